//! Parsing again gives what parsing gives: after any edits of any example, also of broken ones, the tree and the findings
//! are those of a text that was parsed from nothing.

use hypedc::source::FileId;
use hypedc::syntax::{Parsed, parse, reparse};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::support::{by_turn, files, sized};

/// What is put in: pieces that open, close, hide or end something.
const PIECES: &[&str] = &[
    "{",
    "}",
    "\n}\n",
    "\"",
    "'",
    "(",
    ")",
    "//",
    "/// what it is\n",
    "\n",
    ";",
    "    ",
    "\t",
    "mode a {\n",
    "entity B {\n",
    "world W {\n",
    "behavior C(a) {\n",
    "map m \"\n",
    "const a = 1\n",
    "x' = 3",
    "when true -> a",
    "ß",
    "\u{1f40a}",
    "\r\n",
    "start.x",
    "#",
    "when timer >",
    "collide",
    "import \"a.hyped\"\n",
    " ",
    "a_very_long_name",
    "tiles t 8 x 8 {\n",
];

/// A byte of a text where a character begins.
fn place(text: &str, rng: &mut Pcg64) -> usize {
    let mut at = rng.random_range(0..=text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// One edit: pieces are put in, bytes are deleted, lines are doubled or moved.
fn edit(text: &mut String, rng: &mut Pcg64) {
    let at = place(text, rng);
    let line_end = |text: &str, at: usize| text[at..].find('\n').map_or(text.len(), |end| at + end + 1);
    match rng.random_range(0..6) {
        0 | 1 => text.insert_str(at, PIECES[rng.random_range(0..PIECES.len())]),
        2 => {
            let end = (at..=text.len()).filter(|end| text.is_char_boundary(*end)).nth(rng.random_range(1..4));
            text.replace_range(at..end.unwrap_or(text.len()), "");
        }
        3 => {
            let end = line_end(text, at);
            text.replace_range(at..end, "");
        }
        4 => {
            let end = line_end(text, at);
            let copy = text[at..end].to_string();
            let to = place(text, rng);
            text.insert_str(to, &copy);
        }
        _ => {
            let other = place(text, rng);
            let moved = text[at.min(other)..at.max(other)].to_string();
            text.replace_range(at.min(other)..at.max(other), "");
            let to = place(text, rng);
            text.insert_str(to, &moved);
        }
    }
}

#[test]
fn parsing_again_gives_what_parsing_gives() {
    let mut all = files("examples", "hyped");
    all.extend(files("tests/ui", "hyped"));
    let mut taken = (0, 0);
    for (turn, path) in by_turn(&all, 0).iter().enumerate() {
        let original = std::fs::read_to_string(path).unwrap();
        let mut rng = Pcg64::seed_from_u64(turn as u64);
        let (mut text, mut before): (String, Option<Parsed>) = (original.clone(), None);
        for step in 0..sized(12, 200) {
            // Where there is nothing left to be taken, there is nothing to be seen.
            if step % 6 == 5 {
                text.clone_from(&original);
            }
            // The file before another of the same number was another one.
            let id = FileId(u32::from(step % 4 == 3));
            let again = reparse(id, &text, before.as_ref());
            let (tree, diagnostics) = parse(id, &text);
            assert_eq!(again.file, tree, "{}, step {step}:\n{text}", path.display());
            let said = |of| format!("{of:?}");
            assert_eq!(said(&again.diagnostics), said(&diagnostics), "{}, step {step}:\n{text}", path.display());
            taken = (taken.0 + again.taken(), taken.1 + tree.items.len());
            before = Some(again);
            edit(&mut text, &mut rng);
        }
    }
    assert!(taken.0 * 4 > taken.1, "{taken:?}: of what does not change, most is taken");
}

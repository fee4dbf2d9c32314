//! The formatter: its layout, that it changes only the layout, and that it is idempotent.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "properties/generate.rs"]
mod generate;

use std::path::Path;

use crate::support::{Disk, files, is_long, sized};
use hypedc::compile::compile;
use hypedc::format::{WIDTH, format};
use hypedc::ir;
use hypedc::source::{FileId, Files, ReadError};
use hypedc::syntax::parse;
use proptest::prelude::*;

const FILE: FileId = FileId(0);

/// The canonical layout of a text without syntax errors.
fn formatted(text: &str) -> String {
    format(FILE, text).unwrap_or_else(|found| panic!("{found:?}\n{text}"))
}

fn is_right(text: &str) -> bool {
    !parse(FILE, text).1.has_errors()
}

/// The syntax tree as text, without its spans, and the comments.
fn meaning(text: &str) -> (String, Vec<String>) {
    let (tree, _) = parse(FILE, text);
    let comment = |line: &str| line.find("//").map(|at| line[at..].split_whitespace().collect::<Vec<_>>().join(" "));
    let comments = text.lines().filter_map(comment).collect();
    (without_spans(&format!("{:#?}", tree.items)), comments)
}

/// Takes `file0[1..2]` out of a text.
fn without_spans(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut parts = text.split("file0[");
    out.push_str(parts.next().unwrap());
    for part in parts {
        out.push_str(part.split_once(']').unwrap().1);
    }
    out
}

/// Formats a text and checks the invariants of the result.
fn checked(text: &str) -> String {
    let once = formatted(text);
    let (tree, comments) = meaning(text);
    let (tree_after, comments_after) = meaning(&once);
    assert!(is_right(&once), "no errors come in: {text:?}\n{once}");
    assert_eq!(comments, comments_after, "all comments stay, in order: {text:?}\n{once}");
    if let Some((before, after)) = tree.lines().zip(tree_after.lines()).find(|(before, after)| before != after) {
        panic!("it means the same: {before} becomes {after} in {text:?}\n{once}");
    }
    assert_eq!(tree.lines().count(), tree_after.lines().count(), "{text:?}");
    assert_eq!(formatted(&once), once, "the second time changes nothing: {text:?}");
    for line in once.lines() {
        assert_eq!(line.trim_end(), line, "no blanks at a line's end: {once}");
    }
    assert!(once.is_empty() || (once.ends_with('\n') && !once.ends_with("\n\n")), "one line end at the end: {once:?}");
    assert!(!once.starts_with('\n'));
    once
}

/// Numbers that look random, from a seed.
struct Noise(u64);

impl Noise {
    fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % count.max(1)
    }
}

/// Inserts comments, blanks and line breaks wherever the grammar allows them.
fn disturbed(text: &str, seed: u64, edits: usize) -> String {
    let pieces = [
        "// a comment\n",
        " // a comment\n",
        "\n// one\n\n// two\n",
        "\n/// documents\n",
        "\n",
        "\n\n",
        "  ",
        "   ",
        "    ",
        "\t",
        ";",
        "",
    ];
    let mut noise = Noise(seed | 1);
    let mut text = text.to_string();
    for _ in 0..edits {
        let ends: Vec<usize> = boundaries(&text);
        let at = ends[noise.below(ends.len())];
        let piece = pieces[noise.below(pieces.len())];
        // The text that the piece replaces: nothing, or the blanks that follow.
        let rest = &text[at..];
        let blanks = rest.len() - rest.trim_start_matches([' ', '\n']).len();
        let until = at + if noise.below(3) == 0 { blanks } else { 0 };
        let edited = format!("{}{piece}{}", &text[..at], &text[until..]);
        if is_right(&edited) {
            text = edited;
        }
    }
    text
}

/// Where words, numbers and marks end.
fn boundaries(text: &str) -> Vec<usize> {
    let kind = |c: char| if c.is_alphanumeric() || c == '_' { 0 } else { 1 + u32::from(c.is_whitespace()) };
    let mut before = None;
    let mut found = vec![0];
    for (at, c) in text.char_indices() {
        if before.is_some_and(|b| b == 1 || b != kind(c)) {
            found.push(at);
        }
        before = Some(kind(c));
    }
    found.push(text.len());
    found
}

/// Every program of the examples and the tests that has no syntax errors.
fn programs() -> Vec<(String, String)> {
    let all: Vec<_> = ["examples", "tests"].iter().flat_map(|f| files(f, "hyped")).collect();
    let read = all.iter().map(|p| (p.display().to_string(), Disk.read(p).unwrap_or_default()));
    read.filter(|(_, text)| is_right(text)).collect()
}

#[test]
fn a_messy_program_becomes_a_tidy_one() {
    insta::assert_snapshot!(checked(&std::fs::read_to_string("tests/fmt/messy.hyped").unwrap()));
}

/// Asserts that a text is formatted to another one, which is canonical.
#[track_caller]
fn becomes(text: &str, expected: &str) {
    assert_eq!(checked(text), expected);
}

#[test]
fn a_block_stays_on_its_line_while_there_is_room() {
    let short = "entity A { mode b { x' = 1; y' = 2 } mode c { } }\n";
    becomes(short, short);
    becomes(
        "entity A{mode b{x'=1\n;y'=2}mode c{\n\n}}",
        "entity A {\n    mode b {\n        x' = 1\n        y' = 2\n    }\n    mode c { }\n}\n",
    );
    for (room, fits) in [(0, true), (1, false)] {
        let name = "a".repeat(WIDTH - "entity A { param  = 1 }".len() + room);
        let line = format!("entity A {{ param {name} = 1 }}\n");
        let broken = format!("entity A {{\n    param {name} = 1\n}}\n");
        becomes(&line, if fits { &line } else { &broken });
    }
}

#[test]
fn blank_lines_stay_but_not_at_the_ends_of_blocks() {
    becomes(
        "\n\nconst a = 1\n\n\n\nconst b = 2\nentity A {\n\n\n    x' = 1\n\n\n    // last\n\n}\n\n\n",
        "const a = 1\n\nconst b = 2\nentity A {\n    x' = 1\n\n    // last\n}\n",
    );
    becomes("", "");
    becomes("\n \n", "");
    becomes("// only this", "// only this\n");
    // A comment that is no documentation does not become one.
    becomes("entity A { /// a\n\nmode b { } }", "entity A { /// a\n\n    mode b { }\n}\n");
}

#[test]
fn what_was_aligned_stays_aligned() {
    becomes(
        "const a     =    -4\nconst long  =     5\nconst other=6\n",
        "const a    = -4\nconst long =  5\nconst other = 6\n",
    );
    becomes("const a  = 1\n\nconst bb = 2\n", "const a = 1\n\nconst bb = 2\n");
    becomes("const a   = 1 // a\nconst b   =  22 // b\n", "const a = 1 // a\nconst b = 22 // b\n");
    becomes(
        "const a = 1    // a\n// between\nconst bb = 22  // b\n",
        "const a = 1   // a\n// between\nconst bb = 22 // b\n",
    );
    let rows = "world W {
    space s {
        place hero:  Hero  at (32, 16) { speed =  1; y = 2 }
        place slime: Slime at (200, 16)
    }
    goal far:   hero.x > 200
    never died: hero in dead
}
";
    becomes(rows, &rows.replace("speed =  1", "speed = 1"));
}

#[test]
fn a_statement_too_long_for_a_line_is_broken_once() {
    let test = "touching(body, a_wall_of_many_stones, below)";
    let line =
        |guard: &str| format!("entity A {{\n    mode a {{\n        when {guard} -> a {{ x' := 1 }}\n    }}\n}}\n");
    let broken = |guard: &str| {
        format!(
            "entity A {{\n    mode a {{\n        when {guard}\n            -> a\n        {{\n            x' := 1\n        \
             }}\n    }}\n}}\n"
        )
    };
    becomes(
        &line(&format!("{test} and x > 1 or {test} and (x < 2 or y < 2)")),
        &broken(&format!("{test} and x > 1\n            or {test} and (x < 2 or y < 2)")),
    );
    becomes(
        &line(&format!("{test} and {test} and {test} or {test}")),
        &broken(&format!("{test}\n            and {test}\n            and {test}\n            or {test}")),
    );
    // A line break that is not kept does not count.
    let inside = format!("({test} or {test} or {test})");
    becomes(&line(&inside.replace("touching(", "touching\n(")), &broken(&inside));
    let author = format!("{test} and {test}\n            and {test} or {test} and {test}");
    becomes(&line(&author).replace(" -> a", "\n            -> a"), &broken(&author));
}

#[test]
fn line_ends_are_those_of_the_first_line() {
    let text = "const a = 1\r\nworld W {\n  space s {\r\n map t \"\r\n   ..\n  ##\r\n \"\n}\n}";
    let expected = "const a = 1\nworld W {\n    space s {\n        map t \"\n            ..\n            ##\n        \"\n    }\n}\n";
    becomes(text, &expected.replace('\n', "\r\n"));
    becomes(&text.replacen("\r\n", "\n", 1), expected);
}

#[test]
fn a_text_with_errors_is_refused() {
    for text in ["entity A {", "entity A { mode }", "const = 3", "world W { space s { map t \" } }", "const a = ((((1)"]
    {
        let found = format(FILE, text).unwrap_err();
        assert_eq!(found.iter().count(), parse(FILE, text).1.iter().count());
        assert!(found.has_errors(), "{text}");
    }
    let deep = format!("const a = {}1{}", "(".repeat(100_000), ")".repeat(100_000));
    assert!(format(FILE, &deep).is_err());
}

#[test]
fn deep_and_long_programs_are_formatted() {
    let depth = 63;
    let modes = format!("entity A {{ {} {} }}", "mode a {".repeat(depth), "}".repeat(depth));
    let broken = checked(&modes);
    assert!(broken.lines().all(|l| l.chars().count() <= WIDTH + 4 * depth), "{broken}");
    checked(&format!("const a = {}1{}", "(\n".repeat(depth), ")".repeat(depth)));
    checked(&format!("const a = {}1", "- ".repeat(200)));
    let line = format!("entity A {{ mode a {{ {} }} }}", vec!["x' = 3 + 4 * y"; 50_000].join(";"));
    assert_eq!(formatted(&line).lines().count(), 50_004);
    let list = format!("entity A {{ button {} }}", vec!["a"; 50_000].join("  ,"));
    assert_eq!(formatted(&list).lines().count(), 3);
    let column = format!("entity A {{\n{}}}", "    axis   a\n".repeat(50_000));
    assert_eq!(formatted(&column).lines().count(), 50_002);
}

#[test]
fn programs_keep_their_meaning_and_their_comments() {
    let programs = programs();
    assert!(programs.len() > 60, "{} programs", programs.len());
    for (_, text) in &programs {
        checked(text);
    }
}

/// Reads programs in their canonical layout.
struct Formatted;

impl Files for Formatted {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let text = Disk.read(path)?;
        Ok(if path.extension().is_some_and(|e| e == "hyped") { formatted(&text) } else { text })
    }
}

#[test]
fn the_intermediate_representation_stays() {
    for path in files("examples", "hyped").iter().chain(&files("tests/conformance", "hyped")) {
        let compiled = |files: &dyn Files| {
            let program = compile(path, files).program.unwrap();
            let mut json = serde_json::to_value(&program).unwrap();
            json.as_object_mut().unwrap().remove("spans").unwrap();
            (ir::text(&program), json)
        };
        assert!(compiled(&Disk) == compiled(&Formatted), "{}", path.display());
    }
}

/// A tab within quotes is as wide before the layout as after it, so that what was aligned once stays so.
#[test]
fn a_tab_within_quotes_is_one_column() {
    let line = |space: &str, map: &str, legend: &str, blanks: &str, size: &str| {
        format!("    space {space} {{ map vglc \"{map}\" legend \"{legend}\" tile{blanks}{size} }}\n")
    };
    let lines = [
        line("d", "levels\t/room.txt", "levels/long.json", " ", "16 x 16"),
        line("e", "levels/room.txt", "levels/good.json\t", "     ", "16 x 0"),
        line("f", "levels/room.txt", "levels/good.json", " ", "16 x 16"),
    ];
    checked(&format!("world W {{\n{}}}\n", lines.concat()));
}

#[test]
fn comments_and_breaks_may_stand_wherever_the_grammar_lets_them() {
    // Programs of a folder are alike: every third will do.
    for (index, (_, text)) in programs().iter().enumerate().filter(|(index, _)| is_long() || index % 3 == 0) {
        checked(&disturbed(text, 0x9e37_79b9 + index as u64, 40));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: sized(50, 1_000), max_shrink_iters: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_keep_their_meaning(
        choices in prop::collection::vec(any::<u16>(), 0..400),
        seed: u64,
        edits in 0..60usize,
    ) {
        let text = generate::program(&choices);
        checked(&disturbed(&text, seed, edits));
    }
}

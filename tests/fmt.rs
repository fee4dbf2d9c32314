//! The formatter: what its layout looks like, that it changes nothing but the layout, and that it has nothing to do the
//! second time.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "properties/generate.rs"]
mod generate;
mod support;

use std::path::Path;

use hypedc::compile::compile;
use hypedc::format::{WIDTH, format};
use hypedc::ir;
use hypedc::source::{FileId, Files, ReadError};
use hypedc::syntax::parse;
use proptest::prelude::*;
use support::{Disk, files};

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
    let comments = tree.trivia.iter().map(|c| text[c.span.range()].to_string()).collect();
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

/// Formats a text and checks all that always holds of the outcome.
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

/// Puts comments, blanks and line breaks wherever the grammar lets them stand.
fn disturbed(text: &str, seed: u64, edits: usize) -> String {
    let pieces = [
        "// a comment\n",
        " // a comment\n",
        "\n// one\n\n// two\n",
        "\n/// documents\n",
        "\n",
        "\n\n",
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
        // What the piece takes the place of: nothing, or the blanks that follow.
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

#[test]
fn comments_and_breaks_may_stand_wherever_the_grammar_lets_them() {
    for (index, (_, text)) in programs().iter().enumerate() {
        checked(&disturbed(text, 0x9e37_79b9 + index as u64, 40));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, max_shrink_iters: 40, failure_persistence: None, ..ProptestConfig::default() })]

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

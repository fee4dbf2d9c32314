//! Programs that someone is in the middle of writing: whatever is done to a text, the compiler answers, and what still
//! compiles still runs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::{compile_text, files, sized};
use hypedc::diagnostic::render;
use hypedc::ir::WorldId;
use hypedc::sim::{Input, Simulator};
use proptest::prelude::*;
use std::sync::Arc;

/// The example programs, each as one text without imports.
fn texts() -> Vec<String> {
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    let without_imports = |text: String| -> String {
        text.lines().filter(|l| !l.starts_with("import")).map(|l| format!("{l}\n")).collect()
    };
    let paper = |names: &[&str]| -> String {
        names.iter().map(|n| without_imports(read(&format!("examples/paper/{n}.hyped")))).collect()
    };
    let mut texts: Vec<String> = files("tests/ui", "hyped").iter().map(|p| read(p.to_str().unwrap())).collect();
    for _ in 0..texts.len() / 4 {
        texts.push(read("examples/flappy.hyped"));
        texts.push(read("examples/balloon.hyped"));
        texts.push(paper(&["robot", "platforms", "test1"]));
        texts.push(paper(&["mario", "platforms", "test2"]));
    }
    texts
}

/// The text cut into words, numbers, spaces and single signs.
fn tokens(text: &str) -> Vec<String> {
    let kind = |c: char| if c.is_alphanumeric() || c == '_' { 0 } else { 1 + u32::from(c.is_whitespace()) };
    let mut tokens: Vec<String> = Vec::new();
    for c in text.chars() {
        match tokens.last_mut() {
            Some(last) if kind(c) != 1 && last.chars().next_back().is_some_and(|l| kind(l) == kind(c)) => last.push(c),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens
}

#[derive(Debug, Clone)]
enum Edit {
    Delete,
    Double,
    SwapWithNext,
    Replace(&'static str),
    Insert(&'static str),
}

fn edit() -> impl Strategy<Value = Edit> {
    let pieces = prop::sample::select(vec![
        "{",
        "}",
        "(",
        ")",
        "\"",
        "'",
        "->",
        ":=",
        "=",
        ":",
        ",",
        ";",
        "\n",
        "\r\n",
        "//",
        "not ",
        " and ",
        "mode ",
        "when ",
        "é",
        "\u{1f600}",
        "0",
        "1e9",
        "12frames",
        "x''",
        "'{'",
        "*",
        "/",
        "-",
        "..",
        "space ",
        "map ",
        "place ",
        "\t",
    ]);
    prop_oneof![
        3 => Just(Edit::Delete),
        1 => Just(Edit::Double),
        1 => Just(Edit::SwapWithNext),
        2 => pieces.clone().prop_map(Edit::Replace),
        2 => pieces.prop_map(Edit::Insert),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: sized(500, 20_000), ..ProptestConfig::default() })]

    #[test]
    fn edited_programs_get_an_answer(
        which in any::<prop::sample::Index>(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), edit()), 1..4),
    ) {
        let texts = texts();
        let mut tokens = tokens(which.get(texts.as_slice()).as_str());
        for (at, edit) in edits {
            if tokens.is_empty() {
                break;
            }
            let at = at.index(tokens.len());
            match edit {
                Edit::Delete => drop(tokens.remove(at)),
                Edit::Double => tokens.insert(at, tokens[at].clone()),
                Edit::SwapWithNext => {
                    let next = (at + 1) % tokens.len();
                    tokens.swap(at, next);
                }
                Edit::Replace(with) => tokens[at] = with.to_string(),
                Edit::Insert(piece) => tokens.insert(at, piece.to_string()),
            }
        }
        let text = tokens.concat();
        let compiled = compile_text(&text);
        let found = &compiled.diagnostics;
        // Every finding can be shown, and has a place in the file.
        let human = render::human(&compiled.sources, found.iter(), false);
        let short = render::short(&compiled.sources, found.iter());
        prop_assert_eq!(human.is_empty(), found.is_empty());
        prop_assert_eq!(short.lines().count(), found.iter().count());
        for label in found.iter().flat_map(|d| d.primary.iter().chain(&d.secondary)) {
            prop_assert!(label.span.range().end <= text.len(), "{label:?} of {text:?}");
        }
        if let Some(program) = &compiled.program {
            for world in program.worlds.ids().take(2) {
                run(program, world);
            }
        }
    }
}

/// A few steps with every button held in turn; a fault is an answer, too.
fn run(program: &Arc<hypedc::ir::Program>, world: WorldId) {
    let sim = Simulator::new(program, world);
    let mut scratch = sim.scratch();
    let Ok(mut state) = sim.initial(&mut scratch) else { return };
    let mut input = Input::nothing(program.worlds[world].players.len());
    for step in 0..40u64 {
        for player in &mut input.0 {
            player.buttons = 1 << (step / 4 % 8);
            player.axes[0] = [-1.0, 0.0, 1.0][(step / 7 % 3) as usize];
        }
        let mut twin = state.clone();
        let first = sim.step(&mut state, &input, &mut scratch);
        let second = sim.step(&mut twin, &input, &mut sim.scratch());
        assert_eq!(first, second);
        if first.is_err() {
            return;
        }
        assert_eq!(state, twin, "the same step gives the same bits");
    }
}

/// Each parameter is the square of the one before: its exponent doubles until no number holds it.
#[test]
fn of_dimensions_with_too_large_exponents_nothing_is_said() {
    let squares: String = (1..=80).map(|i| format!("param p{i} = p{} * p{}\n", i - 1, i - 1)).collect();
    let program = |used: &str| {
        format!(
            "entity A {{\nparam p0: px = 1\n{squares}mode a {{ x' = 0\nwhen {used} -> b }} mode b {{ x' = 0 }} }}\n"
        )
    };
    let found = |used: &str| {
        let compilation = compile_text(&program(used));
        render::short(&compilation.sources, compilation.diagnostics.iter())
    };
    assert!(found("p2 > p1").contains("px^4"), "{}", found("p2 > p1"));
    for used in ["p80 > p79", "p64 > p63", "p63 > p62 * p62 * p80", "p70 > 1px"] {
        assert!(!found(used).contains("px^"), "{used}: {}", found(used));
    }
}

//! Memory is bounded by the size of the text: for texts of many kinds, the bytes that are allocated at the peak of a
//! check.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::ops::ControlFlow;
use std::path::Path;

use crate::support::{Text, is_long};
use hypedc::compile::check_with;
use hypedc::parallel::{TaskContext, work};

/// The bytes of a text.
const SIZE: usize = 1 << 20;

/// Lines until the text is long enough.
fn lines(before: &str, after: &str, line: impl Fn(usize) -> String) -> String {
    let mut text = before.to_string();
    for i in 0.. {
        if text.len() + after.len() >= SIZE {
            break;
        }
        text += &line(i);
    }
    text + after
}

/// Maximum number of allocated bytes per byte of text. Without blanks between one-letter names and symbols, each byte
/// is an expression.
const MAX_BYTES_PER_BYTE: f64 = 40.0;

/// Texts of one kind each.
fn shapes() -> Vec<(&'static str, String)> {
    vec![
        ("edges", lines("entity A { mode a {\n", "} }\n", |_| "when x > 1 -> a\n".into())),
        (
            "edges of a world",
            lines("entity A { mode a {\n", "} }\nworld W { space main { place a: A at (0, 0) } }\n", |_| {
                "when x > 1 -> a\n".into()
            }),
        ),
        (
            "edges that stay",
            lines("entity A { continuous z = 0\nmode a {\n", "} }\n", |i| format!("when x > {i} {{ z := {i} }}\n")),
        ),
        ("constants", lines("", "", |i| format!("const c{i} = {i}\n"))),
        ("constants of constants", lines("const a = 1\n", "", |i| format!("const c{i} = a + {i} * (a - 2)\n"))),
        ("parameters", lines("entity A {\n", "}\n", |i| format!("param p{i} = {i}\n"))),
        ("variables", lines("entity A {\n", "}\n", |i| format!("continuous p{i} = {i}\n"))),
        ("entities", lines("", "", |i| format!("entity A{i} {{ }}\n"))),
        ("as many entities as there may be", (0..10_000).map(|i| format!("entity A{i} {{ }}\n")).collect()),
        (
            "entities that move",
            lines("", "", |i| format!("entity A{i} {{ mode a {{ x' = 1; when x > 9 -> b }} mode b {{ }} }}\n")),
        ),
        (
            "modes",
            lines("", "", |i| {
                format!(
                    "entity A{i} {{ {} }}\n",
                    (0..1000).map(|m| format!("mode m{m} {{ x' = {m} }}\n")).collect::<String>()
                )
            }),
        ),
        (
            "expressions",
            lines("entity A { mode a {\n", "} }\n", |i| format!("when x > {}{i} -> a\n", "y + 2 * x - ".repeat(60))),
        ),
        (
            "expressions without blanks",
            lines("entity A { mode a {\n", "} }\n", |i| format!("when x>{}{i}->a\n", "y+2*x-".repeat(60))),
        ),
        ("calls", lines("entity A { mode a {\n", "} }\n", |_| "when min(x, y) > max(1, 2) -> a\n".into())),
        (
            "maps",
            lines(
                "world W { tiles t 16 x 16 { '.': empty\n'#': wall }\n space main { map t \"\n",
                "\"\n } }\n",
                |_| format!("{}\n", "..#.".repeat(60)),
            ),
        ),
        (
            "instances",
            lines("entity A { }\nworld W { space main {\n", "} }\n", |i| format!("place a{i}: A at ({i}, 0)\n")),
        ),
        (
            "worlds",
            lines("entity A { }\n", "", |i| format!("world W{i} {{ space main {{ place a: A at (0, 0) }} }}\n")),
        ),
        ("rectangles", lines("world W { space main {\n", "} }\n", |i| format!("rect wall ({i}, 0, 8, 8)\n"))),
        (
            "rectangles that are touched",
            lines(
                "entity A { collider a: rect(0, 0, 8, 8)\nmode m { when touching(a, wall) -> n } mode n { } }
world W { collide a with wall: block\nspace main { place a: A at (0, 9)\n",
                "} }\n",
                |i| format!("rect wall ({i}, 0, 8, 8)\n"),
            ),
        ),
        (
            "goals",
            lines("entity A { }\nworld W { space main { place a: A at (0, 0) }\n", "}\n", |i| {
                format!("goal g{i}: a.x > {i}\n")
            }),
        ),
        ("colliders", lines("entity A {\n", "}\n", |_| "collider c: rect(0, 0, 8, 8)\n".into())),
        ("tags", lines("entity A {\n", "}\n", |i| format!("collider \"tag {i}\": rect(0, 0, 8, 8)\n"))),
        ("values", lines("entity A { discrete d: {", "n} = n }\n", |i| format!("n{i}, "))),
        ("comments", lines("", "", |_| "// x\n".into())),
        ("documents", lines("", "", |i| format!("/// x\nconst c{i} = 1\n"))),
        ("newlines", lines("", "", |_| "\n".into())),
        ("nonsense", lines("", "", |_| "a\n".into())),
        ("other nonsense", lines("", "", |i| format!("mode a{i} = 7\n"))),
        ("unknown names", lines("entity A { mode a {\n", "} }\n", |i| format!("when z{i} > 1 -> b\n"))),
        ("braces", lines("entity A {\n", "}\n", |_| "mode a {}\n".into())),
        ("open braces", lines("", "", |_| "entity A {\n".into())),
        ("updates", lines("entity A { continuous z = 0\nmode a { when x > 1 {\n", "} } }\n", |_| "z := 1\n".into())),
    ]
}

fn most(text: &str) -> u64 {
    let files = Text(text);
    let check = || drop(check_with(Path::new("test.hyped"), Default::default(), &files));
    allocation_counter::measure(check).bytes_max
}

#[test]
fn a_check_takes_memory_by_the_byte() {
    // Each takes seconds: every fifth will do, unless all are asked for.
    let chosen = shapes().into_iter().enumerate().filter(|(index, _)| is_long() || index % 5 == 0);
    let (shapes, mut over): (Vec<_>, _) = (chosen.map(|(_, shape)| shape).collect(), Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    // Allocations are counted by thread.
    let measure = |at: usize, context: &TaskContext<'_, f64>| {
        let (_, text) = &shapes[at];
        context.submit(most(text) as f64 / text.len() as f64);
    };
    work(shapes.len(), threads, &|| false, &measure, &mut |at, each| {
        let (name, _) = shapes[at];
        println!("{name:25} {each:7.1}");
        if each > MAX_BYTES_PER_BYTE {
            over.push(format!("{name}: {each:.1} bytes for each, not {MAX_BYTES_PER_BYTE}"));
        }
        ControlFlow::Continue(())
    });
    assert!(over.is_empty(), "{over:#?}");
}

#[test]
fn four_times_the_text_takes_four_times_the_memory() {
    for (name, text) in
        shapes().into_iter().filter(|(name, _)| ["edges that stay", "constants", "goals"].contains(name))
    {
        // A part of it up to the end of a line, with what closes it.
        let end = text[..text.len() / 4].rfind('\n').unwrap() + 1;
        let after = if name == "constants" {
            ""
        } else if name == "goals" {
            "}\n"
        } else {
            "} }\n"
        };
        let (part, all) = (most(&format!("{}{after}", &text[..end])), most(&text));
        assert!(all < 5 * part, "{name}: {part} bytes of a quarter, {all} of all");
    }
}

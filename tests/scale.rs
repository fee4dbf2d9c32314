//! Large programs: those that read like games compile without a finding, and the shapes that stress one thing get an
//! answer in a time that grows with them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../benches/large/mod.rs"]
mod large;

use std::path::{Path, PathBuf};

use crate::support::{compile_text, sized};
use hypedc::compile::compile;
use hypedc::diagnostic::{Severity, render};
use hypedc::source::{FileId, Files, ReadError};

#[test]
fn large_programs_are_right() {
    let text = large::realistic(10_000);
    let compiled = compile_text(&text);
    let found: Vec<_> = compiled.diagnostics.iter().take(5).collect();
    assert!(found.is_empty(), "{}", render::human(&compiled.sources, found, false));
    assert!(compiled.program.is_some());
}

#[test]
fn every_shape_gets_an_answer() {
    // What takes the square of a size takes hours at these.
    for (name, shape) in large::SHAPES {
        let compiled = compile_text(&shape(sized(1_500, 3_000)));
        let short = render::short(&compiled.sources, compiled.diagnostics.iter());
        assert_eq!(short.lines().count(), compiled.diagnostics.iter().count(), "{name}");
    }
}

/// The codes of the findings in a text.
fn codes(text: &str) -> Vec<&'static str> {
    compile_text(text).diagnostics.iter().map(|d| d.code.text()).collect()
}

#[test]
fn constants_that_double_do_not_grow_without_end() {
    let doubled: String = (1..60).map(|i| format!("const c{i} = c{0} + c{0}\n", i - 1)).collect();
    let text = format!("const c0 = 1\n{doubled}entity A {{ x' = c59 }}\n");
    assert_eq!(codes(&text), ["E0005"]);
}

#[test]
fn behaviours_inside_of_each_other_end_somewhere() {
    let chain = |length: usize| {
        let behaviors = (0..length).map(|i| format!("behavior B{i}() {{ use B{}() }}\n", i + 1)).collect::<String>();
        format!("{behaviors}behavior B{length}() {{ x' = 1 }}\nentity A {{ use B0() }}\n")
    };
    assert_eq!(codes(&chain(100)), [""; 0]);
    assert_eq!(codes(&chain(20_000)), ["E0003"]);
}

#[test]
fn large_programs_are_far_below_the_largest() {
    assert!(large::realistic(100_000).len() * 4 < hypedc::source::MAX_FILE_BYTES);
}

#[test]
fn guards_of_many_parts_are_compared_with_an_end() {
    let parts = |edge: usize| (0..60).map(|p| format!("x > {}", edge + p)).collect::<Vec<_>>().join(" and ");
    let edges: String = (0..400).map(|edge| format!("when {} -> a\n", parts(edge))).collect();
    let found = codes(&format!("entity A {{ mode a {{ {edges} }} }}\n"));
    assert!(found.iter().all(|code| *code == "W0405"), "{found:?}");
}

#[test]
fn bytes_without_end_get_an_answer() {
    // Each of them is a single line, or a single blank.
    let all =
        ["a", "(", ")", "\"", " ", "7", "/", "}", "'", "\n", ";", ",", "\"a", "ab ", "1 ", "map a\"", "a = \"b\" "];
    for part in all {
        for before in ["", "const a = (", "entity A { "] {
            let text = format!("{before}{}", part.repeat(sized(100_000, 300_000)));
            let compiled = compile_text(&text);
            let short = render::short(&compiled.sources, compiled.diagnostics.iter());
            assert!(short.len() < sized(40_000, 100_000), "{part:?} after {before:?}: {} bytes", short.len());
        }
    }
}

#[test]
fn names_of_a_set_are_kept_once() {
    let text = |n: usize| {
        let names: Vec<String> = (0..n).map(|i| format!("n{i}")).collect();
        let edges: String = (0..n).map(|i| format!("when d == n{i} {{ d := n{} }}\n", (i + 1) % n)).collect();
        format!("entity A {{ discrete d: {{{}}} = n0\nmode m {{ {edges} }} }}\n", names.join(", "))
    };
    let most = |n: usize| {
        let text = text(n);
        allocation_counter::measure(|| drop(compile_text(&text))).bytes_max
    };
    let (few, many) = (most(400), most(1_600));
    assert!(many < few * 6, "four times the text takes {few} and {many} bytes");
}

#[test]
fn a_text_of_too_many_tokens_is_refused_before_it_is_read() {
    let text = format!("entity A {{ mode m {{\n{} }} }}\n", "when d<1{d:=1}\n".repeat(600_000));
    let mut found = Vec::new();
    let taken = allocation_counter::measure(|| found = codes(&text));
    assert_eq!(found, ["E0003"]);
    assert!(taken.bytes_max < 40 * text.len() as u64, "{} bytes", taken.bytes_max);
}

#[test]
fn programs_of_too_many_entities_or_worlds_are_refused_once() {
    let entities = |count: usize| (0..count).map(|i| format!("entity A{i} {{ }}\n")).collect::<String>();
    let worlds = |count: usize| (0..count).map(|i| format!("world W{i} {{ }}\n")).collect::<String>();
    let errors = |text: &str| {
        let found = compile_text(text).diagnostics;
        let errors = found.iter().filter(|d| d.severity == Severity::Error);
        errors.map(|d| (d.message.clone(), d.primary.as_ref().unwrap().span.range().start)).collect::<Vec<_>>()
    };
    assert_eq!(errors(&entities(10_000)), []);
    assert_eq!(errors(&worlds(10_000)), []);
    // Only the first one too many is reported; its body and its uses are not.
    let user = "world W { space main { place a: A10001 at (0, 0) } }\n";
    let many = format!("{user}{}entity B {{ x' = z }}\nentity A10001 {{ x' = z }}\n", entities(10_000));
    let at = many.find("B {").unwrap();
    assert_eq!(errors(&many), [("too many entities: 10001, at most 10000".to_string(), at)]);
    let many = format!("{}world V {{ step 0 }}\nworld U {{ step 0 }}\n", worlds(10_000));
    let at = many.find("V {").unwrap();
    assert_eq!(errors(&many), [("too many worlds: 10001, at most 10000".to_string(), at)]);
}

#[test]
fn behaviours_that_are_used_too_often_are_refused_once() {
    let used = |times: usize| format!("behavior B() {{ }}\nentity A {{\n{}}}\n", "use B()\n".repeat(times));
    assert_eq!(compile_text(&used(50_000)).diagnostics.iter().count(), 0);
    let found = compile_text(&used(50_002));
    let [only] = found.diagnostics.iter().collect::<Vec<_>>()[..] else { panic!("one finding") };
    assert_eq!(only.message, "too many behaviors put in place by `use`: 50001, at most 50000");
    let at = found.sources.file(FileId(0)).line_column(only.primary.as_ref().unwrap().span.range().start);
    assert_eq!(at, (50_003, 1));
}

#[test]
fn files_without_end_are_refused_once() {
    struct Empty(String);
    impl Files for Empty {
        fn read(&self, path: &Path) -> Result<String, ReadError> {
            Ok(if path.ends_with("root.hyped") { self.0.clone() } else { ".\n".into() })
        }
    }
    let maps = (0..15_001).map(|i| format!("space s{i} {{ map t from \"{i}.txt\" }}\n")).collect::<String>();
    let text = format!("world W {{ tiles t 8 x 8 {{ '.': empty }}\n{maps}}}\n");
    let found = compile(Path::new("root.hyped"), &Empty(text)).diagnostics;
    let errors: Vec<_> = found.iter().filter(|d| d.code.text() == "E0003").map(|d| &d.message).collect();
    assert_eq!(errors, ["too many files, levels and legends included: 15001, at most 15000"]);
}

#[test]
fn imported_entities_count_too() {
    struct Two([String; 2]);
    impl Files for Two {
        fn identity(&self, path: &Path) -> PathBuf {
            path.to_path_buf()
        }

        fn read(&self, path: &Path) -> Result<String, ReadError> {
            Ok(self.0[usize::from(!path.ends_with("root.hyped"))].clone())
        }
    }
    let entities = |letter: char| (0..6_000).map(|i| format!("entity {letter}{i} {{ }}\n")).collect::<String>();
    let files = Two([format!("import \"other.hyped\"\n{}", entities('A')), entities('B')]);
    let found = compile(Path::new("root.hyped"), &files).diagnostics;
    let errors: Vec<_> = found.iter().filter(|d| d.severity == Severity::Error).map(|d| &d.message).collect();
    assert_eq!(errors, ["too many entities: 10001, at most 10000"]);
}

//! Programs with one mistake each: the checker's findings, and their distance from the mistake.
//!
//! A mutant is an example with one small change of its text. It changes the meaning if it does not compile, or if its
//! flat form differs, places left aside. The table counts how many of those get a finding, and how many findings have a
//! label within one line of the change.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

pub mod mutate;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::support::{Disk, files};
use hypedc::compile::{Compilation, compile};
use hypedc::diagnostic::Diagnostic;
use hypedc::ir::{Program, Spans};
use hypedc::source::{Files, ReadError};
use mutate::{Kind, Mutant, mutant};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Number of mutants of each kind.
const EACH: usize = 200;

/// The disk, but for one file.
struct Changed<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Files for Changed<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if path == self.path { Ok(self.text.to_string()) } else { Disk.read(path) }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

/// The meaning of a program: its flat form without spans.
fn meaning(program: &Program) -> String {
    serde_json::to_string(&Program { spans: Spans::default(), ..program.clone() }).unwrap()
}

/// The lines, from 1, of a finding's labels in a file.
fn lines(compilation: &Compilation, d: &Diagnostic, path: &Path) -> Vec<usize> {
    let labels = d.primary.iter().chain(&d.secondary);
    let labels = labels.filter(|l| compilation.sources.file(l.span.file()).path == path);
    labels
        .flat_map(|l| {
            let file = compilation.sources.file(l.span.file());
            let line = |at: u32| file.line_column(at as usize).0;
            // Of a label over several lines, its ends are drawn.
            [line(l.span.start()), line(l.span.end().saturating_sub(1).max(l.span.start()))]
        })
        .collect()
}

#[derive(Default, Clone, Copy)]
struct Count {
    mutants: usize,
    changed: usize,
    diagnosed: usize,
    near: usize,
    findings: usize,
}

impl Count {
    fn plus(self, other: Count) -> Count {
        Count {
            mutants: self.mutants + other.mutants,
            changed: self.changed + other.changed,
            diagnosed: self.diagnosed + other.diagnosed,
            near: self.near + other.near,
            findings: self.findings + other.findings,
        }
    }

    fn row(&self, name: &str) -> String {
        let share = |part: usize, whole: usize| match whole {
            0 => "-".to_string(),
            _ => format!("{:.1} %", 100.0 * part as f64 / whole as f64),
        };
        let Count { mutants, changed, diagnosed, near, findings } = *self;
        let mean = findings as f64 / diagnosed.max(1) as f64;
        let (said, close) = (share(diagnosed, changed), share(near, diagnosed));
        format!("{name:<28} {mutants:>7} {changed:>8} {said:>10} {close:>8} {mean:>9.2}\n")
    }
}

#[test]
fn mistakes_are_found_and_told_of_near_to_where_they_are() {
    let programs: Vec<PathBuf> = files("examples", "hyped");
    let originals: Vec<(String, Compilation)> =
        programs.iter().map(|p| (std::fs::read_to_string(p).unwrap(), compile(p, &Disk))).collect();
    let meanings: Vec<String> = originals.iter().map(|(_, c)| meaning(c.program.as_ref().unwrap())).collect();
    assert!(originals.iter().all(|(_, c)| c.diagnostics.is_empty()), "the examples themselves are clean");

    let mut rng = Pcg64::seed_from_u64(7);
    let mut counts: BTreeMap<Kind, Count> = BTreeMap::new();
    let mut missed = String::new();
    let mut far = String::new();
    for &kind in Kind::ALL {
        let count = counts.entry(kind).or_default();
        while count.mutants < EACH {
            let which = rng.random_range(0..programs.len());
            let (path, (text, _)) = (&programs[which], &originals[which]);
            let Some(Mutant { text: changed, line, what }) = mutant(text, kind, &mut rng) else { continue };
            count.mutants += 1;
            let compilation = compile(path, &Changed { path, text: &changed });
            let is_same = || compilation.program.as_ref().is_some_and(|p| meaning(p) == meanings[which]);
            if compilation.diagnostics.is_empty() && is_same() {
                continue;
            }
            count.changed += 1;
            let found: Vec<&Diagnostic> = compilation.diagnostics.iter().collect();
            if found.is_empty() {
                writeln!(missed, "{}:{line}: {}: {what}", path.display(), kind.name()).unwrap();
                continue;
            }
            count.diagnosed += 1;
            count.findings += found.len();
            let near = found.iter().flat_map(|d| lines(&compilation, d, path)).any(|l| l.abs_diff(line) <= 1);
            if near {
                count.near += 1;
            } else {
                let said: Vec<String> = found.iter().map(|d| format!("{} {}", d.code, d.message)).collect();
                writeln!(far, "{}:{line}: {}: {what}\n    {}", path.display(), kind.name(), said.join("\n    "))
                    .unwrap();
            }
        }
    }
    // For debugging: the list of mutants.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("mutants_missed.txt"), missed).unwrap();
    std::fs::write(folder.join("mutants_far.txt"), far).unwrap();

    let mut table = format!(
        "{:<28} {:>7} {:>8} {:>10} {:>8} {:>9}\n",
        "change", "mutants", "changed", "diagnosed", "near", "findings"
    );
    for (kind, count) in &counts {
        table.push_str(&count.row(kind.name()));
    }
    let total = counts.values().fold(Count::default(), |all, c| all.plus(*c));
    table.push_str(&total.row("all"));
    insta::assert_snapshot!(table);
    assert!(total.mutants >= 2_000);
}

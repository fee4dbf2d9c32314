//! The output for users: every program of `tests/ui` with its rendered findings, in both forms.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::support::Disk;
use hypedc::compile::{LevelFile, check_with};
use hypedc::diagnostic::{Code, render};

fn programs() -> Vec<PathBuf> {
    crate::support::files("tests/ui", "hyped")
}

#[test]
fn findings_look_like_this() {
    for path in programs() {
        let compiled = check_with(&path, LevelFile::default(), &Disk);
        let found = &compiled.diagnostics;
        assert!(!found.is_empty(), "{}: nothing is found", path.display());
        let human = render::human(&compiled.sources, found.iter(), false);
        let short = render::short(&compiled.sources, found.iter());
        let lines = short.lines().count();
        assert_eq!(lines, found.iter().count(), "{}: one line a finding", path.display());
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        insta::with_settings!({ snapshot_path => "ui", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(name, format!("{human}{short}"));
        });
    }
}

#[test]
fn every_code_of_the_checker_is_shown() {
    let mut seen = BTreeSet::new();
    for path in programs() {
        seen.extend(check_with(&path, LevelFile::default(), &Disk).diagnostics.iter().map(|d| d.code));
    }
    // These need a file that is no text, or a running world; the tests of the command line show them.
    let elsewhere =
        [Code::NotUtf8, Code::NoQuestion, Code::Fault, Code::InvariantBroken, Code::TestFailed, Code::SpawnRefused];
    // Imports have files of their own, and tests of their own.
    let is_of_import = |code: &Code| code.text()[1..].starts_with("08");
    let missing = Code::ALL.iter().copied().filter(|c| !seen.contains(c) && !elsewhere.contains(c));
    let missing: Vec<Code> = missing.filter(|code| !is_of_import(code)).collect();
    assert!(missing.is_empty(), "no program shows {missing:?}");
}

//! What a user sees: every program of `tests/ui` beside its rendered findings, in both forms.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use hypedc::compile::compile;
use hypedc::diagnostic::{Code, render};
use hypedc::source::{Files, ReadError, decode};

struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        decode(std::fs::read(path).map_err(|_| ReadError::Unreadable("no such file".into()))?)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
    }
}

fn programs() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir("tests/ui")
        .unwrap()
        .map(|f| f.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "hyped"))
        .collect();
    files.sort();
    assert!(files.len() > 25, "the programs are there");
    files
}

#[test]
fn findings_look_like_this() {
    for path in programs() {
        let compiled = compile(&path, &Disk);
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
        seen.extend(compile(&path, &Disk).diagnostics.iter().map(|d| d.code));
    }
    // These need a file that is no text, or a running world; the tests of the command line show them.
    let elsewhere = [Code::NotUtf8, Code::BadInput, Code::NoQuestion, Code::Fault];
    let missing: Vec<Code> =
        Code::ALL.iter().copied().filter(|c| !seen.contains(c) && !elsewhere.contains(c)).collect();
    assert!(missing.is_empty(), "no program shows {missing:?}");
}

//! Fixes: each removes its finding, and `check --fix` applies them to the files.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{Disk, Text, compile_text, files};
use hypedc::compile::{Compilation, compile};
use hypedc::diagnostic::Code;
use hypedc::diagnostic::fix::{apply_edits, by_file};
use hypedc::source::{Files, ReadError};

/// The disk with other texts in place of some files.
struct Overlay(BTreeMap<PathBuf, String>);

impl Files for Overlay {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.0.get(path).map_or_else(|| Disk.read(path), |text| Ok(text.clone()))
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

/// Applies each fix alone and asserts that its finding is gone; returns the codes of the findings that had one.
fn each_fix_works(root: &Path, files: &dyn Files) -> Vec<Code> {
    let Compilation { sources, diagnostics, .. } = compile(root, files);
    let mut codes = Vec::new();
    for d in diagnostics.iter() {
        let Some(fix) = &d.fix else { continue };
        let mut texts = BTreeMap::new();
        for (file, edits) in by_file([fix]) {
            let source = sources.file(file);
            texts.insert(source.path.clone(), apply_edits(source.text(), &edits).unwrap());
        }
        let shown: Vec<String> = texts.values().cloned().collect();
        let overlay = Overlay(texts);
        let again = compile(root, &overlay).diagnostics;
        let start = |d: &hypedc::diagnostic::Diagnostic| d.primary.as_ref().map(|l| (l.span.file(), l.span.start()));
        let left = again.iter().any(|a| (a.code, &a.message, start(a)) == (d.code, &d.message, start(d)));
        assert!(!left, "{}: {} stays after: {}\n{}", root.display(), d.message, fix.title, shown.concat());
        let count = |found: &hypedc::diagnostic::Diagnostics| found.iter().filter(|a| a.code == d.code).count();
        assert!(
            count(&again) < count(&diagnostics),
            "{}: {} only moves\n{}",
            root.display(),
            d.message,
            shown.concat()
        );
        codes.push(d.code);
    }
    codes
}

#[test]
fn every_fix_does_away_with_its_finding() {
    let all: Vec<Code> = files("tests/ui", "hyped").iter().flat_map(|path| each_fix_works(path, &Disk)).collect();
    for (code, least) in [(Code::UnknownName, 15), (Code::Syntax, 4)] {
        let found = all.iter().filter(|c| **c == code).count();
        assert!(found >= least, "{code}: {found}");
    }
}

/// The text after its only fix.
fn after_fix(text: &str) -> Option<String> {
    each_fix_works(Path::new("test.hyped"), &Text(text));
    let found = compile_text(text);
    let fixes: Vec<_> = found.diagnostics.iter().filter_map(|d| d.fix.as_ref()).collect();
    let [fix] = fixes[..] else { return None };
    apply_edits(text, by_file([fix]).values().next()?)
}

#[test]
fn what_is_certain_is_mended() {
    let in_mode = |line: &str| format!("entity A {{\n    button jump\n    mode only {{\n        {line}\n    }}\n}}\n");
    for (wrong, right) in [
        ("when pressed(jmp) { y := 1 }", "when pressed(jump) { y := 1 }"),
        ("wen pressed(jump) { y := 1 }", "when pressed(jump) { y := 1 }"),
        ("when pressed(jump) { y = 1 }", "when pressed(jump) { y := 1 }"),
        ("when pressed(jump) -> only { y' = 1 }", "when pressed(jump) -> only { y' := 1 }"),
        ("when x = 1 { y := 1 }", "when x == 1 { y := 1 }"),
        ("when x^2 > 1 { y := 1 }", "when x * x > 1 { y := 1 }"),
        ("when 1 / x ^ 2 > 1 { y := 1 }", "when 1 / (x * x) > 1 { y := 1 }"),
        ("when self.x > 1 { y := 1 }", "when x > 1 { y := 1 }"),
        ("y' = held(jump) ? 1 : -1 // up", "y' = if(held(jump), 1, -1) // up"),
    ] {
        assert_eq!(after_fix(&in_mode(wrong)), Some(in_mode(right)), "{wrong}");
    }
    assert_eq!(after_fix("entitiy A { }\n").as_deref(), Some("entity A { }\n"));
    for (wrong, right) in [
        ("clamp y' > -200", "clamp y' >= -200"),
        ("discrete armed = true", "discrete armed: bool = true"),
        ("discrete armed: boolean = true", "discrete armed: bool = true"),
        ("discrete keys: 0..9 = 0", "discrete keys: int 0..9 = 0"),
    ] {
        let around = |line: &str| format!("entity A {{\n    {line}\n}}\n");
        assert_eq!(after_fix(&around(wrong)), Some(around(right)), "{wrong}");
    }
    let world = |size: &str, player: &str| {
        format!(
            "entity A {{ x' = 3 }}\nworld W {{\n    tiles t {size} {{ '#': wall }}\n    \
             space main {{\n        place a: A at (0, 0)\n    }}\n    {player}\n}}\n"
        )
    };
    assert_eq!(after_fix(&world("16x16", "player 1: a")), Some(world("16 x 16", "player 1: a")));
    assert_eq!(after_fix(&world("16 x 16", "player: a")), Some(world("16 x 16", "player 1: a")));
}

#[test]
fn what_is_not_certain_is_left() {
    for text in [
        // Two names are equally similar.
        "entity A {\n    param start = 1\n    param stark = 1\n    x' = stars\n}\n",
        // A second `=` may be the start of something else.
        "entity A {\n    y' = 1 = 2\n}\n",
        // `mode` would not make sense of it.
        "entity A {\n    mod + 3\n}\n",
        // In a behaviour a name has a different meaning at each use.
        "behavior B {\n    param speed = 1\n    x' = sped\n}\nentity A { use B }\nentity C { use B }\n",
    ] {
        let found = compile_text(text);
        assert!(found.diagnostics.has_errors(), "{text}");
        assert!(found.diagnostics.iter().all(|d| d.fix.is_none()), "{text}{:?}", found.diagnostics);
    }
}

/// A separate folder for a test.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("fix_{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn check(arguments: &[&str], file: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).arg("check").args(arguments).arg(file).output().unwrap()
}

#[test]
fn check_mends_files_and_what_they_import() {
    let at = folder("imports");
    std::fs::create_dir_all(at.join("game/parts")).unwrap();
    let write = |path: &str, text: &str| std::fs::write(at.join(path), text).unwrap();
    let read = |path: &str| std::fs::read_to_string(at.join(path)).unwrap();
    let outside = "entity Outside { param speed = 1 x' = sped }\n";
    write("outside.hyped", outside);
    write("game/parts/inside.hyped", "entity Inside {\n    param speed = 1\n    x' = sped\n}\n");
    write(
        "game/main.hyped",
        "\u{feff}import \"parts/inside.hyped\"\r\nimport \"../outside.hyped\"\r\nentitiy Main {\r\n    param speed = 1\r\n    x' = speeed\r\n}\r\n",
    );
    let output = check(&["--fix", "--format", "short"], &at.join("game/main.hyped"));
    let told = String::from_utf8(output.stderr).unwrap().replace(&at.display().to_string(), "…");
    assert_eq!(
        told,
        "fixed …/game/main.hyped:3:1: write `entity` (E0101)\n\
         fixed …/game/parts/inside.hyped:3:10: write `speed` (E0201)\n\
         fixed …/game/main.hyped:5:10: write `speed` (E0201)\n"
    );
    assert_eq!(
        read("game/main.hyped"),
        "\u{feff}import \"parts/inside.hyped\"\r\nimport \"../outside.hyped\"\r\nentity Main {\r\n    param speed = 1\r\n    x' = speed\r\n}\r\n"
    );
    assert_eq!(read("game/parts/inside.hyped"), "entity Inside {\n    param speed = 1\n    x' = speed\n}\n");
    assert_eq!(read("outside.hyped"), outside, "outside of the program's folder");
    assert_eq!(output.status.code(), Some(1));
    let left = String::from_utf8(output.stdout).unwrap();
    assert!(left.lines().count() == 1 && left.contains("outside.hyped:1:"), "{left}");
    let names: Vec<_> = std::fs::read_dir(at.join("game")).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "nothing stays behind: {names:?}");
}

#[test]
fn a_clean_file_is_not_written() {
    let path = folder("clean").join("clean.hyped");
    std::fs::write(&path, "entity A { }\n").unwrap();
    let before = std::fs::metadata(&path).unwrap().modified().unwrap();
    let output = check(&["--fix"], &path);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), format!("{}: no errors\n", path.display()));
    assert_eq!(std::fs::metadata(&path).unwrap().modified().unwrap(), before);
    assert_eq!(check(&["--fix"], Path::new("no/such.hyped")).status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::PermissionsExt;
    let at = folder("links");
    std::fs::create_dir(at.join("real")).unwrap();
    let (real, link) = (at.join("real/a.hyped"), at.join("link.hyped"));
    std::fs::write(&real, "entitiy A { }\n").unwrap();
    std::fs::set_permissions(&real, std::fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    assert_eq!(check(&["--fix"], &link).status.code(), Some(0));
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(std::fs::read_to_string(&real).unwrap(), "entity A { }\n");
    assert_eq!(std::fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
}

//! The structure that the documentation promises: the header of each file, its length, and the direction of the
//! dependencies between modules.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;

use crate::support::files;

/// Each module of the library with its allowed dependencies, in the order of the pipeline.
const DEPENDENCIES: &[(&str, &[&str])] = &[
    ("source", &[]),
    ("watch", &[]),
    ("parallel", &[]),
    ("tabular", &[]),
    ("diagnostic", &["source"]),
    ("syntax", &["source", "diagnostic"]),
    ("format", &["source", "diagnostic", "syntax"]),
    ("import", &["source", "diagnostic", "syntax", "format"]),
    ("ir", &["source"]),
    ("level", &["source", "diagnostic", "ir"]),
    ("sema", &["source", "diagnostic", "syntax", "level", "ir"]),
    ("ir/lower", &["source", "sema", "ir"]),
    ("lint", &["source", "diagnostic", "sema", "ir"]),
    ("analysis", &["source", "watch", "diagnostic", "ir"]),
    ("compile", &["source", "diagnostic", "syntax", "level", "sema", "lint", "ir", "analysis"]),
    ("sim", &["source", "watch", "tabular", "diagnostic", "ir"]),
    ("reach", &["source", "watch", "ir", "analysis", "sim"]),
    ("graph", &["source", "ir"]),
    ("view", &["ir"]),
    ("experiment", &["source", "watch", "parallel", "tabular", "ir", "analysis", "compile", "sim", "reach"]),
    ("corpus", &["tabular", "reach"]),
    ("lsp", &["source", "watch", "diagnostic", "syntax", "format", "sema", "ir", "analysis", "compile"]),
    (
        "cli",
        &[
            "source",
            "parallel",
            "tabular",
            "corpus",
            "analysis",
            "watch",
            "diagnostic",
            "format",
            "import",
            "ir",
            "compile",
            "sim",
            "reach",
            "graph",
            "view",
            "experiment",
            "lsp",
        ],
    ),
];

/// Within a module: the parts of its own module that a folder does not use.
const FOLDER_RULES: &[(&str, &[&str])] = &[
    ("analysis/domain", &["analysis::geometry", "analysis::step", "analysis::fixpoint", "analysis::membership"]),
    ("analysis/geometry", &["analysis::step", "analysis::fixpoint", "analysis::membership", "analysis::findings"]),
    ("analysis/step", &["analysis::fixpoint", "analysis::membership", "analysis::findings"]),
    ("analysis/fixpoint", &["analysis::membership", "analysis::findings"]),
    ("lsp/text", &["lsp::view", "lsp::snapshot", "lsp::documents", "lsp::features", "lsp::protocol"]),
    ("lsp/features", &["lsp::protocol"]),
    ("lsp/view", &["lsp::features", "lsp::protocol"]),
    ("lsp/snapshot", &["lsp::view", "lsp::features", "lsp::protocol"]),
    ("lsp/documents", &["lsp::view", "lsp::snapshot", "lsp::features", "lsp::protocol"]),
    ("lsp/diagnostics", &["lsp::view", "lsp::features", "lsp::protocol"]),
];

/// Maximum number of lines of a source file.
const MAX_LINES: usize = 620;

#[test]
fn files_say_what_they_are_and_stay_short() {
    for path in files("src", "rs") {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("//! "), "{} does not say what it is", path.display());
        let lines = text.lines().count();
        assert!(lines <= MAX_LINES, "{} has {lines} lines", path.display());
    }
}

#[test]
fn arrows_between_modules_run_one_way() {
    let mut seen = Vec::new();
    for path in files("src", "rs") {
        let inside = path.strip_prefix("src").unwrap();
        let inside = inside.to_str().unwrap().replace('\\', "/");
        let is_of = |module: &str| inside.strip_prefix(module).is_some_and(|rest| rest.starts_with(['/', '.']));
        if is_of("lib") || is_of("main") {
            continue;
        }
        // A folder within a module can have its own dependencies.
        let of = DEPENDENCIES.iter().filter(|(m, _)| is_of(m)).max_by_key(|(m, _)| m.len());
        let (module, allowed) = of.unwrap_or_else(|| panic!("{inside} is not drawn"));
        seen.push(module.to_string());
        let text = std::fs::read_to_string(&path).unwrap();
        for (_, after) in text.match_indices("crate::").map(|(at, word)| (at, &text[at + word.len()..])) {
            let used: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let fine = used == *module || allowed.contains(&used.as_str());
            assert!(fine, "{} uses {used}, which the pipeline does not allow", path.display());
        }
    }
    for (module, _) in DEPENDENCIES {
        assert!(seen.iter().any(|s| s == module), "{module} is listed, but missing");
    }
}

#[test]
fn folders_of_a_module_have_separate_dependencies() {
    for (folder, forbidden) in FOLDER_RULES {
        let of = |inside: &str| inside.strip_prefix(folder).is_some_and(|rest| rest.starts_with(['/', '.']));
        let inside = |path: &Path| path.strip_prefix("src").unwrap().to_str().unwrap().replace('\\', "/");
        let files: Vec<_> = files("src", "rs").into_iter().filter(|path| of(&inside(path))).collect();
        assert!(!files.is_empty(), "{folder} is missing");
        for path in files {
            let text = std::fs::read_to_string(&path).unwrap();
            let used = forbidden.iter().find(|used| text.contains(&format!("crate::{used}::")));
            assert_eq!(used, None, "{} uses what comes after it", path.display());
        }
    }
}

#[test]
fn the_map_names_every_module() {
    let map = std::fs::read_to_string("src/lib.rs").unwrap();
    for (module, _) in DEPENDENCIES.iter().filter(|(module, _)| !module.contains('/')) {
        assert!(map.contains(&format!("//! | [`{module}`] |")), "src/lib.rs does not say what {module} holds");
    }
    assert!(Path::new("grammar/hyped.pest").exists());
}

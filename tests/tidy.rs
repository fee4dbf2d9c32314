//! The structure that the documentation promises: the header of each file, its length, and the direction of the
//! dependencies between modules.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;

use crate::support::{declares, files};

/// Each module of the library with its allowed dependencies, in the order of the pipeline.
const DEPENDENCIES: &[(&str, &[&str])] = &[
    ("source", &[]),
    ("watch", &[]),
    ("parallel", &[]),
    ("tabular", &[]),
    ("json", &[]),
    ("ordered", &[]),
    ("diagnostic", &["source", "json", "ordered"]),
    ("syntax", &["source", "ordered", "diagnostic"]),
    ("format", &["source", "ordered", "diagnostic", "syntax"]),
    ("import", &["source", "diagnostic", "syntax", "format"]),
    ("ir", &["source", "json"]),
    ("level", &["source", "ordered", "diagnostic", "ir"]),
    ("sema", &["source", "ordered", "diagnostic", "syntax", "level", "ir"]),
    ("ir/lower", &["source", "ordered", "sema", "ir"]),
    ("lint", &["source", "ordered", "diagnostic", "sema", "ir"]),
    ("analysis", &["source", "watch", "ordered", "diagnostic", "ir"]),
    ("sim", &["source", "watch", "tabular", "json", "ordered", "diagnostic", "ir"]),
    ("batch", &["diagnostic", "ir", "sim"]),
    ("compile", &["source", "diagnostic", "syntax", "level", "sema", "lint", "ir", "analysis", "sim"]),
    ("why", &["source", "ir", "sim"]),
    ("reach", &["source", "watch", "parallel", "ordered", "ir", "analysis", "sim", "why"]),
    ("graph", &["source", "ordered", "ir"]),
    ("view", &["ordered", "ir", "sim"]),
    ("experiment", &["source", "watch", "parallel", "tabular", "ir", "analysis", "compile", "sim", "reach"]),
    ("corpus", &["tabular", "json", "reach"]),
    ("tune", &["source", "watch", "json", "diagnostic", "ir", "analysis", "compile", "sim", "reach"]),
    ("suite", &["source", "watch", "syntax", "ir", "compile", "sim", "reach", "corpus", "why"]),
    (
        "ask",
        &[
            "source",
            "watch",
            "json",
            "diagnostic",
            "ir",
            "analysis",
            "compile",
            "sim",
            "reach",
            "corpus",
            "why",
            "view",
        ],
    ),
    ("diff", &["source", "watch", "diagnostic", "syntax", "ir", "analysis", "sim", "reach", "why"]),
    (
        "studio",
        &[
            "source",
            "watch",
            "ordered",
            "diagnostic",
            "syntax",
            "ir",
            "level",
            "analysis",
            "compile",
            "sim",
            "reach",
            "graph",
            "why",
        ],
    ),
    (
        "lsp",
        &[
            "source",
            "watch",
            "json",
            "ordered",
            "diagnostic",
            "syntax",
            "format",
            "sema",
            "ir",
            "level",
            "analysis",
            "compile",
            "sim",
            "why",
            "reach",
            "corpus",
            "suite",
            "ask",
            "studio",
            "view",
        ],
    ),
    (
        "cli",
        &[
            "source",
            "parallel",
            "tabular",
            "json",
            "corpus",
            "diff",
            "ask",
            "analysis",
            "watch",
            "diagnostic",
            "format",
            "import",
            "ir",
            "compile",
            "sim",
            "reach",
            "studio",
            "suite",
            "graph",
            "view",
            "experiment",
            "why",
            "tune",
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
    ("lsp/text", &["lsp::view", "lsp::snapshot", "lsp::documents", "lsp::location", "lsp::features", "lsp::protocol"]),
    ("lsp/features", &["lsp::protocol", "lsp::service"]),
    ("lsp/service", &["lsp::protocol", "lsp::verdicts"]),
    ("lsp/verdicts", &["lsp::features", "lsp::service", "lsp::protocol", "lsp::view"]),
    ("lsp/protocol", &["lsp::service"]),
    ("lsp/view", &["lsp::features", "lsp::protocol"]),
    ("lsp/values", &["lsp::view", "lsp::snapshot", "lsp::documents", "lsp::features", "lsp::protocol"]),
    ("lsp/snapshot", &["lsp::view", "lsp::features", "lsp::protocol"]),
    ("lsp/documents", &["lsp::view", "lsp::snapshot", "lsp::features", "lsp::protocol"]),
    ("lsp/location", &["lsp::snapshot", "lsp::documents", "lsp::features", "lsp::protocol"]),
];

/// Crates that are for one folder of a module: the module, the folder, the crates.
const FOREIGN: &[(&str, &str, &[&str])] = &[("lsp", "lsp/protocol", &["gen_lsp_types", "lsp_server", "serde_json"])];

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
fn crates_stay_in_their_rooms() {
    for (module, room, crates) in FOREIGN {
        let (inside, outside): (Vec<_>, Vec<_>) = files(&format!("src/{module}"), "rs")
            .into_iter()
            .partition(|path| path.starts_with(Path::new("src").join(room)));
        assert!(!outside.is_empty(), "{module} has no file outside of {room}");
        for used in *crates {
            let names = |path: &std::path::PathBuf| std::fs::read_to_string(path).unwrap().contains(used);
            assert!(inside.iter().any(names), "{room} does not use {used}");
            let stray = outside.iter().find(|path| names(path));
            assert_eq!(stray, None, "{used} is used outside of {room}");
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

/// Each phase of the simulator beside its abstraction, in the documentation of the analysis.
#[test]
fn the_table_of_phases_names_what_there_is() {
    let text = std::fs::read_to_string("src/analysis/mod.rs").unwrap();
    let rows = text.lines().filter(|line| line.starts_with("//! | ") && line.matches(" | ").count() == 4);
    let mut names = 0;
    for row in rows {
        let cells: Vec<&str> = row.split(" | ").collect();
        let code = |cell: usize| cells[cell].split('`').skip(1).step_by(2);
        for (cell, folder) in [(1, "src/sim"), (2, "src/analysis")] {
            for name in code(cell).filter(|name| !["never", "goal"].contains(name)) {
                // Of a variant its enumeration is looked up.
                let is_variant = |part: &&str| part.starts_with(char::is_uppercase) && name.contains(':');
                let last = name.rsplit(['.', ':']).find(|part| !part.is_empty() && !is_variant(part));
                let last = last.unwrap_or_else(|| name.split(':').next().unwrap());
                let mut code = files(folder, "rs").into_iter().map(|path| std::fs::read_to_string(path).unwrap());
                let is_declared = code.any(|code| declares(&code, &["fn", "struct", "enum", "mod", "pub"], last));
                assert!(is_declared, "{folder} declares no `{last}`: {row}");
                names += 1;
            }
        }
        for name in code(4) {
            let exists = match name.rsplit_once('/') {
                Some(("tests", file)) => Path::new("tests").join(file).exists(),
                Some(("verdicts", pattern)) => some_file("tests/verdicts", pattern),
                Some(("found", pattern)) => some_file("tests/analysis/found", pattern),
                _ => some_file("tests/analysis/found", name) || Path::new("tests/analysis").join(name).exists(),
            };
            assert!(exists, "no test `{name}`: {row}");
        }
    }
    assert!(names > 20, "{names}");
}

/// Whether a folder has a program whose name fits a pattern with `*` at its ends.
fn some_file(folder: &str, pattern: &str) -> bool {
    let middle = pattern.trim_matches('*');
    files(folder, "hyped").iter().any(|path| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let starts = pattern.starts_with('*') || name.starts_with(middle);
        let ends = pattern.ends_with('*') || name.ends_with(middle);
        name.contains(middle) && starts && ends
    })
}

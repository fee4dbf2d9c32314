//! Writes a test with the inputs of a run: the text of the program with it, once the test has passed there.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{Monitor, Program, named};
use crate::compile::Changes;
use crate::lsp::buffers::Buffers;
use crate::source::{Files, ReadError, normalize};
use crate::suite::{NoWays, Recorded, Subject, TestOptions, insert_test, run_test};

/// The arguments.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(in crate::lsp) struct RecordArguments {
    #[serde(skip)]
    pub program: Program,
    /// The name of the test.
    pub test: String,
    /// The inputs, as a script.
    pub inputs: String,
    /// What holds after them.
    pub predicate: String,
    /// The seed of what nature draws.
    pub chance: Option<u64>,
}

/// A text with a new test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Recording {
    pub path: PathBuf,
    pub text: String,
}

/// The files with one other text.
struct Changed<'a> {
    buffers: &'a Buffers,
    path: &'a Path,
    text: &'a str,
}

impl Files for Changed<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if normalize(path) == self.path { Ok(self.text.to_string()) } else { self.buffers.read(path) }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.buffers.identity(path)
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        self.buffers.bad_picture(path)
    }
}

/// The text with a test whose inputs lead to its predicate.
///
/// # Errors
/// Why there is none: the test does not pass, or cannot be written.
pub(in crate::lsp) fn record(
    arguments: &RecordArguments,
    buffers: &Buffers,
    monitor: &dyn Monitor,
) -> Result<Recording, String> {
    let RecordArguments { program, test, inputs, predicate, chance } = arguments;
    let (loaded, tests) = program.load(&Changes::default(), buffers)?;
    let world = loaded.program.worlds[program.world(&loaded)?].name.clone();
    if tests.iter().any(|case| (&case.world_name, &case.name) == (&world, test)) {
        return Err(format!("`{world}` has a test `{test}` already"));
    }
    let path = named(&program.path);
    let text = buffers.read(&path).map_err(|_| format!("cannot read `{}`", path.display()))?;
    let recorded = Recorded { world: &world, test, inputs, seed: *chance, predicate: predicate.trim() };
    let text = insert_test(&text, &recorded)
        .ok_or_else(|| format!("the file does not hold the world `{world}`, or no test can be named `{test}`"))?;
    let files = Changed { buffers, path: &path, text: &text };
    let compiled = crate::compile::compile_changed(&path, program.level(), &Changes::default(), &files);
    let Some(compiled_program) = &compiled.program else {
        return Err(crate::ask::Refusal::Findings(compiled.diagnostics).sentence(&compiled.sources));
    };
    let case = compiled.tests.iter().find(|case| (&case.world_name, &case.name) == (&world, test));
    let subject = Subject { file: &path, level: program.level(), numbers: &[], files: &files };
    let options = TestOptions { nodes: 1, seed: 1, covers: false, ways: &NoWays };
    let tested = case.map(|case| run_test(&subject, (compiled_program, &compiled.sources), case, &options, monitor));
    match tested {
        Some(tested) if tested.result.passed => Ok(Recording { path, text }),
        Some(tested) => {
            let claim = tested.result.claims.iter().find(|claim| !claim.passed).map(|claim| claim.answer.clone());
            let why = tested.result.problems.into_iter().next().or(claim).unwrap_or_default();
            Err(format!("a test of these inputs does not pass: {why}"))
        }
        None => Err("the test cannot be read in the text".to_string()),
    }
}

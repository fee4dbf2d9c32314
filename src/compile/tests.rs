//! The tests of a program, as data beside it: no table of the program depends on them. Their scripts are read here, as they
//! name buttons of compiled entities.

use std::path::Path;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::{TooMany, Unreadable};
use crate::ir::{Program, WorldId};
use crate::sema::checked::{self, ClaimKind, When, World};
use crate::sim::{Script, parse_script_at};
use crate::source::{FileId, Files, SourceMap, Span};
use crate::syntax::ast::{SearchKind, TestInputs};

/// A test of a world.
#[derive(Debug, Clone)]
pub struct TestCase {
    /// The world.
    pub world: WorldId,
    /// Its name, by which it is tested again with further questions.
    pub world_name: String,
    /// The name of the test.
    pub name: String,
    /// The inputs of its run; none if it is given none.
    pub script: Option<Script>,
    /// The seed of what nature draws.
    pub seed: Option<u64>,
    /// What it claims, in source order.
    pub claims: Vec<TestClaim>,
    /// Its name in the text.
    pub at: Span,
}

/// A claim of a test.
#[derive(Debug, Clone)]
pub struct TestClaim {
    /// The predicate, or the name of a goal or a `never`, on one line.
    pub predicate: String,
    /// What is claimed of it.
    pub kind: TestClaimKind,
    /// The whole.
    pub at: Span,
    /// The whole on one line.
    pub text: String,
}

/// What is claimed of a predicate.
#[derive(Debug, Clone)]
pub enum TestClaimKind {
    /// Something of the run with the inputs of the test.
    Expect(When),
    /// Something of all runs.
    Search(TestSearch),
}

/// What is claimed of all runs.
#[derive(Debug, Clone)]
pub struct TestSearch {
    /// What is asked.
    pub kind: SearchKind,
    /// The predicate that never holds on the way.
    pub without: Option<String>,
    /// Whether it is `not without`: there is a way, and none without it.
    pub is_needed: bool,
    /// Maximum number of steps of a way.
    pub within: Option<u32>,
}

/// Reads the tests of the worlds of a file; reports scripts that cannot be given. A world whose map is not known yet has
/// tests without scripts.
pub(super) fn read_tests(
    worlds: Vec<WorldTests>,
    program: &Program,
    sources: &mut SourceMap,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Vec<TestCase> {
    let mut cases = Vec::new();
    for WorldTests { world: id, name: world_name, tests } in worlds {
        let is_open = program.worlds.get(id).is_none_or(|world| world.open.is_some());
        for test in tests {
            let mut script = (!test.inputs.is_empty()).then(Script::default);
            for inputs in test.inputs.iter().filter(|_| !is_open) {
                let Some((file, base)) = source_of(inputs, sources, files, diagnostics) else { continue };
                let text = match inputs.is_file {
                    true => sources.file(file).text(),
                    false => inputs.text.text.as_str(),
                };
                let (read, found) = parse_script_at(program, id, (file, base), text);
                diagnostics.append(found);
                for step in read.steps {
                    script.get_or_insert_default().push(&step.input, step.count);
                }
            }
            let claims = test.claims.iter().map(|claim| TestClaim {
                predicate: one_line(sources, claim.predicate),
                kind: kind(claim, sources),
                at: claim.span,
                text: one_line(sources, claim.span),
            });
            cases.push(TestCase {
                world: id,
                world_name: world_name.clone(),
                name: test.name.text.to_string(),
                script,
                seed: test.seed,
                claims: claims.collect(),
                at: test.name.span,
            });
        }
    }
    cases
}

/// The tests of a world, as they are checked.
pub(super) struct WorldTests {
    world: WorldId,
    name: String,
    tests: Vec<checked::Test>,
}

/// The tests of the worlds of a file.
pub(super) fn checked_tests(checked: &checked::Checked, file: Option<FileId>) -> Vec<WorldTests> {
    let has_tests = |world: &World| !world.tests.is_empty() && Some(world.name.span.file()) == file;
    let worlds = checked.worlds.pairs().filter(|(_, world)| has_tests(world));
    let of = |(id, world): (WorldId, &World)| WorldTests {
        world: id,
        name: world.name.text.to_string(),
        tests: world.tests.clone(),
    };
    worlds.map(of).collect()
}

fn kind(claim: &checked::Claim, sources: &SourceMap) -> TestClaimKind {
    match &claim.kind {
        ClaimKind::Expect(when) => TestClaimKind::Expect(*when),
        ClaimKind::Search { kind, without, within } => TestClaimKind::Search(TestSearch {
            kind: *kind,
            without: without.map(|(at, _)| one_line(sources, at)),
            is_needed: without.is_some_and(|(_, is_needed)| is_needed),
            within: *within,
        }),
    }
}

/// The file of a script, and where it begins there; reports a file that cannot be read.
fn source_of(
    inputs: &TestInputs,
    sources: &mut SourceMap,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<(FileId, usize)> {
    let at = inputs.text.span;
    if !inputs.is_file {
        // After the quote.
        return Some((at.file(), at.range().start + 1));
    }
    if sources.is_full() {
        diagnostics.report(TooMany::sources(at));
        return None;
    }
    let folder = sources.file(at.file()).path.parent().unwrap_or(Path::new("")).to_path_buf();
    let path = folder.join(inputs.text.text.as_str());
    if let Some((known, _)) = sources.iter().find(|(_, file)| file.path == path) {
        return Some((known, 0));
    }
    match files.read(&path) {
        Ok(text) => Some((sources.add(&path, text), 0)),
        Err(error) => {
            diagnostics.report(Unreadable { path, import: Some(at), error });
            None
        }
    }
}

/// The text of a span on one line, without comments.
fn one_line(sources: &SourceMap, span: Span) -> String {
    let mut words: Vec<&str> = Vec::new();
    for line in sources.slice(span).lines() {
        let is_quoted = |at: usize| line.get(..at).is_some_and(|before| before.matches('"').count() % 2 == 1);
        let comment = line.match_indices("//").map(|(at, _)| at).find(|at| !is_quoted(*at));
        words.extend(line.get(..comment.unwrap_or(line.len())).unwrap_or(line).split_whitespace());
    }
    words.join(" ")
}

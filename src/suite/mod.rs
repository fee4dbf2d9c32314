//! Tests of worlds: each is run and asked, and its result is a record of plain data. [`run_test`] does one test; the command
//! line runs many of them in parallel, shows them and keeps the ways that were found.
//!
//! A claim about the run of a test's inputs is answered by the simulator. A claim about all runs is the same question as one
//! of `hypedc reach`: the predicate is added to the world as a goal or a `never`, and [`crate::reach::query`] answers it.
//! The program of the other tests and of all runs does not know these predicates.
//!
//! | file | holds |
//! |---|---|
//! | `record` | results of tests and claims |
//! | `result` | the result of all tests |
//! | `run` | the run of a test's inputs, and the claims about it |
//! | `search` | the claims about all runs |
//! | `ways` | ways that were found before |
//! | `insert` | a test that is written into the text of a program |
//! | `lcov` | coverage in the form that editors read |
//! | `junit` | results in the form that build servers read |

mod insert;
#[cfg(feature = "cli")]
mod junit;
mod lcov;
mod record;
mod result;
mod run;
mod search;
mod ways;

use std::path::Path;
use std::sync::Arc;

use crate::compile::{
    Changes, Compilation, ExtraConstraint, ExtraQuestion, LevelFile, NumberSetting, TestCase, TestClaimKind,
    compile_changed,
};
use crate::ir::Program;
use crate::sim::{Script, Simulator};
use crate::source::{Files, SourceMap};
use crate::watch::Watch;
use crate::why::{Covered, place};

pub use insert::{Recorded, insert_test};
#[cfg(feature = "cli")]
pub use junit::junit;
pub use lcov::lcov;
pub use record::{ClaimResult, TestResult};
#[cfg(feature = "testing")]
pub use result::suite_schema;
pub use result::{CoverageResult, SuiteResult};
pub use ways::{NoWays, WayName, Ways};

/// The program that is tested.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Its file.
    pub file: &'a Path,
    /// The level of worlds that leave their map open.
    pub level: LevelFile<'a>,
    /// Numbers that are set.
    pub numbers: &'a [NumberSetting<'a>],
    /// Where files are read from.
    pub files: &'a (dyn Files + Sync),
}

impl Subject<'_> {
    /// Compiles it with some questions.
    fn compile(&self, questions: &[ExtraQuestion<'_>], constraint: Option<ExtraConstraint<'_>>) -> Compilation {
        let changes = Changes { questions, constraint, numbers: self.numbers };
        compile_changed(self.file, self.level, &changes, self.files)
    }
}

/// How tests are run.
#[derive(Clone, Copy)]
pub struct TestOptions<'a> {
    /// Maximum number of nodes of each search.
    pub nodes: u64,
    /// The seed of searches.
    pub seed: u64,
    /// Whether runs and ways are observed for the coverage.
    pub covers: bool,
    /// The ways that were found before.
    pub ways: &'a dyn Ways,
}

/// What came of a test.
#[derive(Debug, Clone)]
pub struct Tested {
    /// The result.
    pub result: TestResult,
    /// What its runs and the ways that were found cover, if that is asked for.
    pub covered: Option<Covered>,
}

/// The name of the source of a test's questions.
pub(crate) const ORIGIN: &str = "test";

/// Runs a test of a program that compiled.
pub fn run_test(
    subject: &Subject<'_>,
    (program, sources): (&Arc<Program>, &SourceMap),
    case: &TestCase,
    options: &TestOptions<'_>,
    watch: &dyn Watch,
) -> Tested {
    let mut result = TestResult::new(subject.file, case, place(sources, case.at));
    let mut ways: Vec<(u64, Script)> = Vec::new();
    let has_run = case.claims.iter().any(|claim| matches!(claim.kind, TestClaimKind::Expect(_)));
    let mut expected = Vec::new().into_iter();
    if has_run {
        let ran = run::run(subject, case, sources, watch);
        result.problems = ran.problems;
        result.steps = Some(ran.steps);
        ways.push((ran.steps, case.script.clone().unwrap_or_default()));
        expected = ran.claims.into_iter();
    }
    for claim in &case.claims {
        let answered = match &claim.kind {
            TestClaimKind::Expect(_) => expected.next(),
            TestClaimKind::Search(search) => {
                let (answered, found) = search::search(subject, case, (claim, search), options, sources, watch);
                ways.extend(found.into_iter().map(|script| (script.len(), script)));
                Some(answered)
            }
        };
        result.claims.extend(answered);
    }
    // A test that was broken off claims what nobody has checked.
    result.passed = result.problems.is_empty()
        && result.claims.len() == case.claims.len()
        && result.claims.iter().all(|claim| claim.passed);
    let covered = options.covers.then(|| {
        let (sim, mut covered) = (Simulator::new(program, case.world), Covered::new(program));
        for (steps, script) in &ways {
            covered.add_run(&sim, sources, (script, case.seed.unwrap_or_default()), *steps);
        }
        covered
    });
    Tested { result, covered }
}

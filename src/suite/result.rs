//! The result of all tests as a record, from which JSON and text are made.

use serde::Serialize;

use crate::why::{EdgeCoverage, ModeCoverage, PlaceCoverage};

use super::record::TestResult;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// What came of all tests.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SuiteResult {
    /// The version of this format.
    pub version: u32,
    /// The version of the command.
    pub hypedc: String,
    /// The seed of searches.
    pub seed: u64,
    /// Maximum number of nodes for each claim that is searched.
    pub nodes: u64,
    /// Number of tests that passed.
    pub passed: usize,
    /// Number of tests that failed.
    pub failed: usize,
    /// Number of tests that were not chosen.
    pub filtered: usize,
    /// Number of tests that were not run, because the command was stopped.
    pub not_run: usize,
    /// The tests, in the order of files and texts.
    pub tests: Vec<TestResult>,
    /// What was covered; left out if that is not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<CoverageResult>,
    /// How long it took, s.
    pub seconds: f64,
}

impl SuiteResult {
    /// A result without tests.
    pub fn new(seed: u64, nodes: u64, filtered: usize) -> Self {
        SuiteResult {
            version: RESULT_VERSION,
            hypedc: env!("CARGO_PKG_VERSION").to_string(),
            seed,
            nodes,
            passed: 0,
            failed: 0,
            filtered,
            not_run: 0,
            tests: Vec::new(),
            coverage: None,
            seconds: 0.0,
        }
    }

    /// Adds a test.
    pub fn add(&mut self, test: TestResult) {
        self.passed += usize::from(test.passed);
        self.failed += usize::from(!test.passed);
        self.tests.push(test);
    }
}

/// What the runs of the tests and the ways that they found cover.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct CoverageResult {
    /// Number of runs: those of inputs, and the ways that were found.
    pub runs: u64,
    /// Number of steps of all of them.
    pub steps: u64,
    /// The modes of the entities that the tested worlds have instances of, in the order of the text.
    pub modes: Vec<ModeCoverage>,
    /// The edges of these entities, in the order of the text.
    pub edges: Vec<EdgeCoverage>,
}

impl CoverageResult {
    /// The modes and edges of a coverage.
    pub fn new(coverage: &PlaceCoverage) -> Self {
        CoverageResult {
            runs: coverage.runs,
            steps: coverage.steps,
            modes: coverage.modes().cloned().collect(),
            edges: coverage.edges().cloned().collect(),
        }
    }
}

/// The schema of the JSON result.
#[cfg(feature = "testing")]
pub fn suite_schema() -> schemars::Schema {
    schemars::schema_for!(SuiteResult)
}

//! The results of tests, as records of plain data.

use std::path::Path;

use serde::Serialize;

use crate::compile::{TestCase, TestClaim};
use crate::reach::Conclusion;
use crate::source::Span;
use crate::why::{Atom, Place};

/// What came of a test.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TestResult {
    /// The file.
    pub file: String,
    /// The world.
    pub world: String,
    /// Its name.
    pub test: String,
    /// Its name in the text.
    pub place: Place,
    /// Whether all of its claims are so, and its run ended as it should.
    pub passed: bool,
    /// Why the run of its inputs is no good run, a sentence each.
    pub problems: Vec<String>,
    /// Number of steps of the run; null if it has none.
    pub steps: Option<u64>,
    /// What came of each claim, in source order.
    pub claims: Vec<ClaimResult>,
    /// How long it took, s.
    pub seconds: f64,
    /// The place for findings.
    #[serde(skip)]
    pub at: Span,
}

impl TestResult {
    /// A test that has not run yet.
    pub(super) fn new(file: &Path, case: &TestCase, place: Place) -> Self {
        TestResult {
            file: file.display().to_string(),
            world: case.world_name.clone(),
            test: case.name.clone(),
            place,
            passed: false,
            problems: Vec::new(),
            steps: None,
            claims: Vec::new(),
            seconds: 0.0,
            at: case.at,
        }
    }
}

/// What came of a claim.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ClaimResult {
    /// The claim as it is written.
    pub claim: String,
    /// Its place.
    pub place: Place,
    /// Whether it is so. What is not known is not so.
    pub passed: bool,
    /// What was found out, in words.
    pub answer: String,
    /// The verdict of the search; null for a claim about the run.
    pub verdict: Option<Conclusion>,
    /// The step that decides: after it the predicate holds, or does not; of a search, the last step of the way.
    pub step: Option<u64>,
    /// Why it is so, a sentence each.
    pub reasons: Vec<String>,
    /// The parts of the predicate after that step of the run, if the claim is not so.
    pub parts: Vec<Atom>,
    /// The way that was found, as an input script.
    pub inputs: Option<String>,
    /// The place for findings.
    #[serde(skip)]
    pub at: Span,
}

impl ClaimResult {
    /// A claim that is not answered yet.
    pub(super) fn new(claim: &TestClaim, place: Place) -> Self {
        ClaimResult {
            claim: claim.text.clone(),
            place,
            passed: false,
            answer: String::new(),
            verdict: None,
            step: None,
            reasons: Vec::new(),
            parts: Vec::new(),
            inputs: None,
            at: claim.at,
        }
    }
}

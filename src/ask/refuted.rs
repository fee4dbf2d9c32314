//! A run into a state that the analysis excludes, as a record: the analysis is wrong about this world, which is a bug of
//! `hypedc`, and its proofs are withdrawn.

use std::path::PathBuf;

use serde::Serialize;

use crate::analysis::Beyond;
use crate::ir::{Program, WorldId};
use crate::reach::Refutation;

/// A run that refutes the analysis, as results have it.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Refuted {
    /// The instance.
    pub instance: String,
    /// Its active modes.
    pub modes: Vec<String>,
    /// What is as it never is.
    pub beyond: Vec<BeyondResult>,
    /// Number of steps.
    pub steps: u64,
    /// The inputs, as a script.
    pub inputs: String,
    /// Where all that is needed to see it again was written; null if it could not be.
    pub file: Option<PathBuf>,
    /// What is outside, in words.
    #[serde(skip)]
    pub what: String,
}

/// A number that is as it never is.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct BeyondResult {
    /// The variable.
    pub variable: String,
    /// Its value.
    pub value: String,
    /// The values that the analysis allows.
    pub allowed: String,
}

impl Refuted {
    /// Creates the report without a file.
    pub fn new(program: &Program, world: WorldId, refutation: &Refutation) -> Self {
        let Refutation { script, steps, outside } = refutation;
        let beyond = outside.beyond.iter().map(|Beyond { variable, value, allowed }| BeyondResult {
            variable: variable.clone(),
            value: value.clone(),
            allowed: allowed.clone(),
        });
        Refuted {
            instance: outside.instance.clone(),
            modes: outside.modes.clone(),
            beyond: beyond.collect(),
            steps: *steps,
            inputs: script.text(program, world),
            file: None,
            what: outside.to_string(),
        }
    }
}

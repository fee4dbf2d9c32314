//! The result of `hypedc tune` as a record, and as CSV.

use serde::Serialize;

use crate::reach::query::ProofMethod;
use crate::tabular::csv;
use crate::tune::{Axis, Change, Part, Trial};

use crate::cli::reach::refuted::Refuted;

/// The version of the JSON result.
pub(super) const RESULT_VERSION: u32 = 1;

/// The smallest change that turns an answer.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct TuneResult {
    /// The version of this format.
    pub version: u32,
    /// The path of the program.
    pub file: String,
    /// The world.
    pub world: String,
    /// A hash of what the program as it is means.
    pub program_sha256: String,
    /// Numbers of the program that were set.
    pub set: Vec<String>,
    /// The goal.
    pub goal: String,
    /// Whether a change is sought with which the goal is proven unreachable.
    pub prevent: bool,
    /// What must never hold on a path; null if anything may.
    pub without: Option<String>,
    /// The scripts in whose last states the paths begin; if empty, in the initial state.
    pub after: Vec<String>,
    /// The seed of the searches.
    pub seed: u64,
    /// The limit of nodes for each value.
    pub nodes_limit: u64,
    /// The limit of time for each value, s; null without a limit.
    pub seconds_limit: Option<f64>,
    /// The numbers that are varied.
    pub numbers: Vec<Axis>,
    /// All values that were tried; the first are what the program has.
    pub trials: Vec<Trial>,
    /// Parts of the range of a number that are proven as a whole.
    pub parts: Vec<Part>,
    /// The smallest change that was found; null if there is none, or if none is needed.
    pub change: Option<Change>,
    /// The change as arguments of `--set`.
    pub change_set: Vec<String>,
    /// Whether the program as it is has the wanted answer.
    pub is_wanted_already: bool,
    /// Whether it was stopped before its end.
    pub stopped: bool,
    /// A run that shows that the analysis is wrong, a mistake of `hypedc`; null if none has. Nothing is proven then.
    pub refuted: Option<Refuted>,
    /// The duration, s.
    pub seconds: f64,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(TuneResult)
}

/// A line for each value that was tried.
pub(super) fn csv_text(result: &TuneResult) -> String {
    let names = result.numbers.iter().map(|axis| axis.name.as_str());
    let rest = ["goal", "verdict", "is_wanted", "steps", "seconds_of_play", "proven_by", "nodes", "inputs", "error"];
    let mut out = csv::line(names.chain(rest)) + "\n";
    for trial in &result.trials {
        let mut cells: Vec<String> = trial.values.iter().map(|value| Axis::text(*value)).collect();
        let text = |text: Option<String>| text.unwrap_or_default();
        cells.extend([
            result.goal.clone(),
            trial.verdict.name().to_string(),
            trial.is_wanted.to_string(),
            text(trial.steps.map(|steps| steps.to_string())),
            text(trial.seconds_of_play.map(|seconds| seconds.to_string())),
            text(trial.proven_by.map(|by: ProofMethod| by.name().to_string())),
            trial.nodes.to_string(),
            text(trial.inputs.clone()),
            text(trial.error.clone()),
        ]);
        out.push_str(&csv::line(cells));
        out.push('\n');
    }
    out
}

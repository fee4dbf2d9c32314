//! The results of a search for a change, as plain data.

use serde::{Deserialize, Serialize};

use crate::reach::query::ProofMethod;
use crate::reach::{Conclusion, Luck, Refutation};

use super::Built;
use super::axis::Axis;

/// What came of some values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Trial {
    /// The value of each number.
    pub values: Vec<f64>,
    /// The verdict about the goal.
    pub verdict: Conclusion,
    /// Whether this is the wanted answer, and no `never` is known to be broken.
    pub is_wanted: bool,
    /// The number of steps of the path; null if there is none.
    pub steps: Option<u64>,
    /// The duration of the path in the world, s; null if there is none.
    pub seconds_of_play: Option<f64>,
    /// The path, as an input script that was replayed with these values; null if there is none.
    pub inputs: Option<String>,
    /// The luck that the path needs; left out in a world without chances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub luck: Option<Luck>,
    /// If the path was found at other values: the index of that trial.
    pub path_of: Option<usize>,
    /// How it was proven that there is no way; null if it was not.
    pub proven_by: Option<ProofMethod>,
    /// Why there is no way, a sentence each.
    pub reasons: Vec<String>,
    /// Nodes of all trees that were grown.
    pub nodes: u64,
    /// The `never`s that must hold, where the answer has turned.
    pub nevers: Vec<NeverTrial>,
    /// Why there is no verdict: what is wrong with the program with these values.
    pub error: Option<String>,
}

/// What is known of a `never`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct NeverTrial {
    /// Its name.
    pub name: String,
    /// The verdict about it.
    pub verdict: Conclusion,
}

/// Values of one number, the others as the program has them, all of which are proven by one argument.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Part {
    /// The index of the number.
    pub number: usize,
    /// The least value.
    pub from: f64,
    /// The greatest value: the goal is proven unreachable for it, the least one, and each number between them.
    pub to: f64,
}

/// A change that turns the answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Change {
    /// The index of the trial with these values.
    pub trial: usize,
    /// Its size: the greatest change of a number, relative to what the program has.
    pub size: f64,
    /// The index of the trial with the next smaller change of the same numbers that was tried; it does not turn the answer.
    pub before: usize,
    /// Whether it is proven that no smaller change of one number alone turns the answer, up to that trial.
    pub is_proven_smallest: bool,
}

/// What is known of a question about changes.
#[derive(Debug, Default)]
pub struct Tuned {
    /// The numbers.
    pub axes: Vec<Axis>,
    /// All values that were tried; the first are what the program has.
    pub trials: Vec<Trial>,
    /// The values that are proven as a whole, in order.
    pub parts: Vec<Part>,
    /// The smallest change that was found; none if there is none, or if the program already has the wanted answer.
    pub change: Option<Change>,
    /// Whether it was stopped before its end.
    pub is_stopped: bool,
    /// A run that shows that the analysis is wrong, with its program: nothing is proven then.
    pub refuted: Option<(Refutation, Built)>,
}

impl Tuned {
    /// Whether the program as it is has the wanted answer.
    pub fn is_wanted_already(&self) -> bool {
        self.trials.first().is_some_and(|trial| trial.is_wanted)
    }
}

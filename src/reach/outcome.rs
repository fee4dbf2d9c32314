//! How a search ends, and what it took.

use crate::sim::{Fault, Script};

use super::proof::Proof;

/// The answer to "can this goal be reached?".
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Yes, by this plan, which was replayed.
    Reached(Plan),
    /// Nothing was found within the budget; this proves nothing.
    NotFound,
    /// No, and this is why; nothing was searched.
    Unreachable(Proof),
}

/// A way to a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The inputs from the initial state on; the goal holds after the last step.
    pub script: Script,
    /// How many steps they last.
    pub steps: u64,
}

/// What a search did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Statistics {
    /// Nodes over all trees, roots included.
    pub nodes: u64,
    /// Trees begun.
    pub trees: u64,
    /// Extensions simulated.
    pub extensions: u64,
    /// Extensions that ended in a `never`, out of bounds or in a fault.
    pub failures: u64,
    /// Steps simulated.
    pub steps: u64,
}

/// The end of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The answer.
    pub verdict: Verdict,
    /// What it took.
    pub statistics: Statistics,
    /// Whether the watch ended it before the budget did.
    pub stopped: bool,
    /// Whether some combinations of inputs were left out because there are too many.
    pub truncated: bool,
    /// The first run-time error met, with the step of its path (from 1): a mistake of the program.
    pub fault: Option<(Fault, u64)>,
}

impl Outcome {
    /// A verdict before any work.
    pub(super) fn of(verdict: Verdict) -> Self {
        Outcome { verdict, statistics: Statistics::default(), stopped: false, truncated: false, fault: None }
    }
}

//! Experiments: planners run many times on questions, and tables of their success rates and costs.
//!
//! A [`Design`] has every [`Setup`] with every seed on every [`Question`]. [`conduct`] runs it on several threads and
//! returns plain [`Run`]s in a fixed order; a [`Report`] makes rows, tables and JSON of them. [`paper`] holds the
//! experiment of Osborn, Lambrigger and Mateas, *HyPED: Modeling and Analyzing Action Games as Hybrid Systems*, AIIDE
//! 2017. The caller provides the clock.

mod conduct;
mod design;
mod formats;
pub mod paper;
mod report;
mod row;

pub use conduct::{Clock, RunError, conduct};
pub use design::{Design, Question, Setup};
pub use formats::{CSV_HEADER, csv_line};
pub use report::Report;
pub use row::{Row, Spread};

use crate::reach::Conclusion;

/// The outcome of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// A path to the goal was found.
    Reached,
    /// The budget of time or nodes is spent.
    NotFound,
    /// The memory is full before the budget is spent.
    OutOfMemory,
    /// An exhaustive search proves that there is no path.
    Unreachable,
    /// All states were visited that are reachable with axes at -1, 0 and 1; values between matter.
    Exhausted,
}

impl Finding {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Finding::Reached => Conclusion::Reached.name(),
            Finding::NotFound => Conclusion::NotFound.name(),
            Finding::OutOfMemory => "out-of-memory",
            Finding::Unreachable => Conclusion::ProvenUnreachable.name(),
            Finding::Exhausted => Conclusion::Exhausted.name(),
        }
    }
}

/// The result of one search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// The index of the question.
    pub question: usize,
    /// The index of the setup.
    pub setup: usize,
    /// Its seed.
    pub seed: u64,
    /// The outcome.
    pub finding: Finding,
    /// Nodes over all trees, roots included.
    pub nodes: u64,
    /// Trees started.
    pub trees: u64,
    /// Extensions simulated.
    pub extensions: u64,
    /// Steps simulated.
    pub steps: u64,
    /// Duration of the search by the clock, seconds, without the analysis of the world.
    pub seconds: f64,
    /// Number of steps of the path.
    pub path_steps: Option<u64>,
}

//! Experiments: planners run many times over questions, and tables of how often and how soon they reached the goal.
//!
//! A [`Design`] says what is run: every [`Setup`] with every seed on every [`Question`]. [`conduct`] runs it on several
//! threads and gives plain [`Run`]s in a fixed order; a [`Report`] makes rows, tables and JSON of them. [`paper`] holds
//! the experiment of Osborn, Lambrigger and Mateas, *HyPED: Modeling and Analyzing Action Games as Hybrid Systems*,
//! AIIDE 2017. Who calls brings the clock.

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

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// With a way to the goal.
    Reached,
    /// With its budget of time or nodes spent.
    NotFound,
    /// With its memory full before its budget was spent.
    OutOfMemory,
    /// With a proof, by trying all there is, that there is no way.
    Unreachable,
    /// All states were visited that inputs with axes at -1, 0 and 1 lead to; values between make a difference.
    Exhausted,
}

impl Finding {
    /// As it is written in results.
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

/// What came of one search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Which of the questions it was about.
    pub question: usize,
    /// Which of the design's setups it used.
    pub setup: usize,
    /// Its seed.
    pub seed: u64,
    /// How it ended.
    pub finding: Finding,
    /// Nodes over all trees, roots included.
    pub nodes: u64,
    /// Trees begun.
    pub trees: u64,
    /// Extensions simulated.
    pub extensions: u64,
    /// Steps simulated.
    pub steps: u64,
    /// Seconds of the clock that the search took, the analysis of the world not included.
    pub seconds: f64,
    /// How many steps the way to the goal takes.
    pub path_steps: Option<u64>,
}

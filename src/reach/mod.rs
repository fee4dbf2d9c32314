//! Reachability: can the player bring about a goal, and how?
//!
//! One loop ([`search`]) owns sampling, simulation, the tree and the budget; what a published planner adds is a small
//! strategy of two methods, in a file of its own. A found path is replayed in the simulator before it is reported.

mod controls;
mod metric;
mod nearest;
mod outcome;
mod problem;
mod region;
mod rrt;
mod search;
mod strategy;
mod tree;

pub use controls::{ControlSets, MAX_CONTROLS};
pub use metric::{Coordinate, Metric, Point, Quantity};
pub use nearest::Linear;
pub use outcome::{Outcome, Plan, Statistics, Verdict};
pub use problem::{Problem, Standing};
pub use rrt::Rrt;
pub use search::{Limits, Settings, search};
pub use strategy::{Choice, Growth, Strategy};
pub use tree::{NodeId, Tree};

use crate::sim::Fault;
use crate::watch::Watch;

/// Looks for a way to the problem's goal with the plain RRT.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn reach(problem: &Problem<'_>, settings: &Settings, limits: &Limits, watch: &dyn Watch) -> Result<Outcome, Fault> {
    let metric = Metric::new(problem.sim);
    let mut strategy = Rrt::new(&metric);
    search(problem, &metric, &mut strategy, settings, limits, watch)
}

//! Reachability: can the player bring about a goal, and how?
//!
//! The analysis is asked first: a goal that holds in no state that it allows is proven unreachable. It allows all that
//! a search could come to, since both end a run where a player leaves the bounds of its space.
//!
//! One loop ([`search`]) owns sampling, simulation, the tree and the budget; what a published planner adds is a small
//! strategy of two methods, in a file of its own. A found path is replayed in the simulator before it is reported.

mod bounds;
mod controls;
mod draw;
mod metric;
mod nearest;
mod outcome;
mod problem;
mod proof;
mod region;
mod rrt;
mod search;
mod strategy;
mod tree;

pub use bounds::Sampling;
pub use controls::{ControlSets, MAX_CONTROLS};
pub use metric::{Coordinate, Metric, Point, Quantity};
pub use nearest::{Index, Neighbour};
pub use outcome::{Outcome, Plan, Statistics, Verdict};
pub use problem::{Problem, Standing};
pub use proof::{Part, Proof};
pub use rrt::Rrt;
pub use search::{Limits, Settings, search};
pub use strategy::{Choice, Growth, Strategy};
pub use tree::{NodeId, Tree};

use crate::analysis::ConfigurationSpace;
use crate::sim::Fault;
use crate::watch::Watch;

/// Asks the analysis whether the goal can hold at all; if so, looks for a way to it with the plain RRT.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn reach(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    if let Some(proof) = Proof::of(problem, space) {
        problem.sim.initial(&mut problem.sim.scratch())?;
        return Ok(Outcome::of(Verdict::Unreachable(proof)));
    }
    let metric = Metric::new(problem.sim, space, settings.sampling);
    let mut strategy = Rrt::new(&metric);
    search(problem, &metric, &mut strategy, settings, limits, watch)
}

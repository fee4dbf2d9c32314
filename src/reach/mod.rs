//! Reachability: can the player bring about a goal, and how?
//!
//! The analysis is asked first: a goal that holds in no state that it allows is proven unreachable. It allows all that
//! a run could come to: both end one where a player leaves the bounds that are written for its space. Where there are none,
//! a search stops at a window of its own (`window.rs`), and proves nothing if it did.
//!
//! Then searchers grow trees of states ([`search`]). Those that sample share one loop (`sampler.rs`), to which a planner
//! adds a strategy (`planners/`); `exhaustive.rs` visits each state once and can prove a "no"; `portfolio.rs` lets several
//! take turns. A found path is replayed in the simulator before it is reported, and can be made faster (`hasten.rs`) and simpler
//! (`shorten.rs`).
//!
//! Every state that is made on the way is held against what the analysis says (`guard.rs`). One that lies outside shows that
//! the analysis is wrong about this world: no proof that rests on it is given then.

mod bounds;
mod controls;
mod coverage;
mod distance;
mod draw;
mod exhaustive;
mod ground;
mod guard;
mod hasten;
mod metric;
mod nearest;
mod outcome;
mod planners;
mod portfolio;
mod problem;
mod proof;
mod region;
mod sampler;
mod search;
mod searcher;
mod shorten;
mod strategy;
mod tree;
mod whereabouts;
mod window;

pub use bounds::Sampling;
pub use controls::MAX_CONTROLS;
pub use coverage::{Count, Covered, PLACE};
pub use guard::{Guard, Refutation};
pub use hasten::hasten;
pub use metric::{Coordinate, Measure, Metric, Point, Quantity};
pub use nearest::{Index, Neighbour};
pub use outcome::{Argument, Cut, End, Outcome, Plan, Statistics, Verdict, Visited};
pub use planners::Planner;
pub use problem::{BadStart, Death, Problem, Standing, Start, Target};
pub use proof::{Part, Proof};
pub use search::{Limits, Restart, Settings, search};
pub use shorten::shorten;

use crate::analysis::ConfigurationSpace;
use crate::sim::Fault;
use crate::watch::{Meter, Watch};

use guard::guarded;

/// Asks the analysis whether what is asked for can hold at all; if so, searches for a way to it.
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
    guarded(problem, space, settings, |problem| {
        let Some(proof) = Proof::of(problem, space) else {
            return search(problem, space, settings, limits, watch);
        };
        let starts = problem.starts()?;
        let mut outcome = Outcome::of(Verdict::Unreachable(Argument::Analysis(proof)), "analysis");
        if let Some(guard) = problem.guard() {
            starts.iter().for_each(|start| guard.follow(problem, &start.script, &Meter::new(watch)));
            outcome.refute_by(guard);
        }
        Ok(outcome)
    })
}

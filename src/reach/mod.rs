//! Reachability: can the player bring about a goal, and how?
//!
//! The analysis is asked first: a goal that holds in no state that it allows is proven unreachable. It allows all that
//! a run could come to: both end one where a player leaves the bounds that are written for its space. Where there are none,
//! a search stops at a window of its own (`window.rs`), and proves nothing if it did.
//!
//! It is also asked how soon a goal can hold at the earliest, where there is a time to keep.
//!
//! Then searchers grow trees of states ([`search`]). Those that sample share one loop (`sampler.rs`), to which a planner
//! adds a strategy (`planners/`); `exhaustive.rs` visits each state once and can prove a "no"; `portfolio.rs` lets several
//! take turns. A found path is replayed in the simulator before it is reported, and can be made faster (`improve_duration.rs`) and simpler
//! (`shorten.rs`); what is found for one question can answer another one (`exchange.rs`). [`query`] does all of this in a row.
//!
//! Every state that is made on the way is checked against what the analysis says (`guard.rs`). One that lies outside shows that
//! the analysis is wrong about this world: no proof that rests on it is given then.

mod bounds;
mod conclusion;
mod controls;
mod coverage;
mod distance;
mod draw;
mod exchange;
mod exhaustive;
mod guard;
mod improve_duration;
mod metric;
mod nearest;
mod outcome;
mod planners;
mod portfolio;
mod problem;
mod proof;
pub mod query;
mod region;
mod sampler;
mod seam;
mod search;
mod search_context;
mod searcher;
mod shorten;
mod strategy;
mod tree;
mod whereabouts;
mod window;

pub use bounds::Sampling;
pub use conclusion::Conclusion;
pub use controls::MAX_CONTROLS;
pub use coverage::{Count, Covered, PLACE};
pub use exchange::passed;
pub use guard::{Guard, Refutation};
pub use improve_duration::improve_duration;
pub use metric::{Coordinate, Measure, Metric, Point, Quantity};
pub use nearest::{Index, Neighbour};
pub use outcome::{Argument, Cut, End, Exhaustion, Outcome, Plan, Statistics, Verdict, Visited};
pub use planners::Planner;
pub use problem::{BadStart, Problem, Start, StateStatus, Target, Termination};
pub use proof::{Part, Proof, TooFar};
pub use search::{Limits, Restart, Settings, search};
pub use shorten::shorten;

use crate::analysis::{ConfigurationSpace, endless, watched_space};
use crate::ir::ExprId;
use crate::sim::Fault;
use crate::watch::{Meter, Watch};

use guard::guarded;

/// Nodes of a first glance: what is found within them needs no closer look by the analysis.
const GLANCE: u64 = 4_000;

/// Asks the analysis whether what is asked for can hold at all; if so, searches for a way to it. What a glance does not find
/// is examined more closely before the search goes on: by place, which takes longer (only where the planner is `auto`).
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
        let mut outcome = reach_guarded(problem, space, settings, limits, watch)?;
        if let Some(guard) = problem.guard() {
            if outcome.rests_on_analysis() {
                let starts = problem.starts(watch)?.unwrap_or_default();
                starts.iter().for_each(|start| guard.follow(problem, &start.script, &Meter::new(watch)));
            }
            outcome.refute_by(guard);
        }
        Ok(outcome)
    })
}

fn reach_guarded(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    let (program, world) = (problem.sim.program(), problem.sim.world_id());
    // A goal counts as long as a run has not ended; a `never` in the state that ends it, too.
    let endless = matches!(problem.target, Target::Never(_)).then(|| endless(program, world));
    let nevers: Vec<ExprId> = match endless {
        Some(_) => Vec::new(),
        None => problem.sim.world().nevers.iter().map(|never| never.holds).collect(),
    };
    let whole = endless.as_ref().map(|endless| watched_space(endless, world, &nevers, watch));
    let (of, whole) = (endless.as_ref().unwrap_or(program), whole.as_ref().unwrap_or(space));
    if let Some(proof) = Proof::of(problem, whole) {
        // Where it breaks a rule, there is nothing to ask.
        if problem.starts(watch)?.is_none() {
            return Ok(Outcome::stopped(settings.planner));
        }
        return Ok(Outcome::of(Verdict::Unreachable(Argument::Analysis(proof)), "analysis"));
    }
    if let Some(far) = TooFar::of(problem, space, watch)? {
        return Ok(Outcome::of(Verdict::Unreachable(Argument::Distance(far)), "analysis"));
    }
    if settings.planner == Planner::Auto && limits.nodes > GLANCE {
        let glance = search(problem, space, settings, &Limits { nodes: GLANCE, ..*limits }, watch)?;
        if glance.verdict != Verdict::NotFound || glance.end != End::Nodes {
            return Ok(glance);
        }
        let closer = whole.clone().by_place(of, world, &nevers, watch);
        if let Some(proof) = Proof::of(problem, &closer) {
            if let Some(guard) = problem.guard() {
                // What the glance saw was checked against less than the proof rests on: it is examined again.
                let closely = Guard::new(&closer, program, world);
                let again = problem.clone().guarded(&closely);
                search(&again, space, settings, &Limits { nodes: GLANCE, ..*limits }, watch)?;
                closely.refutation().into_iter().for_each(|refutation| guard.note(refutation));
            }
            return Ok(Outcome::of(Verdict::Unreachable(Argument::Analysis(proof)), "analysis"));
        }
    }
    search(problem, space, settings, limits, watch)
}

//! Reachability: can the player bring about a goal, and how?
//!
//! The analysis comes first: a goal that holds in no state of the configuration space is proven unreachable. The space
//! contains every state of a run until a player leaves the written bounds of its space. Without bounds, a search stops
//! at a window (`window.rs`), and proves nothing if it did.
//!
//! With a time limit, it also bounds from below the time at which a goal can hold.
//!
//! Then searchers grow trees of states ([`search`]). Sampling searchers share one loop (`sampler.rs`), to which a
//! planner adds a strategy (`planners/`); `exhaustive.rs` visits each state once and can prove a "no"; `portfolio.rs`
//! alternates several. Where `auto` finds nothing, `exact` visits all states in few bytes each. A path is replayed in
//! the simulator before it is reported, and can be made faster (`shortcuts.rs`, `improve_duration.rs`) and simpler
//! (`shorten.rs`); a path for one question can answer another one (`exchange.rs`). [`query`] runs all of this in order.
//!
//! Every state created on the way is checked against the analysis (`monitor.rs`). A state outside shows that the
//! analysis is wrong about this world: proofs that rest on it are withdrawn.

mod ahead;
mod around;
mod bounds;
mod conclusion;
mod controls;
mod coverage;
mod distance;
mod draw;
mod draw_input;
mod exact;
mod exchange;
mod exhaustive;
mod explore;
mod gates;
mod goal_positions;
mod improve_duration;
mod interval;
mod known_states;
mod ledges;
mod lost;
mod luck;
mod metric;
mod monitor;
mod nearest;
mod outcome;
mod packed_states;
mod planners;
mod portfolio;
mod probability;
mod problem;
mod proof;
pub mod query;
mod region;
mod restriction;
pub mod robust;
mod rounds;
mod sampler;
mod search;
mod search_context;
mod searcher;
mod settled;
mod shortcuts;
mod shorten;
mod stages;
mod start_hold;
mod strategy;
pub mod stuck;
mod style;
mod subgoals;
mod trail;
mod tree;
pub mod why_not;
mod window;

pub use crate::analysis::Part;
pub use bounds::Sampling;
pub use conclusion::{Conclusion, Shift};
pub use controls::MAX_CONTROLS;
pub use coverage::{Count, Covered, PLACE};
pub use exact::exhaust;
pub use exchange::plan_from_script;
pub use explore::{CoveredEntity, CoveredSpace, Explored, Explorer, Observer, Reached, Top};
pub use goal_positions::distance_to_goal;
pub use improve_duration::improve_duration;
pub use interval::wilson_95;
pub use metric::{Coordinate, Measure, Metric, Point, Quantity};
pub use monitor::{Monitor, Refutation};
pub use nearest::{Around, Index, Neighbour};
pub use outcome::{Argument, Cut, End, Exhaustion, Outcome, Plan, Statistics, Unfinished, Verdict, Visited};
pub use planners::Planner;
pub use probability::Luck;
pub use problem::{BadStart, Problem, Start, StateStatus, Target, Termination};
pub use proof::{Proof, TooFar, least_steps};
pub use search::{Limits, Restart, Settings, search};
pub use shortcuts::{Effort, take_shortcuts};
pub use shorten::shorten;
pub use style::{Style, improve_style};
pub use trail::{TileTrail, Trail};

use crate::analysis::{ConfigurationSpace, at_most, endless, watched_space};
use crate::ir::ExprId;
use crate::sim::Fault;
use crate::watch::{Meter, Watch};

use monitor::monitored;
use rounds::{GoOn, Interlude, Pause};
use search::search_asking;

/// When a search pauses for a finer analysis, by place: an answer within them needs none.
const BY_PLACE: Pause = Pause { nodes: 4_000, times: 1 };
/// When it pauses for one by the courses of falls, which alternates with it. What can be reached is come nearer to again
/// and again.
const BY_FLIGHT: Pause = Pause { nodes: 24_000, times: 4 };

/// Maximum number of configurations that are told apart by the courses of falls, for each node of the budget, and for each
/// node while the search is stuck, which may yet find a way: one costs as much as two nodes or more. Both are the same where
/// exhaustion is asked for.
const FLIGHTS: u64 = 2;
const FLIGHTS_WHEN_STUCK: u64 = 1;
const FLIGHTS_EXHAUSTING: u64 = 20;

/// Says yes so many times for each node of a search, which goes on whenever that is used up, and so many times at most.
fn alternating<'g>(nodes: u64, go_on: &'g mut GoOn<'_>, per_node: u64, most: u64) -> impl FnMut() -> bool + 'g {
    let (mut used, mut granted) = (0, nodes.saturating_mul(per_node).min(most));
    move || {
        if used == granted && granted < most {
            let nodes = go_on().unwrap_or(0);
            granted = granted.max(nodes.saturating_mul(per_node)).min(most);
        }
        let is_granted = used < granted;
        used += u64::from(is_granted);
        is_granted
    }
}

/// Asks the analysis whether the target can hold at all; if so, searches for a path to it. With the planner `auto`, a
/// search that has found nothing for a while pauses for an analysis that distinguishes players by place.
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
    monitored(problem, space, settings, |problem| {
        let mut outcome = reach_monitored(problem, space, settings, limits, watch)?;
        if let Some(monitor) = problem.monitor() {
            if outcome.rests_on_analysis() {
                let starts = problem.starts(watch)?.unwrap_or_default();
                starts.iter().for_each(|start| monitor.follow(problem, &start.script, &Meter::new(watch)));
            }
            outcome.refute_by(monitor);
        }
        Ok(outcome)
    })
}

fn reach_monitored(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    let (program, world) = (problem.sim.program(), problem.sim.world_id());
    // A goal counts until a run has ended; a `never` also counts in the state that ends it.
    let endless = matches!(problem.target, Target::Never(_)).then(|| endless(program, world));
    let nevers: Vec<ExprId> = match endless {
        Some(_) => Vec::new(),
        None => problem.rules(),
    };
    let whole = endless.as_ref().map(|endless| watched_space(endless, world, &nevers, watch));
    let (of, whole) = (endless.as_ref().unwrap_or(program), whole.as_ref().unwrap_or(space));
    if let Some(proof) = Proof::of(problem, whole) {
        // A faulty or stopped start has no answer.
        if problem.starts(watch)?.is_none() {
            return Ok(Outcome::stopped(settings.planner));
        }
        return Ok(Outcome::of(Verdict::Unreachable(Argument::Analysis(proof)), "analysis"));
    }
    if let Some(far) = TooFar::of(problem, space, watch)? {
        return Ok(Outcome::of(Verdict::Unreachable(Argument::Distance(far)), "analysis"));
    }
    let prove = |closer: ConfigurationSpace| -> Option<Proof> {
        let proof = Proof::of(problem, &closer)?;
        if let Some(monitor) = problem.monitor() {
            // The search was monitored against less than this proof rests on, so its beginning is repeated. A fault at
            // the start would have ended it already.
            let finer_monitor = Monitor::new(&closer, program, world);
            let again = problem.clone().monitored(&finer_monitor);
            let _ = search(&again, space, settings, &Limits { nodes: BY_PLACE.nodes, ..*limits }, watch);
            finer_monitor.refutation().into_iter().for_each(|refutation| monitor.note(refutation));
        }
        Some(proof)
    };
    // The engine of the page has no room for more.
    #[cfg(feature = "ask")]
    let proof_by_flight = |goes_on: &mut dyn FnMut() -> bool| -> Option<Proof> {
        prove(whole.clone().by_flight(of, world, &nevers, goes_on, watch))
    };
    #[cfg(not(feature = "ask"))]
    let proof_by_flight = |_: &mut dyn FnMut() -> bool| -> Option<Proof> { None };
    let [per_node, when_stuck] = match settings.exhausts {
        true => [FLIGHTS_EXHAUSTING; 2],
        false => [FLIGHTS, FLIGHTS_WHEN_STUCK],
    };
    let all_flights = limits.nodes.saturating_mul(per_node);
    let (mut proof, mut is_tried) = (None, false);
    let mut closer_proof = |pause: Pause, go_on: &mut GoOn<'_>| -> bool {
        proof = match pause {
            BY_PLACE => prove(whole.clone().by_place(of, world, &nevers, watch)),
            _ => {
                is_tried = true;
                proof_by_flight(&mut alternating(pause.nodes, go_on, when_stuck, all_flights))
            }
        };
        proof.is_some()
    };
    let pauses = [BY_PLACE, BY_FLIGHT];
    let is_auto = settings.planner == Planner::Auto && limits.nodes > BY_PLACE.nodes;
    let interlude = is_auto.then_some(Interlude { pauses: &pauses, ends: &mut closer_proof });
    let outcome = search_asking(problem, space, settings, limits, watch, interlude)?;
    if is_auto && proof.is_none() && !is_tried && outcome.is_open() {
        proof = proof_by_flight(&mut at_most(all_flights as usize));
    }
    if let Some(proof) = proof {
        let answer = Outcome::of(Verdict::Unreachable(Argument::Analysis(proof)), "analysis");
        let nearest = outcome.nearest.map(|nearest| nearest.sampled(outcome.statistics.nodes));
        return Ok(Outcome { nearest, ..answer });
    }
    #[cfg(feature = "ask")]
    if settings.planner == Planner::Auto && settings.exhausts {
        return exact::conclude(problem, outcome, settings, limits, watch);
    }
    Ok(outcome)
}

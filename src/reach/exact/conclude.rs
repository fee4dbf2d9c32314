//! From the states that were visited to the outcome of a question.

use crate::sim::Fault;
use crate::watch::Watch;

use super::super::controls::reads_between;
use super::super::outcome::{Argument, End, Exhaustion, Outcome, Unfinished, Verdict};
use super::super::planners::Planner;
use super::super::problem::Problem;
use super::super::search::{Limits, Settings};
use super::super::start_hold::{StartStatus, finish_hold};
use super::super::window::Windows;
use super::{Budget, Ending, Exhausted, visit_all};

/// Number of states for each node of the budget of a search: a node costs much more than a state here.
const STATES: u64 = 20;

/// Visits all states of a question, at most as many as the limit has nodes, in few bytes each. Instances that can act
/// on the others only by contacts are left out. `None` if that is not possible: with several starts, where a run is
/// over at the start, and where nature draws.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn exhaust(
    problem: &Problem<'_>,
    limits: &Limits,
    threads: usize,
    watch: &dyn Watch,
) -> Result<Option<Outcome>, Fault> {
    Ok(visited(problem, limits, (threads, false), watch)?.map(|(outcome, _)| outcome))
}

/// States in which the first player stands.
type Rests = Vec<Vec<u8>>;

/// As [`exhaust`], with the states in which the first player stands if it is to be explained that there is no way.
fn visited(
    problem: &Problem<'_>,
    limits: &Limits,
    (threads, explains): (usize, bool),
    watch: &dyn Watch,
) -> Result<Option<(Outcome, Rests)>, Fault> {
    let Some(starts) = problem.starts(watch)? else { return Ok(None) };
    let [start] = &*starts else { return Ok(None) };
    let StartStatus::Open(start) = finish_hold(problem, start.clone(), watch)? else { return Ok(None) };
    let starts = [start];
    let windows = Windows::new(problem, &starts);
    let budget = Budget { states: limits.nodes, memory: limits.memory, threads, explains };
    let Some(Exhausted { ending, states, within, left_out, rests }) =
        visit_all(problem, &starts, &windows, &budget, watch)
    else {
        return Ok(None);
    };
    let answered = |verdict| Outcome::of(verdict, Planner::Exhaustive.name());
    let exhaustion = Exhaustion { states, min_hold: problem.min_hold(), left_out };
    let reads_between = reads_between(problem);
    let outcome = match ending {
        Ending::Reached(plan) => answered(Verdict::Reached(plan)),
        Ending::All if reads_between => answered(Verdict::Exhausted(exhaustion)),
        Ending::All => answered(Verdict::Unreachable(Argument::Exhaustion(exhaustion))),
        Ending::Stopped => Outcome { end: End::Stopped, ..answered(Verdict::NotFound) },
        Ending::Open => {
            let unfinished = Some(Unfinished { states, steps: within, left_out });
            Outcome { end: End::Nodes, unfinished, ..answered(Verdict::NotFound) }
        }
    };
    Ok(Some((Outcome { reads_between, ..outcome }, rests)))
}

/// Visits all states of a question whose search found nothing, and completes its outcome.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
#[cfg_attr(not(feature = "ask"), allow(dead_code, reason = "only the command line asks for it"))]
pub(in super::super) fn conclude(
    problem: &Problem<'_>,
    mut outcome: Outcome,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    if !outcome.is_open() {
        return Ok(outcome);
    }
    let limits = Limits { nodes: limits.nodes.saturating_mul(STATES), ..*limits };
    let how = (settings.threads, settings.explains);
    let Some((visited, rests)) = visited(problem, &limits, how, watch)? else { return Ok(outcome) };
    outcome.nearest.iter_mut().for_each(|nearest| nearest.stand(&rests));
    outcome.unfinished = visited.unfinished;
    match visited.verdict {
        Verdict::NotFound if visited.end == End::Stopped => outcome.end = End::Stopped,
        Verdict::NotFound => {}
        verdict => (outcome.verdict, outcome.end, outcome.planner) = (verdict, End::Answered, visited.planner),
    }
    Ok(outcome)
}

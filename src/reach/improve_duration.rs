//! Makes a plan faster: by a beam (`planners/beam.rs`), which goes on from each path to faster ones; where it finds none,
//! repeats the question with less time as long as there is an answer. After AO-x of Hauser and Zhou, *Asymptotically
//! Optimal Planning by Feasible Kinodynamic Planning in a State-Cost Space*, 2016, in which each plan bounds the cost of
//! the next.

use crate::analysis::ConfigurationSpace;
use crate::watch::Watch;

use super::coverage::mix;
use super::outcome::{Outcome, Plan, Verdict, join_records};
use super::planners::Planner;
use super::problem::Problem;
use super::search::{Limits, Settings, search};

/// Time limits of the next plan, in percent of the last one; the boldest is tried first.
const TIMES: [u64; 4] = [60, 80, 90, 97];
/// The divisors of the node budget for a beam, and for its nodes without a faster plan.
const BEAM: u64 = 2;
const PATIENCE: u64 = 4;
/// The divisor of the node budget for one other search, and the maximum number of its nodes.
const SHARE: u64 = 4;
const MAX_NODES: u64 = 100_000;
/// The fewest nodes for a faster plan than the first one, and the percentage of its time that it may take: less is not
/// worth the search.
const FEWEST: u64 = 1_000;
const FASTER: u64 = 90;

/// A faster plan, if one is found; `limits` bound all searches for it together.
#[must_use]
pub fn improve_duration(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    plan: &Plan,
    watch: &dyn Watch,
) -> Plan {
    let mut best = plan.clone();
    let (mut left, mut round) = (limits.nodes, 0);
    // A shortest plan cannot be improved.
    let mut is_faster = |planner, percent: u64, most: u64, patience: u64| {
        let steps = best.steps - best.after;
        let within = (steps * percent / 100).min(steps.saturating_sub(1));
        let nodes = most.min(left);
        if best.is_shortest || within == 0 || nodes == 0 || watch.stop() {
            return false;
        }
        round += 1;
        let limited = problem.clone().within(u32::try_from(within).unwrap_or(u32::MAX));
        let settings = Settings { planner, seed: mix(settings.seed, round), records: false, patience, ..*settings };
        let Ok(outcome) = search(&limited, space, &settings, &Limits { nodes, ..*limits }, watch) else { return false };
        left = left.saturating_sub(outcome.statistics.nodes.max(1));
        match outcome.verdict {
            Verdict::Reached(plan) if plan.steps - plan.after < steps => best = plan,
            _ => return false,
        }
        true
    };
    // Each finds ways that the others do not.
    let planners: &[Planner] = match settings.planner {
        Planner::Auto => {
            if is_faster(Planner::Beam, 100, limits.nodes / BEAM, limits.nodes / PATIENCE) {
                return best;
            }
            &[Planner::TimeGuided, Planner::DistanceGuided]
        }
        _ => &[settings.planner],
    };
    let most = (limits.nodes / SHARE).clamp(1, MAX_NODES);
    for percent in TIMES {
        while planners.iter().any(|planner| is_faster(*planner, percent, most, 0)) {}
    }
    best
}

/// A faster plan than the first one, by one more search of twice as many nodes: what is found first is often a detour.
/// What it took is counted in `outcome`.
pub(super) fn hasten(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    outcome: &mut Outcome,
    watch: &dyn Watch,
) {
    let Verdict::Reached(plan) = &outcome.verdict else { return };
    let nodes = (2 * outcome.statistics.nodes).max(FEWEST).min(limits.nodes.saturating_sub(outcome.statistics.nodes));
    let steps = (plan.steps - plan.after) * FASTER / 100;
    if plan.is_shortest || steps == 0 || nodes == 0 || watch.stop() {
        return;
    }
    let settings = Settings { planner: Planner::TimeGuided, hold: None, explains: false, ..*settings };
    let limits = Limits { nodes, ..*limits };
    let limited = problem.clone().within(u32::try_from(steps).unwrap_or(u32::MAX));
    let Ok(faster) = search(&limited, space, &settings, &limits, watch) else { return };
    outcome.statistics.add(&faster.statistics);
    join_records(&mut outcome.record, &faster.record);
    if let Verdict::Reached(faster) = faster.verdict {
        outcome.verdict = Verdict::Reached(faster);
    }
}

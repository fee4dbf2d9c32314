//! Makes a plan faster: repeats the question with less time as long as there is an answer. After AO-x of Hauser and
//! Zhou, *Asymptotically Optimal Planning by Feasible Kinodynamic Planning in a State-Cost Space*, 2016, in which each
//! plan bounds the cost of the next.

use crate::analysis::ConfigurationSpace;
use crate::watch::Watch;

use super::coverage::mix;
use super::outcome::{Plan, Verdict};
use super::planners::Planner;
use super::problem::Problem;
use super::search::{Limits, Settings, search};

/// Time limits of the next plan, in percent of the last one; the boldest is tried first.
const TIMES: [u64; 4] = [60, 80, 90, 97];
/// The divisor of the node budget for one search, and the maximum number of its nodes.
const SHARE: u64 = 4;
const MAX_NODES: u64 = 100_000;

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
    // By measurement, this planner is the best for it.
    let planner = if settings.planner == Planner::Auto { Planner::DistanceGuided } else { settings.planner };
    let (mut left, mut round, mut tried) = (limits.nodes, 0, 0);
    // A shortest plan cannot be improved.
    while let Some(percent) = TIMES.get(tried).filter(|_| !best.is_shortest && left > 0 && !watch.stop()) {
        let steps = (best.steps - best.after) * percent / 100;
        if steps == 0 {
            break;
        }
        round += 1;
        let nodes = (limits.nodes / SHARE).clamp(1, MAX_NODES).min(left);
        let settings = Settings { planner, seed: mix(settings.seed, round), records: false, ..*settings };
        let limits = Limits { nodes, ..*limits };
        let limited = problem.clone().within(u32::try_from(steps).unwrap_or(u32::MAX));
        let Ok(outcome) = search(&limited, space, &settings, &limits, watch) else { break };
        left = left.saturating_sub(outcome.statistics.nodes.max(1));
        match outcome.verdict {
            Verdict::Reached(plan) if plan.steps - plan.after < best.steps - best.after => best = plan,
            _ => tried += 1,
        }
    }
    best
}

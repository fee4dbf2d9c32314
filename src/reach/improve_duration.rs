//! Makes a plan faster: by shortcuts (`shortcuts.rs`), by a beam (`planners/beam.rs`), which goes on from each path, and by
//! asking again with less time as long as there is an answer. After AO-x of Hauser and Zhou, *Asymptotically Optimal
//! Planning by Feasible Kinodynamic Planning in a State-Cost Space*, 2016: each plan bounds the cost of the next.

use crate::analysis::ConfigurationSpace;
use crate::watch::Watch;

use super::coverage::mix;
use super::outcome::{Plan, Verdict};
use super::planners::Planner;
use super::problem::Problem;
use super::search::{Limits, Settings, search};
use super::shortcuts::{Effort, take_shortcuts};

/// Time limits of the next plan, in percent of the last one; the boldest is tried first.
const TIMES: [u64; 4] = [60, 80, 90, 97];
/// The divisors of the node budget for a beam, and for its nodes without a faster plan.
const BEAM: u64 = 2;
const PATIENCE: u64 = 4;
/// Who is asked in place of `auto`: each finds ways that the other does not.
const PLANNERS: [Planner; 2] = [Planner::TimeGuided, Planner::DistanceGuided];
/// The divisor of the nodes of searches that only add to a beam.
const BRIEF: u64 = 4;
/// The divisor of the node budget for one other search, and the maximum number of its nodes.
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
    // What takes less time is searched for with less.
    let best = take_shortcuts(problem, plan, Effort::Brief(u64::MAX), watch);
    let mut improving = Improving { problem, space, settings, limits, watch, best, left: limits.nodes, round: 0 };
    let mut most = (limits.nodes / SHARE).clamp(1, MAX_NODES);
    if settings.planner == Planner::Auto {
        // A beam seldom waits for anything: where it finds a plan, others may find a faster one.
        if improving.search(Planner::Beam, 100, limits.nodes / BEAM, limits.nodes / PATIENCE) {
            most /= BRIEF;
        }
        improving.repeat(&PLANNERS, &TIMES, most);
    } else {
        improving.repeat(&[settings.planner], &TIMES, most);
    }
    let fast = take_shortcuts(problem, &improving.best, Effort::Thorough, watch);
    if fast.steps < plan.steps { fast } else { plan.clone() }
}

/// The search for faster plans.
struct Improving<'i, 'p> {
    problem: &'i Problem<'p>,
    space: &'i ConfigurationSpace,
    settings: &'i Settings,
    limits: &'i Limits,
    watch: &'i dyn Watch,
    /// The fastest plan so far.
    best: Plan,
    /// Number of nodes that are left.
    left: u64,
    /// Number of searches so far.
    round: u64,
}

impl Improving<'_, '_> {
    /// Searches with time limits, in percent of the fastest plan, each as long as a planner finds a faster one.
    fn repeat(&mut self, planners: &[Planner], times: &[u64], nodes: u64) {
        for percent in times {
            while planners.iter().any(|planner| self.search(*planner, *percent, nodes, 0)) {}
        }
    }

    /// Whether a planner finds a faster plan.
    fn search(&mut self, planner: Planner, percent: u64, nodes: u64, patience: u64) -> bool {
        let steps = self.best.steps - self.best.after;
        let within = (steps * percent / 100).min(steps.saturating_sub(1));
        let nodes = nodes.max(1).min(self.left);
        // A shortest plan cannot be improved.
        if self.best.is_shortest || within == 0 || nodes == 0 || self.watch.stop() {
            return false;
        }
        self.round += 1;
        let seed = mix(self.settings.seed, self.round);
        let limited = self.problem.clone().within(u32::try_from(within).unwrap_or(u32::MAX));
        let settings = Settings { planner, seed, records: false, patience, ..*self.settings };
        let limits = Limits { nodes, ..*self.limits };
        let Ok(outcome) = search(&limited, self.space, &settings, &limits, self.watch) else { return false };
        self.left = self.left.saturating_sub(outcome.statistics.nodes.max(1));
        match outcome.verdict {
            Verdict::Reached(plan) if plan.steps - plan.after < steps => self.best = plan,
            _ => return false,
        }
        true
    }
}

//! A complete search: builds searchers from the settings, which `rounds.rs` runs until there is an answer or the budget is
//! spent.

use std::sync::Arc;

use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::analysis::ConfigurationSpace;
use crate::sim::Fault;
use crate::watch::{Meter, Watch};

use super::bounds::Sampling;
use super::controls::{ControlSets, reads_between};
use super::coverage::mix;
use super::distance::DistanceField;
use super::exhaustive::{Change, Exhaustive};
use super::ledges::Ledges;
use super::lost::Lost;
use super::metric::{Measure, Metric};
use super::monitor::monitored;
use super::outcome::{Argument, Outcome, Plan, Verdict};
use super::planners::{Guidance, Method, Planner, blended};
use super::portfolio::{Arm, Portfolio, Refinement};
use super::problem::{Problem, Start};
use super::rounds::{Interlude, ParallelSearch};
use super::sampler::Sampler;
use super::search_context::SearchContext;
use super::searcher::Searcher;
use super::shortcuts::{Effort, take_shortcuts};
use super::start_hold::{StartStatus, finish_hold};
use super::strategy::Strategy;
use super::why_not::Margins;
use super::window::Windows;

/// Search settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The seed of the generator: the same seed gives the same search.
    pub seed: u64,
    /// The planner.
    pub planner: Planner,
    /// Range of the number of steps for which an input is held, ends included; `None`: the planner's default.
    pub hold: Option<(u16, u16)>,
    /// The share of samples that are drawn from the goal region.
    pub goal_bias: f64,
    /// When a tree is given up for a new one.
    pub restart: Restart,
    /// Number of nodes without a faster path after which a sampling planner ends that has found one; 0: with the first.
    pub patience: u64,
    /// Whether `auto` goes on from the first path to faster ones, with as much work again.
    pub hastens: bool,
    /// Where samples are drawn from.
    pub sampling: Sampling,
    /// The metric.
    pub measure: Measure,
    /// Number of parallel trees, each with its own seed; the result depends on it.
    pub trees: usize,
    /// Number of threads; the result does not depend on it.
    pub threads: usize,
    /// Whether all nodes are recorded, for pictures.
    pub records: bool,
    /// Whether all states are checked against the configuration space, if a problem has no [`Monitor`](super::Monitor).
    pub checks: bool,
    /// Whether the states that come nearest to the target are kept, to explain a missing answer.
    pub explains: bool,
    /// Whether `auto` visits all states, in another way, when its search has found nothing: with the feature `cli` alone,
    /// elsewhere [`exhaust`](super::exhaust) does it.
    pub exhausts: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            seed: 1,
            planner: Planner::Auto,
            hold: None,
            goal_bias: 0.05,
            restart: Restart::ByPlanner,
            patience: 0,
            hastens: false,
            sampling: Sampling::Reduced,
            measure: Measure::Full,
            trees: 1,
            threads: 1,
            records: false,
            checks: true,
            explains: false,
            exhausts: false,
        }
    }
}

/// When a tree is given up for a new one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Restart {
    /// The planner's default.
    #[default]
    ByPlanner,
    /// After this number of nodes, or a multiple of it.
    After(u64),
    /// Never.
    Never,
}

/// Limits of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Nodes over all trees.
    pub nodes: u64,
    /// Memory for trees and indexes, bytes.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { nodes: 200_000, memory: 2 << 30 }
    }
}

/// Searches until the target is found or the budget is spent, without the analysis.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn search(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    search_asking(problem, space, settings, limits, watch, None)
}

/// As [`search`], with an interlude.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub(super) fn search_asking(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
    interlude: Option<Interlude<'_>>,
) -> Result<Outcome, Fault> {
    monitored(problem, space, settings, |problem| {
        let mut outcome = search_monitored(problem, space, settings, limits, watch, interlude)?;
        if let Some(monitor) = problem.monitor() {
            outcome.refute_by(monitor);
        }
        Ok(outcome)
    })
}

fn search_monitored(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
    interlude: Option<Interlude<'_>>,
) -> Result<Outcome, Fault> {
    let Some(all) = problem.starts(watch)? else { return Ok(Outcome::stopped(settings.planner)) };
    let is_alone = all.len() == 1;
    let (mut starts, mut fault, mut is_by_luck) = (Vec::new(), None, false);
    for start in all {
        problem.monitor().inspect(|monitor| monitor.follow(problem, &start.script, &Meter::new(watch)));
        match finish_hold(problem, start, watch)? {
            StartStatus::Open(start) => starts.push(start),
            StartStatus::Over { is_by_luck: by_luck } => is_by_luck |= by_luck,
            StartStatus::Fault(at, step) => fault = fault.or(Some((at, step))),
            StartStatus::Stopped => return Ok(Outcome::stopped(settings.planner)),
            StartStatus::Goal { script, after } => {
                let steps = script.len();
                // Only the mandatory hold comes before it.
                let plan = Plan { steps, script, after, is_shortest: is_alone };
                return Ok(Outcome::of(Verdict::Reached(plan), settings.planner.name()));
            }
        }
    }
    if starts.is_empty() {
        let verdict =
            if fault.is_some() || is_by_luck { Verdict::NotFound } else { Verdict::Unreachable(Argument::Over) };
        return Ok(Outcome { fault, ..Outcome::of(verdict, settings.planner.name()) });
    }
    // Among thousands of instances, preparing a search takes long.
    if watch.stop() {
        return Ok(Outcome::stopped(settings.planner));
    }
    let windows = Windows::new(problem, &starts);
    let metric = Metric::measuring(problem.sim, space, (settings.sampling, windows.extent), settings.measure);
    let uses_distances = settings.planner.uses_distances() || settings.explains || problem.time().is_some();
    let distances = if uses_distances { DistanceField::new(problem, space, &Meter::new(watch)) } else { None };
    let (margins, lost) = (Margins::new(problem), Lost::new(problem, space));
    let uses_ledges = settings.planner.uses_ledges();
    let ledges = if uses_ledges { Ledges::new(problem, distances.as_ref()).map(Arc::new) } else { None };
    let build = Builder {
        problem,
        lost: &lost,
        measures: (&metric, &windows),
        guidance: Guidance { distances: distances.as_ref(), margins: &margins, ledges: ledges.as_ref() },
        settings,
        limits,
        starts: &starts,
        watch,
    };
    let trees: Vec<Box<dyn Searcher + '_>> = (0..settings.trees.max(1)).map(|tree| build.searcher(tree)).collect();
    let reads_between = reads_between(problem);
    let nearest = (u32::MAX, 0);
    Ok(ParallelSearch { trees, settings, limits, watch, fault, is_by_luck, reads_between, nearest }.grow(interlude))
}

/// Builds searchers.
struct Builder<'b, 'a> {
    problem: &'a Problem<'a>,
    measures: (&'a Metric, &'a Windows),
    guidance: Guidance<'a>,
    lost: &'a Lost,
    settings: &'b Settings,
    limits: &'b Limits,
    starts: &'b [Start],
    watch: &'a dyn Watch,
}

impl<'a> Builder<'_, 'a> {
    /// The searcher of a tree.
    fn searcher(&self, tree: usize) -> Box<dyn Searcher + 'a> {
        match self.settings.planner.method() {
            Method::Portfolio => {
                // Both rules of the tree hold as coverage does.
                let (planner, hold) = (Planner::DistanceGuided, self.hold(Planner::Coverage));
                let led = |distances: Option<&'a DistanceField>| {
                    let strategy = blended(self.problem, self.measures.0, Guidance { distances, ..self.guidance });
                    self.sampler(planner, strategy, (tree, hold), (self.restart(distances), false))
                };
                let places = self.guidance.distances.filter(|of| of.leads_to_places());
                // Before the edge that leads on, something else may have to be done elsewhere.
                let is_certain = self.guidance.distances.is_none_or(DistanceField::is_goal);
                let shares = match (self.problem.time(), places) {
                    (Some(_), _) => IN_TIME,
                    (None, None) => NOWHERE,
                    (None, Some(_)) if is_certain => AUTO,
                    (None, Some(_)) => TO_AN_EDGE,
                };
                let mut arms = vec![Arm::new(shares.blended, led(self.guidance.distances))];
                if !is_certain {
                    arms.push(Arm::new(shares.blended, led(None)));
                }
                let mut add = |planner: Planner, shares: &[[u64; 3]]| {
                    let searchers = self.searchers(planner, tree);
                    arms.extend(searchers.into_iter().zip(shares).map(|(searcher, &[share, late, for_faster])| {
                        let for_faster = if self.settings.hastens { for_faster } else { 0 };
                        Arm::new(share, searcher).late(late).for_faster(for_faster)
                    }));
                };
                if self.guidance.distances.is_none_or(|of| is_certain || !self.is_pushed(of)) {
                    add(Planner::DistanceGuided, shares.by_jumps);
                }
                if self.guidance.ledges.is_some() && self.guidance.distances.is_none_or(|of| !self.is_pushed(of)) {
                    add(Planner::LedgeGuided, shares.by_ledges);
                }
                if places.is_some() {
                    add(Planner::TimeGuided, shares.by_time);
                    add(Planner::Beam, &[shares.beam]);
                }
                add(Planner::Coverage, &[shares.coverage]);
                add(Planner::Rrt, &[[1, 1, 0]]);
                // Exhaustive search does not depend on the seed.
                if tree == 0 {
                    arms.push(Arm::new(FOR_PROOFS[0], Box::new(self.refinement(tree))).late(FOR_PROOFS[1]));
                }
                self.portfolio(arms)
            }
            Method::Sampling { .. } | Method::Alternating { .. } | Method::Exhaustive { .. } => {
                let mut searchers = self.searchers(self.settings.planner, tree);
                match searchers.pop() {
                    Some(only) if searchers.is_empty() => only,
                    last => self.portfolio(searchers.into_iter().chain(last).map(|one| Arm::new(1, one)).collect()),
                }
            }
        }
    }

    fn portfolio(&self, arms: Vec<Arm<'a>>) -> Box<dyn Searcher + 'a> {
        let from = |start: &Start| {
            let (sim, distances) = (self.problem.sim, self.guidance.distances?);
            Some((distances.least_steps(sim, &start.state), distances.of(sim, &start.state)))
        };
        let (least, far) = self.starts.iter().filter_map(from).min().unwrap_or((0, 0));
        let memory = self.limits.memory / self.settings.trees.max(1) as u64;
        let (problem, watch) = (self.problem, self.watch);
        let hasten = move |plan: &Plan| take_shortcuts(problem, plan, Effort::Brief(0), watch);
        Box::new(Portfolio::new(arms, memory, (least.into(), far), hasten))
    }

    /// Number of nodes of the shortest tree of `auto` that is led by distances and by coverage.
    fn restart(&self, distances: Option<&DistanceField>) -> u64 {
        // What is pushed gets stuck, and what comes too fast does not stop: then a tree finds more of the same.
        match self.guidance.margins.is_empty() {
            _ if distances.is_some_and(|of| self.is_pushed(of)) => RESTART_PUSHED,
            false if distances.is_some() => RESTART_BY_NUMBERS,
            _ => Planner::DistanceGuided.restart(),
        }
    }

    /// Whether the goal depends on the position of an instance that players can only push.
    fn is_pushed(&self, distances: &DistanceField) -> bool {
        !self.problem.players().contains(&distances.slot())
    }

    /// Exhaustive searches with inputs that change only every few steps, finer and finer, up to all that the question
    /// admits.
    fn refinement(&self, tree: usize) -> Refinement<'a> {
        let least = self.problem.min_hold();
        let coarse = COARSE.into_iter().filter(|hold| *hold > least).chain((least > 1).then_some(least));
        let changes = coarse.map(Change::Every).chain([Change::After(least)]);
        // With a time limit, only breadth-first search proves anything.
        let best_first = self.problem.time().is_none();
        let stages =
            changes.map(|change| Box::new(self.exhaustive(tree, change, best_first)) as Box<dyn Searcher + 'a>);
        Refinement::new(stages.collect())
    }

    fn exhaustive(&self, tree: usize, change: Change, best_first: bool) -> Exhaustive<'a> {
        let mut controls = ControlSets::complete();
        // An input that continues is found by its number, which is then that of the players' input alone.
        if !change.continues() {
            controls = controls.with_draws(self.problem);
        }
        Exhaustive::new(self.context(tree, controls, (1, 1)), change, best_first)
    }

    /// The context of a tree. Trees have different starts and seeds; the first has the given seed.
    fn context(&self, tree: usize, controls: ControlSets, hold: (u16, u16)) -> SearchContext<'a> {
        let mut starts = self.starts.to_vec();
        starts.rotate_left(tree % self.starts.len().max(1));
        let seed = if tree == 0 { self.settings.seed } else { mix(self.settings.seed, tree as u64) };
        let rng = Pcg64::seed_from_u64(seed);
        SearchContext::new(self.problem, self.measures, controls, starts, hold, rng, self.watch)
            .recording(self.settings.records)
            .tracking(self.settings.explains, self.guidance.distances)
    }

    /// Range of the number of steps for which a planner holds an input.
    fn hold(&self, planner: Planner) -> (u16, u16) {
        self.settings.hold.unwrap_or_else(|| {
            // With a time limit it tries no whole jumps, and need not leave at one step.
            let is_timed = planner == Planner::DistanceGuided && self.problem.time().is_some();
            default_hold(if is_timed { Planner::Coverage } else { planner }, self.problem.min_hold())
        })
    }

    /// The searchers of a single planner, as a rule one.
    fn searchers(&self, planner: Planner, tree: usize) -> Vec<Box<dyn Searcher + 'a>> {
        let hold = self.hold(planner);
        let (problem, metric, guidance) = (self.problem, self.measures.0, self.guidance);
        match planner.method() {
            Method::Sampling { samples, strategy } => {
                let strategy = strategy(problem, metric, guidance);
                vec![self.sampler(planner, strategy, (tree, hold), (planner.restart(), samples))]
            }
            Method::Alternating { strategies } => {
                let strategies = strategies(problem, metric, guidance).into_iter();
                let restart = (planner.restart(), false);
                strategies.map(|strategy| self.sampler(planner, strategy, (tree, hold), restart)).collect()
            }
            Method::Portfolio | Method::Exhaustive { .. } => {
                let least = self.problem.min_hold();
                let change = if hold.0 > least { Change::Every(hold.0) } else { Change::After(least) };
                let is_best_first = matches!(planner.method(), Method::Exhaustive { is_best_first: true });
                vec![Box::new(self.exhaustive(tree, change, is_best_first))]
            }
        }
    }

    /// A searcher that grows trees with a strategy.
    fn sampler(
        &self,
        planner: Planner,
        strategy: Box<dyn Strategy + Send + 'a>,
        (tree, hold): (usize, (u16, u16)),
        (restart, samples): (u64, bool),
    ) -> Box<dyn Searcher + 'a> {
        let restart = match self.settings.restart {
            Restart::ByPlanner => Some(restart),
            Restart::After(nodes) => Some(nodes),
            Restart::Never => None,
        };
        // What is never pressed and never released takes few changes, also where no mode reads it.
        let controls = match self.problem.restriction() {
            Some(_) => ControlSets::complete(),
            None => ControlSets::default(),
        };
        let controls = controls.with_draws(self.problem);
        let context = self.context(tree, controls, hold);
        let goal_bias = samples.then_some(self.settings.goal_bias);
        Box::new(Sampler::new(
            context,
            strategy,
            planner.name(),
            goal_bias,
            (restart, self.settings.patience),
            (self.guidance.distances, self.lost),
        ))
    }
}

/// The range of holds of a planner, steps. If inputs are held for a minimum time, it begins there, whatever the planner
/// does otherwise: other holds than a planner's own are asked for.
fn default_hold(planner: Planner, least: u16) -> (u16, u16) {
    match least {
        1 => planner.hold(),
        least => (least, planner.hold().1.max(least.saturating_mul(MAX_HOLD))),
    }
}

/// Maximum hold for each step of a minimum hold.
const MAX_HOLD: u16 = 4;

/// Number of nodes of the shortest tree of `auto` where the goal depends on what is pushed, or on other numbers than
/// positions.
const RESTART_PUSHED: u64 = 3_000;
const RESTART_BY_NUMBERS: u64 = 20_000;

/// Coarse holds, steps: they lead to few states, among which paths are found soon.
const COARSE: [u16; 3] = [10, 5, 2];

/// The shares of an exhaustive search, which looks for proofs: of few states there is one soon.
const FOR_PROOFS: [u64; 2] = [2, 1];

/// The shares of the work in `auto`: until a path is found, and in the search for a faster one. RRT, which finds some
/// things that others do not, has a share of 1.
struct Shares {
    /// Of the tree that is led by distances and by coverage.
    blended: u64,
    /// Of the trees that are led by time, in the order of their manners, and of a beam, where there are distances: at
    /// first, when the search takes long, and for a faster path.
    by_time: &'static [[u64; 3]],
    beam: [u64; 3],
    /// Of a tree by whole jumps: not of what is pushed, nor with a time limit.
    by_jumps: &'static [[u64; 3]],
    /// Of one from ledge to ledge: where the goal has a position.
    by_ledges: &'static [[u64; 3]],
    /// Of a tree by coverage alone, where distances lead astray.
    coverage: [u64; 3],
}

/// The shares as a rule: none of those that find ways is the best in most levels, so they begin with about the same, and
/// their pace decides. Where all are stuck, most is left to ledges, then to a beam: these begin anew where others go on
/// from what they have. Where distances only lead to an edge, or nowhere, more is left to the others.
const AUTO: Shares = Shares {
    blended: 1,
    by_time: &[[8, 8, 4], [2, 2, 0], [8, 16, 2]],
    beam: [8, 32, 6],
    by_jumps: &[[8, 16, 0]],
    by_ledges: &[[4, 192, 0]],
    coverage: [1, 4, 0],
};
const TO_AN_EDGE: Shares = Shares {
    blended: 14,
    by_time: &[[8, 10, 3], [6, 6, 1], [4, 4, 0]],
    beam: [4, 12, 5],
    by_jumps: &[[2, 24, 0]],
    by_ledges: &[],
    coverage: [4, 4, 0],
};
const NOWHERE: Shares =
    Shares { blended: 8, by_time: &[], beam: [0; 3], by_jumps: &[[6, 4, 0]], by_ledges: &[], coverage: [4, 4, 0] };
const IN_TIME: Shares = Shares {
    blended: 8,
    by_time: &[[4, 4, 2], [3, 3, 1], [3, 3, 2], [2, 2, 0]],
    beam: [6, 6, 4],
    by_jumps: &[],
    by_ledges: &[],
    coverage: [1, 1, 0],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_begin_at_the_minimum_and_vary() {
        for planner in Planner::ALL {
            assert_eq!(default_hold(planner, 1), planner.hold());
            let (least, most) = default_hold(planner, 20);
            assert!(least == 20 && most >= 4 * least && most >= planner.hold().1, "{planner:?}: {least}..{most}");
        }
        assert_eq!(default_hold(Planner::Auto, u16::MAX), (u16::MAX, u16::MAX));
    }
}

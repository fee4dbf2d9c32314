//! A complete search: builds searchers from the settings, runs them in parallel until there is an answer or the budget
//! is spent, and builds the outcome.

use std::sync::Mutex;
use std::thread;

use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::analysis::ConfigurationSpace;
use crate::sim::Fault;
use crate::watch::{Meter, Progress, Watch};

use super::bounds::Sampling;
use super::controls::{ControlSets, reads_between};
use super::coverage::mix;
use super::distance::DistanceField;
use super::exhaustive::{Change, Exhaustive};
use super::lost::Lost;
use super::metric::{Measure, Metric};
use super::monitor::monitored;
use super::outcome::{Argument, End, Outcome, Plan, Verdict};
use super::planners::{Guidance, Method, Planner, blended};
use super::portfolio::{Arm, Portfolio, Refinement};
use super::problem::{Problem, Start};
use super::sampler::Sampler;
use super::search_context::{Notes, SearchContext};
use super::searcher::{Ending, Searcher};
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

/// Number of nodes between two checks of the limits.
const ROUND: u64 = 512;

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

/// What is asked in a search that has not found anything yet: whether it can end there.
pub(super) struct Interlude<'i> {
    /// In order.
    pub pauses: &'i [Pause],
    /// The question.
    pub ends: &'i mut dyn FnMut(Pause, &mut GoOn<'_>) -> bool,
}

/// Goes on with a search for a while; returns its number of nodes, or `None` once it cannot go on, or need not.
pub(super) type GoOn<'g> = dyn FnMut() -> Option<u64> + 'g;

/// When a search pauses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pause {
    /// At least after so many nodes.
    pub nodes: u64,
    /// After so many times the nodes that it took to come as near to the goal as it is.
    pub times: u64,
}

impl Pause {
    /// Whether a search pauses after some nodes, of which so many took it nearest to the goal.
    fn is_due(self, nodes: u64, nearest: u64) -> bool {
        self.nodes <= nodes && self.times.saturating_mul(nearest) <= nodes
    }

    /// The number of nodes until then, at least.
    fn left(self, nodes: u64) -> Option<u64> {
        self.nodes.checked_sub(nodes).filter(|left| *left > 0)
    }
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
    let build = Builder {
        problem,
        lost: &lost,
        measures: (&metric, &windows),
        guidance: Guidance { distances: distances.as_ref(), margins: &margins },
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
                let (planner, hold) = (Planner::DistanceGuided, self.settings.hold);
                let hold = hold.unwrap_or_else(|| default_hold(planner, self.problem.min_hold()));
                let led = |distances: Option<&'a DistanceField>| {
                    let strategy = blended(self.problem, self.measures.0, Guidance { distances, ..self.guidance });
                    self.sampler(planner, strategy, (tree, hold), (self.restart(distances), false))
                };
                let shares = if self.problem.time().is_some() { IN_TIME } else { AUTO };
                let mut arms = vec![Arm::new(shares.blended, led(self.guidance.distances))];
                // Before the edge that leads on, something else may have to be done elsewhere.
                let is_certain = self.guidance.distances.is_none_or(DistanceField::is_goal);
                if !is_certain {
                    arms.push(Arm::new(shares.blended, led(None)));
                }
                let mut add = |planner: Planner, shares: &[[u64; 3]]| {
                    let searchers = self.searchers(planner, tree, self.settings.hold);
                    arms.extend(searchers.into_iter().zip(shares).map(|(searcher, &[share, late, for_faster])| {
                        let for_faster = if self.settings.hastens { for_faster } else { 0 };
                        Arm::new(share, searcher).late(late).for_faster(for_faster)
                    }));
                };
                if self.guidance.distances.is_some() {
                    add(Planner::TimeGuided, shares.by_time);
                    add(Planner::Beam, &[shares.beam]);
                }
                add(Planner::Coverage, &[[shares.coverage, shares.coverage, 0]]);
                add(Planner::Rrt, &[[1, 1, 0]]);
                // Exhaustive search does not depend on the seed.
                if tree == 0 {
                    arms.push(Arm::new(1, Box::new(self.refinement(tree))).late(2));
                }
                self.portfolio(arms)
            }
            Method::Sampling { .. } | Method::Alternating { .. } | Method::Exhaustive { .. } => {
                let mut searchers = self.searchers(self.settings.planner, tree, self.settings.hold);
                match searchers.pop() {
                    Some(only) if searchers.is_empty() => only,
                    last => self.portfolio(searchers.into_iter().chain(last).map(|one| Arm::new(1, one)).collect()),
                }
            }
        }
    }

    fn portfolio(&self, arms: Vec<Arm<'a>>) -> Box<dyn Searcher + 'a> {
        Box::new(Portfolio::new(arms, self.limits.memory / self.settings.trees.max(1) as u64))
    }

    /// Number of nodes of the shortest tree of `auto` that is led by distances and by coverage.
    fn restart(&self, distances: Option<&DistanceField>) -> u64 {
        // What is pushed gets stuck, and what comes too fast does not stop: then a tree finds more of the same.
        let is_pushed = distances.is_some_and(|of| !self.problem.players().contains(&of.slot()));
        match self.guidance.margins.is_empty() {
            _ if is_pushed => RESTART_PUSHED,
            false if distances.is_some() => RESTART_BY_NUMBERS,
            _ => Planner::DistanceGuided.restart(),
        }
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

    /// The searchers of a single planner, as a rule one.
    fn searchers(&self, planner: Planner, tree: usize, hold: Option<(u16, u16)>) -> Vec<Box<dyn Searcher + 'a>> {
        let hold = hold.unwrap_or_else(|| default_hold(planner, self.problem.min_hold()));
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

/// The shares of the work in `auto`: until a path is found, and in the search for a faster one. RRT, which finds some
/// things that others do not, and an exhaustive search, which looks for proofs, have a share of 1.
struct Shares {
    /// Of the tree that is led by distances and by coverage.
    blended: u64,
    /// Of the trees that are led by time, in the order of their manners, and of a beam, where there are distances: at
    /// first, when the search takes long, and for a faster path.
    by_time: &'static [[u64; 3]],
    beam: [u64; 3],
    /// Of a tree by coverage alone, where distances lead astray.
    coverage: u64,
}

/// The shares as a rule, and with a time limit.
const AUTO: Shares = Shares { blended: 8, by_time: &[[5, 5, 3], [3, 3, 2], [2, 2, 0]], beam: [6, 12, 4], coverage: 4 };
const IN_TIME: Shares =
    Shares { blended: 8, by_time: &[[4, 4, 2], [3, 3, 1], [3, 3, 2], [2, 2, 0]], beam: [6, 6, 4], coverage: 1 };

/// Parallel searchers.
struct ParallelSearch<'f, 'a> {
    trees: Vec<Box<dyn Searcher + 'a>>,
    settings: &'f Settings,
    limits: &'f Limits,
    watch: &'f dyn Watch,
    /// The first run-time error before the start of any tree, with its step.
    fault: Option<(Fault, u64)>,
    /// Whether the run of a start was over before the search, but would not have been with other draws.
    is_by_luck: bool,
    /// Whether axis values between -1, 0 and 1 matter.
    reads_between: bool,
    /// How near it has come to the goal, in places, and with how many nodes.
    nearest: (u32, u64),
}

/// How a search ended, and in which tree; `None` without an answer.
type Ended = (Option<Verdict>, End, usize);

impl ParallelSearch<'_, '_> {
    /// Grows all trees in rounds.
    fn grow(mut self, mut interlude: Option<Interlude<'_>>) -> Outcome {
        if self.watch.stop() {
            return self.outcome(Verdict::NotFound, End::Stopped, 0);
        }
        let (verdict, end, tree) = loop {
            let pause = interlude.as_ref().and_then(|interlude| interlude.pauses.first().copied());
            // What was found needs no proof that there is nothing.
            let pause = pause.filter(|_| !self.has_found());
            if let (Some(interlude), Some(pause)) = (&mut interlude, pause.filter(|pause| self.is_due(*pause))) {
                interlude.pauses = &interlude.pauses[1..];
                let mut ended = None;
                let mut go_on = || {
                    // Once it comes nearer to the goal, it needs no other answer until it is stuck again.
                    while ended.is_none() {
                        ended = self.advance(None);
                        if self.has_found() || ended.is_some() {
                            break;
                        }
                        if self.is_due(pause) {
                            return Some(self.nodes());
                        }
                    }
                    None
                };
                if (interlude.ends)(pause, &mut go_on) {
                    break (None, End::Stopped, 0);
                }
                if let Some(ended) = ended {
                    break ended;
                }
            } else if let Some(ended) = self.advance(pause) {
                break ended;
            }
        };
        match verdict {
            Some(verdict) => self.outcome(verdict, end, tree),
            None => self.unanswered(end, tree),
        }
    }

    fn nodes(&self) -> u64 {
        self.trees.iter().map(|tree| tree.nodes()).sum()
    }

    fn has_found(&self) -> bool {
        self.trees.iter().any(|tree| tree.has_found())
    }

    fn is_due(&self, pause: Pause) -> bool {
        pause.is_due(self.nodes(), self.nearest.1)
    }

    /// Grows all trees equally, until a pause at most; the first tree in order with an answer wins, so the result does not
    /// depend on timing. Returns how the search ends, if it does.
    fn advance(&mut self, pause: Option<Pause>) -> Option<Ended> {
        let nodes = self.nodes();
        let left = self.limits.nodes.saturating_sub(nodes);
        if left == 0 {
            return Some((None, End::Nodes, 0));
        }
        let bytes: usize = self.trees.iter().map(|t| t.bytes()).sum();
        if bytes as u64 > self.limits.memory {
            return Some((None, End::Memory, 0));
        }
        let places = self.trees.iter().map(|t| t.places()).max().unwrap_or(0);
        self.watch.progress(Progress { nodes, budget: self.limits.nodes, places });
        let left = pause.and_then(|pause| pause.left(nodes)).map_or(left, |pause| left.min(pause));
        let share = (left / self.trees.len() as u64).clamp(1, ROUND);
        let endings = self.round(share);
        let is_spent = endings.iter().all(|e| matches!(e, Ending::Spent));
        for (tree, ending) in endings.into_iter().enumerate() {
            match ending {
                Ending::Reached(plan) => return Some((Some(Verdict::Reached(plan)), End::Answered, tree)),
                Ending::Exhausted(found) => {
                    let verdict = match self.reads_between {
                        true => Verdict::Exhausted(found),
                        false => Verdict::Unreachable(Argument::Exhaustion(found)),
                    };
                    // A start that ended in a run-time error, or by bad luck, might have led further.
                    let is_open = self.fault.is_some() || self.is_by_luck;
                    return Some((Some(if is_open { Verdict::NotFound } else { verdict }), End::Answered, tree));
                }
                Ending::Stopped => return Some((None, End::Stopped, tree)),
                Ending::Paused | Ending::Spent => {}
            }
        }
        let near = self.trees.iter().filter_map(|tree| tree.nearest()).min();
        if let Some(near) = near.filter(|near| *near < self.nearest.0) {
            self.nearest = (near, self.nodes());
        }
        if is_spent {
            return Some((None, End::Answered, 0));
        }
        self.watch.stop().then_some((None, End::Stopped, 0))
    }

    /// Grows each tree by `nodes` nodes, on as many threads as the settings and the system allow.
    fn round(&mut self, nodes: u64) -> Vec<Ending> {
        let threads = self.settings.threads.clamp(1, self.trees.len());
        if threads == 1 {
            return self.trees.iter_mut().map(|tree| tree.advance(nodes)).collect();
        }
        // More threads than cores do not help.
        let threads = threads.min(thread::available_parallelism().map_or(1, usize::from).max(2));
        let mut endings: Vec<Option<Ending>> = self.trees.iter().map(|_| None).collect();
        let tasks = Mutex::new(self.trees.iter_mut().zip(&mut endings));
        let grow = || {
            // A poisoned lock ends the loop; the scope re-raises the panic.
            let next = || tasks.lock().map_or(None, |mut tasks| tasks.next());
            while let Some((tree, ending)) = next() {
                *ending = Some(tree.advance(nodes));
            }
        };
        thread::scope(|scope| {
            for _ in 1..threads {
                // If the system refuses a thread, the existing ones do all the work.
                if thread::Builder::new().spawn_scoped(scope, grow).is_err() {
                    break;
                }
            }
            grow();
        });
        endings.into_iter().map(|ending| ending.unwrap_or(Ending::Stopped)).collect()
    }

    /// The outcome of a search without an answer, unless a pending path is one.
    fn unanswered(mut self, end: End, tree: usize) -> Outcome {
        let pending = self.trees.iter_mut().enumerate().find_map(|(tree, t)| Some((tree, t.pending()?)));
        match pending {
            Some((tree, plan)) => self.outcome(Verdict::Reached(plan), End::Answered, tree),
            None => self.outcome(Verdict::NotFound, end, tree),
        }
    }

    fn outcome(self, verdict: Verdict, end: End, tree: usize) -> Outcome {
        let mut notes = Notes::default();
        self.trees.iter().for_each(|tree| tree.report(&mut notes));
        let planner = match end {
            End::Answered => self.trees[tree].planner(),
            _ => self.settings.planner.name(),
        };
        Outcome {
            verdict,
            end,
            planner,
            statistics: notes.statistics,
            covered: notes.coverage.covered(),
            exhausted: notes.exhausted,
            unfinished: None,
            cuts: notes.cuts,
            violations: notes.violations,
            record: notes.record,
            truncated: notes.is_truncated,
            has_open_draws: notes.has_open_draws,
            fault: self.fault.or(notes.fault),
            reads_between: self.reads_between,
            refuted: None,
            is_withdrawn: false,
            nearest: notes.nearest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_is_due_after_its_nodes_and_where_the_search_is_stuck() {
        let pause = Pause { nodes: 1_000, times: 4 };
        assert_eq!([0, 999].map(|nodes| pause.is_due(nodes, 0)), [false; 2]);
        assert!(pause.is_due(1_000, 250) && !pause.is_due(1_000, 251) && pause.is_due(1_004, 251));
        assert_eq!([0, 999, 1_000, 2_000].map(|nodes| pause.left(nodes)), [Some(1_000), Some(1), None, None]);
    }

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

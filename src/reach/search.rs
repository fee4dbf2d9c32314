//! A whole search: builds the searchers that the settings ask for, lets them grow until there is an answer or the budget
//! is spent, several of them in parallel, and tells what came of it.

use std::sync::Mutex;
use std::thread;

use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::analysis::ConfigurationSpace;
use crate::sim::Fault;
use crate::watch::{Meter, Progress, Watch};

use super::bounds::Sampling;
use super::controls::{ControlSets, reads_between};
use super::coverage::mixed;
use super::distance::Distances;
use super::exhaustive::{Change, Exhaustive};
use super::guard::guarded;
use super::metric::{Measure, Metric};
use super::outcome::{Argument, End, Outcome, Plan, Verdict};
use super::planners::{Method, Planner};
use super::portfolio::{Portfolio, Refinement};
use super::problem::{Problem, Start};
use super::sampler::Sampler;
use super::seam::{Settled, settled};
use super::search_context::{Notes, SearchContext};
use super::searcher::{Ending, Searcher};
use super::window::Windows;

/// How a search goes about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The seed of the generator: the same seed gives the same search.
    pub seed: u64,
    /// Who searches.
    pub planner: Planner,
    /// For how many steps an input is held: drawn between both, ends included; none: as the planner does by itself.
    pub hold: Option<(u16, u16)>,
    /// The share of samples that are drawn towards the goal.
    pub goal_bias: f64,
    /// When a tree is given up for a new one.
    pub restart: Restart,
    /// Where samples are drawn from.
    pub sampling: Sampling,
    /// What distances are measured in.
    pub measure: Measure,
    /// How many trees grow side by side, each from a seed of its own; the result depends on it.
    pub trees: usize,
    /// How many threads let them grow; the result does not depend on it.
    pub threads: usize,
    /// Whether all nodes are recorded, for pictures.
    pub records: bool,
    /// Whether all states are checked against what the world can be, where a problem has no [`Guard`](super::Guard) of its own.
    pub checks: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            seed: 1,
            planner: Planner::Auto,
            hold: None,
            goal_bias: 0.05,
            restart: Restart::ByPlanner,
            sampling: Sampling::Reduced,
            measure: Measure::Full,
            trees: 1,
            threads: 1,
            records: false,
            checks: true,
        }
    }
}

/// When a tree is given up for a new one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Restart {
    /// As the planner does by itself.
    #[default]
    ByPlanner,
    /// After this number of nodes, or a multiple of it.
    After(u64),
    /// Trees grow for ever.
    Never,
}

/// What a search may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Nodes over all trees.
    pub nodes: u64,
    /// Bytes that trees and indexes may take.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { nodes: 200_000, memory: 2 << 30 }
    }
}

/// How many nodes grow between two looks at the whole.
const ROUND: u64 = 512;

/// Searches until what is asked for is found or the budget is spent, without asking the analysis first.
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
    guarded(problem, space, settings, |problem| {
        let mut outcome = search_guarded(problem, space, settings, limits, watch)?;
        if let Some(guard) = problem.guard() {
            outcome.refute_by(guard);
        }
        Ok(outcome)
    })
}

fn search_guarded(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    let Some(all) = problem.starts(watch)? else { return Ok(Outcome::stopped(settings.planner)) };
    let is_alone = all.len() == 1;
    let (mut starts, mut fault) = (Vec::new(), None);
    for start in all {
        problem.guard().inspect(|guard| guard.follow(problem, &start.script, &Meter::new(watch)));
        match settled(problem, start, watch)? {
            Settled::Open(start) => starts.push(start),
            Settled::Over => {}
            Settled::Fault(at, step) => fault = fault.or(Some((at, step))),
            Settled::Stopped => return Ok(Outcome::stopped(settings.planner)),
            Settled::Goal { script, after } => {
                let steps = script.len();
                // Only what must be held anyway comes before.
                let plan = Plan { steps, script, after, is_shortest: is_alone };
                return Ok(Outcome::of(Verdict::Reached(plan), settings.planner.name()));
            }
        }
    }
    if starts.is_empty() {
        let verdict = if fault.is_some() { Verdict::NotFound } else { Verdict::Unreachable(Argument::Over) };
        return Ok(Outcome { fault, ..Outcome::of(verdict, settings.planner.name()) });
    }
    let windows = Windows::new(problem, &starts);
    let metric = Metric::measuring(problem.sim, space, (settings.sampling, windows.extent), settings.measure);
    let is_led = settings.planner.is_led() || problem.time().is_some();
    let distances = if is_led { Distances::new(problem, space, &Meter::new(watch)) } else { None };
    let build = Builder {
        problem,
        measures: (&metric, &windows),
        distances: distances.as_ref(),
        settings,
        limits,
        starts: &starts,
        watch,
    };
    let trees: Vec<Box<dyn Searcher + '_>> = (0..settings.trees.max(1)).map(|tree| build.searcher(tree)).collect();
    Ok(Forest { trees, settings, limits, watch, fault, reads_between: reads_between(problem) }.grow())
}

/// Builds searchers.
struct Builder<'b, 'a> {
    problem: &'a Problem<'a>,
    measures: (&'a Metric, &'a Windows),
    distances: Option<&'a Distances>,
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
                let planners = match (self.distances, self.problem.time()) {
                    (Some(_), None) => AUTO,
                    (Some(_), Some(_)) => AUTO_IN_TIME,
                    (None, _) => AUTO_NOWHERE,
                };
                let sampling =
                    planners.iter().map(|(share, planner)| (*share, self.one(*planner, tree, self.settings.hold)));
                let mut arms: Vec<_> = sampling.collect();
                // An exhaustion is the same whatever its seed.
                if tree == 0 {
                    arms.push((1, Box::new(self.refinement(tree))));
                }
                Box::new(Portfolio::new(arms, self.limits.memory / self.settings.trees.max(1) as u64))
            }
            Method::Sampling { .. } | Method::Exhaustive { .. } => {
                self.one(self.settings.planner, tree, self.settings.hold)
            }
        }
    }

    /// Exhaustions by inputs that change only every few steps, finer and finer, down to all that the question admits.
    fn refinement(&self, tree: usize) -> Refinement<'a> {
        let least = self.problem.least_hold();
        let coarse = COARSE.into_iter().filter(|hold| *hold > least).chain((least > 1).then_some(least));
        let changes = coarse.map(Change::Every).chain([Change::After(least)]);
        // Within a time, only what goes in the order of time proves anything.
        let best_first = self.problem.time().is_none();
        let stages =
            changes.map(|change| Box::new(self.exhaustive(tree, change, best_first)) as Box<dyn Searcher + 'a>);
        Refinement::new(stages.collect())
    }

    fn exhaustive(&self, tree: usize, change: Change, best_first: bool) -> Exhaustive<'a> {
        Exhaustive::new(self.context(tree, ControlSets::complete(), (1, 1)), change, best_first)
    }

    /// What a tree is built on. Trees begin at different starts and with different seeds, of which the first is the one that is
    /// given.
    fn context(&self, tree: usize, controls: ControlSets, hold: (u16, u16)) -> SearchContext<'a> {
        let mut starts = self.starts.to_vec();
        starts.rotate_left(tree % self.starts.len().max(1));
        let seed = if tree == 0 { self.settings.seed } else { mixed(self.settings.seed, tree as u64) };
        let rng = Pcg64::seed_from_u64(seed);
        SearchContext::new(self.problem, self.measures, controls, starts, hold, rng, self.watch)
            .recording(self.settings.records)
    }

    /// The searcher of a planner that is no portfolio.
    fn one(&self, planner: Planner, tree: usize, hold: Option<(u16, u16)>) -> Box<dyn Searcher + 'a> {
        let hold = hold.unwrap_or(planner.hold());
        match planner.method() {
            Method::Sampling { samples, strategy } => {
                let strategy = strategy(self.problem, self.measures.0, self.distances);
                let restart = match self.settings.restart {
                    Restart::ByPlanner => Some(planner.restart()),
                    Restart::After(nodes) => Some(nodes),
                    Restart::Never => None,
                };
                let context = self.context(tree, ControlSets::default(), hold);
                let goal_bias = samples.then_some(self.settings.goal_bias);
                Box::new(Sampler::new(context, strategy, planner.name(), goal_bias, restart, self.distances))
            }
            Method::Portfolio | Method::Exhaustive { .. } => {
                let least = self.problem.least_hold();
                let change = if hold.0 > least { Change::Every(hold.0) } else { Change::After(least) };
                let is_best_first = matches!(planner.method(), Method::Exhaustive { is_best_first: true });
                Box::new(self.exhaustive(tree, change, is_best_first))
            }
        }
    }
}

/// Inputs that change only every few steps lead to few states, so that ways to the goal are soon found among them.
const COARSE: [u16; 3] = [10, 5, 2];

/// The sampling planners that `auto` takes in turns, with their shares of the nodes: by measurement, the first solves most
/// goals at a place soonest, the second most others, the third some that these do not. Beside them, an exhaustion with a
/// share of 1 looks for proofs.
const AUTO: [(u64, Planner); 3] = [(4, Planner::Lead), (4, Planner::Coverage), (1, Planner::Rrt)];
/// Where there is a time to keep, the first is the best by far.
const AUTO_IN_TIME: [(u64, Planner); 3] = [(16, Planner::Lead), (4, Planner::Coverage), (1, Planner::Rrt)];
/// Where distances lead nowhere, as the goal lies at no place: then places are left that are covered regardless of what
/// all others do.
const AUTO_NOWHERE: [(u64, Planner); 3] = [(4, Planner::Coverage), (2, Planner::Lead), (1, Planner::Rrt)];

/// Searchers side by side.
struct Forest<'f, 'a> {
    trees: Vec<Box<dyn Searcher + 'a>>,
    settings: &'f Settings,
    limits: &'f Limits,
    watch: &'f dyn Watch,
    /// The first run-time error before any tree has begun, with its step.
    fault: Option<(Fault, u64)>,
    /// Whether values of axes between -1, 0 and 1 can make a difference.
    reads_between: bool,
}

impl Forest<'_, '_> {
    /// Lets all trees grow in rounds. In each round all grow as much, and the lowest tree with an answer has the word, so
    /// that the result does not depend on who is faster.
    fn grow(mut self) -> Outcome {
        if self.watch.stop() {
            return self.outcome(Verdict::NotFound, End::Stopped, 0);
        }
        loop {
            let nodes: u64 = self.trees.iter().map(|t| t.nodes()).sum();
            let left = self.limits.nodes.saturating_sub(nodes);
            if left == 0 {
                return self.unanswered(End::Nodes, 0);
            }
            let bytes: usize = self.trees.iter().map(|t| t.bytes()).sum();
            if bytes as u64 > self.limits.memory {
                return self.unanswered(End::Memory, 0);
            }
            let places = self.trees.iter().map(|t| t.places()).max().unwrap_or(0);
            self.watch.progress(Progress { nodes, budget: self.limits.nodes, places });
            let share = (left / self.trees.len() as u64).clamp(1, ROUND);
            let endings = self.round(share);
            let is_spent = endings.iter().all(|e| matches!(e, Ending::Spent));
            for (tree, ending) in endings.into_iter().enumerate() {
                match ending {
                    Ending::Reached(plan) => return self.outcome(Verdict::Reached(plan), End::Answered, tree),
                    Ending::Exhausted(found) => {
                        let verdict = match self.reads_between {
                            true => Verdict::Exhausted(found),
                            false => Verdict::Unreachable(Argument::Exhaustion(found)),
                        };
                        // A start that ended in a run-time error says nothing of where it might have led.
                        let verdict = if self.fault.is_some() { Verdict::NotFound } else { verdict };
                        return self.outcome(verdict, End::Answered, tree);
                    }
                    Ending::Stopped => return self.unanswered(End::Stopped, tree),
                    Ending::Paused | Ending::Spent => {}
                }
            }
            if is_spent {
                return self.unanswered(End::Answered, 0);
            }
            if self.watch.stop() {
                return self.unanswered(End::Stopped, 0);
            }
        }
    }

    /// Lets each tree grow by `nodes` nodes, on as many threads as the settings and the system allow.
    fn round(&mut self, nodes: u64) -> Vec<Ending> {
        let threads = self.settings.threads.clamp(1, self.trees.len());
        if threads == 1 {
            return self.trees.iter_mut().map(|tree| tree.advance(nodes)).collect();
        }
        // More threads than cores only wait for each other.
        let threads = threads.min(thread::available_parallelism().map_or(1, usize::from).max(2));
        let mut endings: Vec<Option<Ending>> = self.trees.iter().map(|_| None).collect();
        let tasks = Mutex::new(self.trees.iter_mut().zip(&mut endings));
        let grow = || {
            // A thread that panics takes all with it in the end.
            let next = || tasks.lock().map_or(None, |mut tasks| tasks.next());
            while let Some((tree, ending)) = next() {
                *ending = Some(tree.advance(nodes));
            }
        };
        thread::scope(|scope| {
            for _ in 1..threads {
                // What the system does not give is not needed: the threads that there are do it all.
                if thread::Builder::new().spawn_scoped(scope, grow).is_err() {
                    break;
                }
            }
            grow();
        });
        endings.into_iter().map(|ending| ending.unwrap_or(Ending::Stopped)).collect()
    }

    /// The end of a search that has no answer yet; a way that was found already is one.
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
            cuts: notes.cuts,
            violations: notes.violations,
            record: notes.record,
            truncated: notes.is_truncated,
            fault: self.fault.or(notes.fault),
            reads_between: self.reads_between,
            refuted: None,
            is_withdrawn: false,
        }
    }
}

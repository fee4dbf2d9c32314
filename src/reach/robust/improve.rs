//! Searches for a plan that is easier for a person. Candidates are the plan that was found, simpler ones, and plans of other
//! searches: with longer holds, and with fewer inputs, such as one in which a button is never released. The best are
//! edited: changes are moved to where they succeed, pauses are put in, changes removed, the rest of a plan searched again.
//! Edits are compared on the same errors, so that few plays tell them apart.
//!
//! Of long plans hardly any play succeeds, and then no edit seems to help. So a part of the plays has smaller errors (as
//! in annealing): they succeed first, and lead to plans with which the others do, too. The move of all changes at once by
//! the mean error of the plays that succeed is the step of the cross-entropy method (Rubinstein, *The Cross-Entropy
//! Method for Combinatorial and Continuous Optimization*, 1999).

use std::ops::ControlFlow;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::analysis::ConfigurationSpace;
use crate::ir::Extremes;
use crate::ordered::Ordered;
use crate::parallel::{self, TaskContext};
use crate::watch::{Meter, Progress, Watch};

use super::super::coverage::mix;
use super::super::outcome::{Plan, Verdict};
use super::super::problem::Problem;
use super::super::restriction::Restriction;
use super::super::search::{Limits, Settings, search};
use super::super::shorten::{MAX_STEPS, shorten_within};
use super::super::start_hold::is_held;
use super::super::style::Style;
use super::Course;
use super::crowd::{self, Crowd};
use super::edit::{Cause, edit, follow, pick};
use super::guide::Guide;
use super::jitter::Jitter;
use super::play::{Ending, Nature, Plays};
use super::timeline::{Change, Timeline};

/// Errors of plays in units of the standard deviation, in turn.
const SCALES: [f64; 4] = [1.0, 1.0, 0.5, 0.25];
/// Number of plays by which plans are compared, at first and at last.
const PLAYS: (u64, u64) = (256, 1024);
/// Number of edits that are tried side by side.
const EDITS: usize = 8;
/// Number of rounds without a better plan after which more plays are needed to find one.
const PATIENCE: u32 = 8;
/// Number of searches for other plans, and minimum holds of the plans, steps, in turn.
const SEARCHES: usize = 24;
const HOLDS: [u16; 5] = [10, 20, 15, 6, 30];
/// Number of plays by which other plans are compared at first, and number of those that are compared further.
const FIRST_PLAYS: u64 = 32;
const FINALISTS: usize = 4;
/// Number of plans that are edited in turn at first.
const POOL: usize = 3;
/// Maximum number of nodes of a search for another plan, and for the rest of one.
const NODES: (u64, u64) = (20_000, 2_000);
/// Simulated steps for each node of the budget.
const STEPS_PER_NODE: u64 = 200;
/// The share of plays that is good enough.
const ENOUGH: f64 = 0.998;
/// The share of plays from which on errors need not be smaller.
const EASY: f64 = 0.05;
/// Maximum number of steps, times the number of parts, of a plan that is shortened: each part takes a few replays.
const SHORTENED: u64 = 50_000;
/// Salts of seeds.
const CROWDS: u64 = 0x6372_6f77_6473;
const SEARCH: u64 = 0x726f_6275_7374;
const CHOICE: u64 = 0x6368_6f69_6365;

/// The result of a search for an easier plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Improved {
    /// The plan; the first one if none is better.
    pub plan: Plan,
    /// Number of plans that were compared.
    pub compared: u64,
}

/// Searches for a plan that succeeds more often under timing errors than the given one. Its result is the same on any
/// number of threads.
pub fn improve_robustness(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    (settings, limits): (&Settings, &Limits),
    plan: &Plan,
    jitter: &Jitter,
    watch: &dyn Watch,
) -> Improved {
    let unchanged = Improved { plan: plan.clone(), compared: 1 };
    let Some(course) = Course::new(problem, plan, watch) else { return unchanged };
    let jitters = SCALES.map(|scale| Jitter::new(jitter.sigma() * scale));
    let budget = limits.nodes.saturating_mul(STEPS_PER_NODE);
    let first = Timeline::new(problem.sim.world(), plan);
    let mut improver = Improver {
        course,
        space,
        settings,
        limits,
        jitters,
        watch,
        seed: mix(settings.seed, SEARCH),
        round: 0,
        spent: 0,
        budget,
        compared: 1,
        is_easy: false,
        known: None,
    };
    let ended = improver.run(&first, plan);
    let is_stopped = ended.is_none();
    let Some(best) = ended.or_else(|| improver.known.take()) else { return unchanged };
    improver.is_easy = true;
    let compared = improver.compared;
    // Chosen by plays that neither plan was edited by.
    let choice = mix(settings.seed, CHOICE);
    let count = |timeline: &Timeline| improver.wins(timeline, choice, PLAYS.1, None, &mut 0);
    // If it is stopped, the plan that was the best so far.
    if !is_stopped {
        let (Some(Ok(old)), Some(Ok(new))) = (count(&first), count(&best)) else { return unchanged };
        if new.count <= old.count {
            return Improved { compared, ..unchanged };
        }
    }
    let script = match problem.sim.draws() {
        [] => best.script(),
        _ => match super::super::luck::only_read(problem, &best.script(), plan.after, &Meter::new(watch)) {
            Some(script) => script,
            None => return Improved { compared, ..unchanged },
        },
    };
    let is_shortest = plan.is_shortest && script.len() == plan.steps;
    Improved { plan: Plan { steps: script.len(), script, after: plan.after, is_shortest }, compared }
}

/// The plays of a plan that succeeded.
#[derive(Debug, Clone)]
struct Wins {
    of: Vec<bool>,
    count: usize,
}

/// A plan and its plays.
#[derive(Debug, Clone)]
struct Candidate {
    timeline: Timeline,
    wins: Wins,
}

/// Worse than the plan that it is compared with.
struct Worse;

struct Improver<'a> {
    course: Course<'a>,
    space: &'a ConfigurationSpace,
    settings: &'a Settings,
    limits: &'a Limits,
    /// One for each of [`SCALES`].
    jitters: [Jitter; SCALES.len()],
    watch: &'a dyn Watch,
    seed: u64,
    /// Number of rounds so far.
    round: u64,
    /// Simulated steps.
    spent: u64,
    budget: u64,
    compared: u64,
    /// Whether plays have true errors only.
    is_easy: bool,
    /// The best plan so far.
    known: Option<Timeline>,
}

impl Improver<'_> {
    /// The best plan; `None` if there is only the first.
    fn run(&mut self, first: &Timeline, plan: &Plan) -> Option<Timeline> {
        let mut pool = self.candidates(first, plan)?;
        if pool.len() == 1 && pool.first().is_some_and(|only| only.timeline.changes.is_empty()) {
            return None;
        }
        pool.order_by_key(Candidate::rank);
        self.note(pool.first());
        self.gather(&mut pool, first)?;
        self.note(pool.first());
        pool.truncate(POOL);
        // With true errors, if so many succeed that edits can be told apart.
        self.is_easy = pool.first().is_some_and(|best| best.share() > EASY);
        let plans = pool.into_iter().map(|candidate| candidate.timeline).collect();
        let mut pool: Vec<Candidate> = self.compare(plans, (self.seed, PLAYS.0), None)?.into_iter().flatten().collect();
        let share = self.budget.saturating_sub(self.spent) / 8;
        for candidate in &mut pool {
            let until = self.spent + share;
            self.climb(candidate, (self.seed, PLAYS.0), until)?;
        }
        let mut best = pool.into_iter().reduce(|a, b| if b.wins.count > a.wins.count { b } else { a })?;
        self.note(Some(&best));
        // With ever more plays, each time others: a plan must not be good at some errors only.
        let mut plays = PLAYS.0;
        while self.spent < self.budget && best.share() < ENOUGH && !self.watch.stop() {
            let seed = mix(self.seed, plays);
            let mut spent = 0;
            let Some(Ok(wins)) = self.wins(&best.timeline, seed, plays, None, &mut spent) else { break };
            self.spent += spent;
            best.wins = wins;
            self.climb(&mut best, (seed, plays), self.budget);
            self.note(Some(&best));
            if plays >= PLAYS.1 {
                break;
            }
            plays *= 2;
        }
        Some(best.timeline)
    }

    fn note(&mut self, best: Option<&Candidate>) {
        self.known = best.map(|best| best.timeline.clone());
    }

    /// The scale of the errors of a play.
    fn scale(&self, trial: u64) -> usize {
        if self.is_easy { 0 } else { trial as usize % SCALES.len() }
    }

    /// Adds plans with which a crowd arrives, and puts the best first.
    fn gather(&mut self, pool: &mut Vec<Candidate>, first: &Timeline) -> Option<()> {
        let mut guides: Vec<Timeline> = pool.iter().take(1).map(|candidate| candidate.timeline.clone()).collect();
        let quickest = pool.iter().min_by_key(|candidate| candidate.timeline.steps);
        guides.extend(quickest.map(|candidate| candidate.timeline.clone()).filter(|plan| !guides.contains(plan)));
        let mut plans = Vec::new();
        let left = self.budget.saturating_sub(self.spent) * 3 / 4;
        let each = left.max(self.budget / 4) / guides.len().max(1) as u64;
        for (guide, seed) in guides.iter().zip(1..) {
            let meter = Meter::new(self.watch);
            let course = &self.course;
            let points = course.checkpoints(guide, &meter)?.states();
            let reach = crowd::earliest(&self.jitters[0]) as f64;
            let Some(guide) = Guide::new(course.problem, crowd::controls(course), guide, points, reach) else {
                continue;
            };
            let crowd = Crowd {
                course,
                guide,
                jitter: &self.jitters[0],
                seed: mix(self.seed, seed),
                threads: self.settings.threads,
                budget: (each, self.limits.memory / 4),
                shown: (STEPS_PER_NODE, self.limits.nodes),
                watch: self.watch,
            };
            let (found, steps) = crowd.search(first);
            plans.extend(found);
            self.spent += steps;
        }
        self.is_easy = true;
        plans.extend(pool.iter().map(|candidate| candidate.timeline.clone()));
        let seed = mix(self.seed, CROWDS);
        let mut tried: Vec<Candidate> =
            self.compare(plans, (seed, 3 * FIRST_PLAYS), None)?.into_iter().flatten().collect();
        if !tried.is_empty() {
            tried.order_by_key(Candidate::rank);
            *pool = tried;
        }
        self.is_easy = false;
        (!self.watch.stop()).then_some(())
    }

    /// The first plan and others.
    fn candidates(&mut self, first: &Timeline, plan: &Plan) -> Option<Vec<Candidate>> {
        let problem = self.course.problem;
        let (settings, space, watch) = (self.settings, self.space, self.watch);
        let limits = Limits { nodes: (self.limits.nodes / 16).clamp(1, NODES.0), ..*self.limits };
        let task = |index: usize, context: &TaskContext<'_, (Vec<Plan>, u64)>| {
            let (found, mut steps) = match index {
                0 => (Some(plan.clone()), 0),
                _ => {
                    let hold = HOLDS[index % HOLDS.len()].max(problem.min_hold());
                    let settings = Settings { seed: mix(settings.seed, index as u64), ..quiet(settings) };
                    let problem = problem.clone().holding(hold);
                    // With few inputs there are few changes.
                    let restriction = match index % 4 {
                        0 => Restriction::none(problem.sim),
                        _ => Restriction::drawn(problem.sim, mix(settings.seed, index as u64)),
                    };
                    let problem = problem.restricted(restriction);
                    match search(&problem, space, &settings, &limits, watch) {
                        Ok(outcome) => (found(outcome.verdict), outcome.statistics.steps),
                        Err(_) => (None, 0),
                    }
                }
            };
            let mut plans = Vec::new();
            if let Some(plan) = found {
                let parts = plan.script.steps.len() as u64;
                if parts * plan.steps <= SHORTENED {
                    let simple = shorten_within(problem, None, &plan, Style::Fast, MAX_STEPS, watch);
                    steps += parts * plan.steps;
                    plans.push(simple);
                }
                plans.push(plan);
            }
            context.submit((plans, steps));
        };
        let mut all: Vec<Vec<Plan>> = vec![Vec::new(); SEARCHES + 1];
        let stop = || watch.stop();
        let mut spent = 0;
        parallel::work(all.len(), settings.threads, &stop, &task, &mut |index, (plans, steps)| {
            all[index] = plans;
            spent += steps;
            ControlFlow::Continue(())
        });
        self.spent += spent;
        let mut timelines: Vec<Timeline> = vec![first.clone()];
        for plan in all.iter().flatten().filter(|plan| plan.after == first.after) {
            let timeline = Timeline::new(problem.sim.world(), plan);
            if timelines.iter().all(|known| known.script() != timeline.script()) {
                timelines.push(timeline);
            }
        }
        let mut tried: Vec<Candidate> =
            self.compare(timelines, (self.seed, FIRST_PLAYS), None)?.into_iter().flatten().collect();
        tried.order_by_key(Candidate::rank);
        tried.truncate(FINALISTS);
        let finalists = tried.into_iter().map(|candidate| candidate.timeline).collect();
        Some(self.compare(finalists, (self.seed, PLAYS.0), None)?.into_iter().flatten().collect())
    }

    /// Plays some plans; `None` for those that do not reach the target, or are worse than another.
    fn compare(
        &mut self,
        plans: Vec<Timeline>,
        (seed, plays): (u64, u64),
        than: Option<&Wins>,
    ) -> Option<Vec<Option<Candidate>>> {
        self.compared += plans.len() as u64;
        let this = &*self;
        let mut results: Vec<Option<Candidate>> = vec![None; plans.len()];
        let task = |index: usize, context: &TaskContext<'_, (Option<Candidate>, u64)>| {
            let mut spent = 0;
            let candidate = this.candidate(&plans[index], (seed, plays), than, &mut spent);
            context.submit((candidate, spent));
        };
        let stop = || this.watch.stop();
        let mut spent = 0;
        parallel::work(plans.len(), this.settings.threads, &stop, &task, &mut |index, (result, steps)| {
            results[index] = result;
            spent += steps;
            ControlFlow::Continue(())
        });
        self.spent += spent;
        let nodes = self.spent / STEPS_PER_NODE;
        self.watch.progress(Progress { nodes, budget: self.limits.nodes, places: 0 });
        (!self.watch.stop()).then_some(results)
    }

    /// A plan, cut where it reaches the target, with its plays; `None` if it does not, or if it is worse.
    fn candidate(
        &self,
        timeline: &Timeline,
        (seed, plays): (u64, u64),
        than: Option<&Wins>,
        spent: &mut u64,
    ) -> Option<Candidate> {
        let problem = self.course.problem;
        let (mut play, meter) = (Plays::new(problem), Meter::new(self.watch));
        timeline.times(&vec![0; timeline.changes.len()], &mut play.times);
        let until = self.course.until(timeline);
        let ending = play.play(timeline, self.course.start(), until, Nature::Planned, &meter);
        *spent += play.steps;
        let Ending::Reached(steps) = ending else { return None };
        let changes = timeline.changes.iter().filter(|change| change.step < steps).copied().collect();
        let timeline = timeline.with(changes, steps);
        if problem.min_hold() > 1 && !is_held(&timeline.script(), timeline.after, problem.min_hold()) {
            return None;
        }
        let wins = self.wins(&timeline, seed, plays, than, spent)?.ok()?;
        Some(Candidate { timeline, wins })
    }

    /// The plays of a plan that succeed; `None` if the watch stops them, and [`Worse`] as soon as it is clear that fewer do
    /// than of another plan.
    fn wins(
        &self,
        timeline: &Timeline,
        seed: u64,
        plays: u64,
        than: Option<&Wins>,
        spent: &mut u64,
    ) -> Option<Result<Wins, Worse>> {
        let (mut play, meter, mut errors) = (Plays::new(self.course.problem), Meter::new(self.watch), Vec::new());
        let until = self.course.until(timeline);
        let mut wins = Wins { of: Vec::with_capacity(plays as usize), count: 0 };
        let (mut gained, mut lost) = (0_u32, 0_u32);
        for trial in 0..plays {
            let jitter = &self.jitters[self.scale(trial)];
            errors.clear();
            errors.extend(timeline.changes.iter().map(|change| jitter.draw(seed, trial, u64::from(change.key))));
            timeline.times(&errors, &mut play.times);
            let before = play.steps;
            let ending = play.play(timeline, self.course.start(), until, Nature::Anew(mix(seed, trial)), &meter);
            *spent += play.steps - before;
            let is_won = match ending {
                Ending::Reached(_) => true,
                Ending::Over | Ending::Late => false,
                Ending::Stopped => return None,
            };
            wins.of.push(is_won);
            wins.count += usize::from(is_won);
            let Some(than) = than else { continue };
            let other = than.of.get(trial as usize).copied().unwrap_or(false);
            gained += u32::from(is_won && !other);
            lost += u32::from(other && !is_won);
            // As in McNemar's test.
            let (gap, spread) = (f64::from(lost) - f64::from(gained), f64::from(lost + gained).sqrt());
            let is_hopeless = wins.count + (plays - trial - 1) as usize <= than.count.saturating_sub(1);
            if is_hopeless || trial >= 24 && gap > 2.0 * spread {
                return Some(Err(Worse));
            }
        }
        Some(Ok(wins))
    }

    /// Edits a plan as long as that helps; `None` if the watch stops it.
    fn climb(&mut self, best: &mut Candidate, (seed, plays): (u64, u64), until: u64) -> Option<()> {
        let mut idle = 0;
        while idle < PATIENCE && self.spent < until.min(self.budget) && best.share() < ENOUGH {
            self.round += 1;
            let edits = self.edits(best, seed)?;
            let tried = self.compare(edits, (seed, plays), Some(&best.wins))?;
            let old = best.wins.count;
            for candidate in tried.into_iter().flatten() {
                if candidate.rank() < best.rank() {
                    *best = candidate;
                }
            }
            // What is merely simpler, or better by a single play, is taken, but is no reason to go on for long.
            idle = if best.wins.count > old { 0 } else { idle + 1 };
        }
        Some(())
    }

    /// Edits of a plan; `None` if the watch stops it.
    fn edits(&mut self, best: &Candidate, seed: u64) -> Option<Vec<Timeline>> {
        let mut rng = Pcg64::seed_from_u64(mix(self.seed, self.round));
        let changes = &best.timeline.changes;
        if changes.is_empty() {
            return Some(vec![best.timeline.clone()]);
        }
        let causes = self.causes(best, seed);
        let gain = [1.0, 0.5, 2.0][rng.random_range(0..3)];
        let mut all = vec![follow(&best.timeline, &causes, gain)];
        for _ in 2..EDITS {
            let at = pick(&causes, &mut rng);
            all.push(edit(&best.timeline, at, &mut rng));
        }
        // The rest of the plan once more, from a little before.
        let at = pick(&causes, &mut rng);
        let back = rng.random_range(0..=6.min(at));
        let again = self.searched_again(&best.timeline, changes[at - back].step);
        if let Some((timeline, steps)) = again {
            self.spent += steps;
            all.push(timeline);
        }
        (!self.watch.stop()).then_some(all)
    }

    /// A plan that begins as a plan does up to a step, and goes on differently; and the simulated steps.
    fn searched_again(&self, plan: &Timeline, step: u64) -> Option<(Timeline, u64)> {
        let (problem, limits) = (self.course.problem, self.limits);
        let limits = Limits { nodes: (limits.nodes / 64).clamp(1, NODES.1), ..*limits };
        let left = problem.time().map(|most| most.saturating_sub((step - plan.after) as u32));
        let mut rest = problem.clone().restarted(plan.script().first(step), self.watch).ok()?;
        if let Some(left) = left {
            rest = rest.within(left);
        }
        let settings = Settings { seed: mix(self.seed, self.round), ..quiet(self.settings) };
        let outcome = search(&rest, self.space, &settings, &limits, self.watch).ok()?;
        let steps = outcome.statistics.steps;
        let whole = Plan { after: plan.after, ..found(outcome.verdict)? };
        Some((Timeline::new(problem.sim.world(), &whole), steps))
    }

    /// For each change how much it has to do with failures, and by how many steps plays that succeed are late, on average.
    fn causes(&self, best: &Candidate, seed: u64) -> Vec<Cause> {
        let (wins, all) = (best.wins.count as f64, best.wins.of.len() as f64);
        let cause = |change: &Change| {
            let (mut late, mut won, mut lost) = (0.0, 0.0, 0.0);
            for (trial, is_won) in (0..).zip(&best.wins.of) {
                let error = f64::from(self.jitters[self.scale(trial)].draw(seed, trial, u64::from(change.key)));
                if *is_won {
                    late += error;
                    won += error * error;
                } else {
                    lost += error * error;
                }
            }
            let spread = |sum: f64, count: f64| if count > 0.0 { sum / count } else { 0.0 };
            let (mean, variance) = (spread(late, wins), spread(won, wins));
            let noise = (variance / wins.greatest(1.0)).sqrt();
            let weight = (spread(lost, all - wins) - variance).greatest(0.0);
            Cause { weight, late: if mean.abs() > 1.5 * noise { mean } else { 0.0 } }
        };
        best.timeline.changes.iter().map(cause).collect()
    }
}

impl Candidate {
    /// The less, the better: most plays that succeed, then the fewest changes, then the fewest steps.
    fn rank(&self) -> (usize, usize, u64) {
        (usize::MAX - self.wins.count, self.timeline.changes.len(), self.timeline.steps)
    }

    fn share(&self) -> f64 {
        self.wins.count as f64 / self.wins.of.len().max(1) as f64
    }
}

/// Settings of searches whose trees nobody sees.
fn quiet(settings: &Settings) -> Settings {
    Settings { records: false, trees: 1, threads: 1, ..*settings }
}

fn found(verdict: Verdict) -> Option<Plan> {
    match verdict {
        Verdict::Reached(plan) => Some(plan),
        Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
    }
}

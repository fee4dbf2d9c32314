//! A session answers questions about one world: it analyses the world once, searches for each target, reuses paths
//! between targets, and checks every state created on the way against the analysis.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::analysis::{ConfigurationSpace, watched_space};
use crate::ir::{ExprId, NeverId, Program, World, WorldId};
use crate::sim::{Fault, Script, Simulator};
use crate::source::SourceMap;
use crate::watch::{Meter, Unwatched, Watch};

use super::super::exchange::plan_from_script;
use super::super::explore::Observer;
use super::super::luck::only_read;
use super::super::monitor::{Monitor, Refutation};
use super::super::outcome::{End, Outcome, Plan, Verdict};
use super::super::planners::Planner;
use super::super::probability::Luck;
use super::super::problem::{BadStart, Problem, Target, Termination};
use super::super::proof::least_steps;
use super::super::reach;
use super::super::robust::{Improved, Jitter};
use super::super::search::{Limits, Settings, search};
use super::super::shortcuts::{Effort, take_shortcuts};
use super::super::shorten::shorten;
use super::super::style::{Style, improve_style};
use super::super::why_not::{WhyNot, explain};
use super::answer::{Answer, Counterexample};
use super::robust::{FoundRobust, RobustRecord, TimingErrors};
use super::wording::unpressed_words;

/// Number of nodes of the search that looks for what comes nearest to a goal that is proven unreachable.
const SAMPLE_NODES: u64 = 2_000;

/// The questions about a world, and the search settings.
#[derive(Debug, Clone)]
pub struct Query {
    /// The goals to reach and the `never`s to break, in the order of the answers.
    pub targets: Vec<Target>,
    /// Search settings.
    pub settings: Settings,
    /// Limits of each search.
    pub limits: Limits,
    /// Minimum number of steps for which each input is held.
    pub min_hold: u16,
    /// Maximum number of steps of a path from the start of the search; `None`: no limit.
    pub within: Option<u32>,
    /// `never`s that a path must not break; counterexamples to them are not reported.
    pub without: Vec<NeverId>,
    /// For each player, buttons that no input of a path holds; empty: none.
    pub unpressed: Vec<u64>,
    /// `never`s that are questions only: they end no run.
    pub asked: Vec<NeverId>,
    /// Scripts whose ends are the starts of searches; if empty, the initial state.
    pub after: Vec<Script>,
    /// How paths are made better; `None`: they are not.
    pub style: Option<Style>,
    /// The seed of what nature draws; `None`: a search is free to choose it.
    pub chance: Option<u64>,
    /// Timing errors that paths to goals should withstand; counterexamples are for no person.
    pub errors: Option<TimingErrors>,
}

impl Query {
    /// The problem for a target; `None` if the watch stopped the replay of a start.
    ///
    /// [`QueryError`] if a start leads nowhere.
    pub fn problem<'s>(
        &self,
        sim: &'s Simulator,
        target: Target,
        watch: &dyn Watch,
    ) -> Result<Option<Problem<'s>>, QueryError> {
        let Query { min_hold, within, without, unpressed, asked, after, .. } = self;
        let mut problem = Problem::asking(sim, target).holding(*min_hold).asking_only(asked);
        problem = problem.never_pressing(unpressed.clone());
        if let Some(seed) = self.chance {
            problem = problem.foretold(seed);
        }
        for never in without {
            problem = problem.without(sim.world().nevers[*never].holds);
        }
        if let Some(steps) = within {
            problem = problem.within(*steps);
        }
        for (index, script) in after.iter().enumerate() {
            problem = match problem.after_watched(script.clone(), watch) {
                Ok(problem) => problem,
                Err(BadStart::Stopped) => return Ok(None),
                Err(BadStart::Fault(fault, step)) => return Err(QueryError::Fault(fault, step)),
                Err(BadStart::Over(reason, step)) => return Err(QueryError::Over { script: index, reason, step }),
            };
        }
        Ok(Some(problem))
    }

    /// The predicates of the `never`s of a world that end a run.
    pub fn rules(&self, world: &World) -> Vec<ExprId> {
        let nevers = world.nevers.pairs().filter(|(id, _)| !self.asked.contains(id));
        nevers.map(|(_, never)| never.holds).collect()
    }

    /// The plan that a script gives for the first target: cut where that holds, after the steps that were given.
    pub fn plan_of(&self, problem: &Problem<'_>, script: &Script, watch: &dyn Watch) -> Option<Plan> {
        plan_from_script(problem, script, self.given_steps(script)?, watch)
    }

    /// Number of steps at the start of a script that were given with the query; `None` if it starts elsewhere.
    fn given_steps(&self, script: &Script) -> Option<u64> {
        let after = &self.after;
        if after.is_empty() {
            return Some(0);
        }
        after.iter().filter(|given| script.first(given.len()) == **given).map(Script::len).max()
    }

    /// A query with the default settings and limits.
    pub fn new(targets: Vec<Target>) -> Self {
        Query {
            targets,
            settings: Settings::default(),
            limits: Limits::default(),
            min_hold: 1,
            within: None,
            without: Vec::new(),
            unpressed: Vec::new(),
            asked: Vec::new(),
            after: Vec::new(),
            style: None,
            chance: None,
            errors: None,
        }
    }
}

/// Why a question cannot be answered at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum QueryError {
    /// A run-time error at a step, 0 in the initial state.
    Fault(Fault, u64),
    /// The run of one of the scripts in [`Query::after`] is over at a step.
    Over {
        /// The index of the script.
        script: usize,
        /// Why the run is over.
        reason: Termination,
        /// The step; 0: before the first.
        step: u64,
    },
}

/// The current activity of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Searches for a target.
    Search(Target),
    /// Replays the path to one target to answer others.
    Exchange,
    /// Makes a path better in the style that is asked for.
    Minimize(Target),
    /// Searches for a path that withstands timing errors.
    MakeRobust(Target),
    /// Measures how well it does.
    MeasureRobust(Target),
}

/// Provides a watch for each phase of a session, and may measure its time.
pub trait Supervisor {
    /// Runs the work of a phase under a watch. Breaks if the session should end after it.
    fn supervise(&mut self, phase: Phase, work: &mut dyn FnMut(&dyn Watch)) -> ControlFlow<()>;
}

/// One watch for all phases.
impl Supervisor for &dyn Watch {
    fn supervise(&mut self, _: Phase, work: &mut dyn FnMut(&dyn Watch)) -> ControlFlow<()> {
        work(*self);
        if self.stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// A world with everything that the questions about it share.
pub struct Session {
    query: Query,
    sim: Simulator,
    space: ConfigurationSpace,
    /// Checks the states created for any of the questions.
    monitor: Option<Monitor>,
}

/// The result for a target.
pub struct Found<'s> {
    /// The target.
    pub target: Target,
    /// The outcome of the search.
    pub outcome: Outcome,
    /// How robust the path is, if that was asked and there is a path; `None` if it was stopped before.
    pub robust: Option<FoundRobust>,
    /// `None` if the search was stopped before it started.
    problem: Option<Problem<'s>>,
}

impl Found<'_> {
    fn plan(&self) -> Option<&Plan> {
        match &self.outcome.verdict {
            Verdict::Reached(plan) => Some(plan),
            Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
        }
    }
}

impl Session {
    /// Analyses a world; if the watch stops it, everything counts as possible.
    pub fn new(program: &Arc<Program>, world: WorldId, query: Query, watch: &dyn Watch) -> Self {
        let space = watched_space(program, world, &query.rules(&program.worlds[world]), watch);
        Session::with_space(program, world, query, space)
    }

    /// Uses a configuration space that was computed before.
    pub fn with_space(program: &Arc<Program>, world: WorldId, query: Query, space: ConfigurationSpace) -> Self {
        let monitor = query.settings.checks.then(|| Monitor::new(&space, program, world));
        Session { query, sim: Simulator::new(program, world), space, monitor }
    }

    /// The query.
    pub fn query(&self) -> &Query {
        &self.query
    }

    /// The simulator of the world.
    pub fn simulator(&self) -> &Simulator {
        &self.sim
    }

    /// The configuration space on which proofs rest.
    pub fn space(&self) -> &ConfigurationSpace {
        &self.space
    }

    /// A run into a state that the analysis excludes, if a search has met one: the analysis is wrong about this world.
    pub fn refutation(&self) -> Option<Refutation> {
        self.monitor.as_ref().and_then(Monitor::refutation)
    }

    /// Searches for all targets; fewer results than targets if the supervisor ends it.
    ///
    /// [`QueryError`] if no target can be searched for.
    pub fn find_all(&self, supervisor: &mut dyn Supervisor) -> Result<Vec<Found<'_>>, QueryError> {
        let mut all: Vec<Found<'_>> = Vec::new();
        for &target in &self.query.targets {
            let mut found = None;
            let search = &mut |watch: &dyn Watch| found = Some(self.search((target, None), watch));
            let flow = supervisor.supervise(Phase::Search(target), search);
            all.extend(found.transpose()?);
            if flow.is_break() {
                return Ok(all);
            }
        }
        let _ = supervisor.supervise(Phase::Exchange, &mut |watch| {
            self.exchange(&mut all, watch);
        });
        if self.query.style.is_some() {
            for found in &mut all {
                let _ = supervisor.supervise(Phase::Minimize(found.target), &mut |watch| self.minimize(found, watch));
            }
            let _ = supervisor.supervise(Phase::Exchange, &mut |watch| {
                // Each round shortens a path.
                while self.exchange(&mut all, watch) {
                    all.iter_mut().for_each(|found| self.shorten(found, watch));
                }
            });
        }
        if let Some(errors) = self.query.errors {
            for found in all.iter_mut().filter(|found| matches!(found.target, Target::Goal(_))) {
                let (target, mut improved) = (found.target, None);
                let _ = supervisor.supervise(Phase::MakeRobust(target), &mut |watch| {
                    improved = self.improve(found, errors, watch);
                });
                let _ = supervisor.supervise(Phase::MeasureRobust(target), &mut |watch| {
                    self.measure(found, errors, improved.take(), watch);
                });
            }
        }
        Ok(all)
    }

    /// Searches for one target independently of the others.
    ///
    /// [`QueryError`] if the target cannot be searched for.
    pub fn find(&self, target: Target, watch: &dyn Watch) -> Result<Found<'_>, QueryError> {
        let mut found = self.search((target, None), watch)?;
        if self.query.style.is_some() {
            self.minimize(&mut found, watch);
        }
        if let Some(errors) = self.query.errors.filter(|_| matches!(target, Target::Goal(_))) {
            let improved = self.improve(&found, errors, watch);
            self.measure(&mut found, errors, improved, watch);
        }
        Ok(found)
    }

    /// Searches without the analysis for the first target, and shows each state on the way to an observer. For a target
    /// that nothing reaches, it goes wherever it can.
    ///
    /// [`QueryError`] if it cannot be searched.
    pub fn explore(&self, observer: &dyn Observer, watch: &dyn Watch) -> Result<Outcome, QueryError> {
        match self.query.targets.first() {
            Some(target) => self.wander(*target, observer, watch),
            None => Ok(Outcome::stopped(self.query.settings.planner)),
        }
    }

    /// The same for any target, by the planner `coverage` instead of `auto`.
    ///
    /// [`QueryError`] if it cannot be searched.
    pub fn wander(&self, target: Target, observer: &dyn Observer, watch: &dyn Watch) -> Result<Outcome, QueryError> {
        let Query { settings, limits, .. } = &self.query;
        let planner = if settings.planner == Planner::Auto { Planner::Coverage } else { settings.planner };
        let Some(problem) = self.problem(target, watch)? else { return Ok(Outcome::stopped(planner)) };
        let settings = Settings { planner, explains: false, ..*settings };
        let problem = problem.observed(observer);
        search(&problem, &self.space, &settings, limits, watch).map_err(|fault| QueryError::Fault(fault, 0))
    }

    /// Searches for one target, and shows each state on the way to an observer.
    ///
    /// [`QueryError`] if the target cannot be searched for.
    pub fn find_observed<'s>(
        &'s self,
        target: Target,
        observer: &'s dyn Observer,
        watch: &dyn Watch,
    ) -> Result<Found<'s>, QueryError> {
        self.search((target, Some(observer)), watch)
    }

    /// The answer. Call it after all targets have been searched for: one search can withdraw the proof of another.
    pub fn answer(&self, found: &mut Found<'_>, sources: &SourceMap) -> Answer {
        if let Some(refutation) = self.refutation() {
            found.outcome.refute(&refutation);
        }
        let (program, world) = (self.sim.program(), self.sim.world_id());
        let violations = found.outcome.violations.iter().filter(|(never, _)| !self.query.without.contains(never));
        let violations = violations.map(|(never, script)| {
            let problem = found.problem.as_ref().map(|problem| problem.clone().of(Target::Never(*never)));
            // Only what is read of all that nature drew in the search.
            let kept = self.query.given_steps(script).unwrap_or(0);
            let read = problem.as_ref().filter(|_| !self.sim.draws().is_empty());
            let read = read.and_then(|problem| only_read(problem, script, kept, &Meter::new(&Unwatched)));
            let script = read.as_ref().unwrap_or(script);
            Counterexample {
                never: self.sim.world().nevers[*never].name.clone(),
                steps: script.len(),
                inputs: script.text(program, world),
                luck: problem.and_then(|problem| Luck::chosen(&problem, script, kept)),
            }
        });
        let violations = violations.collect();
        let luck =
            found.problem.as_ref().zip(found.plan()).and_then(|(p, plan)| Luck::chosen(p, &plan.script, plan.after));
        let spaces = found.problem.as_ref().zip(found.plan()).map(|(p, plan)| self.spaces_after(p, &plan.script));
        let spaces = spaces.unwrap_or_default();
        let why_not = self.why_not(found, sources);
        let errors = self.query.errors.zip(found.robust.as_ref());
        let robust = errors.map(|(errors, robust)| RobustRecord::new(&self.sim, errors, robust));
        let mut answer = Answer::new(&self.sim, sources, found.target, &found.outcome);
        if answer.states.is_some()
            && let Some(unpressed) = unpressed_words(program, self.sim.world(), &self.query.unpressed)
        {
            answer.reasons.push(format!("inputs with {unpressed} were not tried, as asked"));
        }
        if let Some(least) = self.least_steps(found) {
            let is_shortest = self.query.after.len() <= 1 && answer.steps == Some(least);
            answer.least_steps = Some(least);
            answer.is_shortest = answer.is_shortest.map(|known| known || is_shortest);
        }
        Answer { violations, luck, spaces, why_not, robust, ..answer }
    }

    /// A lower bound of the number of steps to a goal that was reached, from where its path begins, if the analysis knows
    /// one.
    fn least_steps(&self, found: &Found<'_>) -> Option<u64> {
        let (problem, plan) = (found.problem.as_ref()?, found.plan()?);
        if self.refutation().is_some() {
            return None;
        }
        let least = least_steps(problem, &self.space, plan.steps - plan.after, &Unwatched).ok()??;
        Some(plan.after + least)
    }

    /// What came nearest to a target that was not reached, if the search kept it.
    fn why_not(&self, found: &Found<'_>, sources: &SourceMap) -> Option<WhyNot> {
        let (problem, nearest) = (found.problem.as_ref()?, found.outcome.nearest.as_ref()?);
        let is_wanted = match (&found.outcome.verdict, found.target) {
            (Verdict::Reached(_), _) | (Verdict::Unreachable(_), Target::Never(_)) => false,
            (Verdict::NotFound | Verdict::Exhausted(_) | Verdict::Unreachable(_), _) => true,
        };
        if !is_wanted {
            return None;
        }
        let script = nearest.whole.as_ref().map(|near| &near.script)?;
        let kept = self.query.given_steps(script).unwrap_or(0);
        explain(problem, sources, (nearest, found.outcome.statistics.nodes), kept, &Meter::new(&Unwatched))
    }

    /// The spaces that the players are in after a script, each once.
    fn spaces_after(&self, problem: &Problem<'_>, script: &Script) -> Vec<String> {
        let mut scratch = self.sim.scratch();
        let Ok(mut state) = self.sim.initial(&mut scratch) else { return Vec::new() };
        for (input, step) in script.inputs().zip(1..) {
            if self.sim.step(&mut state, &problem.draw(step, input), &mut scratch).is_err() {
                return Vec::new();
            }
        }
        let mut spaces: Vec<String> = Vec::new();
        for &slot in problem.players() {
            let name = &self.sim.world().spaces[self.sim.space(&state, slot)].name;
            if !spaces.contains(name) {
                spaces.push(name.clone());
            }
        }
        spaces
    }

    fn search<'s>(
        &'s self,
        (target, observer): (Target, Option<&'s dyn Observer>),
        watch: &dyn Watch,
    ) -> Result<Found<'s>, QueryError> {
        let Query { settings, limits, .. } = &self.query;
        let Some(problem) = self.problem(target, watch)? else {
            return Ok(Found { target, problem: None, robust: None, outcome: Outcome::stopped(settings.planner) });
        };
        let problem = match observer {
            Some(observer) => problem.observed(observer),
            None => problem,
        };
        let is_free = settings.planner == Planner::Auto && settings.hold.is_none();
        let is_for_speed = self.query.style.is_none_or(|style| style == Style::Fast);
        let hastens = is_free && is_for_speed && observer.is_none();
        let settings = &Settings { hastens, ..*settings };
        let mut outcome = reach(&problem, &self.space, settings, limits, watch).map_err(|f| QueryError::Fault(f, 0))?;
        if hastens && let Verdict::Reached(plan) = &outcome.verdict {
            let effort = Effort::Brief(outcome.statistics.steps);
            outcome.verdict = Verdict::Reached(take_shortcuts(&problem, plan, effort, watch));
        }
        // If a search came before the proof, what it came nearest to is known.
        let is_unexplained = outcome.rests_on_analysis() && outcome.nearest.is_none();
        if settings.explains && matches!(target, Target::Goal(_)) && is_unexplained {
            let limits = Limits { nodes: limits.nodes.min(SAMPLE_NODES), ..*limits };
            let settings = Settings { records: false, planner: Planner::Auto, ..*settings };
            let sample =
                search(&problem, &self.space, &settings, &limits, watch).map_err(|f| QueryError::Fault(f, 0))?;
            if matches!(sample.verdict, Verdict::Reached(_)) {
                // Against the proof: what was replayed counts.
                outcome = sample;
            } else if let Some(nearest) = sample.nearest {
                outcome.nearest = Some(nearest.sampled(sample.statistics.nodes));
            }
        }
        Ok(Found { target, problem: Some(problem), robust: None, outcome })
    }

    /// A path that withstands timing errors better, if there is one to begin with.
    fn improve(&self, found: &Found<'_>, errors: TimingErrors, watch: &dyn Watch) -> Option<Improved> {
        let (problem, plan) = found.problem.as_ref().zip(found.plan())?;
        let search = (&self.query.settings, &self.query.limits);
        Some((errors.methods.improve)(problem, &self.space, search, plan, &Jitter::new(errors.sigma), watch))
    }

    /// Takes a better path, and measures how robust it is.
    fn measure(&self, found: &mut Found<'_>, errors: TimingErrors, improved: Option<Improved>, watch: &dyn Watch) {
        let (Some(problem), Some(first)) = (&found.problem, found.plan().cloned()) else { return };
        let Improved { plan, compared } = improved.unwrap_or(Improved { plan: first.clone(), compared: 1 });
        let replayed = plan_from_script(problem, &plan.script, plan.after, watch);
        // What is shown was replayed.
        if replayed.is_none_or(|replayed| replayed.steps != plan.steps) {
            return;
        }
        let (jitter, settings) = (Jitter::new(errors.sigma), &self.query.settings);
        let how = (settings.seed, errors.trials, settings.threads);
        let Some(robustness) = (errors.methods.robustness)(problem, &plan, &jitter, how, watch) else { return };
        let is_other = plan.script != first.script;
        let success = is_other.then(|| (errors.methods.success)(problem, &first, &jitter, how, watch)).flatten();
        let first = success.map(|success| (first, success));
        if is_other {
            found.outcome.verdict = Verdict::Reached(plan);
        }
        found.robust = Some(FoundRobust { first, compared, robustness });
    }

    /// Makes a path better in the style that is asked for.
    fn minimize(&self, found: &mut Found<'_>, watch: &dyn Watch) {
        if let (Some(problem), Some(plan), Some(style)) = (&found.problem, found.plan(), self.query.style) {
            let Query { settings, limits, .. } = &self.query;
            let plan = improve_style(problem, &self.space, settings, limits, plan, style, watch);
            found.outcome.verdict = Verdict::Reached(plan);
        }
    }

    /// Simplifies a path that may come from another target.
    fn shorten(&self, found: &mut Found<'_>, watch: &dyn Watch) {
        if let (Some(problem), Some(plan), Some(style)) = (&found.problem, found.plan(), self.query.style) {
            found.outcome.verdict = Verdict::Reached(shorten(problem, &self.space, plan, style, watch));
        }
    }

    /// Uses for each target the shortest path found for any: a path may pass several targets. Returns whether anything
    /// changed.
    fn exchange(&self, all: &mut [Found<'_>], watch: &dyn Watch) -> bool {
        if all.len() < 2 {
            return false;
        }
        let mut scripts: Vec<(Script, u64, &'static str)> = Vec::new();
        for found in all.iter() {
            let violations = found.outcome.violations.iter().map(|(_, script)| script);
            for script in found.plan().map(|plan| &plan.script).into_iter().chain(violations) {
                if let Some(after) = self.query.given_steps(script)
                    && !scripts.iter().any(|(known, ..)| known == script)
                {
                    scripts.push((script.clone(), after, found.outcome.planner));
                }
            }
        }
        let mut has_changed = false;
        for found in all {
            let Some(problem) = &found.problem else { continue };
            for (script, after, planner) in &scripts {
                let steps = |plan: &Plan| plan.steps - plan.after;
                let known = found.plan().map(steps);
                let plan = plan_from_script(problem, script, *after, watch);
                let Some(plan) = plan.filter(|plan| known.is_none_or(|known| steps(plan) < known)) else { continue };
                let outcome = &mut found.outcome;
                (outcome.verdict, outcome.end, outcome.planner) = (Verdict::Reached(plan), End::Answered, *planner);
                outcome.is_withdrawn = false;
                has_changed = true;
            }
        }
        has_changed
    }

    fn problem(&self, target: Target, watch: &dyn Watch) -> Result<Option<Problem<'_>>, QueryError> {
        let problem = self.query.problem(&self.sim, target, watch)?;
        Ok(problem.map(|problem| match &self.monitor {
            Some(monitor) => problem.monitored(monitor),
            None => problem,
        }))
    }
}

/// Replays a script that was found for a target before, without the analysis. If it still leads there from the initial
/// state: the path up to the target, and the luck that it needs.
pub fn replay(
    sim: &Simulator,
    query: &Query,
    target: Target,
    script: &Script,
    watch: &dyn Watch,
) -> Option<(Plan, Option<Luck>)> {
    let problem = query.problem(sim, target, watch).ok()??;
    let plan = plan_from_script(&problem, script, 0, watch)?;
    let luck = Luck::chosen(&problem, &plan.script, 0);
    Some((plan, luck))
}

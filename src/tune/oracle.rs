//! Judges values: replays the ways that are known, then searches and proves as `hypedc reach` does.

use crate::analysis::watched_space;
use crate::compile::NumberSetting;
use crate::diagnostic::{Diagnostics, render};
use crate::ir::Extremes;
use crate::reach::query::{QueryError, Session};
use crate::reach::{Conclusion, Luck, Verdict, improve_duration};
use crate::sim::{Input, Script, Simulator};
use crate::watch::Watch;

use super::axis::Axis;
use super::record::{NeverTrial, Trial, Tuned};
use super::{Built, Host, Question, Wanted};

/// Number of steps by which a known way is made longer: it may only be a little late.
const LATER: u32 = 120;
/// By how many steps a change of inputs is moved in a known way.
const SHIFTS: [i64; 8] = [1, -1, 2, -2, 4, -4, 8, -8];
/// Maximum number of changes of inputs of a way that is varied.
const MAX_CHANGES: usize = 40;

/// What judges values, with all that it found.
pub(super) struct Oracle<'h> {
    pub host: &'h dyn Host,
    pub question: &'h Question,
    pub found: Tuned,
    /// The ways to the goal, each with the index of its trial.
    ways: Vec<(usize, Script)>,
}

impl<'h> Oracle<'h> {
    pub fn new(host: &'h dyn Host, question: &'h Question) -> Self {
        let found = Tuned { axes: question.axes.clone(), ..Tuned::default() };
        Oracle { host, question, found, ways: Vec::new() }
    }

    /// The program with these values.
    pub fn build(&self, values: &[f64]) -> Result<Built, String> {
        let axes = self.question.axes.iter().zip(values);
        // What the program has stays as it is written.
        let changed: Vec<(&Axis, String)> =
            axes.filter(|(axis, value)| **value != axis.base).map(|(axis, value)| (axis, Axis::text(*value))).collect();
        let numbers: Vec<NumberSetting<'_>> =
            changed.iter().map(|(axis, value)| NumberSetting { path: &axis.name, value }).collect();
        self.host.build(&numbers)
    }

    /// The values as text: `Hero.jump_speed=251.5`.
    fn label(&self, values: &[f64]) -> String {
        let axes = self.question.axes.iter().zip(values);
        axes.map(|(axis, value)| format!("{}={}", axis.name, Axis::text(*value))).collect::<Vec<_>>().join(" ")
    }

    /// The index of the trial of some values, which are judged unless they were before; `None` after a stop.
    pub fn judge(&mut self, values: &[f64]) -> Option<usize> {
        if let Some(known) = self.found.trials.iter().position(|trial| trial.values == values) {
            return Some(known);
        }
        if self.host.is_stopped() {
            self.found.is_stopped = true;
            return None;
        }
        let mut trial = None;
        let (label, host) = (self.label(values), self.host);
        host.watched(&label, &mut |watch| trial = Some(self.trial(values, watch)));
        // The work of a stopped search is incomplete.
        self.found.is_stopped |= self.host.is_stopped();
        let (trial, way) = trial?;
        let index = self.found.trials.len();
        self.ways.extend(way.map(|way| (index, way)));
        self.found.trials.push(trial);
        Some(index)
    }

    /// Replays what is known by now where nothing was found.
    pub fn replay_all(&mut self) {
        for index in 0..self.found.trials.len() {
            self.replay(index);
        }
    }

    /// Replays what is known by now where nothing was found; returns whether that changes the verdict.
    pub fn replay(&mut self, index: usize) -> bool {
        let is_open = self.found.trials[index].verdict == Conclusion::NotFound;
        if !is_open || self.ways.is_empty() || self.host.is_stopped() {
            return false;
        }
        let values = self.found.trials[index].values.clone();
        let Ok(built) = self.build(&values) else { return false };
        let (label, host, mut replayed) = (self.label(&values), self.host, None);
        host.watched(&label, &mut |watch| {
            replayed = self.replayed(&values, &built, self.ways.clone(), watch);
        });
        let Some((mut trial, way)) = replayed else { return false };
        host.watched(&label, &mut |watch| self.complete(&mut trial, None, &built, watch));
        trial.nodes += self.found.trials[index].nodes;
        self.ways.push((index, way));
        self.found.trials[index] = trial;
        true
    }

    /// Makes the way of a trial faster, so that it leaves room for smaller values; returns whether it could be.
    pub fn improve(&mut self, index: usize) -> bool {
        let Some((_, way)) = self.ways.iter().rev().find(|(of, _)| *of == index) else { return false };
        let (values, way) = (self.found.trials[index].values.clone(), way.clone());
        let (Ok(built), query) = (self.build(&values), &self.question.query) else { return false };
        let (label, mut faster) = (self.label(&values), None);
        self.host.watched(&label, &mut |watch| {
            let sim = Simulator::new(&built.program, built.world);
            let target = query.targets.first().copied();
            let problem = target.and_then(|target| query.problem(&sim, target, watch).ok().flatten());
            let Some(problem) = problem else { return };
            let Some(plan) = query.plan_of(&problem, &way, watch) else { return };
            let space = watched_space(&built.program, built.world, &query.rules(sim.world()), watch);
            let found = improve_duration(&problem, &space, &query.settings, &query.limits, &plan, watch);
            faster = (found.steps < plan.steps).then_some(found.script);
        });
        let is_faster = faster.is_some() && !self.host.is_stopped();
        self.ways.extend(faster.filter(|_| is_faster).map(|way| (index, way)));
        is_faster
    }

    fn trial(&mut self, values: &[f64], watch: &dyn Watch) -> (Trial, Option<Script>) {
        let failed = |why: String| (Trial { error: Some(why), ..blank(values) }, None);
        let built = match self.build(values) {
            Ok(built) => built,
            Err(why) => return failed(why),
        };
        if let Some((mut trial, way)) = self.replayed(values, &built, self.ways.clone(), watch) {
            self.complete(&mut trial, None, &built, watch);
            return (trial, Some(way));
        }
        let session = Session::new(&built.program, built.world, self.question.query.clone(), watch);
        let Some(&target) = self.question.query.targets.first() else { return failed("no goal".to_string()) };
        let mut found = match session.find(target, watch) {
            Ok(found) => found,
            Err(QueryError::Fault(fault, step)) => {
                let mut found = Diagnostics::new();
                found.report(fault.fact(&built.program, built.world, step));
                return failed(render::short(&built.sources, found.iter()).trim_end().to_string());
            }
            Err(QueryError::Over { .. }) => return failed("the run is over before it begins".to_string()),
        };
        let answer = session.answer(&mut found, &built.sources);
        let way = match &found.outcome.verdict {
            Verdict::Reached(plan) => Some(plan.script.clone()),
            _ => None,
        };
        let mut trial = Trial {
            verdict: answer.verdict,
            steps: answer.steps,
            seconds_of_play: answer.seconds_of_play,
            inputs: answer.inputs,
            luck: answer.luck,
            proven_by: answer.proven_by,
            reasons: answer.reasons,
            nodes: answer.nodes,
            ..blank(values)
        };
        self.refute(&session, &built);
        self.complete(&mut trial, Some(&session), &built, watch);
        (trial, way)
    }

    /// Keeps a run that refutes the analysis.
    pub fn refute(&mut self, session: &Session, built: &Built) {
        if let (Some(refutation), None) = (session.refutation(), &self.found.refuted) {
            self.found.refuted = Some((refutation, built.clone()));
        }
    }

    /// Judges the `never`s where the answer has turned.
    fn complete(&mut self, trial: &mut Trial, session: Option<&Session>, built: &Built, watch: &dyn Watch) {
        trial.is_wanted = match self.question.wanted {
            Wanted::Reached => trial.verdict == Conclusion::Reached,
            Wanted::Prevented => trial.verdict == Conclusion::ProvenUnreachable,
        };
        if !trial.is_wanted || self.question.nevers.is_empty() {
            return;
        }
        let own;
        let session = match session {
            Some(session) => session,
            None => {
                own = Session::new(&built.program, built.world, self.question.query.clone(), watch);
                &own
            }
        };
        for &never in &self.question.nevers {
            let name = never.name(&built.program.worlds[built.world]).to_string();
            let verdict = match session.find(never, watch) {
                Ok(found) => found.outcome.conclusion(never),
                Err(_) => Conclusion::Error,
            };
            trial.is_wanted &= !matches!(verdict, Conclusion::Violated | Conclusion::Error);
            trial.nevers.push(NeverTrial { name, verdict });
        }
        self.refute(session, built);
    }

    /// The first of some ways, or of those near them, that leads to the goal with these values; the ways of the nearest
    /// values are tried first.
    fn replayed(
        &self,
        values: &[f64],
        built: &Built,
        mut ways: Vec<(usize, Script)>,
        watch: &dyn Watch,
    ) -> Option<(Trial, Script)> {
        let query = &self.question.query;
        let &target = query.targets.first()?;
        let far = |index: usize| {
            let axes = self.question.axes.iter().zip(&self.found.trials[index].values).zip(values);
            axes.map(|((axis, a), b)| (a - b).abs() / (axis.high - axis.low)).fold(0.0, f64::greatest)
        };
        ways.sort_by(|(a, _), (b, _)| far(*a).total_cmp(&far(*b)));
        let sim = Simulator::new(&built.program, built.world);
        let problem = query.problem(&sim, target, watch).ok()??;
        let known = ways.iter().map(|(of, way)| (*of, longer(way, &sim)));
        let exact = known.clone().find_map(|(of, way)| Some((of, query.plan_of(&problem, &way, watch)?)));
        let near = || {
            let first =
                known.clone().take(2).flat_map(|(of, way)| near(&way).map(move |way| (of, way)).collect::<Vec<_>>());
            first.into_iter().find_map(|(of, way)| Some((of, query.plan_of(&problem, &way, watch)?)))
        };
        let (of, plan) = exact.or_else(near)?;
        let trial = Trial {
            verdict: Conclusion::of_path(target),
            steps: Some(plan.steps),
            seconds_of_play: Some(plan.steps as f64 * sim.world().step.seconds()),
            inputs: Some(plan.script.text(&built.program, built.world)),
            luck: Luck::chosen(&problem, &plan.script, plan.after),
            path_of: Some(of),
            ..blank(values)
        };
        Some((trial, plan.script))
    }
}

/// A way whose last input is held, then released.
fn longer(way: &Script, sim: &Simulator) -> Script {
    let mut longer = way.clone();
    let last = longer.steps.last().map(|step| step.input.clone());
    last.iter().for_each(|input| longer.push(input, LATER));
    longer.push(&Input::nothing(sim.world().players.len()), LATER);
    longer
}

/// A way with one of its changes of inputs some steps later or earlier, or with two inputs at once instead of one after the
/// other.
fn near(way: &Script) -> impl Iterator<Item = Script> {
    let count = way.steps.len().saturating_sub(1).min(MAX_CHANGES);
    let moves = (0..count).flat_map(|at| SHIFTS.map(|by| (at, by)));
    let moved = moves.filter_map(|(at, by)| {
        let mut moved = way.clone();
        let step = moved.steps.get_mut(at)?;
        step.count = u32::try_from(i64::from(step.count) + by).ok()?;
        Some(moved)
    });
    let joined = (0..count).flat_map(|at| [(at, at + 1), (at + 1, at)]).filter_map(|(at, with)| {
        let mut joined = way.clone();
        let other = joined.steps.get(with)?.input.clone();
        let input = &mut joined.steps.get_mut(at)?.input;
        for (mine, other) in input.0.iter_mut().zip(&other.0) {
            mine.buttons |= other.buttons;
            let axes = mine.axes.iter_mut().zip(other.axes);
            axes.filter(|(axis, _)| **axis == 0.0).for_each(|(axis, other)| *axis = other);
        }
        Some(joined)
    });
    moved.chain(joined)
}

fn blank(values: &[f64]) -> Trial {
    Trial {
        values: values.to_vec(),
        verdict: Conclusion::Error,
        is_wanted: false,
        steps: None,
        seconds_of_play: None,
        inputs: None,
        luck: None,
        path_of: None,
        proven_by: None,
        reasons: Vec::new(),
        nodes: 0,
        nevers: Vec::new(),
        error: None,
    }
}

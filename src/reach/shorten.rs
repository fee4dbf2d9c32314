//! Makes a plan simpler: removes parts, merges neighbours and changes times while the rest still reaches the goal and is
//! better in a style (`style.rs`). A candidate is simulated from the first part in which it differs; the result is replayed.

use crate::analysis::ConfigurationSpace;
use crate::sim::{Scratch, Script, ScriptStep};
use crate::watch::{Meter, PollLimit, Watch};

use super::distance::DistanceField;
use super::luck::only_read;
use super::outcome::Plan;
use super::problem::{Problem, StateStatus};
use super::search_context::{REPLAY_POLLS, replays_to};
use super::start_hold::is_held;
use super::style::Style;

/// Maximum number of simulated steps.
pub(super) const MAX_STEPS: u64 = 3_000_000;
/// Maximum size of the states that are kept, bytes.
const MAX_KEPT: usize = 64 << 20;
/// How many parts of a candidate cost as much as a simulated step.
const PARTS_PER_STEP: usize = 8;
/// Number of steps between two questions whether the rest can be done in time.
const ASKED: u64 = 8;

/// Improves a plan until no single change does, or the watch stops it. Steps before the start of the search are kept, and
/// inputs are held for their minimum time. In another style than [`Style::Fast`] the time limit of the problem counts.
#[must_use]
pub fn shorten(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    plan: &Plan,
    style: Style,
    watch: &dyn Watch,
) -> Plan {
    let distances = DistanceField::new(problem, space, &Meter::new(watch));
    shorten_within(problem, distances.as_ref(), plan, style, MAX_STEPS, watch)
}

/// As [`shorten`], by a number of simulated steps; with distances, a candidate ends where the rest takes too long.
pub(super) fn shorten_within(
    problem: &Problem<'_>,
    distances: Option<&DistanceField>,
    plan: &Plan,
    style: Style,
    budget: u64,
    watch: &dyn Watch,
) -> Plan {
    let meter = Meter::new(watch);
    if replays_to(problem, &plan.script, plan.after, &mut problem.sim.scratch(), &meter) != Some(plan.steps) {
        return plan.clone();
    }
    let (prefix, parts) = split(&plan.script, plan.after);
    let Some(mut attempts) = Attempts::new(problem, distances, style, (&prefix, plan.after), parts, (budget, &meter))
    else {
        return plan.clone();
    };
    let mut changed = true;
    while std::mem::take(&mut changed) {
        let mut at = 0;
        while at < attempts.best.len() {
            let better = variants(&attempts.best, at, style).into_iter().find_map(|variant| attempts.better(&variant));
            match better {
                Some((from, parts)) => {
                    attempts.take(from, parts);
                    changed = true;
                }
                None => at += 1,
            }
            if attempts.is_spent() {
                changed = false;
                break;
            }
        }
    }
    let mut script = prefix.clone();
    attempts.best.iter().for_each(|part| script.push(&part.input, part.count));
    if script == plan.script {
        return plan.clone();
    }
    rewritten(problem, plan, script)
}

/// A plan with another script, which was found for it, if a short replay confirms that; else the same. What was found before
/// a stop still counts.
pub(super) fn rewritten(problem: &Problem<'_>, plan: &Plan, script: Script) -> Plan {
    let poll_limit = PollLimit::new(REPLAY_POLLS);
    let (late, steps) = (Meter::new(&poll_limit), script.len());
    if replays_to(problem, &script, plan.after, &mut problem.sim.scratch(), &late) != Some(steps) {
        return plan.clone();
    }
    // Other steps read what nature draws.
    let script = match problem.sim.draws() {
        [] => script,
        _ => match only_read(problem, &script, plan.after, &late) {
            Some(script) => script,
            None => return plan.clone(),
        },
    };
    // A plan as short as a shortest one is a shortest one.
    Plan { is_shortest: plan.is_shortest && steps == plan.steps, steps, script, after: plan.after }
}

/// Simulates candidates.
struct Attempts<'p, 'm> {
    problem: &'p Problem<'p>,
    distances: Option<&'m DistanceField>,
    style: Style,
    /// What comes before the start of the search, and its number of steps.
    prefix: (&'p Script, u64),
    /// The parts of the best plan so far.
    best: Vec<ScriptStep>,
    /// Before each of them the number of steps from the start of the search, and the state, which is kept before every few
    /// parts where there are many large ones.
    starts: Vec<(u64, Option<Box<[u8]>>)>,
    every: usize,
    cost: [u64; 3],
    /// Maximum number of steps.
    most: u64,
    state: Vec<u8>,
    scratch: Scratch,
    meter: &'m Meter<'m>,
    simulated: u64,
    /// Maximum number of simulated steps.
    budget: u64,
}

impl<'p, 'm> Attempts<'p, 'm> {
    /// Those at a plan; `None` if its start is not reached, or if the meter runs out.
    fn new(
        problem: &'p Problem<'p>,
        distances: Option<&'m DistanceField>,
        style: Style,
        prefix: (&'p Script, u64),
        parts: Vec<ScriptStep>,
        (budget, meter): (u64, &'m Meter<'m>),
    ) -> Option<Self> {
        let mut scratch = problem.sim.remembering_scratch();
        let mut state = problem.sim.metered_initial(&mut scratch, meter).ok().filter(|_| !meter.is_stopped())?.to_vec();
        for (step, input) in (1..).zip(prefix.0.inputs()) {
            problem.sim.metered_step(&mut state, &problem.draw(step, input), &mut scratch, meter).ok()?;
        }
        let steps = parts.iter().map(|part| u64::from(part.count)).sum();
        let most = problem.time().map_or(style.most_steps(steps), u64::from).max(steps);
        let starts = vec![(0, Some(state.clone().into_boxed_slice()))];
        let every = (parts.len() * state.len()).div_ceil(MAX_KEPT).max(1);
        let (cost, simulated) = ([u64::MAX; 3], 0);
        let mut attempts = Attempts {
            problem,
            distances,
            style,
            prefix,
            best: Vec::new(),
            starts,
            every,
            cost,
            most,
            state,
            scratch,
            meter,
            simulated,
            budget,
        };
        attempts.take(0, parts);
        (!meter.is_stopped()).then_some(attempts)
    }

    fn is_spent(&self) -> bool {
        self.simulated >= self.budget || self.meter.is_stopped() || self.meter.spend(0)
    }

    /// Takes parts as the best, which are the same before `from`, where a state is kept.
    fn take(&mut self, from: usize, parts: Vec<ScriptStep>) {
        self.cost = self.style.cost(&parts, self.problem.sim.world().step.seconds());
        self.best = parts;
        self.starts.truncate(from + 1);
        let mut steps = self.go_to(from);
        for at in from..self.best.len().saturating_sub(1) {
            for _ in 0..self.best[at].count {
                let Some(()) = self.step(at, steps + 1, None) else { return };
                steps += 1;
            }
            let is_kept = (at + 1).is_multiple_of(self.every);
            self.starts.push((steps, is_kept.then(|| self.state.clone().into_boxed_slice())));
        }
    }

    /// Goes to the state before a part, where one is kept; returns its number of steps.
    fn go_to(&mut self, part: usize) -> u64 {
        let (steps, state) = &self.starts[part];
        state.iter().for_each(|state| self.state.copy_from_slice(state));
        *steps
    }

    /// Simulates a step with a part of the best, or another one.
    fn step(&mut self, at: usize, number: u64, other: Option<&ScriptStep>) -> Option<()> {
        self.simulated += 1;
        let part = other.unwrap_or_else(|| &self.best[at]);
        let input = self.problem.draw(self.prefix.1 + number, &part.input);
        self.problem.sim.metered_step(&mut self.state, &input, &mut self.scratch, self.meter).ok()?;
        (!self.meter.is_stopped()).then_some(())
    }

    /// The parts of a candidate up to the goal, if they are better than the best, with the first in which they differ.
    fn better(&mut self, parts: &[ScriptStep]) -> Option<(usize, Vec<ScriptStep>)> {
        let step = self.problem.sim.world().step.seconds();
        if self.is_spent() || parts.is_empty() || !self.can_be_better(parts, step) {
            return None;
        }
        // Comparing and copying them takes time, too.
        self.simulated += (parts.len() / PARTS_PER_STEP) as u64;
        let same = self.best.iter().zip(parts).take_while(|(a, b)| a == b).count().min(self.starts.len() - 1);
        let from = (0..=same).rev().find(|at| self.starts[*at].1.is_some())?;
        let length = self.reaches(from, parts)?;
        let parts = cut(parts, length);
        if self.style.cost(&parts, step) >= self.cost {
            return None;
        }
        let mut whole = self.prefix.0.clone();
        parts.iter().for_each(|part| whole.push(&part.input, part.count));
        is_held(&whole, self.prefix.1, self.problem.min_hold()).then_some((from, parts))
    }

    /// Whether a candidate is better if it reaches the goal soon enough.
    fn can_be_better(&self, parts: &[ScriptStep], step: f64) -> bool {
        match self.style {
            // The goal may be reached sooner.
            Style::Fast => true,
            Style::Calm | Style::FewInputs => self.style.cost(parts, step)[0] <= self.cost[0],
        }
    }

    /// The number of steps after which parts reach the goal, which are the best ones before `from`. In a style in which
    /// time counts last, the last input is held for as long as it takes.
    fn reaches(&mut self, from: usize, parts: &[ScriptStep]) -> Option<u64> {
        let total: u64 = self.best.iter().map(|part| u64::from(part.count)).sum();
        let most = match self.style {
            Style::Fast if parts.len() < self.best.len() => total,
            Style::Fast => total - 1,
            Style::Calm | Style::FewInputs => self.most,
        };
        let tail = self.best.iter().rev().zip(parts.iter().rev()).take_while(|(a, b)| a == b).count();
        let mut steps = self.go_to(from);
        for (at, part) in parts.iter().enumerate().skip(from) {
            // What comes may be what came from this state before.
            let left = parts.len() - at;
            if at > from
                && left <= tail
                && let Some((then, Some(state))) = self.starts.get(self.best.len() - left)
                && **state == *self.state
                && (*then == steps || !self.problem.is_foretold())
            {
                let length = steps + (total - then);
                return (length <= most).then_some(length);
            }
            let is_held_on = left == 1 && self.style != Style::Fast;
            let count = if is_held_on { most.saturating_sub(steps) } else { u64::from(part.count) };
            for _ in 0..count {
                if steps >= most {
                    return None;
                }
                self.step(at, steps + 1, Some(part))?;
                steps += 1;
                match self.problem.judge(&self.state).ok()? {
                    StateStatus::Open => {}
                    StateStatus::Goal => return Some(steps),
                    StateStatus::Dead(_) => return None,
                }
                if steps.is_multiple_of(ASKED)
                    && let Some(distances) = self.distances
                    && steps + u64::from(distances.least_steps(self.problem.sim, &self.state)) > most
                {
                    return None;
                }
            }
        }
        None
    }
}

/// Parts of some length, the last one as long as it takes.
fn cut(parts: &[ScriptStep], length: u64) -> Vec<ScriptStep> {
    let mut script = Script::default();
    let mut left = length;
    for (at, part) in parts.iter().enumerate() {
        let is_last = at + 1 == parts.len();
        let count = if is_last { left } else { u64::from(part.count).min(left) };
        script.push(&part.input, count as u32);
        left -= count;
    }
    script.steps
}

/// Splits a script after some steps.
pub(super) fn split(script: &Script, kept: u64) -> (Script, Vec<ScriptStep>) {
    let (mut prefix, mut rest) = (Script::default(), Vec::new());
    let mut left = kept;
    for step in &script.steps {
        let count = u64::from(step.count).min(left) as u32;
        prefix.push(&step.input, count);
        left -= u64::from(count);
        if step.count > count {
            rest.push(ScriptStep { input: step.input.clone(), count: step.count - count });
        }
    }
    (prefix, rest)
}

/// Possible changes at an index of a plan, the boldest first.
fn variants(steps: &[ScriptStep], at: usize, style: Style) -> Vec<Vec<ScriptStep>> {
    let mut out = Vec::new();
    let with = |change: &dyn Fn(&mut Vec<ScriptStep>)| {
        let mut steps = steps.to_vec();
        change(&mut steps);
        // Equal neighbours are merged.
        let mut script = Script::default();
        steps.iter().filter(|s| s.count > 0).for_each(|s| script.push(&s.input, s.count));
        script.steps
    };
    // Detours are several steps long (as in delta debugging: Zeller and Hildebrandt, 2002).
    let mut run = steps.len() / 2;
    while run > 1 {
        if at + run <= steps.len() {
            out.push(with(&|s| drop(s.drain(at..at + run))));
        }
        run = if run > 8 { run / 2 } else { run - 1 };
    }
    out.push(with(&|s| drop(s.remove(at))));
    for neighbour in [at.checked_sub(1), Some(at + 1)].into_iter().flatten().filter(|n| *n < steps.len()) {
        out.push(with(&|s| s[at].input = s[neighbour].input.clone()));
    }
    let count = steps[at].count;
    for cut in [count / 2, count / 4, 8, 4, 2, 1] {
        if 0 < cut && cut < count {
            out.push(with(&|s| s[at].count -= cut));
        }
    }
    // Who has time waits.
    if style != Style::Fast {
        for longer in [32, 16, 8, 4] {
            out.push(with(&|s| s[at].count += longer));
        }
    }
    // Moving a change of inputs can make room.
    if at + 1 < steps.len() {
        for moved in [8, 4, 2, 1] {
            if moved < count {
                out.push(with(&|s| {
                    s[at].count -= moved;
                    s[at + 1].count += moved;
                }));
            }
            if moved < steps[at + 1].count {
                out.push(with(&|s| {
                    s[at].count += moved;
                    s[at + 1].count -= moved;
                }));
            }
        }
    }
    out
}

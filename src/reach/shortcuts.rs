//! Makes a plan faster by shortcuts: where the players can come to a later place of their way sooner than they did, in the
//! same modes and about as fast, the rest of the way is played from there. Comes after a search, and in a portfolio
//! (`portfolio.rs`) before the search for a faster path.
//!
//! After Nakhost and Müller, *Action Elimination and Plan Neighborhood Graph Search: Two Algorithms for Plan Improvement*,
//! ICAPS 2010: loops are left out, and states beside the plan lead back to it. Here a state seldom returns exactly, so that
//! the rest is simulated: to the goal, to a state of the old way, from which it is known, or until it strays.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use hashbrown::{HashMap, HashTable};

use crate::ir::{Extremes, SlotId, VarId};
use crate::sim::{Input, Scratch, Script};
use crate::watch::{Meter, Watch};

use super::coverage::{PLACE, insert, mix};
use super::outcome::Plan;
use super::problem::{Problem, StateStatus};
use super::shorten::rewritten;
use super::start_hold::is_held;

/// The sides of the squares in which positions count as the same, px, first those that are tried first, and the number of
/// classes of velocities up to the fastest on the way.
const SIDES: [f64; 2] = [0.5, PLACE / 2.0];
const VELOCITIES: f64 = 6.0;
/// Maximum number of steps for which a shortcut holds an input that leads back to the way.
const MAX_HOLD: usize = 48;
/// A run has strayed that has been so far from the old way for so many steps, px.
const ASTRAY: f64 = 2.0 * PLACE;
const STRAYING: u32 = 8;
/// Divisor: the share of the steps of a search that is simulated after it for shortcuts, at least and at most.
const BRIEF: u64 = 4;
const FEWEST: u64 = 20_000;
const MOST: u64 = 400_000;
/// The same for as many as there are.
const MAX_STEPS: u64 = 1_000_000;
/// Divisor: the share of all that for the candidates of a round, and for trying them.
const SHARE: u64 = 8;
/// How long a run differs at most whose input is another one.
const APART: usize = 240;
/// Divisor: a round has saved little that has saved less of the steps.
const LITTLE: usize = 100;
/// Divisor: as many steps of the budget are simulated besides to make the rest simpler.
const SIMPLER: u64 = 2;
/// Maximum size of the states that are kept, bytes.
const MAX_KEPT: usize = 256 << 20;

/// How long shortcuts are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// As long as they save much, after a search that simulated so many steps: with a small share of those.
    Brief(u64),
    /// As long as they save anything, with a million simulated steps at most, and half as many to make the rest simpler.
    Thorough,
}

impl Effort {
    /// Maximum number of simulated steps for shortcuts.
    fn budget(self) -> u64 {
        match self {
            Effort::Brief(searched) => (searched / BRIEF).clamp(FEWEST, MOST),
            Effort::Thorough => MAX_STEPS,
        }
    }
}

/// A plan that takes fewer steps, or as many with fewer changes of inputs, if shortcuts lead to one; else the same. Inputs
/// are those of the plan, and held for their minimum time. Where nature draws, plans stay as they are.
#[must_use]
pub fn take_shortcuts(problem: &Problem<'_>, plan: &Plan, effort: Effort, watch: &dyn Watch) -> Plan {
    let meter = Meter::new(watch);
    match Shortcuts::new(problem, plan, effort, &meter).and_then(|all| all.take(effort)) {
        Some(script) => rewritten(problem, plan, script),
        None => plan.clone(),
    }
}

/// A part of a way: inputs by their numbers, and the state before the first of them and after each.
#[derive(Debug, Default)]
struct Way {
    inputs: Vec<u32>,
    states: Vec<u8>,
}

impl Way {
    fn len(&self) -> usize {
        self.inputs.len()
    }

    fn state(&self, at: usize, size: usize) -> &[u8] {
        &self.states[at * size..(at + 1) * size]
    }

    /// Replaces what lies between two states.
    fn replace(&mut self, (from, to): (usize, usize), by: &Way, size: usize) {
        replace(&mut self.inputs, (from, to), &by.inputs);
        replace(&mut self.states, ((from + 1) * size, (to + 1) * size), &by.states);
    }
}

fn replace<T: Copy>(all: &mut Vec<T>, (from, to): (usize, usize), by: &[T]) {
    let rest = all.split_off(to);
    all.truncate(from);
    all.extend_from_slice(by);
    all.extend_from_slice(&rest);
}

/// From a state of the way an input that is held for some steps leads to about the same place as a later state.
#[derive(Debug, Clone, Copy)]
struct Shortcut {
    from: usize,
    input: u32,
    hold: usize,
    to: usize,
}

impl Shortcut {
    /// The number of steps that it saves.
    fn gain(self) -> usize {
        self.to - self.from - self.hold
    }

    /// The same on a way on which another one was taken.
    fn after(self, taken: Shortcut) -> Option<Shortcut> {
        if self.to <= taken.from {
            return Some(self);
        }
        let gain = taken.gain();
        (self.from >= taken.to).then(|| Shortcut { from: self.from - gain, to: self.to - gain, ..self })
    }
}

/// Possible shortcuts: those that lead to the same place first, of these those that save most.
#[derive(Debug, Default)]
struct Found {
    all: Vec<Shortcut>,
    queue: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

impl Found {
    fn push(&mut self, shortcut: Shortcut, side: usize) {
        let most = u64::from(u32::MAX);
        let cost = (side as u64) * most + (most - shortcut.gain() as u64);
        self.queue.push(Reverse((cost, shortcut.from as u32, self.all.len() as u32)));
        self.all.push(shortcut);
    }

    fn pop(&mut self) -> Option<Shortcut> {
        self.queue.pop().map(|Reverse((_, _, at))| self.all[at as usize])
    }
}

/// How states are told apart: by where the players are, their modes, discrete variables and velocities.
struct Keys<'p> {
    problem: &'p Problem<'p>,
    /// For each player and axis the width of a class of velocities, px/s.
    widths: Vec<[f64; 2]>,
}

impl<'p> Keys<'p> {
    /// Those for the states of a way.
    fn on<'s>(problem: &'p Problem<'p>, states: impl Iterator<Item = &'s [u8]> + Clone) -> Self {
        let mut keys = Keys { problem, widths: Vec::new() };
        for &slot in problem.players() {
            let fastest = states.clone().fold([0.0_f64; 2], |fastest, state| {
                let velocity = keys.velocity(state, slot);
                [0, 1].map(|axis| fastest[axis].greatest(velocity[axis].abs()))
            });
            keys.widths.push(fastest.map(|fastest| fastest.greatest(1.0) / VELOCITIES));
        }
        keys
    }

    fn velocity(&self, state: &[u8], slot: SlotId) -> [f64; 2] {
        VarId::XY.map(|var| self.problem.sim.world().layout.slots[slot].var(state, var, 1))
    }

    /// A key for squares of each size.
    fn of(&self, state: &[u8]) -> [u64; 2] {
        SIDES.map(|side| self.key(state, side))
    }

    fn key(&self, state: &[u8], side: f64) -> u64 {
        let (sim, world) = (self.problem.sim, self.problem.sim.world());
        self.problem.players().iter().zip(&self.widths).fold(0, |mut key, (&slot, widths)| {
            let layout = &world.layout.slots[slot];
            let entity = &sim.program().entities[world.slots[slot].entity];
            let (x, y) = sim.position(state, slot);
            key = mix(key, u64::from(sim.space(state, slot).0));
            let numbers = [x / side, y / side].map(f64::floor);
            let classes = self.velocity(state, slot).into_iter().zip(widths).map(|(of, width)| (of / width).round());
            key = numbers.into_iter().chain(classes).fold(key, |key, number| mix(key, number as i64 as u64));
            key = entity.groups.ids().fold(key, |key, group| mix(key, u64::from(layout.leaf(state, group).0)));
            entity.discretes.ids().fold(key, |key, id| mix(key, layout.discrete(state, id) as u64))
        })
    }
}

/// Finds shortcuts, and takes those whose way reaches the goal.
struct Shortcuts<'p, 'm> {
    problem: &'p Problem<'p>,
    /// What comes before the start of the search, and its number of steps.
    prefix: (Script, u64),
    /// The inputs of the plan.
    inputs: Vec<Input>,
    keys: Keys<'p>,
    way: Way,
    /// What a shortcut leads to.
    trial: Way,
    /// What was tried in vain, counted from the end of the way.
    failed: HashTable<u64>,
    is_shortest: bool,
    size: usize,
    state: Vec<u8>,
    scratch: Scratch,
    meter: &'m Meter<'m>,
    /// Number of steps that are left to simulate.
    left: u64,
}

impl<'p, 'm> Shortcuts<'p, 'm> {
    /// Walks the way of a plan; `None` if there is nothing to be gained.
    fn new(problem: &'p Problem<'p>, plan: &Plan, effort: Effort, meter: &'m Meter<'m>) -> Option<Self> {
        let steps = (plan.steps - plan.after) as usize;
        // Other steps read what nature draws.
        if !problem.sim.draws().is_empty() {
            return None;
        }
        let mut scratch = problem.sim.remembering_scratch();
        let mut state = problem.sim.metered_initial(&mut scratch, meter).ok()?.to_vec();
        let size = state.len();
        if steps.saturating_mul(size) > MAX_KEPT {
            return None;
        }
        let mut inputs: Vec<Input> = Vec::new();
        let mut way = Way::default();
        for (number, input) in (0..).zip(plan.script.inputs()) {
            if number >= plan.after {
                way.states.extend_from_slice(&state);
                let known = inputs.iter().position(|known| known == input);
                way.inputs.push(known.unwrap_or(inputs.len()) as u32);
                if known.is_none() {
                    inputs.push(input.clone());
                }
            }
            problem.sim.metered_step(&mut state, input, &mut scratch, meter).ok().filter(|()| !meter.is_stopped())?;
        }
        way.states.extend_from_slice(&state);
        let keys = Keys::on(problem, way.states.chunks_exact(size));
        let prefix = (plan.script.first(plan.after), plan.after);
        let (trial, failed) = (Way::default(), HashTable::new());
        let left = effort.budget();
        Some(Shortcuts {
            problem,
            prefix,
            inputs,
            keys,
            way,
            trial,
            failed,
            is_shortest: plan.is_shortest,
            size,
            state,
            scratch,
            meter,
            left,
        })
    }

    /// Takes shortcuts, and makes the rest simpler; the script, if anything has changed.
    fn take(mut self, effort: Effort) -> Option<Script> {
        let before = self.way.inputs.clone();
        let budget = self.left;
        if !self.is_shortest {
            self.shorten(effort);
        }
        self.simplify(budget / SIMPLER);
        (self.way.inputs != before).then(|| self.script())
    }

    /// Takes shortcuts until none is left, few save anything, or the budget is spent.
    fn shorten(&mut self, effort: Effort) {
        let share = (self.left / SHARE).max(1);
        // First hardly more than loops.
        let found = self.find(0, usize::MAX);
        self.take_of(found, share);
        let (mut in_vain, mut round) = (0, 0);
        while !self.is_spent() {
            // Where the way is long, each round begins at other steps.
            let steps = self.way.len();
            let cost = (steps * self.inputs.len() * MAX_HOLD) as u64;
            let stride = cost.div_ceil(share).max(1) as usize;
            let found = self.find(round % stride, stride);
            self.take_of(found, share);
            let saved = steps - self.way.len();
            let is_enough = match effort {
                Effort::Brief(_) => saved * LITTLE <= steps,
                Effort::Thorough => in_vain + 1 >= stride && saved == 0,
            };
            if is_enough {
                break;
            }
            in_vain = if saved > 0 { 0 } else { in_vain + 1 };
            round += 1;
        }
    }

    /// Replaces the input of a part of the way by the one before or after it, where that soon makes no difference; simulates
    /// at most so many steps.
    fn simplify(&mut self, most: u64) {
        self.left = most;
        let mut has_changed = true;
        while std::mem::take(&mut has_changed) {
            let mut from = 0;
            while let Some(&input) = self.way.inputs.get(from).filter(|_| !self.is_spent()) {
                let hold = self.way.inputs[from..].iter().take_while(|of| **of == input).count();
                let to = from + hold;
                let neighbours = [from.checked_sub(1), Some(to)].map(|at| self.way.inputs.get(at?).copied());
                let parts = neighbours.into_iter().flatten().map(|input| Shortcut { from, input, hold, to });
                has_changed |= parts.into_iter().any(|part| self.takes(part, APART));
                from = to;
            }
        }
    }

    fn is_spent(&self) -> bool {
        self.left == 0 || self.meter.is_stopped()
    }

    fn script(&self) -> Script {
        let mut script = self.prefix.0.clone();
        self.way.inputs.iter().for_each(|&input| script.push(&self.inputs[input as usize], 1));
        script
    }

    /// Simulates a step after a number of steps of the way; `None` if it cannot go on.
    fn step(&mut self, number: usize, input: u32) -> Option<StateStatus> {
        self.left = self.left.checked_sub(1)?;
        let input = self.problem.draw(self.prefix.1 + number as u64 + 1, &self.inputs[input as usize]);
        self.problem.sim.metered_step(&mut self.state, &input, &mut self.scratch, self.meter).ok()?;
        self.problem.judge(&self.state).ok().filter(|_| !self.meter.is_stopped())
    }

    /// The loops of the way, which lead back to about the same place, and for each key the last state with it.
    fn loops(&self) -> (Found, [HashMap<u64, u32>; 2]) {
        let (mut found, mut last) = (Found::default(), [HashMap::default(), HashMap::default()]);
        // Backwards, so that the first with a key is the last of the way.
        for from in (0..=self.way.len()).rev() {
            let keys = self.keys.of(self.way.state(from, self.size));
            for (side, (last, key)) in last.iter_mut().zip(keys).enumerate() {
                let to = *last.entry(key).or_insert(from as u32) as usize;
                if from < to {
                    found.push(Shortcut { from, input: 0, hold: 0, to }, side);
                }
            }
        }
        (found, last)
    }

    /// Possible shortcuts: loops, and from each state of a stride the best ones by each input.
    fn find(&mut self, offset: usize, stride: usize) -> Found {
        let (mut found, last) = self.loops();
        for from in (offset..self.way.len()).step_by(stride) {
            self.trial.states.clear();
            for input in 0..self.inputs.len() as u32 {
                self.state.copy_from_slice(self.way.state(from, self.size));
                let mut best: [Option<Shortcut>; 2] = [None; 2];
                for hold in 1..=MAX_HOLD {
                    if !matches!(self.step(from + hold - 1, input), Some(StateStatus::Open)) {
                        break;
                    }
                    // Inputs that have the same effect are one.
                    if hold == 1 {
                        if self.trial.states.chunks_exact(self.size).any(|state| *state == *self.state) {
                            break;
                        }
                        self.trial.states.extend_from_slice(&self.state);
                    }
                    for ((best, last), key) in best.iter_mut().zip(&last).zip(self.keys.of(&self.state)) {
                        let to = last.get(&key).map_or(0, |to| *to as usize);
                        if to > from + hold && best.is_none_or(|best| to - from - hold > best.gain()) {
                            *best = Some(Shortcut { from, input, hold, to });
                        }
                    }
                }
                for (side, best) in best.into_iter().enumerate() {
                    best.into_iter().for_each(|best| found.push(best, side));
                }
            }
        }
        found
    }

    /// Takes what reaches the goal sooner, with at most so many simulated steps.
    fn take_of(&mut self, mut found: Found, most: u64) {
        let until = self.left.saturating_sub(most);
        let mut taken: Vec<Shortcut> = Vec::new();
        while self.left > until && !self.meter.is_stopped() {
            let Some(shortcut) = found.pop() else { return };
            let shortcut = taken.iter().try_fold(shortcut, |shortcut, taken| shortcut.after(*taken));
            if let Some(shortcut) = shortcut.filter(|shortcut| shortcut.to <= self.way.len())
                && self.takes(shortcut, usize::MAX)
            {
                taken.push(shortcut);
            }
        }
    }

    /// Takes a shortcut if it reaches the goal as soon, and a state of the way after so many steps; each is tried once.
    fn takes(&mut self, shortcut: Shortcut, apart: usize) -> bool {
        let total = self.way.len();
        let Shortcut { from, input, hold, to } = shortcut;
        let numbers = [total - from, input as usize, hold, total - to];
        let key = numbers.into_iter().fold(0, |key, number| mix(key, number as u64));
        if self.failed.find(key, |known| *known == key).is_some() {
            return false;
        }
        let replaced = self.try_out(shortcut, apart);
        match replaced {
            Some(replaced) => self.way.replace((from, replaced), &self.trial, self.size),
            None => insert(&mut self.failed, key),
        }
        replaced.is_some()
    }

    /// Tries a shortcut, for so many steps after it. If it reaches the goal as soon: the state of the way up to which `trial`
    /// replaces it.
    fn try_out(&mut self, shortcut: Shortcut, apart: usize) -> Option<usize> {
        let Shortcut { from, input, hold, to } = shortcut;
        let total = self.way.len();
        self.state.copy_from_slice(self.way.state(from, self.size));
        self.trial.inputs.clear();
        self.trial.states.clear();
        let mut straying = 0;
        let mut replaced = None;
        for number in 0..(hold + total - to).min(hold.saturating_add(apart)) {
            let input = if number < hold { input } else { self.way.inputs[to + number - hold] };
            let status = self.step(from + number, input)?;
            self.trial.inputs.push(input);
            self.trial.states.extend_from_slice(&self.state);
            match status {
                StateStatus::Open => {}
                StateStatus::Goal => {
                    replaced = Some(total);
                    break;
                }
                StateStatus::Dead(_) => return None,
            }
            if number < hold {
                continue;
            }
            let at = to + number + 1 - hold;
            let before = self.way.state(at, self.size);
            if *before == *self.state {
                replaced = Some(at);
                break;
            }
            let sim = self.problem.sim;
            let is_astray = self.problem.players().iter().any(|&slot| {
                let (here, there) = (sim.position(&self.state, slot), sim.position(before, slot));
                (here.0 - there.0).abs() > ASTRAY || (here.1 - there.1).abs() > ASTRAY
            });
            straying = if is_astray { straying + 1 } else { 0 };
            if straying > STRAYING {
                return None;
            }
        }
        replaced.filter(|replaced| self.is_admitted(from, *replaced))
    }

    /// Whether inputs are held for their minimum time if `trial` replaces a part of the way.
    fn is_admitted(&self, from: usize, replaced: usize) -> bool {
        if self.problem.min_hold() <= 1 {
            return true;
        }
        let (before, after) = (&self.way.inputs[..from], &self.way.inputs[replaced..]);
        let mut whole = self.prefix.0.clone();
        let all = before.iter().chain(&self.trial.inputs).chain(after);
        all.for_each(|&input| whole.push(&self.inputs[input as usize], 1));
        is_held(&whole, self.prefix.1, self.problem.min_hold())
    }
}

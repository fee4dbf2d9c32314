//! Visits all states that inputs lead to, one generation after the other: the states after one step, after two, and so
//! on. Each state is stored once ([`States`]). The states of a generation are numbered one after the other, so they are
//! their own queue, and the first way to a state is one of the shortest.
//!
//! A generation is extended in parts. Threads look at the states that are known at the beginning of a part; what is new
//! is added afterwards in order, so that numbers do not depend on threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::ir::SpaceId;
use crate::sim::{Fault, Input, Scratch, Simulator};
use crate::watch::{Meter, Watch};

use super::super::problem::StateStatus;
use super::classes::Classes;
use super::free::FreeTouches;
use super::occupied::Occupied;
use super::states::{Full, States, UNKNOWN};

/// Maximum number of states of a part of a generation.
const PART: usize = 1 << 15;
/// Number of states that a thread takes at once.
const BLOCK: usize = 256;
/// If a generation is more than twice as large as the one this many steps before, the states multiply: in most worlds
/// they do so at first, and in some for ever.
const DOUBLING: usize = 4;
/// The share of the budget of states that may multiply, and its minimum.
const MULTIPLYING: (u64, u64) = (64, 1 << 16);

/// What is visited.
pub(super) struct Question<'q> {
    pub sim: &'q Simulator,
    /// All combinations of inputs.
    pub inputs: &'q [Input],
    /// Minimum number of steps for which an input is held.
    pub min_hold: u16,
    /// Maximum number of steps.
    pub within: Option<u32>,
    /// What ends a run.
    pub judge: &'q (dyn Fn(&[u8]) -> Result<StateStatus, Fault> + Sync),
    /// The space whose search window a player has left.
    pub left: &'q (dyn Fn(&[u8]) -> Option<SpaceId> + Sync),
    /// Contacts with what was left out.
    pub free: &'q FreeTouches,
}

/// Limits of a visit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub states: u64,
    /// Steps that are simulated.
    pub steps: u64,
    /// Bytes.
    pub memory: u64,
}

/// How a visit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// Nothing is left to visit, or no time.
    Exhausted,
    /// From this state, this choice leads to the target.
    Goal(u32, Choice),
    /// A player left a search window.
    Cut(SpaceId),
    /// A step broke a rule.
    Fault,
    /// A limit was reached.
    Full,
    /// The watch stopped it.
    Stopped,
}

/// What happens in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Choice {
    /// The index of the input.
    pub input: u16,
    /// Whether it is the one that was held before.
    pub continues: bool,
    /// Of the contacts that may be there, those that are, one bit each.
    pub contacts: u32,
}

/// A visit: the states so far.
pub(super) struct Visit<'q> {
    question: Question<'q>,
    pub states: States,
    /// Number of steps simulated.
    pub steps: u64,
    /// Number of whole generations.
    pub generations: u32,
    workers: Vec<Worker<'q>>,
}

/// The memory of a thread.
struct Worker<'q> {
    scratch: Scratch,
    meter: Meter<'q>,
    /// The state that is extended: its bytes, its words and their numbers.
    bytes: Vec<u8>,
    values: Vec<u64>,
    numbers: Vec<u32>,
    /// The state after a step.
    work: Vec<u8>,
    next: Vec<u64>,
    classes: Classes,
    /// Number of steps that were simulated.
    steps: u64,
    /// Where the colliders of instances were, if that is recorded.
    occupied: Option<Occupied>,
}

/// What a thread found from some states.
#[derive(Default)]
struct Found {
    parents: Vec<u32>,
    numbers: Vec<u32>,
    values: Vec<u64>,
    steps: u64,
    ended: Option<Ended>,
}

/// A step from a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reached {
    /// To a state, which is in [`Worker::next`].
    Open,
    Goal,
    Dead,
    Cut(SpaceId),
    Fault,
}

impl<'q> Visit<'q> {
    /// A visit of what some starts lead to, by a number of threads; `occupied` records where colliders are.
    ///
    /// [`Full`] if the starts cannot be stored.
    pub fn new(
        question: Question<'q>,
        starts: &[(&[u8], Option<u16>)],
        (threads, watch): (usize, &'q dyn Watch),
        occupied: Option<&Occupied>,
    ) -> Result<Self, Full> {
        let size = question.sim.world().layout.size;
        let words = size / 8 + usize::from(question.min_hold > 1);
        let worker = |_| Worker {
            scratch: question.sim.scratch(),
            meter: Meter::new(watch),
            bytes: vec![0; size],
            values: vec![0; words],
            numbers: vec![0; words],
            work: vec![0; size],
            next: vec![0; words],
            classes: Classes::default(),
            steps: 0,
            occupied: occupied.cloned(),
        };
        let workers = (0..threads.max(1)).map(worker).collect();
        let mut visit = Visit { question, states: States::new(words), steps: 0, generations: 0, workers };
        let mut values = vec![0; words];
        for (start, held) in starts {
            to_words(start, &mut values);
            if let Some(hold) = values.get_mut(size / 8) {
                *hold = hold_word(held.map(|input| (input, 0)));
            }
            visit.states.add(&mut vec![UNKNOWN; words], &values, None)?;
        }
        Ok(visit)
    }

    /// Visits until it ends.
    pub fn run(&mut self, limits: &Limits) -> Ended {
        let mut from = 0;
        let mut end = self.states.len();
        let mut sizes = vec![end];
        let most_multiplying = (limits.states / MULTIPLYING.0).max(MULTIPLYING.1);
        loop {
            if from == end {
                self.generations += u32::from(end < self.states.len());
                if end == self.states.len() || self.question.within.is_some_and(|most| self.generations >= most) {
                    return Ended::Exhausted;
                }
                sizes.push(self.states.len() - end);
                end = self.states.len();
                let before = sizes.len().checked_sub(1 + DOUBLING).map_or(0, |at| sizes[at]);
                let multiply = sizes.last().is_some_and(|last| *last > 2 * before);
                if multiply && end as u64 > most_multiplying {
                    return Ended::Full;
                }
            }
            let is_full = self.states.len() as u64 > limits.states || self.steps > limits.steps;
            if is_full || self.states.bytes() as u64 > limits.memory {
                return Ended::Full;
            }
            if self.question.within == Some(0) {
                return Ended::Exhausted;
            }
            let part = from..end.min(from + PART);
            from = part.end;
            for found in self.extend(part) {
                self.steps += found.steps;
                let words = self.workers[0].values.len();
                let mut numbers = found.numbers;
                for (at, &parent) in found.parents.iter().enumerate() {
                    let of = at * words..(at + 1) * words;
                    if self.states.add(&mut numbers[of.clone()], &found.values[of], Some(parent)).is_err() {
                        return Ended::Full;
                    }
                }
                if let Some(ended) = found.ended {
                    return ended;
                }
            }
        }
    }

    /// Extends some states; returns what was found, block by block.
    fn extend(&mut self, part: std::ops::Range<usize>) -> Vec<Found> {
        let (question, states) = (&self.question, &self.states);
        let blocks = part.len().div_ceil(BLOCK);
        let block = |at: usize| part.start + at * BLOCK..part.end.min(part.start + (at + 1) * BLOCK);
        let next = AtomicUsize::new(0);
        let work = |worker: &mut Worker<'_>| {
            let mut done = Vec::new();
            loop {
                let at = next.fetch_add(1, Ordering::Relaxed);
                if at >= blocks {
                    return done;
                }
                done.push((at, worker.extend(question, states, block(at))));
            }
        };
        let threads = self.workers.len().min(blocks);
        let mut all = match &mut self.workers[..threads] {
            [only] => work(only),
            [first, others @ ..] => thread::scope(|scope| {
                let work = &work;
                let spawn = |worker| thread::Builder::new().spawn_scoped(scope, move || work(worker)).ok();
                // Threads that the system refuses leave their blocks to the others.
                let running: Vec<_> = others.iter_mut().filter_map(spawn).collect();
                let mut all = work(first);
                for thread in running {
                    match thread.join() {
                        Ok(done) => all.extend(done),
                        Err(panic) => std::panic::resume_unwind(panic),
                    }
                }
                all
            }),
            [] => Vec::new(),
        };
        all.sort_by_key(|(at, _)| *at);
        all.into_iter().map(|(_, found)| found).collect()
    }

    /// The choices from a start to a state, and the start.
    pub fn way(&mut self, state: u32) -> (u32, Vec<Choice>) {
        let mut chain = vec![state];
        let mut last = state;
        while self.states.parent(last) != last {
            last = self.states.parent(last);
            chain.push(last);
        }
        chain.reverse();
        let mut wanted = self.workers[0].next.clone();
        let mut numbers = vec![0; wanted.len()];
        let mut choices = Vec::new();
        for pair in chain.windows(2) {
            self.states.read(pair[1], &mut numbers, &mut wanted);
            let mut by = None;
            self.workers[0].each(&self.question, &self.states, pair[0], |worker, choice, reached| {
                let is_it = matches!(reached, Reached::Open) && worker.next == wanted;
                by = is_it.then_some(choice);
                is_it
            });
            choices.extend(by);
        }
        (last, choices)
    }

    /// Reads states.
    pub fn reader(&self) -> StateReader {
        let words = self.workers.first().map_or(0, |worker| worker.values.len());
        StateReader { numbers: vec![0; words], values: vec![0; words] }
    }

    /// Where colliders were, all threads together.
    pub fn into_occupied(self) -> Option<Occupied> {
        self.workers.into_iter().filter_map(|worker| worker.occupied).reduce(Occupied::join)
    }
}

/// The working memory to read states.
pub(super) struct StateReader {
    numbers: Vec<u32>,
    values: Vec<u64>,
}

impl StateReader {
    /// The bytes of a state.
    pub fn read(&mut self, states: &States, state: u32, bytes: &mut [u8]) {
        states.read(state, &mut self.numbers, &mut self.values);
        to_bytes(&self.values, bytes);
    }
}

impl Worker<'_> {
    /// Extends some states.
    fn extend(&mut self, question: &Question<'_>, states: &States, block: std::ops::Range<usize>) -> Found {
        let mut found = Found::default();
        let words = self.values.len();
        let before = self.steps;
        for state in block {
            let state = state as u32;
            let first = found.values.len();
            self.each(question, states, state, |worker, choice, reached| {
                found.ended = match reached {
                    Reached::Open => None,
                    Reached::Goal => Some(Ended::Goal(state, choice)),
                    Reached::Dead => None,
                    Reached::Cut(space) => Some(Ended::Cut(space)),
                    Reached::Fault => Some(Ended::Fault),
                };
                if matches!(reached, Reached::Open) {
                    // Many inputs lead to the same state.
                    let is_known = found.values[first..].chunks_exact(words).any(|known| known == worker.next);
                    if !is_known {
                        let begin = found.numbers.len();
                        let mut is_new = false;
                        for (word, &value) in worker.next.iter().enumerate() {
                            let number = match value == worker.values[word] {
                                true => worker.numbers[word],
                                false => states.number(word, value),
                            };
                            is_new |= number == UNKNOWN;
                            found.numbers.push(number);
                        }
                        if is_new || !states.contains(&found.numbers[begin..]) {
                            found.values.extend(&worker.next);
                            found.parents.push(state);
                        } else {
                            found.numbers.truncate(begin);
                        }
                    }
                }
                found.ended.is_some()
            });
            if self.meter.is_stopped() {
                found.ended = Some(Ended::Stopped);
            }
            if found.ended.is_some() {
                break;
            }
        }
        found.steps = self.steps - before;
        found
    }

    /// Takes each step from a state, until `visit` returns true.
    fn each(
        &mut self,
        question: &Question<'_>,
        states: &States,
        state: u32,
        mut visit: impl FnMut(&Self, Choice, Reached) -> bool,
    ) {
        states.read(state, &mut self.numbers, &mut self.values);
        to_bytes(&self.values, &mut self.bytes);
        let was_left = (question.left)(&self.bytes).is_some();
        if question.min_hold == 1 {
            return self.each_class(question, was_left, visit);
        }
        let held = self.values.get(self.bytes.len() / 8).and_then(|word| hold_of(*word));
        let all = 0..question.inputs.len() as u16;
        let (new, continued) = match held {
            // No choice before the hold is over.
            Some((_, 1..)) => (0..0, held),
            Some((_, 0)) => (all, held),
            None => (all, None),
        };
        let may = question.free.set_in(question.sim, &self.bytes);
        let inputs = continued.map(|(input, left)| (input, true, left.saturating_sub(1)));
        let inputs = inputs.into_iter().chain(new.map(|input| (input, false, question.min_hold - 1)));
        for (input, continues, left) in inputs {
            // All subsets of the contacts that may be there.
            let mut contacts = may;
            loop {
                let reached = self.step(question, (input, left), (may, contacts), was_left);
                self.steps += 1;
                if self.meter.is_stopped() || visit(self, Choice { input, continues, contacts }, reached) {
                    return;
                }
                if contacts == 0 {
                    break;
                }
                contacts = (contacts - 1) & may;
            }
        }
    }

    /// As [`Worker::each`], where inputs can change at each step: of inputs that make no difference one is simulated.
    fn each_class(
        &mut self,
        question: &Question<'_>,
        was_left: bool,
        mut visit: impl FnMut(&Self, Choice, Reached) -> bool,
    ) {
        let may = question.free.set_in(question.sim, &self.bytes);
        let classes = self.classes.of(question.sim, question.inputs, &self.bytes);
        for class in classes.iter() {
            let mut contacts = may;
            loop {
                let reached = self.step(question, (class.input, 0), (may, contacts), was_left);
                if self.meter.is_stopped() {
                    return;
                }
                self.steps += 1;
                for (input, buttons) in &class.variants {
                    for (&at, buttons) in question.sim.world().layout.players.iter().zip(buttons) {
                        self.next[at / 8] = *buttons;
                    }
                    if visit(self, Choice { input: *input, continues: false, contacts }, reached) {
                        return;
                    }
                    if reached != Reached::Open {
                        break;
                    }
                }
                if contacts == 0 {
                    break;
                }
                contacts = (contacts - 1) & may;
            }
        }
    }

    /// Takes a step with an input and some of the contacts that may be there.
    #[inline]
    fn step(
        &mut self,
        question: &Question<'_>,
        (input, left): (u16, u16),
        (may, contacts): (u32, u32),
        was_left: bool,
    ) -> Reached {
        let sim = question.sim;
        self.work.copy_from_slice(&self.bytes);
        if may != 0 {
            question.free.keep_only(sim, &mut self.work, contacts);
        }
        let input_of_step = &question.inputs[usize::from(input)];
        if sim.metered_step(&mut self.work, input_of_step, &mut self.scratch, &self.meter).is_err() {
            return Reached::Fault;
        }
        if let Some(occupied) = &mut self.occupied {
            occupied.mark(&self.scratch);
        }
        question.free.set_possible(sim, &mut self.work, &self.scratch);
        match (question.judge)(&self.work) {
            Ok(StateStatus::Open) => {}
            Ok(StateStatus::Goal) => return Reached::Goal,
            Ok(StateStatus::Dead(_)) => return Reached::Dead,
            Err(_) => return Reached::Fault,
        }
        // As everywhere, one state beyond the window is simulated.
        if let Some(space) = (question.left)(&self.work)
            && was_left
        {
            return Reached::Cut(space);
        }
        to_words(&self.work, &mut self.next);
        if let Some(hold) = self.next.get_mut(self.work.len() / 8) {
            *hold = hold_word(Some((input, left)));
        }
        Reached::Open
    }
}

/// The words of a state.
#[inline]
fn to_words(bytes: &[u8], words: &mut [u64]) {
    for (at, chunk) in bytes.as_chunks::<8>().0.iter().enumerate() {
        words[at] = u64::from_le_bytes(*chunk);
    }
}

#[inline]
fn to_bytes(words: &[u64], bytes: &mut [u8]) {
    for (at, chunk) in bytes.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        *chunk = words[at].to_le_bytes();
    }
}

/// What is held and for how many steps it must be, as a word: 0 for nothing.
fn hold_word(held: Option<(u16, u16)>) -> u64 {
    held.map_or(0, |(input, left)| 1 + (u64::from(input) << 16 | u64::from(left)))
}

fn hold_of(word: u64) -> Option<(u16, u16)> {
    word.checked_sub(1).map(|held| ((held >> 16) as u16, held as u16))
}

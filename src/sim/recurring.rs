//! Steps of instances that nothing touches are remembered: in a search the same enemies walk the same ways again and again,
//! on many branches. What an instance does next follows from its own bytes, as far as it reads no other and no input, takes
//! no edge, and no other comes near. So a step looks its bytes up, and takes over what came of them; of what stays as it is
//! it looks at nothing. The result is the same to the bit, work included. This is memoization of transitions, instance by
//! instance.

use std::hash::BuildHasher;
use std::ops::Range;
use std::sync::Arc;

use hashbrown::{DefaultHashBuilder, HashTable};

use crate::ir::Id;

use super::actor::Actor;
use super::collision::Body;
use super::recall::Recall;
use super::simulator::Simulator;
use super::state::{real, set_real};

/// Minimum number of instances for which it pays.
const FEWEST: usize = 3;
/// Maximum number of states that are remembered of instances with one code; beyond it they are forgotten.
const MOST: usize = 1 << 15;
/// No state, or not known; and there is no instance.
const NONE: u32 = u32::MAX;
const ABSENT: u32 = u32::MAX - 1;

/// What comes of a state.
#[derive(Debug, Clone, Copy)]
struct Next {
    /// The next one; [`NONE`] if it is not known.
    state: u32,
    /// The work of finding its contacts.
    work: u32,
    /// Whether it stays as it is, without contacts.
    is_still: bool,
}

/// Nothing is known.
const UNKNOWN: Next = Next { state: NONE, work: 0, is_still: false };

/// The states of instances that do the same from the same bytes, by number.
#[derive(Debug, Clone, Default)]
struct States {
    /// The size of a state, bytes.
    size: usize,
    /// Each state, followed by what its flows make of it, before contacts.
    bytes: Vec<u8>,
    /// What comes of each state.
    next: Vec<Next>,
    table: HashTable<u32>,
    hasher: DefaultHashBuilder,
}

impl States {
    fn before(&self, state: u32) -> &[u8] {
        &self.bytes[2 * self.size * state as usize..][..self.size]
    }

    fn moved(&self, state: u32) -> &[u8] {
        &self.bytes[(2 * state as usize + 1) * self.size..][..self.size]
    }

    fn find(&self, block: &[u8]) -> u32 {
        let hash = self.hasher.hash_one(block);
        self.table.find(hash, |state| self.before(*state) == block).copied().unwrap_or(NONE)
    }

    /// The number of a state, which may be new.
    fn insert(&mut self, block: &[u8]) -> u32 {
        match self.find(block) {
            NONE => {
                let state = self.next.len() as u32;
                self.next.push(UNKNOWN);
                self.bytes.extend_from_slice(block);
                self.bytes.extend_from_slice(block);
                let States { table, hasher, bytes, size, .. } = self;
                let of = |state: &u32| hasher.hash_one(&bytes[2 * *size * *state as usize..][..*size]);
                table.insert_unique(hasher.hash_one(block), state, of);
                state
            }
            known => known,
        }
    }
}

/// An instance whose steps are remembered.
#[derive(Debug, Clone)]
struct Recurring {
    slot: u32,
    /// Which states are those of its like.
    of: u32,
    /// Where its bytes are in a state, and where its life and its position are among them.
    block: (usize, usize),
    alive: usize,
    vars: usize,
    /// Where a state says what carries it.
    carrier: usize,
    /// Where its contact bits are in its bytes.
    touches: (usize, usize),
    /// Its state when the step began, where it is expected in the next step, and where its boxes were placed last;
    /// [`NONE`] if not known.
    state: u32,
    expected: u32,
    placed: u32,
    /// Whether this step takes over what came of its state, whether another has come near, and whether what it does is to
    /// be remembered.
    is_recalled: bool,
    is_touched: bool,
    is_new: bool,
    /// Whether it stays as it is in this step; and whether it has since the step before, so that steps do not look at it
    /// until another comes near.
    rests: bool,
    sleeps: bool,
    /// The work of finding its contacts.
    work: u64,
}

/// What is remembered of a run and of those before it.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    all: Vec<Recurring>,
    states: Vec<States>,
    /// For each slot, the number of its instance in `all`, if its steps are remembered.
    numbers: Vec<u32>,
    /// The slots of all other instances.
    others: Vec<u32>,
    /// For each slot, the numbers of its bodies.
    bodies: Vec<Range<u32>>,
    /// Those of `all` that do not sleep, in order; and those that did until another came near in this step.
    busy: Vec<u32>,
    roused: Vec<u32>,
    /// The slots that a step looks at: see [`Recall`].
    awake: Vec<u32>,
    moving: Vec<u32>,
    unsettled: Vec<u32>,
    /// The work that those save that sleep.
    asleep: u64,
    /// The state after the last step; empty if it does not count.
    last: Vec<u8>,
    /// States of the world before and after the flows, as far as they are to be remembered.
    before: Vec<u8>,
    moved: Vec<u8>,
}

impl Memory {
    /// Memory for a world; `None` where instances depend on more than themselves, or few could be remembered.
    pub fn of(sim: &Simulator) -> Option<Box<Memory>> {
        let count = sim.actors.len();
        let mut is_plain = vec![true; count];
        let mut bodies = vec![0..0; count];
        for (at, body) in (0..).zip(&sim.collision.bodies) {
            let slot = body.slot.index();
            is_plain[slot] &= body.is_plain;
            // Those of a slot are neighbours.
            bodies[slot] = if bodies[slot].is_empty() { at..at + 1 } else { bodies[slot].start..at + 1 };
        }
        let is_own = |actor: &&Actor| {
            let is_told =
                actor.player.is_some() || actor.signals > 0 || actor.bound > 0 || !actor.entity.refs.is_empty();
            is_plain[actor.index()] && actor.code.is_apart && !actor.code.is_joint && !is_told
        };
        let own: Vec<&Actor> = sim.actors.iter().filter(is_own).collect();
        // Until a step ends, a part of what is known is not in the state: boxes must not depend on it.
        let reads_no_other = |body: &Body| body.is_plain || sim.actors[body.slot.index()].code.is_apart;
        let is_readable = sim.moves_independently || sim.collision.bodies.iter().all(reads_no_other);
        if !is_readable || !sim.is_local() || own.len() < FEWEST {
            return None;
        }
        let mut first: Vec<&Actor> = Vec::new();
        let mut states: Vec<States> = Vec::new();
        let mut numbers = vec![NONE; count];
        let mut all = Vec::new();
        for actor in own {
            let (from, to) = actor.layout.block;
            let of = first.iter().position(|other| are_alike(other, actor)).unwrap_or_else(|| {
                first.push(actor);
                states.push(States { size: to - from, ..States::default() });
                states.len() - 1
            });
            numbers[actor.index()] = all.len() as u32;
            let touches = actor.layout.touches - from;
            all.push(Recurring {
                slot: actor.id.0,
                of: of as u32,
                block: (from, to),
                alive: actor.layout.alive_offset(),
                vars: actor.layout.vars,
                carrier: actor.layout.carrier,
                touches: (touches, touches + actor.touches.div_ceil(8)),
                state: NONE,
                expected: NONE,
                placed: NONE,
                is_recalled: false,
                is_touched: false,
                is_new: false,
                rests: false,
                sleeps: false,
                work: 0,
            });
        }
        let others = (0..).zip(&numbers).filter(|(_, number)| **number == NONE).map(|(slot, _)| slot).collect();
        let size = sim.world().layout.size;
        let list = || Vec::with_capacity(count);
        Some(Box::new(Memory {
            busy: (0..all.len() as u32).collect(),
            all,
            states,
            numbers,
            others,
            bodies,
            roused: list(),
            awake: list(),
            moving: list(),
            unsettled: list(),
            asleep: 0,
            last: Vec::with_capacity(size),
            before: vec![0; size],
            moved: vec![0; size],
        }))
    }

    /// Before a step: looks up what each instance does.
    pub fn recall(&mut self, state: &[u8]) {
        for of in 0..self.states.len() {
            if self.states[of].next.len() >= MOST {
                self.forget(of);
            }
        }
        let Memory { all, states, others, busy, roused, awake, moving, unsettled, asleep, last, .. } = self;
        // Where the run goes on, what rests goes on to.
        if *state != **last {
            busy.clear();
            busy.extend(0..all.len() as u32);
            *asleep = 0;
        }
        // A step that failed may have left some.
        [&mut *roused, awake, moving, unsettled].into_iter().for_each(Vec::clear);
        let mut others = others.iter().copied().peekable();
        for number in busy.iter() {
            let one = &mut all[*number as usize];
            let (from, to) = one.block;
            let (block, states) = (&state[from..to], &states[one.of as usize]);
            // What is carried moves with another.
            let is_alone = state[one.alive] == 1 && state[one.carrier..one.carrier + 2] == [0, 0];
            one.state = match one.expected {
                expected if expected != NONE && states.before(expected) == block => expected,
                _ if is_alone => states.find(block),
                _ => NONE,
            };
            if state[one.alive] == 0 {
                (one.is_recalled, one.is_new, one.is_touched, one.work) = (false, false, false, 0);
                (one.rests, one.sleeps) = (one.placed == ABSENT, false);
                if !one.rests {
                    moving.push(one.slot);
                }
                (one.expected, one.placed) = (NONE, ABSENT);
                continue;
            }
            let next = states.next.get(one.state as usize).copied().unwrap_or(UNKNOWN);
            one.is_recalled = is_alone && next.state != NONE;
            one.is_new = is_alone && !one.is_recalled;
            let is_placed = one.is_recalled && one.placed == one.state;
            (one.rests, one.sleeps) = (is_placed && next.is_still, false);
            if !is_placed {
                moving.push(one.slot);
            }
            if !one.is_recalled {
                while let Some(other) = others.next_if(|other| *other < one.slot) {
                    awake.push(other);
                }
                awake.push(one.slot);
            }
            one.placed = if one.is_recalled { one.state } else { NONE };
            one.expected = next.state;
            (one.is_touched, one.work) = (false, u64::from(next.work));
        }
        awake.extend(others);
        moving.extend(&self.others);
        unsettled.extend_from_slice(awake);
    }

    /// After a step, in which instances were spawned or not: those had been absent, and are looked at again.
    pub fn keep(&mut self, state: &[u8], is_spawned: bool) {
        self.last.clear();
        if !is_spawned {
            self.last.extend_from_slice(state);
        }
    }

    /// The boxes are somewhere else now.
    pub fn forget_boxes(&mut self) {
        self.all.iter_mut().for_each(|one| one.placed = NONE);
        self.last.clear();
    }

    /// Forgets some states.
    fn forget(&mut self, of: usize) {
        let States { bytes, next, table, .. } = &mut self.states[of];
        bytes.clear();
        next.clear();
        table.clear();
        for one in self.all.iter_mut().filter(|one| one.of as usize == of) {
            (one.expected, one.placed) = (NONE, NONE);
        }
        self.last.clear();
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        let of = |of: &States| of.bytes.capacity() + size_of::<Next>() * of.next.capacity() + 5 * of.table.capacity();
        self.states.iter().map(of).sum()
    }

    /// What was known of an instance does not hold in this step: its contacts are found, and it does not sleep.
    fn rouse(&mut self, number: u32) {
        let one = &self.all[number as usize];
        if one.sleeps {
            self.roused.push(number);
            self.asleep -= one.work;
        }
        self.unsettled.push(one.slot);
    }

    fn of_slot(&mut self, slot: usize) -> Option<&mut Recurring> {
        self.all.get_mut(self.numbers[slot] as usize)
    }
}

/// Whether two instances do the same from the same bytes.
fn are_alike(a: &Actor, b: &Actor) -> bool {
    let offsets = |actor: &Actor| {
        let from = actor.layout.block.0;
        let to = [actor.layout.block.1, actor.layout.vars, actor.layout.alive_offset(), actor.leaf_at];
        (to.map(|to| to - from), actor.layout.touches - from)
    };
    Arc::ptr_eq(&a.code, &b.code) && a.timer_limits == b.timer_limits && offsets(a) == offsets(b)
}

impl Recall for Memory {
    const IS_ANY: bool = true;

    #[inline(always)]
    fn awake(&self) -> &[u32] {
        &self.awake
    }

    #[inline(always)]
    fn moving(&self) -> &[u32] {
        &self.moving
    }

    #[inline(always)]
    fn unsettled(&self) -> usize {
        self.unsettled.len()
    }

    #[inline(always)]
    fn unsettled_slot(&self, nth: usize) -> usize {
        self.unsettled[nth] as usize
    }

    #[inline(always)]
    fn bodies(&self, slot: usize) -> Range<usize> {
        let Range { start, end } = self.bodies[slot];
        start as usize..end as usize
    }

    fn acts(&mut self, slot: usize) {
        if let Some(one) = self.of_slot(slot) {
            one.is_new = false;
        }
    }

    fn meet(&mut self, slot: usize, state: &mut [u8]) -> bool {
        let Memory { all, states, numbers, .. } = self;
        let number = numbers[slot];
        let Some(one) = all.get_mut(number as usize) else { return false };
        if std::mem::replace(&mut one.is_touched, true) || !one.is_recalled {
            return false;
        }
        state[one.block.0..one.block.1].copy_from_slice(states[one.of as usize].moved(one.state));
        self.rouse(number);
        true
    }

    #[inline(always)]
    fn add_work(&mut self, slot: usize, work: u64) {
        if let Some(one) = self.of_slot(slot).filter(|one| one.is_new) {
            one.work += work;
        }
    }

    fn lose(&mut self, slot: usize) {
        let number = self.numbers[slot];
        let Some(one) = self.all.get_mut(number as usize) else { return };
        one.is_touched = true;
        if std::mem::take(&mut one.is_recalled) {
            one.rests = false;
            self.moving.push(one.slot);
            self.rouse(number);
        }
    }

    fn note(&mut self, state: &[u8]) {
        let Memory { all, busy, before, .. } = self;
        for one in busy.iter().map(|number| &all[*number as usize]).filter(|one| one.is_new) {
            let (from, to) = one.block;
            before[from..to].copy_from_slice(&state[from..to]);
        }
    }

    fn move_known(&mut self, state: &mut [u8], start: &mut [(f64, f64)]) {
        let Memory { all, states, busy, moved, .. } = self;
        for number in busy.iter() {
            let one = &all[*number as usize];
            let (from, to) = one.block;
            if one.is_recalled && !one.rests {
                start[one.slot as usize] = (real(state, one.vars), real(state, one.vars + 24));
                // Its boxes need no more.
                let moved = states[one.of as usize].moved(one.state);
                set_real(state, one.vars, real(moved, one.vars - from));
                set_real(state, one.vars + 24, real(moved, one.vars + 24 - from));
            } else if one.is_new {
                moved[from..to].copy_from_slice(&state[from..to]);
            }
        }
    }

    fn end(&mut self, state: &mut [u8]) -> u64 {
        let Memory { all, states, busy, roused, asleep, before, moved, .. } = self;
        let mut saved = 0;
        busy.retain(|number| {
            let one = &mut all[*number as usize];
            let (from, to) = one.block;
            let states = &mut states[one.of as usize];
            if one.is_touched {
                (one.expected, one.placed) = (NONE, NONE);
            } else if one.rests {
                one.sleeps = true;
                *asleep += one.work;
                return false;
            } else if one.is_recalled {
                state[from..to].copy_from_slice(states.before(one.expected));
                saved += one.work;
            } else if one.is_new {
                let begun = if one.state == NONE { states.insert(&before[from..to]) } else { one.state };
                let next = states.insert(&state[from..to]);
                // Contacts are found anew if another comes near.
                let moved = &mut moved[from..to];
                moved[one.touches.0..one.touches.1].fill(0);
                let is_still = next == begun && *moved == state[from..to];
                let at = (2 * begun as usize + 1) * states.size;
                states.bytes[at..at + states.size].copy_from_slice(moved);
                states.next[begun as usize] = Next { state: next, work: one.work as u32, is_still };
                one.expected = next;
            }
            true
        });
        for number in roused.drain(..) {
            let one = &mut all[number as usize];
            (one.expected, one.placed, one.sleeps) = (NONE, NONE, false);
            if let Err(at) = busy.binary_search(&number) {
                busy.insert(at, number);
            }
        }
        saved + *asleep
    }
}

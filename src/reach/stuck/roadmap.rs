//! A roadmap of the places at which players can rest: with no input for a while they stay where they are. Most games can
//! be left alone there, so a way between two of them can be continued by any way from the second.
//!
//! Places are told apart by what lasts: where the players are, their modes and discrete values, which of the placed
//! instances live, which tiles are broken, and the place, modes and discrete values of all instances that change only
//! when players do something. Two states of one place can still differ, so what the roadmap says is no proof.

use std::collections::BTreeMap;

use crate::ir::{Origin, SlotId};
use crate::sim::{Fault, Input, Script};

use super::super::coverage::mix;
use super::super::problem::{Problem, StateStatus};
use super::place::{Places, PlayerPlace};

/// Number of steps without input after which an instance that has not changed is taken to change for players only.
const CALM_STEPS: u64 = 300;
/// Number of steps without input for which players that rest stay where they are.
const REST_STEPS: u64 = 2;

/// What tells places apart: where the players are, and a hash of the rest.
pub(super) type Key = (Vec<PlayerPlace>, u64);

/// A place at which players rest, or the start.
pub(super) struct RestPlace {
    pub key: Key,
    pub state: Vec<u8>,
    /// The place from which it was found first; its own number for the start.
    pub parent: u32,
    /// The inputs from there.
    pub inputs: Script,
    /// Number of steps from the initial state.
    pub steps: u64,
    /// The places that ways from it lead to.
    pub next: Vec<u32>,
    /// Whether a way from it comes back to it: the run goes on there.
    pub returns: bool,
    /// Whether a way from it reaches the goal directly.
    pub is_at_goal: bool,
    /// Number of ways that were tried from it.
    pub tried: u32,
}

/// The places and the ways between them.
pub(super) struct Roadmap<'p> {
    pub problem: &'p Problem<'p>,
    pub names: Places<'p>,
    pub places: Vec<RestPlace>,
    known: BTreeMap<Key, u32>,
    /// The number of places at the same spots.
    at_spots: BTreeMap<Vec<PlayerPlace>, u32>,
    /// The instances that change only when players do something.
    pub calm: Vec<SlotId>,
}

impl<'p> Roadmap<'p> {
    /// A roadmap with the start only.
    ///
    /// # Errors
    /// A [`Fault`] if a step without input breaks a rule.
    pub fn new(problem: &'p Problem<'p>, start: &[u8]) -> Result<Self, Fault> {
        let names = Places::new(problem);
        let calm = calm_slots(problem, start, &names)?;
        let mut roadmap =
            Roadmap { problem, names, places: Vec::new(), known: BTreeMap::new(), at_spots: BTreeMap::new(), calm };
        roadmap.add(start, 0, Script::default());
        Ok(roadmap)
    }

    /// The key of a state.
    fn key(&self, state: &[u8]) -> Key {
        let sim = self.problem.sim;
        let world = sim.world();
        let mut rest = 0;
        for (slot, placed) in world.slots.pairs().filter(|(_, slot)| slot.origin != Origin::Free) {
            if placed.player.is_none() {
                rest = mix(rest, u64::from(world.layout.slots[slot].alive(state)));
            }
        }
        for &slot in &self.calm {
            rest = mix(rest, look(self.problem, state, slot, &self.names));
        }
        for tile in sim.broken_tiles(state) {
            rest = mix(rest, u64::from(tile.0) + 1);
        }
        (self.names.players(state), rest)
    }

    /// The place of a state, which is added if it is new.
    pub fn add(&mut self, state: &[u8], parent: u32, inputs: Script) -> u32 {
        let key = self.key(state);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let place = self.places.len() as u32;
        let before = self.places.get(parent as usize).map_or(0, |parent| parent.steps);
        let steps = before + inputs.len();
        *self.at_spots.entry(key.0.clone()).or_default() += 1;
        self.known.insert(key.clone(), place);
        let (state, next) = (state.to_vec(), Vec::new());
        self.places.push(RestPlace {
            key,
            state,
            parent,
            inputs,
            steps,
            next,
            returns: false,
            is_at_goal: false,
            tried: 0,
        });
        place
    }

    /// Notes a way between two places.
    pub fn connect(&mut self, from: u32, to: u32) {
        let place = &mut self.places[from as usize];
        if from == to {
            place.returns = true;
        } else if !place.next.contains(&to) {
            place.next.push(to);
        }
    }

    /// The number of places where the players are the same.
    pub fn at_same_spot(&self, place: u32) -> u32 {
        self.at_spots.get(&self.places[place as usize].key.0).copied().unwrap_or(0)
    }

    /// The inputs from the initial state to a place.
    pub fn script(&self, place: u32) -> Script {
        let mut chain = Vec::new();
        let mut at = place;
        loop {
            let place = &self.places[at as usize];
            chain.push(&place.inputs);
            if place.parent == at {
                break;
            }
            at = place.parent;
        }
        let mut script = Script::default();
        for inputs in chain.into_iter().rev() {
            inputs.steps.iter().for_each(|step| script.push(&step.input, step.count));
        }
        script
    }

    /// The places that have a way to one of some places, these included.
    pub fn leading_to(&self, is_target: impl Fn(&RestPlace) -> bool) -> Vec<bool> {
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); self.places.len()];
        for (from, place) in (0u32..).zip(&self.places) {
            place.next.iter().for_each(|to| before[*to as usize].push(from));
        }
        let mut leads: Vec<bool> = self.places.iter().map(is_target).collect();
        let mut open: Vec<u32> = (0u32..).zip(&leads).filter(|(_, leads)| **leads).map(|(place, _)| place).collect();
        while let Some(place) = open.pop() {
            for &from in &before[place as usize] {
                if !std::mem::replace(&mut leads[from as usize], true) {
                    open.push(from);
                }
            }
        }
        leads
    }

    /// The places that some place leads to, itself included, among those that pass a test.
    pub fn behind(&self, place: u32, is_counted: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut seen = vec![false; self.places.len()];
        seen[place as usize] = true;
        let mut found = vec![place];
        let mut at = 0;
        while let Some(&place) = found.get(at) {
            at += 1;
            for &next in &self.places[place as usize].next {
                if is_counted(next) && !std::mem::replace(&mut seen[next as usize], true) {
                    found.push(next);
                }
            }
        }
        found
    }
}

/// A hash of what is seen of an instance.
fn look(problem: &Problem<'_>, state: &[u8], slot: SlotId, places: &Places<'_>) -> u64 {
    let instance = problem.sim.instance(state, slot);
    if !instance.is_alive() {
        return 0;
    }
    let (column, row) = places.tile(state, slot);
    let mut hash = [u64::from(instance.space().0), column as u64, row as u64].into_iter().fold(1, mix);
    let entity = instance.entity();
    for group in entity.groups.ids() {
        hash = mix(hash, u64::from(instance.leaf(group).0));
    }
    entity.discretes.ids().fold(hash, |hash, discrete| mix(hash, instance.discrete(discrete) as u64))
}

/// The placed instances without a player that look the same for a while if there is no input.
fn calm_slots(problem: &Problem<'_>, start: &[u8], places: &Places<'_>) -> Result<Vec<SlotId>, Fault> {
    let sim = problem.sim;
    let world = sim.world();
    let others = world.slots.pairs().filter(|(_, slot)| slot.origin != Origin::Free && slot.player.is_none());
    let mut calm: Vec<(SlotId, u64)> = others.map(|(slot, _)| (slot, look(problem, start, slot, places))).collect();
    let (mut state, mut scratch) = (start.to_vec(), sim.scratch());
    let nothing = Input::nothing(world.players.len());
    for step in 1..=CALM_STEPS {
        sim.step(&mut state, &sim.draw(0, step, &nothing), &mut scratch)?;
        if matches!(problem.judge(&state)?, StateStatus::Dead(_)) {
            break;
        }
        // A thing that falls to the ground first settles.
        if step == CALM_STEPS / 10 {
            calm.iter_mut().for_each(|(slot, seen)| *seen = look(problem, &state, *slot, places));
        }
        if step > CALM_STEPS / 10 {
            calm.retain(|(slot, seen)| *seen == look(problem, &state, *slot, places));
        }
    }
    Ok(calm.into_iter().map(|(slot, _)| slot).collect())
}

/// Whether players stay where they are, and in their modes, without input.
pub(super) struct RestTest {
    seen: Vec<u64>,
    since: u64,
}

impl RestTest {
    pub fn new() -> Self {
        RestTest { seen: Vec::new(), since: 0 }
    }

    /// Whether players rest after one more step without input.
    pub fn rests(&mut self, problem: &Problem<'_>, state: &[u8]) -> bool {
        let mut now = Vec::with_capacity(self.seen.len());
        for &slot in problem.players() {
            let instance = problem.sim.instance(state, slot);
            let (x, y) = instance.position();
            now.extend([u64::from(instance.is_alive()), u64::from(instance.space().0), x.to_bits(), y.to_bits()]);
            if instance.is_alive() {
                now.extend(instance.entity().groups.ids().map(|group| u64::from(instance.leaf(group).0)));
            }
        }
        self.since = if now == self.seen { self.since + 1 } else { 0 };
        self.seen = now;
        self.since >= REST_STEPS
    }
}

//! A state as a value: cloned, compared, hashed, saved and loaded. A loaded state is verified completely, so that a
//! file cannot cause invalid steps.

use std::fmt;
use std::ops::{Deref, DerefMut};

use crate::ir::{Id, SlotId};

use super::fnv::Fnv;
use super::simulator::Simulator;
use super::state::{Life, buttons};

/// A state of a world. Between two steps equal states have equal bytes, and equal futures.
#[derive(PartialEq, Eq, Hash)]
pub struct State(Vec<u8>);

impl State {
    /// The state with these bytes, in the layout of the world.
    pub(super) fn new(bytes: Vec<u8>) -> State {
        State(bytes)
    }
}

impl Clone for State {
    fn clone(&self) -> State {
        State(self.0.clone())
    }

    /// Reuses the memory: nothing is allocated between states of one world.
    fn clone_from(&mut self, other: &State) {
        self.0.clone_from(&other.0);
    }
}

/// The bytes, for reading with the layout of the world.
impl Deref for State {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.0
    }
}

/// The bytes, for writing with the layout of the world: the simulator relies on valid contents.
impl DerefMut for State {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut self.0
    }
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "State({} bytes)", self.0.len())
    }
}

/// The magic number of a saved state.
const MAGIC: [u8; 8] = *b"hypedst1";

/// Why bytes are not a state of a world.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotAState {
    /// They were not saved as a state.
    Header,
    /// They were saved in a world with other instances, variables, modes or contacts.
    OtherWorld,
    /// An instance has an invalid value.
    Damaged {
        /// The instance; `None` for the buttons of the players.
        instance: Option<String>,
        /// What is wrong.
        what: &'static str,
    },
}

impl fmt::Display for NotAState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotAState::Header => write!(f, "this is not a saved state"),
            NotAState::OtherWorld => write!(f, "the state was saved in a world with other instances or variables"),
            NotAState::Damaged { instance: Some(name), what } => {
                write!(f, "the saved state is damaged: {name}: {what}")
            }
            NotAState::Damaged { instance: None, what } => write!(f, "the saved state is damaged: {what}"),
        }
    }
}

impl std::error::Error for NotAState {}

impl Simulator {
    /// A state as bytes that [`Simulator::load`] reads, even after numbers in the program have changed.
    pub fn save(&self, state: &State) -> Vec<u8> {
        [&MAGIC[..], &self.fingerprint().to_le_bytes(), state].concat()
    }

    /// Loads a saved state.
    ///
    /// [`NotAState`] if it belongs to another world, or has invalid contents.
    pub fn load(&self, bytes: &[u8]) -> Result<State, NotAState> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(NotAState::Header)?;
        let (fingerprint, state) = rest.split_first_chunk().ok_or(NotAState::Header)?;
        if *fingerprint != self.fingerprint().to_le_bytes() || state.len() != self.world().layout.size {
            return Err(NotAState::OtherWorld);
        }
        let damaged = |instance: Option<SlotId>, what| NotAState::Damaged {
            instance: instance.map(|slot| self.world().slots[slot].name.clone()),
            what,
        };
        let of_players = self.world().layout.players.iter();
        if of_players.into_iter().any(|at| buttons(state, *at) & !self.remembered != 0) {
            return Err(damaged(None, "a button that nothing reads is down"));
        }
        for slot in self.world().slots.ids() {
            self.check(state, slot).map_err(|what| damaged(Some(slot), what))?;
        }
        if let Some(breakables) = &self.breakables {
            breakables.check(state).map_err(|what| damaged(None, what))?;
        }
        Ok(State(state.to_vec()))
    }

    /// Checks a slot of a state.
    pub(super) fn check(&self, state: &[u8], slot: SlotId) -> Result<(), &'static str> {
        let (layout, entity, world) = (self.layout(slot), self.entity(slot), self.world());
        let must = |holds: bool, what| if holds { Ok(()) } else { Err(what) };
        match state[layout.alive] {
            0 => {
                let is_blank = state[layout.block.0..layout.block.1].iter().all(|byte| *byte == 0);
                return must(is_blank, "there is no instance, but it has values");
            }
            alive => must(alive == Life::Alive as u8, "it is neither there nor not there")?,
        }
        let is_number = |value: f64| value.is_finite() && (value != 0.0 || value.is_sign_positive());
        for var in entity.vars.ids() {
            must((0..=2).all(|degree| is_number(layout.var(state, var, degree))), "a variable is no number")?;
        }
        for param in entity.params.ids() {
            must(layout.param(state, param).is_none_or(is_number), "a parameter is no number")?;
        }
        for (id, discrete) in entity.discretes.pairs() {
            let (low, high) = discrete.range;
            must((low..=high).contains(&layout.discrete(state, id)), "a variable is out of its range")?;
        }
        for id in entity.timers.ids() {
            must(layout.timer(state, id) <= world.slots[slot].timer_limits[id], "a timer is out of its range")?;
        }
        for (id, group) in entity.groups.pairs() {
            must(entity.leaves_of(group).contains(layout.leaf(state, id)), "a group is in no mode of its own")?;
        }
        must(layout.space(state).index() < world.spaces.len(), "it is in no space")?;
        let is_there = |target: SlotId| target.index() < world.slots.len() && self.layout(target).alive(state);
        for (id, reference) in entity.refs.pairs() {
            let fits =
                |target| is_there(target) && reference.entity.is_none_or(|entity| entity == world.slots[target].entity);
            must(layout.reference(state, id).is_none_or(fits), "a reference is to nothing that it can be to")?;
        }
        let touched = entity.touches.ids().take(entity.bound);
        let is_slot = |target: SlotId| target.index() < world.slots.len();
        let mut others = touched.filter_map(|touch| layout.touched(state, touch)).chain(layout.carrier(state));
        must(others.all(is_slot), "what it touches or is on is nothing")?;
        let tiles = world.layout.tiles.as_ref().map_or(0, |tiles| tiles.count);
        let mut touched = entity.touches.ids().take(entity.bound).filter_map(|id| layout.touched_tile(state, id));
        must(touched.all(|tile| tile.index() < tiles), "a tile that it touches is none")
    }

    /// A fingerprint of the meaning of a state's bytes: FNV-1a over the names and structure of the world. Numbers, guards
    /// and edges of the program are not part of it.
    fn fingerprint(&self) -> u64 {
        let mut hash = Fnv::new();
        let mut add = |text: &str| {
            hash.add(text.as_bytes());
            hash.add(&[0xff]);
        };
        for (slot, table) in self.world().slots.pairs() {
            let (entity, layout) = (self.entity(slot), self.layout(slot));
            add(&table.name);
            add(&entity.name);
            entity.vars.iter().for_each(|name| add(name));
            if layout.rest.is_some() {
                add("rests");
            }
            if layout.params.is_some() {
                entity.params.iter().for_each(|param| add(&param.name));
            }
            entity.discretes.iter().for_each(|discrete| add(&format!("{} {:?}", discrete.name, discrete.domain)));
            entity.timers.iter().for_each(|timer| add(&entity.modes[timer.mode].path));
            entity.leaves.iter().for_each(|leaf| add(&entity.modes[leaf.mode].path));
            entity.refs.iter().for_each(|reference| add(&reference.name));
            entity.signals.iter().for_each(|s| add(&format!("{} {}", s.name, s.number.is_some())));
            for touch in entity.touches.iter() {
                let kept = if touch.tiles { " tiles" } else { "" };
                add(&format!("{} {} {:?} {}{kept}", touch.mine.0, touch.other, touch.side, touch.bound));
            }
            add(&entity.envelopes.len().to_string());
        }
        self.program().tags.iter().for_each(|tag| add(tag));
        self.world().spaces.iter().for_each(|space| add(&space.name));
        for (space, cell) in self.breakables.iter().flat_map(|breakables| breakables.tiles.places.iter()) {
            add(&format!("{space} {cell}"));
        }
        self.world().players.iter().for_each(|player| add(&player.number.to_string()));
        hash.value()
    }
}

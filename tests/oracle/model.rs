//! The state of a world between two steps, in its simplest form.
use hypedc::ir::{Id, SlotId};

use hypedc::ir::{EntityId, ModeId, Side, TagId, WorldId};

use std::collections::{BTreeMap, BTreeSet};

use hypedc::sema::checked::{Checked, Entity, World};

/// A run-time fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    NotFinite,
    DivisionByZero,
    Diverged,
    OutOfRange,
    ReadNone,
}

/// The input of one player in a step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Keys {
    /// The buttons that are down.
    pub held: BTreeSet<u32>,
    /// The axes.
    pub axes: [f64; 4],
}

/// The inputs of a step: of each player, and what nature draws for the chances of each slot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moves {
    pub keys: Vec<Keys>,
    pub drawn: Vec<Vec<i32>>,
}

/// A contact of one of an instance's colliders.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Contact {
    /// The tags of the instance's own collider.
    pub mine: BTreeSet<TagId>,
    /// The tags of the other side.
    pub other: BTreeSet<TagId>,
    /// The side of the instance's own collider.
    pub side: Side,
    /// The instance that is touched; none for a tile or a rectangle.
    pub who: Option<usize>,
    /// The tile that is touched, if it can be broken.
    pub tile: Option<Along>,
}

/// A touched tile: how long the edge is along which it is touched, as the bits of that number (it is not negative), and
/// the tile's cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Along {
    pub length: u64,
    pub cell: usize,
}

/// An instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Thing {
    pub params: Vec<f64>,
    /// Position, velocity, acceleration.
    pub vars: Vec<[f64; 3]>,
    pub discretes: Vec<i32>,
    /// Slots.
    pub refs: Vec<Option<usize>>,
    pub space: usize,
    /// Of each group the active modes, outermost first.
    pub modes: Vec<Vec<ModeId>>,
    /// Of each active mode the steps since it was entered.
    pub timers: BTreeMap<ModeId, u32>,
    /// The envelopes that have reached their peak, and in which direction.
    pub peaks: BTreeMap<u32, [i64; 2]>,
    pub contacts: BTreeSet<Contact>,
    /// The signals that were sent to it in the last step, with the sums of their numbers.
    pub signals: BTreeMap<u32, f64>,
    /// The slot of its carrier.
    pub carrier: Option<usize>,
}

impl Thing {
    pub fn position(&self) -> (f64, f64) {
        (self.vars[0][0], self.vars[1][0])
    }

    pub fn is_in(&self, mode: ModeId) -> bool {
        self.modes.iter().flatten().any(|m| *m == mode)
    }
}

/// A world between two steps.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// The live instance of each slot.
    pub things: Vec<Option<Thing>>,
    /// Of each player the buttons that were down in the last step.
    pub held: Vec<BTreeSet<u32>>,
    /// The broken tiles, by space and cell, each with the steps until it is back, if it ever is.
    pub broken: BTreeMap<(usize, usize), Option<u16>>,
    /// What nature has drawn, during a step.
    pub drawn: Vec<Vec<i32>>,
}

/// A world that is interpreted.
pub struct Oracle<'p> {
    pub program: &'p Checked,
    pub world: &'p World,
}

impl<'p> Oracle<'p> {
    pub fn new(program: &'p Checked, world: WorldId) -> Self {
        Oracle { program, world: &program.worlds[world] }
    }

    pub fn entity_id(&self, slot: usize) -> EntityId {
        self.world.instances[SlotId::from_index(slot)].entity
    }

    pub fn entity(&self, slot: usize) -> &'p Entity {
        &self.program.entities[self.entity_id(slot)]
    }

    /// The length of a step, s.
    pub fn dt(&self) -> f64 {
        self.seconds(1.0)
    }

    /// A number of steps in seconds.
    pub fn seconds(&self, steps: f64) -> f64 {
        steps * self.world.step.0 as f64 / self.world.step.1 as f64
    }

    /// The player that controls a slot.
    pub fn player(&self, slot: usize) -> Option<usize> {
        self.world.players.iter().position(|p| p.slot.0 as usize == slot)
    }
}

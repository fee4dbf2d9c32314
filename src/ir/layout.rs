//! The layout of a state: one block of bytes, of a size known when the world is compiled.
//!
//! Widest fields first, so that every field is aligned: real numbers, the players' buttons, whole numbers and
//! timers, leaves and spaces, flags and contact bits.

use serde::Serialize;

use super::{Entity, EntityId, IdVec, PlayerId, Slot, SlotId};

/// Byte offsets within a state.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Layout {
    /// The size of a state in bytes, a multiple of 8.
    pub size: usize,
    /// Of each slot.
    pub slots: IdVec<SlotId, SlotLayout>,
    /// Of each player: the buttons of the last step, a `u64`.
    pub players: IdVec<PlayerId, usize>,
}

/// Byte offsets of one slot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SlotLayout {
    /// `f64` triples: position, velocity, acceleration of each continuous variable.
    pub vars: usize,
    /// An `i32` for each discrete variable.
    pub discretes: usize,
    /// A `u32` for each timer: the steps since its mode was entered, 0 while the mode is not active.
    pub timers: usize,
    /// A `u16` for each group: the active leaf.
    pub leaves: usize,
    /// A `u16`: the space.
    pub space: usize,
    /// A byte: whether the instance is alive.
    pub alive: usize,
    /// Bits from the lowest: whether each contact question held in the last collision phase.
    pub touches: usize,
}

impl Layout {
    /// Lays out the state of a world with these slots and so many players.
    pub(super) fn new(slots: &IdVec<SlotId, Slot>, players: usize, entities: &IdVec<EntityId, Entity>) -> Layout {
        let mut at = 0;
        let mut take = |bytes: usize| {
            let start = at;
            at += bytes;
            start
        };
        let of = |slot: &Slot| &entities[slot.entity];
        let vars: Vec<usize> = slots.iter().map(|s| take(24 * of(s).vars.len())).collect();
        let players = (0..players).map(|_| take(8)).collect();
        let discretes: Vec<usize> = slots.iter().map(|s| take(4 * of(s).discretes.len())).collect();
        let timers: Vec<usize> = slots.iter().map(|s| take(4 * of(s).timers.len())).collect();
        let leaves: Vec<usize> = slots.iter().map(|s| take(2 * of(s).groups.len())).collect();
        let spaces: Vec<usize> = slots.iter().map(|_| take(2)).collect();
        let alive: Vec<usize> = slots.iter().map(|_| take(1)).collect();
        let touches: Vec<usize> = slots.iter().map(|s| take(of(s).touches.len().div_ceil(8))).collect();
        let slots = (0..slots.len())
            .map(|i| SlotLayout {
                vars: vars[i],
                discretes: discretes[i],
                timers: timers[i],
                leaves: leaves[i],
                space: spaces[i],
                alive: alive[i],
                touches: touches[i],
            })
            .collect();
        Layout { size: at.next_multiple_of(8), slots, players }
    }
}

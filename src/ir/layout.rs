//! The layout of a state: one block of bytes, of a size known when the world is compiled.
//!
//! The players' buttons come first, then one block for each slot, then the tiles that can be broken. Within a block the widest fields come first, so that
//! every field is aligned: real numbers, whole numbers and timers, leaves, references and spaces, flags, bits of contacts
//! and signals.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{BreakableTiles, Entity, EntityId, IdVec, PlayerId, Slot, SlotId, Space, SpaceId};

/// Byte offsets within a state.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Layout {
    /// The size of a state in bytes, a multiple of 8.
    pub size: usize,
    /// Of each slot.
    pub slots: IdVec<SlotId, SlotLayout>,
    /// Of each player: the buttons of the last step, a `u64`.
    pub players: IdVec<PlayerId, usize>,
    /// Of the tiles that can be broken, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tiles: Option<TileLayout>,
}

/// Byte offsets of the tiles that can be broken, in the order of their numbers: those that come back first, then by
/// space, kind and cell.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct TileLayout {
    /// Bits from the lowest: whether each tile is broken.
    pub broken: usize,
    /// How many tiles there are.
    pub count: usize,
    /// A `u16` for each tile that comes back: the steps until it does, 0 while it is there.
    pub restoring: usize,
    /// How many tiles come back.
    pub restored: usize,
}

/// Byte offsets of one slot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SlotLayout {
    /// The slot's block: from the first byte to before the second.
    pub block: (usize, usize),
    /// `f64` triples: position, velocity, acceleration of each continuous variable.
    pub vars: usize,
    /// `f64`s: the parameters, where they may differ from one instance of the slot to the next.
    pub params: Option<usize>,
    /// An `f64` for each number of a signal: the sum of what was sent in the last step.
    #[serde(default)]
    pub sums: usize,
    /// An `i32` for each discrete variable.
    pub discretes: usize,
    /// A `u32` for each timer: the steps since its mode was entered, 0 while the mode is not active.
    pub timers: usize,
    /// A `u32` for each contact query that is bound, if any of the entity can name a tile: 0, or 1 plus the tile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tiles: Option<usize>,
    /// A `u16` for each group: the active leaf.
    pub leaves: usize,
    /// A `u16` for each envelope: 0, or 1 plus the number of the direction in which its peak was reached.
    pub peaks: usize,
    /// A `u16` for each reference: 0 for none, or 1 plus the slot.
    pub refs: usize,
    /// A `u16` for each contact query that is bound: 0, or 1 plus the lowest slot that is touched.
    pub bound: usize,
    /// A `u16`: the space.
    pub space: usize,
    /// A `u16`: 0, or 1 plus the slot that the instance is on and that carries it.
    pub carrier: usize,
    /// A byte: 0 where there is no instance, 1 for one that is alive.
    pub alive: usize,
    /// Bits from the lowest: whether each contact query held in the last collision phase.
    pub touches: usize,
    /// Bits from the lowest: whether each signal was sent in the last step.
    #[serde(default)]
    pub signals: usize,
}

impl Layout {
    /// Lays out the state of a world with these slots, a number of players and these spaces.
    pub(super) fn new(
        slots: &IdVec<SlotId, Slot>,
        players: usize,
        entities: &IdVec<EntityId, Arc<Entity>>,
        spaces: &IdVec<SpaceId, Space>,
    ) -> Layout {
        let mut at = 0;
        let mut take = |bytes: usize| {
            let start = at;
            at += bytes;
            start
        };
        let players = (0..players).map(|_| take(8)).collect();
        let slots = slots
            .iter()
            .map(|slot| {
                let e = &entities[slot.entity];
                let start = take(0);
                let vars = take(24 * e.vars.len());
                let params = (!slot.is_fixed).then(|| take(8 * e.params.len()));
                let sums = take(8 * e.numbered_signals());
                let (discretes, timers) = (take(4 * e.discretes.len()), take(4 * e.timers.len()));
                let keeps_tiles = e.touches.iter().any(|touch| touch.tiles);
                let tiles = keeps_tiles.then(|| take(4 * e.bound));
                let peaked = e.envelopes.iter().any(|v| v.peak.is_some());
                let peaks = take(if peaked { 2 * e.envelopes.len() } else { 0 });
                let (leaves, refs, bound) = (take(2 * e.groups.len()), take(2 * e.refs.len()), take(2 * e.bound));
                let (space, carrier) = (take(2), take(2));
                let (alive, touches) = (take(1), take(e.touches.len().div_ceil(8)));
                let signals = take(e.signals.len().div_ceil(8));
                let end = take(0);
                take(end.next_multiple_of(8) - end);
                SlotLayout {
                    block: (start, take(0)),
                    vars,
                    params,
                    sums,
                    discretes,
                    timers,
                    tiles,
                    leaves,
                    peaks,
                    refs,
                    bound,
                    space,
                    carrier,
                    alive,
                    touches,
                    signals,
                }
            })
            .collect();
        let BreakableTiles { places, restored, .. } = BreakableTiles::of(spaces);
        let tiles = (!places.is_empty()).then(|| TileLayout {
            broken: take(8 * places.len().div_ceil(64)),
            count: places.len(),
            restoring: take((2 * restored).next_multiple_of(8)),
            restored,
        });
        Layout { size: at, slots, players, tiles }
    }
}

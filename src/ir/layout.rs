//! The layout of a state: one block of bytes, of a size known when the world is compiled.
//!
//! The players' buttons come first, then one block for each slot, then the tiles that can be broken. Within a block the
//! widest fields come first, so that every field is aligned: real numbers, whole numbers and timers, leaves, references
//! and spaces, flags, bits of contacts and signals. The blocks of instances that never move are the last ones: they hold
//! only what varies, are as small as their fields allow, and neighbours.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{BreakableTiles, Entity, IdVec, PlayerId, Program, Slot, SlotId, SpaceId, VarId, World};

/// Byte offsets within a state.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
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

/// What is constant of an instance that never moves, and not in a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Rest {
    /// The values of its continuous variables; their derivatives are 0.
    pub vars: IdVec<VarId, f64>,
    /// The space that it is in.
    pub space: SpaceId,
}

/// Byte offsets of one slot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SlotLayout {
    /// The slot's block: from the first byte to before the second.
    pub block: (usize, usize),
    /// Of an instance that never moves, what is not stored; `vars`, `space` and `carrier` then mean nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<Arc<Rest>>,
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
    /// A `u16` for each group: the active leaf; for one that never moves and has one leaf, a place that is 0 for all.
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
    /// Lays out the state of a world; the layout that the world has is not read.
    pub(super) fn new(program: &Program, world: &World) -> Layout {
        let still = program.still_slots(world);
        let mut taken = Taken(0);
        let players = world.players.iter().map(|_| taken.take(8)).collect();
        let moving = |slot: &Slot, taken: &mut Taken| {
            let entity = &program.entities[slot.entity];
            let start = taken.take(0);
            let vars = taken.take(24 * entity.vars.len());
            let params = (!slot.is_fixed).then(|| taken.take(8 * entity.params.len()));
            let layout = fields(entity, taken, None);
            taken.align(8);
            SlotLayout { block: (start, taken.0), vars, params, ..layout }
        };
        let slots = world.slots.pairs().map(|(id, slot)| (!still[id]).then(|| moving(slot, &mut taken)));
        let slots: Vec<Option<SlotLayout>> = slots.collect();
        // The leaf of all that have only one.
        let only_leaf = still.iter().any(|is| *is).then(|| taken.take(8));
        let resting = |slot: &Slot, taken: &mut Taken| {
            let entity = &program.entities[slot.entity];
            let vars = slot.vars.iter().map(|values| values[0] + 0.0).collect();
            let rest = Some(Arc::new(Rest { vars, space: slot.space }));
            // Neighbours of one entity are equally far apart.
            let mut size = Taken(0);
            fields(entity, &mut size, Some(0));
            taken.align(alignment(entity));
            size.align(if size.0 <= 8 { size.0.next_power_of_two() } else { alignment(entity) });
            let start = taken.0;
            let layout = fields(entity, taken, only_leaf);
            taken.0 = start + size.0;
            SlotLayout { block: (start, taken.0), rest, ..layout }
        };
        let all = slots.into_iter().zip(world.slots.iter());
        let slots = all.map(|(known, slot)| known.unwrap_or_else(|| resting(slot, &mut taken))).collect();
        taken.align(8);
        let BreakableTiles { places, restored, .. } = BreakableTiles::of(&world.spaces);
        let tiles = (!places.is_empty()).then(|| TileLayout {
            broken: taken.take(8 * places.len().div_ceil(64)),
            count: places.len(),
            restoring: taken.take((2 * restored).next_multiple_of(8)),
            restored,
        });
        Layout { size: taken.0, slots, players, tiles }
    }
}

impl World {
    /// Lays out its state again, after a change of its spaces or slots.
    pub fn lay_out(&mut self, program: &Program) {
        self.layout = Layout::new(program, self);
    }
}

/// The bytes that are taken.
struct Taken(usize);

impl Taken {
    fn take(&mut self, bytes: usize) -> usize {
        self.0 += bytes;
        self.0 - bytes
    }

    fn align(&mut self, to: usize) {
        self.0 = self.0.next_multiple_of(to.max(1));
    }
}

/// The fields of a slot after its real variables and parameters. For an instance that never moves it is given where the
/// leaf is if the entity has only one.
fn fields(e: &Entity, taken: &mut Taken, rests: Option<usize>) -> SlotLayout {
    let start = taken.0;
    let sums = taken.take(8 * e.numbered_signals());
    let (discretes, timers) = (taken.take(4 * e.discretes.len()), taken.take(4 * e.timers.len()));
    let keeps_tiles = e.touches.iter().any(|touch| touch.tiles);
    let tiles = keeps_tiles.then(|| taken.take(4 * e.bound));
    let peaked = e.envelopes.iter().any(|v| v.peak.is_some());
    let peaks = taken.take(if peaked { 2 * e.envelopes.len() } else { 0 });
    let leaves = match rests {
        Some(only) if has_one_leaf(e) => only,
        _ => taken.take(2 * e.groups.len()),
    };
    let (refs, bound) = (taken.take(2 * e.refs.len()), taken.take(2 * e.bound));
    let moved = if rests.is_some() { 0 } else { 2 };
    let (space, carrier) = (taken.take(moved), taken.take(moved));
    let (alive, touches) = (taken.take(1), taken.take(e.touches.len().div_ceil(8)));
    let signals = taken.take(e.signals.len().div_ceil(8));
    SlotLayout {
        block: (start, taken.0),
        rest: None,
        vars: start,
        params: None,
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
}

/// What the offset of an instance that never moves is a multiple of: the size of its widest field.
fn alignment(e: &Entity) -> usize {
    let of_four = !e.discretes.is_empty() || !e.timers.is_empty() || e.touches.iter().any(|touch| touch.tiles);
    let of_two = !has_one_leaf(e) || !e.refs.is_empty() || e.bound > 0;
    match (e.numbered_signals(), of_four, of_two) {
        (1.., ..) => 8,
        (0, true, _) => 4,
        (0, false, true) => 2,
        (0, false, false) => 1,
    }
}

/// Whether no other leaf can be active: the place of the leaf is always 0.
fn has_one_leaf(e: &Entity) -> bool {
    e.leaves.len() <= 1 && e.groups.len() <= 1
}

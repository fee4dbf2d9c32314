//! Access to a state: plain functions over a block of bytes and the offsets of the layout. Numbers are little-endian,
//! so a state can be moved between machines.

use crate::ir::{
    DiscreteId, EnvelopeId, GroupId, Id, LeafId, ParamId, RefId, Rest, SignalId, SlotId, SlotLayout, SpaceId, TileId,
    TimerId, TouchId, VarId,
};

/// The life cycle of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Life {
    /// There is no instance.
    None,
    /// There is one.
    Alive,
    /// It is destroyed in this step; its values stay readable until the step ends.
    Dying,
    /// It is spawned in this step; it moves, collides and takes edges from the next step on.
    Born,
}

#[inline]
fn short(state: &[u8], at: usize) -> u16 {
    // Numbers of two bytes are at multiples of 2.
    u16::from_le_bytes(state.as_chunks().0[at / 2])
}

/// A slot as 1 plus its number, 0 for none; a world has at most `sema::MAX_INSTANCES` slots, so it fits.
#[inline]
fn slot(state: &[u8], at: usize) -> Option<SlotId> {
    short(state, at).checked_sub(1).map(|s| SlotId(u32::from(s)))
}

#[inline]
fn set_slot(state: &mut [u8], at: usize, slot: Option<SlotId>) {
    store(state, at, slot.map_or(0, |s| s.0 as u16 + 1).to_le_bytes());
}

#[inline]
fn load<const N: usize>(state: &[u8], at: usize) -> [u8; N] {
    state[at..at + N].first_chunk().copied().unwrap_or([0; N])
}

#[inline]
fn store<const N: usize>(state: &mut [u8], at: usize, bytes: [u8; N]) {
    if let Some(chunk) = state[at..at + N].first_chunk_mut() {
        *chunk = bytes;
    }
}

/// A real number at an offset.
#[inline]
pub fn real(state: &[u8], at: usize) -> f64 {
    // Real numbers are at multiples of 8.
    f64::from_le_bytes(state.as_chunks().0[at / 8])
}

/// Writes a real number at an offset.
#[inline]
pub fn set_real(state: &mut [u8], at: usize, value: f64) {
    state.as_chunks_mut().0[at / 8] = value.to_le_bytes();
}

/// A continuous variable with its derivatives.
#[inline]
pub(super) fn triple(bytes: &[u8; 24]) -> [f64; 3] {
    [real(bytes, 0), real(bytes, 8), real(bytes, 16)]
}

#[inline]
pub(super) fn set_triple(bytes: &mut [u8; 24], [value, first, second]: [f64; 3]) {
    set_real(bytes, 0, one_zero(value));
    set_real(bytes, 8, one_zero(first));
    set_real(bytes, 16, one_zero(second));
}

/// As [`set_triple`] of values that are known not to be negative zero: neither is a sum of which one part is not.
#[inline]
pub(super) fn set_moved(bytes: &mut [u8; 24], values: [f64; 3]) {
    debug_assert!(values.iter().all(|v| v.to_bits() != (-0.0f64).to_bits()), "{values:?}");
    let [value, first, second] = values;
    set_real(bytes, 0, value);
    set_real(bytes, 8, first);
    set_real(bytes, 16, second);
}

/// There is one zero, so that equal states are equal bytes.
#[inline]
pub(super) fn one_zero(value: f64) -> f64 {
    value + 0.0
}

/// The buttons of a player's last step.
#[inline]
pub fn buttons(state: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(load(state, at))
}

/// Writes the buttons of a player's last step.
#[inline]
pub fn set_buttons(state: &mut [u8], at: usize, buttons: u64) {
    store(state, at, buttons.to_le_bytes());
}

/// The offsets of an instance's position, space and life.
#[derive(Debug, Clone, Copy)]
pub(super) struct PositionLayout {
    vars: usize,
    space: usize,
    alive: usize,
}

impl PositionLayout {
    pub fn of(layout: &SlotLayout) -> Self {
        PositionLayout { vars: layout.vars, space: layout.space, alive: layout.alive }
    }

    /// As [`SlotLayout::acts`].
    #[inline]
    pub fn acts(self, state: &[u8]) -> bool {
        state[self.alive] == 1
    }

    #[inline]
    pub fn position(self, state: &[u8]) -> (f64, f64) {
        // The values of `x` and `y`, each followed by two derivatives.
        let bytes = &state[self.vars..self.vars + 32];
        (real(bytes, 0), real(bytes, 24))
    }

    /// As [`SlotLayout::space`].
    #[inline]
    pub fn space(self, state: &[u8]) -> SpaceId {
        SpaceId(u32::from(short(state, self.space)))
    }
}

/// A leaf, by its offset.
#[inline]
pub(super) fn leaf_at(state: &[u8], at: usize) -> LeafId {
    LeafId(u32::from(short(state, at)))
}

impl SlotLayout {
    /// The offset of a continuous variable (degree 0) or one of its derivatives, of an instance that may move.
    #[inline]
    fn var_offset(&self, var: VarId, degree: u8) -> usize {
        self.vars + 24 * var.index() + 8 * usize::from(degree)
    }

    /// Where a continuous variable or one of its derivatives is in a state, for code that reads it often; none of an
    /// instance that never moves.
    pub(crate) fn moving_offset(&self, var: VarId, degree: u8) -> Option<usize> {
        self.rest.is_none().then(|| self.var_offset(var, degree))
    }

    /// A continuous variable or one of its derivatives.
    #[inline]
    pub fn var(&self, state: &[u8], var: VarId, degree: u8) -> f64 {
        match &self.rest {
            None => self.moving_var(state, var, degree),
            Some(rest) => self.resting_var(rest, state, var, degree),
        }
    }

    /// As [`SlotLayout::var`], of an instance that may move.
    #[inline]
    pub(super) fn moving_var(&self, state: &[u8], var: VarId, degree: u8) -> f64 {
        real(state, self.var_offset(var, degree))
    }

    /// As [`SlotLayout::var`], of an instance that never moves.
    #[cold]
    fn resting_var(&self, rest: &Rest, state: &[u8], var: VarId, degree: u8) -> f64 {
        let value = rest.vars.get(var).filter(|_| degree == 0 && self.alive(state));
        one_zero(value.copied().unwrap_or(0.0))
    }

    /// Writes a continuous variable or one of its derivatives; those of an instance that never moves stay.
    #[inline]
    pub fn set_var(&self, state: &mut [u8], var: VarId, degree: u8, value: f64) {
        if self.rest.is_none() {
            self.set_moving_var(state, var, degree, value);
        }
    }

    /// As [`SlotLayout::set_var`], of an instance that may move.
    #[inline]
    pub(super) fn set_moving_var(&self, state: &mut [u8], var: VarId, degree: u8, value: f64) {
        set_real(state, self.var_offset(var, degree), one_zero(value));
    }

    /// The first continuous variables, each with its derivatives.
    #[inline]
    pub(super) fn triples_mut<'s>(&self, state: &'s mut [u8], count: usize) -> &'s mut [[u8; 24]] {
        state[self.vars..self.vars + 24 * count].as_chunks_mut().0
    }

    /// A discrete variable.
    #[inline]
    pub fn discrete(&self, state: &[u8], id: DiscreteId) -> i32 {
        i32::from_le_bytes(load(state, self.discretes + 4 * id.index()))
    }

    /// Writes a discrete variable.
    #[inline]
    pub fn set_discrete(&self, state: &mut [u8], id: DiscreteId, value: i32) {
        store(state, self.discretes + 4 * id.index(), value.to_le_bytes());
    }

    /// The sum of what was sent with a signal in the last step.
    #[inline]
    pub fn sum(&self, state: &[u8], id: SignalId) -> f64 {
        real(state, self.sums + 8 * id.index())
    }

    /// Writes the sum of what was sent with a signal.
    #[inline]
    pub fn set_sum(&self, state: &mut [u8], id: SignalId, value: f64) {
        set_real(state, self.sums + 8 * id.index(), one_zero(value));
    }

    /// Whether a signal was sent in the last step.
    #[inline]
    pub fn signal(&self, state: &[u8], id: SignalId) -> bool {
        state[self.signals + id.index() / 8] >> (id.index() % 8) & 1 == 1
    }

    /// Notes that a signal was sent.
    #[inline]
    pub fn set_signal(&self, state: &mut [u8], id: SignalId) {
        state[self.signals + id.index() / 8] |= 1 << (id.index() % 8);
    }

    /// Forgets what was sent with some numbers of signals.
    #[inline]
    pub(super) fn clear_signals(&self, state: &mut [u8], signals: usize, sums: usize) {
        state[self.sums..self.sums + 8 * sums].fill(0);
        state[self.signals..self.signals + signals.div_ceil(8)].fill(0);
    }

    /// A timer's count of steps.
    #[inline]
    pub fn timer(&self, state: &[u8], id: TimerId) -> u32 {
        u32::from_le_bytes(load(state, self.timers + 4 * id.index()))
    }

    /// Writes a timer's count of steps.
    #[inline]
    pub fn set_timer(&self, state: &mut [u8], id: TimerId, count: u32) {
        store(state, self.timers + 4 * id.index(), count.to_le_bytes());
    }

    /// The active leaf of a group.
    #[inline]
    pub fn leaf(&self, state: &[u8], group: GroupId) -> LeafId {
        leaf_at(state, self.leaf_offset(group))
    }

    /// The offset of a group's leaf.
    #[inline]
    pub(super) fn leaf_offset(&self, group: GroupId) -> usize {
        self.leaves + 2 * group.index()
    }

    /// Makes a leaf of a group the active one.
    #[inline]
    pub fn set_leaf(&self, state: &mut [u8], group: GroupId, leaf: LeafId) {
        // An entity has at most `sema::MAX_MODES` modes, so a leaf fits.
        store(state, self.leaves + 2 * group.index(), (leaf.0 as u16).to_le_bytes());
    }

    /// The space that the instance is in.
    #[inline]
    pub fn space(&self, state: &[u8]) -> SpaceId {
        match &self.rest {
            None => SpaceId(u32::from(short(state, self.space))),
            Some(rest) => self.resting_space(rest, state),
        }
    }

    #[cold]
    fn resting_space(&self, rest: &Rest, state: &[u8]) -> SpaceId {
        if self.alive(state) { rest.space } else { SpaceId(0) }
    }

    /// Moves the instance to a space; one that never moves stays.
    pub fn set_space(&self, state: &mut [u8], space: SpaceId) {
        if self.rest.is_none() {
            store(state, self.space, (space.0 as u16).to_le_bytes());
        }
    }

    /// Where a state says whether there is an instance: its byte there is not 0.
    pub(crate) fn alive_offset(&self) -> usize {
        self.alive
    }

    /// Whether there is an instance, alive or otherwise.
    #[inline]
    pub fn alive(&self, state: &[u8]) -> bool {
        state[self.alive] != 0
    }

    /// The life cycle of the slot.
    #[inline]
    pub fn life(&self, state: &[u8]) -> Life {
        match state[self.alive] {
            0 => Life::None,
            1 => Life::Alive,
            2 => Life::Dying,
            _ => Life::Born,
        }
    }

    /// Whether there is an instance that acts in this step.
    #[inline]
    pub(super) fn acts(&self, state: &[u8]) -> bool {
        state[self.alive] == 1
    }

    /// Sets the life cycle of the slot.
    pub fn set_life(&self, state: &mut [u8], life: Life) {
        state[self.alive] = life as u8;
    }

    /// Makes the slot free.
    pub fn clear(&self, state: &mut [u8]) {
        state[self.block.0..self.block.1].fill(0);
    }

    /// A parameter of a reusable slot.
    #[inline]
    pub(super) fn param(&self, state: &[u8], id: ParamId) -> Option<f64> {
        self.params.map(|at| real(state, at + 8 * id.index()))
    }

    pub(super) fn set_param(&self, state: &mut [u8], id: ParamId, value: f64) {
        if let Some(at) = self.params {
            set_real(state, at + 8 * id.index(), one_zero(value));
        }
    }

    /// The target of a reference.
    #[inline]
    pub fn reference(&self, state: &[u8], id: RefId) -> Option<SlotId> {
        slot(state, self.refs + 2 * id.index())
    }

    /// Makes a reference refer to a slot, or to none.
    pub fn set_reference(&self, state: &mut [u8], id: RefId, target: Option<SlotId>) {
        set_slot(state, self.refs + 2 * id.index(), target);
    }

    /// The lowest instance that a bound contact query found in the last collision phase.
    #[inline]
    pub fn touched(&self, state: &[u8], id: TouchId) -> Option<SlotId> {
        slot(state, self.bound + 2 * id.index())
    }

    /// Stores the instance that a bound contact query found.
    #[inline]
    pub fn set_touched(&self, state: &mut [u8], id: TouchId, target: Option<SlotId>) {
        set_slot(state, self.bound + 2 * id.index(), target);
    }

    /// The tile that a bound contact query found in the last collision phase.
    #[inline]
    pub fn touched_tile(&self, state: &[u8], id: TouchId) -> Option<TileId> {
        let at = self.tiles? + 4 * id.index();
        u32::from_le_bytes(load(state, at)).checked_sub(1).map(TileId)
    }

    /// Stores the tile that a bound contact query found.
    #[inline]
    pub fn set_touched_tile(&self, state: &mut [u8], id: TouchId, tile: Option<TileId>) {
        if let Some(at) = self.tiles {
            store(state, at + 4 * id.index(), tile.map_or(0, |tile| tile.0 + 1).to_le_bytes());
        }
    }

    /// The carrier of the instance.
    #[inline]
    pub fn carrier(&self, state: &[u8]) -> Option<SlotId> {
        if self.rest.is_some() { None } else { self.moving_carrier(state) }
    }

    /// As [`SlotLayout::carrier`], of an instance that may move.
    #[inline]
    pub(super) fn moving_carrier(&self, state: &[u8]) -> Option<SlotId> {
        slot(state, self.carrier)
    }

    /// Sets the carrier of the instance; one that never moves has none.
    #[inline]
    pub fn set_carrier(&self, state: &mut [u8], carrier: Option<SlotId>) {
        if self.rest.is_none() {
            self.set_moving_carrier(state, carrier);
        }
    }

    /// As [`SlotLayout::set_carrier`], of an instance that may move.
    #[inline]
    pub(super) fn set_moving_carrier(&self, state: &mut [u8], carrier: Option<SlotId>) {
        set_slot(state, self.carrier, carrier);
    }

    /// 0, or 1 plus the number of the direction in which an envelope reached its peak.
    #[inline]
    pub fn peak(&self, state: &[u8], id: EnvelopeId) -> u16 {
        short(state, self.peaks + 2 * id.index())
    }

    /// Stores the direction in which an envelope reached its peak.
    #[inline]
    pub fn set_peak(&self, state: &mut [u8], id: EnvelopeId, peak: u16) {
        store(state, self.peaks + 2 * id.index(), peak.to_le_bytes());
    }

    /// Whether a contact query held in the last collision phase.
    #[inline]
    pub fn touch(&self, state: &[u8], touch: TouchId) -> bool {
        state[self.touches + touch.index() / 8] >> (touch.index() % 8) & 1 == 1
    }

    /// The bits of the first eight contact queries, of an instance with any.
    #[inline]
    pub(super) fn first_touches(&self, state: &[u8]) -> u8 {
        state[self.touches]
    }

    /// Sets the bit of a contact query.
    #[inline]
    pub fn set_touch(&self, state: &mut [u8], touch: TouchId) {
        state[self.touches + touch.index() / 8] |= 1 << (touch.index() % 8);
    }

    /// Clears the bit of a contact query; what it has found, if it is bound, stays.
    #[inline]
    pub fn clear_touch(&self, state: &mut [u8], touch: TouchId) {
        state[self.touches + touch.index() / 8] &= !(1 << (touch.index() % 8));
    }

    /// Sets the bits of some of the first 64 contact queries.
    #[inline]
    pub(super) fn set_touches(&self, state: &mut [u8], mut bits: u64) {
        let mut at = self.touches;
        while bits != 0 {
            state[at] |= bits as u8;
            bits >>= 8;
            at += 1;
        }
    }

    /// Clears all contacts of the instance; `count` is the number of its contact queries, `bound` the number of those
    /// that store what is touched.
    #[inline(always)]
    pub fn clear_touches(&self, state: &mut [u8], count: usize, bound: usize) {
        match count {
            0 => return,
            1..=8 => state[self.touches] = 0,
            _ => state[self.touches..self.touches + count.div_ceil(8)].fill(0),
        }
        if bound > 0 {
            state[self.bound..self.bound + 2 * bound].fill(0);
            if let Some(tiles) = self.tiles {
                state[tiles..tiles + 4 * bound].fill(0);
            }
        }
    }
}

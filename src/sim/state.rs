//! Reading and writing a state: plain functions over a block of bytes and the offsets of the layout.

use crate::ir::{DiscreteId, GroupId, Id, LeafId, SlotLayout, SpaceId, TimerId, TouchId, VarId};

fn load<const N: usize>(state: &[u8], at: usize) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.copy_from_slice(&state[at..at + N]);
    bytes
}

fn store<const N: usize>(state: &mut [u8], at: usize, bytes: [u8; N]) {
    state[at..at + N].copy_from_slice(&bytes);
}

/// A real number at an offset.
pub fn real(state: &[u8], at: usize) -> f64 {
    f64::from_ne_bytes(load(state, at))
}

/// Writes a real number at an offset.
pub fn set_real(state: &mut [u8], at: usize, value: f64) {
    store(state, at, value.to_ne_bytes());
}

/// The buttons of a player's last step.
pub fn buttons(state: &[u8], at: usize) -> u64 {
    u64::from_ne_bytes(load(state, at))
}

/// Writes the buttons of a player's last step.
pub fn set_buttons(state: &mut [u8], at: usize, buttons: u64) {
    store(state, at, buttons.to_ne_bytes());
}

impl SlotLayout {
    /// The offset of a continuous variable (degree 0) or one of its derivatives.
    pub fn var_offset(&self, var: VarId, degree: u8) -> usize {
        self.vars + 24 * var.index() + 8 * usize::from(degree)
    }

    /// A continuous variable or one of its derivatives.
    pub fn var(&self, state: &[u8], var: VarId, degree: u8) -> f64 {
        real(state, self.var_offset(var, degree))
    }

    /// Writes a continuous variable or one of its derivatives.
    pub fn set_var(&self, state: &mut [u8], var: VarId, degree: u8, value: f64) {
        set_real(state, self.var_offset(var, degree), value);
    }

    /// A discrete variable.
    pub fn discrete(&self, state: &[u8], id: DiscreteId) -> i32 {
        i32::from_ne_bytes(load(state, self.discretes + 4 * id.index()))
    }

    /// Writes a discrete variable.
    pub fn set_discrete(&self, state: &mut [u8], id: DiscreteId, value: i32) {
        store(state, self.discretes + 4 * id.index(), value.to_ne_bytes());
    }

    /// A timer's count of steps.
    pub fn timer(&self, state: &[u8], id: TimerId) -> u32 {
        u32::from_ne_bytes(load(state, self.timers + 4 * id.index()))
    }

    /// Writes a timer's count of steps.
    pub fn set_timer(&self, state: &mut [u8], id: TimerId, count: u32) {
        store(state, self.timers + 4 * id.index(), count.to_ne_bytes());
    }

    /// The active leaf of a group.
    pub fn leaf(&self, state: &[u8], group: GroupId) -> LeafId {
        LeafId(u32::from(u16::from_ne_bytes(load(state, self.leaves + 2 * group.index()))))
    }

    /// Makes a leaf of a group the active one.
    pub fn set_leaf(&self, state: &mut [u8], group: GroupId, leaf: LeafId) {
        // An entity has at most `sema::MAX_MODES` modes, so a leaf fits.
        store(state, self.leaves + 2 * group.index(), (leaf.0 as u16).to_ne_bytes());
    }

    /// The space that the instance is in.
    pub fn space(&self, state: &[u8]) -> SpaceId {
        SpaceId(u32::from(u16::from_ne_bytes(load(state, self.space))))
    }

    /// Moves the instance to a space.
    pub fn set_space(&self, state: &mut [u8], space: SpaceId) {
        store(state, self.space, (space.0 as u16).to_ne_bytes());
    }

    /// Whether the instance is alive.
    pub fn alive(&self, state: &[u8]) -> bool {
        state[self.alive] != 0
    }

    /// Makes the instance alive or not.
    pub fn set_alive(&self, state: &mut [u8], alive: bool) {
        state[self.alive] = u8::from(alive);
    }

    /// Whether a contact question held in the last collision phase.
    pub fn touch(&self, state: &[u8], touch: TouchId) -> bool {
        state[self.touches + touch.index() / 8] >> (touch.index() % 8) & 1 == 1
    }

    /// Notes that a contact question holds.
    pub fn set_touch(&self, state: &mut [u8], touch: TouchId) {
        state[self.touches + touch.index() / 8] |= 1 << (touch.index() % 8);
    }

    /// Forgets all contacts of the instance; `count` is the number of its contact questions.
    pub fn clear_touches(&self, state: &mut [u8], count: usize) {
        state[self.touches..self.touches + count.div_ceil(8)].fill(0);
    }
}

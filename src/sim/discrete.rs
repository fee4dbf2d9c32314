//! The discrete phase: edges, updates, entering and leaving modes. Everything is read from the state as the step
//! began and written to the new one, so that the order of instances does not matter.

use std::cell::Cell;

use crate::ir::{Edge, EdgeId, Entity, Group, GroupId, LeafId, ModeId, Place, SlotId, Update};

use super::evaluate::Reader;
use super::fault::{Fault, FaultKind};
use super::simulator::{Scratch, Simulator};

impl Simulator<'_> {
    /// Takes the edges of every live slot.
    pub(super) fn transitions(&self, state: &mut [u8], scratch: &Scratch) -> Result<(), Fault> {
        let fault = Cell::new(None);
        for me in self.world().slots.ids() {
            if !self.layout(me).alive(&scratch.before) {
                continue;
            }
            let reader = Reader { sim: self, state: &scratch.before, frames: &scratch.frames, fault: &fault, me };
            for (id, group) in self.entity(me).groups.pairs() {
                self.group(state, &reader, id, group);
            }
        }
        Self::settle(&fault)
    }

    fn group(&self, state: &mut [u8], reader: &Reader<'_>, id: GroupId, group: &Group) {
        let entity = self.entity(reader.me);
        let active = self.layout(reader.me).leaf(reader.state, id);
        let leaf = &entity.leaves[active];
        for &edge in &leaf.internal {
            let edge = &entity.edges[edge];
            if reader.truth(edge.guard) {
                self.update(state, reader, &edge.updates);
            }
        }
        let taken = leaf.edges.iter().copied().find(|&edge| reader.truth(entity.edges[edge].guard));
        if let Some(edge) = taken {
            self.take(state, reader, (id, group), active, edge);
        }
    }

    /// Leaves and enters modes and runs the updates: entries from the outermost in, then the edge's own.
    fn take(&self, state: &mut [u8], reader: &Reader<'_>, group: (GroupId, &Group), active: LeafId, edge: EdgeId) {
        let entity = self.entity(reader.me);
        let layout = self.layout(reader.me);
        let edge: &Edge = &entity.edges[edge];
        let Some(target) = edge.target else { return };
        let next = reader.entered(target);
        layout.set_leaf(state, group.0, next);
        let (first, after) = group.1.modes;
        for (id, timer) in entity.timers.pairs() {
            let inside = first <= timer.mode && timer.mode < after;
            if inside && !(is_active(entity, next, timer.mode) && is_kept(entity, active, target, timer.mode)) {
                layout.set_timer(state, id, 0);
            }
        }
        for &mode in &entity.leaves[next].path {
            if !is_kept(entity, active, target, mode) {
                self.update(state, reader, &entity.modes[mode].entry);
            }
        }
        self.update(state, reader, &edge.updates);
    }

    fn update(&self, state: &mut [u8], reader: &Reader<'_>, updates: &[Update]) {
        let layout = self.layout(reader.me);
        for update in updates {
            let value = reader.number(update.value);
            match update.place {
                Place::Var(var, degree) => layout.set_var(state, var, degree, value),
                Place::Discrete(id) => {
                    let (low, high) = self.entity(reader.me).discretes[id].range;
                    let fits = value >= f64::from(low) && value <= f64::from(high) && value.fract() == 0.0;
                    if fits {
                        layout.set_discrete(state, id, value as i32);
                    } else {
                        reader.note(FaultKind::OutOfRange(update.value, id, value));
                    }
                }
            }
        }
    }

    /// The new state's slot is where timers of active modes are counted.
    pub(super) fn count_timers(&self, state: &mut [u8], me: SlotId) {
        let entity = self.entity(me);
        let layout = self.layout(me);
        for (id, timer) in entity.timers.pairs() {
            let active = layout.leaf(state, entity.modes[timer.mode].group);
            if is_active(entity, active, timer.mode) {
                let count = layout.timer(state, id);
                let limit = self.world().slots[me].timer_limits[id];
                layout.set_timer(state, id, count.saturating_add(1).min(limit));
            }
        }
    }
}

/// Whether a mode is active while a leaf is.
fn is_active(entity: &Entity, leaf: LeafId, mode: ModeId) -> bool {
    let (first, after) = entity.modes[mode].leaves;
    first <= leaf && leaf < after
}

/// Whether an edge from a leaf to `target` neither leaves nor enters a mode: an active proper ancestor of the target.
fn is_kept(entity: &Entity, active: LeafId, target: ModeId, mode: ModeId) -> bool {
    mode < target && target < entity.modes[mode].end && is_active(entity, active, mode)
}

//! What instances do to others: the signals that they send, which others receive in the next step, and whom they
//! destroy.

use std::collections::BTreeSet;

use crate::ir::{EntityId, Subject};

use crate::analysis::domain::received::Received;
use crate::analysis::domain::values::Interval;
use crate::analysis::fixpoint::Analysis;

impl Analysis<'_> {
    /// Publishes what can be sent; returns whether anything changed.
    pub(super) fn deliver(&mut self) -> bool {
        let mut received = Received::default();
        for slot in self.world.slots.ids() {
            let known = &self.slots[self.first[slot]];
            for (id, send) in self.entity(slot).sends.pairs() {
                let value = if known.is_given_up { Some(Interval::ALL) } else { known.sent.get(id) };
                let of = &self.program.entities[send.entity];
                let is_whole = of.signals[send.signal].number.as_ref().map(|number| number.is_whole);
                value.into_iter().for_each(|value| received.add(send, is_whole, value));
            }
        }
        if received == self.received {
            return false;
        }
        for slot in self.world.slots.ids() {
            if received.differs(&self.received, self.world.slots[slot].entity) {
                self.slots[slot].configurations.values_mut().for_each(|g| g.is_new = true);
            }
        }
        self.received = received;
        true
    }

    /// Marks the slots whose instances can be destroyed by others.
    pub(super) fn mark_destroyable(&mut self) -> bool {
        let living = self.world.slots.ids().filter(|s| self.overall[*s].can_live);
        let by: BTreeSet<EntityId> = living.map(|slot| self.world.slots[slot].entity).collect();
        let mut changed = false;
        for by in by {
            let destroyed = self.program.destroyed_by(by, |of| of != Subject::Me);
            for slot in self.world.slots.ids().filter(|slot| destroyed[self.world.slots[*slot].entity]) {
                if !self.slots[slot].can_be_absent {
                    self.slots[slot].can_be_absent = true;
                    self.slots[slot].is_changed = true;
                    changed = true;
                }
            }
        }
        changed
    }
}

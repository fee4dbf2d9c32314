//! Narrowing after the fixpoint iteration (Cousot and Cousot, POPL 1977).

use std::collections::BTreeMap;

use crate::ir::{Origin, SlotId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Values;
use crate::analysis::domain::widen::{extended, intersection};
use crate::analysis::fixpoint::{Analysis, Growing, Key, Slot};
use crate::analysis::geometry::cells::CellId;
use crate::analysis::geometry::surroundings::Surroundings;
use crate::analysis::step::Outcome;

/// Maximum number of extensions of a configuration by its own successors.
const MAX_EXTENSIONS: usize = 8;

impl Analysis<'_> {
    /// Steps once from all configurations and keeps only their successors and the initial ones. Bounds that a
    /// configuration justifies only by itself are dropped: it restarts from the input of others.
    pub fn narrow(&mut self) {
        self.surroundings = Surroundings::new(&mut self.scene, &self.overall);
        let mut found: Vec<(SlotId, Key, Outcome)> = Vec::new();
        for slot in self.world.slots.ids().filter(|s| self.is_first(*s) && !self.slots[*s].is_given_up) {
            for (key, growing) in &self.slots[slot].configurations {
                if self.watch.stop() {
                    self.is_stopped = true;
                    return;
                }
                if let Some(outcome) = self.stepper(slot).run(&growing.at) {
                    found.push((slot, key.clone(), outcome));
                }
            }
        }
        let clear = |slot: &mut Slot| {
            slot.speed = [0.0; 2];
            slot.near_speed = [0.0; 2];
            slot.contact = [Values::none(); 2];
            slot.is_changed = true;
            (std::mem::take(&mut slot.configurations), slot.is_given_up)
        };
        let before: Vec<(BTreeMap<Key, Growing>, bool)> = self.slots.iter_mut().map(clear).collect();
        for slot in self.world.slots.ids().filter(|s| self.world.slots[*s].origin != Origin::Free) {
            self.begin(slot);
        }
        for (slot, key, outcome) in found {
            self.take(slot, &key, outcome);
        }
        for (slot, (known, is_given_up)) in self.world.slots.ids().zip(before) {
            if is_given_up {
                self.slots[slot].configurations = known;
                continue;
            }
            let mut narrowed = std::mem::take(&mut self.slots[slot].configurations);
            for (key, growing) in &mut narrowed {
                // The whole analysis is given up then.
                self.is_stopped |= self.watch.stop();
                if self.is_stopped {
                    break;
                }
                if let Some(known) = known.get(key) {
                    growing.at = self.restarted(slot, key.1, intersection(&growing.at, &known.at), &known.at);
                }
            }
            self.slots[slot].configurations = narrowed;
        }
        self.publish();
    }

    /// Iterates a configuration from its entries, within the previous result `known`.
    fn restarted(&self, slot: SlotId, cell: CellId, entries: Configuration, known: &Configuration) -> Configuration {
        let mut at = entries.clone();
        for _ in 0..MAX_EXTENSIONS {
            let Some(outcome) = self.stepper(slot).run_on(&at) else { break };
            let here = |next: Configuration| {
                let is_kept_out = self.surroundings.is_kept_out(slot, &next.leaves);
                self.cells(slot).split(next, is_kept_out).into_iter().find(|(of, _)| *of == cell)
            };
            let own = outcome.next.into_iter().filter_map(here).map(|(_, own)| own).reduce(|a, b| a.or(&b));
            let Some(own) = own.map(|own| intersection(&own, known)) else { return entries };
            if own.is_within(&at) {
                // A fixpoint: everything else is dropped.
                let mut at = intersection(&entries.or(&own), &at);
                at.sharpen();
                return at;
            }
            at = extended(&at, &own, known);
            at.sharpen();
        }
        known.clone()
    }
}

//! Initial configurations of instances: placed, made from a tile, or spawned.

use crate::ir::{IdVec, LeafId, Origin, Place, SlotId, SpawnId, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Values;
use crate::analysis::domain::widen::within_bounds;
use crate::analysis::fixpoint::{Analysis, MAX_CONFIGURATIONS};
use crate::analysis::geometry::placement::{PlacedColliders, Placement};
use crate::analysis::geometry::seam::bring_in;

impl Analysis<'_> {
    /// Adds the initial configurations of an instance that exists from the start.
    pub(in crate::analysis) fn begin(&mut self, slot: SlotId) {
        let s = &self.world.slots[slot];
        let vars = s.vars.iter().map(|v| v.map(Values::point)).collect();
        let discretes = s.discretes.iter().map(|d| Values::point(f64::from(*d))).collect();
        let mut at = Configuration::new(vars, discretes, s.timer_limits.len(), [s.space].into());
        if !s.is_fixed {
            at.params = s.params.iter().map(|p| Values::point(*p)).collect();
        }
        self.vary(slot, &mut at);
        bring_in(self.world, &mut at);
        // Contacts are detected before the first step, too, without pushes.
        let contact = VarId::XY.map(|var| at.vars[var][0]);
        let known = &mut self.slots[slot].contact;
        *known = [known[0].or(&contact[0]), known[1].or(&contact[1])];
        self.enter(slot, at);
    }

    /// The initial configurations of a slot that exists from the start.
    pub(in crate::analysis) fn begins(&mut self, slot: SlotId) -> Vec<Configuration> {
        let known = std::mem::take(&mut self.slots[slot].configurations);
        self.begin(slot);
        let begins = std::mem::replace(&mut self.slots[slot].configurations, known);
        begins.into_values().map(|growing| growing.at).collect()
    }

    /// Gives an instance that begins all values of what is not known of it.
    fn vary(&mut self, slot: SlotId, at: &mut Configuration) {
        let Some(dependent) = self.unknown.slots.get(&slot) else { return };
        let (entity, s) = (self.entity(slot), &self.world.slots[slot]);
        at.params = IdVec::new();
        for (id, param) in entity.params.pairs() {
            let value = match dependent.params.get(&id) {
                Some(one) => {
                    let default = self.unknown.defaults.get(&(s.entity, id)).copied();
                    // It reads the parameters before it.
                    let own = default.unwrap_or_else(|| self.reader(Some((slot, at))).number(param.default));
                    // It may be given all the same.
                    own.or(&Values::point(*one))
                }
                None => Values::point(s.params[id]),
            };
            at.params.push(value);
        }
        for (id, first) in entity.first.pairs() {
            if let (Some(one), Some(first)) = (dependent.vars.get(&id), first) {
                let own = self.reader(Some((slot, at))).number(*first);
                at.vars[id][0] = own.or(&Values::point(*one));
            }
        }
        for (known, value) in self.slots[slot].params.iter_mut().zip(at.params.iter()) {
            *known = known.or(value);
        }
    }

    /// Adds a configuration in all possible initial leaves.
    fn enter(&mut self, slot: SlotId, at: Configuration) -> bool {
        let entity = self.entity(slot);
        let mut combinations: Vec<Vec<LeafId>> = vec![Vec::new()];
        for group in entity.groups.iter() {
            // Choices read parameters, which may have several values: all choices are possible.
            let inside = group.modes;
            let simple = group.choices.is_empty() && !entity.modes[group.first].chooses;
            let leaves: Vec<LeafId> = match simple {
                true => vec![entity.modes[group.first].initial],
                false => {
                    let leaves = entity.leaves.pairs().filter(|(_, l)| inside.contains(l.mode));
                    leaves.map(|(id, _)| id).collect()
                }
            };
            combinations = combinations
                .into_iter()
                .flat_map(|c| {
                    leaves.iter().map(move |l| c.iter().copied().chain([*l]).collect::<Vec<_>>()).collect::<Vec<_>>()
                })
                .take(MAX_CONFIGURATIONS + 1)
                .collect();
        }
        let mut changed = false;
        if let Some(placement) = Placement::of(&at) {
            for leaves in &combinations {
                let colliders = PlacedColliders::While(leaves.clone());
                changed |=
                    self.place(slot, &Placement { spaces: placement.spaces.clone(), at: placement.at, colliders });
            }
        }
        let at = within_bounds(self.world, slot, at);
        for leaves in combinations {
            changed |= self.grow(slot, Configuration { leaves: leaves.into(), ..at.clone() }, None);
        }
        changed
    }

    /// Adds the configurations that a spawn can create, in each slot that it can take.
    pub(in crate::analysis) fn spawn(&mut self, spawner: SlotId, spawn: SpawnId, at: &Configuration) -> bool {
        let spawn = &self.entity(spawner).spawns[spawn];
        let mut changed = false;
        for slot in self.world.slots.ids() {
            let s = &self.world.slots[slot];
            if s.entity != spawn.entity || s.origin == Origin::Named || !self.is_first(slot) {
                continue;
            }
            let entity = self.entity(slot);
            let reader = self.reader(Some((spawner, at)));
            let theirs = |id| reader.number(id);
            let zero = || [Values::point(0.0); 3];
            let vars = entity.vars.iter().map(|_| zero()).collect();
            let mut spawned = Configuration::new(vars, IdVec::new(), entity.timers.len(), (*at.spaces).clone());
            // The instance's own expressions can only read the parameters evaluated so far.
            let own = |spawned: &Configuration, id| self.reader(Some((slot, spawned))).number(id);
            for (id, param) in entity.params.pairs() {
                let given = spawn.params.iter().find(|(p, _)| *p == id);
                let default = || {
                    let varied = self.unknown.defaults.get(&(s.entity, id)).copied();
                    varied.unwrap_or_else(|| own(&spawned, param.default))
                };
                let value = given.map_or_else(default, |(_, value)| theirs(*value));
                spawned.params.push(value);
            }
            for (var, first) in entity.first.pairs() {
                spawned.vars[var][0] = match first {
                    Some(first) => own(&spawned, *first),
                    None if var.is_position() => at.vars[var][0],
                    None => Values::point(0.0),
                };
            }
            for discrete in entity.discretes.iter() {
                let value = own(&spawned, discrete.first).and(&Values::range(discrete.range));
                spawned.discretes.push(value);
            }
            for update in &spawn.updates {
                match update.place {
                    Place::Var(var, degree) => spawned.vars[var][usize::from(degree)] = theirs(update.value),
                    Place::Discrete(id) => spawned.discretes[id] = theirs(update.value),
                    Place::Ref(_) => {}
                }
            }
            // A fault stops the run.
            if spawned.is_impossible() {
                continue;
            }
            let known = &mut self.slots[slot].params;
            let mut reshaped = false;
            for (id, value) in spawned.params.pairs() {
                let joined = known[id].or(value);
                reshaped |= joined != known[id];
                known[id] = joined;
            }
            if reshaped {
                self.scene.reshape(slot, &self.slots[slot].params);
                self.slots[slot].is_changed = true;
                changed = true;
            }
            bring_in(self.world, &mut spawned);
            changed |= self.enter(slot, spawned);
        }
        changed
    }
}

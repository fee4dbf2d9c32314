//! What an instance can be when it begins: placed, made by a tile, or spawned.

use crate::ir::{Id, IdVec, LeafId, Origin, ParamId, Place, SlotId, SpawnId, VarId};

use super::evaluate::Configuration;
use super::fixpoint::{Analysis, MOST_CONFIGURATIONS};
use super::step::Landing;
use super::values::Values;
use super::widen::within_bounds;

impl Analysis<'_> {
    /// The first configurations of an instance that is there from the start.
    pub(super) fn begin(&mut self, slot: SlotId) {
        let s = &self.world.slots[slot];
        let vars = s.vars.iter().map(|v| v.map(Values::point)).collect();
        let discretes = s.discretes.iter().map(|d| Values::point(f64::from(*d))).collect();
        let at = Configuration::new(vars, discretes, s.timer_limits.len(), [s.space].into());
        if let Some(landing) = Landing::of(&at) {
            self.land(slot, &landing);
        }
        self.enter(slot, at);
    }

    /// Adds a configuration in all the leaves in which an instance can begin.
    fn enter(&mut self, slot: SlotId, at: Configuration) -> bool {
        let entity = self.entity(slot);
        let mut combinations: Vec<Vec<LeafId>> = vec![Vec::new()];
        for group in entity.groups.iter() {
            // Choices read parameters, which may be several: all of them are possible.
            let (first, after) = group.modes;
            let simple = group.choices.is_empty() && !entity.modes[group.first].chooses;
            let leaves: Vec<LeafId> = match simple {
                true => vec![entity.modes[group.first].initial],
                false => {
                    let leaves = entity.leaves.pairs().filter(|(_, l)| first <= l.mode && l.mode < after);
                    leaves.map(|(id, _)| id).collect()
                }
            };
            combinations = combinations
                .into_iter()
                .flat_map(|c| {
                    leaves.iter().map(move |l| c.iter().copied().chain([*l]).collect::<Vec<_>>()).collect::<Vec<_>>()
                })
                .take(MOST_CONFIGURATIONS + 1)
                .collect();
        }
        let at = within_bounds(self.world, slot, at);
        let mut changed = false;
        for leaves in combinations {
            changed |= self.grow(slot, Configuration { leaves, ..at.clone() }, false);
        }
        changed
    }

    /// What a spawn can make of each slot that it can take.
    pub(super) fn spawn(&mut self, spawner: SlotId, spawn: SpawnId, at: &Configuration) -> bool {
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
            let mut params = IdVec::new();
            for (id, param) in entity.params.pairs() {
                let given = spawn.params.iter().find(|(p, _)| *p == id);
                let value = match given {
                    Some((_, value)) => theirs(*value),
                    // Defaults read parameters that are known by now; what is not constant can be anything.
                    None => {
                        let known: IdVec<ParamId, f64> =
                            params.iter().map(|v: &Values| v.constant().unwrap_or(f64::NAN)).collect();
                        let value = self.program.constant(param.default, &known, self.world.step);
                        value.map_or(Values::all(), Values::point)
                    }
                };
                params.push(value);
            }
            let known: IdVec<ParamId, f64> = params.iter().map(|v| v.constant().unwrap_or(f64::NAN)).collect();
            let first = |id, otherwise: Values| {
                self.program.constant(id, &known, self.world.step).map_or(otherwise, Values::point)
            };
            let zero = || Values::point(0.0);
            let position = |(var, value): (VarId, &Option<_>)| {
                let position = match value {
                    Some(value) => first(*value, Values::all()),
                    None if var.index() < 2 => at.vars[var][0],
                    None => zero(),
                };
                [position, zero(), zero()]
            };
            let vars = entity.first.pairs().map(position).collect();
            let discretes = entity.discretes.iter().map(|d| first(d.first, Values::range(d.range))).collect();
            let mut born = Configuration::new(vars, discretes, entity.timers.len(), (*at.spaces).clone());
            for update in &spawn.updates {
                match update.place {
                    Place::Var(var, degree) => born.vars[var][usize::from(degree)] = theirs(update.value),
                    Place::Discrete(id) => born.discretes[id] = theirs(update.value),
                    Place::Ref(_) => {}
                }
            }
            let known = &mut self.slots[slot].params;
            let mut reshaped = false;
            for (id, value) in params.pairs() {
                let joined = known[id].or(value);
                reshaped |= joined != known[id];
                known[id] = joined;
            }
            if reshaped {
                self.scene.reshape(slot, &self.slots[slot].params);
                self.slots[slot].is_changed = true;
                changed = true;
            }
            if let Some(landing) = Landing::of(&born) {
                changed |= self.land(slot, &landing);
            }
            changed |= self.enter(slot, born);
        }
        changed
    }
}

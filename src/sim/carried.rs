//! A state of one program as a state of another, by names: so that play goes on while the text changes. What exists in
//! both keeps its values; contacts are computed anew; what exists no longer is listed.

use crate::ir::{DiscreteId, Domain, Id, LeafId, ModeId, SlotId};
use crate::watch::{Meter, Unwatched};

use super::fault::Fault;
use super::saved::State;
use super::simulator::Simulator;
use super::state::{buttons, set_buttons};

/// A state that was carried over.
pub struct Carried {
    /// The state.
    pub state: State,
    /// What it has no place for: `bat`, `hero.fuel`, `hero in swim`.
    pub lost: Vec<String>,
}

impl Simulator {
    /// A state of another simulator as a state of this one.
    ///
    /// # Errors
    /// A [`Fault`] if the state breaks a rule of this program, or why the result is no state.
    pub fn carry_over(&self, other: &Simulator, from: &State) -> Result<Result<Carried, &'static str>, Fault> {
        let mut scratch = self.scratch();
        let mut state = self.initial(&mut scratch)?;
        let mut lost = Vec::new();
        for (id, slot) in other.world().slots.pairs() {
            if other.layout(id).alive(from) && !self.has(other, id) {
                lost.push(slot.name.clone());
            }
        }
        for slot in self.world().slots.ids() {
            let Some(old) = self.same(other, slot) else { continue };
            match (other.layout(old).alive(from), self.layout(slot).alive(&state)) {
                (false, false) => continue,
                (false, true) => self.layout(slot).clear(&mut state),
                (true, true) => self.carry_instance(other, (from, old), (&mut state, slot), &mut lost),
                (true, false) => {
                    self.place(slot, &mut state)?;
                    self.carry_instance(other, (from, old), (&mut state, slot), &mut lost);
                }
            }
        }
        self.carry_references(other, from, &mut state);
        self.carry_tiles(other, from, &mut state);
        self.carry_buttons(other, from, &mut state);
        self.first_contacts(&mut state, &mut scratch, &Meter::new(&Unwatched))?;
        if let Err(why) = self.world().slots.ids().try_for_each(|slot| self.check(&state, slot)) {
            return Ok(Err(why));
        }
        lost.dedup();
        Ok(Ok(Carried { state, lost }))
    }

    /// Whether this world has the instance of a slot of another one.
    fn has(&self, other: &Simulator, slot: SlotId) -> bool {
        let named = self.world().slot_named(&other.world().slots[slot].name);
        named.is_some_and(|own| self.entity(own).name == other.entity(slot).name)
    }

    /// The slot of another world with the name and the entity of a slot.
    fn same(&self, other: &Simulator, slot: SlotId) -> Option<SlotId> {
        let old = other.world().slot_named(&self.world().slots[slot].name)?;
        (other.entity(old).name == self.entity(slot).name).then_some(old)
    }

    fn carry_instance(
        &self,
        other: &Simulator,
        (from, old): (&[u8], SlotId),
        (state, slot): (&mut State, SlotId),
        lost: &mut Vec<String>,
    ) {
        let (entity, layout, old_layout) = (self.entity(slot), self.layout(slot), other.layout(old));
        let before = other.instance(from, old);
        let name = before.name();
        for (id, var) in before.entity().vars.pairs() {
            match entity.var_named(var) {
                Some(own) => {
                    (0..=2).for_each(|degree| layout.set_var(state, own, degree, old_layout.var(from, id, degree)));
                }
                None => lost.push(format!("{name}.{var}")),
            }
        }
        // Parameters that belong to the instance; others are those of the new text.
        for (id, param) in before.entity().params.pairs() {
            if let (Some(value), Some(own)) = (old_layout.param(from, id), entity.param_named(&param.name)) {
                layout.set_param(state, own, value);
            }
        }
        for (id, discrete) in before.entity().discretes.pairs() {
            match entity.discrete_named(&discrete.name).and_then(|own| Some((own, self.value(slot, own, before, id)?)))
            {
                Some((own, value)) => layout.set_discrete(state, own, value),
                None => lost.push(format!("{name}.{}", discrete.name)),
            }
        }
        for mode in before.modes() {
            let path = &before.entity().modes[mode].path;
            let Some(own) = entity.modes.find(|mode| mode.path == *path) else {
                lost.push(format!("{name} in {path}"));
                continue;
            };
            layout.set_leaf(state, entity.modes[own].group, self.leaf_in(slot, own));
        }
        for (id, timer) in entity.timers.pairs() {
            let path = &entity.modes[timer.mode].path;
            let is_active = entity.is_active_in(timer.mode, layout.leaf(state, entity.modes[timer.mode].group));
            let known = before.entity().timers.find(|of| before.entity().modes[of.mode].path == *path);
            let count = known.filter(|_| is_active).map_or(0, |known| old_layout.timer(from, known));
            layout.set_timer(state, id, count.min(self.world().slots[slot].timer_limits[id]));
        }
        let space = &other.world().spaces[before.space()].name;
        match self.world().spaces.find(|of| of.name == *space) {
            Some(own) => layout.set_space(state, own),
            None => lost.push(format!("{name} in {space}")),
        }
    }

    /// The value of a discrete variable of another program's instance as a value of one's own; none if it is none.
    fn value(
        &self,
        slot: SlotId,
        own: DiscreteId,
        before: super::instance::Instance<'_>,
        id: DiscreteId,
    ) -> Option<i32> {
        let (own, old) = (&self.entity(slot).discretes[own], &before.entity().discretes[id]);
        let value = match (&own.domain, &old.domain) {
            (Domain::Set(names), Domain::Set(_)) => {
                let name = before.discrete_name(id)?;
                i32::try_from(names.iter().position(|of| of == name)?).ok()?
            }
            (Domain::Bool, Domain::Bool) | (Domain::Int, Domain::Int) => before.discrete(id),
            _ => return None,
        };
        (own.range.0..=own.range.1).contains(&value).then_some(value)
    }

    /// The leaf of a mode, or that of its first inner mode.
    fn leaf_in(&self, slot: SlotId, mode: ModeId) -> LeafId {
        let entity = self.entity(slot);
        let mut inner = mode;
        while let Some(next) = entity.modes[inner].inner {
            inner = next;
        }
        entity.modes[inner].leaves.from
    }

    /// References, by the names of what they refer to; those to what is not there are none.
    fn carry_references(&self, other: &Simulator, from: &[u8], state: &mut State) {
        for slot in self.world().slots.ids() {
            if !self.layout(slot).alive(state) {
                continue;
            }
            let old = self.same(other, slot).map(|old| other.instance(from, old)).filter(|old| old.is_alive());
            for (id, reference) in self.entity(slot).refs.pairs() {
                if let Some(old) = old
                    && let Some(known) = old.entity().refs.find(|of| of.name == reference.name)
                {
                    let target = old.reference(known).and_then(|target| self.world().slot_named(target.name()));
                    let fits =
                        |target: &SlotId| reference.entity.is_none_or(|of| of == self.world().slots[*target].entity);
                    self.layout(slot).set_reference(state, id, target.filter(fits));
                }
                let target = self.layout(slot).reference(state, id);
                if target.is_some_and(|target| !self.layout(target).alive(state)) {
                    self.layout(slot).set_reference(state, id, None);
                }
            }
        }
    }

    /// Broken tiles, by the places of their cells in spaces of the same size.
    fn carry_tiles(&self, other: &Simulator, from: &[u8], state: &mut State) {
        let Some(breakables) = &self.breakables else { return };
        for tile in other.broken_tiles(from) {
            let Some((space, column, row)) = other.place_of_tile(tile) else { continue };
            let name = &other.world().spaces[space].name;
            let Some(own) = self.world().spaces.find(|of| of.name == *name) else { continue };
            let Some(map) = self.world().spaces[own].map.as_ref() else { continue };
            if column < map.columns
                && row < map.rows
                && let Some(tile) = breakables.tile(own.index(), row * map.columns + column)
            {
                breakables.break_tile(state, tile);
            }
        }
    }

    /// Buttons that were down, so that holding them is no new press.
    fn carry_buttons(&self, other: &Simulator, from: &[u8], state: &mut State) {
        for ((id, player), &at) in self.world().players.pairs().zip(self.world().layout.players.iter()) {
            let Some(old) = other.world().players.find(|of| of.number == player.number) else { continue };
            let held = buttons(from, other.world().layout.players[old]);
            let known = &other.entity(other.world().players[old].slot).buttons;
            let mut down = 0;
            for (button, name) in self.entity(self.world().players[id].slot).buttons.pairs() {
                let was = known.find(|of| of == name).is_some_and(|was| held >> was.index() & 1 == 1);
                down |= u64::from(was) << button.index();
            }
            set_buttons(state, at, down & self.remembered);
        }
    }
}

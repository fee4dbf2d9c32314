//! The discrete phase: edges, updates, entering and leaving modes. Everything is read from the state as the step
//! began and written to the new one, so that the order of instances does not matter. Who is destroyed, spawned or
//! goes through a link is noted, and done once all have decided.

use std::cell::Cell;

use crate::ir::{Actions, EdgeId, Entity, Follow, GroupId, Id, Leaf, LeafId, Place, SlotId, Transition, Update};

use super::actor::{Actor, Plan};
use super::evaluate::Reader;
use super::fault::{Fault, FaultKind};
use super::input::Frame;
use super::life::Changes;
use super::simulator::{Scratch, Simulator};

/// An edge that a group takes in this step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Taken {
    pub edge: EdgeId,
    pub transition: Transition,
}

/// A group that does something in this step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Acting {
    slot: SlotId,
    group: GroupId,
    choice: Option<Taken>,
}

impl Simulator {
    /// Takes the edges of every live slot.
    pub(super) fn transitions(&self, state: &mut [u8], scratch: &mut Scratch) -> Result<(), Fault> {
        let Scratch { before, frames, taken, acting, changes, .. } = scratch;
        let fault = Cell::new(None);
        changes.clear();
        acting.clear();
        self.decide(state, frames, taken, acting, &fault);
        Self::settle(&fault)?;
        // In most steps no edge is taken, and the state need not be kept.
        if acting.is_empty() {
            return Ok(());
        }
        before.copy_from_slice(state);
        for &Acting { slot, group, choice } in acting.iter() {
            let actor = &self.actors[slot.index()];
            let reader = self.reader(actor, before, frames, &taken[actor.groups.clone()], &fault);
            self.run(state, &reader, &actor.entity, group, choice, changes);
        }
        Self::settle(&fault)?;
        if changes.is_none() { Ok(()) } else { self.change(state, scratch) }
    }

    /// Notes which groups do something in this step: those that take an edge, and those with more to run.
    fn decide(
        &self,
        state: &[u8],
        frames: &[Frame],
        taken: &mut [Option<Taken>],
        acting: &mut Vec<Acting>,
        fault: &Cell<Option<Fault>>,
    ) {
        let mut alone = Reader { frames, ..self.onlooker(state, fault) };
        for actor in &self.actors {
            if !actor.layout.acts(state) {
                continue;
            }
            let (entity, slot) = (&*actor.entity, actor.id);
            if !actor.code.is_joint {
                // No group waits for another.
                alone.turn_to(actor);
                for group in actor.group_ids() {
                    let from = actor.layout.leaf(state, group);
                    let plan = &actor.code.plans[from];
                    let edge = first_edge(&alone, plan);
                    if edge.is_some() || plan.is_busy {
                        let choice = edge.and_then(|edge| taking(&alone, entity, group, from, edge));
                        acting.push(Acting { slot, group, choice });
                    }
                }
                continue;
            }
            let own = actor.groups.clone();
            taken[own.clone()].fill(None);
            for &group in &entity.order {
                let reader = self.reader(actor, state, frames, &taken[own.clone()], fault);
                let from = actor.layout.leaf(state, group);
                let edge = first_edge(&reader, &actor.code.plans[from]);
                let choice = edge.and_then(|edge| taking(&reader, entity, group, from, edge));
                taken[own.start + group.index()] = choice;
            }
            for (group, &choice) in actor.group_ids().zip(&taken[own]) {
                if choice.is_some() || actor.code.plans[actor.layout.leaf(state, group)].is_busy {
                    acting.push(Acting { slot, group, choice });
                }
            }
        }
    }

    /// Runs what a group does: edges without a target, the edge that is taken, links.
    #[inline(never)]
    fn run(
        &self,
        state: &mut [u8],
        reader: &Reader<'_>,
        entity: &Entity,
        group: GroupId,
        taken: Option<Taken>,
        changes: &mut Changes,
    ) {
        let from = self.layout(reader.me).leaf(reader.state, group);
        let leaf: &Leaf = &entity.leaves[from];
        let set = |needs: &[crate::ir::RefId]| {
            needs.iter().all(|&r| self.layout(reader.me).reference(reader.state, r).is_some())
        };
        for &id in &leaf.internal {
            let edge = &entity.edges[id];
            if set(&edge.needs) && reader.truth(edge.guard) {
                changes.takes(reader.me, id);
                self.act(state, reader, &edge.actions, changes);
            }
        }
        if let Some(taken) = taken {
            changes.takes(reader.me, taken.edge);
            self.take(state, reader, entity, taken, changes);
        }
        for &follow in &leaf.follows {
            let follow: &Follow = &entity.follows[follow];
            if changes.is_moving(reader.me) || !set(&follow.needs) || !follow.guard.is_none_or(|g| reader.truth(g)) {
                continue;
            }
            if let Some(link) = self.link_at(reader) {
                changes.go(reader.me, link);
                self.act(state, reader, &follow.actions, changes);
            }
        }
    }

    /// Leaves and enters modes and runs the updates: entries from the outermost in, then the edge's own.
    fn take(&self, state: &mut [u8], reader: &Reader<'_>, entity: &Entity, taken: Taken, changes: &mut Changes) {
        let Taken { edge, transition } = taken;
        let layout = self.layout(reader.me);
        layout.set_leaf(state, transition.group, transition.to);
        for timer in transition.resets(entity) {
            layout.set_timer(state, timer, 0);
        }
        for mode in transition.entered(entity) {
            self.act(state, reader, &entity.modes[mode].entry, changes);
        }
        self.act(state, reader, &entity.edges[edge].actions, changes);
    }

    fn act(&self, state: &mut [u8], reader: &Reader<'_>, actions: &Actions, changes: &mut Changes) {
        for update in &actions.updates {
            self.update(state, reader.me, reader, update);
        }
        for update in &actions.refs {
            changes.assigns(reader.me, update.reference);
            let target = reader.reference(update.value);
            self.layout(reader.me).set_reference(state, update.reference, target);
        }
        for &spawn in &actions.spawns {
            let into = self.entity(reader.me).spawns[spawn].into;
            if let Some(into) = into {
                changes.assigns(reader.me, into);
            }
            changes.spawn(reader.me, spawn, into);
        }
        for &what in &actions.destroys {
            if let Some(target) = reader.reference(what) {
                changes.destroy(target);
            }
        }
    }

    /// Writes a variable of a slot; the value is what `reader` reads.
    pub(super) fn update(&self, state: &mut [u8], slot: SlotId, reader: &Reader<'_>, update: &Update) {
        let value = reader.number(update.value);
        match update.place {
            Place::Var(var, degree) => self.layout(slot).set_var(state, var, degree, value),
            Place::Discrete(id) => {
                let (low, high) = self.entity(slot).discretes[id].range;
                let fits = value >= f64::from(low) && value <= f64::from(high) && value.fract() == 0.0;
                if fits {
                    self.layout(slot).set_discrete(state, id, value as i32);
                } else {
                    let entity = self.world().slots[slot].entity;
                    reader.note(FaultKind::OutOfRange(update.value, entity, id, value));
                }
            }
            Place::Ref(_) => {}
        }
    }

    /// The new state's slot is where timers of active modes are counted.
    #[inline(always)]
    pub(super) fn count_timers(&self, state: &mut [u8], actor: &Actor) {
        let Actor { layout, timer_limits, code, .. } = actor;
        if timer_limits.is_empty() {
            return;
        }
        for group in actor.group_ids() {
            for &id in &code.plans[layout.leaf(state, group)].timers {
                let count = layout.timer(state, id);
                layout.set_timer(state, id, count.saturating_add(1).min(timer_limits[id]));
            }
        }
    }
}

/// The edge that a group takes: the first whose guard holds.
#[inline(always)]
fn first_edge(reader: &Reader<'_>, plan: &Plan) -> Option<EdgeId> {
    for &(guard, edge) in &plan.edges {
        if reader.truth(guard) {
            return Some(edge);
        }
    }
    None
}

/// Where an edge leads.
fn taking(reader: &Reader<'_>, entity: &Entity, group: GroupId, from: LeafId, edge: EdgeId) -> Option<Taken> {
    let target = entity.edges[edge].target?;
    Some(Taken { edge, transition: Transition { group, from, target, to: reader.entered(target) } })
}

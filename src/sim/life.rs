//! Destroyed instances, broken tiles, spawned instances and moves through links: applied after all edges are taken, in slot order.
//!
//! A destroyed instance stays readable until the step ends; then every reference to it becomes none and its slot is
//! free. A spawned instance is readable at once, but moves, collides and takes edges from the next step on.

use std::cell::Cell;

use crate::ir::{EdgeId, EntityId, Id, Origin, Place, RefId, Slot, SlotId, SpaceId, SpawnId, TileId, VarId, World};

use super::evaluate::Reader;
use super::fault::{Fault, FaultKind};
use super::simulator::{Scratch, Simulator};
use super::state::Life;

/// The slots that a spawn of an entity may take. The slot of a placed instance is never reused: it has a name.
#[derive(Debug)]
pub(super) struct Pool {
    free: Vec<SlotId>,
    placed: Vec<SlotId>,
    /// The most instances that may be alive at once.
    limit: usize,
}

impl Pool {
    pub fn new(world: &World, entity: EntityId) -> Self {
        let limit = world.limits.iter().find(|limit| limit.entity == entity);
        let slots = world.slots.pairs().filter(|(_, s)| s.entity == entity);
        let (placed, free): (Vec<_>, Vec<_>) = slots.partition(|(_, s)| s.origin == Origin::Named);
        let ids = |of: Vec<(SlotId, &Slot)>| of.into_iter().map(|(id, _)| id).collect();
        Pool { free: ids(free), placed: ids(placed), limit: limit.map_or(usize::MAX, |l| l.count as usize) }
    }

    /// The first slot that is free, unless as many instances are alive as may be.
    fn first(&self, is_alive: impl Fn(SlotId) -> bool) -> Option<SlotId> {
        let living = self.placed.iter().chain(&self.free).filter(|slot| is_alive(**slot)).count();
        self.free.iter().copied().find(|slot| living < self.limit && !is_alive(*slot))
    }
}

/// The pending changes of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Changes {
    destroys: Vec<SlotId>,
    /// The spawner, the spawn, and the reference that is set to the new instance.
    spawns: Vec<(SlotId, SpawnId, Option<RefId>)>,
    /// Tiles that break.
    breaks: Vec<TileId>,
    /// Instances with the index of the link that they move through.
    moves: Vec<(SlotId, usize)>,
    /// Instances with the edges that they took.
    edges: Vec<(SlotId, EdgeId)>,
    /// Whether any instance was spawned or destroyed in this step.
    lives_changed: bool,
    /// The first spawn of the step that found no free slot.
    refused: Option<(SlotId, SpawnId)>,
}

impl Changes {
    /// With capacity for all changes of one step.
    pub fn with_capacity(destroys: usize, spawns: usize, slots: usize, edges: usize) -> Self {
        Changes {
            destroys: Vec::with_capacity(destroys),
            breaks: Vec::with_capacity(destroys),
            spawns: Vec::with_capacity(spawns),
            moves: Vec::with_capacity(slots),
            edges: Vec::with_capacity(edges),
            ..Changes::default()
        }
    }

    /// Whether anything is spawned.
    #[cfg(feature = "ask")]
    pub fn has_spawned(&self) -> bool {
        !self.spawns.is_empty()
    }

    /// Those that are destroyed.
    pub fn destroyed(&self) -> &[SlotId] {
        &self.destroys
    }

    pub fn clear(&mut self) {
        self.destroys.clear();
        self.breaks.clear();
        self.spawns.clear();
        self.moves.clear();
        self.edges.clear();
        self.lives_changed = false;
        self.refused = None;
    }

    /// Whether there are no pending changes.
    pub fn is_none(&self) -> bool {
        self.destroys.is_empty() && self.breaks.is_empty() && self.spawns.is_empty() && self.moves.is_empty()
    }

    pub fn destroy(&mut self, slot: SlotId) {
        self.destroys.push(slot);
    }

    pub fn break_tile(&mut self, tile: TileId) {
        self.breaks.push(tile);
    }

    pub fn spawn(&mut self, me: SlotId, spawn: SpawnId, into: Option<RefId>) {
        self.spawns.push((me, spawn, into));
    }

    /// A later update of a reference takes precedence over an earlier spawn.
    pub fn clear_spawn_target(&mut self, me: SlotId, reference: RefId) {
        for (slot, _, into) in &mut self.spawns {
            if *slot == me && *into == Some(reference) {
                *into = None;
            }
        }
    }

    pub fn move_through(&mut self, me: SlotId, link: usize) {
        self.moves.push((me, link));
    }

    pub fn record_edge(&mut self, me: SlotId, edge: EdgeId) {
        self.edges.push((me, edge));
    }

    /// The taken edges in order.
    pub fn edges(&self) -> &[(SlotId, EdgeId)] {
        &self.edges
    }

    pub fn is_moving(&self, me: SlotId) -> bool {
        self.moves.last().is_some_and(|(slot, _)| *slot == me)
    }

    pub fn refused(&self) -> Option<(SlotId, SpawnId)> {
        self.refused
    }
}

impl Simulator {
    /// The first open link of the instance's space whose rectangle contains the instance.
    pub(super) fn link_at(&self, reader: &Reader<'_>) -> Option<usize> {
        let (x, y) = self.position(reader.state, reader.me);
        let links = &self.world().spaces[self.space(reader.state, reader.me)].links;
        links.iter().position(|link| {
            let inside =
                (link.from.left..=link.from.right).contains(&x) && (link.from.bottom..=link.from.top).contains(&y);
            inside && link.guard.is_none_or(|g| self.world_reader(reader.state, reader.fault).truth(g))
        })
    }

    /// Applies the pending changes.
    #[cold]
    pub(super) fn apply_changes(&self, state: &mut [u8], scratch: &mut Scratch) -> Result<(), Fault> {
        let Scratch { before, frames, taken, changes, .. } = scratch;
        for &slot in &changes.destroys {
            if self.layout(slot).acts(state) {
                self.layout(slot).set_life(state, Life::Dying);
                changes.lives_changed = true;
            }
        }
        if let Some(breakables) = &self.breakables {
            changes.breaks.iter().for_each(|tile| breakables.break_tile(state, *tile));
        }
        for &(me, spawn, into) in &changes.spawns {
            let pool = &self.pools[self.entity(me).spawns[spawn].entity.index()];
            let free = pool.first(|slot| self.layout(slot).alive(state));
            match free {
                Some(slot) => {
                    let actor = &self.actors[me.index()];
                    let fault = Cell::new(None);
                    let spawner = self.reader(actor, before, frames, &taken[actor.groups.clone()], &fault);
                    self.initialize_spawned(state, slot, spawn, &spawner);
                    Self::check_fault(&fault)?;
                    changes.lives_changed = true;
                }
                None => {
                    changes.refused.get_or_insert((me, spawn));
                }
            }
            if let Some(into) = into {
                self.layout(me).set_reference(state, into, free);
            }
        }
        for &(me, link) in &changes.moves {
            let link = &self.world().spaces[self.space(before, me)].links[link];
            let layout = self.layout(me);
            layout.set_space(state, link.space);
            let along = |value: f64, from: (f64, f64), to: (f64, f64)| {
                to.0 + (to.1 - to.0) * (value - from.0) / (from.1 - from.0)
            };
            let (x, y) = self.position(state, me);
            layout.set_var(
                state,
                VarId::X,
                0,
                along(x, (link.from.left, link.from.right), (link.to.left, link.to.right)),
            );
            layout.set_var(
                state,
                VarId::Y,
                0,
                along(y, (link.from.bottom, link.from.top), (link.to.bottom, link.to.top)),
            );
            layout.set_carrier(state, None);
        }
        Ok(())
    }

    /// Initialises a free slot by a spawn.
    fn initialize_spawned(&self, state: &mut [u8], slot: SlotId, spawn: SpawnId, spawner: &Reader<'_>) {
        let spawn = &self.entity(spawner.me).spawns[spawn];
        let layout = self.layout(slot);
        let entity = self.entity(slot);
        layout.clear(state);
        layout.set_life(state, Life::Born);
        let (x, y) = self.position(spawner.state, spawner.me);
        layout.set_var(state, VarId::X, 0, x);
        layout.set_var(state, VarId::Y, 0, y);
        let space: SpaceId = self.space(spawner.state, spawner.me);
        layout.set_space(state, space);
        let fault = spawner.fault;
        macro_rules! own {
            () => {
                self.reader(&self.actors[slot.index()], state, spawner.frames, &[], fault)
            };
        }
        for (id, param) in entity.params.pairs() {
            let given = spawn.params.iter().find(|(p, _)| *p == id);
            let value = match given {
                Some((_, value)) => spawner.number(*value),
                None => own!().number(param.default),
            };
            layout.set_param(state, id, value);
        }
        let is_given = |place: Place| spawn.updates.iter().any(|update| update.place == place);
        for (var, first) in entity.first.pairs() {
            if let Some(first) = first.filter(|_| !is_given(Place::Var(var, 0))) {
                let value = own!().number(first);
                layout.set_var(state, var, 0, value);
            }
        }
        for (id, discrete) in entity.discretes.pairs().filter(|(id, _)| !is_given(Place::Discrete(*id))) {
            let value = own!().number(discrete.first);
            let (low, high) = discrete.range;
            if value >= f64::from(low) && value <= f64::from(high) && value.fract() == 0.0 {
                layout.set_discrete(state, id, value as i32);
            } else {
                let of = self.world().slots[slot].entity;
                spawner.note(FaultKind::OutOfRange(discrete.first, of, id, value));
            }
        }
        for update in &spawn.updates {
            self.update(state, slot, spawner, update);
        }
        for update in &spawn.refs {
            layout.set_reference(state, update.reference, spawner.reference(update.value));
        }
        for (group, g) in entity.groups.pairs() {
            let reader = own!();
            let leaf = reader.entered(reader.chosen(&g.choices, g.first));
            layout.set_leaf(state, group, leaf);
        }
    }

    /// Removes destroyed instances and all references to them at the end of a step.
    pub(super) fn remove_destroyed(&self, state: &mut [u8], scratch: &Scratch) {
        if !scratch.changes.lives_changed {
            return;
        }
        if let Some(still) = &self.still {
            return self.remove_destroyed_of(still, state, &scratch.changes.destroys);
        }
        for me in self.world().slots.ids() {
            self.forget_destroyed(state, me);
        }
        for me in self.world().slots.ids() {
            let layout = self.layout(me);
            match layout.life(state) {
                Life::Dying => layout.clear(state),
                Life::Born => layout.set_life(state, Life::Alive),
                Life::Alive | Life::None => {}
            }
        }
    }

    /// Makes an instance refer to no destroyed one.
    pub(super) fn forget_destroyed(&self, state: &mut [u8], me: SlotId) {
        let layout = self.layout(me);
        if !matches!(layout.life(state), Life::Alive | Life::Born) {
            return;
        }
        let is_dying = |s: SlotId| self.layout(s).life(state) == Life::Dying;
        if layout.carrier(state).is_some_and(is_dying) {
            layout.set_carrier(state, None);
        }
        for id in self.entity(me).refs.ids() {
            if layout.reference(state, id).is_some_and(|s| self.layout(s).life(state) == Life::Dying) {
                layout.set_reference(state, id, None);
            }
        }
    }
}

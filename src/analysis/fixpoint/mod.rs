//! The fixpoint iteration: steps from all known configurations until nothing new is found, then narrows the result.

pub(in crate::analysis) mod counter_bounds;
mod effects;
pub(in crate::analysis) mod initial;
pub(in crate::analysis) mod narrowing;
mod thresholds;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::ir::{
    DiscreteId, Entity, EntityId, Expr, ExprId, Id, IdVec, LeafId, Origin, ParamId, Program, SlotId, SpaceId, VarId,
    World,
};

use crate::watch::Watch;

use super::{ConfigurationSpace, GivenUp, SlotSpace};
use crate::analysis::domain::configuration::{Configuration, MidStep, Overall};
use crate::analysis::domain::received::{Received, Sent};
use crate::analysis::domain::unknown::{Unknown, known_or};
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::domain::widen::{GrowthCounts, Thresholds, within_bounds};
use crate::analysis::fixpoint::counter_bounds::Limits;
use crate::analysis::geometry::cells::{CellId, Cells};
use crate::analysis::geometry::placement::{PlacedColliders, Placement};
use crate::analysis::geometry::scene::Scene;
use crate::analysis::geometry::seam::keep_in;
use crate::analysis::geometry::surroundings::Surroundings;
use crate::analysis::step::evaluate::{Joined, Phase, Reader};
use crate::analysis::step::forbidden::Forbidden;
use crate::analysis::step::{Outcome, Stepper};

/// Maximum number of combinations of leaves per slot.
pub(in crate::analysis) const MAX_CONFIGURATIONS: usize = 1_024;
/// Number of narrowing passes.
const NARROWINGS: usize = 2;

/// Identifies a configuration: the active leaf of each group, and the cell of the position.
pub(in crate::analysis) type Key = (Arc<[LeafId]>, CellId);

/// A configuration that may still grow.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Growing {
    pub at: Configuration,
    growth: GrowthCounts,
    is_new: bool,
}

#[derive(Debug, Default, Clone)]
pub(in crate::analysis) struct Slot {
    pub configurations: BTreeMap<Key, Growing>,
    pub can_be_absent: bool,
    pub is_given_up: bool,
    /// The reason, if given up.
    pub why: Option<GivenUp>,
    pub params: IdVec<ParamId, Values>,
    /// The spaces to which links lead it: contacts there decide whether it can stay.
    pub entered: BTreeSet<SpaceId>,
    /// px/s
    pub speed: [f64; 2],
    pub near_speed: [f64; 2],
    pub mid_step: MidStep,
    /// What it can send.
    pub sent: Sent,
    /// Position when contacts are detected, px.
    pub contact: [Values; 2],
    /// Whether the slot has changed since it was last published.
    pub is_changed: bool,
}

impl Slot {
    /// Number of distinct combinations of leaves.
    fn combinations(&self) -> usize {
        let keys: Vec<&Key> = self.configurations.keys().collect();
        keys.chunk_by(|a, b| a.0 == b.0).count()
    }
}

/// An analysis in progress.
pub(in crate::analysis) struct Analysis<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub slots: IdVec<SlotId, Slot>,
    pub overall: IdVec<SlotId, Overall>,
    /// Joins over several slots, cached.
    joined: Joined,
    pub scene: Scene<'a>,
    pub surroundings: Surroundings,
    /// What instances of each entity can receive.
    pub received: Received,
    /// The slot that represents each slot: slots that are empty at the start are interchangeable.
    first: IdVec<SlotId, SlotId>,
    /// Invariant bounds of the discrete variables.
    pub(in crate::analysis) limits: Limits,
    /// What is not known of the instances that begin.
    pub unknown: &'a Unknown,
    /// Predicates that never hold.
    pub(in crate::analysis) forbidden: Forbidden<'a>,
    /// Whether any instance reads others.
    is_read: bool,
    /// Whether the analysis is narrowing, so that no widening is needed.
    is_narrowing: bool,
    /// Number of branches of steps that may still be examined.
    pub effort: usize,
    /// Polled to see whether the result is still needed.
    pub watch: &'a dyn Watch,
    /// Whether the watch requested a stop.
    pub is_stopped: bool,
    /// Widening thresholds: the numbers that the program compares with or writes, and the ends of pushes.
    thresholds: Thresholds,
}

impl<'a> Analysis<'a> {
    pub fn new(
        scene: Scene<'a>,
        forbidden: Forbidden<'a>,
        (limits, unknown): (Limits, &'a Unknown),
        effort: usize,
        watch: &'a dyn Watch,
    ) -> Self {
        let (program, world) = (forbidden.program, forbidden.world);
        let slots: IdVec<SlotId, Slot> = world
            .slots
            .iter()
            .map(|s| Slot {
                can_be_absent: s.origin == Origin::Free,
                params: s.params.iter().map(|p| known_or(*p, Values::none())).collect(),
                is_changed: true,
                mid_step: MidStep::new(s.vars.len(), s.discretes.len()),
                ..Slot::default()
            })
            .collect();
        let mut free: BTreeMap<EntityId, SlotId> = BTreeMap::new();
        let first = world.slots.pairs().map(|(slot, s)| match s.origin {
            Origin::Free => *free.entry(s.entity).or_insert(slot),
            Origin::Named | Origin::Tile => slot,
        });
        let mut analysis = Analysis {
            program,
            world,
            overall: IdVec::new(),
            joined: Joined::default(),
            slots,
            first: first.collect(),
            scene,
            limits,
            unknown,
            forbidden,
            surroundings: Surroundings::default(),
            received: Received::default(),
            effort,
            watch,
            is_stopped: false,
            is_narrowing: false,
            is_read: program.entities.iter().any(|entity| reads_others(program, entity)),
            thresholds: Thresholds::default(),
        };
        analysis.overall = world.slots.ids().map(|s| analysis.overall(s)).collect();
        for slot in world.slots.ids().filter(|s| world.slots[*s].origin != Origin::Free) {
            analysis.begin(slot);
        }
        analysis.publish();
        analysis.thresholds = analysis.thresholds();
        analysis
    }

    pub(in crate::analysis) fn entity(&self, slot: SlotId) -> &'a Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    /// Whether a slot is its own representative.
    pub(in crate::analysis) fn is_first(&self, slot: SlotId) -> bool {
        self.first[slot] == slot
    }

    /// Joins a configuration into a slot; returns true if the slot grew. `from` is the configuration that led to it:
    /// growth caused by a configuration itself is weighted differently, and is ignored while narrowing.
    pub(in crate::analysis) fn grow(&mut self, slot: SlotId, mut found: Configuration, from: Option<&Key>) -> bool {
        if self.slots[slot].is_given_up || !self.restrict(slot, &mut found) {
            return false;
        }
        let mut changed = false;
        let is_kept_out = self.surroundings.is_kept_out(slot, &found.leaves);
        if let (Cells::Fine(fine), false) = (self.cells(slot), self.is_narrowing) {
            self.effort = self.effort.saturating_sub(fine.count_parts(&found));
            // The whole analysis is given up then.
            if self.effort == 0 {
                return false;
            }
        }
        let parts = self.cells(slot).split(found, is_kept_out);
        for (cell, found) in parts {
            let is_own = from.is_some_and(|(leaves, of)| *of == cell && *leaves == found.leaves);
            if !(is_own && self.is_narrowing) {
                changed |= self.grow_in(slot, cell, found, is_own);
            }
        }
        changed
    }

    /// Restricts a configuration to what its counters and the predicates that never hold allow; returns whether anything is
    /// left.
    pub fn restrict(&self, slot: SlotId, found: &mut Configuration) -> bool {
        cut(found, &self.limits[slot]);
        !found.is_impossible() && self.forbidden.cut(slot, found)
    }

    /// The cells into which a slot's positions are divided.
    pub fn cells(&self, slot: SlotId) -> &Cells {
        &self.scene.cells[self.scene.of[slot]]
    }

    fn grow_in(&mut self, slot: SlotId, cell: CellId, found: Configuration, is_own: bool) -> bool {
        let known = &mut self.slots[slot];
        let key = (found.leaves.clone(), cell);
        // The common case: nothing is new, and nothing large is moved.
        if known.configurations.get(&key).is_some_and(|growing| found.is_within(&growing.at)) {
            return false;
        }
        let Some(mut growing) = known.configurations.remove(&key) else {
            let growth = GrowthCounts::new(&found);
            self.scene.activate(self.scene.of[slot], &key.0);
            known.configurations.insert(key, Growing { at: found, growth, is_new: true });
            known.is_changed = true;
            if known.configurations.len() > MAX_CONFIGURATIONS && known.combinations() > MAX_CONFIGURATIONS {
                self.give_up(slot, GivenUp::Combinations);
            }
            return true;
        };
        let others = |var: VarId, degree: usize| {
            let hulls = known.configurations.values().filter_map(|g| g.at.vars[var][degree].hull());
            hulls.reduce(Interval::or)
        };
        let mut joined = growing.at.or(&found);
        joined.sharpen();
        let is_more = joined != growing.at;
        if is_more {
            if !self.is_narrowing {
                growing.growth.widen(&growing.at, &mut joined, &self.thresholds, is_own, others);
            }
            cut(&mut joined, &self.limits[slot]);
            self.forbidden.cut(slot, &mut joined);
            joined.sharpen();
            self.scene.cells[self.scene.of[slot]].cut(cell, &mut joined);
            keep_in(self.world, &mut joined);
            growing.at = within_bounds(self.world, slot, joined);
            growing.is_new = true;
            known.is_changed = true;
        }
        known.configurations.insert(key, growing);
        is_more
    }

    fn overall(&self, slot: SlotId) -> Overall {
        let known = &self.slots[slot];
        let entity = self.entity(slot);
        let all = |c: &dyn Fn(&Configuration) -> Values| {
            Values::any(known.configurations.values().flat_map(|g| c(&g.at).intervals().to_vec()))
        };
        if known.is_given_up {
            return Overall {
                can_live: true,
                can_be_absent: true,
                params: match self.world.slots[slot].is_fixed {
                    true => known.params.clone(),
                    false => known.params.iter().map(|_| Values::all()).collect(),
                },
                contact: [Values::all(); 2],
                vars: entity.vars.iter().map(|_| [Values::all(), Values::all(), Values::all()]).collect(),
                discretes: self.limits[slot].clone(),
                spaces: self.world.spaces.ids().collect(),
                speed: [f64::INFINITY; 2],
                near_speed: [f64::INFINITY; 2],
                mid_step: MidStep::anything(
                    entity.vars.len(),
                    self.limits[slot].clone(),
                    entity.leaves.ids().collect(),
                ),
                leaves: entity.leaves.ids().collect(),
            };
        }
        Overall {
            can_live: !known.configurations.is_empty(),
            can_be_absent: known.can_be_absent,
            params: known.params.clone(),
            vars: entity.vars.ids().map(|v| [0, 1, 2].map(|d| all(&|c| c.vars[v][d]))).collect(),
            discretes: entity.discretes.ids().map(|id| all(&|c| c.discretes[id])).collect(),
            spaces: known.configurations.values().flat_map(|g| &*g.at.spaces).chain(&known.entered).copied().collect(),
            contact: known.contact,
            speed: known.speed,
            near_speed: known.near_speed,
            mid_step: known.mid_step.clone(),
            leaves: known.configurations.keys().flat_map(|(leaves, _)| &**leaves).copied().collect(),
        }
    }

    /// Publishes the joins of the changed slots to all others; returns true if anything changed.
    pub fn publish(&mut self) -> bool {
        let mut changed = self.deliver();
        for slot in self.world.slots.ids() {
            let first = self.first[slot];
            if !self.slots[first].is_changed && slot.index() < self.overall.len() {
                continue;
            }
            let overall = match first == slot {
                true => self.overall(slot),
                false => self.overall[first].clone(),
            };
            if overall != self.overall[slot] {
                if overall.params != self.overall[slot].params {
                    // Its own expressions read the parameters.
                    self.slots[slot].configurations.values_mut().for_each(|g| g.is_new = true);
                }
                self.overall[slot] = overall;
                self.joined.forget();
                changed = true;
            }
        }
        for slot in self.slots.iter_mut() {
            slot.is_changed = false;
        }
        for (slot, overall) in self.overall.pairs() {
            for space in &overall.spaces {
                self.scene.prepare(self.scene.of[slot], *space);
            }
        }
        changed
    }

    /// Steps until nothing new is found.
    pub fn run(&mut self) {
        // The guards of links read the instances of the world.
        let is_guarded = self.world.spaces.iter().any(|space| space.links.iter().any(|link| link.guard.is_some()));
        let reads_others =
            |entity: &Entity| reads_others(self.program, entity) || (is_guarded && !entity.follows.is_empty());
        let of: IdVec<EntityId, bool> = self.program.entities.iter().map(|entity| reads_others(entity)).collect();
        let reads_others: IdVec<SlotId, bool> = self.world.slots.iter().map(|slot| of[slot.entity]).collect();
        let firsts: Vec<SlotId> = self.world.slots.ids().filter(|s| self.is_first(*s)).collect();
        let mut others_changed = true;
        if self.effort == 0 {
            return self.give_all_up();
        }
        for round in 0.. {
            let before = std::mem::replace(&mut self.surroundings, Surroundings::new(&mut self.scene, &self.overall));
            let mut changed = false;
            for &slot in &firsts {
                let same = round > 0 && self.surroundings.of(slot) == before.of(slot);
                if !same || (others_changed && reads_others[slot]) {
                    self.slots[slot].configurations.values_mut().for_each(|g| g.is_new = true);
                }
                changed |= self.iterate_slot(slot);
            }
            changed |= self.mark_destroyable();
            others_changed = self.publish();
            // After a stop, the absence of changes means nothing.
            self.is_stopped |= self.scene.meter.is_stopped();
            if self.effort == 0 || self.is_stopped {
                self.give_all_up();
                return;
            }
            if !changed && !others_changed {
                break;
            }
        }
        self.is_narrowing = true;
        for _ in 0..NARROWINGS {
            self.narrow();
            self.is_stopped |= self.scene.meter.is_stopped();
            if self.is_stopped {
                self.give_all_up();
                return;
            }
        }
    }

    /// Gives up all slots.
    fn give_all_up(&mut self) {
        let why = if self.is_stopped { GivenUp::Stopped } else { GivenUp::Budget };
        let firsts: Vec<SlotId> = self.world.slots.ids().filter(|s| self.is_first(*s)).collect();
        firsts.into_iter().for_each(|slot| self.give_up(slot, why));
        self.publish();
    }

    /// Gives up a slot and all slots that it can spawn: everything is possible for them.
    fn give_up(&mut self, slot: SlotId, why: GivenUp) {
        let known = &mut self.slots[slot];
        if std::mem::replace(&mut known.is_given_up, true) {
            return;
        }
        known.why = Some(why);
        known.is_changed = true;
        self.scene.activate_all(self.scene.of[slot]);
        for spawn in self.entity(slot).spawns.iter() {
            let made = |s: &SlotId| {
                let s = &self.world.slots[*s];
                s.entity == spawn.entity && s.origin != Origin::Named
            };
            let made: Vec<SlotId> = self.world.slots.ids().filter(made).map(|s| self.first[s]).collect();
            for slot in made {
                // The spawner determines its parameters.
                let params: IdVec<ParamId, Values> = self.slots[slot].params.iter().map(|_| Values::all()).collect();
                if self.slots[slot].params != params {
                    self.scene.reshape(slot, &params);
                    self.slots[slot].params = params;
                    self.slots[slot].is_changed = true;
                }
                self.give_up(slot, why);
            }
        }
    }

    /// Steps a slot until nothing new is found, while all others stay fixed.
    fn iterate_slot(&mut self, slot: SlotId) -> bool {
        let mut changed = false;
        while self.effort > 0 {
            // A space must be published before the obstacles in it are known.
            let published = &self.overall[slot].spaces;
            let known = self.slots[slot].configurations.iter();
            let new = known.filter(|(_, g)| g.is_new && g.at.spaces.is_subset(published));
            let due: Vec<Key> = new.map(|(key, _)| key.clone()).collect();
            if due.is_empty() {
                break;
            }
            for key in due {
                if self.watch.stop() {
                    self.is_stopped = true;
                    self.effort = 0;
                    return true;
                }
                // The current value: the keys before this one may have added to it.
                let published = &self.overall[slot].spaces;
                let growing = self.slots[slot].configurations.get_mut(&key);
                let Some(growing) = growing.filter(|g| g.at.spaces.is_subset(published)) else { continue };
                growing.is_new = false;
                let at = growing.at.clone();
                match self.stepper(slot).run(&at) {
                    Some(outcome) => {
                        self.effort = self.effort.saturating_sub(outcome.next.len() + 1);
                        changed |= self.take(slot, &key, outcome);
                    }
                    None => {
                        self.give_up(slot, GivenUp::Combinations);
                        return true;
                    }
                }
            }
        }
        changed
    }

    /// The context in which expressions of an instance or of the world are evaluated.
    pub fn reader<'s>(&'s self, me: Option<(SlotId, &'s Configuration)>) -> Reader<'s> {
        Reader {
            program: self.program,
            world: self.world,
            slots: &self.overall,
            joined: &self.joined,
            surroundings: &self.surroundings,
            received: &self.received,
            pinned: None,
            me,
            tested: None,
            member: None,
            phase: Phase::Discrete,
        }
    }

    pub fn stepper(&self, slot: SlotId) -> Stepper<'_> {
        let reader = self.reader(None);
        let flow_groups = self.scene.flow_groups[self.world.slots[slot].entity].as_deref();
        let motion_edges = &self.scene.motion_edges[self.world.slots[slot].entity];
        let collider_groups = &self.scene.collider_groups[self.world.slots[slot].entity];
        let collider_groups = self.surroundings.has_bounded_pushes(slot).then_some(collider_groups.as_slice());
        Stepper {
            reader,
            scene: &self.scene,
            slot,
            collider_groups,
            step: self.world.step.seconds(),
            flow_groups,
            motion_edges,
            grids: None,
        }
    }

    pub fn take(&mut self, slot: SlotId, from: &Key, outcome: Outcome) -> bool {
        let mut changed = false;
        for next in outcome.next {
            changed |= self.grow(slot, next, Some(from));
        }
        if outcome.can_end && !self.slots[slot].can_be_absent {
            self.slots[slot].can_be_absent = true;
            self.slots[slot].is_changed = true;
            changed = true;
        }
        for (spawn, at) in outcome.spawns {
            changed |= self.spawn(slot, spawn, &at);
        }
        for (send, value) in outcome.sends {
            changed |= self.slots[slot].sent.add(send, value);
        }
        let known = &mut self.slots[slot];
        let speeds = known.speed.iter_mut().chain(&mut known.near_speed);
        for (old, speed) in speeds.zip(outcome.speed.into_iter().chain(outcome.near_speed)) {
            // It grows with velocities, which are widened.
            if speed > *old {
                *old = speed;
                changed = true;
                known.is_changed = true;
            }
        }
        for (old, at) in known.contact.iter_mut().zip(&outcome.contact) {
            if !at.is_within(old) {
                *old = old.or(at);
                changed = true;
                known.is_changed = true;
            }
        }
        for at in outcome.mid_step.iter().filter(|_| self.is_read) {
            let is_more = known.mid_step.add(at);
            known.is_changed |= is_more;
            changed |= is_more;
        }
        if !outcome.spaces.is_subset(&known.entered) {
            known.entered.extend(outcome.spaces);
            known.is_changed = true;
            changed = true;
        }
        for placement in outcome.placements {
            changed |= self.place(slot, &placement);
        }
        let number = self.scene.of[slot];
        for leaves in outcome.activated {
            changed |= self.scene.activate(number, &leaves);
        }
        let kind = &mut self.scene.kinds[number];
        changed |= outcome.appears && !kind.appears;
        kind.appears |= outcome.appears;
        changed
    }

    /// Places an instance; returns true if the position is new, or if the instance can newly overlap something that
    /// pushes it.
    pub fn place(&mut self, slot: SlotId, placement: &Placement) -> bool {
        let kind = self.scene.of[slot];
        let mut changed = false;
        for space in placement.spaces.iter() {
            let (is_put, is_new) = match placement.colliders {
                PlacedColliders::All | PlacedColliders::While(_) => (true, false),
                PlacedColliders::One { was_unblocked, .. } => (was_unblocked, true),
            };
            changed |= is_put && self.scene.seed(kind, *space, placement.at);
            changed |= is_new && self.scene.seed_collider(kind, *space, placement.at);
        }
        if self.scene.kinds[kind].can_be_inside {
            return changed;
        }
        let inside = placement.spaces.iter().any(|space| self.scene.is_inside(kind, *space, placement));
        self.scene.kinds[kind].can_be_inside = inside;
        changed || inside
    }

    pub fn finish(mut self) -> ConfigurationSpace {
        let slots = self.world.slots.ids().map(|slot| {
            let found = &self.slots[self.first[slot]];
            SlotSpace {
                configurations: found.configurations.values().map(|g| g.at.clone()).collect(),
                can_be_absent: found.can_be_absent,
                is_given_up: found.is_given_up,
                why: found.why,
            }
        });
        let slots: IdVec<SlotId, SlotSpace> = slots.collect();
        let surroundings = match slots.iter().all(|s| s.is_given_up) {
            true => Surroundings::unknown(&self.overall),
            false => Surroundings::new(&mut self.scene, &self.overall),
        };
        let received = self.received;
        ConfigurationSpace {
            slots,
            overall: self.overall,
            joined: Joined::default(),
            surroundings,
            received,
            finer: None,
        }
    }
}

/// Whether instances of an entity read others.
fn reads_others(program: &Program, entity: &Entity) -> bool {
    let mut code = (entity.code.from.0..entity.code.to.0).map(ExprId);
    !entity.refs.is_empty()
        || entity.touches.iter().any(|t| t.bound)
        || code.any(|id| {
            let expr = &program.exprs[id];
            matches!(expr, Expr::Probe { .. } | Expr::Count { .. } | Expr::Nearest { .. } | Expr::Broken(_))
        })
}

/// Restricts discrete variables to their bounds.
fn cut(at: &mut Configuration, limits: &IdVec<DiscreteId, Values>) {
    for (id, limit) in limits.pairs() {
        if !at.discretes[id].is_within(limit) {
            at.discretes[id] = at.discretes[id].and(limit);
        }
    }
}

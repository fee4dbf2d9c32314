//! Which instances can take part in what a question asks, and a world without the others.
//!
//! An instance takes part if it is a player, if the question reads it, or if it can act on one that does: by a value
//! that is read, a blocking contact, a signal, a spawn, a destruction, a reference. What is left then acts on those
//! that take part in one way only: a contact query of theirs holds because of it. Leaving the others out and letting
//! these queries hold or not ([`super::free`]) therefore loses no run: each run of the world, seen from the instances
//! that take part, is a run of the world without the others.

use crate::ir::{
    Edge, Entity, EntityId, Expr, ExprId, Follow, IdVec, Origin, Program, Push, RefValue, SlotId, Subject, TagSet,
    Touch, TouchId, World, WorldId,
};

/// The instances of a world that take part in something.
pub(super) struct Independence<'a> {
    program: &'a Program,
    world: &'a World,
    pub takes_part: IdVec<SlotId, bool>,
}

impl<'a> Independence<'a> {
    /// Those that can act on some instances, and these.
    pub fn new(program: &'a Program, world: &'a World, roots: impl Iterator<Item = SlotId>) -> Self {
        let takes_part = world.slots.iter().map(|_| false).collect();
        let mut found = Independence { program, world, takes_part };
        roots.for_each(|slot| found.takes_part[slot] = true);
        let mut count = 0;
        loop {
            found.grow();
            let now = found.takes_part.iter().filter(|takes| **takes).count();
            if now == count {
                return found;
            }
            count = now;
        }
    }

    /// The slots that some expressions of the world read.
    pub fn read_by(program: &Program, world: &World, predicates: Vec<ExprId>) -> Vec<SlotId> {
        let mut slots = Vec::new();
        for id in program.with_operands(predicates) {
            match program.exprs[id] {
                Expr::Alive(slot) => slots.push(slot),
                Expr::Count { of, .. } | Expr::Nearest { of, .. } => {
                    slots.extend(world.slots.pairs().filter(|(_, slot)| slot.entity == of).map(|(id, _)| id));
                }
                expr => {
                    if let Some(Subject::Slot(slot)) = expr.subject() {
                        slots.push(slot);
                    }
                }
            }
        }
        slots
    }

    fn entity(&self, slot: SlotId) -> EntityId {
        self.world.slots[slot].entity
    }

    /// Entities with instances that take part, or that do not.
    fn entities(&self, take_part: bool) -> Vec<EntityId> {
        let slots = self.takes_part.pairs().filter(|(_, takes)| **takes == take_part);
        let mut entities: Vec<EntityId> = slots.map(|(slot, _)| self.entity(slot)).collect();
        entities.sort_unstable();
        entities.dedup();
        entities
    }

    /// Adds all instances of entities.
    fn add(&mut self, is_added: impl Fn(EntityId) -> bool) {
        for (slot, of) in self.world.slots.pairs() {
            self.takes_part[slot] |= is_added(of.entity);
        }
    }

    fn grow(&mut self) {
        let program = self.program;
        for me in self.entities(true) {
            for subject in self.read_subjects(me) {
                self.add_subject(me, subject);
            }
            let entity = &program.entities[me];
            // What it acts on must be clear: an instance that takes part is not mistaken for one that does not.
            for subject in acted_on(entity) {
                let inside = self.entities(true);
                if inside.iter().any(|other| program.can_be(me, subject, *other)) {
                    self.add_subject(me, subject);
                }
            }
            for spawn in entity.spawns.iter() {
                self.add(|entity| entity == spawn.entity);
            }
        }
        let inside = self.entities(true);
        for other in self.entities(false) {
            if self.acts_on(other, &inside) {
                self.add(|entity| entity == other);
            }
        }
        self.add_blocking();
    }

    fn add_subject(&mut self, me: EntityId, subject: Subject) {
        let program = self.program;
        match subject {
            Subject::Me => {}
            Subject::Slot(slot) => self.takes_part[slot] = true,
            Subject::Ref(_) | Subject::Touched(_) | Subject::Probed(_) | Subject::Member(_) => {
                self.add(|other| program.can_be(me, subject, other));
            }
        }
    }

    /// The subjects that an entity reads.
    fn read_subjects(&mut self, me: EntityId) -> Vec<Subject> {
        let entity = self.program.entities[me].clone();
        let mut subjects = Vec::new();
        for id in entity.code.ids() {
            match self.program.exprs[id] {
                Expr::Alive(slot) => subjects.push(Subject::Slot(slot)),
                Expr::Count { of, .. } | Expr::Nearest { of, .. } => subjects.push(Subject::Member(of)),
                Expr::Probe { other, .. } => {
                    let tags = TagSet::of(other);
                    let program = self.program;
                    self.add(|of| program.entities[of].colliders.iter().any(|c| c.tags.meets(tags)));
                }
                expr => subjects.extend(expr.subject()),
            }
        }
        let needs = entity.edges.iter().flat_map(|edge: &Edge| &edge.needs);
        let needs = needs.chain(entity.follows.iter().flat_map(|follow: &Follow| &follow.needs));
        subjects.extend(needs.map(|reference| Subject::Ref(*reference)));
        subjects
    }

    /// Whether an entity acts on instances of some others otherwise than by a contact.
    fn acts_on(&self, other: EntityId, inside: &[EntityId]) -> bool {
        let (program, entity) = (self.program, &self.program.entities[other]);
        let destroyed = program.destroyed_by(other, |subject| subject != Subject::Me);
        // A tile that breaks, breaks for all.
        let breaks = self.world.layout.tiles.is_some()
            && (entity
                .action_lists()
                .any(|actions| actions.destroys.iter().any(|of| *of != RefValue::Of(Subject::Me))));
        breaks
            || inside.iter().any(|entity| destroyed[*entity])
            || entity.spawns.iter().any(|spawn| inside.contains(&spawn.entity))
            || entity.sends.iter().any(|send| inside.contains(&send.entity))
    }

    /// Adds instances that can push or carry one that takes part.
    fn add_blocking(&mut self) {
        let (program, world) = (self.program, self.world);
        for me in self.entities(true) {
            for mine in program.entities[me].colliders.iter() {
                let blocks = |theirs: TagSet| {
                    world.meeting(mine.tags, theirs).is_some_and(|meeting| {
                        let response = meeting.response;
                        response.carry || (response.push != Push::Sense && !mine.kinematic)
                    })
                };
                self.add(|other| program.entities[other].colliders.iter().any(|theirs| blocks(theirs.tags)));
            }
        }
    }

    /// Whether an instance can come to be while the world runs.
    pub fn is_spawned(&self, entity: EntityId) -> bool {
        let mut slots = self.world.slots.iter();
        let is_free = self.world.slots.iter().any(|slot| slot.entity == entity && slot.origin == Origin::Free);
        is_free || slots.any(|slot| self.program.entities[slot.entity].spawns.iter().any(|s| s.entity == entity))
    }

    /// The contact queries of an instance that others can satisfy, each with the entities of those; `is_other` tells
    /// who they are.
    pub fn touched_by(&self, me: EntityId, is_other: impl Fn(SlotId) -> bool) -> Vec<(TouchId, Touch, Vec<EntityId>)> {
        let entity = &self.program.entities[me];
        let mut others: Vec<EntityId> =
            self.world.slots.ids().filter(|s| is_other(*s)).map(|s| self.entity(s)).collect();
        others.sort_unstable();
        others.dedup();
        let meets = |touch: &Touch, other: EntityId| {
            let mine = || entity.colliders.iter().filter(|c| c.tags.meets(touch.mine));
            let theirs = self.program.entities[other].colliders.iter();
            let mut theirs = theirs.filter(|c| c.tags.meets(TagSet::of(touch.other)));
            theirs.any(|theirs| mine().any(|mine| self.world.meeting(mine.tags, theirs.tags).is_some()))
        };
        let by = |touch: &Touch| others.iter().copied().filter(|other| meets(touch, *other)).collect::<Vec<_>>();
        let all = entity.touches.pairs().map(|(id, touch)| (id, *touch, by(touch)));
        all.filter(|(.., by)| !by.is_empty()).collect()
    }
}

/// The subjects that an entity destroys, signals to, or refers to from then on.
fn acted_on(entity: &Entity) -> Vec<Subject> {
    let mut subjects = Vec::new();
    let of = |value: &RefValue| match value {
        RefValue::Of(subject) => Some(*subject),
        RefValue::None => None,
    };
    for actions in entity.action_lists() {
        subjects.extend(actions.destroys.iter().filter_map(of));
        subjects.extend(actions.refs.iter().filter_map(|update| of(&update.value)));
    }
    for spawn in entity.spawns.iter() {
        subjects.extend(spawn.refs.iter().filter_map(|update| of(&update.value)));
    }
    subjects.extend(entity.sends.iter().filter_map(|send| send.to));
    subjects
}

/// A program whose world has some instances only; `ids` are the new ids of these.
pub(super) fn without_others(
    program: &Program,
    world: WorldId,
    takes_part: &IdVec<SlotId, bool>,
) -> (Program, Renumbered) {
    let old = &program.worlds[world];
    let mut count = 0;
    let number = |takes: &bool| {
        count += u32::from(*takes);
        takes.then(|| SlotId(count - 1))
    };
    let ids = Renumbered(takes_part.iter().map(number).collect());
    let mut new = (**old).clone();
    let kept = old.slots.pairs().filter(|(slot, _)| takes_part[*slot]);
    new.slots = kept
        .map(|(_, slot)| {
            let mut slot = slot.clone();
            slot.refs = slot.refs.iter().map(|to| to.and_then(|to| ids.get(to))).collect();
            slot
        })
        .collect();
    let players = old
        .players
        .iter()
        .filter_map(|player| Some(crate::ir::Player { slot: ids.get(player.slot)?, ..player.clone() }));
    new.players = players.collect();
    let mut changed = Program::clone(program);
    changed.exprs = program.exprs.iter().map(|expr| ids.expr(*expr)).collect();
    new.lay_out(&changed);
    let worlds = program.worlds.pairs().map(|(id, of)| if id == world { new.clone().into() } else { of.clone() });
    changed.worlds = worlds.collect();
    (changed, ids)
}

/// The ids of instances after others were left out.
pub(super) struct Renumbered(IdVec<SlotId, Option<SlotId>>);

impl Renumbered {
    /// The new id, if it is still there.
    pub fn get(&self, slot: SlotId) -> Option<SlotId> {
        self.0.get(slot).copied().flatten()
    }

    /// An expression about instances with their new ids; one about an instance that is not there is not evaluated.
    fn expr(&self, expr: Expr) -> Expr {
        let of = |subject: Subject| match subject {
            Subject::Slot(slot) => self.get(slot).map(Subject::Slot),
            other => Some(other),
        };
        let changed = match expr {
            Expr::Param(s, id) => of(s).map(|s| Expr::Param(s, id)),
            Expr::Var(s, id, degree) => of(s).map(|s| Expr::Var(s, id, degree)),
            Expr::Discrete(s, id) => of(s).map(|s| Expr::Discrete(s, id)),
            Expr::Touching(s, id) => of(s).map(|s| Expr::Touching(s, id)),
            Expr::IsNone(s) => of(s).map(Expr::IsNone),
            Expr::Is(s, id) => of(s).map(|s| Expr::Is(s, id)),
            Expr::InMode(s, id) => of(s).map(|s| Expr::InMode(s, id)),
            Expr::InSpace(s, id) => of(s).map(|s| Expr::InSpace(s, id)),
            Expr::Near { of: s, x, y, radius } => of(s).map(|of| Expr::Near { of, x, y, radius }),
            Expr::Distance { of: s, x, y } => of(s).map(|of| Expr::Distance { of, x, y }),
            Expr::Alive(slot) => self.get(slot).map(Expr::Alive),
            other => Some(other),
        };
        changed.unwrap_or(Expr::Bool(false))
    }
}

//! Which instances never move. Where a world has many of them, a state holds only what of them can vary, and a step
//! looks only at those that something touches.

use super::{
    Drive, Entity, EntityId, Expr, ExprId, IdVec, Place, Program, Slot, SlotId, Subject, TagSet, VarId, World,
};

/// The least number of instances that never move for which a world treats them apart.
pub const MANY_STILL: usize = 16;

impl Program {
    /// For each slot of a world, whether its instance never moves, is always in the same space and has colliders of a
    /// constant shape; no slot if there are fewer than [`MANY_STILL`] of them.
    ///
    /// Such an instance is the only one that ever takes its slot, its variables rest and nothing sets, bounds or pushes
    /// them, it can neither ride, follow links nor be brought across a seam, and it meets no slope.
    pub fn still_slots(&self, world: &World) -> IdVec<SlotId, bool> {
        let mut can_rest: IdVec<EntityId, Option<bool>> = self.entities.iter().map(|_| None).collect();
        let others = tags_of_others(self, world);
        let mut is_still = |slot: &Slot| {
            let entity = &self.entities[slot.entity];
            *can_rest[slot.entity].get_or_insert_with(|| self.can_rest(entity, world, &others))
                && self.rests(entity, slot, world)
        };
        let still: IdVec<SlotId, bool> = world.slots.iter().map(&mut is_still).collect();
        if still.iter().filter(|is| **is).count() < MANY_STILL {
            return still.iter().map(|_| false).collect();
        }
        still
    }

    /// Whether nothing but flows can change the position of an instance of an entity.
    fn can_rest(&self, entity: &Entity, world: &World, others: &[TagSet]) -> bool {
        let is_set = |place: Place| matches!(place, Place::Var(..));
        let sets = entity.action_lists().any(|actions| actions.updates.iter().any(|update| is_set(update.place)));
        // Being pushed or carried depends on the rules only.
        let is_moved = |mine: TagSet| {
            let mut meetings = others.iter().filter_map(|other| world.meeting(mine, *other));
            meetings.any(|meeting| meeting.response.moves())
        };
        let mut colliders = entity.colliders.iter();
        entity.envelopes.is_empty()
            && entity.clamps.is_empty()
            && entity.follows.is_empty()
            && !sets
            && colliders
                .all(|c| (c.kinematic || !is_moved(c.tags)) && c.guard.is_none_or(|guard| self.is_of_modes(guard)))
    }

    /// Whether the guard of a collider reads nothing but the modes of its own instance.
    fn is_of_modes(&self, guard: ExprId) -> bool {
        match self.exprs[guard] {
            Expr::InMode(Subject::Me, _) | Expr::Bool(_) => true,
            Expr::Not(a) => self.is_of_modes(a),
            Expr::And(a, b) | Expr::Or(a, b) => self.is_of_modes(a) && self.is_of_modes(b),
            _ => false,
        }
    }

    /// Whether the variables of a slot's only instance are at rest, whatever its modes, and its shapes are constant.
    fn rests(&self, entity: &Entity, slot: &Slot, world: &World) -> bool {
        let constant = |id: ExprId| self.constant(id, &slot.params, world.step);
        let keeps = |drive: &Drive| match *drive {
            Drive::Coast(_) => true,
            Drive::Flow { var, degree: 0, value } => constant(value) == Some(slot.vars[var][0]),
            Drive::Flow { value, .. } => constant(value) == Some(0.0),
            Drive::Envelope(..) => false,
        };
        slot.is_fixed
            && slot.player.is_none()
            && slot.vars.len() >= VarId::XY.len()
            && !world.spaces[slot.space].wraps()
            && !meets_slopes(entity, slot, world)
            && slot.vars.iter().all(|[_, velocity, acceleration]| *velocity == 0.0 && *acceleration == 0.0)
            && entity.free.iter().chain(entity.leaves.iter().flat_map(|leaf| &leaf.drives)).all(keeps)
            && entity.colliders.iter().all(|c| c.shape.sides(constant).is_some())
    }
}

/// Whether a rule pairs a collider of a slot with a slope of its space.
fn meets_slopes(entity: &Entity, slot: &Slot, world: &World) -> bool {
    let kinds = world.spaces[slot.space].map.iter().flat_map(|map| &map.kinds);
    let mut slopes = kinds.filter(|kind| kind.slope.is_some()).map(|kind| kind.tags.iter().copied().collect());
    slopes.any(|tags: TagSet| entity.colliders.iter().any(|c| world.meeting(c.tags, tags).is_some()))
}

/// The sets of tags that a collider can meet in a world.
fn tags_of_others(program: &Program, world: &World) -> Vec<TagSet> {
    let mut entities: Vec<EntityId> = world.slots.iter().map(|slot| slot.entity).collect();
    entities.sort_unstable();
    entities.dedup();
    let colliders = entities.iter().flat_map(|id| program.entities[*id].colliders.iter());
    let mut all: Vec<TagSet> = colliders.map(|collider| collider.tags).collect();
    for space in world.spaces.iter() {
        all.extend(space.solids.iter().map(|solid| solid.tags));
        let kinds = space.map.iter().flat_map(|map| &map.kinds);
        all.extend(kinds.map(|kind| kind.tags.iter().copied().collect::<TagSet>()));
    }
    all.sort_unstable();
    all.dedup();
    all
}

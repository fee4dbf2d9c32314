//! Lowers worlds: predicates, slots with their initial values, the layout.

use crate::ir::{
    Bounds, Collide, EntityId, ExprId, GoalId, IdVec, Layout, Limit, Link, NeverId, Origin, Player, PlayerId,
    Predicate, Program, Slot, SlotId, Solid, Space, SpaceId, Step, TagId, TagSet, TileKind, World, WorldSpans,
};
use crate::sema::checked;

use super::term::Context;

/// The predicates of a world, lowered.
pub(super) struct Predicates {
    goals: IdVec<GoalId, Predicate>,
    nevers: IdVec<NeverId, Predicate>,
    /// For each space, the guards of its links.
    links: IdVec<SpaceId, Vec<Option<ExprId>>>,
}

/// Lowers `goal` and `never`; this may add contact queries to entities.
pub(super) fn predicates(
    program: &mut Program,
    w: &checked::World,
    destructible: &IdVec<EntityId, bool>,
) -> Predicates {
    let entity_of = |slot: SlotId| w.instances[slot].entity;
    let indestructible =
        |slot: SlotId| w.instances[slot].origin == Origin::Named && !destructible[w.instances[slot].entity];
    let tiles = |tag| tiles(w, tag);
    let context = Context { me: None, slots: &entity_of, indestructible: &indestructible, tiles: Some(&tiles) };
    let mut lowered = |q: &checked::Question| Predicate {
        name: q.name.text.to_string(),
        holds: program.term(&q.predicate, &context),
    };
    let goals = w.goals.iter().map(&mut lowered).collect();
    let nevers = w.nevers.iter().map(&mut lowered).collect();
    let mut links = IdVec::new();
    for space in w.spaces.iter() {
        let guards = space.links.iter().map(|l| l.guard.as_ref().map(|g| program.term(g, &context)));
        links.push(guards.collect());
    }
    Predicates { goals, nevers, links }
}

/// The number of tiles of a world with a tag, and whether any of them can be broken.
fn tiles(w: &checked::World, tag: TagId) -> (usize, bool) {
    let maps = || w.spaces.iter().filter_map(|space| space.map.as_ref());
    let count = |can_break: bool| {
        let is_counted = |kind: &TileKind<TagId>| kind.tags.contains(&tag) && (!can_break || kind.breakable.is_some());
        maps().map(|map| map.count(is_counted)).sum()
    };
    let all: usize = count(false);
    (all, count(true) > 0)
}

/// For each entity, whether anything may destroy an instance of it.
pub(super) fn destructible(program: &Program) -> IdVec<EntityId, bool> {
    let mut destructible: IdVec<EntityId, bool> = program.entities.iter().map(|_| false).collect();
    // Most entities destroy nothing.
    let destroys = |id: &EntityId| program.entities[*id].action_lists().any(|actions| !actions.destroys.is_empty());
    for by in program.entities.ids().filter(destroys) {
        for (other, is_destroyed) in program.destroyed_by(by, |_| true).pairs() {
            destructible[other] |= is_destroyed;
        }
    }
    destructible
}

/// Lowers a world; all contact queries must be known.
pub(super) fn lower(program: &mut Program, w: &checked::World, predicates: Predicates) {
    let step = Step { numerator: w.step.0, denominator: w.step.1 };
    let players: IdVec<PlayerId, Player> =
        w.players.iter().map(|p| Player { number: p.number, slot: p.slot }).collect();
    let spawned = |entity: EntityId| program.entities.iter().any(|e| e.spawns.iter().any(|s| s.entity == entity));
    let is_fixed = |i: &checked::Instance| match i.origin {
        Origin::Named => true,
        Origin::Tile => !spawned(i.entity),
        Origin::Free => false,
    };
    let slots: IdVec<SlotId, Slot> = w
        .instances
        .pairs()
        .map(|(id, instance)| Slot {
            name: instance.name.text.to_string(),
            origin: instance.origin,
            is_fixed: is_fixed(instance),
            entity: instance.entity,
            space: instance.space,
            player: players.find(|p| p.slot == id),
            params: instance.params.clone(),
            vars: instance.vars.clone(),
            discretes: instance.discretes.clone(),
            refs: instance.refs.clone(),
            // The parameters of a reusable slot are not known.
            timer_limits: program.timer_limits(instance.entity, is_fixed(instance).then_some(&instance.params), step),
        })
        .collect();
    let spaces = w.spaces.iter().zip(predicates.links.iter()).map(|(s, links)| space(s, links)).collect();
    let collide = w
        .collide
        .iter()
        .map(|c| Collide {
            left: c.left.iter().copied().collect::<TagSet>(),
            right: c.right.iter().copied().collect::<TagSet>(),
            response: c.response,
        })
        .collect();
    program.spans.worlds.push(WorldSpans {
        name: w.name.span,
        spaces: w.spaces.iter().map(|s| s.name.span).collect(),
        solids: w.spaces.iter().map(|s| s.solids.iter().map(|x| x.span).collect()).collect(),
        links: w.spaces.iter().map(|s| s.links.iter().map(|l| l.span).collect()).collect(),
        slots: w.instances.iter().map(|i| i.span).collect(),
        players: w.players.iter().map(|p| p.span).collect(),
        goals: w.goals.iter().map(|g| g.name.span).collect(),
        nevers: w.nevers.iter().map(|n| n.name.span).collect(),
    });
    let mut world = World {
        name: w.name.text.to_string(),
        step,
        spaces,
        slots,
        players,
        collide,
        limits: w.limits.iter().map(|(entity, count)| Limit { entity: *entity, count: *count }).collect(),
        goals: predicates.goals,
        nevers: predicates.nevers,
        open: w.open,
        layout: Layout::default(),
    };
    world.layout = Layout::new(program, &world);
    program.worlds.push(world.into());
}

fn space(s: &checked::Space, guards: &[Option<ExprId>]) -> Space {
    Space {
        name: s.name.text.to_string(),
        map: s.map.clone(),
        solids: s
            .solids
            .iter()
            .map(|solid| Solid { tags: solid.tags.iter().copied().collect(), bounds: Bounds::new(solid.rect) })
            .collect(),
        bounds: s.bounds.map(Bounds::new),
        periods: s.periods(),
        links: s
            .links
            .iter()
            .zip(guards)
            .map(|(l, guard)| Link { from: Bounds::new(l.from), space: l.space, to: Bounds::new(l.to), guard: *guard })
            .collect(),
    }
}

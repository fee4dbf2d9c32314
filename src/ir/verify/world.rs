//! Verifies a world: instances fit their entities, maps their kinds of tiles, and the layout follows from them.

use crate::ir::{
    Bounds, Collide, Domain, Layout, Link, MAX_COLLIDE_LINES, MAX_INSTANCES, Origin, Player, Program, Slot, Solid,
    Space, TagId, TileMap, World, WorldId, WorldSpans,
};

use super::code::{Code, Facts, Owner};
use super::{At, Checked, each, each_of, ensure, exists, finite, same, tags};

pub(super) fn verify(program: &Program, code: &Code<'_>, id: WorldId, world: &World) -> Checked {
    let World { name: _, step, spaces, slots, players, collide, limits, goals, nevers, open, layout } = world;
    let expr = |e| code.check(Owner::World(id), e, &mut Facts::new());
    ensure(step.numerator > 0 && step.denominator > 0, "a step takes time").at("step")?;
    ensure(slots.len() <= MAX_INSTANCES, "there are more than a state can number").at("slots")?;
    ensure(slots.is_empty() || !spaces.is_empty(), "instances are in spaces").at("spaces")?;
    open.map_or(Ok(()), |space| exists(space, spaces)).at("open")?;
    each("players", players, |player, Player { number: _, slot }| {
        exists(*slot, slots).at("slot")?;
        ensure(slots[*slot].player == Some(player), "the instance is another player's").at("slot")
    })?;
    each("slots", slots, |_, slot| self::slot(program, world, slot))?;
    each("spaces", spaces, |_, space| {
        let Space { name: _, map, solids, bounds, periods: _, links } = space;
        map.as_ref().map_or(Ok(()), |map| self::map(program, map)).at("map")?;
        bounds.map_or(Ok(()), rectangle).at("bounds")?;
        wraps(space).at("periods")?;
        each_of("solids", solids, |Solid { tags: of, bounds }| {
            tags(*of, program).at("tags")?;
            rectangle(*bounds).at("bounds")
        })?;
        each_of("links", links, |Link { from, space, to, guard }| {
            exists(*space, spaces).at("space")?;
            rectangle(*from).at("from")?;
            rectangle(*to).at("to")?;
            ensure(from.left < from.right && from.bottom < from.top, "it has no inside").at("from")?;
            guard.map_or(Ok(()), expr).at("guard")
        })
    })?;
    ensure(collide.len() <= MAX_COLLIDE_LINES, "there are more than a world can have").at("collide")?;
    each_of("collide", collide, |Collide { left, right, response: _ }| {
        tags(*left, program).at("left")?;
        tags(*right, program).at("right")
    })?;
    each_of("limits", limits, |limit| {
        exists(limit.entity, &program.entities).at("entity")?;
        let of_it = limits.iter().filter(|other| other.entity == limit.entity).count();
        ensure(of_it == 1, "the entity has another one").at("entity")
    })?;
    each("goals", goals, |_, goal| expr(goal.holds).at("holds"))?;
    each("nevers", nevers, |_, never| expr(never.holds).at("holds"))?;
    let is_laid_out = *layout == Layout::new(program, world);
    ensure(is_laid_out, "it is not the one that follows from the slots and the players").at("layout")?;
    spans(world, &program.spans.worlds[id]).at("spans")
}

fn slot(program: &Program, world: &World, slot: &Slot) -> Checked {
    let Slot { name: _, origin, is_fixed, entity, space, player, params, vars, discretes, refs, timer_limits } = slot;
    exists(*entity, &program.entities).at("entity")?;
    exists(*space, &world.spaces).at("space")?;
    player.map_or(Ok(()), |player| exists(player, &world.players)).at("player")?;
    let of = &program.entities[*entity];
    same(params.len(), of.params.len()).at("params")?;
    params.iter().try_for_each(|value| finite(&[*value])).at("params")?;
    same(vars.len(), of.vars.len()).at("vars")?;
    vars.iter().try_for_each(|values| finite(values)).at("vars")?;
    same(discretes.len(), of.discretes.len()).at("discretes")?;
    let fits = |(value, discrete): (&i32, &crate::ir::Discrete)| match &discrete.domain {
        Domain::Int | Domain::Bool | Domain::Set(_) => (discrete.range.0..=discrete.range.1).contains(value),
    };
    ensure(discretes.iter().zip(of.discretes.iter()).all(fits), "a value is out of its range").at("discretes")?;
    same(refs.len(), of.refs.len()).at("refs")?;
    each("refs", refs, |id, to| {
        let Some(to) = *to else { return Ok(()) };
        exists(to, &world.slots)?;
        ensure(of.refs[id].entity.is_none_or(|may| may == world.slots[to].entity), "it refers to others")
    })?;
    let is_spawned = program.entities.iter().any(|e| e.spawns.iter().any(|spawn| spawn.entity == *entity));
    let keeps = match origin {
        Origin::Named => true,
        Origin::Tile => !is_spawned,
        Origin::Free => false,
    };
    ensure(*is_fixed == keeps, "it does not follow from where instances come from").at("is_fixed")?;
    let limits = program.timer_limits(*entity, is_fixed.then_some(params), world.step);
    ensure(*timer_limits == limits, "they do not follow from what timers are compared with").at("timer_limits")
}

fn map(program: &Program, map: &TileMap<TagId>) -> Checked {
    let TileMap { columns, rows, tile, kinds, cells } = map;
    finite(&[tile.0, tile.1]).at("tile")?;
    ensure(tile.0 > 0.0 && tile.1 > 0.0, "a tile has a size").at("tile")?;
    ensure(columns.checked_mul(*rows) == Some(cells.len()), "there is not a tile for each column and row")
        .at("cells")?;
    ensure(cells.iter().all(|kind| usize::from(*kind) < kinds.len()), "a tile is of no kind").at("cells")?;
    each_of("kinds", kinds, |kind| {
        let is_at_once = kind.breakable.is_some_and(|breakable| breakable.restore == Some(0));
        ensure(!is_at_once, "a broken tile is back at once").at("breakable")?;
        let divides = kind.slope.is_none_or(|slope| slope.misfit(tile.1).is_none());
        ensure(divides, "the line does not divide the tile").at("slope")?;
        super::all_exist(&kind.tags, &program.tags).at("tags")
    })
}

/// Checks that what repeats lies between the borders, that no rectangle is longer, and that a map fills it.
fn wraps(space: &Space) -> Checked {
    let sides = |b: Bounds, axis: usize| [(b.left, b.right), (b.bottom, b.top)][axis];
    for (axis, period) in space.periods.iter().enumerate().filter_map(|(axis, period)| Some((axis, (*period)?))) {
        let borders = (period.low, period.high);
        let is_within = |b: Option<Bounds>| b.is_none_or(|b| sides(b, axis) == borders);
        ensure(space.extent().is_some() && is_within(space.extent()), "the borders are not those of the space")?;
        ensure(is_within(space.map_rectangle()), "the map does not fill what repeats")?;
        ensure(period.low < period.high, "the borders are one place")?;
        let is_longer = |solid: &Solid| sides(solid.bounds, axis).1 - sides(solid.bounds, axis).0 > period.size();
        ensure(!space.solids.iter().any(is_longer), "a rectangle is longer than what repeats")?;
    }
    Ok(())
}

fn rectangle(Bounds { left, right, bottom, top }: Bounds) -> Checked {
    finite(&[left, right, bottom, top])?;
    ensure(left <= right && bottom <= top, "it ends before it begins")
}

fn spans(world: &World, spans: &WorldSpans) -> Checked {
    let WorldSpans { name: _, spaces, solids, links, slots, players, goals, nevers } = spans;
    let counts = [
        (spaces.len(), world.spaces.len()),
        (solids.len(), world.spaces.len()),
        (links.len(), world.spaces.len()),
        (slots.len(), world.slots.len()),
        (players.len(), world.players.len()),
        (goals.len(), world.goals.len()),
        (nevers.len(), world.nevers.len()),
    ];
    counts.into_iter().try_for_each(|(count, wanted)| same(count, wanted))?;
    each("solids", solids, |id, of| same(of.len(), world.spaces[id].solids.len()))?;
    each("links", links, |id, of| same(of.len(), world.spaces[id].links.len()))
}

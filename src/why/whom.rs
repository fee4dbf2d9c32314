//! What an instance touches: the instances, tiles and other geometry at its sides after a step. Where nothing is found there
//! any more, for instance because it was destroyed, nothing is named.

use crate::ir::{Bounds, Side, SlotId, Space, Touch, TouchId};

use super::step::Moment;

/// How near a body is to what it touches, px.
const NEAR: f64 = 0.5;
/// Maximum number of things that are named.
const MAX_NAMED: usize = 4;

/// What a contact query is about, by name: `raft`, or ``tile `#` at column 3, row 1``.
pub(super) fn whom(moment: &Moment<'_>, slot: SlotId, touch: TouchId) -> Vec<String> {
    let me = moment.sim.instance(moment.after, slot);
    let Some(Touch { mine, other, side, .. }) = me.entity().touches.get(touch).copied() else { return Vec::new() };
    let own: Vec<Bounds> = me
        .colliders()
        .filter(|(id, _)| me.entity().colliders[*id].tags.meets(mine))
        .map(|(_, b)| b.placed(me.position()))
        .collect();
    let space = &moment.sim.world().spaces[me.space()];
    // Beyond a seam everything is seen again, one period away.
    let own: Vec<Bounds> = own.iter().flat_map(|own| images(space, own)).collect();
    let meets = |there: &Bounds| own.iter().any(|own| is_at(own, there, side));
    let mut named = Vec::new();
    for instance in moment.sim.instances(moment.after) {
        if instance.slot() == slot || instance.space() != me.space() {
            continue;
        }
        let is_other = |id| instance.entity().colliders[id].tags.iter().any(|tag| tag == other);
        let mut there =
            instance.colliders().filter(|(id, _)| is_other(*id)).map(|(_, b)| b.placed(instance.position()));
        if there.any(|b| meets(&b)) {
            named.push(format!("`{}`", instance.name()));
        }
    }
    if let Some(map) = &space.map {
        let broken = moment.sim.broken_tiles(moment.after);
        let broken: Vec<_> = broken.into_iter().filter_map(|tile| moment.sim.place_of_tile(tile)).collect();
        let reach = |at: f64, side: f64| (at / side).floor() as i64;
        let mut seen = Vec::new();
        for body in &own {
            let (left, right) = (reach(body.left - NEAR, map.tile.0), reach(body.right + NEAR, map.tile.0));
            let (low, high) = (reach(body.bottom - NEAR, map.tile.1), reach(body.top + NEAR, map.tile.1));
            for (row, column) in (low..=high).flat_map(|row| (left..=right).map(move |column| (row, column))) {
                let Some(kind) = map.kind(column, row).and_then(|kind| map.kinds.get(kind)) else { continue };
                let cell = row as usize * map.columns + column as usize;
                let there = Bounds::new(map.rectangle(cell));
                let is_broken = broken.contains(&(me.space(), column as usize, row as usize));
                // Within a slope a body is inside of the tile.
                let side = side.filter(|_| kind.slope.is_none());
                if kind.tags.contains(&other) && !is_broken && !seen.contains(&cell) && is_at(body, &there, side) {
                    seen.push(cell);
                    named.push(tile_words(space, column as usize, row as usize));
                }
            }
        }
    }
    for solid in space.solids.iter().filter(|solid| solid.tags.iter().any(|tag| tag == other)) {
        if meets(&solid.bounds) {
            named.push(format!("the geometry at ({}, {})", solid.bounds.left, solid.bounds.bottom));
        }
    }
    if named.len() > MAX_NAMED {
        let more = named.len() - MAX_NAMED;
        named.truncate(MAX_NAMED);
        named.push(format!("{more} more"));
    }
    named
}

/// A tile in words: ``tile `#` at column 3, row 1``.
pub(super) fn tile_words(space: &Space, column: usize, row: usize) -> String {
    let map = space.map.as_ref();
    let kind = map.and_then(|map| map.kinds.get(map.kind(column as i64, row as i64)?));
    let symbol = kind.map_or(String::new(), |kind| format!(" `{}`", kind.symbol));
    format!("tile{symbol} at column {column}, row {row}")
}

/// A body where it is, and where it is seen beyond the seams of its space.
fn images(space: &Space, body: &Bounds) -> Vec<Bounds> {
    let turns = |axis: usize| space.periods[axis].map_or(vec![0.0], |period| vec![0.0, -period.size(), period.size()]);
    let across = turns(0);
    let up = turns(1);
    up.iter().flat_map(|dy| across.iter().map(move |dx| body.placed((*dx, *dy)))).collect()
}

/// Whether something is at a side of a body, or anywhere beside or in it.
pub fn is_at(own: &Bounds, there: &Bounds, side: Option<Side>) -> bool {
    let across = own.left < there.right && own.right > there.left;
    let along = own.bottom < there.top && own.top > there.bottom;
    let near = |a: f64, b: f64| (a - b).abs() <= NEAR;
    match side {
        Some(Side::Below) => across && near(own.bottom, there.top),
        Some(Side::Above) => across && near(own.top, there.bottom),
        Some(Side::Left) => along && near(own.left, there.right),
        Some(Side::Right) => along && near(own.right, there.left),
        None => {
            let wide = own.left - NEAR <= there.right && own.right + NEAR >= there.left;
            wide && own.bottom - NEAR <= there.top && own.top + NEAR >= there.bottom
        }
    }
}

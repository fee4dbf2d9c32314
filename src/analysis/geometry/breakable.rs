//! Tiles that can be broken, as the analysis sees them: each may be there or not at any time, unless nothing in the world
//! breaks it. What nothing breaks is an ordinary tile.

use std::borrow::Cow;

use crate::ir::{Expr, Program, RefValue, Subject, TagId, TagSet, TileKind, World};

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::seam;

/// The world as it is analysed: repeated beyond seams, and without the property of being breakable where nothing breaks.
pub(in crate::analysis) fn prepared<'w>(program: &Program, world: &'w World) -> Cow<'w, World> {
    let mut world = seam::unrolled(world).map_or(Cow::Borrowed(world), Cow::Owned);
    if world.layout.tiles.is_none() {
        return world;
    }
    let broken = broken(program, &world);
    for space in world.to_mut().spaces.iter_mut() {
        for kind in space.map.iter_mut().flat_map(|map| &mut map.kinds) {
            kind.breakable = kind.breakable.filter(|_| kind.tags.iter().any(|tag| TagSet::of(*tag).meets(broken)));
        }
    }
    world
}

/// The tags of the tiles that instances of a world can break.
fn broken(program: &Program, world: &World) -> TagSet {
    let mut tags = TagSet::default();
    for (id, entity) in program.entities.pairs() {
        if !world.slots.iter().any(|slot| slot.entity == id) {
            continue;
        }
        for what in entity.action_lists().flat_map(|actions| &actions.destroys) {
            tags = tags.with(match *what {
                RefValue::Of(Subject::Touched(touch)) if entity.touches[touch].tiles => {
                    TagSet::of(entity.touches[touch].other)
                }
                RefValue::Of(Subject::Probed(probe)) => match program.exprs[entity.probes[probe]] {
                    Expr::Probe { other, tiles: true, .. } => TagSet::of(other),
                    _ => continue,
                },
                _ => continue,
            });
        }
    }
    tags
}

/// The number of tiles with a tag in all maps. The map of a space that wraps may be a repeated one; each of its tiles
/// counts up to three times along an axis that wraps.
pub(in crate::analysis) fn number_of_tiles(world: &World, tag: TagId) -> Interval {
    let (mut low, mut high) = (0, 0);
    for (space, map) in world.spaces.iter().filter_map(|space| Some((space, space.map.as_ref()?))) {
        let count = map.count(|kind| kind.tags.contains(&tag));
        let copies: usize = space.periods.iter().flatten().map(|_| 3).product();
        low += count / copies;
        high += count;
    }
    Interval { low: low as f64, high: high as f64 }
}

/// The number of tiles with a tag that can be broken.
pub(in crate::analysis) fn most_broken(world: &World, tag: TagId) -> f64 {
    let can_break = |kind: &TileKind<TagId>| kind.breakable.is_some() && kind.tags.contains(&tag);
    let maps = world.spaces.iter().filter_map(|space| space.map.as_ref());
    maps.map(|map| map.count(can_break)).sum::<usize>() as f64
}

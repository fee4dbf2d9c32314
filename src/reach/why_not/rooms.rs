//! How many links are between rooms.

use crate::ir::{Id, SpaceId, World};

/// For each space, the number of links on the shortest way to one that is looked for; `u32::MAX` if none leads there.
pub(super) fn ways_to(world: &World, is_wanted: impl Fn(SpaceId) -> bool) -> Vec<u32> {
    let mut ways: Vec<u32> = world.spaces.ids().map(|id| if is_wanted(id) { 0 } else { u32::MAX }).collect();
    loop {
        let mut has_changed = false;
        for (id, space) in world.spaces.pairs() {
            let next = space.links.iter().map(|link| ways[link.space.index()]).min();
            let least = next.unwrap_or(u32::MAX).saturating_add(1);
            if least < ways[id.index()] {
                ways[id.index()] = least;
                has_changed = true;
            }
        }
        if !has_changed {
            return ways;
        }
    }
}

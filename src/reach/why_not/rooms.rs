//! How many steps are between places that lead to each other: links between rooms, edges between modes.

use crate::ir::{Id, SpaceId, World};

/// For each place, the number of steps on the shortest way to one that is looked for; `u32::MAX` if none leads there.
/// `least` gives the least of the numbers of the places to which one leads, given all numbers.
pub(in super::super) fn hops(
    count: usize,
    is_wanted: impl Fn(usize) -> bool,
    least: impl Fn(usize, &[u32]) -> u32,
) -> Vec<u32> {
    let mut hops: Vec<u32> = (0..count).map(|at| if is_wanted(at) { 0 } else { u32::MAX }).collect();
    loop {
        let mut has_changed = false;
        for at in 0..count {
            let next = least(at, &hops).saturating_add(1);
            if next < hops[at] {
                hops[at] = next;
                has_changed = true;
            }
        }
        if !has_changed {
            return hops;
        }
    }
}

/// For each space, the number of links on the shortest way to one that is looked for; `u32::MAX` if none leads there.
pub(super) fn ways_to(world: &World, is_wanted: impl Fn(SpaceId) -> bool) -> Vec<u32> {
    let links = |at: usize| &world.spaces[SpaceId::from_index(at)].links;
    let least = |at: usize, ways: &[u32]| links(at).iter().map(|link| ways[link.space.index()]).min();
    let is_wanted = |at: usize| is_wanted(SpaceId::from_index(at));
    hops(world.spaces.len(), is_wanted, |at, ways| least(at, ways).unwrap_or(u32::MAX))
}

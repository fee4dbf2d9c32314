//! Where the first player stands among the states that were visited, to say where its way ends: states after two steps
//! at one height, one for each place.

use hashbrown::HashTable;

use crate::ir::{IdVec, Layout, SlotId};
use crate::sim::Simulator;

use super::super::coverage::{PLACE, insert, mix};
use super::generations::Visit;
use super::independence::Renumbered;

/// Maximum size of the states that are kept, bytes.
const MAX_BYTES: usize = 8 << 20;

/// The states in which a player stands.
pub(super) fn rests(visit: &Visit<'_>, sim: &Simulator) -> Vec<Vec<u8>> {
    let Some(player) = sim.world().players.iter().next().map(|player| player.slot) else { return Vec::new() };
    let size = sim.world().layout.size;
    let mut places: HashTable<u64> = HashTable::new();
    let mut rests: Vec<Vec<u8>> = Vec::new();
    let mut reader = visit.reader();
    let mut bytes = vec![0; size];
    for state in 0..visit.states.len() as u32 {
        let parent = visit.states.parent(state);
        let before = visit.states.parent(parent);
        let mut at = |state: u32, bytes: &mut [u8]| {
            reader.read(&visit.states, state, bytes);
            (sim.space(bytes, player), sim.position(bytes, player))
        };
        let (space, (x, y)) = at(state, &mut bytes);
        let place = mix(mix(u64::from(space.0), (x / PLACE).floor() as i64 as u64), (y / PLACE).floor() as i64 as u64);
        if !sim.world().layout.slots[player].alive(&bytes) || places.find(place, |known| *known == place).is_some() {
            continue;
        }
        let (mut first, mut second) = (vec![0; size], vec![0; size]);
        let is_still = at(parent, &mut first).1.1 == y && at(before, &mut second).1.1 == y;
        if is_still && parent != before && (rests.len() + 1) * size <= MAX_BYTES {
            insert(&mut places, place);
            rests.push(bytes.clone());
        }
    }
    rests
}

/// A state of a part of a world as one of the whole: instances that were left out are as in `first`. Only what does not
/// refer to other instances is meant.
pub(super) fn in_whole(
    first: &[u8],
    whole: &IdVec<SlotId, crate::ir::SlotLayout>,
    part: &Layout,
    ids: &Renumbered,
    state: &[u8],
) -> Option<Vec<u8>> {
    let mut bytes = first.to_vec();
    for (old, layout) in whole.pairs() {
        let Some(new) = ids.get(old) else { continue };
        let new = &part.slots[new];
        let (to, from) = (layout.block.0..layout.block.1, new.block.0..new.block.1);
        if to.len() != from.len() || layout.rest != new.rest {
            return None;
        }
        bytes[to].copy_from_slice(&state[from]);
    }
    Some(bytes)
}

//! Colours of kinds of tiles: by their role for the players first, then by their tags, so that the same tags look the
//! same in every picture where possible.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::ir::{EntityId, Look, Program, Push, TagSet, World, WorldId};
use crate::ordered::Ordered;

use super::goal::touched;

const GROUNDS: [&str; 4] = ["ground0", "ground1", "ground2", "ground3"];
const ACCENTS: [&str; 6] = ["accent0", "accent1", "accent2", "accent3", "accent4", "accent5"];

/// Scenery that covers less than one tile in this number is not drawn.
const AIR: usize = 4;

/// The role of a tile or solid for the players.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    /// No contact with anything.
    Scenery,
    /// No contact with a player, but with others, or somebody looks for it.
    ForOthers,
    /// Contact without a push.
    Sensed,
    /// Solid from above only.
    OneWay,
    /// Solid.
    Solid,
}

/// The appearance of tiles and solids with some tags.
#[derive(Debug, Clone)]
pub(super) struct Appearance {
    pub tags: TagSet,
    pub role: Role,
    pub class: &'static str,
    /// The names of the tags.
    pub name: String,
    /// What the program says that it looks like.
    pub look: Option<Look>,
}

/// The appearances of all static geometry.
#[derive(Debug, Clone, Default)]
pub(super) struct Appearances {
    pub list: Vec<Appearance>,
}

impl Appearances {
    /// The appearances in a world; `wanted` are the tags that the goal names.
    pub fn new(program: &Program, id: WorldId, wanted: TagSet) -> Appearances {
        let world = &program.worlds[id];
        // Number of tiles and of solids with each set of tags.
        let mut counts: Vec<(TagSet, [usize; 2])> = Vec::new();
        let mut count = |tags: TagSet, more: [usize; 2]| match counts.iter_mut().find(|(set, _)| *set == tags) {
            Some((_, count)) => (0..2).for_each(|of| count[of] += more[of]),
            None => counts.push((tags, more)),
        };
        let mut all = 0;
        for space in world.spaces.iter() {
            if let Some(map) = &space.map {
                let mut used = vec![0; map.kinds.len()];
                map.cells.iter().for_each(|&kind| used[usize::from(kind)] += 1);
                all += map.cells.len();
                for (kind, used) in map.kinds.iter().zip(used).filter(|(_, used)| *used > 0) {
                    count(kind.tags.iter().copied().collect(), [used, 0]);
                }
            }
            space.solids.iter().for_each(|solid| count(solid.tags, [0, 1]));
        }
        let mut kinds: Vec<(Role, TagSet, usize)> = counts
            .into_iter()
            .map(|(tags, [tiles, solids])| (role(program, world, tags), tags, tiles, solids))
            // Tiles of scenery that cover nearly everything are treated as air.
            .filter(|(role, tags, tiles, solids)| {
                *tags != TagSet::default()
                    && (program.looks.of_tags(id, *tags).is_some()
                        || *role != Role::Scenery
                        || *solids > 0
                        || AIR * tiles < all.max(1))
            })
            .map(|(role, tags, tiles, solids)| (role, tags, tiles + solids))
            .collect();
        kinds.order_by_key(|(role, _, count)| (Reverse(*role), Reverse(*count)));
        let players = || world.players.iter().map(|player| player.slot);
        let feared =
            world.nevers.iter().flat_map(|never| players().map(|slot| touched(program, world, never.holds, slot)));
        let feared = feared.fold(TagSet::default(), TagSet::with);
        let mut appearances = Appearances::default();
        for (role, tags, _) in kinds {
            let name = names(program, tags);
            let class = match role {
                Role::Solid => appearances.unused(&GROUNDS, &name),
                Role::OneWay => "cloud",
                _ if wanted.meets(tags) => "wanted",
                _ if feared.meets(tags) => "feared",
                Role::Sensed => appearances.unused(&ACCENTS, &name),
                Role::ForOthers => "dim",
                Role::Scenery => "scenery",
            };
            let look = program.looks.of_tags(id, tags).cloned();
            appearances.list.push(Appearance { tags, role, class, name, look });
        }
        appearances
    }

    /// The index of the appearance of some tags; none if they are not drawn.
    pub fn of(&self, tags: TagSet) -> Option<usize> {
        self.list.iter().position(|appearance| appearance.tags == tags)
    }

    /// The class that matches a name, or the next unused one. The most frequent ground gets the plain class.
    fn unused(&self, classes: &[&'static str], name: &str) -> &'static str {
        let first = if classes == GROUNDS { 0 } else { fnv(name) as usize % classes.len() };
        let mut order = classes.iter().cycle().skip(first).take(classes.len());
        let free = order.find(|class| self.list.iter().all(|appearance| appearance.class != **class));
        free.copied().unwrap_or(classes[first])
    }
}

/// The role of tiles with some tags.
fn role(program: &Program, world: &World, tags: TagSet) -> Role {
    for_players(program, world, tags).unwrap_or_else(|| {
        let entities: BTreeSet<EntityId> = world.slots.iter().map(|slot| slot.entity).collect();
        let is_met = world.strongest_push(program, entities, tags).is_some_and(|push| push != Push::Sense);
        let is_looked_for = program.is_probed(tags);
        if is_met || is_looked_for { Role::ForOthers } else { Role::Scenery }
    })
}

/// The strongest role of something with some tags for any collider of a player, if it meets one.
pub(super) fn for_players(program: &Program, world: &World, tags: TagSet) -> Option<Role> {
    world.strongest_push(program, world.player_entities(), tags).map(|push| match push {
        Push::Sense => Role::Sensed,
        Push::FromAbove => Role::OneWay,
        Push::Block => Role::Solid,
    })
}

/// The names of some tags.
pub(super) fn names(program: &Program, tags: TagSet) -> String {
    tags.iter().filter_map(|tag| program.tags.get(tag).map(String::as_str)).collect::<Vec<_>>().join(", ")
}

/// The hash of Fowler, Noll and Vo (FNV-1a): the same on every machine and in every run.
fn fnv(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

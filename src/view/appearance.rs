//! Colours of kinds of tiles: by their role for the player first, then by their tags, so that the same tags look the
//! same in every picture where possible.

use std::cmp::Reverse;

use crate::ir::{Program, Push, SlotId, TagSet, World};

use super::goal::touched;

const GROUNDS: [&str; 4] = ["ground0", "ground1", "ground2", "ground3"];
const ACCENTS: [&str; 6] = ["accent0", "accent1", "accent2", "accent3", "accent4", "accent5"];

/// Scenery that covers less than one tile in this number is not drawn.
const AIR: usize = 4;

/// The role of a tile or solid for the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    /// No contact.
    Scenery,
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
}

/// The appearances of all static geometry.
#[derive(Debug, Clone, Default)]
pub(super) struct Appearances {
    pub list: Vec<Appearance>,
}

impl Appearances {
    /// The appearances in a world; `wanted` are the tags that the goal names.
    pub fn new(program: &Program, world: &World, player: Option<SlotId>, wanted: TagSet) -> Appearances {
        // Number of tiles and solids with each set of tags.
        let mut counts: Vec<(TagSet, usize)> = Vec::new();
        let mut count = |tags: TagSet, more: usize| match counts.iter_mut().find(|(set, _)| *set == tags) {
            Some((_, count)) => *count += more,
            None => counts.push((tags, more)),
        };
        let mut tiles = 0;
        for space in world.spaces.iter() {
            if let Some(map) = &space.map {
                let mut used = vec![0; map.kinds.len()];
                map.cells.iter().for_each(|&kind| used[usize::from(kind)] += 1);
                tiles += map.cells.len();
                for (kind, used) in map.kinds.iter().zip(used).filter(|(_, used)| *used > 0) {
                    count(kind.tags.iter().copied().collect(), used);
                }
            }
            space.solids.iter().for_each(|solid| count(solid.tags, 1));
        }
        let mut kinds: Vec<(Role, TagSet, usize)> = counts
            .into_iter()
            .map(|(tags, count)| (role(program, world, player, tags), tags, count))
            // Scenery that covers nearly everything is treated as air.
            .filter(|(role, tags, count)| {
                *tags != TagSet::default() && (*role != Role::Scenery || AIR * count < tiles.max(1))
            })
            .collect();
        kinds.sort_by_key(|(role, _, count)| (Reverse(*role), Reverse(*count)));
        let feared = player.map_or(TagSet::default(), |player| {
            let nevers = world.nevers.iter().map(|never| touched(program, world, never.holds, player));
            nevers.fold(TagSet::default(), TagSet::with)
        });
        let mut appearances = Appearances::default();
        for (role, tags, _) in kinds {
            let name = names(program, tags);
            let class = match role {
                Role::Solid => appearances.unused(&GROUNDS, &name),
                Role::OneWay => "cloud",
                _ if wanted.meets(tags) => "wanted",
                _ if feared.meets(tags) => "feared",
                Role::Sensed => appearances.unused(&ACCENTS, &name),
                Role::Scenery => "scenery",
            };
            appearances.list.push(Appearance { tags, role, class, name });
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

/// The role of tiles with some tags for the player: the strongest for any of its colliders.
pub(super) fn role(program: &Program, world: &World, player: Option<SlotId>, tags: TagSet) -> Role {
    let Some(player) = player else { return Role::Scenery };
    let colliders = &program.entities[world.slots[player].entity].colliders;
    let meetings = colliders.iter().filter_map(|collider| world.meeting(collider.tags, tags));
    let roles = meetings.map(|meeting| match meeting.response.push {
        Push::Sense => Role::Sensed,
        Push::FromAbove => Role::OneWay,
        Push::Block => Role::Solid,
    });
    roles.max().unwrap_or(Role::Scenery)
}

/// The names of some tags.
pub(super) fn names(program: &Program, tags: TagSet) -> String {
    tags.iter().filter_map(|tag| program.tags.get(tag).map(String::as_str)).collect::<Vec<_>>().join(", ")
}

/// The hash of Fowler, Noll and Vo (FNV-1a): the same on every machine and in every run.
fn fnv(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

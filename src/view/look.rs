//! Which colour a kind of tile has: by what it is to the player first, then by its tags, so that the same tags look the
//! same in every picture where they can.

use std::cmp::Reverse;

use crate::ir::{Program, Push, SlotId, TagSet, World};

use super::goal::touched;

const GROUNDS: [&str; 4] = ["ground0", "ground1", "ground2", "ground3"];
const ACCENTS: [&str; 6] = ["accent0", "accent1", "accent2", "accent3", "accent4", "accent5"];

/// A kind of scenery is not drawn if it covers less than one tile in this number.
const AIR: usize = 4;

/// What something is to the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    /// It does not meet it.
    Scenery,
    /// It notices it.
    Sensed,
    /// It is on it, and can jump through it from below.
    OneWay,
    /// It cannot get in.
    Solid,
}

/// How things with some tags are drawn.
#[derive(Debug, Clone)]
pub(super) struct Look {
    pub tags: TagSet,
    pub role: Role,
    pub class: &'static str,
    /// The names of the tags.
    pub name: String,
}

/// How all that never moves is drawn.
#[derive(Debug, Clone, Default)]
pub(super) struct Looks {
    pub list: Vec<Look>,
}

impl Looks {
    /// Of the tiles and solids of a world; `wanted` are the tags that the goal asks for.
    pub fn new(program: &Program, world: &World, player: Option<SlotId>, wanted: TagSet) -> Looks {
        // How many tiles and solids there are of each set of tags.
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
            // Scenery that is nearly everywhere is the air.
            .filter(|(role, tags, count)| {
                *tags != TagSet::default() && (*role != Role::Scenery || AIR * count < tiles.max(1))
            })
            .collect();
        kinds.sort_by_key(|(role, _, count)| (Reverse(*role), Reverse(*count)));
        let feared = player.map_or(TagSet::default(), |player| {
            let nevers = world.nevers.iter().map(|never| touched(program, world, never.holds, player));
            nevers.fold(TagSet::default(), TagSet::with)
        });
        let mut looks = Looks::default();
        for (role, tags, _) in kinds {
            let name = names(program, tags);
            let class = match role {
                Role::Solid => looks.unused(&GROUNDS, &name),
                Role::OneWay => "cloud",
                _ if wanted.meets(tags) => "wanted",
                _ if feared.meets(tags) => "feared",
                Role::Sensed => looks.unused(&ACCENTS, &name),
                Role::Scenery => "scenery",
            };
            looks.list.push(Look { tags, role, class, name });
        }
        looks
    }

    /// The number of the look of some tags; none for nothing.
    pub fn of(&self, tags: TagSet) -> Option<usize> {
        self.list.iter().position(|look| look.tags == tags)
    }

    /// The class that a name asks for, or the next one that nothing has yet. The ground there is
    /// most of is the plain one.
    fn unused(&self, classes: &[&'static str], name: &str) -> &'static str {
        let first = if classes == GROUNDS { 0 } else { fnv(name) as usize % classes.len() };
        let mut order = classes.iter().cycle().skip(first).take(classes.len());
        let free = order.find(|class| self.list.iter().all(|look| look.class != **class));
        free.copied().unwrap_or(classes[first])
    }
}

/// What things with some tags are to the player: the most that they are to one of its colliders.
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

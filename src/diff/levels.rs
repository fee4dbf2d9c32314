//! The tiles and the instances of tiles that differ between two compiled worlds.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::ir::{Origin, Program, TagId, TileKind, TileMap, World};

/// What differs in a space.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct LevelChange {
    /// The world.
    pub world: String,
    /// The space.
    pub space: String,
    /// Columns and rows of the old map and of the new one, if they differ.
    pub sizes: Option<[[usize; 2]; 2]>,
    /// The number of tiles that differ, as far as both maps reach.
    pub tiles: usize,
    /// Column and row of the first of them, from the upper left corner, from 1; null if there is none.
    pub first: Option<[usize; 2]>,
    /// Its character in the old map and in the new one.
    pub symbols: Option<[char; 2]>,
    /// The number of instances that tiles made, and that are not there any more.
    pub instances_gone: usize,
    /// The number of instances that tiles make, and that were not there.
    pub instances_new: usize,
}

/// What a tile means.
type Meaning<'t> = (Vec<&'t str>, String);

fn meaning<'p>(program: &'p Program, kind: &TileKind<TagId>) -> Meaning<'p> {
    let mut tags: Vec<&str> = kind.tags.iter().map(|tag| program.tags[*tag].as_str()).collect();
    tags.sort_unstable();
    (tags, format!("{:?} {:?}", kind.slope, kind.breakable))
}

/// The spaces whose levels differ between two worlds.
pub fn level_changes(old: (&Program, &World), new: (&Program, &World)) -> Vec<LevelChange> {
    let mut found = Vec::new();
    for (id, space) in old.1.spaces.pairs() {
        let Some(other) = new.1.space_named(&space.name) else { continue };
        let mut change = LevelChange {
            world: new.1.name.clone(),
            space: space.name.clone(),
            sizes: None,
            tiles: 0,
            first: None,
            symbols: None,
            instances_gone: 0,
            instances_new: 0,
        };
        if let (Some(map), Some(now)) = (&space.map, &new.1.spaces[other].map) {
            compare_maps((old.0, map), (new.0, now), &mut change);
        }
        let before = of_tiles(old.0, old.1, id);
        let after = of_tiles(new.0, new.1, other);
        let missing = |from: &BTreeMap<Key, usize>, of: &BTreeMap<Key, usize>| -> usize {
            from.iter().map(|(key, count)| count.saturating_sub(of.get(key).copied().unwrap_or(0))).sum()
        };
        (change.instances_gone, change.instances_new) = (missing(&before, &after), missing(&after, &before));
        let is_other = change.sizes.is_some() || change.tiles + change.instances_gone + change.instances_new > 0;
        found.extend(is_other.then_some(change));
    }
    found
}

/// Entity and position of an instance.
type Key = (String, String);

/// The instances that tiles make in a space.
fn of_tiles(program: &Program, world: &World, space: crate::ir::SpaceId) -> BTreeMap<Key, usize> {
    let mut all = BTreeMap::new();
    for slot in world.slots.iter().filter(|slot| slot.origin == Origin::Tile && slot.space == space) {
        let at: Vec<String> = slot.vars.iter().take(2).map(|values| values[0].to_string()).collect();
        *all.entry((program.entities[slot.entity].name.to_string(), at.join(","))).or_insert(0) += 1;
    }
    all
}

fn compare_maps(
    (old_program, old): (&Program, &TileMap<TagId>),
    (new_program, new): (&Program, &TileMap<TagId>),
    change: &mut LevelChange,
) {
    if (old.columns, old.rows) != (new.columns, new.rows) {
        change.sizes = Some([[old.columns, old.rows], [new.columns, new.rows]]);
    }
    let was: Vec<Meaning<'_>> = old.kinds.iter().map(|kind| meaning(old_program, kind)).collect();
    let is: Vec<Meaning<'_>> = new.kinds.iter().map(|kind| meaning(new_program, kind)).collect();
    // Rows from the top: a map grows upwards in the text as well.
    for row in 0..old.rows.min(new.rows) {
        for column in 0..old.columns.min(new.columns) {
            let kind = |map: &TileMap<TagId>| map.kind(column as i64, (map.rows - 1 - row) as i64);
            let (Some(before), Some(after)) = (kind(old), kind(new)) else { continue };
            if was[before] == is[after] {
                continue;
            }
            change.tiles += 1;
            if change.first.is_none() {
                change.first = Some([column + 1, row + 1]);
                change.symbols = Some([old.kinds[before].symbol, new.kinds[after].symbol]);
            }
        }
    }
}

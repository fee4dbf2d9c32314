//! Where the players of a state are, as far as a person tells places apart: space, tile, modes, discrete values.

use crate::ir::{Bounds, Domain, LeafId, SlotId, SpaceId};
use crate::sim::Instance;

use super::super::coverage::PLACE;
use super::super::goal_positions::extent;
use super::super::problem::Problem;

/// Where one player is. The order is only there to sort.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct PlayerPlace {
    /// The player.
    pub slot: SlotId,
    /// Whether there is an instance; the rest says nothing if there is none.
    pub is_alive: bool,
    /// The space.
    pub space: SpaceId,
    /// The column and the row of the tile that the middle of the body is in, from the lower left corner. Without a map,
    /// that of a grid of [`PLACE`] px.
    pub tile: (i64, i64),
    /// The active leaf of each group of modes.
    pub leaves: Vec<LeafId>,
    /// The discrete values.
    pub discretes: Vec<i32>,
}

/// Tells the places of a world apart.
pub(super) struct Places<'p> {
    problem: &'p Problem<'p>,
    /// For each slot, the middle of its body, relative to the position.
    middles: Vec<(f64, f64)>,
    /// For each space, width and height of a tile.
    tiles: Vec<(f64, f64)>,
}

impl<'p> Places<'p> {
    pub fn new(problem: &'p Problem<'p>) -> Self {
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let middle = |slot: SlotId| {
            let colliders = program.entities[world.slots[slot].entity].colliders.iter();
            let body = colliders.filter_map(|collider| extent(problem, slot, collider)).reduce(Bounds::join);
            body.map_or((0.0, 0.0), |body| (f64::midpoint(body.left, body.right), f64::midpoint(body.bottom, body.top)))
        };
        Places {
            problem,
            middles: world.slots.ids().map(middle).collect(),
            tiles: world.spaces.iter().map(|space| space.map.as_ref().map_or((PLACE, PLACE), |map| map.tile)).collect(),
        }
    }

    /// The tile that the middle of an instance is in.
    pub fn tile(&self, state: &[u8], slot: SlotId) -> (i64, i64) {
        let sim = self.problem.sim;
        let ((x, y), space) = (sim.position(state, slot), sim.space(state, slot));
        let (middle, tile) = (self.middles[slot.0 as usize], self.tiles[space.0 as usize]);
        (((x + middle.0) / tile.0).floor() as i64, ((y + middle.1) / tile.1).floor() as i64)
    }

    /// Where a player is.
    fn player(&self, state: &[u8], slot: SlotId) -> PlayerPlace {
        let instance = self.problem.sim.instance(state, slot);
        let mut place = PlayerPlace {
            slot,
            is_alive: instance.is_alive(),
            space: SpaceId(0),
            tile: (0, 0),
            leaves: Vec::new(),
            discretes: Vec::new(),
        };
        if place.is_alive {
            place.space = instance.space();
            place.tile = self.tile(state, slot);
            let entity = instance.entity();
            place.leaves.extend(entity.groups.ids().map(|group| instance.leaf(group)));
            place.discretes.extend(entity.discretes.ids().map(|discrete| instance.discrete(discrete)));
        }
        place
    }

    /// Where all players are.
    pub fn players(&self, state: &[u8]) -> Vec<PlayerPlace> {
        self.problem.players().iter().map(|&slot| self.player(state, slot)).collect()
    }

    /// A tile in words. Columns count from the left and rows from the top, as in the text of a map; without a map the
    /// lower left corner of the place is given.
    pub fn tile_words(&self, space: SpaceId, (column, row): (i64, i64)) -> String {
        let spaces = &self.problem.sim.world().spaces;
        let place = match &spaces[space].map {
            Some(map) => format!("column {}, row {}", column + 1, map.rows as i64 - row),
            None => {
                let (width, height) = self.tiles[space.0 as usize];
                format!("x {}, y {}", column as f64 * width, row as f64 * height)
            }
        };
        if spaces.len() > 1 { format!("{place} of `{}`", spaces[space].name) } else { place }
    }

    /// Where the players are, in words.
    pub fn words(&self, players: &[PlayerPlace]) -> String {
        let several = players.len() > 1;
        let one = |place: &PlayerPlace| {
            let slot = &self.problem.sim.world().slots[place.slot];
            let name = if several { format!("{} ", slot.name) } else { String::new() };
            if !place.is_alive {
                return format!("{}is gone", if several { name } else { format!("{} ", slot.name) });
            }
            let entity = &self.problem.sim.program().entities[slot.entity];
            let leaves = entity.groups.pairs().zip(&place.leaves);
            // A group with one mode tells nothing.
            let modes = leaves.filter(|((_, group), _)| group.modes.to.0 - group.modes.from.0 > 1);
            let modes = modes.map(|(_, leaf)| entity.modes[entity.leaves[*leaf].mode].path.clone());
            let discretes = entity.discretes.iter().zip(&place.discretes);
            let discretes = discretes.map(|(discrete, value)| match &discrete.domain {
                Domain::Bool => format!("{}{}", if *value == 0 { "not " } else { "" }, discrete.name),
                Domain::Int | Domain::Set(_) => format!("{} = {}", discrete.name, discrete.domain.text(*value)),
            });
            let parts: Vec<String> = modes.chain(discretes).collect();
            let state = if parts.is_empty() { String::new() } else { format!(" ({})", parts.join(", ")) };
            format!("{name}{}{state}", self.tile_words(place.space, place.tile))
        };
        players.iter().map(one).collect::<Vec<_>>().join("; ")
    }

    /// What differs in some instances between two states, in words.
    pub fn differences(&self, before: &[u8], after: &[u8], slots: &[SlotId]) -> Vec<String> {
        let of = |slot: &SlotId| {
            let sim = self.problem.sim;
            self.difference(sim.instance(before, *slot), sim.instance(after, *slot))
        };
        slots.iter().filter_map(of).collect()
    }

    /// The instances that no player controls.
    pub fn others(&self) -> Vec<SlotId> {
        let world = self.problem.sim.world();
        world.slots.ids().filter(|slot| world.slots[*slot].player.is_none()).collect()
    }

    fn difference(&self, before: Instance<'_>, after: Instance<'_>) -> Option<String> {
        let name = after.name();
        match (before.is_alive(), after.is_alive()) {
            (false, false) => return None,
            (true, false) => return Some(format!("`{name}` is gone")),
            (false, true) => return Some(format!("`{name}` is there")),
            (true, true) => {}
        }
        let place = |instance: Instance<'_>, state| (instance.space(), self.tile(state, instance.slot()));
        let (from, to) = (place(before, before.bytes()), place(after, after.bytes()));
        if from != to {
            return Some(format!("`{name}` is at {}", self.tile_words(to.0, to.1)));
        }
        let entity = after.entity();
        let is_other = |group: &_| before.leaf(*group) != after.leaf(*group);
        let modes: Vec<&str> = entity
            .groups
            .ids()
            .filter(is_other)
            .map(|group| entity.modes[entity.leaves[after.leaf(group)].mode].path.as_str())
            .collect();
        if !modes.is_empty() {
            return Some(format!("`{name}` is in {}", modes.join(", ")));
        }
        let discrete = entity.discretes.ids().find(|id| before.discrete(*id) != after.discrete(*id))?;
        let info = &entity.discretes[discrete];
        Some(format!("`{name}` has {} = {}", info.name, info.domain.text(after.discrete(discrete))))
    }
}

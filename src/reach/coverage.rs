//! The coverage of a search: numbers of places, of combinations of modes, and of both together, and how many of them
//! are recent, so that "not found" can be judged.

use hashbrown::HashTable;

use crate::ir::{Origin, SlotId};

use super::problem::Problem;

/// The side of a place, px.
pub const PLACE: f64 = 16.0;
/// Maximum number of checkpoints of the growth of coverage.
const MAX_CHECKPOINTS: usize = 512;

/// Sizes of the covered sets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Places of 16 × 16 px in which the players were, all players together.
    pub places: u64,
    /// Combinations of modes and of discrete variables, of all instances.
    pub modes: u64,
    /// Pairs of a place and a combination.
    pub both: u64,
}

/// The coverage, and how it grew.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Covered {
    /// By all nodes.
    pub all: Count,
    /// By the first half of them.
    pub half: Count,
    /// Checkpoints: numbers of nodes with the coverage at each.
    pub growth: Vec<(u64, Count)>,
}

/// The sets of covered places and combinations.
#[derive(Debug, Default)]
pub(super) struct Coverage {
    places: HashTable<u64>,
    modes: HashTable<u64>,
    both: HashTable<u64>,
    visits: u64,
    /// The number of visits between two checkpoints.
    every: u64,
    growth: Vec<(u64, Count)>,
    slots: Vec<SlotId>,
}

impl Coverage {
    pub fn new(problem: &Problem<'_>) -> Self {
        let world = problem.sim.world();
        let changes = |slot: &SlotId| {
            let s = &world.slots[*slot];
            let entity = &problem.sim.program().entities[s.entity];
            s.origin == Origin::Free || entity.leaves.len() > entity.groups.len() || !entity.discretes.is_empty()
        };
        Coverage { every: 1, slots: world.slots.ids().filter(changes).collect(), ..Coverage::default() }
    }

    /// Counts a state.
    pub fn visit(&mut self, problem: &Problem<'_>, state: &[u8]) {
        let world = problem.sim.world();
        let mut place = 0;
        for &slot in problem.players() {
            let (x, y) = problem.sim.position(state, slot);
            place = mix(place, u64::from(problem.sim.space(state, slot).0));
            place = mix(place, (x / PLACE).floor() as i64 as u64);
            place = mix(place, (y / PLACE).floor() as i64 as u64);
        }
        let mut modes = 0;
        for &slot in &self.slots {
            let layout = &world.layout.slots[slot];
            let entity = &problem.sim.program().entities[world.slots[slot].entity];
            modes = mix(modes, u64::from(layout.alive(state)));
            if !layout.alive(state) {
                continue;
            }
            for group in entity.groups.ids() {
                modes = mix(modes, u64::from(layout.leaf(state, group).0));
            }
            for id in entity.discretes.ids() {
                modes = mix(modes, layout.discrete(state, id) as u64);
            }
        }
        insert(&mut self.places, place);
        insert(&mut self.modes, modes);
        insert(&mut self.both, mix(place, modes));
        self.visits += 1;
        if self.visits.is_multiple_of(self.every) {
            self.growth.push((self.visits, self.count()));
            if self.growth.len() >= MAX_CHECKPOINTS {
                self.every *= 2;
                let every = self.every;
                self.growth.retain(|(visits, _)| visits.is_multiple_of(every));
            }
        }
    }

    pub fn count(&self) -> Count {
        Count { places: self.places.len() as u64, modes: self.modes.len() as u64, both: self.both.len() as u64 }
    }

    pub fn covered(&self) -> Covered {
        let half = self.growth.iter().find(|(visits, _)| *visits >= self.visits / 2).map_or(self.count(), |(_, c)| *c);
        Covered { all: self.count(), half, growth: self.growth.clone() }
    }

    /// Adds the coverage of another search; keeps the checkpoints of the larger one.
    pub fn join(&mut self, other: &Coverage) {
        for (mine, theirs) in
            [(&mut self.places, &other.places), (&mut self.modes, &other.modes), (&mut self.both, &other.both)]
        {
            theirs.iter().for_each(|key| insert(mine, *key));
        }
        if other.visits > self.visits {
            (self.visits, self.every) = (other.visits, other.every);
            self.growth.clone_from(&other.growth);
        }
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        (self.places.capacity() + self.modes.capacity() + self.both.capacity()) * 10
    }
}

/// Adds a key to a set.
pub(super) fn insert(table: &mut HashTable<u64>, key: u64) {
    table.entry(key, |known| *known == key, |known| *known).or_insert(key);
}

/// Mixes a number into a hash key. Collisions are negligible (one in 2⁶⁴).
pub(super) fn mix(key: u64, number: u64) -> u64 {
    // The finaliser of Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, 2014.
    let mut z = key.rotate_left(23) ^ number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

//! What a search sees its first player do: rooms and modes, where it came to rest, how high and how far it jumped from
//! there. A player rests where its height stays the same for two steps in a row; at the top of a jump it does so for one.
//! It also rests where it moved down in a step after which it is no longer falling: something holds it. A player who jumps
//! again at once rests in this way only.

use hashbrown::HashTable;

use crate::ir::{Id, SlotId, VarId};
use crate::sim::Simulator;

use super::super::coverage::{PLACE, insert, mix};
use super::super::problem::Problem;
use super::super::tree::NodeId;

/// A longer way in a step is no movement, px.
const LEAP: f64 = 64.0;
/// Number of steps at one height after which a player rests.
const RESTED: u8 = 2;
/// How much lower than it began a jump may end, px.
const LEVEL: f64 = 0.5;
/// Maximum size of the states in which players rest, bytes.
const MAX_BYTES: usize = 8 << 20;

/// A jump that was seen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Jump {
    /// Its height or length, px.
    pub size: f64,
    /// Where it began, px.
    pub from: (f64, f64),
}

/// What was seen.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Seen {
    /// For each space, whether the player was in it.
    pub spaces: Vec<bool>,
    /// For each leaf of the player, whether it was active.
    pub leaves: Vec<bool>,
    /// The highest rise above the place where the player rested before.
    pub highest: Jump,
    /// The longest way from one place of rest to the next that is not lower.
    pub longest: Jump,
    /// The first states in which the player rested, one for each place.
    pub rests: Vec<Vec<u8>>,
}

impl Seen {
    pub fn join(&mut self, other: &Seen) {
        let join = |mine: &mut Vec<bool>, theirs: &[bool]| {
            mine.resize(mine.len().max(theirs.len()), false);
            mine.iter_mut().zip(theirs).for_each(|(mine, theirs)| *mine |= theirs);
        };
        join(&mut self.spaces, &other.spaces);
        join(&mut self.leaves, &other.leaves);
        for (mine, theirs) in [(&mut self.highest, other.highest), (&mut self.longest, other.longest)] {
            if theirs.size > mine.size {
                *mine = theirs;
            }
        }
        self.rests.extend(other.rests.iter().cloned());
    }
}

/// How a node's state came about.
#[derive(Debug, Clone, Copy, Default)]
struct Flight {
    /// Where the player rested last.
    base: (f32, f32),
    /// Where its height last changed.
    changed: f32,
    /// Number of steps at this height.
    still: u8,
    /// Whether it is known where the player rested last.
    has_base: bool,
    /// Whether it sank when its height last changed.
    sank: bool,
}

/// Watches the first player.
#[derive(Debug)]
pub(super) struct Gauge {
    player: Option<SlotId>,
    groups: usize,
    seen: Seen,
    /// Of each node of the current tree.
    flights: Vec<Flight>,
    now: Flight,
    /// The position and the space before the next step.
    at: (f64, f64),
    space: u32,
    /// The places of the states in `seen`.
    places: HashTable<u64>,
    last_place: (u32, i64, i64),
    bytes: usize,
}

impl Gauge {
    pub fn new(problem: &Problem<'_>) -> Gauge {
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let player = problem.players().first().copied();
        let entity = player.map(|slot| &program.entities[world.slots[slot].entity]);
        Gauge {
            player,
            groups: entity.map_or(0, |entity| entity.groups.len()),
            seen: Seen {
                spaces: vec![false; world.spaces.len()],
                leaves: vec![false; entity.map_or(0, |entity| entity.leaves.len())],
                ..Seen::default()
            },
            flights: Vec::new(),
            now: Flight::default(),
            at: (0.0, 0.0),
            space: 0,
            places: HashTable::new(),
            last_place: (u32::MAX, 0, 0),
            bytes: 0,
        }
    }

    /// Begins an extension of a node.
    #[inline]
    pub fn begin(&mut self, sim: &Simulator, state: &[u8], node: NodeId) {
        self.now = self.flights.get(node.index()).copied().unwrap_or_default();
        if let Some(player) = self.player {
            (self.at, self.space) = (sim.position(state, player), sim.space(state, player).0);
        }
    }

    /// Adds the last state as a node.
    #[inline]
    pub fn add(&mut self) {
        self.flights.push(self.now);
    }

    /// Begins a tree.
    pub fn begin_tree(&mut self, sim: &Simulator, state: &[u8]) {
        self.now = Flight::default();
        if let Some(player) = self.player {
            (self.at, self.space) = (sim.position(state, player), sim.space(state, player).0);
            self.enter(self.space);
        }
    }

    fn enter(&mut self, space: u32) {
        if let Some(known) = self.seen.spaces.get_mut(space as usize) {
            *known = true;
        }
    }

    pub fn end_tree(&mut self) {
        self.flights.clear();
    }

    /// Notes a state.
    #[inline]
    pub fn see(&mut self, sim: &Simulator, state: &[u8]) {
        let Some(player) = self.player else { return };
        let layout = &sim.world().layout.slots[player];
        if !layout.alive(state) {
            return;
        }
        for group in 0..self.groups {
            let leaf = layout.leaf(state, crate::ir::GroupId(group as u32)).index();
            if let Some(known) = self.seen.leaves.get_mut(leaf) {
                *known = true;
            }
        }
        let (x, y) = (layout.var(state, VarId::X, 0), layout.var(state, VarId::Y, 0));
        let space = layout.space(state).0;
        let (was, was_in) = (self.at, self.space);
        (self.at, self.space) = ((x, y), space);
        let now = &mut self.now;
        if space != was_in || (x - was.0).abs() > LEAP || (y - was.1).abs() > LEAP {
            (now.still, now.has_base, now.changed) = (0, false, x as f32);
            self.enter(space);
            return;
        }
        if y != was.1 {
            (now.still, now.changed, now.sank) = (0, x as f32, y < was.1);
            let rise = y - f64::from(now.base.1);
            if rise > self.seen.highest.size && now.has_base {
                self.seen.highest = Jump { size: rise, from: base(now) };
            }
            if y > was.1 || layout.var(state, VarId::Y, 1) < 0.0 {
                return;
            }
            now.still = RESTED - 1;
        } else if now.still == 0 && now.sank {
            // It fell to the very height of what it stands on.
            now.still = RESTED - 1;
        }
        if now.still < RESTED {
            now.still += 1;
            if now.still < RESTED {
                return;
            }
            let length = f64::from((now.changed - now.base.0).abs());
            if now.has_base && y >= f64::from(now.base.1) - LEVEL && length > self.seen.longest.size {
                self.seen.longest = Jump { size: length, from: base(now) };
            }
            now.has_base = true;
        }
        now.base = (x as f32, y as f32);
        let place = (space, (x * (1.0 / PLACE)) as i64, (y * (1.0 / PLACE)) as i64);
        if place != self.last_place {
            self.last_place = place;
            self.keep(state, place);
        }
    }

    #[inline(never)]
    fn keep(&mut self, state: &[u8], (space, column, row): (u32, i64, i64)) {
        let known = self.places.len();
        insert(&mut self.places, mix(mix(u64::from(space), column as u64), row as u64));
        if self.places.len() > known && self.bytes + state.len() <= MAX_BYTES {
            self.bytes += state.len();
            self.seen.rests.push(state.to_vec());
        }
    }

    pub fn seen(&self) -> Seen {
        self.seen.clone()
    }

    pub fn bytes(&self) -> usize {
        self.bytes + self.flights.capacity() * size_of::<Flight>() + self.places.capacity() * 10
    }
}

/// Where a flight began.
fn base(flight: &Flight) -> (f64, f64) {
    (f64::from(flight.base.0), f64::from(flight.base.1))
}

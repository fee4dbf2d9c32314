//! Ledges: pieces of the tops of static obstacles on which a player can stand, as positions of the player. And a gauge that
//! tells, during an extension, how far a player has missed them. Used by `planners/ledge_guided.rs`.

use std::sync::Arc;

use crate::ir::{Bounds, Extremes, Id, Push, SlotId, Space, SpaceId, TagSet, World};
use crate::ordered::Ordered;
use crate::sim::Simulator;

use super::distance::{DistanceField, body, push};
use super::problem::Problem;

/// Maximum length of a ledge, px: longer tops are divided.
const LENGTH: f64 = 64.0;
/// Maximum number of ledges.
const MAX_LEDGES: usize = 1 << 16;
/// Maximum distance between a player's position and the ledge that it stands on, px: rounding.
const ROUNDING: f64 = 1e-6;
/// Who has landed and is alive after so many steps has survived that.
const SURVIVED: u32 = 3;
/// Ledges at most so far apart are near each other, px: what a jump may reach.
const NEAR: f64 = 192.0;

/// A piece of a top, as positions of a player (px).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ledge {
    pub space: SpaceId,
    /// The height at which the player stands on it.
    pub y: f64,
    /// The range of x in which the player touches it.
    outer: (f64, f64),
    /// The range in which it carries the whole player, or as much as fits.
    inner: (f64, f64),
}

impl Ledge {
    /// A position on it.
    pub fn middle(&self) -> (f64, f64) {
        (f64::midpoint(self.inner.0, self.inner.1), self.y)
    }

    /// How far a position is from standing on it, along the axis on which it is farther, px.
    fn miss(&self, (x, y): (f64, f64)) -> f64 {
        let across = (self.inner.0 - x).greatest(x - self.inner.1).greatest(0.0);
        across.greatest((y - self.y).abs())
    }
}

/// The ledges of a world, for one player.
#[derive(Debug)]
pub struct Ledges {
    slot: SlotId,
    /// In the order of spaces, heights, and from left to right.
    all: Vec<Ledge>,
}

impl Ledges {
    /// Those of the player who is led to the goal, or of the first one; `None` if there are none, or too many.
    pub fn new(problem: &Problem<'_>, distances: Option<&DistanceField>) -> Option<Self> {
        let is_player = |slot: &SlotId| problem.players().contains(slot);
        let slot = distances.map(DistanceField::slot).filter(is_player);
        let ledges = Ledges::of(problem, slot.or(problem.players().first().copied())?);
        Some(ledges).filter(|ledges| !ledges.all.is_empty())
    }

    /// Those of a player.
    fn of(problem: &Problem<'_>, slot: SlotId) -> Self {
        let world = problem.sim.world();
        let mut all = Vec::new();
        for (id, space) in world.spaces.pairs() {
            let carries = |mine: TagSet, tags: TagSet| push(world, mine, tags) > Push::Sense;
            let Some((mine, body)) = body(problem, slot, id, carries) else { continue };
            for solid in space.solids.iter().filter(|solid| carries(mine, solid.tags)) {
                let Bounds { left, right, top, .. } = solid.bounds;
                all.extend(pieces(id, (left, right), top, &body));
            }
            tops(world, space, mine, &mut |along, top| all.extend(pieces(id, along, top, &body)));
            if all.len() > MAX_LEDGES {
                all.clear();
                break;
            }
        }
        let key = |ledge: &Ledge| (ledge.space.index(), ledge.y, ledge.inner.0);
        all.order_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        Ledges { slot, all }
    }

    /// No ledges.
    pub fn none() -> Self {
        Ledges { slot: SlotId(0), all: Vec::new() }
    }

    /// Their number.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// One of them.
    pub fn get(&self, ledge: u32) -> Option<&Ledge> {
        self.all.get(ledge as usize)
    }

    /// Where the player is, as a ledge that is a point.
    pub fn here(&self, sim: &Simulator, state: &[u8]) -> Ledge {
        let (x, y) = sim.position(state, self.slot);
        Ledge { space: sim.space(state, self.slot), y, outer: (x, x), inner: (x, x) }
    }

    /// Those at most [`NEAR`] away from one.
    pub fn near(&self, from: &Ledge) -> Vec<u32> {
        let low = self.first_from(from.space, from.y - NEAR);
        let level = self.all[low..].iter().take_while(|other| other.space == from.space && other.y <= from.y + NEAR);
        let is_near = |other: &Ledge| other.inner.0 - from.inner.1 <= NEAR && from.inner.0 - other.inner.1 <= NEAR;
        (low as u32..).zip(level).filter(|(_, other)| is_near(other)).map(|(number, _)| number).collect()
    }

    /// The number of the first ledge of a space from a height on.
    fn first_from(&self, space: SpaceId, y: f64) -> usize {
        self.all.partition_point(|ledge| (ledge.space.index(), ledge.y) < (space.index(), y))
    }

    /// The ledge on which the player stands.
    pub fn under(&self, sim: &Simulator, state: &[u8]) -> Option<u32> {
        let ((x, y), space) = (sim.position(state, self.slot), sim.space(state, self.slot));
        let first = self.first_from(space, y - ROUNDING);
        let here = self.all[first..].iter().take_while(|ledge| ledge.space == space && ledge.y <= y + ROUNDING);
        let touched = here.enumerate().filter(|(_, ledge)| ledge.outer.0 < x && x < ledge.outer.1);
        let away = |ledge: &Ledge| (ledge.inner.0 - x).greatest(x - ledge.inner.1);
        let nearest = touched.min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b)));
        nearest.map(|(at, _)| (first + at) as u32)
    }
}

/// The pieces of a top, as positions of a body.
fn pieces(space: SpaceId, (left, right): (f64, f64), top: f64, body: &Bounds) -> Vec<Ledge> {
    if !(left.is_finite() && right.is_finite()) {
        return Vec::new();
    }
    let count = ((right - left) / LENGTH).ceil().clamp(1.0, MAX_LEDGES as f64);
    let middle = f64::midpoint(body.left, body.right);
    let piece = |at: f64| {
        let (low, high) = (left + (right - left) * at / count, left + (right - left) * (at + 1.0) / count);
        let from = low - if at == 0.0 { body.left } else { middle };
        let to = high - if at + 1.0 == count { body.right } else { middle };
        let inner = if from <= to { (from, to) } else { (f64::midpoint(from, to), f64::midpoint(from, to)) };
        Ledge { space, y: top - body.bottom, outer: (low - body.right, high - body.left), inner }
    };
    (0..count as u32).map(|at| piece(f64::from(at))).collect()
}

/// The tops of tiles that carry a body with some tags, side by side, where no tile is on them: from left to right, and their
/// height.
fn tops(world: &World, space: &Space, mine: TagSet, add: &mut dyn FnMut((f64, f64), f64)) {
    let Some(map) = &space.map else { return };
    let tags: Vec<TagSet> = map.kinds.iter().map(|kind| kind.tags.iter().copied().collect()).collect();
    let pushes: Vec<Push> = map
        .kinds
        .iter()
        .zip(&tags)
        .map(|(kind, tags)| match kind.slope {
            Some(_) => Push::Sense,
            None => push(world, mine, *tags),
        })
        .collect();
    let kind = |column: usize, row: usize| map.kind(column as i64, row as i64);
    // What a tile is besides may decide what becomes of who stands on it.
    let top = |column: usize, row: usize| {
        let is_covered = kind(column, row + 1).is_some_and(|kind| pushes[kind] == Push::Block);
        kind(column, row).filter(|kind| !is_covered && pushes[*kind] > Push::Sense).map(|kind| tags[kind])
    };
    for row in 0..map.rows {
        let mut from = 0;
        while from < map.columns {
            let tags = top(from, row);
            let same = (from..map.columns).take_while(|column| top(*column, row) == tags).count();
            if tags.is_some() {
                let [left, bottom, ..] = map.rectangle(row * map.columns + from);
                add((left, left + same as f64 * map.tile.0), bottom + map.tile.1);
            }
            from += same;
        }
    }
}

/// Watches how near a player comes to some ledges during an extension, and whether it lands.
#[derive(Debug)]
pub struct Gauge {
    ledges: Arc<Ledges>,
    /// The ledges, and the least miss of each, px.
    watched: Vec<(u32, f64)>,
    /// Whether the player stood on a ledge at the last step.
    stood: bool,
    /// Number of steps since it landed.
    landed: Option<u32>,
}

impl Gauge {
    /// A gauge that watches nothing yet.
    pub fn new(ledges: Arc<Ledges>) -> Self {
        Gauge { ledges, watched: Vec::new(), stood: false, landed: None }
    }

    /// Watches other ledges.
    pub fn watch(&mut self, ledges: impl Iterator<Item = u32>) {
        self.watched.clear();
        self.watched.extend(ledges.map(|ledge| (ledge, f64::INFINITY)));
    }

    /// The ledges with the least miss of each in the last extension, px.
    pub fn watched(&self) -> &[(u32, f64)] {
        &self.watched
    }

    /// Begins an extension from a state.
    pub fn begin(&mut self, sim: &Simulator, state: &[u8]) {
        self.watched.iter_mut().for_each(|(_, miss)| *miss = f64::INFINITY);
        self.stood = self.ledges.under(sim, state).is_some();
        self.landed = None;
    }

    /// Sees a state; returns whether the player has landed and survived that.
    pub fn see(&mut self, sim: &Simulator, state: &[u8]) -> bool {
        if let Some(steps) = &mut self.landed {
            *steps += 1;
            return *steps >= SURVIVED;
        }
        let (at, space) = (sim.position(state, self.ledges.slot), sim.space(state, self.ledges.slot));
        for (ledge, miss) in &mut self.watched {
            let ledge = &self.ledges.all[*ledge as usize];
            if ledge.space == space {
                *miss = miss.least(ledge.miss(at));
            }
        }
        let stood = std::mem::replace(&mut self.stood, self.ledges.under(sim, state).is_some());
        self.landed = (self.stood && !stood).then_some(0);
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: Bounds = Bounds { left: 2.0, right: 14.0, bottom: 0.0, top: 16.0 };

    #[test]
    fn long_tops_are_divided() {
        let all = pieces(SpaceId(0), (0.0, 192.0), 32.0, &BODY);
        let [inner, outer]: [Vec<_>; 2] =
            [all.iter().map(|l| l.inner).collect(), all.iter().map(|l| l.outer).collect()];
        assert_eq!(inner, [(-2.0, 56.0), (56.0, 120.0), (120.0, 178.0)]);
        assert_eq!(outer, [(-14.0, 62.0), (50.0, 126.0), (114.0, 190.0)]);
        assert!(all.iter().all(|l| l.y == 32.0));
    }

    #[test]
    fn a_narrow_ledge_is_missed_by_how_far_its_middle_is() {
        let ledge = pieces(SpaceId(0), (100.0, 108.0), 8.0, &BODY)[0];
        assert_eq!(ledge.middle(), (96.0, 8.0));
        assert_eq!(ledge.miss((96.0, 8.0)), 0.0);
        assert_eq!(ledge.miss((91.0, 10.0)), 5.0);
        assert_eq!(ledge.miss((95.0, 2.0)), 6.0);
        assert!(pieces(SpaceId(0), (f64::NEG_INFINITY, 8.0), 8.0, &BODY).is_empty());
    }
}

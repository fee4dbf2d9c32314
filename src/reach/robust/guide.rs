//! Progress along a known path. Its loops are left out; a player has got as far as the last part of it that it was near,
//! and the path is searched only a little ahead, so that a place that is passed twice is two places.

use std::collections::BTreeMap;

use crate::ir::{DiscreteId, Extremes, SpaceId};
use crate::sim::Control;

use super::super::coverage::{PLACE, mix};
use super::super::problem::Problem;
use super::timeline::Timeline;

/// The length of a place along the path, px.
const LENGTH: f64 = 2.0 * PLACE;
/// How far ahead the path is searched at least, px.
const AHEAD: f64 = 8.0 * PLACE;
/// How near a player is who has got somewhere, px.
const NEAR: f64 = 12.0 * PLACE;
/// What a differing number counts, px.
const DIFFERENCE: f64 = 4.0 * PLACE;

/// How far a player has got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Mark {
    /// The index in the path.
    at: usize,
    /// The number of the place.
    pub place: usize,
}

/// A path.
pub(super) struct Guide<'a> {
    problem: &'a Problem<'a>,
    /// What can be changed.
    pub controls: Vec<Control>,
    /// The plan.
    pub plan: Timeline,
    /// When it gets to which place.
    pub log: Vec<(usize, u64)>,
    points: Vec<Point>,
    /// The place of each point.
    places: Vec<usize>,
    /// By how many places players are apart who are late or early.
    pub spread: usize,
}

/// Where the players are, and what they have.
#[derive(Debug, Clone, PartialEq)]
struct Point {
    at: Vec<(SpaceId, (f64, f64))>,
    numbers: Vec<i32>,
}

impl Point {
    fn of(problem: &Problem<'_>, state: &[u8]) -> Point {
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let mut point = Point { at: Vec::new(), numbers: Vec::new() };
        for &slot in problem.players() {
            point.at.push((problem.sim.space(state, slot), problem.sim.position(state, slot)));
            let layout = &world.layout.slots[slot];
            let count = program.entities[world.slots[slot].entity].discretes.len() as u32;
            point.numbers.extend((0..count).map(|id| layout.discrete(state, DiscreteId(id))));
        }
        point
    }

    /// A distance, px; infinite between spaces.
    fn distance(&self, other: &Point) -> f64 {
        let mut sum = 0.0;
        for (a, b) in self.at.iter().zip(&other.at) {
            if a.0 != b.0 {
                return f64::INFINITY;
            }
            let ((ax, ay), (bx, by)) = (a.1, b.1);
            sum += (ax - bx).hypot(ay - by);
        }
        let differing = self.numbers.iter().zip(&other.numbers).filter(|(a, b)| a != b).count();
        sum + DIFFERENCE * differing as f64
    }

    /// A number for the place and what the players have, on a grid.
    fn key(&self, size: f64) -> u64 {
        let at = self.at.iter().fold(0, |key, (space, (x, y))| {
            let cell = |v: f64| (v / size).floor() as i64 as u64;
            mix(mix(mix(key, u64::from(space.0)), cell(*x)), cell(*y))
        });
        self.numbers.iter().fold(at, |key, number| mix(key, *number as u64))
    }
}

impl<'a> Guide<'a> {
    /// The path of a plan, from its states with their numbers of steps; `None` if the players hardly move on it.
    pub fn new(
        problem: &'a Problem<'a>,
        controls: Vec<Control>,
        plan: &Timeline,
        states: impl Iterator<Item = (u64, Vec<u8>)>,
        spread: f64,
    ) -> Option<Guide<'a>> {
        let mut points: Vec<(Point, u64)> = Vec::new();
        let mut last: BTreeMap<u64, usize> = BTreeMap::new();
        for (step, state) in states {
            let point = Point::of(problem, &state);
            let key = point.key(PLACE);
            // Back where it was: what lies between leads nowhere.
            if let Some(at) = last.get(&key).copied().filter(|at| *at < points.len()) {
                for (gone, _) in points.drain(at + 1..) {
                    let key = gone.key(PLACE);
                    if last.get(&key).is_some_and(|index| *index > at) {
                        last.remove(&key);
                    }
                }
            } else {
                last.insert(key, points.len());
                points.push((point, step));
            }
        }
        let (mut places, mut log, mut length, mut place) = (Vec::new(), Vec::new(), 0.0, 0);
        for (index, (point, step)) in points.iter().enumerate() {
            if let Some((before, _)) = index.checked_sub(1).and_then(|before| points.get(before)) {
                // A step through a link is as long as a place.
                length += point.distance(before).least(LENGTH);
            }
            place = (length / LENGTH) as usize;
            places.push(place);
            if log.last().is_none_or(|(known, _)| *known < place) {
                log.push((place, *step));
            }
        }
        let points = points.into_iter().map(|(point, _)| point).collect();
        let spread = ((spread * fastest(&places, &log)).ceil() as usize).min(32);
        let plan = plan.clone();
        (place >= 4).then_some(Guide { problem, controls, plan, log, points, places, spread })
    }

    /// Where a player is at the start.
    pub fn start(&self, state: &[u8]) -> Option<Mark> {
        let point = Point::of(self.problem, state);
        let first = self.points.first()?;
        (point.distance(first) < NEAR).then_some(Mark { at: 0, place: 0 })
    }

    /// How far a player has got after some more steps.
    pub fn advance(&self, mark: Mark, steps: u64, state: &[u8]) -> Mark {
        let point = Point::of(self.problem, state);
        let ahead = (AHEAD / LENGTH) as usize + steps as usize;
        let end = self.places[mark.at..].partition_point(|place| *place <= mark.place + ahead) + mark.at;
        let mut best = (NEAR, mark.at);
        for (at, other) in self.points[mark.at..end].iter().enumerate() {
            let distance = point.distance(other);
            if distance <= best.0 {
                best = (distance, mark.at + at);
            }
        }
        Mark { at: best.1, place: self.places[best.1] }
    }

    /// What tells beginnings in the same place apart: where exactly it is, and what the players do.
    pub fn kind(&self, state: &[u8]) -> u64 {
        let key = Point::of(self.problem, state).key(LENGTH);
        let world = self.problem.sim.world();
        self.problem.players().iter().fold(key, |key, &slot| {
            let groups = self.problem.sim.program().entities[world.slots[slot].entity].groups.ids();
            groups.fold(key, |key, group| mix(key, u64::from(world.layout.slots[slot].leaf(state, group).0)))
        })
    }
}

/// Number of places that are passed in a step, on average where it moves.
fn fastest(places: &[usize], log: &[(usize, u64)]) -> f64 {
    let steps = log.windows(2).map(|pair| pair[1].1.saturating_sub(pair[0].1)).filter(|steps| *steps > 0);
    let mut steps: Vec<u64> = steps.collect();
    steps.sort_unstable();
    let middle = steps.get(steps.len() / 2).copied().unwrap_or(1).max(1);
    if places.is_empty() { 0.0 } else { 1.0 / middle as f64 }
}

//! Drawing a part of a sample: a combination of leaves, then a value for each coordinate from what it can be then.

use rand::{Rng, RngExt};

use crate::analysis::Interval;

use super::metric::{Coordinate, NO_LEAF, Point};

/// No part of a union counts for less than this share of the range around it: a point, which has no length, is drawn,
/// too.
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// Lengths count up to this, so that all weights together are a number.
const MAX_LENGTH: f64 = 1e30;

/// How the values of one slot are drawn.
#[derive(Debug, Clone, Default)]
pub(super) struct SlotDraw {
    /// Each is as likely as any other.
    pub combinations: Vec<Combination>,
}

/// One combination of leaves.
#[derive(Debug, Clone, Default)]
pub(super) struct Combination {
    pub leaves: Vec<Leaf>,
    /// In the order of the slot's coordinates.
    pub values: Vec<Draw>,
}

/// The leaf of a group.
#[derive(Debug, Clone, Copy)]
pub(super) enum Leaf {
    /// This one.
    Fixed(f32),
    /// One of `count` numbers from `first` on.
    Any(u32, u32),
}

/// The values of a coordinate, on its scale: intervals with the weights of all up to each.
#[derive(Debug, Clone)]
pub(super) struct Draw {
    parts: Vec<(f32, f32, f32)>,
}

impl Draw {
    /// Uniform over intervals by length; whole numbers each count the same.
    pub fn of(coordinate: &Coordinate, intervals: &[Interval], whole: bool) -> Self {
        let hull = intervals.iter().copied().reduce(Interval::or);
        let least = hull.map_or(0.0, |h| (h.high - h.low).min(MAX_LENGTH)) * LEAST_SHARE;
        let mut sum = 0.0;
        let part = |i: &Interval| {
            let length = (i.high - i.low).min(MAX_LENGTH);
            sum += if whole { length + 1.0 } else { length.max(least) };
            (sum as f32, coordinate.scaled(i.low), coordinate.scaled(i.high))
        };
        Draw { parts: intervals.iter().map(part).collect() }
    }

    /// Where there is no instance.
    fn nowhere(coordinate: &Coordinate) -> Self {
        let at = coordinate.nowhere();
        Draw { parts: vec![(0.0, at, at)] }
    }

    fn draw(&self, rng: &mut impl Rng) -> f32 {
        let (_, low, high) = match self.parts.as_slice() {
            [] => return 0.0,
            [only] => *only,
            [.., last] => {
                let at = if last.0 > 0.0 { rng.random_range(0.0..last.0) } else { 0.0 };
                self.parts.iter().find(|(upto, ..)| at < *upto).copied().unwrap_or(*last)
            }
        };
        if low < high { rng.random_range(low..high) } else { low }
    }
}

impl Combination {
    /// No instance.
    pub fn absent(coordinates: &[Coordinate], leaves: usize) -> Self {
        let values = coordinates.iter().map(Draw::nowhere).collect();
        Combination { leaves: vec![Leaf::Fixed(NO_LEAF); leaves], values }
    }
}

impl SlotDraw {
    /// Leaves out all leaves and those values that are not kept.
    pub fn keep(&mut self, kept: &[bool]) {
        for combination in &mut self.combinations {
            combination.leaves.clear();
            let mut kept = kept.iter();
            combination.values.retain(|_| kept.next().is_none_or(|k| *k));
        }
    }

    /// Adds the slot's part to a sample.
    pub fn draw(&self, rng: &mut impl Rng, out: &mut Point) {
        let chosen = match self.combinations.as_slice() {
            [] => return,
            [only] => only,
            several => &several[rng.random_range(0..several.len())],
        };
        out.modes.extend(chosen.leaves.iter().map(|leaf| match *leaf {
            Leaf::Fixed(leaf) => leaf,
            Leaf::Any(first, count) => (first + rng.random_range(0..count.max(1))) as f32,
        }));
        out.reals.extend(chosen.values.iter().map(|d| d.draw(rng)));
    }
}

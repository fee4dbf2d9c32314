//! Draws a slot's part of a sample: a combination of leaves, then a value for each coordinate.

use rand::{Rng, RngExt};

use crate::analysis::Interval;
use crate::ir::Extremes;

use super::metric::{Coordinate, NO_LEAF, Point};

/// Minimum weight of an interval, as a share of the whole range: points, which have no length, are drawn, too.
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// Maximum length that counts, so that the sum of all weights stays finite.
const MAX_LENGTH: f64 = 1e30;

/// The distribution of one slot.
#[derive(Debug, Clone, Default)]
pub(super) struct SlotDraw {
    /// Drawn uniformly.
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
    /// A fixed leaf.
    Fixed(f32),
    /// One of `count` numbers from `first` on.
    Any(u32, u32),
}

/// The values of a coordinate, on its scale: intervals with cumulative weights.
#[derive(Debug, Clone)]
pub(super) struct Draw {
    parts: Vec<(f32, f32, f32)>,
}

impl Draw {
    /// Uniform by length; uniform over numbers if they are whole.
    pub fn of(coordinate: &Coordinate, intervals: &[Interval], whole: bool) -> Self {
        let hull = intervals.iter().copied().reduce(Interval::or);
        let least = hull.map_or(0.0, |h| (h.high - h.low).least(MAX_LENGTH)) * LEAST_SHARE;
        let mut sum = 0.0;
        let part = |i: &Interval| {
            let length = (i.high - i.low).least(MAX_LENGTH);
            sum += if whole { length + 1.0 } else { length.greatest(least) };
            (sum as f32, coordinate.scaled(i.low), coordinate.scaled(i.high))
        };
        Draw { parts: intervals.iter().map(part).collect() }
    }

    /// The value for an absent instance.
    fn absent(coordinate: &Coordinate) -> Self {
        let at = coordinate.absent();
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
    /// The combination without an instance.
    pub fn absent(coordinates: &[Coordinate], leaves: usize) -> Self {
        let values = coordinates.iter().map(Draw::absent).collect();
        Combination { leaves: vec![Leaf::Fixed(NO_LEAF); leaves], values }
    }
}

impl SlotDraw {
    /// Removes all leaves, and the values that are not kept.
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

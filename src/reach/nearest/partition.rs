//! A partition: the points with the same modes, whose distances depend only on coordinates.

use std::cmp::Ordering;

use super::forest::Forest;
use super::linear::{Best, Linear, Query};

/// Points of the same modes.
#[derive(Debug, Clone)]
pub(super) struct Partition {
    modes: Vec<f32>,
    points: Linear,
    forest: Forest,
}

impl Partition {
    /// A partition of some modes; `tree` is the minimum number of points for a tree with few coordinates.
    pub fn new(reals: usize, modes: Vec<f32>, tree: usize) -> Self {
        Partition { modes, points: Linear::new(reals, 0), forest: Forest::new(tree) }
    }

    /// Approximate memory use, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Partition>() + self.points.bytes() + self.forest.bytes()
    }

    /// Compares modes in the order of partitions.
    pub fn order(&self, modes: &[f32]) -> Ordering {
        compare(self.modes.iter().copied(), modes.iter().copied())
    }

    pub fn modes(&self) -> &[f32] {
        &self.modes
    }

    /// Number of differing modes.
    pub fn differing(&self, modes: &[f32]) -> usize {
        self.modes.iter().zip(modes).filter(|(own, other)| own != other).count()
    }

    pub fn points(&self) -> &Linear {
        &self.points
    }

    /// Adds a point; call [`Partition::after_push`] after the last one.
    pub fn push(&mut self, reals: &[f32], index: u32) {
        self.points.push(reals, &[], index);
    }

    /// Updates the trees. Returns the first moved slot, if removed points were dropped.
    pub fn after_push(&mut self) -> Option<usize> {
        self.forest.after_push(&mut self.points)
    }

    /// Removes a point. Returns the first moved slot, if removed points were dropped.
    pub fn remove(&mut self, slot: usize) -> Option<usize> {
        self.points.remove(slot);
        self.forest.after_remove(&mut self.points, slot)
    }

    /// Searches for a nearer accepted point.
    pub fn search(&self, query: &Query<'_>, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        self.forest.search(&self.points, query, best, accept);
    }
}

/// The total order of modes.
pub(super) fn compare(a: impl Iterator<Item = f32>, b: impl Iterator<Item = f32>) -> Ordering {
    a.zip(b).map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

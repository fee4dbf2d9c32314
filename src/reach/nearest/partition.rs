//! The points that agree in all modes: within them only coordinates tell distances apart.

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
    /// A partition of some modes; `worth` is the number of points of few coordinates from which a tree pays off.
    pub fn new(reals: usize, modes: Vec<f32>, tree: usize) -> Self {
        Partition { modes, points: Linear::new(reals, 0), forest: Forest::new(tree) }
    }

    /// The memory that it takes, bytes, about.
    pub fn bytes(&self) -> usize {
        size_of::<Partition>() + self.points.bytes() + self.forest.bytes()
    }

    /// Where modes come in the order of partitions.
    pub fn order(&self, modes: &[f32]) -> Ordering {
        compare(self.modes.iter().copied(), modes.iter().copied())
    }

    pub fn modes(&self) -> &[f32] {
        &self.modes
    }

    /// How many modes differ.
    pub fn differing(&self, modes: &[f32]) -> usize {
        self.modes.iter().zip(modes).filter(|(own, other)| own != other).count()
    }

    pub fn points(&self) -> &Linear {
        &self.points
    }

    /// Adds a point; [`Partition::grown`] is to be called after the last one.
    pub fn push(&mut self, reals: &[f32], index: u32) {
        self.points.push(reals, &[], index);
    }

    /// If it dropped removed points, gives the slot from which on the others have moved.
    pub fn grown(&mut self) -> Option<usize> {
        self.forest.grown(&mut self.points)
    }

    /// Takes a point out. If it dropped it and others, gives the slot from which on the others have moved.
    pub fn remove(&mut self, slot: usize) -> Option<usize> {
        self.points.remove(slot);
        self.forest.removed(&mut self.points, slot)
    }

    /// Looks for a nearer point that is accepted.
    pub fn search(&self, query: &Query<'_>, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        self.forest.search(&self.points, query, best, accept);
    }
}

/// Modes in the order of partitions: equal are those that are the same number.
pub(super) fn compare(a: impl Iterator<Item = f32>, b: impl Iterator<Item = f32>) -> Ordering {
    a.zip(b).map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

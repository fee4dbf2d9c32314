//! An incremental index of static trees: the doubling method of Bentley and Saxe, *Decomposable Searching Problems I:
//! Static-to-Dynamic Transformation*, 1980. The oldest points are in the largest tree; the newest are scanned until
//! there are enough for a tree.

use super::linear::{Best, Linear, Query};
use super::tree::{MAX_AXES, Tree, varying};

/// Trees over some slots; the rest is scanned.
#[derive(Debug, Clone)]
pub(super) struct Forest {
    trees: Vec<Tree>,
    /// Minimum number of points for a tree with up to four coordinates.
    least: usize,
    /// Number of scanned slots at which a tree is considered next.
    next: usize,
    /// Number of scanned slots with removed points.
    removed: usize,
}

/// Factor of the minimum number of points for a tree, by dimension: measured with `benches/nearest.rs`.
fn size_factor(axes: usize) -> Option<usize> {
    match axes {
        0..=4 => Some(1),
        5..=8 => Some(4),
        9..=MAX_AXES => Some(16),
        _ => None,
    }
}

impl Forest {
    /// Approximate memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.trees.iter().map(Tree::bytes).sum()
    }

    pub fn new(least: usize) -> Self {
        Forest { trees: Vec::new(), least, next: least, removed: 0 }
    }

    /// The first slot that is in no tree.
    fn end(&self) -> usize {
        self.trees.last().map_or(0, |tree| tree.slots().end)
    }

    /// Updates the trees after points were added. Returns the first moved slot, if removed points were dropped.
    pub fn after_push(&mut self, points: &mut Linear) -> Option<usize> {
        if points.len() - self.end() < self.next {
            return None;
        }
        // A tree is merged into the new one if it is no larger than the points after it.
        let joins = |tree: &&Tree| tree.slots().len() <= points.len() - tree.slots().end;
        let joining = self.trees.iter().rev().take_while(joins).count();
        Some(self.rebuild_after(self.trees.len() - joining, points))
    }

    /// Updates the trees after a point was removed. Returns the first moved slot, if removed points were dropped.
    pub fn after_remove(&mut self, points: &mut Linear, slot: usize) -> Option<usize> {
        if let Some(number) = self.trees.iter().position(|tree| tree.slots().contains(&slot)) {
            return self.trees[number].after_remove(points, slot).then(|| self.rebuild_after(number, points));
        }
        self.removed += 1;
        (2 * self.removed > points.len() - self.end()).then(|| self.rebuild_after(self.trees.len(), points))
    }

    /// Keeps the first trees and rebuilds one over the points after them, if it pays off. Returns the first slot after
    /// the kept trees.
    fn rebuild_after(&mut self, kept: usize, points: &mut Linear) -> usize {
        self.trees.truncate(kept);
        let from = self.end();
        points.compact(from);
        self.removed = 0;
        let count = points.len() - from;
        self.next = self.least;
        if count >= self.least {
            let axes = varying(points, from..points.len());
            // Constant coordinates may start to vary, so this is decided again at twice the number.
            self.next = size_factor(axes.len()).map_or(2 * count, |times| times * self.least);
            if count >= self.next {
                let built = Tree::build(points, from..points.len(), axes);
                self.next = if built.is_some() { self.next } else { 2 * count };
                self.trees.extend(built);
            }
        }
        from
    }

    /// Searches for a nearer accepted point.
    pub fn search(&self, points: &Linear, query: &Query<'_>, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        for tree in &self.trees {
            tree.search(points, query, best, accept);
        }
        points.scan(self.end()..points.len(), query, best, accept);
    }
}

//! Points that come one by one, in static trees: the doubling method of Bentley and Saxe, *Decomposable Searching
//! Problems I: Static-to-Dynamic Transformation*, 1980. The oldest points are in the largest tree; the newest are in
//! none and are scanned until they are worth one.

use super::linear::{Best, Linear, Query};
use super::tree::{MAX_AXES, Tree, varying};

/// Trees over the slots of some points, the rest of which is scanned.
#[derive(Debug, Clone)]
pub(super) struct Forest {
    trees: Vec<Tree>,
    /// How many points of up to four coordinates are worth a tree.
    least: usize,
    /// How many scanned slots are worth a tree, as far as is known.
    next: usize,
    /// How many of the scanned slots are of removed points.
    removed: usize,
}

/// How many points are worth a tree, in multiples of what is in few dimensions: measured with `benches/nearest.rs`.
fn worth(axes: usize) -> Option<usize> {
    match axes {
        0..=4 => Some(1),
        5..=8 => Some(4),
        9..=MAX_AXES => Some(16),
        _ => None,
    }
}

impl Forest {
    /// The memory that it takes, bytes, about.
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

    /// Told of new points. If it drops removed ones, gives the slot from which on the others have moved.
    pub fn grown(&mut self, points: &mut Linear) -> Option<usize> {
        if points.len() - self.end() < self.next {
            return None;
        }
        // A tree goes into the new one if it is no larger than what comes after it.
        let joins = |tree: &&Tree| tree.slots().len() <= points.len() - tree.slots().end;
        let joining = self.trees.iter().rev().take_while(joins).count();
        Some(self.plant_after(self.trees.len() - joining, points))
    }

    /// Told that a point was removed. If it drops it and others, gives the slot from which on the others have moved.
    pub fn removed(&mut self, points: &mut Linear, slot: usize) -> Option<usize> {
        if let Some(number) = self.trees.iter().position(|tree| tree.slots().contains(&slot)) {
            return self.trees[number].removed(points, slot).then(|| self.plant_after(number, points));
        }
        self.removed += 1;
        (2 * self.removed > points.len() - self.end()).then(|| self.plant_after(self.trees.len(), points))
    }

    /// Keeps the first trees and puts the points after them into one, if that pays off. Returns the first slot after
    /// those that were kept.
    fn plant_after(&mut self, kept: usize, points: &mut Linear) -> usize {
        self.trees.truncate(kept);
        let from = self.end();
        points.compact(from);
        self.removed = 0;
        let count = points.len() - from;
        self.next = self.least;
        if count >= self.least {
            let axes = varying(points, from..points.len());
            // Coordinates that are all the same may not stay so, nor stay different: asked again at twice the number.
            self.next = worth(axes.len()).map_or(2 * count, |times| times * self.least);
            if count >= self.next {
                let planted = Tree::plant(points, from..points.len(), axes);
                self.next = if planted.is_some() { self.next } else { 2 * count };
                self.trees.extend(planted);
            }
        }
        from
    }

    /// Looks for a nearer point that is accepted.
    pub fn search(&self, points: &Linear, query: &Query<'_>, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        for tree in &self.trees {
            tree.search(points, query, best, accept);
        }
        points.scan(self.end()..points.len(), query, best, accept);
    }
}

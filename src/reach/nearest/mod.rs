//! The exact nearest neighbour among points that come and go: real coordinates, and modes that cost a fixed penalty
//! where they differ. Few points are scanned; the modes that many points share get a partition each (`partition.rs`),
//! whose points are in trees (`forest.rs`, `tree.rs`) where that is faster.

mod forest;
mod linear;
mod partition;
#[cfg(test)]
mod tests;
mod tree;

use linear::{Best, Linear, Query};
use partition::{Partition, compare};

/// A found point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// How many points were added before it.
    pub index: usize,
    /// The squared distance, with the penalties of the modes that differ.
    pub distance: f32,
}

/// Numbers of points from which on it is done otherwise: measured with `benches/nearest.rs`.
#[derive(Debug, Clone, Copy)]
struct Thresholds {
    /// As many points as are scanned whatever their modes.
    scan: usize,
    /// As many of them as get a partition if their modes are the same. What is left is scanned: thousands of partitions
    /// of a few points each take longer than a scan of all.
    partition: usize,
    /// As many points of a partition, in up to four coordinates, as get a tree.
    tree: usize,
}

const THRESHOLDS: Thresholds = Thresholds { scan: 500, partition: 50, tree: 1_500 };

/// Where a point is.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Among the points of rare modes.
    Rest(u32),
    /// In a partition.
    Partition(u32, u32),
    Removed,
}

/// Points and the nearest of them: of least squared distance, ties go to the lower index. A query takes no memory,
/// but if removed or refused points are the nearest.
#[derive(Debug, Clone)]
pub struct Index {
    reals: usize,
    modes: usize,
    penalty: f32,
    thresholds: Thresholds,
    /// The points of modes that few points have.
    rest: Linear,
    /// How many of their slots are of removed points.
    removed: usize,
    /// The number of their slots at which common modes among them are looked for.
    next: usize,
    partitions: Vec<Partition>,
    /// The partitions in the order of their modes.
    order: Vec<u32>,
    /// By index.
    places: Vec<Place>,
}

impl Index {
    /// No points yet, of `reals` finite coordinates and `modes` modes; a mode that differs adds `penalty`, 0 or more,
    /// to the squared distance.
    pub fn new(reals: usize, modes: usize, penalty: f32) -> Self {
        Index::with_thresholds(reals, modes, penalty, THRESHOLDS)
    }

    fn with_thresholds(reals: usize, modes: usize, penalty: f32, thresholds: Thresholds) -> Self {
        // A point is removed by its first coordinate.
        let rest = Linear::new(reals.max(1), modes);
        let (partitions, order, places) = (Vec::new(), Vec::new(), Vec::new());
        Index { reals, modes, penalty, thresholds, rest, removed: 0, next: thresholds.scan, partitions, order, places }
    }

    /// Forgets all points, keeps the memory of those that are scanned.
    pub fn clear(&mut self) {
        self.rest.clear();
        self.removed = 0;
        self.next = self.thresholds.scan;
        self.partitions.clear();
        self.order.clear();
        self.places.clear();
    }

    /// The number of points, removed ones included.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The memory that it takes, bytes, about.
    pub fn bytes(&self) -> usize {
        let partitions: usize = self.partitions.iter().map(Partition::bytes).sum();
        self.rest.bytes() + partitions + self.places.capacity() * size_of::<Place>()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Adds a point; its index is the number of points before it.
    pub fn push(&mut self, reals: &[f32], modes: &[f32]) {
        debug_assert_eq!((reals.len(), modes.len()), (self.reals, self.modes), "a point of this space");
        let index = self.places.len() as u32;
        let reals = at_least_one(reals);
        match self.order.binary_search_by(|&number| self.partitions[number as usize].order(modes)) {
            Ok(at) => {
                let number = self.order[at];
                let partition = &mut self.partitions[number as usize];
                self.places.push(Place::Partition(number, partition.points().len() as u32));
                partition.push(reals, index);
                let moved = partition.grown();
                self.note_partition(number, moved);
            }
            Err(_) => {
                self.places.push(Place::Rest(self.rest.len() as u32));
                self.rest.push(reals, modes, index);
                if self.rest.len() >= self.next {
                    self.split();
                }
            }
        }
    }

    /// Takes a point out, if it is there.
    pub fn remove(&mut self, index: usize) {
        let Some(place) = self.places.get_mut(index) else {
            return;
        };
        match std::mem::replace(place, Place::Removed) {
            Place::Rest(slot) => {
                self.rest.remove(slot as usize);
                self.removed += 1;
                if 2 * self.removed > self.rest.len() {
                    self.compact_rest();
                }
            }
            Place::Partition(number, slot) => {
                let moved = self.partitions[number as usize].remove(slot as usize);
                self.note_partition(number, moved);
            }
            Place::Removed => {}
        }
    }

    /// The nearest point; none if all are removed.
    pub fn nearest(&self, reals: &[f32], modes: &[f32]) -> Option<Neighbour> {
        self.search(reals, modes, &mut |_| true)
    }

    /// The nearest point that `accept` takes; it must answer the same for the same point. It is asked about the nearest
    /// point, and about others only if it refuses that one.
    pub fn nearest_where(
        &self,
        reals: &[f32],
        modes: &[f32],
        mut accept: impl FnMut(usize) -> bool,
    ) -> Option<Neighbour> {
        let nearest = self.nearest(reals, modes)?;
        if accept(nearest.index) {
            return Some(nearest);
        }
        self.search(reals, modes, &mut |index| index != nearest.index && accept(index))
    }

    fn search(&self, reals: &[f32], modes: &[f32], accept: &mut impl FnMut(usize) -> bool) -> Option<Neighbour> {
        debug_assert_eq!((reals.len(), modes.len()), (self.reals, self.modes), "a point of this space");
        let mut query = Query { reals: at_least_one(reals), modes, penalty: self.penalty, differing: 0 };
        let mut best = Best::none();
        let mut penalties = 0.0;
        for differing in 0..=self.modes {
            // Every point that is left is at least so far.
            if penalties > best.distance {
                break;
            }
            query.differing = differing;
            for partition in &self.partitions {
                if partition.differing(modes) == differing {
                    partition.search(&query, &mut best, accept);
                }
            }
            if differing == 0 {
                self.rest.scan(0..self.rest.len(), &query, &mut best, accept);
            }
            penalties += self.penalty;
        }
        (!best.is_none()).then_some(Neighbour { index: best.index, distance: best.distance })
    }

    /// Returns the modes that many points share a partition each.
    fn split(&mut self) {
        self.rest.compact(0);
        let modes_of = |slot: &u32| self.rest.modes(*slot as usize);
        let mut slots: Vec<u32> = (0..self.rest.len() as u32).collect();
        slots.sort_unstable_by(|a, b| compare(modes_of(a), modes_of(b)).then(a.cmp(b)));
        let runs = slots.chunk_by(|a, b| compare(modes_of(a), modes_of(b)).is_eq());
        let mut partitions = Vec::new();
        let mut moved = Vec::new();
        for run in runs.filter(|run| run.len() >= self.thresholds.partition) {
            let modes = modes_of(&run[0]).collect();
            let mut partition = Partition::new(self.rest.reals(), modes, self.thresholds.tree);
            let mut reals = Vec::new();
            for &slot in run {
                reals.clear();
                reals.extend(self.rest.coordinates(slot as usize));
                partition.push(&reals, self.rest.index(slot as usize) as u32);
            }
            partition.grown();
            partitions.push(partition);
            moved.extend_from_slice(run);
        }
        for slot in moved {
            self.rest.remove(slot as usize);
        }
        self.compact_rest();
        for partition in partitions {
            let number = self.partitions.len() as u32;
            let at = self.order.partition_point(|&n| self.partitions[n as usize].order(partition.modes()).is_lt());
            self.order.insert(at, number);
            self.partitions.push(partition);
            self.note_partition(number, Some(0));
        }
        self.next = self.thresholds.scan.max(2 * self.rest.len());
    }

    /// Drops the removed points of rare modes.
    fn compact_rest(&mut self) {
        self.rest.compact(0);
        self.removed = 0;
        for slot in 0..self.rest.len() {
            self.places[self.rest.index(slot)] = Place::Rest(slot as u32);
        }
    }

    /// Notes where the points of a partition are that have moved.
    fn note_partition(&mut self, number: u32, from: Option<usize>) {
        let points = self.partitions[number as usize].points();
        for slot in from.map_or(0..0, |from| from..points.len()) {
            self.places[points.index(slot)] = Place::Partition(number, slot as u32);
        }
    }
}

/// Points without coordinates are all in one place.
fn at_least_one(reals: &[f32]) -> &[f32] {
    if reals.is_empty() { &[0.0] } else { reals }
}

//! Exact nearest neighbours among points that are added and removed: real coordinates, and modes with a fixed penalty
//! where they differ. Few points are scanned; points with common modes get a partition (`partition.rs`), whose points
//! are in trees (`forest.rs`, `tree.rs`) where that is faster.

mod forest;
mod linear;
mod partition;
#[cfg(test)]
mod tests;
mod tree;

use linear::{Best, Linear, Query};
use partition::{Partition, compare};

/// The result of a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Its index: the number of points added before it.
    pub index: usize,
    /// The squared distance, with the penalties of the modes that differ.
    pub distance: f32,
}

/// Numbers of points at which the data structure changes: measured with `benches/nearest.rs`.
#[derive(Debug, Clone, Copy)]
struct Thresholds {
    /// Number of points that are scanned regardless of their modes.
    scan: usize,
    /// Number of points with the same modes that get a partition. The rest is scanned: thousands of partitions with a
    /// few points each are slower than one scan.
    partition: usize,
    /// Number of points of a partition, in up to four coordinates, that get a tree.
    tree: usize,
}

const THRESHOLDS: Thresholds = Thresholds { scan: 500, partition: 50, tree: 1_500 };

/// The location of a point.
#[derive(Debug, Clone, Copy)]
enum Location {
    /// In the list of points with rare modes.
    Rest(u32),
    /// In a partition.
    Partition(u32, u32),
    Removed,
}

/// An index of points by squared distance; ties go to the lower index. A query allocates nothing, unless removed or
/// refused points are the nearest.
#[derive(Debug, Clone)]
pub struct Index {
    reals: usize,
    modes: usize,
    penalty: f32,
    thresholds: Thresholds,
    /// Points with rare modes.
    rest: Linear,
    /// Number of their slots with removed points.
    removed: usize,
    /// Number of their slots at which common modes are looked for.
    next: usize,
    partitions: Vec<Partition>,
    /// The partitions in the order of their modes.
    order: Vec<u32>,
    /// By index.
    locations: Vec<Location>,
    /// The coordinates that repeat.
    around: Vec<Around>,
}

/// A coordinate that repeats, as in a space that wraps: its points lie in one period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    /// The number of the coordinate.
    pub coordinate: usize,
    /// The middle of the period.
    pub middle: f32,
    /// Its length, more than 0.
    pub size: f32,
}

/// Maximum number of coordinates that repeat: each of them doubles the work of a query.
const MAX_AROUND: usize = 4;

impl Index {
    /// An empty index of points with `reals` finite coordinates and `modes` modes; a differing mode adds `penalty` (at
    /// least 0) to the squared distance.
    pub fn new(reals: usize, modes: usize, penalty: f32) -> Self {
        Index::with_thresholds(reals, modes, penalty, THRESHOLDS)
    }

    fn with_thresholds(reals: usize, modes: usize, penalty: f32, thresholds: Thresholds) -> Self {
        // The first coordinate marks removed points.
        let rest = Linear::new(reals.max(1), modes);
        let (partitions, order, locations) = (Vec::new(), Vec::new(), Vec::new());
        Index {
            reals,
            modes,
            penalty,
            thresholds,
            rest,
            removed: 0,
            next: thresholds.scan,
            partitions,
            order,
            locations,
            around: Vec::new(),
        }
    }

    /// With coordinates that repeat: of the ways between two points, the shortest counts. A query is then also asked one
    /// period further, towards the other end of each of them.
    #[must_use]
    pub fn around(mut self, mut around: Vec<Around>) -> Self {
        around.truncate(MAX_AROUND);
        self.around = around;
        self
    }

    /// Removes all points, but keeps the memory of the scanned ones.
    pub fn clear(&mut self) {
        self.rest.clear();
        self.removed = 0;
        self.next = self.thresholds.scan;
        self.partitions.clear();
        self.order.clear();
        self.locations.clear();
    }

    /// Number of points, including removed ones.
    pub fn len(&self) -> usize {
        self.locations.len()
    }

    /// Approximate memory use, bytes.
    pub fn bytes(&self) -> usize {
        let partitions: usize = self.partitions.iter().map(Partition::bytes).sum();
        self.rest.bytes() + partitions + self.locations.capacity() * size_of::<Location>()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.locations.is_empty()
    }

    /// Adds a point; its index is the number of points before it.
    pub fn push(&mut self, reals: &[f32], modes: &[f32]) {
        debug_assert_eq!((reals.len(), modes.len()), (self.reals, self.modes), "a point of this space");
        let index = self.locations.len() as u32;
        let reals = at_least_one(reals);
        match self.order.binary_search_by(|&number| self.partitions[number as usize].order(modes)) {
            Ok(at) => {
                let number = self.order[at];
                let partition = &mut self.partitions[number as usize];
                self.locations.push(Location::Partition(number, partition.points().len() as u32));
                partition.push(reals, index);
                let moved = partition.after_push();
                self.note_partition(number, moved);
            }
            Err(_) => {
                self.locations.push(Location::Rest(self.rest.len() as u32));
                self.rest.push(reals, modes, index);
                if self.rest.len() >= self.next {
                    self.split();
                }
            }
        }
    }

    /// Removes a point, if it is present.
    pub fn remove(&mut self, index: usize) {
        let Some(place) = self.locations.get_mut(index) else {
            return;
        };
        match std::mem::replace(place, Location::Removed) {
            Location::Rest(slot) => {
                self.rest.remove(slot as usize);
                self.removed += 1;
                if 2 * self.removed > self.rest.len() {
                    self.compact_rest();
                }
            }
            Location::Partition(number, slot) => {
                let moved = self.partitions[number as usize].remove(slot as usize);
                self.note_partition(number, moved);
            }
            Location::Removed => {}
        }
    }

    /// The nearest point; `None` if there is none.
    pub fn nearest(&self, reals: &[f32], modes: &[f32]) -> Option<Neighbour> {
        self.search(reals, modes, &mut |_| true)
    }

    /// The nearest accepted point. `accept` must be a pure function; it is called with the nearest point, and with
    /// others only if it refuses that one.
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
        let nearest = self.search_once(reals, modes, accept);
        if self.around.is_empty() {
            return nearest;
        }
        let mut best = nearest;
        let mut moved = reals.to_vec();
        for turned in 1..1_u32 << self.around.len() {
            moved.copy_from_slice(reals);
            for (at, Around { coordinate, middle, size }) in self.around.iter().enumerate() {
                if turned >> at & 1 == 1 {
                    let real = &mut moved[*coordinate];
                    *real += if *real < *middle { *size } else { -*size };
                }
            }
            let found = self.search_once(&moved, modes, accept);
            let is_better = |a: &Neighbour, b: &Neighbour| (a.distance, a.index) < (b.distance, b.index);
            if let Some(found) = found.filter(|found| best.is_none_or(|best| is_better(found, &best))) {
                best = Some(found);
            }
        }
        best
    }

    fn search_once(&self, reals: &[f32], modes: &[f32], accept: &mut impl FnMut(usize) -> bool) -> Option<Neighbour> {
        debug_assert_eq!((reals.len(), modes.len()), (self.reals, self.modes), "a point of this space");
        let mut query = Query { reals: at_least_one(reals), modes, penalty: self.penalty, differing: 0 };
        let mut best = Best::none();
        let mut penalties = 0.0;
        for differing in 0..=self.modes {
            // All remaining points are at least this far away.
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

    /// Moves points with common modes into partitions.
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
            partition.after_push();
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
            self.locations[self.rest.index(slot)] = Location::Rest(slot as u32);
        }
    }

    /// Updates the locations of moved points of a partition.
    fn note_partition(&mut self, number: u32, from: Option<usize>) {
        let points = self.partitions[number as usize].points();
        for slot in from.map_or(0..0, |from| from..points.len()) {
            self.locations[points.index(slot)] = Location::Partition(number, slot as u32);
        }
    }
}

/// Points without coordinates share one dummy coordinate.
fn at_least_one(reals: &[f32]) -> &[f32] {
    if reals.is_empty() { &[0.0] } else { reals }
}

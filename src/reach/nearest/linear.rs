//! Points with real coordinates and modes, with a linear scan for the nearest. Points are stored in blocks of sixteen,
//! coordinate by coordinate, so that the compiler can vectorise. The distance is defined here with one order of
//! summation, so that all searches agree to the last bit.

use std::ops::Range;

const LANES: usize = 16;
/// Number of coordinates after which a block is skipped if none of its points can be the nearest.
const ROWS_AT_ONCE: usize = 8;
/// Coordinate of a removed point: farther than any point, as coordinates are finite.
const REMOVED: f32 = f32::INFINITY;

/// A nearest-neighbour query.
#[derive(Debug, Clone, Copy)]
pub(super) struct Query<'q> {
    pub reals: &'q [f32],
    pub modes: &'q [f32],
    /// Penalty of a differing mode in the squared distance.
    pub penalty: f32,
    /// Number of differing modes that the points do not store.
    pub differing: usize,
}

/// The nearest point so far: the least squared distance, then the lowest index.
#[derive(Debug, Clone, Copy)]
pub(super) struct Best {
    pub distance: f32,
    pub index: usize,
    /// Number of points searched so far.
    pub searched: usize,
}

impl Best {
    pub fn none() -> Self {
        // A removed point is farther than this.
        Best { distance: f32::MAX, index: usize::MAX, searched: 0 }
    }

    pub fn is_none(&self) -> bool {
        self.index == usize::MAX
    }

    /// Whether a point would replace it.
    pub fn is_beaten_by(&self, distance: f32, index: usize) -> bool {
        distance < self.distance || (distance == self.distance && index < self.index)
    }
}

/// Points in slots; a later slot has a higher index.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    reals: usize,
    modes: usize,
    indices: Vec<u32>,
    blocks: Vec<[f32; LANES]>,
}

impl Linear {
    /// An empty list; needs at least one coordinate, which marks removed points.
    pub fn new(reals: usize, modes: usize) -> Self {
        Linear { reals, modes, indices: Vec::new(), blocks: Vec::new() }
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.indices.capacity() * size_of::<u32>() + self.blocks.capacity() * size_of::<[f32; LANES]>()
    }

    fn rows(&self) -> usize {
        self.reals + self.modes
    }

    /// The number of coordinates.
    pub fn reals(&self) -> usize {
        self.reals
    }

    /// Number of slots, including those of removed points.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    pub fn clear(&mut self) {
        self.indices.clear();
        self.blocks.clear();
    }

    /// Adds a point whose index is higher than those before it.
    pub fn push(&mut self, reals: &[f32], modes: &[f32], index: u32) {
        let (slot, rows) = (self.len(), self.rows());
        if slot.is_multiple_of(LANES) {
            let at = self.blocks.len();
            self.blocks.resize(at + rows, [0.0; LANES]);
            self.blocks[at] = [REMOVED; LANES];
        }
        let block = slot / LANES * rows;
        for (row, value) in reals.iter().chain(modes).enumerate() {
            self.blocks[block + row][slot % LANES] = *value;
        }
        self.indices.push(index);
    }

    /// Removes a point; its slot stays until the points are compacted.
    pub fn remove(&mut self, slot: usize) {
        let block = slot / LANES * self.rows();
        self.blocks[block][slot % LANES] = REMOVED;
    }

    /// The index of the point in a slot.
    pub fn index(&self, slot: usize) -> usize {
        self.indices[slot] as usize
    }

    pub fn is_live(&self, slot: usize) -> bool {
        self.value(slot, 0) < REMOVED
    }

    /// A coordinate; the modes follow the coordinates.
    pub fn value(&self, slot: usize, row: usize) -> f32 {
        self.blocks[slot / LANES * self.rows() + row][slot % LANES]
    }

    /// The modes of a point.
    pub fn modes(&self, slot: usize) -> impl Iterator<Item = f32> {
        (self.reals..self.rows()).map(move |row| self.value(slot, row))
    }

    /// The coordinates of a point.
    pub fn coordinates(&self, slot: usize) -> impl Iterator<Item = f32> {
        (0..self.reals).map(move |row| self.value(slot, row))
    }

    /// The squared distance of one point, bit for bit as in the scan.
    pub fn distance(&self, slot: usize, query: &Query<'_>) -> f32 {
        let mut sum = 0.0;
        // The query of a partition by modes has more modes than its points.
        for row in 0..self.reals {
            let d = self.value(slot, row) - query.reals[row];
            sum += d * d;
        }
        for row in self.reals..self.rows() {
            let mode = self.value(slot, row);
            sum += if mode == query.modes[row - self.reals] { 0.0 } else { query.penalty };
        }
        (0..query.differing).fold(sum, |sum, _| sum + query.penalty)
    }

    /// Drops the removed points from a slot on; the others keep their order.
    pub fn compact(&mut self, from: usize) {
        let rows = self.rows();
        let mut to = from;
        for slot in from..self.len() {
            if !self.is_live(slot) {
                continue;
            }
            if to < slot {
                for row in 0..rows {
                    self.blocks[to / LANES * rows + row][to % LANES] = self.value(slot, row);
                }
                self.indices[to] = self.indices[slot];
            }
            to += 1;
        }
        self.indices.truncate(to);
        self.blocks.truncate(to.div_ceil(LANES) * rows);
        if !to.is_multiple_of(LANES) {
            self.blocks[to / LANES * rows][to % LANES..].fill(REMOVED);
        }
    }

    /// Scans a range of slots, and perhaps a few around it, for a nearer accepted point.
    pub fn scan(
        &self,
        slots: Range<usize>,
        query: &Query<'_>,
        best: &mut Best,
        accept: &mut impl FnMut(usize) -> bool,
    ) {
        let rows = self.rows();
        let (first, end) = (slots.start / LANES, slots.end.div_ceil(LANES));
        for (number, block) in self.blocks[first * rows..end * rows].chunks_exact(rows).enumerate() {
            let Some(sums) = self.sums(block, query, best.distance) else {
                continue;
            };
            let slot = (first + number) * LANES;
            for (lane, &sum) in sums.iter().enumerate().take(self.len() - slot) {
                if sum <= best.distance {
                    let index = self.index(slot + lane);
                    if best.is_beaten_by(sum, index) && accept(index) {
                        (best.distance, best.index) = (sum, index);
                    }
                }
            }
        }
        best.searched += slots.len();
    }

    /// The squared distances of a block, if any of them is at most `most`.
    fn sums(&self, block: &[[f32; LANES]], query: &Query<'_>, most: f32) -> Option<[f32; LANES]> {
        let mut sums = [0.0f32; LANES];
        let (reals, modes) = block.split_at(self.reals);
        for (chunk, rows) in reals.chunks(ROWS_AT_ONCE).enumerate() {
            for (at, row) in rows.iter().enumerate() {
                let value = query.reals[chunk * ROWS_AT_ONCE + at];
                for lane in 0..LANES {
                    let d = row[lane] - value;
                    sums[lane] += d * d;
                }
            }
            // The sums only grow.
            if !any_at_most(&sums, most) {
                return None;
            }
        }
        if modes.is_empty() && query.differing == 0 {
            return Some(sums);
        }
        for (at, row) in modes.iter().enumerate() {
            let value = query.modes[at];
            for lane in 0..LANES {
                sums[lane] += if row[lane] == value { 0.0 } else { query.penalty };
            }
        }
        for _ in 0..query.differing {
            for sum in &mut sums {
                *sum += query.penalty;
            }
        }
        any_at_most(&sums, most).then_some(sums)
    }
}

/// Branch-free, so that the compiler can vectorise.
fn any_at_most(sums: &[f32; LANES], most: f32) -> bool {
    sums.iter().fold(false, |any, sum| any | (*sum <= most))
}

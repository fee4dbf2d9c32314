//! Nearest neighbours by a linear scan: exact, ties to the lower index. Points stand in blocks of sixteen, one
//! coordinate after the other, so that the compiler can use vector instructions.

const LANES: usize = 16;
/// Where a removed point is moved: farther than any point, as coordinates are finite.
const REMOVED: f32 = f32::INFINITY;

/// Points with real coordinates and modes; a mode that differs adds a fixed penalty to the squared distance.
#[derive(Debug, Clone)]
pub struct Linear {
    reals: usize,
    modes: usize,
    penalty: f32,
    len: usize,
    blocks: Vec<[f32; LANES]>,
}

impl Linear {
    /// An empty set of points of `reals` coordinates and `modes` modes.
    pub fn new(reals: usize, modes: usize, penalty: f32) -> Self {
        // A removed point needs a coordinate to be removed by.
        Linear { reals: reals.max(1), modes, penalty, len: 0, blocks: Vec::new() }
    }

    fn rows(&self) -> usize {
        self.reals + self.modes
    }

    /// Forgets all points, keeps the memory.
    pub fn clear(&mut self) {
        self.len = 0;
        self.blocks.clear();
    }

    /// The number of points, removed ones included.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a point; its index is the number of points before it.
    pub fn push(&mut self, reals: &[f32], modes: &[f32]) {
        let rows = self.rows();
        if self.len.is_multiple_of(LANES) {
            let at = self.blocks.len();
            self.blocks.resize(at + rows, [0.0; LANES]);
            self.blocks[at] = [REMOVED; LANES];
        }
        let (block, lane) = (self.len / LANES * rows, self.len % LANES);
        self.blocks[block][lane] = 0.0;
        for (row, value) in reals.iter().enumerate() {
            self.blocks[block + row][lane] = *value;
        }
        for (row, value) in modes.iter().enumerate() {
            self.blocks[block + self.reals + row][lane] = *value;
        }
        self.len += 1;
    }

    /// Takes a point out.
    pub fn remove(&mut self, index: usize) {
        let block = index / LANES * self.rows();
        self.blocks[block][index % LANES] = REMOVED;
    }

    /// x
    pub fn nearest_where(
        &self,
        reals: &[f32],
        modes: &[f32],
        mut accept: impl FnMut(usize) -> bool,
    ) -> Option<Neighbour> {
        let mut best = (f32::INFINITY, 0);
        for (number, block) in self.blocks.chunks_exact(self.rows()).enumerate() {
            let mut sums = [0.0f32; LANES];
            let (real_rows, mode_rows) = block.split_at(self.reals);
            for (row, value) in real_rows.iter().zip(reals.iter().chain(std::iter::repeat(&0.0))) {
                for lane in 0..LANES {
                    let d = row[lane] - value;
                    sums[lane] += d * d;
                }
            }
            for (row, value) in mode_rows.iter().zip(modes) {
                for lane in 0..LANES {
                    sums[lane] += if row[lane] == *value { 0.0 } else { self.penalty };
                }
            }
            let least = sums.iter().copied().fold(f32::INFINITY, f32::min);
            if least < best.0 {
                for lane in 0..LANES {
                    if sums[lane] < best.0 && accept(number * LANES + lane) {
                        best = (sums[lane], number * LANES + lane);
                    }
                }
            }
        }
        (best.0 < f32::INFINITY).then_some(Neighbour { index: best.1, distance: best.0 })
    }

    /// x
    pub fn nearest(&self, reals: &[f32], modes: &[f32]) -> Option<usize> {
        self.nearest_where(reals, modes, |_| true).map(|n| n.index)
    }
}

/// The nearest point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Which.
    pub index: usize,
    /// The squared distance.
    pub distance: f32,
}

/// Points.
#[derive(Debug, Clone)]
pub struct Index(Linear);

impl Index {
    /// New.
    pub fn new(reals: usize, modes: usize, penalty: f32) -> Self {
        Index(Linear::new(reals, modes, penalty))
    }
    /// x
    pub fn clear(&mut self) {
        self.0.clear();
    }
    /// x
    pub fn push(&mut self, reals: &[f32], modes: &[f32]) {
        self.0.push(reals, modes);
    }
    /// x
    pub fn remove(&mut self, index: usize) {
        self.0.remove(index);
    }
    /// x
    pub fn nearest(&self, reals: &[f32], modes: &[f32]) -> Option<Neighbour> {
        self.0.nearest_where(reals, modes, |_| true)
    }
    /// x
    pub fn nearest_where(&self, reals: &[f32], modes: &[f32], accept: impl FnMut(usize) -> bool) -> Option<Neighbour> {
        self.0.nearest_where(reals, modes, accept)
    }
    /// x
    pub fn bytes(&self) -> usize {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute(points: &[(Vec<f32>, Vec<f32>, bool)], reals: &[f32], modes: &[f32]) -> Option<usize> {
        let mut best: Option<(f32, usize)> = None;
        for (i, (r, m, alive)) in points.iter().enumerate() {
            let mut sum = 0.0;
            for (a, b) in r.iter().zip(reals) {
                sum += (a - b) * (a - b);
            }
            for (a, b) in m.iter().zip(modes) {
                sum += if a == b { 0.0 } else { 0.5 };
            }
            if *alive && best.is_none_or(|(least, _)| sum < least) {
                best = Some((sum, i));
            }
        }
        best.map(|(_, i)| i)
    }

    proptest! {
        /// Few distinct values, as game states have: ties are common and must go to the lower index.
        #[test]
        fn agrees_with_brute_force(
            points in prop::collection::vec(
                (prop::collection::vec((0..4).prop_map(|v| v as f32 / 4.0), 3),
                 prop::collection::vec((0..3).prop_map(|v| v as f32), 2), any::<bool>()), 1..70),
            query in prop::collection::vec((0..4).prop_map(|v| v as f32 / 4.0), 3),
            modes in prop::collection::vec((0..3).prop_map(|v| v as f32), 2),
        ) {
            let mut linear = Linear::new(3, 2, 0.5);
            for (r, m, _) in &points {
                linear.push(r, m);
            }
            for (i, (.., alive)) in points.iter().enumerate() {
                if !alive {
                    linear.remove(i);
                }
            }
            prop_assert_eq!(linear.nearest(&query, &modes), brute(&points, &query, &modes));
        }
    }
}

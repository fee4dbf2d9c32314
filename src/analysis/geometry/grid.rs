//! The plane of the positions of a kind in a space, cut at all lines at which pushes can end: each cell lies completely
//! inside or outside of blocking obstacles.

use crate::ir::SpaceId;

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::{ROUNDING, rounded, rounding};
use crate::analysis::geometry::local::Surfaces;

/// Margin of the plane around all obstacles, px.
pub(in crate::analysis) const MARGIN: f64 = 1.0;
/// Half the size of a cell for an exact fit, px.
pub(in crate::analysis) const THIN: f64 = 4.0 * ROUNDING;

/// The cells of a space. They share their edges.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) struct Grid {
    pub space: SpaceId,
    /// The lines between cells, and each as far as rounding goes to both sides of it: lowest and highest positions.
    lines: [Vec<f64>; 2],
    rounded: [[Vec<f64>; 2]; 2],
    /// Row by row, whether a cell lies inside a blocking obstacle.
    pub is_blocked: Vec<bool>,
}

/// How far ends are widened, in rounding errors of touching edges.
const SNAP: f64 = 3.0;

impl Grid {
    /// `around` is what the lines surround, `blocking` returns the positions inside of blocking obstacles. `None` if there
    /// are more than `most` cells, or if some would be too narrow to represent.
    pub fn new(
        space: SpaceId,
        surfaces: &Surfaces,
        probed: [Vec<f64>; 2],
        around: [Interval; 2],
        most: usize,
        blocking: impl Fn() -> Vec<[Interval; 2]>,
    ) -> Option<Grid> {
        let lines = [0, 1].map(|axis| {
            let [mut lines, mut others] = surfaces.lines(axis);
            [&mut lines, &mut others].into_iter().for_each(in_order);
            // An exact fit between two obstacles gets its own cell.
            let is_at = |x: f64| {
                let at = others.partition_point(|o| *o < x - ROUNDING / 2.0);
                others.get(at).is_some_and(|o| *o <= x + ROUNDING / 2.0)
            };
            let thin: Vec<f64> = lines.iter().copied().filter(|x| is_at(*x)).collect();
            lines.extend(others);
            in_order(&mut lines);
            lines.retain(|x| thin.iter().all(|t| (t - x).abs() > ROUNDING / 2.0));
            lines.extend(thin.into_iter().flat_map(|x| [x - THIN, x + THIN]));
            if !probed[axis].is_empty() {
                lines.extend(&probed[axis]);
                in_order(&mut lines);
            }
            lines.push(around[axis].low - MARGIN);
            lines.push(around[axis].high + MARGIN);
            lines.sort_by(f64::total_cmp);
            lines
        });
        // Nearly equal lines would leave slivers that are too narrow to represent.
        let is_sliver = |lines: &[f64]| lines.windows(2).any(|pair| pair[1] - pair[0] < THIN);
        if lines.iter().any(|lines| is_sliver(lines)) {
            return None;
        }
        let ends = |lines: &Vec<f64>, end: fn(Interval) -> f64| {
            lines.iter().map(|x| end(rounded(Interval::point(*x)))).collect::<Vec<f64>>()
        };
        let rounded = [0, 1].map(|axis| [ends(&lines[axis], |i| i.low), ends(&lines[axis], |i| i.high)]);
        let mut grid = Grid { space, lines, rounded, is_blocked: Vec::new() };
        let (across, up) = (grid.count(0), grid.count(1));
        if across.saturating_mul(up) > most {
            return None;
        }
        grid.is_blocked = vec![false; across * up];
        for sides in blocking() {
            let inside = |axis: usize, at: usize| {
                let Interval { low, high } = grid.side(axis, at);
                low.is_finite() && high.is_finite() && sides[axis].contains((low + high) / 2.0)
            };
            let columns: Vec<usize> = (0..across).filter(|at| inside(0, *at)).collect();
            let rows: Vec<usize> = (0..up).filter(|at| inside(1, *at)).collect();
            for row in rows {
                columns.iter().for_each(|column| grid.is_blocked[row * across + column] = true);
            }
        }
        Some(grid)
    }

    /// Number of cells along an axis.
    pub fn count(&self, axis: usize) -> usize {
        self.lines[axis].len() + 1
    }

    /// The side of the cells at a place along an axis.
    pub fn side(&self, axis: usize, at: usize) -> Interval {
        let lines = &self.lines[axis];
        let low = at.checked_sub(1).and_then(|i| lines.get(i)).copied().unwrap_or(f64::NEG_INFINITY);
        Interval { low, high: lines.get(at).copied().unwrap_or(f64::INFINITY) }
    }

    /// The largest boxes in the hull of a position whose cells are all blocked, or all free.
    pub fn parts(&self, [x, y]: [Interval; 2]) -> Vec<([Interval; 2], bool)> {
        let columns = self.range(0, x);
        let of = |row: usize| {
            let first = row * self.count(0);
            self.is_blocked.get(first + columns.start()..=first + columns.end()).unwrap_or_default()
        };
        let rows = self.range(1, y);
        let is_blocked = of(*rows.start()).first().copied().unwrap_or_default();
        if rows.clone().all(|row| of(row).iter().all(|cell| *cell == is_blocked)) {
            return vec![([x, y], is_blocked)];
        }
        let mut out = Vec::new();
        let rows: Vec<usize> = rows.collect();
        for rows in rows.chunk_by(|a, b| of(*a) == of(*b)) {
            let up = self.side(1, rows[0]).or(self.side(1, rows[rows.len() - 1]));
            let cells: Vec<(usize, bool)> = columns.clone().zip(of(rows[0]).iter().copied()).collect();
            for run in cells.chunk_by(|a, b| a.1 == b.1) {
                let across = self.side(0, run[0].0).or(self.side(0, run[run.len() - 1].0));
                if let (Some(x), Some(y)) = (rounded(across).and(x), rounded(up).and(y)) {
                    out.push(([x, y], run[0].1));
                }
            }
        }
        out
    }

    /// The lowest line.
    pub fn bottom(&self) -> f64 {
        self.lines[1].first().copied().unwrap_or(f64::NEG_INFINITY)
    }

    /// Whether any cell that a box overlaps is free.
    pub fn is_free(&self, [x, y]: [Interval; 2]) -> bool {
        let columns = self.range(0, x);
        self.range(1, y).any(|row| columns.clone().any(|column| !self.is_blocked[row * self.count(0) + column]))
    }

    /// The runs of columns under an interval along x that differ in nothing at some height: all that a body reaches that
    /// moves along without rising or falling. Each with the part of the interval that lies in it.
    pub fn runs(&self, [x, y]: [Interval; 2]) -> Vec<(Interval, Interval)> {
        let rows: Vec<usize> = self.range(1, y).collect();
        let alike = |a: usize, b: usize| {
            rows.iter().all(|row| {
                let at = |column: usize| self.is_blocked[row * self.count(0) + column];
                at(a) == at(b)
            })
        };
        let mut out = Vec::new();
        let (mut at, last) = (*self.range(0, x).start(), *self.range(0, x).end());
        while at <= last {
            let mut low = at;
            while low > 1 && alike(low - 1, at) {
                low -= 1;
            }
            let mut high = at;
            while high + 2 < self.count(0) && alike(high + 1, at) {
                high += 1;
            }
            let run = rounded(self.side(0, low).or(self.side(0, high)));
            if let Some(part) = run.and(x) {
                out.push((run, part));
            }
            at = high + 1;
        }
        out
    }

    /// An interval along an axis, widened a little so that its ends at a line are the same wherever it comes from.
    pub fn snapped(&self, axis: usize, x: Interval) -> Interval {
        let at = |end: f64| {
            let lines = &self.lines[axis];
            let after = lines.partition_point(|line| *line < end);
            let near = [after.checked_sub(1).and_then(|at| lines.get(at)), lines.get(after)];
            near.into_iter().flatten().copied().find(|line| (line - end).abs() <= SNAP * rounding(*line))
        };
        Interval {
            low: at(x.low).map_or(x.low, |line| line - SNAP * rounding(line)),
            high: at(x.high).map_or(x.high, |line| line + SNAP * rounding(line)),
        }
    }

    /// The cells along an axis that an interval overlaps.
    pub fn range(&self, axis: usize, hull: Interval) -> std::ops::RangeInclusive<usize> {
        let [lows, highs] = &self.rounded[axis];
        highs.partition_point(|high| *high < hull.low)..=lows.partition_point(|low| *low <= hull.high)
    }
}

/// Sorts lines and removes duplicates.
fn in_order(lines: &mut Vec<f64>) {
    lines.sort_by(f64::total_cmp);
    lines.dedup_by(|a, b| (*a - *b).abs() <= ROUNDING / 2.0);
}

//! Spatial indices for [`crate::analysis::membership`]: rows by position, and the boxes of a region.

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::region::Region;
use crate::ir::Extremes;

/// Maximum number of bins of a grid along an axis.
const MAX_BINS: usize = 256;

/// A uniform grid over the hull of all rows; bins at the border also cover everything beyond it.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Grid {
    low: [f64; 2],
    /// Bins per px.
    scale: [f64; 2],
    count: usize,
    /// The first item of each bin, row by row, and the end of the last.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Grid {
    /// `None` if the rows have no finite ends to tell them apart.
    pub fn new(hulls: &[[Interval; 2]]) -> Option<Grid> {
        let ends = |axis: usize| {
            let ends = hulls.iter().flat_map(move |hull| [hull[axis].low, hull[axis].high]);
            let ends = ends.filter(|x| x.is_finite()).map(Interval::point);
            ends.reduce(Interval::or)
        };
        let around = [ends(0)?, ends(1)?];
        let count = ((hulls.len() as f64).sqrt() as usize).clamp(1, MAX_BINS);
        let scale = around.map(|i| if i.low < i.high { count as f64 / (i.high - i.low) } else { 0.0 });
        let mut grid = Grid { low: around.map(|i| i.low), scale, count, starts: Vec::new(), items: Vec::new() };
        let mut bins: Vec<Vec<u32>> = vec![Vec::new(); count * count];
        for (number, hull) in (0..).zip(hulls).filter(|(_, hull)| hull.iter().all(|i| i.low <= i.high)) {
            let range = |axis: usize| grid.bin(axis, hull[axis].low)..=grid.bin(axis, hull[axis].high);
            for up in range(1) {
                range(0).for_each(|across| bins[up * count + across].push(number));
            }
        }
        for bin in bins {
            grid.starts.push(grid.items.len() as u32);
            grid.items.extend(bin);
        }
        grid.starts.push(grid.items.len() as u32);
        Some(grid)
    }

    /// Monotonic in `x`, so the bin of a number lies between the bins of the ends of any interval around it.
    #[inline]
    fn bin(&self, axis: usize, x: f64) -> usize {
        // The cast saturates at 0.
        (((x - self.low[axis]) * self.scale[axis]) as usize).min(self.count - 1)
    }

    /// A superset of the rows that contain a position.
    #[inline]
    pub fn around(&self, at: [f64; 2]) -> &[u32] {
        let bin = self.bin(1, at[1]) * self.count + self.bin(0, at[0]);
        match self.starts.get(bin..bin + 2) {
            Some(&[from, to]) => slice(&self.items, (from, to)),
            _ => &[],
        }
    }
}

/// The boxes of a region, grouped by their intervals along y.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Boxes {
    rows: Lookup<(u32, u32)>,
    across: Vec<Lookup<()>>,
}

impl Boxes {
    pub fn new(region: &Region) -> Boxes {
        let mut boxes = region.boxes().to_vec();
        let key = |i: Interval| (i.low, i.high);
        boxes.sort_by(|a, b| {
            let ((al, ah), (bl, bh)) = (key(a[1]), key(b[1]));
            al.total_cmp(&bl).then(ah.total_cmp(&bh)).then(a[0].low.total_cmp(&b[0].low))
        });
        let mut rows = Vec::new();
        let mut across = Vec::new();
        for row in boxes.chunk_by(|a, b| a[1] == b[1]) {
            rows.push((row[0][1], (across.len() as u32, 0)));
            across.push(Lookup::new(row.iter().map(|b| (b[0], ())).collect()));
        }
        Boxes { rows: Lookup::new(rows), across }
    }

    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        self.rows.around(y).any(|(_, (row, _))| self.across[*row as usize].around(x).next().is_some())
    }

    /// Text of the boxes at the height of a position.
    pub fn text(&self, [_, y]: [f64; 2]) -> String {
        let rows: Vec<String> = self
            .rows
            .around(y)
            .flat_map(|(up, (row, _))| {
                let along = self.across[*row as usize].items.iter();
                along.map(move |(x, ())| format!("x in {} and y in {}", exact_text(&[*x]), exact_text(&[*up])))
            })
            .collect();
        if rows.is_empty() { "nothing at this height".to_string() } else { rows.join(", or ") }
    }
}

/// Intervals with a point query.
#[derive(Debug, Clone)]
struct Lookup<T> {
    /// In order of their low ends.
    items: Vec<(Interval, T)>,
    /// Prefix maxima of the high ends.
    reach: Vec<f64>,
}

impl<T> Lookup<T> {
    /// `items` must be in order of their low ends.
    fn new(items: Vec<(Interval, T)>) -> Self {
        let reach = items.iter().scan(f64::NEG_INFINITY, |most, (i, _)| {
            *most = most.greatest(i.high);
            Some(*most)
        });
        Lookup { reach: reach.collect(), items }
    }

    /// The intervals that contain a number.
    fn around(&self, x: f64) -> impl Iterator<Item = &(Interval, T)> {
        let after = self.items.partition_point(|(i, _)| i.low <= x);
        let below = (0..after).rev().take_while(move |&index| x <= self.reach[index]);
        below.map(|index| &self.items[index]).filter(move |(i, _)| i.contains(x))
    }
}

/// Intervals with all their digits.
pub(in crate::analysis) fn exact_text(intervals: &[Interval]) -> String {
    let one = |i: &Interval| match i.is_point() {
        true => i.low.to_string(),
        false => format!("{}..{}", i.low, i.high),
    };
    match intervals {
        [] => "none".to_string(),
        several => several.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// A range of some items.
#[inline]
pub(in crate::analysis) fn slice<T>(items: &[T], (from, to): (u32, u32)) -> &[T] {
    items.get(from as usize..to as usize).unwrap_or_default()
}

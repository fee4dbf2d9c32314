//! Looking things up by where they are: rows by place, and the boxes of a region. For [`crate::analysis::membership`].

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::region::Region;

/// The most bins of a grid along an axis.
const MAX_BINS: usize = 256;

/// Rows by where they are: the plane around all their ends, in bins of the same size; what lies beyond belongs to the bins at
/// the border.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Grid {
    low: [f64; 2],
    /// Bins for each px.
    scale: [f64; 2],
    count: usize,
    /// The first item of each bin, row by row, and the end of the last.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Grid {
    /// None if the rows have no finite ends to tell them apart.
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

    /// It never decreases as `x` grows, so that what is in an interval is in a bin between those of its ends.
    #[inline]
    fn bin(&self, axis: usize, x: f64) -> usize {
        // A cast puts what is too low at 0.
        (((x - self.low[axis]) * self.scale[axis]) as usize).min(self.count - 1)
    }

    /// The rows that can be at a place, and others.
    #[inline]
    pub fn around(&self, at: [f64; 2]) -> &[u32] {
        let bin = self.bin(1, at[1]) * self.count + self.bin(0, at[0]);
        match self.starts.get(bin..bin + 2) {
            Some(&[from, to]) => slice(&self.items, (from, to)),
            _ => &[],
        }
    }
}

/// The boxes of a region, by the intervals along y that they share.
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

    /// The boxes at the height of a place, as text.
    pub fn text(&self, [_, y]: [f64; 2]) -> String {
        let rows: Vec<String> = self
            .rows
            .around(y)
            .flat_map(|(up, (row, _))| {
                let along = self.across[*row as usize].items.iter();
                along.map(move |(x, ())| format!("x in {} and y in {}", whole(&[*x]), whole(&[*up])))
            })
            .collect();
        if rows.is_empty() { "nothing at this height".to_string() } else { rows.join(", or ") }
    }
}

/// Intervals in which a number is looked for.
#[derive(Debug, Clone)]
struct Lookup<T> {
    /// By their low ends.
    items: Vec<(Interval, T)>,
    /// The highest end of all up to each.
    reach: Vec<f64>,
}

impl<T> Lookup<T> {
    /// Of intervals in the order of their low ends.
    fn new(items: Vec<(Interval, T)>) -> Self {
        let reach = items.iter().scan(f64::NEG_INFINITY, |most, (i, _)| {
            *most = most.max(i.high);
            Some(*most)
        });
        Lookup { reach: reach.collect(), items }
    }

    /// Those that a number is in.
    fn around(&self, x: f64) -> impl Iterator<Item = &(Interval, T)> {
        let after = self.items.partition_point(|(i, _)| i.low <= x);
        let below = self.items[..after].iter().zip(&self.reach[..after]).rev();
        below.take_while(move |(_, reach)| x <= **reach).map(|(item, _)| item).filter(move |(i, _)| i.contains(x))
    }
}

/// Intervals with all their digits.
pub(in crate::analysis) fn whole(intervals: &[Interval]) -> String {
    let one = |i: &Interval| match i.is_point() {
        true => i.low.to_string(),
        false => format!("{}..{}", i.low, i.high),
    };
    match intervals {
        [] => "none".to_string(),
        several => several.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// A part of some items.
#[inline]
pub(in crate::analysis) fn slice<T>(items: &[T], (from, to): (u32, u32)) -> &[T] {
    items.get(from as usize..to as usize).unwrap_or_default()
}

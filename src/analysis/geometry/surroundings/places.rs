//! Where an instance can be that meets another: many boxes of positions, joined in rows so that those under a position
//! are found at once.

use std::collections::BTreeMap;

use crate::ir::SpaceId;

use crate::analysis::domain::values::Interval;

/// Height of a row, px: heights that differ by less are not told apart.
const ROW: f64 = 8.0;
/// Maximum number of rows of a box, and the number of the row of all that is taller or without end.
const MAX_ROWS: i64 = 1 << 12;
const TALL: i64 = i64::MIN;

/// Boxes of positions in spaces, px.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Places {
    /// Of each row of a space: boxes in order along x, apart.
    rows: BTreeMap<(SpaceId, i64), Vec<[Interval; 2]>>,
}

impl Places {
    /// The hull, row by row, of some boxes.
    pub fn new(boxes: impl IntoIterator<Item = (SpaceId, [Interval; 2])>) -> Places {
        let mut rows: BTreeMap<(SpaceId, i64), Vec<[Interval; 2]>> = BTreeMap::new();
        for (space, [x, y]) in boxes {
            let Some((first, last)) = row_range(y) else {
                rows.entry((space, TALL)).or_default().push([x, y]);
                continue;
            };
            for row in first..=last {
                let side = Interval { low: row as f64 * ROW, high: (row + 1) as f64 * ROW };
                if let Some(y) = side.and(y) {
                    rows.entry((space, row)).or_default().push([x, y]);
                }
            }
        }
        for row in rows.values_mut() {
            row.sort_by(|a, b| a[0].low.total_cmp(&b[0].low));
            row.dedup_by(|next, last| {
                let meets = next[0].low <= last[0].high;
                if meets {
                    *last = [last[0].or(next[0]), last[1].or(next[1])];
                }
                meets
            });
        }
        Places { rows }
    }

    /// Adds the parts of a box of positions in a space that are among them.
    pub fn within(&self, space: SpaceId, [x, y]: [Interval; 2], out: &mut Vec<[Interval; 2]>) {
        let (first, last) = row_range(y).unwrap_or((TALL + 1, i64::MAX));
        // What lies on the border between two rows is in both.
        let near = self.rows.range((space, first.saturating_sub(1))..=(space, last));
        let tall = self.rows.range((space, TALL)..=(space, TALL));
        for (_, row) in tall.chain(near) {
            let from = row.partition_point(|place| place[0].high < x.low);
            let there = row[from..].iter().take_while(|place| place[0].low <= x.high);
            out.extend(there.filter_map(|place| Some([place[0].and(x)?, place[1].and(y)?])));
        }
    }
}

/// The rows of an interval of heights; `None` if it is too tall.
fn row_range(y: Interval) -> Option<(i64, i64)> {
    let (first, last) = ((y.low / ROW).floor(), (y.high / ROW).floor());
    // What is that far off is exact in neither.
    let is_short = last - first <= MAX_ROWS as f64 && first.abs() < 1e15 && last.abs() < 1e15;
    is_short.then_some((first as i64, last as i64))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SPACE: SpaceId = SpaceId(0);

    fn interval() -> impl Strategy<Value = Interval> {
        let end = prop_oneof![
            -99.0..99.0,
            Just(f64::INFINITY),
            Just(f64::NEG_INFINITY),
            (-9..9i32).prop_map(|n| f64::from(n) * ROW)
        ];
        (end.clone(), end).prop_map(|(a, b)| Interval::between(a, b))
    }

    proptest! {
        #[test]
        fn each_place_of_each_box_is_found(
            boxes in prop::collection::vec((interval(), interval()), 1..20),
            at in (interval(), interval()),
        ) {
            let boxes: Vec<_> = boxes.into_iter().map(|(x, y)| [x, y]).collect();
            let places = Places::new(boxes.iter().map(|place| (SPACE, *place)));
            let mut found = Vec::new();
            places.within(SPACE, [at.0, at.1], &mut found);
            for place in boxes {
                let (Some(x), Some(y)) = (place[0].and(at.0), place[1].and(at.1)) else { continue };
                for (x, y) in [(x.low, y.low), (x.low, y.high), (x.high, y.low), (x.high, y.high)] {
                    let is_found = found.iter().any(|place: &[Interval; 2]| place[0].contains(x) && place[1].contains(y));
                    prop_assert!(is_found, "({x}, {y})");
                }
            }
            places.within(SpaceId(1), [Interval::ALL; 2], &mut found);
            prop_assert!(found.iter().all(|place| place[0].and(at.0) == Some(place[0]) && place[1].and(at.1) == Some(place[1])));
        }
    }
}

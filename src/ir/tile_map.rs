//! A grid of tiles, as levels provide it and worlds store it.

use serde::{Deserialize, Serialize};

use super::{Bounds, Breakable, Slope};

/// A grid of tiles. Column 0 is the leftmost, row 0 the lowest; its lower-left corner is the space's origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TileMap<T> {
    /// The number of columns.
    pub columns: usize,
    /// The number of rows.
    pub rows: usize,
    /// Width and height of a tile, px.
    pub tile: (f64, f64),
    /// The kinds of tiles.
    pub kinds: Vec<TileKind<T>>,
    /// The kind of each tile, row by row from the lowest.
    pub cells: Vec<u16>,
}

/// A kind of tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TileKind<T> {
    /// Its character in the text.
    pub symbol: char,
    /// Its tags.
    pub tags: Vec<T>,
    /// The line up to which tiles of the kind are solid; all of the tile is if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slope: Option<Slope>,
    /// Whether tiles of the kind can be broken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub breakable: Option<Breakable>,
}

impl<T> TileKind<T> {
    /// Whether a tile of the kind is always there, in all of its cell.
    pub fn lasts(&self) -> bool {
        self.breakable.is_none() && self.slope.is_none()
    }
}

impl<T> TileMap<T> {
    /// The kind of the tile at a column and a row; `None` outside the map.
    pub fn kind(&self, column: i64, row: i64) -> Option<usize> {
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        if column >= self.columns {
            return None;
        }
        self.cells.get(row * self.columns + column).map(|&k| usize::from(k))
    }

    /// The rectangle of a tile by the index of its cell: lower-left corner, width and height, px.
    pub fn rectangle(&self, cell: usize) -> [f64; 4] {
        let (column, row) = ((cell % self.columns) as f64, (cell / self.columns) as f64);
        [column * self.tile.0, row * self.tile.1, self.tile.0, self.tile.1]
    }

    /// The number of tiles of the kinds that pass a test.
    pub fn count(&self, is_counted: impl Fn(&TileKind<T>) -> bool) -> usize {
        let counted: Vec<bool> = self.kinds.iter().map(is_counted).collect();
        self.cells.iter().filter(|kind| counted.get(usize::from(**kind)).is_some_and(|is| *is)).count()
    }

    /// For each cell, whether one of some boxes is near: at most a cell and a slack in px away. By two-dimensional prefix
    /// sums; empty if there are no boxes.
    pub fn cells_near(&self, boxes: impl IntoIterator<Item = Bounds>, slack: f64) -> Vec<bool> {
        let mut boxes = boxes.into_iter().peekable();
        if boxes.peek().is_none() {
            return Vec::new();
        }
        let across = self.columns + 1;
        let mut counts = vec![0i32; across * (self.rows + 1)];
        for Bounds { left, right, bottom, top } in boxes {
            let range = |low: f64, high: f64, size: f64, count: usize| {
                let first = ((low - slack) / size).floor() - 1.0;
                let after = ((high + slack) / size).ceil() + 1.0;
                (first.clamp(0.0, count as f64) as usize, after.clamp(0.0, count as f64) as usize)
            };
            let (first, after) = range(left, right, self.tile.0, self.columns);
            let (low, high) = range(bottom, top, self.tile.1, self.rows);
            for (row, sign) in [(low, 1), (high, -1)] {
                counts[row * across + first] += sign;
                counts[row * across + after] -= sign;
            }
        }
        for at in 1..counts.len() {
            if at % across != 0 {
                counts[at] += counts[at - 1];
            }
        }
        for at in across..counts.len() {
            counts[at] += counts[at - across];
        }
        let cell = |at: usize| counts[at / self.columns * across + at % self.columns] > 0;
        (0..self.columns * self.rows).map(cell).collect()
    }

    /// Width and height of the whole map, px.
    pub fn size(&self) -> (f64, f64) {
        (self.columns as f64 * self.tile.0, self.rows as f64 * self.tile.1)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn cells_near_a_box_are_those_that_it_touches_and_their_neighbours(
            (columns, rows) in (1..9_usize, 1..9_usize),
            boxes in prop::collection::vec((-3..12_i32, -3..12_i32, 0..5_i32, 0..5_i32), 0..5),
        ) {
            let (width, height) = (16.0, 8.0);
            let cells = vec![0; columns * rows];
            let map = TileMap::<()> { columns, rows, tile: (width, height), kinds: Vec::new(), cells };
            // In halves of cells.
            let half = |size: f64, count: i32| size / 2.0 * f64::from(count);
            let boxes: Vec<Bounds> = boxes
                .into_iter()
                .map(|(x, y, w, h)| Bounds {
                    left: half(width, x),
                    right: half(width, x + w),
                    bottom: half(height, y),
                    top: half(height, y + h),
                })
                .collect();
            let near = map.cells_near(boxes.iter().copied(), 0.5);
            for cell in 0..columns * rows {
                let [x, y, ..] = map.rectangle(cell);
                let is_near = |of: &Bounds| {
                    let (x, y) = ((x - width - 0.5, x + 2.0 * width + 0.5), (y - height - 0.5, y + 2.0 * height + 0.5));
                    of.left < x.1 && of.right > x.0 && of.bottom < y.1 && of.top > y.0
                };
                let is_near = boxes.iter().any(is_near);
                prop_assert_eq!(near.get(cell).copied().unwrap_or(false), is_near, "cell {}", cell);
            }
        }
    }
}

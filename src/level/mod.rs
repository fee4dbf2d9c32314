//! Tile maps: a grid of kinds of tiles, each kind a list of tags. Read from rows of text, with a tile set of one's own
//! or a legend of the Video Game Level Corpus, and from files of the level editors Tiled and LDtk.

mod drawn;
mod editor;
mod inline;
mod ldtk;
mod legend;
mod node;
mod numbers;
mod objects;
mod tiled;

pub use drawn::{Drawn, Meaning, Setting, Thing, Value};
pub use editor::{Format, drawn, read_beside};
pub use inline::{InlineTile, inline_map, text_rows};
pub use legend::legend;

use serde::Serialize;

/// The most tiles one map may have.
pub const MAX_TILES: usize = 4_000_000;
/// The most things, and the most rectangles, that a level of an editor may have.
pub const MAX_THINGS: usize = 100_000;
/// Positions, sizes and edges in a level are at most so far from 0, px: whatever is added to them stays a number.
pub const MAX_LENGTH: f64 = 1e12;

/// A grid of tiles. Column 0 is the leftmost, row 0 the lowest; its lower-left corner is the space's origin.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TileKind<T> {
    /// Its character in the text.
    pub symbol: char,
    /// Its tags.
    pub tags: Vec<T>,
}

impl<T> TileMap<T> {
    /// The kind of the tile at a column and a row; none outside of the map.
    pub fn kind(&self, column: i64, row: i64) -> Option<usize> {
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        if column >= self.columns {
            return None;
        }
        self.cells.get(row * self.columns + column).map(|&k| usize::from(k))
    }

    /// Where a tile is, by its index among the cells: its lower-left corner, its width and its height, px.
    pub fn rectangle(&self, cell: usize) -> [f64; 4] {
        let (column, row) = ((cell % self.columns) as f64, (cell / self.columns) as f64);
        [column * self.tile.0, row * self.tile.1, self.tile.0, self.tile.1]
    }

    /// Width and height of the whole map, px.
    pub fn size(&self) -> (f64, f64) {
        (self.columns as f64 * self.tile.0, self.rows as f64 * self.tile.1)
    }
}

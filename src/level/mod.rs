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
#[cfg(feature = "tiled")]
mod xml;

pub use drawn::{Drawn, Meaning, Setting, Thing, Value};
pub use editor::{Format, drawn, read_beside};
pub use inline::{InlineTile, inline_map, text_rows};
pub use legend::legend;

/// The most tiles one map may have.
pub const MAX_TILES: usize = 4_000_000;
/// The most things, and the most rectangles, that a level of an editor may have.
pub const MAX_THINGS: usize = 100_000;
/// Positions, sizes and edges in a level are at most so far from 0, px: whatever is added to them stays a number.
pub const MAX_LENGTH: f64 = 1e12;

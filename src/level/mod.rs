//! Tile maps: a grid of kinds of tiles, each kind a list of tags. Read from rows of text, with a tile set or a legend
//! of the Video Game Level Corpus, and from files of the level editors Tiled and LDtk.

mod brush;
mod editor;
mod editor_level;
mod inline;
mod ldtk;
mod legend;
mod node;
mod numbers;
mod objects;
mod tile_art;
mod tiled;
#[cfg(feature = "tiled")]
mod xml;

pub use brush::{Brush, Canvas};
pub use editor::{Format, level_names, read_dependencies, read_level};
pub use editor_level::{EditorLevel, Meaning, Object, Setting, Value};
pub use inline::{InlineTile, inline_map, text_rows};
pub use legend::legend;
pub use tile_art::TileArt;

/// Maximum number of tiles of a map.
pub const MAX_TILES: usize = 4_000_000;
/// Maximum number of objects, and of rectangles, of an editor's level.
pub const MAX_OBJECTS: usize = 100_000;
/// Maximum absolute value of positions, sizes and edges in a level, px: sums of them stay finite.
pub const MAX_LENGTH: f64 = 1e12;

//! The tiles of a world that can be broken, numbered: those that come back first, then by space, kind and cell. So the
//! tiles of a kind are neighbours, and the bits of those that come back lie together.

use serde::{Deserialize, Serialize};

use super::{Id, IdVec, Space, SpaceId, TagSet, TileId};

/// That a tile can be broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Breakable {
    /// The number of steps after which it is back; none if it stays broken.
    pub restore: Option<u16>,
}

/// The tiles of a world that can be broken.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BreakableTiles {
    /// Their kinds, in the order of the tiles.
    pub kinds: Vec<BreakableKind>,
    /// The space and the cell of each tile.
    pub places: IdVec<TileId, (SpaceId, u32)>,
    /// How many of them come back.
    pub restored: usize,
}

/// The tiles of a space that are of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BreakableKind {
    /// The space.
    pub space: SpaceId,
    /// The kind in the map of the space.
    pub kind: usize,
    /// What they count as.
    pub tags: TagSet,
    /// The first tile, and the one after the last.
    pub tiles: (TileId, TileId),
    /// The number of steps after which they are back.
    pub restore: Option<u16>,
}

impl BreakableTiles {
    /// Those of some spaces.
    pub fn of(spaces: &IdVec<SpaceId, Space>) -> BreakableTiles {
        let mut out = BreakableTiles::default();
        for comes_back in [true, false] {
            for (space, map) in spaces.pairs().filter_map(|(id, space)| Some((id, space.map.as_ref()?))) {
                for (kind, of) in map.kinds.iter().enumerate() {
                    let Some(breakable) = of.breakable.filter(|b| b.restore.is_some() == comes_back) else { continue };
                    let first = TileId::from_index(out.places.len());
                    for (cell, _) in map.cells.iter().enumerate().filter(|(_, k)| usize::from(**k) == kind) {
                        out.places.push((space, cell as u32));
                    }
                    let tiles = (first, TileId::from_index(out.places.len()));
                    let tags = of.tags.iter().copied().collect();
                    out.kinds.push(BreakableKind { space, kind, tags, tiles, restore: breakable.restore });
                }
            }
            if comes_back {
                out.restored = out.places.len();
            }
        }
        out
    }
}

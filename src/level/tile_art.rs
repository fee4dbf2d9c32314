//! The pictures of a level editor's tiles: which part of which picture each cell shows. Nothing that runs depends on it,
//! so that what cannot be shown is left out without a finding.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::ir::TilePicture;

use super::node::Node;

/// The bits of a tile's number that mirror it: horizontally, vertically, along the diagonal.
const MIRRORED: [(u32, u8); 3] = [(1 << 31, 1), (1 << 30, 2), (1 << 29, 4)];
/// Maximum number of tiles, and of different stacks of them.
const MAX: usize = u16::MAX as usize;

/// What distinguishes a tile from others of the map.
pub(super) type TileKey = [u32; 4];

/// How the bits of a tile's number in Tiled mirror it, as in [`TilePicture::mirrored`].
pub(super) fn mirrored(number: u32) -> u8 {
    MIRRORED.iter().filter(|(bit, _)| number & bit != 0).map(|(_, own)| own).sum()
}

/// What the cells of a map show.
#[derive(Debug, Clone, Default)]
pub struct TileArt {
    /// The paths of pictures.
    pub pictures: Vec<PathBuf>,
    /// Parts of pictures.
    pub tiles: Vec<TilePicture>,
    /// What cells show, the lowest tile first. The first one is nothing.
    pub stacks: Vec<Vec<u16>>,
    /// For each cell, row by row from the lowest, its stack.
    pub cells: Vec<u16>,
    known: BTreeMap<TileKey, Option<u16>>,
    joined: BTreeMap<(u16, u16), u16>,
}

impl TileArt {
    /// Of a map whose cells show nothing yet.
    pub(super) fn new(cells: usize) -> Self {
        TileArt { stacks: vec![Vec::new()], cells: vec![0; cells], ..TileArt::default() }
    }

    /// Whether no cell shows anything.
    pub(super) fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }

    /// Puts a tile over what a cell shows. `part` is asked once for each key.
    pub(super) fn put(
        &mut self,
        cell: usize,
        key: TileKey,
        mirrored: u8,
        part: impl FnOnce() -> Option<(PathBuf, [u32; 4])>,
    ) {
        let tile = match self.known.get(&key) {
            Some(known) => *known,
            None => {
                let tile = part().and_then(|(path, part)| self.tile(&path, part, mirrored));
                self.known.insert(key, tile);
                tile
            }
        };
        let (Some(tile), Some(&below)) = (tile, self.cells.get(cell)) else { return };
        let stack = match self.joined.get(&(below, tile)) {
            Some(&stack) => stack,
            None if self.stacks.len() >= MAX => return,
            None => {
                let mut stack = self.stacks.get(usize::from(below)).cloned().unwrap_or_default();
                stack.push(tile);
                self.stacks.push(stack);
                let id = (self.stacks.len() - 1) as u16;
                self.joined.insert((below, tile), id);
                id
            }
        };
        if let Some(cell) = self.cells.get_mut(cell) {
            *cell = stack;
        }
    }

    fn tile(&mut self, path: &Path, part: [u32; 4], mirrored: u8) -> Option<u16> {
        let picture = self.pictures.iter().position(|known| known == path).unwrap_or_else(|| {
            self.pictures.push(path.to_path_buf());
            self.pictures.len() - 1
        });
        self.tiles.push(TilePicture { picture: u16::try_from(picture).ok()?, part, mirrored });
        u16::try_from(self.tiles.len() - 1).ok()
    }
}

/// The pictures of a tileset of Tiled.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    /// The picture that holds all tiles, with the number of tiles in a row.
    picture: Option<(PathBuf, u32)>,
    /// Width and height of a tile, pixels.
    tile: [u32; 2],
    /// Around the tiles, and between two of them, pixels.
    margin: u32,
    spacing: u32,
    /// Pictures of single tiles, with their sizes.
    own: BTreeMap<u32, (PathBuf, [u32; 2])>,
}

impl Sheet {
    /// That of a tileset in a file of a folder.
    pub fn read(node: &Node<'_>, folder: &Path) -> Sheet {
        let number = |node: &Node<'_>, name: &str| node.count(name).ok().flatten();
        let tile = ["tilewidth", "tileheight"].map(|name| number(node, name).unwrap_or(0));
        let (margin, spacing) = (number(node, "margin").unwrap_or(0), number(node, "spacing").unwrap_or(0));
        let picture = picture(node, folder).and_then(|(path, [width, _])| {
            let fitting = || width.saturating_sub(margin).saturating_add(spacing).checked_div(tile[0] + spacing);
            let columns = number(node, "columns").filter(|columns| *columns > 0).or_else(fitting)?;
            (tile[0] > 0 && tile[1] > 0 && columns > 0).then_some((path, columns))
        });
        let own = node.children(&["tile", "tiles"]).filter_map(|tile| {
            let (path, size) = picture_of_tile(tile, folder)?;
            Some((number(tile, "id")?, (path, size)))
        });
        Sheet { picture, tile, margin, spacing, own: own.collect() }
    }

    /// The picture of a tile, and the part of it: left, top, width, height.
    pub fn part(&self, id: u32) -> Option<(PathBuf, [u32; 4])> {
        if let Some((path, [width, height])) = self.own.get(&id) {
            return Some((path.clone(), [0, 0, *width, *height]));
        }
        let (path, columns) = self.picture.as_ref()?;
        let [width, height] = self.tile;
        let at = |index: u32, size: u32| {
            let step = size.checked_add(self.spacing)?;
            index.checked_mul(step)?.checked_add(self.margin)
        };
        Some((path.clone(), [at(id % columns, width)?, at(id / columns, height)?, width, height]))
    }
}

/// The picture of a tileset, and its size.
fn picture(node: &Node<'_>, folder: &Path) -> Option<(PathBuf, [u32; 2])> {
    let number = |node: &Node<'_>, name: &str| node.count(name).ok().flatten().unwrap_or(0);
    match node.child("image") {
        // An element of XML.
        Some(image) => {
            let source = image.get("source")?;
            Some((folder.join(&*source.text), [number(image, "width"), number(image, "height")]))
        }
        None => {
            let source = node.get("image")?;
            Some((folder.join(&*source.text), [number(node, "imagewidth"), number(node, "imageheight")]))
        }
    }
}

/// The picture of a single tile, if its size is known.
fn picture_of_tile(tile: &Node<'_>, folder: &Path) -> Option<(PathBuf, [u32; 2])> {
    picture(tile, folder).filter(|(_, [width, height])| *width > 0 && *height > 0)
}

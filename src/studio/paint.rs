//! The maps of a level as they are written: each cell is one character, in the text of the program or in the file of
//! the level. Painting a cell replaces that character.

use std::path::{Path, PathBuf};

use crate::diagnostic::Diagnostics;
use crate::level::text_rows;
use crate::source::{Files, SourceMap, Span};
use crate::syntax;
use crate::syntax::ast::{File, Item, Map, MapSource, SpaceItem, Tile, World, WorldItem};

use super::protocol::Scene;

/// The program as it is written.
pub(super) struct Written<'l> {
    sources: SourceMap,
    trees: Vec<File>,
    /// The level from the command line.
    level: Option<&'l Path>,
}

impl<'l> Written<'l> {
    pub fn read(root: &Path, level: Option<&'l Path>, files: &dyn Files) -> Written<'l> {
        let mut sources = SourceMap::new();
        let (trees, _) = syntax::load(root, files, &mut sources);
        if let Some(level) = level
            && let Ok(text) = files.read(level)
        {
            sources.add(level, text);
        }
        Written { sources, trees, level }
    }

    /// Completes a scene: which maps can be painted, and what their characters make.
    pub fn describe(&self, scene: &mut Scene) {
        let Some((_, world)) = self.world(&scene.world) else { return };
        for space in &mut scene.spaces {
            let Some(map) = &mut space.map else { continue };
            map.is_painted = self.map(&scene.world, &space.name).is_some_and(|(_, map)| is_of_characters(map));
            for kind in &mut map.kinds {
                if let Some(spawn) = tile_of(world, &kind.symbol).and_then(|tile| tile.spawn.as_ref()) {
                    kind.label = format!("spawn {}", spawn.entity.text.as_str());
                }
            }
        }
    }

    /// The file and the bytes of a cell: its column and its row, from the upper left one.
    pub fn cell(&self, world: &str, space: &str, column: usize, row: usize) -> Option<(PathBuf, Span)> {
        let (file, map) = self.map(world, space)?;
        let rows: Vec<(String, Span)> = match &map.source {
            MapSource::Inline(_, rows) => rows.iter().map(|row| (row.text.to_string(), row.span)).collect(),
            MapSource::Text(_, path) | MapSource::Vglc(path, _) => {
                let (_, id) = file.texts.iter().find(|(at, _)| *at == path.span)?;
                self.rows(*id)?
            }
            MapSource::Open(_) | MapSource::OpenLegend(_) | MapSource::OpenAll(_) => {
                let (id, _) = self.sources.iter().find(|(_, file)| Some(&*file.path) == self.level)?;
                self.rows(id)?
            }
            MapSource::Tiled(..) | MapSource::Ldtk(..) => return None,
        };
        let (text, span) = rows.get(row)?;
        let (byte, symbol) = text.char_indices().nth(column)?;
        let start = span.range().start + byte;
        let span = Span::new(span.file(), start, start + symbol.len_utf8());
        Some((self.sources.file(span.file()).path.clone(), span))
    }

    /// The text of a file with a character in place of a span.
    pub fn replaced(&self, span: Span, symbol: &str) -> Option<String> {
        let mut text = self.sources.file(span.file()).text().to_string();
        text.get(span.range())?;
        text.replace_range(span.range(), symbol);
        Some(text)
    }

    fn rows(&self, id: crate::source::FileId) -> Option<Vec<(String, Span)>> {
        let rows = text_rows(self.sources.file(id).text(), id, &mut Diagnostics::default())?;
        Some(rows.into_iter().map(|(row, span)| (row.to_string(), span)).collect())
    }

    fn world(&self, name: &str) -> Option<(&File, &World)> {
        let worlds = self.trees.iter().flat_map(|file| file.items.iter().map(move |item| (file, item)));
        worlds.into_iter().find_map(|(file, item)| match item {
            Item::World(world) if &*world.name.text == name => Some((file, &**world)),
            _ => None,
        })
    }

    fn map(&self, world: &str, space: &str) -> Option<(&File, &Map)> {
        let (file, world) = self.world(world)?;
        let items = world.items.iter().find_map(|item| match item {
            WorldItem::Space(of) if of.name.text.as_str() == space => Some(&of.items),
            _ => None,
        })?;
        let map = items.iter().find_map(|item| if let SpaceItem::Map(map) = item { Some(&**map) } else { None })?;
        Some((file, map))
    }
}

/// Whether each cell of a map is a character.
fn is_of_characters(map: &Map) -> bool {
    !matches!(map.source, MapSource::Tiled(..) | MapSource::Ldtk(..))
}

/// What a world says of a character.
fn tile_of<'w>(world: &'w World, symbol: &str) -> Option<&'w Tile> {
    let sets = world.items.iter().filter_map(|item| match item {
        WorldItem::Tiles(set) => Some(&set.tiles),
        _ => None,
    });
    sets.flatten().find(|tile| symbol.chars().eq([tile.symbol]))
}

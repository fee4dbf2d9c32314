//! The maps of a level as they are written: each cell is one character, in the text of the program or in the file of
//! the level, or one number in the file of a level editor. Painting a cell replaces that character or that number.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::compile::parted;
use crate::diagnostic::Diagnostics;
use crate::ir::TilePicture;
use crate::level::{Brush, Canvas, Format, Meaning, read_dependencies, text_rows};
use crate::ordered::Ordered;
use crate::source::{FileId, Files, SourceMap, Span, normalize};
use crate::syntax::ast::{File, Item, Kind, Map, MapSource, SpaceItem, Tile, World, WorldItem};
use crate::syntax::{self, Unshared};

use super::protocol::{BrushInfo, MapInfo, Scene};

/// Maximum number of brushes of a map.
const MAX_BRUSHES: usize = 500;

/// The program as it is written.
pub(crate) struct Written<'l> {
    sources: SourceMap,
    trees: Vec<File>,
    /// The level from the command line, and its part.
    level: Option<(&'l Path, Option<&'l str>)>,
}

/// A map of a level editor.
struct Edited<'w> {
    format: Format,
    file: FileId,
    part: Option<&'w str>,
    /// What the program says of names in the level.
    kinds: &'w [Kind],
}

impl<'l> Written<'l> {
    pub fn read(root: &Path, level: Option<&'l Path>, files: &dyn Files) -> Written<'l> {
        let mut sources = SourceMap::new();
        let (trees, _) = syntax::load(root, (files, &Unshared), &mut sources);
        let level = level.map(|path| match parted(path) {
            Some((Some(file), part)) => (file, part),
            _ => (path, None),
        });
        if let Some((level, _)) = level
            && let Ok(text) = files.read(level)
        {
            sources.add(level, text);
        }
        let mut written = Written { sources, trees, level };
        written.read_dependencies(files);
        written
    }

    /// Reads the tilesets and separate levels of the maps of level editors.
    fn read_dependencies(&mut self, files: &dyn Files) {
        let maps = self.trees.iter().flat_map(|file| file.maps().map(move |map| (file, map)));
        let edited: Vec<(Format, FileId, Option<String>)> = maps
            .filter_map(|(file, map)| self.edited(file, map))
            .map(|of| (of.format, of.file, of.part.map(str::to_string)))
            .collect();
        for (format, file, part) in edited {
            // What cannot be read is a finding of the program.
            let mut found = Diagnostics::default();
            read_dependencies(format, file, part.as_deref(), &mut self.sources, files, &mut found);
        }
    }

    /// Completes a scene: what its maps can be painted with.
    pub fn describe(&self, scene: &mut Scene) {
        let Some((_, world)) = self.world(&scene.world) else { return };
        let folder = Path::new(&scene.path).parent().unwrap_or(Path::new("")).to_path_buf();
        for space in &mut scene.spaces {
            let Some(info) = &mut space.map else { continue };
            let Some((file, map)) = self.map(&scene.world, &space.name) else { continue };
            let Some(edited) = self.edited(file, map) else {
                info.brushes = characters(world, info);
                continue;
            };
            match self.canvas(&edited) {
                Ok(canvas) => {
                    let is_known = |name: &String| {
                        let is_said = edited.kinds.iter().any(|kind| kind.name.text == name.as_str());
                        is_said || self.is_entity(name) || scene.tags.contains(name)
                    };
                    let is_worth =
                        |brush: &&Brush| brush.names.is_empty() || brush.is_used || brush.names.iter().any(is_known);
                    let mut brushes: Vec<&Brush> = canvas.brushes.iter().filter(is_worth).collect();
                    // The empty one, those that the map has, the others.
                    brushes.order_by_key(|brush| (!brush.names.is_empty(), !brush.is_used));
                    info.brushes_left_out = brushes.len().saturating_sub(MAX_BRUSHES);
                    brushes.truncate(MAX_BRUSHES);
                    info.brushes = brushes
                        .into_iter()
                        .map(|brush| self.brush(brush, &edited, info, (&scene.tags, &folder)))
                        .collect();
                    info.is_drawn_by_rules = edited.format == Format::Ldtk;
                }
                Err(why) => info.unpainted = Some(why),
            }
        }
    }

    /// The file and the bytes that painting a cell replaces, and what stands there then. The cell is given by its column
    /// and its row, from the upper left one.
    pub fn stroke(
        &self,
        (world, space): (&str, &str),
        (column, row): (usize, usize),
        symbol: &str,
    ) -> Option<(PathBuf, Span, String)> {
        let (file, map) = self.map(world, space)?;
        let (span, text) = match self.edited(file, map) {
            Some(edited) => self.canvas(&edited).ok()?.stroke(symbol, column, row, &self.sources)?,
            None => (self.character(file, map, column, row)?, symbol.to_string()),
        };
        Some((self.sources.file(span.file()).path.clone(), span, text))
    }

    /// The text of a file with another text in place of a span.
    pub fn replaced(&self, span: Span, by: &str) -> Option<String> {
        let mut text = self.sources.file(span.file()).text().to_string();
        text.get(span.range())?;
        text.replace_range(span.range(), by);
        Some(text)
    }

    /// The rows of a map that is written in characters, from the highest.
    #[cfg(feature = "lsp")]
    pub fn map_rows(&self, world: &str, space: &str) -> Option<Vec<(String, Span)>> {
        let (file, map) = self.map(world, space)?;
        if self.edited(file, map).is_some() {
            return None;
        }
        self.written_rows(file, map)
    }

    /// The path of a file.
    #[cfg(feature = "lsp")]
    pub fn path(&self, file: FileId) -> &Path {
        &self.sources.file(file).path
    }

    fn written_rows(&self, file: &File, map: &Map) -> Option<Vec<(String, Span)>> {
        match &map.source {
            MapSource::Inline(_, rows) => Some(rows.iter().map(|row| (row.text.to_string(), row.span)).collect()),
            MapSource::Text(_, path) | MapSource::Vglc(path, _) => self.rows(text_of(file, path.span)?),
            MapSource::Open(_) | MapSource::OpenLegend(_) | MapSource::OpenAll(_) => self.rows(self.level_file()?),
            MapSource::Tiled(..) | MapSource::Ldtk(..) => None,
        }
    }

    /// The character of a cell.
    fn character(&self, file: &File, map: &Map, column: usize, row: usize) -> Option<Span> {
        let rows = self.written_rows(file, map)?;
        let (text, span) = rows.get(row)?;
        let (byte, symbol) = text.char_indices().nth(column)?;
        let start = span.range().start + byte;
        Some(Span::new(span.file(), start, start + symbol.len_utf8()))
    }

    fn rows(&self, id: FileId) -> Option<Vec<(String, Span)>> {
        let rows = text_rows(self.sources.file(id).text(), id, &mut Diagnostics::default())?;
        Some(rows.into_iter().map(|(row, span)| (row.to_string(), span)).collect())
    }

    /// The file of the level from the command line.
    fn level_file(&self) -> Option<FileId> {
        let (path, _) = self.level?;
        self.sources.iter().find(|(_, file)| &*file.path == path).map(|(id, _)| id)
    }

    /// The level editor's file of a map, if it comes from one.
    fn edited<'w>(&'w self, file: &File, map: &'w Map) -> Option<Edited<'w>> {
        let of = |format, file, part, kinds| Some(Edited { format, file, part, kinds });
        match &map.source {
            MapSource::Tiled(path, kinds) => of(Format::Tiled, text_of(file, path.span)?, None, &kinds.kinds),
            MapSource::Ldtk(path, part, kinds) => {
                let part = part.as_ref().map(|part| part.text.as_str());
                of(Format::Ldtk, text_of(file, path.span)?, part, &kinds.kinds)
            }
            MapSource::OpenAll(kinds) => {
                let (path, part) = self.level?;
                of(Format::of(path)?, self.level_file()?, part, &kinds.kinds)
            }
            _ => None,
        }
    }

    fn canvas(&self, of: &Edited<'_>) -> Result<Canvas, String> {
        let kinds: BTreeMap<&str, &Kind> = of.kinds.iter().map(|kind| (kind.name.text.as_str(), kind)).collect();
        let meaning = |name: &str| match kinds.get(name) {
            Some(kind) if kind.spawn.is_some() => Meaning::Entity,
            Some(kind) if kind.tags.iter().all(|tag| tag.text == "empty") => Meaning::Nothing,
            Some(_) => Meaning::Tags,
            None if self.is_entity(name) => Meaning::Entity,
            None if name == "empty" => Meaning::Nothing,
            None => Meaning::Tags,
        };
        Canvas::read(of.format, of.file, of.part, &self.sources, &meaning)
    }

    /// A brush as the page shows it.
    fn brush(&self, brush: &Brush, of: &Edited<'_>, map: &MapInfo, (all, folder): (&[String], &Path)) -> BrushInfo {
        let (mut label, mut tags) = (Vec::new(), Vec::new());
        for name in &brush.names {
            match of.kinds.iter().find(|kind| kind.name.text == name.as_str()) {
                Some(Kind { spawn: Some(spawn), .. }) => label.push(format!("spawn {}", spawn.entity.text)),
                Some(kind) => tags.extend(kind.tags.iter().map(|tag| tag.text.to_string())),
                None if self.is_entity(name) => label.push(format!("spawn {name}")),
                None => tags.push(name.clone()),
            }
        }
        tags.retain(|tag| tag != "empty");
        tags.sort_unstable();
        tags.dedup();
        let mut numbers: Vec<usize> = tags.iter().filter_map(|tag| all.iter().position(|known| known == tag)).collect();
        numbers.sort_unstable();
        let is_same = |known: &[usize]| {
            let mut known = known.to_vec();
            known.sort_unstable();
            !numbers.is_empty() && known == numbers
        };
        label.extend(tags);
        let label = match (label.is_empty(), brush.names.is_empty()) {
            (false, _) => label.join(", "),
            (true, true) => "empty".to_string(),
            (true, false) => "scenery".to_string(),
        };
        let picture = brush.picture.as_ref().and_then(|(path, part)| {
            let mut known = map.art.iter().flat_map(|art| &art.pictures);
            let picture = known.position(|known| normalize(&folder.join(known)) == normalize(path))?;
            Some(TilePicture { picture: u16::try_from(picture).ok()?, part: *part, mirrored: 0 })
        });
        let kind = map.kinds.iter().position(|kind| is_same(&kind.tags));
        BrushInfo { symbol: brush.symbol.clone(), label, kind, picture }
    }

    fn is_entity(&self, name: &str) -> bool {
        let mut items = self.trees.iter().flat_map(|file| &file.items);
        items.any(|item| matches!(item, Item::Entity(entity) if &*entity.name.text == name))
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

/// The cells that were painted and that the level editor draws by rules: until it saves the level, the file has the tiles
/// that it drew for what was there before.
#[derive(Default)]
pub(super) struct Redrawn(BTreeMap<(String, usize, usize), Drawn>);

/// What a cell is, and what the level editor shows for it.
#[derive(PartialEq)]
pub(super) struct Drawn {
    kind: Vec<String>,
    tiles: Vec<TilePicture>,
}

impl Redrawn {
    /// What a cell is and shows now; none if no rules draw it.
    pub fn now(scene: &Scene, space: usize, cell: usize) -> Option<Drawn> {
        let map = scene.spaces.get(space)?.map.as_ref().filter(|map| map.is_drawn_by_rules)?;
        let art = map.art.as_ref()?;
        let stack = art.stacks.get(usize::from(*art.cells.get(cell)?))?;
        let tiles = stack.iter().filter_map(|tile| art.tiles.get(usize::from(*tile)).cloned()).collect();
        let kind = usize::try_from(*map.cells.get(cell)?).ok().and_then(|kind| map.kinds.get(kind));
        let tags = kind.iter().flat_map(|kind| &kind.tags).filter_map(|tag| scene.tags.get(*tag).cloned());
        Some(Drawn { kind: tags.collect(), tiles })
    }

    /// Remembers what a cell was and showed before it was painted first.
    pub fn note(&mut self, world: &str, (space, cell): (usize, usize), before: Option<Drawn>) {
        let Some(before) = before else { return };
        self.0.entry((world.to_string(), space, cell)).or_insert(before);
    }

    /// Hides the old tiles of cells that are something else now.
    pub fn hide(&self, scene: &mut Scene) {
        for ((world, space, cell), before) in &self.0 {
            let now = Some(()).filter(|()| *world == scene.world).and_then(|()| Redrawn::now(scene, *space, *cell));
            let is_old = now.is_some_and(|now| now.tiles == before.tiles && now.kind != before.kind);
            let map = scene.spaces.get_mut(*space).and_then(|space| space.map.as_mut()).filter(|_| is_old);
            if let Some(shown) = map.and_then(|map| map.art.as_mut()?.cells.get_mut(*cell)) {
                *shown = 0;
            }
        }
    }
}

/// The file that a path in a file of the program names.
fn text_of(file: &File, path: Span) -> Option<FileId> {
    file.texts.iter().find(|(at, _)| *at == path).map(|(_, id)| *id)
}

/// The characters of a map.
fn characters(world: &World, map: &MapInfo) -> Vec<BrushInfo> {
    let label = |symbol: &str| {
        let spawn = tile_of(world, symbol)?.spawn.as_ref()?;
        Some(format!("spawn {}", spawn.entity.text))
    };
    let brush = |(index, kind): (usize, &super::protocol::TileInfo)| BrushInfo {
        symbol: kind.symbol.clone(),
        label: label(&kind.symbol).unwrap_or_else(|| kind.label.clone()),
        kind: Some(index),
        picture: None,
    };
    map.kinds.iter().enumerate().map(brush).collect()
}

/// What a world says of a character.
fn tile_of<'w>(world: &'w World, symbol: &str) -> Option<&'w Tile> {
    let sets = world.items.iter().filter_map(|item| match item {
        WorldItem::Tiles(set) => Some(&set.tiles),
        _ => None,
    });
    sets.flatten().find(|tile| symbol.chars().eq([tile.symbol]))
}

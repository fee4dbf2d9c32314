//! Reader of maps of the editor Tiled: XML (`.tmx`) or JSON (`.tmj`), with their tilesets (`.tsx`, `.tsj`). Classes and
//! the property `tags` become names; a tile without names has those of its layer.
//!
//! Read through `roxmltree` and `serde_json` (`node.rs`), so that every error has a place in the file and decompression
//! a limit: the crate `tiled` (0.16) has neither, and reads no JSON.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::ordered::Ordered;
use crate::source::{FileId, SourceMap, Span};

use super::editor_level::{EditorLevel, Grid, Meaning, Object, Setting, Value, names, too_many_kinds};
use super::node::{LevelError, Node, Scalar};
use super::numbers::Data;
use super::objects::{Shape, too_many_objects};
use super::tile_art::{Sheet, TileArt, mirrored};
use super::{MAX_OBJECTS, MAX_TILES};

/// The bits of a tile's number that encode its mirroring and rotation.
pub(super) const FLAGS: u32 = 0xf000_0000;
/// Maximum number of tile numbers in all layers together.
const MAX_NUMBERS: usize = 4 * MAX_TILES;
/// Maximum distance of a chunk from the origin, in tiles.
const MAX_CHUNK_DISTANCE: f64 = 1e9;

/// An error, and the file that it is in.
pub(super) type FileError = (FileId, LevelError);

/// The class and the properties that a tileset gives a tile.
#[derive(Debug, Clone, Default)]
pub(super) struct Tile {
    pub class: String,
    pub tags: Vec<String>,
    pub settings: Vec<Setting>,
}

impl Tile {
    /// Its class and its tags; none if it has those of its layer.
    pub fn names(&self) -> Vec<String> {
        let class = Some(&self.class).filter(|class| !class.is_empty());
        class.into_iter().chain(&self.tags).cloned().collect()
    }
}

struct Tileset {
    first: u32,
    /// Number of tiles; none if the file does not say.
    count: Option<u32>,
    tiles: BTreeMap<u32, Tile>,
    sheet: Sheet,
}

/// All tilesets of a map, by their first numbers.
pub(super) struct Tilesets(Vec<Tileset>);

impl Tilesets {
    /// The tile of a number without its flags; none if no tileset has it.
    pub fn tile(&self, number: u32) -> Option<&Tile> {
        const PLAIN: &Tile = &Tile { class: String::new(), tags: Vec::new(), settings: Vec::new() };
        let number = number & !FLAGS;
        let set = self.0.iter().rev().find(|set| set.first <= number)?;
        let own = number - set.first;
        set.tiles.get(&own).or_else(|| set.count.is_none_or(|count| own < count).then_some(PLAIN))
    }

    /// The tiles of all tilesets that have names of their own, with their numbers.
    pub fn named(&self) -> impl Iterator<Item = (u32, &Tile)> {
        let tiles = self
            .0
            .iter()
            .flat_map(|set| set.tiles.iter().map(move |(own, tile)| (set.first.saturating_add(*own), tile)));
        tiles.filter(|(number, tile)| number & FLAGS == 0 && !tile.names().is_empty())
    }

    /// The picture of the tile of a number, and the part of it.
    pub fn part(&self, number: u32) -> Option<(PathBuf, [u32; 4])> {
        let number = number & !FLAGS;
        let set = self.0.iter().rev().find(|set| set.first <= number)?;
        set.sheet.part(number - set.first)
    }
}

/// The files that a map names (its tilesets), and where.
pub(super) fn dependencies(root: &Node<'_>) -> Vec<(String, Range<usize>)> {
    let sets = root.children(&["tileset", "tilesets"]).filter_map(|set| set.get("source"));
    sets.map(|source| (source.text.to_string(), source.at.clone())).collect()
}

/// A map while it is read.
pub(super) struct Reader<'a> {
    pub file: FileId,
    pub meaning: &'a dyn Fn(&str) -> Meaning,
    pub sets: Tilesets,
    /// Width and height of a tile, px.
    pub tile: (f64, f64),
    /// The column and the row (from the top) of the first cell.
    origin: (i64, i64),
    /// Height of the map, and the distance of its left edge from the file's origin, px.
    pub height: f64,
    pub left: f64,
    pub top: f64,
    pub rectangles: Vec<(Vec<String>, [f64; 4], Span)>,
    pub objects: Vec<Object>,
    art: TileArt,
    numbers: usize,
}

/// Reads a map. Its tilesets must be among the sources, under the paths that `beside` gives.
pub(super) fn tiled(
    root: &Node<'_>,
    file: FileId,
    sources: &SourceMap,
    beside: &dyn Fn(&str) -> Option<FileId>,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Result<EditorLevel, FileError> {
    let own = |error: LevelError| (file, error);
    let is_map = root.name == "map" || root.text_of("type") == "map";
    if !is_map {
        return Err(own(LevelError::new(root.head(), "this is no map of Tiled")));
    }
    if let Some(orientation) = root.get("orientation").filter(|o| o.text != "orthogonal") {
        let why = format!("the map is {}: only orthogonal maps have tiles that are rectangles", orientation.text);
        return Err(own(LevelError::new(orientation.at.clone(), why)));
    }
    let side = |name: &str| match root.needed(name, root.number(name)) {
        Ok(side) if side > 0.0 => Ok(side),
        Ok(side) => Err(LevelError::new(root.head(), format!("`{name}` is {side}, and must be above 0"))),
        Err(error) => Err(error),
    };
    let tile = (side("tilewidth").map_err(own)?, side("tileheight").map_err(own)?);
    let sets = tilesets(root, file, sources, beside)?;
    let mut reader = Reader {
        file,
        meaning,
        sets,
        tile,
        origin: (0, 0),
        height: 0.0,
        left: 0.0,
        top: 0.0,
        rectangles: Vec::new(),
        objects: Vec::new(),
        art: TileArt::default(),
        numbers: 0,
    };
    reader.map(root).map_err(own)
}

/// The tilesets of a map.
pub(super) fn tilesets(
    root: &Node<'_>,
    file: FileId,
    sources: &SourceMap,
    beside: &dyn Fn(&str) -> Option<FileId>,
) -> Result<Tilesets, FileError> {
    let mut sets = Vec::new();
    let folder = |file: FileId| sources.file(file).path.parent().map(Path::to_path_buf).unwrap_or_default();
    for node in root.children(&["tileset", "tilesets"]) {
        let first = node.needed("firstgid", node.count("firstgid")).map_err(|error| (file, error))?;
        match node.get("source") {
            None => sets.push(tileset(node, file, first, &folder(file)).map_err(|error| (file, error))?),
            Some(source) => {
                let missing = || (file, LevelError::missing(source.at.clone()));
                let other = beside(&source.text).ok_or_else(missing)?;
                let set = Node::read(sources.file(other).text()).and_then(|node| {
                    if node.name == "tileset" || node.text_of("type") == "tileset" {
                        tileset(&node, other, first, &folder(other))
                    } else {
                        Err(LevelError::new(node.head(), "this is no tileset of Tiled"))
                    }
                });
                sets.push(set.map_err(|error| (other, error))?);
            }
        }
    }
    sets.order_by_key(|set| set.first);
    Ok(Tilesets(sets))
}

fn tileset(node: &Node<'_>, file: FileId, first: u32, folder: &Path) -> Result<Tileset, LevelError> {
    let mut tiles = BTreeMap::new();
    for tile in node.children(&["tile", "tiles"]) {
        let id = tile.needed("id", tile.count("id"))?;
        let class = [tile.text_of("class"), tile.text_of("type")].into_iter().find(|class| !class.is_empty());
        let (tags, settings) = properties(tile, file)?;
        tiles.insert(id, Tile { class: class.unwrap_or("").to_string(), tags, settings });
    }
    let count = node.count("tilecount")?.filter(|count| *count > 0);
    Ok(Tileset { first, count, tiles, sheet: Sheet::read(node, folder) })
}

/// The tags and the other properties of a node.
pub(super) fn properties(node: &Node<'_>, file: FileId) -> Result<(Vec<String>, Vec<Setting>), LevelError> {
    let (mut tags, mut settings) = (Vec::new(), Vec::new());
    // In XML they are in a separate element.
    let list = node.children(&["properties"]).filter(|p| p.get("name").is_none());
    let inside = list.flat_map(|list| list.children(&["property"]));
    for property in inside.chain(node.children(&["properties"]).filter(|p| p.get("name").is_some())) {
        let name = property.text_of("name");
        let inner = Scalar { text: property.text.trim().into(), at: property.head() };
        let value = property.get("value").unwrap_or(&inner);
        let number = || value.text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let value = match property.text_of("type") {
            "" | "string" | "file" if name == "tags" => {
                tags.extend(names(&value.text));
                continue;
            }
            "" | "string" | "file" => Value::Text(value.text.to_string()),
            "int" | "float" => match number() {
                Some(number) => Value::Number(number),
                None => return Err(LevelError::new(value.at.clone(), format!("`{name}` is no number"))),
            },
            "bool" => Value::Truth(value.text == "true"),
            "object" if matches!(&*value.text, "" | "0") => continue,
            "object" => Value::Object(value.text.to_string()),
            _ => Value::Other,
        };
        let at = property.get("name").map_or(property.head(), |name| name.at.clone());
        settings.push(Setting { name: name.to_string(), value, at: Span::new(file, at.start, at.end) });
    }
    Ok((tags, settings))
}

/// The layers in a map or in a group.
pub(super) fn layers<'n, 't>(node: &'n Node<'t>) -> impl Iterator<Item = (&'static str, &'n Node<'t>)> {
    node.children(&["layer", "objectgroup", "group", "layers"]).map(|layer| {
        let kind = match (&*layer.name, layer.text_of("type")) {
            ("layer", _) | ("layers", "tilelayer") => "tiles",
            ("objectgroup", _) | ("layers", "objectgroup") => "objects",
            ("group", _) | ("layers", "group") => "group",
            _ => "image",
        };
        (kind, layer)
    })
}

/// A rectangle of a layer: its first column and row, its size, and its numbers.
pub(super) struct Chunk<'n> {
    pub x: i64,
    pub y: i64,
    pub columns: usize,
    pub rows: usize,
    pub data: Data<'n>,
}

impl Reader<'_> {
    fn map(&mut self, root: &Node<'_>) -> Result<EditorLevel, LevelError> {
        let mut grid = if root.is("infinite") {
            let mut bounds = None;
            self.bounds(root, &mut bounds)?;
            let (left, top, right, bottom) =
                bounds.ok_or_else(|| LevelError::new(root.head(), "this map has no tiles"))?;
            self.origin = (left, top);
            (self.left, self.top) = (left as f64 * self.tile.0, top as f64 * self.tile.1);
            let span = |from: i64, to: i64| usize::try_from(to - from + 1).unwrap_or(0);
            Grid::new(span(left, right), span(top, bottom), root.head())?
        } else {
            let columns = root.needed("width", root.count("width"))?;
            let rows = root.needed("height", root.count("height"))?;
            Grid::new(columns as usize, rows as usize, root.head())?
        };
        self.height = grid.rows() as f64 * self.tile.1;
        self.numbers = 0;
        self.art = TileArt::new(grid.columns() * grid.rows());
        self.layers(root, (0.0, 0.0), &mut grid)?;
        let mut level = grid.into_level(self.tile);
        level.rectangles = std::mem::take(&mut self.rectangles);
        level.objects = std::mem::take(&mut self.objects);
        level.art = Some(std::mem::take(&mut self.art)).filter(|art| !art.is_empty());
        Ok(level)
    }

    /// The bounds of the tiles of an infinite map, in columns and rows: left, top, right, bottom.
    fn bounds(&mut self, node: &Node<'_>, bounds: &mut Option<(i64, i64, i64, i64)>) -> Result<(), LevelError> {
        for (kind, layer) in layers(node) {
            if (self.meaning)(layer.text_of("name")) == Meaning::Nothing {
                continue;
            }
            match kind {
                "group" => self.bounds(layer, bounds)?,
                "tiles" => {
                    for chunk in chunks(layer)? {
                        let numbers = self.numbers(&chunk)?;
                        for (index, _) in numbers.iter().enumerate().filter(|(_, number)| **number & !FLAGS != 0) {
                            let x = chunk.x + (index % chunk.columns) as i64;
                            let y = chunk.y + (index / chunk.columns) as i64;
                            let (left, top, right, bottom) = bounds.unwrap_or((x, y, x, y));
                            *bounds = Some((left.min(x), top.min(y), right.max(x), bottom.max(y)));
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn numbers(&mut self, chunk: &Chunk<'_>) -> Result<Vec<u32>, LevelError> {
        let count = chunk.columns.saturating_mul(chunk.rows);
        self.numbers = self.numbers.saturating_add(count);
        if count > MAX_TILES || self.numbers > MAX_NUMBERS {
            let why = format!("too many tiles: at most {MAX_TILES} a layer, and {MAX_NUMBERS} in all layers, are read");
            return Err(LevelError::new(chunk.data.at.clone(), why));
        }
        chunk.data.numbers(count)
    }

    /// Reads layers, with an offset to the right and down, px.
    fn layers(&mut self, node: &Node<'_>, moved: (f64, f64), grid: &mut Grid) -> Result<(), LevelError> {
        for (kind, layer) in layers(node) {
            let (x, y) = (layer.number("offsetx")?.unwrap_or(0.0), layer.number("offsety")?.unwrap_or(0.0));
            let moved = (moved.0 + x, moved.1 + y);
            if (self.meaning)(layer.text_of("name")) == Meaning::Nothing {
                if kind == "tiles" && moved == (0.0, 0.0) {
                    self.scenery(layer, (grid.columns(), grid.rows()));
                }
                continue;
            }
            match kind {
                "group" => self.layers(layer, moved, grid)?,
                "tiles" if moved != (0.0, 0.0) => {
                    let why = format!("the layer `{}` is moved, and all tiles are in one grid", layer.text_of("name"));
                    return Err(LevelError::new(layer.head(), why));
                }
                "tiles" => self.tiles(layer, grid)?,
                "objects" => self.objects(layer, moved)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Shows a layer that means nothing; what cannot be read of it is not shown.
    fn scenery(&mut self, layer: &Node<'_>, (columns, rows): (usize, usize)) {
        if !is_visible(layer) {
            return;
        }
        for chunk in chunks(layer).unwrap_or_default() {
            let numbers = self.numbers(&chunk).unwrap_or_default();
            for (index, number) in numbers.into_iter().enumerate().filter(|(_, number)| number & !FLAGS != 0) {
                let column = chunk.x + (index % chunk.columns) as i64 - self.origin.0;
                let row = chunk.y + (index / chunk.columns) as i64 - self.origin.1;
                let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else { continue };
                if column < columns && row < rows {
                    let cell = (rows - 1 - row) * columns + column;
                    self.art.put(cell, [number, 0, 0, 0], mirrored(number), || self.sets.part(number));
                }
            }
        }
    }

    /// Puts a layer of tiles into the grid.
    fn tiles(&mut self, layer: &Node<'_>, grid: &mut Grid) -> Result<(), LevelError> {
        let fallback = layer_names(layer, self.file)?;
        let called = layer.text_of("name");
        let mut known: BTreeMap<u32, (u16, Option<Tile>)> = BTreeMap::new();
        let (is_visible, columns, rows) = (is_visible(layer), grid.columns(), grid.rows());
        for chunk in chunks(layer)? {
            for (index, flagged) in self.numbers(&chunk)?.into_iter().enumerate() {
                let number = flagged & !FLAGS;
                if number == 0 {
                    continue;
                }
                let column = chunk.x + (index % chunk.columns) as i64 - self.origin.0;
                let row = chunk.y + (index / chunk.columns) as i64 - self.origin.1;
                let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else { continue };
                let (kind, instance) = match known.entry(number) {
                    Entry::Occupied(entry) => &*entry.into_mut(),
                    Entry::Vacant(entry) => {
                        let broken = |why: String| LevelError::new(chunk.data.place(index), why);
                        let missing =
                            || format!("layer `{called}`, column {column}, row {row}: no tileset has tile {number}");
                        let tile = self.sets.tile(number).ok_or_else(|| broken(missing()))?;
                        let (names, instance) = self.sorted(tile, &fallback);
                        let kind = grid.kind(names).ok_or_else(|| too_many_kinds(chunk.data.place(index)))?;
                        &*entry.insert((kind, instance))
                    }
                };
                grid.put(column, row, *kind, &chunk.data.at)?;
                // What becomes an instance moves: it is no part of the map.
                if is_visible && instance.is_none() {
                    let cell = (rows - 1 - row) * columns + column;
                    self.art.put(cell, [flagged, 0, 0, 0], mirrored(flagged), || self.sets.part(number));
                }
                if let Some(Tile { class, settings, .. }) = instance {
                    if self.objects.len() >= MAX_OBJECTS {
                        return Err(too_many_objects(chunk.data.at.clone()));
                    }
                    let place =
                        if self.objects.len() < MAX_PLACES { chunk.data.place(index) } else { chunk.data.at.clone() };
                    let position = (column as f64 * self.tile.0, self.height - (row + 1) as f64 * self.tile.1);
                    let at = Span::new(self.file, place.start, place.end);
                    self.objects.push(Object::of_tile(class.clone(), position, settings.clone(), at));
                }
            }
        }
        Ok(())
    }

    /// The names of a tile that are tags; and if one of its names is an entity, the tile with the entity as its class.
    fn sorted(&self, tile: &Tile, fallback: &[String]) -> (Vec<String>, Option<Tile>) {
        let mut all = tile.names();
        if all.is_empty() {
            all = fallback.to_vec();
        }
        let entity = all.iter().find(|name| (self.meaning)(name) == Meaning::Entity);
        let instance = entity.map(|class| Tile { class: class.clone(), ..tile.clone() });
        all.retain(|name| (self.meaning)(name) == Meaning::Tags);
        (all, instance)
    }

    fn objects(&mut self, layer: &Node<'_>, moved: (f64, f64)) -> Result<(), LevelError> {
        for object in layer.children(&["object", "objects"]) {
            let shape = Shape::of(object);
            self.object(layer, object, shape, moved)?;
        }
        Ok(())
    }
}

/// The names of a layer: its class and tags, else its own name.
pub(super) fn layer_names(layer: &Node<'_>, file: FileId) -> Result<Vec<String>, LevelError> {
    let (mut all, _) = properties(layer, file)?;
    all.extend(names(layer.text_of("class")));
    if all.is_empty() {
        all.extend(Some(layer.text_of("name").to_string()).filter(|name| !name.is_empty()));
    }
    Ok(all)
}

/// Whether the editor shows a layer.
fn is_visible(layer: &Node<'_>) -> bool {
    !matches!(layer.text_of("visible"), "false" | "0")
}

/// Maximum number of objects whose place in a list of numbers is searched for exactly: the search is linear.
const MAX_PLACES: usize = 100;

/// The chunks of a layer: one, or those of an infinite map.
pub(super) fn chunks<'n>(layer: &'n Node<'_>) -> Result<Vec<Chunk<'n>>, LevelError> {
    let inner = layer.child("data");
    // In JSON, encoding and compression are members of the layer.
    let with = inner.filter(|data| data.get("encoding").is_some()).unwrap_or(layer);
    let data = |node: &'n Node<'_>| -> Data<'n> {
        let packed = node.get("data");
        let list = node.child("data").unwrap_or(node);
        let (text, text_at) = packed.map_or((list.text, list.text_at), |packed| (&*packed.text, packed.at.start));
        let at = packed.map_or(list.head(), |packed| packed.at.start..packed.at.start + 1);
        Data { text, text_at, encoding: with.text_of("encoding"), compression: with.text_of("compression"), at }
    };
    let part = |node: &'n Node<'_>| -> Result<Chunk<'n>, LevelError> {
        let far = |name: &str| match node.number(name)?.unwrap_or(0.0) {
            at if at.abs() <= MAX_CHUNK_DISTANCE => Ok(at as i64),
            _ => Err(LevelError::new(node.head(), format!("`{name}` is too far from the origin"))),
        };
        let (columns, rows) =
            (node.needed("width", node.count("width"))?, node.needed("height", node.count("height"))?);
        let (columns, rows) = (columns as usize, rows as usize);
        if columns == 0 || rows == 0 {
            return Err(LevelError::new(node.head(), "a layer without columns or rows"));
        }
        Ok(Chunk { x: far("x")?, y: far("y")?, columns, rows, data: data(node) })
    };
    let parts: Vec<&'n Node<'_>> = match inner {
        Some(inner) => inner.children(&["chunk"]).collect(),
        None => layer.children(&["chunks"]).collect(),
    };
    if !parts.is_empty() {
        return parts.into_iter().map(part).collect();
    }
    match layer.get("data").is_some() || inner.is_some() {
        true => Ok(vec![part(layer)?]),
        false => Ok(Vec::new()),
    }
}

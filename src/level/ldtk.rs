//! Reader of levels of the editor LDtk (`.ldtk`, with levels in separate files or not): identifiers of the values of
//! integer grids become names, entities become objects, their fields settings.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use serde::Deserialize;

use crate::diagnostic::similar;
use crate::source::{FileId, SourceMap, Span};

use super::MAX_OBJECTS;
use super::editor_level::{EditorLevel, Grid, Meaning, Object, Setting, Value, too_many_kinds};
use super::node::{LevelError, Node};
use super::numbers::{Data, listed};
use super::objects::too_many_objects;
use super::tile_art::TileArt;
use super::tiled::FileError;

/// All levels of a project in its order, world by world.
fn levels<'n, 't>(root: &'n Node<'t>) -> impl Iterator<Item = &'n Node<'t>> {
    root.children(&["levels"]).chain(root.children(&["worlds"]).flat_map(|world| world.children(&["levels"])))
}

/// The names of all levels of a project; empty if the text is none.
pub(super) fn level_names(text: &str) -> Vec<String> {
    let Ok(root) = Node::read(text) else { return Vec::new() };
    levels(&root).map(|level| level.text_of("identifier").to_string()).collect()
}

/// The level with a name, or the only level.
pub(super) fn select_level<'n, 't>(root: &'n Node<'t>, name: Option<&str>) -> Result<&'n Node<'t>, LevelError> {
    if root.get("jsonVersion").is_none() && root.child("__header__").is_none() {
        return Err(LevelError::new(root.head(), "this is no project of LDtk"));
    }
    let all: Vec<&str> = levels(root).map(|level| level.text_of("identifier")).collect();
    let list = || {
        let shown: Vec<String> = all.iter().take(10).map(|name| format!("`{name}`")).collect();
        format!("{}{}", shown.join(", "), if all.len() > 10 { ", …" } else { "" })
    };
    let found = match name {
        Some(name) => levels(root).find(|level| level.text_of("identifier") == name),
        None => levels(root).next().filter(|_| all.len() == 1),
    };
    found.ok_or_else(|| {
        let why = match name {
            _ if all.is_empty() => "this project has no level".to_string(),
            None => format!("this project has several levels, and one must be named: {}", list()),
            Some(name) => match similar(name, all.iter().copied()) {
                Some(near) => format!("this project has no level `{name}`; did you mean `{near}`?"),
                None => format!("this project has no level `{name}`, but {}", list()),
            },
        };
        LevelError::new(root.head(), why)
    })
}

/// The separate file of a level and where it is named, if the level has one.
pub(super) fn dependencies(root: &Node<'_>, level: Option<&str>) -> Vec<(String, Range<usize>)> {
    let path = select_level(root, level).ok().and_then(|level| level.get("externalRelPath"));
    path.map(|path| (path.text.to_string(), path.at.clone())).into_iter().collect()
}

/// Reads a level of a project. Its separate file must be among the sources, under the path that `beside` gives.
pub(super) fn ldtk(
    root: &Node<'_>,
    level: Option<&str>,
    file: FileId,
    sources: &SourceMap,
    beside: &dyn Fn(&str) -> Option<FileId>,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Result<EditorLevel, FileError> {
    let level = select_level(root, level).map_err(|error| (file, error))?;
    let folder = sources.file(file).path.parent().unwrap_or(Path::new(""));
    let Some(path) = level.get("externalRelPath") else {
        return Reader { root, folder, file, meaning }.level(level).map_err(|error| (file, error));
    };
    let missing = || (file, LevelError::missing(path.at.clone()));
    let other = beside(&path.text).ok_or_else(missing)?;
    let node = Node::read(sources.file(other).text()).map_err(|error| (other, error))?;
    Reader { root, folder, file: other, meaning }.level(&node).map_err(|error| (other, error))
}

/// A tile that a layer shows: its place, that of its picture in the tileset, and how it is mirrored.
#[derive(Deserialize)]
struct Tile {
    px: [i64; 2],
    src: [u32; 2],
    #[serde(default)]
    f: u32,
}

struct Reader<'a, 't> {
    root: &'a Node<'t>,
    /// The folder of the project: pictures are named from it.
    folder: &'a Path,
    file: FileId,
    meaning: &'a dyn Fn(&str) -> Meaning,
}

impl Reader<'_, '_> {
    fn level(&self, level: &Node<'_>) -> Result<EditorLevel, LevelError> {
        let layers = level.children(&["layerInstances"]);
        let is_read = |layer: &&Node<'_>| (self.meaning)(layer.text_of("__identifier")) != Meaning::Nothing;
        let layers: Vec<&Node<'_>> = layers.filter(is_read).collect();
        let grids = || layers.iter().filter(|layer| values(layer).is_some());
        // A level without a grid is empty space of its size.
        let model = grids().chain(layers.iter()).next().copied();
        let model = model.ok_or_else(|| LevelError::new(level.head(), "this level has no layers"))?;
        let size = |layer: &Node<'_>| -> Result<(usize, usize, f64), LevelError> {
            let columns = layer.needed("__cWid", layer.count("__cWid"))?;
            let rows = layer.needed("__cHei", layer.count("__cHei"))?;
            let side = layer.needed("__gridSize", layer.number("__gridSize"))?;
            Ok((columns as usize, rows as usize, side))
        };
        let (columns, rows, side) = size(model)?;
        if side <= 0.0 {
            return Err(LevelError::new(model.head(), "the side of a cell is not above 0 px"));
        }
        let mut grid = Grid::new(columns, rows, model.head())?;
        let height = rows as f64 * side;
        let mut objects = Vec::new();
        for layer in &layers {
            let called = layer.text_of("__identifier");
            let offset = |name: &str| layer.number(name).map(|offset| offset.unwrap_or(0.0));
            let moved = (offset("__pxTotalOffsetX")?, offset("__pxTotalOffsetY")?);
            if let Some(values) = values(layer) {
                if size(layer)? != (columns, rows, side) || moved != (0.0, 0.0) {
                    let why = format!("the layer `{called}` has another grid than `{}`", model.text_of("__identifier"));
                    return Err(LevelError::new(layer.head(), why));
                }
                objects.append(&mut self.grid(layer, values, side, &mut grid)?);
            }
            for entity in layer.children(&["entityInstances"]) {
                if objects.len() >= MAX_OBJECTS {
                    return Err(too_many_objects(entity.head()));
                }
                let class = entity.needed("__identifier", Ok(entity.get("__identifier")))?;
                if (self.meaning)(&class.text) != Meaning::Nothing {
                    objects.push(self.object(entity, class.text.to_string(), moved, height)?);
                }
            }
        }
        let art = self.art(level, (columns, rows, side));
        let mut result = grid.into_level((side, side));
        result.art = Some(art).filter(|art| !art.is_empty());
        result.objects = objects;
        Ok(result)
    }

    /// What the cells show: the tiles of all layers on the grid, those that mean nothing included.
    fn art(&self, level: &Node<'_>, (columns, rows, side): (usize, usize, f64)) -> TileArt {
        let mut art = TileArt::new(columns * rows);
        let layers: Vec<&Node<'_>> = level.children(&["layerInstances"]).collect();
        // The topmost layer comes first.
        for layer in layers.into_iter().rev() {
            let number = |name: &str| layer.number(name).ok().flatten().unwrap_or(0.0);
            let is_moved = number("__pxTotalOffsetX") != 0.0 || number("__pxTotalOffsetY") != 0.0;
            if layer.text_of("visible") == "false" || is_moved || number("__gridSize") != side {
                continue;
            }
            let Some(path) = layer.get("__tilesetRelPath") else { continue };
            let uid = layer.text_of("__tilesetDefUid");
            let sets = self.root.child("defs").into_iter().flat_map(|defs| defs.children(&["tilesets"]));
            let size = sets.filter(|set| set.text_of("uid") == uid).find_map(|set| set.count("tileGridSize").ok()?);
            let Some(size) = size else { continue };
            let path = self.folder.join(&*path.text);
            let lists = ["autoLayerTiles", "gridTiles"].into_iter().filter_map(|name| layer.child(name));
            let tiles = lists.flat_map(|list| serde_json::from_str::<Vec<Tile>>(list.text).unwrap_or_default());
            for Tile { px: [x, y], src: [left, top], f } in tiles {
                let mirrored = f & 3;
                let (column, row) = ((x as f64 / side).floor(), (y as f64 / side).floor());
                let is_in = |at: f64, count: usize| (0.0..count as f64).contains(&at);
                if !is_in(column, columns) || !is_in(row, rows) {
                    continue;
                }
                let cell = (rows - 1 - row as usize) * columns + column as usize;
                let key = [uid.parse().unwrap_or(0), left, top, mirrored];
                art.put(cell, key, mirrored as u8, || Some((path.clone(), [left, top, size, size])));
            }
        }
        art
    }

    /// Puts the values of a layer into the grid. Returns the objects of the cells whose value is an entity.
    fn grid(&self, layer: &Node<'_>, values: &Node<'_>, side: f64, grid: &mut Grid) -> Result<Vec<Object>, LevelError> {
        let columns = grid.columns();
        let called = layer.text_of("__identifier");
        let names = value_names(self.root, layer)?;
        let at = values.head();
        let data =
            Data { text: values.text, text_at: values.text_at, encoding: "csv", compression: "", at: at.clone() };
        let mut objects = Vec::new();
        let mut kinds: BTreeMap<u32, u16> = BTreeMap::new();
        for (index, value) in data.numbers(columns * grid.rows())?.into_iter().enumerate().filter(|(_, v)| *v != 0) {
            let (column, row) = (index % columns, index / columns);
            let kind = match kinds.get(&value) {
                Some(&kind) => kind,
                None => {
                    let Some(name) = names.get(&value) else {
                        let why = format!("layer `{called}`, column {column}, row {row}: no value {value} is defined");
                        return Err(LevelError::new(data.place(index), why));
                    };
                    let name = Some(name.clone()).filter(|name| (self.meaning)(name) == Meaning::Tags);
                    let kind =
                        grid.kind(name.into_iter().collect()).ok_or_else(|| too_many_kinds(data.place(index)))?;
                    kinds.insert(value, kind);
                    kind
                }
            };
            grid.put(column, row, kind, &at)?;
            if let Some(name) = names.get(&value).filter(|name| (self.meaning)(name) == Meaning::Entity) {
                if objects.len() >= MAX_OBJECTS {
                    return Err(too_many_objects(at));
                }
                let position = (column as f64 * side, (grid.rows() - 1 - row) as f64 * side);
                objects.push(Object::of_tile(
                    name.clone(),
                    position,
                    Vec::new(),
                    Span::new(self.file, at.start, at.end),
                ));
            }
        }
        Ok(objects)
    }

    fn object(&self, entity: &Node<'_>, class: String, moved: (f64, f64), height: f64) -> Result<Object, LevelError> {
        let pair = |name: &str, other: f64| -> Result<(f64, f64), LevelError> {
            let Some(list) = entity.child(name) else { return Ok((other, other)) };
            let mut numbers = listed(list.text, list.text_at).map(|(part, _)| part.parse::<f64>().ok());
            let pair = numbers.next().flatten().zip(numbers.next().flatten());
            let pair = pair.filter(|(x, y)| x.is_finite() && y.is_finite());
            pair.ok_or_else(|| LevelError::new(list.head(), format!("`{name}` is not two numbers")))
        };
        let (x, y) = pair("px", 0.0)?;
        let pivot = pair("__pivot", 0.0)?;
        let side = |name: &str| entity.number(name).map(|side| side.unwrap_or(0.0));
        let (width, tall) = (side("width")?, side("height")?);
        let left = x + moved.0 - pivot.0 * width;
        let bottom = y + moved.1 + (1.0 - pivot.1) * tall;
        let mut settings = Vec::new();
        for field in entity.children(&["fieldInstances"]) {
            settings.extend(self.setting(field)?);
        }
        let at = entity.head();
        Ok(Object {
            class,
            name: String::new(),
            id: entity.text_of("iid").to_string(),
            position: (left, height - bottom),
            settings,
            at: Span::new(self.file, at.start, at.end),
        })
    }

    /// The setting of a field; none if the field has no value.
    fn setting(&self, field: &Node<'_>) -> Result<Option<Setting>, LevelError> {
        let name = field.text_of("__identifier").to_string();
        let value = match (field.text_of("__type"), field.get("__value"), field.child("__value")) {
            ("Int" | "Float", Some(_), _) => field.number("__value")?.map(Value::Number),
            ("Bool", Some(value), _) => Some(Value::Truth(value.text == "true")),
            ("EntityRef", _, Some(target)) => Some(Value::Object(target.text_of("entityIid").to_string())),
            ("Color" | "FilePath", ..) => Some(Value::Other),
            (_, Some(value), _) => Some(Value::Text(value.text.to_string())),
            // A list or a point.
            (_, None, Some(_)) => Some(Value::Other),
            (_, None, None) => None,
        };
        let at = field.get("__identifier").map_or(field.head(), |name| name.at.clone());
        Ok(value.map(|value| Setting { name, value, at: Span::new(self.file, at.start, at.end) }))
    }
}

/// The values of a layer's grid, if it has one.
pub(super) fn values<'n, 't>(layer: &'n Node<'t>) -> Option<&'n Node<'t>> {
    let values = layer.child("intGridCsv")?;
    (layer.text_of("__type") == "IntGrid" || listed(values.text, 0).next().is_some()).then_some(values)
}

/// The names of the values of a layer's grid.
pub(super) fn value_names(root: &Node<'_>, layer: &Node<'_>) -> Result<BTreeMap<u32, String>, LevelError> {
    let (called, of) = (layer.text_of("__identifier"), layer.text_of("layerDefUid"));
    let defined = root.child("defs").into_iter().flat_map(|defs| defs.children(&["layers"]));
    let mut names = BTreeMap::new();
    for value in defined.filter(|d| d.text_of("uid") == of).flat_map(|d| d.children(&["intGridValues"])) {
        let number = value.needed("value", value.count("value"))?;
        // A value need not have an identifier.
        let name = value.get("identifier").map_or(format!("{called} {number}"), |name| name.text.to_string());
        names.insert(number, name);
    }
    Ok(names)
}

//! Painting into a level editor's file: what a cell can be, and which number of the file a cell is. Files in which a
//! cell is no number of its own, packed ones for instance, are not painted, and say why.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::source::{FileId, SourceMap, Span};

use super::editor::Format;
use super::editor_level::Meaning;
use super::node::Node;
use super::numbers::{Data, listed};
use super::{ldtk, tiled};

/// What a cell can be: a tile of Tiled, a value of an integer grid of LDtk, or empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Brush {
    /// How a request names it.
    pub symbol: String,
    /// Its names in the level; none for an empty cell.
    pub names: Vec<String>,
    /// Whether a cell has it.
    pub is_used: bool,
    /// Its picture, and the part of it: left, top, width, height.
    pub picture: Option<(PathBuf, [u32; 4])>,
    /// Its number in the file; 0 empties a cell.
    number: u32,
    /// The only layer in which the number has these names; none if it has them in every layer.
    layer: Option<usize>,
}

/// The layers of a level whose cells are numbers in its file.
#[derive(Debug)]
pub struct Canvas {
    file: FileId,
    /// The lowest layer first.
    layers: Vec<Layer>,
    /// What a cell can be, the empty one first.
    pub brushes: Vec<Brush>,
}

#[derive(Debug)]
struct Layer {
    /// Its list of numbers in the file.
    at: Range<usize>,
    x: i64,
    y: i64,
    columns: usize,
    rows: usize,
    numbers: Vec<u32>,
    /// The numbers that mean something in the program.
    meant: BTreeSet<u32>,
}

impl Layer {
    /// The index of a cell of the map in the list.
    fn index(&self, column: usize, row: usize) -> Option<usize> {
        let column = usize::try_from(i64::try_from(column).ok()? - self.x).ok()?;
        let row = usize::try_from(i64::try_from(row).ok()? - self.y).ok()?;
        (column < self.columns && row < self.rows).then_some(row * self.columns + column)
    }

    fn is_meant(&self, index: usize) -> bool {
        self.numbers.get(index).is_some_and(|number| self.meant.contains(&(number & !tiled::FLAGS)))
    }
}

impl Canvas {
    /// The canvas of a level, as [`read_level`](super::read_level) reads it; or why it is not painted.
    pub fn read(
        format: Format,
        file: FileId,
        part: Option<&str>,
        sources: &SourceMap,
        meaning: &dyn Fn(&str) -> Meaning,
    ) -> Result<Canvas, String> {
        // What is wrong with a level is a finding of the program.
        let broken = || "The level cannot be read.".to_string();
        let root = Node::read(sources.file(file).text()).map_err(|_| broken())?;
        let canvas = match format {
            Format::Tiled => of_tiled(&root, file, sources, meaning)?,
            Format::Ldtk => of_ldtk(&root, part, file, sources, meaning)?,
        };
        canvas.ok_or_else(broken)
    }

    /// The bytes of the number that a brush replaces, and the new number: in the topmost layer that means something at
    /// the cell, else in the lowest one. Columns and rows count from the upper left cell.
    pub fn stroke(&self, symbol: &str, column: usize, row: usize, sources: &SourceMap) -> Option<(Span, String)> {
        let brush = self.brushes.iter().find(|brush| brush.symbol == symbol)?;
        let own = brush.layer.and_then(|layer| self.layers.get(layer));
        let is_meant = |layer: &&Layer| layer.index(column, row).is_some_and(|index| layer.is_meant(index));
        let layer = own.or_else(|| self.layers.iter().rev().find(is_meant)).or(self.layers.first())?;
        let index = layer.index(column, row)?;
        let text = sources.file(self.file).text().get(layer.at.clone())?;
        let (found, at) = listed(text, layer.at.start).nth(index)?;
        let is_there = found.parse::<u32>().ok() == layer.numbers.get(index).copied();
        is_there.then(|| (Span::new(self.file, at.start, at.end), brush.number.to_string()))
    }
}

/// Collects layers and brushes.
struct Builder<'m> {
    meaning: &'m dyn Fn(&str) -> Meaning,
    layers: Vec<Layer>,
    brushes: BTreeMap<(Option<usize>, u32), Brush>,
}

impl<'m> Builder<'m> {
    fn new(meaning: &'m dyn Fn(&str) -> Meaning) -> Self {
        Builder { meaning, layers: Vec::new(), brushes: BTreeMap::new() }
    }

    fn add(
        &mut self,
        (layer, number): (Option<usize>, u32),
        names: Vec<String>,
        picture: Option<(PathBuf, [u32; 4])>,
        is_used: bool,
    ) {
        let symbol = layer.map_or(number.to_string(), |layer| format!("{layer}/{number}"));
        let brush = || Brush { symbol, names, is_used: false, picture, number, layer };
        self.brushes.entry((layer, number)).or_insert_with(brush).is_used |= is_used;
    }

    fn is_meant(&self, names: &[String]) -> bool {
        names.iter().any(|name| (self.meaning)(name) != Meaning::Nothing)
    }

    fn into_canvas(mut self, file: FileId) -> Result<Option<Canvas>, String> {
        if self.layers.is_empty() {
            return Err("No layer of the level has cells that mean something in the program.".to_string());
        }
        self.add((None, 0), Vec::new(), None, false);
        Ok(Some(Canvas { file, layers: self.layers, brushes: self.brushes.into_values().collect() }))
    }
}

fn of_tiled(
    root: &Node<'_>,
    file: FileId,
    sources: &SourceMap,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Result<Option<Canvas>, String> {
    if root.is("infinite") {
        let why =
            "An infinite map is not painted here: switch off \"Infinite\" in Tiled's Map Properties, and save it.";
        return Err(why.to_string());
    }
    let folder = sources.file(file).path.parent().unwrap_or(Path::new(""));
    let Ok(sets) = tiled::tilesets(root, file, sources, &|name| sources.find(&folder.join(name))) else {
        return Ok(None);
    };
    let mut builder = Builder::new(meaning);
    tile_layers(root, file, &sets, &mut builder)?;
    for (number, tile) in sets.named() {
        if builder.is_meant(&tile.names()) {
            builder.add((None, number), tile.names(), sets.part(number), false);
        }
    }
    builder.into_canvas(file)
}

/// Adds the layers of tiles in a map or in a group.
fn tile_layers(node: &Node<'_>, file: FileId, sets: &tiled::Tilesets, builder: &mut Builder<'_>) -> Result<(), String> {
    for (kind, layer) in tiled::layers(node) {
        let called = layer.text_of("name");
        if (builder.meaning)(called) == Meaning::Nothing {
            continue;
        }
        match kind {
            "group" => tile_layers(layer, file, sets, builder)?,
            "tiles" => {
                let names = tiled::layer_names(layer, file).unwrap_or_default();
                for chunk in tiled::chunks(layer).unwrap_or_default() {
                    let is_text = layer.get("data").is_some();
                    if !matches!(chunk.data.encoding, "csv" | "") || is_text {
                        return Err(format!(
                            "The tiles of the layer `{called}` are packed and not painted here: choose \"CSV\" as the \
                             Tile Layer Format in Tiled's Map Properties, and save the map."
                        ));
                    }
                    add_tiles(chunk, &names, sets, builder);
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn add_tiles(chunk: tiled::Chunk<'_>, fallback: &[String], sets: &tiled::Tilesets, builder: &mut Builder<'_>) {
    let Some(numbers) = numbers(&chunk.data, chunk.columns.saturating_mul(chunk.rows)) else { return };
    let used: BTreeSet<u32> = numbers.iter().map(|number| number & !tiled::FLAGS).filter(|n| *n != 0).collect();
    let layer = builder.layers.len();
    let mut meant = BTreeSet::new();
    for number in used {
        let Some(tile) = sets.tile(number) else { continue };
        // A tile without names has those of its layer: in another layer it would be something else.
        let (of, names) = match tile.names() {
            names if names.is_empty() => (Some(layer), fallback.to_vec()),
            names => (None, names),
        };
        if builder.is_meant(&names) {
            meant.insert(number);
        }
        builder.add((of, number), names, sets.part(number), true);
    }
    let at = chunk.data.text_at..chunk.data.text_at + chunk.data.text.len();
    let (x, y, columns, rows) = (chunk.x, chunk.y, chunk.columns, chunk.rows);
    builder.layers.push(Layer { at, x, y, columns, rows, numbers, meant });
}

fn of_ldtk(
    root: &Node<'_>,
    part: Option<&str>,
    file: FileId,
    sources: &SourceMap,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Result<Option<Canvas>, String> {
    let Ok(level) = ldtk::select_level(root, part) else { return Ok(None) };
    let Some(path) = level.get("externalRelPath") else { return of_level(root, level, file, meaning) };
    let folder = sources.file(file).path.parent().unwrap_or(Path::new(""));
    let Some(other) = sources.find(&folder.join(&*path.text)) else { return Ok(None) };
    let Ok(level) = Node::read(sources.file(other).text()) else { return Ok(None) };
    of_level(root, &level, other, meaning)
}

/// The integer grids of a level of LDtk.
fn of_level(
    root: &Node<'_>,
    level: &Node<'_>,
    file: FileId,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Result<Option<Canvas>, String> {
    let mut builder = Builder::new(meaning);
    let layers: Vec<&Node<'_>> = level.children(&["layerInstances"]).collect();
    // The topmost layer comes first in the file.
    for layer in layers.into_iter().rev() {
        let Some(values) = ldtk::values(layer) else { continue };
        if meaning(layer.text_of("__identifier")) == Meaning::Nothing {
            continue;
        }
        let side = |name: &str| layer.count(name).ok().flatten().map_or(0, |count| count as usize);
        let (columns, rows) = (side("__cWid"), side("__cHei"));
        let data =
            Data { text: values.text, text_at: values.text_at, encoding: "csv", compression: "", at: values.head() };
        let Some(numbers) = numbers(&data, columns.saturating_mul(rows)) else { return Ok(None) };
        let Ok(names) = ldtk::value_names(root, layer) else { return Ok(None) };
        let index = builder.layers.len();
        let mut meant = BTreeSet::new();
        for (number, name) in names {
            let (names, is_used) = (vec![name], numbers.contains(&number));
            if builder.is_meant(&names) {
                meant.insert(number);
            }
            builder.add((Some(index), number), names, None, is_used);
        }
        let at = values.text_at..values.text_at + values.text.len();
        builder.layers.push(Layer { at, x: 0, y: 0, columns, rows, numbers, meant });
    }
    builder.into_canvas(file)
}

/// The numbers of a list; none if they are not as many as cells, which is a finding of the program.
fn numbers(data: &Data<'_>, count: usize) -> Option<Vec<u32>> {
    data.numbers(count).ok()
}

//! Contents of a level editor's file, whichever the editor: a grid in which each cell has names, rectangles with names,
//! and objects with positions. Names are classes, tags or identifiers; the program gives them a meaning.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::source::Span;

use super::MAX_TILES;
use super::node::LevelError;
use super::tile_art::TileArt;

/// Maximum number of kinds of cells of a map.
const MAX_KINDS: usize = 4_096;

/// A level. Lengths are px, y points up, the lower-left corner of the grid is (0, 0).
#[derive(Debug, Clone)]
pub struct EditorLevel {
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Width and height of a cell, px.
    pub tile: (f64, f64),
    /// The names of each kind of cell; kind 0 has none.
    pub kinds: Vec<Vec<String>>,
    /// The kind of each cell, row by row from the lowest.
    pub cells: Vec<u16>,
    /// Rectangles with names: x and y of the lower-left corner, width, height.
    pub rectangles: Vec<(Vec<String>, [f64; 4], Span)>,
    /// The objects, in the order of the file.
    pub objects: Vec<Object>,
    /// What its cells show in the editor, if that is known.
    pub art: Option<TileArt>,
}

/// The meaning of a name of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// An entity: the object is an instance of it.
    Entity,
    /// Tags.
    Tags,
    /// Nothing.
    Nothing,
}

/// An object of a level.
#[derive(Debug, Clone)]
pub struct Object {
    /// Its class.
    pub class: String,
    /// Its name; empty if it has none.
    pub name: String,
    /// The identifier by which other objects of the file refer to it.
    pub id: String,
    /// Its lower-left corner.
    pub position: (f64, f64),
    /// Its properties.
    pub settings: Vec<Setting>,
    /// Where it is in the file.
    pub at: Span,
}

impl Object {
    /// The object of a tile: it has no name, and nothing refers to it.
    pub(super) fn of_tile(class: String, position: (f64, f64), settings: Vec<Setting>, at: Span) -> Self {
        Object { class, name: String::new(), id: String::new(), position, settings, at }
    }
}

/// A property of an object.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The name of the property.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// Where it is in the file.
    pub at: Span,
}

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// `true` or `false`.
    Truth(bool),
    /// A word.
    Text(String),
    /// Another object, by its id.
    Object(String),
    /// A value that no entity can have: a list, a colour, a point.
    Other,
}

/// A grid that is filled layer by layer: a cell has the names that any layer gives it.
pub(super) struct Grid {
    columns: usize,
    rows: usize,
    kinds: Vec<Vec<String>>,
    known: BTreeMap<Vec<String>, u16>,
    joined: BTreeMap<(u16, u16), u16>,
    cells: Vec<u16>,
}

impl Grid {
    /// A grid of empty cells.
    pub fn new(columns: usize, rows: usize, at: Range<usize>) -> Result<Self, LevelError> {
        let count = columns.saturating_mul(rows);
        if count == 0 {
            return Err(LevelError::new(at, "this map has no tiles"));
        }
        if count > MAX_TILES {
            return Err(LevelError::new(at, format!("{count} tiles are too many: at most {MAX_TILES} are read")));
        }
        let known = BTreeMap::from([(Vec::new(), 0)]);
        Ok(Grid { columns, rows, kinds: vec![Vec::new()], known, joined: BTreeMap::new(), cells: vec![0; count] })
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of the kind of cell with these names; none if there are too many kinds.
    pub fn kind(&mut self, mut names: Vec<String>) -> Option<u16> {
        names.sort_unstable();
        names.dedup();
        if let Some(&kind) = self.known.get(&names) {
            return Some(kind);
        }
        let kind = u16::try_from(self.kinds.len()).ok().filter(|kind| usize::from(*kind) < MAX_KINDS)?;
        self.kinds.push(names.clone());
        self.known.insert(names, kind);
        Some(kind)
    }

    /// Adds the names of a kind to a cell, its row counted from the top.
    pub fn put(&mut self, column: usize, row: usize, kind: u16, at: &Range<usize>) -> Result<(), LevelError> {
        if column >= self.columns || row >= self.rows {
            return Err(LevelError::new(at.clone(), format!("column {column}, row {row} lies outside of the map")));
        }
        let index = (self.rows - 1 - row) * self.columns + column;
        let before = self.cells[index];
        if before == kind || kind == 0 {
            return Ok(());
        }
        let joined = match self.joined.get(&(before, kind)) {
            Some(&joined) => joined,
            None => {
                let names = self.kinds[usize::from(before)].iter().chain(&self.kinds[usize::from(kind)]).cloned();
                let joined = self.kind(names.collect()).ok_or_else(|| too_many_kinds(at.clone()))?;
                self.joined.insert((before, kind), joined);
                joined
            }
        };
        self.cells[index] = joined;
        Ok(())
    }

    /// The level with this grid. Kinds that no cell has are left out.
    pub fn into_level(self, tile: (f64, f64)) -> EditorLevel {
        let mut used = vec![false; self.kinds.len()];
        used[0] = true;
        self.cells.iter().for_each(|kind| used[usize::from(*kind)] = true);
        let mut numbers = vec![0u16; used.len()];
        let left = numbers.iter_mut().zip(&used).filter(|(_, is_used)| **is_used);
        left.zip(0..).for_each(|((number, _), next)| *number = next);
        let kinds = self.kinds.into_iter().zip(&used).filter(|(_, is_used)| **is_used).map(|(kind, _)| kind).collect();
        let cells = self.cells.into_iter().map(|kind| numbers[usize::from(kind)]).collect();
        let (columns, rows) = (self.columns, self.rows);
        EditorLevel { columns, rows, tile, kinds, cells, rectangles: Vec::new(), objects: Vec::new(), art: None }
    }
}

pub(super) fn too_many_kinds(at: Range<usize>) -> LevelError {
    LevelError::new(at, format!("too many kinds of tiles: at most {MAX_KINDS} are read"))
}

/// The names of a list: `wall, ground`.
pub(super) fn names(list: &str) -> impl Iterator<Item = String> + '_ {
    list.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_string)
}

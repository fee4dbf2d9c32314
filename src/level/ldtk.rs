//! Levels of the editor LDtk (`.ldtk`, with levels in files of their own or not): identifiers of the values of integer
//! grids are names, entities are things, their fields settings.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::diagnostic::similar;
use crate::source::{FileId, SourceMap, Span};

use super::MAX_THINGS;
use super::drawn::{Drawn, Grid, Meaning, Setting, Thing, Value, too_many_kinds};
use super::node::{Node, Trouble};
use super::numbers::{Data, listed};
use super::objects::too_many_things;
use super::tiled::Broken;

/// All levels of a project, in its order, those of several worlds one after the other.
fn levels<'n, 't>(root: &'n Node<'t>) -> impl Iterator<Item = &'n Node<'t>> {
    root.children(&["levels"]).chain(root.children(&["worlds"]).flat_map(|world| world.children(&["levels"])))
}

/// The level of a name, or the only one.
fn chosen<'n, 't>(root: &'n Node<'t>, name: Option<&str>) -> Result<&'n Node<'t>, Trouble> {
    if root.get("jsonVersion").is_none() && root.child("__header__").is_none() {
        return Err(Trouble::new(root.head(), "this is no project of LDtk"));
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
        Trouble::new(root.head(), why)
    })
}

/// The file that holds a level, and where it is named, if it has one of its own.
pub(super) fn named(root: &Node<'_>, level: Option<&str>) -> Vec<(String, Range<usize>)> {
    let path = chosen(root, level).ok().and_then(|level| level.get("externalRelPath"));
    path.map(|path| (path.text.to_string(), path.at.clone())).into_iter().collect()
}

/// Reads a level of a project. A file of its own must be among the sources, under the path that `beside` gives.
pub(super) fn ldtk(
    root: &Node<'_>,
    level: Option<&str>,
    file: FileId,
    sources: &SourceMap,
    beside: &dyn Fn(&str) -> Option<FileId>,
    meaning: &dyn Fn(&str) -> Meaning,
) -> Result<Drawn, Broken> {
    let level = chosen(root, level).map_err(|trouble| (file, trouble))?;
    let Some(path) = level.get("externalRelPath") else {
        return Reader { root, file, meaning }.level(level).map_err(|trouble| (file, trouble));
    };
    let missing = || (file, Trouble::missing(path.at.clone()));
    let other = beside(&path.text).ok_or_else(missing)?;
    let node = Node::read(sources.file(other).text()).map_err(|trouble| (other, trouble))?;
    Reader { root, file: other, meaning }.level(&node).map_err(|trouble| (other, trouble))
}

struct Reader<'a, 't> {
    root: &'a Node<'t>,
    file: FileId,
    meaning: &'a dyn Fn(&str) -> Meaning,
}

impl Reader<'_, '_> {
    fn level(&self, level: &Node<'_>) -> Result<Drawn, Trouble> {
        let layers = level.children(&["layerInstances"]);
        let is_read = |layer: &&Node<'_>| (self.meaning)(layer.text_of("__identifier")) != Meaning::Nothing;
        let layers: Vec<&Node<'_>> = layers.filter(is_read).collect();
        let grids = || layers.iter().filter(|layer| self.values(layer).is_some());
        // A level without a grid is empty space of its size.
        let model = grids().chain(layers.iter()).next().copied();
        let model = model.ok_or_else(|| Trouble::new(level.head(), "this level has no layers"))?;
        let size = |layer: &Node<'_>| -> Result<(usize, usize, f64), Trouble> {
            let columns = layer.needed("__cWid", layer.count("__cWid"))?;
            let rows = layer.needed("__cHei", layer.count("__cHei"))?;
            let side = layer.needed("__gridSize", layer.number("__gridSize"))?;
            Ok((columns as usize, rows as usize, side))
        };
        let (columns, rows, side) = size(model)?;
        if side <= 0.0 {
            return Err(Trouble::new(model.head(), "the side of a cell is not above 0 px"));
        }
        let mut grid = Grid::new(columns, rows, model.head())?;
        let height = rows as f64 * side;
        let mut things = Vec::new();
        for layer in &layers {
            let called = layer.text_of("__identifier");
            let offset = |name: &str| layer.number(name).map(|offset| offset.unwrap_or(0.0));
            let moved = (offset("__pxTotalOffsetX")?, offset("__pxTotalOffsetY")?);
            if let Some(values) = self.values(layer) {
                if size(layer)? != (columns, rows, side) || moved != (0.0, 0.0) {
                    let why = format!("the layer `{called}` has another grid than `{}`", model.text_of("__identifier"));
                    return Err(Trouble::new(layer.head(), why));
                }
                things.append(&mut self.grid(layer, values, side, &mut grid)?);
            }
            for entity in layer.children(&["entityInstances"]) {
                if things.len() >= MAX_THINGS {
                    return Err(too_many_things(entity.head()));
                }
                let class = entity.needed("__identifier", Ok(entity.get("__identifier")))?;
                if (self.meaning)(&class.text) != Meaning::Nothing {
                    things.push(self.thing(entity, class.text.to_string(), moved, height)?);
                }
            }
        }
        let mut drawn = grid.drawn((side, side));
        drawn.things = things;
        Ok(drawn)
    }

    /// The values of a layer's grid, if it has one.
    fn values<'n, 't>(&self, layer: &'n Node<'t>) -> Option<&'n Node<'t>> {
        let values = layer.child("intGridCsv")?;
        (layer.text_of("__type") == "IntGrid" || listed(values.text, 0).next().is_some()).then_some(values)
    }

    /// Puts the values of a layer into the grid. Returns what is on cells whose value is an entity.
    fn grid(&self, layer: &Node<'_>, values: &Node<'_>, side: f64, grid: &mut Grid) -> Result<Vec<Thing>, Trouble> {
        let columns = grid.columns();
        let called = layer.text_of("__identifier");
        let defined = self.root.child("defs").into_iter().flat_map(|defs| defs.children(&["layers"]));
        let of = layer.text_of("layerDefUid");
        let mut names: BTreeMap<u32, String> = BTreeMap::new();
        for value in defined.filter(|d| d.text_of("uid") == of).flat_map(|d| d.children(&["intGridValues"])) {
            let number = value.needed("value", value.count("value"))?;
            // A value need not have an identifier.
            let name = value.get("identifier").map_or(format!("{called} {number}"), |name| name.text.to_string());
            names.insert(number, name);
        }
        let at = values.head();
        let data =
            Data { text: values.text, text_at: values.text_at, encoding: "csv", compression: "", at: at.clone() };
        let mut things = Vec::new();
        let mut kinds: BTreeMap<u32, u16> = BTreeMap::new();
        for (index, value) in data.numbers(columns * grid.rows())?.into_iter().enumerate().filter(|(_, v)| *v != 0) {
            let (column, row) = (index % columns, index / columns);
            let kind = match kinds.get(&value) {
                Some(&kind) => kind,
                None => {
                    let Some(name) = names.get(&value) else {
                        let why = format!("layer `{called}`, column {column}, row {row}: no value {value} is defined");
                        return Err(Trouble::new(data.place(index), why));
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
                if things.len() >= MAX_THINGS {
                    return Err(too_many_things(at));
                }
                let position = (column as f64 * side, (grid.rows() - 1 - row) as f64 * side);
                things.push(Thing::of_tile(name.clone(), position, Vec::new(), Span::new(self.file, at.start, at.end)));
            }
        }
        Ok(things)
    }

    fn thing(&self, entity: &Node<'_>, class: String, moved: (f64, f64), height: f64) -> Result<Thing, Trouble> {
        let pair = |name: &str, other: f64| -> Result<(f64, f64), Trouble> {
            let Some(list) = entity.child(name) else { return Ok((other, other)) };
            let mut numbers = listed(list.text, list.text_at).map(|(part, _)| part.parse::<f64>().ok());
            let pair = numbers.next().flatten().zip(numbers.next().flatten());
            let pair = pair.filter(|(x, y)| x.is_finite() && y.is_finite());
            pair.ok_or_else(|| Trouble::new(list.head(), format!("`{name}` is not two numbers")))
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
        Ok(Thing {
            class,
            name: String::new(),
            id: entity.text_of("iid").to_string(),
            position: (left, height - bottom),
            settings,
            at: Span::new(self.file, at.start, at.end),
        })
    }

    /// A field that has a value.
    fn setting(&self, field: &Node<'_>) -> Result<Option<Setting>, Trouble> {
        let name = field.text_of("__identifier").to_string();
        let value = match (field.text_of("__type"), field.get("__value"), field.child("__value")) {
            ("Int" | "Float", Some(_), _) => field.number("__value")?.map(Value::Number),
            ("Bool", Some(value), _) => Some(Value::Truth(value.text == "true")),
            ("EntityRef", _, Some(target)) => Some(Value::Thing(target.text_of("entityIid").to_string())),
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

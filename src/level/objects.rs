//! Reader of the objects of a map of Tiled: rectangles with names, and the objects of the level.

use std::ops::Range;

use crate::source::Span;

use super::MAX_OBJECTS;
use super::editor_level::{Meaning, Object};
use super::node::{LevelError, Node};
use super::tiled::{Reader, Tile, layer_names, properties};

/// The shape of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// A rectangle with sides.
    Rectangle,
    /// A point, or a rectangle without sides.
    Point,
    /// A tile, its position the lower-left corner.
    Tile,
    /// A text, which has no meaning here.
    Text,
    /// A shape without a lower-left corner.
    Other(&'static str),
}

impl Shape {
    /// The shape of an object.
    pub fn of(object: &Node<'_>) -> Self {
        let has = |name: &str| object.child(name).is_some() || object.is(name);
        let sides = ["width", "height"].map(|side| object.number(side).ok().flatten().unwrap_or(0.0));
        if object.get("gid").is_some() {
            Shape::Tile
        } else if has("text") {
            Shape::Text
        } else if let Some(other) = ["ellipse", "polygon", "polyline", "capsule"].into_iter().find(|name| has(name)) {
            Shape::Other(other)
        } else if has("point") || sides.contains(&0.0) {
            Shape::Point
        } else {
            Shape::Rectangle
        }
    }
}

impl Reader<'_> {
    /// Reads an object: an instance if its class is an entity, else a rectangle with names.
    pub(super) fn object(
        &mut self,
        layer: &Node<'_>,
        object: &Node<'_>,
        shape: Shape,
        moved: (f64, f64),
    ) -> Result<(), LevelError> {
        let at = object.head();
        if let Some(template) = object.get("template") {
            let why = "an object of a template is not read: detach it from its template in the editor";
            return Err(LevelError::new(template.at.clone(), why));
        }
        let mut tile = Tile::default();
        if let Some(number) = object.count("gid")? {
            let known = self.sets.tile(number);
            let id = object.text_of("id");
            tile = known
                .cloned()
                .ok_or_else(|| LevelError::new(at.clone(), format!("object {id}: no tileset has its tile")))?;
        }
        let class = [object.text_of("class"), object.text_of("type"), &tile.class];
        let class = class.into_iter().find(|class| !class.is_empty()).unwrap_or("").to_string();
        let (tags, mut settings) = properties(object, self.file)?;
        // Defaults from the object's tile.
        settings.extend(tile.settings.into_iter().filter(|of| !object_sets(object, &of.name)));
        let (width, height) = (object.number("width")?.unwrap_or(0.0), object.number("height")?.unwrap_or(0.0));
        let (x, y) = (object.number("x")?.unwrap_or(0.0), object.number("y")?.unwrap_or(0.0));
        let bottom = if shape == Shape::Tile { y } else { y + height };
        let position = (x + moved.0 - self.left, self.height - (bottom + moved.1 - self.top));
        let span = Span::new(self.file, at.start, at.end);
        let own = Some(class.clone()).filter(|class| !class.is_empty());
        let mut all: Vec<String> = own.into_iter().chain(tags).chain(tile.tags).collect();
        if all.is_empty() && matches!(shape, Shape::Rectangle | Shape::Tile) {
            all = layer_names(layer, self.file)?;
            // A tile without names is no wall.
            all.retain(|name| shape == Shape::Rectangle || (self.meaning)(name) == Meaning::Entity);
        }
        let entity = all.iter().find(|name| (self.meaning)(name) == Meaning::Entity).cloned();
        // A point can only be an instance.
        let lost = Some(class).filter(|class| shape == Shape::Point && (self.meaning)(class) == Meaning::Tags);
        if let Some(class) = entity.or(lost.filter(|class| !class.is_empty())) {
            if self.objects.len() >= MAX_OBJECTS {
                return Err(too_many_objects(at));
            }
            let (name, id) = (object.text_of("name").to_string(), object.text_of("id").to_string());
            self.objects.push(Object { class, name, id, position, settings, at: span });
            return Ok(());
        }
        all.retain(|name| (self.meaning)(name) == Meaning::Tags);
        if all.is_empty() || matches!(shape, Shape::Text | Shape::Point) {
            return Ok(());
        }
        if let Shape::Other(what) = shape {
            let why = format!("this {what} cannot be `{}`: only rectangles can have tags", all.join("`, `"));
            return Err(LevelError::new(at, why));
        }
        if object.number("rotation")?.unwrap_or(0.0) != 0.0 {
            return Err(LevelError::new(at, "a rectangle that is turned is not read"));
        }
        if width <= 0.0 || height <= 0.0 {
            return Err(LevelError::new(at, "a side of this rectangle is not above 0 px"));
        }
        if self.rectangles.len() >= MAX_OBJECTS {
            return Err(too_many_objects(at));
        }
        self.rectangles.push((all, [position.0, position.1, width, height], span));
        Ok(())
    }
}

fn object_sets(object: &Node<'_>, name: &str) -> bool {
    let inside = object.children(&["properties"]).flat_map(|list| list.children(&["property"]));
    inside.chain(object.children(&["properties"])).any(|property| property.text_of("name") == name)
}

pub(super) fn too_many_objects(at: Range<usize>) -> LevelError {
    LevelError::new(at, format!("too many objects: at most {MAX_OBJECTS} are read"))
}

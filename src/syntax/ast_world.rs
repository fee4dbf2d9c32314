//! Worlds in the syntax tree, and looks.

use std::sync::Arc;

use crate::source::Span;

use super::ast::{Assignment, Condition, Expr, File, Item, Name, Test};

/// `world Name { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Its name.
    pub name: Name,
    /// Its contents.
    pub items: Vec<WorldItem>,
    /// The text of the `///` lines above it.
    pub doc: Option<String>,
    /// The whole.
    pub span: Span,
}

/// An item of a world.
#[derive(Debug, Clone, PartialEq)]
pub enum WorldItem {
    /// `step 1/60`
    Step(Box<Expr>),
    /// `collide a with b: block`
    Collide(Box<Collide>),
    /// `tiles name 32 x 32 { … }`
    Tiles(Box<Tiles>),
    /// `space name { … }`
    Space(Box<Space>),
    /// `limit Entity 8`
    Limit(Box<Limit>),
    /// `look coin, gem: #ffd040`
    Look(Box<TagLook>),
    /// `player 1: hero`
    Player(Box<Player>),
    /// `condition name = predicate`
    Condition(Box<Condition>),
    /// `goal name: predicate`
    Goal(Box<Question>),
    /// `never name: predicate`
    Never(Box<Question>),
    /// `test "name" { … }`
    Test(Box<Test>),
}

impl File {
    /// The maps of all worlds.
    pub fn maps(&self) -> impl Iterator<Item = &Map> {
        let worlds = self.items.iter().filter_map(|i| if let Item::World(world) = i { Some(world) } else { None });
        let items = worlds.flat_map(|w| &w.items);
        let spaces = items.filter_map(|i| if let WorldItem::Space(space) = i { Some(space) } else { None });
        spaces.flat_map(|s| &s.items).filter_map(|i| if let SpaceItem::Map(map) = i { Some(&**map) } else { None })
    }

    /// The world of a name in this file, or all of them.
    pub(crate) fn worlds<'f>(&'f self, name: Option<&'f str>) -> impl Iterator<Item = &'f World> {
        let worlds = self.items.iter().filter_map(|i| if let Item::World(world) = i { Some(&**world) } else { None });
        worlds.filter(move |world| name.is_none_or(|name| &*world.name.text == name))
    }

    /// As [`File::worlds`], to change them.
    pub(crate) fn worlds_mut<'f>(&'f mut self, name: Option<&'f str>) -> impl Iterator<Item = &'f mut World> {
        let worlds = self
            .items
            .iter_mut()
            .filter_map(|i| if let Item::World(world) = i { Some(Arc::make_mut(world)) } else { None });
        worlds.filter(move |world| name.is_none_or(|name| &*world.name.text == name))
    }
}

/// `collide a, b with c: block, keep velocity`
#[derive(Debug, Clone, PartialEq)]
pub struct Collide {
    /// The tags on the left.
    pub left: Vec<Name>,
    /// The tags on the right.
    pub right: Vec<Name>,
    /// What a contact does.
    pub response: Response,
    /// The whole.
    pub span: Span,
}

/// The response of a contact, as written.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// `block`, not `sense`.
    pub block: bool,
    /// `from above`
    pub from_above: bool,
    /// `keep velocity`
    pub keep_velocity: bool,
    /// `carry`
    pub carry: bool,
    /// `bounce share`
    pub bounce: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `tiles name w x h { 'c': tags … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Tiles {
    /// The set's name.
    pub name: Name,
    /// A tile's width, px.
    pub width: Expr,
    /// A tile's height, px.
    pub height: Expr,
    /// The characters.
    pub tiles: Vec<Tile>,
    /// The whole.
    pub span: Span,
}

/// `'c': tags`
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    /// The character in the map.
    pub symbol: char,
    /// Where the character is.
    pub symbol_span: Span,
    /// Its tags; `empty` stands for none.
    pub tags: Vec<Name>,
    /// The line up to which it is solid.
    pub slope: Option<Box<Slope>>,
    /// Whether it can be broken.
    pub breakable: Option<Box<Breakable>>,
    /// The instance that it spawns.
    pub spawn: Option<TileSpawn>,
}

/// `slope (x, y)-(x, y)`
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The left end of the line, then the right one.
    pub ends: [[Expr; 2]; 2],
    /// The whole.
    pub span: Span,
}

/// `breakable restore after time`
#[derive(Debug, Clone, PartialEq)]
pub struct Breakable {
    /// After how long it is back.
    pub restore: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `spawn Entity as name { settings }` of a tile
#[derive(Debug, Clone, PartialEq)]
pub struct TileSpawn {
    /// The entity.
    pub entity: Name,
    /// The name of the only instance.
    pub name: Option<Name>,
    /// Parameters and first values of the instances.
    pub settings: Vec<Assignment>,
    /// From `spawn` to the last name.
    pub span: Span,
    /// The whole.
    pub whole: Span,
}

/// `look #e04030`, `look "slime.png"`
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// The colour or the picture.
    pub appearance: Appearance,
    /// The whole.
    pub span: Span,
}

/// What something looks like, as written.
#[derive(Debug, Clone, PartialEq)]
pub enum Appearance {
    /// `#e04030`
    Color(Name),
    /// The path of a picture.
    Picture(Name),
}

/// `look coin, gem: #ffd040`
#[derive(Debug, Clone, PartialEq)]
pub struct TagLook {
    /// The tags of what looks so.
    pub tags: Vec<Name>,
    /// The colour or the picture.
    pub appearance: Appearance,
    /// The whole.
    pub span: Span,
}

/// `limit Entity 8`
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// The entity.
    pub entity: Name,
    /// Maximum number of instances.
    pub count: Expr,
    /// The whole.
    pub span: Span,
}

/// `space name { … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    /// Its name.
    pub name: Name,
    /// Its contents.
    pub items: Vec<SpaceItem>,
    /// The whole.
    pub span: Span,
}

/// An item of a space.
#[derive(Debug, Clone, PartialEq)]
pub enum SpaceItem {
    /// A map.
    Map(Box<Map>),
    /// A link to another space.
    Link(Box<Link>),
    /// An instance.
    Place(Box<Place>),
    /// `rect tags (x, y, width, height)`: free-standing static geometry.
    Solid(Box<Solid>),
    /// `bounds rect(x, y, width, height)`
    Bounds(Box<Rectangle>),
    /// `wrap horizontal`, `wrap vertical`
    Wrap(Wrap),
}

/// `wrap horizontal`: the left and the right border of a space are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrap {
    /// Whether the lower and the upper border are meant.
    pub is_vertical: bool,
    /// The whole.
    pub span: Span,
}

/// `rect tags (x, y, width, height)`
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// What it counts as.
    pub tags: Vec<Name>,
    /// Where it is.
    pub rectangle: Rectangle,
}

/// `(x, y, width, height)`
#[derive(Debug, Clone, PartialEq)]
pub struct Rectangle {
    /// x and y of the lower-left corner, width, height.
    pub sides: Box<[Expr; 4]>,
    /// The whole line.
    pub span: Span,
}

/// `link rect(…) -> space at rect(…) when guard`
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Where it begins.
    pub from: Rectangle,
    /// The space it leads to.
    pub space: Name,
    /// Where it leads to.
    pub to: Rectangle,
    /// When it is open.
    pub guard: Option<Expr>,
    /// The whole.
    pub span: Span,
}

/// `map …`
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// The source of its rows and tiles.
    pub source: MapSource,
    /// The whole.
    pub span: Span,
}

/// The source of a map's rows and tiles.
#[derive(Debug, Clone, PartialEq)]
pub enum MapSource {
    /// `map tiles " … "`: the rows from top to bottom, trimmed.
    Inline(Name, Vec<Name>),
    /// `map tiles from "file"`
    Text(Name, Name),
    /// `map vglc "file" legend …`
    Vglc(Name, Legend),
    /// `map level tiles`: the command line names the file.
    Open(Name),
    /// `map level legend …`: the command line names the file.
    OpenLegend(Legend),
    /// `map tiled "file" { … }`
    Tiled(Name, Kinds),
    /// `map ldtk "file" level "name" { … }`
    Ldtk(Name, Option<Name>, Kinds),
    /// `map level { … }`: the command line names the file, and says how it is read.
    OpenAll(Kinds),
}

/// The meaning of characters of a level, or of names in a level editor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Kinds {
    /// `'c': tags`
    pub tiles: Vec<Tile>,
    /// `name: tags`
    pub kinds: Vec<Kind>,
}

/// `name: tags`
#[derive(Debug, Clone, PartialEq)]
pub struct Kind {
    /// The name in the level.
    pub name: Name,
    /// Its tags; `empty` stands for none.
    pub tags: Vec<Name>,
    /// The line up to which tiles of this name are solid.
    pub slope: Option<Box<Slope>>,
    /// Whether tiles of this name can be broken.
    pub breakable: Option<Box<Breakable>>,
    /// The instance that it spawns.
    pub spawn: Option<TileSpawn>,
}

/// `legend "file" tile w x h { 'c': … }`
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// The legend's file.
    pub path: Name,
    /// A tile's width, px.
    pub width: Expr,
    /// A tile's height, px.
    pub height: Expr,
    /// Tiles that differ from the legend.
    pub tiles: Vec<Tile>,
    /// The whole.
    pub span: Span,
}

/// `place name: Entity at (x, y) { settings }`
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// The instance's name.
    pub name: Name,
    /// Its entity.
    pub entity: Name,
    /// Its place.
    pub x: Expr,
    /// Its place.
    pub y: PlaceHeight,
    /// Its own parameters and first values.
    pub settings: Vec<Assignment>,
    /// The whole.
    pub span: Span,
}

/// The height of a place: the second coordinate.
#[derive(Debug, Clone, PartialEq)]
pub enum PlaceHeight {
    /// A number.
    At(Expr),
    /// `above tag`: on top of the lowest tile with the tag over which there is room.
    Above(Name),
}

impl PlaceHeight {
    /// The span of the whole.
    pub fn span(&self) -> Span {
        match self {
            PlaceHeight::At(y) => y.span,
            PlaceHeight::Above(tag) => tag.span,
        }
    }
}

/// `player 1: hero`
#[derive(Debug, Clone, PartialEq)]
pub struct Player {
    /// The player's number as written.
    pub number: Name,
    /// The instance it controls.
    pub instance: Name,
    /// The whole.
    pub span: Span,
}

/// `goal name: predicate` or `never name: predicate`
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Its name.
    pub name: Name,
    /// What is looked for.
    pub predicate: Expr,
}

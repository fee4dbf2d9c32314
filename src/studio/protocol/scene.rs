//! What the page draws: what does not change while a world runs, and the frames of a run.

use serde::{Deserialize, Serialize};

use crate::ir::{Look, TilePicture};

/// What does not change while a world runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Scene {
    /// The path of the main file.
    pub path: String,
    /// The name of the world.
    pub world: String,
    /// The length of a step, s.
    pub step: f64,
    /// The names of all tags.
    pub tags: Vec<String>,
    /// The players in the order in which inputs name them.
    pub players: Vec<PlayerInfo>,
    /// The spaces.
    pub spaces: Vec<SpaceInfo>,
    /// The entities.
    pub entities: Vec<EntityInfo>,
    /// The slots of instances.
    pub slots: Vec<SlotInfo>,
    /// The names of the goals.
    pub goals: Vec<String>,
    /// The names of the `never`s.
    pub nevers: Vec<String>,
}

/// A player.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct PlayerInfo {
    /// Its number as written.
    pub number: u32,
    /// The slot that it controls.
    pub slot: u32,
    /// The names of its buttons.
    pub buttons: Vec<String>,
    /// The names of its axes.
    pub axes: Vec<String>,
}

/// A space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SpaceInfo {
    /// Its name.
    pub name: String,
    /// What it covers: written bounds, or map, geometry and first positions; `[left, bottom, right, top]`, px.
    pub extent: [f64; 4],
    /// Whether it repeats horizontally and vertically.
    pub wraps: [bool; 2],
    /// Its tiles.
    pub map: Option<MapInfo>,
    /// Free-standing geometry.
    pub solids: Vec<SolidInfo>,
    /// Ways out.
    pub links: Vec<LinkInfo>,
}

/// What static geometry is for the players; for other instances, if no player meets it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Nobody meets it.
    Scenery,
    /// It is sensed or looked for, and does not push.
    Sensed,
    /// Solid from above only.
    OneWay,
    /// Solid.
    Solid,
}

/// A free-standing rectangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SolidInfo {
    /// Its tags.
    pub tags: Vec<usize>,
    /// What it is for the players.
    pub role: Role,
    /// Its look, if the program says one.
    pub look: Option<Look>,
    /// `[left, bottom, right, top]`, px.
    pub area: [f64; 4],
}

/// A way to another space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct LinkInfo {
    /// Where it begins: `[left, bottom, right, top]`, px.
    pub area: [f64; 4],
    /// The space it leads to.
    pub space: usize,
}

/// A tile map. Its lower left corner is at (0, 0).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct MapInfo {
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Width and height of a tile, px.
    pub tile: [f64; 2],
    /// What its cells can be painted with.
    pub brushes: Vec<BrushInfo>,
    /// The number of brushes that are too many to show.
    pub brushes_left_out: usize,
    /// Why a map of a level editor is not painted.
    pub unpainted: Option<String>,
    /// Whether the level editor draws cells by rules: it draws a cell that is painted here when it saves the level.
    pub is_drawn_by_rules: bool,
    /// The kinds of tiles.
    pub kinds: Vec<TileInfo>,
    /// For each cell, from the upper left one row by row, its kind, or -1.
    pub cells: Vec<i32>,
    /// What the cells show in the level editor that the map was made with, if that is known.
    pub art: Option<MapArt>,
}

/// What the cells of a map show in its level editor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct MapArt {
    /// The paths of pictures.
    pub pictures: Vec<String>,
    /// Tiles: parts of pictures.
    pub tiles: Vec<TilePicture>,
    /// What cells show, the lowest tile first. The first one is nothing.
    pub stacks: Vec<Vec<u16>>,
    /// For each cell, as in [`MapInfo::cells`], its stack.
    pub cells: Vec<u16>,
}

/// What a cell of a map can be painted with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct BrushInfo {
    /// How [`Request::Paint`](super::Request::Paint) names it: a character, or a tile of a level editor.
    pub symbol: String,
    /// What it is, in a few words.
    pub label: String,
    /// The kind of tile that it is, if the map has one with its tags.
    pub kind: Option<usize>,
    /// Its tile in the level editor: a part of a picture of [`MapInfo::art`].
    pub picture: Option<TilePicture>,
}

/// A kind of tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TileInfo {
    /// Its symbol in the map.
    pub symbol: String,
    /// What it is, in a few words.
    pub label: String,
    /// What it is for the players.
    pub role: Role,
    /// Its look, if the program says one.
    pub look: Option<Look>,
    /// Its tags.
    pub tags: Vec<usize>,
    /// The ends of its slope within the tile, px: `[x1, y1, x2, y2]`.
    pub slope: Option<[f64; 4]>,
    /// Whether it can be broken.
    pub breakable: bool,
}

/// An entity.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EntityInfo {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: Option<String>,
    /// Its look, if the program says one: that of a tag of its colliders counts as well.
    pub look: Option<Look>,
    /// Its colliders.
    pub colliders: Vec<ColliderInfo>,
    /// The paths of its modes, such as `ground.walk`.
    pub modes: Vec<String>,
}

/// A collider.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ColliderInfo {
    /// Its tags.
    pub tags: Vec<usize>,
    /// Whether it is a circle (its box is a square).
    pub is_round: bool,
    /// Whether a contact of it with anything can push; otherwise it only senses.
    pub is_solid: bool,
}

/// A place for an instance.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SlotInfo {
    /// The name of the instance.
    pub name: String,
    /// Its entity.
    pub entity: usize,
    /// The index of its player.
    pub player: Option<usize>,
}

/// A frame that is shown, and what happened on the way to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Shown {
    /// The frame that is shown.
    pub frame: Frame,
    /// The frame before it, to draw between both; none at the start.
    pub before: Option<Frame>,
    /// Number of frames of the history: the greatest number that can be sought.
    pub length: u64,
    /// What happened in the last steps that were played.
    pub events: Vec<EventInfo>,
    /// Whether the first frame is a state that was carried over from the program before a change: no inputs lead there
    /// from the start of the world.
    pub is_carried: bool,
    /// Why the run cannot go on: a player left the bounds, or a rule of the language was broken.
    pub ended: Option<String>,
}

/// A state as it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Frame {
    /// Its number: that of the steps before it.
    pub at: u64,
    /// For each living instance: slot, space, x, y, number of active colliders, and of each its index in the entity and
    /// its box relative to the position: left, bottom, right, top (px).
    pub bodies: Vec<f64>,
    /// The tiles that are broken: space and cell, as in [`MapInfo::cells`].
    pub broken: Vec<[usize; 2]>,
    /// The goals that hold.
    pub goals: Vec<usize>,
    /// The `never`s that hold.
    pub nevers: Vec<usize>,
}

/// An event.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EventInfo {
    /// The frame after the step in which it happened.
    pub frame: u64,
    /// `goal`, `never`, `spawned`, `destroyed`, `entered`.
    pub kind: String,
    /// Of what: the name of the goal, the `never` or the instance.
    pub name: String,
}

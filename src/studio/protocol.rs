//! What the page asks and what it is answered, as JSON. `studio/src/protocol.ts` is the same for the page: they change
//! together.

use serde::{Deserialize, Serialize};

pub use crate::why::{Atom, Contact, EdgeState, Inspected, Place, Value};

/// A request of the page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(tag = "ask", rename_all = "snake_case")]
pub enum Request {
    /// Compiles the files and starts a world from its first state; the history is empty afterwards.
    Open {
        /// The world; the first one if none is named.
        #[serde(default)]
        world: Option<String>,
    },
    /// Compiles the files again, in the same world, and plays the inputs of the history again. With errors, the last
    /// good program goes on.
    Reload,
    /// Steps on from the current frame; what the history has after it is dropped.
    Play {
        /// The input of each step.
        inputs: Vec<StepInput>,
    },
    /// Shows another frame of the history; the history stays.
    Seek {
        /// Number of the frame: 0 is the first state.
        frame: u64,
    },
    /// The positions of the players over the next steps, if an input is held: nothing is stepped.
    Predict {
        /// The input that is held.
        input: StepInput,
        /// Number of steps.
        steps: u32,
    },
    /// What is known about an instance at the current frame.
    Inspect {
        /// Its slot.
        slot: u32,
    },
    /// What the values of an instance can be at all, by the analysis: it runs beside the play.
    Bounds {
        /// Its slot.
        slot: u32,
    },
    /// The statechart of an entity.
    Chart {
        /// Its name.
        entity: String,
    },
    /// The inputs of the history as a script.
    Script,
    /// Replaces the history by a script, and shows its end.
    Load {
        /// The script, as in `.inputs` files.
        script: String,
    },
    /// The numbers in the text that can be changed while playing.
    Sliders,
    /// Changes a number, and plays the inputs of the history again.
    Set {
        /// Which: its index in the last list of sliders.
        slider: usize,
        /// The new value, in the unit in which it is written.
        value: f64,
    },
    /// Writes a number that was set into the text, and only this one; numbers that were set before stay set.
    Write {
        /// Which: its index in the last list of sliders.
        slider: usize,
    },
    /// The text of a file of the program, with the numbers that were set.
    Text {
        /// Its path; that of the main file if there is none.
        #[serde(default)]
        path: Option<String>,
        /// Whether it is wanted without the numbers that were set.
        #[serde(default)]
        written: bool,
    },
    /// Reads a file from this text from now on, in place of the one on the disk.
    Edit {
        /// Its path; that of the main file if there is none.
        #[serde(default)]
        path: Option<String>,
        /// Its text; the file on the disk is read again if there is none.
        text: Option<String>,
    },
    /// Paints a cell of a map: replaces its character in the text, and plays the inputs of the history again.
    Paint {
        /// The space.
        space: usize,
        /// The cell, as in [`MapInfo::cells`].
        cell: usize,
        /// The new character.
        symbol: String,
    },
    /// Takes back the last [`Request::Paint`] or [`Request::Write`].
    Undo,
    /// Starts a search from the current frame; a search that runs is stopped.
    Search {
        /// What is searched for.
        target: Target,
        /// The budget.
        nodes: u64,
        /// The seed.
        #[serde(default)]
        seed: u64,
    },
    /// How far the search is; its result if it has ended.
    Poll,
    /// Stops the search; the next [`Request::Poll`] answers what it has.
    Stop,
}

/// What a search is for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A goal by its name.
    Goal(String),
    /// A `never` by its name: is there a violation?
    Never(String),
    /// A predicate, as `hypedc reach --without` takes it.
    Predicate(String),
    /// A place for the first player: the space, x and y.
    Place([f64; 3]),
}

/// The inputs of all players in one step, in the order of [`Scene::players`].
pub type StepInput = Vec<Held>;

/// The input of a player.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Held {
    /// Indices of the buttons that are down.
    #[serde(default)]
    pub buttons: Vec<usize>,
    /// The axes, from -1 to 1; missing ones are 0.
    #[serde(default)]
    pub axes: Vec<f64>,
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// A program runs: after `open`, `reload`, `set` and `edit`.
    Opened(Box<Opened>),
    /// Another frame is shown: after `play`, `seek` and `load`.
    Shown(Shown),
    /// The positions of the players, one list each, the current one first: `[space, x, y]`. A list ends where the
    /// player is gone or the run stops.
    Predicted {
        /// One list for each player.
        paths: Vec<Vec<[f64; 3]>>,
    },
    /// An instance.
    Inspected(Box<Inspected>),
    /// What the values of an instance can be.
    Bounds {
        /// Whether the analysis has ended; otherwise there are no values yet.
        is_ready: bool,
        /// The values, with kinds and names as in [`Inspected::values`].
        values: Vec<Value>,
    },
    /// A statechart.
    Chart {
        /// The entity.
        entity: String,
        /// The picture. The group of a mode has the attribute `data-mode`: its index in [`EntityInfo::modes`]; an
        /// edge has the attribute `data-edge`: as [`EdgeState::edge`].
        svg: String,
    },
    /// A script, or a text.
    Text {
        /// The text.
        text: String,
    },
    /// The numbers that can be changed.
    Sliders {
        /// All of them, in the order of the text.
        sliders: Vec<Slider>,
    },
    /// How far a search is.
    Searching(Searching),
    /// Done; there is nothing to tell.
    Done,
    /// The request could not be served.
    Refused {
        /// Why.
        message: String,
    },
}

/// A program that runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Opened {
    /// Errors and warnings of the texts as they are now.
    pub findings: Vec<Finding>,
    /// Whether the program is the one of these texts; otherwise they have errors, and the last good one goes on.
    pub is_current: bool,
    /// The paths of the files that the program is made of, the main one first.
    pub files: Vec<String>,
    /// The paths of those that differ from the disk.
    pub unsaved: Vec<String>,
    /// The names of the worlds.
    pub worlds: Vec<String>,
    /// What does not change while the world runs; none if there was no program without errors yet.
    pub scene: Option<Scene>,
    /// The frame that is shown.
    pub shown: Option<Shown>,
    /// Of the same inputs with the program before: the positions of the players at each step, as in
    /// [`Answer::Predicted`]; empty if nothing was played.
    pub ghost: Vec<Vec<[f64; 3]>>,
    /// What could not be kept of the history, in a sentence.
    pub lost: Option<String>,
}

/// A finding about the text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Finding {
    /// `error` or `warning`.
    pub severity: String,
    /// Its code.
    pub code: String,
    /// What was found.
    pub message: String,
    /// The place of the mistake, if it has one.
    pub place: Option<Place>,
    /// Other places, with what they say.
    pub labels: Vec<(Place, String)>,
    /// Ways out.
    pub helps: Vec<String>,
}

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
    /// Whether its cells are characters that can be painted.
    pub is_painted: bool,
    /// The kinds of tiles.
    pub kinds: Vec<TileInfo>,
    /// For each cell, from the upper left one row by row, its kind, or -1.
    pub cells: Vec<i32>,
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

/// A number in the text: a `param` or a `const` that is written as a literal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Slider {
    /// The entity; none of a `const`.
    pub entity: Option<String>,
    /// The name.
    pub name: String,
    /// The value, in the unit in which it is written.
    pub value: f64,
    /// The value that is written in the file.
    pub written: f64,
    /// The unit that is written after it.
    pub unit: String,
    /// Where the literal is.
    pub place: Place,
}

/// How far a search is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Searching {
    /// Whether it still runs.
    pub is_running: bool,
    /// Nodes so far.
    pub nodes: u64,
    /// The budget.
    pub budget: u64,
    /// Places covered.
    pub places: u64,
    /// The positions of new nodes since the last answer: `[space, x, y]`.
    pub points: Vec<[f64; 3]>,
    /// The verdict in a sentence, once it has ended.
    pub verdict: Option<String>,
    /// `reached`, `not_found`, `unreachable`, …
    pub conclusion: Option<String>,
    /// The script that leads there from the first frame: the history up to where the search began, and what was found.
    pub script: Option<String>,
    /// The positions of the players along it, as in [`Answer::Predicted`], from where the search began.
    pub ghost: Vec<Vec<[f64; 3]>>,
}

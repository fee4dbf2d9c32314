//! What the page asks and what it is answered, as JSON. `studio/src/protocol.ts` is the same for the page: they change
//! together.

mod inspected;
mod scene;

use serde::{Deserialize, Serialize};

pub use crate::why::Place;
pub use inspected::*;
pub use scene::*;

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
    /// Says what goes on after a change of the program.
    Keep {
        /// The state of the current frame, by names; otherwise the inputs of the history are played again.
        state: bool,
    },
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
    /// States of the history as the lines of a trace, in the format of `hypedc sim --trace`.
    Trace {
        /// The first frame.
        from: u64,
        /// Number of frames.
        count: u32,
    },
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
    /// Paints a cell of a map: replaces its character or its number in the text, and plays the inputs of the history again.
    Paint {
        /// The space.
        space: usize,
        /// The cell, as in [`MapInfo::cells`].
        cell: usize,
        /// What it is painted with: [`BrushInfo::symbol`].
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
        /// The values while certain modes are active, for each set of modes that can be.
        in_modes: Vec<BoundsInModes>,
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
    /// What could not be kept of the history or of the state, in a sentence.
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

//! Why a goal was not reached, as a record of plain data: the states that came nearest, and where the way ended. It says
//! what one search saw, and proves nothing.

use serde::{Deserialize, Serialize};

use super::words::distance_words;

/// Why a goal was not reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct WhyNot {
    /// Number of nodes of the search that saw all this.
    pub nodes: u64,
    /// Whether that was a small search beside a proof, which needs none.
    pub is_sample: bool,
    /// The state in which the whole goal came nearest; null if no state could be compared.
    pub nearest: Option<NearState>,
    /// For each part of the goal, the state in which it came nearest by itself; empty if there is only one part.
    pub parts: Vec<PartNearest>,
    /// Where the way in the direction of the goal ends, of a player that falls or that an instance blocks; null if that is
    /// not known.
    pub way: Option<WayEnd>,
    /// The highest rise of the first player above where it rested before, px.
    pub highest_jump: f64,
    /// The longest way of the first player from where it rested to where it rested next, not lower, px.
    pub longest_jump: f64,
    /// Rooms that the first player never entered.
    pub rooms: Vec<ClosedRoom>,
    /// Modes that an instance was never in: those that lead to a mode of the goal, those to which an instance could go that is
    /// in the way, and those of the first player to which an edge of a mode leads that it was in.
    pub modes: Vec<ClosedMode>,
}

impl PartState {
    /// Its text with what it lacks.
    pub fn phrase(&self) -> String {
        if self.text.is_empty() { self.words.clone() } else { format!("`{}` {}", self.text, self.words) }
    }

    /// How far it is from holding, with its unit; `None` if there is no measure, and if it is at the limit.
    pub fn distance_words(&self) -> Option<String> {
        self.distance.filter(|distance| *distance > 0.0).map(|distance| distance_words(distance, &self.unit))
    }
}

impl WhyNot {
    /// The first missing part in the nearest state.
    pub fn missing(&self) -> Option<&PartState> {
        self.nearest.as_ref()?.parts.iter().find(|part| !part.holds)
    }

    /// What came nearest, in one phrase.
    pub fn phrase(&self) -> Option<String> {
        let column = self.nearest.as_ref()?.at.column.map_or(String::new(), |column| format!(" at column {column}"));
        Some(format!("{}{column}", self.missing()?.phrase()))
    }
}

/// A state of a search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Point {
    /// The number of steps to it.
    pub step: u64,
    /// The time in the world, s.
    pub seconds: f64,
    /// The space of the first player; null without players.
    pub space: Option<String>,
    /// Its position, px.
    pub x: f64,
    /// Its position, px.
    pub y: f64,
    /// The column of the map, from 1; null outside of it and without a map.
    pub column: Option<usize>,
    /// The inputs that lead there, as a script.
    pub inputs: String,
}

/// The state in which the whole goal came nearest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct NearState {
    /// The state.
    #[serde(flatten)]
    pub at: Point,
    /// Each part of the goal in it.
    pub parts: Vec<PartState>,
}

/// A part of a goal in a state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct PartState {
    /// Its text.
    pub text: String,
    /// Whether it holds.
    pub holds: bool,
    /// How far it is from holding; null if there is no measure, 0 if it holds or is at the limit.
    pub distance: Option<f64>,
    /// The unit of the distance, such as `px/s`, `rooms` or `edges`; empty for counts and where the program does not tell.
    pub unit: String,
    /// The same in words: `misses by 12.4 px`.
    pub words: String,
}

/// The state in which a part of a goal came nearest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct PartNearest {
    /// The part.
    #[serde(flatten)]
    pub part: PartState,
    /// The state; null if no state could be compared.
    pub at: Option<Point>,
}

/// Where the way in the direction of the goal ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct WayEnd {
    /// The space.
    pub space: String,
    /// The position of the player at the end of the footing on which it stood nearest to the goal, px.
    pub x: f64,
    /// The same.
    pub y: f64,
    /// The column of the map, from 1; null without a map.
    pub column: Option<usize>,
    /// What is between there and the goal.
    pub barrier: Barrier,
    /// Its height or length, px; null if there is none, or no end of it.
    pub size: Option<f64>,
    /// The same in tiles; null without a map.
    pub tiles: Option<f64>,
    /// The same in words.
    pub words: String,
}

/// What is between a place and a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Barrier {
    /// A wall that is higher than any jump that was seen.
    Wall,
    /// No footing for further than any jump that was seen.
    Gap,
    /// The goal is higher above than any jump that was seen.
    Height,
    /// An instance that blocks the player in the nearest state.
    Instance,
    /// Nothing that is known.
    Unknown,
}

/// A room that was never entered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ClosedRoom {
    /// Its name.
    pub room: String,
    /// The room with a link to it in which the player was; null if there is none.
    pub from: Option<String>,
    /// The file and the line of the link.
    pub place: Option<String>,
    /// The condition of the link, if it has one.
    pub guard: Option<PartState>,
}

/// A mode that was never entered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ClosedMode {
    /// The instance.
    pub instance: String,
    /// Whether it leads to a mode that the goal asks for, or is one, or is one of an instance in the way.
    pub is_asked: bool,
    /// Its path.
    pub mode: String,
    /// The mode with the edge that came nearest, on the way to the nearest state.
    pub from: String,
    /// The file and the line of the edge.
    pub place: Option<String>,
    /// The step in which its guard came nearest; null if it was never tried on that way, and if nothing that is missing has a
    /// distance.
    pub step: Option<u64>,
    /// What was missing then, a phrase each.
    pub missing: Vec<String>,
}

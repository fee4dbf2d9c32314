//! What the page tells of a program beside the level: instances, their edges and values (of [`crate::why`]), numbers that can be changed,
//! and searches.

use serde::{Deserialize, Serialize};

use super::Place;

pub use crate::why::{Atom, Contact, EdgeState, Inspected, Value};

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

/// What the values of an instance can be while certain modes are active.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct BoundsInModes {
    /// The modes, sorted: all that are active, as in [`Inspected::modes`].
    pub modes: Vec<usize>,
    /// The values in the order of [`Answer::Bounds`](super::Answer::Bounds).
    pub values: Vec<String>,
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
    /// The new nodes since the last answer: `[space, x, y, x before, y before]`, with the position in the node before, or
    /// the same one again if that is in another space.
    pub points: Vec<[f64; 5]>,
    /// The verdict in a sentence, once it has ended.
    pub verdict: Option<String>,
    /// `reached`, `not_found`, `unreachable`, …
    pub conclusion: Option<String>,
    /// The script that leads there from the first frame: the history up to where the search began, and what was found.
    pub script: Option<String>,
    /// The positions of the players along it, as in `Answer::Predicted`, from where the search began.
    pub ghost: Vec<Vec<[f64; 3]>>,
}

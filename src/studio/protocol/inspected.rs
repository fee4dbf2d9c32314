//! What the page tells of a program beside the level: instances, their edges and values, numbers that can be changed,
//! and searches.

use serde::{Deserialize, Serialize};

use super::Place;

/// An instance at the current frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Inspected {
    /// Its slot.
    pub slot: u32,
    /// Whether it is there.
    pub is_alive: bool,
    /// Indices of its active modes, outer ones included.
    pub modes: Vec<usize>,
    /// Variables, discrete variables and parameters with their values as text, and for how long.
    pub values: Vec<Value>,
    /// The contact queries that hold.
    pub contacts: Vec<Contact>,
    /// The edges that were considered in the step that led to this frame.
    pub edges: Vec<EdgeState>,
}

/// A contact query that holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Contact {
    /// The query as it is written, or the condition that it is in.
    pub text: String,
    /// The side that it asks for: `left`, `right`, `above` or `below`.
    pub side: Option<String>,
}

/// A value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Value {
    /// `variable`, `discrete`, `parameter`, `reference` or `timer`.
    pub kind: String,
    /// Its name.
    pub name: String,
    /// Its value with its unit, as the language writes it.
    pub value: String,
}

/// An edge in the step that led to the current frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EdgeState {
    /// Its index in the entity.
    pub edge: usize,
    /// The mode whose edge it is, and the target.
    pub from: usize,
    /// The target; none if it stays.
    pub to: Option<usize>,
    /// Whether its guard held.
    pub held: bool,
    /// Whether it was taken.
    pub taken: bool,
    /// Its line in the text.
    pub place: Option<Place>,
    /// The parts of its guard that `and` and `or` join, with their values.
    pub atoms: Vec<Atom>,
}

/// A part of a guard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Atom {
    /// Its text.
    pub text: String,
    /// Whether it held; none if it could not be evaluated.
    pub held: Option<bool>,
    /// Of a comparison, both sides.
    pub sides: Option<[f64; 2]>,
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
    /// The new nodes since the last answer: `[space, x, y, x before, y before]`, with the position in the node before, or
    /// the same one again if that is in another space.
    pub points: Vec<[f64; 5]>,
    /// The verdict in a sentence, once it has ended.
    pub verdict: Option<String>,
    /// `reached`, `not_found`, `unreachable`, …
    pub conclusion: Option<String>,
    /// The script that leads there from the first frame: the history up to where the search began, and what was found.
    pub script: Option<String>,
    /// The positions of the players along it, as in [`Answer::Predicted`], from where the search began.
    pub ghost: Vec<Vec<[f64; 3]>>,
}

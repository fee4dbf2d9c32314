//! The records of an instance at a step, which the page of a play session and `hypedc why` share: modes and values, contacts,
//! and of each edge that was considered whether its guard held, part by part.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A place in a file: lines and columns from 1, columns in UTF-16 code units.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Place {
    /// The path of the file.
    pub path: String,
    /// First line.
    pub line: usize,
    /// Column of its first character.
    pub column: usize,
    /// Last line.
    pub end_line: usize,
    /// Column after its last character.
    pub end_column: usize,
}

/// Its file and its first line: `game.hyped:12`.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.path, self.line)
    }
}

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

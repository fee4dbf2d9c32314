//! Facts about worlds.

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// Map rows of different length.
pub struct RowLength {
    /// The row.
    pub at: Span,
    /// How many tiles it has.
    pub length: usize,
    /// How many most rows have.
    pub expected: usize,
    /// One of them.
    pub model: Span,
}

impl Fact for RowLength {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, format!("a row has {} tiles, others have {}", self.length, self.expected))
            .at(self.at, format!("{} tiles", self.length))
            .and(self.model, format!("{} tiles", self.expected))
    }
}

/// A map character without a tile.
pub struct UnknownTile {
    /// The character.
    pub symbol: char,
    /// Its first place.
    pub at: Span,
    /// How often it occurs.
    pub count: usize,
    /// The name of the tile set.
    pub tiles: String,
    /// Where the tile set stands.
    pub declared: Span,
}

impl Fact for UnknownTile {
    fn word(self) -> Diagnostic {
        let times = if self.count == 1 { String::new() } else { format!(" ({} times)", self.count) };
        Diagnostic::new(Code::BadMap, format!("no tile `{}` in `tiles {}`{times}", self.symbol, self.tiles))
            .at(self.at, "no tile has this character")
            .and(self.declared, "the tile set")
            .help(format!("add `'{}': empty`, or tags instead of `empty`", self.symbol))
    }
}

/// A map without tiles.
pub struct EmptyMap {
    /// The map.
    pub at: Span,
}

impl Fact for EmptyMap {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, "this map has no tiles").at(self.at, "no rows")
    }
}

/// A step that is not a positive time.
pub struct BadStep {
    /// The step.
    pub at: Span,
}

impl Fact for BadStep {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::BadStep, "a step is a positive number of seconds, at most 10")
            .at(self.at, "not an exact fraction of a second")
            .help("write it as a number or as a fraction of two numbers: `step 1/60`")
    }
}

/// Players and instances that do not fit together.
pub struct BadPlayer {
    /// The `player` line.
    pub at: Span,
    /// Why.
    pub why: String,
    /// The other line, where there is one.
    pub other: Option<Span>,
}

impl Fact for BadPlayer {
    fn word(self) -> Diagnostic {
        let d = Diagnostic::new(Code::BadPlayer, self.why).at(self.at, "this player");
        match self.other {
            Some(other) => d.and(other, "the other one"),
            None => d,
        }
    }
}

/// A character that cannot be a tile.
pub struct BadTile {
    /// The character.
    pub at: Span,
}

impl Fact for BadTile {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, "a tile is neither white space nor `\"`")
            .at(self.at, "cannot stand in a map")
            .help("rows are trimmed, and a `\"` ends the map; use another character")
    }
}

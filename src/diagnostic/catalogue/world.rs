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
        let tiles = |count: usize| format!("{count} tile{}", if count == 1 { "" } else { "s" });
        let length = tiles(self.length);
        Diagnostic::new(Code::BadMap, format!("a row has {length}, others have {}", self.expected))
            .at(self.at, length)
            .and(self.model, tiles(self.expected))
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
    /// The tile set or legend: `tiles basic`.
    pub tiles: String,
    /// Where the tile set stands.
    pub declared: Span,
}

impl Fact for UnknownTile {
    fn word(self) -> Diagnostic {
        let times = if self.count == 1 { String::new() } else { format!(" ({} times)", self.count) };
        Diagnostic::new(Code::BadMap, format!("no tile `{}` in `{}`{times}", self.symbol, self.tiles))
            .at(self.at, "no tile has this character")
            .and(self.declared, "the tile set")
            .help(if self.symbol.is_whitespace() || self.symbol == '"' {
                "a tile is never white space or `\"`: use another character".into()
            } else {
                format!("add `'{}': empty`, or tags instead of `empty`", self.symbol)
            })
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

/// More instances of an entity than its limit allows.
pub struct OverLimit {
    /// The `limit` line.
    pub at: Span,
    /// The entity.
    pub name: String,
    /// How many are placed or made by tiles.
    pub living: usize,
    /// How many may live.
    pub limit: usize,
    /// One that is too many.
    pub one: Option<Span>,
}

impl Fact for OverLimit {
    fn word(self) -> Diagnostic {
        let OverLimit { at, name, living, limit, one } = self;
        let message = format!("{living} instances of `{name}` live at first, at most {limit} may");
        let d = Diagnostic::new(Code::BadLimit, message).at(at, format!("at most {limit}"));
        match one {
            Some(span) => d.and(span, "one too many"),
            None => d,
        }
    }
}

/// An entity that is spawned without a limit.
pub struct MissingLimit {
    /// The world.
    pub at: Span,
    /// The entity.
    pub name: String,
    /// Where it is spawned.
    pub spawn: Span,
}

impl Fact for MissingLimit {
    fn word(self) -> Diagnostic {
        let MissingLimit { at, name, spawn } = self;
        Diagnostic::new(Code::BadLimit, format!("`{name}` is spawned in a world that sets no limit for it"))
            .at(at, "this world")
            .and(spawn, "spawned here")
            .help(format!("add `limit {name} 8` to the world: so many may live at once"))
    }
}

/// A tile with `as` that does not stand exactly once.
pub struct TileInstances {
    /// The name.
    pub at: Span,
    /// The name.
    pub name: String,
    /// The tile.
    pub symbol: char,
    /// How often it stands in the map.
    pub count: u64,
    /// The map.
    pub map: Span,
}

impl Fact for TileInstances {
    fn word(self) -> Diagnostic {
        let TileInstances { at, name, symbol, count, map } = self;
        let message =
            format!("the tile `{symbol}` stands {count} times in the map, so `{name}` names no single instance");
        Diagnostic::new(Code::TileInstances, message)
            .at(at, "needs exactly one such tile")
            .and(map, format!("{count} times here"))
            .help("leave out `as`, or use a character of its own")
    }
}

/// A legend that cannot be read.
pub struct BadLegend {
    /// Where in the legend.
    pub at: Span,
    /// Why.
    pub why: String,
}

impl Fact for BadLegend {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, format!("this is no legend: {}", self.why))
            .at(self.at, "here")
            .help("a legend is JSON: `{ \"tiles\": { \"X\": [\"solid\", \"ground\"], … } }`")
    }
}

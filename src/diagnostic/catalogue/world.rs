//! Facts about worlds.

use super::did_you_mean;
use crate::diagnostic::suggestion::{BlockKind, Change, Piece};
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// Map rows of different length.
pub struct RowLength {
    /// The row.
    pub at: Span,
    /// The number of the row, from 1 at the top.
    pub row: usize,
    /// Its number of tiles.
    pub length: usize,
    /// The most frequent length.
    pub expected: usize,
    /// A row of that length.
    pub model: Span,
    /// What can stand for the missing tiles: the most frequent one of the row.
    pub fill: char,
    /// What is too much of the row; empty, and at its end, if it is too short.
    pub rest: Span,
}

impl Fact for RowLength {
    fn into_diagnostic(self) -> Diagnostic {
        let tiles = |count: usize| format!("{count} tile{}", if count == 1 { "" } else { "s" });
        let length = tiles(self.length);
        let missing = self.expected.saturating_sub(self.length);
        let more = self.fill.to_string().repeat(missing);
        let title = match missing {
            0 => format!("remove {} of the row", tiles(self.length - self.expected)),
            _ => format!("add `{more}` to the row"),
        };
        Diagnostic::new(Code::BadMap, format!("row {} has {length}, others have {}", self.row, self.expected))
            .at(self.at, length)
            .and(self.model, tiles(self.expected))
            .suggest(title, vec![Change::Write(self.rest, vec![Piece::Text(more)])])
    }
}

/// A map character without a tile.
pub struct UnknownTile {
    /// The character.
    pub symbol: char,
    /// Its first place.
    pub at: Span,
    /// The number of occurrences.
    pub count: usize,
    /// The tile set or legend: `tiles basic`.
    pub tiles: String,
    /// Where the tile set is.
    pub declared: Span,
    /// The characters that it defines.
    pub known: Vec<char>,
}

/// Maximum number of listed characters of a tile set.
const MAX_LISTED: usize = 20;

/// The characters of a tile set, the most similar first: the other case of a letter.
fn listed_symbols(mut known: Vec<char>, symbol: char) -> Option<String> {
    let is_case = |c: &char| c.to_lowercase().eq(symbol.to_lowercase());
    known.sort_unstable_by_key(|c| (!is_case(c), *c));
    let shown: Vec<String> = known.iter().take(MAX_LISTED).map(|c| format!("`{c}`")).collect();
    let more = known.len().saturating_sub(MAX_LISTED);
    match (shown.is_empty(), more) {
        (true, _) => None,
        (false, 0) => Some(format!("it has {}", shown.join(" "))),
        (false, _) => Some(format!("it has {} and {more} more", shown.join(" "))),
    }
}

impl Fact for UnknownTile {
    fn into_diagnostic(self) -> Diagnostic {
        let times = if self.count == 1 { String::new() } else { format!(" ({} times)", self.count) };
        let d = Diagnostic::new(Code::BadMap, format!("no tile `{}` in `{}`{times}", self.symbol, self.tiles))
            .at(self.at, "no tile has this character")
            .and(self.declared, listed_symbols(self.known, self.symbol).unwrap_or_else(|| "has no characters".into()));
        let is_tile = !(self.symbol.is_whitespace() || self.symbol == '"');
        let line = format!("'{}': empty", self.symbol);
        let d = if is_tile { d.or_add(BlockKind::Tiles, self.declared, line) } else { d };
        d.help(if self.symbol.is_whitespace() || self.symbol == '"' {
            "a tile is never white space or `\"`: use another character".into()
        } else {
            format!("add `'{}': empty`, or tags instead of `empty`", self.symbol)
        })
    }
}

/// A file of another format where a map needs rows of characters.
pub struct NotRows {
    /// Its beginning, or the first character that is not text.
    pub at: Span,
    /// Its format.
    pub what: &'static str,
    /// The way to read it.
    pub help: Option<&'static str>,
}

impl Fact for NotRows {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::BadMap, format!("this level is {}, not rows of tiles", self.what));
        let d = d.at(self.at, "here");
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// A map without tiles.
pub struct EmptyMap {
    /// The map.
    pub at: Span,
}

impl Fact for EmptyMap {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, "this map has no tiles").at(self.at, "no rows")
    }
}

/// A step that is not a positive time.
pub struct BadStep {
    /// The step.
    pub at: Span,
}

impl Fact for BadStep {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BadStep, "a step is a positive number of seconds, at most 10")
            .at(self.at, "not an exact fraction of a second")
            .help("write it as a number or as a fraction of two numbers: `step 1/60`")
            .or_wrap("write a fraction of a second: `1/…`", self.at, "1/", "")
            .or_write(self.at, "1/60")
    }
}

/// An inconsistency between players and instances.
pub struct BadPlayer {
    /// The `player` line.
    pub at: Span,
    /// The reason.
    pub why: String,
    /// The related line, if any.
    pub other: Option<Span>,
    /// The number of the line, and a number that no other player has.
    pub free: Option<(Span, u32)>,
}

impl Fact for BadPlayer {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::BadPlayer, self.why).at(self.at, "this player");
        let d = self.free.into_iter().fold(d, |d, (at, number)| d.or_write(at, number.to_string()));
        let d = d.or_remove("the line", self.at);
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
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, "a tile is neither white space nor `\"`")
            .at(self.at, "is not allowed in a map")
            .help("rows are trimmed, and a `\"` ends the map; use another character")
    }
}

/// More instances of an entity than its limit allows.
pub struct OverLimit {
    /// The `limit` line.
    pub at: Span,
    /// The entity.
    pub name: String,
    /// The number that is placed or spawned by tiles.
    pub living: usize,
    /// The limit.
    pub limit: usize,
    /// An instance above the limit.
    pub one: Option<Span>,
}

impl Fact for OverLimit {
    fn into_diagnostic(self) -> Diagnostic {
        let OverLimit { at, name, living, limit, one } = self;
        let message = format!("{living} instances of `{name}` live at first, at most {limit} may");
        let d = Diagnostic::new(Code::BadLimit, message).at(at, format!("at most {limit}"));
        let d = d.or_write(at, format!("limit {name} {living}"));
        match one {
            Some(span) => d.and(span, "one too many"),
            None => d,
        }
    }
}

/// A spawned entity without a limit.
pub struct MissingLimit {
    /// The world.
    pub at: Span,
    /// The entity.
    pub name: String,
    /// Where it is spawned.
    pub spawn: Span,
}

impl Fact for MissingLimit {
    fn into_diagnostic(self) -> Diagnostic {
        let MissingLimit { at, name, spawn } = self;
        Diagnostic::new(Code::BadLimit, format!("`{name}` is spawned in a world that sets no limit for it"))
            .at(at, "this world")
            .and(spawn, "spawned here")
            .help(format!("add `limit {name} 8` to the world: the most that live at once"))
            .or_add(BlockKind::World, at, format!("limit {name} 8"))
    }
}

/// A place above a tag that is nowhere.
pub struct NoPlaceAbove {
    /// The tag.
    pub at: Span,
    /// The tag.
    pub tag: String,
    /// The space.
    pub space: String,
    /// Where in the space, px; none if the space has no map.
    pub x: Option<f64>,
}

impl Fact for NoPlaceAbove {
    fn into_diagnostic(self) -> Diagnostic {
        let NoPlaceAbove { at, tag, space, x } = self;
        let tag = as_tag(&tag);
        match x {
            Some(x) => {
                Diagnostic::new(Code::NoPlaceAbove, format!("no tile with room above it is tagged `{tag}` at x = {x}"))
                    .at(at, format!("nothing to stand on in the map of `{space}`"))
                    .help("choose another x, or write the height as a number")
            }
            None => Diagnostic::new(Code::NoPlaceAbove, format!("`above {tag}` in a space without a map"))
                .at(at, format!("`{space}` has no tiles"))
                .help("write the height as a number; what is above a `rect` begins at its upper edge, y plus height"),
        }
    }
}

/// A tile with `as` that does not occur exactly once.
pub struct TileInstances {
    /// The name.
    pub at: Span,
    /// The name.
    pub name: String,
    /// The tile: its character, or its name.
    pub tile: String,
    /// The number of occurrences in the map.
    pub count: u64,
    /// The map.
    pub map: Span,
}

impl Fact for TileInstances {
    fn into_diagnostic(self) -> Diagnostic {
        let TileInstances { at, name, tile, count, map } = self;
        let message = format!("the tile `{tile}` occurs {count} times, so `{name}` names no single instance");
        Diagnostic::new(Code::TileInstances, message)
            .at(at, "needs exactly one such tile")
            .or_remove("the name", at)
            .and(map, if count == 0 { "not in this map" } else { "in this map" })
            .help(match count {
                0 => "put the tile into a map, or `place` the instance",
                _ => "leave out `as`, or use a tile of its own",
            })
    }
}

/// A legend that cannot be read.
pub struct BadLegend {
    /// Where in the legend.
    pub at: Span,
    /// The reason.
    pub why: String,
}

impl Fact for BadLegend {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, format!("this is no legend: {}", self.why))
            .at(self.at, "here")
            .help("a legend is JSON: `{ \"tiles\": { \"X\": [\"solid\", \"ground\"], … } }`")
    }
}

/// Maximum number of names in a message about missing ones.
const MAX_NAMES: usize = 4;

/// Names of instances that only the level of an open map can have, and no level is given.
pub struct MissingLevel {
    /// The first of them.
    pub at: Span,
    /// The names.
    pub names: Vec<String>,
    /// The world.
    pub world: String,
    /// The map.
    pub map: Span,
    /// One that is similar to a known name, and that name.
    pub near: Option<(String, String)>,
}

impl Fact for MissingLevel {
    fn into_diagnostic(self) -> Diagnostic {
        let MissingLevel { at, names, world, map, near } = self;
        let mut shown: Vec<String> = names.iter().take(MAX_NAMES).map(|name| format!("`{name}`")).collect();
        if let Some(others @ 1..) = names.len().checked_sub(MAX_NAMES) {
            shown.push(format!("{others} more"));
        }
        let listed = super::list(&shown, "and");
        let is = if names.len() == 1 { "is no instance" } else { "are no instances" };
        let help = match near {
            Some((name, near)) => format!("give the level with `--map PATH`; if it has no `{name}`, write `{near}`"),
            None => "give the level with `--map PATH`".to_string(),
        };
        Diagnostic::new(Code::NoQuestion, format!("the map of `{world}` is missing, and {listed} {is} without it"))
            .at(at, "no instance of the program")
            .and(map, "leaves the level to the command line")
            .help(help)
    }
}

/// A level of the command line, without the options that its map requires.
pub struct UnreadLevel {
    /// The map.
    pub at: Span,
    /// The level's file.
    pub path: String,
    /// Whether a legend is missing.
    pub legend: bool,
    /// Whether the size of tiles is missing.
    pub tile: bool,
}

impl Fact for UnreadLevel {
    fn into_diagnostic(self) -> Diagnostic {
        let missing: &[&str] = match (self.legend, self.tile) {
            (true, true) => &["--legend LEGEND.json", "--tile 16x16"],
            (true, false) => &["--legend LEGEND.json"],
            _ => &["--tile 16x16"],
        };
        let what = match (self.legend, self.tile) {
            (true, true) => "what its characters stand for and how large its tiles are",
            (true, false) => "what its characters stand for",
            _ => "how large its tiles are",
        };
        Diagnostic::new(Code::NoQuestion, format!("nothing says how to read `{}`: {what}", self.path))
            .at(self.at, "leaves it to the command line")
            .help(format!("add `{}`", missing.join(" ")))
    }
}

/// A legend of the command line that has no effect.
pub struct RedundantLegend {
    /// Its path.
    pub legend: String,
    /// The tile set's name.
    pub tiles: String,
    /// Where the tile set is declared.
    pub at: Span,
}

impl Fact for RedundantLegend {
    fn into_diagnostic(self) -> Diagnostic {
        let RedundantLegend { legend, tiles, at } = self;
        let message = format!("`tiles {tiles}` has all characters of `{legend}`: the legend says nothing");
        Diagnostic::new(Code::NoQuestion, message)
            .at(at, "goes before the legend")
            .help("leave out `--legend`, or write `map level` without a tile set")
    }
}

/// A level of an editor that cannot be read.
pub struct BadLevel {
    /// Where in its files.
    pub at: Span,
    /// The reason.
    pub why: String,
}

impl Fact for BadLevel {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BadLevel, self.why).at(self.at, "here")
    }
}

/// An object of a level whose class is no entity.
pub struct UnknownObject {
    /// Where it is in the level.
    pub at: Span,
    /// Its class.
    pub class: String,
    /// The number of such objects.
    pub count: usize,
    /// The nearest entity.
    pub near: Option<String>,
    /// The map.
    pub map: Span,
}

impl Fact for UnknownObject {
    fn into_diagnostic(self) -> Diagnostic {
        let UnknownObject { at, class, count, near, map } = self;
        let times = if count == 1 { String::new() } else { format!(" ({count} of them)") };
        let message =
            format!("`{class}`{times} of the level is no entity of the program{}", did_you_mean(near.as_ref()));
        let name = as_tag(&class);
        let d = Diagnostic::new(Code::BadLevel, message);
        let spawn = near.as_ref().map(|near| format!("{name}: spawn {near}"));
        let d = spawn.into_iter().fold(d, |d, line| d.or_add(BlockKind::Map, map, line));
        let entity = near.unwrap_or_else(|| "ENTITY".into());
        d.or_add(BlockKind::Map, map, format!("{name}: empty"))
            .at(at, "what is this?")
            .and(map, "in this map")
            .help(format!("add `{name}: spawn {entity}` to the map's block, or `{name}: empty` to leave it out"))
    }
}

/// A property of a level that its entity does not have.
pub struct UnknownSetting {
    /// The property.
    pub at: Span,
    /// Its name.
    pub name: String,
    /// The entity.
    pub entity: String,
    /// The number of instances that have it.
    pub count: usize,
    /// The nearest name that the entity has.
    pub near: Option<String>,
}

impl Fact for UnknownSetting {
    fn into_diagnostic(self) -> Diagnostic {
        let UnknownSetting { at, name, entity, count, near } = self;
        let times = if count == 1 { String::new() } else { format!(" ({count} times)") };
        let message =
            format!("the level sets `{name}`{times}, which `{entity}` does not have{}", did_you_mean(near.as_ref()));
        Diagnostic::new(Code::UnknownSetting, message)
            .at(at, "has no effect")
            .help(format!("declare it in `{entity}`, such as `param {name} = 0`, or take it out of the level"))
    }
}

/// A name of an editor's level that nothing asks, and that is almost one that the program knows.
pub struct UnknownLevelName {
    /// The map.
    pub at: Span,
    /// The name in the level.
    pub name: String,
    /// The nearest name of the program.
    pub near: String,
    /// What it stands for, as the map's block says it.
    pub meaning: String,
}

/// A tag as it is written: in quotes if it is not a name.
pub(crate) fn as_tag(tag: &str) -> String {
    if tag.chars().all(|c| c.is_alphanumeric() || c == '_') { tag.to_string() } else { format!("\"{tag}\"") }
}

impl Fact for UnknownLevelName {
    fn into_diagnostic(self) -> Diagnostic {
        let UnknownLevelName { at, name, near, meaning } = self;
        let message = format!("nothing asks for `{name}` of the level; did you mean `{near}`?");
        let line = format!("{}: {meaning}", as_tag(&name));
        Diagnostic::new(Code::UnknownLevelName, message)
            .at(at, "in this map")
            .help(format!("rename it in the level, or add `{line}` to the map's block; `empty` leaves it out"))
            .or_add(BlockKind::Map, at, line)
            .or_add(BlockKind::Map, at, format!("{}: empty", as_tag(&name)))
    }
}

/// A character in the block of a map whose tiles have names.
pub struct NoCharacters {
    /// The character.
    pub at: Span,
}

impl Fact for NoCharacters {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BadMap, "the tiles of a level editor have names, not characters")
            .at(self.at, "never in the level")
            .or_remove("the line", self.at)
            .help(
                "write the class of a tile or an object, or the identifier of a value or an entity: `Coin: spawn Coin`",
            )
    }
}

/// An option for the reading of a level whose format makes it superfluous.
pub struct KnownReading {
    /// The map.
    pub at: Span,
    /// The option.
    pub option: &'static str,
    /// The level's file.
    pub path: String,
}

impl Fact for KnownReading {
    fn into_diagnostic(self) -> Diagnostic {
        let message =
            format!("`{}` is for levels of characters: `{}` says itself how it is read", self.option, self.path);
        Diagnostic::new(Code::NoQuestion, message).at(self.at, "this map").help(format!("leave out `{}`", self.option))
    }
}

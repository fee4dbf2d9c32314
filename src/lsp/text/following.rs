//! What goes on with a statement where one writes: whether a value has just ended, the words that can follow one, and what
//! is given by name already.

use super::lexer::{Kind, begins_name, tokens};
use super::place::{Block, Place};
use super::words::is_keyword;

/// Whether a value is before a place, so that an operator or a word that goes on must come.
pub(in crate::lsp) fn ends_operand(place: &Place<'_>) -> bool {
    let last = place.back(1);
    match place.statement.as_slice() {
        // A number comes after the name.
        ["limit" | "tiles", _] => false,
        _ if matches!(last, "true" | "false" | "none" | "self" | "timer") => true,
        _ if matches!(last, "left" | "right" | "above" | "below" | ")" | "'" | "''") => true,
        _ if last.starts_with(|c: char| c == '"' || c.is_ascii_digit()) => true,
        _ => last.starts_with(begins_name) && !is_keyword(last),
    }
}

/// The words that can follow a value.
pub(in crate::lsp) fn after_operand(place: &Place<'_>) -> &'static [&'static str] {
    let first = place.statement.first().copied().unwrap_or_default();
    let has = |word: &str| place.statement.contains(&word);
    // A word that comes once, if it is not there.
    let once = |word: &'static [&'static str; 1]| -> &'static [&'static str] { if has(word[0]) { &[] } else { word } };
    let joined: &[&str] = match (place.around(Block::World).is_some(), place.back(1)) {
        (true, ")") => &["and", "or"],
        (true, _) => &["and", "or", "in", "touching"],
        // `touching(body, coin) as c`
        (false, ")") => &["and", "or", "as"],
        (false, _) => &["and", "or", "in", "is"],
    };
    match (first, place.block()) {
        (_, Some(Block::Tiles | Block::Kinds)) => {
            if has("spawn") {
                &["as"]
            } else {
                &[]
            }
        }
        ("place" | "rect" | "bounds" | "collider" | "kinematic" | "link", _) if !place.calls.is_empty() => &[],
        _ if !place.calls.is_empty() => joined,
        ("goal" | "never", _) => {
            if has(":") {
                joined
            } else {
                &[]
            }
        }
        ("place", _) => {
            if has(":") && !has("at") {
                &["at"]
            } else {
                &[]
            }
        }
        ("collide", _) => once(&["with"]),
        ("tiles", _) => once(&["x"]),
        ("map", _) => match () {
            () if has("legend") => &["tile"],
            () if has("vglc") => &["legend"],
            () if has("ldtk") && !has("level") => &["level"],
            () if has("tiled") || has("ldtk") || has("from") || has("level") => &[],
            () => &["from"],
        },
        ("link", _) => match () {
            () if has("when") => joined,
            () if has("at") => &["when"],
            () if has("->") => &["at"],
            () => &[],
        },
        ("envelope", _) => match () {
            () if has("directions") || has("fixed") => &[],
            () if has("by") => &["directions"],
            () => &["by", "fixed"],
        },
        ("attack" | "release", _) => once(&["to"]),
        ("clamp", _) => once(&["in"]),
        ("collider" | "kinematic" | "follow", _) if !has("when") => {
            if has(")") {
                &["when"]
            } else {
                &[]
            }
        }
        ("when" | "and" | "or", _) if has("->") => &[],
        ("when" | "and" | "or" | "while" | "invariant" | "collider" | "kinematic" | "follow" | "initial", _) => joined,
        _ => &[],
    }
}

/// The names that are set between the brackets around a byte; where parentheses are not closed, up to the end of its line.
pub(in crate::lsp) fn given<'t>(code: &'t str, byte: usize, opens: &str) -> Vec<&'t str> {
    let all = tokens(code);
    let here = all.partition_point(|token| token.at.start < byte);
    let text = |at: usize| all.get(at).map_or("", |token| token.text(code));
    let closes = if opens == "(" { ")" } else { "}" };
    // Whether a token is the bracket that ends what is examined, those inside left out.
    let ends = |depth: &mut usize, at: usize, inner: &str, outer: &str| {
        *depth += usize::from(text(at) == inner);
        text(at) == outer && std::mem::replace(depth, depth.saturating_sub(1)) == 0
    };
    let (mut back, mut ahead) = (0, 0);
    let begin = (0..here).rev().find(|at| ends(&mut back, *at, closes, opens)).unwrap_or(here);
    let is_line_end = |at: usize| opens == "(" && all.get(at).is_some_and(|token| token.kind == Kind::Newline);
    let end =
        (here..all.len()).find(|at| ends(&mut ahead, *at, opens, closes) || is_line_end(*at)).unwrap_or(all.len());
    (begin..end).filter(|at| text(*at + 1) == "=").map(text).collect()
}

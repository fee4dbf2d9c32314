//! Completion inside a statement: whether an operand ends at the cursor, the keywords that can follow it, and the names
//! that a block or an argument list assigns.

use super::cursor::{Block, CursorContext};
use super::lexer::{Kind, Token, starts_name, tokens};
use super::words::is_keyword;

/// Whether an operand ends before the cursor, so that an operator or a keyword must follow.
pub(in crate::lsp) fn ends_operand(cursor: &CursorContext<'_>) -> bool {
    let last = cursor.previous(1);
    match cursor.statement.as_slice() {
        // A number follows the name.
        ["limit" | "tiles", _] => false,
        _ if matches!(last, "true" | "false" | "none" | "self" | "timer") => true,
        _ if matches!(last, "left" | "right" | "above" | "below" | ")" | "'" | "''") => true,
        _ if last.starts_with(|c: char| c == '"' || c.is_ascii_digit()) => true,
        _ => last.starts_with(starts_name) && !is_keyword(last),
    }
}

/// The keywords that can follow an operand.
pub(in crate::lsp) fn after_operand(cursor: &CursorContext<'_>) -> &'static [&'static str] {
    let first = cursor.statement.first().copied().unwrap_or_default();
    let has = |word: &str| cursor.statement.contains(&word);
    // A keyword that can occur once, if it is still missing.
    let once = |word: &'static [&'static str; 1]| -> &'static [&'static str] { if has(word[0]) { &[] } else { word } };
    let joined: &[&str] = match (cursor.enclosing(Block::World).is_some(), cursor.previous(1)) {
        (true, ")") => &["and", "or"],
        (true, _) => &["and", "or", "in", "touching"],
        // `touching(body, coin) as c`
        (false, ")") => &["and", "or", "as"],
        // `nearest Slime in awake within 80 as s`
        (false, _) if has("nearest") && !has("as") => &["and", "or", "in", "within", "as"],
        (false, _) => &["and", "or", "in", "is"],
    };
    match (first, cursor.block()) {
        (_, Some(Block::Tiles | Block::Kinds)) => match () {
            () if has("spawn") => &["as"],
            () if has("breakable") || !has(":") => &[],
            () if has("slope") => &["breakable"],
            () => &["slope", "breakable"],
        },
        (_, Some(Block::Test)) => after_claim(cursor, joined),
        ("place" | "rect" | "bounds" | "collider" | "kinematic" | "link", _) if !cursor.calls.is_empty() => &[],
        _ if !cursor.calls.is_empty() => joined,
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
        ("else", _) => &[],
        ("when" | "and" | "or", _) if has("->") => &[],
        ("when" | "and" | "or" | "while" | "invariant" | "condition", _) => joined,
        ("collider" | "kinematic" | "follow" | "initial", _) => joined,
        _ => &[],
    }
}

/// The keywords that can follow an operand in a claim of a test.
fn after_claim(cursor: &CursorContext<'_>, joined: &'static [&'static str]) -> &'static [&'static str] {
    let has = |word: &str| cursor.statement.contains(&word);
    match cursor.statement.first().copied().unwrap_or_default() {
        _ if !cursor.calls.is_empty() => joined,
        "expect" if has("at") || has("by") => &[],
        "expect" => &["and", "or", "in", "touching", "at", "by", "always", "never"],
        _ if has("within") => &[],
        "reachable" if !has("without") => &["and", "or", "in", "touching", "within", "without", "not without"],
        "unreachable" | "unfound" | "never" if !has("without") => &["and", "or", "in", "touching", "within", "without"],
        "reachable" | "unreachable" | "unfound" | "never" => &["and", "or", "in", "touching", "within"],
        _ => &[],
    }
}

/// The names that are assigned between the brackets around an offset. Unclosed parentheses end with the line.
pub(in crate::lsp) fn assigned_names<'t>(code: &'t str, byte: usize, opening: &str) -> Vec<&'t str> {
    let all: Vec<Token> = tokens(code).collect();
    let here = all.partition_point(|token| token.at.start < byte);
    let text = |at: usize| all.get(at).map_or("", |token| token.text(code));
    let closing = if opening == "(" { ")" } else { "}" };
    // Whether a token is the matching bracket, at nesting depth 0.
    let closes_at = |depth: &mut usize, at: usize, inner: &str, outer: &str| {
        *depth += usize::from(text(at) == inner);
        text(at) == outer && std::mem::replace(depth, depth.saturating_sub(1)) == 0
    };
    let (mut back, mut ahead) = (0, 0);
    let begin = (0..here).rev().find(|at| closes_at(&mut back, *at, closing, opening)).unwrap_or(here);
    let is_line_end = |at: usize| opening == "(" && all.get(at).is_some_and(|token| token.kind == Kind::Newline);
    let end = (here..all.len())
        .find(|at| closes_at(&mut ahead, *at, opening, closing) || is_line_end(*at))
        .unwrap_or(all.len());
    (begin..end).filter(|at| text(*at + 1) == "=").map(text).collect()
}

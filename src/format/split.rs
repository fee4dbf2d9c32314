//! Line breaks in a statement that is on one line in the source and too long.

use crate::syntax::Rule;

use super::layout::Place;
use super::tokens::{Kind, Token};
use super::{INDENT, WIDTH};

/// Where a statement is broken.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Split {
    /// Where the author broke it.
    Nowhere,
    /// Before `or` and `->`.
    Or,
    /// Before `and`, `or` and `->`.
    AndOr,
}

impl Split {
    /// Whether a break is before a token that is in no list.
    pub fn is_before(self, rule: Rule) -> bool {
        match self {
            Split::Nowhere => false,
            Split::Or => matches!(rule, Rule::kw_or | Rule::arrow),
            Split::AndOr => matches!(rule, Rule::kw_or | Rule::kw_and | Rule::arrow),
        }
    }
}

/// How to break the statement that the first token begins. `stays` is whether a line break before a token is kept in
/// the layout.
pub(super) fn split(
    tokens: &[Token<'_>],
    places: &[(Place, Place)],
    indent: usize,
    stays: impl Fn(usize) -> bool,
) -> Split {
    let mut width = indent;
    // The longest line, and the current line, if it is broken before `or`.
    let (mut longest, mut filled, mut ors) = (0, indent, false);
    let mut depth = 0usize;
    for (index, (token, (place, _))) in tokens.iter().zip(places).enumerate() {
        if (token.starts && index > 0) || matches!(token.kind, Kind::BlockClose | Kind::Map) {
            break;
        }
        if token.kind == Kind::BlockOpen {
            width += 2;
            break;
        }
        let before = index.checked_sub(1).map_or(place.line, |before| places[before].1.line);
        if place.line != before && stays(index) {
            return Split::Nowhere;
        }
        let own = token.text.chars().count() + usize::from(token.space && index > 0);
        match token.kind {
            Kind::Open => depth += 1,
            Kind::Close => depth = depth.saturating_sub(1),
            _ if depth == 0 && Split::Or.is_before(token.rule) => {
                ors |= token.rule == Rule::kw_or;
                longest = longest.max(filled);
                filled = indent + INDENT - 1;
            }
            _ => {}
        }
        width += own;
        filled += own;
    }
    if width <= WIDTH {
        Split::Nowhere
    } else if ors && longest.max(filled) <= WIDTH {
        Split::Or
    } else {
        Split::AndOr
    }
}

//! Suggestions: ways to mend a finding among which the author chooses. A check says what changes, by spans; an editor
//! turns that into edits of a text. Unlike a [`Fix`](super::Fix), a suggestion may guess what is meant.

use super::Diagnostic;
use crate::source::{FileId, Span};

/// One way to mend a finding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suggestion {
    /// A short description: `remove the edge`.
    pub title: String,
    /// What changes, all of it together.
    pub changes: Vec<Change>,
}

/// The kind of a block that gets a new statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// `entity … { }` or `behavior … { }`
    Entity,
    /// The mode around.
    Mode,
    /// `world … { }`
    World,
    /// `space … { }`
    Space,
    /// `tiles … { }`
    Tiles,
    /// The block of a map, which may be missing.
    Map,
    /// `test … { }`
    Test,
}

/// A piece of a new text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// A text.
    Text(String),
    /// A copy of what is at a span.
    Of(Span),
}

/// A change of the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Change {
    /// Replaces a span.
    Write(Span, Vec<Piece>),
    /// Removes the statement that a span belongs to, or the element of a list.
    Remove(Span),
    /// Adds a statement to the block of a kind around a span.
    Add(BlockKind, Span, String),
    /// Moves the statement of the first span before that of the second.
    MoveBefore(Span, Span),
    /// Moves the statement of a span out of its mode, into the entity; with the mode as a condition if that is asked.
    MoveToEntity(Span, bool),
    /// Renames what is declared at a span, wherever it is used.
    Rename(Span, String),
    /// Adds arguments at the end of the parentheses after a span, which may be missing.
    AddArguments(Span, String),
    /// Adds a line after the line in which the second span ends, as far indented as the line of the first.
    AddLine(Span, Span, String),
}

impl Change {
    /// The spans that it refers to.
    pub fn spans(&self) -> impl Iterator<Item = Span> {
        let (first, second) = match self {
            Change::Write(at, _)
            | Change::Remove(at)
            | Change::Add(_, at, _)
            | Change::MoveToEntity(at, _)
            | Change::Rename(at, _)
            | Change::AddArguments(at, _) => (*at, None),
            Change::MoveBefore(a, b) | Change::AddLine(a, b, _) => (*a, Some(*b)),
        };
        let pieces: &[Piece] = if let Change::Write(_, pieces) = self { pieces } else { &[] };
        let copied = pieces.iter().filter_map(|piece| if let Piece::Of(span) = piece { Some(*span) } else { None });
        [Some(first), second].into_iter().flatten().chain(copied)
    }
}

impl Suggestion {
    /// Whether it refers to the text of a file of some kind.
    pub(super) fn touches(&self, is: impl Fn(FileId) -> bool) -> bool {
        self.changes.iter().flat_map(Change::spans).any(|span| is(span.file()))
    }

    /// Whether it refers to a copy of text that has a different meaning elsewhere.
    pub(super) fn is_of_copies(&self) -> bool {
        self.changes.iter().flat_map(Change::spans).any(Span::is_copy)
    }
}

impl Diagnostic {
    /// Adds a suggestion.
    #[must_use]
    pub fn suggest(mut self, title: impl Into<String>, changes: Vec<Change>) -> Self {
        self.suggestions.push(Suggestion { title: title.into(), changes });
        self
    }

    /// Suggests another text for a span.
    #[must_use]
    pub fn or_write(self, at: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        self.suggest(format!("write `{text}`"), vec![Change::Write(at, vec![Piece::Text(text)])])
    }

    /// Suggests a text around what is at a span.
    #[must_use]
    pub fn or_wrap(self, title: impl Into<String>, at: Span, before: &str, after: &str) -> Self {
        let pieces = vec![Piece::Text(before.into()), Piece::Of(at), Piece::Text(after.into())];
        self.suggest(title, vec![Change::Write(at, pieces)])
    }

    /// Suggests to remove the statement of a span: `remove the edge`.
    #[must_use]
    pub fn or_remove(self, what: &str, at: Span) -> Self {
        self.suggest(format!("remove {what}"), vec![Change::Remove(at)])
    }

    /// Suggests a new statement.
    #[must_use]
    pub fn or_add(self, to: BlockKind, near: Span, statement: impl Into<String>) -> Self {
        let statement = statement.into();
        self.suggest(format!("add `{statement}`"), vec![Change::Add(to, near, statement)])
    }
}

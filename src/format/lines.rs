//! The lines of the canonical layout, before and after things are aligned.

use std::ops::Range;

use crate::syntax::Rule;

/// What can be aligned: only things of one kind are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    /// A comment at the end of its line.
    Comment,
    /// A name, a number or whatever else begins a value.
    Value,
    /// The sign before a value.
    Sign,
    /// A mark or a word of the grammar.
    Mark(Rule),
}

/// A token or a comment in a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece<'t> {
    /// As written.
    pub text: &'t str,
    /// How many columns it takes.
    pub width: usize,
    /// Whether a blank is before it at least.
    pub space: bool,
    /// What can be aligned with it.
    pub slot: Slot,
    /// The column where the author put it.
    pub column: usize,
    /// How many blanks the author put before it; none if it began a line.
    pub blanks: Option<usize>,
    /// How many blanks more it gets so that it is aligned.
    pub pad: usize,
}

/// A line.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// How far it is indented.
    pub indent: usize,
    /// Its pieces.
    pub pieces: Range<usize>,
    /// Whether a blank line is before it.
    pub blank: bool,
    /// Whether it is a comment and nothing else.
    pub comment: bool,
    /// The block whose statement begins here; none for other lines.
    pub block: Option<usize>,
    /// The lines, as the author counts, of its first and its last piece.
    pub source: (usize, usize),
}

/// The lines of a text.
#[derive(Debug, Default)]
pub(super) struct Lines<'t> {
    pub lines: Vec<Line>,
    pub pieces: Vec<Piece<'t>>,
}

impl Lines<'_> {
    /// The lines as text.
    pub fn print(&self, line_end: &str) -> String {
        let mut out = String::new();
        let blanks = |out: &mut String, count: usize| out.extend(std::iter::repeat_n(' ', count));
        for line in &self.lines {
            if line.blank {
                out.push_str(line_end);
            }
            for (index, piece) in self.pieces[line.pieces.clone()].iter().enumerate() {
                let before = if index == 0 { line.indent } else { usize::from(piece.space) + piece.pad };
                blanks(&mut out, before);
                out.push_str(piece.text);
            }
            out.push_str(line_end);
        }
        out
    }
}

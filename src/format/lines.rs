//! The lines of the canonical layout, before and after alignment.

use std::ops::Range;

use crate::syntax::Rule;

/// The kinds of pieces for alignment: only pieces of the same kind are aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    /// A comment at the end of its line.
    Comment,
    /// A name, a number or another beginning of a value.
    Value,
    /// The sign before a value.
    Sign,
    /// A symbol or a keyword.
    Mark(Rule),
}

/// A token or a comment in a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece<'t> {
    /// As written.
    pub text: &'t str,
    /// Its number of columns.
    pub width: usize,
    /// Whether there is at least one blank before it.
    pub space: bool,
    /// Its kind for alignment.
    pub slot: Slot,
    /// The column where the author put it.
    pub column: usize,
    /// Number of blanks before it in the source; none if it began a line.
    pub blanks: Option<usize>,
    /// Number of additional blanks for alignment.
    pub pad: usize,
}

/// A line.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// Its indentation.
    pub indent: usize,
    /// Its pieces.
    pub pieces: Range<usize>,
    /// Whether a blank line is before it.
    pub blank: bool,
    /// Whether it contains only a comment.
    pub comment: bool,
    /// The block whose statement begins here; none for other lines.
    pub block: Option<usize>,
    /// The source lines of its first and its last piece.
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

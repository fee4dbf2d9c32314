//! The canonical layout of a program's text. The grammar's pairs say what is there; the text between them says
//! where the author put comments, blank lines and line breaks.
//!
//! ```text
//!  text ──syntax──▶ pairs ──tokens──▶ tokens ──layout──▶ lines ──align──▶ columns ──▶ text
//!                               └──gap──▶ comments, line breaks ──┘
//! ```
//!
//! The rules:
//!
//! - Four blanks for each open block; one statement a line.
//! - A block that is written on one line stays there if the line fits in [`WIDTH`] columns, one that is written over
//!   several lines stays so. An empty block is `{ }`.
//! - Inside a statement line breaks stay where the author put them, moved to before `and`, `or` and `->`, and to after
//!   a comma. A line of a statement that goes on is indented once more, `{` then is on a line of its own. A
//!   statement that is too long for a line and has no break yet is broken before its `or`, `and` and `->`.
//! - Comments stay in their gap between two tokens, those at a line's end at the end of that line. Blank lines between
//!   statements stay, several become one; none are at the beginning or the end of a block.
//! - More than one blank inside a line stays where it aligns something with the line above or below.
//! - The rows of a map are indented with their `map` and otherwise left alone: a map's rows are read without the blanks
//!   around them.
//! - Line ends are those of the text's first line; the text ends with one.

mod align;
mod gap;
mod layout;
mod lines;
mod split;
mod tokens;

use crate::diagnostic::Diagnostics;
use crate::source::FileId;
use crate::syntax;

/// Maximum number of columns of a line before it is broken.
pub const WIDTH: usize = 120;

/// Indentation of a block, in columns.
const INDENT: usize = 4;

/// Formats a text. The result has the same meaning and the same comments, and is a fixed point of `format`.
///
/// The syntax errors of a text that does not fit the grammar; places are in `file`.
pub fn format(file: FileId, text: &str) -> Result<String, Diagnostics> {
    let Some(tokens) = syntax::pairs(file, text).and_then(|pairs| tokens::tokens(text, pairs)) else {
        return Err(syntax::parse(file, text).1);
    };
    let mut lines = layout::lines(text, &tokens);
    align::align(&mut lines);
    Ok(lines.print(line_end(text)))
}

/// The line end of the text's first line.
fn line_end(text: &str) -> &'static str {
    match text.find('\n') {
        Some(at) if text[..at].ends_with('\r') => "\r\n",
        _ => "\n",
    }
}

//! Positions and ranges of the protocol, from byte offsets of a text. All other conversions build on them.

use std::ops::Range;

use gen_lsp_types as types;

use crate::lsp::text::document_text::{Encoding, Text};

/// The start of a document.
pub(super) const START: types::Position = types::Position { line: 0, character: 0 };

/// Converts a byte offset of a text.
pub(super) fn position(text: &Text, byte: usize, encoding: Encoding) -> types::Position {
    let at = text.position(byte, encoding);
    types::Position { line: at.line, character: at.column }
}

/// Converts a byte range of a text.
pub(super) fn range(text: &Text, bytes: &Range<usize>, encoding: Encoding) -> types::Range {
    types::Range { start: position(text, bytes.start, encoding), end: position(text, bytes.end, encoding) }
}

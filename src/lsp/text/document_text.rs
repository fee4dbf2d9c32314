//! Texts of documents: conversion between byte offsets and positions, and changes. Lines end with LF, CRLF or CR;
//! columns use the negotiated encoding. Positions outside of the text are clamped to the nearest one inside. Crates
//! such as `line-index` do not support a lone CR, which the protocol allows.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::source::FileId;
use crate::syntax::ast::File;
use crate::syntax::{Parsed, reparse};

/// A position in a text: line and column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) struct Position {
    /// From 0.
    pub line: u32,
    /// From 0, in units of an [`Encoding`].
    pub column: u32,
}

/// The unit of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::lsp) enum Encoding {
    /// Bytes.
    Utf8,
    /// UTF-16 code units: the default of the protocol.
    #[default]
    Utf16,
    /// Unicode code points.
    Utf32,
}

impl Encoding {
    fn width(self, c: char) -> u32 {
        match self {
            Encoding::Utf8 => c.len_utf8() as u32,
            Encoding::Utf16 => c.len_utf16() as u32,
            Encoding::Utf32 => 1,
        }
    }
}

/// A text with an index of its lines, and its syntax tree: it is parsed once, whoever asks first.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Text {
    whole: String,
    /// The offset of each line.
    starts: Vec<u32>,
    /// Whether a column is a number of bytes in any encoding: a long line need not be read for it.
    is_ascii: bool,
    parsed: OnceLock<Arc<Parsed>>,
    /// The text before the last changes.
    before: Option<Arc<Parsed>>,
}

impl PartialEq for Text {
    fn eq(&self, other: &Self) -> bool {
        self.whole == other.whole
    }
}

impl Eq for Text {}

/// A file may begin with it; the compiler skips it.
const BYTE_ORDER_MARK: char = '\u{feff}';

impl Text {
    pub fn new(whole: impl Into<String>) -> Self {
        let whole = whole.into();
        let (starts, is_ascii) = (line_starts(&whole), whole.is_ascii());
        Text { whole, starts, is_ascii, parsed: OnceLock::new(), before: None }
    }

    /// Another text, most of which is probably the same.
    pub fn replaced(&self, whole: impl Into<String>) -> Self {
        Text { before: self.parsed.get().or(self.before.as_ref()).cloned(), ..Text::new(whole) }
    }

    /// The code as it was parsed, as the file 0.
    pub fn parsed(&self) -> &Arc<Parsed> {
        self.parsed.get_or_init(|| Arc::new(reparse(FileId(0), self.code(), self.before.as_deref())))
    }

    /// The syntax tree of the code, as the file 0.
    pub fn tree(&self) -> &File {
        &self.parsed().file
    }

    /// The text as the editor has it.
    pub fn whole(&self) -> &str {
        &self.whole
    }

    /// The text as the compiler sees it, without a byte order mark. Byte offsets refer to it.
    pub fn code(&self) -> &str {
        self.whole.get(self.mark_len()..).unwrap_or_default()
    }

    /// The length of the byte order mark, if there is one.
    fn mark_len(&self) -> usize {
        if self.whole.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len_utf8() } else { 0 }
    }

    /// The position of an offset in the code.
    pub fn position(&self, byte: usize, encoding: Encoding) -> Position {
        let mut byte = (byte + self.mark_len()).min(self.whole.len());
        while !self.whole.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self.starts.partition_point(|&start| start as usize <= byte).saturating_sub(1);
        let start = self.starts.get(line).map_or(0, |&s| s as usize);
        let before = self.whole.get(start..byte).unwrap_or_default();
        let column = if encoding == Encoding::Utf8 || self.is_ascii || before.is_ascii() {
            before.len() as u32
        } else {
            before.chars().map(|c| encoding.width(c)).sum()
        };
        Position { line: line as u32, column }
    }

    /// The offset in the code of a position, clamped to the text.
    pub fn byte(&self, position: Position, encoding: Encoding) -> usize {
        self.whole_byte(position, encoding).saturating_sub(self.mark_len())
    }

    /// The range of the code between two positions, in either order.
    pub fn bytes(&self, range: Range<Position>, encoding: Encoding) -> Range<usize> {
        let (a, b) = (self.byte(range.start, encoding), self.byte(range.end, encoding));
        a.min(b)..a.max(b)
    }

    fn whole_byte(&self, position: Position, encoding: Encoding) -> usize {
        let Some(&start) = self.starts.get(position.line as usize) else { return self.whole.len() };
        let end = self.starts.get(position.line as usize + 1).map_or(self.whole.len(), |&e| e as usize);
        let line = self.whole.get(start as usize..end).unwrap_or_default().trim_end_matches(['\n', '\r']);
        if self.is_ascii {
            return start as usize + line.len().min(position.column as usize);
        }
        let mut left = position.column;
        for (at, c) in line.char_indices() {
            let width = encoding.width(c);
            // A position inside a character maps to its start.
            if left < width {
                return start as usize + at;
            }
            left -= width;
        }
        start as usize + line.len()
    }

    /// Replaces a range, or the whole text.
    pub fn change(&mut self, range: Option<Range<Position>>, text: &str, encoding: Encoding) {
        match range {
            Some(range) => {
                let (a, b) = (self.whole_byte(range.start, encoding), self.whole_byte(range.end, encoding));
                self.replace(a.min(b)..a.max(b), text);
            }
            None => {
                text.clone_into(&mut self.whole);
                self.starts = line_starts(&self.whole);
            }
        }
        self.is_ascii = self.whole.is_ascii();
        // An edit within a statement leaves most of the tree as it is.
        self.before = self.parsed.take().or(self.before.take());
    }

    /// Replaces a range of the whole text. Only the lines that it touches are looked at again.
    fn replace(&mut self, bytes: Range<usize>, text: &str) {
        let by = text.len() as isize - bytes.len() as isize;
        self.whole.replace_range(bytes.clone(), text);
        // The first line whose start, or the line feed after its carriage return, may be another.
        let first = self.starts.partition_point(|start| (*start as usize) < bytes.start).saturating_sub(1);
        // The first start whose line end before it is not replaced.
        let last = self.starts.partition_point(|start| *start as usize <= bytes.end);
        let from = self.starts.get(first).map_or(0, |start| *start as usize);
        let moved = |start: &u32| (*start as usize).saturating_add_signed(by);
        let to = self.starts.get(last).map_or(self.whole.len(), moved);
        let tail = self.starts.split_off(last).iter().map(|start| moved(start) as u32).collect::<Vec<u32>>();
        self.starts.truncate(first);
        let inside = line_starts(self.whole.get(from..to).unwrap_or_default());
        self.starts.extend(inside.iter().map(|start| from as u32 + start).filter(|start| tail.first() != Some(start)));
        self.starts.extend(tail);
    }
}

fn line_starts(text: &str) -> Vec<u32> {
    let bytes = text.as_bytes();
    let ends = |(at, byte): (usize, &u8)| match byte {
        b'\n' => Some(at as u32 + 1),
        b'\r' if bytes.get(at + 1) != Some(&b'\n') => Some(at as u32 + 1),
        _ => None,
    };
    std::iter::once(0).chain(bytes.iter().enumerate().filter_map(ends)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, column: u32) -> Position {
        Position { line, column }
    }

    #[test]
    fn columns_count_what_was_agreed_on() {
        let text = Text::new("é\u{1f40a}x\r\nab\rc");
        assert_eq!(text.byte(at(0, 3), Encoding::Utf16), 6);
        assert_eq!(text.byte(at(0, 2), Encoding::Utf32), 6);
        assert_eq!(text.byte(at(0, 6), Encoding::Utf8), 6);
        assert_eq!(text.position(6, Encoding::Utf16), at(0, 3));
        assert_eq!(text.position(9, Encoding::Utf16), at(1, 0));
        assert_eq!(text.position(12, Encoding::Utf16), at(2, 0), "a carriage return alone ends a line");
    }

    #[test]
    fn what_lies_beyond_is_moved_inside() {
        let text = Text::new("é\u{1f40a}x\r\nab");
        assert_eq!(text.byte(at(0, 2), Encoding::Utf16), 2, "inside of a surrogate pair");
        assert_eq!(text.byte(at(0, 99), Encoding::Utf16), 7, "beyond the end of a line");
        assert_eq!(text.byte(at(99, 0), Encoding::Utf16), 11, "beyond the last line");
        assert_eq!(text.position(1, Encoding::Utf16), at(0, 0), "inside of a character");
        assert_eq!(text.position(999, Encoding::Utf16), at(1, 2));
    }

    #[test]
    fn a_byte_order_mark_is_a_column_and_no_code() {
        let text = Text::new("\u{feff}ab\n");
        assert_eq!(text.code(), "ab\n");
        assert_eq!(text.position(0, Encoding::Utf16), at(0, 1));
        assert_eq!(text.byte(at(0, 2), Encoding::Utf16), 1);
    }

    proptest::proptest! {
        #[test]
        fn lines_after_a_change_are_those_of_the_whole_text(
            text in "[a\r\n]{0,12}", new in "[b\r\n]{0,4}", from in 0..13usize, length in 0..13usize,
        ) {
            let mut changed = Text::new(text.as_str());
            let from = from.min(text.len());
            changed.replace(from..(from + length).min(text.len()), &new);
            let again = Text::new(changed.whole());
            proptest::prop_assert_eq!(changed.starts, again.starts, "{:?}", again.whole);
        }
    }

    #[test]
    fn changes_are_put_in_place() {
        let mut text = Text::new("ab\r\ncd");
        text.change(Some(at(0, 2)..at(1, 0)), "\u{1f40a}\n", Encoding::Utf16);
        assert_eq!(text.whole(), "ab\u{1f40a}\ncd");
        assert_eq!(text.position(7, Encoding::Utf16), at(1, 0));
        text.change(None, "x", Encoding::Utf16);
        assert_eq!(text, Text::new("x"));
    }
}

//! Spans: ranges of bytes of a file. A program has as many spans as expressions, so each is packed into eight bytes; as
//! JSON it has a field for each of its numbers.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{FileId, MAX_COPIES, MAX_FILE_BYTES, MAX_SOURCES, OTHER_SOURCES};

/// The ids from here on are those of copies.
pub(super) const FIRST_COPY: u32 = 1 << 31;

/// In sixteen bits the ids of copies follow those of files.
const COPIES_FROM: usize = MAX_SOURCES + OTHER_SOURCES;
/// The id of files and copies beyond the limits; no file and no copy has it.
const NO_FILE: u32 = u16::MAX as u32;
const _: () = assert!(COPIES_FROM + MAX_COPIES <= NO_FILE as usize);

impl FileId {
    /// The index of the copy, if it is one.
    pub(super) fn copy(self) -> Option<usize> {
        self.0.checked_sub(FIRST_COPY).map(|copy| copy as usize)
    }

    /// The id in sixteen bits.
    fn packed(self) -> u32 {
        match self.copy() {
            None if (self.0 as usize) < COPIES_FROM => self.0,
            Some(copy) if copy < MAX_COPIES => (COPIES_FROM + copy) as u32,
            _ => NO_FILE,
        }
    }

    fn unpacked(packed: u32) -> FileId {
        match packed.checked_sub(COPIES_FROM as u32) {
            None => FileId(packed),
            Some(copy) => FileId(FIRST_COPY + copy),
        }
    }
}

/// Maximum start and maximum length.
const MAX_PACKED: usize = (1 << 24) - 1;
const _: () = assert!(MAX_FILE_BYTES <= MAX_PACKED);

/// A range of bytes in one file, end exclusive.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(from = "SpanFields", into = "SpanFields")]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Span {
    /// The file in the upper half, then the upper 16 bits of the start.
    upper: u32,
    /// The lower 8 bits of the start, then the length. In this order spans are ordered as their numbers are.
    lower: u32,
}

const _: () = assert!(size_of::<Span>() == 8);

/// A range of bytes in one file, end exclusive.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Span")]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct SpanFields {
    /// The file it lies in.
    file: FileId,
    /// The first byte.
    start: u32,
    /// One past the last byte.
    end: u32,
}

impl From<Span> for SpanFields {
    fn from(span: Span) -> Self {
        SpanFields { file: span.file(), start: span.start(), end: span.end() }
    }
}

impl From<SpanFields> for Span {
    /// An invalid range is mapped to no file, and rejected with all spans outside of files.
    fn from(SpanFields { file, start, end }: SpanFields) -> Self {
        let fits = start <= end && end as usize <= MAX_PACKED;
        Span::new(if fits { file } else { FileId::unpacked(NO_FILE) }, start as usize, end as usize)
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}[{}..{}]", self.file(), self.start(), self.end())
    }
}

impl Span {
    /// The bytes `start..end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        // Files are limited to `MAX_FILE_BYTES`, so nothing is cut.
        let (start, length) = (start.min(MAX_PACKED) as u32, end.saturating_sub(start).min(MAX_PACKED) as u32);
        Span { upper: file.packed() << 16 | start >> 8, lower: start << 24 | length }
    }

    /// The file it lies in.
    pub fn file(self) -> FileId {
        FileId::unpacked(self.upper >> 16)
    }

    /// The first byte.
    pub fn start(self) -> u32 {
        (self.upper & 0xffff) << 8 | self.lower >> 24
    }

    /// One past the last byte.
    pub fn end(self) -> u32 {
        self.start() + (self.lower & MAX_PACKED as u32)
    }

    /// The same bytes of another file.
    #[must_use]
    pub fn in_file(self, file: FileId) -> Span {
        Span { upper: file.packed() << 16 | self.upper & 0xffff, ..self }
    }

    /// The span from where it starts to another end.
    #[must_use]
    pub fn ending(self, end: u32) -> Span {
        Span::new(self.file(), self.start() as usize, end as usize)
    }

    /// The smallest span around both; this one if they are not of the same file.
    pub fn to(self, other: Span) -> Span {
        if self.upper >> 16 != other.upper >> 16 {
            return self;
        }
        let (start, end) = (self.start().min(other.start()), self.end().max(other.end()));
        Span::new(self.file(), start as usize, end as usize)
    }

    /// Whether it is in a copy of a file's text, see [`SourceMap::copy`](super::SourceMap::copy).
    pub fn is_copy(self) -> bool {
        self.file().copy().is_some()
    }

    /// The span as a range of byte indices.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start() as usize..self.end() as usize
    }

    /// Whether `other` lies inside this span.
    pub fn contains(self, other: Span) -> bool {
        self.upper >> 16 == other.upper >> 16 && self.start() <= other.start() && other.end() <= self.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILES: [FileId; 4] =
        [FileId(0), FileId(COPIES_FROM as u32 - 1), FileId(FIRST_COPY), FileId(FIRST_COPY + MAX_COPIES as u32 - 1)];

    #[test]
    fn all_numbers_are_kept() {
        let ends = [0, 1, 255, 256, 65_535, 1 << 20, MAX_FILE_BYTES];
        let mut before = None;
        for file in FILES {
            for start in ends {
                for end in ends.into_iter().filter(|end| start <= *end) {
                    let span = Span::new(file, start, end);
                    assert_eq!((span.file(), span.range()), (file, start..end));
                    assert_eq!(span.in_file(FILES[1]).range(), start..end);
                    assert!(before < Some(span), "{before:?} {span:?}");
                    before = Some(span);
                    let json = serde_json::to_string(&span).unwrap_or_default();
                    assert_eq!(json, format!(r#"{{"file":{},"start":{start},"end":{end}}}"#, file.0));
                    assert_eq!(serde_json::from_str::<Span>(&json).ok(), Some(span));
                }
            }
        }
    }

    #[test]
    fn what_no_span_can_be_lies_in_no_file() {
        let past = u32::MAX;
        for (file, start, end) in [
            (COPIES_FROM as u32, 0, 0),
            (FIRST_COPY + MAX_COPIES as u32, 0, 0),
            (past, past, past),
            (0, 2, 1),
            (0, 0, 1 << 24),
        ] {
            let span = Span::from(SpanFields { file: FileId(file), start, end });
            assert!(!FILES.contains(&span.file()) && span.upper >> 16 == NO_FILE, "{span:?}");
        }
    }
}

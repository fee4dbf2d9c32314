//! Source files, byte spans, and the line index from bytes to lines and columns. First in the pipeline: every later
//! stage refers to it. Files are read through [`Files`].

mod span;

use std::fmt;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use span::FIRST_COPY;
pub use span::Span;

/// Maximum size of a file, in bytes: several hundred thousand lines. Each is checked within seconds.
pub const MAX_FILE_BYTES: usize = (16 << 20) - 1;
/// Maximum number of files of a program, levels and legends included.
pub const MAX_SOURCES: usize = 15_000;
/// Maximum number of additional files: those of the command line.
const OTHER_SOURCES: usize = 500;
/// Maximum number of copies of text, see [`SourceMap::copy`].
pub const MAX_COPIES: usize = 50_000;

/// A file of a [`SourceMap`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct FileId(pub u32);

impl fmt::Debug for FileId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "file{}", self.0)
    }
}

/// One file's text and where its lines begin.
#[derive(Debug, Clone)]
pub struct SourceFile {
    /// The path as given by the user or an `import`; diagnostics show it.
    pub path: PathBuf,
    text: String,
    line_starts: Vec<u32>,
    /// Number of characters and of UTF-16 code units before each multiple of `MARK` bytes: a line may be as long as a
    /// file.
    marks: Vec<(u32, u32)>,
}

/// Distance of two marks: the maximum number of bytes that are counted one by one.
const MARK: usize = 1 << 10;

impl SourceFile {
    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of a byte, both from 1; the column counts characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let byte = byte.min(self.text.len());
        let line = self.line_starts.partition_point(|&start| start as usize <= byte).saturating_sub(1);
        let start = self.line_starts.get(line).map_or(0, |&s| s as usize);
        let column = if self.text.is_char_boundary(byte) { self.before(byte).0 - self.before(start).0 } else { 0 };
        (line + 1, column + 1)
    }

    /// Line and column of a byte, both from 1; the column counts UTF-16 code units.
    pub fn line_column_utf16(&self, byte: usize) -> (usize, usize) {
        let (line, _) = self.line_column(byte);
        let start = self.line_range(line - 1).map_or(0, |range| range.start);
        // A byte inside a character counts as its first byte.
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        (line, self.before(byte).1 - self.before(start).1 + 1)
    }

    /// Number of characters and of UTF-16 code units that begin before a byte.
    fn before(&self, byte: usize) -> (usize, usize) {
        let (characters, units) = self.marks.get(byte / MARK).copied().unwrap_or_default();
        let (more, twice) = counted(&self.text.as_bytes()[byte / MARK * MARK..byte]);
        (characters as usize + more, units as usize + more + twice)
    }
}

impl SourceFile {
    /// The bytes of a line (from 0), its line break included; none past the last line.
    pub fn line_range(&self, line: usize) -> Option<std::ops::Range<usize>> {
        let start = *self.line_starts.get(line)? as usize;
        let end = self.line_starts.get(line + 1).map_or(self.text.len(), |&e| e as usize);
        Some(start..end)
    }
}

/// Number of characters that begin in a range of bytes, and the number of them with two UTF-16 code units.
fn counted(bytes: &[u8]) -> (usize, usize) {
    let characters = bytes.iter().filter(|b| **b & 0xc0 != 0x80).count();
    (characters, bytes.iter().filter(|b| **b >= 0xf0).count())
}

/// The serialised form of a [`SourceMap`].
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Texts {
    files: Vec<Text>,
    copies: Vec<(FileId, Span)>,
}

/// The serialised form of a file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Text {
    path: String,
    text: String,
}

/// All files of one compilation, in the order in which they were read.
#[derive(Debug, Clone, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
    /// Copies of a file's text that are expanded elsewhere: the file, and the place of the expansion.
    copies: Vec<(FileId, Span)>,
}

impl SourceMap {
    /// An empty map.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether the limit of files that a program names is reached; files of the command line still fit.
    pub fn is_full(&self) -> bool {
        self.files.len() >= MAX_SOURCES
    }

    /// Whether the limit of copies is reached.
    pub fn is_full_of_copies(&self) -> bool {
        self.copies.len() >= MAX_COPIES
    }

    /// Adds a file and returns its id.
    pub fn add(&mut self, path: impl Into<PathBuf>, text: impl Into<String>) -> FileId {
        let text: String = text.into();
        let mut line_starts = vec![0];
        line_starts.extend(text.bytes().enumerate().filter(|&(_, b)| b == b'\n').map(|(i, _)| i as u32 + 1));
        let (mut marks, mut characters, mut units) = (vec![(0, 0)], 0, 0);
        for part in text.as_bytes().chunks_exact(MARK) {
            let (more, twice) = counted(part);
            characters += more as u32;
            units += (more + twice) as u32;
            marks.push((characters, units));
        }
        let id = FileId(self.files.len() as u32);
        self.files.push(SourceFile { path: path.into(), text, line_starts, marks });
        id
    }

    /// The file of an id of this map; of a copy: the original.
    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[self.original(id).0 as usize]
    }

    /// The file of a path, if it was read.
    pub fn find(&self, path: &Path) -> Option<FileId> {
        self.files.iter().position(|file| file.path == path).map(|index| FileId(index as u32))
    }

    /// A new id for a copy of a file's text that is expanded elsewhere.
    pub fn copy(&mut self, of: FileId, put_at: Span) -> FileId {
        let of = self.original(of);
        self.copies.push((of, put_at));
        FileId(FIRST_COPY + self.copies.len() as u32 - 1)
    }

    fn original(&self, id: FileId) -> FileId {
        id.copy().and_then(|copy| self.copies.get(copy)).map_or(id, |(of, _)| *of)
    }

    /// The place of a span in the original text, and the places of the expansions around it, innermost first.
    pub fn trace(&self, span: Span) -> (Span, Vec<Span>) {
        let mut places = Vec::new();
        let mut at = span;
        while let Some((_, put_at)) = at.file().copy().and_then(|copy| self.copies.get(copy)) {
            places.push(put_at.in_file(self.original(put_at.file())));
            at = *put_at;
        }
        (span.in_file(self.original(span.file())), places)
    }

    /// The text under a span; empty if the span is not of this map.
    pub fn slice(&self, span: Span) -> &str {
        self.files.get(self.original(span.file()).0 as usize).and_then(|f| f.text.get(span.range())).unwrap_or("")
    }

    /// The serialised form.
    pub fn texts(&self) -> Texts {
        let text = |file: &SourceFile| Text { path: file.path.to_string_lossy().into_owned(), text: file.text.clone() };
        Texts { files: self.files.iter().map(text).collect(), copies: self.copies.clone() }
    }

    /// The deserialised map; none if it exceeds a limit, a copy is of no file, or a copy was not expanded into earlier
    /// text.
    pub fn of(texts: Texts) -> Option<SourceMap> {
        let mut map = SourceMap::new();
        let is_too_long = |file: &Text| file.text.len() > MAX_FILE_BYTES;
        if texts.files.len() > MAX_SOURCES + OTHER_SOURCES
            || texts.copies.len() > MAX_COPIES
            || texts.files.iter().any(is_too_long)
        {
            return None;
        }
        for Text { path, text } in texts.files {
            map.add(path, text);
        }
        for (of, put_at) in texts.copies {
            if of.0 as usize >= map.files.len() || !map.holds(put_at) {
                return None;
            }
            map.copy(of, put_at);
        }
        Some(map)
    }

    /// Whether a span lies in a file of this map, or in a copy.
    pub fn holds(&self, span: Span) -> bool {
        let file = self.files.get(self.original(span.file()).0 as usize);
        file.is_some_and(|file| file.text.get(span.range()).is_some())
    }

    /// All files with their ids.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        self.files.iter().enumerate().map(|(i, f)| (FileId(i as u32), f))
    }
}

/// The reason why a file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReadError {
    /// An error of the system; its text.
    Unreadable(String),
    /// Not UTF-8; the first invalid byte.
    NotUtf8(usize),
    /// Larger than [`MAX_FILE_BYTES`]; its size.
    TooLarge(u64),
}

/// A source of text: the disk, or the open buffers of an editor.
pub trait Files {
    /// The text of a file.
    ///
    /// # Errors
    /// [`ReadError`] if it cannot be read, is not UTF-8 or is too large.
    fn read(&self, path: &Path) -> Result<String, ReadError>;

    /// A canonical path: the same for all spellings of one file, to detect a second import of it.
    fn identity(&self, path: &Path) -> PathBuf {
        path.to_path_buf()
    }

    /// Why a file is no picture that can be shown, in a few words; nothing if it is one, or if these files cannot tell.
    fn bad_picture(&self, _path: &Path) -> Option<String> {
        None
    }
}

/// Checks size and encoding of a file's bytes and drops a byte order mark.
///
/// # Errors
/// [`ReadError::TooLarge`] and [`ReadError::NotUtf8`].
pub fn decode(bytes: Vec<u8>) -> Result<String, ReadError> {
    if bytes.len() > MAX_FILE_BYTES {
        return Err(ReadError::TooLarge(bytes.len() as u64));
    }
    let text = String::from_utf8(bytes).map_err(|e| ReadError::NotUtf8(e.utf8_error().valid_up_to()))?;
    let text = match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_string(),
        None => text,
    };
    if !text.contains('\r') {
        return Ok(text);
    }
    // A carriage return alone is an old line end; a line feed has the same length.
    Ok(text.replace("\r\n", "\u{0}\n").replace('\r', "\n").replace("\u{0}\n", "\r\n"))
}

/// A path without `.` and `..`, resolved lexically: symbolic links are not followed.
pub fn normalize(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

/// A text on one line, with one space between its words.
pub fn on_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A piece of a program on one line, without comments.
pub fn code_on_one_line(text: &str) -> String {
    on_one_line(&without_comments(text))
}

/// A text without `// …`; line breaks stay.
pub fn without_comments(text: &str) -> String {
    let cut = |line: &str| {
        let comment = outside_quotes(line).find(|&(at, _)| line[at..].starts_with("//")).map(|(at, _)| at);
        line.get(..comment.unwrap_or(line.len())).unwrap_or("").to_string()
    };
    text.lines().map(cut).collect::<Vec<_>>().join("\n")
}

/// The characters outside of quotes.
pub fn outside_quotes(text: &str) -> impl Iterator<Item = (usize, char)> {
    let mut quoted = false;
    text.char_indices().filter(move |&(_, c)| {
        quoted ^= c == '"';
        !quoted
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_of_a_character_is_where_it_begins() {
        let mut map = SourceMap::new();
        let file = map.add("a", "ab🐊c\n");
        let column = |byte| map.file(file).line_column_utf16(byte);
        assert_eq!([2, 3, 4, 5, 6].map(column), [(1, 3), (1, 3), (1, 3), (1, 3), (1, 5)]);
    }

    #[test]
    fn lines_and_columns_count_characters() {
        let mut map = SourceMap::new();
        let id = map.add("a", "one\néé x\n");
        let file = map.file(id);
        assert_eq!(file.line_column(0), (1, 1));
        assert_eq!(file.line_column(4), (2, 1));
        assert_eq!(file.line_column(9), (2, 4));
        assert_eq!(file.line_column(1000), (3, 1));
        let id = map.add("b", "\u{1f40a} é\n");
        assert_eq!(map.file(id).line_column(7), (1, 4));
        assert_eq!(map.file(id).line_column_utf16(7), (1, 5));
    }

    #[test]
    fn columns_of_long_lines_are_counted_from_marks() {
        let text = format!("{}\n{}", "aé\u{1f40a}".repeat(700), "é\u{1f40a}x".repeat(5_000));
        let mut map = SourceMap::new();
        let id = map.add("a", text.as_str());
        for (byte, _) in text.char_indices().step_by(97) {
            let start = text[..byte].rfind('\n').map_or(0, |at| at + 1);
            let line = 1 + usize::from(start > 0);
            let before = &text[start..byte];
            assert_eq!(map.file(id).line_column(byte), (line, before.chars().count() + 1));
            assert_eq!(map.file(id).line_column_utf16(byte), (line, before.encode_utf16().count() + 1));
        }
    }

    #[test]
    fn a_byte_order_mark_is_dropped_and_bad_bytes_are_named() {
        assert_eq!(decode(vec![0xef, 0xbb, 0xbf, b'a']), Ok("a".to_string()));
        assert_eq!(decode(vec![b'a', 0xff]), Err(ReadError::NotUtf8(1)));
    }
}

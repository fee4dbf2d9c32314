//! Facts about files and limits.

use std::path::PathBuf;

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::{MAX_FILE_BYTES, MAX_SOURCES, ReadError, Span};

/// A file that cannot be read.
pub struct Unreadable {
    /// Its path.
    pub path: PathBuf,
    /// The import or the map that names it; none for a file of the command line.
    pub import: Option<Span>,
    /// The reason.
    pub error: ReadError,
}

impl Unreadable {
    /// The fact for a file of the command line.
    pub fn named(path: impl Into<PathBuf>, error: ReadError) -> Self {
        Unreadable { path: path.into(), import: None, error }
    }
}

impl Fact for Unreadable {
    fn into_diagnostic(self) -> Diagnostic {
        let path = self.path.display();
        let d = match self.error {
            ReadError::Unreadable(why) => Diagnostic::new(Code::Unreadable, format!("cannot read `{path}`: {why}")),
            ReadError::NotUtf8(byte) => {
                Diagnostic::new(Code::NotUtf8, format!("`{path}` is not UTF-8 text: byte {byte} fits no character"))
                    .help("save the file with the encoding UTF-8")
            }
            ReadError::TooLarge(bytes) => {
                let found = mebibytes(bytes);
                let message = format!("`{path}` is too large: {found} MiB, less than {LIMIT} MiB are read");
                Diagnostic::new(Code::TooLarge, message).help(match self.path.extension() {
                    Some(extension) if extension == "hyped" => "split it into several files, and `import` them in one",
                    _ => "a level can be several spaces, each with a map in a file of its own",
                })
            }
        };
        match self.import {
            Some(span) => d.at(span, "named here"),
            None => d,
        }
    }
}

/// The first size that is too large, in MiB.
const LIMIT: usize = (MAX_FILE_BYTES + 1) >> 20;

/// A size as text. Only the beginning of a stream is read: its size is known only to be above the limit.
fn mebibytes(bytes: u64) -> String {
    let over = bytes.saturating_sub(MAX_FILE_BYTES as u64);
    if over <= 1 {
        return format!("{LIMIT} or more");
    }
    // Rounded up: a file above the limit never looks as if it were below.
    format!("{:.1}", (bytes as f64 / f64::from(1 << 20) * 10.0).ceil() / 10.0)
}

/// Files that import each other.
pub struct ImportCycle {
    /// The import that closes the cycle.
    pub import: Span,
    /// The files on the cycle.
    pub files: Vec<PathBuf>,
}

impl Fact for ImportCycle {
    fn into_diagnostic(self) -> Diagnostic {
        let chain: Vec<String> = self.files.iter().map(|f| format!("`{}`", f.display())).collect();
        Diagnostic::new(Code::ImportCycle, format!("files import each other: {}", chain.join(" → ")))
            .at(self.import, "this import closes the cycle")
            .help("move what both need into a third file")
            .or_remove("this import", self.import)
    }
}

/// A count above its limit.
pub struct TooMany {
    /// What is counted.
    pub what: String,
    /// The count.
    pub count: u64,
    /// The limit.
    pub limit: u64,
    /// Where.
    pub at: Span,
}

impl TooMany {
    /// The fact that a program has too many files, levels and legends included.
    pub fn sources(at: Span) -> Self {
        let what = "files, levels and legends included".into();
        TooMany { what, count: MAX_SOURCES as u64 + 1, limit: MAX_SOURCES as u64, at }
    }
}

impl Fact for TooMany {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::TooLarge, format!("too many {}: {}, at most {}", self.what, self.count, self.limit))
            .at(self.at, format!("{} {}", self.count, self.what))
    }
}

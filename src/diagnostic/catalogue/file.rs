//! Facts about files and limits.

use std::path::PathBuf;

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::{MAX_FILE_BYTES, MAX_SOURCES, ReadError, Span};

/// A file that is not to be had.
pub struct Unreadable {
    /// Its path.
    pub path: PathBuf,
    /// Where it is imported, or named by a map; none if it was named on the command line.
    pub import: Option<Span>,
    /// Why.
    pub error: ReadError,
}

impl Unreadable {
    /// Of a file that was named on the command line.
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

/// What [`MAX_FILE_BYTES`] is the last number below, in MiB.
const LIMIT: usize = (MAX_FILE_BYTES + 1) >> 20;

/// How much that is, for people. Of a stream only its beginning is read: of that it is no more than known to be too
/// large.
fn mebibytes(bytes: u64) -> String {
    let over = bytes.saturating_sub(MAX_FILE_BYTES as u64);
    if over <= 1 {
        return format!("{LIMIT} or more");
    }
    // Rounded up: what is too large does not look as if it were not.
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
    }
}

/// Something there is too much of.
pub struct TooMany {
    /// What it is.
    pub what: String,
    /// How many there are.
    pub count: u64,
    /// How many there may be.
    pub limit: u64,
    /// Where.
    pub at: Span,
}

impl TooMany {
    /// One file more than a program may be made of, levels and legends included.
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

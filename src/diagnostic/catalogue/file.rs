//! Facts about files and limits.

use std::path::PathBuf;

use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::{ReadError, Span};

/// A file that is not to be had.
pub struct Unreadable {
    /// Its path.
    pub path: PathBuf,
    /// Where it is imported, or named by a map; none if it was named on the command line.
    pub import: Option<Span>,
    /// Why.
    pub error: ReadError,
}

impl Fact for Unreadable {
    fn word(self) -> Diagnostic {
        let path = self.path.display();
        let d = match self.error {
            ReadError::Unreadable(why) => Diagnostic::new(Code::Unreadable, format!("cannot read `{path}`: {why}")),
            ReadError::NotUtf8(byte) => {
                Diagnostic::new(Code::NotUtf8, format!("`{path}` is not UTF-8 text: byte {byte} fits no character"))
                    .help("save the file with the encoding UTF-8")
            }
            ReadError::TooLarge(bytes) => Diagnostic::new(
                Code::TooLarge,
                format!("`{path}` is too large: {bytes} bytes, at most {} are read", crate::source::MAX_FILE_BYTES),
            ),
        };
        match self.import {
            Some(span) => d.at(span, "named here"),
            None => d,
        }
    }
}

/// Files that import each other.
pub struct ImportCycle {
    /// The import that closes the cycle.
    pub import: Span,
    /// The files on the cycle.
    pub files: Vec<PathBuf>,
}

impl Fact for ImportCycle {
    fn word(self) -> Diagnostic {
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

impl Fact for TooMany {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::TooLarge, format!("too many {}: {}, at most {}", self.what, self.count, self.limit))
            .at(self.at, format!("{} {}", self.count, self.what))
    }
}

//! Locations in files, independent of the protocol: positions of requests and ranges of results. Byte offsets refer to
//! the code of a text, which is the text without a byte order mark.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use crate::lsp::text::document_text::Text;

/// The position of a request: a byte offset in a file, in [`View::text`](crate::lsp::view::View::text).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct FileOffset {
    pub path: PathBuf,
    pub byte: usize,
}

/// A range of bytes in a file, with the text to which the offsets refer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Location {
    pub path: PathBuf,
    pub text: Arc<Text>,
    pub bytes: Range<usize>,
}

/// A replacement of a range by a new text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Edit {
    pub at: Location,
    pub new_text: String,
}

//! Places in files, without the protocol: where something is asked, and where an answer is. Bytes count in the code of a
//! text, which is the text without a byte order mark.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use crate::lsp::text::document_text::Text;

/// Where something is asked: a byte of a file, in [`View::text`](crate::lsp::view::View::text).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct FileOffset {
    pub path: PathBuf,
    pub byte: usize,
}

/// Where an answer is: some bytes of a file, and the text that they count in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Location {
    pub path: PathBuf,
    pub text: Arc<Text>,
    pub bytes: Range<usize>,
}

/// A text to put in place of another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Edit {
    pub at: Location,
    pub new_text: String,
}

//! What the server knows at one moment: the open documents and the newest snapshot of each program. Features are functions of
//! it: they change nothing and wait for nothing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::diagnostic::Diagnostics;
use crate::lsp::Workspace;
use crate::lsp::documents::Documents;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::document_text::{Encoding, Text};
use crate::lsp::values::Ranges;
use crate::source::FileId;

/// Why a request that was understood cannot be met.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Refusal(pub String);

/// What is known of a program that is open, or in the workspace.
pub(in crate::lsp) struct Known {
    pub now: Arc<Snapshot>,
    /// The last one without errors.
    pub good: Option<Arc<Snapshot>>,
    /// What the analysis of values found of it as it is now.
    pub findings: Option<Diagnostics>,
    /// What its variables could be when that was last known.
    pub ranges: Option<Ranges>,
}

/// What features see.
pub(in crate::lsp) struct View {
    pub documents: Documents,
    /// The programs that are open or in the workspace, by their paths.
    pub known: BTreeMap<PathBuf, Known>,
    /// The old and the new name of the last renaming.
    pub renamed: Option<(String, String)>,
    pub disk: Arc<dyn Workspace>,
}

impl View {
    /// The programs that a document is part of, itself first.
    pub fn programs(&self, path: &Path) -> impl Iterator<Item = &Known> {
        let own = self.known.get(path);
        let others = self.known.iter().filter(move |(root, k)| root.as_path() != path && k.now.file(path).is_some());
        own.into_iter().chain(others.map(|(_, known)| known))
    }

    /// The text that offsets in a file count in: of the open document, or else of the first program that has the file.
    pub fn text(&self, path: &Path) -> Option<Arc<Text>> {
        match self.documents.get(path) {
            Some(document) => Some(Arc::clone(&document.text)),
            None => self.programs(path).find_map(|known| Some(known.now.text(known.now.file(path)?))),
        }
    }

    /// A byte of [`text`](Self::text) in the text that a program was compiled from. If that is an older one, it is the byte
    /// at the same line and column.
    pub fn byte_in(&self, snapshot: &Snapshot, file: FileId, byte: usize) -> usize {
        let text = snapshot.text(file);
        match self.text(snapshot.path(file)) {
            Some(newest) if newest != text => text.byte(newest.position(byte, Encoding::Utf8), Encoding::Utf8),
            _ => byte,
        }
    }
}

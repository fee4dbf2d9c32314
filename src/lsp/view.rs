//! The state of the server that features read: the open documents and the newest snapshot of each program. Features are
//! functions of a view: they neither modify it nor block.

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

/// Why a valid request is refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Refusal(pub String);

/// The state of a program that is open or in the workspace.
pub(in crate::lsp) struct ProgramState {
    pub current: Arc<Snapshot>,
    /// The last snapshot without errors.
    pub last_good: Option<Arc<Snapshot>>,
    /// The findings of the value analysis for the current snapshot; `None` until it has run.
    pub findings: Option<Diagnostics>,
    /// The newest known value ranges of its variables; may be of an older snapshot.
    pub ranges: Option<Ranges>,
}

/// The state that features read.
pub(in crate::lsp) struct View {
    pub documents: Documents,
    /// The programs that are open or in the workspace, by path.
    pub programs: BTreeMap<PathBuf, ProgramState>,
    /// The old and the new name of the last rename.
    pub last_rename: Option<(String, String)>,
    pub disk: Arc<dyn Workspace>,
}

impl View {
    /// The programs that contain a file, the one whose root it is first.
    pub fn programs_with(&self, path: &Path) -> impl Iterator<Item = &ProgramState> {
        let own = self.programs.get(path);
        let others = self
            .programs
            .iter()
            .filter(move |(root, state)| root.as_path() != path && state.current.file(path).is_some());
        own.into_iter().chain(others.map(|(_, state)| state))
    }

    /// The text to which offsets in a file refer: the open document, or else the file in the first program that
    /// contains it.
    pub fn text(&self, path: &Path) -> Option<Arc<Text>> {
        match self.documents.get(path) {
            Some(document) => Some(Arc::clone(&document.text)),
            None => self.programs_with(path).find_map(|state| Some(state.current.text(state.current.file(path)?))),
        }
    }

    /// Maps an offset in [`text`](Self::text) to the text that a snapshot was compiled from. If that text is older,
    /// returns the offset at the same line and column.
    pub fn byte_in(&self, snapshot: &Snapshot, file: FileId, byte: usize) -> usize {
        let text = snapshot.text(file);
        match self.text(snapshot.path(file)) {
            Some(newest) if newest != text => text.byte(newest.position(byte, Encoding::Utf8), Encoding::Utf8),
            _ => byte,
        }
    }
}

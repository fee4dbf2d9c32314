//! The documents that are open in the editor: their texts and versions, as the editor has them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use crate::lsp::text::document_text::{Encoding, Position, Text};

/// An open document.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Document {
    /// As the editor calls it.
    pub uri: String,
    /// The editor's own count of changes.
    pub version: i32,
    /// Whether it is a program, and not a level or a legend.
    pub is_program: bool,
    /// What is in it.
    pub text: Arc<Text>,
}

/// A change of a text.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Change {
    /// Where; without a range everything changes.
    pub range: Option<Range<Position>>,
    pub new_text: String,
}

/// All open documents, by their paths.
pub(in crate::lsp) type Open = BTreeMap<PathBuf, Document>;

/// The documents, shared with the thread that compiles them.
#[derive(Debug, Default)]
pub(in crate::lsp) struct Documents {
    open: Arc<Open>,
}

impl Documents {
    /// Opens a document, or reopens it.
    pub fn open(&mut self, path: PathBuf, uri: String, version: i32, text: String, language: &str) {
        let is_program = language == "hyped" || path.extension().is_some_and(|e| e == "hyped");
        let document = Document { uri, version, is_program, text: Arc::new(Text::new(text)) };
        Arc::make_mut(&mut self.open).insert(path, document);
    }

    /// Changes an open document; returns whether it is one. The range of each change counts in the text that the changes
    /// before it left.
    pub fn change(&mut self, path: &Path, version: i32, changes: &[Change], encoding: Encoding) -> bool {
        let Some(document) = Arc::make_mut(&mut self.open).get_mut(path) else { return false };
        document.version = version;
        let text = Arc::make_mut(&mut document.text);
        for Change { range, new_text } in changes {
            text.change(range.clone(), new_text, encoding);
        }
        true
    }

    /// Closes a document; returns whether it was open.
    pub fn close(&mut self, path: &Path) -> bool {
        Arc::make_mut(&mut self.open).remove(path).is_some()
    }

    /// An open document.
    pub fn get(&self, path: &Path) -> Option<&Document> {
        self.open.get(path)
    }

    /// All of them as they are now.
    pub fn all(&self) -> &Arc<Open> {
        &self.open
    }
}

/// A path without `.` and `..`, whatever the disk says of links.
pub(in crate::lsp) fn clean(path: &Path) -> PathBuf {
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

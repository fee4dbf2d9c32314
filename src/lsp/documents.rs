//! The open documents: their texts and versions, in sync with the editor.

use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::lsp::text::document_text::{Encoding, Position, Text};

/// Bytes of text that leave enough memory free to give it back to the system.
const MUCH: usize = 1 << 20;

/// An open document.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Document {
    /// The URI that the editor uses for it.
    pub uri: String,
    /// The version number of the editor.
    pub version: i32,
    /// Whether it is a program, and not a level or a legend.
    pub is_program: bool,
    pub text: Arc<Text>,
    /// The lines of the last change, until the document is saved: what is being typed is not finished.
    pub edited: Option<RangeInclusive<u32>>,
}

/// A change of a text.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Change {
    /// The replaced range; `None` replaces the whole text.
    pub range: Option<Range<Position>>,
    pub new_text: String,
}

/// All open documents, by path.
pub(in crate::lsp) type OpenDocuments = BTreeMap<PathBuf, Document>;

/// The open documents, shared with the worker.
#[derive(Debug, Default)]
pub(in crate::lsp) struct Documents {
    open: Arc<OpenDocuments>,
    /// Bytes of text that were closed or removed since memory was given back.
    dropped: usize,
}

impl Documents {
    /// Opens a document, or replaces it if it is already open.
    pub fn open(&mut self, path: PathBuf, uri: String, version: i32, text: String, language: &str) {
        let is_program = language == "hyped" || path.extension().is_some_and(|e| e == "hyped");
        let text = match self.open.get(&path) {
            Some(document) => document.text.replaced(text),
            None => Text::new(text),
        };
        let document = Document { uri, version, is_program, text: Arc::new(text), edited: None };
        Arc::make_mut(&mut self.open).insert(path, document);
    }

    /// Applies changes to a document; returns false if it is not open. The range of each change refers to the text
    /// after the preceding changes.
    pub fn change(&mut self, path: &Path, version: i32, changes: &[Change], encoding: Encoding) -> bool {
        let Some(document) = Arc::make_mut(&mut self.open).get_mut(path) else { return false };
        document.version = version;
        let text = Arc::make_mut(&mut document.text);
        let length = text.whole().len();
        for Change { range, new_text } in changes {
            text.change(range.clone(), new_text, encoding);
            document.edited = range.as_ref().map(|range| {
                let first = range.start.line;
                first..=first.saturating_add(new_text.matches('\n').count() as u32)
            });
        }
        self.dropped += length.saturating_sub(text.whole().len());
        true
    }

    /// A document was saved: nothing of it is being typed. Returns whether something was.
    pub fn save(&mut self, path: &Path) -> bool {
        let Some(document) = Arc::make_mut(&mut self.open).get_mut(path) else { return false };
        document.edited.take().is_some()
    }

    /// Closes a document; returns whether it was open.
    pub fn close(&mut self, path: &Path) -> bool {
        let closed = Arc::make_mut(&mut self.open).remove(path);
        self.dropped += closed.as_ref().map_or(0, |document| document.text.whole().len());
        closed.is_some()
    }

    /// Whether much text was closed or removed since the last call that said so.
    pub fn dropped_much(&mut self) -> bool {
        let is_much = self.dropped >= MUCH;
        if is_much {
            self.dropped = 0;
        }
        is_much
    }

    /// An open document.
    pub fn get(&self, path: &Path) -> Option<&Document> {
        self.open.get(path)
    }

    /// The current state of all open documents.
    pub fn all(&self) -> &Arc<OpenDocuments> {
        &self.open
    }
}

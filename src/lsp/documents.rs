//! The documents that are open in the editor: their texts and versions, as the editor has them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gen_lsp_types::{TextDocumentContentChangeEvent, Uri};

use crate::lsp::text::document_text::{Encoding, Text};
use crate::lsp::text::uri::path_of;

/// An open document.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Document {
    /// As the editor calls it.
    pub uri: Uri,
    /// The editor's own count of changes.
    pub version: i32,
    /// Whether it is a program, and not a level or a legend.
    pub is_program: bool,
    /// What is in it.
    pub text: Arc<Text>,
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
    pub fn open(&mut self, uri: Uri, version: i32, text: String, language: &str) -> PathBuf {
        let path = path_of(&uri);
        let is_program = language == "hyped" || path.extension().is_some_and(|e| e == "hyped");
        let document = Document { uri, version, is_program, text: Arc::new(Text::new(text)) };
        Arc::make_mut(&mut self.open).insert(path.clone(), document);
        path
    }

    /// Changes an open document; returns its path if it is one.
    pub fn change(
        &mut self,
        uri: &Uri,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
        encoding: Encoding,
    ) -> Option<PathBuf> {
        let path = path_of(uri);
        let document = Arc::make_mut(&mut self.open).get_mut(&path)?;
        document.version = version;
        let text = Arc::make_mut(&mut document.text);
        for change in changes {
            use TextDocumentContentChangeEvent as Change;
            match change {
                Change::TextDocumentContentChangePartial(part) => text.change(Some(part.range), &part.text, encoding),
                Change::TextDocumentContentChangeWholeDocument(whole) => text.change(None, &whole.text, encoding),
            }
        }
        Some(path)
    }

    /// Closes a document; returns its path if it was open.
    pub fn close(&mut self, uri: &Uri) -> Option<PathBuf> {
        let path = path_of(uri);
        Arc::make_mut(&mut self.open).remove(&path).map(|_| path)
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

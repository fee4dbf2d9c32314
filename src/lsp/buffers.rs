//! The files as the editor has them: open documents, and the disk for all others.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::lsp::Workspace;
use crate::lsp::documents::OpenDocuments;
use crate::source::{Files, ReadError, decode, normalize};

/// The open documents at one point in time, over the disk.
#[derive(Clone)]
pub(in crate::lsp) struct Buffers {
    pub open: Arc<OpenDocuments>,
    pub disk: Arc<dyn Workspace>,
}

impl Files for Buffers {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let path = normalize(path);
        match self.open.get(&path) {
            Some(document) => decode(document.text.whole().as_bytes().to_vec()),
            None => self.disk.read(&path),
        }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        let path = normalize(path);
        if self.open.contains_key(&path) { path } else { self.disk.identity(&path) }
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        self.disk.bad_picture(&normalize(path))
    }
}

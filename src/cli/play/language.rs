//! The language service of the page's editor: its own WebSocket, so that an analysis does not hold up the play.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::lsp::Workspace;
use crate::lsp::service::{Request, Service};
use crate::source::{Files, ReadError};
use crate::studio::Answer;

use super::super::disk::Disk;

/// The disk, without a search for programs: only those that are open are compiled.
struct Opened;

impl Files for Opened {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        Disk.read(path)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        Disk.bad_picture(path)
    }
}

impl Workspace for Opened {
    fn programs(&self, _: &Path) -> Vec<PathBuf> {
        Vec::new()
    }
}

/// The service of one page.
pub(super) struct Language(Service);

impl Language {
    pub fn new() -> Language {
        Language(Service::new(Arc::new(Opened)))
    }

    /// Answers a request, both as JSON.
    pub fn answer(&mut self, text: &str) -> String {
        let answer = match serde_json::from_str::<Request>(text) {
            Ok(request) => serde_json::to_string(&self.0.answer(request)),
            Err(error) => serde_json::to_string(&Answer::Refused { message: format!("not a request: {error}") }),
        };
        answer.unwrap_or_default()
    }
}

//! The language service over the files in memory.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hypedc::lsp::Workspace;
use hypedc::lsp::service::{Answer, Request, Service};
use hypedc::source::{Files, ReadError};

use crate::files::Memory;

pub(crate) use hypedc::lsp::service::Request as LanguageRequest;

/// The files of the program as a workspace.
struct InMemory(Memory);

impl Files for InMemory {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.0.read(path)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.0.identity(path)
    }
}

impl Workspace for InMemory {
    fn programs(&self, folder: &Path) -> Vec<PathBuf> {
        self.0.programs(folder)
    }
}

/// A language service.
pub(crate) struct Language(Service);

impl Language {
    /// A service over the files of a program.
    pub fn new(files: Memory) -> Language {
        Language(Service::new(Arc::new(InMemory(files))))
    }

    pub fn answer(&mut self, request: Request) -> Answer {
        self.0.answer(request)
    }
}

//! What the server knows at one moment: the open documents and the newest snapshot of each program. Features are functions of
//! it: they change nothing and wait for nothing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lsp_server::ErrorCode;

use crate::diagnostic::Diagnostics;
use crate::lsp::Workspace;
use crate::lsp::client::Client;
use crate::lsp::diagnostics::ByDocument;
use crate::lsp::documents::Documents;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::values::Ranges;

/// Why a request has no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Failure {
    pub code: i32,
    pub message: String,
}

impl Failure {
    /// The request was understood, and cannot be met.
    pub fn refused(message: impl Into<String>) -> Self {
        Failure { code: ErrorCode::RequestFailed as i32, message: message.into() }
    }
}

/// What is known of a program that is open, or in the workspace.
pub(in crate::lsp) struct Known {
    pub now: Arc<Snapshot>,
    /// The last one without errors.
    pub good: Option<Arc<Snapshot>>,
    /// What the analysis of values found of it as it is now.
    pub findings: Option<Diagnostics>,
    /// What its variables could be when that was last known.
    pub ranges: Option<Ranges>,
    /// What compiling found, as the editor shows it.
    pub compile_findings: ByDocument,
    /// What the analysis of values found, as the editor shows it: of the program as it is now or, until that is known, of
    /// its state before.
    pub value_findings: ByDocument,
}

/// What features see.
pub(in crate::lsp) struct View {
    pub client: Client,
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
}

//! The language server: what editors ask of open texts (Language Server Protocol 3.18), over any connection.
//!
//! ```text
//!  editor ◀──messages──▶ server ──documents──▶ worker ──compile──▶ Snapshot ──▶ server
//!                          │                      └────analysis──▶ findings, ranges ──▶ server
//!                          └── one file for each family of requests, from the newest snapshots
//! ```
//!
//! The server's thread only reads messages, keeps the documents and answers from snapshots; all that takes long is done
//! by the worker, which starts anew when a document changes. A request that needs names waits until the worker has
//! compiled the documents as the request saw them. What broken texts do not tell is taken from the last snapshot that was
//! free of errors.

mod actions;
mod alignment;
mod capabilities;
mod completion;
mod diagnostics;
mod dispatch;
mod documents;
mod following;
mod hierarchy;
mod hints;
mod hover;
mod lexer;
mod meanings;
mod navigate;
mod place;
mod rename;
mod server;
mod signature;
mod snapshot;
mod structure;
mod text;
mod tokens;
mod uri;
mod values;
mod words;
mod worker;

use std::path::{Path, PathBuf};

pub use server::{Server, Settings};

use crate::source::Files;

/// Where programs are that no document is open of.
pub trait Workspace: Files + Send + Sync {
    /// The programs in a folder and in those below.
    fn programs(&self, folder: &Path) -> Vec<PathBuf>;
}

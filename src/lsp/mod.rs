//! The language server (Language Server Protocol 3.18): answers requests of editors about open documents, over any
//! connection.
//!
//! ```text
//!  editor ◀──messages──▶ protocol/ ──documents──▶ worker ──compile──▶ Snapshot ─┐
//!                           │                       └────analysis──▶ findings ──┤
//!                           └─path, byte─▶ features/ ◀──View◀───────────────────┘
//!                           ◀──plain results──┘
//! ```
//!
//! | folder, file | holds |
//! |---|---|
//! | `protocol` | the connection, the worker, the table of requests, conversion from and to the protocol's types |
//! | `service` | the same features by typed requests, without a connection: for the editor of the playground |
//! | `features` | the features of the server: functions from a view, a path and a byte offset to plain results |
//! | `verdicts` | goals and `never`s asked again while one types; levels of open maps; painted maps |
//! | `commands`, `buffers` | the commands that run a program: `sim`, `reach`, `test`, `why`; the files that they read |
//! | `view`, `snapshot`, `documents`, `values`, `location` | the state that features read, and locations in it |
//! | `text` | texts that may not parse: positions, tokens, the context of a cursor |
//!
//! Only `protocol` uses the types of the protocol. Features use byte offsets and paths; `protocol` converts their
//! results to lines and columns, URIs, and the kinds that editors know.
//!
//! The server's thread only reads messages, updates the documents and answers from snapshots. The worker does
//! everything that takes long, and restarts when a document changes. A request that needs names waits until the worker
//! has compiled the documents as of the request. Where a text does not parse, features fall back to the last snapshot
//! without errors.

#![cfg_attr(not(feature = "lsp"), allow(dead_code, reason = "the service alone offers fewer features"))]

#[cfg(feature = "lsp")]
mod buffers;
#[cfg(feature = "lsp")]
mod commands;
mod documents;
mod features;
mod location;
#[cfg(feature = "lsp")]
mod protocol;
pub mod service;
mod snapshot;
mod text;
mod values;
#[cfg(feature = "lsp")]
mod verdicts;
mod view;

use std::path::{Path, PathBuf};

#[cfg(feature = "lsp")]
pub use protocol::{Server, Settings, Transport};

use crate::source::Files;

/// Access to the programs on the disk, for those that are not open.
pub trait Workspace: Files + Send + Sync {
    /// The programs in a folder and its subfolders.
    fn programs(&self, folder: &Path) -> Vec<PathBuf>;

    /// The files in a folder and its subfolders that may be levels, by their names.
    fn levels(&self, _folder: &Path) -> Vec<PathBuf> {
        Vec::new()
    }

    /// What was remembered under a key, outside of all projects.
    fn recall(&self, _key: &str) -> Option<String> {
        None
    }

    /// Remembers a text under a key. What cannot be written is forgotten.
    fn remember(&self, _key: &str, _text: &str) {}

    /// Gives memory that the calling thread does not need any more back to the system. Called when nothing is left to do for
    /// it, and by the server after much text was closed.
    fn release_memory(&self) {}

    /// Seconds since some moment, for records; always 0 without a clock.
    fn seconds(&self) -> f64 {
        0.0
    }

    /// The files in a folder and its subfolders with one of some endings.
    fn files(&self, _folder: &Path, _endings: &[&str]) -> Vec<PathBuf> {
        Vec::new()
    }
}

//! The language server: what editors ask of open texts (Language Server Protocol 3.18), over any connection.
//!
//! ```text
//!  editor ◀──messages──▶ protocol/ ──documents──▶ worker ──compile──▶ Snapshot ─┐
//!                           │                       └────analysis──▶ findings ──┤
//!                           └─path, byte─▶ features/ ◀──View◀───────────────────┘
//!                           ◀──plain answers──┘
//! ```
//!
//! | folder, file | holds |
//! |---|---|
//! | `protocol` | the connection, the worker, the table of requests, the way from and to the protocol's types |
//! | `features` | what the server can do: functions from a view, a path and a byte to plain answers |
//! | `view`, `snapshot`, `documents`, `values`, `location` | what is known at one moment, and places in it |
//! | `text` | texts that may be broken: lines and columns, words, where a cursor is |
//!
//! Only `protocol` uses the types of the protocol. A feature counts in bytes and names files by paths; lines and columns,
//! URIs, and the kinds that editors know come in when its answer is sent.
//!
//! The server's thread only reads messages, keeps the documents and answers from snapshots; all that takes long is done
//! by the worker, which restarts when a document changes. A request that needs names waits until the worker has
//! compiled the documents as the request saw them. What broken texts do not tell is taken from the last snapshot that was
//! free of errors.

mod documents;
mod features;
mod location;
mod protocol;
mod snapshot;
mod text;
mod values;
mod view;

use std::path::{Path, PathBuf};

pub use protocol::{Server, Settings};

use crate::source::Files;

/// Where programs are that no document is open of.
pub trait Workspace: Files + Send + Sync {
    /// The programs in a folder and in those below.
    fn programs(&self, folder: &Path) -> Vec<PathBuf>;
}

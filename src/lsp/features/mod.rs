//! The features of the server, one file per family of requests: functions from a view and a position to plain results.
//! Independent of the protocol.

pub(super) mod actions;
pub(super) mod completion;
pub(super) mod completion_items;
pub(super) mod completion_order;
mod completion_text;
pub(super) mod file_renames;
pub(super) mod findings;
pub(super) mod formatting;
pub(super) mod hierarchy;
pub(super) mod hints;
pub(super) mod hover;
pub(super) mod hover_more;
pub(super) mod navigate;
pub(super) mod rename;
pub(super) mod signature;
pub(super) mod structure;
#[cfg(feature = "lsp")]
pub(super) mod tests;
pub(super) mod tokens;

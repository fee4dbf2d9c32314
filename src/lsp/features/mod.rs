//! What the server can do, one file for each family of requests: functions from what is known at one moment, and a
//! place in a file, to plain answers. Nothing here knows of the protocol.

pub(super) mod actions;
pub(super) mod completion;
pub(super) mod completion_items;
pub(super) mod hierarchy;
pub(super) mod hints;
pub(super) mod hover;
pub(super) mod navigate;
pub(super) mod rename;
pub(super) mod signature;
pub(super) mod structure;
pub(super) mod tokens;

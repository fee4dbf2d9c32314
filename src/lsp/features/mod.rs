//! What the server can do, one file for each family of requests: functions from what is known at one moment to answers.

mod actions;
mod completion;
mod hierarchy;
mod hints;
mod hover;
mod navigate;
mod rename;
mod signature;
mod structure;
pub(super) mod tokens;

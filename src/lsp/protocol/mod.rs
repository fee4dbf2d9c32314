//! The connection to the editor: messages, the worker that compiles, the table of requests.

mod capabilities;
mod requests;
mod server;
mod token_updates;
mod worker;

pub use server::{Server, Settings};

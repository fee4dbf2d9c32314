//! The connection to the editor: messages, the worker that compiles, the table of requests. All that knows the
//! protocol's types is here: `from_protocol` reads them, `to_protocol` writes them.

mod capabilities;
mod client;
mod findings;
mod from_protocol;
mod handlers;
mod kinds;
mod requests;
mod server;
mod to_protocol;
mod tokens;
mod uri;
mod worker;

pub use server::{Server, Settings};

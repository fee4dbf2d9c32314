//! The connection to the editor: messages, the worker, the table of requests. Only this module uses the types of the
//! protocol: `from_protocol` converts parameters; `to_protocol` converts results, `findings` and `tokens` what the server
//! publishes, all three on top of `positions`.

mod capabilities;
mod client;
mod context;
mod edit_handlers;
mod findings;
mod from_protocol;
mod handlers;
mod kinds;
mod positions;
mod requests;
mod server;
mod to_protocol;
mod tokens;
mod transport;
mod uri;
mod worker;

pub use server::{Server, Settings};
pub use transport::Transport;

//! The connection to the editor: messages, the worker, the table of requests. Only this module uses the types of the
//! protocol: `from_protocol` converts parameters; `to_protocol` converts results, `findings` and `tokens` what the server
//! publishes, all three on top of `positions`.

mod background;
mod broken;
mod capabilities;
mod client;
mod commands;
mod context;
mod edit_handlers;
mod explain;
mod extensions;
mod findings;
mod from_protocol;
mod handlers;
mod inbox;
mod kinds;
mod lenses;
mod live;
mod painting;
mod play;
mod positions;
mod requests;
mod runnable;
mod server;
mod tasks;
mod to_protocol;
mod tokens;
mod transport;
mod uri;
mod worker;

pub use server::{Server, Settings};
pub use transport::Transport;

//! A play session: a program is compiled, its world is played, scrubbed, inspected, changed and searched, all by typed
//! [requests](Request) with typed [answers](Answer). It does no input or output: `hypedc play` carries it to a page over
//! a WebSocket, the playground runs it in the page's worker.

mod bounds;
mod history;
mod inspect;
mod paint;
mod project;
mod protocol;
mod scene;
mod search;
mod session;
mod sliders;

pub use project::Level;
pub use protocol::*;
pub use search::{Listener, Task};
pub use session::Session;

//! A play session: a program is compiled, its world is played, scrubbed, inspected, changed and searched, all by typed
//! [requests](Request) with typed [answers](Answer). It does no input or output: `hypedc play` carries it to a page over
//! a WebSocket, the playground runs it in the page's worker.

mod bounds;
mod history;
mod inspect;
#[cfg(feature = "lsp")]
mod lit;
mod paint;
mod project;
mod protocol;
mod scene;
mod search;
mod session;
mod sliders;

#[cfg(feature = "lsp")]
pub use lit::{Lit, LitMode};
#[cfg(any(feature = "cli", feature = "lsp"))]
pub(crate) use paint::Written;
pub use project::Level;
pub use protocol::*;
pub use search::{Listener, Task};
pub use session::Session;

/// The JSON Schemas of requests as they are read and of answers as they are written.
#[cfg(feature = "testing")]
pub fn schemas() -> [serde_json::Value; 2] {
    use schemars::generate::SchemaSettings;
    let settings = SchemaSettings::draft2020_12();
    let request = settings.clone().for_deserialize().into_generator().into_root_schema_for::<Request>();
    let answer = settings.for_serialize().into_generator().into_root_schema_for::<Answer>();
    [request.to_value(), answer.to_value()]
}

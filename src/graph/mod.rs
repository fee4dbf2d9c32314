//! Statecharts of entities: the modes with their edges as a plain graph, read off a compiled program, and writers that
//! make pictures of it. Guards and updates are shown as the source writes them.
//!
//! | format | drawn by |
//! |---|---|
//! | [`dot`] | Graphviz |
//! | [`mermaid`] | Mermaid, as a `stateDiagram-v2` |
//! | [`svg`] | us: modes one below the other, edges beside them |

mod chart;
mod dot;
mod excerpt;
mod layout;
mod mermaid;
mod svg;
mod writer;

pub use chart::{Action, Chart, Edge, Initial, Mode, Region, chart};
pub use dot::dot;
pub use mermaid::mermaid;
pub use svg::svg;

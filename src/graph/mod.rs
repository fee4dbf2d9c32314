//! Statecharts of entities: the modes with their edges as a plain graph, built from a compiled program, and writers of
//! pictures. Guards and updates are shown as in the source.
//!
//! | format | drawn by |
//! |---|---|
//! | [`dot`] | Graphviz |
//! | [`mermaid`] | Mermaid, as a `stateDiagram-v2` |
//! | [`svg`] | our own layout: modes stacked, edges beside them |

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

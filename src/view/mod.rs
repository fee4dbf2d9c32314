//! Pictures of searches: the level, the visited points, the tree, the path to the goal. Drawn from plain data, so that
//! any search can be shown; no verdict depends on this module.
//!
//! | file | draws |
//! |---|---|
//! | `search` | the whole picture: title, a panel for each space, legend |
//! | `panel` | one space, layer by layer |
//! | `frame`, `extent` | the transformation to the picture; the visible part of a space |
//! | `appearance` | the colours of kinds of tiles |
//! | `tiles`, `heat`, `tree`, `route`, `goal`, `body` | the layers |
//! | `label`, `legend`, `style`, `svg` | names that do not cover each other, the legend, colours, numbers |

mod appearance;
mod body;
mod extent;
mod frame;
mod goal;
mod heat;
mod label;
mod legend;
mod panel;
mod route;
mod search;
mod style;
mod svg;
mod tiles;
mod tree;

pub use search::{Node, Search, Stop, search_svg};

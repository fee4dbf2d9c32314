//! Pictures of what a search found: the level, where the player was, the tree, the way to the goal. Drawn from plain
//! data, so that any search can be shown; nothing is computed here that a verdict rests on.
//!
//! | file | draws |
//! |---|---|
//! | `search` | the whole picture: title, a panel for each space, legend |
//! | `panel` | one space, layer by layer |
//! | `frame`, `extent` | where a point of the game is in the picture; what part of a space is shown |
//! | `look` | which colour a kind of tile has |
//! | `tiles`, `heat`, `tree`, `route`, `goal`, `body` | the layers |
//! | `label`, `legend`, `style`, `svg` | names that do not cover each other, the key, colours, numbers |

mod body;
mod extent;
mod frame;
mod goal;
mod heat;
mod label;
mod legend;
mod look;
mod panel;
mod route;
mod search;
mod style;
mod svg;
mod tiles;
mod tree;

pub use search::{Node, Search, Stop, search_svg};

//! Pictures of searches and runs: the level, the visited points, the tree, the ways of all that moves. Drawn from plain
//! data, so that any search and any run can be shown; no verdict depends on this module.
//!
//! | file | draws |
//! |---|---|
//! | `track`, `record` | what is shown of a run; its recording while it is simulated |
//! | `picture`, `grid` | the whole picture: title, panels, legend; the arrangement of the panels |
//! | `panel` | one space or a part of it, layer by layer |
//! | `frame`, `extent` | the transformation to the picture; the visible part of a space |
//! | `appearance` | the colours of kinds of tiles |
//! | `tiles`, `heat`, `tree`, `route`, `trail`, `trap`, `moment`, `goal`, `body` | the layers |
//! | `look` | the colours and pictures that a program gives to things |
//! | `cells` | where a search was, as plain data |
//! | `verdict_map` | verdicts over the values of a program's numbers |
//! | `label`, `legend`, `style`, `svg` | names that do not cover each other, the legend, colours, numbers |

mod appearance;
mod body;
mod canvas;
mod cells;
mod extent;
mod film;
mod frame;
mod goal;
mod grid;
mod heat;
mod label;
mod legend;
mod look;
mod moment;
mod palette;
mod panel;
mod picture;
mod record;
mod route;
mod style;
mod svg;
mod tiles;
mod track;
mod trail;
mod trap;
mod tree;
mod verdict_map;

pub use canvas::{Canvas, Image, Paint};
pub use cells::cells;
pub use film::{Film, FilmOptions, PlayerArea};
pub use look::Images;
pub use palette::{ColorTable, Colors};
pub use picture::{Node, Picture, PictureLayer, picture_svg};
pub use record::Recorder;
pub use svg::escaped;
pub use track::{Mark, Moment, Part, Pose, Run, Stop, Track};
pub use verdict_map::{Shade, VerdictMap, VerdictPanel, verdict_map_svg};

//! Why a goal was not reached: the states that came nearest to it, and where the way ends.
//!
//! A search keeps, for each part of the goal and for the whole, the state that came nearest (`tracker`), by distances that
//! are cheap to compute (`lack`), and what its first player was seen to do (`gauge`). After the search, `explain` replays the
//! inputs to these states and describes them. It is a record of what one search saw: it proves nothing.
//!
//! | file | holds |
//! |---|---|
//! | `lack` | the parts of a goal, and how far each is from holding in a state |
//! | `contact` | the gap between bodies that have to touch |
//! | `approach` | the edges to a mode or a value, and what the next one lacks |
//! | `rooms` | the number of links between rooms, and of edges between modes |
//! | `unit` | the units of distances |
//! | `margins` | classes of what the numbers of a state lack, for planners |
//! | `tracker`, `gauge` | what a search keeps: nearest states, jumps, places of rest |
//! | `record` | the explanation as plain data |
//! | `explain` | from what a search kept to the record |
//! | `astray` | where inputs lead that missed the target |
//! | `way` | where the way in the direction of the goal ends |
//! | `bar` | the instance that is in the way in the nearest state |
//! | `closed` | rooms and modes that were never entered |
//! | `words` | distances in words |

mod approach;
mod astray;
mod bar;
mod closed;
mod contact;
mod explain;
mod gauge;
mod lack;
mod margins;
mod record;
mod rooms;
mod tracker;
mod unit;
mod way;
mod words;

pub use astray::{Astray, AstrayEnd, astray};
pub use record::{Barrier, ClosedMode, ClosedRoom, NearState, PartNearest, PartState, Point, WayEnd, WhyNot};
pub use tracker::{Near, Nearest};

pub(super) use explain::explain;
pub(super) use margins::Margins;
pub(super) use rooms::hops;
pub(super) use tracker::Tracker;

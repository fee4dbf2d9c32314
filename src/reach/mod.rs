//! Reachability: can the player bring about a goal, and how?
//!
//! One loop ([`search`]) owns sampling, simulation, the tree and the budget; what a published planner adds is a small
//! strategy of two methods, in a file of its own. A found path is replayed in the simulator before it is reported.

mod controls;
mod metric;
mod nearest;
mod outcome;
mod problem;
mod region;
mod rrt;
mod search;
mod tree;

pub use controls::{ControlSets, MAX_CONTROLS};
pub use metric::{Coordinate, Metric, Point, Quantity};
pub use nearest::Linear;
pub use outcome::{Outcome, Plan, Statistics, Verdict};
pub use problem::{Problem, Standing};
pub use rrt::Rrt;
pub use search::{Choice, Growth, Limits, Settings, Strategy, reach, search};
pub use tree::{NodeId, Tree};

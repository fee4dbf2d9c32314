//! Questions by names, as the command line and the language server ask them: a world, a goal, an instance become ids, and
//! answers become records. The records are what `--format json` prints. No stage of the compiler needs this module.
//!
//! | file | holds |
//! |---|---|
//! | `refusal` | why a question cannot be asked |
//! | `world` | worlds by name |
//! | `run` | runs of inputs, and what happens in them |
//! | `reach` | questions about what is reached, and their answers |
//! | `without` | what paths are to be without: a predicate, or a button |
//! | `explore` | what a search without a question covers |
//! | `refuted` | a run that refutes the analysis |
//! | `why` | questions about a step, and their answers |
//! | `picture` | pictures of answers and of runs |
//! | `bounds` | the values that each part of a world can have |
//! | `stuck` | where a player gets stuck |
//! | `hash` | hashes of programs |

mod bounds;
mod explore;
mod hash;
mod picture;
mod reach;
mod refusal;
mod refuted;
mod run;
mod stuck;
mod why;
mod without;
mod world;

use std::sync::Arc;

use crate::ir::Program;
use crate::source::SourceMap;

pub use bounds::{
    Border, BoundsResult, Dimensions, End, WorldBounds, borders, bounds_of, bounds_watched, dimensions, goal_reasons,
};
pub use explore::{EdgeResult, Exploration, ModeResult, SpaceResult, TopResult, joined_tops};
pub use hash::{program_sha256, sha256};
pub use picture::{Drawing, RunOutcome, nearest, nodes, plan, recorded, run_svg, search_svg};
pub use reach::{GoalResult, RunResult, WITHOUT, no_goal, read_scripts, targets, unknown};
pub use refusal::Refusal;
pub use refuted::{BeyondResult, Refuted};
pub use run::{Observed, OnState, RunEnd, SimResult, drive};
pub use stuck::{
    StuckAnswer, StuckDrawn, StuckLimits, StuckResult, StuckVerdict, StuckWatches, StuckWay, answer_stuck,
};
pub use why::{Asked, WhyQuestion, WhyResult, answer_why};
pub use without::Without;
pub use world::{find_world, open_world};
#[cfg(feature = "testing")]
pub use {
    bounds::bounds_schema, explore::exploration_schema, reach::reach_schema, run::sim_schema, stuck::stuck_schema,
    why::why_schema,
};

/// A program that compiled, and its files.
pub struct Loaded {
    /// The files.
    pub sources: SourceMap,
    /// The program.
    pub program: Arc<Program>,
}

//! What a change of a program broke: two programs compared by what they say, by how their players move, and by the
//! answers to the same questions.
//!
//! | file | holds |
//! |---|---|
//! | `outline` | a program as named parts, from its syntax trees |
//! | `changes` | the parts that differ between two outlines |
//! | `levels` | the tiles and instances that differ between two compiled worlds |
//! | `flat` | a player alone on flat ground, in a copy of its world |
//! | `figures` | how high, how far and how fast a player is there |
//! | `figure_changes` | the figures that differ |
//! | `divergence` | the first step at which the same inputs lead two programs apart |
//! | `question` | a question asked of both programs |

mod changes;
mod divergence;
mod figure_changes;
mod figures;
mod flat;
mod levels;
mod outline;
mod question;

pub use changes::{Change, ChangeKind, changes};
pub use divergence::{Difference, Divergence, Ended, Happened, RunEnd, Side, diverge};
pub use figure_changes::{FigureChange, PlayerChange, player_changes};
pub use figures::{Figures, Jump, Press, Speed, measure};
pub use levels::{LevelChange, level_changes};
pub use outline::{Part, outline};
pub use question::{Answered, Budget, Class, Compared, Comparison, OldWay, Origin, Version, compare};

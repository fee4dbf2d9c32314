//! The window of each change of a plan: by how much it alone can be too early or too late, found by replays.

use crate::ir::Extremes;
use crate::watch::{Meter, Watch};

use super::jitter::Jitter;
use super::play::{Ending, Nature, Plays};
use super::timeline::{Change, Timeline};
use super::{Course, MAX_WINDOW, Place};

/// One side of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// By at most this number of steps.
    Steps(u32),
    /// By at least this number of steps: no more were tried.
    AtLeast(u32),
    /// By any number of steps: the change cannot come before the search starts, or before the last change of its control.
    Any,
}

impl Side {
    /// The number of steps that are known to be fine.
    pub fn steps(self) -> u32 {
        match self {
            Side::Steps(steps) | Side::AtLeast(steps) => steps,
            Side::Any => u32::MAX,
        }
    }
}

/// A change with its window.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// The change.
    pub change: Change,
    /// The value of its control before it.
    pub before: f64,
    /// How much too early it can be.
    pub early: Side,
    /// How much too late it can be.
    pub late: Side,
    /// The probability of success if only this change has an error.
    pub alone: f64,
    /// Where the first player is then, if all goes as planned; `None` without players.
    pub place: Option<Place>,
}

/// The windows of all changes, in the order of their times; `None` if the watch stops it.
pub(super) fn windows(
    course: &Course<'_>,
    timeline: &Timeline,
    jitter: &Jitter,
    watch: &dyn Watch,
) -> Option<Vec<Window>> {
    let mut plays = Plays::new(course.problem);
    let meter = Meter::new(watch);
    let tried = jitter.tried();
    let checkpoints = course.checkpoints(timeline, &meter)?;
    let mut errors = vec![0; timeline.changes.len()];
    let mut planned = Vec::new();
    timeline.times(&errors, &mut planned);
    let mut found = Vec::with_capacity(timeline.changes.len());
    for (index, change) in timeline.changes.iter().enumerate() {
        let mut last = planned.clone();
        // Whether the target is still reached with an error of this change.
        let mut succeeds = |error: i32, last: &mut Vec<u64>| -> Option<Tried> {
            errors[index] = error;
            timeline.times(&errors, &mut plays.times);
            errors[index] = 0;
            if plays.times == *last {
                return Some(Tried::Same);
            }
            last.clone_from(&plays.times);
            let first = change.step.min(plays.times[index]);
            let from = checkpoints.before(first);
            match plays.play(timeline, from, course.until(timeline), Nature::Planned, &meter) {
                Ending::Reached(_) => Some(Tried::Reached),
                Ending::Over | Ending::Late => Some(Tried::Failed),
                Ending::Stopped => None,
            }
        };
        let mut sides = [Side::Any; 2];
        let mut alone = jitter.probability(0);
        for (side, sign) in sides.iter_mut().zip([-1, 1]) {
            last.clone_from(&planned);
            let (mut is_open, mut was_fine) = (true, true);
            for steps in 1..=tried.max(MAX_WINDOW as i32) {
                if !is_open && steps > tried {
                    break;
                }
                was_fine = match succeeds(sign * steps, &mut last)? {
                    // It is the play before once more, and so are all others.
                    Tried::Same => {
                        let rest: f64 = (steps..=tried).map(|steps| jitter.probability(sign * steps)).sum();
                        alone += if was_fine { rest } else { 0.0 };
                        if is_open {
                            *side = Side::Any;
                        }
                        break;
                    }
                    Tried::Reached => true,
                    Tried::Failed => false,
                };
                if was_fine && steps <= tried {
                    alone += jitter.probability(sign * steps);
                }
                if is_open && !was_fine {
                    (*side, is_open) = (Side::Steps(steps as u32 - 1), false);
                } else if is_open {
                    *side = Side::AtLeast(steps as u32);
                }
            }
        }
        let [early, late] = sides;
        let place = checkpoints.place(change.step);
        let before = timeline.value_before(index);
        found.push(Window { change: *change, before, early, late, alone: alone.least(1.0), place });
    }
    Some(found)
}

/// How a play with one error went.
enum Tried {
    Reached,
    Failed,
    /// It is the same play as the one before.
    Same,
}

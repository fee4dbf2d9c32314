//! Edits of a plan: changes are moved, removed, put off.

use rand::RngExt;
use rand_pcg::Pcg64;

use crate::sim::Control;

use super::timeline::{Change, Timeline};

/// Pauses that are tried, steps.
const PAUSES: [u64; 4] = [10, 20, 40, 80];

/// What a change has to do with failures.
pub(super) struct Cause {
    pub weight: f64,
    /// How late it is in plays that succeed, steps.
    pub late: f64,
}

/// A change, those that have to do with failures more often.
pub(super) fn pick(causes: &[Cause], rng: &mut Pcg64) -> usize {
    let all: f64 = causes.iter().map(|cause| cause.weight).sum();
    let least = 0.3 * all / causes.len() as f64 + f64::MIN_POSITIVE;
    let mut left = rng.random::<f64>() * (all + least * causes.len() as f64);
    let place = causes.iter().position(|cause| {
        left -= cause.weight + least;
        left < 0.0
    });
    place.unwrap_or(causes.len().saturating_sub(1))
}

/// Moves all changes to where they are in plays that succeed.
pub(super) fn follow(plan: &Timeline, causes: &[Cause], gain: f64) -> Timeline {
    let moved = plan.changes.iter().zip(causes).map(|(change, cause)| {
        let by = (cause.late * gain).round() as i64;
        Change { step: change.step.saturating_add_signed(by).max(plan.after), ..*change }
    });
    plan.with(moved.collect(), plan.steps)
}

/// One edit around a change.
pub(super) fn edit(plan: &Timeline, at: usize, rng: &mut Pcg64) -> Timeline {
    let mut changes = plan.changes.clone();
    let Change { control, step, .. } = changes[at];
    let next = (at + 1..changes.len()).find(|other| changes[*other].control == control);
    let by = [1, 1, 2, 3, 5, 8, 13][rng.random_range(0..7)] * if rng.random() { 1 } else { -1 };
    let moved = |change: &Change, by: i64| change.step.saturating_add_signed(by).max(plan.after);
    let mut steps = plan.steps;
    match rng.random_range(0..8) {
        0 | 1 => changes[at].step = moved(&changes[at], by),
        2 => {
            for index in [Some(at), next].into_iter().flatten() {
                changes[index].step = moved(&changes[index], by);
            }
        }
        3 | 4 => {
            // All that comes after, too.
            changes[at..].iter_mut().for_each(|change| change.step = moved(change, by));
            steps = steps.saturating_add_signed(by);
        }
        5 => {
            // Without it, and without what takes it back.
            let gone: Vec<usize> = [Some(at), next].into_iter().flatten().collect();
            changes = changes.into_iter().enumerate().filter(|(i, _)| !gone.contains(i)).map(|(_, c)| c).collect();
        }
        6 => {
            changes.remove(at);
        }
        _ => {
            let pause = PAUSES[rng.random_range(0..PAUSES.len())];
            pause_at(plan, &mut changes, step, pause);
            steps += pause;
        }
    }
    plan.with(changes, steps.max(plan.after + 1))
}

/// Puts in a pause: axes at rest, buttons up, then all as before.
fn pause_at(plan: &Timeline, changes: &mut Vec<Change>, step: u64, pause: u64) {
    let mut held: Vec<Change> = plan.held_before(step);
    held.retain(|change| change.value != 0.0);
    changes.iter_mut().filter(|change| change.step >= step).for_each(|change| change.step += pause);
    let key = changes.iter().map(|change| change.key).max().unwrap_or(0);
    for (change, number) in held.into_iter().zip((1..).step_by(2)) {
        changes.push(Change { step, value: 0.0, key: key + number, ..change });
        let is_changed = |c: &Change| c.control == change.control && c.step == step + pause;
        // What it changes to at the end of the pause counts.
        if !changes.iter().any(is_changed) {
            changes.push(Change { step: step + pause, key: key + number + 1, ..change });
        }
    }
    debug_assert!(changes.iter().all(|c| matches!(c.control, Control::Axis(..)) || c.value == 0.0 || c.value == 1.0));
}

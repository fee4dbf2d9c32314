//! The courses of falls, and how far each has come: what is told apart, and in which course a configuration goes on.

use std::sync::Arc;

use crate::ir::{Extremes, LeafId, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};

/// What is not joined: the modes, the pushes along y, and the phase of the fall.
pub(super) type Course = (Arc<[LeafId]>, Option<[bool; 2]>, Phase);

/// How far a fall has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Phase {
    /// Where it began, and the number of steps since.
    Since(Beginning, u32),
    /// Its modes have changed once since, from one height at one velocity, and it still rises: where it began, after how
    /// many steps they changed, and the number of steps since.
    Turned(Beginning, u32, u32),
    /// Its modes have changed since, at any time, and it falls, or it began at many heights: it is told by its row and its
    /// range of velocities.
    Within(i64, i64),
    /// It goes on at the same velocity (its bits), and is in a row: how long it has lasted does not matter any more.
    Steady(i64, u64),
}

/// Maximum number of steps after which a change of modes is told by its step.
const MAX_TURNS: u32 = 64;
/// Falls that begin this near to each other are not told apart, px.
const ROW: f64 = 8.0;

/// Maximum size of the heights from which falls begin whose steps are counted, px.
const EXACT: f64 = 1.0;
/// Minimum size of a range of velocities, px/s.
const SLOW: f64 = 4.0;
/// Maximum number of pieces into which an interval is cut, and how near to a multiple is at it, as a share of the size.
const MAX_PIECES: i64 = 64;
const CLOSE: f64 = 1e-6;

/// Where falls begin that are not told apart: the row, and whether they rise or fall there.
pub(super) type Beginning = (i64, [bool; 2]);

/// The parts of which each place, height and velocity is one interval.
pub(super) fn single(at: Configuration) -> Vec<Configuration> {
    let mut out = vec![at];
    for (var, degree) in [(VarId::X, 0), (VarId::Y, 0), (VarId::Y, 1), (VarId::Y, 2)] {
        if out.iter().any(|at| at.vars[var][degree].intervals().len() > 1) {
            let parts = |at: Configuration| {
                let all = at.vars[var][degree].intervals().to_vec().into_iter();
                all.map(move |one| {
                    let mut at = at.clone();
                    at.set(var, degree, Values::from(one));
                    at
                })
            };
            out = out.into_iter().flat_map(parts).collect();
        }
    }
    out
}

/// The courses of what a configuration of one becomes in a step (s); it is at a height, and a fall would begin there.
pub(super) fn after(
    (course, at): (&Course, &Configuration),
    (next, y, first): (Configuration, Interval, Beginning),
    (step, is_player): (f64, bool),
) -> Vec<(Course, Configuration)> {
    let is_undisturbed = next.trace.is_some_and(|trace| !trace.is_disturbed);
    let stays = is_undisturbed && stays(at, &next);
    // Where it was pushed to is one of few heights, and so is where it begins to fall from there.
    let is_pushed = course.1 != Some([false; 2]) || pushed(&next) != Some([false; 2]);
    let is_exact = is_pushed && y.high - y.low <= EXACT;
    let steady = steady(at, &next);
    let phase = match course.2 {
        // What stays at its height does not grow older.
        Phase::Since(first, age) if stays => Phase::Since(first, age),
        _ if stays || !is_undisturbed && is_exact => Phase::Since(first, 0),
        _ if !is_undisturbed => return in_rows(&next, y, step, None),
        _ if steady.is_some() => return in_rows(&next, y, step, steady),
        Phase::Since(first, age) if next.leaves == at.leaves => Phase::Since(first, age + 1),
        Phase::Turned(first, turn, age) if next.leaves == at.leaves && rises(&next) => {
            Phase::Turned(first, turn, age + 1)
        }
        Phase::Since(first, age) if is_player && is_thin(&next) && age < MAX_TURNS => Phase::Turned(first, age, 0),
        _ => return in_rows(&next, y, step, None),
    };
    vec![((next.leaves.clone(), pushed(&next), phase), next)]
}

/// Whether a configuration is at one height and has one velocity along y, up to rounding.
fn is_thin(at: &Configuration) -> bool {
    let is = |degree: usize| at.vars[VarId::Y][degree].hull().is_some_and(|hull| hull.high - hull.low <= EXACT);
    is(0) && is(1)
}

/// Whether a configuration may still rise.
fn rises(at: &Configuration) -> bool {
    at.vars[VarId::Y][1].hull().is_some_and(|hull| hull.high >= 0.0)
}

/// Whether a configuration neither rises nor falls on the way to the next.
fn stays(at: &Configuration, next: &Configuration) -> bool {
    let is_still = |at: &Configuration| at.vars[VarId::Y][1].constant() == Some(0.0);
    let [y, later] = [&at.vars[VarId::Y][0], &next.vars[VarId::Y][0]];
    later == y && at.vars[VarId::Y][1] == next.vars[VarId::Y][1] || is_still(at) && is_still(next) && later.is_within(y)
}

/// The velocity along y at which a configuration goes on, if it is the same in the next.
fn steady(at: &Configuration, next: &Configuration) -> Option<f64> {
    let velocity = next.vars[VarId::Y][1].constant()?;
    (at.vars[VarId::Y][1].constant() == Some(velocity)).then_some(velocity)
}

/// A configuration, cut into rows; and into ranges of velocities, if it does not go on at one.
fn in_rows(at: &Configuration, y: Interval, step: f64, steady: Option<f64>) -> Vec<(Course, Configuration)> {
    let Some(velocity) = at.vars[VarId::Y][1].hull() else { return Vec::new() };
    // What a step changes: a range becomes the next one.
    let acceleration = at.vars[VarId::Y][2].constant().map_or(0.0, f64::abs);
    let change = (acceleration * step).greatest(SLOW);
    let velocities = match steady {
        Some(_) => vec![(0, velocity)],
        None => cut(velocity, change),
    };
    let mut out = Vec::new();
    for (row, y) in cut(y, ROW) {
        for (range, velocity) in &velocities {
            let mut at = at.clone();
            at.set(VarId::Y, 0, Values::from(y));
            at.set(VarId::Y, 1, Values::from(*velocity));
            let phase = steady.map_or(Phase::Within(row, *range), |velocity| Phase::Steady(row, velocity.to_bits()));
            out.push(((at.leaves.clone(), pushed(&at), phase), at));
        }
    }
    out
}

/// An interval cut at all multiples of a size, with the number of each piece; whole if there would be too many. What
/// crosses a multiple by rounding only is not cut there.
fn cut(all: Interval, size: f64) -> Vec<(i64, Interval)> {
    // The casts saturate.
    let (first, last) = ((all.low / size + CLOSE).floor() as i64, (all.high / size - CLOSE).floor() as i64);
    let pieces = last.saturating_sub(first);
    if !(1..MAX_PIECES).contains(&pieces) {
        return vec![(first, all)];
    }
    let piece = |number: i64| {
        let low = if number == first { all.low } else { number as f64 * size };
        let high = if number == last { all.high } else { (number + 1) as f64 * size };
        (number, Interval { low, high })
    };
    (first..=last).map(piece).collect()
}

/// The pushes along y of the last step, if they are known.
pub(super) fn pushed(at: &Configuration) -> Option<[bool; 2]> {
    at.trace.map(|trace| trace.pushed)
}

/// Where a fall begins; `None` if the configuration is impossible.
pub(super) fn beginning(at: &Configuration) -> Option<Beginning> {
    let (y, velocity) = (at.vars[VarId::Y][0].hull()?, at.vars[VarId::Y][1].hull()?);
    // The casts saturate.
    let row = |y: f64| (y / ROW).round() as i64;
    Some((row(y.high), [velocity.low < 0.0, velocity.high > 0.0]))
}

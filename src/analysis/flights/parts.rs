//! The configurations of a course: at different places along x, apart from each other.

use crate::ir::{Extremes, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};

/// Maximum number of configurations of a course that are told apart by place.
const MAX_PARTS: usize = 256;
/// In place of the positions that a part has along x.
pub(super) const NOWHERE: Interval = Interval::point(0.0);

/// A configuration at some places of a course.
#[derive(Debug)]
pub(super) struct Part {
    pub x: Interval,
    /// At no place along x: the parts share what else is the same.
    pub at: Configuration,
    /// Whether it is still to be stepped.
    pub is_due: bool,
}

/// A configuration at other places.
pub(super) fn placed(at: &Configuration, x: Interval) -> Configuration {
    let mut at = at.clone();
    at.set(VarId::X, 0, Values::from(x));
    at
}

/// The join of two configurations, with one interval each of heights and velocities.
pub(super) fn joined(a: &Configuration, b: &Configuration) -> Configuration {
    let mut all = a.or(b);
    for var in VarId::XY {
        for degree in 0..3 {
            let hull = all.vars[var][degree].hull().map_or(Values::none(), Values::from);
            all.set(var, degree, hull);
        }
    }
    all
}

/// Whether two configurations are the same.
fn is_same(a: &Configuration, b: &Configuration) -> bool {
    a.shares(b) && a.timers == b.timers && a.spaces == b.spaces && a.trace == b.trace || a == b
}

/// Joins a configuration at some places into the parts of its course, which stay apart; returns whether any is to be
/// stepped.
pub(super) fn overlay(parts: &mut Vec<Part>, x: Interval, found: &Configuration) -> bool {
    // What only touches is apart.
    let is_before = |a: f64, b: f64| if x.is_point() { a < b } else { a <= b };
    let first = parts.partition_point(|part| is_before(part.x.high, x.low));
    let after = parts.partition_point(|part| !is_before(x.high, part.x.low)).max(first);
    let mut new: Vec<Part> = Vec::new();
    let mut from = x.low;
    let mut is_more = false;
    for part in &parts[first..after] {
        let left = |x: Interval| Part { x, at: part.at.clone(), is_due: part.is_due };
        if from < part.x.low {
            let x = Interval { low: from, high: part.x.low };
            new.push(Part { x, at: found.clone(), is_due: true });
            is_more = true;
        }
        let both = Interval { low: from.greatest(part.x.low), high: x.high.least(part.x.high) };
        from = part.x.high;
        if found.is_within(&part.at) {
            new.push(left(part.x));
            continue;
        }
        is_more = true;
        if part.x.low < both.low {
            new.push(left(Interval { low: part.x.low, high: both.low }));
        }
        new.push(Part { x: both, at: joined(&part.at, found), is_due: true });
        if both.high < part.x.high {
            new.push(left(Interval { low: both.high, high: part.x.high }));
        }
    }
    if from < x.high || first == after {
        let x = Interval { low: from, high: x.high };
        new.push(Part { x, at: found.clone(), is_due: true });
        is_more = true;
    }
    if !is_more {
        return false;
    }
    // With its neighbours, of which it may be the rest.
    let (first, after) = (first.saturating_sub(1), (after + 1).min(parts.len()));
    let mut all: Vec<Part> = parts.splice(first..after, []).collect();
    let at = all.partition_point(|part| is_before(part.x.high, x.low));
    let to = all.partition_point(|part| !is_before(x.high, part.x.low)).max(at);
    all.splice(at..to, new);
    all.dedup_by(|next, last| {
        let is_one = next.is_due == last.is_due && next.x.low <= last.x.high && is_same(&next.at, &last.at);
        if is_one {
            last.x = last.x.or(next.x);
        }
        is_one
    });
    parts.splice(first..first, all);
    if parts.len() > MAX_PARTS
        && let Some(x) = parts.iter().map(|part| part.x).reduce(Interval::or)
        && let Some(at) = parts.iter().map(|part| part.at.clone()).reduce(|a, b| joined(&a, &b))
    {
        *parts = vec![Part { x, at, is_due: true }];
    }
    true
}

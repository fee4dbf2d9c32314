//! Colliders as the analysis looks at them: bodies with their boxes, kinds of instances that share them, and where edges
//! meet.

use crate::ir::{Bounds, EntityId, Meeting, Push, Side, SlotId, TagSet};

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::presence::{Cover, Presence};

/// Edges that meet are this near, px: positions are rounded.
pub(in crate::analysis) const ROUNDING: f64 = 1e-6;

/// How far inside of a platform something may have been that comes from above, px; as the simulator has it.
pub(in crate::analysis) const TOLERANCE: f64 = 0.001;
/// How much rounding can shift where edges meet at some coordinates, px.
pub(in crate::analysis) fn rounding(at: f64) -> f64 {
    // What has no end is not rounded there.
    if at.is_finite() { ROUNDING + at.abs() * 1e-12 } else { 0.0 }
}

/// An interval, and what is so near to it that only rounding tells them apart.
pub(in crate::analysis) fn rounded(i: Interval) -> Interval {
    Interval { low: i.low - rounding(i.low), high: i.high + rounding(i.high) }
}

/// A box relative to a position, px: of both axes, from its low to its high end.
pub(in crate::analysis) type Extent = [Interval; 2];

/// A collider of a kind.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Body {
    pub tags: TagSet,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// Its box, where that is always the same.
    pub extent: Option<Extent>,
    /// When it is there; none if more than modes decide that.
    pub presence: Option<Presence>,
    /// Whether it can be there at all, by the leaves that are known to be possible.
    pub is_live: bool,
    /// Whether anything pushes it.
    pub is_pushed: bool,
}

/// Slots whose colliders are the same.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Kind {
    pub entity: EntityId,
    pub slots: Vec<SlotId>,
    pub bodies: Vec<Body>,
    /// Whether something can put an instance inside of what pushes it, or through it.
    pub jumps: bool,
    /// Whether a collider of it that is never pushed can come back after it was away.
    pub appears: bool,
    /// The positions at which an instance can meet anything that never moves.
    pub near: Option<Extent>,
}

/// A body of a kind meets a body of another.
#[derive(Debug, Clone, Copy)]
pub(in crate::analysis) struct Pair {
    pub mine: usize,
    pub kind: usize,
    pub theirs: usize,
    pub meeting: Meeting,
}

/// Where pushes put an instance, along an axis: by the low and by the high side of its colliders, in order.
pub(in crate::analysis) type Edges = [[Vec<Interval>; 2]; 2];

impl Body {
    /// Its size along both axes, px; infinite where it is not always the same.
    pub fn size(&self) -> [f64; 2] {
        self.extent.map_or([f64::INFINITY; 2], |e| e.map(|i| i.high - i.low))
    }
}

impl Kind {
    /// The colliders that are kept out of what blocks.
    pub fn kept_out(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter().filter(|b| b.is_pushed && b.is_live)
    }

    /// Boxes that are kept out of what blocks while the kind is covered: those of colliders that are always there; if there
    /// are none, what lies within all that are there by turns.
    pub fn cores(&self) -> Vec<(TagSet, Extent)> {
        let steady: Vec<_> = self.kept_out().filter(|b| b.presence == Some(Presence::Always)).collect();
        if !steady.is_empty() {
            return steady.into_iter().filter_map(|b| Some((b.tags, b.extent?))).collect();
        }
        let alike = |a: &Body| self.kept_out().all(|b| a.tags == b.tags);
        let Some(first) = self.kept_out().next().filter(|first| alike(first)) else { return Vec::new() };
        let both = |a: Extent, b: Extent| Some([a[0].and(b[0])?, a[1].and(b[1])?]);
        let mut extents = self.kept_out().map(|b| b.extent);
        let within = extents.next().flatten().and_then(|first| extents.try_fold(first, |a, b| both(a, b?)));
        within.map(|within| (first.tags, within)).into_iter().collect()
    }

    /// While which leaves it is kept out of what blocks.
    pub fn cover(&self) -> Cover {
        if self.kept_out().any(|b| b.presence == Some(Presence::Always)) {
            return Cover::Always;
        }
        match self.cores().is_empty() {
            true => Cover::default(),
            false => Cover::While(self.kept_out().filter_map(|b| b.presence.clone()).collect()),
        }
    }
}

/// The place in `Edges` of the pushes by a contact on a side.
pub(in crate::analysis) fn face(side: Side) -> (usize, usize) {
    match side {
        Side::Left => (0, 0),
        Side::Right => (0, 1),
        Side::Below => (1, 0),
        Side::Above => (1, 1),
    }
}

/// The sides on which a meeting can push the first of the two.
pub(in crate::analysis) fn sides_of(meeting: Meeting) -> impl Iterator<Item = Side> {
    let can = move |side: &Side| match meeting.response.push {
        Push::Sense => false,
        Push::Block => true,
        Push::FromAbove => match side {
            Side::Below => meeting.first_on_second,
            Side::Above => meeting.second_on_first,
            Side::Left | Side::Right => false,
        },
    };
    [Side::Left, Side::Right, Side::Below, Side::Above].into_iter().filter(can)
}

pub(in crate::analysis) fn along(bounds: Bounds) -> [(f64, f64); 2] {
    [(bounds.left, bounds.right), (bounds.bottom, bounds.top)]
}

/// Where an instance is while a box of its own meets something from `low` to `high`.
pub(in crate::analysis) fn near(extent: Option<Extent>, axis: usize, (low, high): (f64, f64)) -> Interval {
    extent.map_or(Interval::ALL, |e| rounded(Interval { low: low - e[axis].high, high: high - e[axis].low }))
}

/// Where something from `low` to `high` pushes an instance, by the low end of its box or by the high one.
pub(in crate::analysis) fn edge_at(extent: Extent, axis: usize, end: usize, (low, high): (f64, f64)) -> f64 {
    match end {
        0 => high - extent[axis].low,
        _ => low - extent[axis].high,
    }
}

pub(in crate::analysis) fn edge(extent: Extent, axis: usize, end: usize, sides: (f64, f64)) -> Interval {
    rounded(Interval::point(edge_at(extent, axis, end, sides)))
}

/// Puts intervals in order and joins those that meet.
pub(in crate::analysis) fn disjoin(edges: &mut Vec<Interval>) {
    edges.sort_by(|a, b| a.low.total_cmp(&b.low));
    edges.dedup_by(|next, last| {
        let meets = next.low <= last.high;
        if meets {
            last.high = last.high.max(next.high);
        }
        meets
    });
}

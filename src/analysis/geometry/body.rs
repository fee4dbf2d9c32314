//! Colliders as the analysis models them: bodies with their boxes, kinds of instances that share them, and the
//! positions where pushes end.

use crate::ir::{Bounds, EntityId, Extremes, Meeting, Push, Side, SlotId, TagSet};
use crate::ordered::Ordered;

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::presence::{KeptOut, Presence};

/// Tolerance for touching edges, px: positions are rounded.
pub(in crate::analysis) const ROUNDING: f64 = 1e-6;

/// How deep a body may have been inside a one-way platform that it lands on, px; as in the simulator.
pub(in crate::analysis) const TOLERANCE: f64 = 0.001;
/// Rounding error of touching edges at a coordinate, px.
pub(in crate::analysis) fn rounding(at: f64) -> f64 {
    // Infinite ends are exact.
    if at.is_finite() { ROUNDING + at.abs() * 1e-12 } else { 0.0 }
}

/// An interval, enlarged by the rounding error.
pub(in crate::analysis) fn rounded(i: Interval) -> Interval {
    Interval { low: i.low - rounding(i.low), high: i.high + rounding(i.high) }
}

/// A box relative to a position, px: an interval per axis.
pub(in crate::analysis) type Extent = [Interval; 2];

/// A collider of a kind.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Body {
    pub tags: TagSet,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// Its box, if it is constant.
    pub extent: Option<Extent>,
    /// Whether it is a circle within that box.
    pub is_round: bool,
    /// When it is active; `None` if that depends on more than modes.
    pub presence: Option<Presence>,
    /// Whether it can be active in any of the leaves known to be possible.
    pub is_live: bool,
    /// Whether anything pushes it.
    pub is_pushed: bool,
}

/// Slots with the same colliders.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Kind {
    pub entity: EntityId,
    pub slots: Vec<SlotId>,
    pub bodies: Vec<Body>,
    /// Whether something can place an instance inside an obstacle that pushes it, or beyond it.
    pub can_be_inside: bool,
    /// Whether a collider that is never pushed can be switched on again.
    pub appears: bool,
    /// The positions at which an instance can touch a static obstacle.
    pub near: Option<Extent>,
}

/// A body of one kind that can touch a body of another.
#[derive(Debug, Clone, Copy)]
pub(in crate::analysis) struct Pair {
    pub mine: usize,
    pub kind: usize,
    pub theirs: usize,
    pub meeting: Meeting,
}

/// Where pushes end, per axis: by the low and by the high side of the colliders, in order.
pub(in crate::analysis) type Edges = [[Vec<Interval>; 2]; 2];

impl Body {
    /// Its size along both axes, px; infinite if it is not constant.
    pub fn size(&self) -> [f64; 2] {
        self.extent.map_or([f64::INFINITY; 2], |e| e.map(|i| i.high - i.low))
    }
}

impl Kind {
    /// The colliders that are kept out of blocking obstacles.
    pub fn kept_out(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter().filter(|b| b.is_pushed && b.is_live)
    }

    /// Boxes that are kept out of blocking obstacles while [`Kind::kept_out_while`] holds: those of colliders that are
    /// always active, or else the intersection of all that alternate.
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

    /// The condition under which an instance is kept out of blocking obstacles.
    pub fn kept_out_while(&self) -> KeptOut {
        if self.kept_out().any(|b| b.presence == Some(Presence::Always)) {
            return KeptOut::Always;
        }
        match self.cores().is_empty() {
            true => KeptOut::default(),
            false => KeptOut::While(self.kept_out().filter_map(|b| b.presence.clone()).collect()),
        }
    }
}

/// The indices in `Edges` of pushes by a contact on a side.
pub(in crate::analysis) fn face(side: Side) -> (usize, usize) {
    match side {
        Side::Left => (0, 0),
        Side::Right => (0, 1),
        Side::Below => (1, 0),
        Side::Above => (1, 1),
    }
}

/// The sides on which a contact rule can push the first of the two.
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

/// The positions at which a box of an instance touches the interval from `low` to `high`.
pub(in crate::analysis) fn near(extent: Option<Extent>, axis: usize, (low, high): (f64, f64)) -> Interval {
    extent.map_or(Interval::ALL, |e| rounded(Interval { low: low - e[axis].high, high: high - e[axis].low }))
}

/// The position to which the interval from `low` to `high` pushes an instance, by the low or the high end of its box.
pub(in crate::analysis) fn edge_at(extent: Extent, axis: usize, end: usize, (low, high): (f64, f64)) -> f64 {
    match end {
        0 => high - extent[axis].low,
        _ => low - extent[axis].high,
    }
}

pub(in crate::analysis) fn edge(extent: Extent, axis: usize, end: usize, sides: (f64, f64)) -> Interval {
    rounded(Interval::point(edge_at(extent, axis, end, sides)))
}

/// Sorts intervals and merges those that overlap.
pub(in crate::analysis) fn disjoin(edges: &mut Vec<Interval>) {
    edges.order_by(|a, b| a.low.total_cmp(&b.low));
    edges.dedup_by(|next, last| {
        let meets = next.low <= last.high;
        if meets {
            last.high = last.high.greatest(next.high);
        }
        meets
    });
}

//! What a picture shows of a run, as plain data: the way of each instance that moves, its shape on the way, and the
//! goals that were reached.

use crate::ir::{Bounds, Extremes, SlotId, SpaceId, TagSet};

/// A run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// The players and all instances that move, by the first step of each life.
    pub tracks: Vec<Track>,
    /// What became true on the way, in order.
    pub marks: Vec<Mark>,
    /// What has to be timed on the way, in order.
    pub moments: Vec<Moment>,
}

/// The way of an instance in one life.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Its slot.
    pub slot: SlotId,
    /// Where it was, in order; while it stays at a place there is one stop only.
    pub stops: Vec<Stop>,
    /// Its shape at intervals: the first one, the last one, and after each move by its own size.
    pub poses: Vec<Pose>,
    /// Whether it was destroyed at its last stop.
    pub is_destroyed: bool,
}

/// An instance after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// The number of the step, 0 before the first one.
    pub step: u64,
    /// The space.
    pub space: SpaceId,
    /// The position, px.
    pub at: [f64; 2],
    /// Whether the inputs of its player differ from those of the step before.
    pub changes: bool,
    /// Whether it did not move here, but was put here: by a link or by an edge that sets its position.
    pub jumps: bool,
}

/// The shape of an instance at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// The space.
    pub space: SpaceId,
    /// The position, px.
    pub at: [f64; 2],
    /// The colliders that are there.
    pub parts: Vec<Part>,
}

/// A collider relative to the position, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Its bounding box.
    pub bounds: Bounds,
    /// Whether it is the inscribed circle.
    pub round: bool,
    /// Its tags.
    pub tags: TagSet,
}

/// A goal or a `never` that became true.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Its name.
    pub name: String,
    /// Whether it is a `never`.
    pub is_never: bool,
    /// The first step after which it held.
    pub step: u64,
    /// The time until then, s.
    pub seconds: f64,
}

/// A change of the first player's input that needs timing.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The number of steps before it.
    pub step: u64,
    /// What it is, and how much too early or too late it can be.
    pub words: String,
    /// Whether it is the hardest one.
    pub is_hardest: bool,
}

impl Run {
    /// The ways of a slot.
    pub fn of(&self, slot: SlotId) -> impl Iterator<Item = &Track> {
        self.tracks.iter().filter(move |track| track.slot == slot)
    }
}

impl Track {
    /// Where the instance was after a step, if its way has begun by then.
    pub fn at(&self, step: u64) -> Option<&Stop> {
        let after = self.stops.partition_point(|stop| stop.step <= step);
        self.stops[..after].last()
    }

    /// The largest distance along an axis between two places of one space.
    pub fn extent(&self) -> f64 {
        let mut extent = 0.0f64;
        for run in self.stops.chunk_by(|a, b| a.space == b.space) {
            for axis in 0..2 {
                let along = || run.iter().map(|stop| stop.at[axis]);
                let (low, high) = (along().fold(f64::MAX, f64::least), along().fold(f64::MIN, f64::greatest));
                extent = extent.greatest(high - low);
            }
        }
        extent
    }
}

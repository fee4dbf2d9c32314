//! Reachable regions: boxes of positions, and the obstacles that shape them.

use crate::ir::{Bounds, TagSet};

use crate::analysis::domain::values::{Interval, Values};

/// Maximum number of strips used one by one; above it, only their hull is used.
const MAX_STRIPS: usize = 256;
/// The same for predicates of the world, which are evaluated once per box.
const MAX_BOXES: usize = 1 << 16;

/// Boxes of positions, px.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) struct Region {
    /// In order of their low ends along y, then x.
    strips: Vec<[Interval; 2]>,
    hull: [Interval; 2],
}

impl Region {
    /// `None` if there are no boxes.
    pub fn new(strips: Vec<[Interval; 2]>) -> Option<Region> {
        let hull = strips.iter().copied().reduce(|a, b| [a[0].or(b[0]), a[1].or(b[1])])?;
        Some(Region { strips, hull })
    }

    /// Restricts a position to the region.
    pub fn cut(&self, x: &Values, y: &Values) -> [Values; 2] {
        let cut = [x.within(self.hull[0]), y.within(self.hull[1])];
        let (Some(across), Some(up)) = (cut[0].hull(), cut[1].hull()) else { return cut };
        if self.strips.len() > MAX_STRIPS {
            return cut;
        }
        let meets = |[x, y]: &&[Interval; 2]| x.and(across).is_some() && y.and(up).is_some();
        let within = |axis: usize| Values::any(self.strips.iter().filter(meets).map(|strip| strip[axis]));
        [cut[0].and(&within(0)), cut[1].and(&within(1))]
    }

    /// The boxes, or their hull if there are too many.
    pub fn boxes(&self) -> &[[Interval; 2]] {
        match self.strips.len() > MAX_BOXES {
            true => std::slice::from_ref(&self.hull),
            false => &self.strips,
        }
    }
}

/// A collider of a stationary instance.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) struct Obstacle {
    pub bounds: Bounds,
    pub tags: TagSet,
    /// Whether it is always active.
    pub is_always_present: bool,
}

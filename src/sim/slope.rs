//! Slopes: tiles that are solid up to a line. To a collider, such a tile is its box up to the highest point of the line
//! over the collider. A world without slopes has no tables for them.

use crate::ir::{Bounds, Extremes, Slope, World};

use super::contact::{Rect, TOLERANCE};

/// The slopes of a world.
#[derive(Debug)]
pub(super) struct Slopes {
    /// For each space, for each kind of tile; empty if the map of the space has none.
    of: Vec<Vec<Option<Slope>>>,
}

impl Slopes {
    /// Those of a world; `None` if there are none.
    pub fn of(world: &World) -> Option<Box<Slopes>> {
        let of = |space: &crate::ir::Space| {
            let kinds = space.map.iter().flat_map(|map| &map.kinds);
            let slopes: Vec<Option<Slope>> = kinds.map(|kind| kind.slope).collect();
            if slopes.iter().any(Option::is_some) { slopes } else { Vec::new() }
        };
        let of: Vec<Vec<Option<Slope>>> = world.spaces.iter().map(of).collect();
        of.iter().any(|slopes| !slopes.is_empty()).then(|| Box::new(Slopes { of }))
    }

    /// The slopes of a space, for each kind of tile; empty if it has none.
    pub fn of_space(&self, space: usize) -> &[Option<Slope>] {
        &self.of[space]
    }
}

/// The line of a slope at its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub tile: Bounds,
    pub slope: Slope,
}

impl Line {
    /// How much the line rises to the right, px per px.
    pub fn gradient(&self) -> f64 {
        (self.slope.right - self.slope.left) / (self.tile.right - self.tile.left)
    }

    /// The height of the line at a coordinate, of which the nearest inside of the tile counts.
    fn at(&self, x: f64) -> f64 {
        let Line { tile, slope } = self;
        match () {
            () if x <= tile.left => tile.bottom + slope.left,
            () if x >= tile.right => tile.bottom + slope.right,
            () => tile.bottom + (slope.left + (x - tile.left) * self.gradient()),
        }
    }

    /// The highest point of the line over a box.
    pub fn top(&self, rect: &Rect) -> f64 {
        if self.slope.right > self.slope.left { self.at(rect.right) } else { self.at(rect.left) }
    }

    /// Whether a box is above the line, or above what goes on beside the tile. Beyond the low ends the line goes on as
    /// steeply as it is, or as the slope is that joins it there: `joined` are those gradients to the left and to the
    /// right, upwards to the tile.
    pub fn is_below(&self, rect: &Rect, joined: impl Fn(bool) -> f64) -> bool {
        let Line { tile, slope } = self;
        let height = if rect.right < tile.left {
            let steep = self.gradient().greatest(joined(true)).greatest(0.0);
            tile.bottom + slope.left - steep * (tile.left - rect.right)
        } else if rect.left > tile.right {
            let steep = (-self.gradient()).greatest(joined(false)).greatest(0.0);
            tile.bottom + slope.right - steep * (rect.left - tile.right)
        } else {
            self.top(rect)
        };
        rect.bottom >= height - TOLERANCE
    }

    /// The part of the tile that a box meets.
    pub fn part(&self, rect: &Rect) -> Rect {
        let Bounds { left, right, bottom, .. } = self.tile;
        Rect { left, right, bottom, top: self.top(rect), active: true, ..Rect::default() }
    }

    /// Whether a disc, given by its square, overlaps what is below the line.
    pub fn meets_disc(&self, disc: &Rect) -> bool {
        let radius = (disc.right - disc.left) / 2.0;
        self.distance(disc) < radius * radius
    }

    /// Whether it does by more than the tolerance.
    pub fn takes_disc(&self, disc: &Rect) -> bool {
        (disc.right - disc.left) / 2.0 - self.distance(disc).sqrt() > TOLERANCE
    }

    /// The square of the distance of a disc's centre from what is below the line.
    fn distance(&self, disc: &Rect) -> f64 {
        let (x, y) = ((disc.left + disc.right) / 2.0, (disc.bottom + disc.top) / 2.0);
        let Line { tile: Bounds { left, right, bottom, .. }, slope } = *self;
        if left <= x && x <= right && bottom <= y && y <= self.at(x) {
            return 0.0;
        }
        let corners = [
            (left, bottom),
            (right, bottom),
            (right, bottom + slope.right),
            (left, bottom + slope.left),
            (left, bottom),
        ];
        let mut least = f64::INFINITY;
        for (index, from) in corners.iter().enumerate().take(4) {
            let to = corners[index + 1];
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let length = dx * dx + dy * dy;
            let along = if length > 0.0 { ((x - from.0) * dx + (y - from.1) * dy) / length } else { 0.0 };
            let along = along.clamp(0.0, 1.0);
            let (dx, dy) = (x - (from.0 + along * dx), y - (from.1 + along * dy));
            least = least.least(dx * dx + dy * dy);
        }
        least
    }
}

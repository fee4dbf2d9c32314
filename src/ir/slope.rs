//! Tiles that are solid up to a line only: slopes, and slabs whose line is level.

use super::Extremes;

use serde::{Deserialize, Serialize};

/// The line from the left to the right side of a tile below which the tile is solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Slope {
    /// Its height at the left side of the tile, above the lower edge, px.
    pub left: f64,
    /// Its height at the right side, px.
    pub right: f64,
}

/// Why a line does not divide a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Misfit {
    /// An end lies below the tile or above it.
    Outside,
    /// Nothing of the tile is above it.
    Full,
    /// Nothing of the tile is below it.
    Empty,
}

impl Slope {
    /// What is wrong with the line in a tile of a height, px.
    pub fn misfit(self, height: f64) -> Option<Misfit> {
        let Slope { left, right } = self;
        let is_inside = |y: f64| (0.0..=height).contains(&y);
        match () {
            () if !is_inside(left) || !is_inside(right) => Some(Misfit::Outside),
            () if left == height && right == height => Some(Misfit::Full),
            () if left == 0.0 && right == 0.0 => Some(Misfit::Empty),
            () => None,
        }
    }

    /// The heights of its lower and of its higher end, px.
    pub fn ends(self) -> (f64, f64) {
        (self.left.least(self.right), self.left.greatest(self.right))
    }
}

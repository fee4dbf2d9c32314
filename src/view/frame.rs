//! The transformation from the game to the picture: a rectangle of a space, scaled and flipped, since y points up in
//! the game and down in SVG.

use crate::ir::{Bounds, Extremes};

/// A rectangle of the picture: its upper left corner and its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    /// Whether two rectangles share more than an edge.
    pub fn overlaps(&self, other: &Rect) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }

    /// The square around a point.
    pub fn around([x, y]: [f64; 2], radius: f64) -> Rect {
        Rect { x: x - radius, y: y - radius, width: 2.0 * radius, height: 2.0 * radius }
    }
}

/// The visible part of a space, and its scale.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// The visible part, px of the game.
    pub view: Bounds,
    /// The size of a px of the game in the picture.
    pub scale: f64,
}

impl Frame {
    /// The width in the picture.
    pub fn width(&self) -> f64 {
        (self.view.right - self.view.left) * self.scale
    }

    /// The height in the picture.
    pub fn height(&self) -> f64 {
        (self.view.top - self.view.bottom) * self.scale
    }

    /// A point in the picture.
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.view.left) * self.scale, (self.view.top - y) * self.scale]
    }

    /// Whether a point is in the picture; false for NaN.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        (self.view.left..=self.view.right).contains(&x) && (self.view.bottom..=self.view.top).contains(&y)
    }

    /// The visible part of a line, if any; none if it is not finite.
    pub fn clip(&self, [from, to]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
        let Bounds { left, right, bottom, top } = self.view;
        let (mut first, mut last) = (0.0f64, 1.0f64);
        let ways = [to[0] - from[0], to[1] - from[1]];
        let borders = [(left, right), (bottom, top)];
        for axis in 0..2 {
            let (way, (low, high)) = (ways[axis], borders[axis]);
            if !way.is_finite() {
                return None;
            }
            if way == 0.0 {
                if !(low..=high).contains(&from[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - from[axis]) / way, (high - from[axis]) / way);
            (first, last) = (first.greatest(a.least(b)), last.least(a.greatest(b)));
        }
        let along = |part: f64| [from[0] + part * ways[0], from[1] + part * ways[1]];
        // Ends that are inside stay exactly where they are.
        let (start, end) = (if first > 0.0 { along(first) } else { from }, if last < 1.0 { along(last) } else { to });
        (first <= last).then_some([start, end])
    }

    /// A whole rectangle in the picture.
    pub fn place(&self, b: Bounds) -> Rect {
        let [x, y] = self.point([b.left, b.top]);
        Rect { x, y, width: (b.right - b.left) * self.scale, height: (b.top - b.bottom) * self.scale }
    }

    /// The visible part of a rectangle, if any.
    pub fn cut(&self, b: Bounds) -> Option<Rect> {
        let [left, top] = self.point([b.left.greatest(self.view.left), b.top.least(self.view.top)]);
        let [right, bottom] = self.point([b.right.least(self.view.right), b.bottom.greatest(self.view.bottom)]);
        (left < right && top < bottom).then_some(Rect { x: left, y: top, width: right - left, height: bottom - top })
    }
}

/// The intersection of two rectangles; inverted if it is empty.
pub(super) fn shared(a: Bounds, b: Bounds) -> Bounds {
    Bounds {
        left: a.left.greatest(b.left),
        right: a.right.least(b.right),
        bottom: a.bottom.greatest(b.bottom),
        top: a.top.least(b.top),
    }
}

/// A rectangle with a margin.
pub(super) fn grown(b: Bounds, by: f64) -> Bounds {
    Bounds { left: b.left - by, right: b.right + by, bottom: b.bottom - by, top: b.top + by }
}

/// A translated rectangle.
pub(super) fn moved(b: Bounds, [x, y]: [f64; 2]) -> Bounds {
    Bounds { left: b.left + x, right: b.right + x, bottom: b.bottom + y, top: b.top + y }
}

/// Whether all four sides are numbers in the right order.
pub(super) fn is_proper(b: Bounds) -> bool {
    [b.left, b.right, b.bottom, b.top].iter().all(|side| side.is_finite()) && b.left <= b.right && b.bottom <= b.top
}

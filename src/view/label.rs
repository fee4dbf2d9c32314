//! Placement of names: each beside its subject, where it covers no other name and, if there is room, not the path.

use super::frame::Rect;
use super::svg::{BOLD, Number, escaped, put, text_width};
use crate::ir::Extremes;

/// Font size of names.
pub(super) const SIZE: f64 = 11.0;
const HEIGHT: f64 = 14.0;
/// Distance between a name and its subject.
const GAP: f64 = 3.0;

/// The names of a panel.
#[derive(Debug)]
pub(super) struct Labels {
    size: (f64, f64),
    taken: Vec<Rect>,
    /// Points that names avoid if possible.
    points: Vec<[f64; 2]>,
    out: String,
}

impl Labels {
    /// An empty set for a panel of a width and a height.
    pub fn new(size: (f64, f64), points: Vec<[f64; 2]>) -> Self {
        Labels { size, taken: Vec::new(), points, out: String::new() }
    }

    /// Reserves a rectangle.
    pub fn keep_free(&mut self, place: Rect) {
        self.taken.push(place);
    }

    /// Writes a name beside a rectangle; omits it if there is no room.
    pub fn write(&mut self, class: &str, text: &str, beside: Rect) {
        let is_bold = class.contains(' ') && !class.ends_with("violet");
        let width = text_width(text, SIZE) * if is_bold { BOLD } else { 1.0 };
        let (middle, center) = (beside.x + beside.width / 2.0, beside.y + beside.height / 2.0);
        let (over, under) = (beside.y - GAP - HEIGHT, beside.y + beside.height + GAP);
        let (left, right) = (beside.x - GAP - width, beside.x + beside.width + GAP);
        let row = middle - width / 2.0;
        // A name above a subject at the edge moves inwards.
        let inwards = row.clamp(0.0, (self.size.0 - width).greatest(0.0));
        let corners = [
            [row, over],
            [row, under],
            [right, center - HEIGHT / 2.0],
            [left, center - HEIGHT / 2.0],
            [inwards, over],
            [inwards, under],
            [right, over],
            [left, over],
            [right, under],
            [left, under],
            [inwards, over - HEIGHT],
            [inwards, under + HEIGHT],
        ];
        let places = || corners.iter().map(|&[x, y]| Rect { x, y, width, height: HEIGHT }).filter(|r| self.is_free(r));
        let open = |r: &Rect| !self.points.iter().any(|&point| r.overlaps(&Rect::around(point, 2.0)));
        let Some(place) = places().find(open).or_else(|| places().next()) else { return };
        let (x, y) = (Number(place.x), Number(place.y + HEIGHT - GAP));
        put!(self.out, "<text class=\"{class}\" x=\"{x}\" y=\"{y}\">{}</text>\n", escaped(text));
        self.taken.push(place);
    }

    fn is_free(&self, r: &Rect) -> bool {
        let inside = r.x >= 0.0 && r.y >= 0.0 && r.x + r.width <= self.size.0 && r.y + r.height <= self.size.1;
        inside && !self.taken.iter().any(|taken| taken.overlaps(r))
    }

    /// All names.
    pub fn finish(self) -> String {
        self.out
    }
}

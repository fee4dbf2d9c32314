//! Boxes, their overlaps, and the effect of a blocking contact on a movable body.

use crate::ir::{Bounce, Bounds, Meeting, Push, Side, SlotLayout};

use super::state::{set_triple, triple};

/// Penetration that still counts as outside, px.
pub(super) const TOLERANCE: f64 = 0.001;

/// A box in a space.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rect {
    pub left: f64,
    pub right: f64,
    pub bottom: f64,
    pub top: f64,
    pub active: bool,
    /// The index of its space.
    pub space: u32,
    /// The offset from its position to its position at the start of the continuous phase.
    pub back: (f64, f64),
    /// A circle inside its box; only sensors treat it differently.
    pub round: bool,
}

impl Rect {
    /// The same box, moved by a way, px; its space and where it came from stay.
    pub fn moved(self, [x, y]: [f64; 2]) -> Rect {
        Rect { left: self.left + x, right: self.right + x, bottom: self.bottom + y, top: self.top + y, ..self }
    }

    /// A static box in the space of this one.
    pub fn at(&self, b: &Bounds) -> Rect {
        Rect { left: b.left, right: b.right, bottom: b.bottom, top: b.top, round: false, ..*self }
    }

    /// Whether two boxes overlap or touch, and are in one space.
    #[inline]
    pub fn is_near(&self, other: &Rect) -> bool {
        self.left <= other.right
            && other.left <= self.right
            && self.bottom <= other.top
            && other.bottom <= self.top
            && self.space == other.space
    }
}

/// How velocities into the sides are stopped: 0 if they are not, else one more than the index of the bounce among those
/// of the world, in the order of their strength.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stops {
    pub left: u16,
    pub right: u16,
    pub above: u16,
    pub below: u16,
}

/// The combined effect of the blocking contacts of an instance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Displacement {
    /// The push along x and y, px.
    pub push: [f64; 2],
    /// How its velocity is stopped.
    pub stops: Stops,
}

impl Displacement {
    /// That of an instance without contacts.
    pub const NONE: Displacement =
        Displacement { push: [0.0; 2], stops: Stops { left: 0, right: 0, above: 0, below: 0 } };

    /// Adds a contact: per axis the deepest wins. Touching without overlap has no effect.
    #[inline]
    pub fn add(&mut self, contact: Contact, stop: u16) {
        if contact.depth <= 0.0 {
            return;
        }
        let Displacement { push, stops } = self;
        let (axis, sign, side) = match contact.side {
            Side::Left => (0, 1.0, &mut stops.left),
            Side::Right => (0, -1.0, &mut stops.right),
            Side::Below => (1, 1.0, &mut stops.below),
            Side::Above => (1, -1.0, &mut stops.above),
        };
        let deepest = push[axis].abs();
        // Of two equally deep pushes the one towards larger coordinates wins, independent of the order.
        if contact.depth > deepest || (contact.depth == deepest && sign > 0.0) {
            push[axis] = sign * contact.depth;
        }
        *side = (*side).max(stop);
    }

    /// Moves an instance out of obstacles.
    pub fn push_out(self, state: &mut [u8], layout: &SlotLayout, bounces: &[Bounce]) {
        let Displacement { push, stops } = self;
        let stops = [(stops.left, stops.right), (stops.below, stops.above)];
        for (axis, values) in layout.triples_mut(state, 2).iter_mut().enumerate() {
            let (push, (low, high)) = (push[axis], stops[axis]);
            // A contact that stops a velocity also pushes.
            if push == 0.0 {
                continue;
            }
            let [position, velocity, acceleration] = triple(values);
            let stop = match velocity {
                into_low if into_low < 0.0 => low,
                into_high if into_high > 0.0 => high,
                _ => 0,
            };
            let velocity = match stop {
                0 => velocity,
                1 => 0.0,
                _ => bounces[usize::from(stop) - 1].turned(velocity),
            };
            set_triple(values, [position + push, velocity, acceleration]);
        }
    }
}

/// A contact of two boxes: the side of the first, and the depth, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub side: Side,
    pub depth: f64,
}

/// The overlaps of two boxes per axis, each with the side of the first.
pub(super) struct Overlap {
    x: f64,
    pub x_side: Side,
    y: f64,
    pub y_side: Side,
}

impl Overlap {
    /// `None` if the boxes are apart or touch only in a corner. `back` is the offset to the previous position of the
    /// first, relative to the second: the sides are those from which it came, so that a body that moves less than the
    /// other's size in a step is never pushed out on the far side.
    #[inline]
    pub fn of(a: &Rect, b: &Rect, back: (f64, f64)) -> Option<Overlap> {
        let (right, left) = (a.right - b.left, b.right - a.left);
        let (above, below) = (a.top - b.bottom, b.top - a.bottom);
        if right < 0.0 || left < 0.0 || above < 0.0 || below < 0.0 {
            return None;
        }
        let (x, x_side) = if right + back.0 <= left - back.0 { (right, Side::Right) } else { (left, Side::Left) };
        let (y, y_side) = if above + back.1 <= below - back.1 { (above, Side::Above) } else { (below, Side::Below) };
        if (right == 0.0 || left == 0.0) && (above == 0.0 || below == 0.0) {
            return None;
        }
        Some(Overlap { x, x_side, y, y_side })
    }

    /// Whether the first was separate along both axes before: it came diagonally.
    #[inline]
    pub fn came_diagonally(&self, back: (f64, f64)) -> bool {
        let x = if self.x_side == Side::Right { back.0 } else { -back.0 };
        let y = if self.y_side == Side::Above { back.1 } else { -back.1 };
        self.x + x <= TOLERANCE && self.y + y <= TOLERANCE
    }

    #[inline]
    pub fn horizontal(&self) -> Contact {
        Contact { side: self.x_side, depth: self.x }
    }

    #[inline]
    pub fn vertical(&self) -> Contact {
        Contact { side: self.y_side, depth: self.y }
    }

    /// The contact along the axis of least penetration; ties are vertical.
    #[inline]
    pub fn least(&self) -> Contact {
        if self.x < self.y { self.horizontal() } else { self.vertical() }
    }
}

/// The contact of two colliders, if they touch. `covered` tells whether a neighbour covers the left or right face
/// turned to the first, and the same for the upper or lower face.
#[inline]
pub(super) fn meet(
    a: &Rect,
    b: &Rect,
    back: (f64, f64),
    meeting: Meeting,
    covered: impl FnOnce(&Overlap) -> (bool, bool),
) -> Option<Contact> {
    let overlap = Overlap::of(a, b, back)?;
    match meeting.response.push {
        Push::FromAbove => {
            // The previous position of the first, relative to the second.
            let below = (b.top - (a.bottom + back.1), Side::Below, b.top - a.bottom);
            let above = ((a.top + back.1) - b.bottom, Side::Above, a.top - b.bottom);
            let sides = [(meeting.first_on_second, below), (meeting.second_on_first, above)];
            let mut held = sides.into_iter().filter(|(may, (was, ..))| *may && *was <= TOLERANCE);
            held.next().map(|(_, (_, side, depth))| Contact { side, depth })
        }
        Push::Sense if (a.round || b.round) && !circles_meet(a, b) => None,
        Push::Block | Push::Sense => Some(match covered(&overlap) {
            (true, false) => overlap.vertical(),
            (false, true) => overlap.horizontal(),
            _ => overlap.least(),
        }),
    }
}

/// Whether two shapes touch of which at least one is a circle; touching only the corner of a box does not count.
fn circles_meet(a: &Rect, b: &Rect) -> bool {
    let (circle, other) = if a.round { (a, b) } else { (b, a) };
    let centre = |r: &Rect| ((r.left + r.right) / 2.0, (r.bottom + r.top) / 2.0);
    let (x, y) = centre(circle);
    let radius = (circle.right - circle.left) / 2.0;
    if other.round {
        let (ox, oy) = centre(other);
        let both = radius + (other.right - other.left) / 2.0;
        return (x - ox) * (x - ox) + (y - oy) * (y - oy) <= both * both;
    }
    let (dx, dy) = (x - x.clamp(other.left, other.right), y - y.clamp(other.bottom, other.top));
    let distance = dx * dx + dy * dy;
    distance < radius * radius || (distance == radius * radius && (dx == 0.0 || dy == 0.0))
}

/// Whether two shapes of which at least one is a circle overlap by more than the tolerance.
pub(super) fn sinks_in(a: &Rect, b: &Rect) -> bool {
    let (circle, other) = if a.round { (a, b) } else { (b, a) };
    let centre = |r: &Rect| ((r.left + r.right) / 2.0, (r.bottom + r.top) / 2.0);
    let (x, y) = centre(circle);
    let radius = (circle.right - circle.left) / 2.0;
    let (dx, dy, reach) = if other.round {
        let (ox, oy) = centre(other);
        (x - ox, y - oy, radius + (other.right - other.left) / 2.0)
    } else {
        (x - x.clamp(other.left, other.right), y - y.clamp(other.bottom, other.top), radius)
    };
    reach - (dx * dx + dy * dy).sqrt() > TOLERANCE
}

#[inline]
pub(super) fn opposite(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    }
}

//! Spaces that wrap: positions are brought in, and boxes, rectangles and tiles are also seen from the other side of the
//! seam, one period away. A world without such spaces has no [`Seams`] and asks for nothing here.

use std::ops::Range;

use crate::ir::{Extremes, Id, Period, Solid, Space, SpaceId, TagId, TileMap, VarId, World};
use crate::watch::Meter;

use super::broad_phase::{BroadPhase, PAIRS_PER_BOX, Sweep};
use super::collision::{Collision, Scratch};
use super::contact::Rect;
use super::simulator::Simulator;

/// What repeats in each space of a world.
#[derive(Debug)]
pub(super) struct Seams {
    periods: Vec<[Option<Period>; 2]>,
}

impl Seams {
    /// `None` if no space wraps.
    pub fn of(world: &World) -> Option<Seams> {
        let periods: Vec<_> = world.spaces.iter().map(|space| space.periods).collect();
        periods.iter().any(|of| *of != [None; 2]).then_some(Seams { periods })
    }

    /// What repeats in a space.
    pub fn periods(&self, space: usize) -> [Option<Period>; 2] {
        self.periods.get(space).copied().unwrap_or_default()
    }

    /// The shortest of the ways in a space that lead as far as this one, px.
    pub fn shortest(&self, space: SpaceId, way: [f64; 2]) -> [f64; 2] {
        let periods = self.periods(space.index());
        [0, 1].map(|axis| periods[axis].map_or(way[axis], |period| period.shortest(way[axis])))
    }
}

/// The rectangles of a space, with those that are seen beyond a seam: one is repeated from two periods before its place
/// between the borders to one after it. It is no longer than a period, and no collider reaches farther than half of it.
pub(super) fn solids(space: &Space) -> Vec<Solid> {
    let mut all = space.solids.clone();
    for (axis, period) in space.periods.into_iter().enumerate() {
        let Some(period) = period else { continue };
        let repeated = |solid: &Solid| {
            let low = if axis == 0 { solid.bounds.left } else { solid.bounds.bottom };
            let first = ((low - period.low) / period.size()).floor();
            let solid = solid.clone();
            [-2.0, -1.0, 0.0, 1.0].map(|turns| {
                let (way, mut solid) = ((turns - first) * period.size(), solid.clone());
                let (low, high) = match axis {
                    0 => (&mut solid.bounds.left, &mut solid.bounds.right),
                    _ => (&mut solid.bounds.bottom, &mut solid.bounds.top),
                };
                *low += way;
                *high += way;
                solid
            })
        };
        all = all.iter().flat_map(repeated).collect();
    }
    all
}

/// The columns and the rows of a map, and those that are seen beyond a seam.
#[derive(Debug, Clone)]
pub(super) struct Around {
    pub columns: Range<i64>,
    pub rows: Range<i64>,
    wraps: [bool; 2],
}

impl Around {
    pub fn new(space: &Space, map: &TileMap<TagId>) -> Around {
        let around = |count: usize, wraps: bool| {
            let count = count as i64;
            if wraps { -count..2 * count } else { 0..count }
        };
        let wraps = space.periods.map(|period| period.is_some());
        Around { columns: around(map.columns, wraps[0]), rows: around(map.rows, wraps[1]), wraps }
    }

    /// The cell of the map that is seen at a column and a row; `None` outside.
    pub fn cell(&self, map: &TileMap<TagId>, column: i64, row: i64) -> Option<usize> {
        let inside = |at: i64, count: usize, wraps: bool| {
            let at = if wraps { at.rem_euclid((count as i64).max(1)) } else { at };
            usize::try_from(at).ok().filter(|at| *at < count)
        };
        let (column, row) = (inside(column, map.columns, self.wraps[0])?, inside(row, map.rows, self.wraps[1])?);
        Some(row * map.columns + column)
    }
}

/// The boxes that are seen beyond a seam, and for each the body.
#[derive(Debug, Clone, Default)]
pub(super) struct Images {
    /// Space for all boxes with their images.
    rects: Vec<Rect>,
    bodies: Vec<u32>,
}

/// Images of a box beyond the seams of both axes: each pair of boxes is seen once.
pub(super) const MAX_IMAGES: usize = 4;

impl Images {
    /// With capacity for the images of a number of boxes.
    pub fn for_boxes(count: usize) -> Images {
        Images { rects: Vec::with_capacity((1 + MAX_IMAGES) * count), bodies: Vec::with_capacity(MAX_IMAGES * count) }
    }

    /// Collects all boxes, then the images that another box can touch.
    fn collect(&mut self, seams: &Seams, boxes: &[Rect]) {
        self.rects.clear();
        self.bodies.clear();
        let wraps = |rect: &&Rect| rect.active && seams.periods(rect.space as usize) != [None; 2];
        let mut hull = Rect { left: f64::INFINITY, right: f64::NEG_INFINITY, ..Rect::default() };
        (hull.bottom, hull.top) = (hull.left, hull.right);
        for rect in boxes.iter().filter(wraps) {
            hull.left = hull.left.least(rect.left);
            hull.right = hull.right.greatest(rect.right);
            hull.bottom = hull.bottom.least(rect.bottom);
            hull.top = hull.top.greatest(rect.top);
        }
        self.rects.extend_from_slice(boxes);
        for (body, rect) in boxes.iter().enumerate().filter(|(_, rect)| wraps(rect)) {
            let [x, y] = seams.periods(rect.space as usize).map(|period| period.map(Period::size));
            let ways = match (x, y) {
                (Some(x), Some(y)) => [Some([x, 0.0]), Some([0.0, y]), Some([x, y]), Some([x, -y])],
                (Some(x), None) => [Some([x, 0.0]), None, None, None],
                (None, Some(y)) => [Some([0.0, y]), None, None, None],
                (None, None) => [None; MAX_IMAGES],
            };
            for image in ways.into_iter().flatten().map(|way| rect.moved(way)) {
                if image.left <= hull.right && image.bottom <= hull.top && hull.bottom <= image.top {
                    self.rects.push(image);
                    self.bodies.push(body as u32);
                }
            }
        }
    }
}

impl Collision {
    /// Whether two bodies are of two instances and a rule pairs them.
    fn can_meet(&self, i: usize, j: usize) -> bool {
        let (a, b) = (&self.bodies[i], &self.bodies[j]);
        a.slot != b.slot && self.kinds[a.kind].sets[b.set].is_some()
    }

    /// Whether a body can meet any other with an effect.
    fn meets_any(&self, body: usize) -> bool {
        match &self.broad_phase {
            BroadPhase::Listed(_) => true,
            BroadPhase::Kinds(kinds) => kinds.meets[self.bodies[body].set],
        }
    }
}

impl Simulator {
    /// Brings all positions between the borders of their spaces, and where the instances began as far along with them.
    #[cold]
    pub(super) fn bring_in(&self, seams: &Seams, state: &mut [u8], start: &mut [(f64, f64)]) {
        for (at, actor) in self.actors.iter().enumerate() {
            let layout = &actor.layout;
            if !layout.alive(state) {
                continue;
            }
            let periods = seams.periods(layout.space(state).index());
            for (axis, period) in periods.into_iter().enumerate() {
                let Some(period) = period else { continue };
                let var = VarId::XY[axis];
                let position = layout.var(state, var, 0);
                let inside = period.wrapped(position);
                if inside != position {
                    layout.set_var(state, var, 0, inside);
                    let from = &mut start[at];
                    *(if axis == 0 { &mut from.0 } else { &mut from.1 }) += inside - position;
                }
            }
        }
    }

    /// Handles each pair of bodies that are near each other across a seam, the lower index first.
    #[cold]
    pub(super) fn collide_across(&self, seams: &Seams, state: &mut [u8], scratch: &mut Scratch, meter: &Meter<'_>) {
        let Scratch { boxes, sweep, displacements, images, work, .. } = scratch;
        images.collect(seams, boxes);
        let visit = |pair, rects: [&Rect; 2]| self.pair(state, pair, rects, displacements);
        *work = work.wrapping_add(self.pairs_across(images, boxes.len(), sweep, meter, visit) as u64);
    }

    /// Calls `visit` with each pair of a box and the image of another body's; there are `count` boxes. Returns the number
    /// of comparisons.
    fn pairs_across(
        &self,
        Images { rects, bodies: owners }: &Images,
        count: usize,
        sweep: &mut Sweep,
        meter: &Meter<'_>,
        mut visit: impl FnMut((usize, usize), [&Rect; 2]),
    ) -> usize {
        let seen = owners.len();
        if seen == 0 {
            return count;
        }
        let mut pair = |i: usize, image: usize| {
            let j = owners[image - count] as usize;
            if !self.collision.can_meet(i, j) {
                return;
            }
            match i < j {
                true => visit((i, j), [&rects[i], &rects[image]]),
                false => visit((j, i), [&rects[image], &rects[i]]),
            }
        };
        let is_listed = matches!(self.collision.broad_phase, BroadPhase::Listed(_));
        if is_listed || count * seen <= (count + seen) * PAIRS_PER_BOX {
            for image in count..count + seen {
                for i in (0..count).filter(|i| rects[*i].active && rects[*i].is_near(&rects[image])) {
                    pair(i, image);
                }
            }
            return count * seen;
        }
        let body_of = |at: usize| if at < count { at } else { owners[at - count] as usize };
        let meets = |at: usize| self.collision.meets_any(body_of(at));
        sweep.pairs(rects, meets, meter, |i, j| {
            if i < count && j >= count {
                pair(i, j);
            }
        })
    }
}

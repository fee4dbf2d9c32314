//! Adjacent rectangles and tiles form one surface, so a face that a neighbour covers gives no side to a contact.
//!
//! A face matters only where a body touches it, and only in the part beside the body. It is covered if obstacles that
//! block the same body lie along all of that part, directly outside of it. Which rectangles have adjacent ones, and
//! which tiles have adjacent rectangles, is precomputed: all others cost nothing.

use crate::ir::{Bounds, Extremes, Push, Side, Slope, Solid, Space, SpaceId, TagId, TileMap};
use crate::watch::Meter;

use super::collision::{Body, Kind};
use super::contact::{Contact, Displacement, Overlap, Rect, TOLERANCE};
use super::encounter::Encounter;
use super::seam::Around;
use super::simulator::Simulator;

/// Adjacent static obstacles of a space.
#[derive(Debug)]
pub(super) struct Adjacency {
    /// For each rectangle, whether another one touches or overlaps it.
    rects: Vec<bool>,
    /// For each cell of the map, whether a rectangle is near; empty if there are no rectangles.
    cells: Vec<bool>,
}

/// The part of a face beside a body.
#[derive(Debug, Clone, Copy)]
struct Face {
    /// Whether it is a left or right face.
    is_vertical: bool,
    /// Its coordinate across, px.
    at: f64,
    /// Whether it faces larger coordinates.
    faces_up: bool,
    /// Its extent along, px.
    low: f64,
    high: f64,
}

impl Adjacency {
    /// Those of a space with these rectangles.
    pub fn new(space: &Space, solids: &[Solid]) -> Self {
        let near = |map: &TileMap<TagId>| map.cells_near(solids.iter().map(|solid| solid.bounds), TOLERANCE);
        Adjacency { rects: with_neighbours(solids), cells: space.map.as_ref().map(near).unwrap_or_default() }
    }
}

/// For each rectangle, whether another one touches or overlaps it: a sweep from left to right, and one back, over the
/// maximum reach at each height.
fn with_neighbours(solids: &[Solid]) -> Vec<bool> {
    let bounds = |at: usize| solids[at].bounds;
    let mut order: Vec<usize> = (0..solids.len()).collect();
    order.sort_by(|a, b| bounds(*a).left.total_cmp(&bounds(*b).left));
    let ends = |at: usize| (bounds(at).bottom, bounds(at).top + TOLERANCE);
    let mut heights: Vec<f64> = order.iter().flat_map(|at| [ends(*at).0, ends(*at).1]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let rank = |at: f64| heights.partition_point(|h| *h < at);
    let ranks = |at: usize| (rank(ends(at).0), rank(ends(at).1) + 1);
    let mut found = vec![false; order.len()];
    let (mut before, mut after) = (MaxTree::new(heights.len()), MaxTree::new(heights.len()));
    for &at in &order {
        found[at] |= before.within(ranks(at)) >= bounds(at).left;
        before.raise(ranks(at), bounds(at).right + TOLERANCE);
    }
    for &at in order.iter().rev() {
        found[at] |= -after.within(ranks(at)) <= bounds(at).right + TOLERANCE;
        after.raise(ranks(at), -bounds(at).left);
    }
    found
}

/// A segment tree with range updates and range queries of the maximum.
struct MaxTree {
    /// For each node, the maximum given to its whole range, and the maximum given to any part.
    nodes: Vec<(f64, f64)>,
}

impl MaxTree {
    fn new(places: usize) -> Self {
        MaxTree { nodes: vec![(f64::NEG_INFINITY, f64::NEG_INFINITY); 2 * places.next_power_of_two()] }
    }

    /// Calls `visit` with the nodes that form a range, and with their ancestors, which extend beyond it.
    fn cover(
        &mut self,
        (node, span): (usize, (usize, usize)),
        range: (usize, usize),
        visit: &mut impl FnMut(&mut (f64, f64), bool),
    ) {
        if range.1 <= span.0 || span.1 <= range.0 {
            return;
        }
        let is_whole = range.0 <= span.0 && span.1 <= range.1;
        visit(&mut self.nodes[node], is_whole);
        if !is_whole {
            let middle = usize::midpoint(span.0, span.1);
            self.cover((2 * node, (span.0, middle)), range, visit);
            self.cover((2 * node + 1, (middle, span.1)), range, visit);
        }
    }

    fn root(&self) -> (usize, (usize, usize)) {
        (1, (0, self.nodes.len() / 2))
    }

    fn raise(&mut self, range: (usize, usize), to: f64) {
        self.cover(self.root(), range, &mut |(all, any), is_whole| {
            *any = any.greatest(to);
            if is_whole {
                *all = all.greatest(to);
            }
        });
    }

    /// The maximum over a range.
    fn within(&mut self, range: (usize, usize)) -> f64 {
        let mut greatest = f64::NEG_INFINITY;
        self.cover(self.root(), range, &mut |(all, any), is_whole| {
            greatest = greatest.greatest(if is_whole { *any } else { *all });
        });
        greatest
    }
}

impl Face {
    /// The vertical and the horizontal face of a box that are turned to a body.
    fn turned(body: &Rect, other: &Rect, overlap: &Overlap) -> [Face; 2] {
        let (left, right) = (body.left.greatest(other.left), body.right.least(other.right));
        let (bottom, top) = (body.bottom.greatest(other.bottom), body.top.least(other.top));
        let (across, up) = (overlap.x_side != Side::Right, overlap.y_side != Side::Above);
        let at = |faces_up: bool, low: f64, high: f64| if faces_up { high } else { low };
        [
            Face {
                is_vertical: true,
                at: at(across, other.left, other.right),
                faces_up: across,
                low: bottom,
                high: top,
            },
            Face { is_vertical: false, at: at(up, other.bottom, other.top), faces_up: up, low: left, high: right },
        ]
    }

    /// The interval of the face's line that a box covers, if it lies directly outside.
    fn covered_by(&self, b: &Bounds) -> Option<(f64, f64)> {
        let (across, along) = match self.is_vertical {
            true => ((b.left, b.right), (b.bottom, b.top)),
            false => ((b.bottom, b.top), (b.left, b.right)),
        };
        let is_outside = match self.faces_up {
            true => across.0 <= self.at + TOLERANCE && across.1 > self.at + TOLERANCE,
            false => across.1 >= self.at - TOLERANCE && across.0 < self.at - TOLERANCE,
        };
        is_outside.then_some(along)
    }
}

/// The part of a face that is known to be covered, from its low end on.
struct CoveredPart {
    /// Its high end, px.
    reach: f64,
    /// Whether any obstacle is there.
    is_met: bool,
}

impl CoveredPart {
    /// Adds an interval of the face's line; returns whether all of the face is covered now.
    fn add(&mut self, (low, high): (f64, f64), face: &Face) -> bool {
        if low <= self.reach + TOLERANCE && high >= self.reach - TOLERANCE {
            self.is_met = true;
            self.reach = self.reach.greatest(high);
        }
        self.is_met && self.reach >= face.high - TOLERANCE
    }
}

impl Simulator {
    /// Whether neighbours cover the vertical and the horizontal face turned to a body, as far as it matters: the face
    /// along which the overlap is least, and the other one if that is covered. Means nothing once the meter has stopped
    /// the work.
    pub(super) fn covered(
        &self,
        state: &[u8],
        (kind, space): (&Kind, usize),
        (body, other): (&Rect, &Rect),
        overlap: &Overlap,
        by_neighbour: (bool, bool),
        meter: &Meter<'_>,
    ) -> (bool, bool) {
        let [vertical, horizontal] = Face::turned(body, other, overlap);
        let beside = || by_neighbour.0 || self.is_covered(state, kind, space, vertical, meter);
        let over = || by_neighbour.1 || self.is_covered(state, kind, space, horizontal, meter);
        match matches!(overlap.least().side, Side::Left | Side::Right) {
            true if beside() => (true, over()),
            true => (false, false),
            false if over() => (beside(), true),
            false => (false, false),
        }
    }

    /// A body that entered a corner is pushed out as if it had touched both of its neighbours.
    #[inline]
    pub(super) fn corner_contact(
        &self,
        body: &Body,
        with: &Encounter,
        corner: Option<[Contact; 2]>,
        displacement: &mut Displacement,
    ) {
        let Some([horizontal, vertical]) = corner else { return };
        if with.meeting.response.push == Push::Block && !body.kinematic {
            displacement.add(horizontal, with.stop);
            displacement.add(vertical, with.stop);
        }
    }

    /// Whether what blocks covers a part of the left or right side of a tile; `at` is its coordinate, with whether it
    /// faces larger ones.
    pub(super) fn is_side_covered(
        &self,
        state: &[u8],
        (kind, space): (&Kind, usize),
        (at, faces_up): (f64, bool),
        (low, high): (f64, f64),
        meter: &Meter<'_>,
    ) -> bool {
        self.is_covered(state, kind, space, Face { is_vertical: true, at, faces_up, low, high }, meter)
    }

    /// The line of a kind of tile, if it is a slope.
    fn slope_of(&self, space: usize, kind: usize) -> Option<Slope> {
        *self.collision.slopes.as_ref()?.of_space(space).get(kind)?
    }

    /// Whether anything can cover the faces of a rectangle.
    pub(super) fn can_be_covered(&self, (kind, space): (&Kind, usize), solid: usize) -> bool {
        self.collision.adjacency[space].rects[solid] || kind.meets_tiles[space]
    }

    /// Whether a rectangle can cover the faces of the tile of a cell.
    pub(super) fn is_beside_rect(&self, space: usize, cell: usize) -> bool {
        self.collision.adjacency[space].cells.get(cell).copied().unwrap_or(false)
    }

    #[cold]
    fn is_covered(&self, state: &[u8], kind: &Kind, space: usize, face: Face, meter: &Meter<'_>) -> bool {
        if meter.is_stopped() {
            return false;
        }
        let blocks = |met: &Option<Encounter>| met.is_some_and(|w| w.meeting.response.push == Push::Block);
        let table = &self.world().spaces[SpaceId(space as u32)];
        let mut part = CoveredPart { reach: face.low, is_met: false };
        loop {
            let before = part.reach;
            // Among many rectangles at one place, this search is what a step spends its time on.
            let mut looked_at = 0;
            for (solid, met) in self.collision.solids[space].iter().zip(&kind.solids[space]) {
                looked_at += 1;
                if blocks(met) && face.covered_by(&solid.bounds).is_some_and(|along| part.add(along, &face)) {
                    meter.spend(looked_at);
                    return true;
                }
            }
            if let Some(map) = table.map.as_ref().filter(|_| kind.meets_tiles[space]) {
                let (across, along) = match face.is_vertical {
                    true => ((map.tile.0, map.columns), (map.tile.1, map.rows)),
                    false => ((map.tile.1, map.rows), (map.tile.0, map.columns)),
                };
                let around = Around::new(table, map);
                // The cells directly outside the face and beside the body.
                let line = match face.faces_up {
                    true => ((face.at + TOLERANCE) / across.0).floor(),
                    false => ((face.at - TOLERANCE) / across.0).ceil() - 1.0,
                };
                let [lines, cells] = match face.is_vertical {
                    true => [&around.columns, &around.rows],
                    false => [&around.rows, &around.columns],
                };
                let cut = |at: f64| (at / along.0).floor().clamp((cells.start - 1) as f64, cells.end as f64) as i64;
                if line >= lines.start as f64 && line < lines.end as f64 {
                    for nth in (cut(face.low) - 1).max(cells.start)..(cut(face.high) + 1).min(cells.end) {
                        looked_at += 1;
                        let (column, row) = if face.is_vertical { (line as i64, nth) } else { (nth, line as i64) };
                        let cell = around.cell(map, column, row);
                        let is_blocking = cell.is_some_and(|cell| {
                            let tile = usize::from(map.cells[cell]);
                            blocks(&kind.tiles[space][tile]) && !self.is_gone(state, space, cell)
                        });
                        let (low, high) = (nth as f64 * along.0, (nth + 1) as f64 * along.0);
                        let slope = cell.and_then(|cell| self.slope_of(space, usize::from(map.cells[cell])));
                        // A slope covers what is beside it up to its line, and nothing above or below.
                        let high = match slope {
                            None => high,
                            Some(_) if !face.is_vertical => continue,
                            Some(slope) => low + if face.faces_up { slope.left } else { slope.right },
                        };
                        if is_blocking && high > low && part.add((low, high), &face) {
                            meter.spend(looked_at);
                            return true;
                        }
                    }
                }
            }
            if meter.spend(looked_at) || part.reach <= before {
                return false;
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::ir::TagSet;

    proptest! {
        #[test]
        fn neighbours_are_those_that_touch_or_overlap(
            boxes in prop::collection::vec((0..40i8, 0..40i8, 1..9i8, 1..9i8), 0..24)
        ) {
            let solid = |(x, y, width, height): &(i8, i8, i8, i8)| {
                let (left, bottom) = (f64::from(*x), f64::from(*y));
                let bounds = Bounds { left, bottom, right: left + f64::from(*width), top: bottom + f64::from(*height) };
                Solid { bounds, tags: TagSet::default() }
            };
            let solids: Vec<Solid> = boxes.iter().map(solid).collect();
            let meets = |a: &Bounds, b: &Bounds| {
                a.left <= b.right && b.left <= a.right && a.bottom <= b.top && b.bottom <= a.top
            };
            let slow: Vec<bool> = (0..boxes.len())
                .map(|a| (0..boxes.len()).any(|b| a != b && meets(&solids[a].bounds, &solids[b].bounds)))
                .collect();
            prop_assert_eq!(with_neighbours(&solids), slow);
        }
    }
}

//! Scans all static obstacles of a space for the contacts that a kind can have and the ends of its pushes.

use std::collections::BTreeSet;

use crate::ir::{Bounds, Extremes, Id, Meeting, Push, Side, Slope, SpaceId, TagSet};

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::{Body, Kind, along, disjoin, edge, face, near, rounding, sides_of};
use crate::analysis::geometry::placement::{PlacedColliders, Placement};
use crate::analysis::geometry::statics::Statics;
use crate::analysis::geometry::tiles::Tiles;

use super::Scene;

impl Scene<'_> {
    /// Scans all static obstacles; incomplete if the meter runs out.
    pub fn scan_statics(&self, kind: &Kind, space: SpaceId) -> Statics {
        let (world, entity) = (self.world, &self.program.entities[kind.entity]);
        let mut out = Statics::default();
        let tiles = Tiles::new(world, space);
        let solids = &world.spaces[space].solids;
        // Many tiles have the same tags.
        let tags: BTreeSet<TagSet> = tiles.tags.iter().copied().chain(solids.iter().map(|s| s.tags)).collect();
        for touch in entity.touches.iter() {
            let asking: Vec<&Body> = kind.bodies.iter().filter(|b| b.is_live && b.tags.meets(touch.mine)).collect();
            let mut places = [Vec::new(), Vec::new()];
            let mut pushed = true;
            for (body, tags) in asking.iter().flat_map(|b| tags.iter().map(move |t| (b, *t))) {
                let Some(meeting) = world.meeting(body.tags, tags) else { continue };
                if touch.bound && !touch.tiles || !tags.meets(TagSet::of(touch.other)) {
                    continue;
                }
                pushed &= meeting.response.push != Push::Sense && !body.kinematic;
                if self.meter.spend(solids.len() as u64) {
                    return out;
                }
                let boxes = solids.iter().filter(|s| s.tags == tags).map(|s| along(s.bounds));
                let (columns, rows) = tiles.lines(|at| tiles.tag(at) == tags, &self.meter);
                let lines = [columns, rows];
                for (axis, places) in places.iter_mut().enumerate() {
                    let lines = lines[axis].iter().copied().chain(boxes.clone().map(|b| b[axis]));
                    places.extend(lines.map(|(low, high)| near(body.extent, axis, (low, high))));
                }
            }
            places.iter_mut().for_each(disjoin);
            out.places.push(places);
            out.pushed.push(pushed);
        }
        for body in kind.bodies.iter().filter(|b| !b.kinematic && b.is_live) {
            if self.meter.spend(solids.len() as u64) {
                return out;
            }
            self.pushes(body, space, &tiles, &mut out);
        }
        out.edges.iter_mut().chain(&mut out.faces).flatten().for_each(disjoin);
        out
    }

    /// Adds the static obstacles that push a body.
    fn pushes(&self, body: &Body, space: SpaceId, tiles: &Tiles<'_>, out: &mut Statics) {
        let pushing = |t: TagSet| self.world.meeting(body.tags, t).filter(|m| m.response.push != Push::Sense);
        let own = body.size();
        let mut met = |meeting: Meeting, sizes: [f64; 2]| {
            out.pushes = true;
            out.stops |= meeting.response.stop;
            out.slips |= !meeting.response.stop;
            out.bounces.extend(Some(meeting.response.bounce).filter(|bounce| !bounce.is_none()));
            out.anywhere |= body.extent.is_none();
            out.is_steady &= body.presence.is_some();
            for axis in 0..2 {
                out.thinnest[axis] = out.thinnest[axis].least(sizes[axis]);
                out.longest[axis] = out.longest[axis].greatest(sizes[axis] + own[axis]);
            }
        };
        for solid in &self.world.spaces[space].solids {
            let Some(meeting) = pushing(solid.tags) else { continue };
            let sides = along(solid.bounds);
            met(meeting, sides.map(|(low, high)| high - low));
            let Some(extent) = body.extent else { continue };
            for side in sides_of(meeting) {
                let (axis, end) = face(side);
                let at = edge(extent, axis, end, sides[axis]);
                out.edges[axis][end].push(at);
                out.faces[axis][end].push(at);
            }
        }
        let is_beside_rect = tiles.beside_rect(|tags| pushing(tags).is_some());
        let meetings: Vec<Option<Meeting>> = tiles.tags.iter().map(|t| pushing(*t)).collect();
        let covers =
            |(m, lasts): (&Option<Meeting>, &bool)| m.is_some_and(|m| m.response.push == Push::Block) && *lasts;
        let blocks: Vec<bool> = meetings.iter().zip(&tiles.lasts).map(covers).collect();
        for (kind, meeting) in meetings.iter().enumerate().filter_map(|(k, m)| Some((k, (*m)?))) {
            if tiles.spend(&self.meter) || !tiles.has(kind) {
                continue;
            }
            met(meeting, tiles.size());
            out.breaks |= !tiles.lasts[kind];
            out.slopes |= tiles.slopes[kind].is_some();
            let Some(extent) = body.extent else { continue };
            for side in sides_of(meeting) {
                let (axis, end) = face(side);
                let all = tiles.lines(|at| tiles.kind(at) == Some(kind), &self.meter);
                // A one-way obstacle pushes even if it is covered. Beside a rectangle, a body in a corner can be pushed
                // to a covered face.
                let covers = |at| tiles.neighbour(at, side).is_some_and(|k| blocks[k]);
                let covered = |at| meeting.response.push == Push::Block && !is_beside_rect(at) && covers(at);
                let open = tiles.lines(|at| tiles.kind(at) == Some(kind) && !covered(at), &self.meter);
                for (lines, edges) in [(all, &mut out.edges), (open, &mut out.faces)] {
                    let lines = if axis == 0 { lines.0 } else { lines.1 };
                    // On a slope a body rests anywhere between the ends of the line.
                    let ends = tiles.slopes[kind].filter(|_| side == Side::Below).map(Slope::ends);
                    edges[axis][end].extend(lines.into_iter().map(|(low, high)| {
                        let to = |top: f64| edge(extent, axis, end, (low, top));
                        ends.map_or(to(high), |(lowest, highest)| to(low + lowest).or(to(low + highest)))
                    }));
                }
            }
        }
    }

    /// Whether an instance at a placement can overlap a static obstacle that pushes it.
    pub fn is_inside(&self, kind: usize, space: SpaceId, placement: &Placement) -> bool {
        let [x, y] = placement.at;
        let tiles = Tiles::new(self.world, space);
        let is_meant = |id: usize, body: &Body| match &placement.colliders {
            PlacedColliders::All => true,
            PlacedColliders::While(leaves) => body.presence.as_ref().is_none_or(|p| p.is_there(leaves)),
            PlacedColliders::One { collider, .. } => collider.index() == id,
        };
        let bodies = self.kinds[kind].bodies.iter().enumerate();
        let mut meant = bodies.filter(|(id, body)| !body.kinematic && is_meant(*id, body));
        meant.any(|(_, body)| {
            let blocks =
                |tags: TagSet| self.world.meeting(body.tags, tags).is_some_and(|m| m.response.push != Push::Sense);
            let solids = self.world.spaces[space].solids.iter().filter(|s| blocks(s.tags));
            self.meter.spend(self.world.spaces[space].solids.len() as u64);
            let kinds: Vec<bool> = tiles.tags.iter().map(|t| blocks(*t)).collect();
            let Some(extent) = body.extent else { return kinds.contains(&true) || solids.count() > 0 };
            // Cells that share a line with an obstacle overlap it by the rounding error of both.
            let slack = if matches!(placement.colliders, PlacedColliders::One { .. }) { 4.0 } else { 1.0 };
            let wide = |at: Interval, e: Interval| Interval {
                low: at.low + e.low + slack * rounding(at.low),
                high: at.high + e.high - slack * rounding(at.high),
            };
            let (x, y) = (wide(x, extent[0]), wide(y, extent[1]));
            let overlaps = |b: Bounds| x.low < b.right && b.left < x.high && y.low < b.top && b.bottom < y.high;
            solids.into_iter().any(|s| overlaps(s.bounds)) || tiles.within(x, y).any(|kind| kinds[kind])
        })
    }
}

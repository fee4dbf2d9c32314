//! Static obstacles near a position: possible contacts and the ends of pushes. The rest of the analysis treats the axes
//! separately, which is enough unless positions are distinguished; by place, a floor counts only above it.

use std::collections::BTreeMap;

use crate::ir::{LeafId, Push, SpaceId, TagSet, Touch};

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::{Body, Edges, Kind, along, edge_at, face, near, rounded, sides_of};
use crate::analysis::geometry::presence::Presence;
use crate::analysis::geometry::region::Obstacle;
use crate::analysis::geometry::tiles::Tiles;
use crate::ir::{Bounds, Meeting, Side, World};
use crate::watch::Meter;

/// Maximum number of surfaces.
const MAX_SURFACES: usize = 1 << 14;
/// The size of a bucket of the surface index, px.
const BUCKET: f64 = 32.0;
/// Above this number of buckets under a box, all surfaces are examined.
const MAX_BUCKETS: usize = 256;

/// A static obstacle as one collider touches it.
#[derive(Debug, Clone, PartialEq)]
struct Surface {
    /// The positions at which they touch.
    near: [Interval; 2],
    tags: TagSet,
    /// The tags of the collider.
    mine: TagSet,
    /// The number of the collider.
    body: usize,
    /// Whether it pushes the collider, and whether to all sides.
    is_pushing: bool,
    is_solid: bool,
    /// Per axis, where a push by the low and by the high side of the collider ends; `None` for sides that it does not
    /// push to.
    edges: [[Option<f64>; 2]; 2],
    /// Whether each face is open: no neighbour covers it.
    is_open: [[bool; 2]; 2],
}

impl Surface {
    /// Whether a face along an axis is covered that can be turned to an instance at some positions, which are at most
    /// `back` px from those before the step. The half of the obstacle in which its middle was decides.
    fn has_covered_face(&self, axis: usize, at: Interval, back: Option<f64>) -> bool {
        let back = back.unwrap_or(f64::INFINITY);
        let middle = self.near[axis].low.midpoint(self.near[axis].high);
        let from = rounded(Interval { low: at.low - back, high: at.high + back });
        let [low, high] = self.is_open[axis];
        !low && from.high >= middle || !high && from.low <= middle
    }
}

/// The surfaces that a kind can touch in a space.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::analysis) struct Surfaces {
    all: Vec<Surface>,
    /// When each collider is active.
    presences: Vec<Presence>,
    buckets: BTreeMap<(i64, i64), Vec<u32>>,
    /// Surfaces in too many buckets, which every query examines.
    long: Vec<u32>,
}

impl Surfaces {
    /// `None` if there are too many, if a collider is not constant, or if the meter runs out.
    pub fn new(world: &World, kind: &Kind, space: SpaceId, meter: &Meter<'_>) -> Option<Surfaces> {
        let mut out = Surfaces { presences: presences(kind), ..Surfaces::default() };
        let tiles = Tiles::new(world, space);
        let solids = &world.spaces[space].solids;
        for (number, body) in kind.bodies.iter().enumerate() {
            let meetings: Vec<Option<Meeting>> = tiles.tags.iter().map(|t| world.meeting(body.tags, *t)).collect();
            if meetings.iter().all(Option::is_none) && solids.iter().all(|s| world.meeting(body.tags, s.tags).is_none())
            {
                continue;
            }
            if body.extent.is_none() || (body.is_pushed && body.presence.is_none()) {
                return None;
            }
            let pushes = |m: &Option<Meeting>| m.is_some_and(|m| m.response.push == Push::Block);
            let covers = |(m, lasts): (&Option<Meeting>, &bool)| pushes(m) && *lasts;
            let blocks: Vec<bool> = meetings.iter().zip(&tiles.lasts).map(covers).collect();
            if tiles.spend(meter) {
                return None;
            }
            // Beside a rectangle, a body in a corner can be pushed to a covered face.
            let is_beside_rect = tiles.beside_rect(|tags| pushes(&world.meeting(body.tags, tags)));
            let covered = |at: usize, side: Side| {
                let is_covered = tiles.neighbour(at, side).is_some_and(|kind| blocks[kind]);
                is_covered && !is_beside_rect(at)
            };
            for at in 0..tiles.count().0 * tiles.count().1 {
                let Some(kind) = tiles.kind(at) else { continue };
                let Some(meeting) = meetings[kind] else { continue };
                let is_block = meeting.response.push == Push::Block;
                out.add((number, body), tiles.tags[kind], meeting, tiles.bounds(at), |side| {
                    is_block && covered(at, side)
                })?;
            }
            for solid in solids {
                let Some(meeting) = world.meeting(body.tags, solid.tags) else { continue };
                out.add((number, body), solid.tags, meeting, solid.bounds, |_| false)?;
            }
        }
        Some(out)
    }

    /// The surfaces of stationary instances that push a kind.
    pub fn of(world: &World, kind: &Kind, obstacles: &[Obstacle]) -> Surfaces {
        let mut out = Surfaces { presences: presences(kind), ..Surfaces::default() };
        for (number, body) in kind.bodies.iter().enumerate().filter(|(_, b)| b.is_pushed) {
            for obstacle in obstacles {
                if let Some(meeting) = world.meeting(body.tags, obstacle.tags) {
                    // There are always fewer instances than the maximum number of surfaces.
                    let _ = out.add((number, body), obstacle.tags, meeting, obstacle.bounds, |_| false);
                }
            }
        }
        out
    }

    fn add(
        &mut self,
        (number, body): (usize, &Body),
        tags: TagSet,
        meeting: Meeting,
        bounds: Bounds,
        covered: impl Fn(Side) -> bool,
    ) -> Option<()> {
        let (extent, sides) = (body.extent?, along(bounds));
        let is_pushing = meeting.response.push != Push::Sense && !body.kinematic;
        let mut surface = Surface {
            near: [0, 1].map(|axis| near(Some(extent), axis, sides[axis])),
            tags,
            mine: body.tags,
            body: number,
            is_pushing,
            is_solid: meeting.response.push == Push::Block,
            edges: [[None; 2]; 2],
            is_open: [[false; 2]; 2],
        };
        for side in sides_of(meeting).filter(|_| is_pushing) {
            let (axis, end) = face(side);
            surface.edges[axis][end] = Some(edge_at(extent, axis, end, sides[axis]));
            surface.is_open[axis][end] = !covered(side);
        }
        let number = self.all.len() as u32;
        let [columns, rows] = surface.near.map(buckets);
        if span(columns).saturating_mul(span(rows)) > MAX_BUCKETS {
            self.long.push(number);
        } else {
            for row in rows.0..=rows.1 {
                for column in columns.0..=columns.1 {
                    self.buckets.entry((row, column)).or_default().push(number);
                }
            }
        }
        self.all.push(surface);
        (self.all.len() <= MAX_SURFACES).then_some(())
    }

    /// The surfaces that can be touched from a box of positions.
    fn around(&self, at: [Interval; 2]) -> impl Iterator<Item = &Surface> {
        let [columns, rows] = at.map(buckets);
        let mut numbers: Vec<u32> = if span(columns).saturating_mul(span(rows)) > MAX_BUCKETS {
            (0..self.all.len() as u32).collect()
        } else {
            let cells = (rows.0..=rows.1).flat_map(|row| (columns.0..=columns.1).map(move |column| (row, column)));
            let near = cells.filter_map(|cell| self.buckets.get(&cell)).flatten();
            near.chain(&self.long).copied().collect()
        };
        numbers.sort_unstable();
        numbers.dedup();
        let touches = move |s: &&Surface| (0..2).all(|axis| s.near[axis].and(at[axis]).is_some());
        numbers.into_iter().filter_map(|n| self.all.get(n as usize)).filter(touches)
    }

    /// Where pushes of at most `far` px can end, for an instance in a box of positions with some active leaves.
    pub fn edges(&self, at: [Interval; 2], far: f64, leaves: &[LeafId], out: &mut Edges) {
        let is_there = |s: &&Surface| self.presences[s.body].is_there(leaves);
        for surface in self.around(at).filter(|s| s.is_pushing).filter(is_there) {
            for (axis, out) in out.iter_mut().enumerate() {
                for (end, out) in out.iter_mut().enumerate() {
                    let Some(edge) = surface.edges[axis][end].filter(|_| surface.is_open[axis][end]) else { continue };
                    let from = match end {
                        0 => Interval { low: edge - far, high: edge },
                        _ => Interval { low: edge, high: edge + far },
                    };
                    if rounded(from).and(at[axis]).is_some() {
                        out.push(rounded(Interval::point(edge)));
                    }
                }
            }
        }
    }

    /// As [`Surfaces::edges`], along an axis: by which end of a collider, the edge, and the positions across from which it is
    /// pushed there. Neighbours with the same edge are one.
    pub fn pushes(
        &self,
        at: [Interval; 2],
        far: f64,
        axis: usize,
        leaves: &[LeafId],
    ) -> Vec<(usize, Interval, Interval)> {
        let mut out: Vec<(usize, Interval, Interval)> = Vec::new();
        for end in 0..2 {
            let first = out.len();
            for surface in self.around(at).filter(|s| s.is_pushing && self.presences[s.body].is_there(leaves)) {
                let Some(edge) = surface.edges[axis][end].filter(|_| surface.is_open[axis][end]) else { continue };
                let from = match end {
                    0 => Interval { low: edge - far, high: edge },
                    _ => Interval { low: edge, high: edge + far },
                };
                if let (Some(_), Some(across)) = (rounded(from).and(at[axis]), surface.near[1 - axis].and(at[1 - axis]))
                {
                    out.push((end, rounded(Interval::point(edge)), across));
                }
            }
            out[first..].sort_by(|(_, a, at), (_, b, bt)| a.low.total_cmp(&b.low).then(at.low.total_cmp(&bt.low)));
        }
        out.dedup_by(|(end, edge, across), (known, same, all)| {
            let is_one = end == known && edge == same && across.low <= all.high;
            if is_one {
                *all = all.or(*across);
            }
            is_one
        });
        out
    }

    /// Boxes of positions in which an instance can be after pushes of at most `far` px when a contact query holds.
    /// `also` holds further surfaces that push, `pushed` tells along which axes it can have been pushed, `back` how far
    /// it can be from where it was before the step, if that is known.
    pub fn touched(
        &self,
        touch: &Touch,
        (at, pushed): ([Interval; 2], [bool; 2]),
        (far, back): (f64, Option<f64>),
        also: Option<&Surfaces>,
        out: &mut Vec<[Interval; 2]>,
    ) {
        let wide = |i: Interval| rounded(Interval { low: i.low - far, high: i.high + far });
        let asked = |s: &&&Surface| s.mine.meets(touch.mine) && s.tags.meets(TagSet::of(touch.other));
        let mut add = |within: [Interval; 2]| {
            if let (Some(x), Some(y)) = (within[0].and(at[0]), within[1].and(at[1]))
                && !out.contains(&[x, y])
            {
                out.push([x, y]);
            }
        };
        let around: Vec<&Surface> = self.around(at.map(wide)).collect();
        for surface in around.iter().filter(asked) {
            let within = surface.near.map(wide);
            if let Some((axis, end)) = touch.side.map(face).filter(|_| surface.is_pushing) {
                // It is pushed at least to this edge. A covered face yields a side only in a corner, where the
                // perpendicular face turned to where the instance was is covered, too.
                let is_corner = surface.is_solid && surface.has_covered_face(1 - axis, at[1 - axis], back);
                let Some(edge) = surface.edges[axis][end].filter(|_| surface.is_open[axis][end] || is_corner) else {
                    continue;
                };
                if !pushed[axis] && surface.is_open[axis][end] {
                    continue;
                }
                // The deepest push to that side wins.
                let end_of_push = rounded(match end {
                    0 => Interval { low: edge, high: edge + far },
                    _ => Interval { low: edge - far, high: edge },
                });
                let others = also.into_iter().flat_map(|also| also.around(at.map(wide)));
                let pushing = around.iter().copied().chain(others).filter(|s| s.is_pushing);
                let pushes = pushing.filter_map(|s| s.edges[axis][end]);
                for edge in pushes.filter(|e| end_of_push.contains(*e)) {
                    let mut within = within;
                    within[axis] = rounded(Interval::point(edge));
                    add(within);
                }
                continue;
            }
            add(within);
        }
    }

    /// Where pushes end along an axis, by the low and by the high side of colliders.
    pub fn lines(&self, axis: usize) -> [Vec<f64>; 2] {
        [0, 1].map(|end| self.all.iter().filter_map(|s| s.edges[axis][end]).collect())
    }
}

/// When each collider of a kind is active; `Always` where that is not known.
fn presences(kind: &Kind) -> Vec<Presence> {
    kind.bodies.iter().map(|body| body.presence.clone().unwrap_or(Presence::Always)).collect()
}

/// Number of buckets from the first to the last.
fn span((low, high): (i64, i64)) -> usize {
    high.saturating_sub(low).saturating_add(1).max(1) as usize
}

/// The first and the last bucket under an interval; the cast saturates.
fn buckets(i: Interval) -> (i64, i64) {
    ((i.low / BUCKET).floor() as i64, (i.high / BUCKET).floor() as i64)
}

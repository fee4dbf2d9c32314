//! Static obstacles near a position: possible contacts and the ends of pushes. The rest of the analysis treats the axes
//! separately, which is enough unless positions are distinguished; by place, a floor counts only above it.

use hashbrown::HashMap;

use crate::ir::{Extremes, LeafId, Push, SpaceId, TagSet, Touch};

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::{Body, Edges, Kind, along, edge_at, face, near, rounded, sides_of};
use crate::analysis::geometry::presence::Presence;
use crate::analysis::geometry::region::Obstacle;
use crate::analysis::geometry::tiles::Tiles;
use crate::ir::{Bounds, Meeting, Side, World};
use crate::watch::Meter;

/// Maximum number of surfaces.
const MAX_SURFACES: usize = 1 << 14;
/// More than rounding and the tolerance for touching can make, px.
const SLACK: f64 = 0.01;
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
    /// Whether each face is bare: no neighbour can ever cover it.
    is_bare: [[bool; 2]; 2],
    /// Whether it is always there.
    lasts: bool,
}

/// What covers a face of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Face {
    /// A neighbour that is always there.
    Covered,
    /// A neighbour may.
    Open,
    /// Nothing can.
    Bare,
}

impl Surface {
    /// An obstacle as a collider, with its number, touches it; `None` if that is not constant.
    fn new(
        (number, body): (usize, &Body),
        tags: TagSet,
        meeting: Meeting,
        bounds: Bounds,
        covered: impl Fn(Side) -> Face,
    ) -> Option<Surface> {
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
            is_bare: [[false; 2]; 2],
            lasts: false,
        };
        for side in sides_of(meeting).filter(|_| is_pushing) {
            let (axis, end) = face(side);
            surface.edges[axis][end] = Some(edge_at(extent, axis, end, sides[axis]));
            surface.is_open[axis][end] = covered(side) != Face::Covered;
            surface.is_bare[axis][end] = covered(side) == Face::Bare;
        }
        Some(surface)
    }

    /// The positions along an axis at which a collider is pushed along the other axis, that it is at least `depth` px deep
    /// along, after a move of at most `far` px: not where it is less deep along this one, from a face that nothing covers.
    fn across(&self, axis: usize, depth: f64, far: f64) -> Interval {
        let near = self.near[axis];
        let depth = depth - SLACK;
        let is_beside = near.high - near.low > 2.0 * (far + depth);
        if !self.is_solid || depth <= 0.0 || !is_beside {
            return near;
        }
        // By the high side of the collider at the low end.
        let [high, low] = self.is_bare[axis].map(|is_bare| if is_bare { depth } else { 0.0 });
        Interval { low: near.low + low, high: near.high - high }
    }

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
    /// The size of each collider, px; zero for circles, and where anything is seen from across a seam.
    sizes: Vec<[f64; 2]>,
    buckets: HashMap<(i64, i64), Vec<u32>>,
    /// Surfaces in too many buckets, which every query examines.
    long: Vec<u32>,
}

impl Surfaces {
    /// `None` if there are too many, if a collider is not constant, or if the meter runs out.
    pub fn new(world: &World, kind: &Kind, space: SpaceId, meter: &Meter<'_>) -> Option<Surfaces> {
        let mut out = Surfaces { presences: presences(kind), ..Surfaces::default() };
        let is_plain = |body: &&Body| !body.is_round && !world.spaces[space].wraps();
        out.sizes = kind.bodies.iter().map(|body| Some(body).filter(is_plain).map_or([0.0; 2], Body::size)).collect();
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
            let bare = |at: usize, side: Side| {
                let can_cover = tiles.neighbour(at, side).is_some_and(|kind| pushes(&meetings[kind]));
                !can_cover && !is_beside_rect(at)
            };
            for at in 0..tiles.count().0 * tiles.count().1 {
                let Some(kind) = tiles.kind(at) else { continue };
                let Some(meeting) = meetings[kind] else { continue };
                let is_block = meeting.response.push == Push::Block;
                let surface = Surface::new((number, body), tiles.tags[kind], meeting, tiles.bounds(at), |side| {
                    if is_block && covered(at, side) {
                        Face::Covered
                    } else if bare(at, side) {
                        Face::Bare
                    } else {
                        Face::Open
                    }
                });
                out.add(Surface { lasts: tiles.lasts[kind], ..surface? })?;
            }
            for solid in solids {
                let Some(meeting) = world.meeting(body.tags, solid.tags) else { continue };
                let surface = Surface::new((number, body), solid.tags, meeting, solid.bounds, |_| Face::Open);
                out.add(Surface { lasts: true, ..surface? })?;
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
                    let surface = Surface::new((number, body), obstacle.tags, meeting, obstacle.bounds, |_| Face::Open);
                    let _ = surface.and_then(|surface| out.add(surface));
                }
            }
        }
        out
    }

    fn add(&mut self, surface: Surface) -> Option<()> {
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
        let touches = |n: &u32| {
            let is_near = |s: &Surface| (0..2).all(|axis| s.near[axis].and(at[axis]).is_some());
            self.all.get(*n as usize).is_some_and(is_near)
        };
        let numbers: Vec<u32> = if span(columns).saturating_mul(span(rows)) > MAX_BUCKETS {
            (0..self.all.len() as u32).filter(touches).collect()
        } else {
            let cells = (rows.0..=rows.1).flat_map(|row| (columns.0..=columns.1).map(move |column| (row, column)));
            let near = cells.filter_map(|cell| self.buckets.get(&cell)).flatten();
            let mut numbers: Vec<u32> = near.chain(&self.long).copied().filter(touches).collect();
            numbers.sort_unstable();
            numbers.dedup();
            numbers
        };
        numbers.into_iter().filter_map(|n| self.all.get(n as usize))
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
        let is_pushing = |s: &&Surface| s.is_pushing && self.presences[s.body].is_there(leaves);
        let around: Vec<&Surface> = self.around(at).filter(is_pushing).collect();
        for end in 0..2 {
            let first = out.len();
            for surface in &around {
                let Some(edge) = surface.edges[axis][end].filter(|_| surface.is_open[axis][end]) else { continue };
                let from = match end {
                    0 => Interval { low: edge - far, high: edge },
                    _ => Interval { low: edge, high: edge + far },
                };
                let depth = if end == 0 { edge - at[axis].high } else { at[axis].low - edge };
                let within = surface.across(1 - axis, depth, far);
                if let (Some(_), Some(across)) = (rounded(from).and(at[axis]), within.and(at[1 - axis])) {
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

    /// Boxes of positions in which a contact query surely holds after a collision phase in which pushes were at most `far`
    /// px long, for an instance with some active leaves that was pushed along y by its low and by its high side or not.
    pub fn surely_touched(
        &self,
        touch: &Touch,
        (at, pushed): ([Interval; 2], [bool; 2]),
        far: f64,
        leaves: &[LeafId],
    ) -> Vec<[Interval; 2]> {
        let there = |s: &&&Surface| self.presences[s.body].is_there(leaves);
        let asked = |s: &&&Surface| s.lasts && s.mine.meets(touch.mine) && s.tags.meets(TagSet::of(touch.other));
        let is_plain = |s: &&&Surface| self.sizes.get(s.body).is_some_and(|size| size[0] > 0.0 && size[1] > 0.0);
        let mut out = Vec::new();
        if touch.side.is_none() {
            // Wherever it was before it was pushed, they overlapped.
            let around: Vec<&Surface> = self.around(at).collect();
            let all = around.iter().filter(asked).filter(there).filter(is_plain);
            for surface in all.filter(|s| s.is_solid || !s.is_pushing) {
                let within = surface.near.map(|near| inner(near, far + SLACK));
                out.extend(within[0].zip(within[1]).map(|(x, y)| [x, y]));
            }
        }
        let is_about = |end: &usize| pushed[*end] && touch.side.map(face).is_none_or(|of| of == (1, *end));
        let ends = [0, 1].into_iter().filter(is_about);
        let around = if ends.clone().next().is_some() { self.all_around(at, far) } else { Vec::new() };
        for end in ends {
            // It was pushed to this edge, whatever pushed it.
            let edges = around.iter().filter(there).filter_map(|s| s.edges[1][end].map(|edge| (edge, s.body)));
            let mut edges = edges.filter(|(edge, _)| wide(at[1], SLACK).contains(*edge));
            let Some((edge, body)) = edges.next().filter(|one| edges.all(|other| other == *one)) else { continue };
            let is_it = |s: &&&Surface| s.edges[1][end] == Some(edge) && s.is_solid && s.is_bare[1][end];
            let size = self.sizes.get(body).copied().unwrap_or_default();
            // It is pushed along the axis of least penetration: at least this far it is over or under one of them.
            let deep = far + SLACK;
            let is_large = |s: &&&Surface| {
                let [width, height] = [0, 1].map(|axis| s.near[axis].high - s.near[axis].low);
                width - size[0] >= deep && height > 4.0 * deep
            };
            if size[0] < 2.0 * deep {
                continue;
            }
            let row = around.iter().filter(asked).filter(there).filter(is_it).filter(is_large);
            let mut row: Vec<Interval> = row.map(|s| s.near[0]).collect();
            row.sort_by(|a, b| a.low.total_cmp(&b.low));
            row.dedup_by(|next, last| {
                let is_next = next.low <= last.high - size[0] + SLACK;
                last.high = if is_next { last.high.greatest(next.high) } else { last.high };
                is_next
            });
            out.extend(row.into_iter().filter_map(|x| Some([inner(x, 2.0 * deep)?, at[1]])));
        }
        out
    }

    /// The surfaces that an instance can touch from anywhere near a box of positions, and their neighbours.
    fn all_around(&self, at: [Interval; 2], far: f64) -> Vec<&Surface> {
        let size = self.sizes.iter().map(|size| size[0]).fold(0.0, f64::greatest);
        let (x, y) = (wide(at[0], size + 4.0 * far), wide(at[1], far + 2.0 * SLACK));
        self.around([x, y]).collect()
    }

    /// Where pushes end along an axis, by the low and by the high side of colliders.
    pub fn lines(&self, axis: usize) -> [Vec<f64>; 2] {
        [0, 1].map(|end| self.all.iter().filter_map(|s| s.edges[axis][end]).collect())
    }
}

/// An interval, larger on both sides.
fn wide(i: Interval, by: f64) -> Interval {
    Interval { low: i.low - by, high: i.high + by }
}

/// An interval, smaller on both sides, if anything is left.
fn inner(i: Interval, by: f64) -> Option<Interval> {
    Some(wide(i, -by)).filter(|i| i.low <= i.high)
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

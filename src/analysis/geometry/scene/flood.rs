//! The region that an instance reaches in small steps among static obstacles: the free space connected to its seeds,
//! found by flood fill in its configuration space (Lozano-Pérez, *Spatial planning: a configuration space approach*,
//! IEEE Transactions on Computers 1983: obstacles grow by the size of the collider).
//!
//! The instance is never inside a blocking obstacle unless it starts there. A step moves it by at most `far` px along
//! each axis, so it penetrates an obstacle by at most that and is pushed out by at most that. Free cells are connected
//! if they are at most two such steps apart; thicker walls separate them.
//!
//! If several colliders alternate, their intersection is kept out of blocking obstacles while one of them is active.
//!
//! This fails where a push ends inside another obstacle, or where two obstacles push against each other: at a gap that
//! is too narrow by up to two steps. No region is reported if it comes near such a gap.

use crate::ir::{Bounds, Push, SpaceId, TagSet};

use crate::watch::Meter;

use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::{Extent, Kind, ROUNDING, TOLERANCE};
use crate::analysis::geometry::region::{Obstacle, Region};
use crate::analysis::geometry::tiles::Tiles;

use super::Scene;

/// Maximum number of cells; above it, no region is computed.
const MAX_CELLS: usize = 1 << 22;

impl Scene<'_> {
    /// The region that instances of a kind reach from some boxes in a space, if a step moves them by at most `far` px
    /// along each axis, while they are kept out of blocking obstacles. `None` if there is too much to examine, or if
    /// pushes could leave them inside an obstacle.
    pub fn flood_region(
        &self,
        kind: usize,
        space: SpaceId,
        seeds: &[[Interval; 2]],
        far: f64,
        obstacles: &[Obstacle],
    ) -> Option<Region> {
        let of = &self.kinds[kind];
        let players = of.slots.iter().all(|s| self.world.slots[*s].player.is_some());
        let bounds = self.world.spaces[space].bounds.filter(|_| players);
        let mut blocking = Vec::new();
        for (tags, extent) in of.cores() {
            let blockers = self.blockers((tags, extent), space, obstacles.iter().filter(|o| o.is_always_present));
            blocking.extend(blockers.into_iter().filter(|(_, push)| *push == Push::Block).map(|(sides, _)| sides));
        }
        let plane = Plane::new(&blocking, bounds, &self.meter)?;
        let apart = 2.0 * far + TOLERANCE + 4.0 * ROUNDING;
        let reached = plane.flood(seeds, apart, &self.meter);
        let mut all = Vec::new();
        for body in of.kept_out() {
            let pushing = self.blockers((body.tags, body.extent?), space, obstacles.iter());
            all.extend(pushing.into_iter().map(|(sides, _)| sides));
        }
        if self.meter.is_stopped() || has_narrow_gap(&all, &reached, (far, apart), &self.meter) {
            return None;
        }
        for body in of.kept_out() {
            let mut of_body = self.blockers((body.tags, body.extent?), space, [].iter());
            of_body.retain(|(_, push)| *push == Push::Block);
            let of_body: Vec<_> = of_body.into_iter().map(|(sides, _)| sides).collect();
            if has_ledge(&of_body, &reached, (far, apart), &self.meter) {
                return None;
            }
        }
        let wide = |i: Interval| Interval { low: i.low - ROUNDING, high: i.high + ROUNDING };
        Region::new(reached.into_iter().map(|strip| strip.map(wide)).collect())
    }

    /// The positions at which an instance that is kept out would overlap a static blocking obstacle.
    pub fn blocking(&self, kind: &Kind, space: SpaceId) -> Vec<[Interval; 2]> {
        let of = |core| self.blockers(core, space, [].iter()).into_iter();
        let blockers = kind.cores().into_iter().flat_map(of);
        blockers.filter(|(_, push)| *push == Push::Block).map(|(sides, _)| sides).collect()
    }

    /// The positions at which a box overlaps an obstacle that pushes it, with the kind of push.
    fn blockers<'o>(
        &self,
        (tags, extent): (TagSet, Extent),
        space: SpaceId,
        obstacles: impl Iterator<Item = &'o Obstacle>,
    ) -> Vec<([Interval; 2], Push)> {
        let tiles = Tiles::new(self.world, space);
        let push = |t: TagSet| self.world.meeting(tags, t).map_or(Push::Sense, |m| m.response.push);
        let solids = self.world.spaces[space].solids.iter().map(|s| (s.tags, s.bounds));
        let boxes = solids.chain(obstacles.map(|o| (o.tags, o.bounds)));
        let mut out: Vec<_> = boxes.map(|(tags, bounds)| (grown(bounds, extent), push(tags))).collect();
        out.retain(|(_, push)| *push != Push::Sense);
        // What can be broken keeps nothing out.
        for wanted in [Push::Block, Push::FromAbove] {
            let kinds: Vec<bool> = tiles.tags.iter().zip(&tiles.lasts).map(|(t, l)| *l && push(*t) == wanted).collect();
            out.extend(tiles.boxes(|kind| kinds[kind]).map(|bounds| (grown(bounds, extent), wanted)));
        }
        out.retain(|(sides, _)| sides.iter().all(|side| side.low < side.high));
        out
    }

    /// Whether a collider can overlap an obstacle at one of the seeds.
    pub fn is_inside_of(&self, kind: usize, space: SpaceId, obstacles: &[Obstacle]) -> bool {
        self.kinds[kind].kept_out().any(|body| {
            let Some(extent) = body.extent else { return true };
            let pushes =
                |o: &&Obstacle| self.world.meeting(body.tags, o.tags).is_some_and(|m| m.response.push != Push::Sense);
            obstacles.iter().filter(pushes).any(|o| {
                let sides = grown(o.bounds, extent);
                self.all_seeds(kind, space).any(|at| (0..2).all(|axis| at[axis].and(sides[axis]).is_some()))
            })
        })
    }
}

/// Whether two intervals are at most `apart` from each other.
fn near(a: Interval, b: Interval, apart: f64) -> bool {
    a.low - apart <= b.high && b.low - apart <= a.high
}

/// Whether two obstacles near the reached region leave a gap that is too narrow by at most two steps: they push against
/// each other, or a push by one ends inside the other. Also true if the meter runs out.
fn has_narrow_gap(
    blockers: &[[Interval; 2]],
    reached: &[[Interval; 2]],
    (far, apart): (f64, f64),
    meter: &Meter<'_>,
) -> bool {
    let thickest = 2.0 * far + TOLERANCE + 4.0 * ROUNDING;
    let mut order: Vec<&[Interval; 2]> = blockers.iter().collect();
    [0, 1].into_iter().any(|axis| {
        let across = 1 - axis;
        order.sort_by(|a, b| a[axis].low.total_cmp(&b[axis].low));
        order.iter().any(|a| {
            let side = a[axis];
            let first = order.partition_point(|b| b[axis].low < side.high - thickest);
            let after = order.partition_point(|b| b[axis].low < side.high);
            order.get(first..after).unwrap_or_default().iter().any(|b| {
                if side.low >= b[axis].low || !near(a[across], b[across], apart) {
                    return false;
                }
                let mut gap = [side; 2];
                gap[axis] = Interval { low: b[axis].low, high: side.high };
                gap[across] = a[across].or(b[across]);
                if meter.spend(reached.len() as u64) {
                    return true;
                }
                reached.iter().any(|r| near(r[0], gap[0], apart) && near(r[1], gap[1], apart))
            })
        })
    })
}

/// Whether an obstacle near the reached region covers a face of another and is no thicker there than a step: a step can
/// pass through it into the other, whose covered face gives no side, so that the push goes to another side by any
/// distance. Also true if the meter runs out.
fn has_ledge(
    blockers: &[[Interval; 2]],
    reached: &[[Interval; 2]],
    (far, apart): (f64, f64),
    meter: &Meter<'_>,
) -> bool {
    let thickest = far + TOLERANCE + 4.0 * ROUNDING;
    let mirrored = |i: Interval| Interval { low: -i.high, high: -i.low };
    [(0, false), (0, true), (1, false), (1, true)].into_iter().any(|(axis, is_mirrored)| {
        let across = 1 - axis;
        let along = |b: &[Interval; 2]| if is_mirrored { mirrored(b[axis]) } else { b[axis] };
        let mut order: Vec<&[Interval; 2]> = blockers.iter().collect();
        order.sort_by(|a, b| along(a).high.total_cmp(&along(b).high));
        order.iter().any(|a| {
            let face = along(a).high;
            let first = order.partition_point(|b| along(b).high <= face);
            let after = order.partition_point(|b| along(b).high <= face + thickest);
            order.get(first..after).unwrap_or_default().iter().any(|b| {
                if along(b).low > face + apart || !near(a[across], b[across], apart) {
                    return false;
                }
                let ledge = Interval { low: face, high: along(b).high };
                let ledge = if is_mirrored { mirrored(ledge) } else { ledge };
                if meter.spend(reached.len() as u64) {
                    return true;
                }
                reached.iter().any(|r| near(r[axis], ledge, apart) && near(r[across], b[across], apart))
            })
        })
    })
}

/// The positions at which a box overlaps another.
fn grown(b: Bounds, extent: Extent) -> [Interval; 2] {
    let axis = |low: f64, high: f64, own: Interval| Interval {
        low: low - own.high + ROUNDING,
        high: high - own.low - ROUNDING,
    };
    [axis(b.left, b.right, extent[0]), axis(b.bottom, b.top, extent[1])]
}

/// The plane of positions, cut into cells by the sides of blocking obstacles.
struct Plane {
    /// The sides, in order; a cell lies between two of them.
    lines: [Vec<f64>; 2],
    /// Row by row.
    is_blocked: Vec<bool>,
}

impl Plane {
    /// `None` if there is too much to examine, or if the meter runs out.
    fn new(blocking: &[[Interval; 2]], bounds: Option<Bounds>, meter: &Meter<'_>) -> Option<Plane> {
        let bounds = bounds.map_or([Interval::ALL; 2], |b| {
            [Interval { low: b.left, high: b.right }, Interval { low: b.bottom, high: f64::INFINITY }]
        });
        let lines = [0, 1].map(|axis| {
            let Interval { low, high } = bounds[axis];
            let inside = blocking.iter().flat_map(|b| [b[axis].low, b[axis].high]).filter(|x| low < *x && *x < high);
            let mut lines: Vec<f64> = inside.chain([low, high]).collect();
            lines.sort_by(f64::total_cmp);
            lines.dedup();
            lines
        });
        let count = |axis: usize| lines[axis].len() - 1;
        if count(0).saturating_mul(count(1)) > MAX_CELLS || count(0) == 0 || count(1) == 0 {
            return None;
        }
        let mut is_blocked = vec![false; count(0) * count(1)];
        for b in blocking {
            let range = |axis: usize| {
                let first = lines[axis].partition_point(|x| *x < b[axis].low);
                let after = lines[axis].partition_point(|x| *x < b[axis].high);
                // Obstacles may lie beyond the bounds.
                let after = after.min(count(axis));
                first.min(after)..after
            };
            let (across, up) = (range(0), range(1));
            // Each row costs at least one call.
            if meter.spend(((across.len() / 16 + 4) * up.len()) as u64) {
                return None;
            }
            for row in up {
                is_blocked[row * count(0)..][across.clone()].fill(true);
            }
        }
        Some(Plane { lines, is_blocked })
    }

    /// The runs of free cells of a row, one box each.
    fn strips(&self, row: usize) -> Vec<[Interval; 2]> {
        let [x, y] = &self.lines;
        let across = x.len() - 1;
        let cells = &self.is_blocked[row * across..][..across];
        let up = Interval { low: y[row], high: y[row + 1] };
        let mut out = Vec::new();
        let mut from = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            if !run[0] {
                out.push([Interval { low: x[from], high: x[from + run.len()] }, up]);
            }
            from += run.len();
        }
        out
    }

    /// The free strips connected to some boxes, where strips at most `apart` from each other are connected; incomplete
    /// if the meter runs out.
    fn flood(&self, seeds: &[[Interval; 2]], apart: f64, meter: &Meter<'_>) -> Vec<[Interval; 2]> {
        let rows = self.lines[1].len() - 1;
        let mut starts = Vec::with_capacity(rows + 1);
        let mut strips = Vec::new();
        for row in 0..rows {
            if meter.spend(self.lines[0].len() as u64) {
                return Vec::new();
            }
            starts.push(strips.len());
            strips.extend(self.strips(row));
        }
        starts.push(strips.len());
        let mut is_reached = vec![false; strips.len()];
        let mut open: Vec<usize> = Vec::new();
        for (at, strip) in strips.iter().enumerate() {
            if meter.spend(seeds.len() as u64) {
                return Vec::new();
            }
            if seeds.iter().any(|s| near(s[0], strip[0], apart) && near(s[1], strip[1], apart)) {
                is_reached[at] = true;
                open.push(at);
            }
        }
        let row_of = |at: usize| starts.partition_point(|s| *s <= at) - 1;
        while let Some(at) = open.pop() {
            let [x, y] = strips[at];
            let row = row_of(at);
            let below =
                (0..=row).rev().take_while(|r| near(y, Interval::point(self.lines[1][r + 1]), apart) || *r == row);
            let above = (row + 1..rows).take_while(|r| near(y, Interval::point(self.lines[1][*r]), apart));
            for other in below.chain(above) {
                if meter.spend(16) {
                    return Vec::new();
                }
                let of_row = &strips[starts[other]..starts[other + 1]];
                let first = starts[other] + of_row.partition_point(|s| s[0].high < x.low - apart);
                for next in first..starts[other + 1] {
                    if strips[next][0].low > x.high + apart {
                        break;
                    }
                    if !is_reached[next] {
                        is_reached[next] = true;
                        open.push(next);
                    }
                }
            }
        }
        strips.into_iter().zip(is_reached).filter(|(_, reached)| *reached).map(|(strip, _)| strip).collect()
    }
}

//! Probes over sets of positions: whether a moved collider can overlap something with a tag, and whether it must. Static
//! obstacles are exact: what several of them cover together counts as covered. What moves is known by all its positions.

use std::sync::{Arc, PoisonError};

use crate::ir::{Bounds, Collider, Entity, Expr, ExprId, IdVec, ParamId, Shape, SlotId, SpaceId, TagId, TagSet, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::truth::Truth;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::{TOLERANCE, rounding};
use crate::analysis::geometry::presence::Presence;

use super::evaluate::Reader;

/// Maximum number of cells of a map, and of obstacles, that a probe looks at; beyond, everything is possible.
const MAX_CELLS: usize = 4_096;
const MAX_OBSTACLES: usize = 256;
/// Maximum number of pieces into which positions are split.
const MAX_PIECES: usize = 64;

/// A probe of an instance.
#[derive(Debug, Clone, Copy)]
struct Asked {
    mine: TagSet,
    other: TagSet,
    tag: TagId,
    offset: [ExprId; 2],
    bound: bool,
    tiles: bool,
}

/// A collider of another instance with the tag of a probe.
#[derive(Debug)]
pub(in crate::analysis) struct There {
    slot: SlotId,
    /// Its lower-left corner, if it is there.
    at: [Values; 2],
    /// Its width and height, px.
    size: [f64; 2],
    /// Whether it is there in all states, and no circle.
    is_sure: bool,
}

/// A box that can be anywhere between its ends, relative to the position, px.
#[derive(Debug, Clone, Copy)]
struct Moved {
    corner: [Interval; 2],
    size: [Interval; 2],
    /// Whether it is there for certain, and no circle.
    is_sure: bool,
}

/// Where the lower-left corner of a box is if it overlaps another one: the ends along each axis.
#[derive(Debug, Clone, Copy)]
struct Overlap {
    /// Between these it does for certain.
    must: [(f64, f64); 2],
    /// Outside of these it cannot.
    can: [(f64, f64); 2],
    /// Whether the other one is always there, in all of its box.
    lasts: bool,
}

/// Per axis, the positions of a lower-left corner.
type Corner = [Interval; 2];

/// What a probe looks at from the positions of a configuration.
struct Look {
    asked: Asked,
    /// One's own colliders in each space that one can be in, with the static obstacles that they may overlap; none if
    /// these are too many.
    own: Vec<(SpaceId, Moved, Option<Vec<Overlap>>)>,
    /// The colliders of instances with the tag.
    there: Arc<[There]>,
}

impl Reader<'_> {
    /// Whether a probe can find something, and whether it can find nothing.
    pub(super) fn probe(&self, id: ExprId) -> Truth {
        let Some((_, at)) = self.me else { return Truth::EITHER };
        let Some(look) = self.look(id, at) else { return Truth::EITHER };
        let [x, y] = [VarId::X, VarId::Y].map(|var| at.vars[var][0]);
        let mut out = Truth { can_hold: false, can_fail: false };
        for x in x.intervals() {
            for y in y.intervals() {
                let here = self.probe_at(&look, [*x, *y], at);
                out = Truth { can_hold: out.can_hold || here.can_hold, can_fail: out.can_fail || here.can_fail };
            }
        }
        out
    }

    /// Restricts the position by a probe with an outcome: per axis, to the pieces between the ends of obstacles that allow
    /// it.
    pub(super) fn refine_by_probe(&self, at: &mut Configuration, id: ExprId, holds: bool) -> bool {
        let Some((me, _)) = self.me else { return true };
        for axis in 0..2 {
            let position = at.vars[VarId::XY[axis]][0];
            if position.constant().is_some() {
                continue;
            }
            let known = at.clone();
            let reader = Reader { me: Some((me, &known)), ..*self };
            let Some(look) = reader.look(id, &known) else { return true };
            let across = known.vars[VarId::XY[1 - axis]][0];
            let allows = |piece: &Interval| {
                across.intervals().iter().any(|across| {
                    let place = if axis == 0 { [*piece, *across] } else { [*across, *piece] };
                    let truth = reader.probe_at(&look, place, &known);
                    if holds { truth.can_hold } else { truth.can_fail }
                })
            };
            let Some(cuts) = look.cuts(axis) else { continue };
            let mut kept = Vec::new();
            for interval in position.intervals() {
                let mut low = interval.low;
                let inside = cuts.iter().copied().filter(|cut| interval.low < *cut && *cut < interval.high);
                for high in inside.chain([interval.high]) {
                    kept.push(Interval { low, high });
                    low = high;
                }
            }
            if kept.len() <= 2 * MAX_PIECES {
                kept.retain(allows);
                at.set(VarId::XY[axis], 0, Values::any(kept));
            }
        }
        !at.is_impossible()
    }

    /// What a probe looks at; `None` of another expression, or at no positions.
    fn look(&self, id: ExprId, at: &Configuration) -> Option<Look> {
        let asked = self.asked(id)?;
        let hulls = [at.vars[VarId::X][0].hull()?, at.vars[VarId::Y][0].hull()?];
        let moved = self.moved(&asked);
        let in_space = |space: &SpaceId| {
            let space = *space;
            moved.iter().map(move |moved| (space, *moved)).collect::<Vec<_>>()
        };
        let statics = |(space, moved): (SpaceId, Moved)| {
            let near = match asked.bound && !asked.tiles {
                true => Some(Vec::new()),
                false => self.statics_near(space, &asked, &moved, moved.at(hulls)),
            };
            (space, moved, near)
        };
        let own = at.spaces.iter().flat_map(in_space).map(statics).collect();
        Some(Look { asked, own, there: self.tagged(&asked) })
    }

    fn asked(&self, id: ExprId) -> Option<Asked> {
        let Expr::Probe { mine, other, offset, bound, tiles } = self.program.exprs[id] else { return None };
        Some(Asked { mine: TagSet::of(mine), other: TagSet::of(other), tag: other, offset, bound, tiles })
    }

    /// One's own colliders that a probe moves.
    fn moved(&self, asked: &Asked) -> Vec<Moved> {
        let Some((me, _)) = self.me else { return Vec::new() };
        let own = self.entity(me).colliders.iter().filter(|c| c.tags.meets(asked.mine));
        let offset = asked.offset.map(|id| self.number(id).hull());
        let moved = |c: &Collider| {
            let presence = c.guard.map_or(Truth::of(true), |guard| self.truth(guard));
            let [x, y, width, height] = match c.shape {
                Shape::Rect(numbers) => {
                    let [x, y, width, height] = numbers.map(|id| self.number(id).hull());
                    [x?, y?, width?, height?]
                }
                Shape::Circle(numbers) => {
                    let [x, y, radius] = numbers.map(|id| self.number(id).hull());
                    let (x, y, radius) = (x?, y?, radius?);
                    let twice = radius.plus(radius);
                    [x.minus(radius), y.minus(radius), twice, twice]
                }
            };
            let [dx, dy] = offset;
            let is_there = width.high > 0.0 && height.high > 0.0 && presence.can_hold;
            let is_sure = !presence.can_fail && width.low > 0.0 && height.low > 0.0 && !c.shape.is_round();
            let corner = [x.plus(dx?), y.plus(dy?)];
            is_there.then_some(Moved { corner, size: [width, height], is_sure })
        };
        own.filter_map(moved).collect()
    }

    /// The outcomes of a probe at some positions, an interval per axis.
    fn probe_at(&self, look: &Look, place: Corner, at: &Configuration) -> Truth {
        let mut out = Truth { can_hold: false, can_fail: false };
        for space in at.spaces.iter() {
            let mut here = Truth { can_hold: false, can_fail: true };
            for (_, moved, statics) in look.own.iter().filter(|(of, ..)| of == space) {
                let found = self.overlap_in(*space, look, moved, statics.as_deref(), moved.at(place));
                here.can_hold |= found.can_hold;
                here.can_fail &= found.can_fail;
            }
            out.can_hold |= here.can_hold;
            out.can_fail |= here.can_fail;
        }
        out
    }

    /// Whether a box in a space can overlap something with the tag of a probe, and whether it can overlap nothing; `corner`
    /// are the positions of its lower-left corner, `statics` what it may overlap of what never moves.
    fn overlap_in(
        &self,
        space: SpaceId,
        look: &Look,
        moved: &Moved,
        statics: Option<&[Overlap]>,
        corner: Corner,
    ) -> Truth {
        // Beyond a seam there is more.
        let Some(statics) = statics.filter(|_| !self.world.spaces[space].wraps()) else { return Truth::EITHER };
        let mut out = Truth { can_hold: false, can_fail: true };
        if !look.asked.bound || look.asked.tiles {
            out.can_hold = statics.iter().any(|there| there.can_be(corner));
            let mut pieces = MAX_PIECES;
            out.can_fail = !(out.can_hold && moved.is_sure && is_covered(corner, statics, &mut pieces));
        }
        let me = self.me.map(|(me, _)| me);
        for there in look.there.iter().filter(|there| Some(there.slot) != me) {
            let spaces = &self.slots[there.slot].spaces;
            if !spaces.contains(&space) {
                continue;
            }
            out.can_hold = out.can_hold || there.boxes().any(|b| moved.overlap(&b).can_be(corner));
            if out.can_fail && there.is_sure && spaces.len() == 1 && moved.is_sure {
                let mut boxes = there.boxes().peekable();
                // What always lies between two positions is there at each of them.
                out.can_fail =
                    boxes.peek().is_none() || !boxes.all(|b| moved.overlap(&there.inner(&b)).must_be(corner));
            }
        }
        out
    }

    /// The tiles and rectangles of a space with the tag that a box may overlap; `None` if they are too many.
    fn statics_near(&self, space: SpaceId, asked: &Asked, moved: &Moved, corner: Corner) -> Option<Vec<Overlap>> {
        let space = &self.world.spaces[space];
        let near = |b: Bounds| Some(moved.overlap(&b)).filter(|there| there.can_be(corner));
        // Where a name is given, only tiles that are declared breakable have one, and perhaps none of these is one.
        let named = asked.bound;
        let rects = space.solids.iter().filter(|s| !named && s.tags.meets(asked.other)).map(|s| s.bounds);
        let mut out: Vec<Overlap> = rects.filter_map(near).take(MAX_OBSTACLES + 1).collect();
        let has = |kind: &usize, map: &crate::ir::TileMap<TagId>| {
            map.kinds.get(*kind).is_some_and(|kind| kind.tags.contains(&asked.tag))
        };
        if let Some(map) = space.map.as_ref().filter(|map| (0..map.kinds.len()).any(|kind| has(&kind, map))) {
            let range = |axis: usize, size: f64, count: usize| {
                let end = |x: f64| ((x / size).floor().clamp(-1.0, count as f64) + 1.0) as usize;
                let [low, high] = [corner[axis].low - 1.0, corner[axis].high + moved.size[axis].high + 1.0].map(end);
                low.saturating_sub(1)..high.min(count)
            };
            let (columns, rows) = (range(0, map.tile.0, map.columns), range(1, map.tile.1, map.rows));
            if columns.len().saturating_mul(rows.len()) > MAX_CELLS {
                return None;
            }
            for row in rows {
                for column in columns.clone() {
                    let kind = map.cells.get(row * map.columns + column).map(|kind| usize::from(*kind));
                    if kind.is_some_and(|kind| has(&kind, map)) {
                        let (left, bottom) = (column as f64 * map.tile.0, row as f64 * map.tile.1);
                        let bounds = Bounds { left, right: left + map.tile.0, bottom, top: bottom + map.tile.1 };
                        let lasts = !named && kind.is_some_and(|kind| map.kinds[kind].lasts());
                        out.extend(near(bounds).map(|there| Overlap { lasts, ..there }));
                    }
                }
            }
        }
        (out.len() <= MAX_OBSTACLES).then_some(out)
    }

    /// The colliders of instances with the tag of a probe, wherever they can be.
    fn tagged(&self, asked: &Asked) -> Arc<[There]> {
        let key = (asked.tag, self.is_within_step());
        let mut known = self.joined.probed.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.entry(key).or_insert_with(|| {
            let living = self.world.slots.ids().filter(|slot| self.slots[*slot].can_live);
            let of = |slot: SlotId| {
                let entity = self.entity(slot);
                let colliders = entity.colliders.iter().filter(|c| c.tags.meets(asked.other));
                colliders.filter_map(move |c| self.there(slot, entity, c))
            };
            living.flat_map(of).collect()
        });
        Arc::clone(found)
    }

    /// Where a collider of another instance can be; `None` if it never is.
    fn there(&self, slot: SlotId, entity: &Entity, collider: &Collider) -> Option<There> {
        let o = &self.slots[slot];
        let mut leaves = o.leaves.clone();
        leaves.extend(self.mid_step(o).into_iter().flat_map(|mid_step| &mid_step.leaves));
        let presence = Presence::of(self.program, entity, collider.guard);
        let presence = presence.map_or(Truth::EITHER, |presence| presence.among(&leaves));
        let params: IdVec<ParamId, f64> = o.params.iter().map(|p| p.constant().unwrap_or(f64::NAN)).collect();
        let sides = collider.shape.sides(|id| self.program.constant(id, &params, self.world.step));
        let is_empty = sides.is_some_and(|[.., width, height]| width <= 0.0 || height <= 0.0);
        if !presence.can_hold || is_empty {
            return None;
        }
        let at = [VarId::X, VarId::Y].map(|var| self.var(o, var, 0).unwrap_or(Values::all()));
        let Some([x, y, width, height]) = sides else {
            return Some(There { slot, at: [Values::all(); 2], size: [0.0; 2], is_sure: false });
        };
        let is_sure = !presence.can_fail && !o.can_be_absent && !collider.shape.is_round();
        let at = [at[0].map(|i| i.map(|at| at + x)), at[1].map(|i| i.map(|at| at + y))];
        Some(There { slot, at, size: [width, height], is_sure })
    }
}

impl Look {
    /// Along an axis, the positions at which the outcome can change by static obstacles, in order; `None` if there are too
    /// many.
    fn cuts(&self, axis: usize) -> Option<Vec<f64>> {
        let mut cuts = Vec::new();
        for (_, moved, statics) in &self.own {
            for there in statics.as_ref()? {
                let (must, can) = (there.must[axis], there.can[axis]);
                let corner = moved.corner[axis];
                // A little inside of what is certain, and outside of what is possible: sums are rounded.
                let inside = [must.0 - corner.low, must.1 - corner.high];
                let outside = [can.0 - corner.high, can.1 - corner.low];
                let ends = [
                    inside[0] + rounding(inside[0]),
                    inside[1] - rounding(inside[1]),
                    outside[0] - rounding(outside[0]),
                    outside[1] + rounding(outside[1]),
                ];
                cuts.extend(ends.into_iter().filter(|x| x.is_finite()));
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        (cuts.len() <= 2 * MAX_PIECES).then_some(cuts)
    }
}

impl There {
    /// The boxes that contain it.
    fn boxes(&self) -> impl Iterator<Item = Bounds> + Clone {
        let [width, height] = self.size;
        self.at[0].intervals().iter().flat_map(move |x| {
            self.at[1].intervals().iter().map(move |y| Bounds {
                left: x.low,
                right: x.high + width,
                bottom: y.low,
                top: y.high + height,
            })
        })
    }

    /// The part of a box that contains it which it always fills; empty if it moves by more than its size.
    fn inner(&self, around: &Bounds) -> Bounds {
        let [width, height] = self.size;
        Bounds {
            left: around.right - width,
            right: around.left + width,
            bottom: around.top - height,
            top: around.bottom + height,
        }
    }
}

impl Moved {
    /// The positions of its lower-left corner where the instance is at some positions.
    fn at(&self, place: Corner) -> Corner {
        [place[0].plus(self.corner[0]), place[1].plus(self.corner[1])]
    }

    /// Where its lower-left corner is if it overlaps a box.
    fn overlap(&self, b: &Bounds) -> Overlap {
        Overlap { must: self.ends(b, |size| size.low, 1.0), can: self.ends(b, |size| size.high, -1.0), lasts: true }
    }

    /// Per axis, the ends of its lower-left corner for a length; `sign` tells whether rounding errors narrow them.
    fn ends(&self, b: &Bounds, length: fn(Interval) -> f64, sign: f64) -> [(f64, f64); 2] {
        let along = |axis: usize, (low, high): (f64, f64)| {
            let length = length(self.size[axis]);
            let error = 2.0 * (rounding(low) + rounding(high) + rounding(length));
            let slack = TOLERANCE + sign * error;
            (low - length + slack, high - slack)
        };
        [along(0, (b.left, b.right)), along(1, (b.bottom, b.top))]
    }
}

impl Overlap {
    fn can_be(&self, corner: Corner) -> bool {
        let [x, y] = corner;
        let [(left, right), (bottom, top)] = self.can;
        x.high >= left && x.low <= right && y.high >= bottom && y.low <= top
    }

    fn must_be(&self, corner: Corner) -> bool {
        let [x, y] = corner;
        let [(left, right), (bottom, top)] = self.must;
        self.lasts && left <= x.low && x.high <= right && bottom <= y.low && y.high <= top
    }

    /// The part of some positions where it must.
    fn part(&self, corner: Corner) -> Option<Corner> {
        let within = |axis: usize| {
            let (low, high) = self.must[axis];
            corner[axis].and(Interval { low, high }).filter(|_| self.lasts && low <= high)
        };
        Some([within(0)?, within(1)?])
    }
}

/// Whether a box overlaps something wherever its corner is: what one obstacle does not cover, others do.
fn is_covered(corner: Corner, statics: &[Overlap], pieces: &mut usize) -> bool {
    if statics.iter().any(|there| there.must_be(corner)) {
        return true;
    }
    // Most places that are not covered show it at an end.
    let [across, up] = corner;
    let ends = [across.low, across.high].into_iter().flat_map(|x| [[x, up.low], [x, up.high]]);
    let is_open = |end: [f64; 2]| !statics.iter().any(|there| there.must_be(end.map(Interval::point)));
    let Some(left) = pieces.checked_sub(1).filter(|_| !ends.into_iter().any(is_open)) else { return false };
    *pieces = left;
    let size = |part: &Corner| (part[0].high - part[0].low) + (part[1].high - part[1].low);
    let parts = statics.iter().filter_map(|there| there.part(corner));
    let Some([x, y]) = parts.max_by(|a, b| size(a).total_cmp(&size(b))) else { return false };
    let beside = [
        (across.low < x.low, [Interval { low: across.low, high: x.low }, up]),
        (x.high < across.high, [Interval { low: x.high, high: across.high }, up]),
        (up.low < y.low, [x, Interval { low: up.low, high: y.low }]),
        (y.high < up.high, [x, Interval { low: y.high, high: up.high }]),
    ];
    beside.into_iter().all(|(is_some, rest)| !is_some || is_covered(rest, statics, pieces))
}

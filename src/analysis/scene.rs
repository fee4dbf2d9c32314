//! What the colliders of a world can meet, as far as it never changes: bodies of one kind share it, per space.

use std::collections::BTreeMap;

use crate::ir::{
    Actions, Bounds, Drive, EntityId, Id, IdVec, Meeting, Origin, ParamId, Place, Program, Push, Shape, Side, SlotId,
    SpaceId, TagSet, Touch, VarId, World,
};

use super::values::{Interval, Values};

/// Edges that meet are this near, px: positions are rounded.
pub(super) const ROUNDING: f64 = 1e-6;

/// A box relative to a position, px: of both axes, from its low to its high end.
pub(super) type Extent = [Interval; 2];

/// A collider of a kind.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub tags: TagSet,
    /// Whether it is never pushed.
    pub kinematic: bool,
    /// Its box, where that is always the same.
    pub extent: Option<Extent>,
    /// Whether it is always there, and its box always the same.
    pub is_steady: bool,
}

/// Slots whose colliders are the same.
#[derive(Debug, Clone)]
pub(super) struct Kind {
    pub entity: EntityId,
    pub slots: Vec<SlotId>,
    pub bodies: Vec<Body>,
    /// Whether something can put an instance inside of what blocks it.
    pub jumps: bool,
}

/// A body of a kind meets a body of another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub mine: usize,
    pub kind: usize,
    pub theirs: usize,
    pub meeting: Meeting,
}

/// Where pushes put an instance, along an axis: by the low and by the high side of its colliders, in order.
pub(super) type Edges = [[Vec<Interval>; 2]; 2];

/// What bodies of a kind meet in a space that never moves.
#[derive(Debug, Clone, Default)]
pub(super) struct Statics {
    /// Of each contact question, whether it can hold.
    pub touchable: Vec<bool>,
    /// Of each contact question, whether all that it asks for here pushes the body that asks.
    pub pushed: Vec<bool>,
    pub edges: Edges,
    pub pushes: bool,
    /// Whether some push stops the velocity into the surface.
    pub stops: bool,
    /// Whether some push does not.
    pub slips: bool,
    /// Whether a push can end anywhere: the body that is pushed is not always the same.
    pub anywhere: bool,
}

/// The kinds of a world, and what they meet.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub kinds: Vec<Kind>,
    /// The kind of each slot.
    pub of: IdVec<SlotId, usize>,
    /// Of each kind, what its bodies meet of others.
    pub pairs: Vec<Vec<Pair>>,
    statics: BTreeMap<(usize, SpaceId), Statics>,
}

/// The place in `Edges` of the pushes by a contact on a side.
pub(super) fn face(side: Side) -> (usize, usize) {
    match side {
        Side::Left => (0, 0),
        Side::Right => (0, 1),
        Side::Below => (1, 0),
        Side::Above => (1, 1),
    }
}

/// The sides on which a meeting can push the first of the two.
pub(super) fn sides(meeting: Meeting) -> impl Iterator<Item = Side> {
    let can = move |side: &Side| match meeting.response.push {
        Push::Sense => false,
        Push::Block => true,
        Push::FromAbove => match side {
            Side::Below => meeting.first_on_second,
            Side::Above => meeting.second_on_first,
            Side::Left | Side::Right => false,
        },
    };
    [Side::Left, Side::Right, Side::Below, Side::Above].into_iter().filter(can)
}

impl<'a> Scene<'a> {
    pub fn new(program: &'a Program, world: &'a World) -> Self {
        let mut numbers: BTreeMap<(EntityId, bool, Vec<u64>, bool), usize> = BTreeMap::new();
        let mut scene =
            Scene { program, world, kinds: Vec::new(), of: IdVec::new(), pairs: Vec::new(), statics: BTreeMap::new() };
        for (slot, s) in world.slots.pairs() {
            let bodies = scene.bodies(s.entity, &s.params.iter().map(|p| Values::point(*p)).collect());
            let jumps = may_jump(program, world, slot) || begins_inside(world, slot, &bodies);
            let params: Vec<u64> = s.params.iter().map(|p| p.to_bits()).collect();
            let next = numbers.len();
            let number = *numbers.entry((s.entity, s.origin == Origin::Named, params, jumps)).or_insert(next);
            if number == scene.kinds.len() {
                scene.kinds.push(Kind { entity: s.entity, slots: Vec::new(), bodies, jumps });
            }
            scene.kinds[number].slots.push(slot);
            scene.of.push(number);
        }
        scene.pair_up();
        scene
    }

    /// The parameters of the slots of a kind can be more than before.
    pub fn reshape(&mut self, slot: SlotId, params: &IdVec<ParamId, Values>) {
        let kind = self.of[slot];
        self.kinds[kind].bodies = self.bodies(self.kinds[kind].entity, params);
        self.statics.retain(|(k, _), _| *k != kind);
    }

    /// Finds out what a kind meets in a space, if that is not known yet.
    pub fn prepare(&mut self, kind: usize, space: SpaceId) {
        if !self.statics.contains_key(&(kind, space)) {
            let found = self.look(&self.kinds[kind], space);
            self.statics.insert((kind, space), found);
        }
    }

    /// What a kind meets in a space; none if that has not been prepared.
    pub fn statics(&self, kind: usize, space: SpaceId) -> Option<&Statics> {
        self.statics.get(&(kind, space))
    }

    /// All edges that are known.
    pub fn edges(&self) -> impl Iterator<Item = Interval> + '_ {
        self.statics.values().flat_map(|s| s.edges.iter().flatten().flatten().copied())
    }

    fn pair_up(&mut self) {
        let pairs = |me: &Kind| {
            let mut found = Vec::new();
            for (mine, body) in me.bodies.iter().enumerate() {
                for (kind, other) in self.kinds.iter().enumerate() {
                    let met = other.bodies.iter().enumerate();
                    let met = met.filter_map(|(theirs, o)| {
                        let meeting = self.world.meeting(body.tags, o.tags)?;
                        Some(Pair { mine, kind, theirs, meeting })
                    });
                    found.extend(met);
                }
            }
            found
        };
        self.pairs = self.kinds.iter().map(pairs).collect();
    }

    fn bodies(&self, entity: EntityId, params: &IdVec<ParamId, Values>) -> Vec<Body> {
        let known: IdVec<ParamId, f64> = params.iter().map(|p| p.constant().unwrap_or(f64::NAN)).collect();
        let number = |id| self.program.constant(id, &known, self.world.step);
        let body = |c: &crate::ir::Collider| {
            let sides = match c.shape {
                Shape::Rect([x, y, width, height]) => {
                    (|| Some([number(x)?, number(y)?, number(width)?, number(height)?]))()
                }
                Shape::Circle([x, y, r]) => (|| {
                    let (x, y, r) = (number(x)?, number(y)?, number(r)?);
                    Some([x - r, y - r, 2.0 * r, 2.0 * r])
                })(),
            };
            let extent = sides.map(|[x, y, width, height]| {
                [Interval { low: x, high: x + width }, Interval { low: y, high: y + height }]
            });
            Body { tags: c.tags, kinematic: c.kinematic, extent, is_steady: extent.is_some() && c.guard.is_none() }
        };
        self.program.entities[entity].colliders.iter().map(body).collect()
    }

    fn look(&self, kind: &Kind, space: SpaceId) -> Statics {
        let (world, entity) = (self.world, &self.program.entities[kind.entity]);
        let mut out = Statics::default();
        let tile_tags: Vec<TagSet> = tile_tags(world, space);
        let solids = &world.spaces[space].solids;
        let tags: Vec<TagSet> = tile_tags.iter().copied().chain(solids.iter().map(|s| s.tags)).collect();
        let asking = |touch: &Touch| kind.bodies.iter().filter(|b| b.tags.meets(touch.mine)).collect::<Vec<_>>();
        for touch in entity.touches.iter() {
            let asked: Vec<TagSet> = tags.iter().copied().filter(|t| t.meets(TagSet::of(touch.other))).collect();
            let met: Vec<(&Body, Option<Meeting>)> = asking(touch)
                .into_iter()
                .flat_map(|b| asked.iter().map(move |t| (b, world.meeting(b.tags, *t))))
                .collect();
            out.touchable.push(!touch.bound && met.iter().any(|(_, m)| m.is_some()));
            let blocks = |b: &Body, m: &Meeting| m.response.push != Push::Sense && !b.kinematic;
            out.pushed.push(met.iter().all(|(b, m)| m.as_ref().is_none_or(|m| blocks(b, m))));
        }
        for body in kind.bodies.iter().filter(|b| !b.kinematic) {
            let pushing = |t: TagSet| world.meeting(body.tags, t).filter(|m| m.response.push != Push::Sense);
            for meeting in tags.iter().filter_map(|t| pushing(*t)) {
                out.pushes = true;
                out.stops |= meeting.response.stop;
                out.slips |= !meeting.response.stop;
                out.anywhere |= body.extent.is_none();
            }
            let Some(extent) = body.extent else { continue };
            for solid in solids {
                if let Some(meeting) = pushing(solid.tags) {
                    let Bounds { left, right, bottom, top } = solid.bounds;
                    add_edges(&mut out.edges, meeting, extent, [(left, right), (bottom, top)]);
                }
            }
            let Some(map) = &world.spaces[space].map else { continue };
            for (kind, tags) in tile_tags.iter().enumerate() {
                let Some(meeting) = pushing(*tags) else { continue };
                let (mut columns, mut rows) = (vec![false; map.columns], vec![false; map.rows]);
                for (at, _) in map.cells.iter().enumerate().filter(|(_, k)| usize::from(**k) == kind) {
                    columns[at % map.columns] = true;
                    rows[at / map.columns] = true;
                }
                let lines = |on: &[bool], size: f64| {
                    let on = on.iter().enumerate().filter(|(_, on)| **on);
                    on.map(|(i, _)| (i as f64 * size, i as f64 * size + size)).collect::<Vec<(f64, f64)>>()
                };
                for (axis, lines) in [lines(&columns, map.tile.0), lines(&rows, map.tile.1)].into_iter().enumerate() {
                    for line in lines {
                        add_axis(&mut out.edges, meeting, extent, axis, line);
                    }
                }
            }
        }
        out.edges.iter_mut().flatten().for_each(disjoin);
        out
    }
}

/// Puts intervals in order and joins those that meet.
pub(super) fn disjoin(edges: &mut Vec<Interval>) {
    edges.sort_by(|a, b| a.low.total_cmp(&b.low));
    edges.dedup_by(|next, last| {
        let meets = next.low <= last.high;
        if meets {
            last.high = last.high.max(next.high);
        }
        meets
    });
}

/// The tags of each kind of tile of a space's map.
pub(super) fn tile_tags(world: &World, space: SpaceId) -> Vec<TagSet> {
    let kinds = world.spaces[space].map.iter().flat_map(|m| &m.kinds);
    kinds.map(|k| k.tags.iter().copied().collect()).collect()
}

fn add_edges(edges: &mut Edges, meeting: Meeting, extent: Extent, sides: [(f64, f64); 2]) {
    for (axis, line) in sides.into_iter().enumerate() {
        add_axis(edges, meeting, extent, axis, line);
    }
}

/// Where something from `low` to `high` along an axis pushes a body.
fn add_axis(edges: &mut Edges, meeting: Meeting, extent: Extent, axis: usize, (low, high): (f64, f64)) {
    for side in sides(meeting).filter(|s| face(*s).0 == axis) {
        let at = match face(side).1 {
            0 => high - extent[axis].low,
            _ => low - extent[axis].high,
        };
        edges[axis][face(side).1].push(Interval { low: at - ROUNDING, high: at + ROUNDING });
    }
}

/// Whether an instance is spawned, goes through links, or is put somewhere by an update, a flow or a clamp.
fn may_jump(program: &Program, world: &World, slot: SlotId) -> bool {
    let s = &world.slots[slot];
    let entity = &program.entities[s.entity];
    let is_position = |var: VarId| var.index() < 2;
    let updates = |a: &Actions| a.updates.iter().any(|u| matches!(u.place, Place::Var(var, 0) if is_position(var)));
    let actions = entity.edges.iter().map(|e| &e.actions).chain(entity.modes.iter().map(|m| &m.entry));
    let drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|l| &l.drives));
    s.origin != Origin::Named
        || !entity.follows.is_empty()
        || actions.into_iter().any(updates)
        || entity.clamps.iter().any(|c| c.degree == 0 && is_position(c.var))
        || drives.into_iter().any(|d| matches!(d, Drive::Flow { var, degree: 0, .. } if is_position(*var)))
        || entity.envelopes.iter().any(|e| e.degree == 0 && e.vars.iter().any(|v| is_position(*v)))
}

/// Whether a slot's instance is placed inside of what blocks it.
fn begins_inside(world: &World, slot: SlotId, bodies: &[Body]) -> bool {
    let s = &world.slots[slot];
    let at = |axis: u32| s.vars.get(VarId(axis)).map_or(0.0, |v| v[0]);
    let space = &world.spaces[s.space];
    bodies.iter().filter(|b| !b.kinematic).any(|body| {
        let Some(extent) = body.extent else { return true };
        let side = |axis: usize| Interval {
            low: extent[axis].low + at(axis as u32) + ROUNDING,
            high: extent[axis].high + at(axis as u32) - ROUNDING,
        };
        let (x, y) = (side(0), side(1));
        let blocks = |tags: TagSet| world.meeting(body.tags, tags).is_some_and(|m| m.response.push != Push::Sense);
        let solids = space.solids.iter().filter(|s| blocks(s.tags)).map(|s| s.bounds);
        let mut inside =
            solids.into_iter().any(|b| x.low < b.right && b.left < x.high && y.low < b.top && b.bottom < y.high);
        if let Some(map) = &space.map {
            let tags = tile_tags(world, s.space);
            let cells = |i: Interval, size: f64, count: usize| {
                let cell = |x: f64| (x / size).floor().clamp(0.0, count as f64) as usize;
                cell(i.low)..(cell(i.high) + 1).min(count)
            };
            let rows = cells(y, map.tile.1, map.rows);
            inside |= rows.flat_map(|row| cells(x, map.tile.0, map.columns).map(move |c| (row, c))).any(|(row, c)| {
                let kind = map.cells.get(row * map.columns + c);
                kind.and_then(|k| tags.get(usize::from(*k))).is_some_and(|t| blocks(*t))
            });
        }
        inside
    })
}

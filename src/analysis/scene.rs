//! What the colliders of a world can meet, as far as it never changes: bodies of one kind share it, per space.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::ir::{
    Actions, Bounds, Drive, EdgeId, Entity, EntityId, Expr, Group, Id, IdVec, Meeting, Origin, ParamId, Place, Program,
    Push, Shape, Side, SlotId, SpaceId, TagSet, VarId, World,
};

use crate::watch::{Meter, Watch};

use super::cells::{Cells, near_statics};
use super::local::Surfaces;
use super::region::Region;
use super::step::Landing;
use super::tiles::Tiles;
use super::values::{Interval, Values};

/// Edges that meet are this near, px: positions are rounded.
pub(super) const ROUNDING: f64 = 1e-6;

/// More places than that where instances are put are not told apart.
const MOST_SEEDS: usize = 64;

/// How far inside of a platform something may have stood that comes from above, px; as the simulator has it.
pub(super) const TOLERANCE: f64 = 0.001;
/// Beyond this coordinates are too coarse for what is known of pushes to hold, px.
const MAX_COORDINATE: f64 = (1_u64 << 26) as f64;

/// How much rounding can shift where edges meet at some coordinates, px.
pub(super) fn rounding(at: f64) -> f64 {
    ROUNDING + at.abs() * 1e-12
}

/// An interval, and what is so near to it that only rounding tells them apart.
pub(super) fn rounded(i: Interval) -> Interval {
    Interval { low: i.low - rounding(i.low), high: i.high + rounding(i.high) }
}

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
    /// Whether it is always there.
    pub is_steady: bool,
}

/// Slots whose colliders are the same.
#[derive(Debug, Clone)]
pub(super) struct Kind {
    pub entity: EntityId,
    pub slots: Vec<SlotId>,
    pub bodies: Vec<Body>,
    /// Whether something can put an instance inside of what pushes it, or through it.
    pub jumps: bool,
    /// Where its instances are told apart.
    pub cells: Cells,
    /// The positions at which an instance can meet anything that never moves.
    pub near: Option<Extent>,
    /// Where its cells are fine: what never moves, in each space.
    pub surfaces: Vec<(SpaceId, Arc<Surfaces>)>,
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
#[derive(Debug, Clone)]
pub(super) struct Statics {
    /// Of each contact question, along both axes, where an instance is when it holds.
    pub places: Vec<[Vec<Interval>; 2]>,
    /// Of each contact question, whether all that it asks for here pushes the body that asks.
    pub pushed: Vec<bool>,
    /// Where pushes put it.
    pub edges: Edges,
    /// So, where what pushes it is not deep inside of other things: by faces that no neighbour covers.
    pub faces: Edges,
    /// Of both axes, the size of the thinnest thing that pushes it, px; infinite if there is none.
    pub thinnest: [f64; 2],
    /// Of both axes, how far a push can be, px.
    pub longest: [f64; 2],
    pub pushes: bool,
    /// Whether some push stops the velocity into the surface.
    pub stops: bool,
    /// Whether some push does not.
    pub slips: bool,
    /// Whether a push can end anywhere: the body that is pushed is not always the same.
    pub anywhere: bool,
    /// Whether what is pushed is always there.
    pub is_steady: bool,
}

/// The kinds of a world, and what they meet.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub kinds: Vec<Kind>,
    /// Of each entity, the groups whose leaves decide how its variables flow; none if time does, too.
    pub flowing: IdVec<EntityId, Option<Vec<bool>>>,
    /// Of each entity, the edges whose way depends on where the instance is and how it moves.
    pub moving: IdVec<EntityId, IdVec<EdgeId, bool>>,
    /// The kind of each slot.
    pub of: IdVec<SlotId, usize>,
    /// Of each kind, what its bodies meet of others.
    pub pairs: Vec<Vec<Pair>>,
    /// Counts the work of finding all this. Once it is stopped, what is known is not all there is.
    pub meter: Meter<'a>,
    statics: BTreeMap<(usize, SpaceId), Statics>,
    /// Where instances of a kind are put.
    seeds: BTreeMap<(usize, SpaceId), Vec<[Interval; 2]>>,
    /// Where those of a kind get from there, with the length of their steps, px, and the number of seeds.
    regions: BTreeMap<(usize, SpaceId), (f64, usize, Option<Region>)>,
}

/// How far a step goes, px, rounded up, so that what comes of it is not found anew for each growth.
pub(super) fn rounded_step(far: f64) -> f64 {
    (2.0 * far).ceil() / 2.0
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
pub(super) fn sides_of(meeting: Meeting) -> impl Iterator<Item = Side> {
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
    pub fn new(program: &'a Program, world: &'a World, watch: &'a dyn Watch) -> Self {
        let mut numbers: BTreeMap<(EntityId, bool, Vec<u64>), usize> = BTreeMap::new();
        let mut scene = Scene {
            program,
            world,
            kinds: Vec::new(),
            moving: program.entities.iter().map(moving).collect(),
            flowing: program.entities.ids().map(|e| flowing(program, e)).collect(),
            of: IdVec::new(),
            pairs: Vec::new(),
            meter: Meter::new(watch),
            statics: BTreeMap::new(),
            seeds: BTreeMap::new(),
            regions: BTreeMap::new(),
        };
        for (slot, s) in world.slots.pairs() {
            let params: Vec<u64> = s.params.iter().map(|p| p.to_bits()).collect();
            let next = numbers.len();
            let number = *numbers.entry((s.entity, s.origin == Origin::Named, params)).or_insert(next);
            if number == scene.kinds.len() {
                let bodies = scene.bodies(s.entity, &s.params.iter().map(|p| Values::point(*p)).collect());
                let jumps = drives_position(program, s.entity);
                let cells = Cells::whole();
                let (slots, surfaces) = (Vec::new(), Vec::new());
                let mut kind = Kind { entity: s.entity, slots, bodies, jumps, cells, near: None, surfaces };
                kind.near = near_statics(world, &kind);
                kind.cells = Cells::around(&kind);
                scene.kinds.push(kind);
            }
            scene.kinds[number].slots.push(slot);
            scene.of.push(number);
        }
        scene.pair_up();
        scene
    }

    /// Tells players apart by place; returns false if there are none of whom that can be done.
    pub fn refine(&mut self) -> bool {
        let mut is_refined = false;
        for number in 0..self.kinds.len() {
            let kind = &self.kinds[number];
            if kind.slots.iter().any(|s| self.world.slots[*s].player.is_none()) {
                continue;
            }
            let surfaces = self.world.spaces.ids().map(|s| Some((s, Arc::new(Surfaces::new(self.world, kind, s)?))));
            let Some(surfaces) = surfaces.collect::<Option<Vec<_>>>() else { continue };
            let blocking = |space| self.blocking(kind, space);
            let entity = &self.program.entities[kind.entity];
            if let Some(cells) = Cells::fine(kind, entity, &surfaces, blocking) {
                self.kinds[number].cells = cells;
                self.kinds[number].surfaces = surfaces;
                is_refined = true;
            }
        }
        is_refined
    }

    /// The parameters of the slots of a kind can be more than before.
    pub fn reshape(&mut self, slot: SlotId, params: &IdVec<ParamId, Values>) {
        let kind = self.of[slot];
        self.kinds[kind].bodies = self.bodies(self.kinds[kind].entity, params);
        self.kinds[kind].near = near_statics(self.world, &self.kinds[kind]);
        self.statics.retain(|(k, _), _| *k != kind);
        self.regions.retain(|(k, _), _| *k != kind);
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

    /// Something puts instances of a kind somewhere; gives whether that is new.
    pub fn seed(&mut self, kind: usize, space: SpaceId, at: [Interval; 2]) -> bool {
        let known = self.seeds.entry((kind, space)).or_default();
        let is_known = known.iter().any(|k| (0..2).all(|a| k[a].low <= at[a].low && at[a].high <= k[a].high));
        if !is_known {
            known.push(at);
            if known.len() > MOST_SEEDS {
                let hull = known.iter().copied().reduce(|a, b| [a[0].or(b[0]), a[1].or(b[1])]);
                known.clear();
                known.extend(hull);
                self.regions.remove(&(kind, space));
            }
        }
        !is_known
    }

    /// Where instances of a kind can get in a space, if a step moves them by at most `far` px along each axis. None if
    /// that is not known.
    pub fn region(&mut self, kind: usize, space: SpaceId, far: f64) -> Option<&Region> {
        if !far.is_finite() {
            return None;
        }
        let far = rounded_step(far);
        let seeds = self.seeds.get(&(kind, space)).map_or(&[][..], Vec::as_slice);
        let known = self.regions.get(&(kind, space));
        if known.is_none_or(|(f, count, _)| *f != far || *count != seeds.len()) {
            let found = self.flooded(kind, space, seeds, far);
            let count = seeds.len();
            self.regions.insert((kind, space), (far, count, found));
        }
        self.regions.get(&(kind, space))?.2.as_ref()
    }

    /// All edges that are known.
    pub fn edges(&self) -> impl Iterator<Item = Interval> + '_ {
        self.statics.values().flat_map(|s| s.edges.iter().flatten().flatten().copied())
    }

    fn pair_up(&mut self) {
        let pairs = |me: &Kind| {
            let mut found = Vec::new();
            for (mine, body) in me.bodies.iter().enumerate() {
                if self.meter.spend(self.kinds.len() as u64) {
                    break;
                }
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
            Body { tags: c.tags, kinematic: c.kinematic, extent, is_steady: c.guard.is_none() }
        };
        self.program.entities[entity].colliders.iter().map(body).collect()
    }

    /// The size of a body along both axes, px; infinite where it is not always the same.
    pub fn size(body: &Body) -> [f64; 2] {
        body.extent.map_or([f64::INFINITY; 2], |e| e.map(|i| i.high - i.low))
    }

    fn look(&self, kind: &Kind, space: SpaceId) -> Statics {
        let (world, entity) = (self.world, &self.program.entities[kind.entity]);
        let mut out = Statics::default();
        let tiles = Tiles::new(world, space);
        let solids = &world.spaces[space].solids;
        let tags: Vec<TagSet> = tiles.tags.iter().copied().chain(solids.iter().map(|s| s.tags)).collect();
        for touch in entity.touches.iter() {
            let asking: Vec<&Body> = kind.bodies.iter().filter(|b| b.tags.meets(touch.mine)).collect();
            let mut places = [Vec::new(), Vec::new()];
            let mut pushed = true;
            for (body, tags) in asking.iter().flat_map(|b| tags.iter().map(move |t| (b, *t))) {
                let Some(meeting) = world.meeting(body.tags, tags) else { continue };
                if touch.bound || !tags.meets(TagSet::of(touch.other)) {
                    continue;
                }
                pushed &= meeting.response.push != Push::Sense && !body.kinematic;
                let boxes = solids.iter().filter(|s| s.tags == tags).map(|s| along(s.bounds));
                let (columns, rows) = tiles.lines(|at| tiles.tag(at) == tags);
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
        for body in kind.bodies.iter().filter(|b| !b.kinematic) {
            self.pushes(body, space, &tiles, &mut out);
        }
        out.edges.iter_mut().chain(&mut out.faces).flatten().for_each(disjoin);
        out
    }

    /// What never moves and pushes a body.
    fn pushes(&self, body: &Body, space: SpaceId, tiles: &Tiles<'_>, out: &mut Statics) {
        let pushing = |t: TagSet| self.world.meeting(body.tags, t).filter(|m| m.response.push != Push::Sense);
        let own = Self::size(body);
        let mut met = |meeting: Meeting, sizes: [f64; 2]| {
            out.pushes = true;
            out.stops |= meeting.response.stop;
            out.slips |= !meeting.response.stop;
            out.anywhere |= body.extent.is_none();
            out.is_steady &= body.is_steady;
            for axis in 0..2 {
                out.thinnest[axis] = out.thinnest[axis].min(sizes[axis]);
                out.longest[axis] = out.longest[axis].max(sizes[axis] + own[axis]);
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
        let beside_solids = self.world.spaces[space].solids.iter().any(|s| pushing(s.tags).is_some());
        let meetings: Vec<Option<Meeting>> = tiles.tags.iter().map(|t| pushing(*t)).collect();
        let blocks: Vec<bool> = meetings.iter().map(|m| m.is_some_and(|m| m.response.push == Push::Block)).collect();
        for (kind, meeting) in meetings.iter().enumerate().filter_map(|(k, m)| Some((k, (*m)?))) {
            if !tiles.has(kind) {
                continue;
            }
            met(meeting, tiles.size());
            let Some(extent) = body.extent else { continue };
            for side in sides_of(meeting) {
                let (axis, end) = face(side);
                let all = tiles.lines(|at| tiles.kind(at) == Some(kind));
                // What is open from one side pushes whatever covers it. Beside a rectangle, what goes into a corner can be
                // pushed to a face that is covered.
                let covers = |at| tiles.neighbour(at, side).is_some_and(|k| blocks[k]);
                let covered = |at| meeting.response.push == Push::Block && !beside_solids && covers(at);
                let open = tiles.lines(|at| tiles.kind(at) == Some(kind) && !covered(at));
                for (lines, edges) in [(all, &mut out.edges), (open, &mut out.faces)] {
                    let lines = if axis == 0 { lines.0 } else { lines.1 };
                    edges[axis][end].extend(lines.into_iter().map(|line| edge(extent, axis, end, line)));
                }
            }
        }
    }

    /// Whether what is put somewhere in a space can lie inside of what never moves and pushes it.
    pub fn is_inside(&self, kind: usize, space: SpaceId, landing: &Landing) -> bool {
        let [x, y] = landing.at;
        let tiles = Tiles::new(self.world, space);
        let bodies = self.kinds[kind].bodies.iter().enumerate();
        let mut meant = bodies.filter(|(id, b)| !b.kinematic && landing.collider.is_none_or(|c| c.index() == *id));
        meant.any(|(_, body)| {
            let blocks =
                |tags: TagSet| self.world.meeting(body.tags, tags).is_some_and(|m| m.response.push != Push::Sense);
            let solids = self.world.spaces[space].solids.iter().filter(|s| blocks(s.tags));
            let kinds: Vec<bool> = tiles.tags.iter().map(|t| blocks(*t)).collect();
            let Some(extent) = body.extent else { return kinds.contains(&true) || solids.count() > 0 };
            let wide = |at: Interval, e: Interval| Interval {
                low: at.low + e.low + rounding(at.low),
                high: at.high + e.high - rounding(at.high),
            };
            let (x, y) = (wide(x, extent[0]), wide(y, extent[1]));
            let overlaps = |b: Bounds| x.low < b.right && b.left < x.high && y.low < b.top && b.bottom < y.high;
            solids.into_iter().any(|s| overlaps(s.bounds)) || tiles.within(x, y).any(|kind| kinds[kind])
        })
    }

    /// Whether coordinates are small enough everywhere for what is known of pushes to hold to the last bit.
    pub fn is_precise(&self, kind: usize) -> bool {
        let near = self.kinds[kind].near.iter().flatten();
        near.flat_map(|i| [i.low, i.high]).all(|x| x.abs() < MAX_COORDINATE)
    }
}

impl Default for Statics {
    fn default() -> Self {
        Statics {
            places: Vec::new(),
            pushed: Vec::new(),
            edges: Edges::default(),
            faces: Edges::default(),
            thinnest: [f64::INFINITY; 2],
            longest: [0.0; 2],
            pushes: false,
            stops: false,
            slips: false,
            anywhere: false,
            is_steady: true,
        }
    }
}

pub(super) fn along(bounds: Bounds) -> [(f64, f64); 2] {
    [(bounds.left, bounds.right), (bounds.bottom, bounds.top)]
}

/// Where an instance is while a box of its own meets something from `low` to `high`.
pub(super) fn near(extent: Option<Extent>, axis: usize, (low, high): (f64, f64)) -> Interval {
    extent.map_or(Interval::ALL, |e| rounded(Interval { low: low - e[axis].high, high: high - e[axis].low }))
}

/// Where something from `low` to `high` pushes an instance, by the low end of its box or by the high one.
pub(super) fn edge_at(extent: Extent, axis: usize, end: usize, (low, high): (f64, f64)) -> f64 {
    match end {
        0 => high - extent[axis].low,
        _ => low - extent[axis].high,
    }
}

fn edge(extent: Extent, axis: usize, end: usize, sides: (f64, f64)) -> Interval {
    rounded(Interval::point(edge_at(extent, axis, end, sides)))
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

/// The groups whose leaves decide how an entity's variables flow: those that drive them, or all where what drives them
/// asks for modes. None if it reads timers.
fn flowing(program: &Program, entity: EntityId) -> Option<Vec<bool>> {
    let entity = &program.entities[entity];
    let mut asks_for_modes = false;
    for id in program.with_operands(entity.flow_exprs()) {
        match program.exprs[id] {
            Expr::Timer(_) => return None,
            Expr::InMode(..) | Expr::Joint(..) => asks_for_modes = true,
            _ => {}
        }
    }
    let of = |group: &Group| {
        let (first, after) = group.modes;
        let mut leaves = entity.leaves.iter().filter(|l| first <= l.mode && l.mode < after);
        asks_for_modes || leaves.any(|l| !l.drives.is_empty())
    };
    Some(entity.groups.iter().map(of).collect())
}

/// The edges of groups that drive variables, and those that set them or spawn something.
fn moving(entity: &Entity) -> IdVec<EdgeId, bool> {
    let sets = |a: &Actions| !a.spawns.is_empty() || a.updates.iter().any(|u| matches!(u.place, Place::Var(..)));
    let group_moves = |group: &Group| {
        let (first, after) = group.modes;
        let mut leaves = entity.leaves.iter().filter(|l| first <= l.mode && l.mode < after);
        let mut modes = entity.modes.pairs().filter(|(m, _)| first <= *m && *m < after);
        leaves.any(|l| !l.drives.is_empty() || !l.follows.is_empty()) || modes.any(|(_, m)| sets(&m.entry))
    };
    let moves: Vec<bool> = entity.groups.iter().map(group_moves).collect();
    let mut out: IdVec<EdgeId, bool> = entity.edges.iter().map(|e| sets(&e.actions)).collect();
    for leaf in entity.leaves.iter() {
        let group = entity.modes[leaf.mode].group;
        for edge in leaf.edges.iter().filter(|_| moves[group.index()]) {
            out[*edge] = true;
        }
    }
    out
}

/// Whether a flow, an envelope or a clamp sets the position itself.
fn drives_position(program: &Program, entity: EntityId) -> bool {
    let entity = &program.entities[entity];
    let is_position = |var: VarId| var.index() < 2;
    let drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|l| &l.drives));
    entity.clamps.iter().any(|c| c.degree == 0 && is_position(c.var))
        || drives.into_iter().any(|d| matches!(d, Drive::Flow { var, degree: 0, .. } if is_position(*var)))
        || entity.envelopes.iter().any(|e| e.degree == 0 && e.vars.iter().any(|v| is_position(*v)))
}

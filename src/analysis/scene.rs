//! What the colliders of a world can meet, as far as it never changes: bodies of one kind share it, per space.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::ir::{
    Actions, Bounds, Drive, EdgeId, Entity, EntityId, Expr, Group, Id, IdVec, LeafId, Meeting, Origin, ParamId, Place,
    Program, Push, Side, SlotId, SpaceId, TagSet, VarId, World,
};

use crate::watch::{Meter, Watch};

use super::cells::{Cells, near_statics};
use super::local::Surfaces;
use super::presence::Presence;
use super::region::{Obstacle, Region};
use super::statics::Statics;
use super::values::{Interval, Values};

/// Edges that meet are this near, px: positions are rounded.
pub(super) const ROUNDING: f64 = 1e-6;

/// More places than that where instances are put are not told apart.
const MAX_SEEDS: usize = 64;

/// How far inside of a platform something may have stood that comes from above, px; as the simulator has it.
pub(super) const TOLERANCE: f64 = 0.001;
/// Beyond this coordinates are too coarse for what is known of pushes to hold, px.
const MAX_COORDINATE: f64 = (1_u64 << 26) as f64;

/// How much rounding can shift where edges meet at some coordinates, px.
pub(super) fn rounding(at: f64) -> f64 {
    // What has no end is not rounded there.
    if at.is_finite() { ROUNDING + at.abs() * 1e-12 } else { 0.0 }
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
    /// When it is there; none if more than modes decide that.
    pub presence: Option<Presence>,
    /// Whether it can be there at all, by the leaves that are known to be possible.
    pub is_live: bool,
    /// Whether anything pushes it.
    pub is_pushed: bool,
}

/// Slots whose colliders are the same.
#[derive(Debug, Clone)]
pub(super) struct Kind {
    pub entity: EntityId,
    pub slots: Vec<SlotId>,
    pub bodies: Vec<Body>,
    /// Whether something can put an instance inside of what pushes it, or through it.
    pub jumps: bool,
    /// Whether a collider of it that is never pushed can come back after it was away.
    pub appears: bool,
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

/// Where instances of a kind can get in a space, and what that was found from.
#[derive(Debug)]
struct Flooded {
    /// The length of their steps, px.
    far: f64,
    /// The number of seeds.
    seeds: usize,
    obstacles: Vec<Obstacle>,
    found: Option<Region>,
}

/// The kinds of a world, and what they meet.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub kinds: Vec<Kind>,
    /// Of each entity, the groups whose leaves decide how its variables flow; none if time does, too.
    pub flowing: IdVec<EntityId, Option<Vec<bool>>>,
    /// Of each entity, the groups whose leaves decide which of its colliders are pushed.
    pub covering: IdVec<EntityId, Vec<bool>>,
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
    /// Where they are as colliders of theirs appear.
    uncovered: BTreeMap<(usize, SpaceId), Vec<[Interval; 2]>>,
    /// Where those of a kind get from where they are put.
    regions: BTreeMap<(usize, SpaceId), Flooded>,
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
            moving: program.entities.iter().map(|entity| moving(entity)).collect(),
            flowing: program.entities.ids().map(|e| flowing(program, e)).collect(),
            covering: program.entities.iter().map(|e| covering(program, e)).collect(),
            of: IdVec::new(),
            pairs: Vec::new(),
            meter: Meter::new(watch),
            statics: BTreeMap::new(),
            seeds: BTreeMap::new(),
            uncovered: BTreeMap::new(),
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
                let appears = false;
                scene.kinds.push(Kind { entity: s.entity, slots, bodies, jumps, appears, cells, near: None, surfaces });
            }
            scene.kinds[number].slots.push(slot);
            scene.of.push(number);
        }
        scene.pair_up();
        for kind in 0..scene.kinds.len() {
            scene.kinds[kind].near = scene.near(kind);
            scene.kinds[kind].cells = Cells::around(&scene.kinds[kind]);
        }
        scene
    }

    /// Around the positions at which a kind can meet what never moves: instances that nothing can move, too.
    fn near(&self, kind: usize) -> Option<Extent> {
        let mut hull = near_statics(self.world, &self.kinds[kind], &self.meter);
        for pair in self.pairs[kind].iter().filter(|pair| pair.meeting.response.push != Push::Sense) {
            let (mine, theirs) = (&self.kinds[kind].bodies[pair.mine], &self.kinds[pair.kind].bodies[pair.theirs]);
            let (Some(extent), Some(other), false) = (mine.extent, theirs.extent, mine.kinematic) else { continue };
            let stays = theirs.kinematic && stays(&self.program.entities[self.kinds[pair.kind].entity]);
            for slot in self.kinds[pair.kind].slots.iter().filter(|_| stays).map(|s| &self.world.slots[*s]) {
                if slot.origin != Origin::Free {
                    let at = [0, 1].map(|axis| {
                        let at = slot.vars[VarId::XY[axis]][0];
                        near(Some(extent), axis, (at + other[axis].low, at + other[axis].high))
                    });
                    hull = Some(hull.map_or(at, |h| [h[0].or(at[0]), h[1].or(at[1])]));
                }
            }
        }
        hull
    }

    /// Some leaves can be active together; gives whether a collider can be there for the first time.
    pub fn activate(&mut self, kind: usize, leaves: &[LeafId]) -> bool {
        let mut is_new = false;
        for body in self.kinds[kind].bodies.iter_mut().filter(|b| !b.is_live) {
            let presence = body.presence.as_ref();
            body.is_live = presence.is_none_or(|p| p.is_there(leaves));
            is_new |= body.is_live;
        }
        if is_new {
            self.forget(kind);
        }
        is_new
    }

    /// Nothing is known of the modes of a kind.
    pub fn activate_all(&mut self, kind: usize) {
        self.kinds[kind].bodies.iter_mut().for_each(|b| b.is_live = true);
        self.kinds[kind].appears = true;
        self.forget(kind);
    }

    /// What a kind meets must be found anew.
    fn forget(&mut self, kind: usize) {
        self.statics.retain(|(k, _), _| *k != kind);
        self.regions.retain(|(k, _), _| *k != kind);
    }

    /// Tells players apart by place; returns false if there are none of whom that can be done.
    pub fn refine(&mut self) -> bool {
        let mut is_refined = false;
        for number in 0..self.kinds.len() {
            let kind = &self.kinds[number];
            if kind.slots.iter().any(|s| self.world.slots[*s].player.is_none()) {
                continue;
            }
            let surfaces =
                self.world.spaces.ids().map(|s| Some((s, Arc::new(Surfaces::new(self.world, kind, s, &self.meter)?))));
            let Some(surfaces) = surfaces.collect::<Option<Vec<_>>>() else { continue };
            // Which of its colliders can be there is not known yet.
            let mut whole = kind.clone();
            whole.bodies.iter_mut().for_each(|b| b.is_live = true);
            let blocking = |space| self.blocking(&whole, space);
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
        let mut bodies = self.bodies(self.kinds[kind].entity, params);
        for (body, known) in bodies.iter_mut().zip(&self.kinds[kind].bodies) {
            body.is_live = known.is_live;
        }
        self.kinds[kind].bodies = bodies;
        self.kinds[kind].near = self.near(kind);
        self.forget(kind);
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
        let is_new = add(known, at);
        if is_new && known.len() == 1 {
            self.regions.remove(&(kind, space));
        }
        is_new
    }

    /// A collider of instances of a kind appears somewhere; gives whether that is new.
    pub fn uncover(&mut self, kind: usize, space: SpaceId, at: [Interval; 2]) -> bool {
        add(self.uncovered.entry((kind, space)).or_default(), at)
    }

    /// Where instances of a kind are put in a space, or have colliders that appear.
    pub fn put(&self, kind: usize, space: SpaceId) -> impl Iterator<Item = &[Interval; 2]> {
        [&self.seeds, &self.uncovered].into_iter().filter_map(move |m| m.get(&(kind, space))).flatten()
    }

    /// Where instances of a kind can get in a space among what never moves and some obstacles, if a step moves them by at
    /// most `far` px along each axis. None if that is not known.
    pub fn region(&mut self, kind: usize, space: SpaceId, far: f64, obstacles: &[Obstacle]) -> Option<&Region> {
        if !far.is_finite() {
            return None;
        }
        let far = rounded_step(far);
        let seeds = self.seeds.get(&(kind, space)).map_or(&[][..], Vec::as_slice);
        let is_known = |f: &Flooded| f.far == far && f.seeds == seeds.len() && f.obstacles == obstacles;
        if !self.regions.get(&(kind, space)).is_some_and(is_known) {
            let found = self.flooded(kind, space, seeds, far, obstacles);
            let flooded = Flooded { far, seeds: seeds.len(), obstacles: obstacles.to_vec(), found };
            self.regions.insert((kind, space), flooded);
        }
        self.regions.get(&(kind, space))?.found.as_ref()
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
            let sides = c.shape.sides(number);
            let extent = sides.map(|[x, y, width, height]| {
                [Interval { low: x, high: x + width }, Interval { low: y, high: y + height }]
            });
            let presence = Presence::of(self.program, &self.program.entities[entity], c.guard);
            let is_live = presence == Some(Presence::Always);
            let is_pushed = !c.kinematic && self.is_pushed(c.tags);
            Body { tags: c.tags, kinematic: c.kinematic, extent, presence, is_live, is_pushed }
        };
        self.program.entities[entity].colliders.iter().map(body).collect()
    }

    /// Whether anything of the world pushes what has some tags.
    fn is_pushed(&self, tags: TagSet) -> bool {
        let pushes = |t: TagSet| self.world.meeting(tags, t).is_some_and(|m| m.response.push != Push::Sense);
        self.world.spaces.iter().any(|space| {
            let kinds = space.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect());
            kinds.chain(space.solids.iter().map(|s| s.tags)).any(pushes)
        }) || self.program.entities.iter().flat_map(|e| e.colliders.iter()).any(|c| pushes(c.tags))
    }

    /// The size of a body along both axes, px; infinite where it is not always the same.
    pub fn size(body: &Body) -> [f64; 2] {
        body.extent.map_or([f64::INFINITY; 2], |e| e.map(|i| i.high - i.low))
    }

    /// Whether coordinates are small enough everywhere for what is known of pushes to hold to the last bit.
    pub fn is_precise(&self, kind: usize) -> bool {
        let near = self.kinds[kind].near.iter().flatten();
        near.flat_map(|i| [i.low, i.high]).all(|x| x.abs() < MAX_COORDINATE)
    }
}

/// Adds a box to others, unless it lies in one of them; gives whether it does not. There are never too many.
fn add(known: &mut Vec<[Interval; 2]>, at: [Interval; 2]) -> bool {
    let is_known = known.iter().any(|k| (0..2).all(|a| k[a].low <= at[a].low && at[a].high <= k[a].high));
    if !is_known {
        known.push(at);
        if known.len() > MAX_SEEDS {
            let hull = known.iter().copied().reduce(|a, b| [a[0].or(b[0]), a[1].or(b[1])]);
            known.clear();
            known.extend(hull);
        }
    }
    !is_known
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

pub(super) fn edge(extent: Extent, axis: usize, end: usize, sides: (f64, f64)) -> Interval {
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

/// The groups whose leaves decide which colliders of an entity can be pushed.
fn covering(program: &Program, entity: &Entity) -> Vec<bool> {
    let mut groups = BTreeSet::new();
    for collider in entity.colliders.iter().filter(|c| !c.kinematic) {
        if let Some(presence) = Presence::of(program, entity, collider.guard) {
            presence.groups(&mut groups);
        }
    }
    entity.groups.ids().map(|group| groups.contains(&group)).collect()
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
        let inside = group.modes;
        let mut leaves = entity.leaves.iter().filter(|l| inside.contains(l.mode));
        asks_for_modes || leaves.any(|l| !l.drives.is_empty())
    };
    Some(entity.groups.iter().map(of).collect())
}

/// Whether nothing of an entity drives or sets its position or its velocity.
fn stays(entity: &Entity) -> bool {
    let drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|l| &l.drives));
    let is_driven = |drive: &Drive| match *drive {
        Drive::Coast(_) => false,
        Drive::Flow { var, .. } => var.is_position(),
        Drive::Envelope(id, _) => entity.envelopes[id].vars.iter().any(|v| v.is_position()),
    };
    let mut updates = entity.action_lists().flat_map(|a| &a.updates);
    !drives.into_iter().any(is_driven) && !updates.any(|u| matches!(u.place, Place::Var(VarId::X | VarId::Y, _)))
}

/// The edges of groups that drive variables, and those that set them or spawn something.
fn moving(entity: &Entity) -> IdVec<EdgeId, bool> {
    let sets = |a: &Actions| !a.spawns.is_empty() || a.updates.iter().any(|u| matches!(u.place, Place::Var(..)));
    let group_moves = |group: &Group| {
        let inside = group.modes;
        let mut leaves = entity.leaves.iter().filter(|l| inside.contains(l.mode));
        let mut modes = entity.modes.pairs().filter(|(m, _)| inside.contains(*m));
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
    let is_position = |var: VarId| var.is_position();
    let drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|l| &l.drives));
    entity.clamps.iter().any(|c| c.degree == 0 && is_position(c.var))
        || drives.into_iter().any(|d| matches!(d, Drive::Flow { var, degree: 0, .. } if is_position(*var)))
        || entity.envelopes.iter().any(|e| e.degree == 0 && e.vars.iter().any(|v| is_position(*v)))
}

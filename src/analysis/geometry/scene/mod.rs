//! What the colliders of a world can meet, as far as it never changes: bodies of one kind share it, per space. It is found
//! when it is asked for (`look`, `flood`), and kept.

mod flood;
mod look;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::ir::{
    Actions, Drive, EdgeId, Entity, EntityId, Expr, Group, Id, IdVec, LeafId, Origin, ParamId, Place, Program, Push,
    SlotId, SpaceId, TagSet, VarId, World,
};

use crate::watch::{Meter, Watch};

use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::{Body, Extent, Kind, Pair, near};
use crate::analysis::geometry::cells::{Cells, near_statics};
use crate::analysis::geometry::local::Surfaces;
use crate::analysis::geometry::presence::Presence;
use crate::analysis::geometry::region::{Obstacle, Region};
use crate::analysis::geometry::statics::Statics;

/// More places than that where instances are put are not distinguished.
const MAX_SEEDS: usize = 64;

/// Beyond this coordinates are too coarse for what is known of pushes to hold, px.
const MAX_COORDINATE: f64 = (1_u64 << 26) as f64;

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
pub(in crate::analysis) struct Scene<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub kinds: Vec<Kind>,
    /// Of each entity, the groups whose leaves decide how its variables flow; none if time does, too.
    pub flowing: IdVec<EntityId, Option<Vec<bool>>>,
    /// Of each entity, the groups whose leaves decide which of its colliders are pushed.
    pub covering: IdVec<EntityId, Vec<bool>>,
    /// Of each entity, the edges whose way depends on where the instance is and how it moves.
    pub moving: IdVec<EntityId, IdVec<EdgeId, bool>>,
    /// Of each kind, where its instances are distinguished.
    pub cells: Vec<Cells>,
    /// Of each kind whose cells are fine: what never moves, in each space.
    pub surfaces: Vec<Vec<(SpaceId, Arc<Surfaces>)>>,
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

/// How far a step goes, px, rounded up, so that results are not recomputed for each growth.
pub(in crate::analysis) fn rounded_step(far: f64) -> f64 {
    (2.0 * far).ceil() / 2.0
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
            cells: Vec::new(),
            surfaces: Vec::new(),
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
                let (slots, appears) = (Vec::new(), false);
                scene.kinds.push(Kind { entity: s.entity, slots, bodies, jumps, appears, near: None });
            }
            scene.kinds[number].slots.push(slot);
            scene.of.push(number);
        }
        scene.pair_up();
        for kind in 0..scene.kinds.len() {
            scene.kinds[kind].near = scene.near(kind);
            scene.cells.push(Cells::around(&scene.kinds[kind]));
        }
        scene.surfaces = vec![Vec::new(); scene.kinds.len()];
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

    /// Some leaves can be active together; returns whether a collider can be there for the first time.
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

    /// What a kind meets must be recomputed.
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
                self.cells[number] = cells;
                self.surfaces[number] = surfaces;
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

    /// Something puts instances of a kind somewhere; returns whether that is new.
    pub fn seed(&mut self, kind: usize, space: SpaceId, at: [Interval; 2]) -> bool {
        let known = self.seeds.entry((kind, space)).or_default();
        let is_new = add(known, at);
        if is_new && known.len() == 1 {
            self.regions.remove(&(kind, space));
        }
        is_new
    }

    /// A collider of instances of a kind appears somewhere; returns whether that is new.
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

    /// Whether coordinates are small enough everywhere for what is known of pushes to hold to the last bit.
    pub fn is_precise(&self, kind: usize) -> bool {
        let near = self.kinds[kind].near.iter().flatten();
        near.flat_map(|i| [i.low, i.high]).all(|x| x.abs() < MAX_COORDINATE)
    }
}

/// Adds a box to others, unless it lies in one of them; returns whether it does not. There are never too many.
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

//! The static facts about the colliders of a world, shared by all instances of a kind and cached per space. They are
//! computed on demand (`scan`, `flood`).

mod flood;
mod scan;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::ir::{
    Actions, Drive, EdgeId, Entity, EntityId, Expr, Group, Id, IdVec, LeafId, Origin, ParamId, Place, Program, Push,
    SlotId, SpaceId, TagSet, VarId, World,
};

use crate::watch::{Meter, Watch};

use crate::analysis::domain::unknown::known_or;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::{Body, Extent, Kind, Pair, near};
use crate::analysis::geometry::cells::{Cells, near_statics};
use crate::analysis::geometry::grid::Grid;
use crate::analysis::geometry::local::Surfaces;
use crate::analysis::geometry::presence::Presence;
use crate::analysis::geometry::probe_lines::probe_lines;
use crate::analysis::geometry::region::{Obstacle, Region};
use crate::analysis::geometry::seam::reaches_around;
use crate::analysis::geometry::statics::Statics;

/// Maximum number of seeds that are kept apart.
const MAX_SEEDS: usize = 64;

/// Above this coordinate floating-point numbers are too coarse for exact facts about pushes, px.
const MAX_COORDINATE: f64 = (1_u64 << 26) as f64;

/// The region that instances of a kind reach in a space, with the inputs of its computation.
#[derive(Debug)]
struct Flooded {
    /// The length of their steps, px.
    far: f64,
    /// The number of seeds.
    seeds: usize,
    obstacles: Vec<Obstacle>,
    found: Option<Region>,
}

/// The kinds of a world and what they can touch.
#[derive(Debug)]
pub(in crate::analysis) struct Scene<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub kinds: Vec<Kind>,
    /// For each entity, the groups whose leaves determine the flows of its variables; `None` if they also depend on
    /// time.
    pub flow_groups: IdVec<EntityId, Option<Vec<bool>>>,
    /// For each entity, the groups whose leaves determine which of its colliders are pushed.
    pub collider_groups: IdVec<EntityId, Vec<bool>>,
    /// For each entity, the edges whose effect depends on position or motion.
    pub motion_edges: IdVec<EntityId, IdVec<EdgeId, bool>>,
    /// For each kind, the cells that distinguish its instances.
    pub cells: Vec<Cells>,
    /// For each kind with fine cells: the static obstacles of each space.
    pub surfaces: Vec<Vec<(SpaceId, Arc<Surfaces>)>>,
    /// The kind of each slot.
    pub of: IdVec<SlotId, usize>,
    /// For each kind, the pairs of its bodies with others.
    pub pairs: Vec<Vec<Pair>>,
    /// Limits the work. Once it is stopped, the results are incomplete.
    pub meter: Meter<'a>,
    statics: BTreeMap<(usize, SpaceId), Statics>,
    /// Positions at which instances of a kind are placed.
    seeds: BTreeMap<(usize, SpaceId), Vec<[Interval; 2]>>,
    /// Positions at which a collider is switched on.
    collider_seeds: BTreeMap<(usize, SpaceId), Vec<[Interval; 2]>>,
    /// The regions reached from the seeds.
    regions: BTreeMap<(usize, SpaceId), Flooded>,
}

/// The length of a step, px, rounded up so that small growth does not trigger a recomputation.
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
            motion_edges: program.entities.iter().map(|entity| motion_edges(entity)).collect(),
            flow_groups: program.entities.ids().map(|e| flow_groups(program, e)).collect(),
            collider_groups: program.entities.iter().map(|e| collider_groups(program, e)).collect(),
            cells: Vec::new(),
            surfaces: Vec::new(),
            of: IdVec::new(),
            pairs: Vec::new(),
            meter: Meter::new(watch),
            statics: BTreeMap::new(),
            seeds: BTreeMap::new(),
            collider_seeds: BTreeMap::new(),
            regions: BTreeMap::new(),
        };
        for (slot, s) in world.slots.pairs() {
            let params: Vec<u64> = s.params.iter().map(|p| p.to_bits()).collect();
            let next = numbers.len();
            let number = *numbers.entry((s.entity, s.origin == Origin::Named, params)).or_insert(next);
            if number == scene.kinds.len() {
                let bodies = scene.bodies(s.entity, &s.params.iter().map(|p| known_or(*p, Values::all())).collect());
                let can_be_inside = drives_position(program, s.entity);
                let (slots, appears) = (Vec::new(), false);
                scene.kinds.push(Kind { entity: s.entity, slots, bodies, can_be_inside, appears, near: None });
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

    /// The hull of the positions at which a kind can touch static obstacles, including instances that nothing can move.
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

    /// Marks leaves that can be active together; returns true if a collider can be active for the first time.
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

    /// Assumes that all modes of a kind are possible.
    pub fn activate_all(&mut self, kind: usize) {
        self.kinds[kind].bodies.iter_mut().for_each(|b| b.is_live = true);
        self.kinds[kind].appears = true;
        self.forget(kind);
    }

    /// Drops cached results about a kind.
    fn forget(&mut self, kind: usize) {
        self.statics.retain(|(k, _), _| *k != kind);
        self.regions.retain(|(k, _), _| *k != kind);
    }

    /// Distinguishes players by place where possible; returns true if it is possible for any.
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
            // It is not yet known which of its colliders can be active.
            let mut whole = kind.clone();
            whole.bodies.iter_mut().for_each(|b| b.is_live = true);
            let blocking = |space| self.blocking(&whole, space);
            let entity = &self.program.entities[kind.entity];
            let probed = |space| probe_lines(self.program, self.world, kind, space, &self.meter);
            let cells = Cells::fine(kind, entity, &surfaces, probed, blocking);
            let without = || Cells::fine(kind, entity, &surfaces, |_| [Vec::new(), Vec::new()], blocking);
            if let Some(cells) = cells.or_else(without) {
                self.cells[number] = cells;
                self.surfaces[number] = surfaces;
                is_refined = true;
            }
        }
        is_refined
    }

    /// The plane of each space, cut at all lines at which pushes of a kind can end, with the surfaces there; `None` if a
    /// collider is not constant, or if there are too many.
    pub fn grids(&mut self, number: usize, most: usize) -> Option<Vec<Grid>> {
        let kind = &self.kinds[number];
        let around = kind.near?;
        let mut left = most;
        let (mut grids, mut all) = (Vec::new(), Vec::new());
        for space in self.world.spaces.ids() {
            if self.world.spaces[space].wraps() {
                return None;
            }
            let surfaces = Surfaces::new(self.world, kind, space, &self.meter)?;
            let blocking = || self.blocking(kind, space);
            let grid = Grid::new(space, &surfaces, [Vec::new(), Vec::new()], around, left, blocking)?;
            left -= grid.is_blocked.len();
            grids.push(grid);
            all.push((space, Arc::new(surfaces)));
        }
        self.surfaces[number] = all;
        Some(grids)
    }

    /// Recomputes the bodies of a kind after the parameters of its slots have grown.
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

    /// Scans the static obstacles of a space for a kind, unless that was done before.
    pub fn prepare(&mut self, kind: usize, space: SpaceId) {
        if !self.statics.contains_key(&(kind, space)) {
            let found = self.scan_statics(&self.kinds[kind], space);
            self.statics.insert((kind, space), found);
        }
    }

    /// The static obstacles of a space for a kind; `None` before [`Scene::prepare`].
    pub fn statics(&self, kind: usize, space: SpaceId) -> Option<&Statics> {
        self.statics.get(&(kind, space))
    }

    /// Adds a seed; returns true if it is new.
    pub fn seed(&mut self, kind: usize, space: SpaceId, at: [Interval; 2]) -> bool {
        let known = self.seeds.entry((kind, space)).or_default();
        let is_new = add(known, at);
        if is_new && known.len() == 1 {
            self.regions.remove(&(kind, space));
        }
        is_new
    }

    /// Adds a position at which a collider is switched on; returns true if it is new.
    pub fn seed_collider(&mut self, kind: usize, space: SpaceId, at: [Interval; 2]) -> bool {
        add(self.collider_seeds.entry((kind, space)).or_default(), at)
    }

    /// All seeds of a kind in a space, including those of colliders.
    pub fn all_seeds(&self, kind: usize, space: SpaceId) -> impl Iterator<Item = &[Interval; 2]> {
        [&self.seeds, &self.collider_seeds].into_iter().filter_map(move |m| m.get(&(kind, space))).flatten()
    }

    /// The region that instances of a kind reach in a space among static obstacles and `obstacles`, if a step moves
    /// them by at most `far` px along each axis. `None` if it is not known.
    pub fn region(&mut self, kind: usize, space: SpaceId, far: f64, obstacles: &[Obstacle]) -> Option<&Region> {
        if !far.is_finite() {
            return None;
        }
        let far = rounded_step(far);
        let seeds = self.seeds.get(&(kind, space)).map_or(&[][..], Vec::as_slice);
        let is_known = |f: &Flooded| f.far == far && f.seeds == seeds.len() && f.obstacles == obstacles;
        if !self.regions.get(&(kind, space)).is_some_and(is_known) {
            let found = self.flood_region(kind, space, seeds, far, obstacles);
            let flood_region = Flooded { far, seeds: seeds.len(), obstacles: obstacles.to_vec(), found };
            self.regions.insert((kind, space), flood_region);
        }
        self.regions.get(&(kind, space))?.found.as_ref()
    }

    /// All known ends of pushes.
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
            // What reaches farther than static obstacles are repeated can meet anything.
            let extent = extent.filter(|extent| !reaches_around(self.world, *extent));
            let presence = Presence::of(self.program, &self.program.entities[entity], c.guard);
            let is_live = presence == Some(Presence::Always);
            let is_pushed = !c.kinematic && self.is_pushed(c.tags);
            let is_round = c.shape.is_round();
            Body { tags: c.tags, kinematic: c.kinematic, extent, is_round, presence, is_live, is_pushed }
        };
        self.program.entities[entity].colliders.iter().map(body).collect()
    }

    /// Whether anything in the world pushes a body with some tags.
    fn is_pushed(&self, tags: TagSet) -> bool {
        let pushes = |t: TagSet| self.world.meeting(tags, t).is_some_and(|m| m.response.push != Push::Sense);
        self.world.spaces.iter().any(|space| {
            let kinds = space.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect());
            kinds.chain(space.solids.iter().map(|s| s.tags)).any(pushes)
        }) || self.program.entities.iter().flat_map(|e| e.colliders.iter()).any(|c| pushes(c.tags))
    }

    /// Whether all coordinates are small enough for exact facts about pushes.
    pub fn is_precise(&self, kind: usize) -> bool {
        let near = self.kinds[kind].near.iter().flatten();
        near.flat_map(|i| [i.low, i.high]).all(|x| x.abs() < MAX_COORDINATE)
    }
}

/// Adds a box unless another contains it; returns true if it was added. Replaces all by their hull if there are too
/// many.
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

/// The groups whose leaves determine which colliders of an entity can be pushed.
fn collider_groups(program: &Program, entity: &Entity) -> Vec<bool> {
    let mut groups = BTreeSet::new();
    for collider in entity.colliders.iter().filter(|c| !c.kinematic) {
        if let Some(presence) = Presence::of(program, entity, collider.guard) {
            presence.groups(&mut groups);
        }
    }
    entity.groups.ids().map(|group| groups.contains(&group)).collect()
}

/// The groups whose leaves determine the flows of an entity: those that drive its variables, or all if a flow reads
/// modes. `None` if a flow reads timers. A probe reads what the colliders read.
fn flow_groups(program: &Program, entity: EntityId) -> Option<Vec<bool>> {
    let entity = &program.entities[entity];
    let mut asks_for_modes = false;
    let mut read = entity.flow_exprs();
    if program.with_operands(read.clone()).iter().any(|id| matches!(program.exprs[*id], Expr::Probe { .. })) {
        read.extend(entity.colliders.iter().flat_map(|c| c.shape.numbers().iter().copied().chain(c.guard)));
    }
    for id in program.with_operands(read) {
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

/// Whether an entity never drives or sets its position or velocity.
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

/// For each edge, whether its group drives variables or whether it sets variables or spawns.
fn motion_edges(entity: &Entity) -> IdVec<EdgeId, bool> {
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

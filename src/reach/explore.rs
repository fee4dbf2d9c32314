//! What a search has been through: rooms, tiles that players stood on or were in, modes, edges. It is a record of what was
//! found, state by state; what is missing from it was not found, which proves nothing.

use std::sync::{Mutex, PoisonError};

use crate::ir::{Bounds, EdgeId, EntityId, Id, LeafId, Push, SlotId, SpaceId, TagId, TagSet, TileMap, World};
use crate::sim::{Scratch, Simulator};

/// How near a body is to what it stands on, px.
const NEAR: f64 = 0.05;

/// Sees each state that a search makes, after the step that led there.
pub trait Observer: Sync {
    /// A state within the bounds.
    fn see(&self, sim: &Simulator, state: &[u8], scratch: &Scratch);
}

/// What a player can stand on: the upper side of a tile or of free-standing geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Top {
    /// Its ends and its height, px.
    pub from: f64,
    /// The right end.
    pub to: f64,
    /// The height.
    pub y: f64,
    /// The column and the row of its tile.
    pub tile: Option<(usize, usize)>,
    /// Whether a player stood on it.
    pub is_covered: bool,
}

/// What was covered of a space.
#[derive(Debug, Clone, PartialEq)]
pub struct CoveredSpace {
    /// Whether a player was in it.
    pub is_entered: bool,
    /// What players can stand on.
    pub tops: Vec<Top>,
    /// For each cell of the map, from the lower left: whether it is open to players.
    open: Vec<bool>,
    /// Whether a player was in it.
    entered: Vec<bool>,
    /// The tops of each cell's upper side.
    top_of: Vec<Option<usize>>,
    /// The first top of free-standing geometry.
    solids: usize,
}

impl CoveredSpace {
    /// The number of open cells, and of those that players were in.
    pub fn cells(&self) -> (usize, usize) {
        let open = self.open.iter().filter(|open| **open).count();
        (open, self.open.iter().zip(&self.entered).filter(|(open, entered)| **open && **entered).count())
    }

    /// The number of tops, and of those that players stood on.
    pub fn stood(&self) -> (usize, usize) {
        (self.tops.len(), self.tops.iter().filter(|top| top.is_covered).count())
    }
}

/// What was covered of an entity, by all its instances together.
#[derive(Debug, Clone, PartialEq)]
pub struct CoveredEntity {
    /// The entity.
    pub entity: EntityId,
    /// For each leaf, whether it was active.
    pub leaves: Vec<bool>,
    /// For each edge, whether it was taken.
    pub edges: Vec<bool>,
}

/// What a search has been through.
#[derive(Debug, Clone, PartialEq)]
pub struct Explored {
    /// Each space.
    pub spaces: Vec<CoveredSpace>,
    /// The entities that the world has instances of.
    pub entities: Vec<CoveredEntity>,
}

impl Explored {
    /// Adds what another search has been through in the same world.
    pub fn add(&mut self, other: &Explored) {
        let join = |own: &mut [bool], other: &[bool]| own.iter_mut().zip(other).for_each(|(own, other)| *own |= other);
        for (own, other) in self.spaces.iter_mut().zip(&other.spaces) {
            own.is_entered |= other.is_entered;
            join(&mut own.entered, &other.entered);
            own.tops.iter_mut().zip(&other.tops).for_each(|(own, other)| own.is_covered |= other.is_covered);
        }
        for (own, other) in self.entities.iter_mut().zip(&other.entities) {
            join(&mut own.leaves, &other.leaves);
            join(&mut own.edges, &other.edges);
        }
    }
}

/// Collects what a search has been through.
pub struct Explorer {
    explored: Mutex<Explored>,
    players: Vec<SlotId>,
    /// For each slot its index among the entities.
    of_slot: Vec<usize>,
    /// For each player and collider, whether geometry stops it.
    solid: Vec<Vec<bool>>,
}

impl Explorer {
    /// For a world of which nothing is covered yet.
    pub fn new(sim: &Simulator) -> Self {
        let (program, world) = (sim.program(), sim.world());
        let mut entities: Vec<CoveredEntity> = Vec::new();
        let mut of_slot = Vec::new();
        for slot in world.slots.iter() {
            let known = entities.iter().position(|known| known.entity == slot.entity);
            of_slot.push(known.unwrap_or_else(|| {
                let entity = &program.entities[slot.entity];
                let (leaves, edges) = (vec![false; entity.leaves.len()], vec![false; entity.edges.len()]);
                entities.push(CoveredEntity { entity: slot.entity, leaves, edges });
                entities.len() - 1
            }));
        }
        let players: Vec<SlotId> = world.players.iter().map(|player| player.slot).collect();
        let is_solid = |tags: TagSet| {
            let mut pushing = world.collide.iter().filter(|line| line.response.push != Push::Sense);
            pushing.any(|line| line.left.meets(tags) || line.right.meets(tags))
        };
        let solid = players.iter().map(|slot| {
            let colliders = &program.entities[world.slots[*slot].entity].colliders;
            colliders.iter().map(|collider| is_solid(collider.tags)).collect()
        });
        let spaces = world.spaces.ids().map(|id| space(sim, id)).collect();
        Explorer { solid: solid.collect(), explored: Mutex::new(Explored { spaces, entities }), players, of_slot }
    }

    /// What was covered.
    pub fn explored(&self) -> Explored {
        self.explored.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Observer for Explorer {
    fn see(&self, sim: &Simulator, state: &[u8], scratch: &Scratch) {
        let mut explored = self.explored.lock().unwrap_or_else(PoisonError::into_inner);
        let Explored { spaces, entities } = &mut *explored;
        for instance in sim.instances(state) {
            let covered = &mut entities[self.of_slot[instance.slot().index()]];
            for group in instance.entity().groups.ids() {
                covered.leaves[instance.leaf(group).index()] = true;
            }
        }
        for (slot, edge) in sim.taken_edges(scratch) {
            entities[self.of_slot[slot.index()]].edges[edge.index()] = true;
        }
        for (player, solid) in self.players.iter().zip(&self.solid) {
            let instance = sim.instance(state, *player);
            if !instance.is_alive() {
                continue;
            }
            let id = instance.space();
            let (covered, map) = (&mut spaces[id.index()], sim.world().spaces[id].map.as_ref());
            covered.is_entered = true;
            let position @ (x, y) = instance.position();
            let mut has_body = false;
            for (collider, b) in instance.colliders() {
                if solid.get(collider.index()).copied().unwrap_or(false) {
                    has_body = true;
                    covered.see(map, &b.placed(position));
                }
            }
            if !has_body {
                covered.see(map, &Bounds { left: x, right: x, bottom: y, top: y });
            }
        }
    }
}

impl CoveredSpace {
    fn see(&mut self, map: Option<&TileMap<TagId>>, body: &Bounds) {
        let stands = |top: &Top| (body.bottom - top.y).abs() <= NEAR && body.left < top.to && body.right > top.from;
        for top in self.tops.iter_mut().skip(self.solids) {
            top.is_covered |= stands(top);
        }
        let Some(map) = map else { return };
        let (width, height) = map.tile;
        // Within a pixel's fraction of a border a body is not in the next cell.
        let cell = |at: f64, side: f64, inset: f64| ((at + inset) / side).floor() as i64;
        let (first, last) = (cell(body.left, width, NEAR), cell(body.right, width, -NEAR));
        let last = last.max(first);
        let (low, high) = (cell(body.bottom, height, NEAR), cell(body.top, height, -NEAR));
        let index = |column: i64, row: i64| {
            let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
            (column < map.columns && row < map.rows).then_some(row * map.columns + column)
        };
        for row in low..=high.max(low) {
            for column in first..=last {
                if let Some(at) = index(column, row) {
                    self.entered[at] = true;
                }
            }
        }
        let below = cell(body.bottom, height, -NEAR);
        for row in [below, low] {
            for column in first..=last {
                let Some(top) = index(column, row).and_then(|at| self.top_of[at]) else { continue };
                let is_slope = index(column, row).is_some_and(|at| is_slope(map, at));
                let top = &mut self.tops[top];
                // A body on a slope stands within its tile, at its middle.
                let middle = (body.left + body.right) / 2.0;
                top.is_covered |= if is_slope { (top.from..=top.to).contains(&middle) } else { stands(top) };
            }
        }
    }
}

fn is_slope(map: &TileMap<TagId>, cell: usize) -> bool {
    map.cells.get(cell).and_then(|kind| map.kinds.get(usize::from(*kind))).is_some_and(|kind| kind.slope.is_some())
}

/// A space of which nothing is covered yet.
fn space(sim: &Simulator, id: SpaceId) -> CoveredSpace {
    let (program, world): (_, &World) = (sim.program(), sim.world());
    let space = &world.spaces[id];
    let push = |tags: TagSet| world.strongest_push(program, world.player_entities(), tags);
    let holds = |tags: TagSet| matches!(push(tags), Some(Push::Block | Push::FromAbove));
    let (mut tops, mut open, mut top_of) = (Vec::new(), Vec::new(), Vec::new());
    if let Some(map) = &space.map {
        let kinds: Vec<(bool, bool)> = map
            .kinds
            .iter()
            .map(|kind| {
                let tags: TagSet = kind.tags.iter().copied().collect();
                (holds(tags), push(tags) == Some(Push::Block))
            })
            .collect();
        let of = |cell: usize| map.cells.get(cell).and_then(|kind| kinds.get(usize::from(*kind))).copied();
        for cell in 0..map.cells.len() {
            let (holds, blocks) = of(cell).unwrap_or_default();
            open.push(!blocks || is_slope(map, cell));
            // Above the highest row is no room.
            let is_free = of(cell + map.columns).is_some_and(|(_, blocks)| !blocks);
            top_of.push((holds && is_free).then(|| {
                let [left, bottom, width, height] = map.rectangle(cell);
                let tile = Some((cell % map.columns.max(1), cell / map.columns.max(1)));
                tops.push(Top { from: left, to: left + width, y: bottom + height, tile, is_covered: false });
                tops.len() - 1
            }));
        }
    }
    let solids = tops.len();
    for solid in space.solids.iter().filter(|solid| holds(solid.tags)) {
        let b = solid.bounds;
        tops.push(Top { from: b.left, to: b.right, y: b.top, tile: None, is_covered: false });
    }
    CoveredSpace { is_entered: false, tops, entered: vec![false; open.len()], open, top_of, solids }
}

impl CoveredEntity {
    /// Whether a leaf was active.
    pub fn has(&self, leaf: LeafId) -> bool {
        self.leaves.get(leaf.index()).copied().unwrap_or(false)
    }

    /// Whether an edge was taken.
    pub fn took(&self, edge: EdgeId) -> bool {
        self.edges.get(edge.index()).copied().unwrap_or(false)
    }
}

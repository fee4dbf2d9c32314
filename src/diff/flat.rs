//! A player alone on flat ground: its world with a wide floor in place of its space's map, and all other instances in
//! an empty space of their own, where they still answer what the player reads of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::ir::{Bounds, Id, Program, Push, SlotId, Solid, Space, TagSet, VarId, World, WorldId};
use crate::sim::{Input, Instance, Scratch, Simulator, State};

/// How far the floor reaches to both sides, px.
const REACH: f64 = 100_000.0;
/// Its thickness, px.
const THICKNESS: f64 = 256.0;
/// How far above it the player begins, px: what stands there afterwards is pulled down.
const DROP: f64 = 8.0;
/// How near to the floor a body is that stands on it, px.
const NEAR: f64 = 0.5;
/// For how long a player may fall and settle, s.
const SETTLING: f64 = 5.0;
/// For how many steps it then stays at its height.
const RESTING: u32 = 20;
/// Maximum number of kinds of ground that are tried.
const MAX_GROUNDS: usize = 6;

/// A player that stands.
pub(super) struct Flat {
    pub sim: Simulator,
    pub slot: SlotId,
    /// The state in which it stands.
    pub state: State,
    /// The tags of the floor.
    pub ground: Vec<String>,
    /// Whether it fell there. Many players are not pulled down while they stand, and neither is what moves in all
    /// directions.
    pub is_pulled: bool,
}

impl Flat {
    /// The player of a slot on the first ground of its world on which it comes to rest: after a fall, or where it is put
    /// there. None if there is no such ground.
    pub fn new(program: &Arc<Program>, world: WorldId, slot: SlotId) -> Option<Flat> {
        let grounds = grounds(program, &program.worlds[world], slot);
        let on = |drop| grounds.iter().find_map(|tags| stand(program, world, slot, *tags, drop));
        on(DROP).or_else(|| on(0.0))
    }

    /// The player in a state.
    pub fn player<'a>(&'a self, state: &'a [u8]) -> Instance<'a> {
        self.sim.instance(state, self.slot)
    }
}

/// The kinds of ground that hold a player up: those that block it on all sides first, then the most frequent ones.
fn grounds(program: &Program, world: &World, slot: SlotId) -> Vec<TagSet> {
    let mut counts: BTreeMap<TagSet, usize> = BTreeMap::new();
    for space in world.spaces.iter() {
        for solid in &space.solids {
            *counts.entry(solid.tags).or_insert(0) += 1;
        }
        let Some(map) = &space.map else { continue };
        let mut cells = vec![0; map.kinds.len()];
        for kind in &map.cells {
            if let Some(count) = cells.get_mut(usize::from(*kind)) {
                *count += 1;
            }
        }
        for (kind, count) in map.kinds.iter().zip(cells).filter(|(kind, count)| kind.slope.is_none() && *count > 0) {
            *counts.entry(kind.tags.iter().copied().collect()).or_insert(0) += count;
        }
    }
    // Where nothing static holds it, something that moves may.
    for other in world.slots.ids().filter(|other| *other != slot) {
        let colliders = program.entities[world.slots[other].entity].colliders.iter();
        colliders.filter(|collider| collider.kinematic).for_each(|collider| {
            counts.entry(collider.tags).or_insert(0);
        });
    }
    let push = |tags| world.strongest_push(program, [world.slots[slot].entity], tags);
    let mut grounds: Vec<(bool, usize, TagSet)> = counts
        .into_iter()
        .filter_map(|(tags, count)| match push(tags) {
            None | Some(Push::Sense) => None,
            Some(push) => Some((push == Push::Block, count, tags)),
        })
        .collect();
    grounds.sort_by(|a, b| b.cmp(a));
    grounds.into_iter().take(MAX_GROUNDS).map(|(_, _, tags)| tags).collect()
}

/// A copy of a program in which a player is alone, above a floor if one is given.
fn alone(program: &Arc<Program>, id: WorldId, slot: SlotId, floor: Option<Solid>) -> Arc<Program> {
    let mut changed = Program::clone(program);
    let mut world = World::clone(&program.worlds[id]);
    let space = |name: &str, solids| Space {
        name: name.to_string(),
        map: None,
        solids,
        bounds: None,
        periods: [None; 2],
        links: Vec::new(),
    };
    let here = world.slots[slot].space;
    let name = world.spaces[here].name.clone();
    world.spaces[here] = space(&name, floor.into_iter().collect());
    let elsewhere = world.spaces.push(space("(elsewhere)", Vec::new()));
    for (_, other) in world.slots.iter_mut().enumerate().filter(|(index, _)| *index != slot.index()) {
        other.space = elsewhere;
    }
    world.lay_out(&changed);
    changed.worlds[id] = Arc::new(world);
    Arc::new(changed)
}

/// The player on a floor with these tags, at rest; it begins above it.
fn stand(program: &Arc<Program>, id: WorldId, slot: SlotId, tags: TagSet, drop: f64) -> Option<Flat> {
    let world = &program.worlds[id];
    let sim = Simulator::new(&alone(program, id, slot, None), id);
    let state = sim.initial(&mut sim.scratch()).ok()?;
    let (x, y) = sim.position(&state, slot);
    let bottom = |sim: &Simulator, state: &State| {
        let player = sim.instance(state, slot);
        let entity = player.entity();
        let held = player.colliders().filter(|(collider, _)| {
            let meeting = world.meeting(entity.colliders[*collider].tags, tags);
            meeting.is_some_and(|meeting| meeting.response.push != Push::Sense)
        });
        held.map(|(_, bounds)| bounds.bottom).min_by(f64::total_cmp)
    };
    let top = y + bottom(&sim, &state)? - drop;
    let floor = Solid { tags, bounds: Bounds::new([x - REACH, top - THICKNESS, 2.0 * REACH, THICKNESS]) };
    let sim = Simulator::new(&alone(program, id, slot, Some(floor)), id);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).ok()?;
    let steps = (SETTLING / world.step.seconds()).ceil() as u64;
    let (mut resting, mut step) = (0, 0);
    while resting < RESTING {
        if step >= steps {
            return None;
        }
        step += 1;
        let before = sim.position(&state, slot).1;
        go(&sim, &mut state, &Input::nothing(world.players.len()), &mut scratch)?;
        let player = sim.instance(&state, slot);
        let y = player.position().1;
        let is_down = bottom(&sim, &state).is_some_and(|bottom| (y + bottom - top).abs() <= NEAR);
        resting = if player.is_alive() && y == before && is_down { resting + 1 } else { 0 };
    }
    let ground = tags.iter().filter_map(|tag| program.tags.get(tag).cloned()).collect();
    Some(Flat { sim, slot, state, ground, is_pulled: drop > 0.0 })
}

/// One step; what nature draws in it is always the same. None if it breaks a rule of the language.
pub(super) fn go(sim: &Simulator, state: &mut State, input: &Input, scratch: &mut Scratch) -> Option<()> {
    let input = sim.draw(0, 1, input);
    sim.step(state, &input, scratch).ok()
}

/// The velocity of an instance, px/s.
pub(super) fn velocity(instance: Instance<'_>) -> (f64, f64) {
    let [x, y] = VarId::XY.map(|var| instance.var(var, 1));
    (x, y)
}

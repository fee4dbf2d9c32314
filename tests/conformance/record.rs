//! Parser of a recorded run of the 2017 Python system, and its conversion to a state of our simulator.
//!
//! Entities are numbered in the order of `entities`, which is that of our slots; spaces in source order.

use std::collections::BTreeMap;
use std::path::Path;

use hypedc::ir::{
    ColliderId, DiscreteId, Entity, GroupId, Id, LeafId, ModeId, Program, Side, SlotId, SpaceId, TagSet, TimerId,
    WorldId,
};
use hypedc::sim::state::set_buttons;
use hypedc::sim::{Input, Scratch, Simulator, parse_script};
use hypedc::source::SourceMap;
use serde::Deserialize;

/// A recorded run.
#[derive(Deserialize)]
pub struct Trace {
    /// Run-length encoded inputs: number of steps, and held buttons.
    pub input_sequence_rle: Vec<(u32, Vec<String>)>,
    /// Before the first step.
    pub initial: Record,
    /// After each step.
    pub steps: Vec<Record>,
}

/// The state after a step.
#[derive(Deserialize)]
pub struct Record {
    /// Each entity.
    pub entities: Vec<Recorded>,
    /// All contacts, before anything is pushed.
    pub contacts: Vec<Contact>,
}

/// The state of an entity.
#[derive(Deserialize)]
pub struct Recorded {
    /// Its space.
    pub space: usize,
    /// All active modes, with the names of groups in between: `movement.air.aerial.falling`.
    pub modes: Vec<String>,
    /// Position, velocity and acceleration of each variable.
    pub vars: BTreeMap<String, [f64; 3]>,
    /// The seconds since the entry of a mode, where they are read.
    #[serde(default)]
    pub timers: BTreeMap<String, f64>,
    /// Discrete variables.
    #[serde(default)]
    pub dvars: BTreeMap<String, f64>,
}

/// A contact; the files hold it as a row.
#[derive(Deserialize)]
pub struct Contact {
    /// The one entity,
    first: usize,
    /// with this collider of its own,
    collider: usize,
    /// touches this,
    second: ContactTarget,
    /// of an entity: with this collider;
    other_collider: usize,
    /// how far the first is to be pushed along x and y, 0 not at all;
    push: (f64, f64),
    /// the direction from the first to the second;
    normal: (f64, f64),
    /// whether it blocks: 1 or 0.
    blocks: u8,
}

/// The other side of a contact.
#[derive(Deserialize)]
#[serde(untagged)]
enum ContactTarget {
    /// An entity.
    Entity(usize),
    /// A tile's column and row.
    Tile(i64, i64),
}

impl Contact {
    /// The push of an entity on x and y by a contact that blocks.
    pub fn push_of(&self, entity: usize) -> Option<[f64; 2]> {
        let (x, y) = self.push;
        match self.second {
            _ if self.blocks == 0 => None,
            _ if self.first == entity => Some([x, y]),
            ContactTarget::Entity(second) if second == entity => Some([-x, -y]),
            _ => None,
        }
    }

    /// The side of the first collider.
    fn side(&self) -> Side {
        match self.normal {
            (0.0, 1.0) => Side::Above,
            (0.0, -1.0) => Side::Below,
            (1.0, 0.0) => Side::Right,
            (-1.0, 0.0) => Side::Left,
            other => panic!("{other:?} is no normal"),
        }
    }
}

fn opposite(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    }
}

/// The path of a recorded mode here: nested groups are nested modes.
pub fn our_path(recorded: &str) -> String {
    recorded.split('.').skip(1).step_by(2).collect::<Vec<_>>().join(".")
}

/// The path of a mode without the name of its group, which is not needed to identify it.
pub fn path(entity: &Entity, mode: ModeId) -> &str {
    let (mode, group) = (&entity.modes[mode], &entity.groups[entity.modes[mode].group]);
    let inside = group.name.as_ref().and_then(|name| mode.path.strip_prefix(name)?.strip_prefix('.'));
    inside.unwrap_or(&mode.path)
}

/// Reads a recorded run.
pub fn read(path: &Path) -> Trace {
    let text = std::fs::read_to_string(path).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

impl Trace {
    /// The input of each step.
    pub fn inputs(&self, program: &Program, world: WorldId) -> Vec<Input> {
        let players = program.worlds[world].players.len();
        if players == 0 {
            return vec![Input::nothing(0); self.steps.len()];
        }
        let mut script = String::new();
        for (count, held) in &self.input_sequence_rle {
            let held = if held.is_empty() { "-".to_string() } else { held.join("+") };
            script.push_str(&format!("{held}*{count} "));
        }
        let (script, found) = parse_script(program, world, SourceMap::new().add("inputs", ""), &script);
        assert!(!found.has_errors(), "{found:?}");
        let inputs: Vec<Input> = script.inputs().cloned().collect();
        assert_eq!(inputs.len(), self.steps.len(), "an input for each step");
        inputs
    }
}

/// The leaf whose active modes are those recorded, and its group.
fn leaf(entity: &Entity, recorded: &Recorded) -> (GroupId, LeafId) {
    let paths: Vec<String> = recorded.modes.iter().map(|m| our_path(m)).collect();
    let (id, leaf) = entity
        .leaves
        .pairs()
        .find(|(_, l)| {
            l.path.len() == paths.len() && l.path.iter().all(|&m| paths.iter().any(|p| p == path(entity, m)))
        })
        .unwrap_or_else(|| panic!("{} has no leaf {paths:?}", entity.name));
    (entity.modes[leaf.mode].group, id)
}

/// A discrete variable by its recorded name.
pub fn discrete(entity: &Entity, name: &str) -> DiscreteId {
    entity.discretes.find(|d| d.name == *name).unwrap_or_else(|| panic!("{} has no {name}", entity.name))
}

/// The timer of a recorded mode, and its count for the recorded seconds: 0 while the mode is not active, at most our
/// saturation value.
pub fn timer(sim: &Simulator, slot: SlotId, recorded: &Recorded, mode: &str) -> (TimerId, u32) {
    let s = &sim.world().slots[slot];
    let entity = &sim.program().entities[s.entity];
    let path = our_path(mode);
    let timer = entity.timers.find(|t| self::path(entity, t.mode) == path);
    let timer = timer.unwrap_or_else(|| panic!("{} has no timer of {path}", s.name));
    let steps = (recorded.timers[mode] / sim.world().step.seconds()).round() as u32;
    (timer, steps.min(s.timer_limits[timer]))
}

/// The state of a record, after a step in which `held` was held.
pub fn state(sim: &Simulator, record: &Record, held: &Input, scratch: &mut Scratch) -> Vec<u8> {
    let (program, world) = (sim.program(), sim.world());
    // Values that are not recorded are initial.
    let mut state = sim.initial(scratch).unwrap();
    assert_eq!(world.slots.len(), record.entities.len(), "{} has a slot for each entity", world.name);
    for ((slot, s), recorded) in world.slots.pairs().zip(&record.entities) {
        let entity = &program.entities[s.entity];
        let layout = &world.layout.slots[slot];
        assert_eq!(entity.timers.len(), recorded.timers.len(), "{}: all timers are recorded", s.name);
        assert_eq!(entity.discretes.len(), recorded.dvars.len(), "{}: all discrete variables are recorded", s.name);
        for (var, name) in entity.vars.pairs() {
            for (degree, value) in (0u8..).zip(recorded.vars[&**name]) {
                layout.set_var(&mut state, var, degree, value);
            }
        }
        for (name, value) in &recorded.dvars {
            layout.set_discrete(&mut state, discrete(entity, name), value.round() as i32);
        }
        let (group, leaf) = leaf(entity, recorded);
        layout.set_leaf(&mut state, group, leaf);
        for mode in recorded.timers.keys() {
            let (timer, count) = timer(sim, slot, recorded, mode);
            layout.set_timer(&mut state, timer, if recorded.modes.contains(mode) { count } else { 0 });
        }
        layout.set_space(&mut state, SpaceId::from_index(recorded.space));
    }
    for (player, &at) in world.layout.players.pairs() {
        set_buttons(&mut state, at, held.of(player).buttons);
    }
    with_contacts(sim, &state, record)
}

/// A state with the contact bits of a record.
pub fn with_contacts(sim: &Simulator, state: &[u8], record: &Record) -> Vec<u8> {
    let mut state = state.to_vec();
    for (slot, s) in sim.world().slots.pairs() {
        let touches = sim.program().entities[s.entity].touches.len();
        sim.world().layout.slots[slot].clear_touches(
            &mut state,
            touches,
            sim.program().entities[sim.world().slots[slot].entity].bound,
        );
    }
    for contact in &record.contacts {
        let (slot, side) = (SlotId::from_index(contact.first), contact.side());
        let mine = collider_tags(sim, contact.first, contact.collider);
        let theirs = match contact.second {
            ContactTarget::Entity(second) => {
                let theirs = collider_tags(sim, second, contact.other_collider);
                touch(sim, &mut state, SlotId::from_index(second), (theirs, mine, opposite(side)));
                theirs
            }
            ContactTarget::Tile(column, row) => {
                let space = SpaceId::from_index(record.entities[contact.first].space);
                let map = sim.world().spaces[space].map.as_ref().unwrap();
                let kind = map.kind(column, row).unwrap_or_else(|| panic!("no tile {column}, {row}"));
                map.kinds[kind].tags.iter().copied().collect()
            }
        };
        touch(sim, &mut state, slot, (mine, theirs, side));
    }
    state
}

fn collider_tags(sim: &Simulator, entity: usize, collider: usize) -> TagSet {
    let slot = &sim.world().slots[SlotId::from_index(entity)];
    sim.program().entities[slot.entity].colliders[ColliderId::from_index(collider)].tags
}

/// Sets the bits of one instance for a contact between tags of its own and of another, on a side of its own.
fn touch(sim: &Simulator, state: &mut [u8], slot: SlotId, (mine, theirs, side): (TagSet, TagSet, Side)) {
    let entity = &sim.program().entities[sim.world().slots[slot].entity];
    for (id, touch) in entity.touches.pairs() {
        let on_side = touch.side.is_none_or(|wanted| wanted == side);
        if on_side && touch.mine.meets(mine) && theirs.meets(TagSet::of(touch.other)) {
            sim.world().layout.slots[slot].set_touch(state, id);
        }
    }
}

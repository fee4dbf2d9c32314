//! Goals that are known to be reachable: what holds in states that runs have reached, as text.

use hypedc::ir::{Domain, Id, Origin, Program, SlotId, VarId, World};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::frame::number;

/// A program with goals that hold in some of these states instead of its own.
pub fn with_witnesses(text: &str, program: &Program, world: &World, states: &[Vec<u8>], seed: u64) -> Option<String> {
    let mut rng = Pcg64::seed_from_u64(seed);
    if states.is_empty() {
        return None;
    }
    let mut lines: Vec<String> = text.lines().filter(|l| !l.starts_with("goal ")).map(str::to_string).collect();
    let end = lines.iter().rposition(|l| l.trim() == "}")?;
    let mut goals = Vec::new();
    for index in 0..4 {
        let state = &states[rng.random_range(0..states.len())];
        let count = rng.random_range(1..4);
        let parts: Vec<String> = (0..count).filter_map(|_| part(program, world, state, &mut rng)).collect();
        if !parts.is_empty() {
            goals.push(format!("goal w{index}: {}", parts.join(" and ")));
        }
    }
    lines.splice(end..end, goals);
    Some(lines.join("\n") + "\n")
}

/// Something that holds in a state.
fn part(program: &Program, world: &World, state: &[u8], rng: &mut Pcg64) -> Option<String> {
    let slots: Vec<SlotId> = world.slots.ids().filter(|s| world.layout.slots[*s].alive(state)).collect();
    let slot = *slots.get(rng.random_range(0..slots.len().max(1)))?;
    let (s, layout) = (&world.slots[slot], &world.layout.slots[slot]);
    let entity = &program.entities[s.entity];
    let var = |var: u32, degree: u8| Some(layout.var(state, VarId(var), degree)).filter(|x| x.abs() < 1e12);
    let is_named = s.origin == Origin::Named;
    let who = if is_named { s.name.clone() } else { format!("any {}", entity.name) };
    let modes: Vec<&str> = entity
        .groups
        .ids()
        .flat_map(|g| &entity.leaves[layout.leaf(state, g)].path)
        .map(|m| entity.modes[*m].path.as_str())
        .collect();
    match rng.random_range(0..8) {
        0 | 1 if is_named => {
            let (v, d) = (rng.random_range(0..2), rng.random_range(0..3));
            let value = number(var(v, d)?);
            let name = format!("{who}.{}{}", ["x", "y"][v as usize], "'".repeat(usize::from(d)));
            let op = [">=", "<=", "=="][rng.random_range(0..3)];
            Some(format!("{name} {op} {value}"))
        }
        2 => {
            let radius = ["0.001", "0", "4"][rng.random_range(0..3)];
            Some(format!("near({who}, ({}, {}), {radius})", number(var(0, 0)?), number(var(1, 0)?)))
        }
        3 | 4 if !modes.is_empty() => Some(format!("{who} in {}", modes[rng.random_range(0..modes.len())])),
        5 => Some(format!("inside({who}, {})", world.spaces[layout.space(state)].name)),
        6 if is_named && !entity.discretes.is_empty() => {
            let id = hypedc::ir::DiscreteId(rng.random_range(0..entity.discretes.len()) as u32);
            let value = layout.discrete(state, id);
            let discrete = &entity.discretes[id];
            let value = match &discrete.domain {
                Domain::Int => value.to_string(),
                Domain::Bool => (value != 0).to_string(),
                Domain::Set(names) => names[value as usize].clone(),
            };
            Some(format!("{who}.{} == {value}", discrete.name))
        }
        _ => {
            let held: Vec<usize> = entity
                .touches
                .ids()
                .filter(|t| layout.touch(state, *t))
                .map(|t| entity.touches[t].other.index())
                .collect();
            let tag = held.get(rng.random_range(0..held.len().max(1)))?;
            let name = &program.tags[hypedc::ir::TagId(*tag as u32)];
            Some(format!("{who} touching \"{name}\""))
        }
    }
}

//! What a world can be, held against what it is: no state of random runs lies outside.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use std::path::Path;

use hypedc::analysis::{ConfigurationSpace, configuration_space};
use hypedc::compile::compile;
use hypedc::ir::{Program, VarId, WorldId};
use hypedc::sim::{Input, PlayerInput, Simulator};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use support::{Disk, files};

/// Random steps of each world.
const STEPS: usize = 5_000;

/// What of a state is outside, if anything is.
fn outside(program: &Program, sim: &Simulator<'_>, space: &ConfigurationSpace, state: &[u8]) -> Option<String> {
    let world = sim.world();
    for (slot, s) in world.slots.pairs() {
        let (found, layout) = (&space.slots[slot], &world.layout.slots[slot]);
        let entity = &program.entities[s.entity];
        if found.is_given_up {
            continue;
        }
        if !layout.alive(state) {
            if !found.can_be_absent {
                return Some(format!("{} is absent", s.name));
            }
            continue;
        }
        let leaves: Vec<_> = entity.groups.ids().map(|g| layout.leaf(state, g)).collect();
        let modes: Vec<&str> = leaves.iter().map(|l| entity.modes[entity.leaves[*l].mode].path.as_str()).collect();
        let Some(at) = found.configurations.iter().find(|c| c.leaves == leaves) else {
            return Some(format!("{} is in {modes:?}", s.name));
        };
        for (var, values) in at.vars.pairs() {
            for (degree, values) in (0u8..).zip(values) {
                let value = layout.var(state, var, degree);
                if !values.contains(value) {
                    let name = format!("{}{}", entity.vars[var], "'".repeat(usize::from(degree)));
                    return Some(format!("{} in {modes:?}: {name} is {value}, not in {values}", s.name));
                }
            }
        }
        for (id, values) in at.discretes.pairs() {
            let value = f64::from(layout.discrete(state, id));
            if !values.contains(value) {
                return Some(format!("{} in {modes:?}: {} is {value}", s.name, entity.discretes[id].name));
            }
        }
        for (id, count) in at.timers.pairs() {
            if !count.contains(f64::from(layout.timer(state, id))) {
                return Some(format!("{} in {modes:?}: {id} is {}", s.name, layout.timer(state, id)));
            }
        }
        if !at.spaces.contains(&layout.space(state)) {
            return Some(format!("{} in {modes:?}: in another space", s.name));
        }
    }
    None
}

/// Whether a search would go on: no player is below or beside its space.
fn goes_on(sim: &Simulator<'_>, state: &[u8]) -> bool {
    sim.world().players.iter().all(|p| {
        let layout = &sim.world().layout.slots[p.slot];
        let bounds = sim.world().spaces[layout.space(state)].bounds;
        let (x, y) = (layout.var(state, VarId(0), 0), layout.var(state, VarId(1), 0));
        !layout.alive(state) || bounds.is_none_or(|b| (b.left..=b.right).contains(&x) && y >= b.bottom)
    })
}

/// Runs a world at random; gives what was outside.
fn run(program: &Program, id: WorldId, steps: usize, seed: u64) -> Vec<String> {
    let space = configuration_space(program, id);
    let sim = Simulator::new(program, id);
    let mut scratch = sim.scratch();
    let start = sim.initial(&mut scratch).unwrap();
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut state = start.clone();
    let mut found = Vec::new();
    let mut left = 0;
    let mut input = Input::nothing(sim.world().players.len());
    for _ in 0..steps {
        if let Some(what) = outside(program, &sim, &space, &state) {
            found.push(what);
            if found.len() > 5 {
                break;
            }
        }
        if left == 0 {
            left = rng.random_range(1..32);
            for player in &mut input.0 {
                let axis = |rng: &mut Pcg64| f64::from(rng.random_range(-1..=1));
                let axes = [axis(&mut rng), axis(&mut rng), axis(&mut rng), axis(&mut rng)];
                *player = PlayerInput { buttons: rng.random(), axes };
            }
        }
        left -= 1;
        // A run ends where a search ends, and now and then anyway.
        let ended = sim.step(&mut state, &input, &mut scratch).is_err();
        if ended || !goes_on(&sim, &state) || rng.random_range(0..2_000) == 0 {
            state.copy_from_slice(&start);
        }
    }
    found
}

#[test]
fn no_random_state_lies_outside() {
    let mut all = Vec::new();
    for path in files("examples", "hyped").into_iter().chain(files("tests/conformance", "hyped")) {
        let program = compile(Path::new(&path), &Disk).program.unwrap();
        for world in program.worlds.ids() {
            for what in run(&program, world, STEPS, 1) {
                all.push(format!("{}: {what}", path.display()));
            }
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

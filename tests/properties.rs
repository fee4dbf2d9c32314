//! Properties of random programs, worlds and inputs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod generate;

use crate::support::{compile_text, program};
use hypedc::ir::{Id, Program, SlotId, VarId, WorldId};
use hypedc::sim::{Fault, Input, PlayerInput, Simulator, State};
use proptest::prelude::*;
use std::sync::Arc;

/// The input of a step, drawn from a number.
fn input(players: usize, bits: u64) -> Input {
    let axis = |shift: u32| [-1.0, 0.0, 1.0, 0.5][(bits >> shift & 3) as usize];
    let one = PlayerInput { buttons: bits >> 8 & 3, axes: [axis(0), axis(2), 0.0, 0.0] };
    Input::of_players(vec![one; players])
}

/// Some numbers that look random, from a seed.
fn noise(seed: u64) -> impl Iterator<Item = u64> {
    let mut state = seed | 1;
    std::iter::from_fn(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        Some(state >> 16)
    })
}

/// Every rule that a state keeps between two steps.
fn is_sound(sim: &Simulator, state: &[u8]) {
    let (program, world) = (sim.program(), sim.world());
    for (id, slot) in world.slots.pairs() {
        let (layout, entity) = (&world.layout.slots[id], &program.entities[slot.entity]);
        if !layout.alive(state) {
            assert!(state[layout.block.0..layout.block.1].iter().all(|b| *b == 0), "a free slot is empty");
            continue;
        }
        assert!(layout.space(state).index() < world.spaces.len());
        for (d, discrete) in entity.discretes.pairs() {
            assert!((discrete.range.0..=discrete.range.1).contains(&layout.discrete(state, d)), "within its range");
        }
        for (r, reference) in entity.refs.pairs() {
            if let Some(target) = layout.reference(state, r) {
                assert!(world.layout.slots[target].alive(state), "a reference is to who lives");
                assert!(reference.entity.is_none_or(|e| e == world.slots[target].entity), "and to the right entity");
            }
        }
        for (group, g) in entity.groups.pairs() {
            let mode = entity.leaves[layout.leaf(state, group)].mode;
            assert!(g.modes.contains(mode), "the active leaf is of the group");
        }
        for var in entity.vars.ids() {
            assert!((0..2).all(|degree| layout.var(state, var, degree).is_finite()), "positions and speeds are finite");
        }
    }
}

/// Runs a number of steps; returns the states, and the fault that ended the run.
fn run(program: &Arc<Program>, seed: u64, steps: usize) -> (Vec<State>, Option<Fault>) {
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = match sim.initial(&mut scratch) {
        Ok(state) => state,
        Err(fault) => return (Vec::new(), Some(fault)),
    };
    let players = sim.world().players.len();
    let mut states = vec![state.clone()];
    for bits in noise(seed).take(steps) {
        // An input is held for a while.
        if let Err(fault) = sim.step(&mut state, &input(players, bits), &mut scratch) {
            let _ = fault.fact(program, WorldId(0), states.len() as u64);
            return (states, Some(fault));
        }
        is_sound(&sim, &state);
        for goal in sim.world().goals.ids() {
            let _ = sim.goal(&state, goal);
        }
        let _ = sim.violated(&state);
        let _ = sim.broken_invariant(&state);
        states.push(state.clone());
    }
    (states, None)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_check_and_run(choices in prop::collection::vec(any::<u16>(), 0..400), seed: u64) {
        let text = generate::program(&choices);
        let compiled = compile_text(&text);
        if let Some(program) = &compiled.program {
            let (states, fault) = run(program, seed, 1_000);
            // The same again, bit for bit.
            let (again, fault_again) = run(program, seed, states.len().min(100));
            prop_assert_eq!(&states[..again.len()], &again[..]);
            if states.len() <= 100 {
                prop_assert_eq!(fault, fault_again);
            }
            // A copy of a state continues like the state.
            if states.len() > 2 {
                let sim = Simulator::new(program, WorldId(0));
                let mut scratch = sim.scratch();
                let middle = states.len() / 2;
                let mut copy = states[middle].clone();
                let rest = noise(seed).skip(middle);
                for (bits, expected) in rest.zip(&states[middle + 1..]) {
                    sim.step(&mut copy, &input(sim.world().players.len(), bits), &mut scratch).unwrap();
                    prop_assert_eq!(&copy, expected);
                }
            }
        }
    }
}

#[test]
fn most_random_programs_run() {
    let (mut checked, mut finished, mut steps) = (0, 0, 0);
    for seed in 1..=100u64 {
        let choices: Vec<u16> = noise(seed * 7919).skip(10).take(400).map(|n| n as u16).collect();
        let compiled = compile_text(&generate::program(&choices));
        if let Some(program) = &compiled.program {
            checked += 1;
            let (states, fault) = run(program, seed, 1_000);
            steps += states.len();
            finished += usize::from(fault.is_none());
        }
    }
    // Otherwise the property above is weak.
    assert!(checked >= 30, "{checked} of 100 programs check");
    assert!(finished >= 10 && steps >= 10_000, "{finished} run to the end, {steps} steps");
}

/// A closed room of blocking tiles with an input-driven body.
fn room(width: f64, height: f64, tile: u32, (columns, rows): (usize, usize), pillars: u64) -> Arc<Program> {
    let mut map = String::new();
    for row in 0..rows {
        for column in 0..columns {
            let wall = row == 0 || column == 0 || row == rows - 1 || column == columns - 1;
            // Pillars are separate from each other, the walls and the middle.
            let inside = row > 2 && column > 2 && row < rows - 3 && column < columns - 3;
            let pillar = inside && row % 4 == 3 && column % 4 == 3 && pillars >> ((row + column) % 60) & 1 == 1;
            map.push(if wall || pillar { '#' } else { '.' });
        }
        map.push('\n');
    }
    program(compile_text(&format!(
        "entity Body {{
             axis horizontal, vertical
             param speed = 60
             collider body: rect(0, 0, {width}, {height})
             x' = speed * horizontal
             y' = speed * vertical
         }}
         world W {{
             step 1/60
             collide body with wall: block
             tiles t {tile} x {tile} {{ '.': empty
                 '#': wall }}
             space main {{
                 map t \"
{map}\"
                 place body: Body at ({tile} * 1.5, {tile} * 1.5)
             }}
             player 1: body
         }}"
    )))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Below one tile per step no blocking tile is crossed: a body in a closed room stays inside.
    #[test]
    fn nobody_leaves_a_closed_room(
        (width, height) in (1.0f64..60.0, 1.0f64..60.0),
        tile in prop::sample::select(vec![8u32, 16, 32]),
        share in 0.01f64..0.999,
        pillars: u64,
        seed: u64,
    ) {
        // A body that does not fit between pillars and walls gets a room without pillars.
        let fits = width.max(height) <= f64::from(2 * tile);
        let program = room(width, height, tile, (16, 14), if fits { pillars } else { 0 });
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let size = f64::from(tile);
        let layout = &sim.world().layout.slots[SlotId(0)];
        // Bodies larger than the free space beside the walls start where they have room.
        let (right, top) = (15.0 * size, 13.0 * size);
        prop_assume!(size + width < right - size && size + height < top - size);
        layout.set_var(&mut state, VarId(0), 0, size);
        layout.set_var(&mut state, VarId(1), 0, size);
        let mut held = [0.0, 0.0];
        for bits in noise(seed).take(2_000) {
            // The speed is at most `share` of a tile a step: the parameter is 1 px a step.
            if bits % 7 == 0 {
                held = [bits >> 3 & 1023, bits >> 13 & 1023].map(|n| (n as f64 / 511.5 - 1.0) * share);
            }
            // Positions are moved as flows would: the axes are within -1..1, so large tiles take several pixels a step.
            let fast = PlayerInput { buttons: 0, axes: [held[0], held[1], 0.0, 0.0] };
            let scaled = Input::of_players(vec![PlayerInput { axes: fast.axes.map(|a| a * size), ..fast }]);
            sim.step(&mut state, &scaled, &mut scratch).unwrap();
            let (x, y) = sim.position(&state, SlotId(0));
            let centre = (x + width / 2.0, y + height / 2.0);
            prop_assert!(
                centre.0 > size && centre.0 < right && centre.1 > size && centre.1 < top,
                "left the room at {:?}", (x, y)
            );
        }
    }

    /// A resting body stays where it is, to the last bit, for 100,000 steps.
    #[test]
    fn who_rests_stays_put(
        (width, height) in (1.0f64..60.0, 1.0f64..60.0),
        at in 40.0f64..300.0,
        gravity in -2000.0f64..-1.0,
        ground in prop::sample::select(vec!["tiles", "rect", "platform"]),
    ) {
        let floor = match ground {
            "tiles" => "map t \"\n............\n############\n\"",
            "rect" => "rect wall (0, 0, 400, 32)",
            _ => "place floor: Floor at (0, 0)",
        };
        let program = program(compile_text(&format!(
            "entity Body {{ param gravity = {gravity}; collider body: rect(0, 0, {width}, {height}); y'' = gravity }}
             entity Floor {{ kinematic collider wall: rect(0, 0, 400, 32) }}
             world W {{
                 step 1/60
                 collide body with wall: block
                 tiles t 32 x 32 {{ '.': empty
                     '#': wall }}
                 space main {{ {floor}
                     place body: Body at ({at}, 34) }}
             }}"
        )));
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let body = sim.world().slots.find(|s| s.name == "body").unwrap();
        let nothing = Input::nothing(0);
        for _ in 0..600 {
            sim.step(&mut state, &nothing, &mut scratch).unwrap();
        }
        let (rest, position) = (state.clone(), sim.position(&state, body));
        prop_assert_eq!(position.0, at);
        prop_assert!((position.1 - 32.0).abs() < 1e-9, "it lies on the ground: {}", position.1);
        for step in 0..100_000 {
            sim.step(&mut state, &nothing, &mut scratch).unwrap();
            prop_assert!(state == rest, "it moved in step {step}: {:?}", sim.position(&state, body));
        }
    }
}

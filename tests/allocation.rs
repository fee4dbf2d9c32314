//! A step allocates nothing, nor does the evaluation of goals and nevers: counted in every world of the examples.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::{Disk, files, program};
use allocation_counter::measure;
use hypedc::compile::compile;
use hypedc::ir::{Id, World};
use hypedc::sim::{Input, Simulator};

/// Number of counted steps in each world.
const STEPS: u64 = 300;

/// Inputs that change all the time: every button in its own rhythm, the axes at their ends and in the middle.
fn stir(world: &World, input: &mut Input, step: u64) {
    for player in world.players.ids() {
        let now = &mut input.0[player.index()];
        now.buttons =
            (0..64).filter(|button| step / (7 + 3 * button) % 2 == 1).fold(0, |all, button| all | 1 << button);
        let axes = (0..).zip(&mut now.axes);
        axes.for_each(|(axis, value)| *value = [0.0, 1.0, -1.0][((step / (11 + 2 * axis)) % 3) as usize]);
    }
}

#[test]
fn a_step_allocates_nothing() {
    let mut worlds = 0;
    let (mut reached, mut violated) = (0, 0);
    for path in ["examples", "tests/conformance"].iter().flat_map(|folder| files(folder, "hyped")) {
        let program = program(compile(&path, &Disk));
        for (id, world) in program.worlds.pairs() {
            let sim = Simulator::new(&program, id);
            let mut scratch = sim.scratch();
            let mut state = sim.initial(&mut scratch).unwrap();
            let mut input = Input::nothing(world.players.len());
            let counted = measure(|| {
                for step in 0..STEPS {
                    stir(world, &mut input, step);
                    sim.step(&mut state, &input, &mut scratch).unwrap();
                    reached += world.goals.ids().filter(|&goal| sim.goal(&state, goal).unwrap()).count();
                    violated += usize::from(sim.violated(&state).unwrap().is_some());
                }
            });
            let found = (counted.count_total, counted.bytes_total);
            assert_eq!(found, (0, 0), "{}, world {}: allocations, bytes", path.display(), world.name);
            worlds += 1;
        }
    }
    assert!(worlds >= 10, "the worlds are there");
    assert!(reached + violated > 0, "some world gets somewhere");
}

#[test]
fn allocations_are_counted() {
    let counted = measure(|| drop(std::hint::black_box(vec![0u8; 100])));
    assert_eq!((counted.count_total, counted.bytes_total), (1, 100));
}

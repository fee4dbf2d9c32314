//! A step allocates nothing, nor does the evaluation of goals and nevers: counted in every world of the examples.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::{Disk, compile_text, files, program};
use allocation_counter::measure;
use hypedc::compile::compile;
use hypedc::ir::{Id, World, WorldId};
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
fn a_coin_takes_a_byte_or_two_of_a_state() {
    let size = |coin: &str| {
        let row = |tile: &str| format!("{}\n", tile.repeat(250));
        let text = format!(
            "entity Hero {{ collider body: rect(0, 0, 8, 8)
                 mode idle {{ when touching(body, coin) as it {{ destroy it }} }} }}
             entity Coin {{ collider coin: rect(2, 2, 4, 4)
                 {coin} }}
             world Mint {{
                 collide body with coin: sense
                 tiles mine 8 x 8 {{ '.': empty; 'c': spawn Coin }}
                 space main {{
                     map mine \"
{}
                     \"
                     place hero: Hero at (40, 4)
                 }}
                 goal poor: not any Coin
             }}",
            (row("c").repeat(20) + &row(".")).trim_end()
        );
        let program = program(compile_text(&text));
        let sim = Simulator::new(&program, WorldId(0));
        let (mut scratch, mut run) = (sim.scratch(), 0);
        let mut state = sim.initial(&mut scratch).unwrap();
        let living = |state: &[u8]| sim.instances(state).count();
        let before = living(&state);
        let counted = measure(|| {
            for _ in 0..10 {
                sim.step(&mut state, &Input::default(), &mut scratch).unwrap();
                run += 1;
            }
        });
        assert_eq!((before, run, counted.count_total), (5_001, 10, 0));
        assert!(living(&state) < before, "one is collected");
        state.len() / 5_000
    };
    assert_eq!(size(""), 1);
    assert_eq!(size("always { when touching(coin, body) { destroy self } }"), 2);
    assert_eq!(size("always { when touching(coin, body) as by { destroy self } }"), 4);
    assert_eq!(size("mode there { when touching(coin, body) -> gone } mode gone { }"), 4);
}

#[test]
fn allocations_are_counted() {
    let counted = measure(|| drop(std::hint::black_box(vec![0u8; 100])));
    assert_eq!((counted.count_total, counted.bytes_total), (1, 100));
}

//! One step of the interpreter against one step of the same world written by hand, in the same run.
//!
//! `cargo bench --bench step_ratio` first asserts that both compute the same trajectories, then measures short batches
//! of each alternately and prints medians, so that other load affects all of them. Without `--bench` it only asserts.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, reason = "the table is what it is for")]
#![allow(clippy::disallowed_methods, reason = "it looks at the clock")]

#[path = "../tests/support/mod.rs"]
mod support;
mod yardstick;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use hypedc::compile::compile;
use hypedc::ir::{SlotId, VarId, WorldId};
use hypedc::sim::{Input, Simulator, State, parse_script};
use hypedc::source::SourceMap;
use support::{Disk, program};
use yardstick::{ByHand, JUMP, LEFT, RIGHT, Test1, Test2};

/// Number of measurements of each.
const ROUNDS: usize = 1001;
/// Maximum difference of two numbers, px or px/s.
const TOLERANCE: f64 = 1e-6;
/// Maximum length of an episode, steps.
const LONGEST: u32 = 600;

/// Episodes by the seeds of their random inputs: the first ones in which the player survives for long, boards the brown
/// platform, and moves far; without those in which its side or head hits a wall: there the interpreter differs from the
/// 2017 system on purpose.
const TEST_1: &[u64] = &[37, 46, 162, 301, 410, 428, 435, 478, 512, 605, 685, 808];
const TEST_2: &[u64] = &[11, 14, 34, 106, 125, 174, 180, 197, 248, 270, 285, 289];

/// The held input, as an index into the world's inputs, and its number of steps.
type Held = (usize, u32);

/// Random inputs, each held for 1 to 32 steps (xorshift64*).
fn draws(seed: u64, inputs: usize) -> impl Iterator<Item = Held> {
    let mut x = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
    std::iter::repeat_with(move || {
        x ^= x >> 12;
        x ^= x << 25;
        x ^= x >> 27;
        let drawn = x.wrapping_mul(0x2545_F491_4F6C_DD1D);
        (((drawn >> 40) as usize * inputs) >> 24, ((drawn >> 8) & 31) as u32 + 1)
    })
}

/// The inputs of an episode: until the player leaves the world.
fn episode<W: ByHand>(seed: u64) -> Vec<Held> {
    let mut world = W::start();
    let mut steps = 0;
    let inside = |(input, count): &Held| {
        for _ in 0..*count {
            world.step(W::INPUTS[*input]);
        }
        steps += count;
        let [x, _, y, _] = world.player();
        steps <= LONGEST && (0.0..=640.0).contains(&x) && (0.0..=640.0).contains(&y)
    };
    draws(seed, W::INPUTS.len()).take_while(inside).collect()
}

/// A test in both implementations, and its episodes.
struct Test {
    sim: Simulator,
    /// The state before the first step.
    start: State,
    /// The interpreter's form of each input.
    inputs: Vec<Input>,
    episodes: Vec<Vec<Held>>,
}

impl Test {
    fn new<W: ByHand>(sim: Simulator, seeds: &[u64]) -> Self {
        let mut start = sim.initial(&mut sim.scratch()).unwrap();
        // The 2017 system has no contacts before the first step.
        for (slot, layout) in sim.world().layout.slots.pairs() {
            let entity = &sim.program().entities[sim.world().slots[slot].entity];
            layout.clear_touches(&mut start, entity.touches.len(), entity.bound);
        }
        let inputs = W::INPUTS.iter().map(|&held| input(&sim, held)).collect();
        let episodes = seeds.iter().map(|&seed| episode::<W>(seed)).collect();
        Test { sim, start, inputs, episodes }
    }

    fn steps(&self) -> u32 {
        self.episodes.iter().flatten().map(|(_, count)| count).sum()
    }

    /// The first step at which both differ in an episode, and how.
    fn difference<W: ByHand>(&self, episode: &[Held]) -> Option<String> {
        let mut scratch = self.sim.scratch();
        let mut state = self.start.clone();
        let mut world = W::start();
        let steps = episode.iter().flat_map(|&(input, count)| std::iter::repeat_n(input, count as usize));
        for (step, input) in (1..).zip(steps) {
            self.sim.step(&mut state, &self.inputs[input], &mut scratch).unwrap();
            world.step(W::INPUTS[input]);
            let read = |slot, var, degree| self.sim.world().layout.slots[SlotId(slot)].var(&state, VarId(var), degree);
            let found = [(0, 0, 0), (0, 0, 1), (0, 1, 0), (0, 1, 1), (1, 0, 0), (2, 0, 0)];
            let found = found.map(|(slot, var, degree)| read(slot, var, degree));
            let ([x, vx, y, vy], [one, two]) = (world.player(), world.platforms());
            let expected = [x, vx, y, vy, one, two];
            if found.iter().zip(expected).any(|(a, b)| (a - b).abs() > TOLERANCE) {
                return Some(format!("step {step}: {found:?}, by hand {expected:?}"));
            }
        }
        None
    }

    /// All episodes in the interpreter; ns per step.
    fn interpret(&self, state: &mut [u8], scratch: &mut hypedc::sim::Scratch) -> f64 {
        let before = Instant::now();
        for episode in &self.episodes {
            state.copy_from_slice(&self.start);
            for &(input, count) in episode {
                for _ in 0..count {
                    self.sim.step(state, &self.inputs[input], scratch).unwrap();
                }
            }
            black_box(&*state);
        }
        self.each(before)
    }

    /// All episodes by hand, with the state copied in and out at every step; ns per step.
    fn copied<W: ByHand>(&self) -> f64 {
        let before = Instant::now();
        for episode in &self.episodes {
            let mut world = W::start();
            for &(input, count) in episode {
                for _ in 0..count {
                    let mut copy = black_box(world);
                    copy.step(W::INPUTS[input]);
                    world = copy;
                }
            }
            black_box(&world);
        }
        self.each(before)
    }

    /// All episodes by hand, with the state where the compiler keeps it; ns per step.
    fn kept<W: ByHand>(&self) -> f64 {
        let before = Instant::now();
        for episode in &self.episodes {
            let mut world = W::start();
            for &(input, count) in episode {
                for _ in 0..count {
                    world.step(W::INPUTS[input]);
                }
            }
            black_box(&world);
        }
        self.each(before)
    }

    fn each(&self, since: Instant) -> f64 {
        since.elapsed().as_nanos() as f64 / f64::from(self.steps())
    }
}

/// The input of a player who holds these buttons.
fn input(sim: &Simulator, held: u8) -> Input {
    let names = [(LEFT, "left"), (RIGHT, "right"), (JUMP, "jump")];
    let held: Vec<&str> = names.iter().filter(|(bit, _)| held & bit != 0).map(|(_, name)| *name).collect();
    let text = if held.is_empty() { "-".to_string() } else { held.join("+") };
    let file = SourceMap::new().add("inputs", &text);
    let (script, found) = parse_script(sim.program(), sim.world_id(), file, &text);
    assert!(!found.has_errors(), "{text}: {found:?}");
    script.steps[0].input.clone()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn compare<W: ByHand>(name: &str, seeds: &[u64], measured: bool) {
    let program = program(compile(Path::new(&format!("examples/paper/{name}.hyped")), &Disk));
    let test = Test::new::<W>(Simulator::new(&program, WorldId(0)), seeds);
    for (seed, episode) in seeds.iter().zip(&test.episodes) {
        assert_eq!(test.difference::<W>(episode), None, "{name}, seed {seed}");
    }
    if !measured {
        return;
    }
    let mut scratch = test.sim.scratch();
    let mut state = test.start.clone();
    let rounds: Vec<[f64; 3]> =
        (0..ROUNDS).map(|_| [test.interpret(&mut state, &mut scratch), test.copied::<W>(), test.kept::<W>()]).collect();
    let [interpreter, copied, kept] = [0, 1, 2].map(|which| median(rounds.iter().map(|r| r[which]).collect()));
    let ratio = median(rounds.iter().map(|[interpreter, copied, _]| interpreter / copied).collect());
    println!("{name:<6} {:>8} {interpreter:>14.1} {copied:>16.1} {kept:>14.1} {ratio:>10.2}", test.steps());
}

fn main() {
    let measured = std::env::args().any(|a| a == "--bench");
    if measured {
        println!("ns per step; medians of {ROUNDS} rounds, the ratio is that of the interpreter to the copied state");
        println!("world     steps    interpreter  by hand, copied  by hand, kept      ratio");
    }
    compare::<Test1>("test1", TEST_1, measured);
    compare::<Test2>("test2", TEST_2, measured);
}

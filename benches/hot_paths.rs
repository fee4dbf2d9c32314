//! The hot paths: a simulation step, also in real levels, and a whole search. `cargo bench` prints the times; nothing
//! is asserted about them.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]

#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use hypedc::analysis::configuration_space;
use hypedc::compile::{LevelFile, compile, compile_with};
use hypedc::ir::{GoalId, WorldId};
use hypedc::reach::{Limits, Problem, Settings, Verdict, reach};
use hypedc::sim::{Input, PlayerInput, Simulator, parse_script};
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use support::{Disk, compile_text, program};

/// One step of each of the paper's tests, with inputs that keep everything moving.
fn step(c: &mut Criterion) {
    let scripts = [("test1", "right*30 left*20 -*10"), ("test2", "right+jump*30 left*20 jump*5 -*5")];
    for (name, script) in scripts {
        let program = program(compile(Path::new(&format!("examples/paper/{name}.hyped")), &Disk));
        let file = SourceMap::new().add("inputs", script);
        let (script, _) = parse_script(&program, WorldId(0), file, script);
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let start = sim.initial(&mut scratch).unwrap();
        let steps = script.len();
        let mut state = start.clone();
        c.bench_function(&format!("step/{name}/{steps} steps"), |b| {
            b.iter(|| {
                state.copy_from_slice(&start);
                for input in script.inputs() {
                    sim.step(&mut state, input, &mut scratch).unwrap();
                }
                black_box(&state);
            });
        });
    }
}

/// Steps of Super Mario Bros. with all its enemies, along a path to the end of a level.
fn level(c: &mut Criterion) {
    for name in ["1-1", "8-1"] {
        let level = format!("examples/smb/mario-{name}.txt");
        let level = LevelFile::new(Path::new(&level));
        let program = program(compile_with(Path::new("examples/smb/smb.hyped"), level, &Disk));
        let sim = Simulator::new(&program, WorldId(0));
        let problem = Problem::new(&sim, GoalId(0));
        let space = configuration_space(&program, WorldId(0));
        let found = reach(&problem, &space, &Settings::default(), &Limits::default(), &Unwatched).unwrap();
        let Verdict::Reached(plan) = found.verdict else { panic!("no way through {name}") };
        let mut scratch = sim.scratch();
        let start = sim.initial(&mut scratch).unwrap();
        let mut state = start.clone();
        let mut group = c.benchmark_group("step/smb");
        group.throughput(criterion::Throughput::Elements(plan.steps));
        group.bench_function(format!("{name}, {} instances", sim.world().slots.len()), |b| {
            b.iter(|| {
                state.copy_from_slice(&start);
                for input in plan.script.inputs() {
                    sim.step(&mut state, input, &mut scratch).unwrap();
                }
                black_box(&state);
            });
        });
        group.finish();
    }
}

/// A step and a copy of the state of a world with few and with many breakable tiles: only bytes are added.
fn bricks(c: &mut Criterion) {
    for (columns, rows) in [(10, 5), (200, 100)] {
        let row = |tile: &str| format!("#{}#\n", tile.repeat(columns));
        let map = row("#") + &row("b").repeat(rows) + &row(".").repeat(20) + &row("#");
        let map = map.trim_end();
        let middle = 4 * columns;
        let program = program(compile_text(&format!(
            "entity Ball {{
                 collider ball: rect(0, 0, 6, 6)
                 mode flying {{ when touching(ball, brick) as hit {{ destroy hit }} }}
             }}
             world Wall {{
                 collide ball with wall, brick: block, bounce 1
                 tiles wall 8 x 8 {{ '.': empty; '#': wall; 'b': brick breakable }}
                 space main {{
                     map wall \"
{map}
                     \"
                     place ball: Ball at ({middle}, 20) {{ x' = 140; y' = 90 }}
                 }}
                 goal cleared: count(brick) == 0
             }}"
        )));
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let start = sim.initial(&mut scratch).unwrap();
        let mut state = start.clone();
        let mut group = c.benchmark_group(format!("bricks/{}, {} bytes", columns * rows, start.len()));
        group.bench_function("600 steps", |b| {
            b.iter(|| {
                state.copy_from_slice(&start);
                for _ in 0..600 {
                    sim.step(&mut state, &Input::default(), &mut scratch).unwrap();
                }
                black_box(&state);
            });
        });
        group.bench_function("a copy", |b| {
            b.iter(|| {
                state.copy_from_slice(black_box(&start));
                black_box(&state);
            });
        });
        group.bench_function("the goal", |b| b.iter(|| sim.goal(black_box(&state), GoalId(0)).unwrap()));
        group.finish();
    }
}

/// A step and a copy of the state of a world with few and with many coins, by a player who walks between two of them and
/// by one who collects a row.
fn coins(c: &mut Criterion) {
    for (columns, rows) in [(10, 5), (250, 20)] {
        let row = |tile: &str| format!("#{}#\n", tile.repeat(columns));
        let map = row(".") + &row("c").repeat(rows) + &row(".") + &row("#");
        let map = map.trim_end();
        let program = program(compile_text(&format!(
            "entity Hero {{
                 axis across
                 collider body: rect(1, 0, 6, 7)
                 param speed = 60
                 x' = speed * across
                 y'' = -100
             }}
             entity Coin {{
                 collider coin: rect(2, 2, 4, 4)
                 always {{ when touching(coin, body) {{ destroy self }} }}
             }}
             world Mint {{
                 collide body with wall: block
                 collide body with coin: sense
                 tiles mine 8 x 8 {{ '.': empty; '#': wall; 'c': spawn Coin }}
                 space main {{
                     map mine \"
{map}
                     \"
                     place hero: Hero at (16, 8)
                 }}
                 player 1: hero
                 goal rich: not any Coin
             }}"
        )));
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let start = sim.initial(&mut scratch).unwrap();
        let mut state = start.clone();
        let steps = |across: f64, count: usize| -> Vec<Input> {
            let player = PlayerInput { axes: [across, 0.0, 0.0, 0.0], ..PlayerInput::default() };
            vec![Input::of_players(vec![player]); count]
        };
        let mut group = c.benchmark_group(format!("coins/{}, {} bytes", columns * rows, start.len()));
        let walks = [("60 steps without a coin", steps(0.0, 60)), ("600 steps along a row", steps(1.0, 600))];
        for (name, inputs) in walks {
            group.bench_function(name, |b| {
                b.iter(|| {
                    state.copy_from_slice(&start);
                    for input in &inputs {
                        sim.step(&mut state, input, &mut scratch).unwrap();
                    }
                    black_box(&state);
                });
            });
        }
        group.bench_function("a copy", |b| {
            b.iter(|| {
                state.copy_from_slice(black_box(&start));
                black_box(&state);
            });
        });
        group.finish();
    }
}

/// A step of worlds with many live instances that fall, collide and push each other.
fn crowd(c: &mut Criterion) {
    for instances in [10, 100, 1_000] {
        let mut rng = Pcg64::seed_from_u64(1);
        let side = 40.0 * f64::from(instances).sqrt();
        let mut placed = String::new();
        for i in 0..instances {
            let (x, y) = (rng.random_range(0.0..side), rng.random_range(0.0..side));
            placed.push_str(&format!("place c{i}: Crate at ({x:.0}, {y:.0}) {{ speed = {} }}\n", i % 60));
        }
        let program = program(compile_text(&format!(
            "entity Crate {{
                 param speed = 10
                 collider crate: rect(0, 0, 16, 16)
                 x' = speed
                 mode left {{ x' = -speed; when timer > 1 -> right }}
                 mode right {{ when timer > 1 or touching(crate, right) -> left }}
             }}
             world W {{ collide crate with crate: block
                 space main {{ {placed} }} }}"
        )));
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let nothing = Input::nothing(0);
        c.bench_function(&format!("step/crowd/{instances} instances"), |b| {
            b.iter(|| sim.step(&mut state, &nothing, &mut scratch).unwrap());
        });
    }
}

/// Ten searches, each to its goal.
fn grow(c: &mut Criterion) {
    let program = program(compile(Path::new("examples/paper/test2.hyped"), &Disk));
    let sim = Simulator::new(&program, WorldId(0));
    let problem = Problem::new(&sim, GoalId(0));
    let space = configuration_space(&program, WorldId(0));
    c.bench_function("reach/test2, drawn goal, ten seeds", |b| {
        b.iter(|| {
            for seed in 1..=10 {
                let settings = Settings { seed, ..Settings::default() };
                black_box(reach(&problem, &space, &settings, &Limits::default(), &Unwatched).unwrap());
            }
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = step, level, bricks, coins, crowd, grow
}
criterion_main!(benches);

//! The hot paths: a simulation step, a nearest-neighbour query, a whole search.
//! `cargo bench` prints the times; nothing is asserted about them.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]

#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use hypedc::compile::compile;
use hypedc::ir::{GoalId, WorldId};
use hypedc::reach::{Limits, Linear, Problem, Settings, reach};
use hypedc::sim::{Simulator, parse_script};
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use support::{Disk, program};

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

/// A query among states that share many coordinates, as game states do.
fn nearest(c: &mut Criterion) {
    for points in [1_000, 10_000] {
        let mut rng = Pcg64::seed_from_u64(1);
        let mut linear = Linear::new(8, 3, 0.05);
        for _ in 0..points {
            let reals: Vec<f32> = (0..8).map(|_| rng.random_range(0..50) as f32 / 50.0).collect();
            let modes: Vec<f32> = (0..3).map(|_| rng.random_range(0..3) as f32).collect();
            linear.push(&reals, &modes);
        }
        c.bench_function(&format!("nearest/8 reals, 3 modes/{points} points"), |b| {
            b.iter(|| {
                let reals: [f32; 8] = std::array::from_fn(|_| rng.random_range(0.0..1.0));
                black_box(linear.nearest(&reals, &[0.0, 1.0, 2.0]))
            });
        });
    }
}

/// Ten searches, each to its goal.
fn grow(c: &mut Criterion) {
    let program = program(compile(Path::new("examples/paper/test2.hyped"), &Disk));
    let sim = Simulator::new(&program, WorldId(0));
    let problem = Problem::new(&sim, GoalId(0));
    c.bench_function("reach/test2, drawn goal, ten seeds", |b| {
        b.iter(|| {
            for seed in 1..=10 {
                let settings = Settings { seed, ..Settings::default() };
                black_box(reach(&problem, &settings, &Limits { nodes: 100_000 }, &Unwatched).unwrap());
            }
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = step, nearest, grow
}
criterion_main!(benches);

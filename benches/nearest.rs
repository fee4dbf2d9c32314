//! A planner's operations on the nearest-neighbour index: a query, an insertion, a removal, so that the size is
//! constant. Over 10² to 10⁶ points of 2 to 64 coordinates, uniform and distributed like game states. Nothing is
//! asserted.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use hypedc::reach::Index;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// One coordinate of a game state: of four, a position, a velocity with few values, a counter, a timer that rarely
/// runs.
fn of_a_game(coordinate: usize, rng: &mut Pcg64) -> f32 {
    match coordinate % 4 {
        0 => rng.random_range(0.0..1.0),
        1 => rng.random_range(0..50) as f32 / 50.0,
        2 => rng.random_range(0..4) as f32 / 4.0,
        _ => f32::from(u8::from(rng.random_bool(0.1))) * rng.random_range(0.0..1.0f32),
    }
}

fn anywhere(_: usize, rng: &mut Pcg64) -> f32 {
    rng.random_range(0.0..1.0)
}

/// Measures the operations at a constant number of points.
fn turns(
    c: &mut Criterion,
    group: &str,
    modes: &[u32],
    draw: impl Fn(usize, &mut Pcg64) -> f32,
    pairs: &[(usize, usize)],
) {
    let mut group = c.benchmark_group(format!("nearest/{group}"));
    for &(dimensions, points) in pairs {
        let mut rng = Pcg64::seed_from_u64(1);
        let (mut reals, mut leaves) = (Vec::new(), Vec::new());
        let point = |reals: &mut Vec<f32>, leaves: &mut Vec<f32>, rng: &mut Pcg64| {
            reals.clear();
            reals.extend((0..dimensions).map(|coordinate| draw(coordinate, rng)));
            leaves.clear();
            for &many in modes {
                let below = rng.random_range(1..=many);
                leaves.push(rng.random_range(0..below) as f32);
            }
        };
        let mut index = Index::new(dimensions, modes.len(), 0.05);
        let mut live = Vec::new();
        for _ in 0..points {
            point(&mut reals, &mut leaves, &mut rng);
            live.push(index.len());
            index.push(&reals, &leaves);
        }
        group.bench_function(BenchmarkId::new(format!("{dimensions} coordinates"), points), |b| {
            b.iter(|| {
                point(&mut reals, &mut leaves, &mut rng);
                black_box(index.nearest(&reals, &leaves));
                let at = rng.random_range(0..live.len());
                index.remove(live[at]);
                point(&mut reals, &mut leaves, &mut rng);
                live[at] = index.len();
                index.push(&reals, &leaves);
            });
        });
    }
}

fn games(c: &mut Criterion) {
    let mut pairs = Vec::new();
    for dimensions in [2, 4, 8, 16, 32, 64] {
        pairs.extend([100, 1_000, 10_000, 100_000].map(|points| (dimensions, points)));
    }
    pairs.extend([2, 4, 8, 16, 32].map(|dimensions| (dimensions, 1_000_000)));
    turns(c, "game states", &[2, 3, 3], of_a_game, &pairs);
}

fn uniform(c: &mut Criterion) {
    let mut pairs = Vec::new();
    for dimensions in [2, 4, 8, 16, 32, 64] {
        pairs.extend([100, 1_000, 10_000, 100_000].map(|points| (dimensions, points)));
    }
    pairs.extend([2, 4, 8].map(|dimensions| (dimensions, 1_000_000)));
    turns(c, "uniform", &[], anywhere, &pairs);
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500));
    targets = games, uniform
}
criterion_main!(benches);

//! Time to check programs of 1,000, 10,000 and 100,000 lines: all stages from the text to the analysis, and each shape
//! that stresses one stage at two sizes, to the flat IR. `cargo bench --bench check` prints the times.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]

mod large;
#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use hypedc::compile::{LevelFile, check_with};
use support::{Text, compile_text};

fn lines(c: &mut Criterion) {
    let mut group = c.benchmark_group("check");
    group.sample_size(10);
    for lines in [1_000, 10_000, 100_000] {
        let text = large::realistic(lines);
        group.throughput(Throughput::Elements(text.lines().count() as u64));
        let check = || check_with(Path::new("test.hyped"), LevelFile::default(), &Text(&text));
        group.bench_function(format!("{lines} lines"), |b| b.iter(|| black_box(check())));
    }
    group.finish();
}

fn shapes(c: &mut Criterion) {
    let mut group = c.benchmark_group("check shapes");
    group.sample_size(10);
    for (name, shape) in large::SHAPES {
        for size in [1_000, 4_000] {
            let text = shape(size);
            group.bench_function(format!("{name}/{size}"), |b| b.iter(|| black_box(compile_text(&text))));
        }
    }
    group.finish();
}

criterion_group!(benches, lines, shapes);
criterion_main!(benches);

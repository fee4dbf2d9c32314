//! What the analysis says that cannot be, against worlds that are made to do it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "it says how much it has seen")]

#[path = "analysis/outside.rs"]
mod outside;
mod soundness {
    pub mod arena;
    pub mod choices;
    pub mod claims;
    pub mod eye;
    pub mod files;
    pub mod frame;
    pub mod generate;
    pub mod run;
    pub mod shrink;
    pub mod witness;
}

use std::collections::BTreeMap;

use hypedc::diagnostic::render;
use hypedc::ir::WorldId;
use hypedc::sim::Simulator;
use soundness::claims::Claims;
use soundness::choices::choices;
use soundness::files::compiled;
use soundness::frame::Frame;
use soundness::generate::program;
use soundness::run::{Refuted, Runs, run};
use soundness::shrink::shrunk;
use soundness::witness::with_witnesses;

const STEPS: usize = 160;
const RUNS: u64 = 3;

/// Runs a program at random.
fn refuted(text: &str, seed: u64, samples: Option<&mut Option<String>>) -> Option<(Refuted, String)> {
    let compilation = compiled(text);
    let program = compilation.program.as_ref()?;
    let world = program.worlds.ids().next()?;
    let clock = std::time::Instant::now();
    let claims = Claims::of(&compilation, program, world);
    if std::env::var("HYPEDC_TIMES").is_ok() {
        let slots = program.worlds[world].slots.len();
        println!("{seed}: {:.3} s, {slots} slots, {} configurations, {} claims, {} given up, {:?} bounded", clock.elapsed().as_secs_f64(),
            claims.space.slots.iter().map(|s| s.configurations.len()).sum::<usize>(), claims.count(), claims.space.slots.iter().filter(|s| s.is_given_up).count(),
            {
                let all: Vec<_> = claims.space.slots.iter().flat_map(|s| s.configurations.iter()).flat_map(|c| [c.vars[hypedc::ir::VarId(0)][0].hull(), c.vars[hypedc::ir::VarId(1)][0].hull()]).flatten().collect();
                let bounded = all.iter().filter(|i| i.low.is_finite() && i.high.is_finite()).count();
                100 * bounded / all.len().max(1)
            });
    }
    let sim = Simulator::new(program, world);
    let mut runs = Runs::default();
    for turn in 0..RUNS {
        run(&sim, &claims, STEPS, seed.wrapping_mul(31).wrapping_add(turn), &mut runs);
        if let Some(refuted) = runs.refuted {
            let script = refuted.script.text(program, world);
            return Some((refuted, script));
        }
    }
    if let Some(samples) = samples {
        *samples = with_witnesses(text, program, &program.worlds[world], &runs.samples, seed);
    }
    None
}

fn env(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
}

#[test]
fn programs_compile() {
    let mut failed: BTreeMap<String, (usize, u64)> = BTreeMap::new();
    let count = 500;
    let mut good = 0;
    for seed in 0..count {
        let text = program(&choices(seed), Frame::default());
        let compilation = compiled(&text);
        if compilation.program.is_some() {
            good += 1;
            continue;
        }
        let said = render::human(&compilation.sources, compilation.diagnostics.iter().filter(|d| d.severity == hypedc::diagnostic::Severity::Error), false);
        let first = said.lines().take(6).collect::<Vec<_>>().join("\n");
        failed.entry(said.lines().next().unwrap_or("").to_string()).or_insert((0, seed)).0 += 1;
        if seed < 60 {
            println!("{seed}: {first}");
        }
    }
    println!("{good} of {count}; {failed:#?}");
}

#[test]
fn hunt() {
    let (from, count) = (env("HYPEDC_FROM", 0), env("HYPEDC_WORLDS", 300));
    let mut classes: BTreeMap<String, usize> = BTreeMap::new();
    let most = env("HYPEDC_SHRINK", 2) as usize;
    let out = std::env::var("HYPEDC_OUT").ok();
    let (mut compiled_count, mut found) = (0, 0);
    let clock = std::time::Instant::now();
    let mut slowest = (0.0, 0);
    for seed in from..from + count {
        let text = program(&choices(seed), Frame::default());
        compiled_count += 1;
        let start = clock.elapsed().as_secs_f64();
        let mut more = None;
        let mut text = text;
        let mut result = refuted(&text, seed, Some(&mut more));
        if let (None, Some(more)) = (&result, more) {
            result = refuted(&more, seed, None);
            text = more;
        }
        let took = clock.elapsed().as_secs_f64() - start;
        if took > slowest.0 {
            slowest = (took, seed);
        }
        let Some((refuted_by, _)) = result else { continue };
        found += 1;
        let class = refuted_by.violation.class.clone();
        let known = classes.entry(class.clone()).or_default();
        *known += 1;
        if *known > most {
            continue;
        }
        let mut fails = |text: &str| refuted(text, seed, None).is_some_and(|(r, _)| r.violation.class == class);
        let small = shrunk(&text, &mut fails);
        let Some((last, script)) = refuted(&small, seed, None) else { continue };
        let report = format!(
            "// {}: {}\n// world {seed}; inputs: {script}\n{small}",
            last.violation.class, last.violation.what
        );
        println!("{report}");
        if let Some(folder) = &out {
            let name = class.replace(|c: char| !c.is_alphanumeric(), "_");
            std::fs::write(format!("{folder}/{name}-{seed}.hyped"), &report).unwrap();
        }
    }
    println!("{compiled_count} worlds, {found} refuted, {:.1} s, slowest {slowest:?}; {classes:#?}", clock.elapsed().as_secs_f64());
    let _ = WorldId(0);
}

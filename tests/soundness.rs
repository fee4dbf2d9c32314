//! What the analysis says that cannot be, against worlds that are made to do it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "it says how much it has seen")]

#[path = "analysis/outside.rs"]
mod outside;
mod soundness {
    pub mod alike;
    pub mod arena;
    pub mod choices;
    pub mod claims;
    pub mod consecution;
    pub mod eye;
    pub mod files;
    pub mod frame;
    pub mod generate;
    pub mod run;
    pub mod shrink;
    pub mod tally;
    pub mod witness;
}

use std::collections::BTreeMap;

use hypedc::diagnostic::render;
use hypedc::ir::WorldId;
use hypedc::sim::Simulator;
use soundness::alike::Otherwise;
use soundness::claims::{Claims, Standing};
use soundness::consecution::consecution;
use soundness::choices::choices;
use soundness::files::compiled;
use soundness::frame::Frame;
use soundness::generate::program;
use soundness::run::{Inputs, Refuted, Runs, exhaust, run};
use soundness::shrink::shrunk;
use soundness::tally::Tally;
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
    if seed % 4 == 0 {
        exhaust(&sim, &claims, 300, [1, 4, 12][(seed / 4 % 3) as usize], &mut runs);
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

/// Mistakes that show in the same way, and as early, are most often the same.
fn class_of(refuted: &Refuted) -> String {
    let when = match refuted.script.len() {
        0 => " at the start",
        1 => " in the first step",
        _ => "",
    };
    format!("{}{when}", refuted.violation.class)
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
        if compiled_count % 1_000 == 0 {
            println!("{compiled_count} worlds to {seed}, {found} refuted, {:.0} s; {classes:?}", clock.elapsed().as_secs_f64());
        }
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
        let class = class_of(&refuted_by);
        let known = classes.entry(class.clone()).or_default();
        *known += 1;
        let most = if class.contains(" at the start") { 1 } else { most };
        if *known > most {
            continue;
        }
        let mut fails = |text: &str| refuted(text, seed, None).is_some_and(|(r, _)| class_of(&r) == class);
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

/// Everything that the language has happens in the suite's worlds.
#[test]
fn every_construct_happens() {
    let mut tally = Tally::default();
    for seed in 0..env("HYPEDC_WORLDS", 1_500) {
        let text = program(&choices(seed), Frame::default());
        let Some(program) = compiled(&text).program else { continue };
        tally.read(&text);
        let sim = Simulator::new(&program, WorldId(0));
        let mut scratch = sim.scratch();
        let Ok(mut state) = sim.initial(&mut scratch) else { continue };
        let mut inputs = Inputs::new(seed, sim.world().players.len());
        for _ in 0..120 {
            let before = state.clone();
            let input = inputs.next();
            if let Err(fault) = sim.step(&mut state, input, &mut scratch) {
                tally.stopped(&fault);
                break;
            }
            tally.watch(&sim, &before, input, &state, &scratch);
        }
    }
    let (rules, events) = (tally.rules(), tally.events());
    for (name, count) in rules.iter().chain(&events) {
        println!("{count:>10}  {name}");
    }
    let none: Vec<&String> = rules.iter().chain(&events).filter(|(_, count)| *count == 0).map(|(name, _)| name).collect();
    assert!(none.is_empty(), "never: {none:?}");
}

#[test]
fn temporary_known() {
    let Ok(folder) = std::env::var("HYPEDC_KNOWN") else { return };
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|p| p.extension().is_some_and(|e| e == "hyped")) {
        let text = std::fs::read_to_string(path).unwrap();
        let found = (0..20).find_map(|seed| {
            let mut more = None;
            let found = refuted(&text, seed, Some(&mut more));
            found.or_else(|| refuted(&more?, seed, None))
        });
        println!("{}: {}", path.file_name().unwrap().to_str().unwrap(), found.map_or("-".into(), |(r, _)| format!("{}: {}", r.violation.class, r.violation.what)));
    }
}

#[test]
fn possible_states_lead_to_possible_ones() {
    let mut classes: BTreeMap<String, (usize, u64)> = BTreeMap::new();
    let (mut states, mut stepped) = (0, 0);
    let from = env("HYPEDC_FROM", 0);
    for seed in from..from + env("HYPEDC_WORLDS", 300) {
        let compilation = compiled(&program(&choices(seed), Frame::default()));
        let Some(program) = &compilation.program else { continue };
        let claims = Claims::of(&compilation, program, WorldId(0));
        let sim = Simulator::new(program, WorldId(0));
        let mut runs = Runs::default();
        run(&sim, &claims, STEPS, seed, &mut runs);
        if runs.refuted.is_some() {
            continue;
        }
        let drawn = consecution(&sim, &claims, &runs.samples, 100, seed);
        states += drawn.states;
        stepped += drawn.stepped;
        let mut said = std::collections::BTreeSet::new();
        for hint in drawn.hints {
            if said.insert(hint.class.clone()) {
                println!("{seed}: {}: {}", hint.class, hint.what);
                classes.entry(hint.class).or_insert((0, seed)).0 += 1;
            }
        }
    }
    println!("{states} states, {stepped} stepped; hints in worlds: {classes:#?}");
}

#[test]
fn the_same_world_written_otherwise_is_judged_alike() {
    let mut differ: BTreeMap<Otherwise, (usize, usize, Vec<String>)> = BTreeMap::new();
    let from = env("HYPEDC_FROM", 0);
    for seed in from..from + env("HYPEDC_WORLDS", 200) {
        let choices = choices(seed);
        let verdicts = |text: &str| {
            let compilation = compiled(text);
            let program = compilation.program.as_ref()?;
            let claims = Claims::of(&compilation, program, WorldId(0));
            let is_given_up = claims.space.slots.iter().any(|s| s.is_given_up);
            (!is_given_up).then(|| claims.verdicts(program, WorldId(0)))
        };
        let Some(plain) = verdicts(&program(&choices, Frame::default())) else { continue };
        for way in Otherwise::ALL {
            let Some(text) = way.written(&choices) else { continue };
            if compiled(&text).program.is_none() { println!("{seed}: {way:?} does not compile"); }
            let Some(other) = verdicts(&text) else { continue };
            let entry = differ.entry(way).or_default();
            entry.0 += plain.len();
            for ((name, a), (_, b)) in plain.iter().zip(&other).filter(|(a, b)| a.1 != b.1) {
                entry.1 += 1;
                entry.2.push(format!("{seed} {name}: {a} {b}"));
            }
        }
    }
    for (way, (count, other, examples)) in differ {
        println!("{way:?}: {other} of {count} verdicts differ: {:?}", &examples[..examples.len().min(12)]);
    }
    let _ = Standing { is_inside: true, is_allowed: true };
}

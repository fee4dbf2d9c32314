//! What the analysis says that cannot be, against worlds that are made to do it: random ones with every construct of the
//! language, and changed ones whose verdicts hang by a thread. Claims are what variables, modes, timers and spaces can be,
//! goals that are proven unreachable, invariants, and what `check` says of guards and modes.
//!
//! `HYPEDC_LONG=1 HYPEDC_WORLDS=1000000 cargo test --test proofs soundness::nothing -- --nocapture` looks at that many worlds of
//! each kind, and tells of every 10,000th. The number of a world is its seed: `HYPEDC_FROM=N` goes on where another run
//! was stopped, and several processes can share the numbers. A violation is printed as soon as it is found, as a program
//! of a few lines with the inputs that lead there.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "it says how much it has seen")]

mod alike;
mod arena;
mod ask;
mod choices;
mod claims;
mod consecution;
mod entities;
mod expressions;
mod eye;
mod files;
mod flows;
mod frame;
mod generate;
mod hunt;
mod independent;
mod look;
mod mutants;
#[path = "mutation/mutate.rs"]
#[allow(dead_code, reason = "the lines of changes are not told")]
mod mutate;
pub mod poll_limit;
mod run;
mod shrink;
mod situations;
mod tally;
mod updates;
mod varied;
mod witness;

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::outside;
use crate::support::{files, is_long};
use alike::Otherwise;
use choices::choices;
use claims::Claims;
use consecution::consecution;
use files::compiled;
use frame::Frame;
use generate::program;
use hunt::{Source, hunt, refuted_by};
use hypedc::ir::WorldId;
use hypedc::sim::Simulator;
use mutants::originals;
use run::{Inputs, Runs, run};
use tally::Tally;

/// The numbers of the worlds to test: a default range, or as set by the environment.
fn seeds(usual: u64, long: u64) -> std::ops::Range<u64> {
    let number = |name: &str| std::env::var(name).ok().and_then(|v| v.parse().ok());
    if !is_long() {
        return 0..usual;
    }
    let from: u64 = number("HYPEDC_FROM").unwrap_or(0);
    from..from + number("HYPEDC_WORLDS").unwrap_or(long)
}

/// Tests worlds of a kind; almost all compile, and no claim is refuted.
fn holds(source: &Source, (usual, long): (u64, u64), compiles: u64) {
    let hunt = hunt(source, seeds(usual, long));
    let (worlds, compiled) = (hunt.worlds, hunt.compiled);
    println!("{worlds} worlds, {compiled} compile, {} claims, {} states: {:?}", hunt.claims, hunt.states, hunt.classes);
    println!("{} given up, {} told apart by place", hunt.given_up, hunt.by_place);
    assert!(compiled * 100 >= worlds * compiles, "{compiled} of {worlds} compile");
    assert!(hunt.reports.is_empty(), "{:?}\n\n{}", hunt.classes, hunt.reports.join("\n"));
}

#[test]
fn nothing_that_is_claimed_of_random_worlds_is_false() {
    holds(&Source::Drawn, (250, 14_000), 90);
}

#[test]
fn nothing_that_is_claimed_of_changed_worlds_is_false() {
    holds(&Source::Changed(originals()), (1_500, 30_000), 60);
}

/// With one parameter that is any number of an interval.
#[test]
fn nothing_that_is_claimed_of_all_values_of_a_parameter_is_false() {
    let mut all = varied::Varieties::default();
    // One of them once had timers that stop too early: what a tile makes is spawned again.
    for seed in seeds(250, 14_000).chain([6_225]) {
        varied::vary(seed, &mut all);
    }
    let varied::Varieties { worlds, is_read, ruled_out, states, bites, reports } = all;
    println!("{worlds} worlds, {is_read} with an instance, {ruled_out} goals ruled out, {states} states, {bites} bite");
    assert!(reports.is_empty(), "{}", reports.join("\n\n"));
    let enough = worlds > 150 && is_read > 100 && ruled_out > 50 && states > 20_000 && bites > 10;
    assert!(enough, "{worlds} {is_read} {ruled_out} {states} {bites}");
}

/// Leaving out who cannot help loses no way.
#[test]
fn what_is_proven_without_others_is_never_reached() {
    let mut seen = independent::Seen::default();
    seeds(600, 60_000).for_each(|seed| independent::look(seed, &mut seen));
    let independent::Seen { worlds, proven, proven_without, reached, reports } = seen;
    println!("{worlds} worlds, {proven} proofs, {proven_without} of them without others, {reached} ways");
    assert!(reports.is_empty(), "{}", reports.join("\n\n"));
    assert!(proven > 25 && proven_without > 15 && reached > 12, "{proven} {proven_without} {reached}");
}

/// These programs once had a false verdict.
#[test]
fn what_was_false_once_is_not_said_again() {
    let mut again = Vec::new();
    for path in files("tests/analysis/found", "hyped") {
        let text = std::fs::read_to_string(&path).unwrap();
        let refuted = (0..8).find_map(|seed| refuted_by(&text, seed));
        again.extend(refuted.map(|r| format!("{}: {}", path.display(), r.violation.what)));
    }
    assert!(again.is_empty(), "{}", again.join("\n"));
}

/// Every construct of the language occurs in the random worlds, and takes effect when they run.
#[test]
fn every_construct_happens() {
    let mut tally = Tally::default();
    for seed in seeds(2_000, 80_000) {
        let text = program(&choices(seed), Frame::default());
        let compilation = compiled(&text);
        let Some(program) = &compilation.program else { continue };
        tally.read(&text);
        let sim = Simulator::new(program, WorldId(0));
        let mut scratch = sim.scratch();
        let Ok(mut state) = sim.initial(&mut scratch) else { continue };
        // All of them would take long.
        let is_by_place = seed.is_multiple_of(16) && Claims::of(&compilation, program, WorldId(0)).is_by_place();
        tally.survey(&sim, is_by_place);
        let mut inputs = Inputs::new(seed, &sim);
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
    let all: Vec<(String, usize)> = tally.rules().into_iter().chain(tally.events()).collect();
    for (name, count) in &all {
        println!("{count:>10}  {name}");
    }
    let never: Vec<&String> = all.iter().filter(|(_, count)| *count == 0).map(|(name, _)| name).collect();
    assert!(never.is_empty(), "never: {never:?}");
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    insta::assert_snapshot!(names.join("\n"));
}

/// A text without conditions: their expressions are in place of their names.
fn without_names(text: &str) -> (String, usize) {
    let mut expressions: BTreeMap<String, String> = BTreeMap::new();
    let mut out = String::new();
    for line in text.lines() {
        let mut written = String::new();
        for word in line.split_inclusive(|c: char| !c.is_alphanumeric() && c != '_') {
            let name = word.trim_end_matches(|c: char| !c.is_alphanumeric() && c != '_');
            match expressions.get(name) {
                Some(expression) => written.push_str(&format!("({expression}){}", &word[name.len()..])),
                None => written.push_str(word),
            }
        }
        match written.trim_start().strip_prefix("condition ").and_then(|rest| rest.split_once(" = ")) {
            Some((name, expression)) => drop(expressions.insert(name.to_string(), expression.to_string())),
            None => out.push_str(&(written + "\n")),
        }
    }
    (out, expressions.len())
}

#[test]
fn names_of_guards_change_nothing() {
    let (mut names, mut programs) = (0, 0);
    for seed in seeds(300, 6_000) {
        let text = program(&choices(seed), Frame::default());
        let (written, count) = without_names(&text);
        let (named, written) = (compiled(&text), compiled(&written));
        assert_eq!(named.program.is_some(), written.program.is_some(), "world {seed}\n{text}");
        let (Some(named), Some(written)) = (&named.program, &written.program) else { continue };
        assert_eq!(hypedc::ir::text(named), hypedc::ir::text(written), "world {seed}\n{text}");
        names += count;
        programs += 1;
    }
    assert!(programs > 200 && names > programs, "{names} names in {programs} programs");
}

/// Steps states that are possible by the claims; what is not possible then is told. It is a hint: no run may ever be in
/// the state before.
#[test]
fn possible_states_lead_to_possible_ones() {
    let mut hints: BTreeMap<String, (usize, String)> = BTreeMap::new();
    let (mut states, mut stepped) = (0, 0);
    for seed in seeds(50, 3_000) {
        let compilation = compiled(&program(&choices(seed), Frame::default()));
        let Some(program) = &compilation.program else { continue };
        let claims = Claims::of(&compilation, program, WorldId(0));
        let sim = Simulator::new(program, WorldId(0));
        let mut runs = Runs::default();
        run(&sim, &claims, 160, seed, &mut runs);
        // False claims about reached states are reported elsewhere.
        if runs.refuted.is_some() {
            continue;
        }
        let drawn = consecution(&sim, &claims, &runs.samples, 100, seed);
        states += drawn.states;
        stepped += drawn.stepped;
        let mut classes = BTreeSet::new();
        for hint in drawn.hints {
            if classes.insert(hint.class.clone()) {
                hints.entry(hint.class).or_insert((0, format!("world {seed}: {}", hint.what))).0 += 1;
            }
        }
    }
    println!("{states} states, {stepped} stepped; hints by class, with their worlds:\n{hints:#?}");
    assert!(stepped * 4 >= states && stepped > 0, "{stepped} of {states}");
}

#[test]
fn the_same_world_written_otherwise_is_judged_alike() {
    let mut differ: BTreeMap<Otherwise, (usize, Vec<String>)> = BTreeMap::new();
    for seed in seeds(80, 3_000) {
        let choices = choices(seed);
        let verdicts = |text: &str| {
            let compilation = compiled(text);
            let program = compilation.program.as_ref()?;
            let claims = Claims::of(&compilation, program, WorldId(0));
            // The time of an analysis depends on how the world is written.
            let is_given_up = claims.space.slots.iter().any(|s| s.is_given_up);
            (!is_given_up).then(|| claims.verdicts(program, WorldId(0)))
        };
        let Some(plain) = verdicts(&program(&choices, Frame::default())) else { continue };
        for way in Otherwise::ALL {
            let Some(other) = way.written(&choices).and_then(|text| verdicts(&text)) else { continue };
            let (count, found) = differ.entry(way).or_default();
            *count += plain.len();
            let others = plain.iter().zip(&other).filter(|(a, b)| a.1 != b.1);
            found.extend(others.map(|((name, a), (_, b))| format!("{seed} {name}: {a}, then {b}")));
        }
    }
    println!("{differ:#?}");
    for way in Otherwise::ALL {
        let (count, found) = &differ[&way];
        // Rounding, and the numbers at which widening stops, differ with the frame.
        let most = if matches!(way, Otherwise::Mirrored | Otherwise::Shifted) { count / 50 } else { 0 };
        assert!(found.len() <= most, "{way:?}: {found:#?}");
        assert!(*count > 0, "{way:?}: nothing to compare");
    }
}

//! The configuration space of a world is sound: it contains all states of random runs.
//!
//! `HYPEDC_LONG=1 cargo test --test proofs analysis` runs a million steps of each world and 5,000 random programs with
//! new seeds; otherwise the random programs are always the same.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "it says how much it has seen")]

#[path = "properties/generate.rs"]
pub mod any_program;
mod by_place;
mod false_verdicts;
mod found;
pub mod generate;
mod members;
pub mod outside;
mod places;
mod regions;
mod run;
mod sharp;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;

use crate::soundness::poll_limit;
use crate::support::{Disk, compile_text, files, sized};
use hypedc::compile::compile;
use hypedc::ir::WorldId;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestError, TestRunner};
use run::{Run, run};

#[test]
fn no_random_state_lies_outside() {
    let steps = sized(1_000, 1_000_000);
    let (mut all, mut worlds, mut states) = (Vec::new(), 0, 0);
    for path in files("examples", "hyped").into_iter().chain(files("tests/conformance", "hyped")) {
        let program = compile(Path::new(&path), &Disk).program.unwrap();
        for world in program.worlds.ids() {
            let run = run(&program, world, steps, 1);
            worlds += 1;
            states += run.states;
            all.extend(run.outside.into_iter().map(|what| format!("{}: {what}", path.display())));
        }
    }
    println!("{worlds} worlds, {states} states, {} outside", all.len());
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// Statistics of random programs.
#[derive(Debug, Default)]
struct Tally {
    programs: usize,
    /// Number of programs that compile.
    compiled: usize,
    states: usize,
    slots: usize,
    given_up: usize,
    /// Number of runs by event.
    seen: BTreeMap<String, usize>,
}

impl Tally {
    fn add(&mut self, run: &Run) {
        self.states += run.states;
        self.slots += run.slots;
        self.given_up += run.given_up;
        let happened =
            [("spawned", run.spawned), ("ended", run.ended), ("linked", run.linked), ("by place", run.is_by_place)];
        let happened = happened.into_iter().filter(|(_, did)| *did).map(|(name, _)| name);
        for name in happened.chain(run.goals.iter().map(String::as_str)) {
            *self.seen.entry(name.to_string()).or_default() += 1;
        }
    }

    /// Percentage of compiled programs with an event.
    fn share(&self, of: &str) -> usize {
        100 * self.seen.get(of).copied().unwrap_or(0) / self.compiled.max(1)
    }
}

/// Runs random programs; shrinks and reports one with a state outside.
fn hold(programs: u32, length: std::ops::Range<usize>, generate: fn(&[u16]) -> String) -> Tally {
    let rng_seed = sized(RngSeed::Fixed(1), RngSeed::Random);
    let config = ProptestConfig { cases: programs, failure_persistence: None, rng_seed, ..ProptestConfig::default() };
    let tally = RefCell::new(Tally::default());
    let choices = (prop::collection::vec(any::<u16>(), length), any::<u64>());
    let result = TestRunner::new(config).run(&choices, |(choices, seed)| {
        let mut tally = tally.borrow_mut();
        tally.programs += 1;
        let Some(program) = compile_text(&generate(&choices)).program else { return Ok(()) };
        tally.compiled += 1;
        let run = run(&program, WorldId(0), 1_000, seed);
        tally.add(&run);
        if run.outside.is_empty() { Ok(()) } else { Err(TestCaseError::fail(run.outside.join("\n"))) }
    });
    if let Err(error) = result {
        match error {
            TestError::Fail(why, (choices, seed)) => panic!("{}\nseed {seed}: {why}", generate(&choices)),
            TestError::Abort(why) => panic!("{why}"),
        }
    }
    let tally = tally.into_inner();
    println!("{tally:?}");
    tally
}

#[test]
fn no_state_of_a_lively_program_lies_outside() {
    let tally = hold(sized(60, 5_000), 200..700, generate::program);
    // Otherwise the test is weak.
    assert!(tally.compiled * 100 >= tally.programs * 90, "{tally:?}");
    assert!(tally.given_up * 100 <= tally.slots * 5, "{tally:?}");
    let least = [
        ("wall", 80),
        ("lift", 25),
        ("cloud", 25),
        ("foe", 20),
        ("shot", 15),
        ("spawned", 30),
        ("ended", 10),
        ("linked", 12),
        ("away", 8),
        ("far", 8),
    ];
    for (what, least) in least {
        assert!(tally.share(what) >= least, "{what}: {} of 100 programs, {tally:?}", tally.share(what));
    }
}

#[test]
fn no_state_of_any_program_lies_outside() {
    let tally = hold(sized(100, 5_000), 0..400, any_program::program);
    assert!(tally.compiled * 100 >= tally.programs * 20, "{tally:?}");
}

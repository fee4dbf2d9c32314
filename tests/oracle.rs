//! A slow reference interpreter of worlds, written from the language reference, without code of the simulator or the
//! analysis. Both must have the same states, to the bit, and no verdict may contradict its exhaustive search.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "it says how much it has seen")]

mod ask;
mod brute;
pub mod collide;
mod compare;
mod evaluate;
mod flow;
pub mod generate;
mod lamps;
mod members;
mod model;
mod probe;
mod seam;
pub mod slope;
mod step;
mod verdict;

use std::cell::RefCell;
use std::path::Path;

use crate::analysis::{any_program, generate as lively};
use crate::support::{Disk, Text, files, sized};
use hypedc::compile::{IdeCompilation, compile_for_ide};
use hypedc::ir::WorldId;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestError, TestRunner};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use verdict::{Judge, Tally};

/// A number from the environment.
fn set(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap())
}

fn study_text(text: &str) -> IdeCompilation {
    compile_for_ide(Path::new("test.hyped"), &Text(text))
}

/// Generates a number of programs and checks them. One that fails is shrunk and reported.
fn hold(worlds: u64, generate: fn(&[u16]) -> String, check: impl Fn(&IdeCompilation, u64) -> Result<(), String>) {
    let seed = set("HYPEDC_SEED").unwrap_or(sized(1, u64::from(std::process::id())));
    println!("HYPEDC_SEED={seed}");
    let cases = worlds as u32;
    let config = ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(seed),
        max_shrink_iters: 400,
        ..ProptestConfig::default()
    };
    let choices = (prop::collection::vec(any::<u16>(), 40..500), any::<u64>());
    let result = TestRunner::new(config).run(&choices, |(choices, seed)| {
        let study = study_text(&generate(&choices));
        if study.compilation.program.is_none() {
            return Ok(());
        }
        check(&study, seed).map_err(TestCaseError::fail)
    });
    match result {
        Ok(()) => {}
        Err(TestError::Fail(_, (choices, seed))) => {
            let fails = |text: &str| {
                let study = study_text(text);
                let has_world = study.compilation.program.as_ref().is_some_and(|p| !p.worlds.is_empty());
                has_world.then(|| check(&study, seed).err()).flatten()
            };
            let text = shortened(&generate(&choices), &|text| fails(text).is_some());
            panic!("{text}\nseed {seed}: {}", fails(&text).unwrap());
        }
        Err(TestError::Abort(why)) => panic!("{why}"),
    }
}

/// A program without the lines and blocks that are not needed for the failure.
fn shortened(text: &str, fails: &dyn Fn(&str) -> bool) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
    let mut from = 0;
    while from < lines.len() {
        let mut open = 0;
        let end = (from..lines.len()).find(|at| {
            open += lines[*at].matches('{').count() as i32 - lines[*at].matches('}').count() as i32;
            open <= 0
        });
        let without: Vec<String> = match end {
            Some(end) if open == 0 => [&lines[..from], &lines[end + 1..]].concat(),
            _ => lines.clone(),
        };
        if without.len() < lines.len() && fails(&without.join("\n")) {
            lines = without;
            from = from.saturating_sub(1);
        } else {
            from += 1;
        }
    }
    lines.join("\n")
}

/// Runs both on many programs with random inputs.
fn same_states(worlds: u64, steps: usize, generate: fn(&[u16]) -> String) {
    let seen = RefCell::new((0, 0, 0));
    hold(worlds, generate, |study, seed| {
        let mut rng = Pcg64::seed_from_u64(seed);
        let program = study.compilation.program.as_ref().unwrap();
        let run = compare::run(program, &study.checked, WorldId(0), steps, &mut rng);
        let mut seen = seen.borrow_mut();
        *seen = (seen.0 + 1, seen.1 + run.steps, seen.2 + usize::from(run.faulted));
        run.difference.map_or(Ok(()), |difference| Err(format!("{difference}\n{}", run.script.join(" "))))
    });
    let (compiled, done, faults) = seen.into_inner();
    println!("{compiled} of {worlds} compile, {done} steps, {faults} faults");
    assert!(compiled * 100 >= worlds * 20 && done as u64 >= compiled * steps as u64 / 3, "{compiled} {done}");
}

#[test]
fn tiny_worlds_have_the_same_states() {
    same_states(set("HYPEDC_WORLDS").unwrap_or(600), 120, generate::program);
}

#[test]
fn worlds_with_many_instances_that_never_move_have_the_same_states() {
    let worlds = set("HYPEDC_WORLDS").unwrap_or(sized(100, 10_000));
    same_states(worlds, 80, lamps::program);
    let tally = RefCell::new(lamps::Tally::default());
    hold(worlds, lamps::program, |study, seed| {
        let program = study.compilation.program.as_ref().unwrap();
        tally.borrow_mut().count(program, WorldId(0), 80, &mut Pcg64::seed_from_u64(seed));
        Ok(())
    });
    let tally = tally.into_inner();
    println!("{tally:?}");
    // Otherwise the test is weak.
    assert!(tally.worlds * 100 >= worlds as usize * 25, "{tally:?}");
    assert!(tally.edges > tally.worlds && tally.contacts > tally.worlds, "{tally:?}");
    assert!(2 * tally.destroyed > tally.worlds, "{tally:?}");
}

#[test]
fn lively_worlds_have_the_same_states() {
    same_states(sized(60, 5_000), 200, lively::program);
}

#[test]
fn any_worlds_have_the_same_states() {
    same_states(sized(200, 5_000), 100, any_program::program);
}

/// Judges many tiny worlds.
fn true_verdicts(judge: Judge) -> Tally {
    let worlds = set("HYPEDC_WORLDS").unwrap_or(sized(160, 20_000));
    let most = sized(600, 3_000);
    let tally = RefCell::new(Tally::default());
    hold(worlds, generate::program, |study, _| verdict::check(study, judge, most, &mut tally.borrow_mut()));
    let tally = tally.into_inner();
    println!("{judge:?}: {tally:?}");
    // Otherwise the test is weak.
    let percent = |part: usize, of: usize| 100 * part / of.max(1);
    assert!(percent(tally.worlds, worlds as usize) >= 80, "{tally:?}");
    assert!(percent(tally.closed, tally.worlds) >= 40, "{tally:?}");
    assert!(percent(tally.later, tally.goals) >= 10, "{tally:?}");
    assert!(percent(tally.unreachable, tally.goals) >= 15, "{tally:?}");
    tally
}

#[test]
fn no_goal_that_can_be_reached_is_ruled_out_by_analysis() {
    let tally = true_verdicts(Judge::Analysis);
    assert!(100 * tally.proven >= 20 * tally.unreachable, "{tally:?}");
}

#[test]
fn exhaustion_finds_the_shortest_ways_and_rules_out_the_rest() {
    let tally = true_verdicts(Judge::Exhaustion);
    assert!(100 * tally.proven >= 90 * tally.unreachable, "{tally:?}");
    assert!(100 * tally.shortest >= 95 * tally.reachable, "{tally:?}");
}

#[test]
fn states_are_the_same_to_the_bit() {
    let folders = ["examples", "tests/conformance", "tests/verdicts", "benches/worlds"];
    let mut wrong = Vec::new();
    let (mut worlds, mut steps, mut faults) = (0, 0, 0);
    for path in folders.iter().flat_map(|folder| files(folder, "hyped")) {
        let study = compile_for_ide(Path::new(&path), &Disk);
        let Some(program) = &study.compilation.program else { panic!("{} does not compile", path.display()) };
        for (world, table) in program.worlds.pairs().filter(|(_, w)| w.open.is_none()) {
            let mut rng = Pcg64::seed_from_u64(1);
            let run = compare::run(program, &study.checked, world, sized(120, 3_000), &mut rng);
            worlds += 1;
            steps += run.steps;
            faults += usize::from(run.faulted);
            if let Some(difference) = run.difference {
                wrong.push(format!("{} {}: {difference}", path.display(), table.name));
            }
        }
    }
    println!("{worlds} worlds, {steps} steps, {faults} faults, {} differ", wrong.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Minimised worlds that once had a false verdict; a comment in each describes it.
#[test]
fn what_was_found_is_judged_right() {
    let mut wrong = Vec::new();
    for path in files("tests/oracle/found", "hyped") {
        let study = compile_for_ide(Path::new(&path), &Disk);
        assert!(study.compilation.program.is_some(), "{} does not compile", path.display());
        for judge in [Judge::Analysis, Judge::Exhaustion] {
            let told = verdict::check(&study, judge, 3_000, &mut Tally::default());
            wrong.extend(told.err().map(|why| format!("{}: {why}", path.display())));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

//! Tests many worlds in turn: the first refuted claim of each, reduced to a few lines.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use hypedc::sim::{Script, Simulator};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::choices::choices;
use super::claims::{Claims, Violation};
use super::files::compiled;
use super::frame::Frame;
use super::generate::program;
use super::mutants::changed;
use super::run::{Refuted, Runs, exhaust, has_inputs, run};
use super::shrink::shrunk;
use super::witness::{denied, with_goal};

/// The length of a run.
const STEPS: usize = 240;
/// Number of runs of a world; without inputs, all are equal.
const RUNS: u64 = 3;
/// One in this many worlds is run exhaustively, up to this number of states.
const EXHAUSTED: (u64, usize) = (4, 300);
/// Few claims are made about a world that is given up: shorter runs.
const STEPS_IF_GIVEN_UP: usize = 60;
/// Number of worlds of each class of violations that are reduced.
const SHRUNK: usize = 2;
/// Number of worlds between two reports of progress.
const TELL_EVERY: u64 = 10_000;

/// The source of worlds.
pub enum Source {
    Drawn,
    /// Mutations of these.
    Changed(Vec<String>),
}

impl Source {
    fn text(&self, seed: u64) -> String {
        match self {
            Source::Drawn => program(&choices(seed), Frame::default()),
            Source::Changed(originals) => changed(originals, &mut Pcg64::seed_from_u64(seed)),
        }
    }
}

/// The results of many worlds.
#[derive(Debug, Default)]
pub struct Hunt {
    pub worlds: u64,
    pub compiled: u64,
    /// Worlds with claims other than values of variables.
    pub claims: usize,
    pub states: usize,
    /// Worlds whose analysis takes too long.
    pub given_up: u64,
    /// Worlds with a player that is distinguished by place.
    pub by_place: u64,
    /// Number of worlds of each class of violations.
    pub classes: BTreeMap<String, usize>,
    /// Reduced programs, with their violations.
    pub reports: Vec<String>,
}

/// Tests the worlds with some numbers.
pub fn hunt(source: &Source, seeds: std::ops::Range<u64>) -> Hunt {
    let mut out = Hunt::default();
    for seed in seeds {
        let text = source.text(seed);
        out.worlds += 1;
        if out.worlds.is_multiple_of(TELL_EVERY) {
            println!("{} worlds, to number {seed}, {} states: {:?}", out.worlds, out.states, out.classes);
        }
        let Some((text, refuted)) = of_world(&text, seed, &mut out) else { continue };
        let class = class_of(&refuted);
        let count = out.classes.entry(class.clone()).or_default();
        *count += 1;
        if *count <= SHRUNK {
            let small = shrunk(&text, &mut |text| refuted_by(text, seed).is_some_and(|r| class_of(&r) == class));
            let last = refuted_by(&small, seed).unwrap_or(refuted);
            let report = report(&small, seed, &last);
            println!("{report}");
            out.reports.push(report);
        }
    }
    out
}

/// The refuted claim of a world, and the text: with one more goal, if a predicate was ruled out.
fn of_world(text: &str, seed: u64, out: &mut Hunt) -> Option<(String, Refuted)> {
    let looked = look(text, seed);
    out.compiled += u64::from(looked.is_compiled);
    out.given_up += u64::from(looked.is_given_up);
    out.by_place += u64::from(looked.is_by_place);
    out.claims += looked.claims;
    out.states += looked.states;
    let refuted = looked.refuted?;
    let more = looked.witness.and_then(|holds| with_goal(text, &holds));
    let again = more.and_then(|more| Some((look(&more, seed).refuted?, more)));
    Some(again.map_or_else(|| (text.to_string(), refuted), |(refuted, more)| (more, refuted)))
}

/// The refuted claim of a world.
pub fn refuted_by(text: &str, seed: u64) -> Option<Refuted> {
    look(text, seed).refuted
}

/// The result of a world.
#[derive(Default)]
struct Look {
    is_compiled: bool,
    is_given_up: bool,
    is_by_place: bool,
    claims: usize,
    states: usize,
    refuted: Option<Refuted>,
    /// A predicate that holds in a reached state, although it is ruled out.
    witness: Option<String>,
}

/// Runs a world; a panic is a violation, too.
fn look(text: &str, seed: u64) -> Look {
    catch_unwind(AssertUnwindSafe(|| look_or_panic(text, seed))).unwrap_or_else(|what| {
        let said = what.downcast_ref::<&str>().map(|s| (*s).to_string());
        let said = said.or_else(|| what.downcast_ref::<String>().cloned()).unwrap_or_default();
        let refuted =
            Refuted { violation: Violation::new("panic", said), script: Script::default(), inputs: String::new() };
        Look { refuted: Some(refuted), ..Look::default() }
    })
}

fn look_or_panic(text: &str, seed: u64) -> Look {
    let compilation = compiled(text);
    let Some(program) = &compilation.program else { return Look::default() };
    let Some(world) = program.worlds.ids().next() else { return Look::default() };
    let claims = Claims::of(&compilation, program, world);
    let sim = Simulator::new(program, world);
    let mut runs = Runs::default();
    let (steps, most) = match claims.is_given_up() {
        true => (STEPS_IF_GIVEN_UP, 1),
        false => (STEPS, RUNS),
    };
    for turn in 0..if has_inputs(&sim) { most } else { 1 } {
        if runs.refuted.is_none() {
            run(&sim, &claims, steps, seed.wrapping_mul(31).wrapping_add(turn), &mut runs);
        }
    }
    let (every, states) = EXHAUSTED;
    if runs.refuted.is_none() && seed.is_multiple_of(every) && !claims.is_given_up() {
        exhaust(&sim, &claims, states, [1, 4, 12][(seed / every % 3) as usize], &mut runs);
    }
    let mut out = Look {
        is_compiled: true,
        is_given_up: claims.is_given_up(),
        is_by_place: claims.is_by_place(),
        claims: claims.count(),
        states: runs.states,
        refuted: runs.refuted,
        witness: None,
    };
    if out.refuted.is_none()
        && let Some(denied) = denied(program, world, &claims.space, &runs.samples, seed)
    {
        let violation = Violation::new("witness", denied.what);
        out.refuted = Some(Refuted { violation, script: Script::default(), inputs: String::new() });
        out.witness = denied.holds;
    }
    if let Some(refuted) = &mut out.refuted {
        refuted.inputs = refuted.script.text(program, world);
    }
    out
}

/// Violations of the same kind, after as few steps, usually have the same cause.
fn class_of(refuted: &Refuted) -> String {
    let when = match refuted.script.len() {
        0 => " at the start",
        1 => " in the first step",
        _ => "",
    };
    format!("{}{when}", refuted.violation.class)
}

/// A program with its violation.
fn report(text: &str, seed: u64, refuted: &Refuted) -> String {
    let Violation { class, what } = &refuted.violation;
    format!("// {class}: {what}\n// world {seed}; inputs: {}\n{text}", refuted.inputs)
}

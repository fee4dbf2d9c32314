//! Many worlds, one after the other: the first claim of each that is refuted, cut down to a few lines.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use hypedc::ir::{Program, WorldId};
use hypedc::sim::{Script, Simulator};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::choices::choices;
use super::claims::{Claims, Violation};
use super::files::compiled;
use super::frame::Frame;
use super::generate::program;
use super::mutants::changed;
use super::run::{Refuted, Runs, exhaust, run};
use super::shrink::shrunk;
use super::witness::with_witnesses;

/// The length of a run.
const STEPS: usize = 240;
/// Runs of each world.
const RUNS: u64 = 3;
/// One of so many worlds is run exhaustively, up to so many states.
const EXHAUSTED: (u64, usize) = (4, 300);
/// So many worlds of each class of violations are cut down.
const SHRUNK: usize = 2;
/// How often progress is told, in worlds.
const TELL_EVERY: u64 = 10_000;

/// Where worlds come from.
pub enum Source {
    Drawn,
    /// Changed from these.
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

/// What came of many worlds.
#[derive(Debug, Default)]
pub struct Hunt {
    pub worlds: u64,
    pub compiled: u64,
    /// Worlds of which something was claimed beside what their variables can be.
    pub claims: usize,
    pub states: usize,
    /// Of each class of violations, how many worlds.
    pub classes: BTreeMap<String, usize>,
    /// Small programs, with what is wrong about them.
    pub reports: Vec<String>,
}

/// Looks at the worlds with some numbers.
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

/// The claim of a world that is refuted: by runs of its own, or of the same world with goals that are known to be
/// reachable; and the text.
fn of_world(text: &str, seed: u64, out: &mut Hunt) -> Option<(String, Refuted)> {
    let looked = look(text, seed);
    out.compiled += u64::from(looked.is_compiled);
    out.claims += looked.claims;
    out.states += looked.states;
    if let Some(refuted) = looked.refuted {
        return Some((text.to_string(), refuted));
    }
    let more = looked.witnesses?;
    let looked = look(&more, seed);
    out.states += looked.states;
    looked.refuted.map(|refuted| (more, refuted))
}

/// The claim of a world that is refuted.
pub fn refuted_by(text: &str, seed: u64) -> Option<Refuted> {
    look(text, seed).refuted
}

/// What came of a world.
#[derive(Default)]
struct Look {
    is_compiled: bool,
    claims: usize,
    states: usize,
    refuted: Option<Refuted>,
    /// The text with goals that hold in states that were reached.
    witnesses: Option<String>,
}

/// Runs a world; that nothing panics is claimed as well.
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
    for turn in 0..RUNS {
        if runs.refuted.is_none() {
            run(&sim, &claims, STEPS, seed.wrapping_mul(31).wrapping_add(turn), &mut runs);
        }
    }
    let (every, states) = EXHAUSTED;
    if runs.refuted.is_none() && seed.is_multiple_of(every) {
        exhaust(&sim, &claims, states, [1, 4, 12][(seed / every % 3) as usize], &mut runs);
    }
    if let Some(refuted) = &mut runs.refuted {
        refuted.inputs = refuted.script.text(program, world);
    }
    let witnesses = witnesses(text, program, world, &runs, seed);
    Look { is_compiled: true, claims: claims.count(), states: runs.states, refuted: runs.refuted, witnesses }
}

fn witnesses(text: &str, program: &Program, world: WorldId, runs: &Runs, seed: u64) -> Option<String> {
    with_witnesses(text, program, &program.worlds[world], &runs.samples, seed)
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

/// A program, with what is wrong about it.
fn report(text: &str, seed: u64, refuted: &Refuted) -> String {
    let Violation { class, what } = &refuted.violation;
    format!("// {class}: {what}\n// world {seed}; inputs: {}\n{text}", refuted.inputs)
}

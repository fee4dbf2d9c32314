//! Programs that once had a false verdict (`tests/analysis/found`), each of a few lines: a wrong or missing transition
//! of the analysis. The current verdicts hold in every state of scripted and of random runs.

use std::path::Path;
use std::sync::Arc;

use hypedc::analysis::{ConfigurationSpace, InvariantVerdict, configuration_space, invariants};
use hypedc::compile::compile;
use hypedc::ir::{Program, WorldId};
use hypedc::reach::Monitor;
use hypedc::sim::{Input, PlayerInput, Simulator};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::outside::{outside, ruled_out};
use super::poll_limit::PollLimit;
use super::run::LOOKS_BY_PLACE;
use crate::support::{Disk, files, program};

/// Number of steps of a run.
const STEPS: u64 = 400;
/// Number of random runs.
const RANDOM: u64 = 6;

/// The source of inputs.
enum Script {
    /// All buttons held or none, all axes at a number.
    Constant(u64, f64),
    Random(u64),
}

impl Script {
    fn player(&self, rng: &mut Pcg64) -> PlayerInput {
        match self {
            Script::Constant(buttons, axis) => PlayerInput { buttons: *buttons, axes: [*axis; 4] },
            Script::Random(_) => PlayerInput {
                buttons: rng.random(),
                axes: std::array::from_fn(|_| f64::from(rng.random_range(-1..=1))),
            },
        }
    }
}

/// A verdict that a run refutes.
fn refuted(program: &Arc<Program>, world: WorldId, space: &ConfigurationSpace, script: &Script) -> Option<String> {
    let sim = Simulator::new(program, world);
    let guard = Monitor::new(space, program, world);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).ok()?;
    let proven: Vec<_> = invariants(program, world, space)
        .into_iter()
        .filter_map(|(entity, index, verdict)| (verdict == InvariantVerdict::Proven).then_some((entity, index)))
        .collect();
    let seed = if let Script::Random(seed) = script { *seed } else { 0 };
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut input = Input::nothing(sim.world().players.len());
    let mut left = 0;
    for step in 0..STEPS {
        if sim.left_bounds(&state).is_some() {
            break;
        }
        let broken = || {
            let (slot, index) = sim.broken_invariant(&state).ok()??;
            let is_proven = proven.contains(&(sim.world().slots[slot].entity, index));
            is_proven.then(|| format!("invariant {index} of {} breaks, which is proven", sim.world().slots[slot].name))
        };
        let found = outside(&sim, &guard, &state).or_else(|| ruled_out(program, &sim, space, &state));
        if let Some(what) = found.or_else(broken) {
            return Some(format!("step {step}: {what}"));
        }
        if left == 0 {
            left = rng.random_range(1..24);
            input.0.iter_mut().for_each(|player| *player = script.player(&mut rng));
        }
        left -= 1;
        if sim.step(&mut state, &input, &mut scratch).is_err() {
            break;
        }
    }
    None
}

#[test]
fn nothing_false_is_said_any_more() {
    let mut all = Vec::new();
    let paths = files("tests/analysis/found", "hyped");
    assert!(paths.len() >= 25, "{}", paths.len());
    for path in paths {
        let program = program(compile(Path::new(&path), &Disk));
        for world in program.worlds.ids() {
            let space =
                configuration_space(&program, world).by_place(&program, world, &[], &PollLimit::new(LOOKS_BY_PLACE));
            let constant = [(0, 0.0), (0, 1.0), (0, -1.0), (u64::MAX, 0.0), (u64::MAX, 1.0), (u64::MAX, -1.0)];
            let scripts = constant.map(|(buttons, axis)| Script::Constant(buttons, axis)).into_iter();
            for script in scripts.chain((0..RANDOM).map(Script::Random)) {
                if let Some(what) = refuted(&program, world, &space, &script) {
                    all.push(format!("{}: {what}", path.display()));
                    break;
                }
            }
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

//! Random play of a world, summed up in one number: natively and as WebAssembly it must be the same.

use std::path::Path;

use hypedc::compile::{LevelFile, compile_with};
use hypedc::ir::{Id, WorldId};
use hypedc::sim::{Fnv, Input, Run};
use hypedc::source::Files;
use hypedc::studio::Level;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Deserialize;

/// Number of steps for which inputs are held at most.
const MAX_HELD: u32 = 32;

/// What is played.
#[derive(Debug, Deserialize)]
pub(crate) struct RandomSteps {
    /// The index of the world.
    #[serde(default)]
    world: u32,
    /// Of the inputs, and of what nature draws.
    seed: u64,
    /// Number of steps.
    steps: u64,
    /// Whether all states are hashed; the last one is always.
    #[serde(default)]
    hash: bool,
}

/// Plays a world with random inputs, from the start again when it ends. Returns a hash of the states, and the number of
/// restarts.
///
/// # Errors
/// Why it cannot be played.
pub(crate) fn random_steps(
    files: &dyn Files,
    root: &Path,
    level: &Level,
    of: &RandomSteps,
) -> Result<(u64, u64), String> {
    let level = LevelFile { map: level.map.as_deref(), legend: level.legend.as_deref(), tile: level.tile };
    let compilation = compile_with(root, level, files);
    let program = compilation.program.ok_or("the program has errors")?;
    let world = WorldId(of.world);
    if program.worlds.get(world).is_none_or(|world| world.open.is_some()) {
        return Err("there is no such world to play".to_string());
    }
    let first = Run::new(&program, world).map_err(|fault| format!("{:?}", fault.kind))?;
    let mut run = first.clone();
    run.set_seed(of.seed);
    let mut rng = Pcg64::seed_from_u64(of.seed);
    let (mut hash, mut restarts, mut left) = (Fnv::new(), 0, of.steps);
    while left > 0 {
        let input = random_input(&first, &mut rng);
        for _ in 0..u64::from(rng.random_range(1..=MAX_HELD)).min(left) {
            left -= 1;
            let is_over = run.step(&input).is_err() || run.simulator().left_bounds(run.state()).is_some();
            if of.hash {
                hash.add(run.state());
            }
            if is_over {
                restarts += 1;
                run.set_state(first.state());
                run.set_steps(0);
                run.set_seed(of.seed.wrapping_add(restarts));
                break;
            }
        }
    }
    hash.add(run.state());
    Ok((hash.value(), restarts))
}

/// Each button is down with a probability of a third; each axis is at an end, in the middle, or in between.
fn random_input(run: &Run, rng: &mut Pcg64) -> Input {
    let mut input = run.nothing();
    for ((_, player), of) in run.world().players.pairs().zip(&mut input.0) {
        let entity = run.instance(player.slot).entity();
        for button in entity.buttons.ids() {
            of.buttons |= u64::from(rng.random_bool(1.0 / 3.0)) << button.index();
        }
        for axis in entity.axes.ids() {
            let end = f64::from(rng.random_range(-1..=1_i32));
            let value = if rng.random_bool(0.25) { rng.random_range(-1.0..=1.0) } else { end };
            if let Some(axis) = of.axes.get_mut(axis.index()) {
                *axis = value;
            }
        }
    }
    input
}

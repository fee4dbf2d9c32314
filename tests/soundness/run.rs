//! Random runs of a world, held against what is claimed of it.

use hypedc::sim::{Input, PlayerInput, Script, Simulator};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::claims::{Claims, Standing, Violation};

/// A claim that a run refutes, and the inputs that lead there.
#[derive(Debug, Clone)]
pub struct Refuted {
    pub violation: Violation,
    pub script: Script,
}

/// What came of some runs.
#[derive(Debug, Default)]
pub struct Runs {
    pub refuted: Option<Refuted>,
    pub states: usize,
    /// Reached states, drawn at random.
    pub samples: Vec<Vec<u8>>,
}

/// Draws inputs that are held for some steps.
pub struct Inputs {
    rng: Pcg64,
    left: u32,
    longest: u32,
    pub now: Input,
}

impl Inputs {
    pub fn new(seed: u64, players: usize) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let longest = [2, 8, 40][rng.random_range(0..3)];
        Inputs { rng, left: 0, longest, now: Input::nothing(players) }
    }

    /// The input of the next step.
    pub fn next(&mut self) -> &Input {
        if self.left == 0 {
            self.left = self.rng.random_range(1..=self.longest);
            for player in &mut self.now.0 {
                let axis = |rng: &mut Pcg64| match rng.random_range(0..8) {
                    0..=2 => -1.0,
                    3..=5 => 1.0,
                    6 => rng.random_range(-1.0..1.0),
                    _ => 0.0,
                };
                let axes = [axis(&mut self.rng), axis(&mut self.rng), 0.0, 0.0];
                *player = PlayerInput { buttons: self.rng.random_range(0..4), axes };
            }
        }
        self.left -= 1;
        &self.now
    }
}

/// Steps that a run goes on after a player has left its bounds.
const BEYOND: u32 = 60;

/// Runs a world for some steps from its beginning; ends at the first claim that is refuted.
pub fn run(sim: &Simulator<'_>, claims: &Claims, steps: usize, seed: u64, runs: &mut Runs) {
    let mut scratch = sim.scratch();
    let Ok(mut state) = sim.initial(&mut scratch) else { return };
    let mut inputs = Inputs::new(seed, sim.world().players.len());
    let mut standing = Standing { is_inside: true, is_allowed: true };
    let mut script = Script::default();
    let mut beyond = 0;
    for step in 0..steps {
        standing.is_allowed &= sim.violated(&state) == Ok(None);
        standing.is_inside &= sim.left_bounds(&state).is_none();
        beyond += u32::from(!standing.is_inside);
        runs.states += 1;
        if step % 16 == 0 && standing.is_inside {
            runs.samples.push(state.clone());
        }
        let input = inputs.next();
        let violation = claims.refuted(sim, &state, standing).or_else(|| claims.refuted_by_step(sim, &state, input));
        if let Some(violation) = violation {
            runs.refuted = Some(Refuted { violation, script });
            return;
        }
        script.push(input, 1);
        if beyond > BEYOND || sim.step(&mut state, input, &mut scratch).is_err() {
            return;
        }
    }
}

//! Runs of a world, checked against claims about it: random ones, and all runs of a tiny world.

use std::collections::HashSet;

use hypedc::ir::Entity;
use hypedc::sim::{Draw, DrawId, Input, PlayerInput, Script, Simulator};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::claims::{Claims, StateStatus, Violation};

/// A claim that a run refutes, and the inputs that lead there.
#[derive(Debug, Clone)]
pub struct Refuted {
    pub violation: Violation,
    pub script: Script,
    /// The script as text.
    pub inputs: String,
}

/// The result of some runs.
#[derive(Debug, Default)]
pub struct Runs {
    pub refuted: Option<Refuted>,
    pub states: usize,
    /// Reached states, sampled.
    pub samples: Vec<Vec<u8>>,
}

/// Draws inputs that are held for some steps.
pub struct Inputs {
    rng: Pcg64,
    left: u32,
    longest: u32,
    pub now: Input,
    /// What nature draws in each step, and the seed that it is drawn from.
    draws: Vec<Draw>,
    luck: Pcg64,
}

impl Inputs {
    pub fn new(seed: u64, sim: &Simulator) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let longest = [2, 8, 40][rng.random_range(0..3)];
        let (now, luck) = (Input::nothing(sim.world().players.len()), Pcg64::seed_from_u64(!seed));
        Inputs { rng, left: 0, longest, now, draws: sim.draws().to_vec(), luck }
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
        for (id, draw) in (0..).map(DrawId).zip(&self.draws) {
            self.now.1.set(id, Some(self.luck.random_range(draw.range.0..=draw.range.1)));
        }
        &self.now
    }
}

/// Whether anything reads a player's inputs, or what nature draws; otherwise, all runs are equal.
pub fn has_inputs(sim: &Simulator) -> bool {
    if !sim.draws().is_empty() {
        return true;
    }
    let entities = sim.world().players.iter().map(|p| &sim.program().entities[sim.world().slots[p.slot].entity]);
    entities.into_iter().any(|e| !e.buttons.is_empty() || !e.axes.is_empty())
}

/// Steps in which nothing changes, after which a run without inputs ends, and one with inputs if that lasts longer.
const STILL: [u32; 2] = [2, 60];
/// Number of steps that a run continues after a player has left its bounds.
const BEYOND: u32 = 60;

/// Runs a world for some steps from its beginning; ends at the first claim that is refuted.
pub fn run(sim: &Simulator, claims: &Claims, steps: usize, seed: u64, runs: &mut Runs) {
    let mut scratch = sim.scratch();
    let Ok(mut state) = sim.initial(&mut scratch) else { return };
    let mut inputs = Inputs::new(seed, sim);
    let mut standing = StateStatus { is_inside: true, is_allowed: true };
    let mut script = Script::default();
    let mut beyond = 0;
    let (mut before, mut still) = (state.clone(), 0);
    let most_still = STILL[usize::from(has_inputs(sim))];
    for step in 0..steps {
        standing.is_allowed &= sim.violated(&state) == Ok(None);
        standing.is_inside &= sim.left_bounds(&state).is_none();
        beyond += u32::from(!standing.is_inside);
        runs.states += 1;
        if step % 16 == 0 && standing.is_inside {
            runs.samples.push(state.to_vec());
        }
        let input = inputs.next();
        let violation = claims.refuted(sim, &state, standing).or_else(|| claims.refuted_by_step(sim, &state, input));
        if let Some(violation) = violation {
            runs.refuted = Some(Refuted { violation, script, inputs: String::new() });
            return;
        }
        script.push(input, 1);
        if beyond > BEYOND || sim.step(&mut state, input, &mut scratch).is_err() {
            return;
        }
        still = if state == before { still + 1 } else { 0 };
        if still > most_still {
            return;
        }
        before.copy_from_slice(&state);
    }
}

/// Maximum number of combined inputs that are enumerated.
const MAX_INPUTS: usize = 36;

/// All inputs that the players of a world can give, axes at their ends or in the middle, with all that nature can draw;
/// none if there are too many.
fn all_inputs(sim: &Simulator) -> Option<Vec<Input>> {
    let mut all = vec![Input::default()];
    for player in sim.world().players.iter() {
        let entity: &Entity = &sim.program().entities[sim.world().slots[player.slot].entity];
        let buttons = 1_u64 << entity.buttons.len().min(2);
        let values: &[f64] = &[0.0, 1.0, -1.0];
        let axes = |count: usize, at: usize| if at < count { values } else { &values[..1] };
        let count = entity.axes.len();
        let mut next = Vec::new();
        for input in &all {
            for buttons in 0..buttons {
                for x in axes(count, 0) {
                    for y in axes(count, 1) {
                        let mut more = input.clone();
                        more.0.push(PlayerInput { buttons, axes: [*x, *y, 0.0, 0.0] });
                        next.push(more);
                    }
                }
            }
        }
        all = next;
        if all.len() > MAX_INPUTS {
            return None;
        }
    }
    for (id, draw) in (0..).map(DrawId).zip(sim.draws()) {
        let with = |input: &Input, value: i32| {
            let mut input = input.clone();
            input.1.set(id, Some(value));
            input
        };
        let values = || draw.range.0..=draw.range.1;
        all = all.iter().flat_map(|input| values().map(|value| with(input, value))).collect();
        if all.len() > MAX_INPUTS {
            return None;
        }
    }
    Some(all)
}

/// Maximum number of steps of an exhaustive run.
const MAX_STEPS: usize = 2_500;

/// Runs a world with all inputs there are, each held for some steps, breadth first, up to a number of states.
pub fn exhaust(sim: &Simulator, claims: &Claims, most: usize, hold: u32, runs: &mut Runs) {
    let mut scratch = sim.scratch();
    let (Some(inputs), Ok(start)) = (all_inputs(sim), sim.initial(&mut scratch)) else { return };
    // With a single input, there is only one run.
    if inputs.len() < 2 {
        return;
    }
    let until = runs.states + MAX_STEPS;
    let mut known: HashSet<Vec<u8>> = HashSet::new();
    // Each with its origin: the numbers of a state and of an input.
    let mut open: Vec<(Vec<u8>, bool, usize, usize)> = vec![(start.to_vec(), true, 0, 0)];
    let mut at = 0;
    while at < open.len() && open.len() < most && runs.states < until {
        for (number, input) in inputs.iter().enumerate() {
            let (mut state, mut is_allowed) = (open[at].0.clone(), open[at].1);
            for step in 0..hold {
                is_allowed &= sim.violated(&state) == Ok(None);
                let is_inside = sim.left_bounds(&state).is_none();
                let standing = StateStatus { is_inside, is_allowed };
                runs.states += 1;
                let violation =
                    claims.refuted(sim, &state, standing).or_else(|| claims.refuted_by_step(sim, &state, input));
                if let Some(violation) = violation {
                    let mut way = vec![];
                    let mut back = at;
                    while back != 0 {
                        way.push(open[back].3);
                        back = open[back].2;
                    }
                    let mut script = Script::default();
                    way.iter().rev().for_each(|input| script.push(&inputs[*input], hold));
                    script.push(input, step);
                    runs.refuted = Some(Refuted { violation, script, inputs: String::new() });
                    return;
                }
                if !is_inside || sim.step(&mut state, input, &mut scratch).is_err() {
                    state.clear();
                    break;
                }
            }
            if !state.is_empty() && known.insert([state.as_slice(), &[u8::from(is_allowed)]].concat()) {
                open.push((state, is_allowed, at, number));
            }
        }
        at += 1;
    }
}

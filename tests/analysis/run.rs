//! Random runs of a world, checked against its configuration space, with statistics.

use hypedc::analysis::{at_most, configuration_space};
use hypedc::ir::{Origin, Program, WorldId};
use hypedc::reach::Monitor;
use hypedc::sim::{Input, PlayerInput, Simulator};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::sync::Arc;

use super::outside::{goes_on, outside, ruled_out};
use super::poll_limit::PollLimit;

/// The result of a run.
#[derive(Debug, Default)]
pub struct Run {
    /// The states outside; a run ends after a few.
    pub outside: Vec<String>,
    /// Number of checked states.
    pub states: usize,
    /// Number of slots, and of those for which the analysis gave up.
    pub slots: usize,
    pub given_up: usize,
    /// Whether the space distinguishes states of a player by place.
    pub is_by_place: bool,
    /// Whether an instance was spawned, was destroyed, changed its space.
    pub spawned: bool,
    pub ended: bool,
    pub linked: bool,
    /// The goals that held, by name.
    pub goals: Vec<String>,
}

/// Number of polls before the analysis by place gives up.
pub const LOOKS_BY_PLACE: u32 = 600;
/// Number of configurations after which the analysis by the courses of falls gives up.
const LOOKS_BY_FLIGHT: usize = 3_000;
/// Interval between checks of goals, in steps.
const GOALS_EVERY: usize = 16;

/// Runs a world at random.
pub fn run(program: &Arc<Program>, id: WorldId, steps: usize, seed: u64) -> Run {
    // The space also distinguishes players by place: the monitor checks both.
    let space = configuration_space(program, id).by_place(program, id, &[], &PollLimit::new(LOOKS_BY_PLACE));
    let is_by_place = !std::ptr::eq(space.finest(), &space);
    let space = space.by_flight(program, id, &[], &mut at_most(LOOKS_BY_FLIGHT), &PollLimit::new(LOOKS_BY_PLACE * 8));
    let given_up = space.slots.iter().filter(|s| s.is_given_up).count();
    let mut run = Run { slots: space.slots.len(), given_up, is_by_place, ..Run::default() };
    let sim = Simulator::new(program, id);
    let guard = Monitor::new(&space, program, id);
    let world = sim.world();
    let mut scratch = sim.scratch();
    let Ok(start) = sim.initial(&mut scratch) else { return run };
    if !goes_on(&sim, &start) {
        return run;
    }
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut state = start.clone();
    let mut left = 0;
    let mut input = Input::nothing(world.players.len());
    for step in 0..steps {
        run.states += 1;
        if let Some(what) = outside(&sim, &guard, &state) {
            run.outside.push(format!("step {step}: {what}"));
        }
        if step % GOALS_EVERY == 0 {
            run.outside.extend(ruled_out(program, &sim, &space, &state).map(|what| format!("step {step}: {what}")));
            see(&sim, &state, &mut run);
        }
        if run.outside.len() > 5 {
            break;
        }
        if left == 0 {
            left = rng.random_range(1..32);
            for player in &mut input.0 {
                let axis = |rng: &mut Pcg64| f64::from(rng.random_range(-1..=1));
                let axes = [axis(&mut rng), axis(&mut rng), axis(&mut rng), axis(&mut rng)];
                *player = PlayerInput { buttons: rng.random(), axes };
            }
        }
        left -= 1;
        // A run ends where a search ends, and sometimes at random.
        let ended = sim.step(&mut state, &input, &mut scratch).is_err();
        if ended || !goes_on(&sim, &state) || rng.random_range(0..2_000) == 0 {
            state.copy_from_slice(&start);
        }
    }
    run
}

/// Records the events of a step.
fn see(sim: &Simulator, state: &[u8], run: &mut Run) {
    let world = sim.world();
    for (slot, s) in world.slots.pairs() {
        let layout = &world.layout.slots[slot];
        let alive = layout.alive(state);
        run.spawned |= alive && s.origin == Origin::Free;
        run.ended |= !alive && s.origin != Origin::Free;
        run.linked |= alive && s.origin != Origin::Free && layout.space(state) != s.space;
    }
    for (goal, g) in world.goals.pairs() {
        if !run.goals.contains(&g.name) && sim.goal(state, goal) == Ok(true) {
            run.goals.push(g.name.clone());
        }
    }
}

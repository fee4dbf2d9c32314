//! Random ways from a place: some inputs, each held for a random time, then none until the players rest again.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::sim::{Fault, Input, Scratch, Script};
use crate::watch::Meter;

use super::super::controls::ControlSets;
use super::super::coverage::mix;
use super::super::problem::{Problem, StateStatus};
use super::super::window::Windows;
use super::roadmap::RestTest;

/// Maximum number of inputs of a way.
const MAX_INPUTS: u32 = 5;
/// Binary logarithm of the number of steps for which an input is held at most.
const HOLD_OCTAVES: u32 = 7;
/// Maximum number of steps without input until players rest.
const MAX_SETTLING: u64 = 400;

/// How a way ends.
#[derive(Debug, PartialEq)]
pub(super) enum RolloutEnd {
    /// The goal holds.
    Goal,
    /// The players rest; the state is [`Rollouts::state`].
    Rest,
    /// Nothing is known: the run is over, a player is gone or out of sight, or the players do not come to rest.
    Lost,
    /// The meter stopped it.
    Stopped,
}

/// Draws ways.
pub(super) struct Rollouts<'p> {
    problem: &'p Problem<'p>,
    windows: Windows,
    controls: ControlSets,
    scratch: Scratch,
    seed: u64,
    /// Number of inputs that were held.
    pub nodes: u64,
    /// The first run-time error.
    pub fault: Option<Fault>,
    /// The state at the end of the last way.
    pub state: Vec<u8>,
    /// Its inputs.
    pub script: Script,
}

impl<'p> Rollouts<'p> {
    pub fn new(problem: &'p Problem<'p>, windows: Windows, seed: u64) -> Self {
        Rollouts {
            problem,
            windows,
            controls: ControlSets::default().with_draws(problem),
            scratch: problem.sim.scratch(),
            seed,
            nodes: 0,
            fault: None,
            state: Vec::new(),
            script: Script::default(),
        }
    }

    /// The way number `index` from a place.
    pub fn way(&mut self, from: &[u8], (place, index): (u32, u32), meter: &Meter<'_>) -> RolloutEnd {
        let mut rng = Pcg64::seed_from_u64(mix(mix(self.seed, u64::from(place)), u64::from(index)));
        self.start(from);
        for _ in 0..rng.random_range(1..=MAX_INPUTS) {
            let set = self.controls.of(self.problem, &self.state);
            let choice = rng.random_range(0..self.controls.count(set).max(1));
            let octave = rng.random_range(0..HOLD_OCTAVES);
            let steps = rng.random_range(1u32 << octave..2 << octave);
            let input = Input::of_players(self.controls.input(set, choice).0.clone());
            self.nodes += 1;
            for _ in 0..steps {
                if let Some(end) = self.step(&input, rng.random(), meter) {
                    return end;
                }
            }
        }
        self.settle(rng.random(), meter)
    }

    /// Begins a way.
    pub fn start(&mut self, from: &[u8]) {
        self.state.clear();
        self.state.extend_from_slice(from);
        self.script = Script::default();
    }

    /// Waits until the players rest.
    pub fn settle(&mut self, seed: u64, meter: &Meter<'_>) -> RolloutEnd {
        let nothing = Input::nothing(self.problem.players().len());
        self.nodes += 1;
        let mut test = RestTest::new();
        test.rests(self.problem, &self.state);
        for step in 0..MAX_SETTLING {
            if let Some(end) = self.step(&nothing, mix(seed, step), meter) {
                return end;
            }
            if test.rests(self.problem, &self.state) {
                return RolloutEnd::Rest;
            }
        }
        RolloutEnd::Lost
    }

    /// One step; `luck` is the seed of what nature draws.
    pub fn step(&mut self, input: &Input, luck: u64, meter: &Meter<'_>) -> Option<RolloutEnd> {
        let sim = self.problem.sim;
        let drawn = sim.draw(luck, 1, input);
        let stepped = sim.metered_step(&mut self.state, &drawn, &mut self.scratch, meter);
        if meter.is_stopped() {
            return Some(RolloutEnd::Stopped);
        }
        let status = stepped.and_then(|()| self.problem.judge(&self.state));
        match sim.draws().is_empty() {
            true => self.script.push(input, 1),
            false => self.script.push(&sim.drawn(&drawn, &self.scratch), 1),
        }
        let is_gone = |slot: &_| !sim.world().layout.slots[*slot].alive(&self.state);
        match status {
            Err(fault) => {
                self.fault.get_or_insert(fault);
                Some(RolloutEnd::Lost)
            }
            Ok(StateStatus::Goal) => Some(RolloutEnd::Goal),
            Ok(StateStatus::Dead(_)) => Some(RolloutEnd::Lost),
            Ok(StateStatus::Open) if self.windows.left(self.problem, &self.state).is_some() => Some(RolloutEnd::Lost),
            Ok(StateStatus::Open) if self.problem.players().iter().any(is_gone) => Some(RolloutEnd::Lost),
            Ok(StateStatus::Open) => None,
        }
    }
}

//! Plays of a plan with errors of timing: each is simulated until the target holds, the run is over, or its time is.

use crate::sim::{Input, Scratch};
use crate::watch::Meter;

use super::super::problem::{Problem, StateStatus};
use super::timeline::Timeline;

/// How a play ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    /// The target holds after this number of steps.
    Reached(u64),
    /// The run is over without it.
    Over,
    /// The time is over.
    Late,
    /// The meter stopped it.
    Stopped,
}

/// What nature draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Nature {
    /// As on the path, wherever it fixes something.
    Planned,
    /// Anew, from a seed.
    Anew(u64),
}

/// Plays plans of a problem, with memory that is reused.
pub(super) struct Plays<'p> {
    problem: &'p Problem<'p>,
    scratch: Scratch,
    /// The state at the end of the last play.
    pub state: Vec<u8>,
    input: Input,
    order: Vec<usize>,
    /// When each change of the next play happens.
    pub times: Vec<u64>,
    /// Number of simulated steps so far.
    pub steps: u64,
}

impl<'p> Plays<'p> {
    pub fn new(problem: &'p Problem<'p>) -> Self {
        Plays {
            problem,
            scratch: problem.sim.scratch(),
            state: Vec::new(),
            input: Input::default(),
            order: Vec::new(),
            times: Vec::new(),
            steps: 0,
        }
    }

    /// Plays a plan with its changes at [`Plays::times`], from a state after `first` steps that the plan itself leads to:
    /// no change is moved to an earlier step.
    pub fn play(
        &mut self,
        timeline: &Timeline,
        (first, from): (u64, &[u8]),
        until: u64,
        nature: Nature,
        meter: &Meter<'_>,
    ) -> Ending {
        let sim = self.problem.sim;
        self.order.clear();
        self.order.extend(0..self.times.len());
        // Changes of one control are never at the same time.
        self.order.sort_unstable_by_key(|change| (self.times[*change], *change));
        self.input.clone_from(timeline.held());
        self.state.clear();
        self.state.extend_from_slice(from);
        let (mut next, mut step) = (0, first);
        loop {
            match self.problem.judge(&self.state) {
                Ok(StateStatus::Goal) => return Ending::Reached(step),
                Ok(StateStatus::Open) if step < until => {}
                Ok(StateStatus::Open) => return Ending::Late,
                _ => return Ending::Over,
            }
            while let Some(&change) = self.order.get(next).filter(|change| self.times[**change] <= step) {
                let change = &timeline.changes[change];
                self.input.set(change.control, change.value);
                next += 1;
            }
            let stepped = if sim.draws().is_empty() {
                sim.metered_step(&mut self.state, &self.input, &mut self.scratch, meter)
            } else {
                self.input.1 = match nature {
                    Nature::Planned => timeline.drawn(step).cloned().unwrap_or_default(),
                    Nature::Anew(_) => Default::default(),
                };
                let drawn = match nature {
                    Nature::Anew(seed) if !self.problem.is_foretold() => sim.draw(seed, step + 1, &self.input),
                    _ => self.problem.draw(step + 1, &self.input),
                };
                sim.metered_step(&mut self.state, &drawn, &mut self.scratch, meter)
            };
            if meter.is_stopped() {
                return Ending::Stopped;
            }
            if stepped.is_err() {
                return Ending::Over;
            }
            self.steps += 1;
            step += 1;
        }
    }
}

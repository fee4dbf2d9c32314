//! What nature draws in a search: it is one more player, who helps. And how probable it is that nature draws what a path
//! needs.

use rand::RngExt;
use rand_pcg::Pcg64;

use crate::sim::chance::bits;
use crate::sim::{DrawId, Draws, Input, Scratch, Script, Simulator};
use crate::watch::Meter;

use super::controls::ControlSets;
use super::coverage::mix;
use super::problem::Problem;
use super::strategy::Choice;
use super::tree::Tree;

/// What nature draws in the steps of a choice. It is determined by the choice, so that a repeated choice has the same
/// effect: in the first step as the control set says; in further steps of a hold, and where the set leaves a draw open,
/// pseudo-randomly.
#[derive(Debug, Clone)]
pub(super) struct Luck {
    /// The input of the last step, with all draws.
    pub input: Input,
    /// The draws of it that are tried one by one.
    listed: Draws,
    /// Differs between trees.
    salt: u64,
}

impl Luck {
    /// `None` if nothing is ever drawn.
    pub fn new(problem: &Problem<'_>, rng: &mut Pcg64) -> Option<Self> {
        // Otherwise the random numbers of the search are those of a world without chances.
        let draws = !problem.sim.draws().is_empty();
        draws.then(|| Luck { input: Input::default(), listed: Draws::default(), salt: rng.random() })
    }

    /// Begins another tree.
    pub fn change(&mut self) {
        self.salt = mix(self.salt, 1);
    }

    /// Determines the input of a step (from 1) of a choice. `first` is the number of the choice's first step in the run.
    pub fn draw(
        &mut self,
        problem: &Problem<'_>,
        controls: &ControlSets,
        (tree, first): (&Tree, u64),
        choice: Choice,
        step: u16,
    ) {
        let set = tree.set(choice.node);
        let players = &controls.input(set, choice.input).0;
        self.input.0.clone_from(players);
        self.input.1 = Draws::default();
        self.listed = Draws::default();
        if problem.is_foretold() {
            let open = std::mem::take(&mut self.input);
            self.input = problem.draw(first + u64::from(step) - 1, &open).into_owned();
            return;
        }
        let key = (u64::from(choice.node.0) << 32) | ((choice.input as u64) << 16) | u64::from(choice.hold);
        let key = mix(self.salt, key);
        // In half of the choices, what the first step draws stays: a path may need the same luck several times.
        let step_drawn = if key & 1 == 0 { 1 } else { step };
        for (id, draw) in (0..).map(DrawId).zip(problem.sim.draws()) {
            let value = draw.of_bits(bits(key, u64::from(step_drawn), u64::from(id.0)));
            self.input.1.set(id, Some(value));
        }
        if step_drawn == 1 {
            controls.fix_draws(set, choice.input, &mut self.input.1);
        }
        if step == 1 {
            controls.fix_draws(set, choice.input, &mut self.listed);
        }
    }

    /// Whether the last step has read a draw of which other values may never be tried.
    pub fn leaves_open(&self, sim: &Simulator, scratch: &Scratch) -> bool {
        let read = sim.drawn(&self.input, scratch).1;
        read.iter().any(|(id, _)| self.listed.get(id).is_none())
    }
}

/// A script with all that nature draws and a step reads after the first `kept` steps, and nothing else of it; `None` if
/// the meter stops it.
pub(super) fn only_read(problem: &Problem<'_>, script: &Script, kept: u64, meter: &Meter<'_>) -> Option<Script> {
    if problem.is_foretold() {
        // The seed says it all.
        let mut open = script.first(kept);
        script.inputs().skip(kept as usize).for_each(|input| open.push(&Input::of_players(input.0.clone()), 1));
        return Some(open);
    }
    let mut scratch = problem.sim.scratch();
    let mut state = problem.sim.metered_initial(&mut scratch, meter).ok().filter(|_| !meter.is_stopped())?;
    let mut read = script.first(kept);
    for (step, input) in (1..).zip(script.inputs()) {
        let drawn = problem.draw(step, input);
        problem.sim.metered_step(&mut state, &drawn, &mut scratch, meter).ok()?;
        if meter.is_stopped() {
            return None;
        }
        if step > kept {
            read.push(&problem.sim.drawn(&drawn, &scratch), 1);
        }
    }
    Some(read)
}

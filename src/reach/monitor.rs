//! Checks every state that a search creates against the configuration space on which proofs rest. The simulator defines
//! what happens: a state outside refutes the analysis, and with it every proof that rests on it.
//!
//! Checked are the nodes of trees and exhaustive searches, the states of replayed paths, and those on the way to a
//! start. States after the end of a run (a `never` holds, a player is out of bounds) are not part of the space.

use std::sync::{Mutex, PoisonError};

use crate::analysis::{ConfigurationSpace, Membership, Outside, Reading};
use crate::ir::{
    DiscreteId, GroupId, Id, LeafId, ParamId, Program, SlotLayout, SpaceId, TimerId, TouchId, VarId, World, WorldId,
};
use crate::sim::{Script, Simulator, state};
use crate::watch::Meter;

use super::problem::Problem;
use super::search::Settings;

/// A run into a state that the analysis excludes.
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// The inputs from the initial state on.
    pub script: Script,
    /// Their number of steps.
    pub steps: u64,
    /// The part of the state that is outside.
    pub outside: Outside,
}

/// Checks states against a configuration space, and keeps the shortest run that led outside.
#[derive(Debug)]
pub struct Monitor {
    membership: Membership,
    refutation: Mutex<Option<Refutation>>,
}

impl Monitor {
    /// Checks against a configuration space.
    pub fn new(space: &ConfigurationSpace, program: &Program, world: WorldId) -> Self {
        Monitor { membership: space.membership(program, world), refutation: Mutex::new(None) }
    }

    /// The part of a state that is outside, if any.
    pub fn outside(&self, sim: &Simulator, state: &[u8]) -> Option<Outside> {
        let (program, world) = (sim.program(), sim.world_id());
        sim.world().layout.slots.pairs().find_map(|(slot, layout)| {
            let instance = layout.alive(state).then_some(Instance { layout, state });
            self.membership.outside(program, world, slot, instance.as_ref())
        })
    }

    /// Whether a state is inside.
    pub(super) fn contains(&self, world: &World, state: &[u8]) -> bool {
        self.contains_changed(world, state, |_| true)
    }

    /// Whether a state is inside, given that the previous one is: unchanged slots are skipped.
    pub(super) fn contains_after(&self, world: &World, state: &[u8], before: &[u8]) -> bool {
        self.contains_changed(world, state, |layout| {
            let (from, to) = layout.block;
            state[from..to] != before[from..to]
        })
    }

    #[inline]
    fn contains_changed(&self, world: &World, state: &[u8], is_changed: impl Fn(&SlotLayout) -> bool) -> bool {
        world.layout.slots.pairs().all(|(slot, layout)| {
            !is_changed(layout)
                || match layout.alive(state) {
                    true => self.membership.contains(slot, &Instance { layout, state }),
                    false => self.membership.can_be_absent(slot),
                }
        })
    }

    /// Runs a script and checks each state until the run is over; records a state outside. Records nothing if the meter
    /// stops it.
    pub(super) fn follow(&self, problem: &Problem<'_>, script: &Script, meter: &Meter<'_>) {
        let (sim, mut scratch) = (problem.sim, problem.sim.scratch());
        let Ok(mut state) = sim.metered_initial(&mut scratch, meter) else { return };
        if meter.is_stopped() {
            return;
        }
        let mut done = Script::default();
        let mut inputs = script.inputs();
        loop {
            if problem.judge(&state).map_or(true, |status| status.is_over(problem.target)) {
                return;
            }
            if !self.contains(sim.world(), &state) {
                if let Some(outside) = self.outside(sim, &state) {
                    self.note(Refutation { steps: done.len(), script: done, outside });
                }
                return;
            }
            let Some(input) = inputs.next() else { return };
            let drawn = problem.draw(done.len() + 1, input);
            if sim.metered_step(&mut state, &drawn, &mut scratch, meter).is_err() || meter.is_stopped() {
                return;
            }
            match sim.draws() {
                [] => done.push(input, 1),
                _ => done.push(&sim.drawn(&drawn, &scratch), 1),
            }
        }
    }

    /// Records a run whose last state is outside, cut at the first state that is; the whole run if the meter stops the
    /// replay.
    pub(super) fn refute(&self, problem: &Problem<'_>, script: Script, state: &[u8], meter: &Meter<'_>) {
        self.follow(problem, &script, meter);
        if meter.is_stopped()
            && let Some(outside) = self.outside(problem.sim, state)
        {
            self.note(Refutation { steps: script.len(), script, outside });
        }
    }

    /// Keeps the shortest, so that the result does not depend on the order of threads.
    pub(super) fn note(&self, new: Refutation) {
        let mut known = self.refutation.lock().unwrap_or_else(PoisonError::into_inner);
        let order = |r: &Refutation| (r.steps, format!("{:?}", r.script));
        if known.as_ref().is_none_or(|known| order(&new) < order(known)) {
            *known = Some(new);
        }
    }

    /// The shortest run that has led outside, if one has.
    pub fn refutation(&self) -> Option<Refutation> {
        self.refutation.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Runs `then` with a monitored problem, if states are to be checked.
pub(super) fn monitored<T>(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    then: impl FnOnce(&Problem<'_>) -> T,
) -> T {
    if problem.monitor().is_some() || !settings.checks {
        return then(problem);
    }
    let monitor = Monitor::new(space, problem.sim.program(), problem.sim.world_id());
    then(&problem.clone().monitored(&monitor))
}

/// An instance in a state.
struct Instance<'s> {
    layout: &'s SlotLayout,
    state: &'s [u8],
}

impl Reading for Instance<'_> {
    #[inline]
    fn leaf(&self, group: GroupId) -> LeafId {
        self.layout.leaf(self.state, group)
    }

    #[inline]
    fn real(&self, place: usize) -> f64 {
        match &self.layout.rest {
            None => state::real(self.state, self.layout.vars + 8 * place),
            Some(_) => self.layout.var(self.state, VarId::from_index(place / 3), (place % 3) as u8),
        }
    }

    #[inline]
    fn discrete(&self, id: DiscreteId) -> i32 {
        self.layout.discrete(self.state, id)
    }

    #[inline]
    fn timer(&self, id: TimerId) -> u32 {
        self.layout.timer(self.state, id)
    }

    #[inline]
    fn param(&self, id: ParamId) -> f64 {
        // Tables check parameters only if they can change; otherwise the value is unused.
        self.layout.params.map_or(f64::NAN, |at| state::real(self.state, at + 8 * id.index()))
    }

    #[inline]
    fn space(&self) -> SpaceId {
        self.layout.space(self.state)
    }

    #[inline]
    fn touch(&self, id: TouchId) -> bool {
        self.layout.touch(self.state, id)
    }
}

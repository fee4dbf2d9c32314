//! The question: a world, what is asked for, where a search begins, and where a branch of it ends.

use std::sync::OnceLock;

use crate::ir::{ExprId, GoalId, NeverId, SlotId};
use crate::sim::{Fault, Script, Simulator, State};
use crate::watch::{Meter, Unwatched, Watch};

use super::guard::Guard;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A way to a goal.
    Goal(GoalId),
    /// A way to break a `never`: a counterexample.
    Never(NeverId),
}

/// Why a branch ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// A `never` holds.
    Never(NeverId),
    /// What the question asks to do without holds.
    Avoided,
    /// A player's position lies below or beside the bounds that are written for its space.
    Outside,
}

/// What the simulator makes of a state on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateStatus {
    /// Go on.
    Open,
    /// What is asked for holds.
    Goal,
    /// The branch ends.
    Dead(Termination),
}

impl StateStatus {
    /// Whether the run is over: at a goal it could go on, where a `never` is broken it cannot, even if that is the target.
    pub(super) fn is_over(self, target: Target) -> bool {
        match self {
            StateStatus::Open => false,
            StateStatus::Goal => matches!(target, Target::Never(_)),
            StateStatus::Dead(_) => true,
        }
    }
}

/// A state from which a search begins, and the inputs that lead there.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// From the world's initial state on; empty where the search begins there.
    pub script: Script,
    /// How many of its steps are given; during those after them its last input is held for as long as it must be.
    pub after: u64,
    /// What it leads to.
    pub state: State,
}

impl Start {
    /// How many steps of it are not given.
    pub(super) fn steps(&self) -> u32 {
        u32::try_from(self.script.len() - self.after).unwrap_or(u32::MAX)
    }
}

/// Why an input script leads to no start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BadStart {
    /// A run-time error at a step.
    Fault(Fault, u64),
    /// The run is over at a step (0: before the first).
    Over(Termination, u64),
    /// The watch stopped the replay.
    Stopped,
}

/// A world and what is asked of it.
#[derive(Clone)]
pub struct Problem<'s> {
    /// The simulator of the world.
    pub sim: &'s Simulator,
    /// What is asked for.
    pub target: Target,
    /// Predicates of the world that may not hold on the way, nor at its end.
    avoided: Vec<ExprId>,
    /// The most steps from where the search begins.
    within: Option<u32>,
    /// The number of steps for which each input is held at least.
    least_hold: u16,
    players: Vec<SlotId>,
    /// Looks at the states that are made for an answer.
    guard: Option<&'s Guard>,
    /// From where; none: from the initial state alone.
    starts: Vec<Start>,
    /// The initial state, once it was asked for: of a large world it takes long.
    initial: OnceLock<Result<State, Fault>>,
}

impl<'s> Problem<'s> {
    /// Asks for a goal of the simulator's world, from its initial state.
    pub fn new(sim: &'s Simulator, goal: GoalId) -> Self {
        Problem::asking(sim, Target::Goal(goal))
    }

    /// Asks for a goal, or for a way to break a `never`.
    pub fn asking(sim: &'s Simulator, target: Target) -> Self {
        let players = sim.world().players.iter().map(|p| p.slot).collect();
        Problem {
            sim,
            target,
            players,
            guard: None,
            avoided: Vec::new(),
            within: None,
            least_hold: 1,
            starts: Vec::new(),
            initial: OnceLock::new(),
        }
    }

    /// Where it may not lead: a predicate of the world must never hold.
    #[must_use]
    pub fn without(mut self, predicate: ExprId) -> Self {
        self.avoided.push(predicate);
        self
    }

    /// The predicates that may not hold on the way.
    pub(super) fn avoided(&self) -> &[ExprId] {
        &self.avoided
    }

    /// Holds all states that are made for an answer against what the world can be, so that several questions share what is
    /// found out. Without it, each search does so for itself ([`super::Settings::checks`]).
    #[must_use]
    pub fn guarded(mut self, guard: &'s Guard) -> Self {
        self.guard = Some(guard);
        self
    }

    /// Who looks at the states.
    pub fn guard(&self) -> Option<&'s Guard> {
        self.guard
    }

    /// How many steps it may take at most, from where a search begins.
    #[must_use]
    pub fn within(mut self, steps: u32) -> Self {
        self.within = Some(steps);
        self
    }

    /// How many steps it may take at most; none: as many as it takes.
    pub fn time(&self) -> Option<u32> {
        self.within
    }

    /// Admits only inputs that are held for at least `steps` steps (an input is what all players give together). Once
    /// the hold is over, an input can change at any step. What is asked for can come about during a hold.
    #[must_use]
    pub fn holding(mut self, steps: u16) -> Self {
        self.least_hold = steps.max(1);
        self
    }

    /// For how many steps an input is held at least.
    pub fn least_hold(&self) -> u16 {
        self.least_hold
    }

    /// Begins where a script leads, too; without any, a search begins in the initial state.
    ///
    /// # Errors
    /// Where the run ends on the way.
    pub fn after(self, script: Script) -> Result<Self, BadStart> {
        self.after_watched(script, &Unwatched)
    }

    /// As [`Problem::after`], with a watch over the replay of the script.
    ///
    /// # Errors
    /// Where the run ends on the way, or the watch stops it.
    pub fn after_watched(mut self, script: Script, watch: &dyn Watch) -> Result<Self, BadStart> {
        let initial = self.initial(watch).map_err(|f| BadStart::Fault(f, 0))?;
        let mut state = initial.ok_or(BadStart::Stopped)?;
        let (mut scratch, meter) = (self.sim.scratch(), Meter::new(watch));
        let over = |state: &[u8], step: u64| match self.judge(state) {
            Ok(StateStatus::Dead(death)) => Err(BadStart::Over(death, step)),
            Ok(_) => Ok(()),
            Err(fault) => Err(BadStart::Fault(fault, step)),
        };
        over(&state, 0)?;
        for (input, step) in script.inputs().zip(1_u64..) {
            self.sim.metered_step(&mut state, input, &mut scratch, &meter).map_err(|f| BadStart::Fault(f, step))?;
            if meter.is_stopped() {
                return Err(BadStart::Stopped);
            }
            over(&state, step)?;
        }
        self.starts.push(Start { after: script.len(), script, state });
        Ok(self)
    }

    /// From where a search begins; none if the watch stops it before that is known.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub(super) fn starts(&self, watch: &dyn Watch) -> Result<Option<Vec<Start>>, Fault> {
        if !self.starts.is_empty() {
            return Ok(Some(self.starts.clone()));
        }
        let start = |state| vec![Start { script: Script::default(), after: 0, state }];
        Ok(self.initial(watch)?.map(start))
    }

    /// The initial state; none if the watch stops it before that is known.
    fn initial(&self, watch: &dyn Watch) -> Result<Option<State>, Fault> {
        if let Some(known) = self.initial.get() {
            return known.clone().map(Some);
        }
        let meter = Meter::new(watch);
        let state = self.sim.metered_initial(&mut self.sim.scratch(), &meter);
        if meter.is_stopped() {
            return Ok(None);
        }
        self.initial.get_or_init(|| state).clone().map(Some)
    }

    /// The slots that players control.
    pub fn players(&self) -> &[SlotId] {
        &self.players
    }

    /// The predicate that is asked for.
    pub fn predicate(&self) -> ExprId {
        match self.target {
            Target::Goal(goal) => self.sim.world().goals[goal].holds,
            Target::Never(never) => self.sim.world().nevers[never].holds,
        }
    }

    /// Judges a state: `never` first, then the bounds that are written, then the goal. The order matters: a state out of
    /// bounds is the end of a run, which the analysis does not look at. Where a search itself stops (`window.rs`) is no
    /// part of it.
    ///
    /// # Errors
    /// A [`Fault`] if a predicate breaks a rule.
    pub fn judge(&self, state: &[u8]) -> Result<StateStatus, Fault> {
        for &predicate in &self.avoided {
            if self.sim.holds(state, predicate)? {
                return Ok(StateStatus::Dead(Termination::Avoided));
            }
        }
        if let Target::Never(never) = self.target
            && self.sim.holds(state, self.sim.world().nevers[never].holds)?
        {
            return Ok(StateStatus::Goal);
        }
        if let Some(never) = self.sim.violated(state)? {
            return Ok(StateStatus::Dead(Termination::Never(never)));
        }
        if self.sim.left_bounds(state).is_some() {
            return Ok(StateStatus::Dead(Termination::Outside));
        }
        Ok(match self.target {
            Target::Goal(goal) if self.sim.goal(state, goal)? => StateStatus::Goal,
            _ => StateStatus::Open,
        })
    }
}

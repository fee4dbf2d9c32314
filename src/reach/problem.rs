//! The question: a world, a target, the starts of a search, and the conditions that end a branch.

use std::borrow::Cow;
use std::sync::OnceLock;

use crate::ir::{ExprId, GoalId, NeverId, SlotId};
use crate::sim::{Fault, Input, Script, Simulator, State};
use crate::watch::{Meter, Unwatched, Watch};

use super::explore::Observer;
use super::monitor::Monitor;
use super::restriction::Restriction;

/// The target.
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
    /// A predicate that the question excludes holds.
    Avoided,
    /// A player is below or beside the written bounds of its space.
    Outside,
}

/// The status of a state of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateStatus {
    /// Go on.
    Open,
    /// The target holds.
    Goal,
    /// The branch ends.
    Dead(Termination),
}

impl StateStatus {
    /// Whether the run is over. It can continue after a goal, but not after a broken `never`, even if that is the
    /// target.
    pub(super) fn is_over(self, target: Target) -> bool {
        match self {
            StateStatus::Open => false,
            StateStatus::Goal => matches!(target, Target::Never(_)),
            StateStatus::Dead(_) => true,
        }
    }
}

/// A start of a search, and the inputs that lead there.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The inputs from the initial state; empty if the search starts there.
    pub script: Script,
    /// Number of its steps that are given; after them, its last input is held for the rest of its minimum time.
    pub after: u64,
    /// The state after them.
    pub state: State,
    /// Whether a step that is not given has read what nature draws, of which only one value was tried.
    pub is_by_luck: bool,
}

impl Start {
    /// Number of steps that are not given.
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

/// A question about a world.
#[derive(Clone)]
pub struct Problem<'s> {
    /// The simulator of the world.
    pub sim: &'s Simulator,
    /// The target.
    pub target: Target,
    /// Predicates of the world that must not hold on the path, including its end.
    avoided: Vec<ExprId>,
    /// `never`s that are questions only: they end no run.
    asked: Vec<NeverId>,
    /// Maximum number of steps from the start of the search.
    within: Option<u32>,
    /// Minimum number of steps for which each input is held.
    min_hold: u16,
    /// The inputs that a search may use; a search that may not use all proves nothing.
    restriction: Option<Restriction>,
    /// For each player, the buttons that no input has down: those of other players and of none are free.
    unpressed: Vec<u64>,
    /// What nature draws where a script leaves it open.
    seed: u64,
    /// Whether the search leaves it open, too.
    is_foretold: bool,
    players: Vec<SlotId>,
    /// Checks the states created for an answer.
    monitor: Option<&'s Monitor>,
    /// Sees the states of samplers.
    observer: Option<&'s dyn Observer>,
    /// The starts; if empty, the initial state.
    starts: Vec<Start>,
    /// The initial state, computed on demand: it takes long for a large world.
    initial: OnceLock<Result<State, Fault>>,
}

impl<'s> Problem<'s> {
    /// A question about a goal of the simulator's world, from its initial state.
    pub fn new(sim: &'s Simulator, goal: GoalId) -> Self {
        Problem::asking(sim, Target::Goal(goal))
    }

    /// A question about a goal or a `never`, from the initial state.
    pub fn asking(sim: &'s Simulator, target: Target) -> Self {
        let players = sim.world().players.iter().map(|p| p.slot).collect();
        Problem {
            sim,
            target,
            players,
            monitor: None,
            observer: None,
            avoided: Vec::new(),
            asked: Vec::new(),
            within: None,
            min_hold: 1,
            restriction: None,
            unpressed: Vec::new(),
            seed: 0,
            is_foretold: false,
            starts: Vec::new(),
            initial: OnceLock::new(),
        }
    }

    /// The same question about another target.
    #[must_use]
    pub(super) fn of(self, target: Target) -> Self {
        Problem { target, ..self }
    }

    /// The same inputs and limits in a part of the world.
    pub(super) fn in_part<'p>(&self, sim: &'p Simulator) -> Problem<'p> {
        let Problem { within, min_hold, unpressed, .. } = self;
        let part = Problem::asking(sim, self.target).holding(*min_hold).never_pressing(unpressed.clone());
        Problem { within: *within, ..part }
    }

    /// Excludes a predicate of the world on the path.
    #[must_use]
    pub fn without(mut self, predicate: ExprId) -> Self {
        self.avoided.push(predicate);
        self
    }

    /// Asks about some `never`s: they are no rules of the world, and end no run unless they are the target.
    #[must_use]
    pub fn asking_only(mut self, nevers: &[NeverId]) -> Self {
        self.asked.extend(nevers);
        self
    }

    /// The predicates of the `never`s that end a run.
    pub(super) fn rules(&self) -> Vec<ExprId> {
        let nevers = self.sim.world().nevers.pairs().filter(|(id, _)| !self.asked.contains(id));
        nevers.map(|(_, never)| never.holds).collect()
    }

    /// The first `never` that holds in a state and ends the run.
    fn broken_rule(&self, state: &[u8]) -> Result<Option<NeverId>, Fault> {
        if self.asked.is_empty() {
            return self.sim.violated(state);
        }
        for (id, never) in self.sim.world().nevers.pairs() {
            if !self.asked.contains(&id) && self.sim.holds(state, never.holds)? {
                return Ok(Some(id));
            }
        }
        Ok(None)
    }

    /// The predicates that must not hold on the path.
    pub(super) fn avoided(&self) -> &[ExprId] {
        &self.avoided
    }

    /// Checks all states created for an answer, with a monitor that several questions can share. Without one, each
    /// search has its own ([`super::Settings::checks`]).
    #[must_use]
    pub fn monitored(mut self, monitor: &'s Monitor) -> Self {
        self.monitor = Some(monitor);
        self
    }

    /// The monitor.
    pub fn monitor(&self) -> Option<&'s Monitor> {
        self.monitor
    }

    /// Shows each state of sampling planners to an observer.
    #[must_use]
    pub fn observed(mut self, observer: &'s dyn Observer) -> Self {
        self.observer = Some(observer);
        self
    }

    /// The observer.
    pub(super) fn observer(&self) -> Option<&'s dyn Observer> {
        self.observer
    }

    /// Limits the number of steps from the start of the search.
    #[must_use]
    pub fn within(mut self, steps: u32) -> Self {
        self.within = Some(steps);
        self
    }

    /// Maximum number of steps; `None`: no limit.
    pub fn time(&self) -> Option<u32> {
        self.within
    }

    /// Admits only inputs that are held for at least `steps` steps (an input is the combination of all players'
    /// inputs). After that, an input can change at any step. The target can be reached during a hold.
    #[must_use]
    pub fn holding(mut self, steps: u16) -> Self {
        self.min_hold = steps.max(1);
        self
    }

    /// Admits only inputs in which no player holds some buttons, a set for each player.
    #[must_use]
    pub fn never_pressing(mut self, buttons: Vec<u64>) -> Self {
        self.unpressed = buttons;
        self
    }

    /// The buttons that a player does not hold.
    pub(super) fn unpressed(&self, player: usize) -> u64 {
        self.unpressed.get(player).copied().unwrap_or(0)
    }

    /// Whether a script holds none of those buttons after some steps that were given.
    pub(super) fn is_unpressed(&self, script: &Script, given: u64) -> bool {
        let holds = |input: &Input| (0..).zip(&input.0).any(|(player, of)| of.buttons & self.unpressed(player) != 0);
        self.unpressed.is_empty() || !script.inputs().skip(given as usize).any(holds)
    }

    /// Admits only some inputs, to find a path among them: that there is none proves nothing.
    #[must_use]
    pub(super) fn restricted(mut self, restriction: Restriction) -> Self {
        self.restriction = Some(restriction);
        self
    }

    /// The inputs that a search may use.
    pub(super) fn restriction(&self) -> Option<&Restriction> {
        self.restriction.as_ref()
    }

    /// Fixes what nature draws to the sequence of a seed. Otherwise a search is free to choose it.
    #[must_use]
    pub fn foretold(mut self, seed: u64) -> Self {
        (self.seed, self.is_foretold) = (seed, true);
        self
    }

    /// Whether a seed fixes what nature draws.
    pub fn is_foretold(&self) -> bool {
        self.is_foretold
    }

    /// The seed of what nature draws where a script leaves it open.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// An input with all that nature draws in a step, which counts from the initial state on: what a script leaves open
    /// is drawn from the seed.
    pub fn draw<'i>(&self, step: u64, input: &'i Input) -> Cow<'i, Input> {
        self.sim.draw(self.seed, step, input)
    }

    /// Minimum number of steps for which an input is held.
    pub fn min_hold(&self) -> u16 {
        self.min_hold
    }

    /// Adds a start at the end of a script; without any, a search starts in the initial state.
    ///
    /// [`BadStart`] if the run ends on the way.
    pub fn after(self, script: Script) -> Result<Self, BadStart> {
        self.after_watched(script, &Unwatched)
    }

    /// As [`Problem::after`], with a watch over the replay of the script.
    ///
    /// [`BadStart`] if the run ends on the way, or if the watch stops it.
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
            let input = self.draw(step, input);
            self.sim.metered_step(&mut state, &input, &mut scratch, &meter).map_err(|f| BadStart::Fault(f, step))?;
            if meter.is_stopped() {
                return Err(BadStart::Stopped);
            }
            over(&state, step)?;
        }
        self.starts.push(Start { after: script.len(), script, state, is_by_luck: false });
        Ok(self)
    }

    /// The same question from the end of a script alone.
    ///
    /// [`BadStart`] if the run ends on the way, or if the watch stops it.
    pub(super) fn restarted(mut self, script: Script, watch: &dyn Watch) -> Result<Self, BadStart> {
        self.starts.clear();
        self.after_watched(script, watch)
    }

    /// The starts of a search; `None` if the watch stops their computation.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub(super) fn starts(&self, watch: &dyn Watch) -> Result<Option<Vec<Start>>, Fault> {
        if !self.starts.is_empty() {
            return Ok(Some(self.starts.clone()));
        }
        let start = |state| vec![Start { script: Script::default(), after: 0, state, is_by_luck: false }];
        Ok(self.initial(watch)?.map(start))
    }

    /// The initial state; `None` if the watch stops its computation.
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

    /// The predicate of the target.
    pub fn predicate(&self) -> ExprId {
        match self.target {
            Target::Goal(goal) => self.sim.world().goals[goal].holds,
            Target::Never(never) => self.sim.world().nevers[never].holds,
        }
    }

    /// Classifies a state: `never` first, then the written bounds, then the goal. The order matters: a state out of
    /// bounds ends a run and is not part of the analysis. Search windows (`window.rs`) do not count here.
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
        if let Some(never) = self.broken_rule(state)? {
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

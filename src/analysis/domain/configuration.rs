//! What an instance can be: in one combination of its leaves, in all of them together, and within a step.

use std::collections::BTreeSet;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use crate::ir::{DiscreteId, IdVec, LeafId, ParamId, SpaceId, TimerId, VarId};

use crate::analysis::domain::energy::Fall;
use crate::analysis::domain::values::{Interval, Values};

/// What the variables of an instance can be while some leaves are active.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// The active leaf of each group.
    pub leaves: Vec<LeafId>,
    /// The count of each timer, steps.
    pub timers: IdVec<TimerId, Interval>,
    /// The spaces it can be in.
    pub spaces: Arc<BTreeSet<SpaceId>>,
    /// What its variables can be. Most ways of a step leave them as they are, so that they are shared until written.
    pub(in crate::analysis) numbers: Arc<Numbers>,
}

/// What the variables of an instance can be.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Position, velocity and acceleration of each continuous variable.
    pub vars: IdVec<VarId, [Values; 3]>,
    /// Each discrete variable.
    pub discretes: IdVec<DiscreteId, Values>,
    /// Each parameter, where they can differ from one life of the slot to the next; else nothing.
    pub(in crate::analysis) params: IdVec<ParamId, Values>,
    /// Of each continuous variable that fell in the last step: how, and with which energy.
    pub(in crate::analysis) energy: IdVec<VarId, Energy>,
}

/// How a variable falls, and with which energy.
type Energy = Option<(Fall, Interval)>;

impl Deref for Configuration {
    type Target = Numbers;

    fn deref(&self) -> &Numbers {
        &self.numbers
    }
}

impl DerefMut for Configuration {
    fn deref_mut(&mut self) -> &mut Numbers {
        Arc::make_mut(&mut self.numbers)
    }
}

/// What is known of a slot whatever it does: its configurations in one.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) struct Overall {
    /// Whether there can be an instance.
    pub can_live: bool,
    /// Whether there can be none.
    pub can_be_absent: bool,
    pub params: IdVec<ParamId, Values>,
    pub vars: IdVec<VarId, [Values; 3]>,
    pub discretes: IdVec<DiscreteId, Values>,
    /// What updates make of it within a step, which flows of others read.
    pub between: Between,
    /// Where it is when contacts are found, before anything is pushed; px.
    pub contact: [Values; 2],
    pub spaces: BTreeSet<SpaceId>,
    /// Of both axes, the greatest speed at which it moves before anything stops it, px/s.
    pub speed: [f64; 2],
    /// The same, of those steps that lead to where there is something that never moves.
    pub near_speed: [f64; 2],
    /// The leaves that can be active.
    pub leaves: BTreeSet<LeafId>,
}

/// What an instance can be within a step, after the discrete phase and before the continuous one. Whoever is destroyed in
/// that step is read by others in it, too.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::analysis) struct Between {
    pub vars: IdVec<VarId, [Values; 3]>,
    pub discretes: IdVec<DiscreteId, Values>,
    pub leaves: BTreeSet<LeafId>,
}

impl Between {
    /// Of an entity with so many variables.
    pub fn new(vars: usize, discretes: usize) -> Self {
        let none = |count: usize| (0..count).map(|_| Values::none());
        let vars = none(vars).map(|v| [v; 3]).collect();
        Between { vars, discretes: none(discretes).collect(), leaves: BTreeSet::new() }
    }

    /// Of what can be anything but for its discrete variables, with so many leaves.
    pub fn anything(vars: usize, discretes: IdVec<DiscreteId, Values>, leaves: BTreeSet<LeafId>) -> Self {
        Between { vars: (0..vars).map(|_| [Values::all(); 3]).collect(), discretes, leaves }
    }

    /// Adds what the discrete phase leads to; returns true if that is more than before.
    pub fn add(&mut self, at: &Configuration) -> bool {
        let mut changed = false;
        for leaf in &at.leaves {
            changed |= self.leaves.insert(*leaf);
        }
        let numbers: &Numbers = at;
        let mut join = |known: &mut Values, new: &Values| {
            if !new.is_within(known) {
                *known = known.or(new);
                changed = true;
            }
        };
        for (known, new) in self.vars.iter_mut().flatten().zip(numbers.vars.iter().flatten()) {
            join(known, new);
        }
        for (known, new) in self.discretes.iter_mut().zip(numbers.discretes.iter()) {
            join(known, new);
        }
        changed
    }
}

impl Configuration {
    /// Whether some variable has no value left.
    pub fn is_impossible(&self) -> bool {
        let mut all = self.vars.iter().flatten().chain(self.discretes.iter()).chain(self.params.iter());
        all.any(Values::is_none)
    }

    /// Of an instance that has not moved yet.
    pub(in crate::analysis) fn new(
        vars: IdVec<VarId, [Values; 3]>,
        discretes: IdVec<DiscreteId, Values>,
        timers: usize,
        spaces: BTreeSet<SpaceId>,
    ) -> Self {
        let energy = vars.iter().map(|_| None).collect();
        let timers = (0..timers).map(|_| Interval::point(0.0)).collect();
        let numbers = Arc::new(Numbers { vars, discretes, params: IdVec::new(), energy });
        Configuration { leaves: Vec::new(), timers, spaces: Arc::new(spaces), numbers }
    }

    /// Sets a variable (0), its velocity (1) or acceleration (2).
    pub(in crate::analysis) fn set(&mut self, var: VarId, degree: usize, values: Values) {
        if self.vars[var][degree] != values {
            self.vars[var][degree] = values;
        }
    }

    /// Sets a discrete variable.
    pub(in crate::analysis) fn set_discrete(&mut self, id: DiscreteId, values: Values) {
        if self.discretes[id] != values {
            self.discretes[id] = values;
        }
    }

    /// A variable does not go on as it fell.
    pub(in crate::analysis) fn forget_energy(&mut self, var: VarId) {
        if self.energy[var].is_some() {
            self.energy[var] = None;
        }
    }

    /// A variable has an energy as it falls.
    pub(in crate::analysis) fn set_energy(&mut self, var: VarId, energy: (Fall, Interval)) {
        self.energy[var] = Some(energy);
    }

    /// Whether the variables are the very same: nothing has been written since.
    pub(in crate::analysis) fn shares(&self, other: &Configuration) -> bool {
        Arc::ptr_eq(&self.numbers, &other.numbers)
    }

    /// Whether all that can be here can be there, too.
    pub(in crate::analysis) fn is_within(&self, there: &Configuration) -> bool {
        let energy = |(a, b): (&Energy, &Energy)| match (a, b) {
            (_, None) => true,
            (Some((a, here)), Some((b, there))) => a == b && there.low <= here.low && here.high <= there.high,
            (None, Some(_)) => false,
        };
        let both = |a: &[Values; 3], b: &[Values; 3]| a.iter().zip(b).all(|(a, b)| a.is_within(b));
        let numbers = || {
            self.vars.iter().zip(there.vars.iter()).all(|(a, b)| both(a, b))
                && self.discretes.iter().zip(there.discretes.iter()).all(|(a, b)| a.is_within(b))
                && self.params.iter().zip(there.params.iter()).all(|(a, b)| a.is_within(b))
                && self.energy.iter().zip(there.energy.iter()).all(energy)
        };
        self.timers.iter().zip(there.timers.iter()).all(|(a, b)| b.low <= a.low && a.high <= b.high)
            && (Arc::ptr_eq(&self.spaces, &there.spaces) || self.spaces.is_subset(&there.spaces))
            && (self.shares(there) || numbers())
    }

    /// Cuts speeds and heights to what energies allow.
    pub(in crate::analysis) fn sharpen(&mut self) {
        for var in self.energy.ids() {
            let [mut position, mut velocity, _] = self.vars[var];
            let Some((fall, energy)) = self.energy[var] else { continue };
            for _ in 0..2 {
                let Some(hull) = position.hull() else { break };
                velocity = fall.velocities(energy, hull, &velocity);
                let Some(hull) = velocity.hull() else { break };
                position = fall.positions(energy, hull, &position);
            }
            self.set(var, 0, position);
            self.set(var, 1, velocity);
        }
    }

    /// What can be in either; both are of the same leaves.
    #[must_use]
    pub fn or(&self, other: &Configuration) -> Configuration {
        if other.is_within(self) {
            return self.clone();
        }
        let timers = self.timers.iter().zip(other.timers.iter()).map(|(a, b)| a.or(*b)).collect();
        let spaces = match self.spaces.is_superset(&other.spaces) {
            true => Arc::clone(&self.spaces),
            false => Arc::new(self.spaces.union(&other.spaces).copied().collect()),
        };
        if self.shares(other) {
            return Configuration { timers, spaces, ..self.clone() };
        }
        // Positions and velocities have an energy under whatever acceleration.
        let energy = |var: VarId| {
            let of = |c: &Configuration, fall: Fall| match c.energy[var] {
                Some((own, energy)) if own == fall => Some(energy),
                _ => Some(fall.energy(c.vars[var][0].hull()?, c.vars[var][1].hull()?)),
            };
            let fall = self.energy[var].or(other.energy[var])?.0;
            Some((fall, of(self, fall)?.or(of(other, fall)?)))
        };
        let numbers = Numbers {
            vars: self.vars.iter().zip(other.vars.iter()).map(|(a, b)| [0, 1, 2].map(|d| a[d].or(&b[d]))).collect(),
            discretes: self.discretes.iter().zip(other.discretes.iter()).map(|(a, b)| a.or(b)).collect(),
            params: self.params.iter().zip(other.params.iter()).map(|(a, b)| a.or(b)).collect(),
            energy: self.energy.ids().map(energy).collect(),
        };
        Configuration { leaves: self.leaves.clone(), timers, spaces, numbers: Arc::new(numbers) }
    }
}

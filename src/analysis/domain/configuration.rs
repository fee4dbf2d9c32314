//! Abstract states of an instance: per combination of leaves, joined over all of them, and in the middle of a step.

use std::collections::BTreeSet;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use crate::ir::{DiscreteId, IdVec, LeafId, ParamId, SpaceId, TimerId, VarId};

use crate::analysis::domain::energy::Fall;
use crate::analysis::domain::values::{Interval, Values};

/// The abstract state of an instance while some leaves are active.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// The active leaf of each group.
    pub leaves: Arc<[LeafId]>,
    /// Steps counted by each timer.
    pub timers: IdVec<TimerId, Interval>,
    /// The spaces the instance can be in.
    pub spaces: Arc<BTreeSet<SpaceId>>,
    /// What the last step has done to it, if that is told apart.
    pub(in crate::analysis) trace: Option<Trace>,
    /// Values of its variables. Most branches of a step do not change them, so they are shared until written.
    pub(in crate::analysis) numbers: Arc<Numbers>,
}

/// What a step has done to an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::analysis) struct Trace {
    /// Whether anything but its flows has changed its height or its velocity along y.
    pub is_disturbed: bool,
    /// Whether it was pushed along y: by its low and by its high side.
    pub pushed: [bool; 2],
}

/// Values of the variables of an instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Value, first and second derivative of each continuous variable.
    pub vars: IdVec<VarId, [Values; 3]>,
    /// Each discrete variable.
    pub discretes: IdVec<DiscreteId, Values>,
    /// The parameters, if they can differ between lives of the slot; else empty.
    pub(in crate::analysis) params: IdVec<ParamId, Values>,
    /// For each continuous variable in free fall in the last step: its acceleration and energy.
    pub(in crate::analysis) energy: IdVec<VarId, Energy>,
}

/// The acceleration and energy of a variable in free fall.
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

/// The join of a slot's configurations.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) struct Overall {
    /// Whether the slot can hold an instance.
    pub can_live: bool,
    /// Whether the slot can be empty.
    pub can_be_absent: bool,
    pub params: IdVec<ParamId, Values>,
    pub vars: IdVec<VarId, [Values; 3]>,
    pub discretes: IdVec<DiscreteId, Values>,
    /// Values after the discrete phase, which flows of others read.
    pub mid_step: MidStep,
    /// Position when contacts are detected, before pushes; px.
    pub contact: [Values; 2],
    pub spaces: BTreeSet<SpaceId>,
    /// Maximum speed along each axis before a collision, px/s.
    pub speed: [f64; 2],
    /// The same, over steps that end near static obstacles.
    pub near_speed: [f64; 2],
    /// The leaves that can be active.
    pub leaves: BTreeSet<LeafId>,
}

/// Values of an instance after the discrete phase and before the continuous one. They include those of an instance that
/// is destroyed in the step, which others still read.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::analysis) struct MidStep {
    pub vars: IdVec<VarId, [Values; 3]>,
    pub discretes: IdVec<DiscreteId, Values>,
    pub leaves: BTreeSet<LeafId>,
}

impl MidStep {
    /// Empty, for an entity with a number of variables.
    pub fn new(vars: usize, discretes: usize) -> Self {
        let none = |count: usize| (0..count).map(|_| Values::none());
        let vars = none(vars).map(|v| [v; 3]).collect();
        MidStep { vars, discretes: none(discretes).collect(), leaves: BTreeSet::new() }
    }

    /// Unconstrained except for the discrete variables and leaves.
    pub fn anything(vars: usize, discretes: IdVec<DiscreteId, Values>, leaves: BTreeSet<LeafId>) -> Self {
        MidStep { vars: (0..vars).map(|_| [Values::all(); 3]).collect(), discretes, leaves }
    }

    /// Joins a result of the discrete phase; returns true if the set grew.
    pub fn add(&mut self, at: &Configuration) -> bool {
        let mut changed = false;
        for leaf in &*at.leaves {
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
    /// Whether some variable has no possible value.
    pub fn is_impossible(&self) -> bool {
        let mut all = self.vars.iter().flatten().chain(self.discretes.iter()).chain(self.params.iter());
        all.any(Values::is_none)
    }

    /// The configuration of an instance that has not moved yet.
    pub(in crate::analysis) fn new(
        vars: IdVec<VarId, [Values; 3]>,
        discretes: IdVec<DiscreteId, Values>,
        timers: usize,
        spaces: BTreeSet<SpaceId>,
    ) -> Self {
        let energy = vars.iter().map(|_| None).collect();
        let timers = (0..timers).map(|_| Interval::point(0.0)).collect();
        let numbers = Arc::new(Numbers { vars, discretes, params: IdVec::new(), energy });
        Configuration { leaves: Arc::default(), timers, spaces: Arc::new(spaces), trace: None, numbers }
    }

    /// Sets a variable (degree 0), its velocity (1) or acceleration (2).
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

    /// Drops what is known about the energy of a variable.
    pub(in crate::analysis) fn forget_energy(&mut self, var: VarId) {
        if self.energy[var].is_some() {
            self.energy[var] = None;
        }
    }

    /// Sets the energy of a variable in free fall.
    pub(in crate::analysis) fn set_energy(&mut self, var: VarId, energy: (Fall, Interval)) {
        self.energy[var] = Some(energy);
    }

    /// Whether both share the same variables: nothing was written since they were cloned.
    pub(in crate::analysis) fn shares(&self, other: &Configuration) -> bool {
        Arc::ptr_eq(&self.numbers, &other.numbers)
    }

    /// Whether this configuration is included in another.
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
            && (there.trace.is_none() || self.trace == there.trace)
            && (self.shares(there) || numbers())
    }

    /// Restricts speeds and heights to what the energies allow.
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

    /// The join of two configurations with the same leaves.
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
        let trace = self.trace.filter(|trace| other.trace == Some(*trace));
        if self.shares(other) {
            return Configuration { timers, spaces, trace, ..self.clone() };
        }
        // An energy can be computed for any acceleration.
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
        Configuration { leaves: self.leaves.clone(), timers, spaces, trace, numbers: Arc::new(numbers) }
    }
}

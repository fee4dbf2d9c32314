//! Widening to thresholds taken from the program, and the operators of narrowing.

use std::sync::Arc;

use crate::ir::{Bounds, DiscreteId, Extremes, IdVec, ParamId, SlotId, VarId, World};

use crate::analysis::domain::configuration::{Configuration, Numbers};
use crate::analysis::domain::values::{Interval, Values};

/// Removes the states at which a search stops: a player below or beside the bounds of its space.
pub(in crate::analysis) fn within_bounds(world: &World, slot: SlotId, mut at: Configuration) -> Configuration {
    if world.slots[slot].player.is_none() {
        return at;
    }
    let bounds: Option<Vec<_>> = at.spaces.iter().map(|s| world.spaces[*s].bounds).collect();
    if let Some(all) = bounds.as_deref().and_then(|b| {
        b.iter().copied().reduce(|a, b| Bounds {
            left: a.left.least(b.left),
            right: a.right.greatest(b.right),
            bottom: a.bottom.least(b.bottom),
            top: a.top.greatest(b.top),
        })
    }) {
        let cut = |values: &Values, low: f64, high: f64| values.within(Interval { low, high });
        at.set(VarId::X, 0, cut(&at.vars[VarId::X][0], all.left, all.right));
        at.set(VarId::Y, 0, cut(&at.vars[VarId::Y][0], all.bottom, f64::INFINITY));
    }
    at
}

/// Weight of a growth caused by the configuration itself; growth caused by others has weight 1.
const OWN_WEIGHT: u8 = 4;
/// Number of changes after which an end moves to the next threshold.
const WIDEN_AFTER: u8 = 5 * OWN_WEIGHT;
/// Number of changes after which an end moves to the hull over the other modes.
const THRESHOLDS_UNTIL: u8 = WIDEN_AFTER + 10 * OWN_WEIGHT;
/// Number of changes after which an end becomes infinite.
const OTHERS_UNTIL: u8 = THRESHOLDS_UNTIL + 20 * OWN_WEIGHT;
/// Number of changes after which energies are widened. They grow only by input from other modes, so they get more time.
const ENERGY_WIDEN_AFTER: u8 = 96;

/// Thresholds of widening, in order.
#[derive(Debug, Clone, Default)]
pub(in crate::analysis) struct Thresholds(Vec<f64>);

impl Thresholds {
    pub fn new(mut numbers: Vec<f64>) -> Self {
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        Thresholds(numbers)
    }

    fn at_most(&self, x: f64) -> f64 {
        let after = self.0.partition_point(|t| *t <= x);
        after.checked_sub(1).map_or(f64::NEG_INFINITY, |at| self.0[at])
    }

    fn at_least(&self, x: f64) -> f64 {
        let at = self.0.partition_point(|t| *t < x);
        self.0.get(at).copied().unwrap_or(f64::INFINITY)
    }
}

/// How often each number of a configuration has grown.
#[derive(Debug, Clone, Default)]
pub(in crate::analysis) struct GrowthCounts {
    vars: IdVec<VarId, [u8; 3]>,
    discretes: IdVec<DiscreteId, u8>,
    params: IdVec<ParamId, u8>,
    energy: IdVec<VarId, u8>,
}

impl GrowthCounts {
    pub fn new(at: &Configuration) -> Self {
        GrowthCounts {
            vars: at.vars.iter().map(|_| [0; 3]).collect(),
            discretes: at.discretes.iter().map(|_| 0).collect(),
            params: at.params.iter().map(|_| 0).collect(),
            energy: at.energy.iter().map(|_| 0).collect(),
        }
    }

    /// Widens numbers that have grown too often: first to the next threshold, later to infinity. `others` returns the
    /// hull of a variable (by id and degree) over the other leaves. `is_own` is true if the growth is caused by the
    /// configuration itself; growth caused by others usually ends when those are widened.
    pub fn widen(
        &mut self,
        old: &Configuration,
        new: &mut Configuration,
        thresholds: &Thresholds,
        is_own: bool,
        others: impl Fn(VarId, usize) -> Option<Interval>,
    ) {
        let weight = if is_own { OWN_WEIGHT } else { 1 };
        let numbers: &mut Numbers = new;
        for (var, old) in old.vars.pairs() {
            let counts = self.vars[var].iter_mut().zip(&mut numbers.vars[var]);
            for ((degree, old), (count, new)) in old.iter().enumerate().zip(counts) {
                widen_values((count, weight), old, new, thresholds, || others(var, degree));
            }
        }
        for (id, old) in old.discretes.pairs() {
            widen_values((&mut self.discretes[id], weight), old, &mut numbers.discretes[id], thresholds, || None);
        }
        for (id, old) in old.params.pairs() {
            // Each generation in a chain of spawns is a change caused by the configuration itself.
            widen_values((&mut self.params[id], 2), old, &mut numbers.params[id], thresholds, || None);
        }
        // A timer runs until it is reset.
        for (id, old) in old.timers.pairs() {
            let new = &mut new.timers[id];
            if new.high > old.high {
                new.high = f64::INFINITY;
            }
        }
        for ((count, old), new) in self.energy.iter_mut().zip(old.energy.iter()).zip(new.energy.iter_mut()) {
            if let (Some((before, old)), Some((fall, new))) = (old, new) {
                let is_within = old.low <= new.low && new.high <= old.high;
                if before == fall && !is_within {
                    *count = count.saturating_add(1);
                    if *count > ENERGY_WIDEN_AFTER {
                        *new = widen_energy(*old, *new);
                    }
                }
            }
        }
    }
}

fn widen_values(
    (count, weight): (&mut u8, u8),
    old: &Values,
    new: &mut Values,
    thresholds: &Thresholds,
    others: impl Fn() -> Option<Interval>,
) {
    if new == old {
        return;
    }
    *count = count.saturating_add(weight);
    let (Some(from), Some(to)) = (old.hull(), new.hull()) else { return };
    if *count <= WIDEN_AFTER || new.is_within(old) || weight == 1 && *count <= THRESHOLDS_UNTIL {
        return;
    }
    // A variable that is bounded in other modes gets its bound from there.
    let around = if *count <= THRESHOLDS_UNTIL {
        Interval { low: thresholds.at_most(to.low), high: thresholds.at_least(to.high) }
    } else {
        let others = others().filter(|o| *count <= OTHERS_UNTIL && o.low <= to.low && to.high <= o.high);
        others.unwrap_or(Interval::ALL)
    };
    let low = if to.low < from.low { around.low } else { to.low };
    let high = if to.high > from.high { around.high } else { to.high };
    *new = Values::from(Interval { low, high });
}

/// There are no thresholds for energies; they grow to powers of two.
fn widen_energy(old: Interval, new: Interval) -> Interval {
    let up = |x: f64| if x.abs() > 1e12 { f64::INFINITY } else { x.abs().greatest(1.0).log2().ceil().exp2() };
    let low = match new.low < old.low {
        true if new.low < 0.0 => -up(new.low),
        true => 0.0,
        false => new.low,
    };
    let high = match new.high > old.high {
        true if new.high > 0.0 => up(new.high),
        true => 0.0,
        false => new.high,
    };
    Interval { low, high }
}

/// The intersection of two over-approximations.
pub(in crate::analysis) fn intersection(a: &Configuration, b: &Configuration) -> Configuration {
    let mut out = a.clone();
    out.vars = a.vars.iter().zip(b.vars.iter()).map(|(a, b)| [0, 1, 2].map(|d| a[d].and(&b[d]))).collect();
    out.discretes = a.discretes.iter().zip(b.discretes.iter()).map(|(a, b)| a.and(b)).collect();
    out.params = a.params.iter().zip(b.params.iter()).map(|(a, b)| a.and(b)).collect();
    out.timers = a.timers.iter().zip(b.timers.iter()).map(|(a, b)| a.and(*b).unwrap_or(*a)).collect();
    out.spaces = Arc::new(a.spaces.intersection(&b.spaces).copied().collect());
    out
}

/// Joins a configuration with its successors; an end that grows moves to the known end.
pub(in crate::analysis) fn extended(at: &Configuration, own: &Configuration, known: &Configuration) -> Configuration {
    let values = |at: &Values, own: &Values, known: &Values| {
        let joined = at.or(own);
        let (Some(a), Some(b), Some(k)) = (at.hull(), own.hull(), known.hull()) else { return joined };
        if joined == *at {
            return joined;
        }
        let low = if b.low < a.low { k.low } else { a.low };
        let high = if b.high > a.high { k.high } else { a.high };
        known.within(Interval { low, high }).or(&joined).and(known)
    };
    let mut out = at.or(own);
    for (var, known) in known.vars.pairs() {
        for (degree, known) in known.iter().enumerate() {
            out.set(var, degree, values(&at.vars[var][degree], &own.vars[var][degree], known));
        }
    }
    for (id, known) in known.discretes.pairs() {
        out.discretes[id] = values(&at.discretes[id], &own.discretes[id], known);
    }
    for (id, known) in known.params.pairs() {
        out.params[id] = values(&at.params[id], &own.params[id], known);
    }
    for (id, known) in known.timers.pairs() {
        if own.timers[id].high > at.timers[id].high {
            out.timers[id].high = known.high;
        }
    }
    for (var, known) in known.energy.pairs() {
        if out.energy[var] != at.energy[var] {
            out.energy[var] = *known;
        }
    }
    out
}

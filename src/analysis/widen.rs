//! How growing values are brought to an end: widening to the numbers of the program, and what is in two enclosures.

use std::collections::BTreeSet;

use crate::ir::{Bounds, SlotId, VarId, World};

use super::energy::Fall;
use super::evaluate::Configuration;
use super::values::{Interval, Values};

/// Without the states at which a search stops: a player below or beside the bounds of its space.
pub(super) fn within_bounds(world: &World, slot: SlotId, mut at: Configuration) -> Configuration {
    if world.slots[slot].player.is_none() {
        return at;
    }
    let bounds: Option<Vec<_>> = at.spaces.iter().map(|s| world.spaces[*s].bounds).collect();
    if let Some(all) = bounds.as_deref().and_then(|b| {
        b.iter().copied().reduce(|a, b| Bounds {
            left: a.left.min(b.left),
            right: a.right.max(b.right),
            bottom: a.bottom.min(b.bottom),
            top: a.top.max(b.top),
        })
    }) {
        let cut = |values: &Values, low: f64, high: f64| values.within(Interval { low, high });
        at.vars[VarId(0)][0] = cut(&at.vars[VarId(0)][0], all.left, all.right);
        at.vars[VarId(1)][0] = cut(&at.vars[VarId(1)][0], all.bottom, f64::INFINITY);
    }
    at
}

/// Numbers in order at which growing ends may stay.
#[derive(Debug, Clone, Default)]
pub(super) struct Thresholds(Vec<f64>);

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

/// How far an end that grows is moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Haste {
    /// To the next number that the program knows.
    Next,
    /// On for ever.
    Ever,
    /// So are energies, which grow by what comes in from other modes alone, and are left more time.
    Energy,
}

/// What grows goes to the next number that the program knows, or on for ever.
pub(super) fn widened(
    old: &Configuration,
    new: &Configuration,
    thresholds: &Thresholds,
    haste: Haste,
) -> Configuration {
    let at_once = haste != Haste::Next;
    let interval = |old: Interval, new: Interval| {
        let low = match new.low < old.low {
            true if at_once => f64::NEG_INFINITY,
            true => thresholds.at_most(new.low),
            false => new.low,
        };
        let high = match new.high > old.high {
            true if at_once => f64::INFINITY,
            true => thresholds.at_least(new.high),
            false => new.high,
        };
        Interval { low, high }
    };
    let values = |old: &Values, new: &Values| match (old.hull(), new.hull()) {
        (Some(a), Some(b)) if !new.is_within(old) => Values::from(interval(a, b)),
        _ => *new,
    };
    type Energy = Option<(Fall, Interval)>;
    let energy = |(old, new): (&Energy, &Energy)| match (old, new) {
        (Some((before, old)), Some((fall, new))) if before == fall && haste == Haste::Energy => {
            Some((*fall, wider_energy(*old, *new)))
        }
        _ => *new,
    };
    let mut out = new.clone();
    out.vars = old.vars.iter().zip(new.vars.iter()).map(|(a, b)| [0, 1, 2].map(|d| values(&a[d], &b[d]))).collect();
    out.discretes = old.discretes.iter().zip(new.discretes.iter()).map(|(a, b)| values(a, b)).collect();
    out.timers = old.timers.iter().zip(new.timers.iter()).map(|(a, b)| interval(*a, *b)).collect();
    out.energy = old.energy.iter().zip(new.energy.iter()).map(energy).collect();
    out
}

/// Energies have no numbers of the program to stay at; they grow to powers of two.
fn wider_energy(old: Interval, new: Interval) -> Interval {
    let up = |x: f64| if x.abs() > 1e12 { f64::INFINITY } else { x.abs().max(1.0).log2().ceil().exp2() };
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

/// What is in both; both enclose all that can be.
pub(super) fn both(a: &Configuration, b: &Configuration) -> Configuration {
    let mut out = a.clone();
    out.vars = a.vars.iter().zip(b.vars.iter()).map(|(a, b)| [0, 1, 2].map(|d| a[d].and(&b[d]))).collect();
    out.discretes = a.discretes.iter().zip(b.discretes.iter()).map(|(a, b)| a.and(b)).collect();
    out.timers = a.timers.iter().zip(b.timers.iter()).map(|(a, b)| a.and(*b).unwrap_or(*a)).collect();
    out.spaces = a.spaces.intersection(&b.spaces).copied().collect::<BTreeSet<_>>();
    out
}

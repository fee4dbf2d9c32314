//! The invariant of motion under a constant acceleration.
//!
//! With `v += a·dt; p += v·dt`, the number `v² + a·dt·v − 2·a·p` is constant: it is the energy of a free fall, as
//! preserved by this integrator. It relates speed to height: how fast a body falls when it lands, how high it jumps.
//! Each step adds a rounding error of about 1e-16 of the terms; a margin of 1e-6 of their size covers any realistic
//! number of steps.

use crate::analysis::domain::values::{Interval, Values};
use crate::ir::Extremes;

/// Relative error margin for rounding.
const MARGIN: f64 = 1e-6;

/// A constant acceleration, with the length of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::analysis) struct Fall {
    /// px/s², not 0.
    pub acceleration: f64,
    /// s
    pub step: f64,
}

fn with_margin(i: Interval) -> Interval {
    let margin = |x: f64| MARGIN * (1.0 + x.abs());
    Interval { low: i.low - margin(i.low), high: i.high + margin(i.high) }
}

/// The sum of two terms, with a margin proportional to their sizes: they may cancel.
fn sum(a: Interval, b: Interval) -> Interval {
    let sum = a.plus(b);
    let margin = |a: f64, b: f64| MARGIN * (1.0 + a.abs() + b.abs());
    let (low, high) = (sum.low - margin(a.low, b.low), sum.high + margin(a.high, b.high));
    Interval {
        low: if low.is_nan() { f64::NEG_INFINITY } else { low },
        high: if high.is_nan() { f64::INFINITY } else { high },
    }
}

impl Fall {
    /// The energy of some positions and velocities.
    pub fn energy(self, position: Interval, velocity: Interval) -> Interval {
        let potential = position.times(Interval::point(2.0 * self.acceleration));
        sum(self.kinetic(velocity), Interval { low: -potential.high, high: -potential.low })
    }

    /// `v² + a·dt·v`
    fn kinetic(self, v: Interval) -> Interval {
        // The minimum is at v = -a·dt/2.
        let turn = -self.acceleration * self.step / 2.0;
        let f = |v: f64| if v.is_finite() { v * v + self.acceleration * self.step * v } else { f64::INFINITY };
        let ends = Interval::between(f(v.low), f(v.high));
        if v.contains(turn) { ends.or(Interval::point(f(turn))) } else { ends }
    }

    /// Converts an energy under this acceleration into the energy under another one.
    pub fn converted(self, energy: Interval, to: Fall, position: Interval, velocity: Interval) -> Interval {
        let (a, b) = (self.acceleration, to.acceleration);
        let along = position.times(Interval::point(2.0 * (a - b)));
        let speed = velocity.times(Interval::point((b - a) * self.step));
        let exact = sum(sum(energy, along), speed);
        exact.and(to.energy(position, velocity)).unwrap_or(exact)
    }

    /// The energy after pushes by the low and by the high side. Motion into a surface is stopped; motion away from it
    /// keeps its velocity, which is one of `free`.
    pub fn pushed(self, energy: Interval, pushed: [Option<Interval>; 2], free: Interval) -> Interval {
        let stopped = Interval::point(0.0);
        let mut out = energy;
        for (end, at) in pushed.into_iter().enumerate().filter_map(|(end, at)| Some((end, at?))) {
            // A push against the acceleration adds energy; any other push removes some.
            let gains = (end == 0) == (self.acceleration < 0.0);
            let kept = if end == 0 { free.high.greatest(0.0) } else { free.low.least(0.0) };
            let velocity = if gains { stopped.or(Interval::point(kept)) } else { stopped };
            let turn = -self.acceleration * self.step / 2.0;
            out = out.or(self.energy(at, velocity.or(Interval::point(turn))));
        }
        out
    }

    /// The energy after velocities below (or above) `end` were clamped to it.
    pub fn cut(self, energy: Interval, position: Interval, end: Interval, is_low: bool) -> Interval {
        let cut = self.energy(position, end);
        // In terms of the position before the step, a velocity `v` after it contributes `(v - a·dt/2)²`: slowing down
        // towards `a·dt/2` reduces the energy.
        let turn = self.acceleration * self.step / 2.0;
        match if is_low { end.high <= turn } else { turn <= end.low } {
            true => Interval { low: energy.low.least(cut.low), high: energy.high },
            false => energy.or(cut),
        }
    }

    /// The energy after velocities were reduced in magnitude.
    pub fn slowed(self, energy: Interval, position: Interval) -> Interval {
        // Beyond `-a·dt/2` the energy decreases with the speed, so only velocities between that and 0 can add energy.
        let turn = -self.acceleration * self.step / 2.0;
        energy.or(self.energy(position, Interval::between(0.0, turn)))
    }

    /// The velocities that an energy allows at some positions.
    pub fn velocities(self, energy: Interval, position: Interval, velocity: &Values) -> Values {
        let half = self.acceleration * self.step / 2.0;
        let kinetic = sum(energy, position.times(Interval::point(2.0 * self.acceleration)));
        let square = with_margin(kinetic).high + half * half;
        if square.is_nan() || square == f64::INFINITY {
            return *velocity;
        }
        let root = square.greatest(0.0).sqrt();
        velocity.within(with_margin(Interval { low: -half - root, high: -half + root }))
    }

    /// The positions that an energy allows at some velocities.
    pub fn positions(self, energy: Interval, velocity: Interval, position: &Values) -> Values {
        let difference = sum(self.kinetic(velocity), Interval { low: -energy.high, high: -energy.low });
        position.within(with_margin(difference.times(Interval::point(0.5 / self.acceleration))))
    }
}

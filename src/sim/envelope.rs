//! Envelopes: the effect of attack, decay, sustain and release on a variable in one step (after Swink, *Game Feel*,
//! 2009).
//!
//! A vector moves in a straight line. A reached peak is stored as the number of its direction, so that a change of
//! direction starts a new attack.

use crate::ir::{By, Entity, Envelope, EnvelopeId, ExprId, Press, Release};

use super::evaluate::Reader;

/// The resolution of unquantised directions: fractions of a full turn.
const FINE_DIRECTIONS: f64 = 65_534.0;

/// A driven envelope's direction: a vector of length 1, and its number.
#[derive(Debug, Clone, Copy)]
struct Direction {
    vector: [f64; 2],
    number: u16,
}

impl Direction {
    /// A vector of some length in this direction; of one component if the envelope has one variable.
    fn scaled<const N: usize>(self, length: f64) -> [f64; N] {
        vector(|i| self.vector[i] * length)
    }
}

/// The value of a component after this step.
pub(super) fn envelope_value(reader: &Reader<'_>, id: EnvelopeId, envelope: &Envelope, component: usize) -> f64 {
    if let By::Clock { timer, rise, hold, fall, .. } = envelope.by {
        let layout = reader.own_layout();
        let t = reader.sim.world().step.times(layout.timer(reader.state, timer).saturating_add(1));
        return at_time(
            t,
            [reader.number(rise), reader.number(hold), reader.number(fall)],
            level(reader, envelope),
            reader.number(envelope.sustain),
        );
    }
    match envelope.vars[..] {
        [_] => driven_values::<1>(reader, id, envelope)[0],
        _ => driven_values::<2>(reader, id, envelope)[component],
    }
}

/// The values after this step of an envelope that is driven by input.
#[inline(always)]
fn driven_values<const N: usize>(reader: &Reader<'_>, id: EnvelopeId, envelope: &Envelope) -> [f64; N] {
    let current = current(reader, envelope);
    let (target, rate) = match driven(reader, envelope) {
        Some(direction) => {
            let (level, rate) = driven_target(reader, id, envelope, direction);
            (direction.scaled(level), rate)
        }
        None => match &envelope.release {
            Release::Hold => return current,
            Release::To { rate, level } => {
                let level = reader.number(*level);
                let direction = unit(current);
                (vector(|i| direction[i] * level), *rate)
            }
        },
    };
    approach(reader, current, target, rate)
}

/// 0, or 1 plus the number of the direction whose peak is reached by the end of this step.
pub(super) fn next_peak(reader: &Reader<'_>, entity: &Entity, envelope: &Envelope) -> u16 {
    let layout = reader.own_layout();
    let is_active = envelope.mode.is_none_or(|mode| {
        let inside = entity.modes[mode].leaves;
        let leaf = layout.leaf(reader.state, entity.modes[mode].group);
        inside.contains(leaf)
    });
    let (true, Some(peak)) = (is_active, envelope.peak) else { return 0 };
    let Some(direction) = driven(reader, envelope) else { return 0 };
    let id = entity.envelopes.find(|e| std::ptr::eq(e, envelope));
    let reached = direction.number + 1;
    if id.is_some_and(|id| layout.peak(reader.state, id) == reached) {
        return reached;
    }
    let target: [f64; 2] = direction.scaled(reader.number(peak));
    let next = approach(reader, current(reader, envelope), target, envelope.attack);
    if next == target { reached } else { 0 }
}

/// The target level and the rate of a driven envelope.
#[inline(always)]
fn driven_target(
    reader: &Reader<'_>,
    id: EnvelopeId,
    envelope: &Envelope,
    direction: Direction,
) -> (f64, Option<ExprId>) {
    match envelope.peak {
        Some(_) if reader.own_layout().peak(reader.state, id) == direction.number + 1 => {
            (reader.number(envelope.sustain), envelope.decay)
        }
        Some(peak) => (reader.number(peak), envelope.attack),
        None => (reader.number(envelope.sustain), envelope.attack),
    }
}

/// The direction of the input, if the envelope is driven.
#[inline(always)]
fn driven(reader: &Reader<'_>, envelope: &Envelope) -> Option<Direction> {
    let direction = match &envelope.by {
        By::Button(button) => {
            reader.button(Press::Held, *button).then_some(Direction { vector: [1.0, 0.0], number: 0 })
        }
        By::Axis(axis) => {
            let axis = reader.axis(*axis);
            (axis != 0.0).then(|| Direction { vector: [axis.signum(), 0.0], number: u16::from(axis < 0.0) })
        }
        By::Axes([x, y], directions) => {
            let input = [reader.axis(*x), reader.axis(*y)];
            (input != [0.0, 0.0]).then(|| nearest(input, directions))
        }
        By::Clock { .. } => None,
    }?;
    match envelope.guard {
        Some(guard) if !reader.truth(guard) => None,
        _ => Some(direction),
    }
}

/// The nearest of some unit vectors, ties to the horizontal; the normalised input if there are none.
fn nearest(input: [f64; 2], directions: &[[f64; 2]]) -> Direction {
    let mut best: Option<(f64, usize)> = None;
    for (index, direction) in directions.iter().enumerate() {
        let dot = input[0] * direction[0] + input[1] * direction[1];
        let better = best.is_none_or(|(score, other)| {
            dot > score || (dot == score && direction[0].abs() > directions[other][0].abs())
        });
        if better {
            best = Some((dot, index));
        }
    }
    match best {
        Some((_, index)) => Direction { vector: directions[index], number: index as u16 },
        None => {
            let turn = libm::atan2(input[1], input[0]) / std::f64::consts::TAU;
            let number = (turn.rem_euclid(1.0) * FINE_DIRECTIONS) as u16;
            Direction { vector: unit(input), number }
        }
    }
}

/// A vector by its components. A plain loop is compiled in place, unlike `std::array::from_fn`.
#[inline(always)]
fn vector<const N: usize>(component: impl Fn(usize) -> f64) -> [f64; N] {
    let mut all = [0.0; N];
    for (index, value) in all.iter_mut().enumerate() {
        *value = component(index);
    }
    all
}

/// The length of a vector; exact along the first axis.
#[inline]
fn length<const N: usize>(v: [f64; N]) -> f64 {
    let mut sum = 0.0;
    let mut is_along_axis = true;
    for (index, x) in v.iter().enumerate() {
        is_along_axis &= index == 0 || *x == 0.0;
        sum += x * x;
    }
    if is_along_axis { v[0].abs() } else { sum.sqrt() }
}

/// A vector of length 1, or 0.
#[inline]
fn unit<const N: usize>(v: [f64; N]) -> [f64; N] {
    match length(v) {
        0.0 => [0.0; N],
        // The quotient is 1 or -1, without a division.
        _ if N == 1 => vector(|i| v[i].signum()),
        length => vector(|i| v[i] / length),
    }
}

/// The controlled values before this step.
#[inline]
fn current<const N: usize>(reader: &Reader<'_>, envelope: &Envelope) -> [f64; N] {
    let layout = reader.own_layout();
    let value = |i: usize| envelope.vars.get(i).map_or(0.0, |&v| layout.moving_var(reader.state, v, envelope.degree));
    vector(value)
}

/// Moves from `current` towards `target` by at most the rate of a step, never past it.
#[inline]
fn approach<const N: usize>(
    reader: &Reader<'_>,
    current: [f64; N],
    target: [f64; N],
    rate: Option<ExprId>,
) -> [f64; N] {
    let Some(rate) = rate else { return target };
    let reach = reader.number(rate) * reader.sim.step;
    let offset = vector::<N>(|i| target[i] - current[i]);
    if length(offset) <= reach {
        return target;
    }
    let offset = unit(offset);
    vector(|i| current[i] + offset[i] * reach)
}

fn level(reader: &Reader<'_>, envelope: &Envelope) -> f64 {
    match envelope.release {
        Release::To { level, .. } => reader.number(level),
        Release::Hold => 0.0,
    }
}

/// Tolerance for comparing times, s: sums of times are rounded.
const ROUNDING: f64 = 1e-9;

/// An envelope by time: linear rise, hold, linear fall, constant level.
fn at_time(t: f64, [rise, hold, fall]: [f64; 3], level: f64, peak: f64) -> f64 {
    if t < rise - ROUNDING {
        return level + (peak - level) * (t / rise);
    }
    let t = t - rise;
    if t <= hold + ROUNDING {
        return peak;
    }
    let t = t - hold;
    if t < fall - ROUNDING { peak + (level - peak) * (t / fall) } else { level }
}

//! Flows and envelopes: continuous changes of variables.

use std::collections::BTreeMap;

use hypedc::ir::{Id, VarId};
use hypedc::sema::checked::{By, Drive, DriveBy, Envelope, Rate, Release, Term};

use super::evaluate::Code;
use super::model::{Fault, Oracle, State};
use super::step::{Frame, Passing};

impl Oracle<'_> {
    /// Applies the flows of all instances that are not spawned or destroyed in this step.
    pub fn flows(&self, start: &State, state: &mut State, frames: &[Frame], passing: &Passing) -> Result<(), Fault> {
        for slot in 0..start.things.len() {
            if start.things[slot].is_none() || !passing.acts(slot) {
                continue;
            }
            self.flow(start, state, slot, frames, passing)?;
            let thing = state.things[slot].as_mut().unwrap();
            thing.timers.values_mut().for_each(|count| *count += 1);
        }
        Ok(())
    }

    /// Applies the flows of one instance.
    fn flow(
        &self,
        start: &State,
        state: &mut State,
        slot: usize,
        frames: &[Frame],
        passing: &Passing,
    ) -> Result<(), Fault> {
        let (entity, dt) = (self.entity(slot), self.dt());
        let was = start.things[slot].as_ref().unwrap();
        let joint = passing.joint.get(&slot).map(|j| (&j.0, &j.1));
        let code = Code { joint, passing: Some(passing), ..self.played(start, slot, frames) };
        // From the outermost level to the innermost: inner flows replace outer ones.
        let mut drives: BTreeMap<VarId, &Drive> = entity.drives.iter().map(|d| (d.var, d)).collect();
        for mode in was.modes.iter().flatten() {
            drives.extend(entity.modes[*mode].drives.iter().map(|d| (d.var, d)));
        }
        // An envelope that an inner flow replaces has its peak all the same.
        let mut peaks = BTreeMap::new();
        let active = was.modes.iter().flatten().flat_map(|mode| &entity.modes[*mode].drives);
        for drive in entity.drives.iter().chain(active) {
            if let DriveBy::Envelope(id) = drive.by
                && let (_, Some(peak)) = self.envelope(&code, slot, id.0, &entity.envelopes[id])?
            {
                peaks.insert(id.0, peak);
            }
        }
        for var in entity.vars.ids() {
            let [mut x, mut v, mut a] = was.vars[var.index()];
            let clip = |degree: u8, mut value: f64| {
                for clamp in entity.clamps.iter().filter(|c| (c.var, c.degree) == (var, degree)) {
                    if let Some(low) = &clamp.low {
                        let low = code.value(low)?;
                        value = if value < low { low } else { value };
                    }
                    if let Some(high) = &clamp.high {
                        let high = code.value(high)?;
                        value = if value > high { high } else { value };
                    }
                }
                Ok::<f64, Fault>(value)
            };
            let given = match drives.get(&var) {
                None => None,
                Some(Drive { degree, by: DriveBy::Flow(term), .. }) => Some((*degree, code.value(term)?)),
                Some(Drive { degree, by: DriveBy::Envelope(id), .. }) => {
                    let component = entity.envelopes[*id].vars.iter().position(|v| *v == var).unwrap();
                    let (level, _) = self.envelope(&code, slot, id.0, &entity.envelopes[*id])?;
                    Some((*degree, level[component]))
                }
            };
            match given {
                Some((0, position)) => {
                    x = clip(0, position)?;
                    v = clip(1, 0.0)?;
                    a = 0.0;
                }
                other => {
                    match other {
                        Some((1, speed)) => {
                            v = speed;
                            a = 0.0;
                        }
                        Some((_, acceleration)) => {
                            a = acceleration;
                            v += a * dt;
                        }
                        None => v += a * dt,
                    }
                    v = clip(1, v)?;
                    x += v * dt;
                    x = clip(0, x)?;
                }
            }
            if ![x, v, a].iter().all(|n| n.is_finite()) {
                return Err(Fault::Diverged);
            }
            // Zero has no sign.
            state.things[slot].as_mut().unwrap().vars[var.index()] = [x + 0.0, v + 0.0, a + 0.0];
        }
        state.things[slot].as_mut().unwrap().peaks = peaks;
        Ok(())
    }

    /// The values that an envelope gives its variables, and the direction in which its peak is reached.
    fn envelope(
        &self,
        code: &Code<'_>,
        slot: usize,
        id: u32,
        e: &Envelope,
    ) -> Result<(Vec<f64>, Option<[i64; 2]>), Fault> {
        let dt = self.dt();
        let thing = code.state.things[slot].as_ref().unwrap();
        let now: Vec<f64> = e.vars.iter().map(|v| thing.vars[v.index()][usize::from(e.degree)]).collect();
        let optional = |term: &Option<Term>| term.as_ref().map(|t| code.value(t)).transpose();
        let sustain = code.value(&e.sustain)?;
        if let By::Clock(mode) = e.by {
            // Its value at the end of the step.
            let t = self.seconds(f64::from(thing.timers[&mode] + 1));
            let time = |rate: &Rate, way: f64| match rate {
                Rate::Instant => Ok(0.0),
                Rate::Over(time) => code.value(time),
                Rate::Accel(rate) => Ok(way.abs() / code.value(rate)?),
            };
            let Release::To(rate, level) = &e.release else { panic!("a fixed envelope is released") };
            let level = optional(level)?.unwrap_or(0.0);
            let rise = time(&e.attack, sustain - level)?;
            let hold = optional(&e.sustain_for)?.unwrap_or(0.0);
            let fall = time(rate, sustain - level)?;
            // Times that differ by less than a billionth of a second are the same.
            let value = if t < rise - 1e-9 {
                level + (sustain - level) * (t / rise)
            } else if t - rise <= hold + 1e-9 {
                sustain
            } else if t - rise - hold < fall - 1e-9 {
                sustain + (level - sustain) * ((t - rise - hold) / fall)
            } else {
                level
            };
            return Ok((vec![value], None));
        }
        let driven = match &e.driven_while {
            Some(guard) => code.holds(guard)?,
            None => true,
        };
        let axis = |a: &hypedc::ir::AxisId| code.keys.map_or(0.0, |(keys, _)| keys.axes[a.index()]);
        let (direction, way): (Vec<f64>, [i64; 2]) = match &e.by {
            By::Button(button) => {
                let held = code.keys.is_some_and(|(keys, _)| keys.held.contains(&button.0));
                (vec![if held { 1.0 } else { 0.0 }], [i64::from(held), 0])
            }
            By::Axis(a) => {
                let sign = if axis(a) > 0.0 {
                    1.0
                } else if axis(a) < 0.0 {
                    -1.0
                } else {
                    0.0
                };
                (vec![sign], [sign as i64, 0])
            }
            By::Axes(axes, ways) => nearest(axis(&axes[0]), axis(&axes[1]), *ways),
            By::Clock(_) => panic!("a fixed envelope has no direction"),
        };
        let is_driven = driven && direction.iter().any(|d| *d != 0.0);
        let rate = |rate: &Rate, way: f64| match rate {
            Rate::Instant => Ok(None),
            Rate::Accel(rate) => Ok(Some(code.value(rate)?)),
            Rate::Over(time) => Ok(Some(way.abs() / code.value(time)?)),
        };
        let peak = optional(&e.peak)?;
        let released = match &e.release {
            Release::To(_, Some(level)) => code.value(level)?,
            Release::To(_, None) | Release::Hold => 0.0,
        };
        if is_driven {
            let towards = |level: f64| direction.iter().map(|d| d * level).collect::<Vec<f64>>();
            let Some(peak) = peak else {
                return Ok((approach(&now, &towards(sustain), rate(&e.attack, sustain - released)?, dt), None));
            };
            if thing.peaks.get(&id) == Some(&way) {
                return Ok((approach(&now, &towards(sustain), rate(&e.decay, peak - sustain)?, dt), Some(way)));
            }
            let top = towards(peak);
            let next = approach(&now, &top, rate(&e.attack, peak - released)?, dt);
            let reached = (next == top).then_some(way);
            return Ok((next, reached));
        }
        match &e.release {
            Release::Hold => Ok((now, None)),
            Release::To(by, _) => {
                let length = length(&now);
                let target =
                    now.iter().map(|n| if length == 0.0 { 0.0 } else { n / length * released }).collect::<Vec<_>>();
                Ok((approach(&now, &target, rate(by, sustain - released)?, dt), None))
            }
        }
    }
}

/// The direction of two axes, to the nearest of some ways or as it is.
fn nearest(x: f64, y: f64, ways: Option<u32>) -> (Vec<f64>, [i64; 2]) {
    if x == 0.0 && y == 0.0 {
        return (vec![0.0, 0.0], [0, 0]);
    }
    let Some(ways) = ways else {
        let length = (x * x + y * y).sqrt();
        return (vec![x / length, y / length], [libm::atan2(y, x).to_bits() as i64, 1]);
    };
    // The unit vectors, mirrored from the first eighth of the turn; of several that are as near the most horizontal counts.
    let unit = |way: u32| {
        let part = f64::from(way) / f64::from(ways) * 4.0;
        let (quarter, rest) = (part.floor(), part - part.floor());
        let angle = |part: f64| part * std::f64::consts::FRAC_PI_2;
        let (sin, cos) = if rest == 0.5 {
            (std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2)
        } else if rest < 0.5 {
            (libm::sin(angle(rest)), libm::cos(angle(rest)))
        } else {
            (libm::cos(angle(1.0 - rest)), libm::sin(angle(1.0 - rest)))
        };
        match quarter as u32 {
            0 => [cos, sin],
            1 => [-sin, cos],
            2 => [-cos, -sin],
            _ => [sin, -cos],
        }
    };
    let along = |way: u32| x * unit(way)[0] + y * unit(way)[1];
    let mut best = 0;
    for way in 1..ways {
        let is_level = unit(way)[0].abs() > unit(best)[0].abs();
        if along(way) > along(best) || (along(way) == along(best) && is_level) {
            best = way;
        }
    }
    (unit(best).to_vec(), [1 + i64::from(best), 0])
}

fn length(of: &[f64]) -> f64 {
    match of {
        [x] | [x, 0.0] => x.abs(),
        _ => of.iter().map(|x| x * x).sum::<f64>().sqrt(),
    }
}

/// Moves a point towards another one at a maximum rate per second.
fn approach(from: &[f64], to: &[f64], rate: Option<f64>, dt: f64) -> Vec<f64> {
    let Some(rate) = rate else { return to.to_vec() };
    let most = rate * dt;
    let way: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
    let length = length(&way);
    if length <= most {
        return to.to_vec();
    }
    match (from, way.as_slice()) {
        ([from], [way]) => vec![if *way > 0.0 { from + most } else { from - most }],
        _ => from.iter().zip(&way).map(|(a, w)| a + w / length * most).collect(),
    }
}

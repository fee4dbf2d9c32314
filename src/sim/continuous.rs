//! The continuous phase: flows, envelopes, semi-implicit Euler, clamps, timers.
//!
//! All right-hand sides are evaluated before anything moves. Degree 2: `a = f; v += a·dt; p += v·dt`; degree 1: `a = 0;
//! v = f; p += v·dt`; degree 0: `p = f; v = a = 0`; no flow: the last acceleration is kept.

use std::cell::Cell;

use crate::ir::{Clamp, Drive, Entity, Extremes, Id, VarId};

use super::actor::{Actor, COAST, Flow, Plan, Range, Straight};
use super::chance::Frames;
use super::discrete::TakenEdge;
use super::envelope::{envelope_value, next_peak};
use super::evaluate::Reader;
use super::fault::{Fault, FaultKind};
use super::recall::Recall;
use super::simulator::{Scratch, Simulator};
use super::state::{leaf_at, one_zero, real, set_moved, set_triple, triple};

impl Simulator {
    /// Moves every live slot by one step, as far as it is not recalled; `STILL` as in [`Simulator::step_of`].
    #[inline(always)]
    pub(super) fn flow<const STILL: bool, R: Recall>(
        &self,
        state: &mut [u8],
        scratch: &mut Scratch,
        recall: &R,
    ) -> Result<(), Fault> {
        match &self.still {
            Some(still) if STILL => {
                self.count_still_timers(state);
                self.flow_of(still.moving.iter().map(|slot| &self.actors[*slot as usize]), state, scratch)
            }
            _ if R::IS_ANY => {
                self.flow_of(recall.awake().iter().map(|slot| &self.actors[*slot as usize]), state, scratch)
            }
            _ => self.flow_of(self.actors.iter(), state, scratch),
        }
    }

    /// Moves some slots by one step, as far as there are instances.
    #[inline(always)]
    fn flow_of<'a>(
        &'a self,
        actors: impl Iterator<Item = &'a Actor> + Clone,
        state: &mut [u8],
        scratch: &mut Scratch,
    ) -> Result<(), Fault> {
        let Scratch { frames, flows, clamps, peaks, taken, start, .. } = scratch;
        let fault = Cell::new(None);
        for actor in actors.clone() {
            if !actor.layout.acts(state) {
                continue;
            }
            let steady = steady_plan(state, actor);
            if steady.is_none() {
                self.read_flows(state, actor, frames, taken, &mut flows[actor.vars.clone()], &fault);
            }
            if actor.is_bounded {
                self.read_bounds(state, actor, frames, clamps, peaks, &fault);
            }
            // If no instance reads another, each can move at once.
            if self.moves_independently {
                self.move_by(state, actor, (steady, flows), clamps, peaks, start)?;
            }
        }
        Self::check_fault(&fault)?;
        if !self.moves_independently {
            for actor in actors {
                if actor.layout.acts(state) {
                    self.move_by(state, actor, (steady_plan(state, actor), flows), clamps, peaks, start)?;
                }
            }
        }
        Ok(())
    }

    /// Evaluates the drives of all variables.
    #[inline(always)]
    fn read_flows(
        &self,
        state: &[u8],
        actor: &Actor,
        frames: &Frames,
        taken: &[Option<TakenEdge>],
        own: &mut [Flow],
        fault: &Cell<Option<Fault>>,
    ) {
        let taken = if actor.code.is_joint { &taken[actor.groups.clone()] } else { &[] };
        let reader = self.reader(actor, state, frames, taken, fault);
        for drive in &actor.code.free {
            read_drive(&reader, &actor.entity, *drive, own);
        }
        for group in actor.group_ids() {
            let plan = &actor.code.plans[actor.layout.leaf(state, group)];
            for &(var, flow) in &plan.steady {
                own[var] = flow;
            }
            for drive in &plan.drives {
                read_drive(&reader, &actor.entity, *drive, own);
            }
        }
    }

    /// Evaluates the bounds of clamps, and which envelopes reach their peak.
    fn read_bounds(
        &self,
        state: &[u8],
        actor: &Actor,
        frames: &Frames,
        clamps: &mut [(f64, f64)],
        peaks: &mut [u16],
        fault: &Cell<Option<Fault>>,
    ) {
        let reader = self.reader(actor, state, frames, &[], fault);
        let own = &mut clamps[actor.clamps.clone()];
        for (index, clamp) in actor.entity.clamps.iter().enumerate() {
            own[index] = (
                clamp.low.map_or(f64::NEG_INFINITY, |low| reader.number(low)),
                clamp.high.map_or(f64::INFINITY, |high| reader.number(high)),
            );
        }
        let own = &mut peaks[actor.envelopes.clone()];
        for (id, envelope) in actor.entity.envelopes.pairs() {
            if envelope.peak.is_some() {
                own[id.index()] = next_peak(&reader, &actor.entity, envelope);
            }
        }
    }

    /// Integrates the variables of an instance by constant flows.
    #[inline(always)]
    fn move_straight(&self, actor: &Actor, straight: &[Straight], values: &mut [[u8; 24]]) -> Result<(), Fault> {
        let mut sum = 0.0;
        if let Some(limits) = &actor.code.limits {
            for ((values, flow), limits) in values.iter_mut().zip(straight).zip(limits) {
                let clip = |value, degree: usize| within(limits[degree], value);
                let moved = moved_straight(triple(values), flow, self.step, clip);
                sum += total(moved);
                set_moved(values, moved);
            }
        } else {
            let mut step = |values: &mut [u8; 24], flow: &Straight| {
                let moved = moved_straight(triple(values), flow, self.step, |value, _| value);
                // Without clamps, a velocity or an acceleration that is not finite makes the position not finite.
                sum += moved[0];
                set_moved(values, moved);
            };
            // Most instances have no other variables than their position.
            if let ([x, y], [of_x, of_y]) = (&mut *values, straight) {
                step(x, of_x);
                step(y, of_y);
            } else {
                values.iter_mut().zip(straight).for_each(|(values, flow)| step(values, flow));
            }
        }
        if f64::is_finite(sum) { Ok(()) } else { diverged(actor, values) }
    }

    /// Integrates an instance with the evaluated values.
    #[inline(always)]
    fn move_by(
        &self,
        state: &mut [u8],
        actor: &Actor,
        (steady, read): (Option<&Plan>, &[Flow]),
        clamps: &[(f64, f64)],
        peaks: &[u16],
        start: &mut [(f64, f64)],
    ) -> Result<(), Fault> {
        let layout = &actor.layout;
        if let Some(plan @ Plan { straight: Some(straight), .. }) = steady {
            let values = layout.triples_mut(state, straight.len());
            note_start(actor, values, start);
            if !(plan.rests && values.iter().all(is_still)) {
                self.move_straight(actor, straight, values)?;
            }
            if !plan.timers.is_empty() {
                self.count_timers(state, actor);
            }
            return Ok(());
        }
        let flows = match steady {
            Some(plan) => &*plan.row,
            None => &read[actor.vars.clone()],
        };
        let values = layout.triples_mut(state, flows.len());
        note_start(actor, values, start);
        let mut sum = 0.0;
        if actor.is_bounded {
            let (all, bounds) = (&actor.entity.clamps, &clamps[actor.clamps.clone()]);
            for (index, values) in values.iter_mut().enumerate() {
                let clip = |v, degree| clip(all, bounds, VarId::from_index(index), degree, v);
                let moved = moved(triple(values), flows[index], self.step, clip);
                sum += total(moved);
                set_triple(values, moved);
            }
        } else if let Some(limits) = &actor.code.limits {
            for (index, values) in values.iter_mut().enumerate() {
                let clip = |v, degree: u8| within(limits[index][usize::from(degree)], v);
                let moved = moved(triple(values), flows[index], self.step, clip);
                sum += total(moved);
                set_moved(values, moved);
            }
        } else {
            for (index, values) in values.iter_mut().enumerate() {
                let moved = moved(triple(values), flows[index], self.step, |v, _| v);
                sum += total(moved);
                set_moved(values, moved);
            }
        }
        // A value that is not finite makes the sum not finite; a sum of finite numbers may overflow, too.
        if !f64::is_finite(sum) {
            diverged(actor, values)?;
        }
        if !actor.timer_limits.is_empty() {
            self.count_timers(state, actor);
        }
        if actor.is_bounded {
            let own = &peaks[actor.envelopes.clone()];
            for (id, envelope) in actor.entity.envelopes.pairs() {
                if envelope.peak.is_some() {
                    layout.set_peak(state, id, own[id.index()]);
                }
            }
        }
        Ok(())
    }
}

/// Whether a variable has neither velocity nor acceleration.
#[inline(always)]
fn is_still(values: &[u8; 24]) -> bool {
    let [_, velocity, acceleration] = triple(values);
    velocity.to_bits() | acceleration.to_bits() == 0
}

/// The plan of an instance with a single group, if it gives all flows.
#[inline]
fn steady_plan<'a>(state: &[u8], actor: &'a Actor) -> Option<&'a Plan> {
    let code = &*actor.code;
    if !code.is_single {
        return None;
    }
    Some(&code.plans[leaf_at(state, actor.leaf_at)]).filter(|plan| plan.is_steady)
}

/// Stores the position before anything moves.
#[inline(always)]
fn note_start(actor: &Actor, values: &[[u8; 24]], start: &mut [(f64, f64)]) {
    if let [x, y, ..] = values {
        start[actor.index()] = (real(x, 0), real(y, 0));
    }
}

/// The nearest value of a range.
#[inline(always)]
fn within((low, high): Range, value: f64) -> f64 {
    // Compared by hand: `max` and `min` of a float take thrice as many instructions, for NaN.
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}

/// A variable after a step of a constant flow; `clip` clamps a value of a degree.
#[inline(always)]
fn moved_straight(
    [position, velocity, acceleration]: [f64; 3],
    flow: &Straight,
    dt: f64,
    clip: impl Fn(f64, usize) -> f64,
) -> [f64; 3] {
    let acceleration = acceleration * flow.keeps[0] + flow.adds[0];
    let velocity = clip(velocity * flow.keeps[1] + (acceleration * dt + flow.adds[1]), 1);
    [clip(position + velocity * dt, 0), velocity, acceleration]
}

/// A variable after a step; `clip` clamps a value of a degree.
#[inline(always)]
fn moved(
    [position, velocity, acceleration]: [f64; 3],
    (degree, value): Flow,
    dt: f64,
    clip: impl Fn(f64, u8) -> f64,
) -> [f64; 3] {
    let (velocity, acceleration) = match degree {
        0 => return [clip(value, 0), clip(0.0, 1), 0.0],
        1 => (value, 0.0),
        2 => (velocity + value * dt, value),
        _ => (velocity + acceleration * dt, acceleration),
    };
    let velocity = clip(velocity, 1);
    [clip(position + velocity * dt, 0), velocity, acceleration]
}

/// The sum of a variable and its derivatives, which is finite only if all of them are.
#[inline(always)]
fn total([position, velocity, acceleration]: [f64; 3]) -> f64 {
    position + velocity + acceleration
}

/// Fails with the first variable or derivative that is not finite, if any.
#[cold]
fn diverged(actor: &Actor, values: &[[u8; 24]]) -> Result<(), Fault> {
    for (var, values) in (0..).map(VarId).zip(values) {
        if let Some(degree) = triple(values).iter().position(|v| !v.is_finite()) {
            return Err(Fault { slot: actor.id, kind: FaultKind::Diverged(var, degree as u8) });
        }
    }
    Ok(())
}

/// A value within all clamps of its variable.
fn clip(clamps: &[Clamp], bounds: &[(f64, f64)], var: VarId, degree: u8, value: f64) -> f64 {
    let mut value = value;
    for (index, clamp) in clamps.iter().enumerate() {
        if clamp.var == var && clamp.degree == degree {
            let (low, high) = bounds[index];
            value = value.greatest(low).least(high);
        }
    }
    value
}

/// Stores the value of a drive for its variable.
#[inline(always)]
fn read_drive(reader: &Reader<'_>, entity: &Entity, drive: Drive, own: &mut [Flow]) {
    match drive {
        Drive::Coast(var) => own[var.index()] = COAST,
        Drive::Flow { var, degree, value } => own[var.index()] = (degree, one_zero(reader.number(value))),
        Drive::Envelope(id, component) => {
            let envelope = &entity.envelopes[id];
            let component = usize::from(component);
            let value = envelope_value(reader, id, envelope, component);
            own[envelope.vars[component].index()] = (envelope.degree, one_zero(value));
        }
    }
}

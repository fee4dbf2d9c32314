//! The continuous phase: flows, envelopes, semi-implicit Euler, clamps, timers.
//!
//! All right sides are read before anything moves. Degree 2: `a = f; v += a·dt; p += v·dt`; degree 1: `a = 0;
//! v = f; p += v·dt`; degree 0: `p = f; v = a = 0`; no flow: the last acceleration stays in force.

use std::cell::Cell;

use crate::ir::{Clamp, Drive, Entity, Id, VarId};

use super::actor::{Actor, COAST, Flow};
use super::discrete::Taken;
use super::envelope::{envelope_value, next_peak};
use super::evaluate::Reader;
use super::fault::Fault;
use super::input::Frame;
use super::simulator::{Scratch, Simulator};
use super::state::{set_triple, triple};

impl Simulator<'_> {
    /// Moves every live slot by one step.
    pub(super) fn flow(&self, state: &mut [u8], scratch: &mut Scratch) -> Result<(), Fault> {
        let Scratch { frames, flows, clamps, peaks, taken, start, .. } = scratch;
        let fault = Cell::new(None);
        for actor in &self.actors {
            if !actor.layout.acts(state) {
                continue;
            }
            let own = &mut flows[actor.vars.clone()];
            self.read_flows(state, actor, frames, taken, own, &fault);
            if actor.is_bounded {
                self.read_bounds(state, actor, frames, clamps, peaks, &fault);
            }
            // Where nobody reads anybody else, each can move at once.
            if self.is_private {
                self.move_by(state, actor, own, clamps, peaks, start)?;
            }
        }
        Self::settle(&fault)?;
        if !self.is_private {
            for actor in &self.actors {
                if actor.layout.acts(state) {
                    self.move_by(state, actor, &flows[actor.vars.clone()], clamps, peaks, start)?;
                }
            }
        }
        Ok(())
    }

    /// Reads what drives each variable.
    #[inline(always)]
    fn read_flows(
        &self,
        state: &[u8],
        actor: &Actor<'_>,
        frames: &[Frame],
        taken: &[Option<Taken>],
        own: &mut [Flow],
        fault: &Cell<Option<Fault>>,
    ) {
        let taken = if actor.code.is_joint { &taken[actor.groups.clone()] } else { &[] };
        let reader = self.reader(actor, state, frames, taken, fault);
        for drive in &actor.code.free {
            read_drive(&reader, actor.entity, *drive, own);
        }
        for group in actor.entity.groups.ids() {
            let plan = &actor.code.plans[actor.layout.leaf(state, group)];
            for &(var, flow) in &plan.steady {
                own[var] = flow;
            }
            for drive in &plan.drives {
                read_drive(&reader, actor.entity, *drive, own);
            }
        }
    }

    /// Reads the bounds of clamps, and which envelopes reach their peak.
    fn read_bounds(
        &self,
        state: &[u8],
        actor: &Actor<'_>,
        frames: &[Frame],
        clamps: &mut [(f64, f64)],
        peaks: &mut [u16],
        fault: &Cell<Option<Fault>>,
    ) {
        let reader = self.reader(actor, state, frames, &[], fault);
        for (clamp, bounds) in actor.entity.clamps.iter().zip(&mut clamps[actor.clamps.clone()]) {
            *bounds = (
                clamp.low.map_or(f64::NEG_INFINITY, |low| reader.number(low)),
                clamp.high.map_or(f64::INFINITY, |high| reader.number(high)),
            );
        }
        for (envelope, peak) in actor.entity.envelopes.iter().zip(&mut peaks[actor.envelopes.clone()]) {
            if envelope.peak.is_some() {
                *peak = next_peak(&reader, actor.entity, envelope);
            }
        }
    }

    /// Moves an instance by what was read.
    #[inline(always)]
    fn move_by(
        &self,
        state: &mut [u8],
        actor: &Actor<'_>,
        flows: &[Flow],
        clamps: &[(f64, f64)],
        peaks: &[u16],
        start: &mut [(f64, f64)],
    ) -> Result<(), Fault> {
        let layout = &actor.layout;
        let values = layout.triples_mut(state, flows.len());
        start[actor.index()] = (triple(&values[0])[0], triple(&values[1])[0]);
        let bounds = if actor.is_bounded { &clamps[actor.clamps.clone()] } else { &[] };
        for ((var, values), &flow) in (0u32..).map(VarId).zip(values).zip(flows) {
            self.integrate(values, actor, var, flow, bounds)?;
        }
        if !actor.entity.timers.is_empty() {
            self.count_timers(state, actor);
        }
        if actor.is_bounded {
            for ((id, envelope), peak) in actor.entity.envelopes.pairs().zip(&peaks[actor.envelopes.clone()]) {
                if envelope.peak.is_some() {
                    layout.set_peak(state, id, *peak);
                }
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn integrate(
        &self,
        values: &mut [u8; 24],
        actor: &Actor<'_>,
        var: VarId,
        (degree, value): Flow,
        bounds: &[(f64, f64)],
    ) -> Result<(), Fault> {
        let dt = self.step;
        let clip = |value: f64, degree: u8| {
            if bounds.is_empty() { value } else { clip(&actor.entity.clamps, bounds, var, degree, value) }
        };
        let [position, velocity, acceleration] = triple(values);
        if degree == 0 {
            set_triple(values, [clip(value, 0), clip(0.0, 1), 0.0]);
            return Ok(());
        }
        let (velocity, acceleration) = match degree {
            1 => (value, 0.0),
            2 => (velocity + value * dt, value),
            _ => (velocity + acceleration * dt, acceleration),
        };
        let velocity = clip(velocity, 1);
        let position = clip(position + velocity * dt, 0);
        set_triple(values, [position, velocity, acceleration]);
        Self::finite(actor.id, var, position)
    }
}

/// A value within all clamps of its variable.
fn clip(clamps: &[Clamp], bounds: &[(f64, f64)], var: VarId, degree: u8, value: f64) -> f64 {
    let own = clamps.iter().zip(bounds).filter(|(c, _)| c.var == var && c.degree == degree);
    own.fold(value, |value, (_, &(low, high))| value.max(low).min(high))
}

/// Notes the value of a drive where its variable will find it.
#[inline(always)]
fn read_drive(reader: &Reader<'_>, entity: &Entity, drive: Drive, own: &mut [Flow]) {
    match drive {
        Drive::Coast(var) => own[var.index()] = COAST,
        Drive::Flow { var, degree, value } => own[var.index()] = (degree, reader.number(value)),
        Drive::Envelope(id, component) => {
            let envelope = &entity.envelopes[id];
            let component = usize::from(component);
            let value = envelope_value(reader, id, envelope, component);
            own[envelope.vars[component].index()] = (envelope.degree, value);
        }
    }
}

//! The continuous phase: flows, envelopes, semi-implicit Euler, clamps, timers.
//!
//! All right sides are read before anything moves. Degree 2: `a = f; v += a·dt; p += v·dt`; degree 1: `a = 0;
//! v = f; p += v·dt`; degree 0: `p = f; v = a = 0`; no flow: the last acceleration stays in force.

use std::cell::Cell;

use crate::ir::{Clamp, Drive, Entity, Id, VarId};

use super::actor::{Actor, COAST, Flow};
use super::envelope::{envelope_value, next_peak};
use super::evaluate::Reader;
use super::fault::Fault;
use super::simulator::{Scratch, Simulator};
use super::state::{set_triple, triple};

impl Simulator<'_> {
    /// Moves every live slot by one step.
    pub(super) fn flow(&self, state: &mut [u8], scratch: &mut Scratch) -> Result<(), Fault> {
        let Scratch { frames, flows, clamps, peaks, taken, start, .. } = scratch;
        let fault = Cell::new(None);
        let mut reader = Reader { frames, ..self.onlooker(state, &fault) };
        for actor in &self.actors {
            let Actor { entity, layout, code, .. } = actor;
            if !layout.acts(state) {
                continue;
            }
            let own = &mut flows[actor.var_range()];
            reader.turn_to(actor);
            // Other code does not read it.
            if code.is_joint {
                reader.taken = &taken[actor.group_range()];
            }
            for drive in &code.free {
                read_drive(&reader, entity, *drive, own);
            }
            for group in entity.groups.ids() {
                let plan = &code.plans[layout.leaf(state, group)];
                for &(var, flow) in &plan.steady {
                    own[var] = flow;
                }
                for drive in &plan.drives {
                    read_drive(&reader, entity, *drive, own);
                }
            }
            if !actor.is_bounded {
                continue;
            }
            for (clamp, bounds) in entity.clamps.iter().zip(&mut clamps[actor.clamp_range()]) {
                *bounds = (
                    clamp.low.map_or(f64::NEG_INFINITY, |low| reader.number(low)),
                    clamp.high.map_or(f64::INFINITY, |high| reader.number(high)),
                );
            }
            for (envelope, peak) in entity.envelopes.iter().zip(&mut peaks[actor.envelope_range()]) {
                if envelope.peak.is_some() {
                    *peak = next_peak(&reader, entity, envelope);
                }
            }
        }
        Self::settle(&fault)?;
        for actor in &self.actors {
            let Actor { entity, layout, .. } = actor;
            if !layout.acts(state) {
                continue;
            }
            let bounds = &clamps[actor.clamp_range()];
            let flows = &flows[actor.var_range()];
            let values = layout.triples_mut(state, flows.len());
            start[actor.index()] = (triple(&values[0])[0], triple(&values[1])[0]);
            for ((var, values), &flow) in (0u32..).map(VarId).zip(values).zip(flows) {
                self.integrate(values, actor, var, flow, bounds)?;
            }
            self.count_timers(state, actor);
            if !actor.is_bounded {
                continue;
            }
            for ((id, envelope), peak) in entity.envelopes.pairs().zip(&peaks[actor.envelope_range()]) {
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

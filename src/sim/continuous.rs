//! The continuous phase: flows, envelopes, semi-implicit Euler, clamps, timers.
//!
//! All right sides are read before anything moves. Degree 2: `a = f; v += a·dt; p += v·dt`; degree 1: `a = 0;
//! v = f; p += v·dt`; degree 0: `p = f; v = a = 0`; no flow: the last acceleration stays in force.

use std::cell::Cell;

use crate::ir::{Clamp, Drive, Entity, Id, SlotId, VarId};

use super::envelope::{envelope_value, next_peak};
use super::evaluate::Reader;
use super::fault::Fault;
use super::simulator::{Scratch, Simulator};

/// The degree that stands for "no flow".
const COAST: u8 = 3;

impl Simulator<'_> {
    /// Moves every live slot by one step.
    pub(super) fn flow(&self, state: &mut [u8], scratch: &mut Scratch) -> Result<(), Fault> {
        let Scratch { frames, flows, clamps, peaks, taken, .. } = scratch;
        let fault = Cell::new(None);
        let (mut base, mut clamp_base, mut peak_base) = (0, 0, 0);
        for me in self.world().slots.ids() {
            let entity = self.entity(me);
            let own = &mut flows[base..base + entity.vars.len()];
            let own_clamps = &mut clamps[clamp_base..clamp_base + entity.clamps.len()];
            let own_peaks = &mut peaks[peak_base..peak_base + entity.envelopes.len()];
            base += own.len();
            clamp_base += own_clamps.len();
            peak_base += own_peaks.len();
            let layout = self.layout(me);
            if !layout.acts(state) {
                continue;
            }
            let first = self.groups[me.index()];
            let taken = &taken[first..first + entity.groups.len()];
            let reader = Reader { sim: self, state, frames, taken, fault: &fault, me };
            for drive in &entity.free {
                read_drive(&reader, entity, *drive, own);
            }
            for group in entity.groups.ids() {
                for drive in &entity.leaves[layout.leaf(state, group)].drives {
                    read_drive(&reader, entity, *drive, own);
                }
            }
            for (clamp, bounds) in entity.clamps.iter().zip(own_clamps) {
                *bounds = (
                    clamp.low.map_or(f64::NEG_INFINITY, |low| reader.number(low)),
                    clamp.high.map_or(f64::INFINITY, |high| reader.number(high)),
                );
            }
            for (envelope, peak) in entity.envelopes.iter().zip(own_peaks) {
                if envelope.peak.is_some() {
                    *peak = next_peak(&reader, entity, envelope);
                }
            }
        }
        Self::settle(&fault)?;
        (base, clamp_base, peak_base) = (0, 0, 0);
        for me in self.world().slots.ids() {
            let entity = self.entity(me);
            let own = &flows[base..base + entity.vars.len()];
            let bounds = &clamps[clamp_base..clamp_base + entity.clamps.len()];
            let own_peaks = &peaks[peak_base..peak_base + entity.envelopes.len()];
            base += own.len();
            clamp_base += bounds.len();
            peak_base += own_peaks.len();
            let layout = self.layout(me);
            if !layout.acts(state) {
                continue;
            }
            for (var, &flow) in (0u32..).map(VarId).zip(own) {
                self.integrate(state, me, var, flow, (entity, bounds))?;
            }
            for ((id, envelope), peak) in entity.envelopes.pairs().zip(own_peaks) {
                if envelope.peak.is_some() {
                    layout.set_peak(state, id, *peak);
                }
            }
            self.count_timers(state, me);
        }
        Ok(())
    }

    fn integrate(
        &self,
        state: &mut [u8],
        me: SlotId,
        var: VarId,
        (degree, value): (u8, f64),
        (entity, bounds): (&Entity, &[(f64, f64)]),
    ) -> Result<(), Fault> {
        let layout = self.layout(me);
        let dt = self.step;
        let clip = |value: f64, degree: u8| clip(&entity.clamps, bounds, var, degree, value);
        if degree == 0 {
            layout.set_var(state, var, 0, clip(value, 0));
            layout.set_var(state, var, 1, clip(0.0, 1));
            layout.set_var(state, var, 2, 0.0);
            return Ok(());
        }
        let velocity = if degree == 1 {
            layout.set_var(state, var, 2, 0.0);
            value
        } else {
            let acceleration = if degree == 2 { value } else { layout.var(state, var, 2) };
            layout.set_var(state, var, 2, acceleration);
            layout.var(state, var, 1) + acceleration * dt
        };
        let velocity = clip(velocity, 1);
        let position = clip(layout.var(state, var, 0) + velocity * dt, 0);
        layout.set_var(state, var, 1, velocity);
        layout.set_var(state, var, 0, position);
        Self::finite(me, var, position)
    }
}

/// A value within all clamps of its variable.
fn clip(clamps: &[Clamp], bounds: &[(f64, f64)], var: VarId, degree: u8, value: f64) -> f64 {
    let own = clamps.iter().zip(bounds).filter(|(c, _)| c.var == var && c.degree == degree);
    own.fold(value, |value, (_, &(low, high))| value.max(low).min(high))
}

/// Notes the value of a drive where its variable will find it.
fn read_drive(reader: &Reader<'_>, entity: &Entity, drive: Drive, own: &mut [(u8, f64)]) {
    match drive {
        Drive::Coast(var) => own[var.index()] = (COAST, 0.0),
        Drive::Flow { var, degree, value } => own[var.index()] = (degree, reader.number(value)),
        Drive::Envelope(id, component) => {
            let envelope = &entity.envelopes[id];
            let component = usize::from(component);
            let value = envelope_value(reader, id, envelope, component);
            own[envelope.vars[component].index()] = (envelope.degree, value);
        }
    }
}

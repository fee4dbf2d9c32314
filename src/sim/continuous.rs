//! The continuous phase: flows, envelopes, semi-implicit Euler, timers.
//!
//! All right sides are read before anything moves. Degree 2: `a = f; v += a·dt; p += v·dt`; degree 1: `a = 0;
//! v = f; p += v·dt`; degree 0: `p = f; v = a = 0`; no flow: the last acceleration stays in force.

use std::cell::Cell;

use crate::ir::{Drive, Envelope, Release, SlotId, VarId};

use super::evaluate::Reader;
use super::fault::Fault;
use super::simulator::{Scratch, Simulator};

/// The degree that stands for "no flow".
const COAST: u8 = 3;

impl Simulator<'_> {
    /// Moves every live slot by one step.
    pub(super) fn flow(&self, state: &mut [u8], scratch: &mut Scratch) -> Result<(), Fault> {
        let Scratch { frames, flows, .. } = scratch;
        let fault = Cell::new(None);
        let mut base = 0;
        for me in self.world().slots.ids() {
            let entity = self.entity(me);
            let own = &mut flows[base..base + entity.vars.len()];
            base += own.len();
            let layout = self.layout(me);
            if !layout.alive(state) {
                continue;
            }
            let reader = Reader { sim: self, state, frames, fault: &fault, me };
            for drive in &entity.free {
                read_drive(&reader, *drive, own);
            }
            for group in entity.groups.ids() {
                for drive in &entity.leaves[layout.leaf(state, group)].drives {
                    read_drive(&reader, *drive, own);
                }
            }
        }
        Self::settle(&fault)?;
        base = 0;
        for me in self.world().slots.ids() {
            let count = self.entity(me).vars.len();
            let own = &flows[base..base + count];
            base += count;
            if self.layout(me).alive(state) {
                for (var, &(degree, value)) in (0u32..).map(VarId).zip(own) {
                    self.integrate(state, me, var, degree, value)?;
                }
                self.count_timers(state, me);
            }
        }
        Ok(())
    }

    fn integrate(&self, state: &mut [u8], me: SlotId, var: VarId, degree: u8, value: f64) -> Result<(), Fault> {
        let layout = self.layout(me);
        let dt = self.step;
        if degree == 0 {
            layout.set_var(state, var, 0, value);
            layout.set_var(state, var, 1, 0.0);
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
        let position = layout.var(state, var, 0) + velocity * dt;
        layout.set_var(state, var, 1, velocity);
        layout.set_var(state, var, 0, position);
        Self::finite(me, var, position)
    }
}

/// Notes the value of a drive where its variable will find it.
fn read_drive(reader: &Reader<'_>, drive: Drive, own: &mut [(u8, f64)]) {
    use crate::ir::Id;
    match drive {
        Drive::Coast(var) => own[var.index()] = (COAST, 0.0),
        Drive::Flow { var, degree, value } => own[var.index()] = (degree, reader.number(value)),
        Drive::Envelope(id) => {
            let entity = reader.sim.entity(reader.me);
            let envelope = &entity.envelopes[id];
            own[envelope.var.index()] = (envelope.degree, envelope_value(reader, envelope));
        }
    }
}

/// Where an envelope takes its variable in this step (attack, sustain and release after Swink, *Game Feel*, 2009).
fn envelope_value(reader: &Reader<'_>, envelope: &Envelope) -> f64 {
    let current = reader.sim.layout(reader.me).var(reader.state, envelope.var, envelope.degree);
    let axis = reader.axis(envelope.axis);
    let driven = axis != 0.0 && envelope.guard.is_none_or(|g| reader.truth(g));
    let approach = |target: f64, rate: Option<crate::ir::ExprId>| match rate {
        None => target,
        Some(rate) => {
            let reach = reader.number(rate) * reader.sim.step;
            let way = target - current;
            if way.abs() <= reach { target } else { current + reach.copysign(way) }
        }
    };
    if driven {
        return approach(axis.signum() * reader.number(envelope.sustain), envelope.attack);
    }
    match envelope.release {
        Release::Hold => current,
        Release::To { rate, level } => {
            let direction = if current == 0.0 { 0.0 } else { current.signum() };
            approach(direction * reader.number(level), rate)
        }
    }
}

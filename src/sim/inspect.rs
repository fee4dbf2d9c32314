//! Looks into a state for people: the colliders that are there, and expressions as a step with some input reads them.
//! Nothing of it is part of a step.

use std::cell::Cell;

use crate::ir::{Bounds, ColliderId, ExprId, RefValue, SlotId, TileId};

use super::chance::Frames;
use super::fault::Fault;
use super::input::{Frame, Input};
use super::instance::Instance;
use super::simulator::Simulator;
use super::state::buttons;

impl<'a> Instance<'a> {
    /// The colliders that are there, with their bounding boxes relative to the position, px. A collider whose shape
    /// cannot be computed is left out.
    pub fn colliders(self) -> impl Iterator<Item = (ColliderId, Bounds)> {
        let colliders = self.is_alive().then(|| self.entity().colliders.pairs()).into_iter().flatten();
        colliders.filter_map(move |(id, collider)| {
            let fault = Cell::new(None);
            let reader = self.sim().own_reader(self.bytes(), self.slot(), Frames::NONE, &fault);
            let is_there = collider.guard.is_none_or(|guard| reader.truth(guard));
            let sides = collider.shape.sides(|number| Some(reader.number(number)))?;
            (is_there && fault.get().is_none()).then(|| (id, Bounds::new(sides)))
        })
    }
}

impl Simulator {
    /// The buttons that a state keeps of the last step: those whose presses or releases something reads.
    pub fn remembered_buttons(&self) -> u64 {
        self.remembered
    }

    /// An expression of the entity of a living instance that reads neither inputs nor what nature draws, as a number;
    /// truth is 1. Whether modes of other groups are entered or left in the step is not known: they count as staying.
    ///
    /// # Errors
    /// A [`Fault`] if the expression breaks a rule.
    pub fn own_number(&self, state: &[u8], slot: SlotId, expression: ExprId) -> Result<f64, Fault> {
        let fault = Cell::new(None);
        let value = self.own_reader(state, slot, Frames::NONE, &fault).number(expression);
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(value),
        }
    }
}

/// What a step reads: a state and the input of the step.
pub struct Inspection<'a> {
    sim: &'a Simulator,
    state: &'a [u8],
    frames: Frames,
}

impl<'a> Inspection<'a> {
    /// Of the step from a state with an input.
    pub fn new(sim: &'a Simulator, state: &'a [u8], input: &Input) -> Self {
        let mut frames = Frames::new(sim.world().players.len(), sim.draws().len());
        for (frame, (player, &at)) in frames.players.iter_mut().zip(sim.world().layout.players.pairs()) {
            *frame = Frame::new(input.of(player), buttons(state, at));
        }
        sim.lay(&input.1, &mut frames);
        Inspection { sim, state, frames }
    }

    /// What a value of a living instance stands for, as an action reads it: an instance, or a tile that breaks.
    pub fn target(&self, slot: SlotId, value: RefValue) -> (Option<SlotId>, Option<TileId>) {
        let fault = Cell::new(None);
        let reader = self.sim.own_reader(self.state, slot, &self.frames, &fault);
        let found = reader.reference(value);
        (found, if found.is_none() { reader.tile(value) } else { None })
    }

    /// An expression of the entity of a living instance, as a guard reads it; truth is 1. Whether modes of other groups
    /// are entered or left in the step is not known here: they count as staying.
    ///
    /// # Errors
    /// A [`Fault`] if the expression breaks a rule.
    pub fn value(&self, slot: SlotId, expression: ExprId) -> Result<f64, Fault> {
        let fault = Cell::new(None);
        let value = self.sim.own_reader(self.state, slot, &self.frames, &fault).number(expression);
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(value),
        }
    }
}

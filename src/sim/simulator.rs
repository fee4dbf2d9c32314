//! The simulator of one world: what is prepared once, and the order of the phases.

use std::cell::Cell;

use crate::ir::{Entity, ExprId, GoalId, Id, NeverId, Program, SlotId, SlotLayout, SpaceId, VarId, World, WorldId};

use super::collision::Collision;
use super::evaluate::Reader;
use super::fault::{Fault, FaultKind};
use super::input::{Frame, Input};
use super::state::{buttons, set_buttons};

/// Simulates one world of a program.
pub struct Simulator<'p> {
    program: &'p Program,
    world: &'p World,
    id: WorldId,
    pub(super) step: f64,
    pub(super) collision: Collision,
}

/// The working memory of a step; made once, reused by every step.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// The state as the step began.
    pub(super) before: Vec<u8>,
    /// Each player's input with what changed.
    pub(super) frames: Vec<Frame>,
    /// What drives each variable of each slot: the degree (3: nothing) and the value.
    pub(super) flows: Vec<(u8, f64)>,
    /// What the collision phase needs.
    pub(super) collision: super::collision::Scratch,
}

impl<'p> Simulator<'p> {
    /// Prepares a world.
    pub fn new(program: &'p Program, id: WorldId) -> Self {
        let world = &program.worlds[id];
        let collision = Collision::new(program, world);
        Simulator { program, world, id, step: world.step.seconds(), collision }
    }

    /// The program.
    pub fn program(&self) -> &'p Program {
        self.program
    }

    /// The world.
    pub fn world(&self) -> &'p World {
        self.world
    }

    /// The world's id.
    pub fn world_id(&self) -> WorldId {
        self.id
    }

    pub(super) fn entity(&self, slot: SlotId) -> &'p Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    pub(super) fn layout(&self, slot: SlotId) -> &'p SlotLayout {
        &self.world.layout.slots[slot]
    }

    /// Working memory for this world.
    pub fn scratch(&self) -> Scratch {
        let variables = self.world.slots.iter().map(|s| s.vars.len()).sum();
        Scratch {
            before: vec![0; self.world.layout.size],
            frames: vec![Frame::default(); self.world.players.len()],
            flows: vec![(3, 0.0); variables],
            collision: self.collision.scratch(self.world),
        }
    }

    /// The state before the first step, contacts included.
    ///
    /// # Errors
    /// A [`Fault`] if a collider's size or guard breaks a rule.
    pub fn initial(&self, scratch: &mut Scratch) -> Result<Vec<u8>, Fault> {
        let mut state = vec![0; self.world.layout.size];
        for (id, slot) in self.world.slots.pairs() {
            let layout = self.layout(id);
            for (var, values) in slot.vars.pairs() {
                for (degree, value) in (0u8..).zip(values) {
                    layout.set_var(&mut state, var, degree, *value);
                }
            }
            for (discrete, value) in slot.discretes.pairs() {
                layout.set_discrete(&mut state, discrete, *value);
            }
            let fault = Cell::new(None);
            // Guards of `initial when` read parameters only, so any state will do.
            let reader = Reader { sim: self, state: &[], frames: &[], fault: &fault, me: id };
            for (group, g) in self.entity(id).groups.pairs() {
                let leaf = reader.entered(reader.chosen(&g.choices, g.first));
                layout.set_leaf(&mut state, group, leaf);
            }
            Self::settle(&fault)?;
            layout.set_space(&mut state, slot.space);
            layout.set_alive(&mut state, true);
        }
        scratch.frames.fill(Frame::default());
        self.collide(&mut state, scratch, false)?;
        Ok(state)
    }

    /// One step of time: `state` becomes the next state.
    ///
    /// # Errors
    /// A [`Fault`] if the program breaks a rule; `state` is then not to be used.
    pub fn step(&self, state: &mut [u8], input: &Input, scratch: &mut Scratch) -> Result<(), Fault> {
        scratch.before.copy_from_slice(state);
        for (player, &at) in self.world.layout.players.pairs() {
            let now = input.of(player);
            scratch.frames[player.index()] = Frame::new(now, buttons(state, at));
            set_buttons(state, at, now.buttons);
        }
        self.transitions(state, scratch)?;
        self.flow(state, scratch)?;
        self.collide(state, scratch, true)
    }

    /// Whether a predicate of the world holds in a state.
    ///
    /// # Errors
    /// A [`Fault`] if the predicate breaks a rule.
    pub fn holds(&self, state: &[u8], predicate: ExprId) -> Result<bool, Fault> {
        let fault = Cell::new(None);
        let reader = Reader { sim: self, state, frames: &[], fault: &fault, me: SlotId(0) };
        let holds = reader.truth(predicate);
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(holds),
        }
    }

    /// Whether a goal holds in a state.
    ///
    /// # Errors
    /// As [`Simulator::holds`].
    pub fn goal(&self, state: &[u8], goal: GoalId) -> Result<bool, Fault> {
        self.holds(state, self.world.goals[goal].holds)
    }

    /// The first `never` that holds in a state.
    ///
    /// # Errors
    /// As [`Simulator::holds`].
    pub fn violated(&self, state: &[u8]) -> Result<Option<NeverId>, Fault> {
        for (id, never) in self.world.nevers.pairs() {
            if self.holds(state, never.holds)? {
                return Ok(Some(id));
            }
        }
        Ok(None)
    }

    /// A slot's position, px.
    pub fn position(&self, state: &[u8], slot: SlotId) -> (f64, f64) {
        let layout = self.layout(slot);
        (layout.var(state, VarId(0), 0), layout.var(state, VarId(1), 0))
    }

    /// The space that a slot is in.
    pub fn space(&self, state: &[u8], slot: SlotId) -> SpaceId {
        self.layout(slot).space(state)
    }

    /// Fails with a fault that was noted on the side.
    pub(super) fn settle(fault: &Cell<Option<Fault>>) -> Result<(), Fault> {
        match fault.get() {
            Some(fault) => Err(fault),
            None => Ok(()),
        }
    }

    /// The fault that a variable's new value is, if it is not finite.
    pub(super) fn finite(slot: SlotId, var: VarId, value: f64) -> Result<(), Fault> {
        if value.is_finite() { Ok(()) } else { Err(Fault { slot, kind: FaultKind::Diverged(var) }) }
    }
}

//! Look-up by name, to be done once before a loop that uses ids.

use super::{
    AxisId, ButtonId, ChanceId, DiscreteId, Entity, EntityId, GoalId, ModeId, NeverId, ParamId, Program, RefId, SlotId,
    SpaceId, VarId, World, WorldId,
};

impl Program {
    /// The world with a name.
    pub fn world_named(&self, name: &str) -> Option<WorldId> {
        self.worlds.find(|world| world.name == name)
    }

    /// The entity with a name.
    pub fn entity_named(&self, name: &str) -> Option<EntityId> {
        self.entities.find(|entity| *entity.name == *name)
    }
}

impl World {
    /// The slot of the instance with a name.
    pub fn slot_named(&self, name: &str) -> Option<SlotId> {
        self.slots.find(|slot| slot.name == name)
    }

    /// The space with a name.
    pub fn space_named(&self, name: &str) -> Option<SpaceId> {
        self.spaces.find(|space| space.name == name)
    }

    /// The goal with a name.
    pub fn goal_named(&self, name: &str) -> Option<GoalId> {
        self.goals.find(|goal| goal.name == name)
    }

    /// The `never` with a name.
    pub fn never_named(&self, name: &str) -> Option<NeverId> {
        self.nevers.find(|never| never.name == name)
    }
}

impl Entity {
    /// A continuous variable or one of its derivatives as authors write it: `x`, `x'`, `x''`.
    pub fn variable_text(&self, var: VarId, degree: u8) -> String {
        format!("{}{}", self.vars[var], "'".repeat(usize::from(degree)))
    }

    /// The continuous variable with a name.
    pub fn var_named(&self, name: &str) -> Option<VarId> {
        self.vars.find(|var| **var == *name)
    }

    /// The discrete variable with a name.
    pub fn discrete_named(&self, name: &str) -> Option<DiscreteId> {
        self.discretes.find(|discrete| discrete.name == name)
    }

    /// The parameter with a name.
    pub fn param_named(&self, name: &str) -> Option<ParamId> {
        self.params.find(|param| param.name == name)
    }

    /// The reference with a name.
    pub fn ref_named(&self, name: &str) -> Option<RefId> {
        self.refs.find(|reference| reference.name == name)
    }

    /// The button with a name.
    pub fn button_named(&self, name: &str) -> Option<ButtonId> {
        self.buttons.find(|button| button == name)
    }

    /// The axis with a name.
    pub fn axis_named(&self, name: &str) -> Option<AxisId> {
        self.axes.find(|axis| axis == name)
    }

    /// The chance with a name.
    pub fn chance_named(&self, name: &str) -> Option<ChanceId> {
        self.chances.find(|chance| chance.name == name)
    }

    /// The mode with a full path: `movement.air.rising`.
    pub fn mode_named(&self, path: &str) -> Option<ModeId> {
        self.modes.find(|mode| mode.path == path)
    }
}

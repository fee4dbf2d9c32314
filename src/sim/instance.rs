//! Read access to an instance in a state: its values, modes and contacts, by id or by name.

use crate::ir::{DiscreteId, Domain, Entity, GroupId, LeafId, ModeId, ParamId, RefId, SlotId, SpaceId, TouchId, VarId};

use super::simulator::Simulator;

/// An instance in a state. If its slot is empty, all values are 0 and no mode is active.
#[derive(Clone, Copy)]
pub struct Instance<'a> {
    sim: &'a Simulator,
    state: &'a [u8],
    slot: SlotId,
}

impl Simulator {
    /// The instance of a slot in a state.
    pub fn instance<'a>(&'a self, state: &'a [u8], slot: SlotId) -> Instance<'a> {
        Instance { sim: self, state, slot }
    }

    /// The instances of a state, in the order of their slots.
    pub fn instances<'a>(&'a self, state: &'a [u8]) -> impl Iterator<Item = Instance<'a>> {
        self.world().slots.ids().map(|slot| self.instance(state, slot)).filter(|instance| instance.is_alive())
    }
}

impl<'a> Instance<'a> {
    pub(super) fn sim(self) -> &'a Simulator {
        self.sim
    }

    /// The bytes of the state.
    pub fn bytes(self) -> &'a [u8] {
        self.state
    }

    /// Its slot.
    pub fn slot(self) -> SlotId {
        self.slot
    }

    /// Its name.
    pub fn name(self) -> &'a str {
        &self.sim.world().slots[self.slot].name
    }

    /// Its entity.
    pub fn entity(self) -> &'a Entity {
        self.sim.entity(self.slot)
    }

    /// Whether the slot holds an instance.
    pub fn is_alive(self) -> bool {
        self.sim.layout(self.slot).alive(self.state)
    }

    /// The space that it is in.
    pub fn space(self) -> SpaceId {
        self.sim.space(self.state, self.slot)
    }

    /// Its position, px.
    pub fn position(self) -> (f64, f64) {
        self.sim.position(self.state, self.slot)
    }

    /// A continuous variable (degree 0), its velocity (1) or its acceleration (2).
    pub fn var(self, var: VarId, degree: u8) -> f64 {
        self.sim.layout(self.slot).var(self.state, var, degree)
    }

    /// A discrete variable: a number, 0 or 1 for a truth value, or the index of one of its names.
    pub fn discrete(self, discrete: DiscreteId) -> i32 {
        self.sim.layout(self.slot).discrete(self.state, discrete)
    }

    /// The named value of a discrete variable, if its values have names.
    pub fn discrete_name(self, discrete: DiscreteId) -> Option<&'a str> {
        match &self.entity().discretes[discrete].domain {
            Domain::Set(names) => names.get(usize::try_from(self.discrete(discrete)).ok()?).map(String::as_str),
            Domain::Int | Domain::Bool => None,
        }
    }

    /// A parameter.
    pub fn param(self, param: ParamId) -> f64 {
        self.sim.param(self.state, self.slot, param)
    }

    /// A number by its name: a variable (`x`, `x'`, `x''`), a discrete variable or a parameter.
    pub fn get(self, name: &str) -> Option<f64> {
        let entity = self.entity();
        let plain = name.trim_end_matches('\'');
        let degree = name.len() - plain.len();
        if let (Some(var), 0..=2) = (entity.var_named(plain), degree) {
            return Some(self.var(var, degree as u8));
        }
        let discrete = entity.discrete_named(name).map(|id| f64::from(self.discrete(id)));
        discrete.or_else(|| entity.param_named(name).map(|id| self.param(id)))
    }

    /// The target of a reference.
    pub fn reference(self, reference: RefId) -> Option<Instance<'a>> {
        let target = self.sim.layout(self.slot).reference(self.state, reference)?;
        Some(Instance { slot: target, ..self })
    }

    /// The active leaf of a group.
    pub fn leaf(self, group: GroupId) -> LeafId {
        self.sim.layout(self.slot).leaf(self.state, group)
    }

    /// The innermost active mode of each group.
    pub fn modes(self) -> impl Iterator<Item = ModeId> + 'a {
        let groups = self.is_alive().then(|| self.entity().groups.ids());
        groups.into_iter().flatten().map(move |group| self.entity().leaves[self.leaf(group)].mode)
    }

    /// Whether a mode is active.
    pub fn is_in(self, mode: ModeId) -> bool {
        let entity = self.entity();
        self.is_alive() && entity.is_active_in(mode, self.leaf(entity.modes[mode].group))
    }

    /// The time for which a mode has been active, s; `None` if nothing reads it, so that it is not counted.
    pub fn time_in(self, mode: ModeId) -> Option<f64> {
        let timer = self.entity().timers.find(|timer| timer.mode == mode)?;
        Some(self.sim.world().step.times(self.sim.layout(self.slot).timer(self.state, timer)))
    }

    /// The contact queries of its entity that hold.
    pub fn contacts(self) -> impl Iterator<Item = TouchId> + 'a {
        self.entity().touches.ids().filter(move |touch| self.touches(*touch))
    }

    /// Whether a contact query of its entity holds.
    pub fn touches(self, touch: TouchId) -> bool {
        self.sim.layout(self.slot).touch(self.state, touch)
    }
}

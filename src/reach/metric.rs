//! The space that is sampled and the distance in it: the full state. Positions lie in the level, velocities and
//! accelerations within ±1000; dimensions that no flow, update or push ever changes are left out. Each coordinate is
//! scaled by its range, and each group whose active leaf differs adds a fixed penalty.

use rand::{Rng, RngExt};

use crate::ir::{
    Bounds, DiscreteId, Drive, Entity, Expr, GroupId, Id, LeafId, Origin, Place, Program, Slot, SlotId, TimerId, VarId,
    World,
};
use crate::sim::Simulator;

/// The bound of velocities and accelerations, px/s and px/s².
pub const SPEED: f64 = 1000.0;
/// How far around the placed instances positions are sampled where there is no map, px.
pub const OPEN_MARGIN: f64 = 500.0;
/// What a differing leaf adds to the squared distance.
pub const MODE_PENALTY: f32 = 0.05;

/// What a coordinate measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A continuous variable or a derivative.
    Var(SlotId, VarId, u8),
    /// A discrete variable.
    Discrete(SlotId, DiscreteId),
    /// A timer's count.
    Timer(SlotId, TimerId),
}

/// A coordinate and the range it is sampled from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// What it measures.
    pub quantity: Quantity,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
}

impl Coordinate {
    /// A value on the scale of the range: 0 at its lower end, 1 at its upper end. What lies far outside is kept at a
    /// distance whose square is still a number.
    pub fn scaled(&self, value: f64) -> f32 {
        let width = self.high - self.low;
        if width > 0.0 { ((value - self.low) / width).clamp(-1e9, 1e9) as f32 } else { 0.0 }
    }
}

/// A group whose leaf is compared.
#[derive(Debug, Clone, Copy)]
struct ModeCoordinate {
    slot: SlotId,
    group: GroupId,
    first: LeafId,
    count: u32,
}

/// The sampled space of a world.
#[derive(Debug, Clone)]
pub struct Metric {
    reals: Vec<Coordinate>,
    modes: Vec<ModeCoordinate>,
}

/// A point of the sampled space, or a state seen as one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// Scaled coordinates.
    pub reals: Vec<f32>,
    /// Leaves.
    pub modes: Vec<f32>,
}

impl Metric {
    /// The space of a world.
    pub fn new(sim: &Simulator<'_>) -> Self {
        let (program, world) = (sim.program(), sim.world());
        let mut reals = Vec::new();
        let mut modes = Vec::new();
        for (slot, s) in world.slots.pairs() {
            let entity = &program.entities[s.entity];
            for var in entity.vars.ids() {
                let changes = changing_degrees(program, entity, s, var);
                for degree in (0..3u8).filter(|&d| changes[usize::from(d)]) {
                    let (low, high) = if degree == 0 { positions(world, var) } else { (-SPEED, SPEED) };
                    reals.push(Coordinate { quantity: Quantity::Var(slot, var, degree), low, high });
                }
            }
            for (id, discrete) in entity.discretes.pairs() {
                let updated = updates(entity).any(|place| place == Place::Discrete(id));
                if updated {
                    let (low, high) = discrete.range;
                    // An unbounded counter says little by its size.
                    let (low, high) = (f64::from(low.max(-1000)), f64::from(high.min(1000)));
                    reals.push(Coordinate { quantity: Quantity::Discrete(slot, id), low, high });
                }
            }
            for (id, limit) in s.timer_limits.pairs() {
                let high = f64::from((*limit).min(600));
                reals.push(Coordinate { quantity: Quantity::Timer(slot, id), low: 0.0, high });
            }
            for (group, g) in entity.groups.pairs() {
                let first = entity.modes[g.modes.0].leaves.0;
                let after = entity.leaves.ids().rev().find(|l| entity.leaves[*l].mode < g.modes.1);
                let count = after.map_or(0, |last| last.0 + 1 - first.0);
                if count > 1 {
                    modes.push(ModeCoordinate { slot, group, first, count });
                }
            }
        }
        Metric { reals, modes }
    }

    /// The coordinates, in the order of [`Point::reals`].
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.reals
    }

    /// The number of modes compared.
    pub fn modes(&self) -> usize {
        self.modes.len()
    }

    /// The place of a group in [`Point::modes`].
    pub fn mode_index(&self, slot: SlotId, group: GroupId) -> Option<usize> {
        self.modes.iter().position(|m| m.slot == slot && m.group == group)
    }

    /// A state as a point.
    pub fn point(&self, world: &World, state: &[u8], out: &mut Point) {
        out.reals.clear();
        out.modes.clear();
        for c in &self.reals {
            let value = match c.quantity {
                Quantity::Var(slot, var, degree) => world.layout.slots[slot].var(state, var, degree),
                Quantity::Discrete(slot, id) => f64::from(world.layout.slots[slot].discrete(state, id)),
                Quantity::Timer(slot, id) => f64::from(world.layout.slots[slot].timer(state, id)),
            };
            out.reals.push(c.scaled(value));
        }
        for m in &self.modes {
            out.modes.push(world.layout.slots[m.slot].leaf(state, m.group).0 as f32);
        }
    }

    /// A random point, uniform in every coordinate.
    pub fn sample(&self, rng: &mut impl Rng, out: &mut Point) {
        out.reals.clear();
        out.modes.clear();
        out.reals.extend(self.reals.iter().map(|_| rng.random_range(0.0f32..1.0)));
        out.modes.extend(self.modes.iter().map(|m| (m.first.0 + rng.random_range(0..m.count)) as f32));
    }
}

/// The range in which positions are sampled, px. Other continuous variables have none of their own.
fn positions(world: &World, var: VarId) -> (f64, f64) {
    if var.index() > 1 {
        return (-SPEED, SPEED);
    }
    let side = |b: &Bounds| if var.index() == 0 { (b.left, b.right) } else { (b.bottom, b.top) };
    let around = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
    if let Some(range) = world.spaces.iter().filter_map(|s| s.bounds.as_ref()).map(side).reduce(around) {
        return range;
    }
    let placed = || world.slots.iter().map(|s| s.vars[var][0]);
    let low = placed().fold(f64::INFINITY, f64::min).min(0.0);
    let high = placed().fold(f64::NEG_INFINITY, f64::max).max(0.0);
    (low - OPEN_MARGIN, high + OPEN_MARGIN)
}

fn updates(entity: &Entity) -> impl Iterator<Item = Place> {
    let edges = entity.edges.iter().map(|e| &e.actions);
    let all = edges.chain(entity.modes.iter().map(|m| &m.entry)).chain(entity.follows.iter().map(|f| &f.actions));
    all.flat_map(|a| &a.updates).map(|u| u.place)
}

/// Which of position, velocity and acceleration of a variable can ever change.
fn changing_degrees(program: &Program, entity: &Entity, slot: &Slot, var: VarId) -> [bool; 3] {
    let mut changes = [false; 3];
    // Whatever changes a derivative changes what it is a derivative of.
    let mut from = |degree: usize| changes.iter_mut().take(degree + 1).for_each(|c| *c = true);
    if slot.origin != Origin::Named {
        // A spawn may set anything.
        return [true; 3];
    }
    let [_, velocity, acceleration] = slot.vars[var];
    if velocity != 0.0 {
        from(0);
    }
    if acceleration != 0.0 {
        from(1);
    }
    for drive in entity.free.iter().chain(entity.leaves.iter().flat_map(|l| &l.drives)) {
        match *drive {
            Drive::Flow { var: v, degree, value } if v == var => {
                // An acceleration that a mode fixes is told by the mode.
                let fixed = matches!(program.exprs[value], Expr::Number(_) | Expr::Param(..) | Expr::Negate(_));
                from(usize::from(if degree == 2 && fixed { 1 } else { degree }));
            }
            Drive::Envelope(id, component) if entity.envelopes[id].vars[usize::from(component)] == var => {
                from(usize::from(entity.envelopes[id].degree));
            }
            _ => {}
        }
    }
    for place in updates(entity) {
        if let Place::Var(v, degree) = place
            && v == var
        {
            from(usize::from(degree));
        }
    }
    if var.index() <= 1 && entity.colliders.iter().any(|c| !c.kinematic) {
        from(0);
    }
    changes
}

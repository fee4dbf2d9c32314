//! The space that is sampled and the distance in it: the full state. Each coordinate is scaled, and each group whose
//! active leaf differs adds a fixed penalty. Which coordinates there are, and their scales, the bounds tell
//! (`bounds.rs`).

use rand::Rng;

use crate::analysis::ConfigurationSpace;
use crate::ir::{DiscreteId, GroupId, SlotId, TimerId, VarId, World};
use crate::sim::Simulator;

use super::bounds::{self, Sampling};
use super::draw::SlotDraw;

/// What a differing leaf adds to the squared distance.
pub const MODE_PENALTY: f32 = 0.05;

/// The leaf of an absent instance.
pub(super) const NO_LEAF: f32 = -1.0;

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

/// A coordinate and its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// What it measures.
    pub quantity: Quantity,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// What counts as a distance of 1; above 0.
    pub unit: f64,
}

impl Coordinate {
    /// A value on the scale of distances, 0 at the lower end of the range. What lies far outside is kept at a distance
    /// whose square is still a number.
    pub fn scaled(&self, value: f64) -> f32 {
        ((value - self.low) / self.unit).clamp(-1e9, 1e9) as f32
    }

    /// Where an absent instance is: in the middle.
    pub(super) fn nowhere(&self) -> f32 {
        self.scaled(self.low + (self.high - self.low) / 2.0)
    }
}

/// What of a slot takes part: how many coordinates, which groups' leaves, and how they are drawn.
#[derive(Debug, Clone)]
pub(super) struct SlotPart {
    pub slot: SlotId,
    /// The number of its coordinates.
    pub reals: usize,
    /// Groups whose leaf is compared.
    pub groups: Vec<GroupId>,
    /// Whether it is compared that there is an instance; where leaves are, they tell.
    pub presence: bool,
    pub draw: SlotDraw,
}

/// The sampled space of a world.
#[derive(Debug, Clone)]
pub struct Metric {
    reals: Vec<Coordinate>,
    modes: usize,
    slots: Vec<SlotPart>,
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
    /// The space of a world, sampled from the chosen bounds.
    pub fn new(sim: &Simulator<'_>, space: &ConfigurationSpace, sampling: Sampling) -> Self {
        let mut metric = Metric { reals: Vec::new(), modes: 0, slots: Vec::new() };
        for slot in sim.world().slots.ids() {
            let (coordinates, part) = bounds::of_slot(sim.program(), sim.world(), slot, &space.slots[slot], sampling);
            metric.modes += part.groups.len() + usize::from(part.presence);
            metric.reals.extend(coordinates);
            metric.slots.push(part);
        }
        metric
    }

    /// The coordinates, in the order of [`Point::reals`].
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.reals
    }

    /// The number of modes compared.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// The place of a group in [`Point::modes`].
    pub fn mode_index(&self, slot: SlotId, group: GroupId) -> Option<usize> {
        let mut before = 0;
        for part in &self.slots {
            if part.slot == slot {
                return Some(before + part.groups.iter().position(|g| *g == group)?);
            }
            before += part.groups.len() + usize::from(part.presence);
        }
        None
    }

    /// A state as a point.
    pub fn point(&self, world: &World, state: &[u8], out: &mut Point) {
        out.reals.clear();
        out.modes.clear();
        let mut coordinates = self.reals.as_slice();
        for part in &self.slots {
            let (own, rest) = coordinates.split_at(part.reals);
            coordinates = rest;
            let layout = &world.layout.slots[part.slot];
            let alive = layout.alive(state);
            if part.presence {
                out.modes.push(if alive { 0.0 } else { NO_LEAF });
            }
            if !alive {
                out.reals.extend(own.iter().map(Coordinate::nowhere));
                out.modes.extend(part.groups.iter().map(|_| NO_LEAF));
                continue;
            }
            for c in own {
                let value = match c.quantity {
                    Quantity::Var(_, var, degree) => layout.var(state, var, degree),
                    Quantity::Discrete(_, id) => f64::from(layout.discrete(state, id)),
                    Quantity::Timer(_, id) => f64::from(layout.timer(state, id)),
                };
                out.reals.push(c.scaled(value));
            }
            out.modes.extend(part.groups.iter().map(|g| layout.leaf(state, *g).0 as f32));
        }
    }

    /// A random point.
    pub fn sample(&self, rng: &mut impl Rng, out: &mut Point) {
        out.reals.clear();
        out.modes.clear();
        for part in &self.slots {
            part.draw.draw(rng, out);
        }
    }
}

//! The sampled space and its metric: the full state. Each coordinate is scaled, and each group whose active leaf
//! differs adds a fixed penalty. `bounds.rs` determines the coordinates and their scales.

use rand::Rng;

use crate::analysis::ConfigurationSpace;
pub use crate::analysis::Quantity;
use crate::ir::{Bounds, Extremes, GroupId, SlotId, Space, VarId, World};
use crate::sim::Simulator;

use super::bounds::{self, Sampling};
use super::coverage::PLACE;
use super::draw::SlotDraw;
use super::nearest::Around;

/// Penalty of a differing leaf in the squared distance.
pub const MODE_PENALTY: f32 = 0.05;

/// The leaf of an absent instance.
pub(super) const NO_LEAF: f32 = -1.0;

/// A coordinate and its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// What it measures.
    pub quantity: Quantity,
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// The difference that counts as a distance of 1; positive.
    pub unit: f64,
}

impl Coordinate {
    /// A value on the scale of distances, 0 at the lower end of the range; clamped so that its square is finite.
    pub fn scaled(&self, value: f64) -> f32 {
        ((value - self.low) / self.unit).clamp(-1e9, 1e9) as f32
    }

    /// The coordinate of an absent instance: the middle.
    pub(super) fn absent(&self) -> f32 {
        self.scaled(self.low + (self.high - self.low) / 2.0)
    }
}

/// The part of a slot in the sampled space: coordinates, groups, and their distribution.
#[derive(Debug, Clone)]
pub(super) struct SlotPart {
    pub slot: SlotId,
    /// The number of its coordinates.
    pub reals: usize,
    /// Groups whose leaves are compared.
    pub groups: Vec<GroupId>,
    /// Whether presence is compared; otherwise the leaves show it.
    pub presence: bool,
    /// Whether the space is compared.
    pub space: bool,
    pub draw: SlotDraw,
}

impl SlotPart {
    /// Number of compared modes.
    fn modes(&self) -> usize {
        self.groups.len() + usize::from(self.presence) + usize::from(self.space)
    }

    /// Removes all modes, and the coordinates that are not kept.
    fn keep(&mut self, kept: &[bool]) {
        self.reals = kept.iter().filter(|k| **k).count();
        self.groups.clear();
        self.presence = false;
        self.space = false;
        self.draw.keep(kept);
    }
}

/// A coordinate or a mode in a projection: its level, its cells per unit of distance with the offset of the first
/// (`None` for a mode: each value is a cell), and whether it can show progress.
pub(super) type Projected = (usize, Option<(f32, f32)>, bool);

/// The part of a state that distances measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// The full state.
    #[default]
    Full,
    /// Only the players' positions.
    Positions,
}

impl Measure {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Full => "full",
            Measure::Positions => "xy",
        }
    }
}

/// The sampled space of a world.
#[derive(Debug, Clone)]
pub struct Metric {
    reals: Vec<Coordinate>,
    modes: usize,
    slots: Vec<SlotPart>,
    players: Vec<SlotId>,
    around: Vec<Around>,
}

/// A point of the sampled space, or a state seen as one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// Scaled coordinates.
    pub reals: Vec<f32>,
    /// Leaves.
    pub modes: Vec<f32>,
}

impl Point {
    /// A coordinate or, after these, a leaf.
    #[inline]
    pub fn value(&self, index: usize) -> f32 {
        match index.checked_sub(self.reals.len()) {
            None => self.reals[index],
            Some(index) => self.modes[index],
        }
    }

    /// The squared distance to another point; each differing mode adds `penalty`.
    pub fn distance(&self, other: &Point, penalty: f32) -> f32 {
        let mut sum = 0.0;
        for (index, real) in self.reals.iter().enumerate() {
            let d = real - other.reals[index];
            sum += d * d;
        }
        for (index, mode) in self.modes.iter().enumerate() {
            sum += if *mode == other.modes[index] { 0.0 } else { penalty };
        }
        sum
    }
}

impl Metric {
    /// The space of a world, sampled from the chosen bounds, with the full metric.
    pub fn new(sim: &Simulator, space: &ConfigurationSpace, sampling: Sampling) -> Self {
        let extent = sim.world().spaces.iter().filter_map(Space::extent).reduce(Bounds::join);
        Metric::measuring(sim, space, (sampling, extent), Measure::Full)
    }

    /// The space of a world, sampled from the chosen bounds. Unbounded positions are sampled from `extent`, or else
    /// from around the placed instances.
    pub fn measuring(
        sim: &Simulator,
        space: &ConfigurationSpace,
        (sampling, extent): (Sampling, Option<Bounds>),
        measure: Measure,
    ) -> Self {
        let players: Vec<SlotId> = sim.world().players.iter().map(|p| p.slot).collect();
        let mut metric = Metric { reals: Vec::new(), modes: 0, slots: Vec::new(), players, around: Vec::new() };
        let around = extent.unwrap_or_else(|| bounds::around(sim.world()));
        for slot in sim.world().slots.ids() {
            let (mut coordinates, mut part) =
                bounds::of_slot(sim.program(), sim.world(), slot, &space.slots[slot], (sampling, around));
            if measure == Measure::Positions {
                if !metric.players.contains(&slot) {
                    continue;
                }
                let is_position = |c: &Coordinate| matches!(c.quantity, Quantity::Var(_, var, 0) if var.is_position());
                let kept: Vec<bool> = coordinates.iter().map(is_position).collect();
                part.keep(&kept);
                coordinates.retain(is_position);
            }
            metric.modes += part.modes();
            metric.reals.extend(coordinates);
            metric.slots.push(part);
        }
        metric.around = metric.repeating(sim);
        metric
    }

    /// The coordinates, in the order of [`Point::reals`].
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.reals
    }

    /// The coordinates that repeat.
    pub fn around(&self) -> Vec<Around> {
        self.around.clone()
    }

    /// The positions of players that stay in a space that wraps.
    fn repeating(&self, sim: &Simulator) -> Vec<Around> {
        let of = |(coordinate, c): (usize, &Coordinate)| {
            let Quantity::Var(slot, var, 0) = c.quantity else { return None };
            let table = &sim.world().slots[slot];
            let stays = sim.program().entities[table.entity].follows.is_empty() && self.players.contains(&slot);
            let axis = VarId::XY.iter().position(|axis| *axis == var).filter(|_| stays)?;
            let period = sim.world().spaces[table.space].periods[axis]?;
            let (middle, size) = (c.scaled(f64::midpoint(period.low, period.high)), (period.size() / c.unit) as f32);
            (size.is_finite() && size > 0.0).then_some(Around { coordinate, middle, size })
        };
        self.reals.iter().enumerate().filter_map(of).collect()
    }

    /// The number of modes compared.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// The index of a group in [`Point::modes`].
    pub fn mode_index(&self, slot: SlotId, group: GroupId) -> Option<usize> {
        let mut before = 0;
        for part in &self.slots {
            if part.slot == slot {
                return Some(before + usize::from(part.presence) + part.groups.iter().position(|g| *g == group)?);
            }
            before += part.modes();
        }
        None
    }

    /// The projection for planners that measure coverage: for each coordinate, then for each mode, its [`Projected`]
    /// entry. Level 1 is the position of the players; the flag marks modes, counters and presence.
    pub(super) fn projection(&self) -> Vec<Projected> {
        let is_player = |slot: SlotId| self.players.contains(&slot);
        let real = |c: &Coordinate| {
            let width = (c.high - c.low).clamp(f64::MIN_POSITIVE, f64::MAX);
            let (level, cells, counts) = match c.quantity {
                Quantity::Var(slot, var, 0) if is_player(slot) && var.is_position() => {
                    (1, (width / PLACE).greatest(1.0), false)
                }
                Quantity::Discrete(..) => (2, width + 1.0, true),
                Quantity::Var(slot, _, 0) if !is_player(slot) => (2, 8.0, false),
                Quantity::Var(slot, _, 1) if is_player(slot) => (2, 4.0, false),
                Quantity::Timer(..) => (2, 4.0, false),
                Quantity::Var(..) => (2, 2.0, false),
            };
            // One cell if the number overflows.
            let cells = Some((cells * c.unit / width) as f32).filter(|cells| cells.is_finite()).unwrap_or(1.0);
            (level, Some((cells, c.scaled(c.low))), counts)
        };
        let modes = |part: &SlotPart| {
            let others = part.modes() - usize::from(part.space);
            let space = part.space.then_some((if is_player(part.slot) { 1 } else { 2 }, None, false));
            std::iter::repeat_n((2, None, true), others).chain(space)
        };
        self.reals.iter().map(real).chain(self.slots.iter().flat_map(modes)).collect()
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
                out.reals.extend(own.iter().map(Coordinate::absent));
                let others = part.modes() - usize::from(part.presence);
                out.modes.extend(std::iter::repeat_n(NO_LEAF, others));
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
            if part.space {
                out.modes.push(layout.space(state).0 as f32);
            }
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

//! The bounds that samples are drawn from. Naive: a box for everything, every combination of leaves. Reduced: for each
//! possible combination, the values that the analysis allows; quantities that the combination determines are no
//! coordinates. Both follow Osborn, Lambrigger and Mateas, *HyPED: Modeling and Analyzing Action Games as Hybrid
//! Systems*, AIIDE 2017.

use std::collections::BTreeSet;

use crate::analysis::{Configuration, Interval, SlotSpace, Values};
use crate::ir::{Bounds, Entity, Extremes, GroupId, Id, LeafId, Program, SlotId, SpaceId, VarId, World};

use super::draw::{Combination, Draw, Leaf, SlotDraw};
use super::metric::{Coordinate, Quantity, SlotPart};

/// The bound of velocities and accelerations, px/s and px/s².
const SPEED: f64 = 1000.0;
/// Margin around the placed instances in a space without a map, px.
const OPEN_MARGIN: f64 = 500.0;
/// Maximum size of an unbounded counter: its size says little.
const COUNTER: i32 = 1000;
/// Maximum range of a timer that no expression compares, steps.
const TIMER: u32 = 600;
/// Scale of velocities, accelerations and timers relative to positions: they change quickly or by themselves, so they
/// have to differ by this multiple of their range to count as much.
const FAST_CHANGE_FACTOR: f64 = 10.0;

/// Where samples are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// A box: the level for positions, ±1000 for what is derived from them, all values of discrete variables, all
    /// combinations of leaves.
    Naive,
    /// The values that the analysis allows.
    #[default]
    Reduced,
}

impl Sampling {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Sampling::Naive => "naive",
            Sampling::Reduced => "reduced",
        }
    }
}

/// The coordinates of a slot, and how they are drawn.
pub(super) fn of_slot(
    program: &Program,
    world: &World,
    slot: SlotId,
    space: &SlotSpace,
    (sampling, around): (Sampling, Bounds),
) -> (Vec<Coordinate>, SlotPart) {
    let entity = &program.entities[world.slots[slot].entity];
    let all = boxes(world, entity, slot, around);
    match sampling {
        Sampling::Reduced if !space.is_given_up => reduced(entity, slot, space, &all),
        _ => naive(world, entity, slot, all),
    }
}

fn naive(world: &World, entity: &Entity, slot: SlotId, all: Vec<Coordinate>) -> (Vec<Coordinate>, SlotPart) {
    let groups: Vec<(GroupId, Leaf)> = entity
        .groups
        .pairs()
        .filter_map(|(group, g)| {
            let first = entity.modes[g.modes.from].leaves.from;
            let after = entity.leaves.ids().rev().find(|l| entity.leaves[*l].mode < g.modes.to);
            let count = after.map_or(0, |last| last.0 + 1 - first.0);
            (count > 1).then_some((group, Leaf::Any(first.0, count)))
        })
        .collect();
    let draw = |c: &Coordinate| Draw::of(c, &[Interval { low: c.low, high: c.high }], false);
    let space = world.spaces.len() > 1 && !entity.follows.is_empty();
    let spaces = space.then_some(Leaf::Any(0, world.spaces.len() as u32));
    let combination = Combination {
        leaves: groups.iter().map(|(_, l)| *l).chain(spaces).collect(),
        values: all.iter().map(draw).collect(),
    };
    let part = SlotPart {
        slot,
        reals: all.len(),
        groups: groups.into_iter().map(|(g, _)| g).collect(),
        presence: false,
        space,
        draw: SlotDraw { combinations: vec![combination] },
    };
    (all, part)
}

fn reduced(entity: &Entity, slot: SlotId, space: &SlotSpace, all: &[Coordinate]) -> (Vec<Coordinate>, SlotPart) {
    let configurations = &space.configurations;
    let mut coordinates = Vec::new();
    for c in all {
        let found = || configurations.iter().map(|at| finite(&values(at, c.quantity), c));
        // Skip quantities that the leaves determine.
        if found().all(|v| v.constant().is_some()) {
            continue;
        }
        if let Some(Interval { low, high }) = found().filter_map(|v| v.hull()).reduce(Interval::or) {
            let unit = match c.quantity {
                // Positions keep their scale, however far something can move.
                Quantity::Var(_, var, 0) if var.is_position() => c.unit,
                Quantity::Var(_, _, 0) | Quantity::Discrete(..) => high - low,
                Quantity::Var(..) | Quantity::Timer(..) => (high - low) * FAST_CHANGE_FACTOR,
            };
            coordinates.push(Coordinate { quantity: c.quantity, low, high, unit: positive(unit) });
        }
    }
    let leaf = |at: &Configuration, group: GroupId| at.leaves.get(group.index()).copied().unwrap_or(LeafId(0));
    let differs = |group: &GroupId| {
        let mut leaves = configurations.iter().map(|at| leaf(at, *group));
        let first = leaves.next();
        leaves.any(|l| Some(l) != first)
    };
    let groups: Vec<GroupId> = entity.groups.ids().filter(differs).collect();
    let can_be_both = space.can_be_absent && !configurations.is_empty();
    let presence = can_be_both && groups.is_empty();
    let spaces: BTreeSet<SpaceId> = configurations.iter().flat_map(|at| at.spaces.iter().copied()).collect();
    let has_spaces = spaces.len() > 1;
    let combination = |(at, space): (&Configuration, SpaceId)| {
        let present = presence.then_some(Leaf::Fixed(0.0));
        let leaves = groups.iter().map(|g| Leaf::Fixed(leaf(at, *g).0 as f32));
        let draw = |c: &Coordinate| {
            let whole = !matches!(c.quantity, Quantity::Var(..));
            let within = all.iter().find(|b| b.quantity == c.quantity).unwrap_or(c);
            Draw::of(c, finite(&values(at, c.quantity), within).intervals(), whole)
        };
        let values = coordinates.iter().map(draw).collect();
        let space = has_spaces.then_some(Leaf::Fixed(space.0 as f32));
        Combination { leaves: present.into_iter().chain(leaves).chain(space).collect(), values }
    };
    // A configuration with several spaces yields one combination per space.
    let spaces = |at: &Configuration| -> Vec<SpaceId> {
        if has_spaces { at.spaces.iter().copied().collect() } else { vec![SpaceId(0)] }
    };
    let in_spaces = configurations.iter().flat_map(|at| spaces(at).into_iter().map(move |space| (at, space)));
    let mut combinations: Vec<Combination> = in_spaces.map(combination).collect();
    if can_be_both {
        let leaves = groups.len() + usize::from(presence) + usize::from(has_spaces);
        combinations.push(Combination::absent(&coordinates, leaves));
    }
    let reals = coordinates.len();
    let part = SlotPart { slot, reals, groups, presence, space: has_spaces, draw: SlotDraw { combinations } };
    (coordinates, part)
}

/// The values of a quantity in a configuration.
fn values(at: &Configuration, quantity: Quantity) -> Values {
    match quantity {
        Quantity::Var(_, var, degree) => at.vars[var][usize::from(degree)],
        Quantity::Discrete(_, id) => at.discretes[id],
        Quantity::Timer(_, id) => Values::from(at.timers[id]),
    }
}

/// Replaces infinite ends, and finite ends far outside the box, by the ends of the box.
fn finite(values: &Values, within: &Coordinate) -> Values {
    let width = within.high - within.low;
    let (least, most) = (within.low - width, within.high + width);
    let cut = |i: &Interval| {
        let low = if i.low < least { within.low.least(i.high) } else { i.low };
        let high = if i.high > most { within.high.greatest(i.low) } else { i.high };
        Interval { low: low.least(high), high }
    };
    Values::any(values.intervals().iter().map(cut))
}

fn positive(unit: f64) -> f64 {
    if unit > 0.0 { unit.least(f64::MAX) } else { 1.0 }
}

/// Every variable of a slot with its derivatives, the discrete variables and the timers, each in a box.
fn boxes(world: &World, entity: &Entity, slot: SlotId, around: Bounds) -> Vec<Coordinate> {
    let mut all = Vec::new();
    let mut add = |quantity: Quantity, low: f64, high: f64| {
        all.push(Coordinate { quantity, low, high, unit: positive(high - low) });
    };
    for var in entity.vars.ids() {
        for degree in 0..3u8 {
            // Variables other than x and y have no natural range.
            let (low, high) = match (var.index(), degree) {
                (0, 0) => (around.left, around.right),
                (1, 0) => (around.bottom, around.top),
                _ => (-SPEED, SPEED),
            };
            add(Quantity::Var(slot, var, degree), low, high);
        }
    }
    for (id, discrete) in entity.discretes.pairs() {
        let (low, high) = discrete.range;
        let cut = |end: i32| f64::from(end.clamp(-COUNTER, COUNTER));
        add(Quantity::Discrete(slot, id), cut(low), cut(high));
    }
    for (id, limit) in world.slots[slot].timer_limits.pairs() {
        add(Quantity::Timer(slot, id), 0.0, f64::from((*limit).min(TIMER)));
    }
    all
}

/// The box in which positions are sampled if there is no map: around all placed instances, px.
pub(super) fn around(world: &World) -> Bounds {
    let along = |axis: u32| {
        let placed = || world.slots.iter().map(|s| s.vars[VarId(axis)][0]);
        let low = placed().fold(f64::INFINITY, f64::least).least(0.0);
        let high = placed().fold(f64::NEG_INFINITY, f64::greatest).greatest(0.0);
        (low - OPEN_MARGIN, high + OPEN_MARGIN)
    };
    let ((left, right), (bottom, top)) = (along(0), along(1));
    Bounds { left, right, bottom, top }
}

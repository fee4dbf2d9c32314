//! The cells of players, for planners that keep states apart by them (`distance_guided.rs`, `time_guided.rs`): where they
//! are, what their discrete variables are, their velocities and their modes.

use crate::ir::{Extremes, SlotId, VarId};
use crate::reach::coverage::{PLACE, mix};
use crate::reach::distance::DistanceField;
use crate::reach::metric::{Coordinate, Metric, Point, Quantity};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::tree::NodeId;
use crate::reach::why_not::Margins;

use super::Guidance;

/// As many cells lie side by side in a place of another instance: a crate fits through a gap of its own size only.
const LED: f64 = 4.0;

/// The velocities and modes of the players, as they stand in points.
#[derive(Debug)]
pub(super) struct PlayerCells<'m> {
    /// Who else the distance to the goal is of, such as a crate: its place counts, too.
    led: Option<SlotId>,
    /// What leads from one subgoal to the next.
    stages: Option<&'m DistanceField>,
    velocities: Vec<Velocity>,
    /// The groups, as indices of modes.
    modes: Vec<usize>,
    /// What the goal asks of numbers.
    margins: &'m Margins,
}

/// The coordinate of a velocity, which is 0 at the lower end of its range.
#[derive(Debug, Clone, Copy)]
struct Velocity {
    index: usize,
    /// Cells per unit of distance.
    scale: f32,
    /// The coordinate where nothing moves.
    zero: f32,
}

impl<'m> PlayerCells<'m> {
    /// Those of the players of a problem, with a number of cells for the range of velocities.
    pub fn new(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>, count: f64) -> Self {
        let is_player = |slot: SlotId| problem.players().contains(&slot);
        let velocity = |(index, c): (usize, &Coordinate)| match c.quantity {
            Quantity::Var(slot, var, 1) if is_player(slot) && var.is_position() => {
                let width = (c.high - c.low).greatest(f64::MIN_POSITIVE);
                Some(Velocity { index, scale: (count * c.unit / width) as f32, zero: c.scaled(0.0) })
            }
            _ => None,
        };
        let (world, program) = (problem.sim.world(), problem.sim.program());
        let groups = problem.players().iter().flat_map(|&slot| {
            let groups = program.entities[world.slots[slot].entity].groups.ids();
            groups.filter_map(move |group| metric.mode_index(slot, group))
        });
        let led = guidance.distances.map(DistanceField::slot).filter(|slot| !is_player(*slot));
        PlayerCells {
            led,
            stages: guidance.distances.filter(|distances| distances.has_subgoals()),
            velocities: metric.coordinates().iter().enumerate().filter_map(velocity).collect(),
            modes: groups.collect(),
            margins: guidance.margins,
        }
    }

    /// A key of the players' modes at a point.
    pub fn modes(&self, point: &Point) -> u64 {
        self.modes.iter().fold(1, |key, &index| mix(key, u64::from(point.modes[index].to_bits())))
    }

    /// Whether all velocities of the players are 0 at a point.
    fn is_still(&self, point: &Point) -> bool {
        self.velocities.iter().all(|velocity| point.reals[velocity.index] == velocity.zero)
    }

    /// Whether the players have rested from a node to the one that was added last, which has a point: nothing moved, in
    /// the same modes.
    pub fn are_at_rest(
        &self,
        context: &mut SearchContext<'_>,
        from: NodeId,
        (point, before): (&Point, &mut Point),
    ) -> bool {
        let sim = context.problem.sim;
        let is_there = self.is_still(point)
            && context.problem.players().iter().all(|&slot| {
                let here = sim.position(context.reached(), slot);
                here == sim.position(context.tree.state(from, &mut context.buffer), slot)
            });
        is_there && {
            context.point(from, before);
            self.is_still(before) && self.modes(before) == self.modes(point)
        }
    }

    /// The keys of the place of the node that was added last, squares with sides of some length (px), and of its cell in it.
    pub fn keys(&self, context: &SearchContext<'_>, point: &Point, side: f64) -> [u64; 2] {
        let state = context.reached();
        let world = context.problem.sim.world();
        let mut place = 0;
        for &slot in context.problem.players() {
            place = place_of(context, slot, side, place);
            let layout = &world.layout.slots[slot];
            for id in context.problem.sim.program().entities[world.slots[slot].entity].discretes.ids() {
                place = mix(place, layout.discrete(state, id) as u64);
            }
        }
        if let Some(stages) = self.stages {
            place = mix(place, stages.subgoals(context.problem.sim, state));
        }
        place = self.led.map_or(place, |slot| place_of(context, slot, PLACE, place));
        let mut cell = mix(place, 1);
        if let Some(slot) = self.led {
            cell = place_of(context, slot, PLACE / LED, cell);
        }
        for velocity in &self.velocities {
            cell = mix(cell, (point.reals[velocity.index] * velocity.scale).floor() as i64 as u64);
        }
        cell = mix(cell, self.modes(point));
        [place, self.margins.key(context.problem.sim, state, cell)]
    }
}

/// A key with the place of an instance, a square with sides of some length (px).
fn place_of(context: &SearchContext<'_>, slot: SlotId, side: f64, key: u64) -> u64 {
    let (layout, state) = (&context.problem.sim.world().layout.slots[slot], context.reached());
    let (x, y) = (layout.var(state, VarId::X, 0), layout.var(state, VarId::Y, 0));
    let numbers = [f64::from(layout.space(state).0), (x / side).floor(), (y / side).floor()];
    numbers.into_iter().fold(key, |key, number| mix(key, number as i64 as u64))
}

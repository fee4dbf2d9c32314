//! Guided by distances: extends the places nearest to the goal through the level, less often the more often they were
//! tried.
//!
//! After SyCLoP, Plaku, Kavraki and Vardi, *Motion Planning With Dynamics by a Synergistic Combination of Layers of
//! Planning*, 2010, whose leads are paths through a decomposition of the workspace, and the archive of Ecoffet,
//! Huizinga, Lehman, Stanley and Clune, *First Return, Then Explore*, 2021. The cost of a place is its distance to the
//! goal (`distance.rs`) plus a penalty per choice, and the cheapest place is extended. So an open path is followed at
//! once; at an obstacle, the places before it are tried again and again, farther and farther back.
//!
//! With a time limit, the cost is the number of steps to the place plus a lower bound of the rest, as in a weighted A*
//! (Pohl 1970), and of the nodes with a similar velocity at a place only the earliest are kept, as the archive of
//! Ecoffet et al. keeps the shortest path to each cell.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use hashbrown::HashMap;
use rand::RngExt;

use crate::ir::{Extremes, SlotId, VarId};
use crate::reach::coverage::{PLACE, mix};
use crate::reach::distance::DistanceField;
use crate::reach::metric::{Metric, Point, Quantity};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::cells::Cells;

/// Cost of a place per place on the path to the goal, and per choice.
const DISTANCE: u64 = 4;
const CHOSEN: u64 = 1;
/// With a time limit: weight of the remaining steps, in quarters, and cost per choice; the steps to the place have
/// weight 1.
const REST: u64 = 6;
const CHOSEN_TIMED: u64 = 2;
/// Maximum delay of a node, in steps, after another at the same place with a similar velocity.
const MAX_DELAY: u32 = 8;
/// One choice in this number is a random place.
const RANDOM_ONE_IN: u32 = 8;
/// Number of cells for the range of velocities.
const VELOCITIES: f64 = 8.0;

/// A queue entry: cost, tie-breaking number, place.
type Queued = Reverse<(u64, u32, u32)>;

/// Estimates for a place.
#[derive(Debug, Clone, Copy, Default)]
struct Estimate {
    /// Distance to the goal, in places.
    places: u32,
    /// A lower bound of the steps to the goal, with a time limit.
    rest: u32,
    /// Minimum number of steps to it so far.
    soonest: u32,
}

/// A strategy that extends the places nearest to the goal.
#[derive(Debug)]
pub struct DistanceGuided<'m> {
    distances: Option<&'m DistanceField>,
    /// The coordinates of the players' velocities, with their cells per unit of distance and the offset of the first.
    velocities: Vec<(usize, f32, f32)>,
    /// The players' groups, as indices of modes.
    modes: Vec<usize>,
    cells: Cells,
    /// For each place that was ever open.
    estimates: Vec<Estimate>,
    /// With a time limit: minimum number of steps to each innermost cell.
    soonest: HashMap<u64, u32>,
    queue: BinaryHeap<Queued>,
    /// The least distance of a place of this tree.
    nearest: u32,
}

impl<'m> DistanceGuided<'m> {
    /// A strategy for a problem, with its distance field if there is one.
    pub fn new(problem: &Problem<'_>, metric: &Metric, distances: Option<&'m DistanceField>) -> Self {
        let is_player = |slot: SlotId| problem.players().contains(&slot);
        let velocity = |(index, c): (usize, &crate::reach::metric::Coordinate)| match c.quantity {
            Quantity::Var(slot, var, 1) if is_player(slot) && var.is_position() => {
                let width = (c.high - c.low).greatest(f64::MIN_POSITIVE);
                Some((index, (VELOCITIES * c.unit / width) as f32, c.scaled(c.low)))
            }
            _ => None,
        };
        let (world, program) = (problem.sim.world(), problem.sim.program());
        let groups = problem.players().iter().flat_map(|&slot| {
            let groups = program.entities[world.slots[slot].entity].groups.ids();
            groups.filter_map(move |group| metric.mode_index(slot, group))
        });
        DistanceGuided {
            distances,
            velocities: metric.coordinates().iter().enumerate().filter_map(velocity).collect(),
            modes: groups.collect(),
            cells: Cells::default(),
            estimates: Vec::new(),
            soonest: HashMap::default(),
            queue: BinaryHeap::new(),
            nearest: u32::MAX,
        }
    }

    /// Whether a node is nearer to the goal than all places of this tree.
    pub fn is_nearest(&self, context: &SearchContext<'_>, node: NodeId) -> bool {
        let (sim, state) = (context.problem.sim, context.tree.state(node));
        self.distances.is_some_and(|distances| {
            let (x, y) = sim.position(state, distances.player);
            distances.of(sim.space(state, distances.player), x, y) < self.nearest
        })
    }

    /// Forgets a node without untried inputs.
    pub fn close(&mut self, node: NodeId) {
        self.cells.remove(node);
    }

    /// The keys of a node's place and of its inner cell: velocities and modes.
    fn keys(&self, context: &SearchContext<'_>, node: NodeId, point: &Point) -> [u64; 2] {
        let state = context.tree.state(node);
        let world = context.problem.sim.world();
        let mut place = 0;
        for &slot in context.problem.players() {
            let layout = &world.layout.slots[slot];
            let (x, y) = (layout.var(state, VarId::X, 0), layout.var(state, VarId::Y, 0));
            for number in [f64::from(layout.space(state).0), (x / PLACE).floor(), (y / PLACE).floor()] {
                place = mix(place, number as i64 as u64);
            }
            for id in context.problem.sim.program().entities[world.slots[slot].entity].discretes.ids() {
                place = mix(place, layout.discrete(state, id) as u64);
            }
        }
        let mut inner = mix(place, 1);
        for &(index, scale, offset) in &self.velocities {
            inner = mix(inner, ((point.reals[index] - offset) * scale).floor() as i64 as u64);
        }
        for &index in &self.modes {
            inner = mix(inner, u64::from(point.modes[index].to_bits()));
        }
        [place, inner]
    }

    fn add(&mut self, context: &mut SearchContext<'_>, node: NodeId, point: &Point) {
        let keys = self.keys(context, node, point);
        let (depth, is_timed) = (context.tree.depth(node), context.problem.time().is_some());
        if is_timed {
            let soonest = self.soonest.entry(keys[1]).or_insert(depth);
            if depth > *soonest + MAX_DELAY {
                return;
            }
            *soonest = depth.min(*soonest);
        }
        let (place, is_new) = self.cells.add(node, &keys);
        if place as usize >= self.estimates.len() {
            let estimates = self.distances.map_or(Estimate::default(), |distances| {
                let (sim, state) = (context.problem.sim, context.tree.state(node));
                let ((x, y), space) = (sim.position(state, distances.player), sim.space(state, distances.player));
                Estimate { places: distances.of(space, x, y), rest: distances.least_steps(space, x, y), soonest: depth }
            });
            self.nearest = self.nearest.min(estimates.places);
            self.estimates.resize(place as usize + 1, estimates);
        }
        let soonest = &mut self.estimates[place as usize].soonest;
        let is_sooner = is_timed && depth < *soonest;
        *soonest = depth.min(*soonest);
        if is_new || is_sooner {
            self.enqueue(context, place);
        }
    }

    fn cost(&self, place: u32, is_timed: bool) -> u64 {
        let estimates = &self.estimates[place as usize];
        let chosen = u64::from(self.cells.chosen(place));
        if is_timed {
            u64::from(estimates.soonest) + u64::from(estimates.rest) * REST / 4 + chosen * CHOSEN_TIMED
        } else {
            u64::from(estimates.places) * DISTANCE + chosen * CHOSEN
        }
    }

    /// Queues an open place by its current cost.
    fn enqueue(&mut self, context: &mut SearchContext<'_>, place: u32) {
        let cost = self.cost(place, context.problem.time().is_some());
        self.queue.push(Reverse((cost, context.rng.random(), place)));
    }

    /// The cheapest open place.
    fn cheapest(&mut self, is_timed: bool) -> Option<u32> {
        while let Some(Reverse((cost, _, place))) = self.queue.pop() {
            // Skip entries that are outdated or closed.
            if self.cost(place, is_timed) == cost && !self.cells.inside(place).is_empty() {
                return Some(place);
            }
        }
        None
    }
}

impl Strategy for DistanceGuided<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        let place = if context.rng.random_ratio(1, RANDOM_ONE_IN) {
            let open = self.cells.first();
            if open.is_empty() {
                return None;
            }
            open[context.rng.random_range(0..open.len())]
        } else {
            self.cheapest(context.problem.time().is_some())?
        };
        self.cells.choose(place);
        let inner = self.cells.draw(context, self.cells.inside(place))?;
        self.cells.choose(inner);
        let node = self.cells.draw_node(context, inner);
        let choice = context.draw_untried_holding(node);
        if context.tree.untried(node) == 0 {
            self.cells.remove(node);
        }
        if !self.cells.inside(place).is_empty() {
            self.enqueue(context, place);
        }
        choice
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, point) => {
                self.cells.clear();
                self.estimates.clear();
                self.soonest.clear();
                self.queue.clear();
                self.nearest = u32::MAX;
                self.add(context, root, point);
            }
            Growth::Added(node, point) => self.add(context, node, point),
            Growth::Failed => {}
        }
    }

    fn bytes(&self) -> usize {
        self.cells.bytes()
            + self.estimates.capacity() * size_of::<Estimate>()
            + self.soonest.capacity() * 16
            + self.queue.capacity() * size_of::<Queued>()
    }
}

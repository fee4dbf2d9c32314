//! Led by distances: grows where the players are nearest to the goal through the level, the more reluctantly the oftener
//! that was tried.
//!
//! After SyCLoP, Plaku, Kavraki and Vardi, *Motion Planning With Dynamics by a Synergistic Combination of Layers of
//! Planning*, 2010, whose leads are ways through a decomposition of the workspace, and the archive of Ecoffet, Huizinga,
//! Lehman, Stanley and Clune, *First Return, Then Explore*, 2021. A place of the players costs its distance to the goal
//! (`distance.rs`) and something for each time that it was chosen, and the cheapest place grows. So a way that is open is
//! followed at once, and where it is not, what lies before it is tried again and again, farther and farther back.
//!
//! Where there is a time to keep, a place costs instead the steps that lead to it and the least that the rest takes, as in a
//! weighted A* (Pohl 1970), and of what comes to a place with about the same velocity only the soonest is kept, as the
//! archive of Ecoffet and others keeps the shortest way to each cell.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use hashbrown::HashMap;
use rand::RngExt;

use crate::ir::{SlotId, VarId};
use crate::reach::coverage::{PLACE, mixed};
use crate::reach::distance::Distances;
use crate::reach::metric::{Metric, Point, Quantity};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::cells::Cells;

/// What a place costs for each place on the way from it to the goal, and for each time that it was chosen.
const DISTANCE: u64 = 4;
const CHOSEN: u64 = 1;
/// Where there is a time to keep, a place costs the steps to it, the rest of the way, in quarters of the least steps, and so
/// much for each time that it was chosen.
const REST: u64 = 6;
const TRIED: u64 = 2;
/// What comes so many steps later than another to a place, with about the same velocity, is given up.
const LATE: u32 = 8;
/// One choice in so many is of any place.
const ANY: u32 = 8;
/// Velocities are told apart by cells, so many over their range.
const VELOCITIES: f64 = 8.0;

/// A place in the queue: what it costs, a number that breaks ties, and the place.
type Queued = Reverse<(u64, u32, u32)>;

/// How far away a place is.
#[derive(Debug, Clone, Copy, Default)]
struct Far {
    /// How many places from the goal.
    places: u32,
    /// The least steps to it, where there is a time to keep.
    rest: u32,
    /// After how many steps it was reached at the soonest.
    soonest: u32,
}

/// Grows the places nearest to the goal.
#[derive(Debug)]
pub struct Lead<'m> {
    distances: Option<&'m Distances>,
    /// The players' velocities: the coordinates, with their cells along a distance of 1 and where the first begins.
    velocities: Vec<(usize, f32, f32)>,
    /// The players' groups, by their places among the modes.
    modes: Vec<usize>,
    cells: Cells,
    /// Of each place that was ever open.
    far: Vec<Far>,
    /// Where there is a time to keep: of each innermost cell, after how many steps it was reached at the soonest.
    soonest: HashMap<u64, u32>,
    queue: BinaryHeap<Queued>,
}

impl<'m> Lead<'m> {
    /// A strategy for a problem, with the distances in its level if there are any.
    pub fn new(problem: &Problem<'_>, metric: &Metric, distances: Option<&'m Distances>) -> Self {
        let is_player = |slot: SlotId| problem.players().contains(&slot);
        let velocity = |(index, c): (usize, &crate::reach::metric::Coordinate)| match c.quantity {
            Quantity::Var(slot, var, 1) if is_player(slot) && var.is_position() => {
                let width = (c.high - c.low).max(f64::MIN_POSITIVE);
                Some((index, (VELOCITIES * c.unit / width) as f32, c.scaled(c.low)))
            }
            _ => None,
        };
        let (world, program) = (problem.sim.world(), problem.sim.program());
        let groups = problem.players().iter().flat_map(|&slot| {
            let groups = program.entities[world.slots[slot].entity].groups.ids();
            groups.filter_map(move |group| metric.mode_index(slot, group))
        });
        Lead {
            distances,
            velocities: metric.coordinates().iter().enumerate().filter_map(velocity).collect(),
            modes: groups.collect(),
            cells: Cells::default(),
            far: Vec::new(),
            soonest: HashMap::default(),
            queue: BinaryHeap::new(),
        }
    }

    /// The cell of a node's place and of what the players do there.
    fn keys(&self, context: &SearchContext<'_>, node: NodeId, point: &Point) -> [u64; 2] {
        let state = context.tree.state(node);
        let world = context.problem.sim.world();
        let mut place = 0;
        for &slot in context.problem.players() {
            let layout = &world.layout.slots[slot];
            let (x, y) = (layout.var(state, VarId::X, 0), layout.var(state, VarId::Y, 0));
            for number in [f64::from(layout.space(state).0), (x / PLACE).floor(), (y / PLACE).floor()] {
                place = mixed(place, number as i64 as u64);
            }
            for id in context.problem.sim.program().entities[world.slots[slot].entity].discretes.ids() {
                place = mixed(place, layout.discrete(state, id) as u64);
            }
        }
        let mut inner = mixed(place, 1);
        for &(index, scale, offset) in &self.velocities {
            inner = mixed(inner, ((point.reals[index] - offset) * scale).floor() as i64 as u64);
        }
        for &index in &self.modes {
            inner = mixed(inner, u64::from(point.modes[index].to_bits()));
        }
        [place, inner]
    }

    fn add(&mut self, context: &mut SearchContext<'_>, node: NodeId, point: &Point) {
        let keys = self.keys(context, node, point);
        let (depth, is_timed) = (context.tree.depth(node), context.problem.time().is_some());
        if is_timed {
            let soonest = self.soonest.entry(keys[1]).or_insert(depth);
            if depth > *soonest + LATE {
                return;
            }
            *soonest = depth.min(*soonest);
        }
        let (place, is_new) = self.cells.add(node, &keys);
        if place as usize >= self.far.len() {
            let far = self.distances.map_or(Far::default(), |distances| {
                let (sim, state) = (context.problem.sim, context.tree.state(node));
                let ((x, y), space) = (sim.position(state, distances.player), sim.space(state, distances.player));
                Far { places: distances.of(space, x, y), rest: distances.least_steps(space, x, y), soonest: depth }
            });
            self.far.resize(place as usize + 1, far);
        }
        let soonest = &mut self.far[place as usize].soonest;
        let is_sooner = is_timed && depth < *soonest;
        *soonest = depth.min(*soonest);
        if is_new || is_sooner {
            self.enqueue(context, place);
        }
    }

    fn cost(&self, place: u32, is_timed: bool) -> u64 {
        let far = &self.far[place as usize];
        let chosen = u64::from(self.cells.chosen(place));
        if is_timed {
            u64::from(far.soonest) + u64::from(far.rest) * REST / 4 + chosen * TRIED
        } else {
            u64::from(far.places) * DISTANCE + chosen * CHOSEN
        }
    }

    /// Puts an open place into the queue, by what it costs now.
    fn enqueue(&mut self, context: &mut SearchContext<'_>, place: u32) {
        let cost = self.cost(place, context.problem.time().is_some());
        self.queue.push(Reverse((cost, context.rng.random(), place)));
    }

    /// The cheapest open place.
    fn cheapest(&mut self, is_timed: bool) -> Option<u32> {
        while let Some(Reverse((cost, _, place))) = self.queue.pop() {
            // What was put in again since, or is done with, is no longer there.
            if self.cost(place, is_timed) == cost && !self.cells.inside(place).is_empty() {
                return Some(place);
            }
        }
        None
    }
}

impl Strategy for Lead<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        let place = if context.rng.random_ratio(1, ANY) {
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
        let choice = context.draw_untried(node);
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
                self.far.clear();
                self.soonest.clear();
                self.queue.clear();
                self.add(context, root, point);
            }
            Growth::Added(node, point) => self.add(context, node, point),
            Growth::Failed => {}
        }
    }

    fn bytes(&self) -> usize {
        self.cells.bytes()
            + self.far.capacity() * size_of::<Far>()
            + self.soonest.capacity() * 16
            + self.queue.capacity() * size_of::<Queued>()
    }
}

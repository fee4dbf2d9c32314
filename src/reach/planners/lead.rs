//! Led by distances: grows where the players are nearest to the goal through the level, the more reluctantly the oftener
//! that was tried.
//!
//! After SyCLoP, Plaku, Kavraki and Vardi, *Motion Planning With Dynamics by a Synergistic Combination of Layers of
//! Planning*, 2010, whose leads are ways through a decomposition of the workspace, and the archive of Ecoffet, Huizinga,
//! Lehman, Stanley and Clune, *First Return, Then Explore*, 2021. A place of the players costs its distance to the goal
//! (`distance.rs`) and something for each time that it was chosen, and the cheapest place grows. So a way that is open is
//! followed at once, and where it is not, what lies before it is tried again and again, farther and farther back.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::RngExt;

use crate::ir::{Id, SlotId, VarId};
use crate::reach::coverage::{PLACE, mixed};
use crate::reach::distance::Distances;
use crate::reach::ground::Ground;
use crate::reach::metric::{Metric, Point, Quantity};
use crate::reach::problem::Problem;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::cells::Cells;

/// What a place costs for each place on the way from it to the goal, and for each time that it was chosen.
const DISTANCE: u64 = 4;
const CHOSEN: u64 = 1;
/// One choice in so many is of any place.
const ANY: u32 = 8;
/// Velocities are told apart by cells, so many over their range.
const VELOCITIES: f64 = 8.0;

/// A place in the queue: what it costs, a number that breaks ties, and the place.
type Queued = Reverse<(u64, u32, u32)>;

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
    far: Vec<u32>,
    queue: BinaryHeap<Queued>,
}

impl<'m> Lead<'m> {
    /// A strategy for a problem, with the distances in its level if there are any.
    pub fn new(problem: &Problem<'_>, metric: &Metric, distances: Option<&'m Distances>) -> Self {
        let is_player = |slot: SlotId| problem.players().contains(&slot);
        let velocity = |(index, c): (usize, &crate::reach::metric::Coordinate)| match c.quantity {
            Quantity::Var(slot, var, 1) if is_player(slot) && var.index() < 2 => {
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
            queue: BinaryHeap::new(),
        }
    }

    /// The cell of a node's place and of what the players do there.
    fn keys(&self, ground: &Ground<'_>, node: NodeId, point: &Point) -> [u64; 2] {
        let state = ground.tree.state(node);
        let world = ground.problem.sim.world();
        let mut place = 0;
        for &slot in ground.problem.players() {
            let layout = &world.layout.slots[slot];
            let (x, y) = (layout.var(state, VarId(0), 0), layout.var(state, VarId(1), 0));
            for number in [f64::from(layout.space(state).0), (x / PLACE).floor(), (y / PLACE).floor()] {
                place = mixed(place, number as i64 as u64);
            }
            for id in ground.problem.sim.program().entities[world.slots[slot].entity].discretes.ids() {
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

    fn add(&mut self, ground: &mut Ground<'_>, node: NodeId, point: &Point) {
        let keys = self.keys(ground, node, point);
        let (place, is_new) = self.cells.add(node, &keys);
        if !is_new {
            return;
        }
        if place as usize >= self.far.len() {
            let distance = self.distances.map_or(0, |distances| {
                let (sim, state) = (ground.problem.sim, ground.tree.state(node));
                let (x, y) = sim.position(state, distances.player);
                distances.of(sim.space(state, distances.player), x, y)
            });
            self.far.resize(place as usize + 1, distance);
        }
        self.enqueue(ground, place);
    }

    fn cost(&self, place: u32) -> u64 {
        u64::from(self.far[place as usize]) * DISTANCE + u64::from(self.cells.chosen(place)) * CHOSEN
    }

    /// Puts an open place into the queue, by what it costs now.
    fn enqueue(&mut self, ground: &mut Ground<'_>, place: u32) {
        self.queue.push(Reverse((self.cost(place), ground.rng.random(), place)));
    }

    /// The cheapest open place.
    fn cheapest(&mut self) -> Option<u32> {
        while let Some(Reverse((cost, _, place))) = self.queue.pop() {
            // What was put in again since, or is done with, is no longer there.
            if self.cost(place) == cost && !self.cells.inside(place).is_empty() {
                return Some(place);
            }
        }
        None
    }
}

impl Strategy for Lead<'_> {
    fn choose(&mut self, ground: &mut Ground<'_>, _toward: &Point) -> Option<Choice> {
        let place = if ground.rng.random_ratio(1, ANY) {
            let open = self.cells.first();
            if open.is_empty() {
                return None;
            }
            open[ground.rng.random_range(0..open.len())]
        } else {
            self.cheapest()?
        };
        self.cells.choose(place);
        let inner = self.cells.draw(ground, self.cells.inside(place))?;
        self.cells.choose(inner);
        let node = self.cells.draw_node(ground, inner);
        let choice = ground.draw_untried(node);
        if ground.tree.untried(node) == 0 {
            self.cells.remove(node);
        }
        if !self.cells.inside(place).is_empty() {
            self.enqueue(ground, place);
        }
        choice
    }

    fn learn(&mut self, ground: &mut Ground<'_>, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, point) => {
                self.cells.clear();
                self.far.clear();
                self.queue.clear();
                self.add(ground, root, point);
            }
            Growth::Added(node, point) => self.add(ground, node, point),
            Growth::Failed => {}
        }
    }

    fn samples(&self) -> bool {
        false
    }

    fn bytes(&self) -> usize {
        self.cells.bytes() + self.far.capacity() * 4 + self.queue.capacity() * size_of::<Queued>()
    }
}

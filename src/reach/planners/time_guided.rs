//! Guided by time: extends the node from which the goal seems to be reached first.
//!
//! A weighted A* (Pohl 1970) over states: the cost of a node is the number of steps to it plus an estimate of the rest. The
//! estimate is the distance to the goal (`distance.rs`) at the pace at which the tree has come nearer so far, at least the
//! lower bound of the time. Of nodes in one cell, with similar positions and velocities and the same modes, only the
//! earliest is extended, as in the hybrid A* of Dolgov, Thrun, Montemerlo and Diebel, *Path Planning for Autonomous
//! Vehicles in Unknown Semi-structured Environments*, 2010. Several trees grow side by side, which differ in how they weigh
//! the rest and in how fine their cells are. Each is begun anew, larger, as in the restarts of Richter, Thayer and Ruml,
//! *The Joy of Forgetting*, 2010, or, if nothing was left to extend, with cells and holds half as large.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use hashbrown::HashMap;

use crate::reach::coverage::PLACE;
use crate::reach::distance::DistanceField;
use crate::reach::metric::{Metric, Point};
use crate::reach::problem::Problem;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

use super::Guidance;
use super::player_cells::PlayerCells;

/// How a tree searches.
#[derive(Debug, Clone, Copy)]
struct Manner {
    /// The weight of the rest at the pace so far, and of the lower bound of its time, in eighths.
    weight: u32,
    bound: u32,
    /// The side of a cell, px.
    cell: f64,
    /// For how long inputs are held, steps.
    hold: u16,
}

/// The manners of the trees: the first finds fast ways through open levels, the others any way through more.
const MANNERS: [Manner; 3] = [FAST, BROAD, COARSE];
/// With a time limit, which a way without detours has to keep.
const TIMED: [Manner; 4] = [FAST, Manner { bound: 10, ..FAST }, BROAD, COARSE];
const FAST: Manner = Manner { weight: 8, bound: 12, cell: PLACE / 2.0, hold: 8 };
const BROAD: Manner = Manner { weight: 16, hold: 12, ..FAST };
const COARSE: Manner = Manner { weight: 20, cell: PLACE, hold: 16, ..FAST };
/// Number of nodes of a first tree; the next one has twice as many.
const NODES: u64 = 32_000;
/// Maximum number of doublings.
const DOUBLINGS: u32 = 16;
/// After as many trees in a row that had nothing left to extend, each finer than the one before, no more follow.
const WHOLE: u32 = 5;
/// Number of cells for the range of velocities.
const VELOCITIES: f64 = 16.0;

/// A queue entry: its cost, the latest first, and what gives the cost.
type Queued = Reverse<(u64, Reverse<u32>, Candidate)>;

/// A node that may be extended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    node: NodeId,
    depth: u32,
    /// A lower bound of the steps to the goal.
    rest: u32,
    /// The distance to the goal, in places.
    places: u32,
}

/// A strategy that extends the node from which the goal seems to be reached first.
#[derive(Debug)]
pub struct TimeGuided<'m> {
    distances: Option<&'m DistanceField>,
    players: PlayerCells<'m>,
    manner: Manner,
    /// Number of trees, and of the last ones that had nothing left to extend.
    trees: u32,
    whole: u32,
    /// Number of nodes to which this one grows, and that it has.
    nodes: u64,
    added: u32,
    /// The least depth in each cell.
    soonest: HashMap<u64, u32>,
    queue: BinaryHeap<Queued>,
    /// Steps per place so far.
    pace: f64,
    /// The distance of the root, and the least distance of a node with its depth.
    start: u32,
    nearest: (u32, u32),
    /// Number of nodes when the queue was last put into order.
    ordered: u32,
}

impl<'m> TimeGuided<'m> {
    /// The strategies for a problem, one for each manner, with what leads to its goal.
    pub fn of_all_manners(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>) -> Vec<Self> {
        let manners: &[Manner] = if problem.time().is_some() { &TIMED } else { &MANNERS };
        manners.iter().map(|manner| TimeGuided::new(problem, metric, guidance, *manner)).collect()
    }

    fn new(problem: &Problem<'_>, metric: &Metric, guidance: Guidance<'m>, manner: Manner) -> Self {
        TimeGuided {
            distances: guidance.distances,
            players: PlayerCells::new(problem, metric, guidance, VELOCITIES),
            manner,
            trees: 0,
            whole: 0,
            nodes: 0,
            added: 0,
            soonest: HashMap::default(),
            queue: BinaryHeap::new(),
            pace: 0.0,
            start: 0,
            nearest: (u32::MAX, 0),
            ordered: 0,
        }
    }

    /// Begins a tree.
    fn begin(&mut self) {
        // Of a root alone, the last input is tried before it leaves the queue.
        let is_whole = self.queue.is_empty() || self.added == 1;
        self.whole = if self.trees > 0 && is_whole { self.whole + 1 } else { 0 };
        if self.whole > 0 {
            self.manner.hold = (self.manner.hold / 2).max(1);
            self.manner.cell /= 2.0;
        }
        self.soonest.clear();
        self.queue.clear();
        self.nodes = NODES << self.trees.min(DOUBLINGS);
        self.trees += 1;
        (self.added, self.ordered, self.nearest, self.pace) = (0, 0, (u32::MAX, 0), 0.0);
    }

    fn add(&mut self, context: &SearchContext<'_>, node: NodeId, point: &Point) {
        self.added += 1;
        let [_, key] = self.players.keys(context, point, self.manner.cell);
        let depth = context.tree.depth(node);
        let soonest = self.soonest.entry(key).or_insert(u32::MAX);
        if depth >= *soonest {
            return;
        }
        *soonest = depth;
        let (sim, state) = (context.problem.sim, context.reached());
        let (rest, places) =
            self.distances.map_or((0, 0), |distances| (distances.least_steps(sim, state), distances.of(sim, state)));
        if self.added == 1 {
            self.start = places;
        }
        if places < self.nearest.0 {
            self.nearest = (places, depth);
        }
        // The pace is measured anew from time to time: all costs change with it.
        if self.added >= self.ordered * 2 + 64 {
            self.ordered = self.added;
            self.pace = f64::from(self.nearest.1) / f64::from(self.start.saturating_sub(self.nearest.0).max(1));
            let queue = std::mem::take(&mut self.queue);
            self.queue =
                queue.into_iter().map(|Reverse((_, late, other))| Reverse((self.cost(&other), late, other))).collect();
        }
        let candidate = Candidate { node, depth, rest, places };
        self.queue.push(Reverse((self.cost(&candidate), Reverse(self.added), candidate)));
    }

    /// The cost of a candidate, in eighths of a step.
    fn cost(&self, candidate: &Candidate) -> u64 {
        let estimate = f64::from(candidate.places) * self.pace * f64::from(self.manner.weight);
        let bound = u64::from(candidate.rest) * u64::from(self.manner.bound);
        u64::from(candidate.depth) * 8 + bound.max(estimate as u64)
    }
}

impl Strategy for TimeGuided<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        while let Some(Reverse((_, _, candidate))) = self.queue.peek() {
            if let Some(choice) = context.draw_untried_holding(candidate.node) {
                return Some(Choice { hold: self.manner.hold.clamp(context.hold.0, context.hold.1), ..choice });
            }
            self.queue.pop();
        }
        None
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, point) => {
                self.begin();
                self.add(context, root, point);
            }
            Growth::Added(node, point) => self.add(context, node, point),
            Growth::Failed | Growth::Late | Growth::Known(..) => {}
        }
    }

    fn counts_steps(&self) -> bool {
        true
    }

    fn follows(&self) -> bool {
        self.manner.weight > FAST.weight
    }

    fn is_over(&self) -> bool {
        self.queue.is_empty() || u64::from(self.added) >= self.nodes
    }

    fn is_spent(&self) -> bool {
        self.whole >= WHOLE
    }

    fn bytes(&self) -> usize {
        self.soonest.capacity() * 16 + self.queue.capacity() * size_of::<Queued>()
    }
}

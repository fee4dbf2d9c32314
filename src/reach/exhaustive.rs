//! Exhaustion: all that can be done when inputs change every so many steps, each state once. Many worlds are finite under
//! a fixed step; then "no" is proven for that granularity of inputs. Breadth first, the first way that is found is a
//! shortest one; best first, what is nearest to the goal goes on.
//!
//! States are the same if all their bytes are: everything that the next step reads is part of a state (`sim/state.rs`).
//! Inputs are all that anything ever reads.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::hash::Hasher;

use hashbrown::HashTable;
use rustc_hash::FxHasher;

use super::ground::{Extension, Ground, Notes};
use super::metric::Point;
use super::outcome::Plan;
use super::planners::Planner;
use super::region::GoalRegion;
use super::searcher::{Ending, Searcher};
use super::strategy::Choice;
use super::tree::NodeId;

/// What looking for a state among those that are known costs, in units of work.
const TURN: u64 = 64;

/// In which order states are extended.
#[derive(Debug)]
enum Order {
    /// In that in which they were reached: by the number of inputs on the way. After the nodes of a layer, which ends
    /// here, a way that was found is a shortest one.
    Breadth { layer_end: usize },
    /// Those nearest to the goal first.
    Best(BinaryHeap<Reverse<Ranked>>),
}

/// A node and its squared distance to the goal.
#[derive(Debug, PartialEq)]
struct Ranked(f32, u32);

impl Eq for Ranked {}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// All states that were reached.
pub(super) struct Exhaustive<'a> {
    ground: Ground<'a>,
    region: GoalRegion,
    known: HashTable<u32>,
    order: Order,
    /// The node to extend, and its next input.
    next: (u32, usize),
    /// The shortest way in the layer that is looked at.
    found: Option<(Choice, u16)>,
    point: Point,
}

impl<'a> Exhaustive<'a> {
    /// Breadth first, or the nearest to the goal first.
    pub fn new(ground: Ground<'a>, best_first: bool) -> Self {
        let order = if best_first { Order::Best(BinaryHeap::new()) } else { Order::Breadth { layer_end: 0 } };
        Exhaustive {
            region: GoalRegion::new(ground.problem, ground.metric),
            ground,
            known: HashTable::new(),
            order,
            next: (0, 0),
            found: None,
            point: Point::default(),
        }
    }

    fn plant(&mut self) {
        self.ground.notes.statistics.trees += 1;
        for start in 0..self.ground.starts() {
            let root = self.ground.plant(start, false);
            self.note(root, hashed(self.ground.tree.state(root)));
        }
        match &mut self.order {
            Order::Breadth { layer_end } => *layer_end = self.ground.tree.len(),
            Order::Best(open) => self.next = (open.pop().map_or(0, |Reverse(best)| best.1), 0),
        }
    }

    /// Keeps a new node, whose state has this hash.
    fn note(&mut self, node: NodeId, hash: u64) {
        let tree = &self.ground.tree;
        self.known.insert_unique(hash, node.0, |id| hashed(tree.state(NodeId(*id))));
        if let Order::Best(open) = &mut self.order {
            self.ground.point(node, &mut self.point);
            open.push(Reverse(Ranked(self.region.distance(&self.point), node.0)));
        }
    }

    /// Extends a node by its next input; gives whether nothing is left to extend.
    fn turn(&mut self) -> bool {
        let node = NodeId(self.next.0);
        let choice = Choice { node, input: self.next.1, hold: self.ground.hold.0 };
        match self.ground.extend(choice) {
            Extension::Dead => {}
            Extension::Goal(steps) => {
                if self.found.is_none_or(|(_, known)| steps < known) {
                    self.found = Some((choice, steps));
                }
            }
            Extension::Open => {
                let state = self.ground.reached();
                let tree = &self.ground.tree;
                let hash = hashed(state);
                let is_known = self.known.find(hash, |id| tree.state(NodeId(*id)) == state).is_some();
                if !is_known {
                    let id = self.ground.add(choice, false);
                    self.note(id, hash);
                }
            }
        }
        self.next.1 += 1;
        if self.next.1 < self.ground.inputs(node) {
            return false;
        }
        match &mut self.order {
            Order::Breadth { .. } => {
                self.next = (self.next.0 + 1, 0);
                self.next.0 as usize == self.ground.tree.len()
            }
            Order::Best(open) => match open.pop() {
                Some(Reverse(best)) => {
                    self.next = (best.1, 0);
                    false
                }
                None => true,
            },
        }
    }

    /// A way that was found, as soon as there can be no shorter one, or at once where that is not asked for.
    fn found(&mut self) -> Option<Plan> {
        if let Order::Breadth { layer_end } = &mut self.order {
            if (self.next.0 as usize) < *layer_end {
                return None;
            }
            *layer_end = self.ground.tree.len();
        }
        // Starts that are not the initial state have had steps of different number.
        let is_first = matches!(self.order, Order::Breadth { .. }) && self.ground.starts() == 1;
        // A shorter way may lead around outside of the search window.
        let is_shortest = is_first && self.ground.notes.cuts.is_empty();
        let (choice, steps) = self.found.take()?;
        self.ground.plan(choice, steps, is_shortest.then_some(self.ground.hold.0))
    }
}

impl Searcher for Exhaustive<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        if self.ground.tree.is_empty() {
            self.plant();
        }
        let until = self.ground.notes.statistics.nodes.saturating_add(nodes);
        // A closed world adds no nodes, but still takes its time.
        let mut patience = nodes.saturating_mul(16);
        while self.ground.notes.statistics.nodes < until && patience > 0 {
            patience -= 1;
            let is_over = self.turn();
            // What was cut short proves nothing.
            if self.ground.meter.spend(TURN) {
                return Ending::Stopped;
            }
            if let Some(plan) = self.found() {
                return Ending::Reached(plan);
            }
            if is_over {
                // Within a time, what was reached late may have been left that could also be reached soon.
                let is_early = matches!(self.order, Order::Breadth { .. }) && self.ground.starts() == 1;
                let is_timely = self.ground.problem.time().is_none() || is_early;
                let is_whole = !self.ground.controls.truncated && self.ground.notes.cuts.is_empty();
                let is_proof = is_whole && self.ground.notes.fault.is_none() && is_timely;
                let states = self.ground.tree.len() as u64;
                return if is_proof { Ending::Exhausted(states, self.ground.hold.0) } else { Ending::Spent };
            }
        }
        Ending::Paused
    }

    fn nodes(&self) -> u64 {
        self.ground.notes.statistics.nodes
    }

    fn places(&self) -> u64 {
        self.ground.notes.coverage.count().places
    }

    fn report(&self, notes: &mut Notes) {
        self.ground.report(notes);
    }

    fn bytes(&self) -> usize {
        let open = match &self.order {
            Order::Breadth { .. } => 0,
            Order::Best(open) => open.capacity() * size_of::<Ranked>(),
        };
        self.ground.bytes() + self.known.capacity() * 5 + open
    }

    fn planner(&self) -> &'static str {
        match self.order {
            Order::Breadth { .. } => Planner::Exhaustive.name(),
            Order::Best(_) => Planner::BestFirst.name(),
        }
    }
}

fn hashed(state: &[u8]) -> u64 {
    let mut hasher = FxHasher::default();
    hasher.write(state);
    hasher.finish()
}

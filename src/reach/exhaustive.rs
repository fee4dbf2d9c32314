//! Exhaustive search: tries all inputs and visits each state once. Many worlds are finite under a fixed step, so it can
//! prove a "no". Breadth first finds shortest paths; best first extends the state nearest to the goal.
//!
//! The inputs of a question are held for at least `min_hold` steps and can then change at any step: an automaton
//! beside the world. Its state is the remaining hold and, where it matters, the input. During a hold there is no
//! choice, so nodes exist only after it: from there the input continues for one step, or a new one starts and is held
//! for its minimum. The result of a new input does not depend on the previous one, so it is tried once per state. If
//! inputs can change at every step, a node is just a state.
//!
//! Inputs that change only every few steps lead to fewer states, which are visited sooner; a failure with them says
//! nothing about other inputs.
//!
//! Two states are equal if all their bytes are: everything that the next step reads is part of a state
//! (`sim/state.rs`). The inputs are all that any mode reads.

use std::cmp::{Ordering, Reverse};
use std::collections::{BinaryHeap, VecDeque};
use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use super::metric::Point;
use super::outcome::{Cut, Exhaustion, Plan};
use super::planners::Planner;
use super::region::GoalRegion;
use super::search_context::{Extension, Notes, SearchContext};
use super::searcher::{Ending, Searcher};
use super::strategy::Choice;
use super::tree::NodeId;

/// The cost of looking up a state, in units of work.
const LOOKUP_WORK: u64 = 64;
/// No input is held.
const NONE: u16 = u16::MAX;

/// What tells nodes with equal states apart: the held input, and the step where it decides what nature draws.
type Mark = (u16, u64);

/// Nothing does.
const UNMARKED: Mark = (NONE, 0);

/// When inputs change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    /// At any step after they were held for this number of steps: all inputs that a question admits.
    After(u16),
    /// Only every this number of steps.
    Every(u16),
}

impl Change {
    /// Number of steps for which a new input is held.
    fn hold(self) -> u16 {
        match self {
            Change::After(steps) | Change::Every(steps) => steps.max(1),
        }
    }

    /// Whether a held input can continue where a new one would have to be held.
    pub fn continues(self) -> bool {
        matches!(self, Change::After(2..))
    }
}

/// The order of extension.
#[derive(Debug)]
enum Order {
    /// By the number of steps (Dial, *Algorithm 360: Shortest-path forest with topological ordering*, 1969): the nodes
    /// of each number, starting at `first`.
    Breadth { first: u32, layers: VecDeque<Layer> },
    /// By the distance to the goal.
    Best(BinaryHeap<Reverse<Ranked>>),
}

/// The nodes at a number of steps, and how many of them were taken.
#[derive(Debug, Default)]
struct Layer {
    nodes: Vec<u32>,
    taken: usize,
}

impl Order {
    fn push(&mut self, node: NodeId, depth: u32, distance: f32) {
        match self {
            Order::Breadth { first, layers } => {
                if layers.is_empty() {
                    *first = depth;
                }
                // Starts come in any order of depth.
                while depth < *first {
                    layers.push_front(Layer::default());
                    *first -= 1;
                }
                let at = (depth - *first) as usize;
                if at >= layers.len() {
                    layers.resize_with(at + 1, Layer::default);
                }
                layers[at].nodes.push(node.0);
            }
            Order::Best(open) => open.push(Reverse(Ranked(distance, node.0))),
        }
    }

    fn pop(&mut self) -> Option<NodeId> {
        match self {
            Order::Breadth { first, layers } => loop {
                let layer = layers.front_mut()?;
                if let Some(&node) = layer.nodes.get(layer.taken) {
                    layer.taken += 1;
                    return Some(NodeId(node));
                }
                layers.pop_front();
                *first += 1;
            },
            Order::Best(open) => open.pop().map(|Reverse(best)| NodeId(best.1)),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Order::Breadth { layers, .. } => layers.iter().map(|layer| layer.nodes.capacity() * 4).sum(),
            Order::Best(open) => open.capacity() * size_of::<Ranked>(),
        }
    }
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

/// The node being extended.
#[derive(Debug, Clone, Copy)]
struct Expansion {
    node: NodeId,
    /// Whether the held input still has to be continued.
    continues: bool,
    /// The range of new inputs to try.
    new_inputs: (usize, usize),
}

/// An exhaustive search.
pub(super) struct Exhaustive<'a> {
    context: SearchContext<'a>,
    region: GoalRegion,
    change: Change,
    hashes: DefaultHashBuilder,
    /// The hash of each node's state.
    state_hashes: Vec<u64>,
    /// The nodes, by state and mark.
    known: HashTable<u32>,
    /// If held inputs can continue: one node for each state at which new inputs were tried.
    expanded: HashTable<u32>,
    /// If held inputs can continue, or nature is foretold: what tells each node apart.
    marks: Vec<Mark>,
    order: Order,
    expansion: Option<Expansion>,
    /// The shortest path so far: its steps, its last choice and the steps of that.
    found: Option<(u32, Choice, u16)>,
    point: Point,
    /// For the states of nodes.
    buffer: Vec<u8>,
}

impl<'a> Exhaustive<'a> {
    /// Searches breadth first, or best first.
    pub fn new(context: SearchContext<'a>, change: Change, best_first: bool) -> Self {
        let order = match best_first {
            true => Order::Best(BinaryHeap::new()),
            false => Order::Breadth { first: 0, layers: VecDeque::new() },
        };
        Exhaustive {
            region: GoalRegion::new(context.problem, context.metric),
            context,
            change,
            hashes: DefaultHashBuilder::default(),
            state_hashes: Vec::new(),
            known: HashTable::new(),
            expanded: HashTable::new(),
            marks: Vec::new(),
            order,
            expansion: None,
            found: None,
            point: Point::default(),
            buffer: Vec::new(),
        }
    }

    fn is_breadth_first(&self) -> bool {
        matches!(self.order, Order::Breadth { .. })
    }

    fn add_roots(&mut self) {
        self.context.notes.statistics.trees += 1;
        for start in 0..self.context.starts() {
            let root = self.context.add_root(start, false);
            let held = match self.change.continues() {
                true => self.context.held_at_start(root).unwrap_or(NONE),
                false => NONE,
            };
            let mark = (held, self.context.first_step(root));
            self.keep(root, mark, self.hashes.hash_one(self.context.reached()));
        }
    }

    /// Stores the node that was added last with its mark, and the hash of its state.
    fn keep(&mut self, node: NodeId, mark: Mark, state_hash: u64) {
        let distance = match self.order {
            Order::Breadth { .. } => 0.0,
            Order::Best(_) => {
                self.context.point(node, &mut self.point);
                self.region.distance(&self.point)
            }
        };
        self.order.push(node, self.context.tree.depth(node), distance);
        if self.change.continues() || self.context.problem.is_foretold() {
            self.marks.push(mark);
        }
        self.state_hashes.push(state_hash);
        let (tree, marks, state_hashes) = (&self.context.tree, &self.marks, &self.state_hashes);
        let rehash = |id: &u32| self.hashes.hash_one((state_hashes[*id as usize], mark_of(marks, *id)));
        let hash = rehash(&node.0);
        let state = self.context.reached();
        let is_same = |id: &u32| mark_of(marks, *id) == mark && tree.has_state(NodeId(*id), state);
        match self.known.find_mut(hash, is_same) {
            // The same state was reached later before.
            Some(later) => *later = node.0,
            None => {
                self.known.insert_unique(hash, node.0, rehash);
            }
        }
    }

    /// The next node to extend, if any.
    fn next(&mut self) -> Option<Expansion> {
        loop {
            let node = self.order.pop()?;
            let inputs = self.context.inputs(node);
            if !self.change.continues() {
                return Some(Expansion { node, continues: false, new_inputs: (0, inputs) });
            }
            let (tree, hashes, state_hashes) = (&self.context.tree, &self.hashes, &self.state_hashes);
            let (state, (held, step)) = (tree.state(node, &mut self.buffer), mark_of(&self.marks, node.0));
            let hash_of = |id: u32, mark: Mark| hashes.hash_one((state_hashes[id as usize], mark));
            if self.known.find(hash_of(node.0, (held, step)), |id| *id == node.0).is_none() {
                // The same state was reached sooner in the meantime.
                continue;
            }
            let marks = &self.marks;
            let new_from = |id: u32| (NONE, mark_of(marks, id).1);
            let hash = hash_of(node.0, (NONE, step));
            let is_same = |id: &u32| new_from(*id) == (NONE, step) && tree.has_state(NodeId(*id), state);
            let is_new = self.expanded.find(hash, is_same).is_none();
            if is_new {
                let rehash = |id: &u32| hash_of(*id, new_from(*id));
                self.expanded.insert_unique(hash, node.0, rehash);
            }
            return Some(Expansion { node, continues: held != NONE, new_inputs: (0, if is_new { inputs } else { 0 }) });
        }
    }

    /// Extends a node by its next input.
    fn extend(&mut self, expansion: &mut Expansion) {
        let node = expansion.node;
        let choice = if std::mem::take(&mut expansion.continues) {
            Choice { node, input: usize::from(mark_of(&self.marks, node.0).0), hold: 1 }
        } else {
            expansion.new_inputs.0 += 1;
            Choice { node, input: expansion.new_inputs.0 - 1, hold: self.change.hold() }
        };
        let depth = self.context.tree.depth(node);
        match self.context.extend(choice) {
            Extension::Dead => {}
            Extension::Goal(steps) => {
                let total = depth + u32::from(steps);
                if self.found.is_none_or(|(known, ..)| total < known) {
                    self.found = Some((total, choice, steps));
                }
            }
            Extension::Open => {
                let state = self.context.reached();
                let held = if self.change.continues() { choice.input as u16 } else { NONE };
                let step = match self.context.problem.is_foretold() {
                    true => self.context.first_step(node) + u64::from(choice.hold),
                    false => 0,
                };
                let (tree, all, mark) = (&self.context.tree, &self.marks, (held, step));
                let state_hash = self.hashes.hash_one(state);
                let is_same = |id: &u32| mark_of(all, *id) == mark && tree.has_state(NodeId(*id), state);
                let known = self.known.find(self.hashes.hash_one((state_hash, mark)), is_same);
                // A longer hold may reach it before a shorter one that started later.
                let later = |id: &u32| tree.depth(NodeId(*id)) > depth + u32::from(choice.hold);
                if known.is_none_or(|id| self.is_breadth_first() && later(id)) {
                    let id = self.context.add(choice, false);
                    self.keep(id, mark, state_hash);
                }
            }
        }
    }

    /// Whether no state on a path of fewer than `steps` steps was left out. A path may leave a search window and
    /// return.
    fn is_complete(&self, steps: u32) -> bool {
        let notes = &self.context.notes;
        let is_far = |cut: &Cut| cut.soonest.saturating_add(1) >= steps;
        let are_all = !self.context.controls.truncated && !notes.has_open_draws && !self.context.is_by_luck();
        are_all && notes.fault.is_none() && notes.cuts.iter().all(is_far)
    }

    /// The path found, if it is final: if no path of fewer than `least` steps can still be found, or at once if best
    /// first.
    fn answer(&mut self, least: u32) -> Option<Plan> {
        let (total, choice, steps) = self.found.take_if(|(total, ..)| {
            let is_best_first = matches!(self.order, Order::Best(_));
            is_best_first || *total <= least
        })?;
        // Several starts have different numbers of previous steps.
        let is_alone = self.context.starts() == 1;
        let is_all = matches!(self.change, Change::After(_)) && self.is_complete(total);
        let is_shortest = self.is_breadth_first() && is_alone && is_all;
        self.context.plan(choice, steps, is_shortest)
    }

    /// The result when nothing is left to extend.
    fn exhausted(&mut self) -> Ending {
        // With a time limit, a state that was reached late may also be reachable soon.
        let is_timely = self.context.problem.time().is_none() || self.is_breadth_first();
        if !self.is_complete(u32::MAX) || !is_timely {
            return Ending::Spent;
        }
        let states = if self.change.continues() { self.expanded.len() } else { self.context.tree.len() } as u64;
        match self.change {
            Change::After(steps) => Ending::Exhausted(Exhaustion { states, min_hold: steps, left_out: 0 }),
            Change::Every(steps) => {
                self.context.notes.exhausted = Some((steps, states));
                Ending::Spent
            }
        }
    }
}

impl Searcher for Exhaustive<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        if self.context.tree.is_empty() {
            self.add_roots();
        }
        let until = self.context.notes.statistics.nodes.saturating_add(nodes);
        // A finite world may add no nodes, but every attempt takes time.
        let mut attempts = nodes.saturating_mul(16);
        while self.context.notes.statistics.nodes < until && attempts > 0 {
            attempts -= 1;
            // A stopped search proves nothing.
            if self.context.meter.spend(LOOKUP_WORK) {
                return Ending::Stopped;
            }
            let Some(mut expansion) = self.expansion.or_else(|| self.next()) else {
                if let Some(plan) = self.answer(u32::MAX) {
                    return Ending::Reached(plan);
                }
                return self.exhausted();
            };
            // All remaining nodes are at least as deep as this one.
            if let Some(plan) = self.answer(self.context.tree.depth(expansion.node) + 1) {
                return Ending::Reached(plan);
            }
            let is_open =
                |expansion: &Expansion| expansion.continues || expansion.new_inputs.0 < expansion.new_inputs.1;
            if is_open(&expansion) {
                self.extend(&mut expansion);
            }
            self.expansion = Some(expansion).filter(is_open);
        }
        match self.answer(0) {
            Some(plan) => Ending::Reached(plan),
            None => Ending::Paused,
        }
    }

    fn pending(&mut self) -> Option<Plan> {
        let (_, choice, steps) = self.found.take()?;
        self.context.plan(choice, steps, false)
    }

    fn nodes(&self) -> u64 {
        self.context.notes.statistics.nodes
    }

    fn work(&self) -> u64 {
        self.context.meter.total()
    }

    fn places(&self) -> u64 {
        self.context.notes.coverage.count().places
    }

    fn report(&self, notes: &mut Notes) {
        self.context.report(notes);
    }

    fn bytes(&self) -> usize {
        let tables = (self.known.capacity() + self.expanded.capacity()) * 5 + self.state_hashes.capacity() * 8;
        self.context.bytes() + tables + self.marks.capacity() * size_of::<Mark>() + self.order.bytes()
    }

    fn planner(&self) -> &'static str {
        match self.order {
            Order::Breadth { .. } => Planner::Exhaustive.name(),
            Order::Best(_) => Planner::BestFirst.name(),
        }
    }
}

/// What tells a node apart.
fn mark_of(marks: &[Mark], node: u32) -> Mark {
    marks.get(node as usize).copied().unwrap_or(UNMARKED)
}

//! Exhaustion: breadth first over all that can be done when inputs change every so many steps, each state once. Many
//! worlds are finite under a fixed step; then "no" is proven for that granularity of inputs, and the first way that is
//! found is a shortest one.
//!
//! States are the same if all their bytes are: everything that the next step reads is part of a state (`sim/state.rs`).
//! Inputs are all that anything ever reads.

use std::hash::Hasher;

use hashbrown::HashTable;
use rustc_hash::FxHasher;

use crate::watch::Watch;

use super::ground::{Extension, Ground, Notes};
use super::searcher::{Ending, Searcher};
use super::strategy::Choice;
use super::tree::{NodeId, Tree};

/// How often the watch is asked, in extensions.
const WATCH_EVERY: u64 = 256;

/// All states that were reached, in the order of the steps that they take.
pub(super) struct Exhaustive<'a> {
    ground: Ground<'a>,
    known: HashTable<u32>,
    /// The next node to extend, and its next input.
    next: (usize, usize),
    /// After the nodes of this layer a way that was found is a shortest one.
    layer_end: usize,
    /// The shortest way in the layer that is looked at.
    found: Option<(Choice, u16)>,
    extensions: u64,
}

impl<'a> Exhaustive<'a> {
    pub fn new(ground: Ground<'a>) -> Self {
        Exhaustive { ground, known: HashTable::new(), next: (0, 0), layer_end: 0, found: None, extensions: 0 }
    }

    fn plant(&mut self) {
        self.ground.notes.statistics.trees += 1;
        for start in 0..self.ground.starts() {
            let root = self.ground.plant(start, false);
            let tree = &self.ground.tree;
            let hash = hashed(tree.state(root));
            insert(&mut self.known, tree, hash, root);
        }
        self.layer_end = self.ground.tree.len();
    }

    /// Extends a node by its next input.
    fn turn(&mut self) {
        let node = NodeId(self.next.0 as u32);
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
                let hash = hashed(state);
                let tree = &self.ground.tree;
                let is_known = self.known.find(hash, |id| tree.state(NodeId(*id)) == state).is_some();
                if !is_known {
                    let id = self.ground.add(choice, false);
                    insert(&mut self.known, &self.ground.tree, hash, id);
                }
            }
        }
        self.next.1 += 1;
        if self.next.1 >= self.ground.inputs(node) {
            self.next = (self.next.0 + 1, 0);
        }
    }
}

impl Searcher for Exhaustive<'_> {
    fn advance(&mut self, nodes: u64, watch: &dyn Watch) -> Ending {
        if self.ground.tree.is_empty() {
            self.plant();
        }
        let until = self.ground.notes.statistics.nodes.saturating_add(nodes);
        // A closed world adds no nodes, but still takes its time.
        let mut patience = nodes.saturating_mul(16);
        while self.ground.notes.statistics.nodes < until && patience > 0 {
            patience -= 1;
            self.extensions += 1;
            if self.extensions.is_multiple_of(WATCH_EVERY) && watch.stop() {
                return Ending::Stopped;
            }
            if self.next.0 >= self.layer_end {
                if let Some(plan) = self.found.take().and_then(|(choice, steps)| self.ground.plan(choice, steps, true))
                {
                    return Ending::Reached(plan);
                }
                if self.layer_end == self.ground.tree.len() {
                    let is_proof = !self.ground.controls.truncated && self.ground.notes.fault.is_none();
                    let states = self.ground.tree.len() as u64;
                    return if is_proof { Ending::Exhausted(states, self.ground.hold.0) } else { Ending::Spent };
                }
                self.layer_end = self.ground.tree.len();
            }
            self.turn();
        }
        Ending::Paused
    }

    fn nodes(&self) -> u64 {
        self.ground.notes.statistics.nodes
    }

    fn report(&self, notes: &mut Notes) {
        self.ground.report(notes);
    }

    fn planner(&self) -> &'static str {
        "exhaustive"
    }

    fn bytes(&self) -> usize {
        self.ground.bytes() + self.known.capacity() * 5
    }
}

fn insert(known: &mut HashTable<u32>, tree: &Tree, hash: u64, node: NodeId) {
    known.insert_unique(hash, node.0, |id| hashed(tree.state(NodeId(*id))));
}

fn hashed(state: &[u8]) -> u64 {
    let mut hasher = FxHasher::default();
    hasher.write(state);
    hasher.finish()
}

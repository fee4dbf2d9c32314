//! The states of a tree by their hashes: tells a state that was reached before, from which nothing new follows.
//! Among still things, many extensions end in such states: who waits stays where he is, and falls end on the same ground.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use super::tree::{NodeId, Tree};

/// Spreads half of a hash over all bits.
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// The nodes of a tree by their states.
#[derive(Debug, Default)]
pub(super) struct KnownStates {
    hashes: DefaultHashBuilder,
    nodes: HashTable<u32>,
    /// Half of the hash of each node's state.
    of_nodes: Vec<u32>,
}

impl KnownStates {
    /// Forgets all states.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.of_nodes.clear();
    }

    /// The node of a tree that has a state, at a depth or before.
    pub fn find(&self, tree: &Tree, state: &[u8], depth: u32) -> Option<NodeId> {
        let is_same = |id: &u32| tree.depth(NodeId(*id)) <= depth && tree.has_state(NodeId(*id), state);
        self.nodes.find(spread(self.half(state)), is_same).map(|id| NodeId(*id))
    }

    /// Adds the next node of the tree.
    pub fn add(&mut self, node: NodeId, state: &[u8]) {
        let half = self.half(state);
        self.of_nodes.resize(node.index() + 1, half);
        self.nodes.insert_unique(spread(half), node.0, |id| spread(self.of_nodes[*id as usize]));
    }

    fn half(&self, state: &[u8]) -> u32 {
        (self.hashes.hash_one(state) >> 32) as u32
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * 5 + self.of_nodes.capacity() * 4
    }
}

fn spread(half: u32) -> u64 {
    u64::from(half).wrapping_mul(SPREAD)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_known_from_its_least_depth_on() {
        let (mut tree, mut known) = (Tree::new(8), KnownStates::default());
        let (one, other) = ([1; 8], [2; 8]);
        let root = tree.add_root(&one, 0, 0, 4);
        known.add(root, &one);
        let late = tree.push(&other, root, (0, 9), 0, 4);
        known.add(late, &other);
        let has = |known: &KnownStates, tree: &Tree, state, depth| known.find(tree, state, depth).is_some();
        assert!(has(&known, &tree, &one, 0) && has(&known, &tree, &one, 5));
        assert!(has(&known, &tree, &other, 9) && !has(&known, &tree, &other, 8));
        let soon = tree.push(&other, root, (1, 3), 0, 4);
        known.add(soon, &other);
        assert!(has(&known, &tree, &other, 3) && !has(&known, &tree, &other, 2));
        tree.clear();
        known.clear();
        assert!(!has(&known, &tree, &one, 5));
    }
}

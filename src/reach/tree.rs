//! The tree: flat arrays by node. A node is a state, the input held for some steps that led there, and its parent.

use crate::sim::{Input, Script};

/// A node of a tree; 0 is the root.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// A tree of states.
#[derive(Debug, Default)]
pub struct Tree {
    stride: usize,
    states: Vec<u8>,
    nodes: Vec<Node>,
    /// One bit for each input that was tried, for each node from its `tried` on.
    tried: Vec<u64>,
    /// How many nodes have untried inputs.
    open: usize,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    parent: u32,
    /// The control set whose inputs can be tried here.
    set: u32,
    /// The parent's input that led here, as an index into the parent's control set.
    input: u16,
    /// For how many steps it was held.
    hold: u16,
    /// How many inputs are still untried.
    untried: u16,
    /// The first word of its bits.
    tried: u32,
}

impl Tree {
    /// An empty tree of states of a size in bytes.
    pub fn new(stride: usize) -> Self {
        Tree { stride: stride.max(1), ..Tree::default() }
    }

    /// Forgets all nodes, keeps the memory.
    pub fn clear(&mut self) {
        self.states.clear();
        self.nodes.clear();
        self.tried.clear();
        self.open = 0;
    }

    /// How many nodes have untried inputs.
    pub fn open_nodes(&self) -> usize {
        self.open
    }

    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Adds a node; the root is its own parent. `inputs` is the number of inputs of its control set.
    pub fn push(&mut self, state: &[u8], parent: NodeId, input: u16, hold: u16, set: u32, inputs: usize) -> NodeId {
        let id = NodeId(self.nodes.len() as u32);
        self.states.extend_from_slice(state);
        self.states.resize(self.stride * (self.nodes.len() + 1), 0);
        let tried = self.tried.len() as u32;
        self.tried.resize(self.tried.len() + inputs.div_ceil(64), 0);
        self.open += usize::from(inputs > 0);
        self.nodes.push(Node { parent: parent.0, set, input, hold, untried: inputs as u16, tried });
        id
    }

    /// The state of a node.
    pub fn state(&self, node: NodeId) -> &[u8] {
        let from = self.stride * node.0 as usize;
        &self.states[from..from + self.stride]
    }

    /// The control set of a node.
    pub fn set(&self, node: NodeId) -> u32 {
        self.nodes[node.0 as usize].set
    }

    /// How many inputs are still untried at a node.
    pub fn untried(&self, node: NodeId) -> usize {
        usize::from(self.nodes[node.0 as usize].untried)
    }

    /// Marks the `nth` untried input of a node as tried and gives its index. `nth` is below [`Tree::untried`].
    pub fn take_untried(&mut self, node: NodeId, nth: usize) -> usize {
        let n = &mut self.nodes[node.0 as usize];
        n.untried = n.untried.saturating_sub(1);
        self.open -= usize::from(n.untried == 0);
        let mut left = nth;
        for (index, word) in self.tried.iter_mut().skip(n.tried as usize).enumerate() {
            let open = word.count_zeros() as usize;
            if left >= open {
                left -= open;
                continue;
            }
            let mut free = !*word;
            for _ in 0..left {
                free &= free - 1;
            }
            let bit = free.trailing_zeros();
            *word |= 1 << bit;
            return index * 64 + bit as usize;
        }
        0
    }

    /// The inputs from the root to a node. `inputs` gives those of a control set.
    pub fn script<'i>(&self, node: NodeId, inputs: impl Fn(u32) -> &'i [Input]) -> Script {
        let mut backwards = Vec::new();
        let mut at = node.0;
        while at != 0 {
            let n = &self.nodes[at as usize];
            backwards.push((self.nodes[n.parent as usize].set, n.input, n.hold));
            at = n.parent;
        }
        let mut script = Script::default();
        for (set, input, hold) in backwards.into_iter().rev() {
            script.push(&inputs(set)[usize::from(input)], u32::from(hold));
        }
        script
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_is_taken_once() {
        let mut tree = Tree::new(8);
        let node = tree.push(&[0; 8], NodeId(0), 0, 0, 0, 130);
        let mut seen = vec![false; 130];
        let mut nth = 7;
        while tree.untried(node) > 0 {
            nth = (nth * 31 + 11) % tree.untried(node);
            let input = tree.take_untried(node, nth);
            assert!(!seen[input], "input {input} came twice");
            seen[input] = true;
        }
        assert!(seen.into_iter().all(|s| s));
    }
}

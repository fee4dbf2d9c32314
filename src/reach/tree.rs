//! The search tree as flat arrays by node. A node is a state (`packed_states.rs`), its parent, and the input that led
//! there with its hold.

use super::packed_states::PackedStates;
use super::strategy::Choice;

/// A node of a tree; 0 is the root.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(pub u32);

impl NodeId {
    /// Its index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A tree of states, or several with their own roots.
#[derive(Debug, Default)]
pub struct Tree {
    states: PackedStates,
    nodes: Vec<Node>,
    /// One bit per tried input; the bits of a node start at its `tried`.
    tried: Vec<u64>,
    /// Number of nodes with untried inputs.
    open: usize,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    parent: u32,
    /// The first word of its bits.
    tried: u32,
    /// The control set whose inputs can be tried here.
    set: u16,
    /// The parent's input that led here, as an index into the parent's control set.
    input: u16,
    /// Number of steps for which it was held; 0 for a root.
    hold: u16,
    /// Number of untried inputs.
    untried: u16,
    /// Number of steps from the start of the search.
    depth: u32,
}

impl Tree {
    /// An empty tree of states of a size in bytes.
    pub fn new(stride: usize) -> Self {
        Tree { states: PackedStates::new(stride), ..Tree::default() }
    }

    /// Removes all nodes, but keeps the memory.
    pub fn clear(&mut self) {
        self.states.clear();
        self.nodes.clear();
        self.tried.clear();
        self.open = 0;
    }

    /// Number of nodes with untried inputs.
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

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.states.bytes() + self.nodes.capacity() * size_of::<Node>() + self.tried.capacity() * size_of::<u64>()
    }

    /// Adds a root at a depth in steps. `inputs` is the number of inputs of its control set, 0 if tried inputs are not
    /// tracked.
    pub fn add_root(&mut self, state: &[u8], depth: u32, set: u16, inputs: usize) -> NodeId {
        let id = NodeId(self.nodes.len() as u32);
        self.states.push(state, depth, None);
        self.insert(id, (0, 0), set, inputs, depth)
    }

    /// Adds a node that an input led to, held for some steps.
    pub fn push(&mut self, state: &[u8], parent: NodeId, (input, hold): (u16, u16), set: u16, inputs: usize) -> NodeId {
        let depth = self.depth(parent) + u32::from(hold);
        self.states.push(state, depth, Some(parent.index()));
        self.insert(parent, (input, hold), set, inputs, depth)
    }

    fn insert(&mut self, parent: NodeId, (input, hold): (u16, u16), set: u16, inputs: usize, depth: u32) -> NodeId {
        let id = NodeId(self.nodes.len() as u32);
        let tried = self.tried.len() as u32;
        self.tried.resize(self.tried.len() + inputs.div_ceil(64), 0);
        self.open += usize::from(inputs > 0);
        self.nodes.push(Node { parent: parent.0, set, input, hold, untried: inputs as u16, tried, depth });
        id
    }

    /// The state of a node, perhaps in the buffer.
    pub fn state<'s>(&'s self, node: NodeId, buffer: &'s mut Vec<u8>) -> &'s [u8] {
        self.states.get(node.index(), buffer)
    }

    /// Whether a node has a state.
    pub fn has_state(&self, node: NodeId, state: &[u8]) -> bool {
        self.states.is(node.index(), state)
    }

    /// The control set of a node.
    pub fn set(&self, node: NodeId) -> u16 {
        self.nodes[node.index()].set
    }

    /// The parent of a node; none of a root.
    pub fn parent(&self, node: NodeId) -> Option<NodeId> {
        let n = &self.nodes[node.index()];
        (n.parent != node.0).then_some(NodeId(n.parent))
    }

    /// Number of steps to a node from the start of the search.
    pub fn depth(&self, node: NodeId) -> u32 {
        self.nodes[node.index()].depth
    }

    /// Number of untried inputs of a node.
    pub fn untried(&self, node: NodeId) -> usize {
        usize::from(self.nodes[node.index()].untried)
    }

    /// Marks the `nth` untried input of a node as tried and returns its index. `nth` is below [`Tree::untried`].
    pub fn take_untried(&mut self, node: NodeId, nth: usize) -> usize {
        let n = &mut self.nodes[node.index()];
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

    /// Marks an input of a node as tried; returns whether it was not before.
    pub fn mark_tried(&mut self, node: NodeId, input: usize) -> bool {
        let n = &mut self.nodes[node.index()];
        let word = &mut self.tried[n.tried as usize + input / 64];
        let is_new = *word >> (input % 64) & 1 == 0;
        if is_new {
            *word |= 1 << (input % 64);
            n.untried = n.untried.saturating_sub(1);
            self.open -= usize::from(n.untried == 0);
        }
        is_new
    }

    /// The choice that led to a node; none to a root.
    pub fn before(&self, node: NodeId) -> Option<Choice> {
        let n = &self.nodes[node.index()];
        self.parent(node).map(|parent| Choice { node: parent, input: usize::from(n.input), hold: n.hold })
    }

    /// The choices from its root to a node.
    pub fn choices(&self, node: NodeId) -> Vec<Choice> {
        let mut choices: Vec<Choice> = std::iter::successors(self.before(node), |c| self.before(c.node)).collect();
        choices.reverse();
        choices
    }

    /// The root above a node.
    pub fn root(&self, mut node: NodeId) -> NodeId {
        while let Some(parent) = self.parent(node) {
            node = parent;
        }
        node
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_is_taken_once() {
        let mut tree = Tree::new(8);
        let node = tree.add_root(&[0; 8], 0, 0, 130);
        let mut seen = vec![false; 130];
        assert!(tree.mark_tried(node, 77));
        assert!(!tree.mark_tried(node, 77));
        seen[77] = true;
        let mut nth = 7;
        while tree.untried(node) > 0 {
            nth = (nth * 31 + 11) % tree.untried(node);
            let input = tree.take_untried(node, nth);
            assert!(!seen[input], "input {input} came twice");
            seen[input] = true;
        }
        assert!(seen.into_iter().all(|s| s));
        assert_eq!(tree.open_nodes(), 0);
    }

    #[test]
    fn states_of_any_size_are_kept() {
        let mut buffer = Vec::new();
        for stride in [1, 8, 176, 4_000, (1 << 18) - 8, (1 << 18) + 8] {
            let mut tree = Tree::new(stride);
            for round in 0..2u8 {
                for i in 0..20u8 {
                    tree.add_root(&vec![i + round; stride], 0, 0, 1);
                }
                for i in 0..20u8 {
                    assert_eq!(tree.state(NodeId(u32::from(i)), &mut buffer), vec![i + round; stride]);
                }
                tree.clear();
            }
        }
    }
}

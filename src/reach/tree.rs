//! The tree: flat arrays by node. A node is a state, the input held for some steps that led there, and its parent.
//! States are in chunks, so that a growing tree is never copied.

use crate::sim::{Input, Script};

/// A node of a tree; 0 is the root.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(pub u32);

impl NodeId {
    /// Its place in an array.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The size of a block of states, bytes.
const CHUNK: usize = 1 << 18;

/// A tree of states, or several with roots of their own.
#[derive(Debug, Default)]
pub struct Tree {
    stride: usize,
    /// A chunk holds 2 to the power of this many states.
    shift: u32,
    chunks: Vec<Box<[u8]>>,
    nodes: Vec<Node>,
    /// One bit for each input that was tried, for each node from its `tried` on.
    tried: Vec<u64>,
    /// How many nodes have untried inputs.
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
    /// For how many steps it was held; 0 of a root.
    hold: u16,
    /// How many inputs are still untried.
    untried: u16,
    /// How many steps lead here from where the search began.
    depth: u32,
}

impl Tree {
    /// An empty tree of states of a size in bytes.
    pub fn new(stride: usize) -> Self {
        let stride = stride.max(1);
        Tree { stride, shift: (CHUNK / stride).max(1).ilog2(), ..Tree::default() }
    }

    /// Forgets all nodes, keeps the memory.
    pub fn clear(&mut self) {
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

    /// The memory that it takes, bytes.
    pub fn bytes(&self) -> usize {
        let chunks = self.chunks.len() * (self.stride << self.shift);
        chunks + self.nodes.capacity() * size_of::<Node>() + self.tried.capacity() * size_of::<u64>()
    }

    /// Adds a root at a depth in steps. `inputs` is the number of inputs of its control set, none if
    /// they are not tried one by one.
    pub fn plant(&mut self, state: &[u8], depth: u32, set: u16, inputs: usize) -> NodeId {
        let id = self.push(state, NodeId(self.nodes.len() as u32), (0, 0), set, inputs);
        self.nodes[id.index()].depth = depth;
        id
    }

    /// Adds a node that an input led to, held for some steps.
    pub fn push(&mut self, state: &[u8], parent: NodeId, (input, hold): (u16, u16), set: u16, inputs: usize) -> NodeId {
        let id = self.nodes.len();
        if id >> self.shift >= self.chunks.len() {
            self.chunks.push(vec![0; self.stride << self.shift].into_boxed_slice());
        }
        let (chunk, from) = self.place(id);
        self.chunks[chunk][from..from + state.len()].copy_from_slice(state);
        let tried = self.tried.len() as u32;
        self.tried.resize(self.tried.len() + inputs.div_ceil(64), 0);
        self.open += usize::from(inputs > 0);
        let depth = self.nodes.get(parent.index()).map_or(0, |parent| parent.depth) + u32::from(hold);
        self.nodes.push(Node { parent: parent.0, set, input, hold, untried: inputs as u16, tried, depth });
        NodeId(id as u32)
    }

    fn place(&self, index: usize) -> (usize, usize) {
        (index >> self.shift, (index & ((1 << self.shift) - 1)) * self.stride)
    }

    /// The state of a node.
    pub fn state(&self, node: NodeId) -> &[u8] {
        let (chunk, from) = self.place(node.index());
        &self.chunks[chunk][from..from + self.stride]
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

    /// How many steps lead to a node from where the search began.
    pub fn depth(&self, node: NodeId) -> u32 {
        self.nodes[node.index()].depth
    }

    /// How many inputs are still untried at a node.
    pub fn untried(&self, node: NodeId) -> usize {
        usize::from(self.nodes[node.index()].untried)
    }

    /// Marks the `nth` untried input of a node as tried and gives its index. `nth` is below [`Tree::untried`].
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
    pub fn take(&mut self, node: NodeId, input: usize) -> bool {
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

    /// The inputs from its root to a node. `inputs` gives those of a control set.
    pub fn script<'i>(&self, node: NodeId, inputs: impl Fn(u16) -> &'i [Input]) -> Script {
        let mut backwards = Vec::new();
        let mut at = node;
        while let Some(parent) = self.parent(at) {
            let n = &self.nodes[at.index()];
            backwards.push((self.set(parent), n.input, n.hold));
            at = parent;
        }
        let mut script = Script::default();
        for (set, input, hold) in backwards.into_iter().rev() {
            script.push(&inputs(set)[usize::from(input)], u32::from(hold));
        }
        script
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
        let node = tree.plant(&[0; 8], 0, 0, 130);
        let mut seen = vec![false; 130];
        assert!(tree.take(node, 77));
        assert!(!tree.take(node, 77));
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
        for stride in [1, 8, 176, CHUNK - 8, CHUNK + 8] {
            let mut tree = Tree::new(stride);
            for round in 0..2u8 {
                for i in 0..20u8 {
                    tree.plant(&vec![i + round; stride], 0, 0, 1);
                }
                for i in 0..20u8 {
                    assert_eq!(tree.state(NodeId(u32::from(i))), vec![i + round; stride]);
                }
                tree.clear();
            }
        }
    }
}

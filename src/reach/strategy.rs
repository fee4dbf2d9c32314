//! Where the published planners differ: which node to grow and how, and what to learn from it.

use rand_pcg::Pcg64;

use super::metric::Point;
use super::tree::{NodeId, Tree};

/// A node and the index of an input of its control set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The node to grow.
    pub node: NodeId,
    /// The input.
    pub input: usize,
}

/// What came of a choice.
#[derive(Debug, Clone, Copy)]
pub enum Growth<'p> {
    /// A new tree was begun with this root.
    Rooted(&'p Point),
    /// A node was added at this point; its id is the number of nodes before it.
    Added(&'p Point),
    /// The extension ended in a dead state.
    Failed,
}

/// Everything in which the published planners differ; the planning loop owns the rest.
pub trait Strategy {
    /// Which node to grow and how; none to discard this sample. The input is marked as tried.
    fn choose(&mut self, tree: &mut Tree, toward: &Point, rng: &mut Pcg64) -> Option<Choice>;

    /// Told what came of a choice, or of none at a root.
    fn learn(&mut self, tree: &Tree, choice: Option<Choice>, growth: Growth<'_>);

    /// Whether nothing is left to try in this tree.
    fn exhausted(&self, tree: &Tree) -> bool;
}

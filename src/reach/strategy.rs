//! The interface in which planners differ: how samples are biased, which node to extend and how, and what to learn from
//! the result.

use super::metric::Point;
use super::region::GoalRegion;
use super::search_context::SearchContext;
use super::tree::NodeId;

/// An extension: a node, an input of its control set, and a hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The node to grow.
    pub node: NodeId,
    /// The input.
    pub input: usize,
    /// Steps.
    pub hold: u16,
}

/// The result of a choice.
#[derive(Debug, Clone, Copy)]
pub enum Growth<'p> {
    /// A new tree was started; this is its root.
    Rooted(NodeId, &'p Point),
    /// A node was added at this point.
    Added(NodeId, &'p Point),
    /// The extension ended in a dead state.
    Failed,
    /// From where it ended, the goal is too far away for the time that is left.
    Late,
    /// It ended in the state of a node, at this point, that the tree had reached before; only of planners without samples.
    Known(NodeId, &'p Point),
}

/// Everything in which planners differ; the loop does the rest.
pub trait Strategy {
    /// Biases a sample; returns false to leave that to the loop, which draws a share of all samples from the goal
    /// region.
    fn aim(&mut self, _context: &mut SearchContext<'_>, _goal: &GoalRegion, _toward: &mut Point) -> bool {
        false
    }

    /// Chooses a node and how to extend it; `None` discards this sample. The input is marked as tried.
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice>;

    /// Learns the result of a choice; `choice` is `None` for a root.
    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>);

    /// Whether the tree has grown as far as it is to grow.
    fn is_over(&self) -> bool {
        false
    }

    /// Whether further trees would be like those before.
    fn is_spent(&self) -> bool {
        false
    }

    /// Whether it matters how soon a state is reached, and not only that it is.
    fn counts_steps(&self) -> bool {
        false
    }

    /// Whether it goes on from states on the ways of other searches; not so where ways are to be fast, as those may be
    /// detours.
    fn follows(&self) -> bool {
        true
    }

    /// Whether it begins a tree anew once others have found a path: among the states that can still be in time it finds
    /// others.
    fn starts_over(&self) -> bool {
        false
    }

    /// The name of the planner that made the last choice, if there are several.
    fn planner(&self) -> Option<&'static str> {
        None
    }

    /// Memory use, bytes.
    fn bytes(&self) -> usize;
}

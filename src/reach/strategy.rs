//! Where planners differ: where samples lean, which node to grow and how, what to learn from it.

use super::metric::Point;
use super::region::GoalRegion;
use super::search_context::SearchContext;
use super::tree::NodeId;

/// A node, the index of an input of its control set, and for how many steps it is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The node to grow.
    pub node: NodeId,
    /// The input.
    pub input: usize,
    /// Steps.
    pub hold: u16,
}

/// What came of a choice.
#[derive(Debug, Clone, Copy)]
pub enum Growth<'p> {
    /// A new tree was begun; this is its root.
    Rooted(NodeId, &'p Point),
    /// A node was added at this point.
    Added(NodeId, &'p Point),
    /// The extension ended in a dead state.
    Failed,
}

/// Everything in which planners differ; the loop owns the rest.
pub trait Strategy {
    /// Moves a sample towards what the planner leans to; false to leave that to the loop, which draws a share of all
    /// samples from the goal.
    fn aim(&mut self, _context: &mut SearchContext<'_>, _goal: &GoalRegion, _toward: &mut Point) -> bool {
        false
    }

    /// Which node to grow and how; none to discard this sample. The input is marked as tried.
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice>;

    /// Told what came of a choice, or of none at a root.
    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>);

    /// The memory that it takes, bytes.
    fn bytes(&self) -> usize;
}

//! RRT: draws a sample and extends the nearest node that has an untried input.
//!
//! LaValle, *Rapidly-Exploring Random Trees: A New Tool for Path Planning*, 1998. Here the inputs are finite, and each
//! is tried at most once per node; nodes without untried inputs are removed from the index.

use crate::reach::metric::{MODE_PENALTY, Metric, Point};
use crate::reach::nearest::Index;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;

/// The plain RRT.
#[derive(Debug)]
pub struct Rrt {
    /// The nodes with untried inputs.
    open: Index,
}

impl Rrt {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Rrt { open: Index::new(metric.coordinates().len(), metric.modes(), MODE_PENALTY).around(metric.around()) }
    }

    /// As [`Strategy::choose`], among the nodes that are accepted.
    pub(super) fn choose_where(
        &mut self,
        context: &mut SearchContext<'_>,
        toward: &Point,
        accept: impl FnMut(NodeId) -> bool,
    ) -> Option<Choice> {
        let mut accept = accept;
        let nearest = self.open.nearest_where(&toward.reals, &toward.modes, |index| accept(NodeId(index as u32)))?;
        self.grow(context, NodeId(nearest.index as u32))
    }

    fn grow(&mut self, context: &mut SearchContext<'_>, node: NodeId) -> Option<Choice> {
        let choice = context.draw_untried(node);
        if context.tree.untried(node) == 0 {
            self.open.remove(node.index());
        }
        choice
    }
}

impl Strategy for Rrt {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        let nearest = self.open.nearest(&toward.reals, &toward.modes)?;
        self.grow(context, NodeId(nearest.index as u32))
    }

    fn learn(&mut self, _context: &mut SearchContext<'_>, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(_, point) => {
                self.open.clear();
                self.open.push(&point.reals, &point.modes);
            }
            Growth::Added(_, point) => self.open.push(&point.reals, &point.modes),
            Growth::Failed | Growth::Late | Growth::Known(..) => {}
        }
    }

    fn bytes(&self) -> usize {
        self.open.bytes()
    }
}

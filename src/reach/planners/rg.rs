//! RG-RRT: finds the nearest neighbour of a sample among the successors of all nodes (`reachable.rs`) and applies the
//! input that leads there.
//!
//! Shkolnik, Walter and Tedrake, *Reachability-Guided Sampling for Planning Under Differential Constraints*, 2009.

use crate::reach::metric::{Metric, Point};
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};

use super::reachable::Reachable;

/// RRT guided by reachable states.
#[derive(Debug)]
pub struct Rg {
    reachable: Reachable,
}

impl Rg {
    /// A strategy for a space.
    pub fn new(metric: &Metric) -> Self {
        Rg { reachable: Reachable::new(metric) }
    }
}

impl Strategy for Rg {
    fn choose(&mut self, context: &mut SearchContext<'_>, toward: &Point) -> Option<Choice> {
        self.reachable.choose_where(context, toward, |_| true)
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, _choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, _) => {
                self.reachable.clear();
                self.reachable.add(context, root);
            }
            Growth::Added(node, _) => {
                self.reachable.add(context, node);
            }
            Growth::Failed | Growth::Late | Growth::Known(..) => {}
        }
    }

    fn bytes(&self) -> usize {
        self.reachable.bytes()
    }
}

//! Failure feedback: how often extensions below a node failed. The first idea of RC-RRT.
//!
//! Cheng and LaValle, *Resolution Complete Rapidly-Exploring Random Trees*, 2002, §III: with m inputs at a node, a
//! failed extension adds 1/m to the violation frequency of its node, 1/m² to that of the parent, and so on; a node is
//! excluded from a nearest-neighbour search with that probability. Here one number is drawn per search for all nodes,
//! so the search sees a consistent set of nodes.

use rand::RngExt;

use crate::ir::Extremes;
use crate::reach::search_context::SearchContext;
use crate::reach::tree::NodeId;

/// Smaller terms are ignored.
const MIN_TERM: f32 = 1e-4;

/// The violation frequency of each node.
#[derive(Debug, Default)]
pub struct ViolationFrequencies {
    frequencies: Vec<f32>,
}

impl ViolationFrequencies {
    pub fn clear(&mut self) {
        self.frequencies.clear();
    }

    /// A node without failures.
    pub fn add(&mut self) {
        self.frequencies.push(0.0);
    }

    /// Records a failed extension of a node.
    pub fn fail(&mut self, context: &SearchContext<'_>, node: NodeId) {
        let share = 1.0 / context.inputs(node).max(1) as f32;
        let mut term = share;
        let mut at = Some(node);
        while let Some(node) = at.filter(|_| term >= MIN_TERM) {
            if let Some(violation) = self.frequencies.get_mut(node.index()) {
                *violation = (*violation + term).least(1.0);
            }
            // With a single input the term does not decrease until an ancestor with a choice.
            term *= share;
            at = context.tree.parent(node);
        }
    }

    /// Draws which nodes take part in one search.
    pub fn draw_participants(&self, context: &mut SearchContext<'_>) -> impl Fn(NodeId) -> bool + '_ {
        let drawn: f32 = context.rng.random();
        move |node| self.frequencies.get(node.index()).is_none_or(|v| *v <= drawn)
    }

    pub fn bytes(&self) -> usize {
        self.frequencies.capacity() * size_of::<f32>()
    }
}

//! Failure feedback: how often what grew from a node ended in failure. The first idea of RC-RRT.
//!
//! Cheng and LaValle, *Resolution Complete Rapidly-Exploring Random Trees*, 2002, §III: with m inputs at a node, a failed
//! extension adds 1/m to the violation frequency of its node, 1/m² to that of the parent, and so on up; a node is left out
//! of a search for the nearest with that probability. Here one number is drawn for all nodes of a search, so that a node
//! that is left out is so for all that look at it.

use rand::RngExt;

use crate::reach::search_context::SearchContext;
use crate::reach::tree::NodeId;

/// What is less changes nothing.
const LEAST: f32 = 1e-4;

/// The violation frequency of each node.
#[derive(Debug, Default)]
pub struct Blame {
    violations: Vec<f32>,
}

impl Blame {
    pub fn clear(&mut self) {
        self.violations.clear();
    }

    /// A node without failures.
    pub fn add(&mut self) {
        self.violations.push(0.0);
    }

    /// An extension of a node has failed.
    pub fn fail(&mut self, context: &SearchContext<'_>, node: NodeId) {
        let share = 1.0 / context.inputs(node).max(1) as f32;
        let mut term = share;
        let mut at = Some(node);
        while let Some(node) = at.filter(|_| term >= LEAST) {
            if let Some(violation) = self.violations.get_mut(node.index()) {
                *violation = (*violation + term).min(1.0);
            }
            // With one input, failure is certain all the way up to where there was a choice.
            term *= share;
            at = context.tree.parent(node);
        }
    }

    /// What tells, for one search, which nodes take part.
    pub fn lottery(&self, context: &mut SearchContext<'_>) -> impl Fn(NodeId) -> bool + '_ {
        let drawn: f32 = context.rng.random();
        move |node| self.violations.get(node.index()).is_none_or(|v| *v <= drawn)
    }

    pub fn bytes(&self) -> usize {
        self.violations.capacity() * size_of::<f32>()
    }
}

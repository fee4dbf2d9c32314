//! Reachable states: where the inputs of each node lead. The idea of RG-RRT.
//!
//! Shkolnik, Walter and Tedrake, *Reachability-Guided Sampling for Planning Under Differential Constraints*, 2009: a sample
//! counts only if it is nearer to what a node can reach than to the node itself, so that nothing is grown towards where it
//! cannot go. The reachable set is the set of the states that the node's inputs lead to, each held for a drawn time. It is
//! made when the node is added; what fails then is not tried again.

use crate::reach::metric::{MODE_PENALTY, Metric, Point};
use crate::reach::nearest::Index;
use crate::reach::search_context::{Extension, SearchContext};
use crate::reach::strategy::Choice;
use crate::reach::tree::NodeId;

/// Of a node with more inputs than that, so many are looked ahead, by lot.
const MAX_AHEAD: usize = 64;

/// The states that one extension more would lead to.
#[derive(Debug)]
pub struct Reachable {
    ahead: Index,
    choices: Vec<Choice>,
    /// Leads to the goal.
    winner: Option<Choice>,
    point: Point,
    /// Inputs that failed when they were looked at.
    failed: Vec<NodeId>,
}

impl Reachable {
    pub fn new(metric: &Metric) -> Self {
        Reachable {
            ahead: Index::new(metric.coordinates().len(), metric.modes(), MODE_PENALTY),
            choices: Vec::new(),
            winner: None,
            point: Point::default(),
            failed: Vec::new(),
        }
    }

    pub fn clear(&mut self) {
        self.ahead.clear();
        self.choices.clear();
        self.winner = None;
    }

    /// Looks ahead from a new node; gives as many nodes as inputs failed (the node itself, each time).
    pub fn add(&mut self, context: &mut SearchContext<'_>, node: NodeId) -> &[NodeId] {
        self.failed.clear();
        let inputs = context.inputs(node);
        for nth in 0..inputs.min(MAX_AHEAD) {
            let input = if inputs <= MAX_AHEAD { nth } else { context.draw_input(node) };
            let choice = Choice { node, input, hold: context.draw_hold() };
            match context.preview(choice, &mut self.point) {
                Extension::Dead => {
                    context.tree.take(node, input);
                    self.failed.push(node);
                    continue;
                }
                Extension::Goal(_) => self.winner = Some(choice),
                Extension::Open => {}
            }
            self.ahead.push(&self.point.reals, &self.point.modes);
            self.choices.push(choice);
        }
        &self.failed
    }

    /// The choice that leads nearest to a sample, of nodes that are accepted; none if its node is nearer already.
    pub fn choose_where(
        &mut self,
        context: &mut SearchContext<'_>,
        toward: &Point,
        mut accept: impl FnMut(NodeId) -> bool,
    ) -> Option<Choice> {
        if let Some(choice) = self.winner.take() {
            context.tree.take(choice.node, choice.input);
            return Some(choice);
        }
        loop {
            let choices = &self.choices;
            let nearest =
                self.ahead.nearest_where(&toward.reals, &toward.modes, |index| accept(choices[index].node))?;
            let choice = choices[nearest.index];
            context.point(choice.node, &mut self.point);
            if toward.distance(&self.point, MODE_PENALTY) <= nearest.distance {
                return None;
            }
            self.ahead.remove(nearest.index);
            // Others may have tried it meanwhile.
            if context.tree.take(choice.node, choice.input) {
                return Some(choice);
            }
        }
    }

    pub fn bytes(&self) -> usize {
        self.ahead.bytes() + self.choices.capacity() * size_of::<Choice>()
    }
}

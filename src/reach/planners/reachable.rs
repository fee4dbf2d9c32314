//! Reachable states: the successors of each node. The idea of RG-RRT.
//!
//! Shkolnik, Walter and Tedrake, *Reachability-Guided Sampling for Planning Under Differential Constraints*, 2009: a
//! sample counts only if it is nearer to the reachable set of a node than to the node itself, so that no branch grows
//! towards states that it cannot reach. The reachable set of a node consists of its successors under all inputs, each
//! held for a random time. It is computed when the node is added; inputs that fail then are not tried again.

use crate::reach::metric::{MODE_PENALTY, Metric, Point};
use crate::reach::nearest::Index;
use crate::reach::search_context::{Extension, SearchContext};
use crate::reach::strategy::Choice;
use crate::reach::tree::NodeId;

/// Maximum number of inputs of a node that are simulated in advance; a random sample if there are more.
const MAX_AHEAD: usize = 64;

/// The successors of all nodes.
#[derive(Debug)]
pub struct Reachable {
    successors: Index,
    choices: Vec<Choice>,
    /// A choice that leads to the goal.
    goal_choice: Option<Choice>,
    point: Point,
    /// The node of the last call, once per failed input.
    failed: Vec<NodeId>,
}

impl Reachable {
    pub fn new(metric: &Metric) -> Self {
        Reachable {
            successors: Index::new(metric.coordinates().len(), metric.modes(), MODE_PENALTY).around(metric.around()),
            choices: Vec::new(),
            goal_choice: None,
            point: Point::default(),
            failed: Vec::new(),
        }
    }

    pub fn clear(&mut self) {
        self.successors.clear();
        self.choices.clear();
        self.goal_choice = None;
    }

    /// Simulates the inputs of a new node; returns the node once per failed input.
    pub fn add(&mut self, context: &mut SearchContext<'_>, node: NodeId) -> &[NodeId] {
        self.failed.clear();
        let inputs = context.inputs(node);
        for nth in 0..inputs.min(MAX_AHEAD) {
            let input = if inputs <= MAX_AHEAD { nth } else { context.draw_input(node) };
            let choice = Choice { node, input, hold: context.draw_hold() };
            match context.preview(choice, &mut self.point) {
                Extension::Dead => {
                    context.tree.mark_tried(node, input);
                    self.failed.push(node);
                    continue;
                }
                Extension::Goal(_) => self.goal_choice = Some(choice),
                Extension::Open => {}
            }
            self.successors.push(&self.point.reals, &self.point.modes);
            self.choices.push(choice);
        }
        &self.failed
    }

    /// The choice that leads nearest to a sample, among accepted nodes; `None` if its node is nearer already.
    pub fn choose_where(
        &mut self,
        context: &mut SearchContext<'_>,
        toward: &Point,
        mut accept: impl FnMut(NodeId) -> bool,
    ) -> Option<Choice> {
        if let Some(choice) = self.goal_choice.take() {
            context.tree.mark_tried(choice.node, choice.input);
            return Some(choice);
        }
        loop {
            let choices = &self.choices;
            let nearest =
                self.successors.nearest_where(&toward.reals, &toward.modes, |index| accept(choices[index].node))?;
            let choice = choices[nearest.index];
            context.point(choice.node, &mut self.point);
            if toward.distance(&self.point, MODE_PENALTY) <= nearest.distance {
                return None;
            }
            self.successors.remove(nearest.index);
            // It may have been tried in the meantime.
            if context.tree.mark_tried(choice.node, choice.input) {
                return Some(choice);
            }
        }
    }

    pub fn bytes(&self) -> usize {
        self.successors.bytes() + self.choices.capacity() * size_of::<Choice>()
    }
}

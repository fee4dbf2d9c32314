//! Draws inputs of nodes and how long they are held: any, such that were not tried, or those that go on with what was
//! held before. Part of the context of planners (`search_context.rs`).

use rand::RngExt;

use crate::sim::Input;

use super::search_context::SearchContext;
use super::strategy::Choice;
use super::tree::NodeId;

/// Of as many inputs, one holds anything of what only the modes ahead read, and one nothing; others go on as before.
const HOLDS_AHEAD: u32 = 4;

impl SearchContext<'_> {
    /// The number of steps for which the next input is held: each doubling of the minimum is equally likely, so that
    /// short and long times both occur.
    pub fn draw_hold(&mut self) -> u16 {
        let (low, high) = self.hold;
        if low >= high {
            return low;
        }
        let doublings = (high / low).ilog2();
        let octave = if doublings > 0 { self.rng.random_range(0..=doublings) } else { 0 };
        let least = low << octave;
        let most = if octave == doublings { high } else { (low << (octave + 1)) - 1 };
        self.rng.random_range(least..=most)
    }

    /// The least number of steps for which an input is held.
    pub fn least_hold(&self) -> u16 {
        self.hold.0
    }

    /// A random node of the tree.
    pub fn draw_node(&mut self) -> NodeId {
        NodeId(self.rng.random_range(0..self.tree.len().max(1)) as u32)
    }

    /// A random input of a node, tried or not.
    pub fn draw_input(&mut self, node: NodeId) -> usize {
        let inputs = self.inputs(node);
        self.rng.random_range(0..inputs.max(1))
    }

    /// A random untried input of a node, marked as tried, with a random hold; `None` if there is none.
    pub fn draw_untried(&mut self, node: NodeId) -> Option<Choice> {
        let untried = self.tree.untried(node);
        if untried == 0 {
            return None;
        }
        let nth = self.rng.random_range(0..untried);
        let input = self.tree.take_untried(node, nth);
        Some(Choice { node, input, hold: self.draw_hold() })
    }

    /// As [`SearchContext::draw_untried`], with what only the modes ahead read: as a rule, that stays as it was.
    pub fn draw_untried_holding(&mut self, node: NodeId) -> Option<Choice> {
        let choice = self.draw_untried(node)?;
        Some(Choice { input: self.hold_ahead(node, choice.input), ..choice })
    }

    /// As [`SearchContext::draw_untried_holding`], with the input that goes on with what led to the node, as far as its
    /// modes read that.
    pub fn draw_continuing(&mut self, node: NodeId) -> Option<Choice> {
        let before = self.tree.before(node)?;
        let held = self.controls.input(self.tree.set(before.node), before.input);
        let input = self.most_like(node, held)?;
        if !self.tree.mark_tried(node, input) {
            return self.draw_untried_holding(node);
        }
        let hold = self.draw_hold();
        Some(Choice { node, input: self.hold_ahead(node, input), hold })
    }

    /// What the players do in an input of a node.
    pub fn input(&self, node: NodeId, input: usize) -> &Input {
        self.controls.input(self.tree.set(node), input)
    }

    /// The input of a node that is most like another, as far as its modes read that.
    fn most_like(&self, node: NodeId, wanted: &Input) -> Option<usize> {
        (0..self.inputs(node)).min_by_key(|input| wanted.difference(self.input(node, *input)))
    }

    /// The input of a node that is most like another, also in what only the modes ahead read.
    pub fn input_like(&self, node: NodeId, wanted: &Input) -> usize {
        let (set, input) = (self.tree.set(node), self.most_like(node, wanted).unwrap_or(0));
        match self.controls.combinations_ahead(set) {
            1 => input,
            _ => self.controls.holding_ahead(set, input, self.controls.combination_of(set, wanted)),
        }
    }

    /// An input of a node with what only the modes ahead read.
    fn hold_ahead(&mut self, node: NodeId, input: usize) -> usize {
        let set = self.tree.set(node);
        let combinations = self.controls.combinations_ahead(set);
        if combinations == 1 {
            return input;
        }
        let combination = match self.rng.random_range(0..HOLDS_AHEAD) {
            0 => self.rng.random_range(0..combinations),
            1 => 0,
            _ => self.tree.before(node).map_or(0, |before| {
                self.controls.combination_of(set, self.controls.input(self.tree.set(before.node), before.input))
            }),
        };
        self.controls.holding_ahead(set, input, combination)
    }

    /// The number of inputs of a node, tried or not.
    pub fn inputs(&self, node: NodeId) -> usize {
        self.controls.count(self.tree.set(node))
    }
}

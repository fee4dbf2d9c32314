//! Reuses what was found: a path found for one question may also pass another goal, or break a `never`, and searches go on
//! from states on each other's ways (`portfolio.rs`).

use crate::sim::Script;
use crate::watch::{Meter, Watch};

use super::outcome::Plan;
use super::problem::{Problem, Start};
use super::search_context::{SearchContext, replays_to};
use super::start_hold::is_held;
use super::tree::NodeId;

/// A plan for a question, cut from a script that was found for another one, if the target holds on the way. The first
/// `after` steps of the script were given with the question.
#[must_use]
pub fn plan_from_script(problem: &Problem<'_>, script: &Script, after: u64, watch: &dyn Watch) -> Option<Plan> {
    let steps = replays_to(problem, script, after, &mut problem.sim.scratch(), &Meter::new(watch))?;
    if problem.time().is_some_and(|most| steps - after > u64::from(most)) {
        return None;
    }
    let cut = script.first(steps);
    let is_admitted = is_held(&cut, after, problem.min_hold()) && problem.is_unpressed(&cut, after);
    is_admitted.then_some(Plan { steps, script: cut, after, is_shortest: false })
}

impl SearchContext<'_> {
    /// The starts on the latest way that was adopted.
    pub(super) fn adopted(&self) -> std::ops::Range<usize> {
        self.starts.len() - self.latest..self.starts.len()
    }

    /// Adds states on a way of another search as starts.
    pub(super) fn adopt(&mut self, way: &[Start]) {
        self.latest = way.len();
        self.starts.extend_from_slice(way);
    }

    /// Whether ways can be exchanged: not where nature draws, as states then depend on more than inputs.
    pub(super) fn can_exchange(&self) -> bool {
        self.luck.is_none() && self.problem.time().is_none()
    }

    /// At most so many states on the way to a node as starts, the node's last.
    pub(super) fn way_to(&mut self, node: NodeId, most: usize) -> Vec<Start> {
        let mut way = vec![node];
        while let Some(before) = self.tree.parent(way[way.len() - 1]) {
            way.push(before);
        }
        let apart = way.len().div_ceil(most);
        let mut starts = Vec::new();
        for node in way.into_iter().step_by(apart) {
            let script = match self.tree.before(node) {
                Some(choice) => self.script(choice, choice.hold),
                None => self.start(node).script.clone(),
            };
            let mut start = Start { script, ..self.start(node).clone() };
            start.state.copy_from_slice(self.tree.state(node, &mut self.buffer));
            starts.push(start);
        }
        starts.reverse();
        starts
    }
}

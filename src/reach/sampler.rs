//! The planning loop of sampling planners: sample, choose a node and an input, extend, learn; with restarts.
//!
//! Restarts follow the universal sequence 1, 1, 2, 1, 1, 2, 4, … of Luby, Sinclair and Zuckerman, *Optimal Speedup of
//! Las Vegas Algorithms*, 1993: an early choice that cannot be undone (boarding a platform at the wrong moment) makes
//! single trees heavy-tailed.

use rand::RngExt;

use super::distance::DistanceField;
use super::known_states::KnownStates;
use super::lost::Lost;
use super::metric::Point;
use super::outcome::Plan;
use super::problem::Start;
use super::region::GoalRegion;
use super::search_context::{Extension, Notes, SearchContext};
use super::searcher::{Ending, Searcher};
use super::strategy::{Choice, Growth, Strategy};
use super::tree::NodeId;

/// Maximum number of consecutive samples that a strategy may discard before its tree is abandoned.
const MAX_DISCARDED: u64 = 10_000;

/// Maximum number of consecutive trees without a node besides their root before the search ends.
const MAX_EMPTY_TREES: u64 = 1_000;

/// Maximum number of states on a way that another search goes on from.
const MAX_WAY: usize = 64;
/// From each start as many trees are grown at least before the search ends because they are alike.
const STARTED: u64 = 4;

/// Cost of choosing an extension, in units of work, without comparisons.
const SAMPLE_WORK: u64 = 512;

/// Number of compared coordinates per unit of work: the index skips most nodes.
const COMPARISONS_PER_WORK: u64 = 16;

/// Grows trees with a strategy, with restarts.
pub(super) struct Sampler<'a> {
    context: SearchContext<'a>,
    strategy: Box<dyn Strategy + Send + 'a>,
    /// The name of the planner.
    name: &'static str,
    region: GoalRegion,
    /// The share of samples that are drawn from the goal region; `None` if the strategy uses no samples.
    goal_bias: Option<f64>,
    /// Number of nodes of the shortest tree before a restart; `None`: never.
    restart: Option<u64>,
    /// Maximum number of nodes of the current tree.
    max_tree_nodes: u64,
    distances: Option<&'a DistanceField>,
    /// Number of nodes without a faster path after which it ends with the fastest one; 0: with the first.
    patience: u64,
    /// The fastest path so far, and the number of nodes when it was found.
    fastest: Option<(Plan, u64)>,
    /// Maximum number of steps of a path: one less than the fastest has, of this search or of others.
    most: Option<u32>,
    lost: &'a Lost,
    /// The states of the tree, where they are not added again: of a strategy that tries each input of a node once, in a world
    /// where nature does not draw.
    known: Option<KnownStates>,
    /// The distance field, if ways are exchanged with other searches.
    exchanged: Option<&'a DistanceField>,
    /// The least distance of a node so far, and the node, if it is of the current tree.
    nearest: (u32, Option<NodeId>),
    /// The way to the nearest node of earlier trees.
    way: Vec<Start>,
    round: u64,
    /// Whether this tree is given up for one that looks for a faster path.
    is_given_up: bool,
    /// Number of coordinates of a point.
    coordinates: u64,
    discarded: u64,
    /// Number of consecutive trees without a node besides their root.
    empty_trees: u64,
    toward: Point,
    point: Point,
}

impl<'a> Sampler<'a> {
    pub fn new(
        context: SearchContext<'a>,
        strategy: Box<dyn Strategy + Send + 'a>,
        name: &'static str,
        goal_bias: Option<f64>,
        (restart, patience): (Option<u64>, u64),
        (distances, lost): (Option<&'a DistanceField>, &'a Lost),
    ) -> Self {
        // Near to an edge is not near to the goal: what is too fast there gets no further.
        let exchanged = distances.filter(|of| of.is_goal() && context.can_exchange());
        let known = (goal_bias.is_none() && context.luck.is_none()).then(KnownStates::default);
        let region = GoalRegion::new(context.problem, context.metric);
        let coordinates = context.metric.coordinates().len() as u64 + 1;
        Sampler {
            strategy,
            name,
            region,
            goal_bias: goal_bias.map(|share| share.clamp(0.0, 1.0)),
            restart,
            max_tree_nodes: 0,
            distances,
            patience,
            fastest: None,
            most: None,
            lost,
            known,
            exchanged,
            nearest: (u32::MAX, None),
            way: Vec::new(),
            context,
            round: 0,
            is_given_up: false,
            coordinates,
            discarded: 0,
            empty_trees: 0,
            toward: Point::default(),
            point: Point::default(),
        }
    }

    /// Adds states on the latest way that was adopted as roots.
    fn add_adopted(&mut self) {
        for start in self.context.adopted() {
            let root = self.add_root(start);
            self.strategy.learn(&mut self.context, None, Growth::Added(root, &self.point));
        }
    }

    /// Adds a start as a root, with its point.
    fn add_root(&mut self, start: usize) -> NodeId {
        let root = self.context.add_root(start, true);
        self.context.point(root, &mut self.point);
        if let Some(known) = &mut self.known {
            known.add(root, self.context.reached());
        }
        root
    }

    /// The node with the state that a choice has led to, if the tree had reached it before, as soon as that where it matters.
    fn known(&self, choice: Choice) -> Option<NodeId> {
        let counts_steps = self.strategy.counts_steps() || self.time().is_some();
        let (tree, state) = (&self.context.tree, self.context.reached());
        let depth = if counts_steps { tree.depth(choice.node) + u32::from(choice.hold) } else { u32::MAX };
        self.known.as_ref()?.find(tree, state, depth)
    }

    /// Keeps the way to the nearest node of the tree, which is removed next.
    fn keep_way(&mut self) {
        if let Some(node) = self.nearest.1.take() {
            self.way = self.context.way_to(node, MAX_WAY);
        }
    }

    /// Notes the node that was added last if it is nearer to the goal than all others.
    fn note_nearest(&mut self, node: NodeId) {
        let Some(distances) = self.exchanged else { return };
        let distance = distances.of(self.context.problem.sim, self.context.reached());
        if distance < self.nearest.0 {
            self.nearest = (distance, Some(node));
        }
    }

    /// Starts the next tree at the next start.
    fn start_tree(&mut self) {
        self.keep_way();
        if std::mem::take(&mut self.is_given_up) {
            self.context.adopt(&[]);
        }
        self.round += 1;
        self.discarded = 0;
        self.empty_trees = if self.context.tree.len() == 1 { self.empty_trees + 1 } else { 0 };
        self.max_tree_nodes =
            self.restart.map_or(u64::MAX, |shortest| shortest.max(2).saturating_mul(luby(self.round)));
        self.context.clear();
        self.known.iter_mut().for_each(KnownStates::clear);
        let start = (self.round - 1) as usize % self.context.starts().max(1);
        let root = self.add_root(start);
        self.context.notes.statistics.trees += 1;
        self.strategy.learn(&mut self.context, None, Growth::Rooted(root, &self.point));
        // Every other tree finds ways of its own: those of one way may all come too early.
        if self.round.is_multiple_of(2) {
            self.add_adopted();
        }
    }

    fn is_over(&self) -> bool {
        let tree = &self.context.tree;
        self.is_given_up
            || tree.len() as u64 >= self.max_tree_nodes
            || tree.open_nodes() == 0
            || self.discarded >= MAX_DISCARDED
            || self.strategy.is_over()
    }

    fn choose(&mut self) -> Option<Choice> {
        if let Some(goal_bias) = self.goal_bias {
            self.context.metric.sample(&mut self.context.rng, &mut self.toward);
            if !self.strategy.aim(&mut self.context, &self.region, &mut self.toward)
                && self.context.rng.random_bool(goal_bias)
            {
                self.region.pull(&mut self.context.rng, &mut self.toward);
            }
        }
        self.strategy.choose(&mut self.context, &self.toward)
    }

    /// Maximum number of steps of a path: of the question, and to be faster than the fastest so far, of this search or of
    /// others.
    fn time(&self) -> Option<u32> {
        self.most.into_iter().chain(self.context.problem.time()).min()
    }

    /// Whether the remaining time at a depth is less than the lower bound from a state.
    fn is_too_late(&self, state: &[u8], depth: u32) -> bool {
        let (Some(most), Some(distances)) = (self.time(), self.distances) else { return false };
        depth.saturating_add(distances.least_steps(self.context.problem.sim, state)) > most
    }

    /// Whether all starts are too far away from the goal for the time limit, or all recent trees were empty or alike.
    fn is_hopeless(&self) -> bool {
        let tree = &self.context.tree;
        let has_tried_all = self.round > STARTED * self.context.starts() as u64;
        has_tried_all && self.strategy.is_spent()
            || self.empty_trees >= MAX_EMPTY_TREES
            || self.empty_trees >= self.context.starts() as u64
                && !tree.is_empty()
                && self.context.start_states().all(|(state, depth)| self.is_too_late(state, depth))
    }

    /// The work of choosing an extension. Only samples are compared with nodes, in the worst case with all of them; if
    /// others paid for that too, a large tree would get ever less of the work that is shared.
    fn sample_work(&self) -> u64 {
        let compared = if self.goal_bias.is_some() { self.context.tree.len() as u64 + 1 } else { 0 };
        SAMPLE_WORK + self.coordinates * compared / COMPARISONS_PER_WORK
    }

    /// One iteration of the loop.
    fn iterate(&mut self) -> Option<Plan> {
        let Some(choice) = self.choose() else {
            // A strategy that discards every sample is stuck in this tree.
            self.discarded += 1;
            return None;
        };
        self.discarded = 0;
        let extension = self.context.extend(choice);
        let choice = self.context.as_held(choice);
        match extension {
            // What the goal needs is used up.
            Extension::Open if self.lost.is_in(self.context.problem.sim, self.context.reached()) => {
                self.strategy.learn(&mut self.context, Some(choice), Growth::Failed);
            }
            Extension::Open
                if self.is_too_late(
                    self.context.reached(),
                    self.context.tree.depth(choice.node) + u32::from(choice.hold),
                ) =>
            {
                self.strategy.learn(&mut self.context, Some(choice), Growth::Late);
            }
            Extension::Open => {
                if let Some(known) = self.known(choice) {
                    self.context.reached_point(&mut self.point);
                    self.strategy.learn(&mut self.context, Some(choice), Growth::Known(known, &self.point));
                    return None;
                }
                let node = self.context.add(choice, true);
                if let Some(known) = &mut self.known {
                    known.add(node, self.context.reached());
                }
                self.context.point(node, &mut self.point);
                self.strategy.learn(&mut self.context, Some(choice), Growth::Added(node, &self.point));
                self.note_nearest(node);
            }
            Extension::Dead => self.strategy.learn(&mut self.context, Some(choice), Growth::Failed),
            Extension::Goal(steps) => {
                let after = self.context.tree.depth(choice.node) + u32::from(steps);
                if self.time().is_none_or(|most| after <= most) {
                    return self.context.plan(choice, steps, false);
                }
                self.strategy.learn(&mut self.context, Some(choice), Growth::Late);
            }
        }
        None
    }

    /// Takes a path, which is faster than all before; returns it if it ends the search.
    fn take(&mut self, plan: Plan) -> Option<Plan> {
        if self.patience == 0 {
            return Some(plan);
        }
        self.limit(plan.steps - plan.after);
        self.fastest = Some((plan, self.nodes()));
        None
    }

    /// From now on, paths have fewer steps than a number.
    fn limit(&mut self, steps: u64) {
        self.most = u32::try_from(steps.saturating_sub(1)).ok();
        // There is no missing answer to explain any more.
        self.context.stop_tracking();
    }

    /// Whether it has been long since the fastest path was found.
    fn is_fast_enough(&self) -> bool {
        self.fastest.as_ref().is_some_and(|(_, at)| self.nodes() - at >= self.patience)
    }
}

impl Searcher for Sampler<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        let until = self.context.notes.statistics.nodes.saturating_add(nodes);
        while self.context.notes.statistics.nodes < until {
            if self.is_fast_enough()
                && let Some(plan) = self.pending()
            {
                return Ending::Reached(plan);
            }
            if self.context.meter.spend(self.sample_work()) {
                return Ending::Stopped;
            }
            if self.is_over() {
                self.start_tree();
                if self.is_hopeless() {
                    return self.pending().map_or(Ending::Spent, Ending::Reached);
                }
            } else if let Some(plan) = self.iterate().and_then(|plan| self.take(plan)) {
                return Ending::Reached(plan);
            }
        }
        Ending::Paused
    }

    fn pending(&mut self) -> Option<Plan> {
        self.fastest.take().map(|(plan, _)| plan)
    }

    fn nearest(&self) -> Option<u32> {
        self.exchanged.map(|_| self.nearest.0)
    }

    fn way(&mut self) -> Vec<Start> {
        self.keep_way();
        self.way.clone()
    }

    fn follows(&self) -> bool {
        self.exchanged.is_some() && self.strategy.follows()
    }

    fn adopt(&mut self, nearest: u32, way: &[Start]) {
        self.nearest = (nearest, None);
        self.way = way.to_vec();
        self.context.adopt(way);
        if !self.context.tree.is_empty() {
            self.add_adopted();
        }
    }

    fn has_found(&self) -> bool {
        self.fastest.is_some()
    }

    fn look_for_faster(&mut self, steps: u64) {
        // What was adopted is on a way that is no longer in time, or hardly.
        self.is_given_up |= self.most.is_none() && (self.strategy.starts_over() || !self.context.adopted().is_empty());
        if self.is_given_up {
            self.nearest = (u32::MAX, None);
        }
        self.limit(steps);
    }

    fn nodes(&self) -> u64 {
        self.context.notes.statistics.nodes
    }

    fn work(&self) -> u64 {
        self.context.meter.total()
    }

    fn places(&self) -> u64 {
        self.context.notes.coverage.count().places
    }

    fn report(&self, notes: &mut Notes) {
        self.context.report(notes);
    }

    fn planner(&self) -> &'static str {
        self.strategy.planner().unwrap_or(self.name)
    }

    fn bytes(&self) -> usize {
        self.context.bytes() + self.strategy.bytes() + self.known.as_ref().map_or(0, KnownStates::bytes)
    }
}

/// The `i`-th term, from 1, of the universal restart sequence.
fn luby(mut i: u64) -> u64 {
    loop {
        let next = (i + 1).next_power_of_two();
        if i + 1 == next {
            return next / 2;
        }
        i = i + 1 - next / 2;
    }
}

#[cfg(test)]
mod tests {
    use super::luby;

    #[test]
    fn restarts_follow_the_universal_sequence() {
        let terms: Vec<u64> = (1..=15).map(luby).collect();
        assert_eq!(terms, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }
}

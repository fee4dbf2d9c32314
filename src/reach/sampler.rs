//! The planning loop of all that sample: sample, choose a node and an input, extend, learn; and restarts.
//!
//! Restarts follow the universal sequence 1, 1, 2, 1, 1, 2, 4, … of Luby, Sinclair and Zuckerman, *Optimal Speedup of
//! Las Vegas Algorithms*, 1993: an early choice that cannot be undone (boarding a platform at the wrong moment) makes
//! single trees heavy-tailed.

use rand::RngExt;

use super::distance::Distances;
use super::metric::Point;
use super::outcome::Plan;
use super::region::GoalRegion;
use super::search_context::{Extension, Notes, SearchContext};
use super::searcher::{Ending, Searcher};
use super::strategy::{Choice, Growth, Strategy};

/// How many samples in a row a strategy may discard before its tree is given up.
const MAX_FRUITLESS: u64 = 10_000;

/// So many trees in a row may stay without a node beside their roots before nothing more is tried: all that is possible there
/// ends at once, or has no time left.
const MAX_BARREN: u64 = 1_000;

/// What a sample costs, in units of work, beside being compared.
const TRY: u64 = 512;

/// So many coordinates are compared for a unit of work: indexes leave most nodes out.
const COMPARED: u64 = 16;

/// A tree that a strategy grows from samples, planted anew now and then.
pub(super) struct Sampler<'a> {
    context: SearchContext<'a>,
    strategy: Box<dyn Strategy + Send + 'a>,
    /// The planner's.
    name: &'static str,
    region: GoalRegion,
    /// The share of samples that are drawn towards the goal; none if the strategy looks at no samples.
    goal_bias: Option<f64>,
    /// The number of nodes of the shortest tree before a restart; none: never.
    restart: Option<u64>,
    /// How many nodes the tree may have.
    allowance: u64,
    /// What tells how long the rest of a way takes at least, where there is a time to keep.
    distances: Option<&'a Distances>,
    round: u64,
    /// How many coordinates a point has.
    coordinates: u64,
    fruitless: u64,
    /// How many trees in a row have stayed without a node beside their roots.
    barren: u64,
    toward: Point,
    point: Point,
}

impl<'a> Sampler<'a> {
    pub fn new(
        context: SearchContext<'a>,
        strategy: Box<dyn Strategy + Send + 'a>,
        name: &'static str,
        goal_bias: Option<f64>,
        restart: Option<u64>,
        distances: Option<&'a Distances>,
    ) -> Self {
        let region = GoalRegion::new(context.problem, context.metric);
        let coordinates = context.metric.coordinates().len() as u64 + 1;
        Sampler {
            strategy,
            name,
            region,
            goal_bias: goal_bias.map(|share| share.clamp(0.0, 1.0)),
            restart,
            allowance: 0,
            distances: distances.filter(|_| context.problem.time().is_some()),
            context,
            round: 0,
            coordinates,
            fruitless: 0,
            barren: 0,
            toward: Point::default(),
            point: Point::default(),
        }
    }

    /// Begins the next tree, at the next start.
    fn plant(&mut self) {
        self.round += 1;
        self.fruitless = 0;
        self.barren = if self.context.tree.len() == 1 { self.barren + 1 } else { 0 };
        self.allowance = self.restart.map_or(u64::MAX, |shortest| shortest.max(2).saturating_mul(luby(self.round)));
        self.context.clear();
        let start = (self.round - 1) as usize % self.context.starts().max(1);
        let root = self.context.plant(start, true);
        self.context.notes.statistics.trees += 1;
        self.context.point(root, &mut self.point);
        self.strategy.learn(&mut self.context, None, Growth::Rooted(root, &self.point));
    }

    fn is_over(&self) -> bool {
        let tree = &self.context.tree;
        tree.len() as u64 >= self.allowance || tree.open_nodes() == 0 || self.fruitless >= MAX_FRUITLESS
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

    /// Whether the rest of the way from a state takes longer than there is time after so many steps.
    fn is_too_late(&self, state: &[u8], depth: u32) -> bool {
        let (Some(most), Some(distances)) = (self.context.problem.time(), self.distances) else { return false };
        let sim = self.context.problem.sim;
        let (x, y) = sim.position(state, distances.player);
        let rest = distances.least_steps(sim.space(state, distances.player), x, y);
        depth.saturating_add(rest) > most
    }

    /// Whether all starts are too far away from the goal for the time that there is, as far as `lead` can tell: then every
    /// tree would stay without a node.
    fn is_hopeless(&self) -> bool {
        let tree = &self.context.tree;
        self.barren >= MAX_BARREN
            || self.barren >= self.context.starts() as u64
                && !tree.is_empty()
                && self.context.start_states().all(|(state, depth)| self.is_too_late(state, depth))
    }

    /// One turn of the loop.
    fn turn(&mut self) -> Option<Plan> {
        let Some(choice) = self.choose() else {
            // A strategy that discards every sample has nothing more to say about this tree.
            self.fruitless += 1;
            return None;
        };
        self.fruitless = 0;
        match self.context.extend(choice) {
            // From there, the goal is too far away for the time that is left.
            Extension::Open
                if self.is_too_late(
                    self.context.reached(),
                    self.context.tree.depth(choice.node) + u32::from(choice.hold),
                ) =>
            {
                self.strategy.learn(&mut self.context, Some(choice), Growth::Failed);
            }
            Extension::Open => {
                let node = self.context.add(choice, true);
                self.context.point(node, &mut self.point);
                self.strategy.learn(&mut self.context, Some(choice), Growth::Added(node, &self.point));
            }
            Extension::Dead => self.strategy.learn(&mut self.context, Some(choice), Growth::Failed),
            Extension::Goal(steps) => {
                return self.context.plan(choice, steps, false);
            }
        }
        None
    }
}

impl Searcher for Sampler<'_> {
    fn advance(&mut self, nodes: u64) -> Ending {
        let until = self.context.notes.statistics.nodes.saturating_add(nodes);
        while self.context.notes.statistics.nodes < until {
            // A sample is compared with nodes, at worst with all of them.
            let compared = self.context.tree.len() as u64 + 1;
            if self.context.meter.spend(TRY + self.coordinates * compared / COMPARED) {
                return Ending::Stopped;
            }
            if self.is_over() {
                self.plant();
                if self.is_hopeless() {
                    return Ending::Spent;
                }
            } else if let Some(plan) = self.turn() {
                return Ending::Reached(plan);
            }
        }
        Ending::Paused
    }

    fn nodes(&self) -> u64 {
        self.context.notes.statistics.nodes
    }

    fn places(&self) -> u64 {
        self.context.notes.coverage.count().places
    }

    fn report(&self, notes: &mut Notes) {
        self.context.report(notes);
    }

    fn planner(&self) -> &'static str {
        self.name
    }

    fn bytes(&self) -> usize {
        self.context.bytes() + self.strategy.bytes()
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

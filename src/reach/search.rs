//! The planning loop: sample, choose a node and an input, extend, learn; restarts, the budget, the replay.
//!
//! Restarts follow the universal sequence 1, 1, 2, 1, 1, 2, 4, … of Luby, Sinclair and Zuckerman, *Optimal Speedup of
//! Las Vegas Algorithms*, 1993: an early choice that cannot be undone (boarding a platform at the wrong moment) makes
//! single trees heavy-tailed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::sim::{Fault, Input, Scratch, Script};
use crate::watch::{Progress, Watch};

use super::bounds::Sampling;
use super::controls::ControlSets;
use super::metric::{Metric, Point};
use super::outcome::{Outcome, Plan, Verdict};
use super::problem::{Problem, Standing};
use super::region::GoalRegion;
use super::strategy::{Choice, Growth, Strategy};
use super::tree::{NodeId, Tree};

/// How a search goes about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The seed of the generator: the same seed gives the same search.
    pub seed: u64,
    /// For how many steps an input is held: drawn between both, ends included.
    pub hold: (u16, u16),
    /// The share of samples that are drawn towards the goal.
    pub goal_bias: f64,
    /// The number of nodes of the shortest tree before a restart.
    pub restart: u64,
    /// Where samples are drawn from.
    pub sampling: Sampling,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { seed: 1, hold: (10, 10), goal_bias: 0.05, restart: 2_000, sampling: Sampling::Reduced }
    }
}

/// What a search may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Nodes over all trees.
    pub nodes: u64,
}

/// How many samples in a row a strategy may discard before its tree is given up.
const MAX_FRUITLESS: u64 = 10_000;

/// How often the watch is asked, in extensions.
const WATCH_EVERY: u64 = 64;

/// Grows trees until the goal is found or the budget is spent.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn search(
    problem: &Problem<'_>,
    metric: &Metric,
    strategy: &mut dyn Strategy,
    settings: &Settings,
    limits: &Limits,
    watch: &dyn Watch,
) -> Result<Outcome, Fault> {
    let mut scratch = problem.sim.scratch();
    let root = problem.sim.initial(&mut scratch)?;
    let mut outcome = Outcome::of(Verdict::NotFound);
    match problem.judge(&root)? {
        Standing::Open => {}
        Standing::Goal => {
            outcome.verdict = Verdict::Reached(Plan { script: Script::default(), steps: 0 });
            return Ok(outcome);
        }
        Standing::Dead => return Ok(outcome),
    }
    let mut planner = Planner {
        problem,
        metric,
        settings,
        limits,
        watch,
        region: GoalRegion::new(problem, metric),
        controls: ControlSets::default(),
        tree: Tree::new(root.len()),
        rng: Pcg64::seed_from_u64(settings.seed),
        scratch,
        work: root.clone(),
        outcome,
    };
    let mut round = 1;
    while !planner.is_done() {
        let allowance = settings.restart.max(1).saturating_mul(luby(round));
        if let Some(script) = planner.grow(strategy, &root, allowance) {
            let steps = script.len();
            planner.outcome.verdict = Verdict::Reached(Plan { script, steps });
            break;
        }
        round += 1;
    }
    planner.outcome.truncated = planner.controls.truncated;
    Ok(planner.outcome)
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

struct Planner<'a> {
    problem: &'a Problem<'a>,
    metric: &'a Metric,
    settings: &'a Settings,
    limits: &'a Limits,
    watch: &'a dyn Watch,
    region: GoalRegion,
    controls: ControlSets,
    tree: Tree,
    rng: Pcg64,
    scratch: Scratch,
    work: Vec<u8>,
    outcome: Outcome,
}

/// How an extension ended.
enum Extension {
    Open,
    Dead,
    Goal(u16),
}

impl Planner<'_> {
    fn is_done(&self) -> bool {
        self.outcome.stopped || self.outcome.statistics.nodes >= self.limits.nodes
    }

    /// Grows one tree up to a number of nodes; gives the way to the goal, if it found one that replays.
    fn grow(&mut self, strategy: &mut dyn Strategy, root: &[u8], allowance: u64) -> Option<Script> {
        let mut toward = Point::default();
        let mut point = Point::default();
        self.tree.clear();
        self.add(root, NodeId(0), 0, 0);
        self.outcome.statistics.trees += 1;
        self.metric.point(self.problem.sim.world(), root, &mut point);
        strategy.learn(&self.tree, None, Growth::Rooted(&point));
        let mut tries = 0u64;
        let mut fruitless = 0u64;
        while (self.tree.len() as u64) < allowance && !self.is_done() && !strategy.exhausted(&self.tree) {
            tries += 1;
            if tries.is_multiple_of(WATCH_EVERY) {
                let s = &self.outcome.statistics;
                self.watch.progress(Progress { nodes: s.nodes, budget: self.limits.nodes, trees: s.trees });
                self.outcome.stopped = self.watch.stop();
            }
            self.metric.sample(&mut self.rng, &mut toward);
            if self.rng.random_bool(self.settings.goal_bias.clamp(0.0, 1.0)) {
                self.region.pull(&mut self.rng, &mut toward);
            }
            let Some(choice) = strategy.choose(&mut self.tree, &toward, &mut self.rng) else {
                // A strategy that discards every sample has nothing more to say about this tree.
                fruitless += 1;
                if fruitless >= MAX_FRUITLESS {
                    break;
                }
                continue;
            };
            fruitless = 0;
            let (low, high) = self.settings.hold;
            let hold = if low < high { self.rng.random_range(low..=high) } else { low.max(1) };
            match self.extend(choice, hold) {
                Extension::Open => {
                    self.metric.point(self.problem.sim.world(), &self.work, &mut point);
                    let state = std::mem::take(&mut self.work);
                    self.add(&state, choice.node, choice.input as u16, hold);
                    self.work = state;
                    strategy.learn(&self.tree, Some(choice), Growth::Added(&point));
                }
                Extension::Dead => {
                    self.outcome.statistics.failures += 1;
                    strategy.learn(&self.tree, Some(choice), Growth::Failed);
                }
                Extension::Goal(steps) => {
                    let set = self.tree.set(choice.node);
                    let mut script = self.tree.script(choice.node, |set| self.controls.inputs(set));
                    script.push(&self.controls.inputs(set)[choice.input], u32::from(steps));
                    if self.replays(&script) {
                        return Some(script);
                    }
                    debug_assert!(false, "a found path must replay");
                }
            }
        }
        None
    }

    fn add(&mut self, state: &[u8], parent: NodeId, input: u16, hold: u16) {
        let set = self.controls.of(self.problem, state);
        let inputs = self.controls.inputs(set).len();
        self.tree.push(state, parent, input, hold, set, inputs);
        self.outcome.statistics.nodes += 1;
    }

    /// Simulates a choice in the working state.
    fn extend(&mut self, choice: Choice, hold: u16) -> Extension {
        self.work.copy_from_slice(self.tree.state(choice.node));
        let input: &Input = &self.controls.inputs(self.tree.set(choice.node))[choice.input];
        self.outcome.statistics.extensions += 1;
        for step in 1..=hold {
            self.outcome.statistics.steps += 1;
            let stepped = self.problem.sim.step(&mut self.work, input, &mut self.scratch);
            match stepped.and_then(|()| self.problem.judge(&self.work)) {
                Ok(Standing::Open) => {}
                Ok(Standing::Goal) => return Extension::Goal(step),
                Ok(Standing::Dead) => return Extension::Dead,
                Err(fault) => {
                    let before = self.tree.script(choice.node, |set| self.controls.inputs(set)).len();
                    self.outcome.fault.get_or_insert((fault, before + u64::from(step)));
                    return Extension::Dead;
                }
            }
        }
        Extension::Open
    }

    /// Runs a script from the initial state: the goal must hold after its last step, and no branch may end before.
    fn replays(&mut self, script: &Script) -> bool {
        let sim = self.problem.sim;
        let Ok(mut state) = sim.initial(&mut self.scratch) else {
            return false;
        };
        let mut standing = Ok(Standing::Open);
        for input in script.inputs() {
            if standing != Ok(Standing::Open) {
                return false;
            }
            standing = sim.step(&mut state, input, &mut self.scratch).and_then(|()| self.problem.judge(&state));
        }
        standing == Ok(Standing::Goal)
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

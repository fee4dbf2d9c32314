//! Explains why a goal cannot be reached: the parts of its predicate that hold in no state of the configuration space,
//! with the values that they read.

use crate::analysis::{ConfigurationSpace, Interval, Part, never_holds};
use crate::ir::SlotId;
use crate::sim::Fault;
use crate::watch::Watch;

use super::problem::{Problem, Target};

/// The argument that a goal cannot be reached; each part would need the opposite truth value.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// The parts of the goal's predicate.
    pub parts: Vec<Part>,
}

impl Proof {
    /// A proof from the analysis that the target holds in no state, if there is one. A `never` also counts in the state
    /// in which a run ends, so its space must contain those states.
    pub fn of(problem: &Problem<'_>, space: &ConfigurationSpace) -> Option<Proof> {
        let (program, world) = (problem.sim.program(), problem.sim.world_id());
        never_holds(program, world, problem.predicate(), space).map(|parts| Proof { parts })
    }
}

/// A goal that is too far away for the time limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooFar {
    /// The player that would have to reach it.
    pub player: SlotId,
    /// The positions that it can have by then, per axis.
    pub within: [Interval; 2],
    /// A lower bound of the number of steps.
    pub least: u64,
}

/// Upper limit of the search for the lower bound.
const MAX_STEPS: u64 = 1 << 32;

impl TooFar {
    /// A proof that no player can be where the goal holds within the time limit, if there is one.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub fn of(problem: &Problem<'_>, space: &ConfigurationSpace, watch: &dyn Watch) -> Result<Option<TooFar>, Fault> {
        let (Some(time), Target::Goal(_)) = (problem.time(), problem.target) else { return Ok(None) };
        let Some(starts) = problem.starts(watch)? else { return Ok(None) };
        let (sim, predicate) = (problem.sim, problem.predicate());
        let within = |player: SlotId, state: &[u8], steps: u64| {
            let (x, y) = sim.position(state, player);
            space.within_steps(sim.program(), sim.world_id(), player, [x, y], steps)
        };
        // Whether the goal can hold within a number of steps, judging by one player.
        let can = |player: SlotId, steps: u64| {
            starts.iter().any(|start| {
                within(player, &start.state, steps).is_none_or(|part| {
                    let part = (player, sim.space(&start.state, player), part);
                    space.can_hold_in(sim.program(), sim.world_id(), predicate, part)
                })
            })
        };
        let time = u64::from(time);
        let found = problem.players().iter().find(|player| !can(**player, time)).map(|&player| {
            let (mut low, mut high) = (time, time.saturating_mul(2).max(1));
            while high < MAX_STEPS && !can(player, high) {
                (low, high) = (high, high * 2);
            }
            // It cannot hold after `low` steps; after `high` it may.
            while low + 1 < high {
                let middle = low.midpoint(high);
                if can(player, middle) { high = middle } else { low = middle }
            }
            let parts = starts.iter().filter_map(|start| within(player, &start.state, time));
            let hull = parts.reduce(|a, b| [a[0].or(b[0]), a[1].or(b[1])]);
            TooFar { player, within: hull.unwrap_or([Interval::ALL; 2]), least: low + 1 }
        });
        Ok(found)
    }
}

//! Explains why a goal cannot be reached: the parts of its predicate that hold in no state of the configuration space,
//! with the values that they read.

use crate::analysis::{ConfigurationSpace, Interval, Part, never_holds};
use crate::ir::SlotId;
use crate::sim::Fault;
use crate::watch::Watch;

use super::problem::{Problem, Start, Target};

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

/// How far players can come in a number of steps from the starts of a search.
struct Travel<'t> {
    problem: &'t Problem<'t>,
    space: &'t ConfigurationSpace,
    starts: Vec<Start>,
}

impl<'t> Travel<'t> {
    /// From the starts of a goal's search; `None` of a `never`, and if the watch stops their replay.
    fn of(
        problem: &'t Problem<'t>,
        space: &'t ConfigurationSpace,
        watch: &dyn Watch,
    ) -> Result<Option<Travel<'t>>, Fault> {
        match problem.target {
            Target::Goal(_) => Ok(problem.starts(watch)?.map(|starts| Travel { problem, space, starts })),
            Target::Never(_) => Ok(None),
        }
    }

    /// Where a player can be at most so many steps after a start, per axis; `None` if it can be anywhere.
    fn within(&self, player: SlotId, start: &Start, steps: u64) -> Option<[Interval; 2]> {
        let sim = self.problem.sim;
        let (x, y) = sim.position(&start.state, player);
        self.space.within_steps(sim.program(), sim.world_id(), player, [x, y], steps)
    }

    /// Whether the goal can hold within a number of steps, judging by one player.
    fn can(&self, player: SlotId, steps: u64) -> bool {
        let sim = self.problem.sim;
        self.starts.iter().any(|start| {
            self.within(player, start, steps).is_none_or(|part| {
                let part = (player, sim.space(&start.state, player), part);
                self.space.can_hold_in(sim.program(), sim.world_id(), self.problem.predicate(), part)
            })
        })
    }

    /// The least number of steps within which it can, judging by one player: more than `low`, and at most `high`.
    fn least(&self, player: SlotId, mut low: u64, mut high: u64) -> u64 {
        while low + 1 < high {
            let middle = low.midpoint(high);
            if self.can(player, middle) { high = middle } else { low = middle }
        }
        low + 1
    }
}

/// A lower bound of the number of steps from a start of a search to its goal, judging by how fast players are, if one is
/// known; of a goal to which a path of `most` steps is known.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn least_steps(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    most: u64,
    watch: &dyn Watch,
) -> Result<Option<u64>, Fault> {
    let Some(travel) = Travel::of(problem, space, watch)? else { return Ok(None) };
    let is_far = |player: &&SlotId| most > 0 && !travel.can(**player, 0) && travel.can(**player, most);
    Ok(problem.players().iter().filter(is_far).map(|player| travel.least(*player, 0, most)).max())
}

impl TooFar {
    /// A proof that no player can be where the goal holds within the time limit, if there is one.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub fn of(problem: &Problem<'_>, space: &ConfigurationSpace, watch: &dyn Watch) -> Result<Option<TooFar>, Fault> {
        let Some(time) = problem.time().map(u64::from) else { return Ok(None) };
        let Some(travel) = Travel::of(problem, space, watch)? else { return Ok(None) };
        let found = problem.players().iter().find(|player| !travel.can(**player, time)).map(|&player| {
            let (mut low, mut high) = (time, time.saturating_mul(2).max(1));
            while high < MAX_STEPS && !travel.can(player, high) {
                (low, high) = (high, high * 2);
            }
            let parts = travel.starts.iter().filter_map(|start| travel.within(player, start, time));
            let hull = parts.reduce(|a, b| [a[0].or(b[0]), a[1].or(b[1])]);
            let least = travel.least(player, low, high);
            TooFar { player, within: hull.unwrap_or([Interval::ALL; 2]), least }
        });
        Ok(found)
    }
}

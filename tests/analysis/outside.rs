//! What is false of a state: that it lies outside of what a world can be, as searches look at it, or that a goal holds which
//! never does. The tests of the analysis and the fuzz targets share it.

use hypedc::analysis::ConfigurationSpace;
use hypedc::ir::{GoalId, Program};
use hypedc::reach::Monitor;
use hypedc::sim::Simulator;

/// What of a state is outside, if anything is.
pub fn outside(sim: &Simulator, guard: &Monitor, state: &[u8]) -> Option<String> {
    guard.outside(sim, state).map(|what| what.to_string())
}

/// What of the goals of a world holds, although the space says that it never does.
pub fn ruled_out(program: &Program, sim: &Simulator, space: &ConfigurationSpace, state: &[u8]) -> Option<String> {
    let (world, id) = (sim.world(), sim.world_id());
    let holds = |goal: &GoalId| sim.goal(state, *goal) == Ok(true) && !space.can_hold(program, id, *goal);
    let goal = world.goals.ids().find(holds)?;
    Some(format!("goal {} holds, which is proven never to", world.goals[goal].name))
}

/// Whether a search would go on: no player is below or beside its space.
pub fn goes_on(sim: &Simulator, state: &[u8]) -> bool {
    sim.left_bounds(state).is_none()
}

//! Checks of a state against the analysis: that it is inside the configuration space, as searches check it, and that no
//! goal holds that is ruled out. The tests of the analysis and the fuzz targets share it.

use hypedc::analysis::ConfigurationSpace;
use hypedc::ir::{GoalId, Program};
use hypedc::reach::Monitor;
use hypedc::sim::Simulator;

/// The part of a state that is outside, if any.
pub fn outside(sim: &Simulator, guard: &Monitor, state: &[u8]) -> Option<String> {
    guard.outside(sim, state).map(|what| what.to_string())
}

/// A goal of a world that holds although the space rules it out.
pub fn ruled_out(program: &Program, sim: &Simulator, space: &ConfigurationSpace, state: &[u8]) -> Option<String> {
    let (world, id) = (sim.world(), sim.world_id());
    let holds = |goal: &GoalId| sim.goal(state, *goal) == Ok(true) && !space.can_hold(program, id, *goal);
    let goal = world.goals.ids().find(holds)?;
    Some(format!("goal {} holds, which is proven never to", world.goals[goal].name))
}

/// Whether a search would continue: no player is below or beside its space.
pub fn goes_on(sim: &Simulator, state: &[u8]) -> bool {
    sim.left_bounds(state).is_none()
}

//! Reuses plans: a path found for one question may also pass another goal, or break a `never`.

use crate::sim::Script;
use crate::watch::{Meter, Watch};

use super::outcome::Plan;
use super::problem::Problem;
use super::search_context::replays_to;
use super::start_hold::is_held;

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

//! What is found for one question may answer another one: a way to a goal passes by other goals, and by what breaks a `never`.

use crate::sim::Script;
use crate::watch::{Meter, Watch};

use super::outcome::Plan;
use super::problem::Problem;
use super::seam::is_held;
use super::search_context::replays_to;

/// A plan for a question from a script that was found for another one, if what is asked for holds on the way. The script
/// begins with `after` steps that were given with the question.
#[must_use]
pub fn passed(problem: &Problem<'_>, script: &Script, after: u64, watch: &dyn Watch) -> Option<Plan> {
    let steps = replays_to(problem, script, after, &mut problem.sim.scratch(), &Meter::new(watch))?;
    if problem.time().is_some_and(|most| steps - after > u64::from(most)) {
        return None;
    }
    let cut = script.first(steps);
    is_held(&cut, after, problem.least_hold()).then_some(Plan { steps, script: cut, after, is_shortest: false })
}

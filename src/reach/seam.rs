//! The seam between a script that is given and what a search adds to it: where inputs must be held for a number of steps, the
//! last one of the script must be, too.

use crate::sim::{Fault, Script};
use crate::watch::{Meter, Watch};

use super::problem::{Problem, Start, StateStatus};

/// What becomes of a start.
pub(super) enum Settled {
    /// From there inputs can change.
    Open(Start),
    /// The run is over.
    Over,
    /// What is asked for holds already, after this script, with the number of its steps that were given.
    Goal { script: Script, after: u64 },
    /// A run-time error at a step.
    Fault(Fault, u64),
    /// The watch stopped it.
    Stopped,
}

/// Holds the input that a start's script ends with for as long as it must be held.
///
/// # Errors
/// A [`Fault`] if a predicate breaks a rule at the start.
pub(super) fn settled(problem: &Problem<'_>, mut start: Start, watch: &dyn Watch) -> Result<Settled, Fault> {
    let least = u32::from(problem.least_hold());
    let held = start.script.steps.last().filter(|held| held.count < least).cloned();
    let mut left = held.as_ref().map_or(0, |held| least - held.count);
    let (mut scratch, meter) = (problem.sim.scratch(), Meter::new(watch));
    let mut standing = problem.judge(&start.state)?;
    let mut guard = problem.guard();
    loop {
        let is_over = standing.is_over(problem.target);
        if !is_over && guard.is_some_and(|guard| !guard.contains(problem.sim.world(), &start.state)) {
            let script = start.script.clone();
            guard.take().inspect(|guard| guard.refute(problem, script, &start.state, &meter));
        }
        match standing {
            StateStatus::Open => {}
            StateStatus::Dead(_) => return Ok(Settled::Over),
            StateStatus::Goal => return Ok(Settled::Goal { script: start.script, after: start.after }),
        }
        let Some(held) = held.as_ref().filter(|_| left > 0) else { return Ok(Settled::Open(start)) };
        if problem.time().is_some_and(|most| start.steps() >= most) {
            return Ok(Settled::Over);
        }
        left -= 1;
        start.script.push(&held.input, 1);
        let step = problem.sim.metered_step(&mut start.state, &held.input, &mut scratch, &meter);
        if meter.is_stopped() {
            return Ok(Settled::Stopped);
        }
        standing = match step.and_then(|()| problem.judge(&start.state)) {
            Ok(standing) => standing,
            Err(fault) => return Ok(Settled::Fault(fault, start.script.len())),
        };
    }
}

/// Whether each input of a script is held for at least `least_hold` steps, but for the last one, and for those that are over
/// before the first `after` steps are.
pub(super) fn is_held(script: &Script, after: u64, least: u16) -> bool {
    let mut end = 0;
    let mut steps = script.steps.iter().peekable();
    while let Some(step) = steps.next() {
        end += u64::from(step.count);
        let is_last = steps.peek().is_none();
        if !is_last && end >= after && step.count < u32::from(least) {
            return false;
        }
    }
    true
}

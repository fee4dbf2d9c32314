//! Completes the hold at the end of a given script: if inputs must be held for a number of steps, so must the last
//! input of the script.

use crate::sim::{Fault, Script};
use crate::watch::{Meter, Watch};

use super::problem::{Problem, Start, StateStatus};

/// The status of a start after its hold.
pub(super) enum StartStatus {
    /// Inputs can change from there.
    Open(Start),
    /// The run is over.
    Over,
    /// The target already holds, after this script, of which `after` steps were given.
    Goal { script: Script, after: u64 },
    /// A run-time error at a step.
    Fault(Fault, u64),
    /// The watch stopped it.
    Stopped,
}

/// Holds the last input of a start's script for the rest of its minimum time.
///
/// # Errors
/// A [`Fault`] if a predicate breaks a rule at the start.
pub(super) fn finish_hold(problem: &Problem<'_>, mut start: Start, watch: &dyn Watch) -> Result<StartStatus, Fault> {
    let least = u32::from(problem.min_hold());
    let held = start.script.steps.last().filter(|held| held.count < least).cloned();
    let mut left = held.as_ref().map_or(0, |held| least - held.count);
    let (mut scratch, meter) = (problem.sim.scratch(), Meter::new(watch));
    let mut status = problem.judge(&start.state)?;
    let mut monitor = problem.monitor();
    loop {
        let is_over = status.is_over(problem.target);
        if !is_over && monitor.is_some_and(|monitor| !monitor.contains(problem.sim.world(), &start.state)) {
            let script = start.script.clone();
            monitor.take().inspect(|monitor| monitor.refute(problem, script, &start.state, &meter));
        }
        match status {
            StateStatus::Open => {}
            StateStatus::Dead(_) => return Ok(StartStatus::Over),
            StateStatus::Goal => return Ok(StartStatus::Goal { script: start.script, after: start.after }),
        }
        let Some(held) = held.as_ref().filter(|_| left > 0) else { return Ok(StartStatus::Open(start)) };
        if problem.time().is_some_and(|most| start.steps() >= most) {
            return Ok(StartStatus::Over);
        }
        left -= 1;
        start.script.push(&held.input, 1);
        let step = problem.sim.metered_step(&mut start.state, &held.input, &mut scratch, &meter);
        if meter.is_stopped() {
            return Ok(StartStatus::Stopped);
        }
        status = match step.and_then(|()| problem.judge(&start.state)) {
            Ok(status) => status,
            Err(fault) => return Ok(StartStatus::Fault(fault, start.script.len())),
        };
    }
}

/// Whether each input of a script is held for at least `least` steps, except the last one and those that end before
/// step `after`.
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

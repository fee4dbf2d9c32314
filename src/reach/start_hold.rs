//! Completes the hold at the end of a given script: if inputs must be held for a number of steps, so must the last
//! input of the script.

use crate::sim::{Fault, Input, Script};
use crate::watch::{Meter, Watch};

use super::problem::{Problem, Start, StateStatus};

/// The status of a start after its hold.
pub(super) enum StartStatus {
    /// Inputs can change from there.
    Open(Start),
    /// The run is over: with what nature draws, or whatever it draws.
    Over { is_by_luck: bool },
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
    let held = runs(&start.script).last().filter(|(_, count)| *count < u64::from(least));
    // What is left is less than the minimum.
    let mut left = held.as_ref().map_or(0, |(_, count)| least - *count as u32);
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
            StateStatus::Dead(_) => return Ok(StartStatus::Over { is_by_luck: start.is_by_luck }),
            StateStatus::Goal => return Ok(StartStatus::Goal { script: start.script, after: start.after }),
        }
        let Some((input, _)) = held.as_ref().filter(|_| left > 0) else { return Ok(StartStatus::Open(start)) };
        if problem.time().is_some_and(|most| start.steps() >= most) {
            return Ok(StartStatus::Over { is_by_luck: start.is_by_luck });
        }
        left -= 1;
        // The players hold their input; nature draws anew.
        start.script.push(input, 1);
        let drawn = problem.draw(start.script.len(), input);
        let step = problem.sim.metered_step(&mut start.state, &drawn, &mut scratch, &meter);
        start.is_by_luck |= !problem.sim.drawn(&drawn, &scratch).1.is_empty();
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
    let mut runs = runs(script).peekable();
    while let Some((_, count)) = runs.next() {
        end += count;
        let is_last = runs.peek().is_none();
        if !is_last && end >= after && count < u64::from(least) {
            return false;
        }
    }
    true
}

/// The inputs of the players in a script, each with the number of its steps, whatever nature draws.
fn runs(script: &Script) -> impl Iterator<Item = (Input, u64)> {
    script.steps.chunk_by(|a, b| a.input.0 == b.input.0).filter_map(|same| {
        let input = Input::of_players(same.first()?.input.0.clone());
        Some((input, same.iter().map(|step| u64::from(step.count)).sum()))
    })
}

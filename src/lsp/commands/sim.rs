//! `sim`: runs inputs and tells the last state.

use std::ops::ControlFlow;

use super::{Monitor, SimArguments, named};
use crate::ask::{Observed, SimResult, drive};
use crate::lsp::buffers::Buffers;
use crate::sim::Simulator;

/// Maximum number of steps of a run.
const MAX_STEPS: u64 = 10_000_000;

pub(super) fn run(arguments: &SimArguments, buffers: &Buffers, monitor: &dyn Monitor) -> Result<SimResult, String> {
    let SimArguments { program, inputs, steps, chance } = arguments;
    let (loaded, world, script) = program.load_run(inputs, buffers)?;
    let steps = steps.unwrap_or(script.len()).min(MAX_STEPS);
    monitor.part(0, 1, &loaded.program.worlds[world].name);
    let sim = Simulator::new(&loaded.program, world);
    let mut observed = Observed::new(&sim);
    let ended = drive(&sim, (&script, *chance), steps, monitor, &mut |step, _, state, scratch| {
        observed.observe(step, state);
        observed.record_events(step, scratch, state);
        Ok(ControlFlow::Continue(()))
    });
    let ended = ended.map_err(|error| error.to_string())?;
    let inputs = script.text(&loaded.program, world);
    Ok(observed.result(named(&program.path).display().to_string(), inputs, &ended))
}

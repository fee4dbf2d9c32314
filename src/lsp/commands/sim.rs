//! `sim`: runs inputs and tells the last state.

use std::ops::ControlFlow;

use super::{Drawn, Monitor, SimArguments, named};
use crate::ask::{Drawing, Observed, RunOutcome, SimResult, drive, run_svg};
use crate::lsp::buffers::Buffers;
use crate::sim::Simulator;
use crate::view::{Images, Recorder};

/// Maximum number of steps of a run.
const MAX_STEPS: u64 = 10_000_000;

pub(super) fn run(
    arguments: &SimArguments,
    buffers: &Buffers,
    monitor: &dyn Monitor,
) -> Result<Drawn<SimResult>, String> {
    let SimArguments { program, inputs, steps, chance, picture } = arguments;
    let (loaded, world, script) = program.load_run(inputs, buffers)?;
    let steps = steps.unwrap_or(script.len()).min(MAX_STEPS);
    monitor.part(0, 1, &loaded.program.worlds[world].name);
    let sim = Simulator::new(&loaded.program, world);
    let mut observed = Observed::new(&sim);
    let mut recorder = picture.then(|| Recorder::new(&sim));
    let ended = drive(&sim, (&script, *chance), steps, monitor, &mut |step, input, state, scratch| {
        if let Some(recorder) = &mut recorder {
            recorder.observe(step, input, state);
        }
        observed.observe(step, state);
        observed.record_events(step, scratch, state);
        Ok(ControlFlow::Continue(()))
    });
    let ended = ended.map_err(|error| error.to_string())?;
    let inputs = script.text(&loaded.program, world);
    let pictures = recorder.map(|recorder| {
        let outcome = RunOutcome::new(&observed, &inputs, &ended, true);
        let run = recorder.finish(&observed.last, outcome.marks.clone());
        let svg = run_svg((&loaded.program, world), &run, &outcome, &Images::default());
        Drawing { name: loaded.program.worlds[world].name.clone(), svg }
    });
    let pictures = pictures.into_iter().collect();
    let result = observed.result(named(&program.path).display().to_string(), inputs, &ended);
    Ok(Drawn { result, pictures })
}

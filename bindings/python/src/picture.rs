//! Pictures of runs, as SVG.

use std::ops::ControlFlow;
use std::sync::Arc;

use hypedc::ask::{Loaded, Observed, RunOutcome, drive, run_svg};
use hypedc::ir::WorldId;
use hypedc::sim::Simulator;
use hypedc::view::{Images, Recorder};
use pyo3::prelude::*;

use crate::inputs::script;
use crate::watched::watched;

/// The picture of a run.
pub(crate) fn of_run(
    py: Python<'_>,
    loaded: &Arc<Loaded>,
    world: WorldId,
    inputs: &str,
    chance: Option<u64>,
) -> PyResult<String> {
    let script = script(loaded, world, inputs)?;
    let loaded = Arc::clone(loaded);
    watched(py, None, move |flag| {
        let sim = Simulator::new(&loaded.program, world);
        let (mut observed, mut recorder) = (Observed::new(&sim), Recorder::new(&sim));
        let ended = drive(&sim, (&script, chance), script.len(), flag, &mut |step, input, state, _| {
            observed.observe(step, state);
            recorder.observe(step, input, state);
            Ok(ControlFlow::Continue(()))
        });
        let text = script.text(&loaded.program, world);
        // Nothing is written that could fail.
        let Ok(ended) = ended else { return String::new() };
        let outcome = RunOutcome::new(&observed, &text, &ended, true);
        let run = recorder.finish(&observed.last, outcome.marks.clone());
        run_svg((&loaded.program, world), &run, &outcome, &Images::default())
    })
}

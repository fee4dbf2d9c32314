//! Runs of input scripts as arrays: what players do, and parts of the state by name.

use std::ops::ControlFlow;
use std::sync::Arc;

use hypedc::ask::{RunEnd, drive};
use hypedc::sim::{Control, Named, Simulator};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::error::{argument, question};
use crate::inputs::script;
use crate::program::Program;
use crate::watched::watched;

/// Maximum number of numbers of a trace.
const MAX_NUMBERS: u64 = 1 << 28;

/// What a trace is: the values of each step, rows from step 0 on, a column for each name; the inputs of each step, of the
/// shape (steps, players, buttons + axes); for each name the words that its numbers stand for; why the run ended early.
type Trace<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>, Vec<Option<Vec<String>>>, Option<String>);

/// Runs a script.
#[pyfunction]
#[pyo3(name = "_trace", signature = (program, world, inputs, names, chance = None, steps = None))]
pub fn trace<'py>(
    py: Python<'py>,
    program: &Bound<'py, Program>,
    world: Option<&str>,
    inputs: &str,
    names: Vec<String>,
    chance: Option<u64>,
    steps: Option<u64>,
) -> PyResult<Trace<'py>> {
    let of = program.get();
    let id = of.world_id(world)?;
    let sim = Simulator::new(&of.loaded.program, id);
    let parts: Vec<Named> = names.iter().map(|name| sim.named(name).map_err(question)).collect::<PyResult<_>>()?;
    let words = parts.iter().map(|part| sim.words(*part)).collect();
    let script = script(&of.loaded, id, inputs)?;
    let steps = steps.unwrap_or(script.len());
    let controls: Vec<Vec<Control>> = sim.world().players.ids().map(|id| sim.controls(id).collect()).collect();
    let most = controls.iter().map(Vec::len).max().unwrap_or(0);
    let width = (parts.len() + controls.len() * most) as u64;
    if steps.saturating_add(1).saturating_mul(width.max(1)) > MAX_NUMBERS {
        return Err(argument(format!("{steps} steps with {width} numbers each are too many: name fewer parts")));
    }
    let loaded = Arc::clone(&of.loaded);
    let (values, done, end) = watched(py, None, move |flag| {
        let (mut values, mut done) = (Vec::new(), Vec::new());
        let ended = drive(&sim, (&script, chance), steps, flag, &mut |step, input, state, _| {
            values.extend(parts.iter().map(|part| sim.named_number(state, *part)));
            if step > 0 {
                for of in &controls {
                    let number = |at: usize| of.get(at).map_or(0.0, |control| input.get(*control));
                    done.extend((0..most).map(number));
                }
            }
            Ok(ControlFlow::Continue(()))
        });
        let end = match ended {
            Ok(RunEnd::Done | RunEnd::Enough) | Err(_) => None,
            Ok(RunEnd::LeftBounds) => Some("a player has left the bounds".to_string()),
            Ok(RunEnd::Stopped(step)) => Some(format!("stopped after step {step}")),
            Ok(RunEnd::Fault(fault, step)) => {
                let error = crate::error::step(&loaded.sources, fault.fact(&loaded.program, id, step));
                Some(Python::attach(|py| error.value(py).to_string()))
            }
        };
        (values, done, end)
    })?;
    let sim = Simulator::new(&of.loaded.program, id);
    let players = sim.world().players.len();
    let rows = values.len().checked_div(names.len()).unwrap_or(0);
    let taken = done.len().checked_div(players * most).unwrap_or(0);
    let values = PyArray1::from_vec(py, values).reshape([rows, names.len()])?;
    let done = PyArray1::from_vec(py, done).reshape([taken, players, most])?;
    Ok((values, done, words, end))
}

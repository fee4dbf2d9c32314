//! Questions about runs and worlds, answered by the records of the command line as JSON.

use hypedc::ask::{WhyQuestion, answer_why};
use pyo3::prelude::*;

use crate::error::refusal;
use crate::inputs::script;
use crate::program::Program;
use crate::watched::watched;

/// Why an instance did what it did in a step of a run, or why it never did something.
#[pyfunction]
#[pyo3(
    name = "_why",
    signature = (program, inputs, world = None, instance = None, mode = None, edge = None, never = false, at = None, chance = 0)
)]
#[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub fn why(
    py: Python<'_>,
    program: &Bound<'_, Program>,
    inputs: &str,
    world: Option<&str>,
    instance: Option<String>,
    mode: Option<String>,
    edge: Option<String>,
    never: bool,
    at: Option<u64>,
    chance: u64,
) -> PyResult<String> {
    let of = program.get();
    let id = of.world_id(world)?;
    let script = script(&of.loaded, id, inputs)?;
    let question = WhyQuestion { instance, mode, edge, not: never, at };
    let (loaded, root) = (of.loaded.clone(), of.recipe.root.clone());
    let answer = watched(py, None, move |_| {
        let answer = answer_why(&loaded, id, &root, (&script, chance), &question);
        answer.map(|(result, ..)| serde_json::to_string(&result).unwrap_or_default())
    })?;
    answer.map_err(|why| refusal(&of.loaded.sources, why))
}

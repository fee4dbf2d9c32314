//! `why`: explains a step of a run.

use super::{WhyArguments, named};
use crate::ask::{WhyQuestion, WhyResult, answer_why};
use crate::lsp::buffers::Buffers;

/// Maximum number of steps of a run: it is not interrupted.
const MAX_STEPS: u64 = 1_000_000;

pub(super) fn run(arguments: &WhyArguments, buffers: &Buffers) -> Result<WhyResult, String> {
    let WhyArguments { program, inputs, at, instance, mode, edge, not, chance } = arguments;
    let (loaded, world, script) = program.load_run(inputs, buffers)?;
    if at.unwrap_or_default().max(script.len()) > MAX_STEPS {
        return Err(format!("the run has more than {MAX_STEPS} steps"));
    }
    let (instance, mode, edge) = (instance.clone(), mode.clone(), edge.clone());
    let question = WhyQuestion { instance, mode, edge, not: *not, at: *at };
    let run = (&script, chance.unwrap_or_default());
    let answered = answer_why(&loaded, world, &named(&program.path), run, &question);
    answered.map(|(result, ..)| result).map_err(|why| why.sentence(&loaded.sources))
}

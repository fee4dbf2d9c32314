//! Where inputs that once led to a target lead now: how their run ends, and the state on it that comes nearest.

use crate::sim::{Fault, Script, State};
use crate::source::SourceMap;
use crate::watch::Meter;

use super::super::problem::{Problem, StateStatus, Termination};
use super::explain::{Replayed, point};
use super::lack::Parts;
use super::record::NearState;
use super::words::Describer;

/// Where inputs lead that miss their target.
#[derive(Debug, Clone, PartialEq)]
pub struct Astray {
    /// How the run ends.
    pub end: AstrayEnd,
    /// The step at which it ends.
    pub step: u64,
    /// The state of the run that comes nearest to the target; `None` if there is none to compare.
    pub nearest: Option<NearState>,
}

/// How a run ends that misses its target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AstrayEnd {
    /// There are no more inputs.
    NoInputs,
    /// The run is over.
    Over(Termination),
    /// A run-time error.
    Fault(Fault),
}

/// Follows inputs on their way past the target; `None` if they lead there, or if the meter stops it.
#[must_use]
pub fn astray(problem: &Problem<'_>, sources: &SourceMap, script: &Script, meter: &Meter<'_>) -> Option<Astray> {
    let (sim, parts) = (problem.sim, Parts::new(problem));
    let cost = |state: &[u8]| -> f64 { parts.terms.iter().map(|term| term.cost(sim, state, f64::INFINITY)).sum() };
    let mut scratch = sim.scratch();
    let mut best: Option<(f64, u64, State)> = None;
    let mut state = match sim.metered_initial(&mut scratch, meter) {
        Ok(state) => state,
        Err(fault) => return Some(Astray { end: AstrayEnd::Fault(fault), step: 0, nearest: None }),
    };
    let (mut step, mut inputs) = (0, script.inputs());
    let end = loop {
        if meter.is_stopped() {
            return None;
        }
        match problem.judge(&state) {
            Ok(StateStatus::Goal) => return None,
            Ok(StateStatus::Open) => {}
            Ok(StateStatus::Dead(reason)) => break AstrayEnd::Over(reason),
            Err(fault) => break AstrayEnd::Fault(fault),
        }
        let lack = cost(&state);
        if lack.is_finite() && best.as_ref().is_none_or(|(least, ..)| lack < *least) {
            best = Some((lack, step, state.clone()));
        }
        let Some(input) = inputs.next() else { break AstrayEnd::NoInputs };
        step += 1;
        if let Err(fault) = sim.metered_step(&mut state, &problem.draw(step, input), &mut scratch, meter) {
            break AstrayEnd::Fault(fault);
        }
    };
    let describer = Describer { sim, sources };
    let nearest = best.map(|(_, step, state)| {
        let at = Replayed { script: script.first(step), state };
        let described = parts.ids.iter().zip(&parts.terms);
        let described = described.map(|(id, term)| describer.part(*id, term, &at.state));
        NearState { parts: described.collect(), at: point(problem, &at) }
    });
    Some(Astray { end, step, nearest })
}

impl Astray {
    /// How the run ends, in one phrase.
    pub fn words(&self, problem: &Problem<'_>) -> String {
        let (program, world) = (problem.sim.program(), problem.sim.world_id());
        let at = |step: u64| format!("step {step} ({:.2} s)", step as f64 * problem.sim.world().step.seconds());
        let end = at(self.step);
        match self.end {
            AstrayEnd::Over(Termination::Never(id)) => {
                format!("`never {}` ends the run at {end}", problem.sim.world().nevers[id].name)
            }
            AstrayEnd::Over(Termination::Outside) => format!("a player leaves the bounds at {end}"),
            AstrayEnd::Over(Termination::Avoided) => format!("what must not hold does at {end}"),
            AstrayEnd::Fault(fault) => {
                let fact = fault.fact(program, world, self.step);
                format!("a run-time error at {end}: {} in `{}`", fact.what, fact.instance)
            }
            AstrayEnd::NoInputs => {
                let nearest = self.nearest.as_ref().and_then(|near| {
                    let missing = near.parts.iter().find(|part| !part.holds)?;
                    Some(format!("they come nearest at {}: {}", at(near.at.step), missing.phrase()))
                });
                nearest.unwrap_or(format!("they end at {end}"))
            }
        }
    }
}

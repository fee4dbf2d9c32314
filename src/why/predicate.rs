//! A predicate of a world in a state, part by part; and the state of a run in which it came nearest to holding.

use crate::ir::{Expr, ExprId};
use crate::sim::Simulator;
use crate::source::SourceMap;

use super::lack::Lack;
use super::record::Atom;
use super::step::{atom_text, atoms_of, sides};

/// The parts of a predicate of a world in a state, with what each compares.
pub fn predicate_atoms(sim: &Simulator, sources: &SourceMap, state: &[u8], predicate: ExprId) -> Vec<Atom> {
    let program = sim.program();
    let atom = |id: ExprId| {
        let held = sim.number(state, id).ok().map(|value| value != 0.0);
        // That an instance is there is a part that nobody wrote.
        if matches!(program.exprs[id], Expr::Alive(_)) && held == Some(true) {
            return None;
        }
        Some(Atom { text: atom_text(program, sources, id), held, sides: sides_in(sim, state, id) })
    };
    atoms_of(program, predicate).into_iter().filter_map(atom).collect()
}

/// How far a state is from a predicate: the fewest parts that would have to change, and the sum of the distances of the
/// comparisons among them. Of an `or`, the side that lacks less counts. It is a measure, no proof.
pub fn predicate_distance(sim: &Simulator, state: &[u8], predicate: ExprId) -> (usize, f64) {
    let truth = |id: ExprId| sim.number(state, id).ok().map(|value| value != 0.0);
    let apart = |id: ExprId| sides_in(sim, state, id).map(|[a, b]| (a - b).abs());
    let lack = Lack::of(sim.program(), predicate, &truth, &apart);
    (lack.parts.len(), lack.distance)
}

/// The values of both sides of a comparison.
fn sides_in(sim: &Simulator, state: &[u8], id: ExprId) -> Option<[f64; 2]> {
    sides(sim.program(), id, |id| sim.number(state, id).ok())
}

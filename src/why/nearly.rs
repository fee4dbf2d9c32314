//! How near the guards of edges came in a run: at which step the fewest parts of a guard were missing, and by how much. A
//! number of parts is compared first, then the sum of the distances of comparisons, then the step: the earliest counts.

use serde::Serialize;

use crate::ir::{EdgeId, ExprId, Id, ModeId, Program, SlotId};
use crate::sim::{Inspection, Script, Simulator};
use crate::source::SourceMap;

use super::lack::Lack;
use super::record::{Atom, Place};
use super::run::{Inputs, RunError, play};
use super::step::{Guards, Moved, place};

/// How near some edges came to being taken in a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Nearly {
    /// The instance.
    pub instance: String,
    /// The mode; null if the question is about an edge.
    pub mode: Option<String>,
    /// Number of steps of the run: fewer than asked for if it ended.
    pub steps: u64,
    /// The first step after which the mode was active, 0 at the start; or in which the edge was taken. Null if never.
    pub entered: Option<u64>,
    /// The edges.
    pub edges: Vec<NearlyEdge>,
}

/// How near an edge came.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct NearlyEdge {
    /// Its index in the entity.
    pub edge: usize,
    /// The mode whose edge it is.
    pub from: String,
    /// The target; null if it stays.
    pub to: Option<String>,
    /// Its line in the text.
    pub place: Option<Place>,
    /// Number of steps in which it could be taken: its mode was active.
    pub considered: u64,
    /// The step in which its guard came nearest to holding; null if it was never considered.
    pub step: Option<u64>,
    /// The parts of the guard that were missing then; empty if it held.
    pub missing: Vec<Missing>,
    /// If the guard held in that step: the edge that was taken instead.
    pub instead: Option<String>,
}

/// A part of a guard that was missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Missing {
    /// The part.
    #[serde(flatten)]
    pub atom: Atom,
    /// Of a comparison, how far its sides were apart.
    pub distance: Option<f64>,
}

/// How far the sides of a comparison are apart.
fn distance(guards: &Guards<'_>, id: ExprId) -> Option<f64> {
    guards.atom(id).sides.map(|[a, b]| (a - b).abs())
}

/// How an edge is written in answers.
fn edge_text(program: &Program, entity: crate::ir::EntityId, edge: EdgeId) -> String {
    let of = &program.entities[entity];
    let (source, target) = (of.edges[edge].source, of.edges[edge].target);
    let path = |mode: ModeId| of.modes[mode].path.clone();
    format!("{} -> {}", path(source), target.map_or("(stays)".to_string(), path))
}

/// How near some edges of an instance came to being taken in the first steps of a run, and whether a mode was entered.
///
/// # Errors
/// [`RunError`] if a step breaks a rule of the language; a run that ends earlier is no error.
pub fn nearly(
    sim: &Simulator,
    sources: &SourceMap,
    (script, seed): (&Script, u64),
    steps: u64,
    slot: SlotId,
    (mode, asked): (Option<ModeId>, &[EdgeId]),
) -> Result<Nearly, RunError> {
    let program = sim.program();
    let id = sim.world().slots[slot].entity;
    let entity = &program.entities[id];
    let spans = &program.spans.entities[id].edges;
    let mut best: Vec<Option<Lack>> = vec![None; asked.len()];
    let mut edges: Vec<NearlyEdge> = asked
        .iter()
        .map(|&edge| NearlyEdge {
            edge: edge.index(),
            from: entity.modes[entity.edges[edge].source].path.clone(),
            to: entity.edges[edge].target.map(|mode| entity.modes[mode].path.clone()),
            place: sources.holds(spans[edge]).then(|| place(sources, spans[edge])),
            considered: 0,
            step: None,
            missing: Vec::new(),
            instead: None,
        })
        .collect();
    let (mut played, mut entered) = (0, None);
    let is_in = |state: &[u8]| mode.is_some_and(|mode| sim.instance(state, slot).is_in(mode));
    let mut at_start = false;
    let run = play(sim, Inputs { script, seed }, steps, &mut |at, led, after| {
        let Some((state, input, taken)) = led else {
            at_start = is_in(after);
            return;
        };
        played = at;
        let took = |edge: EdgeId| taken.contains(&(slot, edge));
        if entered.is_none() && (is_in(after) || mode.is_none() && asked.iter().any(|edge| took(*edge))) {
            entered = Some(at);
        }
        let before = sim.instance(state, slot);
        if !before.is_alive() {
            return;
        }
        let inspection = Inspection::new(sim, state, input);
        let moved = Some(Moved { sim, before: state, after, taken });
        let guards = Guards { program, sources, step: &inspection, slot, moved };
        for ((edge, found), best) in asked.iter().zip(&mut edges).zip(&mut best) {
            let of = &entity.edges[*edge];
            let leaf = &entity.leaves[before.leaf(entity.modes[of.source].group)];
            if !leaf.edges.contains(edge) && !leaf.internal.contains(edge) {
                continue;
            }
            found.considered += 1;
            let lacks = Lack::of(program, of.guard, &|id| guards.truth(id), &|id| distance(&guards, id));
            if best.as_ref().is_some_and(|best| !lacks.is_less(best)) {
                continue;
            }
            found.step = Some(at);
            let missing = |part: &ExprId| Missing { atom: guards.atom(*part), distance: distance(&guards, *part) };
            found.missing = lacks.parts.iter().map(missing).collect();
            let instead = leaf.edges.iter().find(|other| took(**other) && *other != edge);
            found.instead = instead.filter(|_| lacks.parts.is_empty()).map(|other| edge_text(program, id, *other));
            *best = Some(lacks);
        }
    });
    match run {
        // What comes after the end of a run is not asked.
        Ok(()) | Err(RunError::Over(..)) => {}
        Err(error) => return Err(error),
    }
    Ok(Nearly {
        instance: sim.world().slots[slot].name.clone(),
        mode: mode.map(|mode| entity.modes[mode].path.clone()),
        steps: played,
        entered: if at_start { Some(0) } else { entered },
        edges,
    })
}

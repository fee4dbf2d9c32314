//! Rooms and modes that a search never entered, at the border of what it entered: which link or edge leads there, and what
//! its condition lacked on the way to the nearest state.

use crate::ir::{EdgeId, Id, ModeId, SlotId, SpaceId};
use crate::sim::Script;
use crate::source::{SourceMap, Span};
use crate::why::nearly;

use super::super::problem::Problem;
use super::gauge::Seen;
use super::lack::Parts;
use super::record::{ClosedMode, ClosedRoom};
use super::words::{Describer, distance_words};

/// Maximum number of rooms, and of modes.
const MAX_CLOSED: usize = 16;

/// `FILE:LINE` of a span.
fn place(sources: &SourceMap, span: Span) -> Option<String> {
    sources.holds(span).then(|| {
        let file = sources.file(span.file());
        format!("{}:{}", file.path.display(), file.line_column_utf16(span.start() as usize).0)
    })
}

/// The rooms that the first player never entered, those behind a link first; `near` is the nearest state.
pub(super) fn closed_rooms(
    problem: &Problem<'_>,
    describer: &Describer<'_>,
    seen: &Seen,
    near: Option<&[u8]>,
) -> Vec<ClosedRoom> {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let is_entered = |id: SpaceId| seen.spaces.get(id.index()).copied().unwrap_or(false);
    let closed = world.spaces.pairs().filter(|(id, _)| !is_entered(*id)).map(|(id, space)| {
        let links = world.spaces.pairs().filter(|(from, _)| is_entered(*from));
        let links = links.flat_map(|(from, space)| space.links.iter().enumerate().map(move |link| (from, link)));
        let link = links.filter(|(_, (_, link))| link.space == id).min_by_key(|(_, (_, link))| link.guard.is_some());
        let Some((from, (index, link))) = link else {
            return ClosedRoom { room: space.name.clone(), from: None, place: None, guard: None };
        };
        let span = program.spans.worlds[problem.sim.world_id()].links.get(from).and_then(|links| links.get(index));
        let guard = link.guard.zip(near).map(|(guard, state)| {
            let parts = Parts::of(problem, guard);
            let mut described = parts.ids.iter().zip(&parts.terms).map(|(id, term)| describer.part(*id, term, state));
            let first = described.find(|part| !part.holds);
            let text = describer.text(guard);
            match first {
                Some(part) if part.text == text => part,
                Some(part) => super::record::PartState { words: format!("`{}` {}", part.text, part.words), text, ..part },
                None => super::record::PartState {
                    text,
                    holds: true,
                    distance: Some(0.0),
                    unit: String::new(),
                    words: "holds".to_string(),
                },
            }
        });
        ClosedRoom {
            room: space.name.clone(),
            from: Some(world.spaces[from].name.clone()),
            place: span.and_then(|span| place(describer.sources, *span)),
            guard,
        }
    });
    let mut closed: Vec<ClosedRoom> = closed.collect();
    closed.sort_by_key(|room| room.from.is_none());
    closed.truncate(MAX_CLOSED);
    closed
}

/// The modes of the first player that it never entered, of those to which an edge of an entered one leads. How near the
/// edges came is asked of the way to the nearest state.
pub(super) fn closed_modes(
    problem: &Problem<'_>,
    sources: &SourceMap,
    seen: &Seen,
    script: &Script,
) -> Vec<ClosedMode> {
    let Some(&player) = problem.players().first() else { return Vec::new() };
    let entity = &problem.sim.program().entities[problem.sim.world().slots[player].entity];
    let is_entered = |mode: ModeId| {
        let mut leaves = entity.modes[mode].leaves.ids();
        leaves.any(|leaf| seen.leaves.get(leaf.index()).copied().unwrap_or(false))
    };
    let is_closed = |mode: &ModeId| {
        // Of a mode and those around it that are closed, the outermost counts.
        !is_entered(*mode) && entity.modes[*mode].parent.is_none_or(is_entered)
    };
    let mut closed = Vec::new();
    for mode in entity.modes.ids().filter(is_closed) {
        let leads = |edge: &EdgeId| {
            let of = &entity.edges[*edge];
            of.target.is_some_and(|target| entity.is_inside(target, mode)) && is_entered(of.source)
        };
        let edges: Vec<EdgeId> = entity.edges.ids().filter(leads).collect();
        if edges.is_empty() {
            continue;
        }
        closed.extend(closed_mode(problem, sources, script, (player, mode, &edges)));
        if closed.len() >= MAX_CLOSED {
            break;
        }
    }
    closed
}

fn closed_mode(
    problem: &Problem<'_>,
    sources: &SourceMap,
    script: &Script,
    (player, mode, edges): (SlotId, ModeId, &[EdgeId]),
) -> Option<ClosedMode> {
    let asked = (Some(mode), edges);
    let found = nearly(problem.sim, sources, (script, problem.seed()), script.len(), player, asked).ok()?;
    let lacks = |edge: &crate::why::NearlyEdge| {
        let distance: f64 = edge.missing.iter().filter_map(|missing| missing.distance).sum();
        (edge.step.is_none(), edge.missing.len(), distance)
    };
    let nearest = found.edges.iter().min_by(|a, b| lacks(a).partial_cmp(&lacks(b)).unwrap_or(std::cmp::Ordering::Equal))?;
    let missing = nearest.missing.iter().map(|missing| match missing.distance {
        Some(distance) if distance > 0.0 => {
            format!("`{}` misses by {}", missing.atom.text, distance_words(distance, ""))
        }
        _ => format!("`{}` does not hold", missing.atom.text),
    });
    Some(ClosedMode {
        mode: found.mode.clone()?,
        from: nearest.from.clone(),
        place: nearest.place.as_ref().map(|place| format!("{}:{}", place.path, place.line)),
        step: nearest.step,
        missing: missing.collect(),
    })
}

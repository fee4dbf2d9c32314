//! Rooms and modes that a search never entered, at the border of what it entered: which link or edge leads there, and what
//! its condition lacked on the way to the nearest state.

use std::cmp::Ordering;

use crate::ir::{EdgeId, Id, ModeId, SlotId, SpaceId};
use crate::ordered::Ordered;
use crate::sim::Script;
use crate::source::SourceMap;
use crate::why::{NearlyEdge, Place, nearly, place};

use super::super::problem::Problem;
use super::gauge::Seen;
use super::lack::{Gauge, Parts};
use super::record::{ClosedMode, ClosedRoom, PartState};
use super::unit::Unit;
use super::words::{Describer, distance_words, holds};

/// Maximum number of rooms, and of modes.
const MAX_CLOSED: usize = 16;

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
                Some(part) => PartState { words: format!("`{}` {}", part.text, part.words), text, ..part },
                None => holds(text, Unit::NONE),
            }
        });
        ClosedRoom {
            room: space.name.clone(),
            from: Some(world.spaces[from].name.clone()),
            place: span
                .filter(|span| describer.sources.holds(**span))
                .map(|span| place(describer.sources, *span).to_string()),
            guard,
        }
    });
    let mut closed: Vec<ClosedRoom> = closed.collect();
    closed.order_by_key(|room| room.from.is_none());
    closed.truncate(MAX_CLOSED);
    closed
}

/// Modes that were never entered: on the way to the nearest state those that the goal asks for or that lead there, and of
/// the first player those of the whole search to which an edge of an entered mode leads. How near the edges came is asked
/// of the way to the nearest state.
pub(super) fn closed_modes(
    problem: &Problem<'_>,
    sources: &SourceMap,
    (parts, seen, bar): (&Parts, &Seen, Option<SlotId>),
    (script, state): (&Script, &[u8]),
) -> Vec<ClosedMode> {
    let mut closed: Vec<ClosedMode> = Vec::new();
    let mut atoms = Vec::new();
    parts.terms.iter().for_each(|term| term.atoms(&mut atoms));
    let asker = Asker { problem, sources, script };
    for atom in atoms {
        let Gauge::Mode(_, approach) = &atom.gauge else { continue };
        let slot = approach.slot;
        if !problem.sim.instance(state, slot).is_alive() || problem.sim.holds(state, atom.id) == Ok(true) {
            continue;
        }
        let entity = &problem.sim.program().entities[problem.sim.world().slots[slot].entity];
        // The next modes on a shortest way.
        let edges: Vec<EdgeId> = approach.next(problem.sim, state);
        let mut targets: Vec<ModeId> = edges.iter().filter_map(|edge| entity.edges[*edge].target).collect();
        targets.dedup();
        for mode in targets {
            let to: Vec<EdgeId> =
                edges.iter().copied().filter(|edge| entity.edges[*edge].target == Some(mode)).collect();
            let found = asker.closed_mode((slot, mode, &to), true).filter(|found| !found.missing.is_empty());
            closed.extend(found.filter(|found| !closed.contains(found)));
        }
    }
    // What is in the way may leave it in another mode.
    if let Some(slot) = bar {
        let instance = problem.sim.instance(state, slot);
        let entity = instance.entity();
        let leaves = entity.groups.ids().map(|group| &entity.leaves[instance.leaf(group)]);
        let edges: Vec<EdgeId> = leaves.flat_map(|leaf| leaf.edges.iter().copied()).collect();
        let mut targets: Vec<ModeId> = edges.iter().filter_map(|edge| entity.edges[*edge].target).collect();
        targets.sort_unstable();
        targets.dedup();
        for mode in targets {
            let leads = |edge: &EdgeId| entity.edges[*edge].target == Some(mode);
            let to: Vec<EdgeId> = edges.iter().copied().filter(leads).collect();
            let found = asker.closed_mode((slot, mode, &to), true).filter(|found| !found.missing.is_empty());
            closed.extend(found.filter(|found| !closed.contains(found)));
        }
    }
    let Some(&player) = problem.players().first() else { return closed };
    let entity = &problem.sim.program().entities[problem.sim.world().slots[player].entity];
    let is_entered = |mode: ModeId| {
        let mut leaves = entity.modes[mode].leaves.ids();
        leaves.any(|leaf| seen.leaves.get(leaf.index()).copied().unwrap_or(false))
    };
    // Of a mode and those around it that are closed, the outermost counts.
    let is_closed = |mode: &ModeId| !is_entered(*mode) && entity.modes[*mode].parent.is_none_or(is_entered);
    for mode in entity.modes.ids().filter(is_closed) {
        let leads = |edge: &EdgeId| {
            let of = &entity.edges[*edge];
            of.target.is_some_and(|target| entity.is_inside(target, mode)) && is_entered(of.source)
        };
        let edges: Vec<EdgeId> = entity.edges.ids().filter(leads).collect();
        let name = &problem.sim.world().slots[player].name;
        let is_known = |known: &ClosedMode| known.instance == *name && known.mode == entity.modes[mode].path;
        if !edges.is_empty() && !closed.iter().any(is_known) {
            closed.extend(asker.closed_mode((player, mode, &edges), false));
        }
        if closed.len() >= MAX_CLOSED {
            break;
        }
    }
    closed
}

/// Asks the way to the nearest state.
struct Asker<'a> {
    problem: &'a Problem<'a>,
    sources: &'a SourceMap,
    script: &'a Script,
}

impl Asker<'_> {
    fn closed_mode(&self, (slot, mode, edges): (SlotId, ModeId, &[EdgeId]), is_asked: bool) -> Option<ClosedMode> {
        let Asker { problem, sources, script } = *self;
        let asked = (Some(mode), edges);
        let found = nearly(problem.sim, sources, (script, problem.seed()), script.len() + 1, slot, asked).ok()?;
        let lacks = |edge: &NearlyEdge| {
            let distance: f64 = edge.missing.iter().filter_map(|missing| missing.distance).sum();
            (edge.step.is_none(), edge.missing.len(), distance)
        };
        let order = |a: &&NearlyEdge, b: &&NearlyEdge| lacks(a).partial_cmp(&lacks(b)).unwrap_or(Ordering::Equal);
        let nearest = found.edges.iter().min_by(order)?;
        let missing = nearest.missing.iter().map(|missing| match missing.distance {
            Some(distance) if distance > 0.0 => {
                format!("`{}` misses by {}", missing.atom.text, distance_words(distance, ""))
            }
            _ => format!("`{}` does not hold", missing.atom.text),
        });
        Some(ClosedMode {
            instance: found.instance.clone(),
            is_asked,
            mode: found.mode.clone()?,
            from: nearest.from.clone(),
            place: nearest.place.as_ref().map(Place::to_string),
            // Where nothing has a distance, no step is nearer than another.
            step: nearest.step.filter(|_| nearest.missing.iter().any(|missing| missing.distance.is_some())),
            missing: missing.collect(),
        })
    }
}

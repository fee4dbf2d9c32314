//! Modes and edges: what can never be entered, never be left, never be taken.

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::{ConstantGuard, Shadowed, Trap, UnreachableMode};
use crate::ir::{EdgeId, IdVec, ModeId};
use crate::sema::checked::{Edge, Entity, Mode, Term, TermKind};
use crate::source::Span;

use super::guard::{implied, truth};

/// The most edges tried before an edge that it is compared with.
const MAX_COMPARED: usize = 64;

/// Judges the modes and edges of an entity.
pub(super) fn modes(entity: &Entity, found: &mut Diagnostics) {
    let entered = entered(entity);
    let dead = deaths(entity, &entered);
    let alive = alive(entity, &dead);
    for (mode, m) in entity.modes.pairs() {
        if !entered[mode] {
            // A mode inside of one that is never entered is explained by it.
            if m.parent.is_none_or(|around| entered[around]) {
                found.report(UnreachableMode { path: m.path.join("."), at: m.name.span, first: first(entity, mode) });
            }
            continue;
        }
        let own: Vec<EdgeId> = m.edges.iter().copied().filter(|&e| entity.edges[e].target.is_some()).collect();
        if !own.is_empty() && !alive[mode] {
            let why = |edge: EdgeId| match dead[edge] {
                Some(Dead::Shadowed(_)) => "another edge comes first",
                _ => "never holds",
            };
            let edges = own.iter().map(|&e| (entity.edges[e].guard.span, why(e))).collect();
            found.report(Trap { path: m.path.join("."), at: m.name.span, edges });
            continue;
        }
        for &edge in &m.edges {
            let guard = &entity.edges[edge].guard;
            match dead[edge] {
                Some(Dead::Never) => found.report(ConstantGuard { at: guard.span, holds: false }),
                Some(Dead::Shadowed(by)) => {
                    let by = &entity.edges[by];
                    found.report(Shadowed { at: guard.span, by: by.guard.span, outer: by.source != mode });
                }
                None => always(entity, guard, found),
            }
        }
        for guard in m.follows.iter().filter_map(|f| f.guard.as_ref()).chain(&m.initial_when) {
            constant(entity, guard, found);
        }
    }
    for guard in entity.colliders.iter().filter_map(|c| c.guard.as_ref()) {
        constant(entity, guard, found);
    }
    for guard in entity.envelopes.iter().filter_map(|e| e.driven_while.as_ref()) {
        constant(entity, guard, found);
    }
}

/// Why edges are never taken; none for those that can be.
fn deaths(entity: &Entity, entered: &IdVec<ModeId, bool>) -> IdVec<EdgeId, Option<Dead>> {
    let truths: IdVec<EdgeId, Option<bool>> = entity.edges.iter().map(|e| truth(entity, &e.guard)).collect();
    let mut dead: IdVec<EdgeId, Option<Dead>> =
        truths.iter().map(|truth| (*truth == Some(false)).then_some(Dead::Never)).collect();
    for (mode, m) in entity.modes.pairs().filter(|(mode, _)| entered[*mode]) {
        let mut own: Vec<EdgeId> = Vec::new();
        for &edge in m.edges.iter().filter(|&&e| entity.edges[e].target.is_some()) {
            if dead[edge].is_none() {
                dead[edge] = shadow(entity, &truths, mode, &own, edge);
            }
            own.push(edge);
        }
    }
    dead
}

/// For each mode, whether any edge of it, of a mode around or of one inside can be taken.
fn alive(entity: &Entity, dead: &IdVec<EdgeId, Option<Dead>>) -> IdVec<ModeId, bool> {
    let own = |m: &Mode| m.edges.iter().any(|&e| entity.edges[e].target.is_some() && dead[e].is_none());
    let own: IdVec<ModeId, bool> = entity.modes.iter().map(own).collect();
    let (mut inside, mut around) = (own.clone(), own);
    // Modes are numbered from the outside in.
    for (mode, m) in entity.modes.pairs() {
        around[mode] |= m.parent.is_some_and(|p| around[p]);
    }
    for mode in entity.modes.ids().rev() {
        if let Some(parent) = entity.modes[mode].parent {
            inside[parent] |= inside[mode];
        }
    }
    entity.modes.ids().map(|m| inside[m] || around[m]).collect()
}

/// Why an edge is never taken.
#[derive(Debug, Clone, Copy)]
enum Dead {
    /// Its guard never holds.
    Never,
    /// Another one always comes first.
    Shadowed(EdgeId),
}

fn never(entity: &Entity, edge: &Edge) -> Option<Dead> {
    (truth(entity, &edge.guard) == Some(false)).then_some(Dead::Never)
}

/// The edge that is always taken before this one, among the earlier ones of its mode and those of the modes around.
fn shadow(
    entity: &Entity,
    truths: &IdVec<EdgeId, Option<bool>>,
    mode: ModeId,
    earlier: &[EdgeId],
    edge: EdgeId,
) -> Option<Dead> {
    let this = &entity.edges[edge];
    let mut before: Vec<EdgeId> = earlier.iter().rev().take(MAX_COMPARED).copied().collect();
    let mut around = entity.modes[mode].parent;
    while let Some(outer) = around.filter(|_| before.len() < MAX_COMPARED) {
        before.extend(entity.modes[outer].edges.iter().take(MAX_COMPARED));
        around = entity.modes[outer].parent;
    }
    let possible = before.into_iter().take(MAX_COMPARED).map(|id| (id, &entity.edges[id])).filter(|(id, other)| {
        // Edges on `lost` come before all others; a guard that is no choice is reported where it is.
        other.target.is_some()
            && (this.lost.is_none() || other.lost.is_some())
            && (is_literal(&other.guard) || truths[*id].is_none())
    });
    implied(entity, &this.guard, possible.map(|(id, other)| (id, &other.guard))).map(Dead::Shadowed)
}

fn is_literal(guard: &Term) -> bool {
    matches!(guard.kind, TermKind::Bool(true))
}

fn always(entity: &Entity, guard: &Term, found: &mut Diagnostics) {
    if !is_literal(guard) && truth(entity, guard) == Some(true) {
        found.report(ConstantGuard { at: guard.span, holds: true });
    }
}

fn constant(entity: &Entity, guard: &Term, found: &mut Diagnostics) {
    match truth(entity, guard) {
        Some(false) => found.report(ConstantGuard { at: guard.span, holds: false }),
        _ => always(entity, guard, found),
    }
}

/// Which modes can be entered, as far as edges and first modes tell.
fn entered(entity: &Entity) -> IdVec<ModeId, bool> {
    let mut active: IdVec<ModeId, bool> = entity.modes.iter().map(|_| false).collect();
    let mut begun = active.clone();
    let mut open: Vec<ModeId> = entity.groups.iter().flat_map(|g| beginnings(entity, &g.modes)).collect();
    while let Some(mode) = open.pop() {
        if std::mem::replace(&mut begun[mode], true) {
            continue;
        }
        open.extend(beginnings(entity, &entity.modes[mode].children));
        // The modes around are entered on the way, but do not begin where they would.
        let mut at = Some(mode);
        while let Some(mode) = at.filter(|&m| !std::mem::replace(&mut active[m], true)) {
            let edges = entity.modes[mode].edges.iter().map(|&e| &entity.edges[e]);
            open.extend(edges.filter(|e| never(entity, e).is_none()).filter_map(|e| e.target));
            at = entity.modes[mode].parent;
        }
    }
    active
}

fn siblings(entity: &Entity, mode: ModeId) -> Vec<ModeId> {
    match entity.modes[mode].parent {
        Some(parent) => entity.modes[parent].children.clone(),
        None => entity.groups[entity.modes[mode].group].modes.clone(),
    }
}

/// Where some modes, side by side, can begin: those marked `initial when`, and the marked or first one.
fn beginnings(entity: &Entity, modes: &[ModeId]) -> Vec<ModeId> {
    let plain = modes.iter().find(|m| entity.modes[**m].marked_initial).or(modes.first());
    let chosen = modes.iter().filter(|m| {
        let guard = entity.modes[**m].initial_when.as_ref();
        guard.is_some_and(|g| truth(entity, g) != Some(false))
    });
    chosen.chain(plain).copied().collect()
}

/// The plain first mode beside a mode.
fn first(entity: &Entity, mode: ModeId) -> Option<(String, Span)> {
    let beside = siblings(entity, mode);
    let first = beside.iter().find(|m| entity.modes[**m].marked_initial).or(beside.first())?;
    let name = &entity.modes[*first].name;
    (*first != mode).then(|| (name.text.to_string(), name.span))
}

//! Lints of modes and edges: never entered, never left, never taken.

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::{ConstantGuard, Shadowed, Trap, UnreachableMode};
use crate::ir::{EdgeId, IdVec, ModeId};
use crate::sema::checked::{Edge, Entity, Mode, Term, TermKind};
use crate::source::Span;

use super::guard::{implied, truth};

/// Maximum number of edges that are shown as doubtful.
const MAX_DOUBTFUL: usize = 2;
/// Maximum number of earlier edges that an edge is compared with.
const MAX_COMPARED: usize = 64;

/// Checks the modes and edges of an entity.
pub(super) fn modes(entity: &Entity, found: &mut Diagnostics) {
    let entered = entered(entity);
    let never_taken = never_taken(entity, &entered);
    let alive = alive(entity, &never_taken);
    for (mode, m) in entity.modes.pairs() {
        if !entered[mode] {
            // A mode inside an unreachable mode is explained by it.
            if m.parent.is_none_or(|around| entered[around]) {
                let beside = entity.siblings(mode);
                let (first, doubtful) = (first(entity, mode, beside), doubtful(entity, beside));
                found.report(UnreachableMode { path: m.path.join("."), at: m.name.span, first, doubtful });
            }
            continue;
        }
        let own: Vec<EdgeId> = m.edges.iter().copied().filter(|&e| entity.edges[e].target.is_some()).collect();
        if !own.is_empty() && !alive[mode] {
            let why = |edge: EdgeId| match never_taken[edge] {
                Some(NeverTaken::Shadowed(_)) => "another edge comes first",
                _ => "never holds",
            };
            let edges = own.iter().map(|&e| (entity.edges[e].guard.span, why(e))).collect();
            found.report(Trap { path: m.path.join("."), at: m.name.span, edges });
            continue;
        }
        for &edge in &m.edges {
            let guard = &entity.edges[edge].guard;
            match never_taken[edge] {
                Some(NeverTaken::Never) => found.report(ConstantGuard { at: guard.span, holds: false }),
                Some(NeverTaken::Shadowed(by)) => {
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

/// The reason why each edge is never taken; none for the others.
fn never_taken(entity: &Entity, entered: &IdVec<ModeId, bool>) -> IdVec<EdgeId, Option<NeverTaken>> {
    let truths: IdVec<EdgeId, Option<bool>> = entity.edges.iter().map(|e| truth(entity, &e.guard)).collect();
    let mut never_taken: IdVec<EdgeId, Option<NeverTaken>> =
        truths.iter().map(|truth| (*truth == Some(false)).then_some(NeverTaken::Never)).collect();
    for (mode, m) in entity.modes.pairs().filter(|(mode, _)| entered[*mode]) {
        let mut own: Vec<EdgeId> = Vec::new();
        for &edge in m.edges.iter().filter(|&&e| entity.edges[e].target.is_some()) {
            if never_taken[edge].is_none() {
                never_taken[edge] = shadow(entity, &truths, mode, &own, edge);
            }
            own.push(edge);
        }
    }
    never_taken
}

/// For each mode, whether an edge of it, of a mode around or of one inside can be taken.
fn alive(entity: &Entity, never_taken: &IdVec<EdgeId, Option<NeverTaken>>) -> IdVec<ModeId, bool> {
    let own = |m: &Mode| m.edges.iter().any(|&e| entity.edges[e].target.is_some() && never_taken[e].is_none());
    let own: IdVec<ModeId, bool> = entity.modes.iter().map(own).collect();
    let (mut inside, mut around) = (own.clone(), own);
    // Outer modes have smaller ids.
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

/// The reason why an edge is never taken.
#[derive(Debug, Clone, Copy)]
enum NeverTaken {
    /// Its guard never holds.
    Never,
    /// An earlier edge always preempts it.
    Shadowed(EdgeId),
}

fn never(entity: &Entity, edge: &Edge) -> Option<NeverTaken> {
    (truth(entity, &edge.guard) == Some(false)).then_some(NeverTaken::Never)
}

/// The edge that always preempts this one, among the earlier ones of its mode and those of the modes around.
fn shadow(
    entity: &Entity,
    truths: &IdVec<EdgeId, Option<bool>>,
    mode: ModeId,
    earlier: &[EdgeId],
    edge: EdgeId,
) -> Option<NeverTaken> {
    let this = &entity.edges[edge];
    let mut before: Vec<EdgeId> = earlier.iter().rev().take(MAX_COMPARED).copied().collect();
    let mut around = entity.modes[mode].parent;
    while let Some(outer) = around.filter(|_| before.len() < MAX_COMPARED) {
        before.extend(entity.modes[outer].edges.iter().take(MAX_COMPARED));
        around = entity.modes[outer].parent;
    }
    let possible = before.into_iter().take(MAX_COMPARED).map(|id| (id, &entity.edges[id])).filter(|(id, other)| {
        // Edges on `lost` come before all others; constant guards are reported separately.
        other.target.is_some()
            && (this.lost.is_none() || other.lost.is_some())
            && (is_literal(&other.guard) || truths[*id].is_none())
    });
    implied(entity, &this.guard, possible.map(|(id, other)| (id, &other.guard))).map(NeverTaken::Shadowed)
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

/// The modes that can be entered, by edges and initial modes.
fn entered(entity: &Entity) -> IdVec<ModeId, bool> {
    let mut active: IdVec<ModeId, bool> = entity.modes.iter().map(|_| false).collect();
    let mut begun = active.clone();
    let mut open: Vec<ModeId> = entity.groups.iter().flat_map(|g| initial_modes(entity, &g.modes)).collect();
    while let Some(mode) = open.pop() {
        if std::mem::replace(&mut begun[mode], true) {
            continue;
        }
        open.extend(initial_modes(entity, &entity.modes[mode].children));
        // The modes around are entered too, but not through their initial modes.
        let mut at = Some(mode);
        while let Some(mode) = at.filter(|&m| !std::mem::replace(&mut active[m], true)) {
            let edges = entity.modes[mode].edges.iter().map(|&e| &entity.edges[e]);
            open.extend(edges.filter(|e| never(entity, e).is_none()).filter_map(|e| e.target));
            at = entity.modes[mode].parent;
        }
    }
    active
}

/// The edges beside a mode that nothing leads to which may have been meant to: those that stay where they are and change
/// nothing, else those that lead to where another edge of the same mode leads. None if they are many.
fn doubtful(entity: &Entity, beside: &[ModeId]) -> Vec<(Span, String)> {
    if beside.len() > MAX_COMPARED {
        return Vec::new();
    }
    let edges = beside.iter().flat_map(|m| &entity.modes[*m].edges).map(|&edge| &entity.edges[edge]);
    let edges: Vec<&Edge> = edges.take(MAX_COMPARED + 1).collect();
    if edges.len() > MAX_COMPARED {
        return Vec::new();
    }
    let name = |mode: ModeId| &entity.modes[mode].name.text;
    let stays = |edge: &&Edge| {
        let stays = edge.target? == edge.source && edge.actions.is_empty();
        stays.then(|| (edge.guard.span, format!("this edge leads back to its own mode, `{}`", name(edge.source))))
    };
    let repeats = |edge: &&Edge| {
        let to = edge.target?;
        let alike = edges.iter().filter(|other| other.source == edge.source && other.target == Some(to)).count();
        (alike > 1).then(|| (edge.guard.span, format!("two edges of `{}` lead to `{}`", name(edge.source), name(to))))
    };
    let mut found: Vec<_> = edges.iter().filter_map(stays).collect();
    if found.is_empty() {
        found = edges.iter().filter_map(repeats).collect();
    }
    if found.len() > MAX_DOUBTFUL { Vec::new() } else { found }
}

/// The possible initial modes of siblings: those marked `initial when`, and the default one.
fn initial_modes(entity: &Entity, modes: &[ModeId]) -> Vec<ModeId> {
    let chosen = modes.iter().filter(|m| {
        let guard = entity.modes[**m].initial_when.as_ref();
        guard.is_some_and(|g| truth(entity, g) != Some(false))
    });
    chosen.copied().chain(entity.default_mode(modes)).collect()
}

/// The default initial mode among the siblings of a mode.
fn first(entity: &Entity, mode: ModeId, beside: &[ModeId]) -> Option<(String, Span)> {
    let first = entity.default_mode(beside)?;
    let name = &entity.modes[first].name;
    (first != mode).then(|| (name.text.to_string(), name.span))
}

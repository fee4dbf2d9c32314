//! Modes that are the target of edges but that values never let an instance enter.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::values::{ModeByValue, Reason};
use crate::ir::{EdgeId, Id, ModeId};

use super::atoms::Judge;
use super::guards::{EXPLAINING_CODES, Site, any_of};
use super::summary::EntitySummary;

/// Reports modes that are never entered; returns the edges that explain them.
pub(super) fn modes(subject: &EntitySummary<'_>, found: &mut Diagnostics) -> BTreeSet<EdgeId> {
    let (entity, context) = (subject.entity, subject.context);
    let is_live = |mode: ModeId| any_of(&subject.live, entity.modes[mode].leaves);
    let mut explained = BTreeSet::new();
    if entity.modes.ids().all(is_live) {
        return explained;
    }
    let judge = Judge::new(subject);
    let choices = entity.groups.iter().flat_map(|g| &g.choices).chain(entity.modes.iter().flat_map(|m| &m.choices));
    let chosen: Vec<ModeId> = choices.map(|c| c.mode).collect();
    for (mode, m) in entity.modes.pairs().filter(|(mode, _)| !is_live(*mode)) {
        let inside = |inner: ModeId, outer: ModeId| outer <= inner && inner < entity.modes[outer].end;
        // Parameters choose these modes: the choice belongs to the instance.
        let is_chosen = chosen.iter().any(|c| inside(*c, mode) || inside(mode, *c));
        let is_outermost = m.parent.is_none_or(is_live);
        let name = context.program.spans.entities[subject.id].modes[mode];
        if is_chosen || !is_outermost || name.is_copy() || context.reported.of(EXPLAINING_CODES, name, context.sources)
        {
            continue;
        }
        let leads_here = |target: ModeId| {
            let initial = entity.modes[target].initial;
            inside(target, mode) || m.leaves.contains(initial)
        };
        // Edges from modes that are never active do not count.
        let edges: Vec<&Site> = subject
            .sites
            .iter()
            .filter(|s| {
                let edge = s.edge.map(|e| &entity.edges[e]);
                edge.is_some_and(|e| e.target.is_some_and(leads_here) && is_live(e.source))
            })
            .collect();
        let is_explained = |s: &&Site| {
            let guard = context.program.spans.exprs[s.guard];
            s.verdict(subject, &judge) == Some(false) && !context.reported.of(EXPLAINING_CODES, guard, context.sources)
        };
        if edges.is_empty() || !edges.iter().all(is_explained) {
            continue;
        }
        explained.extend(edges.iter().filter_map(|s| s.edge));
        let reasons: Vec<Reason> = edges.iter().map(|s| s.reason(subject, &judge, false)).collect();
        let after: Vec<String> = entity
            .edges
            .iter()
            .filter(|e| inside(e.source, mode))
            .filter_map(|e| e.target)
            .filter(|t| !is_live(*t) && !inside(*t, mode) && t.index() != mode.index())
            .map(|t| entity.modes[t].path.clone())
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect();
        found.report(ModeByValue { path: m.path.clone(), at: name, reasons, after });
    }
    explained
}

//! Updates whose value can be out of a discrete variable's range, where the guard holds.

use std::collections::BTreeSet;

use crate::diagnostic::catalogue::values::LeavesRange;
use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{Actions, DiscreteId, Domain, Entity, ExprId, LeafId, ModeId, Place, Program, Transition};

use super::account::{Account, Occurrence};
use super::judge::Reads;
use super::words::Seen;
use super::{Scene, words};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};

/// An update of a discrete variable: where it happens, and what of the configuration is left then.
type Visit<'v> = dyn FnMut(&Actions, &Occurrence<'_>, &Configuration, LeafId) + 'v;

/// An update that may leave the range of its variable, where that was seen first.
pub(super) struct Leaving {
    variable: DiscreteId,
    value: ExprId,
    /// What it can be.
    hull: Interval,
    /// Whether all of that is outside.
    always: bool,
    leaf: LeafId,
    /// What it reads can be, if there is anything to say.
    reads: Option<String>,
}

/// Adds updates that may leave the range in some cases, of which the text alone did not tell; each is added once.
pub(super) fn add(
    scene: &Scene<'_>,
    entity: &Entity,
    cases: &[(&Occurrence<'_>, &Configuration)],
    known: &mut Vec<Leaving>,
) {
    if entity.discretes.iter().all(|d| d.domain != Domain::Int) {
        return;
    }
    let mut seen: BTreeSet<ExprId> = known.iter().map(|l| l.value).collect();
    visit(scene.program, entity, cases, &mut |actions, o, at, leaf| {
        for update in &actions.updates {
            let Place::Discrete(id) = update.place else { continue };
            let variable = &entity.discretes[id];
            if variable.domain != Domain::Int || seen.contains(&update.value) {
                continue;
            }
            let value = o.reader(scene.program, at).number(update.value);
            let (low, high) = (f64::from(variable.range.0), f64::from(variable.range.1));
            // An end that is not known is no sign of a mistake.
            let leaves = |x: f64| x.is_finite() && !(low..=high).contains(&x);
            let Some(hull) = value.hull().filter(|h| leaves(h.low) || leaves(h.high)) else { continue };
            if scene.said.of(&[Code::MayLeaveRange], scene.program.spans.exprs[update.value], scene.sources) {
                continue;
            }
            seen.insert(update.value);
            let outside = [(f64::NEG_INFINITY, low - 1.0), (high + 1.0, f64::INFINITY)];
            let outside = Values::any(
                outside.into_iter().flat_map(|(low, high)| value.within(Interval { low, high }).intervals().to_vec()),
            );
            let reads = Reads::of(scene.program, update.value);
            let reads = words::read(entity, &reads, &[(&at.leaves, &Seen::of(&reads, o, at))]);
            let reads = (!reads.is_empty()).then(|| words::listed(&reads));
            known.push(Leaving { variable: id, value: update.value, hull, always: outside == value, leaf, reads });
        }
    });
}

/// Reports updates that may leave the range.
pub(super) fn report(subject: &Account<'_>, found: &mut Diagnostics) {
    let (entity, spans) = (subject.entity, &subject.scene.program.spans);
    for leaving in &subject.leaving {
        let variable = &entity.discretes[leaving.variable];
        found.report(LeavesRange {
            name: variable.name.clone(),
            range: variable.range,
            declared: spans.entities[subject.id].discretes[leaving.variable],
            at: spans.exprs[leaving.value],
            value: words::values(&Values::from(leaving.hull), ""),
            always: leaving.always,
            mode: entity.modes[entity.leaves[leaving.leaf].mode].path.clone(),
            reads: leaving.reads.clone(),
        });
    }
}

/// Goes through all that can be run, in each configuration in which it can be, cut to where its guard holds.
fn visit(program: &Program, entity: &Entity, cases: &[(&Occurrence<'_>, &Configuration)], visit: &mut Visit<'_>) {
    let writes = |a: &Actions| a.updates.iter().any(|u| matches!(u.place, Place::Discrete(_)));
    for &(o, at) in cases {
        for &from in &at.leaves {
            let leaf = &entity.leaves[from];
            let mut rest = Some(at.clone());
            for &edge in &leaf.edges {
                let edge = &entity.edges[edge];
                let Some(before) = rest.take() else { break };
                let reader = o.reader(program, &before);
                if let Some(held) = reader.refined(&before, edge.guard, true) {
                    if writes(&edge.actions) {
                        visit(&edge.actions, o, &held, from);
                    }
                    for mode in edge.target.map(|target| entered(entity, from, target)).unwrap_or_default() {
                        if writes(&entity.modes[mode].entry) {
                            visit(&entity.modes[mode].entry, o, &held, from);
                        }
                    }
                }
                rest = reader.refined(&before, edge.guard, false);
            }
            for &edge in &leaf.internal {
                let edge = &entity.edges[edge];
                if writes(&edge.actions)
                    && let Some(held) = o.reader(program, at).refined(at, edge.guard, true)
                {
                    visit(&edge.actions, o, &held, from);
                }
            }
            for &follow in &leaf.follows {
                let follow = &entity.follows[follow];
                let held = match follow.guard {
                    Some(guard) => o.reader(program, at).refined(at, guard, true),
                    None => Some(at.clone()),
                };
                if let Some(held) = held.filter(|_| writes(&follow.actions)) {
                    visit(&follow.actions, o, &held, from);
                }
            }
        }
    }
}

/// The modes that an edge from a leaf to a mode may enter.
fn entered(entity: &Entity, from: LeafId, target: ModeId) -> BTreeSet<ModeId> {
    let group = entity.modes[target].group;
    let transitions = entity.enterable(target).ids().map(|to| Transition { group, from, target, to });
    transitions.flat_map(|transition| transition.entered(entity).collect::<Vec<_>>()).collect()
}

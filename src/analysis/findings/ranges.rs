//! Updates whose value can leave the range of a discrete variable where the guard holds.

use std::collections::BTreeSet;

use crate::diagnostic::catalogue::values::LeavesRange;
use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{Actions, DiscreteId, Domain, Entity, ExprId, LeafId, ModeId, Place, Program, Transition};

use super::atoms::Reads;
use super::summary::{EntitySummary, Occurrence};
use super::value_text::Observed;
use super::{Context, value_text};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};

/// A callback for an action list: the instance, the configuration refined by the guard, and the source leaf.
type Visit<'v> = dyn FnMut(&Actions, &Occurrence<'_>, &Configuration, LeafId) + 'v;

/// An update that may leave the range of its variable, as first observed.
pub(super) struct OutOfRange {
    variable: DiscreteId,
    value: ExprId,
    /// Values that it can have.
    hull: Interval,
    /// Whether all of them are outside.
    always: bool,
    leaf: LeafId,
    /// Text of the values that it reads, if there are any.
    reads: Option<String>,
}

/// Adds updates that may leave the range in some cases, unless the front end has already reported them; each is added
/// once.
pub(super) fn add(
    context: &Context<'_>,
    entity: &Entity,
    cases: &[(&Occurrence<'_>, &Configuration)],
    known: &mut Vec<OutOfRange>,
) {
    if entity.discretes.iter().all(|d| d.domain != Domain::Int) {
        return;
    }
    let mut seen: BTreeSet<ExprId> = known.iter().map(|l| l.value).collect();
    visit(context.program, entity, cases, &mut |actions, o, at, leaf| {
        for update in &actions.updates {
            let Place::Discrete(id) = update.place else { continue };
            let variable = &entity.discretes[id];
            if variable.domain != Domain::Int || seen.contains(&update.value) {
                continue;
            }
            let value = o.reader(context.program, at).number(update.value);
            let (low, high) = (f64::from(variable.range.0), f64::from(variable.range.1));
            // An infinite end is no sign of a mistake.
            let leaves = |x: f64| x.is_finite() && !(low..=high).contains(&x);
            // Of an expression over whole numbers only these matter.
            let whole = value.hull().map(|h| Interval { low: h.low.ceil(), high: h.high.floor() });
            let Some(hull) = whole.filter(|h| leaves(h.low) || leaves(h.high)) else { continue };
            if context.reported.of(&[Code::MayLeaveRange], context.program.spans.exprs[update.value], context.sources) {
                continue;
            }
            seen.insert(update.value);
            let outside = [(f64::NEG_INFINITY, low - 1.0), (high + 1.0, f64::INFINITY)];
            let outside = Values::any(
                outside.into_iter().flat_map(|(low, high)| value.within(Interval { low, high }).intervals().to_vec()),
            );
            let reads = Reads::of(context.program, update.value);
            let reads = value_text::read(entity, &reads, &[(&at.leaves, &Observed::of(&reads, o, at))]);
            let reads = (!reads.is_empty()).then(|| value_text::listed(&reads));
            known.push(OutOfRange { variable: id, value: update.value, hull, always: outside == value, leaf, reads });
        }
    });
}

/// Reports updates that may leave the range.
pub(super) fn report(subject: &EntitySummary<'_>, found: &mut Diagnostics) {
    let (entity, spans) = (subject.entity, &subject.context.program.spans);
    for out_of_range in &subject.out_of_range {
        let variable = &entity.discretes[out_of_range.variable];
        found.report(LeavesRange {
            name: variable.name.clone(),
            range: variable.range,
            declared: spans.entities[subject.id].discretes[out_of_range.variable],
            at: spans.exprs[out_of_range.value],
            value: value_text::values(&Values::from(out_of_range.hull), ""),
            always: out_of_range.always,
            mode: entity.modes[entity.leaves[out_of_range.leaf].mode].path.clone(),
            reads: out_of_range.reads.clone(),
        });
    }
}

/// Visits all action lists that can run in each configuration, refined by their guards.
fn visit(program: &Program, entity: &Entity, cases: &[(&Occurrence<'_>, &Configuration)], visit: &mut Visit<'_>) {
    let writes = |a: &Actions| a.updates.iter().any(|u| matches!(u.place, Place::Discrete(_)));
    for &(o, at) in cases {
        for &from in &*at.leaves {
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

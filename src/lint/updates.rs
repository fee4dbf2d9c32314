//! Lints of updates: conflicting updates of two groups in one step, and updates out of a discrete variable's range.

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::{GroupClash, MayLeaveRange};
use crate::ir::{Arithmetic, GroupId, ModeId, Place, Subject};
use crate::sema::checked::{Entity, Term, TermKind, Type, Update};

use super::guard::{exclusive, is_in, truth};
use super::range::{facts, range};
use super::terms::updates;

/// Maximum number of updates of one variable by one group that are examined.
const MAX_COMPARED: usize = 32;

/// An update with its condition.
struct When<'a> {
    mode: ModeId,
    /// None for entry actions.
    guard: Option<&'a Term>,
    update: &'a Update,
}

/// Every update of an entity, in the order of the text.
fn all(entity: &Entity) -> Vec<When<'_>> {
    let mut out = Vec::new();
    for (mode, m) in entity.modes.pairs() {
        let mut add = |guard, actions| out.extend(updates(actions).map(|update| When { mode, guard, update }));
        add(None, &m.entry);
        for &edge in &m.edges {
            let edge = &entity.edges[edge];
            add(Some(&edge.guard), &edge.actions);
        }
        for follow in &m.follows {
            add(follow.guard.as_ref(), &follow.actions);
        }
    }
    out
}

/// Reports updates of one variable by two groups, unless their guards exclude each other.
pub(super) fn clashes(entity: &Entity, found: &mut Diagnostics) {
    if entity.groups.len() < 2 {
        return;
    }
    let mut by_place: BTreeMap<Place, BTreeMap<GroupId, Vec<When<'_>>>> = BTreeMap::new();
    for when in all(entity) {
        let groups = by_place.entry(when.update.place).or_default();
        let list = groups.entry(entity.modes[when.mode].group).or_default();
        if list.len() < MAX_COMPARED {
            list.push(when);
        }
    }
    for (place, groups) in by_place {
        let groups: Vec<Vec<When<'_>>> = groups.into_values().collect();
        for (index, first) in groups.iter().enumerate() {
            let later = groups[index + 1..].iter().flatten();
            let clash = later.flat_map(|b| first.iter().map(move |a| (a, b))).find(|(a, b)| can_coincide(entity, a, b));
            if let Some((a, b)) = clash {
                let variable = name(entity, place);
                found.report(GroupClash { variable, last: b.update.span, first: a.update.span });
                break;
            }
        }
    }
}

/// Whether the guards of two updates of different groups may hold in the same step.
fn can_coincide(entity: &Entity, a: &When<'_>, b: &When<'_>) -> bool {
    let (Some(guard_a), Some(guard_b)) = (a.guard, b.guard) else { return true };
    let possible = |guard| truth(entity, guard) != Some(false);
    // A guard that requires a mode of the other group excludes updates of that mode's siblings.
    possible(guard_a)
        && possible(guard_b)
        && !exclusive(entity, guard_a, guard_b)
        && !asks_for_another(entity, guard_a, b.mode)
        && !asks_for_another(entity, guard_b, a.mode)
}

/// Whether a guard requires a sibling of this mode.
fn asks_for_another(entity: &Entity, guard: &Term, mode: ModeId) -> bool {
    match &guard.kind {
        TermKind::And(sides) => sides.iter().any(|side| asks_for_another(entity, side, mode)),
        TermKind::Or(sides) => sides.iter().all(|side| asks_for_another(entity, side, mode)),
        TermKind::InMode(Subject::Me, other) => {
            let same_group = entity.modes[*other].group == entity.modes[mode].group;
            same_group && !is_in(entity, *other, mode) && !is_in(entity, mode, *other)
        }
        TermKind::Not(inner) => {
            matches!(inner.kind, TermKind::InMode(Subject::Me, other) if is_in(entity, mode, other))
        }
        _ => false,
    }
}

fn name(entity: &Entity, place: Place) -> String {
    match place {
        Place::Var(var, degree) => format!("{}{}", entity.vars[var].name.text, "'".repeat(usize::from(degree))),
        Place::Discrete(id) => entity.discretes[id].name.text.to_string(),
        Place::Ref(id) => entity.refs[id].name.text.to_string(),
    }
}

/// Reports updates that can leave the range of their discrete variable.
pub(super) fn ranges(entity: &Entity, found: &mut Diagnostics) {
    for When { guard, update, .. } in all(entity) {
        let Place::Discrete(id) = update.place else { continue };
        let variable = &entity.discretes[id];
        let (low, high) = variable.range;
        if variable.ty != Type::Int || (low, high) == (i32::MIN, i32::MAX) {
            continue;
        }
        let facts = guard.map(|guard| facts(entity, guard)).unwrap_or_default();
        let value = range(entity, &update.value, &facts);
        // An unknown end is no sign of a mistake.
        let leaves = |end: f64| end.is_finite() && !(f64::from(low)..=f64::from(high)).contains(&end);
        if !(leaves(value.low) || leaves(value.high))
            || value.is_empty()
            || guard.is_some_and(|g| truth(entity, g) == Some(false))
        {
            continue;
        }
        let stopping = match &update.value.kind {
            TermKind::Arithmetic(operator, sides) if sides[0].kind == TermKind::Discrete(Subject::Me, id) => {
                match operator {
                    Arithmetic::Add => Some("+="),
                    Arithmetic::Subtract => Some("-="),
                    _ => None,
                }
            }
            _ => None,
        };
        found.report(MayLeaveRange {
            stopping,
            name: variable.name.text.to_string(),
            range: variable.range,
            at: update.value.span,
            value: (value.low, value.high),
        });
    }
}

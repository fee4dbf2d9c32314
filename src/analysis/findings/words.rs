//! Values in words: what the variables that an expression reads can be, in which mode.

use std::collections::BTreeMap;

use crate::ir::{Domain, Entity, LeafId, VarId};

use super::super::configuration::Configuration;
use super::super::values::{Interval, Values};
use super::judge::Reads;
use super::{Occurrence, Subject};

/// A number with at most three digits after the point.
pub(super) fn number(x: f64) -> String {
    let text = format!("{x:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// A variable or one of its derivatives: `y'`.
pub(super) fn derivative(entity: &Entity, var: VarId, degree: u8) -> String {
    format!("{}{}", entity.vars[var], "'".repeat(usize::from(degree)))
}

/// `is 3 px/s`, `is from -240 to 0 px/s`, `is at most 0 or from 3 to 5`.
pub(super) fn values(values: &Values, unit: &str) -> String {
    let one = |i: &Interval| match (i.low.is_finite(), i.high.is_finite()) {
        _ if i.is_point() => number(i.low),
        (true, true) => format!("from {} to {}", number(i.low), number(i.high)),
        (true, false) => format!("at least {}", number(i.low)),
        (false, true) => format!("at most {}", number(i.high)),
        (false, false) => "any number".to_string(),
    };
    let parts: Vec<String> = match values.intervals() {
        // Many are no help, but for a few numbers.
        all if all.len() > 4 || (all.len() > 2 && !all.iter().all(|i| i.is_point())) => {
            values.hull().iter().map(one).collect()
        }
        all => all.iter().map(one).collect(),
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    match parts.split_last() {
        None => "has no value".to_string(),
        Some((only, [])) => format!("is {only}{unit}"),
        Some((last, init)) => format!("is {} or {last}{unit}", init.join(", ")),
    }
}

/// What a whole number stands for.
fn discrete(domain: &Domain, found: &Values) -> String {
    let named = |names: &[&str]| {
        let can: Vec<String> = names
            .iter()
            .enumerate()
            .filter(|(index, _)| found.contains(*index as f64))
            .map(|(_, name)| format!("`{name}`"))
            .collect();
        format!("is {}", can.join(" or "))
    };
    match domain {
        Domain::Int => values(found, ""),
        Domain::Bool => named(&["false", "true"]),
        Domain::Set(names) => named(&names.iter().map(String::as_str).collect::<Vec<_>>()),
    }
}

fn unit(entity: &Entity, var: VarId, degree: u8) -> &'static str {
    // Of others the unit is not kept.
    let is_position = entity.vars.get(var).is_some_and(|name| name == "x" || name == "y");
    match degree {
        0 if is_position => "px",
        1 if is_position => "px/s",
        2 if is_position => "px/s^2",
        _ => "",
    }
}

/// Each variable that is read, with its name and what it can be.
pub(super) fn read(subject: &Subject<'_>, reads: &Reads, at: &[(&Occurrence<'_>, &Configuration)]) -> Vec<String> {
    let entity = subject.entity;
    let all = |f: &dyn Fn(&Occurrence<'_>, &Configuration) -> Values| {
        Values::any(at.iter().flat_map(|(o, c)| f(o, c).intervals().to_vec()))
    };
    let mut out = Vec::new();
    for &(var, degree) in &reads.vars {
        let found = all(&|_, c| c.vars[var][usize::from(degree)]);
        out.push(format!("`{}` {}", derivative(entity, var, degree), values(&found, unit(entity, var, degree))));
    }
    for &id in &reads.discretes {
        let found = all(&|_, c| c.discretes[id]);
        out.push(format!("`{}` {}", entity.discretes[id].name, discrete(&entity.discretes[id].domain, &found)));
    }
    for &id in &reads.timers {
        let found = all(&|o, c| {
            let step = o.world.step.seconds();
            let Interval { low, high } = c.timers[id];
            // A count that stays at its limit stands for all times from there on.
            let high = if high >= f64::from(o.world.slots[o.slot].timer_limits[id]) { f64::INFINITY } else { high };
            Values::from(Interval { low: low * step, high: high * step })
        });
        // As it is written where the mode is the innermost one.
        let mode = entity.timers[id].mode;
        let is_own = at.iter().all(|(_, c)| c.leaves.iter().any(|l| entity.leaves[*l].mode == mode));
        let name = if is_own { "timer".to_string() } else { format!("timer({})", entity.modes[mode].path) };
        out.push(format!("`{name}` {}", values(&found, "s")));
    }
    for &id in &reads.params {
        let found = all(&|o, _| o.space.overall[o.slot].params[id]);
        out.push(format!("`{}` {}", entity.params[id].name, values(&found, "")));
    }
    out
}

/// `a, b and c`.
pub(super) fn listed(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [only] => only.clone(),
        [init @ .., last] => format!("{} and {last}", init.join(", ")),
    }
}

/// What is read can be, in all the cases together, and mode by mode where that says more.
pub(super) fn reason(
    subject: &Subject<'_>,
    reads: &Reads,
    at: &[(&Occurrence<'_>, &Configuration)],
    leaf: impl Fn(&Configuration) -> Option<LeafId>,
) -> (Option<String>, Vec<String>) {
    let mut by_leaf: BTreeMap<LeafId, Vec<(&Occurrence<'_>, &Configuration)>> = BTreeMap::new();
    for (o, c) in at {
        if let Some(leaf) = leaf(c) {
            by_leaf.entry(leaf).or_default().push((o, c));
        }
    }
    let path = |leaf: LeafId| &subject.entity.modes[subject.entity.leaves[leaf].mode].path;
    let all = read(subject, reads, at);
    if all.is_empty() {
        return (None, Vec::new());
    }
    if let (1, Some(leaf)) = (by_leaf.len(), by_leaf.keys().next()) {
        return (Some(format!("in `{}`, {}", path(*leaf), listed(&all))), Vec::new());
    }
    let mut notes = Vec::new();
    if by_leaf.len() <= 4 {
        let each: Vec<(LeafId, String)> =
            by_leaf.iter().map(|(leaf, at)| (*leaf, listed(&read(subject, reads, at)))).collect();
        if each.iter().any(|(_, text)| *text != listed(&all)) {
            notes = each.into_iter().map(|(leaf, text)| format!("in `{}`, {text}", path(leaf))).collect();
        }
    }
    (Some(listed(&all)), notes)
}

//! Text of the values of the variables that an expression reads, by mode.

use std::collections::BTreeMap;

use crate::ir::{DiscreteId, Domain, Entity, LeafId, ParamId, TimerId, VarId};

use super::atoms::Reads;
use super::summary::Occurrence;
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::domain::wording::number;

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
        // A long list does not help, unless it is a few numbers.
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

/// The values of a discrete variable, by name where they have names.
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
    // The units of other variables are not known here.
    let is_position = entity.vars.get(var).is_some_and(|name| matches!(&**name, "x" | "y"));
    match degree {
        0 if is_position => "px",
        1 if is_position => "px/s",
        2 if is_position => "px/s^2",
        _ => "",
    }
}

/// A number of the instance itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Var(VarId, u8),
    Discrete(DiscreteId),
    /// In seconds.
    Timer(TimerId),
    Param(ParamId),
}

/// Observed values of numbers of an instance, joined over some cases.
#[derive(Debug, Clone, Default)]
pub(super) struct Observed(BTreeMap<Part, Vec<Interval>>);

/// The active leaves, and the values observed in them.
pub(super) type Case<'a> = (&'a [LeafId], &'a Observed);

impl Observed {
    /// The values that are read in one case.
    pub fn of(reads: &Reads, o: &Occurrence<'_>, at: &Configuration) -> Observed {
        let mut seen = Observed::default();
        seen.add(reads, o, at);
        seen
    }

    /// Adds the values that are read in a case.
    pub fn add(&mut self, reads: &Reads, o: &Occurrence<'_>, at: &Configuration) {
        for &(var, degree) in &reads.vars {
            self.join(Part::Var(var, degree), &at.vars[var][usize::from(degree)]);
        }
        for &id in &reads.discretes {
            self.join(Part::Discrete(id), &at.discretes[id]);
        }
        for &id in &reads.timers {
            let step = o.world.step.seconds();
            let Interval { low, high } = at.timers[id];
            // A count at its limit stands for all later times.
            let high = if high >= f64::from(o.world.slots[o.slot].timer_limits[id]) { f64::INFINITY } else { high };
            self.join(Part::Timer(id), &Values::from(Interval { low: low * step, high: high * step }));
        }
        for &id in &reads.params {
            self.join(Part::Param(id), &o.space.overall[o.slot].params[id]);
        }
    }

    fn join(&mut self, part: Part, values: &Values) {
        let known = self.0.entry(part).or_default();
        for new in values.intervals() {
            // The intervals that it overlaps or touches are `from..to`.
            let from = known.partition_point(|i| i.high < new.low);
            let to = known.partition_point(|i| i.low <= new.high);
            let joined = known[from..to].iter().fold(*new, |all, i| all.or(*i));
            known.splice(from..to, [joined]);
        }
        if known.len() > MAX_APART {
            *known = Values::any(known.drain(..)).intervals().to_vec();
        }
    }
}

/// Maximum number of intervals while they are collected.
const MAX_APART: usize = 64;

/// A text for each variable that is read, with its values.
pub(super) fn read(entity: &Entity, reads: &Reads, at: &[Case<'_>]) -> Vec<String> {
    let all = |part: Part| Values::any(at.iter().filter_map(|(_, seen)| seen.0.get(&part)).flatten().copied());
    let mut out = Vec::new();
    for &(var, degree) in &reads.vars {
        let found = values(&all(Part::Var(var, degree)), unit(entity, var, degree));
        out.push(format!("`{}` {found}", entity.variable_text(var, degree)));
    }
    for &id in &reads.discretes {
        let found = all(Part::Discrete(id));
        out.push(format!("`{}` {}", entity.discretes[id].name, discrete(&entity.discretes[id].domain, &found)));
    }
    for &id in &reads.timers {
        // As written in the source when the mode is the innermost one.
        let mode = entity.timers[id].mode;
        let is_own = at.iter().all(|(leaves, _)| leaves.iter().any(|l| entity.leaves[*l].mode == mode));
        let name = if is_own { "timer".to_string() } else { format!("timer({})", entity.modes[mode].path) };
        out.push(format!("`{name}` {}", values(&all(Part::Timer(id)), "s")));
    }
    for &id in &reads.params {
        out.push(format!("`{}` {}", entity.params[id].name, values(&all(Part::Param(id)), "")));
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

/// Text of the values over all cases, and notes by mode where those differ.
pub(super) fn reason(
    entity: &Entity,
    reads: &Reads,
    at: &[Case<'_>],
    leaf: impl Fn(&[LeafId]) -> Option<LeafId>,
) -> (Option<String>, Vec<String>) {
    let mut by_leaf: BTreeMap<LeafId, Vec<Case<'_>>> = BTreeMap::new();
    for &(leaves, seen) in at {
        if let Some(leaf) = leaf(leaves) {
            by_leaf.entry(leaf).or_default().push((leaves, seen));
        }
    }
    let path = |leaf: LeafId| &entity.modes[entity.leaves[leaf].mode].path;
    let all = read(entity, reads, at);
    if all.is_empty() {
        return (None, Vec::new());
    }
    if let (1, Some(leaf)) = (by_leaf.len(), by_leaf.keys().next()) {
        return (Some(format!("in `{}`, {}", path(*leaf), listed(&all))), Vec::new());
    }
    let mut notes = Vec::new();
    if by_leaf.len() <= 4 {
        let each: Vec<(LeafId, String)> =
            by_leaf.iter().map(|(leaf, at)| (*leaf, listed(&read(entity, reads, at)))).collect();
        if each.iter().any(|(_, text)| *text != listed(&all)) {
            notes = each.into_iter().map(|(leaf, text)| format!("in `{}`, {text}", path(leaf))).collect();
        }
    }
    (Some(listed(&all)), notes)
}

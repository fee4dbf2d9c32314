//! What a number can be, as text: `= 32`, `{-30, 30}`, `[0, 640]`, `>= 0`; and why a goal is proven unreachable.

use crate::analysis::{Interval, Values};
use crate::ir::{Entity, Program, World};
use crate::reach::{Proof, Quantity};
use crate::source::SourceMap;

/// More characters than that say less.
const LONGEST: usize = 26;

/// A number with at most three digits after the point.
pub(super) fn number(x: f64) -> String {
    Interval::point(x).to_string()
}

fn interval(i: &Interval) -> String {
    let (low, high) = (number(i.low), number(i.high));
    match (i.low == f64::NEG_INFINITY, i.high == f64::INFINITY) {
        (true, true) => "any".to_string(),
        (true, false) => format!("<= {high}"),
        (false, true) => format!(">= {low}"),
        // What differs only far behind the point reads like one number.
        _ if low == high => low,
        _ => format!("[{low}, {high}]"),
    }
}

/// All that a number can be.
pub(super) fn shown(values: &Values) -> String {
    let texts: Vec<String> = values.intervals().iter().map(interval).collect();
    let points = texts.iter().all(|t| !t.contains(['[', '=', 'y']));
    let all = match texts.as_slice() {
        [] => "none".to_string(),
        [only] if points => format!("= {only}"),
        [only] => only.clone(),
        _ if points => format!("{{{}}}", texts.join(", ")),
        _ => texts.join(" or "),
    };
    match values.hull() {
        Some(hull) if all.len() > LONGEST => format!("{} with gaps", interval(&hull)),
        _ => all,
    }
}

/// A number of an instance with all that it can be, as a relation.
pub(super) fn relation(name: &str, values: &Values) -> String {
    match shown(values) {
        all if all.starts_with(['[', '{']) => format!("{name} in {all}"),
        all => format!("{name} {all}"),
    }
}

/// `x''`
pub(super) fn variable(entity: &Entity, var: crate::ir::VarId, degree: u8) -> String {
    format!("{}{}", entity.vars[var], "'".repeat(usize::from(degree)))
}

/// Why a goal cannot hold: one reason for each part of its predicate that would have to turn out otherwise.
pub(super) fn reasons(sources: &SourceMap, program: &Program, world: &World, proof: &Proof) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for part in &proof.parts {
        let text = sources.slice(program.spans.exprs[part.predicate]);
        let text: Vec<&str> = text.lines().filter_map(|line| line.split("//").next()).collect();
        let text = text.join(" ").split_whitespace().collect::<Vec<_>>().join(" ");
        let reads = part.reads.iter().map(|(quantity, values)| {
            let (slot, name) = match *quantity {
                Quantity::Var(slot, var, degree) => (slot, variable(entity(program, world, slot), var, degree)),
                Quantity::Discrete(slot, id) => (slot, entity(program, world, slot).discretes[id].name.clone()),
                Quantity::Timer(slot, id) => (slot, id.to_string()),
            };
            relation(&format!("{}.{name}", world.slots[slot].name), values)
        });
        let reads: Vec<String> = reads.collect();
        let always = if part.holds { "always" } else { "never" };
        let why = if reads.is_empty() { String::new() } else { format!(": {}", reads.join(", ")) };
        let reason = format!("`{text}` {always} holds{why}");
        if !out.contains(&reason) {
            out.push(reason);
        }
    }
    out
}

fn entity<'p>(program: &'p Program, world: &World, slot: crate::ir::SlotId) -> &'p Entity {
    &program.entities[world.slots[slot].entity]
}

/// Whether a run ends where a player leaves its space, which a proof takes for granted.
pub(super) fn is_bounded(world: &World) -> bool {
    !world.players.is_empty() && world.spaces.iter().any(|s| s.bounds.is_some())
}

//! Why a predicate of a world holds in no state: the parts of it that decide this, with the values that they read.

use crate::ir::{DiscreteId, Entity, Expr, ExprId, Extremes, Program, SlotId, Subject, TimerId, VarId, World, WorldId};
use crate::ordered::Ordered;
use crate::source::{SourceMap, code_on_one_line};

use super::wording::relation;
use super::{ConfigurationSpace, Interval, SlotSpace, Values};

/// A number of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A continuous variable or a derivative.
    Var(SlotId, VarId, u8),
    /// A discrete variable.
    Discrete(SlotId, DiscreteId),
    /// A timer's count.
    Timer(SlotId, TimerId),
}

/// A part of a predicate.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The expression.
    pub predicate: ExprId,
    /// Its constant truth value.
    pub holds: bool,
    /// The variables that it reads, with all their values.
    pub reads: Vec<(Quantity, Values)>,
}

/// The parts because of which a predicate holds in no state of a configuration space; each would need the opposite truth
/// value. `None` if it can hold.
pub fn never_holds(
    program: &Program,
    world: WorldId,
    predicate: ExprId,
    space: &ConfigurationSpace,
) -> Option<Vec<Part>> {
    let prover = Prover { program, world, space };
    if prover.can(predicate, true) {
        return None;
    }
    let mut parts = Vec::new();
    prover.explain(predicate, true, &mut parts);
    Some(parts)
}

impl Part {
    /// The part and the values that it reads, as a sentence: ``` `hero.y > 140` never holds: hero.y in [0, 64] ```.
    pub fn sentence(&self, sources: &SourceMap, program: &Program, world: &World) -> String {
        let text = code_on_one_line(sources.slice(program.spans.exprs[self.predicate]));
        let entity = |slot: SlotId| -> &Entity { &program.entities[world.slots[slot].entity] };
        let reads = self.reads.iter().map(|(quantity, values)| {
            let (slot, name) = match *quantity {
                Quantity::Var(slot, var, degree) => (slot, entity(slot).variable_text(var, degree)),
                Quantity::Discrete(slot, id) => (slot, entity(slot).discretes[id].name.clone()),
                Quantity::Timer(slot, id) => (slot, id.to_string()),
            };
            relation(&format!("{}.{name}", world.slots[slot].name), values)
        });
        let reads: Vec<String> = reads.collect();
        let always = if self.holds { "always" } else { "never" };
        let why = if reads.is_empty() { String::new() } else { format!(": {}", reads.join(", ")) };
        format!("`{text}` {always} holds{why}")
    }
}

struct Prover<'a> {
    program: &'a Program,
    world: WorldId,
    space: &'a ConfigurationSpace,
}

impl Prover<'_> {
    fn can(&self, id: ExprId, holds: bool) -> bool {
        self.space.can_evaluate_to(self.program, self.world, id, holds)
    }

    /// Collects the parts because of which an expression cannot have the wanted truth value.
    fn explain(&self, id: ExprId, wanted: bool, parts: &mut Vec<Part>) {
        match (self.program.exprs[id], wanted) {
            (Expr::Not(a), _) => self.explain(a, !wanted, parts),
            // Both are needed: one impossible part is enough.
            (Expr::And(a, b), true) | (Expr::Or(a, b), false) => {
                match [a, b].into_iter().find(|part| !self.can(*part, wanted)) {
                    Some(part) => self.explain(part, wanted, parts),
                    None => parts.push(self.part(id, wanted)),
                }
            }
            (Expr::And(a, b), false) | (Expr::Or(a, b), true) => {
                self.explain(a, wanted, parts);
                self.explain(b, wanted, parts);
            }
            _ => parts.push(self.part(id, wanted)),
        }
    }

    fn part(&self, predicate: ExprId, wanted: bool) -> Part {
        let mut quantities = Vec::new();
        self.reads(predicate, &mut quantities);
        let reads = quantities.into_iter().filter_map(|q| Some((q, self.values(q)?))).collect();
        Part { predicate, holds: !wanted, reads }
    }

    /// The variables of instances that an expression reads, without duplicates.
    fn reads(&self, id: ExprId, out: &mut Vec<Quantity>) {
        let mut add = |quantity: Quantity| {
            if !out.contains(&quantity) {
                out.push(quantity);
            }
        };
        match self.program.exprs[id] {
            Expr::Var(Subject::Slot(slot), var, degree) => add(Quantity::Var(slot, var, degree)),
            Expr::Discrete(Subject::Slot(slot), discrete) => add(Quantity::Discrete(slot, discrete)),
            Expr::Near { of, x, y, radius } => {
                if let Subject::Slot(slot) = of {
                    add(Quantity::Var(slot, VarId::X, 0));
                    add(Quantity::Var(slot, VarId::Y, 0));
                }
                [x, y, radius].into_iter().for_each(|id| self.reads(id, out));
            }
            Expr::Negate(a) | Expr::Not(a) => self.reads(a, out),
            Expr::Arithmetic(_, a, b) | Expr::Compare(_, a, b) | Expr::And(a, b) | Expr::Or(a, b) => {
                self.reads(a, out);
                self.reads(b, out);
            }
            Expr::Call(_, arguments) => arguments.into_iter().for_each(|id| self.reads(id, out)),
            _ => {}
        }
    }

    /// All values of a variable; `None` if unknown.
    fn values(&self, quantity: Quantity) -> Option<Values> {
        let of =
            |slot: SlotId| -> Option<&SlotSpace> { Some(&self.space.finest().slots[slot]).filter(|s| !s.is_given_up) };
        let mut all: Vec<Interval> = Vec::new();
        let slot = match quantity {
            Quantity::Var(slot, ..) | Quantity::Discrete(slot, _) | Quantity::Timer(slot, _) => of(slot)?,
        };
        for at in &slot.configurations {
            match quantity {
                Quantity::Var(_, var, degree) => all.extend(at.vars[var][usize::from(degree)].intervals()),
                Quantity::Discrete(_, id) => all.extend(at.discretes[id].intervals()),
                Quantity::Timer(_, id) => all.push(at.timers[id]),
            }
        }
        if matches!(quantity, Quantity::Discrete(..)) {
            all = joined(all);
        }
        Some(Values::any(all))
    }
}

/// Intervals of whole numbers, neighbours as one: 0 and \[1, 12\] are \[0, 12\]. Single numbers stay apart: {0, 1}.
fn joined(mut all: Vec<Interval>) -> Vec<Interval> {
    all.order_by(|a, b| a.low.total_cmp(&b.low));
    let mut out: Vec<Interval> = Vec::new();
    for next in all {
        match out.last_mut() {
            Some(last) if next.low <= last.high + 1.0 && !(last.is_point() && next.is_point()) => {
                last.high = last.high.greatest(next.high)
            }
            _ => out.push(next),
        }
    }
    out
}

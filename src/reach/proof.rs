//! Why a goal cannot be reached: the parts of its predicate that hold in no state that the world can be in, with what
//! they read.

use crate::analysis::{ConfigurationSpace, Interval, SlotSpace, Values};
use crate::ir::{Expr, ExprId, SlotId, Subject, VarId};

use super::metric::Quantity;
use super::problem::{Problem, Target};

/// The argument that a goal cannot be reached; each of its parts would have to turn out otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// The parts of the goal's predicate.
    pub parts: Vec<Part>,
}

/// A part of a predicate.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The expression.
    pub predicate: ExprId,
    /// How it always turns out.
    pub holds: bool,
    /// The numbers that it reads of instances, with all that they can be.
    pub reads: Vec<(Quantity, Values)>,
}

impl Proof {
    /// Whether the analysis shows that the goal holds in no state, and why.
    pub fn of(problem: &Problem<'_>, space: &ConfigurationSpace) -> Option<Proof> {
        let (program, world) = (problem.sim.program(), problem.sim.world_id());
        // A `never` is looked at out of bounds, too, of which the analysis says nothing.
        let Target::Goal(goal) = problem.target else { return None };
        if space.can_hold(program, world, goal) {
            return None;
        }
        let mut proof = Proof { parts: Vec::new() };
        let prover = Prover { problem, space };
        prover.explain(problem.predicate(), true, &mut proof.parts);
        Some(proof)
    }
}

struct Prover<'a> {
    problem: &'a Problem<'a>,
    space: &'a ConfigurationSpace,
}

impl Prover<'_> {
    fn can(&self, id: ExprId, holds: bool) -> bool {
        self.space.can_turn_out(self.problem.sim.program(), self.problem.sim.world_id(), id, holds)
    }

    /// The parts for which an expression cannot turn out as wished.
    fn explain(&self, id: ExprId, wished: bool, parts: &mut Vec<Part>) {
        match (self.problem.sim.program().exprs[id], wished) {
            (Expr::Not(a), _) => self.explain(a, !wished, parts),
            // Both would have to: one that cannot is enough.
            (Expr::And(a, b), true) | (Expr::Or(a, b), false) => {
                match [a, b].into_iter().find(|part| !self.can(*part, wished)) {
                    Some(part) => self.explain(part, wished, parts),
                    None => parts.push(self.part(id, wished)),
                }
            }
            (Expr::And(a, b), false) | (Expr::Or(a, b), true) => {
                self.explain(a, wished, parts);
                self.explain(b, wished, parts);
            }
            _ => parts.push(self.part(id, wished)),
        }
    }

    fn part(&self, predicate: ExprId, wished: bool) -> Part {
        let mut quantities = Vec::new();
        self.reads(predicate, &mut quantities);
        let reads = quantities.into_iter().filter_map(|q| Some((q, self.values(q)?))).collect();
        Part { predicate, holds: !wished, reads }
    }

    /// The variables of instances that an expression reads, each once.
    fn reads(&self, id: ExprId, out: &mut Vec<Quantity>) {
        let mut add = |quantity: Quantity| {
            if !out.contains(&quantity) {
                out.push(quantity);
            }
        };
        match self.problem.sim.program().exprs[id] {
            Expr::Var(Subject::Slot(slot), var, degree) => add(Quantity::Var(slot, var, degree)),
            Expr::Discrete(Subject::Slot(slot), discrete) => add(Quantity::Discrete(slot, discrete)),
            Expr::Near { of, x, y, radius } => {
                if let Subject::Slot(slot) = of {
                    add(Quantity::Var(slot, VarId(0), 0));
                    add(Quantity::Var(slot, VarId(1), 0));
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

    /// All that a variable can be; none where nothing is known.
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
        Some(Values::any(all))
    }
}

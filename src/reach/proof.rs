//! Explains why a goal cannot be reached: the parts of its predicate that hold in no state of the configuration space,
//! with the values that they read.

use crate::analysis::{ConfigurationSpace, Interval, SlotSpace, Values};
use crate::ir::{Expr, ExprId, SlotId, Subject, VarId};
use crate::sim::Fault;
use crate::watch::Watch;

use super::metric::Quantity;
use super::problem::{Problem, Target};

/// The argument that a goal cannot be reached; each part would need the opposite truth value.
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
    /// Its constant truth value.
    pub holds: bool,
    /// The variables that it reads, with all their values.
    pub reads: Vec<(Quantity, Values)>,
}

impl Proof {
    /// A proof from the analysis that the target holds in no state, if there is one. A `never` also counts in the state
    /// in which a run ends, so its space must contain those states.
    pub fn of(problem: &Problem<'_>, space: &ConfigurationSpace) -> Option<Proof> {
        let (program, world) = (problem.sim.program(), problem.sim.world_id());
        if space.can_evaluate_to(program, world, problem.predicate(), true) {
            return None;
        }
        let mut proof = Proof { parts: Vec::new() };
        let prover = Prover { problem, space };
        prover.explain(problem.predicate(), true, &mut proof.parts);
        Some(proof)
    }
}

/// A goal that is too far away for the time limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooFar {
    /// The player that would have to reach it.
    pub player: SlotId,
    /// The positions that it can have by then, per axis.
    pub within: [Interval; 2],
    /// A lower bound of the number of steps.
    pub least: u64,
}

/// Upper limit of the search for the lower bound.
const MAX_STEPS: u64 = 1 << 32;

impl TooFar {
    /// A proof that no player can be where the goal holds within the time limit, if there is one.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule.
    pub fn of(problem: &Problem<'_>, space: &ConfigurationSpace, watch: &dyn Watch) -> Result<Option<TooFar>, Fault> {
        let (Some(time), Target::Goal(_)) = (problem.time(), problem.target) else { return Ok(None) };
        let Some(starts) = problem.starts(watch)? else { return Ok(None) };
        let (sim, predicate) = (problem.sim, problem.predicate());
        let within = |player: SlotId, state: &[u8], steps: u64| {
            let (x, y) = sim.position(state, player);
            space.within_steps(sim.program(), sim.world_id(), player, [x, y], steps)
        };
        // Whether the goal can hold within a number of steps, judging by one player.
        let can = |player: SlotId, steps: u64| {
            starts.iter().any(|start| {
                within(player, &start.state, steps).is_none_or(|part| {
                    let part = (player, sim.space(&start.state, player), part);
                    space.can_hold_in(sim.program(), sim.world_id(), predicate, part)
                })
            })
        };
        let time = u64::from(time);
        let found = problem.players().iter().find(|player| !can(**player, time)).map(|&player| {
            let (mut low, mut high) = (time, time.saturating_mul(2).max(1));
            while high < MAX_STEPS && !can(player, high) {
                (low, high) = (high, high * 2);
            }
            // It cannot hold after `low` steps; after `high` it may.
            while low + 1 < high {
                let middle = low.midpoint(high);
                if can(player, middle) { high = middle } else { low = middle }
            }
            let parts = starts.iter().filter_map(|start| within(player, &start.state, time));
            let hull = parts.reduce(|a, b| [a[0].or(b[0]), a[1].or(b[1])]);
            TooFar { player, within: hull.unwrap_or([Interval::ALL; 2]), least: low + 1 }
        });
        Ok(found)
    }
}

struct Prover<'a> {
    problem: &'a Problem<'a>,
    space: &'a ConfigurationSpace,
}

impl Prover<'_> {
    fn can(&self, id: ExprId, holds: bool) -> bool {
        self.space.can_evaluate_to(self.problem.sim.program(), self.problem.sim.world_id(), id, holds)
    }

    /// Collects the parts because of which an expression cannot have the wanted truth value.
    fn explain(&self, id: ExprId, wanted: bool, parts: &mut Vec<Part>) {
        match (self.problem.sim.program().exprs[id], wanted) {
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
        match self.problem.sim.program().exprs[id] {
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
        Some(Values::any(all))
    }
}

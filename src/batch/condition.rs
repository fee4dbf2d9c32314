//! Predicates that end the runs of a batch, as they are decided for each row after each step. The frequent forms are read
//! from the state at once; all others are evaluated as everywhere. Both have the same answer, bit for bit.

use crate::ir::{CompareOp, Expr, ExprId, Program, SlotId, Subject, VarId, compare};
use crate::sim::{Fault, Simulator};

/// A predicate of a world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// `hero.y < 0`: a variable of a named instance beside a number.
    Variable { slot: SlotId, var: VarId, degree: u8, op: CompareOp, bound: f64 },
    /// `near(hero, (416, 48), 16)`, of a named instance.
    Near { slot: SlotId, at: (f64, f64), radius: f64 },
    /// Any other.
    Other(ExprId),
}

impl Condition {
    /// The condition of an expression of a world.
    pub fn new(program: &Program, holds: ExprId) -> Condition {
        let number = |id: ExprId| match program.exprs[id] {
            Expr::Number(number) => Some(number),
            _ => None,
        };
        let found = match program.exprs[holds] {
            Expr::Compare(op, a, b) => match (&program.exprs[a], number(b)) {
                (&Expr::Var(Subject::Slot(slot), var, degree), Some(bound)) => {
                    Some(Condition::Variable { slot, var, degree, op, bound })
                }
                _ => None,
            },
            Expr::Near { of: Subject::Slot(slot), x, y, radius } => match (number(x), number(y), number(radius)) {
                (Some(x), Some(y), Some(radius)) => Some(Condition::Near { slot, at: (x, y), radius }),
                _ => None,
            },
            _ => None,
        };
        found.unwrap_or(Condition::Other(holds))
    }

    /// Whether it holds in a state.
    ///
    /// # Errors
    /// A [`Fault`] if its evaluation breaks a rule.
    #[inline]
    pub fn holds(&self, sim: &Simulator, state: &[u8]) -> Result<bool, Fault> {
        match *self {
            Condition::Variable { slot, var, degree, op, bound } => {
                Ok(compare(op, sim.world().layout.slots[slot].var(state, var, degree), bound))
            }
            Condition::Near { slot, at, radius } => Ok(sim.distance(state, slot, at) <= radius),
            Condition::Other(holds) => sim.holds(state, holds),
        }
    }
}

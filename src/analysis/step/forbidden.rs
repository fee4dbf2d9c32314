//! Predicates that never hold: a search ends where a `never` holds, and so does the analysis. Each configuration is
//! restricted by those parts of a predicate that concern its own instance.

use crate::ir::{CompareOp, Expr, ExprId, IdVec, Program, SlotId, Subject, World};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Values;
use crate::analysis::step::refine::restrict_by;

/// Predicates of a world that hold in no state.
#[derive(Debug, Clone, Copy)]
pub(in crate::analysis) struct Forbidden<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub predicates: &'a [ExprId],
}

impl Forbidden<'_> {
    /// Restricts a configuration to where none of the predicates holds; returns whether anything is left.
    pub fn cut(&self, slot: SlotId, at: &mut Configuration) -> bool {
        self.predicates.iter().all(|predicate| self.assume(slot, at, *predicate, false)) && !at.is_impossible()
    }

    /// Refines by an expression that holds (or fails); returns whether it can.
    fn assume(&self, slot: SlotId, at: &mut Configuration, id: ExprId, holds: bool) -> bool {
        let is_mine = |of: Subject| of == Subject::Slot(slot);
        match (self.program.exprs[id], holds) {
            (Expr::Bool(b), _) => b == holds,
            (Expr::Not(a), _) => self.assume(slot, at, a, !holds),
            (Expr::And(a, b), true) | (Expr::Or(a, b), false) => {
                self.assume(slot, at, a, holds) && self.assume(slot, at, b, holds)
            }
            // One of them decides: if one cannot, the other does.
            (Expr::And(a, b), false) | (Expr::Or(a, b), true) => {
                let with = |part: ExprId| {
                    let mut at = at.clone();
                    (self.assume(slot, &mut at, part, holds) && !at.is_impossible()).then_some(at)
                };
                match (with(a), with(b)) {
                    (Some(first), Some(second)) => *at = first.or(&second),
                    (Some(only), None) | (None, Some(only)) => *at = only,
                    (None, None) => return false,
                }
                true
            }
            (Expr::Alive(of), _) if of == slot => holds,
            (Expr::InMode(of, mode), _) if is_mine(of) => {
                let entity = &self.program.entities[self.world.slots[slot].entity];
                let inside = entity.modes[mode].leaves;
                at.leaves.iter().any(|leaf| inside.contains(*leaf)) == holds
            }
            (Expr::Compare(op, a, b), _) => {
                let op = if holds { op } else { op.negated() };
                self.compare(slot, at, a, op, b) && self.compare(slot, at, b, op.mirrored(), a)
            }
            _ => true,
        }
    }

    /// Restricts the number on one side of a comparison, if it belongs to the instance and the other side is constant.
    fn compare(&self, slot: SlotId, at: &mut Configuration, id: ExprId, op: CompareOp, with: ExprId) -> bool {
        let Some(x) = self.program.constant(with, &IdVec::new(), self.world.step) else { return true };
        let cut = |values: &Values, whole: bool| restrict_by(values, op, &Values::point(x), whole);
        match self.program.exprs[id] {
            Expr::Var(Subject::Slot(of), var, degree) if of == slot => {
                let degree = usize::from(degree);
                at.set(var, degree, cut(&at.vars[var][degree], false));
            }
            Expr::Discrete(Subject::Slot(of), discrete) if of == slot => {
                at.set_discrete(discrete, cut(&at.discretes[discrete], true));
            }
            _ => {}
        }
        !at.is_impossible()
    }
}

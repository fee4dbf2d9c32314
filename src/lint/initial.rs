//! What a guard is worth in the first state of an instance, where its modes and values tell.

use crate::ir::{ModeId, Subject, compare};
use crate::sema::checked::{Entity, Instance, Term, TermKind};
use crate::sema::{ConstantContext, evaluate};

/// An instance as it is placed.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a> {
    pub entity: &'a Entity,
    pub instance: &'a Instance,
    pub context: ConstantContext<'a>,
}

impl Placed<'_> {
    /// Whether a guard holds; none if that depends on more than modes, values and constants.
    pub fn holds(self, term: &Term) -> Option<bool> {
        match &term.kind {
            TermKind::Not(operand) => self.holds(operand).map(|held| !held),
            TermKind::And(operands) => self.joined(operands, false),
            TermKind::Or(operands) => self.joined(operands, true),
            TermKind::InMode(Subject::Me, mode) => self.is_in(*mode),
            TermKind::Compare(op, operands) => {
                let [a, b] = operands.each_ref().map(|operand| self.number(operand));
                Some(compare(*op, a?, b?))
            }
            _ => self.number(term).map(|value| value != 0.0),
        }
    }

    /// Of two operands, `decides` if one of them is that.
    fn joined(self, operands: &[Term; 2], decides: bool) -> Option<bool> {
        let held = operands.each_ref().map(|operand| self.holds(operand));
        if held.contains(&Some(decides)) { Some(decides) } else { held[0].and(held[1]) }
    }

    fn number(self, term: &Term) -> Option<f64> {
        match term.kind {
            TermKind::Discrete(Subject::Me, id) => Some(f64::from(self.instance.discretes[id])),
            TermKind::Var(Subject::Me, var, degree) => Some(self.instance.vars[var][usize::from(degree)]),
            _ => evaluate(term, self.context).ok(),
        }
    }

    /// Whether a mode is active: among its siblings, and each mode around it among its own.
    fn is_in(self, mode: ModeId) -> Option<bool> {
        let mut at = Some(mode);
        while let Some(mode) = at {
            if self.first_of(self.entity.siblings(mode))? != mode {
                return Some(false);
            }
            at = self.entity.modes[mode].parent;
        }
        Some(true)
    }

    /// The initial one of some siblings: the first whose `initial when` holds, else the default one.
    fn first_of(self, siblings: &[ModeId]) -> Option<ModeId> {
        for &mode in siblings {
            if let Some(guard) = &self.entity.modes[mode].initial_when
                && evaluate(guard, self.context).ok()? != 0.0
            {
                return Some(mode);
            }
        }
        self.entity.default_mode(siblings)
    }
}

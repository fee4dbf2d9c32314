//! Syntactic implications of guards: whether one always or never holds, implies another, excludes another.

use crate::ir::{CompareOp, ModeId, Press, Subject};

use std::cell::Cell;

use crate::sema::checked::{Entity, Term, TermKind};

use super::range::{Range, fact, facts, range};
use super::terms::same;

/// Maximum number of pairs of terms that are compared before a query is left undecided.
const MAX_COMPARISONS: u32 = 2_000;

/// Maximum number of conjuncts that are compared with each other.
const MAX_FACTS: usize = 64;

/// The constant value of a guard; none if it is not constant.
pub(super) fn truth(entity: &Entity, guard: &Term) -> Option<bool> {
    match &guard.kind {
        TermKind::Bool(b) => Some(*b),
        TermKind::Not(a) => truth(entity, a).map(|b| !b),
        TermKind::And(..) => {
            let parts = conjuncts(guard);
            let truths = || parts.iter().map(|part| truth(entity, part));
            if truths().any(|t| t == Some(false)) {
                Some(false)
            } else if truths().all(|t| t == Some(true)) {
                Some(true)
            } else {
                contradictory(entity, guard).then_some(false)
            }
        }
        TermKind::Or(sides) => match sides.each_ref().map(|side| truth(entity, side)) {
            [Some(true), _] | [_, Some(true)] => Some(true),
            [Some(false), Some(false)] => Some(false),
            _ => None,
        },
        TermKind::Compare(op, sides) => {
            let [a, b] = sides.as_ref();
            if same(a, b) {
                return Some(matches!(op, CompareOp::Equal | CompareOp::AtMost | CompareOp::AtLeast));
            }
            compared(*op, range(entity, a, &[]), range(entity, b, &[]))
        }
        _ => None,
    }
}

/// The conjuncts of a guard.
fn conjuncts(guard: &Term) -> Vec<&Term> {
    let mut parts = Vec::new();
    let mut open = vec![guard];
    while let Some(term) = open.pop() {
        match &term.kind {
            TermKind::And(sides) => open.extend(sides.iter()),
            _ => parts.push(term),
        }
    }
    parts
}

fn compared(op: CompareOp, a: Range, b: Range) -> Option<bool> {
    let less = |a: Range, b: Range| a.high < b.low || (a.high == b.low && (a.below || b.above));
    let at_most = |a: Range, b: Range| a.high <= b.low;
    match op {
        _ if a.is_empty() || b.is_empty() => None,
        CompareOp::Less if less(a, b) => Some(true),
        CompareOp::Less if at_most(b, a) => Some(false),
        CompareOp::AtMost if at_most(a, b) => Some(true),
        CompareOp::AtMost if less(b, a) => Some(false),
        CompareOp::Greater => compared(CompareOp::Less, b, a),
        CompareOp::AtLeast => compared(CompareOp::AtMost, b, a),
        CompareOp::Equal if a.and(b).is_empty() => Some(false),
        CompareOp::Equal if a == b && a.low == a.high => Some(true),
        CompareOp::Unequal => compared(CompareOp::Equal, a, b).map(|b| !b),
        _ => None,
    }
}

/// Whether the conjuncts leave no value for some number.
fn contradictory(entity: &Entity, guard: &Term) -> bool {
    let mut facts = facts(entity, guard);
    facts.truncate(MAX_FACTS);
    facts.len() >= 2 && facts.iter().any(|f| range(entity, f.of, &facts).is_empty())
}

/// The first of some guards that `a` implies. None of the guards is constantly false.
pub(super) fn implied<'t, K>(entity: &Entity, a: &Term, guards: impl IntoIterator<Item = (K, &'t Term)>) -> Option<K> {
    // Long guards have many pairs: all of them share one budget.
    let comparison = GuardComparison { entity, budget: Cell::new(2 * MAX_COMPARISONS) };
    guards.into_iter().find(|(_, b)| comparison.implies(a, b)).map(|(key, _)| key)
}

/// Whether two guards exclude each other.
pub(super) fn exclusive(entity: &Entity, a: &Term, b: &Term) -> bool {
    GuardComparison { entity, budget: Cell::new(MAX_COMPARISONS) }.exclusive(a, b)
}

/// A comparison of two guards of an entity, with a budget.
struct GuardComparison<'a> {
    entity: &'a Entity,
    budget: Cell<u32>,
}

impl GuardComparison<'_> {
    fn is_exhausted(&self) -> bool {
        let left = self.budget.get();
        self.budget.set(left.saturating_sub(1));
        left == 0
    }

    fn implies(&self, a: &Term, b: &Term) -> bool {
        if self.is_exhausted() {
            return false;
        }
        if same(a, b) {
            return true;
        }
        match (&a.kind, &b.kind) {
            (TermKind::Or(parts), _) => parts.iter().all(|part| self.is_false(part) || self.implies(part, b)),
            (_, TermKind::And(parts)) => parts.iter().all(|part| self.implies(a, part)),
            (TermKind::And(parts), _) if parts.iter().any(|part| self.implies(part, b)) => true,
            (_, TermKind::Or(parts)) => parts.iter().any(|part| self.implies(a, part)),
            // Its parts were already compared.
            (TermKind::And(..), _) => false,
            _ if truth(self.entity, b) == Some(true) || self.is_false(a) => true,
            (TermKind::Not(x), TermKind::Not(y)) => self.implies(y, x),
            _ => self.atom_implies(a, b),
        }
    }

    fn is_false(&self, guard: &Term) -> bool {
        truth(self.entity, guard) == Some(false)
    }

    fn atom_implies(&self, a: &Term, b: &Term) -> bool {
        if let (Some(f), Some(g)) = (fact(self.entity, a), fact(self.entity, b))
            && same(f.of, g.of)
        {
            return f.range.is_within(g.range);
        }
        match (&a.kind, &b.kind) {
            (TermKind::Button(Press::Pressed, x), TermKind::Button(Press::Held, y)) => x == y,
            (TermKind::Touching(a), TermKind::Touching(b)) => {
                b.bound.is_none()
                    && (a.of, a.other) == (b.of, b.other)
                    && (b.mine.is_none() || a.mine == b.mine)
                    && (b.side.is_none() || a.side == b.side)
            }
            (TermKind::InMode(Subject::Me, inner), TermKind::InMode(Subject::Me, outer)) => self.is_in(*inner, *outer),
            _ => false,
        }
    }

    fn exclusive(&self, a: &Term, b: &Term) -> bool {
        if self.is_exhausted() {
            return false;
        }
        if truth(self.entity, a) == Some(false) || truth(self.entity, b) == Some(false) {
            return true;
        }
        match (&a.kind, &b.kind) {
            (TermKind::Or(parts), _) => parts.iter().all(|part| self.exclusive(part, b)),
            (_, TermKind::Or(parts)) => parts.iter().all(|part| self.exclusive(a, part)),
            (TermKind::And(parts), _) => parts.iter().any(|part| self.exclusive(part, b)),
            (_, TermKind::And(parts)) => parts.iter().any(|part| self.exclusive(a, part)),
            (TermKind::Not(x), _) if self.implies(b, x) => true,
            (_, TermKind::Not(y)) if self.implies(a, y) => true,
            (TermKind::InMode(Subject::Me, m), TermKind::InMode(Subject::Me, n)) => {
                self.entity.modes[*m].group == self.entity.modes[*n].group && !self.is_in(*m, *n) && !self.is_in(*n, *m)
            }
            (TermKind::Button(p, x), TermKind::Button(q, y)) => {
                x == y && p != q && (*p == Press::Released || *q == Press::Released)
            }
            (TermKind::Is(of, entity), TermKind::Is(of_b, entity_b)) => of == of_b && entity != entity_b,
            _ => match (fact(self.entity, a), fact(self.entity, b)) {
                (Some(f), Some(g)) => same(f.of, g.of) && f.range.and(g.range).is_empty(),
                _ => false,
            },
        }
    }

    /// Whether a mode is equal to or inside another one.
    fn is_in(&self, inner: ModeId, outer: ModeId) -> bool {
        is_in(self.entity, inner, outer)
    }
}

/// Whether a mode is equal to or inside another one.
pub(super) fn is_in(entity: &Entity, inner: ModeId, outer: ModeId) -> bool {
    let mut around = Some(inner);
    while let Some(mode) = around {
        if mode == outer {
            return true;
        }
        around = entity.modes[mode].parent;
    }
    false
}

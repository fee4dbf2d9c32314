//! Operators: arithmetic, `and` and `or`, comparisons and their chains.

use crate::diagnostic::catalogue::types::BadChain;
use crate::ir::Arithmetic;
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, CompareOp, Expr, ExprKind};

use super::Checker;
use super::checked::{Term, TermKind, Type};
use super::expression::Scope;

/// Arithmetic on two numbers, if the operator is one of it; whole if both are and nothing is divided.
pub(super) fn arithmetic(op: BinaryOp, sides: [Term; 2], span: Span) -> Option<Term> {
    let arithmetic = match op {
        BinaryOp::Add => Arithmetic::Add,
        BinaryOp::Subtract => Arithmetic::Subtract,
        BinaryOp::Multiply => Arithmetic::Multiply,
        BinaryOp::Divide => Arithmetic::Divide,
        BinaryOp::And | BinaryOp::Or => return None,
    };
    let is_whole = sides.iter().all(|side| side.ty == Type::Int) && op != BinaryOp::Divide;
    let ty = if is_whole { Type::Int } else { Type::Real };
    Some(Term { kind: TermKind::Arithmetic(arithmetic, Box::new(sides)), ty, span })
}

impl Checker<'_> {
    /// A binary operator; of `and` and `or`, the right side knows what the left one tests.
    pub(super) fn binary(&mut self, op: BinaryOp, a: &Expr, b: &Expr, span: Span, scope: &Scope<'_>) -> Option<Term> {
        if matches!(op, BinaryOp::And | BinaryOp::Or) {
            // Both sides are checked, so that errors in both are reported.
            let a = self.guard(a, scope);
            let mark = self.facts.mark();
            if let Some(a) = &a {
                self.facts.learn(a, op == BinaryOp::And);
            }
            let b = self.guard(b, scope);
            if !self.facts.bindable {
                self.facts.forget(mark);
            }
            let sides = Box::new([a?, b?]);
            let kind = if op == BinaryOp::And { TermKind::And(sides) } else { TermKind::Or(sides) };
            return Some(Term { kind, ty: Type::Bool, span });
        }
        let (a, b) = (self.number(a, scope), self.number(b, scope));
        arithmetic(op, [a?, b?], span)
    }

    /// A comparison, or a chain of them in one direction.
    pub(super) fn comparison(
        &mut self,
        first: &Expr,
        rest: &[(CompareOp, Expr)],
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Term> {
        let up = |op: &CompareOp| matches!(op, CompareOp::Less | CompareOp::AtMost | CompareOp::Equal);
        let down = |op: &CompareOp| matches!(op, CompareOp::Greater | CompareOp::AtLeast | CompareOp::Equal);
        let one_way = rest.iter().all(|(op, _)| up(op)) || rest.iter().all(|(op, _)| down(op));
        if rest.len() > 1 && !one_way {
            let operands: Vec<Span> =
                std::iter::once(first).chain(rest.iter().map(|(_, e)| e)).map(|e| e.span).collect();
            let links = operands.windows(2).map(|pair| pair[0].to(pair[1])).collect();
            self.diagnostics.report(BadChain { at: span, links });
            return None;
        }
        let mut left = first;
        let mut chain: Option<Term> = None;
        for (op, right) in rest {
            let link = self.compare(*op, left, right, scope)?;
            chain = Some(match chain {
                None => link,
                Some(before) => Term { kind: TermKind::And(Box::new([before, link])), ty: Type::Bool, span },
            });
            left = right;
        }
        chain
    }

    /// One comparison.
    pub(super) fn compare(&mut self, op: CompareOp, left: &Expr, right: &Expr, scope: &Scope<'_>) -> Option<Term> {
        let span = left.span.to(right.span);
        let equality = matches!(op, CompareOp::Equal | CompareOp::Unequal);
        // The type of one side helps to resolve the other: `facing == left`, `left == facing`.
        let hint = self.set_type(left, scope).or_else(|| self.set_type(right, scope));
        let (a, b) = match (&hint, equality) {
            (Some(ty), true) => {
                let (a, b) = (self.typed(left, scope, ty), self.typed(right, scope, ty));
                (a?, b?)
            }
            _ => {
                let a = self.value(left, scope);
                let b = self.value(right, scope);
                let (a, b) = (a?, b?);
                if equality && a.ty == Type::Bool {
                    (a, self.expect(b, &Type::Bool)?)
                } else {
                    (self.expect(a, &Type::Real)?, self.expect(b, &Type::Real)?)
                }
            }
        };
        let compared = Term { kind: TermKind::Compare(op.into(), Box::new([a, b])), ty: Type::Bool, span };
        Some(if scope.world.is_some() { super::predicate::while_alive(compared) } else { compared })
    }

    /// The type of a plain discrete variable that ranges over a set.
    fn set_type(&self, e: &Expr, scope: &Scope<'_>) -> Option<Type> {
        let path = match &e.kind {
            ExprKind::Name(..) | ExprKind::Path(_) => e.path()?,
            ExprKind::Paren(inner) => return self.set_type(inner, scope),
            ExprKind::Each(each) => {
                let [_, name] = &*each.path.view().segments else { return None };
                let entity = &self.checked.entities[self.facts.member?];
                let ty = entity.discretes[entity.discretes.find(|d| d.name.text == name.text)?].ty;
                return matches!(ty, Type::Set(_)).then_some(ty);
            }
            ExprKind::Call(call) if call.function.text == "if" => {
                return call.arguments.iter().skip(1).find_map(|a| self.set_type(a, scope));
            }
            _ => return None,
        };
        let ty = match (&*path.segments, scope.world) {
            ([name], _) => {
                let id = *scope.names?.discretes.get(&name.text)?;
                &scope.entity?.discretes[id].ty
            }
            ([instance, name], world) => {
                let entity = match world {
                    Some(world) => world.instance(&instance.text)?.1,
                    None => self.referred(&instance.text, scope)?.1?,
                };
                let entity = &self.checked.entities[entity];
                &entity.discretes[entity.discretes.find(|d| d.name.text == name.text)?].ty
            }
            _ => return None,
        };
        matches!(ty, Type::Set(_)).then_some(*ty)
    }
}

//! Members of entities and modes: colliders, clamps, flows.

use crate::diagnostic::catalogue::structure::BadCollider;
use crate::diagnostic::catalogue::types::{TypeMismatch, WrongArguments};
use crate::ir::VarId;
use crate::syntax::ast;
use crate::syntax::occurrence::Role;

use super::Checker;
use super::checked::{Clamp, Collider, Drive, DriveBy, Given, Shape, Term};
use super::constant::{ConstantContext, evaluate};
use super::expression::{ReadLimit, Scope};
use super::foreign::rate;
use super::names::unknown;

impl Checker<'_> {
    pub(super) fn collider(&mut self, c: &ast::Collider, scope: &Scope<'_>) -> Option<Collider> {
        let scope = scope.reading(ReadLimit::State);
        let tags = c.tags.iter().map(|t| self.carried(t)).collect();
        let guard = c.guard.as_ref().map(|guard| self.guard(guard, &scope));
        let (count, usage) = match &*c.shape.text {
            "rect" => (4, "`rect(x, y, width, height)`"),
            "circle" => (3, "`circle(x, y, radius)`"),
            _ => {
                let fact = unknown("shape", &c.shape.text, c.shape.span, ["rect", "circle"]);
                self.report_unknown(fact);
                return None;
            }
        };
        if c.arguments.len() != count {
            self.diagnostics.report(WrongArguments { function: c.shape.text.to_string(), at: c.shape.span, usage });
            return None;
        }
        // If the guard tests a reference, the sizes may read it.
        let mark = self.facts.mark();
        if let Some(Some(guard)) = &guard {
            self.facts.learn(guard, true);
        }
        let numbers: Vec<Option<Term>> = c.arguments.iter().map(|a| self.number(a, &scope)).collect();
        self.facts.forget(mark);
        let mut numbers: Vec<Term> = numbers.into_iter().collect::<Option<_>>()?;
        let last = if count == 4 { numbers.pop() } else { None };
        let [x, y, size]: [Term; 3] = numbers.try_into().ok()?;
        let shape = match last {
            Some(height) => Shape::Rect([x, y, size, height]),
            None => Shape::Circle([x, y, size]),
        };
        for (term, what) in shape.sizes() {
            if let Ok(value) = evaluate(term, ConstantContext::LITERALS)
                && value <= 0.0
            {
                self.diagnostics.report(BadCollider { at: term.span, what, value, instance: None });
            }
        }
        let guard = match guard {
            Some(guard) => Some(guard?),
            None => None,
        };
        Some(Collider { tags, kinematic: c.kinematic, shape, guard, span: c.span })
    }

    /// `clamp y' in -200..200`
    pub(super) fn clamp(&mut self, c: &ast::Clamp, scope: &Scope<'_>) -> Option<Clamp> {
        let scope = scope.reading(ReadLimit::State);
        let target = self.controlled(&c.variable, &scope);
        let mut bound = |e: &Option<ast::Expr>| e.as_ref().map(|e| self.number(e, &scope));
        let (low, high) = (bound(&c.low), bound(&c.high));
        let (var, degree) = target?;
        if degree > 1 {
            self.diagnostics.report(TypeMismatch {
                at: c.variable.span,
                found: "an acceleration".into(),
                expected: "a position or a velocity".into(),
                help: Some("clamp the flow that gives it: `x'' = clamp(…, low, high)`".into()),
            });
            return None;
        }
        let flat = |bound: Option<Option<Term>>| match bound {
            Some(term) => term.map(Some),
            None => Some(None),
        };
        Some(Clamp { var, degree, low: flat(low)?, high: flat(high)?, span: c.span })
    }

    /// `x' = e`
    pub(super) fn flow(&mut self, flow: &ast::Assignment, scope: &Scope<'_>) -> Option<Drive> {
        let target = self.controlled(&flow.variable, scope);
        let value = self.number(&flow.value, scope);
        let (var, degree) = target?;
        Some(Drive { var, degree, by: DriveBy::Flow(value?), span: flow.span() })
    }

    /// The continuous variable that a flow or an envelope drives, and its degree.
    pub(super) fn controlled(&mut self, variable: &ast::Variable, scope: &Scope<'_>) -> Option<(VarId, u8)> {
        let names = scope.names?;
        let name = &variable.name();
        if let Some(&var) = names.vars.get(&name.text) {
            if let Some(entity) = scope.entity {
                self.record_value_use(entity, Given::Var(var, 0), name.span, Role::Written);
            }
            return Some((var, self.primes(variable)?));
        }
        let is_param = names.params.get(&name.text).is_some();
        if is_param || names.discretes.get(&name.text).is_some() {
            self.diagnostics.report(TypeMismatch {
                at: variable.span,
                found: if is_param { "a parameter" } else { "a discrete variable" }.into(),
                expected: "a continuous variable".into(),
                help: Some("only `x`, `y` and `continuous` variables flow".into()),
            });
            return None;
        }
        let fact =
            unknown("continuous variable", &name.text, name.span, names.vars.names()).suggestion(rate(&name.text));
        self.report_unknown(fact);
        if variable.primes == 0 {
            // `speed = 3` without `param`: one report is enough.
            self.poisoned_names.insert(name.text.to_string());
        }
        None
    }

    /// The degree of a variable on a left side.
    pub(super) fn primes(&mut self, variable: &ast::Variable) -> Option<u8> {
        self.degree(&variable.path())
    }
}

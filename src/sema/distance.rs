//! Distances: `near(hero, (x, y), 30)`, `distance(target)`. Both go by the shorter way where the space wraps.

use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::ir::{Subject, VarId};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind};

use super::Checker;
use super::checked::{Term, TermKind, Type};
use super::expression::{ReadLimit, Scope};

/// A position, and the reference that has to be asked whether it is none before the position is read.
struct Place {
    at: [Term; 2],
    tested: Option<Subject>,
}

impl Checker<'_> {
    /// `near(hero, (x, y), radius)`, `near(any Slime, self, radius)`
    pub(super) fn near(
        &mut self,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        let [subject, place, radius] = arguments else {
            let forms = match scope.entity {
                Some(_) => "`near(self, (x, y), radius)` or `near(reference, self, radius)`",
                None => "`near(instance, (x, y), radius)` or `near(instance, instance, radius)`",
            };
            wrong(self, forms);
            return None;
        };
        self.allow_inside(span, scope, ReadLimit::State, "`near`")?;
        let Place { at: [x, y], tested } = self.position(place, scope, true)?;
        let radius = self.number(radius, scope)?;
        let near = |of| TermKind::Near(Box::new((of, [x, y, radius])));
        let term = if scope.world.is_some() || matches!(subject.kind, ExprKind::Any(_) | ExprKind::All(_)) {
            self.relation(subject, span, scope, |_, of, _| Some(near(of)))?
        } else {
            let of = self.subject(subject, scope)?;
            Term { kind: near(of), ty: Type::Bool, span }
        };
        let Some(tested) = tested else { return Some(term) };
        let make = |kind| Term { kind, ty: Type::Bool, span };
        let is_there = make(TermKind::Not(Box::new(make(TermKind::IsNone(tested)))));
        Some(make(TermKind::And(Box::new([is_there, term]))))
    }

    /// `distance(target)`, `distance((x, y))` of the instance itself, `distance(hero, door)`
    pub(super) fn distance(
        &mut self,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        let (subject, place) = match arguments {
            [place] if scope.world.is_none() => (None, place),
            [subject, place] => (Some(subject), place),
            _ if scope.world.is_some() => {
                wrong(self, "`distance(instance, instance)` or `distance(instance, (x, y))`");
                return None;
            }
            _ => {
                wrong(self, "`distance(reference)` or `distance((x, y))`");
                return None;
            }
        };
        self.allow_inside(span, scope, ReadLimit::State, "`distance`")?;
        let of = match subject {
            None => Subject::Me,
            Some(subject) if scope.world.is_some() => Subject::Slot(self.instance(subject, scope)?.0),
            Some(subject) => {
                let of = self.subject(subject, scope)?;
                if let Some(name) = subject.name() {
                    self.readable(of, &name, span, scope);
                }
                of
            }
        };
        let place = self.position(place, scope, false)?;
        Some(Term { kind: TermKind::Distance(Box::new((of, place.at))), ty: Type::Real, span })
    }

    /// The instance itself, or one that a reference or a guard names.
    fn subject(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<Subject> {
        match e.kind {
            ExprKind::SelfRef => Some(Subject::Me),
            _ => self.reference(e, scope).map(|(of, _)| of),
        }
    }

    /// A point, or the position of an instance: of one that can be none if that is `tested`.
    fn position(&mut self, e: &Expr, scope: &Scope<'_>, is_tested: bool) -> Option<Place> {
        if let ExprKind::Point(point) = &e.kind {
            let [x, y] = &**point;
            let (x, y) = (self.number(x, scope), self.number(y, scope));
            return Some(Place { at: [x?, y?], tested: None });
        }
        let of = if scope.world.is_some() {
            Subject::Slot(self.instance(e, scope)?.0)
        } else if matches!(e.kind, ExprKind::SelfRef) || e.name().is_some() {
            self.subject(e, scope)?
        } else {
            self.diagnostics.report(TypeMismatch {
                at: e.span,
                found: "an expression".into(),
                expected: "a point `(x, y)`, `self` or a reference".into(),
                help: None,
            });
            return None;
        };
        let tested = is_tested && matches!(of, Subject::Ref(_));
        if let Some(name) = e.name().filter(|_| !tested) {
            self.readable(of, &name, e.span, scope);
        }
        let at = VarId::XY.map(|var| Term { kind: TermKind::Var(of, var, 0), ty: Type::Real, span: e.span });
        Some(Place { at, tested: tested.then_some(of) })
    }
}

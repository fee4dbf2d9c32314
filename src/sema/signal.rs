//! Signals: `signal score(points)`, `send ship.score(100)`, `received(score)` and `score.points`. What is sent in a step
//! is received in the next one, in guards and updates of edges.

use crate::diagnostic::catalogue::types::{TypeMismatch, WrongArguments};
use crate::ir::EntityId;
use crate::source::Span;
use crate::syntax::ast::{self, Expr, Name, PathRef, Receivers};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{Send, Signal, Sum, Term, TermKind, Type};
use super::expression::{ReadLimit, Scope};
use super::names::unknown;

impl Checker<'_> {
    /// Declares a signal, and its number.
    pub(super) fn signal(&mut self, declared: &ast::Signal) -> Signal {
        self.record_declaration(NameKind::Signal, &declared.name);
        let number = declared.number.as_ref().map(|(name, dimension)| {
            self.record_declaration(NameKind::SignalNumber, name);
            let dimension = dimension.as_ref().and_then(|d| self.annotation(d));
            Sum { name: name.clone(), dimension }
        });
        Signal { name: declared.name.clone(), number }
    }

    /// `send ship.score(100)`, `send all Door.open`
    pub(super) fn send(&mut self, send: &ast::Send, scope: &Scope<'_>) -> Option<Send> {
        let (to, id) = self.receivers(&send.to, scope)?;
        let entity = std::sync::Arc::clone(&self.checked.entities[id]);
        let signals = || entity.signals.pairs().filter(|(_, signal)| signal.name.text == send.signal.text);
        let Some((signal, known)) = signals().next() else {
            let known = entity.signals.iter().map(|signal| &signal.name);
            let fact = unknown("signal", &send.signal.text, send.signal.span, known);
            let meant =
                format!("who receives a signal declares it: `signal {}` in `{}`", send.signal.text, entity.name.text);
            self.report_unknown(fact.declared_by(meant));
            return None;
        };
        self.record_use(NameKind::Signal, send.signal.span, known.name.span);
        let number = match (&send.number, &known.number) {
            (None, None) => None,
            (Some(number), Some(sum)) => Some(self.typed(number, scope, &sum.ty())?),
            (None, Some(sum)) => {
                let (signal, name) = (&known.name.text, &sum.name.text);
                self.diagnostics.report(TypeMismatch {
                    at: send.signal.span,
                    found: "no number".into(),
                    expected: format!("`{name}`, the number that `{signal}` is sent with"),
                    help: Some(format!("write it in brackets: `{signal}(NUMBER)`")),
                });
                return None;
            }
            (Some(number), None) => {
                let signal = &known.name.text;
                self.diagnostics.report(TypeMismatch {
                    at: number.span,
                    found: "a number".into(),
                    expected: format!("`{signal}` without a number"),
                    help: Some(format!("declare it with one: `signal {signal}(NAME)`")),
                });
                return None;
            }
        };
        Some(Send { to, entity: id, signal, number, span: send.span })
    }

    /// Who gets a signal, `None` for all instances, and the entity.
    fn receivers(&mut self, to: &Receivers, scope: &Scope<'_>) -> Option<(Option<Term>, EntityId)> {
        let one = match to {
            Receivers::All(name) => {
                let Some(entity) = self.entity_named(name) else {
                    let fact = unknown("entity", &name.text, name.span, self.entities.names());
                    self.report_unknown(fact);
                    return None;
                };
                return Some((None, entity));
            }
            Receivers::One(one) => one,
        };
        let name = one.name().map(|name| name.text.to_string());
        if let Some(name) =
            name.filter(|name| self.referred(name, scope).is_none() && self.entities.get(name).is_some())
        {
            self.diagnostics.report(TypeMismatch {
                at: one.span,
                found: "an entity".into(),
                expected: "a reference".into(),
                help: Some(format!("`send all {name}.…` reaches all instances; `ref NAME: {name}` refers to one")),
            });
            return None;
        }
        let term = self.reference_value(one, scope)?;
        match term.ty {
            Type::Ref(entity) => Some((Some(term), entity)),
            _ => {
                self.of_any(one.span, "whose signals are known");
                None
            }
        }
    }

    /// `received(score)`
    pub(super) fn received(&mut self, arguments: &[Expr], span: Span, scope: &Scope<'_>) -> Option<Term> {
        let name = match arguments {
            [only] => only.name(),
            _ => None,
        };
        let Some(name) = name else {
            let usage = "a signal of this entity, such as `received(hit)`";
            self.diagnostics.report(WrongArguments { function: "received".into(), at: span, usage });
            return None;
        };
        let entity = self.allow(scope.entity, span, scope, ReadLimit::Edges, "a signal")?;
        let Some((id, signal)) = entity.signals.pairs().find(|(_, signal)| signal.name.text == name.text) else {
            let known = entity.signals.iter().map(|signal| &signal.name);
            let fact = unknown("signal", &name.text, name.span, known);
            let meant = format!("declare it in this entity, which receives it: `signal {}`", name.text);
            self.report_unknown(fact.declared_by(meant));
            return None;
        };
        self.record_use(NameKind::Signal, name.span, signal.name.span);
        Some(Term { kind: TermKind::Received(id), ty: Type::Bool, span })
    }

    /// `score.points`, if the entity has such a signal: the sum of what was received.
    pub(super) fn signal_member(
        &mut self,
        path: &PathRef<'_>,
        [first, second]: [&Name; 2],
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Option<Term>> {
        let entity = scope.entity?;
        let (id, signal) = entity.signals.pairs().find(|(_, signal)| signal.name.text == first.text)?;
        Some((|| {
            self.record_use(NameKind::Signal, first.span, signal.name.span);
            self.unprimed(path)?;
            let number = signal.number.as_ref();
            let Some(sum) = number.filter(|sum| sum.name.text == second.text) else {
                let known = number.into_iter().map(|sum| &sum.name);
                let fact = unknown("number of the signal", &second.text, second.span, known);
                let meant =
                    format!("`{0}` is sent without one: `signal {0}({1})` declares it", first.text, second.text);
                self.report_unknown(fact.suggestion(number.is_none().then_some(meant)));
                return None;
            };
            self.record_use(NameKind::SignalNumber, second.span, sum.name.span);
            self.allow(Some(()), span, scope, ReadLimit::Edges, "a signal")?;
            Some(Term { kind: TermKind::Sum(id), ty: sum.ty(), span })
        })())
    }

    /// Reports a signal that is named where a value is needed.
    pub(super) fn signal_as_value(&mut self, name: &Name, scope: &Scope<'_>) -> bool {
        let signal = scope.entity.and_then(|e| e.signals.iter().find(|signal| signal.name.text == name.text));
        let Some(signal) = signal else { return false };
        let sum = signal.number.as_ref().map(|sum| &sum.name.text);
        let asks = format!("`received({})` asks whether it was received", name.text);
        let help = match sum {
            Some(sum) => format!("{asks}, `{}.{sum}` is the sum of what was sent", name.text),
            None => asks,
        };
        self.diagnostics.report(TypeMismatch {
            at: name.span,
            found: "a signal".into(),
            expected: "a value".into(),
            help: Some(help),
        });
        true
    }
}

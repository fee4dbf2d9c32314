//! Probes: `touching(body at (16, 0), wall)` asks whether a place is free. The offset reads only what the instance itself
//! has, so that the answer can be found again wherever the instance that it names is read.

use crate::diagnostic::catalogue::types::{ForeignOffset, TypeMismatch, WrongArguments};
use crate::ir::Subject;
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Name};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{BoundProbe, Probe, Term, TermKind, Type};
use super::expression::{ReadLimit, Scope};

impl Checker<'_> {
    /// `touching(own tag at (x, y), tag)`; `moved` is the first argument, `rest` are those after it.
    pub(super) fn probe(
        &mut self,
        moved: &[Expr; 2],
        rest: &[Expr],
        binding: Option<&Name>,
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Term> {
        self.allow(scope.entity, span, scope, ReadLimit::All, "`touching`")?;
        let [collider, offset] = moved;
        let (mine, other) = match (tag(collider), rest) {
            (Some(mine), [other]) if tag(other).is_some() => (mine, tag(other)?),
            (_, [_, _, ..]) => {
                return self.wrong_probe(
                    span,
                    "no side: the offset says where the place is, as in `touching(body at (0, -1), floor)`",
                );
            }
            _ => {
                return self.wrong_probe(
                    span,
                    "`touching(own tag at (x, y), tag)`, such as `touching(body at (16, 0), wall)`",
                );
            }
        };
        let ExprKind::Point(point) = &offset.kind else {
            self.diagnostics.report(TypeMismatch {
                at: offset.span,
                found: "a single value".into(),
                expected: "an offset: two lengths in brackets, such as `(16, 0)`".into(),
                help: None,
            });
            return None;
        };
        let bindable = std::mem::take(&mut self.facts.bindable);
        let (x, y) = (self.number(&point[0], scope), self.number(&point[1], scope));
        self.facts.bindable = bindable;
        let offset = [x?, y?];
        if let Some(at) = offset.iter().find_map(reads_more) {
            self.diagnostics.report(ForeignOffset { at, what: "the offset of a probe" });
            return None;
        }
        let (mine, other) = (self.tag(&mine), self.tag(&other));
        let bound = binding.map(|name| {
            self.record_declaration(NameKind::Touched, name);
            let probe = Probe { mine, other, offset: offset.clone(), bound: None };
            self.facts.name_probe(name, BoundProbe::Place(probe, span))
        });
        let kind = TermKind::Probe(Box::new(Probe { mine, other, offset, bound }));
        Some(Term { kind, ty: Type::Bool, span })
    }

    fn wrong_probe(&mut self, at: Span, usage: &'static str) -> Option<Term> {
        self.diagnostics.report(WrongArguments { function: "touching".into(), at, usage });
        None
    }
}

/// The tag that an argument names.
fn tag(argument: &Expr) -> Option<Name> {
    match &argument.kind {
        ExprKind::Text(text) => Some(Name { text: (**text).clone(), span: argument.span }),
        _ => argument.name(),
    }
}

/// Where an offset reads another instance, a contact or a transition.
pub(super) fn reads_more(term: &Term) -> Option<Span> {
    let reads = match &term.kind {
        TermKind::Param(of, _) | TermKind::Var(of, ..) | TermKind::Discrete(of, _) | TermKind::InMode(of, _) => {
            *of != Subject::Me
        }
        TermKind::Number(_)
        | TermKind::Quantity(_)
        | TermKind::Frames(_)
        | TermKind::Bool(_)
        | TermKind::Axis(_)
        | TermKind::Chance(_)
        | TermKind::Timer(_)
        | TermKind::Button(..)
        | TermKind::Negate(_)
        | TermKind::Arithmetic(..)
        | TermKind::Call(_)
        | TermKind::Compare(..)
        | TermKind::And(_)
        | TermKind::Or(_)
        | TermKind::Not(_) => false,
        TermKind::Touching(_)
        | TermKind::Probe(_)
        | TermKind::Joint { .. }
        | TermKind::Received(_)
        | TermKind::Sum(_)
        | TermKind::IsNone(_)
        | TermKind::Is(..)
        | TermKind::Alive(_)
        | TermKind::NoneRef
        | TermKind::Instance(_)
        | TermKind::InSpace(..)
        | TermKind::Near(_)
        | TermKind::Tiles(_)
        | TermKind::Distance(_)
        | TermKind::Members(_)
        | TermKind::Nearest(_)
        | TermKind::Count(_) => true,
    };
    if reads { Some(term.span) } else { term.operands().iter().find_map(reads_more) }
}

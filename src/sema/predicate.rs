//! Values of instances: `hero.x` and `main.width` in predicates of a world, `target.x` in entities.

use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::diagnostic::similar;
use crate::ir::{EntityId, SlotId, Subject, VarId};
use crate::source::Span;
use crate::syntax::ast::{Expr, Name, PathRef};
use crate::syntax::occurrence::Role;

use super::checked::{Given, Term, TermKind, Type};
use super::expression::{ReadLimit, Scope};
use super::foreign;
use super::names::{Candidate, unknown};
use super::{Checker, start};

impl Checker<'_> {
    /// `hero.x'`, `hero.keys`, `main.width`.
    pub(super) fn member(
        &mut self,
        path: &PathRef<'_>,
        first: &Name,
        second: &Name,
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Term> {
        if let Some(extra) = path.segments.get(2) {
            self.diagnostics.report(TypeMismatch {
                at: extra.span,
                found: "a name too many".into(),
                expected: if scope.world.is_some() {
                    "`instance.variable` or `space.width`"
                } else {
                    "`reference.variable`"
                }
                .into(),
                help: None,
            });
            return None;
        }
        let is_instance = scope.world.is_some_and(|world| world.instance(&first.text).is_some());
        if !is_instance && let Some(space) = scope.spaces.iter().find(|(name, _)| name.text == first.text) {
            return self.measure(space, path, first, second, span);
        }
        if scope.entity.is_some() {
            return self.referred_member(path, first, second, span, scope);
        }
        if scope.world.is_none() && similar(&first.text, scope.spaces.iter().map(|(name, _)| &*name.text)).is_some() {
            let fact = unknown("space", &first.text, first.span, scope.spaces.iter().map(|(name, _)| name));
            self.report_unknown(fact);
            return None;
        }
        let world = self.allow(scope.world, span, scope, ReadLimit::All, "another instance's variable")?;
        if let Some((slot, entity)) = world.instance(&first.text) {
            self.record_instance_use(world, first);
            return self.value_of(Subject::Slot(slot), entity, path, second, span);
        }
        self.unprimed(path)?;
        let known = world.instance_names().chain(world.spaces.iter().map(|(n, _)| Candidate::from(n)));
        let fact = unknown("instance or space", &first.text, first.span, known);
        self.report_unknown(fact);
        None
    }

    /// `target.x` in an entity.
    fn referred_member(
        &mut self,
        path: &PathRef<'_>,
        first: &Name,
        second: &Name,
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Term> {
        let Some((subject, entity)) = self.referred(&first.text, scope) else {
            let known = scope.names.into_iter().flat_map(|n| n.refs.names()).chain(self.facts.names());
            let fact = unknown("reference", &first.text, first.span, known);
            let meant = self.unreferenced(&first.text, scope).or_else(|| start::suggestion(&first.text));
            self.report_unknown(fact.suggestion(meant));
            return None;
        };
        self.record_subject_use(subject, first, scope);
        self.note_instance(subject, &first.text, first.span);
        self.allow(Some(()), span, scope, ReadLimit::State, "another instance's variable")?;
        self.readable(subject, first, span, scope);
        let Some(entity) = entity else {
            // Every instance has a position.
            let var = match &*second.text {
                "x" => VarId::X,
                "y" => VarId::Y,
                _ => {
                    self.of_any(first.span, "to read more than `x` and `y` of it");
                    return None;
                }
            };
            let degree = self.degree(path)?;
            return Some(Term { kind: TermKind::Var(subject, var, degree), ty: Type::Real, span });
        };
        self.value_of(subject, entity, path, second, span)
    }

    /// A variable or a parameter of another instance.
    pub(super) fn value_of(
        &mut self,
        of: Subject,
        id: EntityId,
        path: &PathRef<'_>,
        second: &Name,
        span: Span,
    ) -> Option<Term> {
        {
            let entity = self.checked.entities[id].clone();
            let named = self.value_named(id, &second.text);
            if let Some(what) = named {
                self.record_value_use(&entity, what, second.span, Role::Read);
            }
            if let Some(Given::Var(var, _)) = named {
                let degree = self.degree(path)?;
                return Some(Term { kind: TermKind::Var(of, var, degree), ty: Type::Real, span });
            }
            if let Some(Given::Discrete(id)) = named {
                self.unprimed(path)?;
                let ty = entity.discretes[id].ty;
                return Some(Term { kind: TermKind::Discrete(of, id), ty, span });
            }
            if let Some(Given::Param(id)) = named {
                self.unprimed(path)?;
                let ty = entity.params[id].default.ty;
                return Some(Term { kind: TermKind::Param(of, id), ty, span });
            }
            let known = entity.vars.iter().map(|v| &v.name).chain(entity.discretes.iter().map(|d| &d.name));
            let known = known.chain(entity.declared_params().map(|(_, p)| &p.name));
            let is_condition = entity.conditions.iter().any(|c| c.name.text == second.text);
            let meant = is_condition.then(|| {
                let (name, of) = (&second.text, &entity.name.text);
                format!("`{name}` is a condition, which only `{of}` itself can use; a `discrete … : bool` can be read")
            });
            let meant = meant.or_else(|| foreign::drawn(&entity, &second.text));
            let fact = unknown("variable", &second.text, second.span, known).suggestion(meant);
            self.report_unknown(fact);
            None
        }
    }

    /// A named instance of the world.
    pub(super) fn instance(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<(SlotId, EntityId)> {
        let world = self.allow(scope.world, e.span, scope, ReadLimit::All, "an instance")?;
        let Some(name) = &e.name() else {
            self.diagnostics.report(TypeMismatch {
                at: e.span,
                found: "an expression".into(),
                expected: "the name of an instance".into(),
                help: None,
            });
            return None;
        };
        if let Some(found) = world.instance(&name.text) {
            self.record_instance_use(world, name);
            return Some(found);
        }
        let fact = unknown("instance", &name.text, name.span, world.instance_names());
        self.report_unknown(fact);
        None
    }
}

/// A predicate about instances that is false if one of them is destroyed.
pub(super) fn while_alive(question: Term) -> Term {
    let mut slots = Vec::new();
    read_slots(&question, &mut slots);
    let span = question.span;
    slots.into_iter().rev().fold(question, |question, slot| {
        let alive = Term { kind: TermKind::Alive(slot), ty: Type::Bool, span };
        Term { kind: TermKind::And(Box::new([alive, question])), ty: Type::Bool, span }
    })
}

/// The distinct instances that a term reads.
fn read_slots(term: &Term, out: &mut Vec<SlotId>) {
    let mut add = |of: &Subject| {
        if let Subject::Slot(slot) = of
            && !out.contains(slot)
        {
            out.push(*slot);
        }
    };
    match &term.kind {
        // It asks itself which of them live.
        TermKind::Count(_) => return,
        TermKind::Var(of, ..)
        | TermKind::Discrete(of, _)
        | TermKind::Param(of, _)
        | TermKind::InMode(of, _)
        | TermKind::InSpace(of, _) => add(of),
        TermKind::Touching(asked) => add(&asked.of),
        TermKind::Near(asked) => add(&asked.0),
        TermKind::Distance(asked) => add(&asked.0),
        _ => {}
    }
    term.operands().iter().for_each(|operand| read_slots(operand, out));
}

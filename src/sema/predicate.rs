//! Expressions about instances in predicates of a world: `hero.x`, `hero in dead`, `near(hero, …)`, `any Goomba`.

use crate::diagnostic::catalogue::syntax::{Misplaced, OnlyInWorlds};
use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::ir::{EntityId, SlotId, Subject, VarId};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Name, PathRef};
use crate::syntax::occurrence::{NameKind, Role};

use super::Checker;
use super::checked::{Given, Term, TermKind, Touching, Type};
use super::expression::{ReadLimit, Scope};
use super::foreign;
use super::names::{Candidate, unknown};

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
        if scope.entity.is_some() {
            return self.referred_member(path, first, second, span, scope);
        }
        let world = self.allow(scope.world, span, scope, ReadLimit::All, "another instance's variable")?;
        if let Some((slot, entity)) = world.instance(&first.text) {
            self.record_instance_use(world, first);
            return self.value_of(Subject::Slot(slot), entity, path, second, span);
        }
        self.unprimed(path)?;
        if let Some((declared, size)) = world.spaces.iter().find(|(n, _)| n.text == first.text) {
            self.record_use(NameKind::Space, first.span, declared.span);
            let Some(size) = size else {
                self.diagnostics.report(TypeMismatch {
                    at: span,
                    found: "a space without a map".into(),
                    expected: "a space with a map".into(),
                    help: Some("the size of a space is the size of its map".into()),
                });
                return None;
            };
            let value = match &*second.text {
                "width" => size.0,
                "height" => size.1,
                other => {
                    let fact = unknown("measure of a space", other, second.span, ["width", "height"]);
                    self.report_unknown(fact);
                    return None;
                }
            };
            return Some(Term { kind: TermKind::Number(value), ty: Type::Real, span });
        }
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
            let meant = self.unreferenced(&first.text, scope);
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
    fn value_of(&mut self, of: Subject, id: EntityId, path: &PathRef<'_>, second: &Name, span: Span) -> Option<Term> {
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
            let known = known.chain(entity.params.iter().map(|p| &p.name));
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

    pub(super) fn near(
        &mut self,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        if scope.entity.is_some() {
            let help = self.distance(arguments, scope);
            self.diagnostics.report(OnlyInWorlds { at: span, what: "`near`", help });
            return None;
        }
        let [subject, place, radius] = arguments else {
            wrong(self, "`near(instance, (x, y), radius)` or `near(instance, instance, radius)`");
            return None;
        };
        self.allow(scope.world, span, scope, ReadLimit::All, "`near`")?;
        let (x, y) = if let ExprKind::Point(point) = &place.kind {
            let [x, y] = &**point;
            let (x, y) = (self.number(x, scope), self.number(y, scope));
            (x?, y?)
        } else {
            let (slot, _) = self.instance(place, scope)?;
            let read =
                |var| Term { kind: TermKind::Var(Subject::Slot(slot), var, 0), ty: Type::Real, span: place.span };
            (read(VarId::X), read(VarId::Y))
        };
        let radius = self.number(radius, scope)?;
        self.relation(subject, span, scope, |_, slot, _| {
            Some(TermKind::Near(Box::new((Subject::Slot(slot), [x.clone(), y.clone(), radius.clone()]))))
        })
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

    /// Applies `make` to the instance left of `in` or `touching`, or to any instance of an entity.
    pub(super) fn relation(
        &mut self,
        subject: &Expr,
        span: Span,
        scope: &Scope<'_>,
        make: impl Fn(&mut Self, SlotId, EntityId) -> Option<TermKind>,
    ) -> Option<Term> {
        if let ExprKind::Any(entity) = &subject.kind {
            return self.any(entity, span, scope, make);
        }
        if let ExprKind::All(entity) = &subject.kind {
            return self.all(entity, span, scope, make);
        }
        if scope.entity.is_some() {
            self.diagnostics.report(Misplaced {
                at: span,
                what: "this question",
                inside: "an entity",
                belongs: "in a `goal` or `never` of a world; an entity asks `touching(TAG)`",
            });
            return None;
        }
        let (slot, entity) = self.instance(subject, scope)?;
        Some(while_alive(Term { kind: make(self, slot, entity)?, ty: Type::Bool, span }))
    }

    /// `make` for each instance of an entity, and that the instance lives.
    fn each(
        &mut self,
        name: &Name,
        span: Span,
        scope: &Scope<'_>,
        what: &'static str,
        make: impl Fn(&mut Self, SlotId, EntityId) -> Option<TermKind>,
    ) -> Option<Vec<Term>> {
        let world = self.allow(scope.world, span, scope, ReadLimit::All, what)?;
        let Some(entity) = self.entity_named(name) else {
            let fact = unknown("entity", &name.text, name.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        let mut each = Vec::new();
        for (slot, (_, of)) in world.instances.iter().enumerate() {
            if *of == entity {
                let slot = SlotId(slot as u32);
                let alive = Term { kind: TermKind::Alive(slot), ty: Type::Bool, span };
                let holds = Term { kind: make(self, slot, entity)?, ty: Type::Bool, span };
                each.push(match holds.kind {
                    TermKind::Bool(true) => alive,
                    _ => Term { kind: TermKind::And(Box::new([alive, holds])), ty: Type::Bool, span },
                });
            }
        }
        Some(each)
    }

    /// A disjunction of `make` over all instances of an entity.
    pub(super) fn any(
        &mut self,
        name: &Name,
        span: Span,
        scope: &Scope<'_>,
        make: impl Fn(&mut Self, SlotId, EntityId) -> Option<TermKind>,
    ) -> Option<Term> {
        let mut some = self.each(name, span, scope, "`any`", make)?;
        // A balanced tree: thousands of instances must not nest thousands of levels deep.
        while some.len() > 1 {
            let mut halves = Vec::with_capacity(some.len().div_ceil(2));
            let mut rest = some.into_iter();
            while let Some(a) = rest.next() {
                halves.push(match rest.next() {
                    Some(b) => Term { kind: TermKind::Or(Box::new([a, b])), ty: Type::Bool, span },
                    None => a,
                });
            }
            some = halves;
        }
        Some(some.pop().unwrap_or(Term { kind: TermKind::Bool(false), ty: Type::Bool, span }))
    }

    /// `all Crate in on`: no living instance is without it.
    fn all(
        &mut self,
        name: &Name,
        span: Span,
        scope: &Scope<'_>,
        make: impl Fn(&mut Self, SlotId, EntityId) -> Option<TermKind>,
    ) -> Option<Term> {
        let without = |this: &mut Self, slot, entity| {
            let holds = Term { kind: make(this, slot, entity)?, ty: Type::Bool, span };
            Some(TermKind::Not(Box::new(holds)))
        };
        let some = self.any(name, span, scope, without)?;
        Some(Term { kind: TermKind::Not(Box::new(some)), ty: Type::Bool, span })
    }

    /// `count(Crate)`, `count(Crate in on)`, `count(Crate touching water)`
    pub(super) fn count(
        &mut self,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        const FORMS: &str =
            "`count(ENTITY)`, `count(ENTITY in MODE)`, `count(ENTITY touching TAG)` or `count(TAG)` of tiles";
        let [of] = arguments else {
            wrong(self, FORMS);
            return None;
        };
        let subject = match &of.kind {
            ExprKind::In(operands) => &operands.0,
            ExprKind::Touching(operands) => &operands.0,
            _ => of,
        };
        let Some(entity) = subject.name() else {
            wrong(self, FORMS);
            return None;
        };
        if subject == of
            && let Some(tiles) = self.count_of_tiles(&entity, span, scope)
        {
            return Some(tiles);
        }
        if let (true, None, Some(world)) = (subject == of, self.entities.get(&entity.text), scope.world) {
            let tags = world.tiles.iter().flatten().map(|(tag, _)| Candidate::from(tag.as_str()));
            let fact = unknown("entity or tag of tiles", &entity.text, entity.span, self.entities.names().chain(tags));
            self.report_unknown(fact);
            return None;
        }
        let each = match &of.kind {
            ExprKind::In(operands) => self.each(&entity, span, scope, "`count`", |this, slot, entity| {
                let names = this.mode_names(entity);
                let mode = this.mode_named(&names, &operands.1.view(), None)?;
                Some(TermKind::InMode(Subject::Slot(slot), mode))
            }),
            ExprKind::Touching(operands) => {
                let other = self.tag(&operands.1);
                self.each(&entity, span, scope, "`count`", |_, slot, _| {
                    let of = Subject::Slot(slot);
                    Some(TermKind::Touching(Box::new(Touching { of, mine: None, other, side: None, bound: None })))
                })
            }
            _ => self.each(&entity, span, scope, "`count`", |_, _, _| Some(TermKind::Bool(true))),
        }?;
        Some(Term { kind: TermKind::Count(Box::new(each)), ty: Type::Int, span })
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
        _ => {}
    }
    term.operands().iter().for_each(|operand| read_slots(operand, out));
}

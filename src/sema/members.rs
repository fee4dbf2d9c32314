//! Questions to the instances of an entity: `any Slime in squashed`, `all Crate.y < 0`, `count(Bomb)`, `nearest Foe as f`.
//! A world asks its instances one by one. An entity, which several worlds can have, asks whoever there is.

use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::{ForeignOffset, TypeMismatch};
use crate::ir::{CompareOp, EntityId, SlotId, Subject, VarId};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ExprKind, Name};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{BoundProbe, Members, Nearest, Term, TermKind, Touching, Type};
use super::expression::{ReadLimit, Scope};
use super::names::{Candidate, unknown};
use super::predicate::while_alive;
use super::probe::reads_more;

/// What is asked of the instances of an entity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fold {
    /// Whether it holds of one of them.
    Any,
    /// Whether it holds of each of them.
    All,
    /// Of how many it holds.
    Count,
}

impl Fold {
    fn words(self) -> &'static str {
        match self {
            Fold::Any => "`any`",
            Fold::All => "`all`",
            Fold::Count => "`count`",
        }
    }
}

impl Checker<'_> {
    /// Applies `make` to the instance left of `in` or `touching`, or to any or all instances of an entity.
    pub(super) fn relation(
        &mut self,
        subject: &Expr,
        span: Span,
        scope: &Scope<'_>,
        make: impl FnOnce(&mut Self, Subject, EntityId) -> Option<TermKind>,
    ) -> Option<Term> {
        let fold = match &subject.kind {
            ExprKind::Any(entity) => Some((Fold::Any, entity)),
            ExprKind::All(entity) => Some((Fold::All, entity)),
            _ => None,
        };
        if let Some((fold, entity)) = fold {
            return self.members(fold, entity, span, scope, |this, entity| {
                let kind = make(this, Subject::Member(entity), entity)?;
                Some(Term { kind, ty: Type::Bool, span })
            });
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
        Some(while_alive(Term { kind: make(self, Subject::Slot(slot), entity)?, ty: Type::Bool, span }))
    }

    /// `any Crate`, `count(Crate in on)`: what `ask` asks of [`Subject::Member`], of all instances of an entity.
    pub(super) fn members(
        &mut self,
        fold: Fold,
        name: &Name,
        span: Span,
        scope: &Scope<'_>,
        ask: impl FnOnce(&mut Self, EntityId) -> Option<Term>,
    ) -> Option<Term> {
        self.allow_inside(span, scope, ReadLimit::Edges, fold.words())?;
        let Some(entity) = self.entity_named(name) else {
            let fact = unknown("entity", &name.text, name.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        self.checked.asks_members |= scope.world.is_none();
        let outer = self.facts.member.replace(entity);
        let holds = ask(self, entity);
        self.facts.member = outer;
        let holds = holds?;
        if let Some(at) = asks_each(&holds) {
            self.nested(at);
            return None;
        }
        let Some(world) = scope.world else { return Some(folded(fold, entity, holds, span)) };
        let mut each = Vec::new();
        for (slot, _) in world.instances.iter().enumerate().filter(|(_, (_, of))| *of == entity) {
            let slot = SlotId(slot as u32);
            let alive = Term { kind: TermKind::Alive(slot), ty: Type::Bool, span };
            let mut asked = holds.clone();
            set_member(&mut asked, slot);
            if fold == Fold::All {
                asked = Term { kind: TermKind::Not(Box::new(asked)), ty: Type::Bool, span };
            }
            each.push(match asked.kind {
                TermKind::Bool(true) => alive,
                _ => Term { kind: TermKind::And(Box::new([alive, asked])), ty: Type::Bool, span },
            });
        }
        Some(match fold {
            Fold::Count => Term { kind: TermKind::Count(Box::new(each)), ty: Type::Int, span },
            Fold::Any => any_of(each, span),
            // No living instance is without it.
            Fold::All => Term { kind: TermKind::Not(Box::new(any_of(each, span))), ty: Type::Bool, span },
        })
    }

    fn nested(&mut self, at: Span) {
        self.diagnostics.report(Misplaced {
            at,
            what: "a question to each instance",
            inside: "another one",
            belongs: "beside it, joined by `and` or `or`",
        });
    }

    /// `any Crate`
    pub(super) fn any(&mut self, name: &Name, span: Span, scope: &Scope<'_>) -> Option<Term> {
        let ask = |_: &mut Self, _| Some(Term { kind: TermKind::Bool(true), ty: Type::Bool, span });
        self.members(Fold::Any, name, span, scope, ask)
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
        if subject == of && self.counts_tiles(&entity, scope) {
            return self.count_of_tiles(&entity, span, scope);
        }
        if let (true, None, Some(world)) = (subject == of, self.entities.get(&entity.text), scope.world) {
            let tags = world.tiles.iter().flatten().map(|(tag, _)| Candidate::from(tag.as_str()));
            let fact = unknown("entity or tag of tiles", &entity.text, entity.span, self.entities.names().chain(tags));
            self.report_unknown(fact);
            return None;
        }
        self.members(Fold::Count, &entity, span, scope, |this, id| {
            let member = Subject::Member(id);
            let kind = match &of.kind {
                ExprKind::In(operands) => {
                    let names = this.mode_names(id);
                    TermKind::InMode(member, this.mode_named(&names, &operands.1.view(), None)?)
                }
                ExprKind::Touching(operands) => touching(member, this.tag(&operands.1)),
                _ => TermKind::Bool(true),
            };
            Some(Term { kind, ty: Type::Bool, span })
        })
    }

    /// A comparison in which `any Crate.x` or `all Crate.x` stands: it asks the instances one by one.
    pub(super) fn of_each(
        &mut self,
        e: &Expr,
        scope: &Scope<'_>,
        compare: impl FnOnce(&mut Self) -> Option<Term>,
    ) -> Option<Term> {
        let mut found = Vec::new();
        eaches(e, true, &mut found);
        let [(each, at), rest @ ..] = &*found else { return compare(self) };
        if let Some((_, second)) = rest.first() {
            self.diagnostics.report(TypeMismatch {
                at: *second,
                found: "a second `any` or `all`".into(),
                expected: "one in a comparison".into(),
                help: Some("a comparison asks the instances of one entity, each by itself".into()),
            });
            return None;
        }
        let entity = each.path.view().segments.first().cloned()?;
        let fold = if each.is_all { Fold::All } else { Fold::Any };
        self.members(fold, &entity, at.to(e.span), scope, |this, _| compare(this))
            .map(|term| Term { span: e.span, ..term })
    }

    /// `any Crate.x`: in a comparison, the value of the instance that is asked; else whether it is true of any.
    pub(super) fn each_value(&mut self, each: &ast::Each, span: Span, scope: &Scope<'_>) -> Option<Term> {
        let path = each.path.view();
        let [entity, rest @ ..] = &*path.segments else { return None };
        let [second, rest @ ..] = rest else {
            self.unprimed(&path)?;
            return None;
        };
        if let Some(extra) = rest.first() {
            self.diagnostics.report(TypeMismatch {
                at: extra.span,
                found: "a name too many".into(),
                expected: "`any ENTITY.VARIABLE`".into(),
                help: None,
            });
            return None;
        }
        if let Some(id) = self.facts.member {
            return self.value_of(Subject::Member(id), id, &path, second, span);
        }
        let fold = if each.is_all { Fold::All } else { Fold::Any };
        self.members(fold, entity, span, scope, |this, id| {
            let value = this.value_of(Subject::Member(id), id, &path, second, span)?;
            if value.ty == Type::Bool {
                return Some(value);
            }
            this.diagnostics.report(TypeMismatch {
                at: span,
                found: "a value of each instance".into(),
                expected: "a comparison".into(),
                help: Some(format!("`any {}.{} > 0` compares it", entity.text, second.text)),
            });
            None
        })
    }

    /// `nearest Foe in awake within 80 as f`
    pub(super) fn nearest(&mut self, asked: &ast::Nearest, span: Span, scope: &Scope<'_>) -> Option<Term> {
        if let Some(binding) = asked.binding.as_ref().filter(|_| !self.facts.bindable) {
            self.misplaced_binding(binding.span);
            return None;
        }
        self.allow(scope.entity, span, scope, ReadLimit::Edges, "`nearest`")?;
        let Some(of) = self.entity_named(&asked.entity) else {
            let fact = unknown("entity", &asked.entity.text, asked.entity.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        let member = Subject::Member(of);
        let make = |kind, ty| Term { kind, ty, span };
        let mut holds: Vec<Term> = Vec::new();
        if let Some(mode) = &asked.mode {
            let names = self.mode_names(of);
            holds.push(make(TermKind::InMode(member, self.mode_named(&names, &mode.view(), None)?), Type::Bool));
        }
        if let Some(limit) = &asked.within {
            let limit = self.number(limit, scope)?;
            if let Some(at) = reads_more(&limit) {
                self.diagnostics.report(ForeignOffset { at, what: "the distance of `nearest`" });
                return None;
            }
            let own = |var| make(TermKind::Var(Subject::Me, var, 0), Type::Real);
            let way = make(TermKind::Distance(Box::new((member, [own(VarId::X), own(VarId::Y)]))), Type::Real);
            let near = TermKind::Compare(CompareOp::AtMost, Box::new([way, limit]));
            holds.push(make(near, Type::Bool));
        }
        let both = holds.into_iter().reduce(|a, b| make(TermKind::And(Box::new([a, b])), Type::Bool));
        let holds = both.unwrap_or(make(TermKind::Bool(true), Type::Bool));
        let mut nearest = Nearest { of, holds, bound: None };
        if let Some(name) = &asked.binding {
            self.record_declaration(NameKind::Touched, name);
            nearest.bound = Some(self.facts.name_probe(name, BoundProbe::Nearest(nearest.clone(), span)));
        }
        Some(make(TermKind::Nearest(Box::new(nearest)), Type::Bool))
    }
}

/// A contact of an instance with a tag.
pub(super) fn touching(of: Subject, other: crate::ir::TagId) -> TermKind {
    TermKind::Touching(Box::new(Touching { of, mine: None, other, side: None, bound: None }))
}

/// A question of an entity to the instances of another one.
fn folded(fold: Fold, of: EntityId, mut holds: Term, span: Span) -> Term {
    let make = |kind, ty| Term { kind, ty, span };
    if fold == Fold::All {
        holds = make(TermKind::Not(Box::new(holds)), Type::Bool);
    }
    let count = make(TermKind::Members(Box::new(Members { of, holds })), Type::Int);
    let op = match fold {
        Fold::Count => return count,
        Fold::Any => CompareOp::Greater,
        // No living instance is without it.
        Fold::All => CompareOp::Equal,
    };
    let zero = make(TermKind::Number(0.0), Type::Int);
    make(TermKind::Compare(op, Box::new([count, zero])), Type::Bool)
}

/// A disjunction as a balanced tree: thousands of instances must not nest thousands of levels deep.
fn any_of(mut some: Vec<Term>, span: Span) -> Term {
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
    some.pop().unwrap_or(Term { kind: TermKind::Bool(false), ty: Type::Bool, span })
}

/// Where a term asks each instance of an entity.
fn asks_each(term: &Term) -> Option<Span> {
    match &term.kind {
        TermKind::Members(_) | TermKind::Nearest(_) | TermKind::Count(_) => Some(term.span),
        _ => term.operands().iter().find_map(asks_each),
    }
}

/// What a comparison reads of each instance of an entity, without the comparisons inside of it.
fn eaches<'e>(e: &'e Expr, is_outermost: bool, out: &mut Vec<(&'e ast::Each, Span)>) {
    let mut inside = |e| eaches(e, false, out);
    match &e.kind {
        ExprKind::Compare(_, both) if is_outermost => both.iter().for_each(inside),
        ExprKind::Chain(chain) if is_outermost => {
            inside(&chain.0);
            chain.1.iter().for_each(|(_, e)| inside(e));
        }
        ExprKind::Each(each) => out.push((each, e.span)),
        ExprKind::Binary(op, both) if !matches!(op, ast::BinaryOp::And | ast::BinaryOp::Or) => {
            both.iter().for_each(inside);
        }
        ExprKind::Paren(a) | ExprKind::Negate(a) => inside(a),
        ExprKind::Call(call) => call.arguments.iter().for_each(inside),
        _ => {}
    }
}

/// Lets a term about a member be about an instance of a world.
fn set_member(term: &mut Term, slot: SlotId) {
    let set = |of: &mut Subject| {
        if matches!(of, Subject::Member(_)) {
            *of = Subject::Slot(slot);
        }
    };
    match &mut term.kind {
        TermKind::Param(of, _)
        | TermKind::Var(of, ..)
        | TermKind::Discrete(of, _)
        | TermKind::InMode(of, _)
        | TermKind::InSpace(of, _) => set(of),
        TermKind::Touching(asked) => set(&mut asked.of),
        TermKind::Near(asked) => {
            set(&mut asked.0);
            asked.1.iter_mut().for_each(|a| set_member(a, slot));
        }
        TermKind::Distance(asked) => {
            set(&mut asked.0);
            asked.1.iter_mut().for_each(|a| set_member(a, slot));
        }
        TermKind::Negate(a) | TermKind::Not(a) => set_member(a, slot),
        TermKind::Arithmetic(_, sides) | TermKind::Compare(_, sides) | TermKind::And(sides) | TermKind::Or(sides) => {
            sides.iter_mut().for_each(|a| set_member(a, slot))
        }
        TermKind::Call(call) => call.1.iter_mut().for_each(|a| set_member(a, slot)),
        TermKind::Count(of) => of.iter_mut().for_each(|a| set_member(a, slot)),
        // A world has neither references and probes nor inputs of its own.
        _ => {}
    }
}

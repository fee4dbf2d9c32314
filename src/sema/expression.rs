//! Expressions: names resolved and types checked, with one scope for each place where an expression can be.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::diagnostic::catalogue::names::UnknownName;
use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::{NotConstant, TypeMismatch};
use crate::ir::{self, EntityId, ModeId, SlotId, Subject, TagId};
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, CompareOp, Expr, ExprKind, Name, PathRef, Unit};
use crate::syntax::occurrence::{NameKind, Role};

use super::Checker;
use super::checked::{Entity, Given, Term, TermKind, Type};
use super::constant::KNOWN_CONSTANTS;
use super::entity::Skeleton;
use super::foreign::suggestion;
use super::members::touching;
use super::mode::ModeNames;
use super::names::{Candidate, unknown};
use super::room::MapSize;

/// The scope of an expression: it determines what it may read.
#[derive(Clone, Copy)]
pub(super) struct Scope<'s> {
    /// The enclosing entity.
    pub entity: Option<&'s Entity>,
    /// Its names.
    pub names: Option<&'s Skeleton>,
    /// The entity's id.
    pub me: Option<EntityId>,
    /// The enclosing mode.
    pub mode: Option<ModeId>,
    /// Whether an edge on `lost` of an enclosing mode covers reads of a reference that may be none.
    pub covered: bool,
    /// The enclosing world.
    pub world: Option<&'s WorldNames>,
    /// The spaces whose sizes it may read.
    pub spaces: &'s [(Name, Option<MapSize>)],
    /// The limit on its reads.
    pub reads: ReadLimit,
}

/// The values that an expression may read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ReadLimit {
    /// Literals and constants.
    Constants,
    /// Parameters, too.
    Params,
    /// Everything except inputs and contacts.
    State,
    /// Everything except signals.
    All,
    /// Everything: what edges read.
    Edges,
}

impl ReadLimit {
    fn words(self) -> (&'static str, &'static str) {
        match self {
            ReadLimit::Constants => ("this value", "literals and constants"),
            ReadLimit::Params => ("this value", "literals, constants and parameters"),
            ReadLimit::State | ReadLimit::All | ReadLimit::Edges => {
                ("a collider's shape and guard", "variables, parameters, modes and timers")
            }
        }
    }
}

/// The names of a world that predicates may use.
#[derive(Debug, Default)]
pub(super) struct WorldNames {
    pub instances: Vec<(Name, EntityId)>,
    pub spaces: Vec<(Name, Option<MapSize>)>,
    /// The tags of its tiles by name; `None` if the tiles of a level are not known yet.
    pub tiles: Option<BTreeMap<String, TagId>>,
    /// The index of each instance by name.
    index: BTreeMap<String, usize>,
}

impl WorldNames {
    pub fn new(instances: Vec<(Name, EntityId)>, spaces: Vec<(Name, Option<MapSize>)>) -> Self {
        let names = instances.iter().enumerate().rev();
        let index = names.map(|(at, (name, _))| (name.text.to_string(), at)).collect();
        WorldNames { instances, spaces, tiles: None, index }
    }

    /// The slot of a named instance, and its entity.
    pub fn instance(&self, name: &str) -> Option<(SlotId, EntityId)> {
        let slot = *self.index.get(name)?;
        Some((SlotId(slot as u32), self.instances[slot].1))
    }

    /// The names of all instances.
    pub fn instance_names(&self) -> impl Iterator<Item = Candidate<'_>> {
        self.instances.iter().map(|(n, _)| Candidate::from(n))
    }
}

impl<'s> Scope<'s> {
    /// Literals and constants only.
    pub fn constant() -> Self {
        Scope {
            entity: None,
            names: None,
            me: None,
            mode: None,
            covered: false,
            world: None,
            spaces: &[],
            reads: ReadLimit::Constants,
        }
    }

    /// Constants, and the sizes of spaces.
    pub fn measured(spaces: &'s [(Name, Option<MapSize>)]) -> Self {
        Scope { spaces, ..Scope::constant() }
    }

    /// Predicates of a world.
    pub fn predicate(world: &'s WorldNames) -> Self {
        Scope { world: Some(world), spaces: &world.spaces, reads: ReadLimit::All, ..Scope::constant() }
    }

    pub fn reading(self, reads: ReadLimit) -> Self {
        Scope { reads, ..self }
    }
}

impl From<CompareOp> for ir::CompareOp {
    fn from(op: CompareOp) -> Self {
        match op {
            CompareOp::Equal => ir::CompareOp::Equal,
            CompareOp::Unequal => ir::CompareOp::Unequal,
            CompareOp::Less => ir::CompareOp::Less,
            CompareOp::AtMost => ir::CompareOp::AtMost,
            CompareOp::Greater => ir::CompareOp::Greater,
            CompareOp::AtLeast => ir::CompareOp::AtLeast,
        }
    }
}

impl Checker<'_> {
    /// Describes a value of a type.
    fn described(&self, ty: Type) -> String {
        match ty {
            Type::Ref(_) | Type::AnyRef => "a reference".into(),
            Type::Real => "a number".into(),
            Type::Int => "a whole number".into(),
            Type::Bool => "a truth value".into(),
            Type::Set(set) => format!("one of {{{}}}", self.sets[set].names.join(", ")),
        }
    }
}

impl Checker<'_> {
    /// A number, a truth value or a value of a set.
    pub(super) fn value(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<Term> {
        self.term(e, scope, None)
    }

    /// A number.
    pub(super) fn number(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<Term> {
        let term = self.term(e, scope, Some(&Type::Real))?;
        self.expect(term, &Type::Real)
    }

    /// A truth value.
    pub(super) fn guard(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<Term> {
        let term = self.term(e, scope, Some(&Type::Bool))?;
        self.expect(term, &Type::Bool)
    }

    /// A value of a type.
    pub(super) fn typed(&mut self, e: &Expr, scope: &Scope<'_>, ty: &Type) -> Option<Term> {
        let term = self.term(e, scope, Some(ty))?;
        self.expect(term, ty)
    }

    /// The term if its type fits `ty`: an int fits a real.
    pub(super) fn expect(&mut self, term: Term, ty: &Type) -> Option<Term> {
        let fits = match (&term.ty, ty) {
            (Type::Int, Type::Real) | (Type::Ref(_), Type::AnyRef) => true,
            (Type::AnyRef, Type::Ref(_)) => term.kind == TermKind::NoneRef,
            (found, wanted) => found == wanted,
        };
        if fits {
            return Some(term);
        }
        if let (Type::Ref(_) | Type::AnyRef, Type::Ref(wanted)) = (&term.ty, ty) {
            let found = match term.ty {
                Type::Ref(found) => format!("an instance of `{}`", self.checked.entities[found].name.text),
                _ => "an instance of any entity".into(),
            };
            let wanted = self.checked.entities[*wanted].name.text.to_string();
            self.diagnostics.report(TypeMismatch {
                at: term.span,
                found,
                expected: format!("an instance of `{wanted}`"),
                help: Some(format!("test it with `is {wanted}` in the same guard")),
            });
            return None;
        }
        let help = match (&term.ty, ty) {
            (Type::Ref(_), _) => Some("`.x` reads it, `is none` and `in MODE` ask it".to_string()),
            (Type::AnyRef, _) => Some("`.x` reads it, `is none` and `is ENTITY` ask it".to_string()),
            (Type::Real, Type::Int) => Some("make it whole with `floor`, `ceil` or `round`".to_string()),
            (Type::Real | Type::Int, Type::Bool) => Some("compare it with something".to_string()),
            _ => None,
        };
        self.diagnostics.report(TypeMismatch {
            at: term.span,
            found: self.described(term.ty),
            expected: self.described(*ty),
            help,
        });
        None
    }

    /// The names of the modes of another entity.
    pub(super) fn mode_names(&mut self, entity: EntityId) -> Rc<ModeNames> {
        let of = &self.checked.entities[entity];
        Rc::clone(self.mode_names.entry(entity).or_insert_with(|| Rc::new(ModeNames::of(of))))
    }

    /// Reports an unknown name unless an earlier error explains it, or it may be an instance of a level to come.
    pub(super) fn report_unknown(&mut self, fact: UnknownName) {
        if self.poisoned_names.contains(&fact.name) || self.poisoned_names.contains("*") {
            return;
        }
        if self.awaited.is_some() && fact.may_be_instance() {
            self.awaited_names.push(fact);
        } else {
            self.diagnostics.report(fact);
        }
    }

    pub(super) fn term(&mut self, e: &Expr, scope: &Scope<'_>, wanted: Option<&Type>) -> Option<Term> {
        // Only conditions that the guard implies can bind a name.
        let bindable = self.facts.bindable;
        let conjunct = matches!(
            &e.kind,
            ExprKind::Paren(_) | ExprKind::Binary(BinaryOp::And, ..) | ExprKind::Call(..) | ExprKind::Nearest(_)
        );
        self.facts.bindable &= conjunct;
        let term = self.any_term(e, scope, wanted);
        self.facts.bindable = bindable;
        term
    }

    fn any_term(&mut self, e: &Expr, scope: &Scope<'_>, wanted: Option<&Type>) -> Option<Term> {
        let make = |kind: TermKind, ty: Type| Some(Term { kind, ty, span: e.span });
        match &e.kind {
            ExprKind::Number(value, unit) => match unit {
                None => {
                    let ty = if value.fract() == 0.0 { Type::Int } else { Type::Real };
                    make(TermKind::Number(*value), ty)
                }
                Some(Unit::Seconds) => make(TermKind::Quantity(Box::new((*value, 0, 1))), Type::Real),
                // Divided, not multiplied by 0.001, so that 250ms equals 0.25s exactly.
                Some(Unit::Milliseconds) => make(TermKind::Quantity(Box::new((value / 1000.0, 0, 1))), Type::Real),
                Some(Unit::Frames) => make(TermKind::Frames(*value), Type::Real),
            },
            ExprKind::Bool(b) => make(TermKind::Bool(*b), Type::Bool),
            ExprKind::Timer => {
                let mode = self.allow(scope.mode, e.span, scope, ReadLimit::State, "`timer`")?;
                make(TermKind::Timer(mode), Type::Real)
            }
            ExprKind::Paren(inner) => {
                let inner = self.term(inner, scope, wanted)?;
                Some(Term { span: e.span, ..inner })
            }
            ExprKind::Name(..) | ExprKind::Path(_) => self.path(&e.path()?, e.span, scope, wanted),
            ExprKind::Call(call) => {
                self.call(&call.function, &call.arguments, call.binding.as_deref(), e.span, scope, wanted)
            }
            ExprKind::InMode(path) => {
                let entity = self.allow(scope.entity, e.span, scope, ReadLimit::State, "`in`")?;
                let names = scope.names?;
                let group = scope.mode.map(|m| entity.modes[m].group);
                let mode = self.mode_named(&names.modes, &path.view(), group)?;
                make(TermKind::InMode(Subject::Me, mode), Type::Bool)
            }
            ExprKind::Negate(a) => {
                let a = self.number(a, scope)?;
                let ty = a.ty;
                make(TermKind::Negate(Box::new(a)), ty)
            }
            ExprKind::Not(a) => {
                let a = self.guard(a, scope)?;
                make(TermKind::Not(Box::new(a)), Type::Bool)
            }
            ExprKind::Binary(op, both) => {
                let [a, b] = &**both;
                self.binary(*op, a, b, e.span, scope)
            }
            ExprKind::Compare(op, both) => {
                let [a, b] = &**both;
                self.of_each(e, scope, |this| this.compare(*op, a, b, scope))
            }
            ExprKind::Chain(chain) => self.of_each(e, scope, |this| this.comparison(&chain.0, &chain.1, e.span, scope)),
            ExprKind::Each(each) => self.each_value(each, e.span, scope),
            ExprKind::Nearest(asked) => self.nearest(asked, e.span, scope),
            ExprKind::In(operands)
                if scope.entity.is_some() && !matches!(operands.0.kind, ExprKind::Any(_) | ExprKind::All(_)) =>
            {
                let (subject, path) = &**operands;
                let (of, entity) = self.reference(subject, scope)?;
                let Some(entity) = entity else {
                    self.of_any(subject.span, "whose modes could be asked");
                    return None;
                };
                let names = self.mode_names(entity);
                let mode = self.mode_named(&names, &path.view(), None)?;
                make(TermKind::InMode(of, mode), Type::Bool)
            }
            ExprKind::Is(operands) if scope.entity.is_some() => {
                let (subject, entity) = &**operands;
                let (of, known) = self.reference(subject, scope)?;
                let Some(name) = entity else {
                    self.note_instance_of(of, subject);
                    return make(TermKind::IsNone(of), Type::Bool);
                };
                let Some(entity) = self.entity_named(name) else {
                    let fact = unknown("entity", &name.text, name.span, self.entities.names());
                    self.report_unknown(fact);
                    return None;
                };
                if let Some(known) = known.filter(|known| *known != entity) {
                    self.never_is(of, subject, name, known, scope);
                    // Treated as a test for the known entity, to avoid follow-up errors.
                    return make(TermKind::Is(of, known), Type::Bool);
                }
                make(TermKind::Is(of, entity), Type::Bool)
            }
            ExprKind::In(operands) => self.relation(&operands.0, e.span, scope, |this, of, entity| {
                let names = this.mode_names(entity);
                let mode = this.mode_named(&names, &operands.1.view(), None)?;
                Some(TermKind::InMode(of, mode))
            }),
            ExprKind::Touching(operands) => {
                let (subject, tag) = &**operands;
                let other = self.tag(tag);
                self.relation(subject, e.span, scope, |_, of, _| Some(touching(of, other)))
            }
            ExprKind::Any(entity) => self.any(entity, e.span, scope),
            ExprKind::All(entity) => {
                self.diagnostics.report(TypeMismatch {
                    at: e.span,
                    found: "all instances of an entity".into(),
                    expected: "a question about them".into(),
                    help: Some(format!("`all {0} in MODE` or `all {0} touching TAG` asks them", entity.text)),
                });
                None
            }
            ExprKind::NoneRef | ExprKind::SelfRef => self.reference_value(e, scope),
            ExprKind::Is(..) => {
                self.diagnostics.report(Misplaced {
                    at: e.span,
                    what: "`is`",
                    inside: "a world's predicate",
                    belongs: "in an entity, where it asks a reference; a predicate asks for a mode by `hero in MODE`",
                });
                None
            }
            ExprKind::Moved(both) => {
                self.diagnostics.report(Misplaced {
                    at: both[1].span,
                    what: "`at`",
                    inside: "this expression",
                    belongs: "after the own tag of a `touching`: `touching(body at (16, 0), wall)`",
                });
                None
            }
            // The guard of an edge, which `edge` reads.
            ExprKind::Else => None,
            ExprKind::Text(_) | ExprKind::Point(..) => {
                let found = if matches!(e.kind, ExprKind::Text(_)) { "a text" } else { "a point" };
                self.diagnostics.report(TypeMismatch {
                    at: e.span,
                    found: found.into(),
                    expected: wanted.map_or("a value".into(), |ty| self.described(*ty)),
                    help: None,
                });
                None
            }
        }
    }

    /// As [`Checker::allow`], of what a world may ask in its predicates and an entity where it may read `in_entity`.
    pub(super) fn allow_inside(
        &mut self,
        at: Span,
        scope: &Scope<'_>,
        in_entity: ReadLimit,
        what: &'static str,
    ) -> Option<()> {
        let needs = if scope.world.is_some() { ReadLimit::All } else { in_entity };
        let is_inside = scope.world.is_some() || scope.entity.is_some();
        self.allow(is_inside.then_some(()), at, scope, needs, what)
    }

    /// `item` if the scope has it and is allowed to read it.
    pub(super) fn allow<T>(
        &mut self,
        item: Option<T>,
        at: Span,
        scope: &Scope<'_>,
        needs: ReadLimit,
        what: &'static str,
    ) -> Option<T> {
        if item.is_some() && scope.reads >= needs {
            self.conditions.note_read(needs, what);
            return item;
        }
        if scope.world.is_some() {
            self.diagnostics.report(Misplaced {
                at,
                what,
                inside: "a world's predicate",
                belongs: "in an entity; a predicate reads instances, such as `hero.x` or `hero in dead`",
            });
        } else if needs == ReadLimit::Edges && scope.reads >= ReadLimit::State {
            let inside = "what flows, colliders and invariants read";
            self.diagnostics.report(Misplaced { at, what, inside, belongs: "in the guard or an update of an edge" });
        } else if scope.reads >= ReadLimit::All {
            let (inside, belongs) = if scope.entity.is_some() && scope.mode.is_none() && needs == ReadLimit::State {
                ("an entity outside of its modes", "inside a mode, or names one: `timer(MODE)`")
            } else {
                ("an entity", "in a `goal` or `never` of a world")
            };
            self.diagnostics.report(Misplaced { at, what, inside, belongs });
        } else {
            let (what, may_read) = scope.reads.words();
            self.diagnostics.report(NotConstant { at, what, may_read });
        }
        None
    }

    fn path(&mut self, path: &PathRef<'_>, span: Span, scope: &Scope<'_>, wanted: Option<&Type>) -> Option<Term> {
        let make = |kind: TermKind, ty: Type| Some(Term { kind, ty, span });
        let [name, rest @ ..] = &*path.segments else {
            return None;
        };
        if let [second, rest @ ..] = rest {
            if let Some(names) = scope.names
                && let Some(start) = self.start(path, names, span, scope)
            {
                return start;
            }
            let signal = rest.is_empty().then(|| self.signal_member(path, [name, second], span, scope)).flatten();
            return signal.unwrap_or_else(|| self.member(path, name, second, span, scope));
        }
        if let (Some(&Type::Set(set)), 0) = (wanted, path.primes)
            && let Some(index) = self.sets[set].names.iter().position(|v| *v == name.text)
        {
            self.record_set_value_use(set, name);
            return make(TermKind::Number(index as f64), Type::Set(set));
        }
        if let (Some(entity), Some(names)) = (scope.entity, scope.names) {
            if let Some(&id) = names.params.get(&name.text) {
                self.record_value_use(entity, Given::Param(id), name.span, Role::Read);
                self.unprimed(path)?;
                self.allow(Some(()), span, scope, ReadLimit::Params, "a parameter")?;
                return make(TermKind::Param(Subject::Me, id), entity.params[id].default.ty);
            }
            if let Some(&id) = names.vars.get(&name.text) {
                self.record_value_use(entity, Given::Var(id, 0), name.span, Role::Read);
                let degree = self.degree(path)?;
                self.allow(Some(()), span, scope, ReadLimit::State, "a variable")?;
                return make(TermKind::Var(Subject::Me, id, degree), Type::Real);
            }
            if let Some(&id) = names.discretes.get(&name.text) {
                self.record_value_use(entity, Given::Discrete(id), name.span, Role::Read);
                self.unprimed(path)?;
                self.allow(Some(()), span, scope, ReadLimit::State, "a variable")?;
                return make(TermKind::Discrete(Subject::Me, id), entity.discretes[id].ty);
            }
            if let Some(&id) = names.chances.get(&name.text) {
                self.record_use(NameKind::Chance, name.span, entity.chances[id].name.span);
                self.unprimed(path)?;
                self.allow(Some(()), span, scope, ReadLimit::All, "a chance")?;
                return make(TermKind::Chance(id), Type::Int);
            }
            if let Some(index) = self.visible_condition(&name.text, scope) {
                return self.used_condition(index, path, span, scope);
            }
            if let Some(&id) = names.axes.get(&name.text).filter(|_| path.primes == 0) {
                self.record_use(NameKind::Axis, name.span, entity.axes[id].span);
                self.allow(Some(()), span, scope, ReadLimit::All, "an axis")?;
                return make(TermKind::Axis(id), Type::Real);
            }
        }
        if scope.world.is_some()
            && let Some(index) = self.visible_condition(&name.text, scope)
        {
            return self.used_condition(index, path, span, scope);
        }
        if let Some((subject, entity)) = self.referred(&name.text, scope) {
            self.record_subject_use(subject, name, scope);
            self.unprimed(path)?;
            self.note_instance(subject, &name.text, span);
            self.allow(Some(()), span, scope, ReadLimit::State, "a reference")?;
            return make(TermKind::Instance(subject), Type::reference(entity));
        }
        if let Some((declared, constant)) = self.constants.entry(&name.text).filter(|_| path.primes == 0) {
            let (declared, term) = (declared.span, Term { span, ..constant.clone() });
            self.record_use(NameKind::Constant, name.span, declared);
            return Some(term);
        }
        if let Some((_, value)) = KNOWN_CONSTANTS.iter().find(|(known, _)| path.primes == 0 && *known == &*name.text) {
            return make(TermKind::Number(*value), Type::Real);
        }
        if scope.world.is_some_and(|w| w.instance(&name.text).is_some()) {
            self.diagnostics.report(TypeMismatch {
                at: span,
                found: "an instance".into(),
                expected: wanted.map_or("a value".into(), |ty| self.described(*ty)),
                help: Some(format!("`{0}.x` reads it, `{0} in MODE` and `{0} touching TAG` ask it", name.text)),
            });
            return None;
        }
        if self.signal_as_value(name, scope) {
            return None;
        }
        let meant = self.condition_elsewhere(&name.text, scope).or_else(|| suggestion(&name.text, scope));
        let meant = meant.or_else(|| self.unreferenced(&name.text, scope));
        let meant = meant.or_else(|| self.value_of_instance(&name.text, scope));
        let of_entity = scope.names.into_iter().flat_map(|names| {
            let plain = Some(names).filter(|_| path.primes == 0).into_iter();
            let plain = plain.flat_map(|n| {
                n.params.names().chain(n.discretes.names()).chain(n.axes.names()).chain(n.chances.names())
            });
            names.vars.names().chain(plain)
        });
        let set = wanted.and_then(|ty| if let Type::Set(set) = ty { Some(*set) } else { None });
        let values = set.into_iter().flat_map(|set| self.sets[set].names.iter().map(|v| Candidate::from(v.as_str())));
        let conditions = self.conditions.names(scope).filter(|_| path.primes == 0).map(Candidate::from);
        let known = of_entity.chain(values).chain(conditions).chain(self.constants.names());
        let kind = if path.primes > 0 { "continuous variable" } else { "variable, parameter or constant" };
        let fact = unknown(kind, &name.text, name.span, known).suggestion(meant);
        self.report_unknown(fact);
        None
    }

    /// Reports primes on something without a derivative.
    pub(super) fn unprimed(&mut self, path: &PathRef<'_>) -> Option<()> {
        if path.primes == 0 {
            return Some(());
        }
        self.diagnostics.report(TypeMismatch {
            at: path.span,
            found: "a derivative of what does not flow".into(),
            expected: "no primes".into(),
            help: Some("only `x`, `y` and `continuous` variables have derivatives".into()),
        });
        None
    }

    /// The degree of a variable written with primes.
    pub(super) fn degree(&mut self, path: &PathRef<'_>) -> Option<u8> {
        if path.primes > 2 {
            self.diagnostics.report(TypeMismatch {
                at: path.span,
                found: format!("a derivative of degree {}", path.primes),
                expected: "a variable, its first or its second derivative".into(),
                help: None,
            });
            return None;
        }
        Some(path.primes as u8)
    }

    /// Reports a reference to any entity where a specific one is needed.
    pub(super) fn of_any(&mut self, at: Span, what: &str) {
        self.diagnostics.report(TypeMismatch {
            at,
            found: "a reference to any entity".into(),
            expected: format!("a reference to a known entity, {what}"),
            help: Some("test it with `is ENTITY` in the same `and` before".into()),
        });
    }
}

//! Expressions: names resolved and types checked, with one scope for each place where an expression can stand.

use crate::diagnostic::catalogue::names::UnknownName;
use crate::diagnostic::catalogue::syntax::{Misplaced, NotSupported};
use crate::diagnostic::catalogue::types::{BadChain, NotConstant, TypeMismatch, WrongArguments};
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, CompareOp, Expr, ExprKind, Name, Path, Unit};

use super::Checker;
use super::checked::{Arithmetic, Entity, Function, Press, Side, Subject, Term, TermKind, Type};
use super::entity::Skeleton;
use super::ids::{EntityId, Id, ModeId, SlotId, SpaceId};
use super::mode::ModeNames;
use super::names::unknown;

/// Where an expression stands, and so what it may read.
#[derive(Clone, Copy)]
pub(super) struct Scope<'s> {
    /// The entity around it.
    pub entity: Option<&'s Entity>,
    /// Its names.
    pub names: Option<&'s Skeleton<'s>>,
    /// The mode around it.
    pub mode: Option<ModeId>,
    /// The world around it.
    pub world: Option<&'s WorldNames>,
    /// What its value must not depend on.
    pub reads: Reads,
}

/// How much an expression may read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Reads {
    /// Literals and constants.
    Constants,
    /// Parameters, too.
    Params,
    /// All but inputs and contacts.
    State,
    /// Everything.
    All,
}

impl Reads {
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Reads::Constants => ("this value", "literals and constants"),
            Reads::Params => ("this value", "literals, constants and parameters"),
            Reads::State | Reads::All => ("a collider", "variables, parameters, modes and timers"),
        }
    }
}

/// The names of a world that predicates may use.
#[derive(Debug, Default)]
pub(super) struct WorldNames {
    pub instances: Vec<(String, EntityId)>,
    pub spaces: Vec<(String, Option<(f64, f64)>)>,
}

impl<'s> Scope<'s> {
    /// Literals and constants only.
    pub fn constant() -> Self {
        Scope { entity: None, names: None, mode: None, world: None, reads: Reads::Constants }
    }

    /// Predicates of a world.
    pub fn predicate(world: &'s WorldNames) -> Self {
        Scope { world: Some(world), reads: Reads::All, ..Scope::constant() }
    }

    pub fn reading(self, reads: Reads) -> Self {
        Scope { reads, ..self }
    }
}

fn describe(ty: &Type) -> String {
    match ty {
        Type::Real => "a number".into(),
        Type::Int => "a whole number".into(),
        Type::Bool => "a truth value".into(),
        Type::Set(names) => format!("one of {{{}}}", names.join(", ")),
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

    /// The term if its value may stand where `ty` is needed: an int may stand where a real may.
    fn expect(&mut self, term: Term, ty: &Type) -> Option<Term> {
        if term.ty == *ty || (term.ty == Type::Int && *ty == Type::Real) {
            return Some(term);
        }
        let help = match (&term.ty, ty) {
            (Type::Real, Type::Int) => Some("make it whole with `floor`, `ceil` or `round`".to_string()),
            (Type::Real | Type::Int, Type::Bool) => Some("compare it with something".to_string()),
            _ => None,
        };
        self.diagnostics.report(TypeMismatch {
            at: term.span,
            found: describe(&term.ty),
            expected: describe(ty),
            help,
        });
        None
    }

    /// Reports an unknown name unless an earlier error explains it.
    pub(super) fn report_unknown(&mut self, fact: UnknownName) {
        if !self.suspects.contains(&fact.name) && !self.suspects.contains("*") {
            self.diagnostics.report(fact);
        }
    }

    fn term(&mut self, e: &Expr, scope: &Scope<'_>, wanted: Option<&Type>) -> Option<Term> {
        let make = |kind: TermKind, ty: Type| Some(Term { kind, ty, span: e.span });
        match &e.kind {
            ExprKind::Number(value, unit) => match unit {
                None => {
                    let ty = if value.fract() == 0.0 { Type::Int } else { Type::Real };
                    make(TermKind::Number(*value), ty)
                }
                Some(Unit::Seconds) => make(TermKind::Seconds(*value), Type::Real),
                // Divided, not multiplied by 0.001, so that 250ms is the same number as 0.25s.
                Some(Unit::Milliseconds) => make(TermKind::Seconds(value / 1000.0), Type::Real),
                Some(Unit::Frames) => make(TermKind::Frames(*value), Type::Real),
            },
            ExprKind::Bool(b) => make(TermKind::Bool(*b), Type::Bool),
            ExprKind::Timer => {
                let mode = self.allow(scope.mode, e.span, scope, Reads::State, "`timer`")?;
                make(TermKind::Timer(mode), Type::Real)
            }
            ExprKind::Paren(inner) => {
                let inner = self.term(inner, scope, wanted)?;
                Some(Term { span: e.span, ..inner })
            }
            ExprKind::Path(path) => self.path(path, e.span, scope, wanted),
            ExprKind::Call(function, arguments, binding) => {
                if let Some(binding) = binding {
                    self.diagnostics.report(NotSupported { at: binding.span, what: "`as`".into() });
                    return None;
                }
                self.call(function, arguments, e.span, scope, wanted)
            }
            ExprKind::InMode(path) => {
                let entity = self.allow(scope.entity, e.span, scope, Reads::State, "`in`")?;
                let names = scope.names?;
                let group = scope.mode.map(|m| entity.modes[m].group);
                let mode = self.mode_named(&names.modes, path, group)?;
                make(TermKind::InMode(Subject::Me, mode), Type::Bool)
            }
            ExprKind::Negate(a) => {
                let a = self.number(a, scope)?;
                let ty = a.ty.clone();
                make(TermKind::Negate(Box::new(a)), ty)
            }
            ExprKind::Not(a) => {
                let a = self.guard(a, scope)?;
                make(TermKind::Not(Box::new(a)), Type::Bool)
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, e.span, scope),
            ExprKind::Compare(first, rest) => self.comparison(first, rest, e.span, scope),
            ExprKind::In(subject, path) => self.relation(subject, e.span, scope, |this, slot, entity| {
                let names = ModeNames::of(&this.checked.entities[entity]);
                let mode = this.mode_named(&names, path, None)?;
                Some(TermKind::InMode(Subject::Slot(slot), mode))
            }),
            ExprKind::Touching(subject, tag) => {
                let other = self.tag(&tag.text);
                self.relation(subject, e.span, scope, |_, slot, _| {
                    Some(TermKind::Touching { of: Subject::Slot(slot), mine: None, other, side: None })
                })
            }
            ExprKind::Any(entity) => self.any(entity, e.span, scope, |_, _, _| Some(TermKind::Bool(true))),
            ExprKind::NoneRef | ExprKind::SelfRef | ExprKind::Is(..) => {
                self.diagnostics.report(NotSupported { at: e.span, what: "a reference".into() });
                None
            }
            ExprKind::Text(_) | ExprKind::Point(..) => {
                let found = if matches!(e.kind, ExprKind::Text(_)) { "a text" } else { "a point" };
                self.diagnostics.report(TypeMismatch {
                    at: e.span,
                    found: found.into(),
                    expected: wanted.map_or("a value".into(), describe),
                    help: None,
                });
                None
            }
        }
    }

    /// `item` if the scope has it and may read that much.
    fn allow<T>(
        &mut self,
        item: Option<T>,
        at: Span,
        scope: &Scope<'_>,
        needs: Reads,
        what: &'static str,
    ) -> Option<T> {
        if item.is_some() && scope.reads >= needs {
            return item;
        }
        if scope.world.is_some() {
            self.diagnostics.report(Misplaced {
                at,
                what,
                inside: "a world's predicate",
                belongs: "in an entity; a predicate reads instances, such as `hero.x` or `hero in dead`",
            });
        } else {
            let (what, may_read) = scope.reads.words();
            self.diagnostics.report(NotConstant { at, what, may_read });
        }
        None
    }

    fn path(&mut self, path: &Path, span: Span, scope: &Scope<'_>, wanted: Option<&Type>) -> Option<Term> {
        let make = |kind: TermKind, ty: Type| Some(Term { kind, ty, span });
        let [name, rest @ ..] = path.segments.as_slice() else {
            return None;
        };
        if let [second, ..] = rest {
            return self.member(path, name, second, span, scope);
        }
        if let (Some(Type::Set(values)), 0) = (wanted, path.primes) {
            if let Some(index) = values.iter().position(|v| *v == name.text) {
                return make(TermKind::Number(index as f64), Type::Set(values.clone()));
            }
        }
        if let (Some(entity), Some(names)) = (scope.entity, scope.names) {
            if let Some(&id) = names.params.get(&name.text).filter(|_| path.primes == 0) {
                self.allow(Some(()), span, scope, Reads::Params, "a parameter")?;
                return make(TermKind::Param(id), entity.params[id].default.ty.clone());
            }
            if let Some(&id) = names.vars.get(&name.text) {
                let degree = self.degree(path)?;
                self.allow(Some(()), span, scope, Reads::State, "a variable")?;
                return make(TermKind::Var(Subject::Me, id, degree), Type::Real);
            }
            if let Some(&id) = names.discretes.get(&name.text).filter(|_| path.primes == 0) {
                self.allow(Some(()), span, scope, Reads::State, "a variable")?;
                return make(TermKind::Discrete(Subject::Me, id), entity.discretes[id].ty.clone());
            }
            if let Some(&id) = names.axes.get(&name.text).filter(|_| path.primes == 0) {
                self.allow(Some(()), span, scope, Reads::All, "an axis")?;
                return make(TermKind::Axis(id), Type::Real);
            }
        }
        if let Some(constant) = self.constants.get(&name.text).filter(|_| path.primes == 0) {
            return Some(Term { span, ..constant.clone() });
        }
        if scope.world.is_some_and(|w| w.instances.iter().any(|(n, _)| *n == name.text)) {
            self.diagnostics.report(TypeMismatch {
                at: span,
                found: "an instance".into(),
                expected: wanted.map_or("a value".into(), describe),
                help: Some(format!("`{0}.x` reads it, `{0} in MODE` and `{0} touching TAG` ask it", name.text)),
            });
            return None;
        }
        let mut known: Vec<&str> = Vec::new();
        if let Some(names) = scope.names {
            known.extend(names.vars.names());
            if path.primes == 0 {
                known.extend(names.params.names().chain(names.discretes.names()).chain(names.axes.names()));
            }
        }
        if let Some(Type::Set(values)) = wanted {
            known.extend(values.iter().map(String::as_str));
        }
        known.extend(self.constants.names());
        let kind = if path.primes > 0 { "continuous variable" } else { "variable, parameter or constant" };
        let fact = unknown(kind, &name.text, name.span, known);
        self.report_unknown(fact);
        None
    }

    /// The degree of a variable written with primes.
    pub(super) fn degree(&mut self, path: &Path) -> Option<u8> {
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

    /// `hero.x'`, `hero.keys`, `main.width`.
    fn member(&mut self, path: &Path, first: &Name, second: &Name, span: Span, scope: &Scope<'_>) -> Option<Term> {
        let Some(world) = scope.world else {
            self.diagnostics.report(NotSupported { at: span, what: "reading another instance's variable".into() });
            return None;
        };
        if let Some(slot) = world.instances.iter().position(|(n, _)| *n == first.text) {
            let entity = &self.checked.entities[world.instances[slot].1];
            let of = Subject::Slot(SlotId(slot as u32));
            if let Some(var) = entity.vars.find(|v| v.name.text == second.text) {
                let degree = self.degree(path)?;
                return Some(Term { kind: TermKind::Var(of, var, degree), ty: Type::Real, span });
            }
            if let Some(id) = entity.discretes.find(|v| v.name.text == second.text) {
                let ty = entity.discretes[id].ty.clone();
                return Some(Term { kind: TermKind::Discrete(of, id), ty, span });
            }
            let known = entity.vars.iter().map(|v| &v.name).chain(entity.discretes.iter().map(|d| &d.name));
            let fact = unknown("variable", &second.text, second.span, known.map(|n| n.text.as_str()));
            self.report_unknown(fact);
            return None;
        }
        if let Some((_, size)) = world.spaces.iter().find(|(n, _)| *n == first.text) {
            let size = (*size)?;
            let value = match second.text.as_str() {
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
        let known = world.instances.iter().map(|(n, _)| n.as_str()).chain(world.spaces.iter().map(|(n, _)| n.as_str()));
        let fact = unknown("instance or space", &first.text, first.span, known);
        self.report_unknown(fact);
        None
    }

    fn binary(&mut self, op: BinaryOp, a: &Expr, b: &Expr, span: Span, scope: &Scope<'_>) -> Option<Term> {
        let arithmetic = match op {
            BinaryOp::And | BinaryOp::Or => {
                // Both sides are looked at, so that both can be wrong in one run.
                let (a, b) = (self.guard(a, scope), self.guard(b, scope));
                let (a, b) = (Box::new(a?), Box::new(b?));
                let kind = if op == BinaryOp::And { TermKind::And(a, b) } else { TermKind::Or(a, b) };
                return Some(Term { kind, ty: Type::Bool, span });
            }
            BinaryOp::Add => Arithmetic::Add,
            BinaryOp::Subtract => Arithmetic::Subtract,
            BinaryOp::Multiply => Arithmetic::Multiply,
            BinaryOp::Divide => Arithmetic::Divide,
        };
        let (a, b) = (self.number(a, scope), self.number(b, scope));
        let (a, b) = (a?, b?);
        let whole = a.ty == Type::Int && b.ty == Type::Int && op != BinaryOp::Divide;
        let ty = if whole { Type::Int } else { Type::Real };
        Some(Term { kind: TermKind::Arithmetic(arithmetic, Box::new(a), Box::new(b)), ty, span })
    }

    fn comparison(&mut self, first: &Expr, rest: &[(CompareOp, Expr)], span: Span, scope: &Scope<'_>) -> Option<Term> {
        let up = |op: &CompareOp| matches!(op, CompareOp::Less | CompareOp::AtMost | CompareOp::Equal);
        let down = |op: &CompareOp| matches!(op, CompareOp::Greater | CompareOp::AtLeast | CompareOp::Equal);
        let one_way = rest.iter().all(|(op, _)| up(op)) || rest.iter().all(|(op, _)| down(op));
        if rest.len() > 1 && !one_way {
            self.diagnostics.report(BadChain { at: span });
            return None;
        }
        let mut left = first;
        let mut chain: Option<Term> = None;
        for (op, right) in rest {
            let link = self.compare(*op, left, right, scope)?;
            chain = Some(match chain {
                None => link,
                Some(before) => Term { kind: TermKind::And(Box::new(before), Box::new(link)), ty: Type::Bool, span },
            });
            left = right;
        }
        chain
    }

    fn compare(&mut self, op: CompareOp, left: &Expr, right: &Expr, scope: &Scope<'_>) -> Option<Term> {
        let span = left.span.to(right.span);
        let equality = matches!(op, CompareOp::Equal | CompareOp::Unequal);
        // The type of one side helps to read the other: `facing == left`, `left == facing`.
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
        Some(Term { kind: TermKind::Compare(op, Box::new(a), Box::new(b)), ty: Type::Bool, span })
    }

    /// The type of a plain discrete variable that ranges over a set.
    fn set_type(&self, e: &Expr, scope: &Scope<'_>) -> Option<Type> {
        let ExprKind::Path(path) = &e.kind else {
            return None;
        };
        let ty = match (path.segments.as_slice(), scope.world) {
            ([name], _) => {
                let id = *scope.names?.discretes.get(&name.text)?;
                &scope.entity?.discretes[id].ty
            }
            ([instance, name], Some(world)) => {
                let (_, entity) = world.instances.iter().find(|(n, _)| *n == instance.text)?;
                let entity = &self.checked.entities[*entity];
                &entity.discretes[entity.discretes.find(|d| d.name.text == name.text)?].ty
            }
            _ => return None,
        };
        matches!(ty, Type::Set(_)).then(|| ty.clone())
    }

    fn call(
        &mut self,
        function: &Name,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wanted: Option<&Type>,
    ) -> Option<Term> {
        let make = |kind: TermKind, ty: Type| Some(Term { kind, ty, span });
        let wrong = |this: &mut Self, usage: &'static str| {
            this.diagnostics.report(WrongArguments { function: function.text.clone(), at: span, usage });
        };
        let (numeric, usage) = match function.text.as_str() {
            "min" => (Function::Min, "`min(a, b)`"),
            "max" => (Function::Max, "`max(a, b)`"),
            "abs" => (Function::Abs, "`abs(a)`"),
            "sign" => (Function::Sign, "`sign(a)`"),
            "clamp" => (Function::Clamp, "`clamp(value, low, high)`"),
            "floor" => (Function::Floor, "`floor(a)`"),
            "ceil" => (Function::Ceil, "`ceil(a)`"),
            "round" => (Function::Round, "`round(a)`"),
            "sqrt" => (Function::Sqrt, "`sqrt(a)`"),
            "if" => {
                let [condition, a, b] = arguments else {
                    wrong(self, "`if(condition, a, b)`");
                    return None;
                };
                let condition = self.guard(condition, scope);
                let a = self.term(a, scope, wanted);
                let b = self.term(b, scope, wanted);
                let (condition, a, b) = (condition?, a?, b?);
                let ty = match (&a.ty, &b.ty) {
                    (Type::Int, Type::Real) | (Type::Real, Type::Int) => Type::Real,
                    _ => a.ty.clone(),
                };
                let b = self.expect(b, &ty)?;
                return make(TermKind::Call(Function::If, vec![condition, a, b]), ty);
            }
            "sin" | "cos" | "atan2" => {
                self.diagnostics.report(NotSupported { at: function.span, what: format!("`{}`", function.text) });
                return None;
            }
            "entering" | "exiting" | "lost" => {
                self.diagnostics.report(NotSupported { at: function.span, what: format!("`{}`", function.text) });
                return None;
            }
            "pressed" | "held" | "released" => {
                return self.button(function, arguments, span, scope);
            }
            "touching" => return self.touching(arguments, span, scope, wrong),
            "timer" => {
                let [Expr { kind: ExprKind::Path(path), .. }] = arguments else {
                    wrong(self, "`timer(mode)`");
                    return None;
                };
                let entity = self.allow(scope.entity, span, scope, Reads::State, "`timer`")?;
                let group = scope.mode.map(|m| entity.modes[m].group);
                let mode = self.mode_named(&scope.names?.modes, path, group)?;
                return make(TermKind::Timer(mode), Type::Real);
            }
            "near" => return self.near(arguments, span, scope, wrong),
            "inside" => {
                let [subject, Expr { kind: ExprKind::Path(path), .. }] = arguments else {
                    wrong(self, "`inside(instance, space)`");
                    return None;
                };
                let world = self.allow(scope.world, span, scope, Reads::All, "`inside`")?;
                let name = path.segments.first()?;
                let Some(space) = world.spaces.iter().position(|(n, _)| *n == name.text) else {
                    let known = world.spaces.iter().map(|(n, _)| n.as_str());
                    let fact = unknown("space", &name.text, name.span, known);
                    self.report_unknown(fact);
                    return None;
                };
                return self.relation(subject, span, scope, |_, slot, _| {
                    Some(TermKind::InSpace(Subject::Slot(slot), SpaceId::from_index(space)))
                });
            }
            other => {
                let known = [
                    "min", "max", "abs", "sign", "clamp", "floor", "ceil", "round", "sqrt", "if", "pressed", "held",
                    "released", "touching", "timer", "near", "inside",
                ];
                let fact = unknown("function", other, function.span, known);
                self.report_unknown(fact);
                return None;
            }
        };
        let count = match numeric {
            Function::Min | Function::Max => 2,
            Function::Clamp => 3,
            _ => 1,
        };
        if arguments.len() != count {
            wrong(self, usage);
            return None;
        }
        let args: Vec<Option<Term>> = arguments.iter().map(|a| self.number(a, scope)).collect();
        let args: Vec<Term> = args.into_iter().collect::<Option<_>>()?;
        let ty = match numeric {
            Function::Floor | Function::Ceil | Function::Round | Function::Sign => Type::Int,
            Function::Sqrt => Type::Real,
            _ if args.iter().all(|a| a.ty == Type::Int) => Type::Int,
            _ => Type::Real,
        };
        make(TermKind::Call(numeric, args), ty)
    }

    fn button(&mut self, function: &Name, arguments: &[Expr], span: Span, scope: &Scope<'_>) -> Option<Term> {
        let [Expr { kind: ExprKind::Path(path), .. }] = arguments else {
            let usage = "a button of this entity, such as `pressed(jump)`";
            self.diagnostics.report(WrongArguments { function: function.text.clone(), at: span, usage });
            return None;
        };
        let names = self.allow(scope.names, span, scope, Reads::All, "a button")?;
        let name = path.segments.first()?;
        let press = match function.text.as_str() {
            "pressed" => Press::Pressed,
            "held" => Press::Held,
            _ => Press::Released,
        };
        if let Some(&button) = names.buttons.get(&name.text).filter(|_| path.segments.len() == 1) {
            return Some(Term { kind: TermKind::Button(press, button), ty: Type::Bool, span });
        }
        let fact = unknown("button", &name.text, name.span, names.buttons.names());
        self.report_unknown(fact);
        None
    }

    fn touching(
        &mut self,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        const USAGE: &str =
            "`touching(tag)`, `touching(tag, side)`, `touching(own tag, tag)` or `touching(own tag, tag, side)`";
        self.allow(scope.entity, span, scope, Reads::All, "`touching`")?;
        let mut words = Vec::new();
        for argument in arguments {
            match &argument.kind {
                ExprKind::Path(Path { segments, primes: 0, .. }) if segments.len() == 1 => {
                    words.extend(segments.first().map(|s| s.text.clone()));
                }
                ExprKind::Text(text) => words.push(text.clone()),
                _ => {
                    wrong(self, USAGE);
                    return None;
                }
            }
        }
        let side = |word: &str| {
            Some(match word {
                "left" => Side::Left,
                "right" => Side::Right,
                "above" => Side::Above,
                "below" => Side::Below,
                _ => return None,
            })
        };
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (mine, other, on) = match words.as_slice() {
            [other] => (None, *other, None),
            [other, on] if side(on).is_some() => (None, *other, side(on)),
            [mine, other] => (Some(*mine), *other, None),
            [mine, other, on] if side(on).is_some() => (Some(*mine), *other, side(on)),
            [_, _, on] => {
                let at = arguments.last().map_or(span, |a| a.span);
                self.diagnostics.report(unknown("side", on, at, ["left", "right", "above", "below"]));
                return None;
            }
            _ => {
                wrong(self, USAGE);
                return None;
            }
        };
        let mine = mine.map(|tag| self.tag(tag));
        let other = self.tag(other);
        Some(Term { kind: TermKind::Touching { of: Subject::Me, mine, other, side: on }, ty: Type::Bool, span })
    }

    fn near(
        &mut self,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        let [subject, place, radius] = arguments else {
            wrong(self, "`near(instance, (x, y), radius)` or `near(instance, instance, radius)`");
            return None;
        };
        self.allow(scope.world, span, scope, Reads::All, "`near`")?;
        let (x, y) = if let ExprKind::Point(x, y) = &place.kind {
            let (x, y) = (self.number(x, scope), self.number(y, scope));
            (x?, y?)
        } else {
            let (slot, _) = self.instance(place, scope)?;
            let read =
                |var| Term { kind: TermKind::Var(Subject::Slot(slot), var, 0), ty: Type::Real, span: place.span };
            (read(super::entity::X), read(super::entity::Y))
        };
        let radius = self.number(radius, scope)?;
        self.relation(subject, span, scope, |_, slot, _| {
            Some(TermKind::Near {
                of: Subject::Slot(slot),
                x: Box::new(x.clone()),
                y: Box::new(y.clone()),
                radius: Box::new(radius.clone()),
            })
        })
    }

    /// A named instance of the world.
    fn instance(&mut self, e: &Expr, scope: &Scope<'_>) -> Option<(SlotId, EntityId)> {
        let world = self.allow(scope.world, e.span, scope, Reads::All, "an instance")?;
        let name = match &e.kind {
            ExprKind::Path(path) if path.segments.len() == 1 && path.primes == 0 => path.segments.first()?,
            _ => {
                self.diagnostics.report(TypeMismatch {
                    at: e.span,
                    found: "an expression".into(),
                    expected: "the name of an instance".into(),
                    help: None,
                });
                return None;
            }
        };
        if let Some(slot) = world.instances.iter().position(|(n, _)| *n == name.text) {
            return Some((SlotId(slot as u32), world.instances[slot].1));
        }
        let fact = unknown("instance", &name.text, name.span, world.instances.iter().map(|(n, _)| n.as_str()));
        self.report_unknown(fact);
        None
    }

    /// What `make` says of the instance, or of any instance of an entity, that stands left of `in` or `touching`.
    fn relation(
        &mut self,
        subject: &Expr,
        span: Span,
        scope: &Scope<'_>,
        make: impl Fn(&mut Self, SlotId, EntityId) -> Option<TermKind>,
    ) -> Option<Term> {
        if let ExprKind::Any(entity) = &subject.kind {
            return self.any(entity, span, scope, make);
        }
        if scope.world.is_none() {
            self.diagnostics.report(NotSupported { at: span, what: "asking another instance".into() });
            return None;
        }
        let (slot, entity) = self.instance(subject, scope)?;
        Some(Term { kind: make(self, slot, entity)?, ty: Type::Bool, span })
    }

    /// Whether `make` holds for some instance of an entity.
    fn any(
        &mut self,
        name: &Name,
        span: Span,
        scope: &Scope<'_>,
        make: impl Fn(&mut Self, SlotId, EntityId) -> Option<TermKind>,
    ) -> Option<Term> {
        let world = self.allow(scope.world, span, scope, Reads::All, "`any`")?;
        let Some(&entity) = self.entities.get(&name.text) else {
            let fact = unknown("entity", &name.text, name.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        let mut some = Vec::new();
        for (slot, (_, of)) in world.instances.iter().enumerate() {
            if *of == entity {
                some.push(Term { kind: make(self, SlotId(slot as u32), entity)?, ty: Type::Bool, span });
            }
        }
        // A balanced tree: thousands of instances must not become thousands of levels.
        while some.len() > 1 {
            let mut halves = Vec::with_capacity(some.len().div_ceil(2));
            let mut rest = some.into_iter();
            while let Some(a) = rest.next() {
                halves.push(match rest.next() {
                    Some(b) => Term { kind: TermKind::Or(Box::new(a), Box::new(b)), ty: Type::Bool, span },
                    None => a,
                });
            }
            some = halves;
        }
        Some(some.pop().unwrap_or(Term { kind: TermKind::Bool(false), ty: Type::Bool, span }))
    }
}

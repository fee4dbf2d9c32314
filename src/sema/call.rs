//! Calls: functions of numbers, buttons, contacts, timers.

use crate::diagnostic::catalogue::structure::JointCycle;
use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::WrongArguments;
use crate::ir::{Function, Id, Press, Side, SpaceId, Subject};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Name, PathRef};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{BoundTouch, Term, TermKind, Touching, Type};
use super::expression::{ReadLimit, Scope};
use super::foreign;
use super::names::unknown;

/// The names of all functions and of the atoms of guards.
pub(crate) const FUNCTIONS: &[&str] = &[
    "min", "max", "abs", "sign", "clamp", "floor", "ceil", "round", "sqrt", "sin", "cos", "atan2", "mod", "if",
    "pressed", "held", "released", "touching", "timer", "entering", "exiting", "lost", "near", "distance", "inside",
    "count", "received",
];

impl Checker<'_> {
    pub(super) fn call(
        &mut self,
        function: &Name,
        arguments: &[Expr],
        binding: Option<&Name>,
        span: Span,
        scope: &Scope<'_>,
        wanted: Option<&Type>,
    ) -> Option<Term> {
        if let Some(binding) = binding
            && (function.text != "touching" || !self.facts.bindable)
        {
            self.misplaced_binding(binding.span);
            return None;
        }
        let make = |kind: TermKind, ty: Type| Some(Term { kind, ty, span });
        let wrong = |this: &mut Self, usage: &'static str| {
            this.diagnostics.report(WrongArguments { function: function.text.to_string(), at: span, usage });
        };
        let (numeric, usage) = match &*function.text {
            "min" => (Function::Min, "`min(a, b)`"),
            "max" => (Function::Max, "`max(a, b)`"),
            "abs" => (Function::Abs, "`abs(a)`"),
            "sign" => (Function::Sign, "`sign(a)`"),
            "clamp" => (Function::Clamp, "`clamp(value, low, high)`"),
            "floor" => (Function::Floor, "`floor(a)`"),
            "ceil" => (Function::Ceil, "`ceil(a)`"),
            "round" => (Function::Round, "`round(a)`"),
            "sqrt" => (Function::Sqrt, "`sqrt(a)`"),
            "sin" => (Function::Sin, "`sin(angle)`"),
            "cos" => (Function::Cos, "`cos(angle)`"),
            "atan2" => (Function::Atan2, "`atan2(y, x)`"),
            "mod" => (Function::Mod, "`mod(a, b)`"),
            "if" => {
                let [condition, a, b] = arguments else {
                    wrong(self, "`if(condition, a, b)`");
                    return None;
                };
                let condition = self.guard(condition, scope);
                let mark = self.facts.mark();
                let branch = |this: &mut Self, e: &Expr, outcome: bool| {
                    if let Some(condition) = &condition {
                        this.facts.learn(condition, outcome);
                    }
                    let term = this.term(e, scope, wanted);
                    this.facts.forget(mark);
                    term
                };
                let a = branch(self, a, true);
                let b = branch(self, b, false);
                let (condition, a, b) = (condition?, a?, b?);
                let ty = match (&a.ty, &b.ty) {
                    (Type::Int, Type::Real) | (Type::Real, Type::Int) => Type::Real,
                    _ => a.ty,
                };
                let b = self.expect(b, &ty)?;
                return make(TermKind::Call(Box::new((Function::If, [condition, a, b].into()))), ty);
            }
            "entering" | "exiting" => {
                let Some(path) = only(arguments) else {
                    wrong(self, "a mode of another group, such as `entering(hurt.yes)`");
                    return None;
                };
                let entity = self.allow(scope.entity, span, scope, ReadLimit::All, "a joint transition")?;
                let mode = self.mode_named(&scope.names?.modes, &path, None)?;
                let group = entity.modes[mode].group;
                if scope.mode.is_some_and(|m| entity.modes[m].group == group) {
                    let name =
                        entity.groups[group].name.as_ref().map_or("the modes".into(), |n| format!("`{}`", n.text));
                    self.diagnostics.report(JointCycle { steps: vec![(name, span)] });
                    return None;
                }
                self.conditions.note_group(group);
                return make(TermKind::Joint { mode, entering: function.text == "entering" }, Type::Bool);
            }
            "lost" => {
                let [reference] = arguments else {
                    wrong(self, "a reference, such as `lost(target)`");
                    return None;
                };
                self.allow(scope.entity, span, scope, ReadLimit::State, "`lost`")?;
                let (subject, _) = self.reference(reference, scope)?;
                self.note_instance_of(subject, reference);
                return make(TermKind::IsNone(subject), Type::Bool);
            }
            "pressed" | "held" | "released" => {
                return self.button(function, arguments, span, scope);
            }
            "touching" => return self.touching(arguments, binding, span, scope, wrong),
            "timer" => {
                let Some(path) = only(arguments) else {
                    wrong(self, "`timer(mode)`");
                    return None;
                };
                let entity = self.allow(scope.entity, span, scope, ReadLimit::State, "`timer`")?;
                let group = scope.mode.map(|m| entity.modes[m].group);
                let mode = self.mode_named(&scope.names?.modes, &path, group)?;
                return make(TermKind::Timer(mode), Type::Real);
            }
            "near" => return self.near(arguments, span, scope, wrong),
            "distance" => return self.distance(arguments, span, scope, wrong),
            "count" => return self.count(arguments, span, scope, wrong),
            "received" => return self.received(arguments, span, scope),
            "inside" => {
                let [subject, space] = arguments else {
                    wrong(self, "`inside(instance, space)`");
                    return None;
                };
                let Some(path) = space.path() else {
                    wrong(self, "`inside(instance, space)`");
                    return None;
                };
                let world = self.allow(scope.world, span, scope, ReadLimit::All, "`inside`")?;
                let Some(name) = path.name() else {
                    wrong(self, "`inside(instance, space)`");
                    return None;
                };
                let known = world.spaces.iter().find(|(n, _)| n.text == name.text);
                if let Some((declared, _)) = known {
                    self.record_use(NameKind::Space, name.span, declared.span);
                }
                let Some(space) = world.spaces.iter().position(|(n, _)| n.text == name.text) else {
                    let known = world.spaces.iter().map(|(n, _)| n);
                    let fact = unknown("space", &name.text, name.span, known);
                    self.report_unknown(fact);
                    return None;
                };
                return self.relation(subject, span, scope, |_, of, _| {
                    Some(TermKind::InSpace(of, SpaceId::from_index(space)))
                });
            }
            other => {
                let meant = foreign::function(other);
                let fact = unknown("function", other, function.span, FUNCTIONS.iter().copied()).suggestion(meant);
                self.report_unknown(fact);
                return None;
            }
        };
        let count = match numeric {
            Function::Min | Function::Max | Function::Atan2 | Function::Mod => 2,
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
            Function::Sqrt | Function::Sin | Function::Cos | Function::Atan2 => Type::Real,
            _ if args.iter().all(|a| a.ty == Type::Int) => Type::Int,
            _ => Type::Real,
        };
        make(TermKind::Call(Box::new((numeric, args.into()))), ty)
    }

    /// Reports an `as` that can bind nothing.
    pub(super) fn misplaced_binding(&mut self, at: Span) {
        self.diagnostics.report(Misplaced {
            at,
            what: "`as`",
            inside: if self.conditions.are_checked() { "a condition" } else { "this expression" },
            belongs: "after `touching(…)` or `nearest …` in the guard of an edge, outside of `not` and `or`",
        });
    }

    pub(super) fn button(
        &mut self,
        function: &Name,
        arguments: &[Expr],
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Term> {
        let Some(path) = only(arguments).filter(|path| path.primes == 0) else {
            let usage = "a button of this entity, such as `pressed(jump)`";
            self.diagnostics.report(WrongArguments { function: function.text.to_string(), at: span, usage });
            return None;
        };
        let names = self.allow(scope.names, span, scope, ReadLimit::All, "a button")?;
        let name = path.segments.first()?;
        let press = match &*function.text {
            "pressed" => Press::Pressed,
            "held" => Press::Held,
            _ => Press::Released,
        };
        if let Some((declared, &button)) = names.buttons.entry(&name.text).filter(|_| path.segments.len() == 1) {
            self.record_use(NameKind::Button, name.span, declared.span);
            return Some(Term { kind: TermKind::Button(press, button), ty: Type::Bool, span });
        }
        let written = path.segments.iter().map(|s| &*s.text).collect::<Vec<_>>().join(".");
        let fact = unknown("button", &written, path.span, names.buttons.names());
        self.report_unknown(fact.suggestion(foreign::button(&written, scope)));
        None
    }

    pub(super) fn touching(
        &mut self,
        arguments: &[Expr],
        binding: Option<&Name>,
        span: Span,
        scope: &Scope<'_>,
        wrong: impl Fn(&mut Self, &'static str),
    ) -> Option<Term> {
        const USAGE: &str =
            "`touching(tag)`, `touching(tag, side)`, `touching(own tag, tag)` or `touching(own tag, tag, side)`";
        if let [Expr { kind: ExprKind::Moved(moved), .. }, rest @ ..] = arguments {
            return self.probe(moved, rest, binding, span, scope);
        }
        if arguments.iter().any(|argument| matches!(argument.kind, ExprKind::Moved(_))) {
            wrong(self, "the own tag first: `touching(own tag at (x, y), tag)`");
            return None;
        }
        self.allow(scope.entity, span, scope, ReadLimit::All, "`touching`")?;
        let mut words: Vec<Name> = Vec::new();
        for argument in arguments {
            let text = match &argument.kind {
                ExprKind::Text(text) => Some((**text).clone()),
                _ => argument.name().map(|name| name.text),
            };
            let Some(text) = text else {
                wrong(self, USAGE);
                return None;
            };
            words.push(Name { text, span: argument.span });
        }
        let side = |word: &Name| Side::named(&word.text);
        let (mine, other, on) = match words.as_slice() {
            [other] => (None, other, None),
            [other, on] if side(on).is_some() => (None, other, side(on)),
            [mine, other] => (Some(mine), other, None),
            [mine, other, on] if side(on).is_some() => (Some(mine), other, side(on)),
            [_, _, on] => {
                let fact = unknown("side", &on.text, on.span, Side::ALL.map(Side::name));
                self.diagnostics.report(fact.meaning(foreign::side(&on.text)));
                return None;
            }
            _ => {
                wrong(self, USAGE);
                return None;
            }
        };
        let mine = mine.map(|tag| self.tag(tag));
        let other = self.tag(other);
        if let Some(name) = binding {
            self.record_declaration(NameKind::Touched, name);
        }
        let bound = binding.map(|name| self.facts.name(name, BoundTouch { mine, other, side: on, span }));
        let touching = Touching { of: Subject::Me, mine, other, side: on, bound };
        Some(Term { kind: TermKind::Touching(Box::new(touching)), ty: Type::Bool, span })
    }
}

/// The single argument, if it is a path.
fn only(arguments: &[Expr]) -> Option<PathRef<'_>> {
    match arguments {
        [path] => path.path(),
        _ => None,
    }
}

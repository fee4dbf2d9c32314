//! Copies the members of a behaviour: spans move to the copy's file, arguments replace parameters.

use crate::source::{FileId, Span};

use super::ast::{
    Appearance, Assignment, Constant, Dimension, Domain, Expr, ExprKind, Initial, Member, Name, Path, RampKind, Rate,
    Receivers, Update, Variable,
};
use super::scan::MAX_OPERATORS;

/// The substitution of a copy.
pub(super) struct Substitution {
    /// The file of the behaviour.
    pub from: FileId,
    /// The file of the copy.
    pub to: FileId,
    /// The argument of each parameter.
    pub arguments: Vec<(String, Expr)>,
    /// The first expression that exceeds the limit.
    pub too_long: Option<Span>,
    /// The spans and indices of replaced parameters.
    pub replaced: Vec<(Span, usize)>,
}

impl Substitution {
    fn span(&self, span: &mut Span) {
        if span.file() == self.from {
            *span = span.in_file(self.to);
        }
    }

    fn name(&self, name: &mut Name) {
        self.span(&mut name.span);
    }

    fn variable(&self, variable: &mut Variable) {
        self.span(&mut variable.span);
    }

    /// A path whose first name may be a parameter for a path.
    fn path(&mut self, path: &mut Path) {
        match path {
            Path::Name(_, _, span) => self.span(span),
            Path::Dotted(dotted) => {
                dotted.segments.iter_mut().for_each(|s| self.name(s));
                self.span(&mut dotted.span);
            }
        }
        let view = path.view();
        let Some(first) = view.segments.first() else { return };
        let Some(parameter) = self.parameter(&first.text) else { return };
        if let Some(inner) = self.arguments.get(parameter).and_then(|(_, argument)| argument.path())
            && inner.primes == 0
        {
            self.replaced.push((first.span, parameter));
            let segments = inner.segments.iter().chain(view.segments.iter().skip(1)).cloned().collect();
            *path = Path::new(segments, view.primes, view.span);
        }
    }

    fn parameter(&self, name: &str) -> Option<usize> {
        self.arguments.iter().position(|(n, _)| n == name)
    }

    /// A member and all inside it.
    pub fn member(&mut self, member: &mut Member) {
        match member {
            Member::Parameter(p) => self.constant(p),
            Member::Continuous(c) => {
                self.name(&mut c.name);
                c.dimension.iter_mut().for_each(|d| self.dimension(d));
                c.initial.iter_mut().for_each(|e| self.whole(e));
            }
            Member::Discrete(d) => {
                self.name(&mut d.name);
                match &mut d.domain {
                    Domain::Int(low, high) => {
                        self.whole(low);
                        self.whole(high);
                    }
                    Domain::Set(names) => names.iter_mut().for_each(|n| self.name(n)),
                    Domain::Bool => {}
                }
                self.whole(&mut d.initial);
            }
            Member::Buttons(list) | Member::Axes(list) => {
                let (names, span) = &mut **list;
                names.iter_mut().for_each(|n| self.name(n));
                self.span(span);
            }
            Member::Chance(c) => {
                self.name(&mut c.name);
                self.whole(&mut c.low);
                self.whole(&mut c.high);
                self.span(&mut c.span);
            }
            Member::Collider(c) => {
                c.tags.iter_mut().for_each(|t| self.name(t));
                self.name(&mut c.shape);
                c.arguments.iter_mut().chain(&mut c.guard).for_each(|e| self.whole(e));
                self.span(&mut c.span);
            }
            Member::Group(g) => {
                self.name(&mut g.name);
                g.members.iter_mut().for_each(|m| self.member(m));
                self.span(&mut g.span);
            }
            Member::Mode(m) => {
                if let Initial::When(guard) = &mut m.initial {
                    self.whole(guard);
                }
                self.name(&mut m.name);
                m.members.iter_mut().for_each(|m| self.member(m));
                self.span(&mut m.span);
            }
            Member::Reference(r) => {
                self.name(&mut r.name);
                self.name(&mut r.entity);
            }
            Member::Clamp(c) => {
                self.variable(&mut c.variable);
                c.low.iter_mut().chain(&mut c.high).for_each(|e| self.whole(e));
                self.span(&mut c.span);
            }
            Member::Invariant(i) => {
                self.whole(&mut i.predicate);
                self.span(&mut i.span);
            }
            Member::Condition(c) => {
                self.name(&mut c.name);
                self.whole(&mut c.value);
                self.span(&mut c.span);
            }
            Member::Signals(list) => {
                let (signals, span) = &mut **list;
                for signal in signals {
                    self.name(&mut signal.name);
                    if let Some((name, dimension)) = &mut signal.number {
                        self.name(name);
                        dimension.iter_mut().for_each(|d| self.dimension(d));
                    }
                    self.span(&mut signal.span);
                }
                self.span(span);
            }
            Member::Look(look) => {
                match &mut look.appearance {
                    Appearance::Color(name) | Appearance::Picture(name) => self.name(name),
                }
                self.span(&mut look.span);
            }
            Member::Flow(a) => self.assignment(a),
            Member::Entry(u) => self.update(u),
            Member::Edge(e) => {
                self.whole(&mut e.guard);
                e.target.iter_mut().for_each(|t| self.path(t));
                e.updates.iter_mut().for_each(|u| self.update(u));
                self.span(&mut e.span);
            }
            Member::Envelope(e) => {
                e.controlled.iter_mut().for_each(|v| self.variable(v));
                e.by.iter_mut().for_each(|e| self.whole(e));
                e.directions.iter_mut().for_each(|n| self.name(n));
                for ramp in &mut e.ramps {
                    self.ramp(&mut ramp.kind);
                    self.span(&mut ramp.span);
                }
                self.span(&mut e.span);
            }
            Member::Follow(f) => {
                f.guard.iter_mut().for_each(|e| self.whole(e));
                f.updates.iter_mut().for_each(|u| self.update(u));
                self.span(&mut f.span);
            }
            Member::Use(u) => {
                self.name(&mut u.behavior);
                u.arguments.iter_mut().for_each(|a| self.assignment(a));
                self.span(&mut u.span);
            }
        }
    }

    fn constant(&mut self, constant: &mut Constant) {
        self.name(&mut constant.name);
        constant.dimension.iter_mut().for_each(|d| self.dimension(d));
        self.whole(&mut constant.value);
    }

    fn dimension(&mut self, dimension: &mut Dimension) {
        self.span(&mut dimension.span);
        dimension.factors.iter_mut().for_each(|(name, _)| self.name(name));
    }

    fn assignment(&mut self, a: &mut Assignment) {
        self.variable(&mut a.variable);
        self.whole(&mut a.value);
    }

    fn update(&mut self, update: &mut Update) {
        match update {
            Update::Assign(a) => self.assignment(a),
            Update::Spawn(s) => {
                s.into.iter_mut().for_each(|v| self.variable(v));
                self.name(&mut s.entity);
                s.settings.iter_mut().for_each(|a| self.assignment(a));
                self.span(&mut s.span);
            }
            Update::Destroy(d) => {
                self.whole(&mut d.what);
                self.span(&mut d.span);
            }
            Update::Send(s) => {
                match &mut s.to {
                    Receivers::One(of) => self.whole(of),
                    Receivers::All(entity) => self.name(entity),
                }
                self.name(&mut s.signal);
                s.number.iter_mut().for_each(|e| self.whole(e));
                self.span(&mut s.span);
            }
        }
    }

    fn ramp(&mut self, ramp: &mut RampKind) {
        match ramp {
            RampKind::Attack(rate, level) => {
                self.rate(rate);
                level.iter_mut().for_each(|e| self.whole(e));
            }
            RampKind::Decay(rate) => self.rate(rate),
            RampKind::Sustain(e) | RampKind::SustainFor(e) | RampKind::While(e) => self.whole(e),
            RampKind::Release(rate, level) => {
                rate.iter_mut().for_each(|r| self.rate(r));
                level.iter_mut().for_each(|e| self.whole(e));
            }
            RampKind::ReleaseHold => {}
        }
    }

    fn rate(&mut self, rate: &mut Rate) {
        if let Rate::Accel(e) | Rate::Over(e) = rate {
            self.whole(e);
        }
    }

    /// A complete expression; its length is limited.
    fn whole(&mut self, e: &mut Expr) {
        let mut operators = 0;
        self.expression(e, &mut operators);
        if operators > MAX_OPERATORS && self.too_long.is_none() {
            self.too_long = Some(e.span);
        }
    }

    /// An expression; adds up its operators.
    fn expression(&mut self, e: &mut Expr, operators: &mut usize) {
        self.span(&mut e.span);
        if matches!(e.kind, ExprKind::Name(..) | ExprKind::Path(_)) {
            let parameter = e.name().and_then(|name| Some((name.span, self.parameter(&name.text)?)));
            let Some((at, (index, (_, argument)))) =
                parameter.and_then(|(at, index)| Some((at, (index, self.arguments.get(index)?))))
            else {
                let mut path = match std::mem::replace(&mut e.kind, ExprKind::NoneRef) {
                    ExprKind::Name(text, primes) => Path::Name(text, primes, e.span),
                    ExprKind::Path(dotted) => Path::Dotted(dotted),
                    other => {
                        e.kind = other;
                        return;
                    }
                };
                self.path(&mut path);
                e.kind = path.into();
                return;
            };
            self.replaced.push((at, index));
            *operators += count(argument);
            // The argument is parenthesised, except for names: those of buttons and tags are no values.
            *e = match argument.kind {
                ExprKind::Name(..) | ExprKind::Path(_) | ExprKind::Text(_) => argument.clone(),
                _ => Expr { kind: ExprKind::Paren(Box::new(argument.clone())), span: e.span },
            };
            return;
        }
        match &mut e.kind {
            ExprKind::Number(..)
            | ExprKind::Bool(_)
            | ExprKind::NoneRef
            | ExprKind::SelfRef
            | ExprKind::Timer
            | ExprKind::Text(_)
            | ExprKind::Else
            | ExprKind::Name(..)
            | ExprKind::Path(_) => {}
            ExprKind::Call(call) => {
                let super::ast::Call { function, arguments, binding } = &mut **call;
                self.name(function);
                binding.iter_mut().for_each(|b| self.name(b));
                arguments.iter_mut().for_each(|a| self.expression(a, operators));
            }
            ExprKind::InMode(path) => self.path(path),
            ExprKind::Any(name) | ExprKind::All(name) => self.name(name),
            ExprKind::Each(each) => {
                // The first name is an entity, never a parameter.
                match &mut each.path {
                    Path::Name(_, _, span) => self.span(span),
                    Path::Dotted(dotted) => {
                        dotted.segments.iter_mut().for_each(|s| self.name(s));
                        self.span(&mut dotted.span);
                    }
                }
            }
            ExprKind::Nearest(nearest) => {
                let super::ast::Nearest { entity, mode, within, binding } = &mut **nearest;
                self.name(entity);
                mode.iter_mut().for_each(|mode| self.path(mode));
                within.iter_mut().for_each(|limit| self.expression(limit, operators));
                binding.iter_mut().for_each(|b| self.name(b));
            }
            ExprKind::Point(both) | ExprKind::Moved(both) => {
                both.iter_mut().for_each(|e| self.expression(e, operators));
            }
            ExprKind::Paren(a) => self.expression(a, operators),
            ExprKind::Negate(a) | ExprKind::Not(a) => {
                *operators += 1;
                self.expression(a, operators);
            }
            ExprKind::Binary(_, both) | ExprKind::Compare(_, both) => {
                *operators += 1;
                both.iter_mut().for_each(|e| self.expression(e, operators));
            }
            ExprKind::Chain(chain) => {
                let (first, rest) = &mut **chain;
                self.expression(first, operators);
                for (_, b) in rest {
                    *operators += 1;
                    self.expression(b, operators);
                }
            }
            ExprKind::In(operands) => {
                let (a, path) = &mut **operands;
                self.expression(a, operators);
                self.path(path);
            }
            ExprKind::Is(operands) => {
                let (a, name) = &mut **operands;
                self.expression(a, operators);
                name.iter_mut().for_each(|n| self.name(n));
            }
            ExprKind::Touching(operands) => {
                let (a, name) = &mut **operands;
                self.expression(a, operators);
                self.name(name);
            }
        }
    }
}

/// The number of operators of an expression.
fn count(e: &Expr) -> usize {
    match &e.kind {
        ExprKind::Call(call) => call.arguments.iter().map(count).sum(),
        ExprKind::Point(both) | ExprKind::Moved(both) => both.iter().map(count).sum(),
        ExprKind::Paren(a) => count(a),
        ExprKind::In(operands) => count(&operands.0),
        ExprKind::Is(operands) => count(&operands.0),
        ExprKind::Touching(operands) => count(&operands.0),
        ExprKind::Nearest(nearest) => nearest.within.as_ref().map_or(0, count),
        ExprKind::Negate(a) | ExprKind::Not(a) => 1 + count(a),
        ExprKind::Binary(_, both) | ExprKind::Compare(_, both) => 1 + both.iter().map(count).sum::<usize>(),
        ExprKind::Chain(chain) => count(&chain.0) + chain.1.iter().map(|(_, b)| 1 + count(b)).sum::<usize>(),
        _ => 0,
    }
}

//! Lowers terms into the arena: operands before operators, constants folded, contact queries and timers numbered.

use std::sync::Arc;

use crate::sema::checked::{self, Term, TermKind, Type};
use crate::sema::{ConstantContext, evaluate};
use crate::source::Span;

use crate::ir::{
    Arena, Arithmetic, Entity, EntityId, Expr, ExprId, Function, ModeId, Program, SlotId, Subject, TagId, TagSet,
    Timer, TimerId, Touch, TouchId,
};

/// The context in which a term is lowered: it determines the ids of its contact queries.
pub(super) struct Context<'a> {
    /// The entity whose code it is, for `Subject::Me`.
    pub me: Option<EntityId>,
    /// The entity of each slot of the world, for `Subject::Slot`.
    pub slots: &'a dyn Fn(SlotId) -> EntityId,
    /// Whether the instance of a slot can never be destroyed.
    pub indestructible: &'a dyn Fn(SlotId) -> bool,
    /// The number of tiles of the world with a tag, and whether any of them can be broken; none in an entity.
    pub tiles: Option<&'a dyn Fn(TagId) -> (usize, bool)>,
}

impl Context<'_> {
    fn entity(&self, of: Subject) -> EntityId {
        match of {
            Subject::Me => self.me.unwrap_or(EntityId(0)),
            Subject::Slot(slot) => (self.slots)(slot),
            // Contact queries exist only for the instance itself, for named instances and for members.
            Subject::Ref(_) | Subject::Touched(_) | Subject::Probed(_) => self.me.unwrap_or(EntityId(0)),
            Subject::Member(entity) => entity,
        }
    }
}

impl Program {
    pub(super) fn entity_mut(&mut self, id: EntityId) -> &mut Entity {
        Arc::make_mut(&mut self.entities[id])
    }

    pub(super) fn push(&mut self, expr: Expr, span: Span) -> ExprId {
        self.spans.exprs.push(span);
        self.exprs.push(expr)
    }

    /// Appends a term to the arena.
    pub(super) fn term(&mut self, term: &Term, context: &Context<'_>) -> ExprId {
        if let Ok(value) = evaluate(term, ConstantContext::LITERALS) {
            let folded = if term.ty == Type::Bool { Expr::Bool(value != 0.0) } else { Expr::Number(value) };
            return self.push(folded, term.span);
        }
        let expr = match &term.kind {
            TermKind::Number(n) => Expr::Number(*n),
            TermKind::Quantity(quantity) => Expr::Number(quantity.0),
            TermKind::Frames(n) => Expr::Frames(*n),
            TermKind::Bool(b) => Expr::Bool(*b),
            TermKind::Param(of, p) => Expr::Param(*of, *p),
            TermKind::Joint { mode, entering } => Expr::Joint(*mode, *entering),
            TermKind::Received(signal) => Expr::Received(*signal),
            TermKind::Sum(sum) => Expr::Sum(*sum),
            TermKind::IsNone(of) => Expr::IsNone(*of),
            TermKind::Is(of, entity) => Expr::Is(*of, *entity),
            TermKind::Alive(slot) => Expr::Alive(*slot),
            // References as values are lowered where they are assigned.
            TermKind::NoneRef | TermKind::Instance(_) => Expr::Bool(false),
            TermKind::Var(of, var, degree) => Expr::Var(*of, *var, *degree),
            TermKind::Discrete(of, id) => Expr::Discrete(*of, *id),
            TermKind::Axis(axis) => Expr::Axis(*axis),
            TermKind::Chance(chance) => Expr::Chance(*chance),
            TermKind::Timer(mode) => {
                let timer = self.timer(context.entity(Subject::Me), *mode);
                Expr::Timer(timer)
            }
            TermKind::Negate(a) => Expr::Negate(self.term(a, context)),
            TermKind::Arithmetic(op, sides) => {
                let [a, b] = sides.as_ref();
                let (a, b) = (self.term(a, context), self.term(b, context));
                Expr::Arithmetic(*op, a, b)
            }
            TermKind::Call(call) => {
                let (function, args) = call.as_ref();
                let ids: Vec<ExprId> = args.iter().map(|a| self.term(a, context)).collect();
                let at = |i: usize| ids.get(i).or(ids.last()).copied().unwrap_or(ExprId(0));
                Expr::Call(*function, [at(0), at(1), at(2)])
            }
            TermKind::Compare(op, sides) => {
                let [a, b] = sides.as_ref();
                let (left, right) = (self.term(a, context), self.term(b, context));
                Expr::Compare(*op, left, right)
            }
            TermKind::And(sides) => {
                let [a, b] = sides.as_ref();
                if let TermKind::Alive(slot) = a.kind
                    && (context.indestructible)(slot)
                {
                    return self.term(b, context);
                }
                let (a, b) = (self.term(a, context), self.term(b, context));
                Expr::And(a, b)
            }
            TermKind::Or(sides) => {
                let [a, b] = sides.as_ref();
                let (a, b) = (self.term(a, context), self.term(b, context));
                Expr::Or(a, b)
            }
            TermKind::Not(a) => Expr::Not(self.term(a, context)),
            TermKind::Button(press, button) => Expr::Button(*press, *button),
            TermKind::Touching(touching) => {
                let checked::Touching { of, mine, other, side, bound } = **touching;
                let touch = bound.unwrap_or_else(|| {
                    let mine = mine.map_or(TagSet::ALL, TagSet::of);
                    self.touch(context.entity(of), Touch { mine, other, side, bound: false, tiles: false }, term.span)
                });
                Expr::Touching(of, touch)
            }
            TermKind::Probe(asked) => {
                let checked::Probe { mine, other, offset, bound } = &**asked;
                if let Some(probe) = bound.and_then(|id| self.entities[context.entity(Subject::Me)].probes.get(id)) {
                    return *probe;
                }
                let offset = offset.each_ref().map(|offset| self.term(offset, context));
                Expr::Probe { mine: *mine, other: *other, offset, bound: false, tiles: false }
            }
            TermKind::InMode(of, mode) => Expr::InMode(*of, *mode),
            TermKind::InSpace(of, space) => Expr::InSpace(*of, *space),
            TermKind::Members(asked) => Expr::Count { of: asked.of, holds: self.term(&asked.holds, context) },
            TermKind::Nearest(asked) => {
                let own = &self.entities[context.entity(Subject::Me)];
                if let Some(probe) = asked.bound.and_then(|id| own.probes.get(id)) {
                    return *probe;
                }
                Expr::Nearest { of: asked.of, holds: self.term(&asked.holds, context) }
            }
            TermKind::Distance(asked) => {
                let (of, point) = asked.as_ref();
                let [x, y] = point.each_ref().map(|number| self.term(number, context));
                Expr::Distance { of: *of, x, y }
            }
            TermKind::Count(of) => return self.count(of, context, term.span),
            TermKind::Tiles(tag) => {
                let all = match context.tiles.map(|tiles| tiles(*tag)) {
                    Some((count, false)) => return self.push(Expr::Number(count as f64), term.span),
                    Some((count, true)) => Expr::Number(count as f64),
                    // Code of an entity runs in all worlds.
                    None => Expr::Tiles(*tag),
                };
                let all = self.push(all, term.span);
                let broken = self.push(Expr::Broken(*tag), term.span);
                Expr::Arithmetic(Arithmetic::Subtract, all, broken)
            }
            TermKind::Near(touching) => {
                let (of, numbers) = touching.as_ref();
                let [x, y, radius] = numbers.each_ref().map(|number| self.term(number, context));
                Expr::Near { of: *of, x, y, radius }
            }
        };
        self.push(expr, term.span)
    }

    /// The number of truth values that hold, as a balanced sum: thousands must not nest thousands of levels deep.
    fn count(&mut self, of: &[Term], context: &Context<'_>, span: Span) -> ExprId {
        if let [half @ .., _] = of
            && !half.is_empty()
        {
            let (a, b) = of.split_at(of.len() / 2);
            let (a, b) = (self.count(a, context, span), self.count(b, context, span));
            return self.push(Expr::Arithmetic(Arithmetic::Add, a, b), span);
        }
        let Some(only) = of.first() else { return self.push(Expr::Number(0.0), span) };
        let holds = self.term(only, context);
        let (one, zero) = (self.push(Expr::Number(1.0), span), self.push(Expr::Number(0.0), span));
        self.push(Expr::Call(Function::If, [holds, one, zero]), span)
    }

    /// The id of a contact query of an entity.
    fn touch(&mut self, entity: EntityId, touch: Touch, span: Span) -> TouchId {
        let touches = &mut Arc::make_mut(&mut self.entities[entity]).touches;
        touches.find(|t| *t == touch).unwrap_or_else(|| {
            self.spans.entities[entity].touches.push(span);
            touches.push(touch)
        })
    }

    pub(super) fn timer(&mut self, entity: EntityId, mode: ModeId) -> TimerId {
        let timers = &mut self.entity_mut(entity).timers;
        timers.find(|t| t.mode == mode).unwrap_or_else(|| timers.push(Timer { mode, thresholds: Some(Vec::new()) }))
    }

    /// Fills in the values that each timer is compared with, once all code of the entity is in the arena.
    pub(super) fn timer_thresholds(&mut self, entity: EntityId, from: ExprId, to: ExprId) {
        let count = self.entities[entity].timers.len();
        let mut uses = vec![0usize; count];
        let mut thresholds: Vec<Vec<ExprId>> = vec![Vec::new(); count];
        for id in from.0..to.0 {
            match self.exprs[ExprId(id)] {
                Expr::Timer(timer) => uses[timer.0 as usize] += 1,
                Expr::Compare(_, a, b) => {
                    for (timer, other) in [(a, b), (b, a)] {
                        if let Expr::Timer(timer) = self.exprs[timer]
                            && known_per_instance(&self.exprs, other)
                        {
                            thresholds[timer.0 as usize].push(other);
                        }
                    }
                }
                _ => {}
            }
        }
        // A timed envelope ends after the sum of its parts.
        for envelope in self.entities[entity].envelopes.iter() {
            if let crate::ir::By::Clock { timer, total, .. } = envelope.by {
                uses[timer.0 as usize] += 1;
                if known_per_instance(&self.exprs, total) {
                    thresholds[timer.0 as usize].push(total);
                }
            }
        }
        for (index, timer) in self.entity_mut(entity).timers.iter_mut().enumerate() {
            let compared = std::mem::take(&mut thresholds[index]);
            timer.thresholds = (compared.len() == uses[index]).then_some(compared);
        }
    }
}

/// Whether an expression reads nothing but parameters and the step.
pub(super) fn known_per_instance(exprs: &Arena<ExprId, Expr>, id: ExprId) -> bool {
    let known = |id| known_per_instance(exprs, id);
    match exprs[id] {
        Expr::Number(_) | Expr::Frames(_) | Expr::Bool(_) | Expr::Param(Subject::Me, _) => true,
        Expr::Negate(a) | Expr::Not(a) => known(a),
        Expr::Arithmetic(_, a, b) | Expr::Compare(_, a, b) | Expr::And(a, b) | Expr::Or(a, b) => known(a) && known(b),
        Expr::Call(_, args) => args.into_iter().all(known),
        _ => false,
    }
}

/// The duration of a ramp, s: given, or derived from its rate and `distance`.
pub(super) fn duration(
    program: &mut Program,
    rate: &checked::Rate,
    distance: ExprId,
    context: &Context<'_>,
    span: Span,
) -> ExprId {
    match rate {
        checked::Rate::Instant => program.push(Expr::Number(0.0), span),
        checked::Rate::Over(time) => program.term(time, context),
        checked::Rate::Accel(a) => {
            let a = program.term(a, context);
            program.push(Expr::Arithmetic(Arithmetic::Divide, distance, a), span)
        }
    }
}

/// The rate of a ramp, per second: given, or derived from its duration and `distance`; `None` is immediate.
pub(super) fn rate(
    program: &mut Program,
    rate: &checked::Rate,
    distance: ExprId,
    context: &Context<'_>,
    span: Span,
) -> Option<ExprId> {
    match rate {
        checked::Rate::Instant => None,
        checked::Rate::Accel(a) => Some(program.term(a, context)),
        checked::Rate::Over(time) => {
            let time = program.term(time, context);
            Some(program.push(Expr::Arithmetic(Arithmetic::Divide, distance, time), span))
        }
    }
}

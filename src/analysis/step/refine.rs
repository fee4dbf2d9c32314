//! Refinement of configurations by guards: what is left of one where a guard holds, or fails.

use crate::ir::{CompareOp, Expr, ExprId, Function, Subject, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};

use super::evaluate::Reader;

impl Reader<'_> {
    /// Refines a configuration by a guard that holds (or fails); `None` if it cannot.
    pub fn refined(&self, from: &Configuration, guard: ExprId, holds: bool) -> Option<Configuration> {
        if !self.can_evaluate_to(from, guard, holds) {
            return None;
        }
        let mut out = from.clone();
        self.refine_possible(&mut out, guard, holds).then_some(out)
    }

    fn can_evaluate_to(&self, at: &Configuration, guard: ExprId, holds: bool) -> bool {
        let reader = Reader { me: self.me.map(|(me, _)| (me, at)), ..*self };
        let truth = reader.truth(guard);
        if holds { truth.can_hold } else { truth.can_fail }
    }

    /// Refines a configuration in place by a guard that holds (or fails); returns whether it can.
    pub fn refine(&self, at: &mut Configuration, guard: ExprId, holds: bool) -> bool {
        self.can_evaluate_to(at, guard, holds) && self.refine_possible(at, guard, holds)
    }

    /// The same for a guard that can.
    fn refine_possible(&self, at: &mut Configuration, guard: ExprId, holds: bool) -> bool {
        let Some((me, _)) = self.me else { return false };
        match (self.program.exprs[guard], holds) {
            (Expr::Not(a), _) => self.refine(at, a, !holds),
            (Expr::And(a, b), true) => self.refine(at, a, true) && self.after(a).refine(at, b, true),
            (Expr::Or(a, b), false) => self.refine(at, a, false) && self.refine(at, b, false),
            (Expr::And(a, b), false) | (Expr::Or(a, b), true) => {
                // Either decides; the second counts only where the first does not.
                let first = self.refined(at, a, holds);
                let rest = if holds { *self } else { self.after(a) };
                let has_second = self.refine(at, a, !holds) && rest.refine(at, b, holds);
                match first {
                    Some(first) if has_second => *at = first.or(at),
                    Some(first) => *at = first,
                    None => return has_second,
                }
                true
            }
            (Expr::Compare(op, a, b), _) => {
                let op = if holds { op } else { op.negated() };
                let reader = Reader { me: Some((me, at)), ..*self };
                let (left, right) = (reader.number(a), reader.number(b));
                self.cut(at, a, op, &right);
                self.cut(at, b, op.mirrored(), &left);
                !at.is_impossible()
            }
            (Expr::Touching(Subject::Me, touch), true) => {
                let boxes = self.touched(me, touch, at);
                for axis in 0..2 {
                    let var = VarId::XY[axis];
                    let places = match &boxes {
                        Some(boxes) => Values::any(boxes.iter().map(|b| b[axis])),
                        None => self.surroundings.places(me, touch)[axis],
                    };
                    at.set(var, 0, at.vars[var][0].and(&places));
                }
                !at.is_impossible()
            }
            (Expr::Touching(Subject::Me, touch), false) if !self.is_within_step() => {
                let Some(left) = self.untouched(me, touch, at) else { return false };
                for (var, left) in VarId::XY.into_iter().zip(left) {
                    at.set(var, 0, left);
                }
                true
            }
            (Expr::Probe { .. }, _) => self.refine_by_probe(at, guard, holds),
            _ => true,
        }
    }

    /// Restricts a variable by a comparison.
    fn cut(&self, out: &mut Configuration, id: ExprId, op: CompareOp, with: &Values) {
        let Some(hull) = with.hull() else { return };
        let cut = |values: &Values, whole: bool| restrict_by(values, op, with, whole);
        match self.program.exprs[id] {
            Expr::Var(Subject::Me, var, degree) => {
                out.set(var, usize::from(degree), cut(&out.vars[var][usize::from(degree)], false));
            }
            Expr::Call(Function::Abs, [of, ..]) => {
                if let Expr::Var(Subject::Me, var, degree) = self.program.exprs[of] {
                    let size = cut(&Values::from(Interval { low: 0.0, high: f64::INFINITY }), false);
                    out.set(var, usize::from(degree), out.vars[var][usize::from(degree)].and(&size.mirrored()));
                }
            }
            Expr::Discrete(Subject::Me, id) => {
                out.set_discrete(id, cut(&out.discretes[id], true));
            }
            Expr::Param(Subject::Me, id) if out.params.get(id).is_some() => {
                let left = cut(&out.params[id], false);
                if left != out.params[id] {
                    out.params[id] = left;
                }
            }
            Expr::Timer(timer) => {
                // One step of tolerance, as times are rounded.
                let step = self.world.step.seconds();
                let cut = match op {
                    CompareOp::Less | CompareOp::AtMost => {
                        Interval { low: 0.0, high: (hull.high / step).floor() + 1.0 }
                    }
                    CompareOp::Greater | CompareOp::AtLeast => {
                        Interval { low: (hull.low / step).ceil() - 1.0, high: f64::INFINITY }
                    }
                    _ => return,
                };
                if let Some(rest) = out.timers[timer].and(cut) {
                    out.timers[timer] = rest;
                }
            }
            _ => {}
        }
    }
}

/// Restricts values by a comparison; `whole` numbers stop short of an open end.
pub(in crate::analysis) fn restrict_by(values: &Values, op: CompareOp, with: &Values, whole: bool) -> Values {
    let Some(hull) = with.hull() else { return *values };
    let less = if whole { hull.high.ceil() - 1.0 } else { hull.high };
    let more = if whole { hull.low.floor() + 1.0 } else { hull.low };
    match op {
        CompareOp::Equal => values.and(with),
        CompareOp::Unequal => with.constant().map_or_else(|| *values, |x| values.without(x)),
        CompareOp::Less => values.within(Interval { low: f64::NEG_INFINITY, high: less }),
        CompareOp::AtMost => values.within(Interval { low: f64::NEG_INFINITY, high: hull.high }),
        CompareOp::Greater => values.within(Interval { low: more, high: f64::INFINITY }),
        CompareOp::AtLeast => values.within(Interval { low: hull.low, high: f64::INFINITY }),
    }
}

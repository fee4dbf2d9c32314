//! Expressions of the arena against a state. A fault is noted on the side and the first one counts, so that the
//! common case is a plain number.

use std::cell::Cell;

use crate::ir::{
    Arithmetic, AxisId, ButtonId, Choice, Entity, Expr, ExprId, Function, Id, LeafId, ModeId, Press, Slot, SlotId,
    SlotLayout, Subject, VarId, arithmetic, call, compare,
};

use super::fault::{Fault, FaultKind};
use super::input::Frame;
use super::simulator::Simulator;

/// What an expression is read against.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    pub sim: &'a Simulator<'a>,
    pub state: &'a [u8],
    pub frames: &'a [Frame],
    pub fault: &'a Cell<Option<Fault>>,
    /// The instance that `Subject::Me` stands for.
    pub me: SlotId,
}

impl<'a> Reader<'a> {
    fn slot(&self, of: Subject) -> SlotId {
        match of {
            Subject::Me => self.me,
            Subject::Slot(slot) => slot,
        }
    }

    fn layout(&self, of: Subject) -> &'a SlotLayout {
        &self.sim.world().layout.slots[self.slot(of)]
    }

    fn entity(&self, of: Subject) -> &'a Entity {
        &self.sim.program().entities[self.sim.world().slots[self.slot(of)].entity]
    }

    fn my_slot(&self) -> &'a Slot {
        &self.sim.world().slots[self.me]
    }

    fn frame(&self) -> Option<&Frame> {
        self.my_slot().player.and_then(|p| self.frames.get(p.index()))
    }

    fn checked(&self, id: ExprId, value: f64, operands: [f64; 2]) -> f64 {
        if value.is_finite() {
            return value;
        }
        self.note(FaultKind::NotFinite(id, operands));
        0.0
    }

    /// Notes a fault unless there is one already.
    #[cold]
    pub fn note(&self, kind: FaultKind) {
        if self.fault.get().is_none() {
            self.fault.set(Some(Fault { slot: self.me, kind }));
        }
    }

    /// The value of an axis, 0 where nobody controls the instance.
    pub fn axis(&self, axis: AxisId) -> f64 {
        self.frame().and_then(|f| f.axes.get(axis.index()).copied()).unwrap_or(0.0)
    }

    /// The first mode of some whose guard holds, or `otherwise`.
    pub fn chosen(&self, choices: &[Choice], otherwise: ModeId) -> ModeId {
        choices.iter().find(|c| self.truth(c.guard)).map_or(otherwise, |c| c.mode)
    }

    /// The leaf that becomes active when a mode of one's own is entered.
    pub fn entered(&self, mode: ModeId) -> LeafId {
        let modes = &self.entity(Subject::Me).modes;
        let mut at = &modes[mode];
        while at.chooses {
            let Some(inner) = at.inner else { break };
            at = &modes[self.chosen(&at.choices, inner)];
        }
        at.initial
    }

    fn button(&self, press: Press, button: ButtonId) -> bool {
        self.frame().is_some_and(|f| {
            let bits = match press {
                Press::Pressed => f.pressed,
                Press::Held => f.held,
                Press::Released => f.released,
            };
            bits >> button.index() & 1 == 1
        })
    }

    /// An expression as a number.
    pub fn number(&self, id: ExprId) -> f64 {
        match self.sim.program().exprs[id] {
            Expr::Number(n) => n,
            Expr::Param(p) => self.my_slot().params[p],
            Expr::Var(of, var, degree) => self.layout(of).var(self.state, var, degree),
            Expr::Discrete(of, discrete) => f64::from(self.layout(of).discrete(self.state, discrete)),
            Expr::Axis(axis) => self.axis(axis),
            Expr::Timer(timer) => self.sim.world().step.times(self.layout(Subject::Me).timer(self.state, timer)),
            Expr::Frames(n) => n * self.sim.world().step.seconds(),
            Expr::Negate(a) => -self.number(a),
            Expr::Arithmetic(op, a, b) => {
                let (a, b) = (self.number(a), self.number(b));
                if op == Arithmetic::Divide && b == 0.0 {
                    self.note(FaultKind::DivisionByZero(id, a));
                    return 0.0;
                }
                self.checked(id, arithmetic(op, a, b), [a, b])
            }
            Expr::Call(Function::If, [condition, a, b]) => self.number(if self.truth(condition) { a } else { b }),
            Expr::Call(function, [a, b, c]) => {
                let (a, b, c) = (self.number(a), self.number(b), self.number(c));
                self.checked(id, call(function, [a, b, c]), [a, b])
            }
            Expr::Bool(_)
            | Expr::Compare(..)
            | Expr::And(..)
            | Expr::Or(..)
            | Expr::Not(_)
            | Expr::Button(..)
            | Expr::Touching(..)
            | Expr::InMode(..)
            | Expr::InSpace(..)
            | Expr::Near { .. } => f64::from(u8::from(self.truth(id))),
        }
    }

    /// An expression as a truth value.
    pub fn truth(&self, id: ExprId) -> bool {
        match self.sim.program().exprs[id] {
            Expr::Bool(b) => b,
            Expr::Compare(op, a, b) => compare(op, self.number(a), self.number(b)),
            Expr::And(a, b) => self.truth(a) && self.truth(b),
            Expr::Or(a, b) => self.truth(a) || self.truth(b),
            Expr::Not(a) => !self.truth(a),
            Expr::Button(press, button) => self.button(press, button),
            Expr::Touching(of, touch) => self.layout(of).touch(self.state, touch),
            Expr::InMode(of, mode) => {
                let mode = &self.entity(of).modes[mode];
                let leaf = self.layout(of).leaf(self.state, mode.group);
                mode.leaves.0 <= leaf && leaf < mode.leaves.1
            }
            Expr::InSpace(of, space) => self.layout(of).space(self.state) == space,
            Expr::Near { of, x, y, radius } => {
                let (px, py) = self.position(of);
                let (dx, dy) = (px - self.number(x), py - self.number(y));
                (dx * dx + dy * dy).sqrt() <= self.number(radius)
            }
            Expr::Number(_)
            | Expr::Param(_)
            | Expr::Var(..)
            | Expr::Discrete(..)
            | Expr::Axis(_)
            | Expr::Timer(_)
            | Expr::Frames(_)
            | Expr::Negate(_)
            | Expr::Arithmetic(..)
            | Expr::Call(..) => self.number(id) != 0.0,
        }
    }

    fn position(&self, of: Subject) -> (f64, f64) {
        let layout = self.layout(of);
        (layout.var(self.state, VarId(0), 0), layout.var(self.state, VarId(1), 0))
    }
}

//! Evaluates expressions on a state. The first fault is stored separately, so that the common case is a plain number.

use std::cell::Cell;

use crate::ir::{
    Arithmetic, AxisId, ButtonId, Choice, Expr, ExprId, Function, Id, LeafId, ModeId, ParamId, Press, ProbeId,
    RefValue, SlotId, SlotLayout, Subject, TileId, arithmetic, call, compare,
};

use super::actor::Actor;
use super::chance::Frames;
use super::discrete::TakenEdge;
use super::fault::{Fault, FaultKind};
use super::input::Frame;
use super::probe::Found;
use super::simulator::Simulator;

/// The context of evaluation.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    pub sim: &'a Simulator,
    pub state: &'a [u8],
    pub frames: &'a Frames,
    /// The transitions of the instance's groups in this step, as far as they are decided.
    pub taken: &'a [Option<TakenEdge>],
    pub fault: &'a Cell<Option<Fault>>,
    /// The instance of `Subject::Me`; `None` for a predicate of the world.
    pub actor: Option<&'a Actor>,
    /// Its slot.
    pub me: SlotId,
    /// The instance that a question to each asks.
    pub member: SlotId,
    /// The expressions; the first has the id `base`.
    pub code: &'a [Expr],
    pub base: u32,
}

impl<'a> Reader<'a> {
    /// The instance of a subject, if there is one.
    #[inline]
    pub fn instance(&self, of: Subject) -> Option<SlotId> {
        match of {
            Subject::Me => Some(self.me),
            Subject::Slot(slot) => Some(slot),
            Subject::Ref(id) => self.own_layout().reference(self.state, id),
            Subject::Touched(id) => self.own_layout().touched(self.state, id),
            Subject::Probed(id) => self.probed(id),
            Subject::Member(_) => Some(self.member),
        }
    }

    /// The instance that a probe finds: looked up anew, for the state that is read is the one that the guard asked.
    #[cold]
    fn probed(&self, id: ProbeId) -> Option<SlotId> {
        let probe = *self.actor?.entity.probes.get(id)?;
        if let Expr::Nearest { of, holds } = *self.at(probe) {
            return self.sim.nearest_member(self, of, holds);
        }
        match self.probe(probe) {
            Found::Instance(slot) => Some(slot),
            Found::Nothing | Found::Static | Found::Tile(_) => None,
        }
    }

    /// The breakable tile that a value stands for, where it is no instance.
    #[cold]
    pub fn tile(&self, value: RefValue) -> Option<TileId> {
        match value {
            RefValue::Of(Subject::Touched(id)) => self.sim.tile_touched(self.state, self.actor?, id),
            RefValue::Of(Subject::Probed(id)) => match self.probe(*self.actor?.entity.probes.get(id)?) {
                Found::Tile(tile) => Some(tile),
                Found::Nothing | Found::Static | Found::Instance(_) => None,
            },
            RefValue::None | RefValue::Of(Subject::Me | Subject::Slot(_) | Subject::Ref(_) | Subject::Member(_)) => {
                None
            }
        }
    }

    /// What a probe finds.
    #[inline(never)]
    fn probe(&self, id: ExprId) -> Found {
        let Expr::Probe { mine, other, offset: [x, y], bound, tiles } = *self.at(id) else { return Found::Nothing };
        self.sim.probe(self, (mine, other), [self.number(x), self.number(y)], (bound, tiles))
    }

    /// The layout of the reader's own instance.
    #[inline(always)]
    pub fn own_layout(&self) -> &'a SlotLayout {
        match self.actor {
            Some(actor) => &actor.layout,
            None => self.sim.layout(self.me),
        }
    }

    #[inline(always)]
    fn at(&self, id: ExprId) -> &'a Expr {
        &self.code[(id.0 - self.base) as usize]
    }

    /// The layout of a subject's instance; records a fault if there is none.
    fn layout(&self, of: Subject, at: ExprId) -> Option<&'a SlotLayout> {
        if of == Subject::Me {
            return Some(self.own_layout());
        }
        match self.instance(of) {
            Some(slot) => Some(self.sim.layout(slot)),
            None => {
                self.note(FaultKind::ReadNone(at));
                None
            }
        }
    }

    fn param(&self, of: Subject, id: ParamId, at: ExprId) -> f64 {
        let Some(slot) = self.instance(of) else {
            self.note(FaultKind::ReadNone(at));
            return 0.0;
        };
        self.sim.param(self.state, slot, id)
    }

    // Not inlined: it is rare, and would enlarge every guard.
    #[inline(never)]
    fn joint(&self, mode: ModeId, entering: bool) -> bool {
        let entity = self.sim.entity(self.me);
        let taken = self.taken.get(entity.modes[mode].group.index());
        let Some(Some(TakenEdge { transition, .. })) = taken.copied() else { return false };
        if entering { transition.enters(entity, mode) } else { transition.leaves(entity, mode) }
    }

    #[inline]
    fn frame(&self) -> Option<&Frame> {
        self.actor.and_then(|actor| self.frames.of(actor))
    }

    pub fn checked(&self, id: ExprId, value: f64, operands: [f64; 2]) -> f64 {
        if value.is_finite() {
            return value;
        }
        self.note(FaultKind::NotFinite(id, operands));
        0.0
    }

    /// Records a fault unless there is one already.
    #[cold]
    pub fn note(&self, kind: FaultKind) {
        if self.fault.get().is_none() {
            self.fault.set(Some(Fault { slot: self.me, kind }));
        }
    }

    /// The value of an axis; 0 if no player controls the instance.
    #[inline]
    pub fn axis(&self, axis: AxisId) -> f64 {
        self.frame().and_then(|f| f.axes.get(axis.index()).copied()).unwrap_or(0.0)
    }

    /// The mode of the first choice whose guard holds, or `otherwise`.
    pub fn chosen(&self, choices: &[Choice], otherwise: ModeId) -> ModeId {
        choices.iter().find(|c| self.truth(c.guard)).map_or(otherwise, |c| c.mode)
    }

    /// The leaf that becomes active when a mode of the instance is entered.
    pub fn entered(&self, mode: ModeId) -> LeafId {
        let modes = &self.sim.entity(self.me).modes;
        let mut at = &modes[mode];
        while at.chooses {
            let Some(inner) = at.inner else { break };
            at = &modes[self.chosen(&at.choices, inner)];
        }
        at.initial
    }

    #[inline]
    pub fn button(&self, press: Press, button: ButtonId) -> bool {
        self.frame().is_some_and(|frame| frame.button(press, button))
    }

    /// The instance of a reference value.
    pub fn reference(&self, value: RefValue) -> Option<SlotId> {
        match value {
            RefValue::None => None,
            RefValue::Of(subject) => self.instance(subject),
        }
    }

    /// An expression as a number.
    #[inline(always)]
    pub fn number(&self, id: ExprId) -> f64 {
        match *self.at(id) {
            Expr::Number(n) => n,
            // The variables of an instance that never moves are constants of its code.
            Expr::Var(Subject::Me, var, degree) => self.own_layout().moving_var(self.state, var, degree),
            _ => self.compute(id),
        }
    }

    /// The slow path of [`Reader::number`].
    #[inline(never)]
    fn compute(&self, id: ExprId) -> f64 {
        match *self.at(id) {
            Expr::Number(n) => n,
            Expr::Param(of, p) => self.param(of, p, id),
            Expr::Var(of, var, degree) => self.layout(of, id).map_or(0.0, |l| l.var(self.state, var, degree)),
            Expr::Discrete(of, discrete) => {
                self.layout(of, id).map_or(0.0, |l| f64::from(l.discrete(self.state, discrete)))
            }
            Expr::Axis(axis) => self.axis(axis),
            Expr::Sum(sum) => self.own_layout().sum(self.state, sum),
            Expr::Chance(chance) => self.actor.map_or(0.0, |a| self.frames.read(a.draws + chance.index())),
            Expr::Timer(timer) => self.sim.world().step.times(self.own_layout().timer(self.state, timer)),
            Expr::Frames(n) => self.sim.world().step.frames(n),
            Expr::Broken(tag) => self.sim.broken_with(self.state, tag) as f64,
            Expr::Tiles(tag) => self.sim.tiles_with(tag) as f64,
            Expr::Count { of, holds } => self.sim.count_members(self, of, holds),
            Expr::Distance { of, x, y } => {
                let Some(slot) = self.instance(of) else {
                    self.note(FaultKind::ReadNone(id));
                    return 0.0;
                };
                let (x, y) = (self.number(x), self.number(y));
                self.checked(id, self.sim.distance(self.state, slot, (x, y)), [x, y])
            }
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
                if function == Function::Mod && b == 0.0 {
                    self.note(FaultKind::DivisionByZero(id, a));
                    return 0.0;
                }
                self.checked(id, call(function, [a, b, c]), [a, b])
            }
            Expr::Bool(_)
            | Expr::Compare(..)
            | Expr::And(..)
            | Expr::Or(..)
            | Expr::Not(_)
            | Expr::Button(..)
            | Expr::Touching(..)
            | Expr::Probe { .. }
            | Expr::Joint(..)
            | Expr::Received(_)
            | Expr::IsNone(_)
            | Expr::Is(..)
            | Expr::Alive(_)
            | Expr::InMode(..)
            | Expr::InSpace(..)
            | Expr::Nearest { .. }
            | Expr::Near { .. } => f64::from(u8::from(self.truth(id))),
        }
    }

    /// An expression as a truth value.
    #[inline(always)]
    pub fn truth(&self, id: ExprId) -> bool {
        match *self.at(id) {
            Expr::Compare(op, a, b) => compare(op, self.number(a), self.number(b)),
            Expr::Touching(Subject::Me, touch) => self.own_layout().touch(self.state, touch),
            Expr::Button(press, button) => self.button(press, button),
            _ => self.decide(id),
        }
    }

    /// The slow path of [`Reader::truth`].
    #[inline(never)]
    fn decide(&self, id: ExprId) -> bool {
        match *self.at(id) {
            Expr::Bool(b) => b,
            Expr::Compare(op, a, b) => compare(op, self.number(a), self.number(b)),
            Expr::And(a, b) => self.truth(a) && self.truth(b),
            Expr::Or(a, b) => self.truth(a) || self.truth(b),
            Expr::Not(a) => !self.truth(a),
            Expr::Button(press, button) => self.button(press, button),
            Expr::Touching(of, touch) => self.instance(of).is_some_and(|s| self.sim.layout(s).touch(self.state, touch)),
            Expr::Probe { .. } => self.probe(id) != Found::Nothing,
            Expr::Joint(mode, entering) => self.joint(mode, entering),
            Expr::Received(signal) => self.own_layout().signal(self.state, signal),
            Expr::IsNone(of) => self.instance(of).is_none(),
            Expr::Is(of, entity) => self.instance(of).is_some_and(|s| self.sim.world().slots[s].entity == entity),
            Expr::Alive(slot) => self.sim.layout(slot).alive(self.state),
            Expr::InMode(of, mode) => self.instance(of).is_some_and(|slot| {
                let mode = &self.sim.entity(slot).modes[mode];
                let leaf = self.sim.layout(slot).leaf(self.state, mode.group);
                mode.leaves.contains(leaf)
            }),
            Expr::InSpace(of, space) => {
                self.instance(of).is_some_and(|s| self.sim.layout(s).space(self.state) == space)
            }
            Expr::Near { of, x, y, radius } => {
                let Some(slot) = self.instance(of) else { return false };
                self.sim.distance(self.state, slot, (self.number(x), self.number(y))) <= self.number(radius)
            }
            Expr::Nearest { of, holds } => self.sim.nearest_member(self, of, holds).is_some(),
            Expr::Number(_)
            | Expr::Param(..)
            | Expr::Var(..)
            | Expr::Discrete(..)
            | Expr::Axis(_)
            | Expr::Sum(_)
            | Expr::Chance(_)
            | Expr::Timer(_)
            | Expr::Frames(_)
            | Expr::Broken(_)
            | Expr::Tiles(_)
            | Expr::Negate(_)
            | Expr::Arithmetic(..)
            | Expr::Count { .. }
            | Expr::Distance { .. }
            | Expr::Call(..) => self.number(id) != 0.0,
        }
    }
}

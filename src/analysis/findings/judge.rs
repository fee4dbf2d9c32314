//! How a guard turns out by the values of the instance itself. What depends on inputs, contacts, other instances, on
//! parameters alone or on where the instance stands is left open: that is a matter of the level, not of the guard.

use std::collections::BTreeSet;

use crate::ir::{DiscreteId, Entity, Expr, ExprId, Id, IdVec, ParamId, Program, TimerId, VarId};

use super::super::evaluate::{Reader, Truth};
use super::Subject;

/// What an expression reads.
#[derive(Debug, Default, Clone)]
pub(super) struct Reads {
    pub vars: BTreeSet<(VarId, u8)>,
    pub discretes: BTreeSet<DiscreteId>,
    pub timers: BTreeSet<TimerId>,
    pub params: BTreeSet<ParamId>,
    /// Modes of its own.
    pub modes: bool,
    /// Inputs.
    pub inputs: bool,
    /// Contacts, other instances, what other groups do.
    pub others: bool,
    /// Positions, speeds or accelerations, whosever.
    pub motion: bool,
}

impl Reads {
    pub fn of(program: &Program, id: ExprId) -> Reads {
        let mut reads = Reads::default();
        reads.add(program, id);
        reads
    }

    fn add(&mut self, program: &Program, id: ExprId) {
        use crate::ir::Subject::Me;
        match program.exprs[id] {
            Expr::Number(_) | Expr::Frames(_) | Expr::Bool(_) => {}
            Expr::Param(Me, p) => {
                self.params.insert(p);
            }
            Expr::Var(Me, var, degree) => {
                self.vars.insert((var, degree));
                self.motion = true;
            }
            Expr::Var(..) => {
                self.others = true;
                self.motion = true;
            }
            Expr::Discrete(Me, id) => {
                self.discretes.insert(id);
            }
            Expr::Timer(timer) => {
                self.timers.insert(timer);
            }
            Expr::Axis(_) | Expr::Button(..) => self.inputs = true,
            Expr::InMode(Me, _) => self.modes = true,
            Expr::Negate(_)
            | Expr::Not(_)
            | Expr::Arithmetic(..)
            | Expr::Compare(..)
            | Expr::And(..)
            | Expr::Or(..)
            | Expr::Call(..) => {}
            Expr::Near { .. } => {
                self.others = true;
                self.motion = true;
            }
            Expr::Param(..)
            | Expr::Discrete(..)
            | Expr::Touching(..)
            | Expr::Joint(..)
            | Expr::IsNone(_)
            | Expr::Is(..)
            | Expr::Alive(_)
            | Expr::InMode(..)
            | Expr::InSpace(..) => self.others = true,
        }
        for operand in program.exprs[id].operands() {
            self.add(program, operand);
        }
    }

    /// Whether it reads a coordinate that the entity itself does not bound.
    fn asks_where(&self, entity: &Entity) -> bool {
        let own = |var: VarId| entity.clamps.iter().any(|c| c.var == var && c.degree == 0);
        self.vars.iter().any(|(var, degree)| *degree == 0 && var.index() < 2 && !own(*var))
    }

    /// Whether anything that it reads changes while a world runs.
    fn changes(&self) -> bool {
        let counted = self.vars.len() + self.discretes.len() + self.timers.len();
        counted > 0 || self.modes || self.inputs
    }
}

/// Judges the guards of an entity.
pub(super) struct Judge<'a> {
    program: &'a Program,
    entity: &'a Entity,
    /// Of each parameter, whether its value is more than the choice of one instance.
    general: IdVec<ParamId, bool>,
}

impl<'a> Judge<'a> {
    pub fn new(subject: &Subject<'a>) -> Self {
        let program = subject.scene.program;
        let values = |param: ParamId| {
            subject.slots.iter().map(move |o| {
                let s = &o.world.slots[o.slot];
                let value = o.space.overall[o.slot].params[param].constant();
                (value, program.constant(subject.entity.params[param].default, &s.params, o.world.step))
            })
        };
        let general = |param: ParamId| {
            let distinct: BTreeSet<u64> = values(param).filter_map(|(v, _)| Some(v?.to_bits())).collect();
            distinct.len() > 1 || values(param).any(|(value, default)| value.is_some() && value == default)
        };
        Judge { program, entity: subject.entity, general: subject.entity.params.ids().map(general).collect() }
    }

    /// The ways a guard can turn out.
    pub fn truth(&self, reader: &Reader<'_>, guard: ExprId) -> Truth {
        self.turned(reader, guard, true)
    }

    fn turned(&self, reader: &Reader<'_>, id: ExprId, positive: bool) -> Truth {
        match self.program.exprs[id] {
            Expr::Bool(b) => Truth::of(b),
            Expr::Not(a) => self.turned(reader, a, !positive).negated(),
            Expr::And(a, b) => self.turned(reader, a, positive).and(self.turned(reader, b, positive)),
            Expr::Or(a, b) => self.turned(reader, a, positive).or(self.turned(reader, b, positive)),
            _ => {
                let reads = Reads::of(self.program, id);
                let is_open = reads.others || !reads.changes() || reads.asks_where(self.entity);
                if is_open || reads.params.iter().any(|p| !self.general[*p]) {
                    return Truth::EITHER;
                }
                let truth = reader.truth(id);
                // That a parameter lets something always hold may be what it is for.
                match (reads.params.is_empty(), positive) {
                    (true, _) => truth,
                    (false, true) => Truth { can_fail: true, ..truth },
                    (false, false) => Truth { can_hold: true, ..truth },
                }
            }
        }
    }
}

impl Truth {
    fn negated(self) -> Truth {
        Truth { can_hold: self.can_fail, can_fail: self.can_hold }
    }

    /// Of both.
    pub(super) fn and(self, other: Truth) -> Truth {
        Truth { can_hold: self.can_hold && other.can_hold, can_fail: self.can_fail || other.can_fail }
    }

    /// Of one of both.
    pub(super) fn or(self, other: Truth) -> Truth {
        Truth { can_hold: self.can_hold || other.can_hold, can_fail: self.can_fail && other.can_fail }
    }

    /// Of either case.
    pub(super) fn joined(self, other: Truth) -> Truth {
        Truth { can_hold: self.can_hold || other.can_hold, can_fail: self.can_fail || other.can_fail }
    }
}

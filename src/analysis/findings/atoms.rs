//! Outcomes of a guard as far as the instance's own values decide them. Inputs, contacts, other instances, position,
//! and guards of parameters alone are left undecided: they depend on the level, not on the guard.

use std::collections::BTreeSet;

use crate::ir::{DiscreteId, Entity, Expr, ExprId, IdVec, ParamId, Program, TimerId, VarId};

use super::summary::{EntitySummary, Occurrence};
use crate::analysis::domain::truth::Truth;
use crate::analysis::step::evaluate::Reader;

/// What an expression reads.
#[derive(Debug, Default, Clone)]
pub(super) struct Reads {
    pub vars: BTreeSet<(VarId, u8)>,
    pub discretes: BTreeSet<DiscreteId>,
    pub timers: BTreeSet<TimerId>,
    pub params: BTreeSet<ParamId>,
    /// Modes of the instance itself.
    pub modes: bool,
    /// Inputs.
    pub inputs: bool,
    /// Contacts, other instances, joint transitions.
    pub others: bool,
    /// Positions, speeds or accelerations of any instance.
    pub motion: bool,
}

impl Reads {
    pub fn of(program: &Program, id: ExprId) -> Reads {
        let mut reads = Reads::default();
        reads.add(program, id);
        reads
    }

    /// Adds everything that another expression reads.
    pub fn add(&mut self, program: &Program, id: ExprId) {
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
            Expr::Axis(_) | Expr::Button(..) | Expr::Chance(_) => self.inputs = true,
            Expr::InMode(Me, _) => self.modes = true,
            Expr::Negate(_)
            | Expr::Not(_)
            | Expr::Arithmetic(..)
            | Expr::Compare(..)
            | Expr::And(..)
            | Expr::Or(..)
            | Expr::Call(..) => {}
            Expr::Near { .. } | Expr::Distance { .. } | Expr::Probe { .. } | Expr::Nearest { .. } => {
                self.others = true;
                self.motion = true;
            }
            Expr::Param(..)
            | Expr::Discrete(..)
            | Expr::Touching(..)
            | Expr::Joint(..)
            | Expr::Received(_)
            | Expr::Sum(_)
            | Expr::IsNone(_)
            | Expr::Is(..)
            | Expr::Alive(_)
            | Expr::Count { .. }
            | Expr::InMode(..)
            | Expr::Broken(_)
            | Expr::Tiles(_)
            | Expr::InSpace(..) => self.others = true,
        }
        for operand in program.exprs[id].operands() {
            self.add(program, operand);
        }
    }

    /// Whether nothing is read whose values can be shown.
    pub fn is_empty(&self) -> bool {
        self.vars.is_empty() && self.discretes.is_empty() && self.timers.is_empty() && self.params.is_empty()
    }

    /// Whether it reads a coordinate that the entity itself does not clamp.
    fn reads_position(&self, entity: &Entity) -> bool {
        let own = |var: VarId| entity.clamps.iter().any(|c| c.var == var && c.degree == 0);
        self.vars.iter().any(|(var, degree)| *degree == 0 && var.is_position() && !own(*var))
    }

    /// Whether anything that it reads can change during a run.
    fn changes(&self) -> bool {
        let counted = self.vars.len() + self.discretes.len() + self.timers.len();
        counted > 0 || self.modes || self.inputs
    }
}

/// The values of a parameter over all slots.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ParamUse {
    /// The first known value, as bits.
    first: Option<u64>,
    /// Whether the value is not specific to one instance: there are several values, or it is the default.
    is_general: bool,
}

impl ParamUse {
    /// Adds the value in a slot.
    pub fn add(&mut self, program: &Program, entity: &Entity, o: &Occurrence<'_>, id: ParamId) {
        let Some(value) = o.space.overall[o.slot].params[id].constant() else { return };
        let default = program.constant(entity.params[id].default, &o.world.slots[o.slot].params, o.world.step);
        let first = *self.first.get_or_insert(value.to_bits());
        self.is_general |= first != value.to_bits() || default == Some(value);
    }
}

/// A part of a guard without `and`, `or` and `not` that values may decide.
pub(super) struct Atom {
    id: ExprId,
    params: BTreeSet<ParamId>,
}

/// The atoms of a guard, in order of their ids; all other parts are undecided.
pub(super) fn atoms(program: &Program, entity: &Entity, guard: ExprId) -> Vec<Atom> {
    let mut out = Vec::new();
    let mut left = vec![guard];
    while let Some(id) = left.pop() {
        match program.exprs[id] {
            Expr::Bool(_) => {}
            Expr::Not(a) => left.push(a),
            Expr::And(a, b) | Expr::Or(a, b) => left.extend([a, b]),
            _ => {
                let reads = Reads::of(program, id);
                if !reads.others && reads.changes() && !reads.reads_position(entity) {
                    out.push(Atom { id, params: reads.params });
                }
            }
        }
    }
    out.sort_unstable_by_key(|a| a.id);
    out.dedup_by_key(|a| a.id);
    out
}

/// The outcomes of the atoms in a case, one byte each.
pub(super) fn case(atoms: &[Atom], reader: &Reader<'_>) -> Vec<u8> {
    atoms.iter().map(|a| reader.truth(a.id).packed()).collect()
}

/// Evaluates the guards of an entity.
pub(super) struct Judge<'a> {
    program: &'a Program,
    /// The parameter values; `None` until all worlds are examined, as any parameter may still turn out to be general.
    params: Option<&'a IdVec<ParamId, ParamUse>>,
}

impl<'a> Judge<'a> {
    /// With the parameter values of all worlds.
    pub fn new(subject: &'a EntitySummary<'_>) -> Self {
        Judge { program: subject.context.program, params: Some(&subject.params) }
    }

    /// While the worlds are being examined; outcomes can only become more precise later.
    pub fn early(program: &'a Program) -> Self {
        Judge { program, params: None }
    }

    /// The possible outcomes of a guard, or of a part of it, in a case.
    pub fn truth(&self, atoms: &[Atom], case: &[u8], id: ExprId) -> Truth {
        self.outcome(atoms, case, id, true)
    }

    fn outcome(&self, atoms: &[Atom], case: &[u8], id: ExprId, positive: bool) -> Truth {
        let outcome = |id, positive| self.outcome(atoms, case, id, positive);
        match self.program.exprs[id] {
            Expr::Bool(b) => Truth::of(b),
            Expr::Not(a) => outcome(a, !positive).negated(),
            Expr::And(a, b) => outcome(a, positive).and(outcome(b, positive)),
            Expr::Or(a, b) => outcome(a, positive).or(outcome(b, positive)),
            _ => {
                let Ok(at) = atoms.binary_search_by_key(&id, |a| a.id) else { return Truth::EITHER };
                let params = &atoms[at].params;
                if params.iter().any(|p| self.params.is_some_and(|given| !given[*p].is_general)) {
                    return Truth::EITHER;
                }
                let truth = case.get(at).map_or(Truth::EITHER, |packed| Truth::unpacked(*packed));
                // A parameter may be meant to switch something on or off for good.
                match (params.is_empty(), positive) {
                    (true, _) => truth,
                    (false, true) => Truth { can_fail: true, ..truth },
                    (false, false) => Truth { can_hold: true, ..truth },
                }
            }
        }
    }
}

impl Truth {
    fn packed(self) -> u8 {
        u8::from(self.can_hold) | u8::from(self.can_fail) << 1
    }

    fn unpacked(packed: u8) -> Truth {
        Truth { can_hold: packed & 1 != 0, can_fail: packed & 2 != 0 }
    }

    fn negated(self) -> Truth {
        Truth { can_hold: self.can_fail, can_fail: self.can_hold }
    }

    /// Conjunction.
    pub(super) fn and(self, other: Truth) -> Truth {
        Truth { can_hold: self.can_hold && other.can_hold, can_fail: self.can_fail || other.can_fail }
    }

    /// Disjunction.
    pub(super) fn or(self, other: Truth) -> Truth {
        Truth { can_hold: self.can_hold || other.can_hold, can_fail: self.can_fail && other.can_fail }
    }

    /// The join of two cases.
    pub(super) fn joined(self, other: Truth) -> Truth {
        Truth { can_hold: self.can_hold || other.can_hold, can_fail: self.can_fail || other.can_fail }
    }
}

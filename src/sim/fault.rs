//! Run-time errors: a running world broke a rule of the language. The step stops; the state must not be used.

use crate::diagnostic::catalogue::run::RunFault;
use crate::ir::{DiscreteId, EntityId, ExprId, Program, SlotId, VarId, WorldId};

/// The broken rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FaultKind {
    /// An expression has no finite value; with its operands.
    NotFinite(ExprId, [f64; 2]),
    /// A division by zero; with the dividend.
    DivisionByZero(ExprId, f64),
    /// A variable, or a derivative, became infinite or NaN during integration.
    Diverged(VarId, u8),
    /// An update gave a discrete variable a value out of its range, or one that is not whole.
    OutOfRange(ExprId, EntityId, DiscreteId, f64),
    /// An expression reads an instance that does not exist.
    ReadNone(ExprId),
}

/// A broken rule and the instance whose code broke it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// The instance.
    pub slot: SlotId,
    /// The rule.
    pub kind: FaultKind,
}

impl Fault {
    /// The fact for a diagnostic; `step` counts from 1.
    pub fn fact(&self, program: &Program, world: WorldId, step: u64) -> RunFault {
        let slot = &program.worlds[world].slots[self.slot];
        let entity = &program.entities[slot.entity];
        let value = |name: &str, value: f64| (name.to_string(), value);
        let (at, what, values) = match self.kind {
            FaultKind::NotFinite(expr, [a, b]) => (
                program.spans.exprs[expr],
                "a value left the finite numbers".to_string(),
                vec![value("the left operand", a), value("the right operand", b)],
            ),
            FaultKind::DivisionByZero(expr, a) => {
                (program.spans.exprs[expr], "division by zero".to_string(), vec![value("the dividend", a)])
            }
            FaultKind::Diverged(var, degree) => (
                program.spans.entities[slot.entity].vars[var],
                format!("`{}` left the finite numbers", entity.variable_text(var, degree)),
                Vec::new(),
            ),
            FaultKind::ReadNone(expr) => {
                (program.spans.exprs[expr], "a reference was read that refers to nothing".to_string(), Vec::new())
            }
            FaultKind::OutOfRange(expr, of, id, found) => {
                let discrete = &program.entities[of].discretes[id];
                (
                    program.spans.exprs[expr],
                    if found.fract() == 0.0 {
                        format!("`{}` left its range {}..{}", discrete.name, discrete.range.0, discrete.range.1)
                    } else {
                        format!("`{}` was given a value that is not whole", discrete.name)
                    },
                    vec![value(&discrete.name, found)],
                )
            }
        };
        RunFault { at, what, instance: slot.name.clone(), step, values }
    }
}

//! Constant evaluation: constants, parameters of an instance, initial values.

use crate::ir::{Function, IdVec, ParamId, Subject, arithmetic, call, compare};
use crate::source::Span;

use super::checked::{Term, TermKind};

/// What a constant term may read.
#[derive(Debug, Clone, Copy)]
pub struct ConstantContext<'a> {
    /// The parameters that are known so far; `None` where parameters may not be read.
    pub params: Option<&'a IdVec<ParamId, f64>>,
    /// The length of the world's step as a fraction of seconds; `None` outside a world.
    pub step: Option<(u64, u64)>,
}

impl ConstantContext<'_> {
    /// Only literals and constants.
    pub const LITERALS: ConstantContext<'static> = ConstantContext { params: None, step: None };
}

/// Why a term has no constant value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConstantError {
    /// It reads something that is not constant, here.
    NotConstant(Span),
    /// It divides by zero or overflows, here.
    NotFinite(Span),
}

/// The constants that every program has, unless it declares others of these names.
pub(crate) const KNOWN_CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("tau", std::f64::consts::TAU)];

/// The value of a term; truth values are 0 and 1.
///
/// [`ConstantError`] if it reads something unknown, or has no finite value.
pub fn evaluate(term: &Term, context: ConstantContext<'_>) -> Result<f64, ConstantError> {
    let value = |t: &Term| evaluate(t, context);
    let truth = |b: bool| f64::from(u8::from(b));
    let unknown = ConstantError::NotConstant(term.span);
    let result = match &term.kind {
        TermKind::Number(n) => *n,
        TermKind::Quantity(quantity) => quantity.0,
        TermKind::Frames(n) => {
            let (numerator, denominator) = context.step.ok_or(unknown)?;
            // Rounded once, like timers.
            n * numerator as f64 / denominator as f64
        }
        TermKind::Bool(b) => truth(*b),
        TermKind::Param(Subject::Me, id) => *context.params.and_then(|p| p.get(*id)).ok_or(unknown)?,
        TermKind::Negate(a) => -value(a)?,
        TermKind::Arithmetic(op, sides) => {
            let [a, b] = sides.as_ref();
            arithmetic(*op, value(a)?, value(b)?)
        }
        TermKind::Call(called) => match (called.0, &*called.1) {
            (Function::If, [condition, a, b]) => value(if value(condition)? != 0.0 { a } else { b })?,
            (Function::If, _) => return Err(unknown),
            (function, args) => {
                let mut values = [0.0; 3];
                for (slot, arg) in values.iter_mut().zip(args) {
                    *slot = value(arg)?;
                }
                call(function, values)
            }
        },
        TermKind::Compare(op, sides) => {
            let [a, b] = sides.as_ref();
            truth(compare(*op, value(a)?, value(b)?))
        }
        TermKind::And(sides) => {
            let [a, b] = sides.as_ref();
            truth(value(a)? != 0.0 && value(b)? != 0.0)
        }
        TermKind::Or(sides) => {
            let [a, b] = sides.as_ref();
            truth(value(a)? != 0.0 || value(b)? != 0.0)
        }
        TermKind::Not(a) => truth(value(a)? == 0.0),
        TermKind::Param(..)
        | TermKind::Var(..)
        | TermKind::Joint { .. }
        | TermKind::Received(_)
        | TermKind::Sum(_)
        | TermKind::IsNone(_)
        | TermKind::Is(..)
        | TermKind::Alive(_)
        | TermKind::NoneRef
        | TermKind::Instance(_)
        | TermKind::Discrete(..)
        | TermKind::Axis(_)
        | TermKind::Chance(_)
        | TermKind::Timer(_)
        | TermKind::Button(..)
        | TermKind::Touching(_)
        | TermKind::Probe(_)
        | TermKind::InMode(..)
        | TermKind::InSpace(..)
        | TermKind::Near(_)
        | TermKind::Tiles(_)
        | TermKind::Distance(_)
        | TermKind::Members(_)
        | TermKind::Nearest(_)
        | TermKind::Count(_) => return Err(unknown),
    };
    if result.is_finite() { Ok(result) } else { Err(ConstantError::NotFinite(term.span)) }
}

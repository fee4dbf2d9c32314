//! Facts about questions, input scripts and runs.

use super::did_you_mean;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// An input script that cannot be read.
pub struct BadInput {
    /// The step of the script, or its wrong part.
    pub at: Span,
    /// The reason.
    pub why: String,
    /// A suggestion.
    pub help: Option<String>,
}

impl Fact for BadInput {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::BadInput, self.why).at(self.at, "cannot be given");
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// A missing world or goal, or an ambiguous choice.
pub struct NoQuestion {
    /// What is missing.
    pub why: String,
    /// The nearest name.
    pub near: Option<String>,
    /// A suggestion.
    pub help: Option<String>,
}

impl Fact for NoQuestion {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::NoQuestion, format!("{}{}", self.why, did_you_mean(self.near.as_ref())));
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// A run-time fault of a world.
pub struct RunFault {
    /// The expression.
    pub at: Span,
    /// What happened.
    pub what: String,
    /// The instance.
    pub instance: String,
    /// The step, from 1.
    pub step: u64,
    /// The values that were read.
    pub values: Vec<(String, f64)>,
}

impl Fact for RunFault {
    fn into_diagnostic(self) -> Diagnostic {
        let RunFault { at, what, instance, step, values } = self;
        let d = Diagnostic::new(Code::Fault, format!("step {step} stopped: {what} in `{instance}`")).at(at, what);
        if values.is_empty() {
            return d;
        }
        let values: Vec<String> = values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        d.note(values.join(", "))
    }
}

/// An invariant violated in a running world.
pub struct BrokenInvariant {
    /// The invariant.
    pub at: Span,
    /// The instance.
    pub instance: String,
    /// The step, from 1; 0 is before the first.
    pub step: u64,
}

impl Fact for BrokenInvariant {
    fn into_diagnostic(self) -> Diagnostic {
        let message = format!("after step {}: an invariant of `{}` does not hold", self.step, self.instance);
        Diagnostic::new(Code::InvariantBroken, message).at(self.at, "does not hold")
    }
}

/// A spawn that found no free slot.
pub struct RefusedSpawn {
    /// The spawn.
    pub at: Span,
    /// The spawning instance.
    pub instance: String,
    /// The spawned entity.
    pub entity: String,
    /// The step, from 1.
    pub step: u64,
}

impl Fact for RefusedSpawn {
    fn into_diagnostic(self) -> Diagnostic {
        let RefusedSpawn { at, instance, entity, step } = self;
        Diagnostic::new(
            Code::SpawnRefused,
            format!("step {step}: no slot was free for a `{entity}` that `{instance}` spawns"),
        )
        .at(at, "refused")
        .help(format!("raise `limit {entity}` if more may live at once"))
    }
}

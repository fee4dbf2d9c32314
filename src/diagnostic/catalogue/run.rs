//! Facts about questions, input scripts and runs.

use super::did_you_mean;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// An input script that cannot be read.
pub struct BadInput {
    /// The step or the part of it.
    pub at: Span,
    /// Why.
    pub why: String,
    /// A way out.
    pub help: Option<String>,
}

impl Fact for BadInput {
    fn word(self) -> Diagnostic {
        let d = Diagnostic::new(Code::BadInput, self.why).at(self.at, "cannot be given");
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// A world or a goal that is not there, or a choice that is not made.
pub struct NoQuestion {
    /// What is missing.
    pub why: String,
    /// The nearest name.
    pub near: Option<String>,
    /// A way out.
    pub help: Option<String>,
}

impl Fact for NoQuestion {
    fn word(self) -> Diagnostic {
        let d = Diagnostic::new(Code::NoQuestion, format!("{}{}", self.why, did_you_mean(self.near.as_ref())));
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// A running world that broke a rule.
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
    fn word(self) -> Diagnostic {
        let RunFault { at, what, instance, step, values } = self;
        let d = Diagnostic::new(Code::Fault, format!("step {step} stopped: {what} in `{instance}`")).at(at, what);
        if values.is_empty() {
            return d;
        }
        let values: Vec<String> = values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        d.note(values.join(", "))
    }
}

//! Facts about types, dimensions and values.

use super::did_you_mean;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A value of the wrong type.
pub struct TypeMismatch {
    /// The value.
    pub at: Span,
    /// What it is.
    pub found: String,
    /// What was needed.
    pub expected: String,
    /// A way out.
    pub help: Option<String>,
}

impl Fact for TypeMismatch {
    fn word(self) -> Diagnostic {
        let d = Diagnostic::new(Code::TypeMismatch, format!("expected {}, found {}", self.expected, self.found))
            .at(self.at, format!("this is {}", self.found));
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// Two uses of different dimension.
pub struct DimensionConflict {
    /// What is used twice, as written.
    pub what: String,
    /// The use that came second, and its dimension.
    pub at: (Span, String),
    /// The first use, and its dimension.
    pub other: Option<(Span, String)>,
    /// Other places that have to do with it.
    pub also: Vec<(Span, String)>,
    /// A name of the dimension that the second use needs.
    pub near: Option<String>,
}

impl Fact for DimensionConflict {
    fn word(self) -> Diagnostic {
        let (at, here) = self.at;
        let mut d = match self.other {
            Some((span, there)) => {
                let message = format!("{} is used as {} and as {}", self.what, kind(&here), kind(&there));
                Diagnostic::new(Code::DimensionConflict, message)
                    .at(at, format!("here it must be {here}"))
                    .and(span, format!("here it must be {there}"))
            }
            None => {
                Diagnostic::new(Code::DimensionConflict, format!("{} does not fit: {here}", self.what)).at(at, here)
            }
        };
        for (span, text) in self.also {
            d = d.and(span, text);
        }
        if self.near.is_some() {
            d.message.push_str(&did_you_mean(self.near.as_ref()));
        }
        d
    }
}

/// A dimension in words where there is a word.
fn kind(dimension: &str) -> String {
    match dimension {
        "px" => "a length".into(),
        "px/s" => "a velocity".into(),
        "px/s^2" => "an acceleration".into(),
        "s" => "a time".into(),
        "1" => "a pure number".into(),
        "1/s" => "a rate".into(),
        other => format!("a value in {other}"),
    }
}

/// A call with the wrong number or kind of arguments.
pub struct WrongArguments {
    /// The function.
    pub function: String,
    /// The call.
    pub at: Span,
    /// How it is called.
    pub usage: &'static str,
}

impl Fact for WrongArguments {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::WrongArguments, format!("`{}` is called with the wrong arguments", self.function))
            .at(self.at, format!("expected {}", self.usage))
    }
}

/// A value that is not known in time.
pub struct NotConstant {
    /// The part that is not known.
    pub at: Span,
    /// What is being defined.
    pub what: &'static str,
    /// What it may read.
    pub may_read: &'static str,
}

impl Fact for NotConstant {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::NotConstant, format!("{} cannot depend on this", self.what))
            .at(self.at, "not known when it is needed")
            .help(format!("it may read {}", self.may_read))
    }
}

/// `a < b > c`
pub struct BadChain {
    /// The chain.
    pub at: Span,
}

impl Fact for BadChain {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::BadChain, "a chain of comparisons must go one way")
            .at(self.at, "its comparisons point both ways")
            .help("join two comparisons with `and`")
    }
}

/// A value outside of what is possible.
pub struct OutOfRange {
    /// The value or what it is given to.
    pub at: Span,
    /// What it is.
    pub what: String,
    /// What it may be.
    pub range: String,
}

impl Fact for OutOfRange {
    fn word(self) -> Diagnostic {
        Diagnostic::new(Code::OutOfRange, format!("{} lies outside of {}", self.what, self.range))
            .at(self.at, format!("must be within {}", self.range))
    }
}

/// A `use` that leaves out arguments.
pub struct MissingArguments {
    /// The `use`.
    pub at: Span,
    /// The behaviour.
    pub name: String,
    /// Its parameters that get none.
    pub missing: Vec<String>,
    /// Where it is declared.
    pub declared: Span,
}

impl Fact for MissingArguments {
    fn word(self) -> Diagnostic {
        let missing: Vec<String> = self.missing.iter().map(|m| format!("`{m}`")).collect();
        let usage: Vec<String> = self.missing.iter().map(|m| format!("{m} = …")).collect();
        let message = format!("`use {}` leaves out {}", self.name, super::list(&missing, "and"));
        Diagnostic::new(Code::WrongArguments, message)
            .at(self.at, "arguments are missing")
            .and(self.declared, "declared here")
            .help(format!("add `{}`", usage.join(", ")))
    }
}

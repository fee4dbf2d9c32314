//! Facts about types, dimensions and values.

use super::did_you_mean;
use crate::diagnostic::suggestion::{Change, Piece};
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A value of the wrong type.
pub struct TypeMismatch {
    /// The value.
    pub at: Span,
    /// What it is.
    pub found: String,
    /// The expected type.
    pub expected: String,
    /// A suggestion.
    pub help: Option<String>,
}

impl Fact for TypeMismatch {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::TypeMismatch, format!("expected {}, found {}", self.expected, self.found))
            .at(self.at, format!("this is {}", self.found));
        let d = match (&*self.found, &*self.expected) {
            (_, "a whole number") => d.or_wrap("write `floor(…)`", self.at, "floor(", ")").or_wrap(
                "write `round(…)`",
                self.at,
                "round(",
                ")",
            ),
            ("a number" | "a whole number", _) => d.or_wrap("compare it: `… > 0`", self.at, "", " > 0"),
            _ => d,
        };
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// Two uses with different dimensions.
pub struct DimensionConflict {
    /// The name or expression, as written.
    pub what: String,
    /// The second use, and its dimension.
    pub at: (Span, String),
    /// The first use, and its dimension.
    pub other: (Span, String),
    /// Related places.
    pub also: Vec<(Span, String)>,
    /// A similar name with the dimension of the second use.
    pub near: Option<String>,
}

impl Fact for DimensionConflict {
    fn into_diagnostic(self) -> Diagnostic {
        let ((at, here), (span, there)) = (self.at, self.other);
        let near = did_you_mean(self.near.as_ref());
        let message = format!("{} is used as {} and as {}{near}", self.what, kind(&here), kind(&there));
        let d = or_near(Diagnostic::new(Code::DimensionConflict, message), Some(at), self.near)
            .at(at, format!("here it must be {here}"))
            .and(span, format!("here it must be {there}"));
        self.also.into_iter().fold(d, |d, (span, text)| d.and(span, text))
    }
}

/// An expression, and its dimension.
pub struct Dimensioned {
    /// Its text, in backquotes.
    pub text: String,
    /// Its place.
    pub at: Option<Span>,
    /// Its dimension.
    pub dimension: String,
}

/// An expression where another dimension is expected.
pub struct WrongDimension {
    /// The expression.
    pub this: Dimensioned,
    /// The expected dimension.
    pub needed: String,
    /// Related places.
    pub also: Vec<(Span, String)>,
    /// A similar name with the expected dimension.
    pub near: Option<String>,
    /// A suggestion.
    pub help: Option<String>,
}

impl Fact for WrongDimension {
    fn into_diagnostic(self) -> Diagnostic {
        let WrongDimension { this, needed, also, near, help } = self;
        let (found, needed) = (measured(&this.dimension), measured(&needed));
        let hint = did_you_mean(near.as_ref());
        let message = format!("{} is {found}, but {needed} is needed here{hint}", this.text);
        let d = or_near(Diagnostic::new(Code::DimensionConflict, message), this.at, near);
        finished(labelled(d, this.at, found), also, help)
    }
}

/// Two expressions that must have the same dimension and do not.
pub struct Unjoinable {
    /// The first of them.
    pub first: Dimensioned,
    /// The second.
    pub second: Dimensioned,
    /// The operation on both: `added`.
    pub how: String,
    /// Related places.
    pub also: Vec<(Span, String)>,
    /// A similar name with the first's dimension, if the second is a name.
    pub near: Option<String>,
    /// A suggestion.
    pub help: Option<String>,
}

impl Fact for Unjoinable {
    fn into_diagnostic(self) -> Diagnostic {
        let Unjoinable { first, second, how, also, near, help } = self;
        let (one, other) = (measured(&first.dimension), measured(&second.dimension));
        let hint = did_you_mean(near.as_ref());
        let verb = if how.starts_with("the ") { "cannot both be" } else { "cannot be" };
        let message = format!("{} and {} {verb} {how}: {one} and {other}{hint}", first.text, second.text);
        let d = or_near(Diagnostic::new(Code::DimensionConflict, message), second.at, near);
        let d = match first.at {
            Some(at) => labelled(d, second.at, other).and(at, one),
            None => labelled(d, second.at, format!("{} is {other}", second.text)),
        };
        finished(d, also, help)
    }
}

/// A square root of an expression whose dimension is no square.
pub struct NoSquare {
    /// The operand, as written.
    pub of: String,
    /// Its place.
    pub at: Span,
    /// Its dimension.
    pub dimension: String,
}

impl Fact for NoSquare {
    fn into_diagnostic(self) -> Diagnostic {
        let dimension = measured(&self.dimension);
        let message = format!("{} has no square root: it is {dimension}, which is no square", self.of);
        Diagnostic::new(Code::DimensionConflict, message).at(self.at, dimension)
    }
}

/// Suggests a similar name of the right dimension.
fn or_near(d: Diagnostic, at: Option<Span>, near: Option<String>) -> Diagnostic {
    match (at, near) {
        (Some(at), Some(near)) => d.or_write(at, near),
        _ => d,
    }
}

fn labelled(d: Diagnostic, at: Option<Span>, text: String) -> Diagnostic {
    match at {
        Some(at) => d.at(at, text),
        None => d,
    }
}

fn finished(d: Diagnostic, also: Vec<(Span, String)>, help: Option<String>) -> Diagnostic {
    let d = also.into_iter().fold(d, |d, (span, text)| d.and(span, text));
    match help {
        Some(help) => d.help(help),
        None => d,
    }
}

/// A dimension in words and as written.
fn measured(dimension: &str) -> String {
    match dimension {
        "px" | "px/s" | "px/s^2" | "s" | "1/s" => format!("{} ({dimension})", kind(dimension)),
        _ => kind(dimension),
    }
}

/// A dimension in words, if it has a name.
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
    fn into_diagnostic(self) -> Diagnostic {
        // How many the usage names: `clamp(value, low, high)`.
        let inside = self.usage.rsplit_once('(').and_then(|(_, rest)| rest.split(')').next());
        let expected = inside.map_or(0, |inside| inside.split(',').count());
        let zeros = vec!["0"; expected].join(", ");
        Diagnostic::new(Code::WrongArguments, format!("`{}` is called with the wrong arguments", self.function))
            .at(self.at, format!("expected {}", self.usage))
            .suggest("add `0` for the missing arguments", vec![Change::AddArguments(self.at, zeros)])
    }
}

/// A value that is not constant where a constant is required.
pub struct NotConstant {
    /// The part that is not constant.
    pub at: Span,
    /// The kind of definition.
    pub what: &'static str,
    /// The names that it may read.
    pub may_read: &'static str,
}

impl Fact for NotConstant {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::NotConstant, format!("{} cannot depend on this", self.what))
            .at(self.at, "not known when it is needed")
            .or_wrap("read where the instance starts: `start.…`", self.at, "start.", "")
            .help(format!("it may read {}", self.may_read))
    }
}

/// The offset of a probe, or the limit of `nearest`, that reads a contact or another instance.
pub struct ForeignOffset {
    /// The part that reads it.
    pub at: Span,
    /// `the offset of a probe`
    pub what: &'static str,
}

impl Fact for ForeignOffset {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::NotConstant, format!("{} cannot depend on this", self.what))
            .at(self.at, "not of the instance itself")
            .help(
                "it may read variables, parameters, modes, timers and inputs of the instance; others ask by themselves",
            )
    }
}

/// `a < b > c`
pub struct BadChain {
    /// The chain.
    pub at: Span,
    /// Its comparisons, each with both operands.
    pub links: Vec<Span>,
}

impl Fact for BadChain {
    fn into_diagnostic(self) -> Diagnostic {
        let mut pieces = Vec::new();
        for link in self.links {
            pieces.extend((!pieces.is_empty()).then(|| Piece::Text(" and ".into())));
            pieces.push(Piece::Of(link));
        }
        Diagnostic::new(Code::BadChain, "a chain of comparisons must go one way")
            .at(self.at, "its comparisons point both ways")
            .help("join two comparisons with `and`")
            .suggest("join the comparisons with `and`", vec![Change::Write(self.at, pieces)])
    }
}

/// A value outside its allowed range.
pub struct OutOfRange {
    /// The value, or the variable that it is assigned to.
    pub at: Span,
    /// What it is.
    pub what: String,
    /// The allowed range.
    pub range: String,
}

impl Fact for OutOfRange {
    fn into_diagnostic(self) -> Diagnostic {
        let ends = self.range.split_once("..").map(|(low, high)| [low.to_string(), high.to_string()]);
        let d = Diagnostic::new(Code::OutOfRange, format!("{} lies outside of {}", self.what, self.range));
        ends.into_iter()
            .flatten()
            .fold(d, |d, end| d.or_write(self.at, end))
            .at(self.at, format!("must be within {}", self.range))
    }
}

/// A `use` that leaves out arguments.
pub struct MissingArguments {
    /// The `use`.
    pub at: Span,
    /// The behaviour.
    pub name: String,
    /// Its parameters without an argument.
    pub missing: Vec<String>,
    /// Where it is declared.
    pub declared: Span,
}

impl Fact for MissingArguments {
    fn into_diagnostic(self) -> Diagnostic {
        let missing: Vec<String> = self.missing.iter().map(|m| format!("`{m}`")).collect();
        let usage: Vec<String> = self.missing.iter().map(|m| format!("{m} = …")).collect();
        let zeros: Vec<String> = self.missing.iter().map(|m| format!("{m} = 0")).collect();
        let zeros = zeros.join(", ");
        let message = format!("`use {}` leaves out {}", self.name, super::list(&missing, "and"));
        Diagnostic::new(Code::WrongArguments, message)
            .at(self.at, "arguments are missing")
            .and(self.declared, "declared here")
            .help(format!("add `{}`", usage.join(", ")))
            .suggest(format!("add {}", super::list(&missing, "and")), vec![Change::AddArguments(self.at, zeros)])
    }
}

//! Facts about text that does not fit the grammar.

use super::list;
use crate::diagnostic::suggestion::Change;
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A token that fits no rule.
pub struct Unexpected {
    /// The token, or the end of the text before the gap.
    pub at: Span,
    /// The text of the token; none at the end of a statement.
    pub found: Option<String>,
    /// The expected tokens.
    pub expected: Vec<String>,
    /// A suggestion, where one is likely.
    pub help: Option<String>,
    /// A replacement that is certainly intended.
    pub meant: Option<(Span, String)>,
}

impl Fact for Unexpected {
    fn into_diagnostic(self) -> Diagnostic {
        let found = match &self.found {
            Some(token) => format!("`{token}`"),
            None => "the end of the line".to_string(),
        };
        // A long list does not help.
        let (message, label) = if self.expected.is_empty() || self.expected.len() > 6 {
            (format!("unexpected {}", found.trim_start_matches("the ")), "does not fit here".to_string())
        } else {
            let expected = list(&self.expected, "or");
            (format!("expected {expected}, found {found}"), format!("expected {expected}"))
        };
        let mut d = Diagnostic::new(Code::Syntax, message).at(self.at, label);
        if let Some((span, text)) = self.meant {
            let what = if text.is_empty() { "leave this out".into() } else { format!("write `{}`", text.trim()) };
            d = d.fix(what, span, text);
        }
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}

/// More syntax errors than are shown.
pub struct TooManyErrors {
    /// The first that is not shown.
    pub at: Span,
}

impl Fact for TooManyErrors {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::Syntax, "too many syntax errors; those from here on are not shown")
            .at(self.at, "the first that is not shown")
    }
}

/// A word longer than is supported.
pub struct LongWord {
    /// Its beginning.
    pub at: Span,
    /// Its length in bytes.
    pub length: usize,
    /// The maximum length.
    pub limit: usize,
}

impl Fact for LongWord {
    fn into_diagnostic(self) -> Diagnostic {
        let message = format!("a word has {} letters, at most {} are read", self.length, self.limit);
        Diagnostic::new(Code::TooLarge, message).at(self.at, "begins here").note("nothing after this place was checked")
    }
}

/// More words, numbers and signs than a file may have.
pub struct TooManyTokens {
    /// The first one too many.
    pub at: Span,
    /// The maximum number.
    pub limit: usize,
}

impl Fact for TooManyTokens {
    fn into_diagnostic(self) -> Diagnostic {
        let message = format!("this file has more than {} words, numbers and signs", self.limit);
        Diagnostic::new(Code::TooLarge, message)
            .at(self.at, "too many from here on")
            .help("put parts of it into files of their own, and `import` them")
            .note("nothing of this file was checked")
    }
}

/// More brackets open than are supported.
pub struct NestingTooDeep {
    /// The first bracket too many.
    pub at: Span,
    /// The maximum number of open brackets.
    pub limit: usize,
}

impl Fact for NestingTooDeep {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::NestingTooDeep, format!("more than {} brackets are open at once", self.limit))
            .at(self.at, "one bracket too many")
            .help("is a bracket left open further up? if not, name parts of the expression or flatten the modes")
            .note("nothing after this place was checked")
    }
}

/// More operators in one expression than are supported.
pub struct ExpressionTooLong {
    /// The first operator too many.
    pub at: Span,
    /// The maximum number.
    pub limit: usize,
    /// Whether the rest of the file was skipped.
    pub unread: bool,
}

impl Fact for ExpressionTooLong {
    fn into_diagnostic(self) -> Diagnostic {
        let d =
            Diagnostic::new(Code::ExpressionTooLong, format!("an expression has more than {} operators", self.limit))
                .at(
                    self.at,
                    if self.unread {
                        "one operator too many"
                    } else {
                        "too long with its constants, conditions or arguments put in place"
                    },
                )
                .help("name parts of it with `const` or `param`");
        if self.unread { d.note("nothing after this place was checked") } else { d }
    }
}

/// An opening brace without a closing one.
pub struct UnclosedBrace {
    /// The opening brace.
    pub open: Span,
    /// The end of the text after which the closing brace is missing, by the indentation of what follows.
    pub here: Option<Span>,
    /// Where the text ends.
    pub end: Span,
}

impl Fact for UnclosedBrace {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::UnbalancedBrace, "this `{` is never closed").at(self.open, "opened here");
        let close = Change::AddLine(self.open, self.here.unwrap_or(self.end), "}".into());
        let d = d.suggest("add the missing `}`", vec![close]);
        match self.here {
            Some(here) => d.and(here, "by the indentation of what follows, a `}` is missing after this"),
            None => d.and(self.end, "the file ends here").help("add a `}` at the end of the file"),
        }
    }
}

/// The header of a block without its opening brace.
pub struct MissingOpenBrace {
    /// The end of the header.
    pub header: Span,
}

impl Fact for MissingOpenBrace {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::UnbalancedBrace, "a `{` is missing").at(self.header, "expected `{` after this").or_wrap(
            "add the missing `{`",
            self.header,
            "",
            " {",
        )
    }
}

/// A closing brace without an opening one.
pub struct StrayBrace {
    /// The brace.
    pub at: Span,
}

impl Fact for StrayBrace {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::UnbalancedBrace, "this `}` closes nothing")
            .at(self.at, "no `{` is open here")
            .suggest("remove the `}`", vec![Change::Write(self.at, Vec::new())])
            .help("remove it, or look for a `{` that is missing further up")
    }
}

/// An inline map without a closing quote.
pub struct UnterminatedMap {
    /// The opening quote, or the line that lacks it.
    pub open: Span,
    /// Whether the opening quote is missing.
    pub opening: bool,
}

impl Fact for UnterminatedMap {
    fn into_diagnostic(self) -> Diagnostic {
        if self.opening {
            return Diagnostic::new(Code::UnterminatedMap, "this map has no opening quote")
                .at(self.open, "the map begins here")
                .help("end this line with a `\"`");
        }
        Diagnostic::new(Code::UnterminatedMap, "this map has no end")
            .at(self.open, "the map begins here")
            .help("close it with a `\"` on a line of its own below the last row")
    }
}

/// A declaration in a block that cannot hold it.
pub struct Misplaced {
    /// The declaration.
    pub at: Span,
    /// The kind of declaration: `param`.
    pub what: &'static str,
    /// The block around: `a mode`.
    pub inside: &'static str,
    /// The block where it is allowed.
    pub belongs: &'static str,
}

impl Fact for Misplaced {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::Misplaced, format!("{} is not allowed in {}", self.what, self.inside))
            .at(self.at, "out of place")
            .suggest("move it to the entity", vec![Change::MoveToEntity(self.at, false)])
            .suggest("move it to the entity, for this mode", vec![Change::MoveToEntity(self.at, true)])
            .help(format!("it belongs {}", self.belongs))
    }
}

//! Diagnostics: the findings of checks, with places and suggested fixes.
//!
//! A check records a *fact* (a struct of [`catalogue`]); the fact becomes a [`Diagnostic`], a plain value with byte
//! spans; a renderer of [`render`] makes text of it. Codes are the closed enum [`Code`]; each is explained by a
//! [`page`].

pub mod catalogue;
mod code;
pub mod fix;
pub mod page;
pub mod render;
mod similar;
pub mod suggestion;
pub mod words;

pub use code::Code;
pub use similar::{MAX_CANDIDATES, only_similar, similar};

use crate::ordered::Ordered;
use crate::source::{FileId, SourceMap, Span};
use suggestion::Suggestion;

/// The severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The program is invalid; it cannot be compiled.
    Error,
    /// The program is valid but probably wrong.
    Warning,
}

/// A place with a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// A short phrase.
    pub text: String,
}

/// A change of the text that is certain to repair the finding and has no other effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fix {
    /// A short description: `write `walking``.
    pub title: String,
    /// The replaced spans and their new texts; the spans do not overlap.
    pub edits: Vec<(Span, String)>,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Which kind of finding.
    pub code: Code,
    /// Error or warning.
    pub severity: Severity,
    /// What was found, in one line.
    pub message: String,
    /// The place of the mistake; none where a whole file is at fault.
    pub primary: Option<Label>,
    /// The other places involved.
    pub secondary: Vec<Label>,
    /// Ways out.
    pub helps: Vec<String>,
    /// Background.
    pub notes: Vec<String>,
    /// How to mend it, where that is certain.
    pub fix: Option<Fix>,
    /// Ways to mend it among which the author chooses.
    pub suggestions: Vec<Suggestion>,
    /// The kind and the name of what is missing, if something is that could be declared.
    pub missing: Option<(&'static str, String)>,
}

impl Diagnostic {
    /// A finding of the code's own severity.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Diagnostic {
            code,
            severity: code.severity(),
            message: message.into(),
            primary: None,
            secondary: Vec::new(),
            helps: Vec::new(),
            notes: Vec::new(),
            fix: None,
            suggestions: Vec::new(),
            missing: None,
        }
    }

    /// Sets the place of the mistake.
    #[must_use]
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.primary = Some(Label { span, text: text.into() });
        self
    }

    /// Adds another place.
    #[must_use]
    pub fn and(mut self, span: Span, text: impl Into<String>) -> Self {
        self.secondary.push(Label { span, text: text.into() });
        self
    }

    /// Moves labels from expanded text to the text itself, and adds the `use` that expanded it.
    #[must_use]
    pub fn traced(mut self, sources: &SourceMap) -> Self {
        // The text of a behaviour has a different meaning for each `use`.
        self.fix = self.fix.filter(|fix| !fix.edits.iter().any(|(span, _)| span.is_copy()));
        self.suggestions.retain(|suggestion| !suggestion.is_of_copies());
        let mut used: Vec<Span> = Vec::new();
        for label in self.primary.iter_mut().chain(&mut self.secondary) {
            let (span, places) = sources.trace(label.span);
            label.span = span;
            for place in places {
                if !used.contains(&place) {
                    used.push(place);
                }
            }
        }
        for place in used {
            if !self.secondary.iter().chain(&self.primary).any(|l| l.span == place) {
                self = self.and(place, "put in place here");
            }
        }
        self
    }

    /// Adds a suggestion.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.helps.push(text.into());
        self
    }

    /// Adds a fix: one text in place of another.
    #[must_use]
    pub fn fix(mut self, title: impl Into<String>, span: Span, text: impl Into<String>) -> Self {
        self.fix = Some(Fix { title: title.into(), edits: vec![(span, text.into())] });
        self
    }

    /// Adds background.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }
}

/// The result of a check, before it becomes a message.
pub trait Fact {
    /// The message.
    fn into_diagnostic(self) -> Diagnostic;
}

/// Maximum number of findings that are kept, errors before warnings; the others are only counted.
pub const MAX_FINDINGS: usize = 10_000;

/// The findings of a stage.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    /// The number of errors and of warnings that were dropped.
    left_out: (usize, usize),
}

impl Diagnostics {
    /// No findings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Records a fact.
    pub fn report(&mut self, fact: impl Fact) {
        self.list.push(fact.into_diagnostic());
        // Not at each report: it sorts them.
        if self.list.len() >= MAX_FINDINGS + MAX_FINDINGS / 4 {
            self.limit();
        }
    }

    /// Drops the findings after the first `kept`.
    pub(crate) fn take_back(&mut self, kept: usize) {
        self.list.truncate(kept);
    }

    /// Adds a label to the findings after the first `known`.
    pub(crate) fn add_label(&mut self, known: usize, at: Span, text: String) {
        for d in self.list.iter_mut().skip(known) {
            *d = d.clone().and(at, text.clone());
        }
    }

    /// Appends the findings of another stage.
    pub fn append(&mut self, mut other: Diagnostics) {
        self.list.append(&mut other.list);
        self.left_out.0 += other.left_out.0;
        self.left_out.1 += other.left_out.1;
    }

    /// Drops findings above the limit: warnings first, and the last ones of those.
    fn limit(&mut self) {
        if self.list.len() <= MAX_FINDINGS {
            return;
        }
        self.list.order_by_key(|d| d.severity);
        for d in self.list.drain(MAX_FINDINGS..) {
            match d.severity {
                Severity::Error => self.left_out.0 += 1,
                Severity::Warning => self.left_out.1 += 1,
            }
        }
    }

    /// The number of findings that were dropped.
    pub fn left_out(&self) -> usize {
        self.left_out.0 + self.left_out.1
    }

    /// Whether any finding is an error.
    pub fn has_errors(&self) -> bool {
        self.left_out.0 > 0 || self.list.iter().any(|d| d.severity == Severity::Error)
    }

    /// The number of errors and of warnings, dropped ones included.
    pub fn counts(&self) -> (usize, usize) {
        let errors = self.list.iter().filter(|d| d.severity == Severity::Error).count();
        (errors + self.left_out.0, self.list.len() - errors + self.left_out.1)
    }

    /// Points at the text itself where `use` expanded it, and at the `use`.
    pub fn trace(&mut self, sources: &SourceMap) {
        self.list = std::mem::take(&mut self.list).into_iter().map(|d| d.traced(sources)).collect();
    }

    /// Removes fixes that change files of some kind: fixes are for programs.
    pub fn strip_fixes(&mut self, is_kept_out: impl Fn(FileId) -> bool) {
        for d in &mut self.list {
            d.fix = d.fix.take().filter(|fix| !fix.edits.iter().any(|(span, _)| is_kept_out(span.file())));
            d.suggestions.retain(|suggestion| !suggestion.touches(&is_kept_out));
        }
    }

    /// Sorts by file and place, findings without a place first; removes duplicates and applies the limit.
    pub fn sort(&mut self) {
        self.limit();
        self.list.order_by_key(|d| (d.primary.as_ref().map(|l| l.span), d.code));
        self.list.dedup();
    }

    /// Keeps the findings for which `keep` holds.
    pub fn retain(&mut self, keep: impl FnMut(&Diagnostic) -> bool) {
        self.list.retain(keep);
    }

    /// The findings.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

//! Facts about names.

use super::did_you_mean;
use crate::diagnostic::similar::nearest;
use crate::diagnostic::{Code, Diagnostic, Fact, MAX_CANDIDATES};
use crate::source::Span;

/// A name that nothing declares.
pub struct UnknownName {
    /// What kind of thing was looked for: `mode`.
    pub kind: &'static str,
    /// The name.
    pub name: String,
    /// Its place.
    pub at: Span,
    /// The nearest name of that kind, and whether it is the only near one.
    near: Option<(String, bool)>,
    /// Where that one is declared.
    declared: Option<Span>,
    /// All names of that kind, each with where it is declared, if they are few and none is near.
    known: Vec<(String, Option<Span>)>,
    /// What the name is elsewhere, and how that is used.
    suggestion: Option<String>,
}

/// The most names that are listed.
const MAX_LISTED: usize = 8;

impl UnknownName {
    /// The name of some kind that is at a place, and all names of that kind with where they are declared.
    pub fn new<'a>(
        kind: &'static str,
        name: &str,
        at: Span,
        known: impl IntoIterator<Item = (&'a str, Option<Span>)>,
    ) -> Self {
        let known: Vec<(&str, Option<Span>)> = known.into_iter().take(MAX_CANDIDATES).collect();
        let near = nearest(name, known.iter().map(|(text, _)| *text));
        let declared = near.and_then(|(near, _)| known.iter().find(|(text, _)| *text == near)?.1);
        let listed = if near.is_some() || known.len() > MAX_LISTED { &[] } else { known.as_slice() };
        UnknownName {
            kind,
            name: name.to_string(),
            at,
            near: near.map(|(text, only)| (text.to_string(), only)),
            declared,
            known: listed.iter().map(|(text, at)| ((*text).to_string(), *at)).collect(),
            suggestion: None,
        }
    }

    /// Says what the name is instead, if it is something: then names that are like it are of no interest.
    #[must_use]
    pub fn suggestion(mut self, what: Option<String>) -> Self {
        if what.is_some() {
            (self.near, self.declared, self.known) = (None, None, Vec::new());
        }
        self.suggestion = what;
        self
    }
}

impl Fact for UnknownName {
    fn into_diagnostic(self) -> Diagnostic {
        let UnknownName { kind, name, at, near, declared, known, suggestion } = self;
        let hint = did_you_mean(near.as_ref().map(|(near, _)| near));
        let label = if suggestion.is_some() { "does not fit here" } else { "not declared" };
        let mut d = Diagnostic::new(Code::UnknownName, format!("no {kind} named `{name}`{hint}")).at(at, label);
        if let (Some((near, _)), Some(declared)) = (&near, declared) {
            d = d.and(declared, format!("`{near}` is declared here"));
        }
        // Of two names that are near either may be meant; and a place may hold more than the name.
        let d = match near {
            Some((near, true)) if at.range().len() == name.len() => d.fix(format!("write `{near}`"), at, near),
            _ => d,
        };
        if let Some(suggestion) = suggestion {
            return d.help(suggestion);
        }
        if known.is_empty() {
            return d;
        }
        if let [(only, Some(declared))] = known.as_slice() {
            return d.and(*declared, format!("there is only `{only}`"));
        }
        let known: Vec<String> = known.iter().map(|(n, _)| format!("`{n}`")).collect();
        d.help(format!("there {} {}", if known.len() == 1 { "is" } else { "are" }, super::list(&known, "and")))
    }
}

/// A name declared twice.
pub struct DuplicateName {
    /// What kind of thing it names.
    pub kind: &'static str,
    /// The name.
    pub name: String,
    /// The first declaration.
    pub first: Span,
    /// The second one.
    pub second: Span,
}

impl Fact for DuplicateName {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::DuplicateName, format!("{} `{}` is declared twice", self.kind, self.name))
            .at(self.second, "declared again")
            .and(self.first, "first declared here")
    }
}

/// A mode's name that fits several modes.
pub struct AmbiguousMode {
    /// The name as written.
    pub name: String,
    /// Its place.
    pub at: Span,
    /// The full paths that it fits.
    pub fits: Vec<(String, Span)>,
}

impl Fact for AmbiguousMode {
    fn into_diagnostic(self) -> Diagnostic {
        let paths: Vec<String> = self.fits.iter().map(|(path, _)| format!("`{path}`")).collect();
        let mut d = Diagnostic::new(Code::AmbiguousMode, format!("`{}` fits several modes", self.name))
            .at(self.at, "which one?")
            .help(format!("write {}", super::list(&paths, "or")));
        for (path, span) in self.fits {
            d = d.and(span, format!("`{path}`"));
        }
        d
    }
}

/// Behaviours that use each other.
pub struct BehaviorCycle {
    /// The `use` that closes the cycle.
    pub at: Span,
    /// The behaviours on the cycle, the first also at the end.
    pub names: Vec<String>,
}

impl Fact for BehaviorCycle {
    fn into_diagnostic(self) -> Diagnostic {
        let chain: Vec<String> = self.names.iter().map(|n| format!("`{n}`")).collect();
        Diagnostic::new(Code::BehaviorCycle, format!("behaviours use each other: {}", chain.join(" → ")))
            .at(self.at, "this use closes the cycle")
            .help("move what both need into a third behaviour")
    }
}

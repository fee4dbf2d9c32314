//! Facts about names.

use super::did_you_mean;
use crate::diagnostic::similar::nearest;
use crate::diagnostic::{Code, Diagnostic, Fact, MAX_CANDIDATES};
use crate::source::Span;

/// A name that nothing declares.
pub struct UnknownName {
    /// The kind of name expected: `mode`.
    pub kind: &'static str,
    /// The name.
    pub name: String,
    /// Its place.
    pub at: Span,
    /// The nearest name of that kind, and whether it is the only similar name.
    near: Option<(String, bool)>,
    /// Its declaration.
    declared: Option<Span>,
    /// All names of that kind with their declarations, if there are few and none is similar.
    known: Vec<(String, Option<Span>)>,
    /// What the name is elsewhere, and how that is used.
    suggestion: Option<String>,
}

/// Maximum number of listed names.
const MAX_LISTED: usize = 8;

impl UnknownName {
    /// A name of a kind at a place, with all declared names of that kind.
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

    /// Whether the name could be that of an instance: it is nothing else.
    pub fn may_be_instance(&self) -> bool {
        matches!(self.kind, "instance" | "instance or space") && self.suggestion.is_none()
    }

    /// The nearest name.
    pub fn near(&self) -> Option<&str> {
        self.near.as_ref().map(|(name, _)| name.as_str())
    }

    /// Sets the name that is certainly meant, if there is one: then similar names do not matter.
    #[must_use]
    pub fn meaning(mut self, name: Option<&str>) -> Self {
        if let Some(name) = name {
            (self.near, self.declared, self.known) = (Some((name.to_string(), true)), None, Vec::new());
        }
        self
    }

    /// Sets the use of the name elsewhere, if there is one: then similar names do not matter.
    #[must_use]
    pub fn suggestion(mut self, what: Option<String>) -> Self {
        if what.is_some() {
            (self.near, self.declared, self.known) = (None, None, Vec::new());
        }
        self.suggestion = what;
        self
    }

    /// Sets how such a name is declared, unless it is nearly one that is known.
    #[must_use]
    pub fn declared_by(self, what: String) -> Self {
        if self.near.is_some() { self } else { self.suggestion(Some(what)) }
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
            Some((near, _)) if at.range().len() == name.len() => d.or_write(at, near),
            _ => d,
        };
        let d = Diagnostic { missing: Some((kind, name)), ..d };
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
    /// The kind of declaration.
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
            .or_remove("the second declaration", self.second)
            .or_remove("the first declaration", self.first)
    }
}

/// A mode's name that matches several modes.
pub struct AmbiguousMode {
    /// The name as written.
    pub name: String,
    /// Its place.
    pub at: Span,
    /// The full paths of the modes that match.
    pub fits: Vec<(String, Span)>,
}

impl Fact for AmbiguousMode {
    fn into_diagnostic(self) -> Diagnostic {
        let paths: Vec<String> = self.fits.iter().map(|(path, _)| format!("`{path}`")).collect();
        let mut d = Diagnostic::new(Code::AmbiguousMode, format!("`{}` fits several modes", self.name))
            .at(self.at, "which one?")
            .help(format!("write {}", super::list(&paths, "or")));
        for (path, span) in self.fits {
            d = d.and(span, format!("`{path}`")).or_write(self.at, path);
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
            .or_remove("this `use`", self.at)
    }
}

/// Conditions that use each other.
pub struct ConditionCycle {
    /// The use that closes the cycle.
    pub at: Span,
    /// The conditions on the cycle, the first also at the end.
    pub names: Vec<String>,
}

impl Fact for ConditionCycle {
    fn into_diagnostic(self) -> Diagnostic {
        let chain: Vec<String> = self.names.iter().map(|n| format!("`{n}`")).collect();
        Diagnostic::new(Code::ConditionCycle, format!("conditions use each other: {}", chain.join(" → ")))
            .at(self.at, "this use closes the cycle")
            .help("a condition stands for its expression: write out what is meant here")
    }
}

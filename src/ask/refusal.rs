//! Why a question cannot be asked: findings with their locations, or a plain sentence.

use crate::diagnostic::{Diagnostics, Fact, Severity};
use crate::source::SourceMap;
use crate::why::place as place_of;

/// Why a question cannot be asked, or its answer cannot be kept.
#[derive(Debug)]
pub enum Refusal {
    /// Findings.
    Findings(Diagnostics),
    /// A sentence.
    Plain(String),
}

impl Refusal {
    /// One finding.
    pub fn of(fact: impl Fact) -> Self {
        let mut found = Diagnostics::new();
        found.report(fact);
        Refusal::Findings(found)
    }

    /// In one sentence: the first finding, with its place and its help.
    pub fn sentence(&self, sources: &SourceMap) -> String {
        let found = match self {
            Refusal::Plain(message) => return message.clone(),
            Refusal::Findings(found) => found.iter().find(|found| found.severity == Severity::Error),
        };
        let Some(found) = found else { return "the question cannot be asked".to_string() };
        let place = found.primary.as_ref().filter(|label| sources.holds(label.span));
        let place = place.map_or(String::new(), |label| format!("{}: ", place_of(sources, label.span)));
        let help = found.helps.first().map_or(String::new(), |help| format!(" ({help})"));
        format!("{place}{}{help}", found.message)
    }
}

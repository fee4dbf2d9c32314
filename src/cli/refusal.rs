//! Why a command cannot be carried out: findings with their locations, or a plain sentence.

use std::io;

use crate::diagnostic::{Diagnostics, Fact, render};
use crate::source::SourceMap;

use super::report::{plain_error, show};

/// Why a question cannot be asked, or its answer cannot be kept.
pub(super) enum Refusal {
    Findings(Diagnostics),
    Plain(String),
}

impl Refusal {
    pub fn of(fact: impl Fact) -> Self {
        let mut found = Diagnostics::new();
        found.report(fact);
        Refusal::Findings(found)
    }

    /// Shows it on standard error.
    pub fn show(&self, sources: &SourceMap) -> io::Result<()> {
        match self {
            Refusal::Findings(found) => show(sources, found),
            Refusal::Plain(message) => plain_error(message),
        }
    }

    /// As text, a line for each finding.
    pub fn text(&self, sources: &SourceMap) -> String {
        match self {
            Refusal::Findings(found) => render::short(sources, found.iter()).trim_end().to_string(),
            Refusal::Plain(message) => message.clone(),
        }
    }
}

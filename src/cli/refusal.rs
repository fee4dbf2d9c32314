//! Shows why a command cannot be carried out.

use std::io;

use crate::diagnostic::render;
use crate::source::SourceMap;

use super::report::{plain_error, show};

pub(super) use crate::ask::Refusal;

impl Refusal {
    /// Shows it on standard error.
    pub(in crate::cli) fn show(&self, sources: &SourceMap) -> io::Result<()> {
        match self {
            Refusal::Findings(found) => show(sources, found),
            Refusal::Plain(message) => plain_error(message),
        }
    }

    /// As text, a line for each finding.
    pub(in crate::cli) fn text(&self, sources: &SourceMap) -> String {
        match self {
            Refusal::Findings(found) => render::short(sources, found.iter()).trim_end().to_string(),
            Refusal::Plain(message) => message.clone(),
        }
    }
}

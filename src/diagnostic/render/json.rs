//! The renderer for programs: everything that was found in a run, as one JSON object.

use serde::Serialize;

use super::{Found, distinct};
use crate::diagnostic::{Diagnostic, Label, Severity};
use crate::json::{Layout, text};
use crate::source::{SourceMap, Span};

/// The version of the object. It grows when a field changes its meaning or goes away.
const VERSION: u32 = 1;

/// The findings of a run of `hypedc check`.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Run {
    /// The version of this format.
    version: u32,
    /// The version of `hypedc`.
    hypedc: &'static str,
    /// The programs that were checked.
    programs: Vec<Program>,
    /// What was found in them.
    findings: Vec<Finding>,
}

/// A program that was checked.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Program {
    /// Its path.
    file: String,
    /// The number of errors.
    errors: usize,
    /// The number of warnings.
    warnings: usize,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Finding {
    /// The code, such as `E0302`.
    code: &'static str,
    /// `error` or `warning`.
    severity: &'static str,
    /// The finding in one line.
    message: String,
    /// The place that it is about.
    primary: Option<Place>,
    /// Other places.
    related: Vec<Place>,
    /// Ways out.
    helps: Vec<String>,
    /// Further lines.
    notes: Vec<String>,
    /// A repair.
    fix: Option<Mending>,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Place {
    #[serde(flatten)]
    range: Range,
    label: String,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Range {
    file: String,
    bytes: Bytes,
    start: Position,
    end: Position,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Bytes {
    start: u32,
    end: u32,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Position {
    line: usize,
    column: usize,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Mending {
    title: String,
    edits: Vec<Edit>,
}

#[derive(Serialize, PartialEq)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Edit {
    #[serde(flatten)]
    range: Range,
    text: String,
}

/// Renders the findings of all programs of a run as one JSON object, see `docs/formats/findings.md` for its fields.
///
/// # Errors
/// None that are known; those of `serde_json`.
pub fn json(run: &[Found<'_>]) -> Result<String, serde_json::Error> {
    let program = |found: &Found<'_>| {
        let (errors, warnings) = found.diagnostics.counts();
        Program { file: found.path.display().to_string(), errors, warnings }
    };
    let object = Run {
        version: VERSION,
        hypedc: env!("CARGO_PKG_VERSION"),
        programs: run.iter().map(program).collect(),
        findings: distinct(run, |found, d| finding(found.sources, d)),
    };
    Ok(text(&object, Layout::Indented)? + "\n")
}

/// The schema of what [`json`] renders.
#[cfg(feature = "testing")]
pub(crate) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(Run)
}

fn finding(sources: &SourceMap, d: &Diagnostic) -> Finding {
    let place = |label: &Label| Place { range: range(sources, label.span), label: label.text.clone() };
    Finding {
        code: d.code.text(),
        severity: match d.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        },
        message: d.message.clone(),
        primary: d.primary.as_ref().map(place),
        related: d.secondary.iter().map(place).collect(),
        helps: d.helps.clone(),
        notes: d.notes.clone(),
        fix: d.fix.as_ref().map(|fix| Mending {
            title: fix.title.clone(),
            edits: fix
                .edits
                .iter()
                .map(|(span, text)| Edit { range: range(sources, *span), text: text.clone() })
                .collect(),
        }),
    }
}

fn range(sources: &SourceMap, span: Span) -> Range {
    let file = sources.file(span.file());
    let position = |byte: u32| {
        let (line, column) = file.line_column(byte as usize);
        Position { line, column }
    };
    Range {
        file: file.path.display().to_string(),
        bytes: Bytes { start: span.start(), end: span.end() },
        start: position(span.start()),
        end: position(span.end()),
    }
}

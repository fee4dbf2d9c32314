//! The renderer for programs: everything that was found in a run, as one JSON object.

use serde::Serialize;

use super::{Found, distinct};
use crate::diagnostic::{Diagnostic, Label, Severity};
use crate::source::{SourceMap, Span};

/// The version of the object. It grows when a field changes its meaning or goes away.
const VERSION: u32 = 1;

#[derive(Serialize)]
struct Run {
    version: u32,
    hypedc: &'static str,
    programs: Vec<Program>,
    findings: Vec<Finding>,
}

#[derive(Serialize)]
struct Program {
    file: String,
    errors: usize,
    warnings: usize,
}

#[derive(Serialize, PartialEq)]
struct Finding {
    code: &'static str,
    severity: &'static str,
    message: String,
    primary: Option<Place>,
    related: Vec<Place>,
    helps: Vec<String>,
    notes: Vec<String>,
    fix: Option<Mending>,
}

#[derive(Serialize, PartialEq)]
struct Place {
    #[serde(flatten)]
    range: Range,
    label: String,
}

#[derive(Serialize, PartialEq)]
struct Range {
    file: String,
    bytes: Bytes,
    start: Position,
    end: Position,
}

#[derive(Serialize, PartialEq)]
struct Bytes {
    start: u32,
    end: u32,
}

#[derive(Serialize, PartialEq)]
struct Position {
    line: usize,
    column: usize,
}

#[derive(Serialize, PartialEq)]
struct Mending {
    title: String,
    edits: Vec<Edit>,
}

#[derive(Serialize, PartialEq)]
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
    Ok(serde_json::to_string_pretty(&object)? + "\n")
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
    let file = sources.file(span.file);
    let position = |byte: u32| {
        let (line, column) = file.line_column(byte as usize);
        Position { line, column }
    };
    Range {
        file: file.path.display().to_string(),
        bytes: Bytes { start: span.start, end: span.end },
        start: position(span.start),
        end: position(span.end),
    }
}

//! Findings as the editor shows them: by document, each once, however many programs import it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gen_lsp_types::{
    Code as WrittenCode, Diagnostic as ShownDiagnostic, DiagnosticRelatedInformation, DiagnosticSeverity,
    DiagnosticTag, Location, Position, PublishDiagnosticsParams, Range, Uri,
};

use super::to_protocol;
use super::uri::{path_of, uri_of};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::alignment::Alignment;
use crate::lsp::text::document_text::Encoding;
use crate::source::Span;

/// What is shown of one program, by document.
type ByDocument = BTreeMap<String, Vec<ShownDiagnostic>>;

/// A document of a program, as the editor called it when that was compiled.
fn uri(snapshot: &Snapshot, path: &Path) -> Uri {
    snapshot.document(path).map_or_else(|| uri_of(path), |document| Uri(document.uri.clone()))
}

/// The range of a place in the text that was compiled.
fn range_of(snapshot: &Snapshot, at: Span, encoding: Encoding) -> Range {
    to_protocol::range(&snapshot.text(at.file()), &at.range(), encoding)
}

/// Some findings of a program, by document.
fn by_document(snapshot: &Snapshot, found: &Diagnostics, encoding: Encoding) -> ByDocument {
    let mut out = ByDocument::new();
    for finding in found.iter() {
        let file = finding.primary.as_ref().map(|label| label.span.file());
        let path = file.map_or(snapshot.root.as_path(), |file| snapshot.path(file));
        out.entry(uri(snapshot, path).0).or_default().push(to_protocol_diagnostic(finding, snapshot, encoding));
    }
    out
}

/// What is left of the findings of an older state of a program: those whose lines are still there, at their new places.
fn carry_over(found: &ByDocument, old: &Snapshot, new: &Snapshot) -> ByDocument {
    let mut line_map = LineMap { old, new, new_lines: BTreeMap::new() };
    let mut out = ByDocument::new();
    for (uri, findings) in found {
        for finding in findings {
            let Some(range) = line_map.range(uri, finding.range) else { continue };
            let mut finding = ShownDiagnostic { range, ..finding.clone() };
            let related = finding.related_information.take().into_iter().flatten();
            let related = related.filter_map(|mut r| {
                r.location.range = line_map.range(&r.location.uri.0, r.location.range)?;
                Some(r)
            });
            finding.related_information = Some(related.collect()).filter(|r: &Vec<_>| !r.is_empty());
            out.entry(uri.clone()).or_default().push(finding);
        }
    }
    out
}

/// Where the lines of the documents of a program are in a newer state of it.
struct LineMap<'s> {
    old: &'s Snapshot,
    new: &'s Snapshot,
    /// Of each line its new place, if there is one; of a document that stayed as it was, nothing.
    new_lines: BTreeMap<String, Option<Vec<Option<usize>>>>,
}

impl LineMap<'_> {
    fn lines(&self, uri: &str) -> Option<Vec<Option<usize>>> {
        let path = path_of(&Uri(uri.into()));
        let (Some(old), Some(new)) = (self.old.file(&path), self.new.file(&path)) else { return Some(Vec::new()) };
        let (old, new) = (self.old.text(old), self.new.text(new));
        (!Arc::ptr_eq(&old, &new) && old != new).then(|| Alignment::between(old.code(), new.code()).new_lines())
    }

    fn range(&mut self, uri: &str, range: Range) -> Option<Range> {
        if !self.new_lines.contains_key(uri) {
            self.new_lines.insert(uri.to_string(), self.lines(uri));
        }
        let Some(lines) = self.new_lines.get(uri)? else { return Some(range) };
        let line = |old: u32| lines.get(old as usize).copied().flatten();
        let first = line(range.start.line)?;
        let stays = (range.start.line..=range.end.line).zip(first..).all(|(old, new)| line(old) == Some(new));
        let moved = |at: Position| Position { line: first as u32 + (at.line - range.start.line), ..at };
        stays.then(|| Range { start: moved(range.start), end: moved(range.end) })
    }
}

/// One finding.
pub(super) fn to_protocol_diagnostic(finding: &Diagnostic, snapshot: &Snapshot, encoding: Encoding) -> ShownDiagnostic {
    let start = Position { line: 0, character: 0 };
    let range = finding.primary.as_ref().map_or(Range { start, end: start }, |l| range_of(snapshot, l.span, encoding));
    let related = finding.secondary.iter().map(|label| DiagnosticRelatedInformation {
        location: Location {
            uri: uri(snapshot, snapshot.path(label.span.file())),
            range: range_of(snapshot, label.span, encoding),
        },
        message: if label.text.is_empty() { "see here".into() } else { label.text.to_string() },
    });
    let related: Vec<DiagnosticRelatedInformation> = related.collect();
    ShownDiagnostic {
        range,
        severity: Some(match finding.severity {
            Severity::Error => DiagnosticSeverity::Error,
            Severity::Warning => DiagnosticSeverity::Warning,
        }),
        code: Some(WrittenCode::String(finding.code.text().into())),
        code_description: None,
        source: Some("hypedc".into()),
        message: message(finding).into(),
        tags: tag(finding.code).map(|tag| vec![tag]),
        related_information: (!related.is_empty()).then_some(related),
        data: None,
    }
}

/// Words below a place that only point at it.
const REDUNDANT_LABELS: [&str; 2] = ["not declared", "does not fit here"];

/// The words of a finding: what was found, the label of the place, ways out, background.
fn message(finding: &Diagnostic) -> String {
    // In a terminal these words are below the place; here they would say the same twice.
    let adds = |text: &String| !finding.message.contains(text.as_str()) && !REDUNDANT_LABELS.contains(&text.as_str());
    let label = finding.primary.iter().map(|l| l.text.to_string()).filter(adds);
    let helps = finding.helps.iter().map(|text| format!("help: {text}"));
    let notes = finding.notes.iter().map(|text| format!("note: {text}"));
    let lines: Vec<String> = std::iter::once(finding.message.clone()).chain(label).chain(helps).chain(notes).collect();
    lines.join("\n")
}

/// What is without effect is shown faded.
fn tag(code: Code) -> Option<DiagnosticTag> {
    let without_effect = matches!(code.text(), "W0201" | "W0401" | "W0403" | "W0405" | "W0702");
    without_effect.then_some(DiagnosticTag::Unnecessary)
}

/// What is shown of a program.
#[derive(Debug, Default)]
struct ProgramFindings {
    /// What compiling found.
    compiling: ByDocument,
    /// What the analysis of values found: of the program as it is now or, until that is known, of its state before.
    values: ByDocument,
}

/// What is known of the open programs, and what was sent of it.
#[derive(Debug, Default)]
pub(super) struct Published {
    programs: BTreeMap<PathBuf, ProgramFindings>,
    /// With the version of the text that the places were counted in, for documents that are open.
    sent: BTreeMap<String, (Option<i32>, Vec<ShownDiagnostic>)>,
}

impl Published {
    /// A program was compiled, after an older state of it.
    pub fn compiled(&mut self, old: Option<&Snapshot>, new: &Snapshot, is_open: bool, encoding: Encoding) {
        let before = self.programs.remove(&new.root);
        if is_open {
            let compiling = by_document(new, &new.ide.compilation.diagnostics, encoding);
            let values = before.zip(old).map(|(before, old)| carry_over(&before.values, old, new)).unwrap_or_default();
            self.programs.insert(new.root.clone(), ProgramFindings { compiling, values });
        }
    }

    /// The values of a program were analysed.
    pub fn analyzed(&mut self, snapshot: &Snapshot, found: &Diagnostics, encoding: Encoding) {
        self.programs.entry(snapshot.root.clone()).or_default().values = by_document(snapshot, found, encoding);
    }

    /// A program is of no interest any more.
    pub fn removed(&mut self, root: &Path) {
        self.programs.remove(root);
    }

    /// The messages that bring the editor up to date: documents whose findings changed, those without any included, and
    /// those whose text changed around them: an editor may have kept places that it counted in the old text, as Eglot
    /// does.
    pub fn update(
        &mut self,
        is_open: impl Fn(&Path) -> bool,
        version: impl Fn(&str) -> Option<i32>,
    ) -> Vec<PublishDiagnosticsParams> {
        let programs = self.programs.iter().filter(|(root, _)| is_open(root));
        let programs = programs.flat_map(|(_, of)| [&of.compiling, &of.values]);
        let mut all = ByDocument::new();
        for (uri, found) in programs.flatten() {
            let known = all.entry(uri.clone()).or_default();
            for finding in found {
                // A finding in a file that several programs import comes once.
                if !known.contains(finding) {
                    known.push(finding.clone());
                }
            }
        }
        for uri in self.sent.keys() {
            all.entry(uri.clone()).or_default();
        }
        let mut messages = Vec::new();
        for (uri, diagnostics) in all {
            let now = (version(&uri), diagnostics);
            if self.sent.get(&uri).map_or(!now.1.is_empty(), |before| *before != now) {
                let (version, diagnostics) = now.clone();
                messages.push(PublishDiagnosticsParams { uri: Uri(uri.clone()), version, diagnostics });
            }
            if now.1.is_empty() {
                self.sent.remove(&uri);
            } else {
                self.sent.insert(uri, now);
            }
        }
        messages
    }
}

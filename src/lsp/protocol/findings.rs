//! Converts findings to the protocol's diagnostics and publishes them by document. A finding in a file that several
//! programs import is published once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gen_lsp_types::{
    Code as WrittenCode, CodeDescription, Diagnostic as ShownDiagnostic, DiagnosticRelatedInformation,
    DiagnosticSeverity, DiagnosticTag, Location, Position, PublishDiagnosticsParams, Range, Uri,
};

use super::client::Client;
use super::positions::{self, START};
use super::uri::{path_of, uri_of};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::lsp::features::findings::{is_unnecessary, message};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::alignment::Alignment;
use crate::lsp::text::document_text::Encoding;
use crate::source::Span;

/// The diagnostics of a program, by the URI of the document.
pub(super) type ByDocument = BTreeMap<String, Vec<ShownDiagnostic>>;

/// The URI of a file: of the document if it was open at compilation, or else of the path.
fn uri(snapshot: &Snapshot, path: &Path) -> Uri {
    snapshot.document(path).map_or_else(|| uri_of(path), |document| Uri(document.uri.clone()))
}

/// The range of a span in the compiled text.
fn range_of(snapshot: &Snapshot, at: Span, encoding: Encoding) -> Range {
    positions::range(&snapshot.text(at.file()), &at.range(), encoding)
}

/// Converts findings of a program, by document.
fn by_document(snapshot: &Snapshot, found: &Diagnostics, encoding: Encoding) -> ByDocument {
    let mut out = ByDocument::new();
    for finding in found.iter() {
        let file = finding.primary.as_ref().map(|label| label.span.file());
        let path = file.map_or(snapshot.root.as_path(), |file| snapshot.path(file));
        out.entry(uri(snapshot, path).0).or_default().push(to_protocol_diagnostic(finding, snapshot, encoding));
    }
    out
}

/// Moves the diagnostics of an older snapshot to a newer one. Drops diagnostics whose lines changed.
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

/// Maps lines of an older snapshot to a newer one.
struct LineMap<'s> {
    old: &'s Snapshot,
    new: &'s Snapshot,
    /// By URI: for each old line the new one, if it is unchanged; `None` for an unchanged document. Computed on demand.
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

/// Converts a finding.
pub(super) fn to_protocol_diagnostic(finding: &Diagnostic, snapshot: &Snapshot, encoding: Encoding) -> ShownDiagnostic {
    let range =
        finding.primary.as_ref().map_or(Range { start: START, end: START }, |l| range_of(snapshot, l.span, encoding));
    let related = finding.secondary.iter().map(|label| DiagnosticRelatedInformation {
        location: Location {
            uri: uri(snapshot, snapshot.path(label.span.file())),
            range: range_of(snapshot, label.span, encoding),
        },
        message: if label.text.is_empty() { "related location".into() } else { label.text.to_string() },
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
        tags: (is_unnecessary(finding.code) && !is_being_typed(finding, snapshot))
            .then(|| vec![DiagnosticTag::Unnecessary]),
        related_information: (!related.is_empty()).then_some(related),
        data: None,
    }
}

/// Says where the page of a finding's code is, if the client has one.
pub(super) fn describe(finding: &mut ShownDiagnostic, client: &Client) {
    let Some(WrittenCode::String(code)) = &finding.code else { return };
    // The findings of verdicts have no page.
    let address = Code::from_text(code).and_then(|code| client.explanation(code.text()));
    finding.code_description = address.map(|address| CodeDescription { href: Uri(address) });
}

/// Whether a finding is about lines of the last change of an open document.
fn is_being_typed(finding: &Diagnostic, snapshot: &Snapshot) -> bool {
    let Some(label) = &finding.primary else { return false };
    let file = label.span.file();
    let Some(edited) = snapshot.document(snapshot.path(file)).and_then(|document| document.edited.clone()) else {
        return false;
    };
    let lines = positions::range(&snapshot.text(file), &label.span.range(), Encoding::Utf8);
    lines.start.line <= *edited.end() && lines.end.line >= *edited.start()
}

/// The diagnostics of a program.
#[derive(Debug, Default)]
struct ProgramFindings {
    /// From the compiler.
    compiling: ByDocument,
    /// From the value analysis: of the current snapshot or, until that is analysed, carried over from an older one.
    values: ByDocument,
    /// From the verdicts on the current text.
    verdicts: ByDocument,
}

/// The diagnostics of all programs, and those that were sent.
#[derive(Debug, Default)]
pub(super) struct Published {
    programs: BTreeMap<PathBuf, ProgramFindings>,
    /// By URI, with the document version to which the ranges refer, if the document is open.
    sent: BTreeMap<String, (Option<i32>, Vec<ShownDiagnostic>)>,
}

impl Published {
    /// Updates a program that was compiled; `old` is its preceding snapshot.
    pub fn compiled(&mut self, old: Option<&Snapshot>, new: &Snapshot, is_open: bool, encoding: Encoding) {
        let before = self.programs.remove(&new.root);
        if is_open {
            let compiling = by_document(new, &new.ide.compilation.diagnostics, encoding);
            let values = before.zip(old).map(|(before, old)| carry_over(&before.values, old, new)).unwrap_or_default();
            self.programs.insert(new.root.clone(), ProgramFindings { compiling, values, verdicts: ByDocument::new() });
        }
    }

    /// Updates a program whose values were analysed.
    pub fn analyzed(&mut self, snapshot: &Snapshot, found: &Diagnostics, encoding: Encoding) {
        self.programs.entry(snapshot.root.clone()).or_default().values = by_document(snapshot, found, encoding);
    }

    /// Updates what the verdicts on a program find.
    pub fn asked(&mut self, root: &Path, found: ByDocument) {
        if let Some(program) = self.programs.get_mut(root) {
            program.verdicts = found;
        }
    }

    /// Removes a program that was closed or deleted.
    pub fn removed(&mut self, root: &Path) {
        self.programs.remove(root);
    }

    /// The notifications that update the editor: for each document whose diagnostics or version changed since they were
    /// sent. The version matters because an editor may keep ranges that refer to the old text, as Eglot does.
    pub fn update(
        &mut self,
        is_open: impl Fn(&Path) -> bool,
        version: impl Fn(&str) -> Option<i32>,
    ) -> Vec<PublishDiagnosticsParams> {
        let programs = self.programs.iter().filter(|(root, _)| is_open(root));
        let programs = programs.flat_map(|(_, of)| [&of.compiling, &of.values, &of.verdicts]);
        let mut all = ByDocument::new();
        for (uri, found) in programs.flatten() {
            let known = all.entry(uri.clone()).or_default();
            for finding in found {
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
            let current = (version(&uri), diagnostics);
            if self.sent.get(&uri).map_or(!current.1.is_empty(), |before| *before != current) {
                let (version, diagnostics) = current.clone();
                messages.push(PublishDiagnosticsParams { uri: Uri(uri.clone()), version, diagnostics });
            }
            if current.1.is_empty() {
                self.sent.remove(&uri);
            } else {
                self.sent.insert(uri, current);
            }
        }
        messages
    }
}

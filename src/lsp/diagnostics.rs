//! Findings as the editor shows them: by document, each once, however many programs import it.

use std::collections::BTreeMap;
use std::sync::Arc;

use gen_lsp_types::{
    Code as WrittenCode, Diagnostic as Shown, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag,
    Position, PublishDiagnosticsParams, Range, Uri,
};

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::source::FileId;

use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::alignment::Alignment;
use crate::lsp::text::document_text::Encoding;
use crate::lsp::text::uri::path_of;

/// What is shown of one program, by document.
pub(in crate::lsp) type ByDocument = BTreeMap<String, Vec<Shown>>;

/// Some findings of a program, by document.
pub(in crate::lsp) fn by_document(snapshot: &Snapshot, found: &Diagnostics, encoding: Encoding) -> ByDocument {
    let mut out = ByDocument::new();
    for finding in found.iter() {
        let file = finding.primary.as_ref().map(|label| label.span.file());
        let uri = file.map_or_else(|| snapshot.root_uri(), |file| snapshot.uri(file));
        out.entry(uri.0).or_default().push(shown(finding, snapshot, encoding));
    }
    out
}

/// What is left of the findings of an older state of a program: those whose lines are still there, at their new places.
pub(in crate::lsp) fn carried(found: &ByDocument, old: &Snapshot, new: &Snapshot) -> ByDocument {
    let mut moves = Moves { old, new, known: BTreeMap::new() };
    let mut out = ByDocument::new();
    for (uri, findings) in found {
        for finding in findings {
            let Some(range) = moves.range(uri, finding.range) else { continue };
            let mut finding = Shown { range, ..finding.clone() };
            let related = finding.related_information.take().into_iter().flatten();
            let related = related.filter_map(|mut r| {
                r.location.range = moves.range(&r.location.uri.0, r.location.range)?;
                Some(r)
            });
            finding.related_information = Some(related.collect()).filter(|r: &Vec<_>| !r.is_empty());
            out.entry(uri.clone()).or_default().push(finding);
        }
    }
    out
}

/// Where the lines of the documents of a program are in a newer state of it.
struct Moves<'s> {
    old: &'s Snapshot,
    new: &'s Snapshot,
    /// Of each line its new place, if there is one; of a document that stayed as it was, nothing.
    known: BTreeMap<String, Option<Vec<Option<usize>>>>,
}

impl Moves<'_> {
    fn lines(&self, uri: &str) -> Option<Vec<Option<usize>>> {
        let path = path_of(&Uri(uri.into()));
        let (Some(old), Some(new)) = (self.old.file(&path), self.new.file(&path)) else { return Some(Vec::new()) };
        let (old, new) = (self.old.text(old), self.new.text(new));
        (!Arc::ptr_eq(&old, &new) && old != new).then(|| Alignment::between(old.code(), new.code()).lines())
    }

    fn range(&mut self, uri: &str, range: Range) -> Option<Range> {
        if !self.known.contains_key(uri) {
            self.known.insert(uri.to_string(), self.lines(uri));
        }
        let Some(lines) = self.known.get(uri)? else { return Some(range) };
        let line = |old: u32| lines.get(old as usize).copied().flatten();
        let first = line(range.start.line)?;
        let stays = (range.start.line..=range.end.line).zip(first..).all(|(old, new)| line(old) == Some(new));
        let moved = |at: Position| Position { line: first as u32 + (at.line - range.start.line), ..at };
        stays.then(|| Range { start: moved(range.start), end: moved(range.end) })
    }
}

/// One finding.
pub(in crate::lsp) fn shown(finding: &Diagnostic, snapshot: &Snapshot, encoding: Encoding) -> Shown {
    let start = Position { line: 0, character: 0 };
    let range = finding.primary.as_ref().map_or(Range { start, end: start }, |l| snapshot.range(l.span, encoding));
    let related = finding.secondary.iter().map(|label| DiagnosticRelatedInformation {
        location: snapshot.location(label.span, encoding),
        message: if label.text.is_empty() { "see here".into() } else { label.text.to_string() },
    });
    let related: Vec<DiagnosticRelatedInformation> = related.collect();
    Shown {
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
const SAYS_NOTHING: [&str; 2] = ["not declared", "does not fit here"];

/// The words of a finding: what was found, the label of the place, ways out, background.
fn message(finding: &Diagnostic) -> String {
    // In a terminal these words are below the place; here they would say the same twice.
    let adds = |text: &String| !finding.message.contains(text.as_str()) && !SAYS_NOTHING.contains(&text.as_str());
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

/// What was sent, and what is to be sent next.
#[derive(Debug, Default)]
pub(in crate::lsp) struct Published {
    /// With the version of the text that the places were counted in, for documents that are open.
    sent: BTreeMap<String, (Option<i32>, Vec<Shown>)>,
}

impl Published {
    /// The messages that bring the editor up to date: documents whose findings changed, those without any included, and
    /// those whose text changed around them: an editor may have kept places that it counted in the old text, as Eglot does.
    pub fn update<'a>(
        &mut self,
        programs: impl IntoIterator<Item = &'a ByDocument>,
        version: impl Fn(&str) -> Option<i32>,
    ) -> Vec<PublishDiagnosticsParams> {
        let mut all = ByDocument::new();
        for (uri, found) in programs.into_iter().flatten() {
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

/// The findings of a file that can be mended, and touch some bytes of it.
pub(in crate::lsp) fn mendable<'a>(
    snapshot: &'a Snapshot,
    more: Option<&'a Diagnostics>,
    file: FileId,
    bytes: std::ops::Range<usize>,
) -> impl Iterator<Item = &'a Diagnostic> {
    let found = snapshot.ide.compilation.diagnostics.iter().chain(more.into_iter().flat_map(Diagnostics::iter));
    found.filter(move |finding| {
        let touches = |l: &crate::diagnostic::Label| {
            l.span.file() == file && l.span.range().start <= bytes.end && bytes.start <= l.span.range().end
        };
        finding.fix.is_some() && finding.primary.as_ref().is_some_and(touches)
    })
}

//! Findings as the editor shows them: by document, each once, however many programs import it.

use std::collections::BTreeMap;

use gen_lsp_types::{
    Code as WrittenCode, Diagnostic as Shown, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag,
    Position, PublishDiagnosticsParams, Range, Uri,
};

use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::source::FileId;

use super::snapshot::Snapshot;
use super::text::Encoding;

/// What is shown of one program, by document.
pub(super) type ByDocument = BTreeMap<String, Vec<Shown>>;

/// The findings of a program, by document.
pub(super) fn by_document(snapshot: &Snapshot, more: Option<&Diagnostics>, encoding: Encoding) -> ByDocument {
    let mut out = ByDocument::new();
    let found = snapshot.study.compilation.diagnostics.iter();
    for finding in found.chain(more.into_iter().flat_map(Diagnostics::iter)) {
        let file = finding.primary.as_ref().map(|label| label.span.file);
        let uri = file.map_or_else(|| snapshot.root_uri(), |file| snapshot.uri(file));
        out.entry(uri.0).or_default().push(shown(finding, snapshot, encoding));
    }
    out
}

/// One finding.
pub(super) fn shown(finding: &Diagnostic, snapshot: &Snapshot, encoding: Encoding) -> Shown {
    let start = Position { line: 0, character: 0 };
    let range = finding.primary.as_ref().map_or(Range { start, end: start }, |l| snapshot.range(l.span, encoding));
    let related = finding.secondary.iter().map(|label| DiagnosticRelatedInformation {
        location: snapshot.location(label.span, encoding),
        message: if label.text.is_empty() { "see here".into() } else { label.text.clone() },
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

/// The words of a finding: what was found, what is said of the place, ways out, background.
fn message(finding: &Diagnostic) -> String {
    let label = finding.primary.iter().map(|l| l.text.clone()).filter(|text| !text.is_empty());
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
pub(super) struct Published {
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
            let before = self.sent.get(&uri);
            if before.map_or(&[][..], |(_, found)| found.as_slice()) != now.1
                || before.is_some_and(|(v, _)| *v != now.0)
            {
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
pub(super) fn mendable<'a>(
    snapshot: &'a Snapshot,
    more: Option<&'a Diagnostics>,
    file: FileId,
    bytes: std::ops::Range<usize>,
) -> impl Iterator<Item = &'a Diagnostic> {
    let found = snapshot.study.compilation.diagnostics.iter().chain(more.into_iter().flat_map(Diagnostics::iter));
    found.filter(move |finding| {
        let touches = |l: &crate::diagnostic::Label| {
            l.span.file == file && l.span.start as usize <= bytes.end && bytes.start <= l.span.end as usize
        };
        finding.fix.is_some() && finding.primary.as_ref().is_some_and(touches)
    })
}

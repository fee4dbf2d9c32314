//! What changes a text as a whole: formatting, and the fixes of findings.

use std::collections::HashMap;

use gen_lsp_types as types;
use gen_lsp_types::{CodeAction, CodeActionKind, TextEdit, Uri, WorkspaceEdit};

use crate::diagnostic::{Diagnostic, Fix};
use crate::format::format;
use crate::source::FileId;

use crate::lsp::diagnostics::{mendable, shown};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::alignment::runs;
use crate::lsp::text::document_text::{Encoding, Text};
use crate::lsp::text::uri::path_of;
use crate::lsp::view::{Failure, View};

impl View {
    pub(in crate::lsp) fn formatting(
        &self,
        params: types::DocumentFormattingParams,
    ) -> Result<Option<Vec<TextEdit>>, Failure> {
        let Some(document) = self.documents.get(&path_of(&params.text_document.uri)) else { return Ok(None) };
        Ok(formatted(&document.text).map(|new| edits(&document.text, &new, self.client.encoding, None)))
    }

    pub(in crate::lsp) fn range_formatting(
        &self,
        params: types::DocumentRangeFormattingParams,
    ) -> Result<Option<Vec<TextEdit>>, Failure> {
        let Some(document) = self.documents.get(&path_of(&params.text_document.uri)) else { return Ok(None) };
        let lines = params.range.start.line.min(params.range.end.line)..=params.range.end.line;
        Ok(formatted(&document.text).map(|new| edits(&document.text, &new, self.client.encoding, Some(lines))))
    }

    pub(in crate::lsp) fn code_actions(
        &self,
        params: types::CodeActionParams,
    ) -> Result<Option<Vec<types::CodeActionResponse>>, Failure> {
        let path = path_of(&params.text_document.uri);
        let encoding = self.client.encoding;
        let wants = |kind: &str| {
            let only = params.context.only.as_ref();
            only.is_none_or(|only| only.iter().any(|k| kind.starts_with(&k.to_string())))
        };
        let mut actions: Vec<CodeAction> = Vec::new();
        let mut all: Vec<&Fix> = Vec::new();
        let mut all_of: Option<&Snapshot> = None;
        for known in self.programs(&path) {
            let snapshot = &*known.now;
            let Some(file) = snapshot.file(&path) else { continue };
            let bytes = snapshot.text(file).bytes(params.range, encoding);
            for finding in mendable(snapshot, known.findings.as_ref(), file, bytes) {
                let action = quick_fix(finding, snapshot, encoding);
                if wants("quickfix") && !actions.contains(&action) {
                    actions.push(action);
                }
            }
            if all_of.is_none() {
                all_of = Some(snapshot);
                let own = mendable(snapshot, known.findings.as_ref(), file, 0..usize::MAX);
                let own = own.filter_map(|finding| finding.fix.as_ref());
                all.extend(own.filter(|fix| fix.edits.iter().all(|(span, _)| span.file == file)));
            }
        }
        if let (Some(snapshot), true) = (all_of, wants("source.fixAll") && !all.is_empty()) {
            let edit = workspace_edit(snapshot, apart(&all), encoding);
            actions.push(CodeAction {
                title: "mend all that is certain".into(),
                kind: Some(CodeActionKind::SourceFixAll),
                edit: Some(edit),
                ..CodeAction::default()
            });
        }
        Ok(Some(actions.into_iter().map(Into::into).collect()))
    }
}

fn quick_fix(finding: &Diagnostic, snapshot: &Snapshot, encoding: Encoding) -> CodeAction {
    let edits = finding.fix.iter().flat_map(|fix| &fix.edits).map(|(span, text)| (*span, text.as_str()));
    CodeAction {
        title: finding.fix.as_ref().map(|fix| fix.title.clone()).unwrap_or_default(),
        kind: Some(CodeActionKind::QuickFix),
        diagnostics: Some(vec![shown(finding, snapshot, encoding)]),
        is_preferred: Some(true),
        edit: Some(workspace_edit(snapshot, edits, encoding)),
        ..CodeAction::default()
    }
}

/// The edits of several fixes; a fix that overlaps one before it is left for the next time.
fn apart<'a>(fixes: &[&'a Fix]) -> Vec<(crate::source::Span, &'a str)> {
    let mut out: Vec<(crate::source::Span, &str)> = Vec::new();
    for fix in fixes {
        let overlaps = fix
            .edits
            .iter()
            .any(|(a, _)| out.iter().any(|(b, _)| a.file == b.file && a.start <= b.end && b.start <= a.end));
        if !overlaps {
            out.extend(fix.edits.iter().map(|(span, text)| (*span, text.as_str())));
        }
    }
    out
}

/// Changes of documents.
pub(in crate::lsp) fn workspace_edit<'a>(
    snapshot: &Snapshot,
    edits: impl IntoIterator<Item = (crate::source::Span, &'a str)>,
    encoding: Encoding,
) -> WorkspaceEdit {
    let mut by_file: Vec<(FileId, Vec<TextEdit>)> = Vec::new();
    for (span, text) in edits {
        let edit = TextEdit { range: snapshot.range(span, encoding), new_text: text.into() };
        match by_file.iter_mut().find(|(file, _)| *file == span.file) {
            Some((_, edits)) => edits.push(edit),
            None => by_file.push((span.file, vec![edit])),
        }
    }
    let changes: HashMap<Uri, Vec<TextEdit>> =
        by_file.into_iter().map(|(file, edits)| (snapshot.uri(file), edits)).collect();
    WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }
}

/// The canonical layout; none of a text that does not fit the grammar.
fn formatted(text: &Text) -> Option<String> {
    // The formatter knows LF and CRLF; what comes from the disk was put right already.
    let code = text.code();
    let only_feeds = || code.replace("\r\n", "\u{0}\n").replace('\r', "\n").replace("\u{0}\n", "\r\n");
    let code = if code.contains('\r') { only_feeds() } else { code.to_string() };
    format(FileId(0), &code).ok()
}

/// The lines that change, each run of them as one edit, so that cursors and folds stay where nothing changes. Only runs
/// that touch `lines`, if they are given.
fn edits(text: &Text, new: &str, encoding: Encoding, lines: Option<std::ops::RangeInclusive<u32>>) -> Vec<TextEdit> {
    let old: Vec<&str> = text.code().split_inclusive('\n').collect();
    let new: Vec<&str> = new.split_inclusive('\n').collect();
    let mut out = Vec::new();
    // The byte at which each old line begins.
    let mut starts = vec![0];
    for line in &old {
        starts.push(starts.last().copied().unwrap_or(0) + line.len());
    }
    for (from, put) in runs(&old, &new) {
        let touched = from.start as u32..=(from.end.max(from.start + 1) - 1) as u32;
        if lines.as_ref().is_some_and(|l| touched.start() > l.end() || l.start() > touched.end()) {
            continue;
        }
        let bytes = starts.get(from.start).copied().unwrap_or(0)..starts.get(from.end).copied().unwrap_or(0);
        let new_text = new.get(put).unwrap_or_default().concat();
        out.push(TextEdit { range: text.range(bytes, encoding), new_text });
    }
    out
}

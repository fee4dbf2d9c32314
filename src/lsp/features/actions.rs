//! Edits of documents: formatting, and code actions for the fixes of findings.

use std::ops::{Range, RangeInclusive};
use std::path::Path;

use crate::diagnostic::{Diagnostic, Diagnostics, Fix, Label};
use crate::format::format;
use crate::source::{FileId, Span};

use crate::lsp::location::Edit;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::alignment::hunks;
use crate::lsp::text::document_text::Text;
use crate::lsp::view::View;

/// The kind of a code action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum ActionKind {
    /// Applies the fix of one finding.
    Fix,
    /// Applies the fixes of all findings of a file that do not overlap.
    FixAll,
}

/// A code action.
#[derive(Debug)]
pub(in crate::lsp) struct CodeAction<'v> {
    pub title: &'v str,
    pub kind: ActionKind,
    /// The finding that is fixed, and its program.
    pub finding: Option<(&'v Snapshot, &'v Diagnostic)>,
    pub edits: Vec<Edit>,
}

/// The fixes of the findings in a range of a file, in each program that contains it; and all fixes of the file as one
/// action.
pub(in crate::lsp) fn code_actions<'v>(view: &'v View, path: &Path, bytes: &Range<usize>) -> Vec<CodeAction<'v>> {
    let mut actions: Vec<CodeAction<'v>> = Vec::new();
    let mut all: Option<CodeAction<'v>> = None;
    let programs = view.programs_with(path).filter_map(|state| Some((state, state.current.file(path)?)));
    for (index, (state, file)) in programs.enumerate() {
        let (snapshot, more) = (&*state.current, state.findings.as_ref());
        let here = view.byte_in(snapshot, file, bytes.start)..view.byte_in(snapshot, file, bytes.end);
        for (finding, fix) in fixable(snapshot, more, file, here) {
            actions.push(CodeAction {
                title: &fix.title,
                kind: ActionKind::Fix,
                finding: Some((snapshot, finding)),
                edits: edits_of(snapshot, fix.edits.iter()),
            });
        }
        if index == 0 {
            let own = fixable(snapshot, more, file, 0..usize::MAX).map(|(_, fix)| fix);
            let own: Vec<&Fix> = own.filter(|fix| fix.edits.iter().all(|(span, _)| span.file() == file)).collect();
            all = (!own.is_empty()).then(|| CodeAction {
                title: "apply all unambiguous fixes",
                kind: ActionKind::FixAll,
                finding: None,
                edits: edits_of(snapshot, without_overlaps(&own)),
            });
        }
    }
    actions.extend(all);
    actions
}

/// The findings with a fix that touch a range of a file, with their fixes.
fn fixable<'v>(
    snapshot: &'v Snapshot,
    more: Option<&'v Diagnostics>,
    file: FileId,
    bytes: Range<usize>,
) -> impl Iterator<Item = (&'v Diagnostic, &'v Fix)> {
    let found = snapshot.ide.compilation.diagnostics.iter().chain(more.into_iter().flat_map(Diagnostics::iter));
    let touches = move |label: &Label| {
        let at = label.span.range();
        label.span.file() == file && at.start <= bytes.end && bytes.start <= at.end
    };
    found.filter_map(move |finding| {
        let fix = finding.fix.as_ref()?;
        finding.primary.as_ref().is_some_and(&touches).then_some((finding, fix))
    })
}

fn edits_of<'f>(snapshot: &Snapshot, edits: impl IntoIterator<Item = &'f (Span, String)>) -> Vec<Edit> {
    edits.into_iter().map(|(at, text)| Edit { at: snapshot.location(*at), new_text: text.clone() }).collect()
}

/// The edits of several fixes. A fix that overlaps a preceding one is skipped; it can be applied afterwards.
fn without_overlaps<'f>(fixes: &[&'f Fix]) -> Vec<&'f (Span, String)> {
    let mut out: Vec<&(Span, String)> = Vec::new();
    for fix in fixes {
        let overlaps = fix.edits.iter().any(|(a, _)| {
            out.iter().any(|(b, _)| a.file() == b.file() && a.start() <= b.end() && b.start() <= a.end())
        });
        if !overlaps {
            out.extend(&fix.edits);
        }
    }
    out
}

/// The edits that format a text; with `lines`, only those that touch these lines. `None` if the text has syntax
/// errors.
pub(in crate::lsp) fn formatting(
    text: &Text,
    lines: Option<&RangeInclusive<u32>>,
) -> Option<Vec<(Range<usize>, String)>> {
    formatted(text).map(|new| edits(text, &new, lines))
}

/// The formatted text; `None` if the text has syntax errors.
fn formatted(text: &Text) -> Option<String> {
    // The formatter accepts LF and CRLF. A lone CR, which occurs only in texts of editors, becomes LF.
    let code = text.code();
    let only_feeds = || code.replace("\r\n", "\u{0}\n").replace('\r', "\n").replace("\u{0}\n", "\r\n");
    let code = if code.contains('\r') { only_feeds() } else { code.to_string() };
    format(FileId(0), &code).ok()
}

/// One edit per hunk of changed lines, so that cursors and folds elsewhere are kept. With `lines`, only hunks that
/// touch these lines.
fn edits(text: &Text, new: &str, lines: Option<&RangeInclusive<u32>>) -> Vec<(Range<usize>, String)> {
    let old: Vec<&str> = text.code().split_inclusive('\n').collect();
    let new: Vec<&str> = new.split_inclusive('\n').collect();
    let mut out = Vec::new();
    // The offset of each old line.
    let mut starts = vec![0];
    for line in &old {
        starts.push(starts.last().copied().unwrap_or(0) + line.len());
    }
    for (from, put) in hunks(&old, &new) {
        let touched = from.start as u32..=(from.end.max(from.start + 1) - 1) as u32;
        if lines.is_some_and(|l| touched.start() > l.end() || l.start() > touched.end()) {
            continue;
        }
        let bytes = starts.get(from.start).copied().unwrap_or(0)..starts.get(from.end).copied().unwrap_or(0);
        out.push((bytes, new.get(put).unwrap_or_default().concat()));
    }
    out
}

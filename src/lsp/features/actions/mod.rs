//! Code actions: the fixes and suggestions of findings, declarations of missing names, refactorings.
//!
//! What an action does is tried before it is offered: the program is compiled with its edits. A way to mend a finding
//! must mend it and add no error; a refactoring must keep the program as it is. Where that takes long, and the editor
//! can ask for the edits of one action, refactorings are tried when they are chosen.
//!
//! | file | holds |
//! |---|---|
//! | `blocks` | where statements and blocks are in a text, what goes with a removed one, where a new one belongs |
//! | `draft` | edits, their layout, the trial |
//! | `suggest` | the suggestions of the checks as edits |
//! | `create` | declarations of missing names, imports |
//! | `extract`, `inline`, `relocate`, `negate` | refactorings |

mod blocks;
pub(in crate::lsp) mod create;
mod draft;
mod extract;
mod inline;
mod negate;
mod relocate;
mod suggest;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, Diagnostics, Fix, Label};
use crate::source::{FileId, Span};

use crate::lsp::location::Edit;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::view::{Refusal, View};

use blocks::Blocks;
use draft::{Draft, Drafted, Keeps};

/// The kind of a code action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum ActionKind {
    /// Applies the fix of one finding.
    Fix,
    /// Mends a finding in one of several ways.
    Suggestion,
    /// Applies the fixes of all findings of a file that do not overlap.
    FixAll,
    /// Names a part of the program.
    Extract,
    /// Writes what a name stands for in its place.
    Inline,
    /// Moves a part to another file.
    Move,
    /// Writes the same in another way.
    Rewrite,
}

/// A code action.
#[derive(Debug)]
pub(in crate::lsp) struct CodeAction<'v> {
    pub title: String,
    pub kind: ActionKind,
    /// The finding that is mended, and its program.
    pub finding: Option<(&'v Snapshot, &'v Diagnostic)>,
    /// `None` if it is not tried yet.
    pub edits: Option<Edits>,
}

/// What an action does.
#[derive(Debug, Default, PartialEq, Eq)]
pub(in crate::lsp) struct Edits {
    pub edits: Vec<Edit>,
    /// New files with their texts.
    pub new_files: BTreeMap<PathBuf, String>,
}

impl From<Drafted> for Edits {
    fn from(drafted: Drafted) -> Self {
        Edits { edits: drafted.edits(), new_files: drafted.new_files }
    }
}

/// A refactoring before it is tried.
struct Candidate {
    title: String,
    kind: ActionKind,
    /// Whether the program must stay the same but for its order; otherwise it must have no new finding.
    keeps_program: bool,
    draft: Draft,
}

impl Candidate {
    fn tried(self, view: &View, snapshot: &Snapshot) -> Option<Edits> {
        let drafted = self.draft.drafted(snapshot)?;
        let keeps = if self.keeps_program { Keeps::Program } else { Keeps::Findings };
        drafted.holds(view, snapshot, keeps).then(|| drafted.into())
    }
}

/// The number of bytes that are compiled at once to try what is offered.
const MAX_TRIED: usize = 1 << 20;

/// The size of a program whose refactorings are tried when they are listed.
const MAX_EAGER: usize = 64 << 10;

/// The actions for a range of a file, in each program that contains it. With `is_lazy`, refactorings of large programs
/// are listed without being tried.
pub(in crate::lsp) fn code_actions<'v>(
    view: &'v View,
    path: &Path,
    bytes: &Range<usize>,
    is_lazy: bool,
) -> Vec<CodeAction<'v>> {
    let mut actions: Vec<CodeAction<'v>> = Vec::new();
    let mut all: Option<CodeAction<'v>> = None;
    let programs = view.programs_with(path).filter_map(|state| Some((state, state.current.file(path)?)));
    for (index, (state, file)) in programs.enumerate() {
        let (snapshot, more) = (&*state.current, state.findings.as_ref());
        let here = view.byte_in(snapshot, file, bytes.start)..view.byte_in(snapshot, file, bytes.end);
        let is_current = view.text(path).is_some_and(|text| text == snapshot.text(file));
        let mut tried = 0;
        for finding in found_at(snapshot, more, file, here.clone()) {
            if let Some(fix) = &finding.fix {
                actions.push(CodeAction {
                    title: fix.title.clone(),
                    kind: ActionKind::Fix,
                    finding: Some((snapshot, finding)),
                    edits: Some(Edits { edits: edits_of(snapshot, fix.edits.iter()), new_files: BTreeMap::new() }),
                });
            }
            if is_current {
                actions.extend(mended(view, snapshot, finding, &mut tried));
            }
        }
        if index == 0 {
            if is_current {
                let is_lazy = is_lazy && size(snapshot) > MAX_EAGER;
                actions.extend(refactored(view, snapshot, file, &here, is_lazy));
            }
            let own = found_at(snapshot, more, file, 0..usize::MAX).filter_map(|finding| finding.fix.as_ref());
            let own: Vec<&Fix> = own.filter(|fix| fix.edits.iter().all(|(span, _)| span.file() == file)).collect();
            all = (!own.is_empty()).then(|| CodeAction {
                title: "apply all unambiguous fixes".into(),
                kind: ActionKind::FixAll,
                finding: None,
                edits: Some(Edits { edits: edits_of(snapshot, without_overlaps(&own)), new_files: BTreeMap::new() }),
            });
        }
    }
    actions.extend(all);
    actions
}

/// The edits of a refactoring that was listed without being tried.
pub(in crate::lsp) fn resolved(view: &View, path: &Path, bytes: &Range<usize>, title: &str) -> Result<Edits, Refusal> {
    let state = view.programs_with(path).next();
    let chosen = state.and_then(|state| {
        let snapshot = &*state.current;
        let file = snapshot.file(path)?;
        let found = candidates(view, snapshot, file, bytes);
        found.into_iter().find(|candidate| candidate.title == title)?.tried(view, snapshot)
    });
    chosen.ok_or_else(|| Refusal("this would change what the program does, or the text has changed".into()))
}

/// The number of bytes of a program's files.
fn size(snapshot: &Snapshot) -> usize {
    snapshot.ide.compilation.sources.iter().map(|(_, file)| file.text().len()).sum()
}

/// The ways to mend a finding that hold when they are tried.
fn mended<'v>(view: &View, snapshot: &'v Snapshot, finding: &'v Diagnostic, tried: &mut usize) -> Vec<CodeAction<'v>> {
    let suggested = finding
        .suggestions
        .iter()
        .filter_map(|suggestion| Some((suggestion.title.clone(), suggest::draft(view, snapshot, suggestion)?)));
    let drafts: Vec<_> = suggested.chain(create::created(view, snapshot, finding)).collect();
    let mut actions: Vec<CodeAction<'v>> = Vec::new();
    for (title, draft) in drafts {
        *tried += size(snapshot);
        let is_known = actions.iter().any(|action| action.title == title);
        if is_known || (*tried > MAX_TRIED && !actions.is_empty()) {
            continue;
        }
        let Some(drafted) = draft.drafted(snapshot) else { continue };
        if drafted.holds(view, snapshot, Keeps::Mends(finding)) {
            let (kind, finding) = (ActionKind::Suggestion, Some((snapshot, finding)));
            actions.push(CodeAction { title, kind, finding, edits: Some(drafted.into()) });
        }
    }
    actions
}

/// The refactorings at a range.
fn refactored<'v>(
    view: &View,
    snapshot: &Snapshot,
    file: FileId,
    bytes: &Range<usize>,
    is_lazy: bool,
) -> Vec<CodeAction<'v>> {
    if !snapshot.is_error_free() {
        return Vec::new();
    }
    let action = |candidate: Candidate| {
        let (title, kind) = (candidate.title.clone(), candidate.kind);
        let edits = if is_lazy { None } else { Some(candidate.tried(view, snapshot)?) };
        Some(CodeAction { title, kind, finding: None, edits })
    };
    candidates(view, snapshot, file, bytes).into_iter().filter_map(action).collect()
}

fn candidates(view: &View, snapshot: &Snapshot, file: FileId, bytes: &Range<usize>) -> Vec<Candidate> {
    let text = snapshot.text(file);
    let Some(blocks) = Blocks::of(text.code()) else { return Vec::new() };
    let path = snapshot.path(file);
    let mut out = extract::candidates(path, &blocks, bytes);
    out.extend(inline::candidate(view, snapshot, file, bytes));
    out.extend(negate::candidates(path, &blocks, bytes));
    out.extend(relocate::candidate(snapshot, path, &blocks, bytes));
    out
}

/// The findings that touch a range of a file.
fn found_at<'v>(
    snapshot: &'v Snapshot,
    more: Option<&'v Diagnostics>,
    file: FileId,
    bytes: Range<usize>,
) -> impl Iterator<Item = &'v Diagnostic> {
    let found = snapshot.ide.compilation.diagnostics.iter().chain(more.into_iter().flat_map(Diagnostics::iter));
    let touches = move |label: &Label| {
        let at = label.span.range();
        label.span.file() == file && at.start <= bytes.end && bytes.start <= at.end
    };
    found.filter(move |finding| finding.primary.as_ref().is_some_and(&touches))
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

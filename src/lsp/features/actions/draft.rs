//! Drafts of code actions: edits of one or more files, brought into the canonical layout where the text was, and tried
//! by compiling the program with them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Severity};
use crate::format::format;
use crate::ir;
use crate::ordered::Ordered;
use crate::source::FileId;

use crate::lsp::documents::{Document, OpenDocuments};
use crate::lsp::features::formatting::edits;
use crate::lsp::location::{Edit, Location};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::document_text::Text;
use crate::lsp::view::View;

/// The edits of a code action.
#[derive(Debug, Clone, Default)]
pub(super) struct Draft {
    edits: BTreeMap<PathBuf, Vec<(Range<usize>, String)>>,
    /// New files with their texts.
    pub new_files: BTreeMap<PathBuf, String>,
}

/// The texts after a draft.
pub(super) struct Drafted {
    texts: BTreeMap<PathBuf, (Arc<Text>, String)>,
    pub new_files: BTreeMap<PathBuf, String>,
}

impl Draft {
    pub fn edit(&mut self, path: &Path, at: Range<usize>, text: impl Into<String>) {
        self.edits.entry(path.to_path_buf()).or_default().push((at, text.into()));
    }

    /// The texts with the edits; `None` if edits overlap or change nothing.
    pub fn drafted(mut self, snapshot: &Snapshot) -> Option<Drafted> {
        let mut texts = BTreeMap::new();
        for (path, edits) in &mut self.edits {
            let text = snapshot.text(snapshot.file(path)?);
            edits.order_by_key(|(at, _)| (at.start, at.end));
            let code = text.code();
            let (mut new, mut done) = (String::with_capacity(code.len()), 0);
            for (at, put) in edits {
                new.push_str(code.get(done..at.start)?);
                new.push_str(put);
                done = at.end;
            }
            new.push_str(code.get(done..)?);
            let new = if code.contains("\r\n") { new.replace("\r\n", "\n").replace('\n', "\r\n") } else { new };
            // What was in the canonical layout stays so.
            let was_formatted = format(FileId(0), code).is_ok_and(|before| before == code);
            let new = if was_formatted { format(FileId(0), &new).unwrap_or(new) } else { new };
            if new != code {
                texts.insert(path.clone(), (text, new));
            }
        }
        let is_nothing = texts.is_empty() && self.new_files.is_empty();
        (!is_nothing).then_some(Drafted { texts, new_files: self.new_files })
    }
}

/// What a draft must keep.
#[derive(Clone, Copy)]
pub(super) enum Keeps<'a> {
    /// Mends this finding, and adds no error.
    Mends(&'a Diagnostic),
    /// Adds no finding.
    Findings,
    /// Adds no finding, and the program is the same but for the order of its parts.
    Program,
}

impl Drafted {
    /// The program after the edits.
    fn compiled(&self, view: &View, snapshot: &Snapshot) -> Snapshot {
        let mut open: OpenDocuments = (**view.documents.all()).clone();
        let changed = self.texts.iter().map(|(path, (old, new))| (path, old.replaced(new.clone())));
        let added = self.new_files.iter().map(|(path, new)| (path, Text::new(new.clone())));
        for (path, text) in changed.chain(added) {
            let (uri, text) = (String::new(), Arc::new(text));
            open.insert(path.clone(), Document { uri, version: 0, is_program: true, text, edited: None });
        }
        Snapshot::compile(&snapshot.root, &Arc::new(open), &*view.disk, Some(snapshot))
    }

    /// Whether the program after the edits is as it has to be.
    pub fn holds(&self, view: &View, snapshot: &Snapshot, keeps: Keeps<'_>) -> bool {
        let parses = |(_, (old, new)): (&PathBuf, &(Arc<Text>, String))| {
            let errors = |text: &Text| text.parsed().diagnostics.counts().0;
            errors(&old.replaced(new.as_str())) <= errors(old)
        };
        if !self.texts.iter().all(parses) {
            return false;
        }
        let after = self.compiled(view, snapshot);
        let (old, new) = (&snapshot.ide.compilation, &after.ide.compilation);
        let is_new = |d: &Diagnostic| {
            let same = |other: &&Diagnostic| other.code == d.code && other.message == d.message;
            new.diagnostics.iter().filter(same).count() > old.diagnostics.iter().filter(same).count()
        };
        match keeps {
            Keeps::Mends(finding) => {
                let same = |d: &&Diagnostic| d.code == finding.code && d.message == finding.message;
                let (before, left) = (old.diagnostics.iter().filter(same), new.diagnostics.iter().filter(same));
                // A finding of the value analysis is not among those of the compiler.
                let (before, left) = (before.count(), left.count());
                let is_mended = left < before || before == 0 && left == 0;
                let mut errors = new.diagnostics.iter().filter(|d| d.severity == Severity::Error);
                is_mended && new.diagnostics.counts().0 <= old.diagnostics.counts().0 && !errors.any(is_new)
            }
            Keeps::Findings => !new.diagnostics.iter().any(is_new),
            Keeps::Program => {
                let parts = |program: &ir::Program| {
                    // A part begins with a line that is not indented.
                    let text = ir::text(program);
                    let mut parts: Vec<String> = Vec::new();
                    for line in text.lines() {
                        match parts.last_mut().filter(|_| line.starts_with(' ')) {
                            Some(part) => *part = format!("{part}\n{line}"),
                            None => parts.push(line.to_string()),
                        }
                    }
                    parts.order_by(Ord::cmp);
                    parts
                };
                let same = old.program.as_ref().zip(new.program.as_ref()).is_some_and(|(a, b)| parts(a) == parts(b));
                same && !new.diagnostics.iter().any(is_new)
            }
        }
    }

    /// The edits, one for each group of changed lines.
    pub fn edits(&self) -> Vec<Edit> {
        let mut out = Vec::new();
        for (path, (text, new)) in &self.texts {
            for (bytes, new_text) in edits(text, new, None) {
                let at = Location { path: path.clone(), text: Arc::clone(text), bytes };
                out.push(Edit { at, new_text });
            }
        }
        out
    }
}

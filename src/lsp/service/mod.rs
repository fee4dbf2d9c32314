//! The features without a connection: typed requests with typed answers, for an editor in the same process, such as
//! that of the playground. It compiles when it is asked to; it has no threads.

mod offsets;
mod types;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use types::{Answer, Completion, Edit, Finding, Fix, Request, Signature, Symbol};

use crate::analysis::watched_findings;
use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::lsp::Workspace;
use crate::lsp::documents::{Document, Documents};
use crate::lsp::features::findings::{is_unnecessary, message};
use crate::lsp::features::navigate::Definition;
use crate::lsp::features::{completion, completion_items, formatting, hover, navigate, signature, structure, tokens};
use crate::lsp::location::FileOffset;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::document_text::Text;
use crate::lsp::values::Ranges;
use crate::lsp::view::{ProgramState, View};
use crate::ordered::Ordered;
use crate::source::{FileId, Span, normalize};
use crate::syntax::keywords;
use crate::watch::Unwatched;

use offsets::{byte_of, units_of};

/// The open documents of an editor, and the programs that contain them.
pub struct Service {
    view: View,
}

impl Service {
    /// A service over files; open documents replace those of the same path.
    pub fn new(disk: Arc<dyn Workspace>) -> Service {
        let (documents, programs) = (Documents::default(), std::collections::BTreeMap::new());
        Service { view: View { documents, programs, last_rename: None, disk } }
    }

    /// Answers a request.
    pub fn answer(&mut self, request: Request) -> Answer {
        match request {
            Request::Document { path, text } => {
                let path = normalize(Path::new(&path));
                self.view.documents.open(path.clone(), String::new(), 0, text, "");
                self.compile(&path);
                Answer::Findings { findings: self.findings(&path) }
            }
            Request::Analyze { path } => {
                let path = normalize(Path::new(&path));
                self.analyze(&path);
                Answer::Findings { findings: self.findings(&path) }
            }
            Request::Keywords => {
                let functions = crate::diagnostic::words::SIGNATURES.iter().map(|of| of.name.to_string());
                let functions: BTreeSet<String> = functions.collect();
                Answer::Keywords {
                    keywords: keywords().iter().map(|of| of.word.to_string()).collect(),
                    functions: functions.into_iter().collect(),
                }
            }
            Request::Completion { path, at } => self
                .at(&path, at, |view, text, at| completion::completion(view, at).map(|found| completions(text, found))),
            Request::Hover { path, at } => self.at(&path, at, |view, text, at| {
                let hover::Hover { at, markdown } = hover::hover(view, at, &|_| Vec::new())?;
                let Range { start: from, end: to } = units_of(text.code(), &at.bytes);
                Some(Answer::Hover { from, to, markdown })
            }),
            Request::Signature { path, at } => self.at(&path, at, |view, _, at| {
                let help = signature::signature_help(view, at)?;
                let signature = |of: signature::CallSignature| Signature {
                    name: of.name,
                    parameters: of.parameters,
                    doc: of.doc.to_string(),
                };
                let signatures = help.signatures.into_iter().map(signature).collect();
                Some(Answer::Signatures { signatures, active: help.active, argument: help.argument })
            }),
            Request::Definition { path, at } => self.at(&path, at, |view, _, at| {
                let Definition::Declarations(declared) = navigate::definition(view, at) else { return None };
                let at = declared.into_iter().next()?;
                let Range { start: from, end: to } = units_of(at.text.code(), &at.bytes);
                Some(Answer::Definition { path: at.path.display().to_string(), from, to })
            }),
            Request::Format { path } => {
                let edits = self.document(&path).and_then(|document| {
                    let code = document.text.code();
                    let edits = formatting::formatting(&document.text, None)?.into_iter();
                    Some(edits.map(|(bytes, text)| edit(code, &bytes, text)).collect())
                });
                edits.map_or(Answer::Nothing, |edits| Answer::Edits { edits })
            }
            Request::Symbols { path } => {
                let symbols = self.document(&path).map(|document| {
                    let all = structure::document_symbols(&document.text).into_iter();
                    all.map(|of| symbol(document.text.code(), of)).collect()
                });
                symbols.map_or(Answer::Nothing, |symbols| Answer::Symbols { symbols })
            }
            Request::Tokens { path } => self.tokens(&path),
        }
    }

    /// The names of the items at a position, and the features by which they are ordered: for the fit of their weights.
    #[cfg(feature = "testing")]
    pub fn evidence(&self, path: &str, at: usize) -> Vec<(String, Vec<(String, f32)>)> {
        let Some(document) = self.document(path) else { return Vec::new() };
        let at = FileOffset { path: normalize(Path::new(path)), byte: byte_of(document.text.code(), at) };
        completion::evidence(&self.view, &at)
    }

    fn document(&self, path: &str) -> Option<&Document> {
        self.view.documents.get(&normalize(Path::new(path)))
    }

    /// Answers a request about a position of a document.
    fn at(&self, path: &str, at: usize, answer: impl FnOnce(&View, &Text, &FileOffset) -> Option<Answer>) -> Answer {
        let Some(document) = self.document(path) else { return Answer::Nothing };
        let text = Arc::clone(&document.text);
        let at = FileOffset { path: normalize(Path::new(path)), byte: byte_of(text.code(), at) };
        answer(&self.view, &text, &at).unwrap_or(Answer::Nothing)
    }

    /// Compiles the programs that a change of a file affects.
    fn compile(&mut self, changed: &Path) {
        let depends = |state: &ProgramState| state.current.dependencies.contains(changed);
        let affected = self.view.programs.iter().filter(|(_, state)| depends(state)).map(|(root, _)| root.clone());
        let mut roots: BTreeSet<PathBuf> = affected.collect();
        if self.view.documents.get(changed).is_some_and(|document| document.is_program) {
            roots.insert(changed.to_path_buf());
        }
        for root in roots {
            let before = self.view.programs.remove(&root);
            let old = before.as_ref().map(|state| &*state.current);
            let current = Arc::new(Snapshot::compile(&root, self.view.documents.all(), &*self.view.disk, old));
            let (last_good, ranges) = before.map_or((None, None), |state| (state.last_good, state.ranges));
            let last_good = if current.is_error_free() { Some(Arc::clone(&current)) } else { last_good };
            self.view.programs.insert(root, ProgramState { current, last_good, findings: None, ranges });
        }
    }

    /// Analyses the values of a program, if it has no errors.
    fn analyze(&mut self, root: &Path) {
        let Some(state) = self.view.programs.get_mut(root).filter(|state| state.findings.is_none()) else { return };
        let compilation = &state.current.ide.compilation;
        let Some(program) = &compilation.program else { return };
        let found = watched_findings(program, &compilation.sources, FileId(0), &compilation.diagnostics, &Unwatched);
        if let Some((findings, spaces)) = found {
            state.ranges = Some(Ranges::of(program, &spaces));
            state.findings = Some(findings);
        }
    }

    /// The findings of the programs that contain a document, in the order of their places; each once.
    fn findings(&self, path: &Path) -> Vec<Finding> {
        let mut all: Vec<Finding> = Vec::new();
        for state in self.view.programs_with(path) {
            let snapshot = &*state.current;
            let compiling = snapshot.ide.compilation.diagnostics.iter();
            for found in compiling.chain(state.findings.iter().flat_map(Diagnostics::iter)) {
                let found = finding(snapshot, found);
                if !all.contains(&found) {
                    all.push(found);
                }
            }
        }
        all.order_by(|a, b| (&a.path, a.from).cmp(&(&b.path, b.from)));
        all
    }

    fn tokens(&self, path: &str) -> Answer {
        let Some(document) = self.document(path) else { return Answer::Nothing };
        let (path, code) = (normalize(Path::new(path)), document.text.code());
        let Some(found) = tokens::semantic_tokens(&self.view, &path, &(0..code.len()), false) else {
            return Answer::Nothing;
        };
        let (mut kinds, mut all): (Vec<&'static str>, Vec<[usize; 3]>) = (Vec::new(), Vec::new());
        // Tokens are in order: each text between two of them is counted once.
        let (mut byte, mut units) = (0, 0);
        for token in found {
            let mut advance = |to: usize| {
                units += code.get(byte..to).map_or(0, |text| text.chars().map(char::len_utf16).sum());
                byte = to;
                units
            };
            let (from, to) = (advance(token.bytes.start), advance(token.bytes.end));
            let name = token.kind.color();
            let kind = kinds.iter().position(|known| *known == name).unwrap_or_else(|| {
                kinds.push(name);
                kinds.len() - 1
            });
            all.push([from, to, kind]);
        }
        Answer::Tokens { kinds: kinds.into_iter().map(str::to_string).collect(), tokens: all }
    }
}

fn edit(code: &str, bytes: &Range<usize>, text: String) -> Edit {
    let Range { start: from, end: to } = units_of(code, bytes);
    Edit { from, to, text }
}

fn completions(text: &Text, found: completion::Completions) -> Answer {
    let Range { start: from, end: to } = units_of(text.code(), &found.replaces);
    let item = |item: completion_items::CompletionItem| Completion {
        label: item.label,
        kind: item.kind.name().to_string(),
        detail: item.detail,
        rank: item.rank,
        snippet: match item.insert {
            completion_items::Insert::Snippet(snippet) => Some(snippet),
            completion_items::Insert::Label => None,
        },
    };
    let items = found.items.into_iter().filter(|item| !item.is_import()).map(item).collect();
    Answer::Completion { from, to, items, likely: found.is_likely }
}

fn symbol(code: &str, of: structure::Symbol) -> Symbol {
    let (whole, name_at) = (units_of(code, &of.whole), units_of(code, &of.name_at));
    Symbol {
        name: of.name,
        detail: of.detail,
        from: whole.start,
        to: whole.end,
        name_from: name_at.start,
        name_to: name_at.end,
        children: of.children.into_iter().map(|child| symbol(code, child)).collect(),
    }
}

/// A finding with offsets into the text of its file.
fn finding(snapshot: &Snapshot, found: &Diagnostic) -> Finding {
    let at = |span: Span| units_of(snapshot.text(span.file()).code(), &span.range());
    let primary = found.primary.as_ref().map(|label| label.span);
    let Range { start: from, end: to } = primary.map_or(0..0, at);
    let path = primary.map_or(snapshot.root.as_path(), |span| snapshot.path(span.file()));
    // A fix of another file is not for the editor of this one.
    let fix = found
        .fix
        .as_ref()
        .filter(|fix| fix.edits.iter().all(|(span, _)| primary.is_some_and(|primary| primary.file() == span.file())));
    let fix = fix.map(|fix| Fix {
        title: fix.title.clone(),
        edits: fix
            .edits
            .iter()
            .map(|(span, text)| {
                let Range { start: from, end: to } = at(*span);
                Edit { from, to, text: text.clone() }
            })
            .collect(),
    });
    Finding {
        path: path.display().to_string(),
        from,
        to,
        severity: if found.severity == Severity::Error { "error" } else { "warning" }.to_string(),
        code: found.code.to_string(),
        message: message(found),
        is_unnecessary: is_unnecessary(found.code),
        fix,
    }
}

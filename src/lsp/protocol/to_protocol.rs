//! Converts results of features to the protocol: paths to URIs, byte offsets to positions, kinds to the protocol's
//! kinds.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

use gen_lsp_types as types;
use gen_lsp_types::Uri;
use serde_json::{Value, json};

use super::client::Client;
use super::findings;
use super::kinds;
use super::positions::{START, position, range};
use super::uri::uri_of;
use crate::lsp::documents::Documents;
use crate::lsp::features::actions::create;
use crate::lsp::features::actions::{ActionKind, CodeAction, Edits};
use crate::lsp::features::completion::Completions;
use crate::lsp::features::completion_items::{CompletionItem, CompletionKind, Insert};
use crate::lsp::features::hierarchy::CallItem;
use crate::lsp::features::hints::{HintKind, InlayHint};
use crate::lsp::features::hover::Hover;
use crate::lsp::features::navigate::{Definition, Highlight, Link, WorkspaceSymbol};
use crate::lsp::features::rename::Renamable;
use crate::lsp::features::signature::{CallSignature, SignatureHelp};
use crate::lsp::features::structure::{Fold, FoldKind, Symbol};
use crate::lsp::location::{Edit, Location};
use crate::lsp::text::document_text::Text;

/// Converts results, for the open documents and the capabilities of a client.
#[derive(Clone, Copy)]
pub(super) struct ToProtocol<'s> {
    pub documents: &'s Documents,
    pub client: &'s Client,
}

impl ToProtocol<'_> {
    /// The URI of a file: that of the editor if it is open.
    pub fn uri(self, path: &Path) -> Uri {
        self.documents.get(path).map_or_else(|| uri_of(path), |document| Uri(document.uri.clone()))
    }

    pub fn range(self, text: &Text, bytes: &Range<usize>) -> types::Range {
        range(text, bytes, self.client.encoding)
    }

    fn range_of(self, at: &Location) -> types::Range {
        self.range(&at.text, &at.bytes)
    }

    pub fn location(self, at: &Location) -> types::Location {
        types::Location { uri: self.uri(&at.path), range: self.range_of(at) }
    }

    pub fn definition(self, found: Definition) -> Option<types::DefinitionResponse> {
        let locations = match found {
            Definition::File(path) => {
                vec![types::Location { uri: uri_of(&path), range: types::Range { start: START, end: START } }]
            }
            Definition::Declarations(declared) => declared.iter().map(|at| self.location(at)).collect(),
        };
        (!locations.is_empty()).then(|| types::Definition::from(locations).into())
    }

    pub fn highlight(self, highlight: &Highlight) -> types::DocumentHighlight {
        let kind = kinds::of_highlight(highlight.role);
        types::DocumentHighlight { range: self.range_of(&highlight.at), kind: Some(kind) }
    }

    pub fn workspace_symbol(self, symbol: WorkspaceSymbol) -> types::WorkspaceSymbol {
        let WorkspaceSymbol { name, kind, at, container: container_name } = symbol;
        let base = types::BaseSymbolInformation { name, kind: kinds::of_name(kind), tags: None, container_name };
        types::WorkspaceSymbol { location: self.location(&at).into(), data: None, base_symbol_information: base }
    }

    pub fn link(self, text: &Text, link: &Link) -> types::DocumentLink {
        let (range, target) = (self.range(text, &link.bytes), Some(uri_of(&link.target)));
        types::DocumentLink { range, target, tooltip: None, data: None }
    }

    pub fn hover(self, hover: Hover) -> types::Hover {
        let contents = types::MarkupContent { kind: types::MarkupKind::Markdown, value: hover.markdown };
        types::Hover { contents: contents.into(), range: Some(self.range_of(&hover.at)) }
    }

    pub fn renamable(self, renamable: Renamable) -> types::PrepareRenameResult {
        let range = self.range_of(&renamable.at);
        types::PrepareRenamePlaceholder { range, placeholder: renamable.name }.into()
    }

    pub fn text_edits(self, text: &Text, edits: Vec<(Range<usize>, String)>) -> Vec<types::TextEdit> {
        let edit = |(bytes, new_text)| types::TextEdit { range: self.range(text, &bytes), new_text };
        edits.into_iter().map(edit).collect()
    }

    pub fn workspace_edit(self, edits: Vec<Edit>) -> types::WorkspaceEdit {
        let mut changes: HashMap<Uri, Vec<types::TextEdit>> = HashMap::new();
        for Edit { at, new_text } in edits {
            let edit = types::TextEdit { range: self.range_of(&at), new_text };
            changes.entry(self.uri(&at.path)).or_default().push(edit);
        }
        types::WorkspaceEdit { changes: Some(changes), ..types::WorkspaceEdit::default() }
    }

    /// The edit of a code action: changes of documents, and new files before them.
    pub fn action_edit(self, edits: Edits) -> types::WorkspaceEdit {
        let Edits { edits, new_files } = edits;
        let edit = self.workspace_edit(edits);
        if new_files.is_empty() {
            return edit;
        }
        let in_document = |uri: Uri, version: Option<i32>, edits: Vec<types::TextEdit>| types::TextDocumentEdit {
            text_document: types::OptionalVersionedTextDocumentIdentifier {
                version,
                text_document_identifier: types::TextDocumentIdentifier { uri },
            },
            edits: edits.into_iter().map(Into::into).collect(),
        };
        let mut changes: Vec<types::DocumentChange> = Vec::new();
        for (path, text) in new_files {
            let uri = uri_of(&path);
            changes.push(types::CreateFile { uri: uri.clone(), options: None, annotation_id: None }.into());
            let all = types::TextEdit { range: types::Range { start: START, end: START }, new_text: text };
            changes.push(in_document(uri, None, vec![all]).into());
        }
        let mut edited: Vec<_> = edit.changes.unwrap_or_default().into_iter().collect();
        edited.sort_by(|(a, _), (b, _)| a.0.cmp(&b.0));
        for (uri, edits) in edited {
            let version = self.documents.get(&super::uri::path_of(&uri)).map(|document| document.version);
            changes.push(in_document(uri, version, edits).into());
        }
        types::WorkspaceEdit { document_changes: Some(changes), ..types::WorkspaceEdit::default() }
    }

    /// A code action; `place` finds it again if its edits are asked for later.
    pub fn code_action(self, action: CodeAction<'_>, place: impl FnOnce() -> Value) -> types::CodeAction {
        let shown = |(snapshot, finding)| {
            let mut shown = findings::to_protocol_diagnostic(finding, snapshot, self.client.encoding);
            findings::describe(&mut shown, self.client);
            vec![shown]
        };
        types::CodeAction {
            title: action.title,
            kind: Some(kinds::of_action(action.kind)),
            diagnostics: action.finding.map(shown),
            is_preferred: (action.kind == ActionKind::Fix).then_some(true),
            data: action.edits.is_none().then(place),
            edit: action.edits.map(|edits| self.action_edit(edits)),
            ..types::CodeAction::default()
        }
    }

    pub fn completion(self, text: &Text, found: Completions) -> types::CompletionResponse {
        let range = self.range(text, &found.replaces);
        let item = |CompletionItem { rank, label, kind, detail, insert, import }| {
            let snippet = match insert {
                Insert::Snippet(snippet) if self.client.has_snippets => Some(snippet),
                Insert::Snippet(_) | Insert::Label => None,
            };
            types::CompletionItem {
                sort_text: Some(format!("{rank:03}{label}")),
                additional_text_edits: import.map(|path| {
                    let (at, new_text) = create::import(text.code(), &path);
                    vec![types::TextEdit { range: self.range(text, &at), new_text }]
                }),
                command: (self.client.suggests_again && opens_list(&snippet)).then(suggest_again),
                kind: Some(kinds::of_completion(kind)),
                detail: (!detail.is_empty()).then_some(detail),
                insert_text_format: snippet.is_some().then_some(types::InsertTextFormat::Snippet),
                text_edit: Some(types::TextEdit { range, new_text: snippet.unwrap_or_else(|| label.clone()) }.into()),
                label,
                ..types::CompletionItem::default()
            }
        };
        // Without placeholders a snippet is no text to insert.
        let is_usable = |item: &CompletionItem| self.client.has_snippets || item.kind != CompletionKind::Snippet;
        found.items.into_iter().filter(is_usable).map(item).collect::<Vec<_>>().into()
    }

    #[allow(deprecated, reason = "a field must be named to be left out")]
    pub fn symbol(self, text: &Text, symbol: Symbol) -> types::DocumentSymbol {
        let children: Vec<_> = symbol.children.into_iter().map(|child| self.symbol(text, child)).collect();
        types::DocumentSymbol {
            name: symbol.name,
            detail: symbol.detail,
            kind: kinds::of_symbol(symbol.kind),
            range: self.range(text, &symbol.whole),
            selection_range: self.range(text, &symbol.name_at),
            children: (!children.is_empty()).then_some(children),
            tags: None,
            deprecated: None,
        }
    }

    /// Converts the ranges around a position, given outermost first.
    pub fn selection(self, text: &Text, at: types::Position, around: &[Range<usize>]) -> types::SelectionRange {
        let outer = around.iter().fold(None, |outer: Option<types::SelectionRange>, bytes| {
            Some(types::SelectionRange { range: self.range(text, bytes), parent: outer.map(Box::new) })
        });
        outer.unwrap_or(types::SelectionRange { range: types::Range { start: at, end: at }, parent: None })
    }

    pub fn hint(self, text: &Text, hint: InlayHint) -> types::InlayHint {
        let is_dimension = hint.kind == HintKind::Dimension;
        types::InlayHint {
            position: position(text, hint.byte, self.client.encoding),
            kind: is_dimension.then_some(types::InlayHintKind::Type),
            padding_left: Some(!is_dimension),
            label: hint.label.into(),
            text_edits: None,
            tooltip: None,
            padding_right: None,
            data: None,
        }
    }

    pub fn call_item(self, item: &CallItem) -> types::CallHierarchyItem {
        let name = &item.name;
        types::CallHierarchyItem {
            name: name.mode.clone(),
            kind: types::SymbolKind::Method,
            tags: None,
            detail: Some(name.entity.clone()),
            uri: self.uri(&item.at.path),
            range: self.range_of(&item.at),
            selection_range: self.range(&item.at.text, &item.name_at),
            data: Some(json!({ "root": name.root, "entity": name.entity, "mode": name.mode })),
        }
    }

    /// The ranges of edges.
    pub fn ranges(self, edges: &[Location]) -> Vec<types::Range> {
        edges.iter().map(|at| self.range_of(at)).collect()
    }
}

/// Whether a text with placeholders leaves the cursor where names are offered.
fn opens_list(snippet: &Option<String>) -> bool {
    snippet.as_ref().is_some_and(|text| text.ends_with("($1)") || text.ends_with(".$0") || text.ends_with("= $1"))
}

/// The command by which the editor offers the next names.
fn suggest_again() -> types::Command {
    let command = super::client::SUGGEST.to_string();
    types::Command { title: "suggest".into(), tooltip: None, command, arguments: None }
}

pub(super) fn fold(fold: &Fold) -> types::FoldingRange {
    let kind = match fold.kind {
        FoldKind::Block => None,
        FoldKind::Comments => Some(types::FoldingRangeKind::Comment),
        FoldKind::Imports => Some(types::FoldingRangeKind::Imports),
    };
    types::FoldingRange {
        start_line: fold.first_line,
        end_line: fold.last_line,
        kind,
        ..types::FoldingRange::default()
    }
}

pub(super) fn signature_help(help: SignatureHelp) -> types::SignatureHelp {
    types::SignatureHelp {
        signatures: help.signatures.into_iter().map(signature).collect(),
        active_signature: Some(help.active as u32),
        active_parameter: Some((help.argument as u32).into()),
    }
}

fn signature(CallSignature { name, parameters, doc }: CallSignature) -> types::SignatureInformation {
    let mut label = format!("{name}(");
    let mut infos = Vec::new();
    for (index, parameter) in parameters.iter().enumerate() {
        if index > 0 {
            label.push_str(", ");
        }
        // Offsets in a label count UTF-16 code units.
        let start = label.encode_utf16().count() as u32;
        label.push_str(parameter);
        let end = label.encode_utf16().count() as u32;
        infos.push(types::ParameterInformation { label: (start, end).into(), documentation: None });
    }
    label.push(')');
    types::SignatureInformation {
        label,
        documentation: (!doc.is_empty()).then(|| doc.into()),
        parameters: Some(infos),
        active_parameter: None,
    }
}

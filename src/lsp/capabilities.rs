//! What the server offers, and what it needs to know of the editor.

use gen_lsp_types as types;
use gen_lsp_types::{PositionEncodingKind, ServerCapabilities};
use serde_json::{Value, json};

use super::text::Encoding;
use super::tokens;

/// What matters of the editor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Client {
    /// What columns count.
    pub encoding: Encoding,
    /// Whether it tells of changed files if it is asked to.
    pub watches_files: bool,
    /// Whether it asks for hints again if it is told to.
    pub refreshes_hints: bool,
    /// Whether completions may have places to fill in.
    pub has_snippets: bool,
    /// Whether it colours words by a grammar of its own, and wants to know of names alone.
    pub has_grammar: bool,
}

impl Client {
    /// Reads what the editor says of itself in `initialize`. Without the types of the protocol, in which one field that a
    /// client leaves out would make all others unreadable.
    pub fn of(params: &Value) -> Self {
        let said = &params["capabilities"];
        let is = |path: &str| said.pointer(path).and_then(Value::as_bool).unwrap_or(false);
        let encodings = said.pointer("/general/positionEncodings").and_then(Value::as_array);
        let names = encodings.into_iter().flatten().filter_map(Value::as_str);
        let known = names.filter_map(|name| match name {
            "utf-8" => Some(Encoding::Utf8),
            "utf-16" => Some(Encoding::Utf16),
            "utf-32" => Some(Encoding::Utf32),
            _ => None,
        });
        Client {
            encoding: known.into_iter().next().unwrap_or_default(),
            watches_files: is("/workspace/didChangeWatchedFiles/dynamicRegistration"),
            refreshes_hints: is("/workspace/inlayHint/refreshSupport"),
            has_grammar: is("/textDocument/semanticTokens/augmentsSyntaxTokens"),
            has_snippets: is("/textDocument/completion/completionItem/snippetSupport"),
        }
    }
}

/// What the server offers.
pub(super) fn capabilities(client: &Client) -> ServerCapabilities {
    let words = |list: &[&str]| Some(list.iter().map(|w| (*w).to_string()).collect::<Vec<String>>());
    ServerCapabilities {
        position_encoding: Some(match client.encoding {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
            Encoding::Utf32 => PositionEncodingKind::UTF32,
        }),
        text_document_sync: Some(
            types::TextDocumentSyncOptions {
                open_close: Some(true),
                change: Some(types::TextDocumentSyncKind::Incremental),
                ..Default::default()
            }
            .into(),
        ),
        document_formatting_provider: Some(true.into()),
        document_range_formatting_provider: Some(true.into()),
        document_symbol_provider: Some(true.into()),
        folding_range_provider: Some(true.into()),
        selection_range_provider: Some(true.into()),
        code_action_provider: Some(
            types::CodeActionOptions {
                code_action_kinds: Some(vec![types::CodeActionKind::QuickFix, types::CodeActionKind::SourceFixAll]),
                ..Default::default()
            }
            .into(),
        ),
        definition_provider: Some(true.into()),
        references_provider: Some(true.into()),
        document_highlight_provider: Some(true.into()),
        rename_provider: Some(types::RenameOptions { prepare_provider: Some(true), ..Default::default() }.into()),
        hover_provider: Some(true.into()),
        workspace_symbol_provider: Some(true.into()),
        document_link_provider: Some(types::DocumentLinkOptions::default()),
        completion_provider: Some(types::CompletionOptions {
            trigger_characters: words(&[".", ">", "(", ",", ":", " ", "\"", "/"]),
            ..Default::default()
        }),
        signature_help_provider: Some(types::SignatureHelpOptions {
            trigger_characters: words(&["(", ","]),
            ..Default::default()
        }),
        semantic_tokens_provider: Some(
            types::SemanticTokensOptions {
                legend: tokens::legend(),
                range: Some(true.into()),
                full: Some(types::SemanticTokensFullDelta { delta: Some(true) }.into()),
                ..Default::default()
            }
            .into(),
        ),
        inlay_hint_provider: Some(true.into()),
        code_lens_provider: Some(types::CodeLensOptions::default()),
        call_hierarchy_provider: Some(true.into()),
        workspace: Some(types::WorkspaceOptions {
            workspace_folders: Some(types::WorkspaceFoldersServerCapabilities {
                supported: Some(true),
                change_notifications: Some(true.into()),
            }),
            ..Default::default()
        }),
        ..Default::default()
    }
}

/// Asks the editor to tell of changes of programs, levels and legends.
pub(super) fn watchers() -> Value {
    let patterns = ["**/*.hyped", "**/*.txt", "**/*.json", "**/*.tmx", "**/*.tmj", "**/*.tsx", "**/*.ldtk"];
    let watchers: Vec<Value> = patterns.iter().map(|pattern| json!({ "globPattern": pattern })).collect();
    json!({ "registrations": [{
        "id": "files",
        "method": "workspace/didChangeWatchedFiles",
        "registerOptions": { "watchers": watchers },
    }] })
}

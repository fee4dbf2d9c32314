//! What the editor says of itself when a session begins, as far as answers depend on it.

use serde_json::Value;

use crate::lsp::text::document_text::Encoding;

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
    /// Reads what the editor says of itself in `initialize`. Without the types of the protocol, in which one field that
    /// a client leaves out would make all others unreadable.
    pub fn from_params(params: &Value) -> Self {
        let capabilities = &params["capabilities"];
        let flag = |path: &str| capabilities.pointer(path).and_then(Value::as_bool).unwrap_or(false);
        let encodings = capabilities.pointer("/general/positionEncodings").and_then(Value::as_array);
        let names = encodings.into_iter().flatten().filter_map(Value::as_str);
        let supported = names.filter_map(|name| match name {
            "utf-8" => Some(Encoding::Utf8),
            "utf-16" => Some(Encoding::Utf16),
            "utf-32" => Some(Encoding::Utf32),
            _ => None,
        });
        Client {
            encoding: supported.into_iter().next().unwrap_or_default(),
            watches_files: flag("/workspace/didChangeWatchedFiles/dynamicRegistration"),
            refreshes_hints: flag("/workspace/inlayHint/refreshSupport"),
            has_grammar: flag("/textDocument/semanticTokens/augmentsSyntaxTokens"),
            has_snippets: flag("/textDocument/completion/completionItem/snippetSupport"),
        }
    }
}

//! The capabilities of the client that affect responses, from its `initialize` request.

use serde_json::Value;

use crate::lsp::text::document_text::Encoding;

/// The command of editors that opens the list of completion items.
pub(super) const SUGGEST: &str = "editor.action.triggerSuggest";

/// The relevant capabilities of the client.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Client {
    /// The unit of columns: the first supported one in the client's order of preference.
    pub encoding: Encoding,
    /// Whether it can be registered to watch files.
    pub watches_files: bool,
    /// Whether it supports `workspace/inlayHint/refresh`.
    pub refreshes_hints: bool,
    /// Whether it supports `workspace/codeLens/refresh`.
    pub refreshes_lenses: bool,
    /// Whether it wants live verdicts.
    pub wants_verdicts: bool,
    /// Whether it asks for the edits of a code action when that is chosen.
    pub resolves_actions: bool,
    /// Whether it creates files that an edit names.
    pub creates_files: bool,
    /// Whether it runs [`SUGGEST`] after a completion item.
    pub suggests_again: bool,
    /// Whether it shows the findings of programs of the workspace that are not open.
    pub reports_closed: bool,
    /// Whether it supports snippets in completion items.
    pub has_snippets: bool,
    /// Whether it shows the progress of work, and creates tokens for it.
    pub shows_progress: bool,
    /// Whether it has commands of its own with the names of the server's, by its option `ownCommands`.
    pub has_commands: bool,
    /// Whether it highlights syntax by its own grammar, so that semantic tokens contain only names.
    pub has_grammar: bool,
}

impl Client {
    /// Reads the parameters of `initialize`. Uses plain JSON: with the types of the protocol, one missing field would
    /// make deserialization fail as a whole.
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
            refreshes_lenses: flag("/workspace/codeLens/refreshSupport"),
            wants_verdicts: wants_verdicts(&params["initializationOptions"]).unwrap_or(true),
            shows_progress: flag("/window/workDoneProgress"),
            has_commands: params
                .pointer("/initializationOptions/ownCommands")
                .and_then(Value::as_bool)
                .unwrap_or(false),
            has_grammar: flag("/textDocument/semanticTokens/augmentsSyntaxTokens"),
            resolves_actions: capabilities
                .pointer("/textDocument/codeAction/resolveSupport/properties")
                .and_then(Value::as_array)
                .is_some_and(|properties| properties.iter().any(|p| p == "edit")),
            creates_files: capabilities
                .pointer("/workspace/workspaceEdit/resourceOperations")
                .and_then(Value::as_array)
                .is_some_and(|operations| operations.iter().any(|o| o == "create")),
            suggests_again: capabilities
                .pointer("/experimental/commands/commands")
                .and_then(Value::as_array)
                .is_some_and(|commands| commands.iter().any(|command| command == SUGGEST)),
            reports_closed: params["initializationOptions"]["workspaceDiagnostics"] == true,
            has_snippets: flag("/textDocument/completion/completionItem/snippetSupport"),
        }
    }
}

/// The setting `verdicts`, if it is given: in the options of `initialize`, or in the section `hypedc` of settings.
pub(super) fn wants_verdicts(settings: &Value) -> Option<bool> {
    settings.get("hypedc").unwrap_or(settings).get("verdicts")?.as_bool()
}

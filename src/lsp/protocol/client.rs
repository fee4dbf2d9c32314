//! The capabilities of the client that affect responses, from its `initialize` request.

use serde_json::Value;

use crate::lsp::text::document_text::Encoding;

/// The command of editors that opens the list of completion items.
pub(super) const SUGGEST: &str = "editor.action.triggerSuggest";

/// The command of an editor that shows what was found of a tile, with the way there: its arguments are those of
/// `hypedc/wayTo`.
pub(super) const TILE: &str = "hypedc.tile";
/// In the address of an explanation, what stands for the code.
const CODE: &str = "{code}";

/// The relevant capabilities of the client.
#[derive(Debug, Clone, Default)]
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
    /// Whether it runs [`TILE`] from the text of a hover.
    pub asks_about_tiles: bool,
    /// The address of the page of a code, with `{code}` in place of it.
    pub explanation: Option<String>,
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
        let commands = capabilities.pointer("/experimental/commands/commands").and_then(Value::as_array);
        let runs = |command: &str| commands.is_some_and(|commands| commands.iter().any(|known| known == command));
        let explanation = params["initializationOptions"]["explainUri"].as_str();
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
            suggests_again: runs(SUGGEST),
            asks_about_tiles: runs(TILE),
            explanation: explanation.filter(|address| address.contains(CODE)).map(str::to_string),
            reports_closed: params["initializationOptions"]["workspaceDiagnostics"] == true,
            has_snippets: flag("/textDocument/completion/completionItem/snippetSupport"),
        }
    }
}

impl Client {
    /// The address of the page that explains a code; none if the client has no such pages.
    pub fn explanation(&self, code: &str) -> Option<String> {
        Some(self.explanation.as_ref()?.replace(CODE, code))
    }
}

/// The setting `verdicts`, if it is given: in the options of `initialize`, or in the section `hypedc` of settings.
pub(super) fn wants_verdicts(settings: &Value) -> Option<bool> {
    settings.get("hypedc").unwrap_or(settings).get("verdicts")?.as_bool()
}

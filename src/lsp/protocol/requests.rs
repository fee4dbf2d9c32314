//! The table of requests: what each needs before it can be answered, and the function that answers it.

use gen_lsp_types as types;
use lsp_server::Request;

use super::handlers::{self, Answer};
use super::server::Server;
use super::tokens;
use super::uri::path_of;

/// What a request needs before it is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Needs {
    /// The text alone.
    Text,
    /// The programs that are open.
    Open,
    /// All programs of the workspace.
    All,
    /// That the worker has nothing left to do.
    Idle,
}

/// Requests as rows: the method, what it needs, its type, and the function that answers it.
macro_rules! requests {
    ($($method:literal $needs:ident $request:ident $file:ident::$answer:ident,)*) => {
        /// What a request needs.
        pub(super) fn needs(method: &str) -> Needs {
            match method {
                $($method => Needs::$needs,)*
                "hypedc/idle" => Needs::Idle,
                _ => Needs::Text,
            }
        }

        impl Server {
            /// Answers a request.
            pub(super) fn dispatch(&mut self, request: Request) {
                match request.method.as_str() {
                    $($method => self.handle::<types::$request>(request, |server, params| {
                        $file::$answer(server, params)
                    }),)*
                    // For scripts and tests: answered when all findings were sent.
                    "hypedc/idle" => self.respond_null(request),
                    "hypedc/text" => self.handle::<TextRequest>(request, |server, params| text(server, params)),
                    _ => self.respond_unknown_method(request),
                }
            }
        }
    };
}

requests! {
    "callHierarchy/incomingCalls"               Open CallHierarchyIncomingCallsRequest handlers::incoming_calls,
    "callHierarchy/outgoingCalls"               Open CallHierarchyOutgoingCallsRequest handlers::outgoing_calls,
    "textDocument/codeAction"                   Open CodeActionRequest                 handlers::code_actions,
    "textDocument/codeLens"                     Open CodeLensRequest                   handlers::code_lenses,
    "textDocument/completion"                   Open CompletionRequest                 handlers::completion,
    "textDocument/definition"                   Open DefinitionRequest                 handlers::definition,
    "textDocument/documentHighlight"            Open DocumentHighlightRequest          handlers::highlights,
    "textDocument/documentLink"                 Open DocumentLinkRequest               handlers::document_links,
    "textDocument/documentSymbol"               Text DocumentSymbolRequest             handlers::document_symbols,
    "textDocument/foldingRange"                 Text FoldingRangeRequest               handlers::folding_ranges,
    "textDocument/formatting"                   Text DocumentFormattingRequest         handlers::formatting,
    "textDocument/hover"                        Open HoverRequest                      handlers::hover,
    "textDocument/inlayHint"                    Open InlayHintRequest                  handlers::inlay_hints,
    "textDocument/prepareCallHierarchy"         Open CallHierarchyPrepareRequest       handlers::prepare_calls,
    "textDocument/prepareRename"                Open PrepareRenameRequest              handlers::prepare_rename,
    "textDocument/rangeFormatting"              Text DocumentRangeFormattingRequest    handlers::range_formatting,
    "textDocument/references"                   All  ReferencesRequest                 handlers::references,
    "textDocument/rename"                       All  RenameRequest                     handlers::rename,
    "textDocument/selectionRange"               Text SelectionRangeRequest             handlers::selection_ranges,
    "textDocument/semanticTokens/full"          Open SemanticTokensRequest             tokens::all_tokens,
    "textDocument/semanticTokens/full/delta"    Open SemanticTokensDeltaRequest        tokens::changed_tokens,
    "textDocument/semanticTokens/range"         Open SemanticTokensRangeRequest        tokens::tokens_in_range,
    "textDocument/signatureHelp"                Open SignatureHelpRequest              handlers::signature_help,
    "workspace/symbol"                          All  WorkspaceSymbolRequest            handlers::workspace_symbols,
}

/// For scripts and tests: the text of an open document, as the server has it.
fn text(server: &Server, params: types::DocumentSymbolParams) -> Answer<TextRequest> {
    let document = server.view.documents.get(&path_of(&params.text_document.uri));
    Ok(document.map(|document| document.text.whole().to_string()))
}

/// The text of an open document, as the server has it.
enum TextRequest {}

impl types::Request for TextRequest {
    const METHOD: types::LspRequestMethod<'static> = types::LspRequestMethod::new("hypedc/text");
    const MESSAGE_DIRECTION: types::MessageDirection = types::MessageDirection::ClientToServer;
    type Params = types::DocumentSymbolParams;
    type Result = Option<String>;
}

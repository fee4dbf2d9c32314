//! The table of requests: the precondition and the handler of each method.

use gen_lsp_types as types;
use lsp_server::{ErrorCode, Request, Response};

use super::context::{Context, Failure, response};
use super::edit_handlers;
use super::explain::{ExplainRequest, explain};
use super::handlers::{self, Answer};
use super::play::Plays;
use super::runnable::{TestsRequest, tests};
use super::tokens;
use super::uri::path_of;

/// The precondition of a request: the request waits until it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Needs {
    /// Only the text of the document: always holds.
    Text,
    /// All open programs are compiled.
    Open,
    /// All programs of the workspace are compiled.
    All,
    /// The worker is idle: all findings are published.
    Idle,
    /// The questions of all open programs are asked: all verdicts are published.
    Asked,
}

/// Defines the table. A row has the method, its precondition, its type, and its handler.
macro_rules! requests {
    ($($method:literal $needs:ident $request:ident $file:ident::$answer:ident,)*) => {
        /// The precondition of a method.
        pub(super) fn needs(method: &str) -> Needs {
            match method {
                $($method => Needs::$needs,)*
                "hypedc/idle" => Needs::Idle,
                "hypedc/asked" => Needs::Asked,
                "hypedc/levels" | "hypedc/chooseLevel" | "hypedc/paint" | "hypedc/wayTo" => Needs::Open,
                "hypedc/tests" => Needs::All,
                _ => Needs::Text,
            }
        }

        /// Calls the handler of a request; returns its response.
        pub(super) fn dispatch(context: &mut Context, request: Request) -> Response {
            match request.method.as_str() {
                $($method => context.handle::<types::$request>(request, |context, params| {
                    $file::$answer(context, params)
                }),)*
                // For scripts and tests: the response follows the last findings.
                "hypedc/idle" | "hypedc/asked" => response(request.id, Ok(())),
                "hypedc/page" => response(request.id, Ok(Plays::page())),
                "hypedc/tests" => context.handle::<TestsRequest>(request, |context, params| tests(context, params)),
                "hypedc/explain" => context.handle::<ExplainRequest>(request, |context, params| explain(context, params)),
                "hypedc/text" => context.handle::<TextRequest>(request, |context, params| text(context, params)),
                method => {
                    let failure = Failure::new(ErrorCode::MethodNotFound, format!("no method `{method}`"));
                    response::<()>(request.id, Err(failure))
                }
            }
        }
    };
}

requests! {
    "callHierarchy/incomingCalls"               Open CallHierarchyIncomingCallsRequest handlers::incoming_calls,
    "callHierarchy/outgoingCalls"               Open CallHierarchyOutgoingCallsRequest handlers::outgoing_calls,
    "codeAction/resolve"                        Open CodeActionResolveRequest          handlers::resolve_action,
    "textDocument/codeAction"                   Open CodeActionRequest                 handlers::code_actions,
    "textDocument/codeLens"                     Open CodeLensRequest                   handlers::code_lenses,
    "textDocument/completion"                   Open CompletionRequest                 handlers::completion,
    "textDocument/definition"                   Open DefinitionRequest                 handlers::definition,
    "textDocument/documentHighlight"            Open DocumentHighlightRequest          handlers::highlights,
    "textDocument/documentLink"                 Open DocumentLinkRequest               handlers::document_links,
    "textDocument/documentSymbol"               Text DocumentSymbolRequest             handlers::document_symbols,
    "textDocument/foldingRange"                 Text FoldingRangeRequest               handlers::folding_ranges,
    "textDocument/formatting"                   Text DocumentFormattingRequest         handlers::formatting,
    "textDocument/onTypeFormatting"             Text DocumentOnTypeFormattingRequest   edit_handlers::on_type_formatting,
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
    "workspace/willRenameFiles"                All  WillRenameFilesRequest            edit_handlers::will_rename_files,
    "workspace/symbol"                          All  WorkspaceSymbolRequest            handlers::workspace_symbols,
}

/// For scripts and tests: returns the server's text of an open document.
fn text(context: &Context, params: types::DocumentSymbolParams) -> Answer<TextRequest> {
    let document = context.view.documents.get(&path_of(&params.text_document.uri));
    Ok(document.map(|document| document.text.whole().to_string()))
}

/// `hypedc/text`: the server's text of an open document.
enum TextRequest {}

impl types::Request for TextRequest {
    const METHOD: types::LspRequestMethod<'static> = types::LspRequestMethod::new("hypedc/text");
    const MESSAGE_DIRECTION: types::MessageDirection = types::MessageDirection::ClientToServer;
    type Params = types::DocumentSymbolParams;
    type Result = Option<String>;
}

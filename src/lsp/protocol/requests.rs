//! The table of requests: what each needs before it can be answered, and which feature answers it.

use gen_lsp_types as types;
use lsp_server::Request;

use crate::lsp::text::uri::path_of;
use crate::lsp::view::{Failure, View};

use super::server::Server;

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

/// Requests as rows: the method, what it needs, its type, and the function of the server or of its view that answers it.
macro_rules! requests {
    ($($method:literal $needs:ident $request:ident $of:ident::$feature:ident,)*) => {
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
                    $($method => self.on::<types::$request>(request, |server, params| {
                        $of::of(server).$feature(params)
                    }),)*
                    // For scripts and tests: answered when all findings were sent.
                    "hypedc/idle" => self.nothing(request),
                    // For scripts and tests: the text as the server has it.
                    "hypedc/text" => self.on::<TextRequest>(request, Self::text),
                    _ => self.unknown(request),
                }
            }
        }
    };
}

requests! {
    "callHierarchy/incomingCalls"               Open CallHierarchyIncomingCallsRequest View::incoming_calls,
    "callHierarchy/outgoingCalls"               Open CallHierarchyOutgoingCallsRequest View::outgoing_calls,
    "textDocument/codeAction"                   Open CodeActionRequest                 View::code_actions,
    "textDocument/codeLens"                     Open CodeLensRequest                   View::code_lenses,
    "textDocument/completion"                   Open CompletionRequest                 View::completion,
    "textDocument/definition"                   Open DefinitionRequest                 View::definition,
    "textDocument/documentHighlight"            Open DocumentHighlightRequest          View::highlights,
    "textDocument/documentLink"                 Open DocumentLinkRequest               View::document_links,
    "textDocument/documentSymbol"               Text DocumentSymbolRequest             View::document_symbols,
    "textDocument/foldingRange"                 Text FoldingRangeRequest               View::folding_ranges,
    "textDocument/formatting"                   Text DocumentFormattingRequest         View::formatting,
    "textDocument/hover"                        Open HoverRequest                      View::hover,
    "textDocument/inlayHint"                    Open InlayHintRequest                  View::inlay_hints,
    "textDocument/prepareCallHierarchy"         Open CallHierarchyPrepareRequest       View::prepare_calls,
    "textDocument/prepareRename"                Open PrepareRenameRequest              View::prepare_rename,
    "textDocument/rangeFormatting"              Text DocumentRangeFormattingRequest    View::range_formatting,
    "textDocument/references"                   All  ReferencesRequest                 View::references,
    "textDocument/rename"                       All  RenameRequest                     Server::rename,
    "textDocument/selectionRange"               Text SelectionRangeRequest             View::selection_ranges,
    "textDocument/semanticTokens/full"          Open SemanticTokensRequest             Server::all_tokens,
    "textDocument/semanticTokens/full/delta"    Open SemanticTokensDeltaRequest        Server::changed_tokens,
    "textDocument/semanticTokens/range"         Open SemanticTokensRangeRequest        Server::tokens_in_range,
    "textDocument/signatureHelp"                Open SignatureHelpRequest              View::signature_help,
    "workspace/symbol"                          All  WorkspaceSymbolRequest            View::workspace_symbols,
}

impl View {
    /// The view of a server.
    fn of(server: &mut Server) -> &View {
        &server.view
    }
}

impl Server {
    /// The server itself.
    fn of(server: &mut Server) -> &mut Server {
        server
    }

    /// Renames, and remembers it: an editor may send its changes one document after the other.
    fn rename(&mut self, params: types::RenameParams) -> Result<Option<types::WorkspaceEdit>, Failure> {
        let renaming = self.view.rename(params)?;
        self.view.renamed = Some((renaming.old, renaming.new));
        Ok(Some(renaming.edit))
    }

    fn text(&mut self, params: types::DocumentSymbolParams) -> Result<Option<String>, Failure> {
        let document = self.view.documents.get(&path_of(&params.text_document.uri));
        Ok(document.map(|document| document.text.whole().to_string()))
    }
}

/// The text of an open document, as the server has it.
pub(in crate::lsp) enum TextRequest {}

impl types::Request for TextRequest {
    const METHOD: types::LspRequestMethod<'static> = types::LspRequestMethod::new("hypedc/text");
    const MESSAGE_DIRECTION: types::MessageDirection = types::MessageDirection::ClientToServer;
    type Params = types::DocumentSymbolParams;
    type Result = Option<String>;
}

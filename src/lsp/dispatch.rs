//! Which family answers which request.

use gen_lsp_types as types;
use lsp_server::Request;

use super::server::Server;

impl Server {
    /// Answers a request.
    pub(super) fn dispatch(&mut self, request: Request) {
        match request.method.as_str() {
            "textDocument/formatting" => self.on::<types::DocumentFormattingRequest>(request, Self::formatting),
            "textDocument/rangeFormatting" => {
                self.on::<types::DocumentRangeFormattingRequest>(request, Self::range_formatting);
            }
            "textDocument/documentSymbol" => {
                self.on::<types::DocumentSymbolRequest>(request, Self::document_symbols);
            }
            "textDocument/foldingRange" => self.on::<types::FoldingRangeRequest>(request, Self::folding_ranges),
            "textDocument/selectionRange" => self.on::<types::SelectionRangeRequest>(request, Self::selection_ranges),
            "textDocument/codeAction" => self.on::<types::CodeActionRequest>(request, Self::code_actions),
            "textDocument/semanticTokens/full" => {
                self.on::<types::SemanticTokensRequest>(request, Self::semantic_tokens);
            }
            "textDocument/semanticTokens/full/delta" => {
                self.on::<types::SemanticTokensDeltaRequest>(request, Self::semantic_tokens_delta);
            }
            "textDocument/semanticTokens/range" => {
                self.on::<types::SemanticTokensRangeRequest>(request, Self::semantic_tokens_in_range);
            }
            "textDocument/definition" => self.on::<types::DefinitionRequest>(request, Self::definition),
            "textDocument/references" => self.on::<types::ReferencesRequest>(request, Self::references),
            "textDocument/documentHighlight" => {
                self.on::<types::DocumentHighlightRequest>(request, Self::highlights);
            }
            "textDocument/prepareRename" => self.on::<types::PrepareRenameRequest>(request, Self::prepare_rename),
            "textDocument/rename" => self.on::<types::RenameRequest>(request, Self::rename),
            "textDocument/hover" => self.on::<types::HoverRequest>(request, Self::hover),
            "workspace/symbol" => self.on::<types::WorkspaceSymbolRequest>(request, Self::workspace_symbols),
            "textDocument/documentLink" => self.on::<types::DocumentLinkRequest>(request, Self::document_links),
            "textDocument/prepareCallHierarchy" => {
                self.on::<types::CallHierarchyPrepareRequest>(request, Self::prepare_calls);
            }
            "callHierarchy/incomingCalls" => {
                self.on::<types::CallHierarchyIncomingCallsRequest>(request, Self::incoming_calls);
            }
            "callHierarchy/outgoingCalls" => {
                self.on::<types::CallHierarchyOutgoingCallsRequest>(request, Self::outgoing_calls);
            }
            "textDocument/completion" => self.on::<types::CompletionRequest>(request, Self::completion),
            "textDocument/signatureHelp" => self.on::<types::SignatureHelpRequest>(request, Self::signature_help),
            "textDocument/inlayHint" => self.on::<types::InlayHintRequest>(request, Self::inlay_hints),
            "textDocument/codeLens" => self.on::<types::CodeLensRequest>(request, Self::code_lenses),
            // For scripts and tests: answered when all findings were sent; the text as the server has it.
            "hypedc/idle" => self.nothing(request),
            "hypedc/text" => self.on::<super::server::TextRequest>(request, Self::text),
            _ => self.unknown(request),
        }
    }
}

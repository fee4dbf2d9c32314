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
            // For scripts: answered when all findings were sent.
            "hypedc/idle" => self.nothing(request),
            _ => self.unknown(request),
        }
    }
}

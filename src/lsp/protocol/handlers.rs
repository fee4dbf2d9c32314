//! The request handlers, one function each: converts the parameters, calls the feature, converts the result.
//! [`requests`](super::requests) is their table.

use std::ops::Range;
use std::path::PathBuf;

use gen_lsp_types as types;

use super::from_protocol::{file_bytes, mode_name, offset, position};
use super::server::{Failure, Server};
use super::to_protocol::{self, ToProtocol};
use super::uri::path_of;
use crate::lsp::documents::Document;
use crate::lsp::features::hierarchy::{self, Call};
use crate::lsp::features::{actions, completion, hints, hover, navigate, rename, signature, structure};
use crate::lsp::location::FileOffset;

/// The result of a handler.
pub(super) type Answer<R> = Result<<R as types::Request>::Result, Failure>;

impl Server {
    pub(super) fn to_protocol(&self) -> ToProtocol<'_> {
        ToProtocol { documents: &self.view.documents, client: &self.client }
    }

    fn offset(&self, at: &types::TextDocumentPositionParams) -> FileOffset {
        offset(&self.view, self.client.encoding, at)
    }

    pub(super) fn file_bytes(
        &self,
        document: &types::TextDocumentIdentifier,
        range: types::Range,
    ) -> (PathBuf, Range<usize>) {
        file_bytes(&self.view, self.client.encoding, document, range)
    }

    fn document(&self, document: &types::TextDocumentIdentifier) -> Option<&Document> {
        self.view.documents.get(&path_of(&document.uri))
    }
}

pub(super) fn incoming_calls(
    server: &Server,
    params: types::CallHierarchyIncomingCallsParams,
) -> Answer<types::CallHierarchyIncomingCallsRequest> {
    let Some(mode) = mode_name(&params.item) else { return Ok(None) };
    let to = server.to_protocol();
    let call = |Call { other, edges }| types::CallHierarchyIncomingCall {
        from: to.call_item(&other),
        from_ranges: to.ranges(&edges),
    };
    Ok(hierarchy::incoming_calls(&server.view, &mode).map(|calls| calls.into_iter().map(call).collect()))
}

pub(super) fn outgoing_calls(
    server: &Server,
    params: types::CallHierarchyOutgoingCallsParams,
) -> Answer<types::CallHierarchyOutgoingCallsRequest> {
    let Some(mode) = mode_name(&params.item) else { return Ok(None) };
    let to = server.to_protocol();
    let call = |Call { other, edges }| types::CallHierarchyOutgoingCall {
        to: to.call_item(&other),
        from_ranges: to.ranges(&edges),
    };
    Ok(hierarchy::outgoing_calls(&server.view, &mode).map(|calls| calls.into_iter().map(call).collect()))
}

pub(super) fn prepare_calls(
    server: &Server,
    params: types::CallHierarchyPrepareParams,
) -> Answer<types::CallHierarchyPrepareRequest> {
    let at = server.offset(&params.text_document_position_params);
    let items = hierarchy::prepare_calls(&server.view, &at);
    let to = server.to_protocol();
    Ok((!items.is_empty()).then(|| items.iter().map(|item| to.call_item(item)).collect()))
}

pub(super) fn code_actions(server: &Server, params: types::CodeActionParams) -> Answer<types::CodeActionRequest> {
    let (path, bytes) = server.file_bytes(&params.text_document, params.range);
    let wanted = |action: &types::CodeAction| {
        let kind = action.kind.as_ref().map(ToString::to_string).unwrap_or_default();
        let only = params.context.only.as_ref();
        only.is_none_or(|only| only.iter().any(|k| kind.starts_with(&k.to_string())))
    };
    let to = server.to_protocol();
    let mut out: Vec<types::CodeAction> = Vec::new();
    for action in actions::code_actions(&server.view, &path, &bytes).into_iter().map(|action| to.code_action(action)) {
        // Programs that share a file have the same findings in it.
        if wanted(&action) && !out.contains(&action) {
            out.push(action);
        }
    }
    Ok(Some(out.into_iter().map(Into::into).collect()))
}

pub(super) fn code_lenses(server: &Server, params: types::CodeLensParams) -> Answer<types::CodeLensRequest> {
    let Some(Document { uri, text, .. }) = server.document(&params.text_document) else { return Ok(None) };
    let to = server.to_protocol();
    Ok(Some(hints::code_lenses(text).iter().map(|lens| to.lens(uri, text, lens)).collect()))
}

pub(super) fn completion(server: &Server, params: types::CompletionParams) -> Answer<types::CompletionRequest> {
    let at = server.offset(&params.text_document_position_params);
    let Some(document) = server.view.documents.get(&at.path) else { return Ok(None) };
    let found = completion::completion(&server.view, &at);
    Ok(found.map(|found| server.to_protocol().completion(&document.text, found)))
}

pub(super) fn definition(server: &Server, params: types::DefinitionParams) -> Answer<types::DefinitionRequest> {
    let at = server.offset(&params.text_document_position_params);
    Ok(server.to_protocol().definition(navigate::definition(&server.view, &at)))
}

pub(super) fn highlights(
    server: &Server,
    params: types::DocumentHighlightParams,
) -> Answer<types::DocumentHighlightRequest> {
    let at = server.offset(&params.text_document_position_params);
    let to = server.to_protocol();
    let found = navigate::highlights(&server.view, &at);
    Ok(found.map(|found| found.iter().map(|highlight| to.highlight(highlight)).collect()))
}

pub(super) fn document_links(server: &Server, params: types::DocumentLinkParams) -> Answer<types::DocumentLinkRequest> {
    let path = path_of(&params.text_document.uri);
    let Some(Document { text, .. }) = server.view.documents.get(&path) else { return Ok(None) };
    let to = server.to_protocol();
    Ok(Some(navigate::document_links(&path, text).iter().map(|link| to.link(text, link)).collect()))
}

pub(super) fn document_symbols(
    server: &Server,
    params: types::DocumentSymbolParams,
) -> Answer<types::DocumentSymbolRequest> {
    let Some(Document { text, .. }) = server.document(&params.text_document) else { return Ok(None) };
    let to = server.to_protocol();
    let symbols = structure::document_symbols(text).into_iter().map(|symbol| to.symbol(text, symbol));
    Ok(Some(symbols.collect::<Vec<_>>().into()))
}

pub(super) fn folding_ranges(server: &Server, params: types::FoldingRangeParams) -> Answer<types::FoldingRangeRequest> {
    let document = server.document(&params.text_document);
    Ok(document.map(|document| structure::folding_ranges(&document.text).iter().map(to_protocol::fold).collect()))
}

pub(super) fn formatting(
    server: &Server,
    params: types::DocumentFormattingParams,
) -> Answer<types::DocumentFormattingRequest> {
    let Some(Document { text, .. }) = server.document(&params.text_document) else { return Ok(None) };
    Ok(actions::formatting(text, None).map(|edits| server.to_protocol().text_edits(text, edits)))
}

pub(super) fn range_formatting(
    server: &Server,
    params: types::DocumentRangeFormattingParams,
) -> Answer<types::DocumentRangeFormattingRequest> {
    let Some(Document { text, .. }) = server.document(&params.text_document) else { return Ok(None) };
    let (first, last) = (params.range.start.line, params.range.end.line);
    let edits = actions::formatting(text, Some(&(first.min(last)..=last)));
    Ok(edits.map(|edits| server.to_protocol().text_edits(text, edits)))
}

pub(super) fn hover(server: &Server, params: types::HoverParams) -> Answer<types::HoverRequest> {
    let at = server.offset(&params.text_document_position_params);
    Ok(hover::hover(&server.view, &at).map(|hover| server.to_protocol().hover(hover)))
}

pub(super) fn inlay_hints(server: &Server, params: types::InlayHintParams) -> Answer<types::InlayHintRequest> {
    let (path, bytes) = server.file_bytes(&params.text_document, params.range);
    let to = server.to_protocol();
    let found = hints::inlay_hints(&server.view, &path, &bytes);
    Ok(found.map(|(text, hints)| hints.into_iter().map(|hint| to.hint(&text, hint)).collect()))
}

pub(super) fn prepare_rename(
    server: &Server,
    params: types::PrepareRenameParams,
) -> Answer<types::PrepareRenameRequest> {
    let at = server.offset(&params.text_document_position_params);
    let found = rename::prepare_rename(&server.view, &at)?;
    Ok(found.map(|renamable| server.to_protocol().renamable(renamable)))
}

pub(super) fn references(server: &Server, params: types::ReferenceParams) -> Answer<types::ReferencesRequest> {
    let at = server.offset(&params.text_document_position_params);
    let found = navigate::references(&server.view, &at, params.context.include_declaration);
    let to = server.to_protocol();
    Ok(Some(found.iter().map(|at| to.location(at)).collect()))
}

/// Renames a symbol and records both names: an editor may send the resulting changes one document at a time.
pub(super) fn rename(server: &mut Server, params: types::RenameParams) -> Answer<types::RenameRequest> {
    let at = server.offset(&params.text_document_position_params);
    let renaming = rename::rename(&server.view, &at, &params.new_name)?;
    let edit = server.to_protocol().workspace_edit(renaming.edits);
    server.view.last_rename = Some((renaming.old, renaming.new));
    Ok(Some(edit))
}

pub(super) fn selection_ranges(
    server: &Server,
    params: types::SelectionRangeParams,
) -> Answer<types::SelectionRangeRequest> {
    let Some(Document { text, .. }) = server.document(&params.text_document) else { return Ok(None) };
    let positions = params.positions;
    let bytes: Vec<usize> = positions.iter().map(|at| text.byte(position(*at), server.client.encoding)).collect();
    let to = server.to_protocol();
    let found = structure::selection_ranges(text, &bytes);
    Ok(Some(positions.into_iter().zip(&found).map(|(at, around)| to.selection(text, at, around)).collect()))
}

pub(super) fn signature_help(
    server: &Server,
    params: types::SignatureHelpParams,
) -> Answer<types::SignatureHelpRequest> {
    let at = server.offset(&params.text_document_position_params);
    Ok(signature::signature_help(&server.view, &at).map(to_protocol::signature_help))
}

pub(super) fn workspace_symbols(
    server: &Server,
    params: types::WorkspaceSymbolParams,
) -> Answer<types::WorkspaceSymbolRequest> {
    let to = server.to_protocol();
    let found = navigate::workspace_symbols(&server.view, &params.query).into_iter();
    Ok(Some(found.map(|symbol| to.workspace_symbol(symbol)).collect::<Vec<_>>().into()))
}

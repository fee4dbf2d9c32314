//! The request handlers, one function each: converts the parameters, calls the feature, converts the result.
//! [`requests`](super::requests) is their table.

use std::ops::Range;
use std::path::PathBuf;

use gen_lsp_types as types;
use serde_json::json;

use super::context::{Context, Failure};
use super::from_protocol::{file_bytes, mode_name, offset, position};
use super::lenses::lenses;
use super::painting::tile_lines;
use super::to_protocol::{self, ToProtocol};
use super::uri::path_of;
use crate::lsp::documents::Document;
use crate::lsp::features::hierarchy::{self, Call};
use crate::lsp::features::{
    actions, completion, formatting as layout, hints, hover, navigate, rename, signature, structure,
};
use crate::lsp::location::FileOffset;

/// The result of a handler.
pub(super) type Answer<R> = Result<<R as types::Request>::Result, Failure>;

impl Context {
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
    context: &Context,
    params: types::CallHierarchyIncomingCallsParams,
) -> Answer<types::CallHierarchyIncomingCallsRequest> {
    let Some(mode) = mode_name(&params.item) else { return Ok(None) };
    let to = context.to_protocol();
    let call = |Call { other, edges }| types::CallHierarchyIncomingCall {
        from: to.call_item(&other),
        from_ranges: to.ranges(&edges),
    };
    Ok(hierarchy::incoming_calls(&context.view, &mode).map(|calls| calls.into_iter().map(call).collect()))
}

pub(super) fn outgoing_calls(
    context: &Context,
    params: types::CallHierarchyOutgoingCallsParams,
) -> Answer<types::CallHierarchyOutgoingCallsRequest> {
    let Some(mode) = mode_name(&params.item) else { return Ok(None) };
    let to = context.to_protocol();
    let call = |Call { other, edges }| types::CallHierarchyOutgoingCall {
        to: to.call_item(&other),
        from_ranges: to.ranges(&edges),
    };
    Ok(hierarchy::outgoing_calls(&context.view, &mode).map(|calls| calls.into_iter().map(call).collect()))
}

pub(super) fn prepare_calls(
    context: &Context,
    params: types::CallHierarchyPrepareParams,
) -> Answer<types::CallHierarchyPrepareRequest> {
    let at = context.offset(&params.text_document_position_params);
    let items = hierarchy::prepare_calls(&context.view, &at);
    let to = context.to_protocol();
    Ok((!items.is_empty()).then(|| items.iter().map(|item| to.call_item(item)).collect()))
}

pub(super) fn code_actions(context: &Context, params: types::CodeActionParams) -> Answer<types::CodeActionRequest> {
    let (path, bytes) = context.file_bytes(&params.text_document, params.range);
    let wanted = |action: &types::CodeAction| {
        let kind = action.kind.as_ref().map(ToString::to_string).unwrap_or_default();
        let only = params.context.only.as_ref();
        only.is_none_or(|only| only.iter().any(|k| kind.starts_with(&k.to_string())))
    };
    let to = context.to_protocol();
    let mut out: Vec<types::CodeAction> = Vec::new();
    let found = actions::code_actions(&context.view, &path, &bytes, context.client.resolves_actions);
    let place = || json!({ "uri": params.text_document.uri, "start": bytes.start, "end": bytes.end });
    let makes_files = |action: &actions::CodeAction<'_>| {
        action.kind == actions::ActionKind::Move
            || action.edits.as_ref().is_some_and(|edits| !edits.new_files.is_empty())
    };
    let found = found.into_iter().filter(|action| context.client.creates_files || !makes_files(action));
    for action in found.map(|action| to.code_action(action, place)) {
        // Programs that share a file have the same findings in it.
        if wanted(&action) && !out.contains(&action) {
            out.push(action);
        }
    }
    Ok(Some(out.into_iter().map(Into::into).collect()))
}

/// The edits of an action that was listed without them.
pub(super) fn resolve_action(context: &Context, action: types::CodeAction) -> Answer<types::CodeActionResolveRequest> {
    let place = action.data.as_ref().and_then(|data| {
        let at = |key: &str| Some(data.get(key)?.as_u64()? as usize);
        let uri = types::Uri(data.get("uri")?.as_str()?.into());
        Some((path_of(&uri), at("start")?..at("end")?))
    });
    let Some((path, bytes)) = place.filter(|_| action.edit.is_none()) else { return Ok(action) };
    let edits = actions::resolved(&context.view, &path, &bytes, &action.title)?;
    Ok(types::CodeAction { edit: Some(context.to_protocol().action_edit(edits)), ..action })
}

pub(super) fn code_lenses(context: &Context, params: types::CodeLensParams) -> Answer<types::CodeLensRequest> {
    let path = path_of(&params.text_document.uri);
    Ok(context.view.documents.get(&path).map(|document| lenses(context, &path, document)))
}

pub(super) fn completion(context: &Context, params: types::CompletionParams) -> Answer<types::CompletionRequest> {
    let at = context.offset(&params.text_document_position_params);
    let Some(document) = context.view.documents.get(&at.path) else { return Ok(None) };
    let found = completion::completion(&context.view, &at);
    if found.as_ref().is_some_and(|found| !found.is_likely) && opens_unasked(params.context.as_ref()) {
        // After the first letter of a word it is asked for again.
        return Ok(Some(types::CompletionList { is_incomplete: true, ..types::CompletionList::default() }.into()));
    }
    Ok(found.map(|found| context.to_protocol().completion(&document.text, found)))
}

/// Whether a list would open by itself between words, where one goes on writing more often than choosing. After a dot,
/// an arrow or a quote only some names fit, and they are wanted.
fn opens_unasked(context: Option<&types::CompletionContext>) -> bool {
    let typed = context.and_then(|context| context.trigger_character.as_deref());
    typed.is_some_and(|typed| matches!(typed, " " | "(" | "," | ":"))
}

pub(super) fn definition(context: &Context, params: types::DefinitionParams) -> Answer<types::DefinitionRequest> {
    let at = context.offset(&params.text_document_position_params);
    Ok(context.to_protocol().definition(navigate::definition(&context.view, &at)))
}

pub(super) fn highlights(
    context: &Context,
    params: types::DocumentHighlightParams,
) -> Answer<types::DocumentHighlightRequest> {
    let at = context.offset(&params.text_document_position_params);
    let to = context.to_protocol();
    let found = navigate::highlights(&context.view, &at);
    Ok(found.map(|found| found.iter().map(|highlight| to.highlight(highlight)).collect()))
}

pub(super) fn document_links(
    context: &Context,
    params: types::DocumentLinkParams,
) -> Answer<types::DocumentLinkRequest> {
    let path = path_of(&params.text_document.uri);
    let Some(Document { text, .. }) = context.view.documents.get(&path) else { return Ok(None) };
    let to = context.to_protocol();
    Ok(Some(navigate::document_links(&path, text).iter().map(|link| to.link(text, link)).collect()))
}

pub(super) fn document_symbols(
    context: &Context,
    params: types::DocumentSymbolParams,
) -> Answer<types::DocumentSymbolRequest> {
    let Some(Document { text, .. }) = context.document(&params.text_document) else { return Ok(None) };
    let to = context.to_protocol();
    let symbols = structure::document_symbols(text).into_iter().map(|symbol| to.symbol(text, symbol));
    Ok(Some(symbols.collect::<Vec<_>>().into()))
}

pub(super) fn folding_ranges(
    context: &Context,
    params: types::FoldingRangeParams,
) -> Answer<types::FoldingRangeRequest> {
    let document = context.document(&params.text_document);
    Ok(document.map(|document| structure::folding_ranges(&document.text).iter().map(to_protocol::fold).collect()))
}

pub(super) fn formatting(
    context: &Context,
    params: types::DocumentFormattingParams,
) -> Answer<types::DocumentFormattingRequest> {
    let Some(Document { text, .. }) = context.document(&params.text_document) else { return Ok(None) };
    Ok(layout::formatting(text, None).map(|edits| context.to_protocol().text_edits(text, edits)))
}

pub(super) fn range_formatting(
    context: &Context,
    params: types::DocumentRangeFormattingParams,
) -> Answer<types::DocumentRangeFormattingRequest> {
    let Some(Document { text, .. }) = context.document(&params.text_document) else { return Ok(None) };
    let (first, last) = (params.range.start.line, params.range.end.line);
    let edits = layout::formatting(text, Some(&(first.min(last)..=last)));
    Ok(edits.map(|edits| context.to_protocol().text_edits(text, edits)))
}

pub(super) fn hover(context: &Context, params: types::HoverParams) -> Answer<types::HoverRequest> {
    let at = context.offset(&params.text_document_position_params);
    let of_tile = |tile: &_| tile_lines(context, &at.path, tile);
    Ok(hover::hover(&context.view, &at, &of_tile).map(|hover| context.to_protocol().hover(hover)))
}

pub(super) fn inlay_hints(context: &Context, params: types::InlayHintParams) -> Answer<types::InlayHintRequest> {
    let (path, bytes) = context.file_bytes(&params.text_document, params.range);
    let to = context.to_protocol();
    let found = hints::inlay_hints(&context.view, &path, &bytes);
    Ok(found.map(|(text, hints)| hints.into_iter().map(|hint| to.hint(&text, hint)).collect()))
}

pub(super) fn prepare_rename(
    context: &Context,
    params: types::PrepareRenameParams,
) -> Answer<types::PrepareRenameRequest> {
    let at = context.offset(&params.text_document_position_params);
    let found = rename::prepare_rename(&context.view, &at)?;
    Ok(found.map(|renamable| context.to_protocol().renamable(renamable)))
}

pub(super) fn references(context: &Context, params: types::ReferenceParams) -> Answer<types::ReferencesRequest> {
    let at = context.offset(&params.text_document_position_params);
    let found = navigate::references(&context.view, &at, params.context.include_declaration);
    let to = context.to_protocol();
    Ok(Some(found.iter().map(|at| to.location(at)).collect()))
}

/// Renames a symbol and records both names: an editor may send the resulting changes one document at a time.
pub(super) fn rename(context: &mut Context, params: types::RenameParams) -> Answer<types::RenameRequest> {
    let at = context.offset(&params.text_document_position_params);
    let renaming = rename::rename(&context.view, &at, &params.new_name)?;
    let edit = context.to_protocol().workspace_edit(renaming.edits);
    context.view.last_rename = Some((renaming.old, renaming.new));
    Ok(Some(edit))
}

pub(super) fn selection_ranges(
    context: &Context,
    params: types::SelectionRangeParams,
) -> Answer<types::SelectionRangeRequest> {
    let Some(Document { text, .. }) = context.document(&params.text_document) else { return Ok(None) };
    let positions = params.positions;
    let bytes: Vec<usize> = positions.iter().map(|at| text.byte(position(*at), context.client.encoding)).collect();
    let to = context.to_protocol();
    let found = structure::selection_ranges(text, &bytes);
    Ok(Some(positions.into_iter().zip(&found).map(|(at, around)| to.selection(text, at, around)).collect()))
}

pub(super) fn signature_help(
    context: &Context,
    params: types::SignatureHelpParams,
) -> Answer<types::SignatureHelpRequest> {
    let at = context.offset(&params.text_document_position_params);
    Ok(signature::signature_help(&context.view, &at).map(to_protocol::signature_help))
}

pub(super) fn workspace_symbols(
    context: &Context,
    params: types::WorkspaceSymbolParams,
) -> Answer<types::WorkspaceSymbolRequest> {
    let to = context.to_protocol();
    let found = navigate::workspace_symbols(&context.view, &params.query).into_iter();
    Ok(Some(found.map(|symbol| to.workspace_symbol(symbol)).collect::<Vec<_>>().into()))
}

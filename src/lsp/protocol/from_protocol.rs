//! Converts parameters from the protocol: URIs to paths, positions to byte offsets.

use std::ops::Range;
use std::path::PathBuf;

use gen_lsp_types as types;
use gen_lsp_types::{TextDocumentContentChangeEvent, Uri};
use serde_json::Value;

use super::uri::path_of;
use crate::lsp::documents::Change;
use crate::lsp::features::hierarchy::ModeName;
use crate::lsp::location::FileOffset;
use crate::lsp::text::document_text::{Encoding, Position};
use crate::lsp::view::View;

/// Converts a position.
pub(super) fn position(at: types::Position) -> Position {
    Position { line: at.line, column: at.character }
}

/// The byte offset of a position; 0 in an unknown document.
pub(super) fn offset(view: &View, encoding: Encoding, at: &types::TextDocumentPositionParams) -> FileOffset {
    let path = path_of(&at.text_document.uri);
    let byte = view.text(&path).map_or(0, |text| text.byte(position(at.position), encoding));
    FileOffset { path, byte }
}

/// The bytes of a range, with its ends in either order; empty in an unknown document.
pub(super) fn file_bytes(
    view: &View,
    encoding: Encoding,
    document: &types::TextDocumentIdentifier,
    range: types::Range,
) -> (PathBuf, Range<usize>) {
    let path = path_of(&document.uri);
    let range = position(range.start)..position(range.end);
    let bytes = view.text(&path).map_or(0..0, |text| text.bytes(range, encoding));
    (path, bytes)
}

/// Converts the changes of a document.
pub(super) fn changes(changes: Vec<TextDocumentContentChangeEvent>) -> Vec<Change> {
    use TextDocumentContentChangeEvent::{TextDocumentContentChangePartial, TextDocumentContentChangeWholeDocument};
    let change = |change| match change {
        TextDocumentContentChangePartial(part) => {
            Change { range: Some(position(part.range.start)..position(part.range.end)), new_text: part.text }
        }
        TextDocumentContentChangeWholeDocument(whole) => Change { range: None, new_text: whole.text },
    };
    changes.into_iter().map(change).collect()
}

/// The mode of a call hierarchy item, which the server stored in its data.
pub(super) fn mode_name(item: &types::CallHierarchyItem) -> Option<ModeName> {
    let data = item.data.as_ref()?;
    let text = |key: &str| Some(data.get(key)?.as_str()?.to_string());
    Some(ModeName { root: text("root")?.into(), entity: text("entity")?, mode: text("mode")? })
}

/// The workspace folders in the parameters of `initialize`; older clients send a single `rootUri`. Uses plain JSON, so
/// that a missing required field elsewhere does no harm.
pub(super) fn folders(params: &Value) -> Vec<PathBuf> {
    let path = |uri: &Value| uri.as_str().map(|uri| path_of(&Uri(uri.into())));
    match params["workspaceFolders"].as_array() {
        Some(list) => list.iter().filter_map(|folder| path(&folder["uri"])).collect(),
        None => path(&params["rootUri"]).into_iter().collect(),
    }
}

//! The handlers of requests that edit: formatting while one types, and renames of files.

use std::path::PathBuf;

use gen_lsp_types as types;

use super::context::Context;
use super::handlers::Answer;
use super::uri::path_of;
use crate::lsp::features::{file_renames, formatting};

pub(super) fn on_type_formatting(
    context: &Context,
    params: types::DocumentOnTypeFormattingParams,
) -> Answer<types::DocumentOnTypeFormattingRequest> {
    let path = path_of(&params.text_document.uri);
    let Some(document) = context.view.documents.get(&path) else { return Ok(None) };
    let edits = formatting::on_type(&document.text, params.position.line, &params.ch);
    Ok(edits.map(|edits| context.to_protocol().text_edits(&document.text, edits)))
}

pub(super) fn will_rename_files(
    context: &Context,
    params: types::RenameFilesParams,
) -> Answer<types::WillRenameFilesRequest> {
    let renames: Vec<(PathBuf, PathBuf)> =
        params.files.iter().map(|file| (path_of(&file.old_uri), path_of(&file.new_uri))).collect();
    let edits = file_renames::followed(&context.view, &renames);
    Ok((!edits.is_empty()).then(|| context.to_protocol().workspace_edit(edits)))
}

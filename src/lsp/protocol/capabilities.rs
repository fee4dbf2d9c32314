//! The capabilities that the server announces to the client.

use gen_lsp_types as types;
use gen_lsp_types::{PositionEncodingKind, ServerCapabilities};
use serde_json::{Value, json};

use super::client::Client;
use super::commands::COMMANDS;
use super::tokens;
use crate::lsp::text::document_text::Encoding;

/// The capabilities of the server.
pub(in crate::lsp) fn capabilities(client: &Client) -> ServerCapabilities {
    let words = |list: &[&str]| Some(list.iter().map(|w| (*w).to_string()).collect::<Vec<String>>());
    ServerCapabilities {
        position_encoding: Some(match client.encoding {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
            Encoding::Utf32 => PositionEncodingKind::UTF32,
        }),
        text_document_sync: Some(
            types::TextDocumentSyncOptions {
                open_close: Some(true),
                change: Some(types::TextDocumentSyncKind::Incremental),
                save: Some(true.into()),
                ..Default::default()
            }
            .into(),
        ),
        document_formatting_provider: Some(true.into()),
        document_range_formatting_provider: Some(true.into()),
        document_on_type_formatting_provider: Some(types::DocumentOnTypeFormattingOptions {
            first_trigger_character: "}".into(),
            more_trigger_character: words(&["\n"]),
        }),
        document_symbol_provider: Some(true.into()),
        folding_range_provider: Some(true.into()),
        selection_range_provider: Some(true.into()),
        code_action_provider: Some(
            types::CodeActionOptions {
                code_action_kinds: Some(vec![
                    types::CodeActionKind::QuickFix,
                    types::CodeActionKind::RefactorExtract,
                    types::CodeActionKind::RefactorInline,
                    types::CodeActionKind::RefactorMove,
                    types::CodeActionKind::RefactorRewrite,
                    types::CodeActionKind::SourceFixAll,
                ]),
                resolve_provider: Some(true),
                ..Default::default()
            }
            .into(),
        ),
        definition_provider: Some(true.into()),
        references_provider: Some(true.into()),
        document_highlight_provider: Some(true.into()),
        rename_provider: Some(types::RenameOptions { prepare_provider: Some(true), ..Default::default() }.into()),
        hover_provider: Some(true.into()),
        workspace_symbol_provider: Some(true.into()),
        document_link_provider: Some(types::DocumentLinkOptions::default()),
        completion_provider: Some(types::CompletionOptions {
            trigger_characters: words(&[".", ">", "(", ",", ":", " ", "\"", "/"]),
            ..Default::default()
        }),
        signature_help_provider: Some(types::SignatureHelpOptions {
            trigger_characters: words(&["(", ","]),
            ..Default::default()
        }),
        semantic_tokens_provider: Some(
            types::SemanticTokensOptions {
                legend: tokens::legend(),
                range: Some(true.into()),
                full: Some(types::SemanticTokensFullDelta { delta: Some(true) }.into()),
                ..Default::default()
            }
            .into(),
        ),
        inlay_hint_provider: Some(true.into()),
        code_lens_provider: Some(types::CodeLensOptions::default()),
        call_hierarchy_provider: Some(true.into()),
        execute_command_provider: Some(types::ExecuteCommandOptions {
            // An editor that has commands of these names sends them without this list.
            commands: if client.has_commands { Vec::new() } else { words(COMMANDS).unwrap_or_default() },
            ..Default::default()
        }),
        workspace: Some(types::WorkspaceOptions {
            workspace_folders: Some(types::WorkspaceFoldersServerCapabilities {
                supported: Some(true),
                change_notifications: Some(true.into()),
            }),
            file_operations: Some(types::FileOperationOptions {
                will_rename: Some(types::FileOperationRegistrationOptions { filters: renamed_files() }),
                ..Default::default()
            }),
            ..Default::default()
        }),
        ..Default::default()
    }
}

/// The files that programs name, and folders of them.
fn renamed_files() -> Vec<types::FileOperationFilter> {
    let filter = |glob: &str, matches| types::FileOperationFilter {
        scheme: Some("file".into()),
        pattern: types::FileOperationPattern { glob: glob.into(), matches: Some(matches), options: None },
    };
    let files = filter("**/*.{hyped,txt,json,tmx,tmj,tsx,ldtk,png}", types::FileOperationPatternKind::File);
    vec![files, filter("**", types::FileOperationPatternKind::Folder)]
}

/// The registration for changes of programs, levels and legends on the disk.
pub(in crate::lsp) fn watchers() -> Value {
    let patterns = ["**/*.hyped", "**/*.txt", "**/*.json", "**/*.tmx", "**/*.tmj", "**/*.tsx", "**/*.ldtk"];
    let watchers: Vec<Value> = patterns.iter().map(|pattern| json!({ "globPattern": pattern })).collect();
    json!({ "registrations": [{
        "id": "files",
        "method": "workspace/didChangeWatchedFiles",
        "registerOptions": { "watchers": watchers },
    }] })
}

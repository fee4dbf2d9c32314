//! What the client tells the server without a question: documents that open, change and close, folders, settings, and
//! requests that it does not wait for any longer.

use std::path::PathBuf;
use std::sync::Arc;

use gen_lsp_types as types;
use lsp_server::{ErrorCode, Notification, RequestId};
use serde_json::Value;

use super::Server;
use crate::lsp::protocol::capabilities::watchers;
use crate::lsp::protocol::client::wants_verdicts;
use crate::lsp::protocol::context::Failure;
use crate::lsp::protocol::from_protocol::changes;
use crate::lsp::protocol::uri::path_of;

impl Server {
    /// Takes what the client tells.
    pub(super) fn notification(&mut self, notification: Notification) {
        fn read<N: types::Notification>(params: Value) -> Option<N::Params> {
            serde_json::from_value(params).ok()
        }
        let Notification { method, params } = notification;
        match method.as_str() {
            "initialized" if self.context.client.watches_files => {
                self.send_request("client/registerCapability", watchers())
            }
            "textDocument/didOpen" => {
                let Some(params) = read::<types::DidOpenTextDocumentNotification>(params) else { return };
                let document = params.text_document;
                let language = document.language_id.to_string();
                let path = path_of(&document.uri);
                self.context.view.documents.open(
                    path.clone(),
                    document.uri.0,
                    document.version,
                    document.text,
                    &language,
                );
                self.mark_changed(path);
            }
            "textDocument/didChange" => {
                let Some(params) = read::<types::DidChangeTextDocumentNotification>(params) else { return };
                let document = params.text_document;
                let path = path_of(&document.text_document_identifier.uri);
                let (changes, encoding) = (changes(params.content_changes), self.context.client.encoding);
                if self.context.view.documents.change(&path, document.version, &changes, encoding) {
                    self.mark_changed(path);
                }
            }
            "textDocument/didSave" => {
                let Some(params) = read::<types::DidSaveTextDocumentNotification>(params) else { return };
                let path = path_of(&params.text_document.uri);
                if self.context.view.documents.save(&path) {
                    self.mark_changed(path);
                }
                if !self.context.client.watches_files {
                    self.read_again();
                }
            }
            "textDocument/didClose" => {
                let Some(params) = read::<types::DidCloseTextDocumentNotification>(params) else { return };
                let path = path_of(&params.text_document.uri);
                self.context.tokens.forget(&path);
                if self.context.view.documents.close(&path) {
                    self.mark_changed(path);
                }
            }
            "workspace/didChangeWatchedFiles" => {
                let Some(params) = read::<types::DidChangeWatchedFilesNotification>(params) else { return };
                for change in params.changes {
                    self.rescan |= change.kind != types::FileChangeType::Changed;
                    self.mark_changed(path_of(&change.uri));
                }
            }
            "workspace/didChangeWorkspaceFolders" => {
                let Some(params) = read::<types::DidChangeWorkspaceFoldersNotification>(params) else { return };
                let gone: Vec<PathBuf> = params.event.removed.iter().map(|f| path_of(&f.uri)).collect();
                let folders = Arc::make_mut(&mut self.folders);
                folders.retain(|folder| !gone.contains(folder));
                folders.extend(params.event.added.iter().map(|f| path_of(&f.uri)));
                (self.rescan, self.has_unsent_changes) = (true, true);
            }
            "window/workDoneProgress/cancel" => {
                self.tasks.cancel_progress(&params["token"]);
            }
            "$/cancelRequest" => {
                let Some(params) = read::<types::CancelNotification>(params) else { return };
                let id = match params.id {
                    types::Id::Int(number) => RequestId::from(number),
                    types::Id::String(text) => RequestId::from(text),
                };
                self.tasks.cancel(&id);
                let waits = self.waiting.iter().position(|(request, _)| request.id == id);
                if waits.map(|at| self.waiting.remove(at)).is_some() || self.live.cancel(&id) {
                    self.respond::<()>(id, Err(Failure::new(ErrorCode::RequestCanceled, "cancelled")));
                }
            }
            "workspace/didChangeConfiguration" => {
                let wanted = wants_verdicts(&params["settings"]);
                if let Some(is_on) = wanted.filter(|is_on| *is_on != self.live.is_on) {
                    self.live.is_on = is_on;
                    self.forget_verdicts(|_| is_on);
                    self.ask();
                }
            }
            _ => {}
        }
    }
}

//! The messages that have come and are not handled yet. What a later message of them makes void is given up before it is
//! begun: a request that is cancelled, and one that is asked again about a document that has changed since.

use std::collections::BTreeSet;

use crossbeam_channel::Receiver;
use lsp_server::{ErrorCode, Message, RequestId};
use serde_json::Value;

use super::context::Failure;

/// The methods by which editors ask again, after each change, for what they show of a document.
const SHOWN: &[&str] = &[
    "textDocument/codeLens",
    "textDocument/documentHighlight",
    "textDocument/documentLink",
    "textDocument/documentSymbol",
    "textDocument/foldingRange",
    "textDocument/inlayHint",
    "textDocument/semanticTokens/full",
    "textDocument/semanticTokens/full/delta",
    "textDocument/semanticTokens/range",
];

/// The messages to be handled, in order, and the requests that are given up.
pub(super) struct Inbox {
    pub messages: Vec<Message>,
    pub given_up: Vec<(RequestId, Failure)>,
}

impl Inbox {
    /// A message, and those that wait behind it.
    pub fn of(first: Message, waiting: &Receiver<Message>) -> Self {
        // Those that come meanwhile are left: otherwise a client that sends fast would never get an answer.
        let count = waiting.len();
        Inbox::sorted(std::iter::once(first).chain(waiting.try_iter().take(count)).collect())
    }

    fn sorted(messages: Vec<Message>) -> Self {
        let mut inbox = Inbox { messages: Vec::with_capacity(messages.len()), given_up: Vec::new() };
        // What later messages say.
        let (mut cancelled, mut changed): (BTreeSet<String>, BTreeSet<String>) = Default::default();
        let mut asked_again: BTreeSet<(String, String)> = BTreeSet::new();
        for message in messages.into_iter().rev() {
            match &message {
                Message::Notification(note) if note.method == "$/cancelRequest" => {
                    cancelled.insert(note.params["id"].to_string());
                }
                Message::Notification(note) if note.method == "textDocument/didChange" => {
                    changed.insert(document(&note.params));
                }
                Message::Request(request) => {
                    let of = (request.method.clone(), document(&request.params));
                    let id = serde_json::to_value(&request.id).unwrap_or_default().to_string();
                    let failure = if cancelled.contains(&id) {
                        Some(Failure::new(ErrorCode::RequestCanceled, "cancelled"))
                    } else if changed.contains(&of.1) && asked_again.contains(&of) {
                        Some(Failure::new(ErrorCode::ContentModified, "the document has changed"))
                    } else {
                        None
                    };
                    if let Some(failure) = failure {
                        inbox.given_up.push((request.id.clone(), failure));
                        continue;
                    }
                    if SHOWN.contains(&request.method.as_str()) {
                        asked_again.insert(of);
                    }
                }
                _ => {}
            }
            inbox.messages.push(message);
        }
        inbox.messages.reverse();
        inbox.given_up.reverse();
        inbox
    }
}

/// The document that a message is about.
fn document(params: &Value) -> String {
    params["textDocument"]["uri"].as_str().unwrap_or_default().to_string()
}

#[cfg(test)]
mod tests {
    use lsp_server::{Notification, Request};
    use serde_json::json;

    use super::*;

    fn ask(id: i32, method: &str) -> Message {
        let params = json!({ "textDocument": { "uri": "a" } });
        Request { id: id.into(), method: format!("textDocument/{method}"), params }.into()
    }

    fn tell(method: &str, params: Value) -> Message {
        Notification { method: method.into(), params }.into()
    }

    /// The requests that are handled, and those that are given up, by their numbers.
    fn sorted(messages: Vec<Message>) -> (Vec<String>, Vec<(String, i32)>) {
        let inbox = Inbox::sorted(messages);
        let handled = inbox.messages.iter().filter_map(|message| match message {
            Message::Request(request) => Some(request.id.to_string()),
            _ => None,
        });
        let given_up = inbox.given_up.into_iter().map(|(id, failure)| (id.to_string(), failure.code));
        (handled.collect(), given_up.collect())
    }

    #[test]
    fn what_is_cancelled_is_not_begun() {
        let messages = vec![
            ask(1, "hover"),
            ask(2, "hover"),
            tell("$/cancelRequest", json!({ "id": 1 })),
            tell("$/cancelRequest", json!({ "id": "2" })),
        ];
        assert_eq!(sorted(messages), (vec!["2".into()], vec![("1".into(), ErrorCode::RequestCanceled as i32)]));
    }

    #[test]
    fn of_what_is_asked_again_after_a_change_the_last_is_answered() {
        let change = |uri: &str| tell("textDocument/didChange", json!({ "textDocument": { "uri": uri } }));
        let messages = vec![
            ask(1, "foldingRange"),
            ask(2, "hover"),
            ask(3, "documentSymbol"),
            change("a"),
            ask(4, "foldingRange"),
            ask(5, "hover"),
            change("b"),
            ask(6, "foldingRange"),
        ];
        let handled = ["2", "3", "4", "5", "6"].map(String::from).to_vec();
        assert_eq!(sorted(messages), (handled, vec![("1".into(), ErrorCode::ContentModified as i32)]));
    }
}

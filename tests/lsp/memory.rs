//! What the memory of a server grows to: over many edits, and by large texts that are closed again.

#![cfg(target_os = "linux")]

use std::io::BufReader;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use lsp_server::{Message, Notification, Request};
use serde_json::{Value, json};

use super::SLIME;
use super::client::Client;

const URI: &str = "file:///game/a.hyped";

/// A program of about so many bytes.
fn large(bytes: usize) -> String {
    let entities = SLIME.split_once("const floor_height").unwrap().0;
    let numbered = |number: usize| {
        let entities = entities.replace("entity Slime", &format!("entity Slime{number}"));
        entities.replace("Hero", &format!("Hero{number}"))
    };
    (0..bytes / entities.len()).map(numbered).collect()
}

/// The memory that a process has, bytes.
fn resident(process: &str) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{process}/statm")).unwrap();
    text.split(' ').nth(1).unwrap().parse::<u64>().unwrap() * 4096
}

#[test]
#[ignore = "the memory of a process is that of all tests in it: run alone, by `memory_of_many_edits_is_bounded`"]
fn many_edits() {
    let mut client = Client::start(&[], json!({}));
    client.open(URI, SLIME);
    let change = |client: &mut Client, rounds: usize| {
        for round in 0..rounds {
            let start = json!({ "line": 2, "character": 0 });
            let end = json!({ "line": 2, "character": usize::from(round % 2 == 1) });
            let text = if round % 2 == 0 { "}" } else { "" };
            client.change(URI, json!([{ "range": { "start": start, "end": end }, "text": text }]));
            if round % 50 == 49 {
                client.settle();
            }
        }
    };
    change(&mut client, 2_000);
    let before = resident("self");
    change(&mut client, 10_000);
    let grown = resident("self").saturating_sub(before);
    assert!(client.stop());
    assert!(grown < 8 << 20, "{grown} bytes more after 10,000 edits");
}

#[test]
#[ignore = "the memory of a process is that of all tests in it: run alone, by `memory_of_large_pastes_is_given_back`"]
fn large_pastes() {
    let large = large(1 << 19);
    let mut client = Client::start(&[], json!({}));
    let rounds = (0..8).map(|_| {
        client.open(URI, "");
        client.settle();
        client.change(URI, json!([{ "text": large }]));
        client.settle();
        let document = json!({ "textDocument": { "uri": URI } });
        client.request("textDocument/documentSymbol", document.clone()).unwrap();
        client.request("textDocument/foldingRange", document).unwrap();
        client.close(URI);
        client.settle();
        client.published.clear();
        resident("self")
    });
    // This process does not give it back to the system; what is kept would add up.
    let all: Vec<u64> = rounds.collect();
    let most = all[..3].iter().max().unwrap();
    assert!(all[7] * 2 < most * 3, "bytes after each paste: {all:?}");
    assert!(client.stop());
}

#[test]
fn memory_of_large_pastes_is_given_back() {
    runs_alone("lsp::memory::large_pastes");
}

#[test]
fn memory_of_many_edits_is_bounded() {
    runs_alone("lsp::memory::many_edits");
}

/// Runs a test in a process of its own.
fn runs_alone(test: &str) {
    let tests = std::env::current_exe().unwrap();
    let output = Command::new(tests).args([test, "--exact", "--ignored"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

/// `hypedc lsp` in a process of its own.
struct Server {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    requests: i32,
}

impl Server {
    fn start() -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
        let command = command.arg("lsp").stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = command.spawn().unwrap();
        let (input, output) = (process.stdin.take().unwrap(), BufReader::new(process.stdout.take().unwrap()));
        let mut server = Server { process, input, output, requests: 0 };
        server.request("initialize", json!({ "capabilities": {} }));
        server.notify("initialized", json!({}));
        server
    }

    fn notify(&mut self, method: &str, params: Value) {
        Message::from(Notification::new(method.to_string(), params)).write(&mut self.input).unwrap();
    }

    fn request(&mut self, method: &str, params: Value) {
        self.requests += 1;
        let request = Request::new(self.requests.into(), method.to_string(), params);
        Message::from(request).write(&mut self.input).unwrap();
        let is_answer = |message: &Message| matches!(message, Message::Response(one) if one.id == self.requests.into());
        while !is_answer(&Message::read(&mut self.output).unwrap().unwrap()) {}
    }

    fn resident(&self) -> u64 {
        resident(&self.process.id().to_string())
    }
}

#[cfg(target_env = "gnu")]
#[test]
fn memory_of_a_closed_text_goes_back_to_the_system() {
    let text = large(1 << 21);
    let mut server = Server::start();
    let before = server.resident();
    let document = json!({ "uri": URI, "languageId": "hyped", "version": 1, "text": text });
    server.notify("textDocument/didOpen", json!({ "textDocument": document }));
    server.request("hypedc/idle", Value::Null);
    let open = server.resident() - before;
    server.notify("textDocument/didClose", json!({ "textDocument": { "uri": URI } }));
    server.request("hypedc/idle", Value::Null);
    // It goes back after the answer.
    let is_back = (0..100).any(|_| {
        std::thread::sleep(Duration::from_millis(100));
        server.resident().saturating_sub(before) * 4 < open
    });
    let closed = server.resident().saturating_sub(before);
    server.request("shutdown", Value::Null);
    server.notify("exit", Value::Null);
    assert!(server.process.wait().unwrap().success());
    assert!(is_back, "{open} bytes more when it is open, {closed} when it is closed");
}

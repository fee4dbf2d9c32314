//! An editor for tests: it talks to a server over streams of bytes, as editors do, keeps the texts as an editor does, and what is shown.

#![allow(dead_code, reason = "not every user needs all of it")]

use std::collections::BTreeMap;
use std::io::{BufReader, pipe};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use hypedc::lsp::{Server, Settings, Transport, Workspace};
use hypedc::source::{Files, ReadError, decode};
use lsp_server::{Connection, Message, Notification, Request, RequestId};
use serde_json::{Value, json};

/// Files by path, in memory.
#[derive(Clone, Default)]
pub struct Memory(pub BTreeMap<PathBuf, String>);

impl Files for Memory {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        assert!(!path.ends_with("fails.hyped"), "this file makes the compiler fail");
        let text = self.0.get(path).ok_or(ReadError::Unreadable("no such file".into()))?;
        decode(text.clone().into_bytes())
    }
}

impl Workspace for Memory {
    fn programs(&self, folder: &Path) -> Vec<PathBuf> {
        let is_program = |path: &&PathBuf| path.starts_with(folder) && path.extension().is_some_and(|e| e == "hyped");
        self.0.keys().filter(is_program).cloned().collect()
    }

    fn files(&self, folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
        let is_of = |path: &&PathBuf| path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending));
        self.0.keys().filter(|path| path.starts_with(folder)).filter(is_of).cloned().collect()
    }
}

/// An editor.
pub struct Client {
    connection: Connection,
    server: Option<JoinHandle<bool>>,
    requests: i32,
    version: i32,
    /// What the server offered.
    pub capabilities: Value,
    /// What is shown, by document.
    pub shown: BTreeMap<String, Value>,
    /// All findings that came, in order, by document.
    pub published: Vec<(String, Value)>,
    /// All messages that came: how, and what they say.
    pub messages: Vec<(String, String)>,
    /// All verdicts that came, in order: the parameters of `hypedc/verdicts`.
    pub verdicts: Vec<Value>,
    /// The requests of the server that came.
    pub asked: Vec<String>,
    /// The progress that was told, in order.
    pub progress: Vec<Value>,
}

impl Client {
    /// An editor with a folder, whose server has a disk of its own.
    pub fn start(files: &[(&str, &str)], capabilities: Value) -> Self {
        let disk = Memory(files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_string())).collect());
        Client::start_on(Arc::new(disk), capabilities)
    }

    /// An editor whose server reads a given disk.
    pub fn start_on(disk: Arc<dyn Workspace>, capabilities: Value) -> Self {
        Client::start_with(disk, capabilities, Value::Null, Settings::default())
    }

    /// An editor with options of its own, whose server does not wait before it analyses.
    pub fn start_with(disk: Arc<dyn Workspace>, capabilities: Value, options: Value, settings: Settings) -> Self {
        Client::start_patient(disk, capabilities, options, Settings { debounce: Duration::ZERO, ..settings })
    }

    /// An editor whose server waits before it analyses, as its settings say.
    pub fn start_patient(disk: Arc<dyn Workspace>, capabilities: Value, options: Value, settings: Settings) -> Self {
        let ([to_server, to_client], report) = ([(); 2].map(|()| pipe().unwrap()), |_: &str| {});
        // Both ends read and write as the server does; their threads end with the streams.
        let (ours, _) = Transport::start(BufReader::new(to_client.0), to_server.1, report);
        let (theirs, _) = Transport::start(BufReader::new(to_server.0), to_client.1, report);
        let server = std::thread::spawn(move || Server::serve(theirs, disk, settings));
        let mut client = Client {
            connection: ours,
            server: Some(server),
            requests: 0,
            version: 0,
            capabilities: Value::Null,
            shown: BTreeMap::new(),
            published: Vec::new(),
            messages: Vec::new(),
            verdicts: Vec::new(),
            asked: Vec::new(),
            progress: Vec::new(),
        };
        let folders = json!([{ "uri": "file:///game", "name": "game" }]);
        let params = json!({
            "processId": null, "rootUri": null, "capabilities": capabilities, "workspaceFolders": folders,
            "initializationOptions": options,
        });
        client.capabilities = client.request("initialize", params).unwrap();
        client.notify("initialized", json!({}));
        client
    }

    /// Tells the server something.
    pub fn notify(&mut self, method: &str, params: Value) {
        let message = Notification { method: method.into(), params };
        self.connection.sender.send(message.into()).unwrap();
    }

    /// Sends a request without waiting for its answer.
    pub fn send(&mut self, method: &str, params: Value) -> RequestId {
        self.requests += 1;
        let id = RequestId::from(self.requests);
        let message = Request { id: id.clone(), method: method.into(), params };
        self.connection.sender.send(message.into()).unwrap();
        id
    }

    /// The next message of the server, if one comes in time.
    pub fn receive(&self, timeout: Duration) -> Option<Message> {
        self.connection.receiver.recv_timeout(timeout).ok()
    }

    /// The version of the document that changed last.
    pub fn version(&self) -> i32 {
        self.version
    }

    /// Waits until findings come for the newest state of a document.
    pub fn published(&mut self, uri: &str) {
        loop {
            let message = self.connection.receiver.recv_timeout(Duration::from_secs(120)).unwrap();
            if let Message::Notification(note) = message
                && note.params["uri"] == uri
                && note.params["version"] == self.version
            {
                return;
            }
        }
    }

    /// Waits for the answer to a request.
    pub fn answer(&mut self, id: &RequestId) -> Result<Value, (i32, String)> {
        loop {
            let message = self.connection.receiver.recv_timeout(Duration::from_secs(120)).unwrap();
            match message {
                Message::Response(response) if response.id == *id => {
                    return response.response_result.map_err(|error| (error.code, error.message));
                }
                Message::Notification(note) if note.method == "textDocument/publishDiagnostics" => {
                    let uri = note.params["uri"].as_str().unwrap().to_string();
                    self.published.push((uri.clone(), note.params["diagnostics"].clone()));
                    self.shown.insert(uri, note.params["diagnostics"].clone());
                }
                Message::Notification(note) if note.method == "$/progress" => self.progress.push(note.params),
                Message::Notification(note) if note.method.ends_with("Message") => {
                    self.messages.push((note.method, note.params["message"].as_str().unwrap().to_string()));
                }
                Message::Notification(note) if note.method == "hypedc/verdicts" => self.verdicts.push(note.params),
                Message::Request(request) => self.asked.push(request.method),
                _ => {}
            }
        }
    }

    /// Sends a request and waits for its answer.
    pub fn request(&mut self, method: &str, params: Value) -> Result<Value, (i32, String)> {
        let id = self.send(method, params);
        self.answer(&id)
    }

    /// Opens a document.
    pub fn open(&mut self, uri: &str, text: &str) {
        self.version += 1;
        let document = json!({ "uri": uri, "languageId": "hyped", "version": self.version, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Changes a document.
    pub fn change(&mut self, uri: &str, changes: Value) {
        self.version += 1;
        let document = json!({ "uri": uri, "version": self.version });
        self.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Closes a document.
    pub fn close(&mut self, uri: &str) {
        self.notify("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    }

    /// Waits until the server has nothing left to do.
    pub fn settle(&mut self) {
        self.request("hypedc/idle", Value::Null).unwrap();
    }

    /// Waits until all questions of the newest texts are asked.
    pub fn asked(&mut self) {
        self.request("hypedc/asked", Value::Null).unwrap();
    }

    /// The titles of the code lenses of a document, with their commands.
    pub fn lenses(&mut self, uri: &str) -> Vec<(String, Value)> {
        let lenses = self.request("textDocument/codeLens", json!({ "textDocument": { "uri": uri } })).unwrap();
        let lens = |lens: &Value| (lens["command"]["title"].as_str().unwrap().to_string(), lens["command"].clone());
        lenses.as_array().unwrap().iter().map(lens).collect()
    }

    /// Ends the server; gives whether it ended in order.
    pub fn stop(mut self) -> bool {
        self.request("shutdown", Value::Null).unwrap();
        self.notify("exit", Value::Null);
        self.server.take().unwrap().join().unwrap()
    }
}

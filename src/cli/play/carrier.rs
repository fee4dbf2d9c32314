//! Carries a session over a WebSocket: one JSON request, one JSON answer, in order. Each page has a session of its own.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tiny_http::{Header, Request as HttpRequest, Response, StatusCode};
use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use crate::studio::{Answer, Level, Request, Session, Task};

use super::super::args::PlayArgs;
use super::super::disk::Disk;
use super::super::pictures::image;
use super::files::{Seen, save};
use super::language::Language;

/// The part of an address that asks for the language service.
const FOR_LANGUAGE: &str = "&for=language";
/// Maximum size of a request, bytes: a program's text.
const MAX_REQUEST: usize = 32 << 20;

/// A request that is not for the session.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
enum FileRequest {
    /// Which files of the program have changed on the disk since the last such question?
    Watch,
    /// Writes a file.
    Save { path: String, text: String },
    /// A picture that the program names.
    Picture { path: String },
}

/// What is answered to them, where it is more than that it is done.
#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
enum FileAnswer {
    Changed {
        files: Vec<String>,
    },
    /// A picture, as an address that holds the whole file.
    Picture {
        address: String,
    },
}

/// Starts sessions.
pub(super) struct Carrier {
    root: PathBuf,
    level: Level,
    /// The numbers that are set at first.
    numbers: Vec<(String, f64)>,
}

impl Carrier {
    pub fn new(args: &PlayArgs, numbers: Vec<(String, f64)>) -> Carrier {
        let (map, legend) = (args.level.map.clone(), args.level.reading.legend.clone());
        Carrier { root: args.file.clone(), level: Level { map, legend, tile: args.level.reading.tile }, numbers }
    }

    /// Turns a request into a WebSocket, and serves it until it is closed.
    pub fn carry(self: &Arc<Self>, request: HttpRequest, key: &str) {
        let accept = derive_accept_key(key.as_bytes());
        let header = Header::from_bytes("Sec-WebSocket-Accept", accept).into_iter();
        let response = header.fold(Response::empty(StatusCode(101)), Response::with_header);
        let carrier = Arc::clone(self);
        let is_for_language = request.url().contains(FOR_LANGUAGE);
        std::thread::spawn(move || {
            let stream = request.upgrade("websocket", response);
            let config =
                WebSocketConfig::default().max_message_size(Some(MAX_REQUEST)).max_frame_size(Some(MAX_REQUEST));
            // A page that is closed is no error.
            let socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
            let mut language = Language::new();
            let _ = match is_for_language {
                true => exchange(socket, |text| language.answer(text)),
                false => carrier.serve(socket),
            };
        });
    }

    fn serve<S: Read + Write>(&self, socket: WebSocket<S>) -> Result<(), Error> {
        let spawn = |task: Task| {
            std::thread::spawn(task);
        };
        let mut session = Session::new(Box::new(Disk), self.root.clone(), self.level.clone(), Box::new(spawn));
        session.preset(self.numbers.clone());
        let mut seen = Seen::default();
        exchange(socket, |text| self.answer(&mut session, &mut seen, text))
    }

    fn answer(&self, session: &mut Session, seen: &mut Seen, text: &str) -> String {
        let answer = match serde_json::from_str(text) {
            Ok(FileRequest::Watch) => {
                let folder = self.root.parent().unwrap_or(Path::new(""));
                let mut paths = session.paths();
                paths.extend(session.pictures().iter().map(|name| folder.join(name)));
                let changed = seen.changed(&paths);
                let files = changed.iter().map(|path| path.display().to_string()).collect();
                return serde_json::to_string(&FileAnswer::Changed { files }).unwrap_or_default();
            }
            Ok(FileRequest::Save { path, text }) => match save(&self.root, &session.paths(), &path, &text) {
                Ok(()) => Answer::Done,
                Err(message) => Answer::Refused { message },
            },
            // A page gets only what the program names.
            Ok(FileRequest::Picture { path }) if session.pictures().contains(&path) => match image(&path, &self.root) {
                Ok((_, address)) => {
                    return serde_json::to_string(&FileAnswer::Picture { address }).unwrap_or_default();
                }
                Err(message) => Answer::Refused { message },
            },
            Ok(FileRequest::Picture { path }) => {
                Answer::Refused { message: format!("the program has no picture `{path}`") }
            }
            Err(_) => match serde_json::from_str::<Request>(text) {
                Ok(request) => session.answer(request),
                Err(error) => Answer::Refused { message: format!("not a request: {error}") },
            },
        };
        serde_json::to_string(&answer).unwrap_or_default()
    }
}

/// Answers each text with a text until the page closes the connection.
fn exchange<S: Read + Write>(mut socket: WebSocket<S>, mut answer: impl FnMut(&str) -> String) -> Result<(), Error> {
    loop {
        match socket.read()? {
            Message::Text(text) => socket.send(Message::text(answer(&text)))?,
            Message::Close(_) => return Ok(()),
            _ => {}
        }
    }
}

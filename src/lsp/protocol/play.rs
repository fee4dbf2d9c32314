//! Play sessions on the texts of the editor: the requests of the page of `hypedc play`, carried by the editor. Each session has
//! a thread of its own, which answers its requests in order.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use crossbeam_channel::{Sender, unbounded};
use gen_lsp_types::Uri;
use lsp_server::{ErrorCode, RequestId};
use serde::Deserialize;
use serde_json::Value;

use super::context::Failure;
use super::tasks::Told;
use super::uri::path_of;
use crate::lsp::Workspace;
use crate::lsp::buffers::Buffers;
use crate::lsp::documents::OpenDocuments;
use crate::source::{Files, ReadError};
use crate::studio::{Level, Request, Session, Task};

/// Maximum number of sessions.
const MAX_SESSIONS: usize = 32;

/// The page of a play session: built from `studio/`.
const PAGE: &str = include_str!("../../../studio/dist/play.html");

/// The parameters of `hypedc/play`.
#[derive(Debug, Deserialize)]
pub(super) struct PlayParams {
    /// The number of the session, chosen by the editor; a new one begins a session.
    session: u64,
    /// The document that is played.
    uri: String,
    /// The level of worlds that leave their map open, by its URI.
    level: Option<String>,
    #[serde(flatten)]
    ask: Ask,
}

/// What is asked.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
enum Ask {
    /// A request of the page, with an answer for it.
    Request(Request),
    /// The places of the current frame in the texts, with the edges of an instance.
    Lit(Option<u32>),
    /// The session is over.
    Close {},
}

/// The documents as they are now.
#[derive(Clone)]
struct Now {
    open: Arc<Mutex<Arc<OpenDocuments>>>,
    disk: Arc<dyn Workspace>,
}

impl Now {
    fn buffers(&self) -> Buffers {
        let open = Arc::clone(&self.open.lock().unwrap_or_else(PoisonError::into_inner));
        Buffers { open, disk: Arc::clone(&self.disk) }
    }
}

impl Files for Now {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.buffers().read(path)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.buffers().identity(path)
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        self.buffers().bad_picture(path)
    }
}

/// A session that runs.
struct Play {
    asked: Sender<(RequestId, Ask)>,
    thread: JoinHandle<()>,
}

/// All sessions.
pub(super) struct Plays {
    now: Now,
    told: Sender<Told>,
    all: BTreeMap<u64, Play>,
}

impl Plays {
    pub fn new(disk: Arc<dyn Workspace>, told: Sender<Told>) -> Self {
        Plays { now: Now { open: Arc::default(), disk }, told, all: BTreeMap::new() }
    }

    /// The documents have changed.
    pub fn update(&self, open: &Arc<OpenDocuments>) {
        *self.now.open.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(open);
    }

    /// Passes a request on to its session; the answer comes as [`Told::Done`].
    pub fn ask(&mut self, id: RequestId, params: Value) -> Result<(), Failure> {
        let PlayParams { session, uri, level, ask } = serde_json::from_value(params)
            .map_err(|error| Failure::new(ErrorCode::InvalidParams, error.to_string()))?;
        if let Ask::Close {} = ask {
            // Its thread ends by itself: nobody waits for what it may be doing.
            self.all.remove(&session);
            let _ = self.told.send(Told::Done(id, Ok(Value::Null)));
            return Ok(());
        }
        if !self.all.contains_key(&session) {
            if self.all.len() >= MAX_SESSIONS {
                return Err(Failure::new(ErrorCode::RequestFailed, "there are too many sessions: close some"));
            }
            let level = Level { map: level.map(|level| path_of(&Uri(level))), ..Level::default() };
            let play = self.begin(path_of(&Uri(uri)), level);
            self.all.insert(session, play);
        }
        let sent = self.all.get(&session).is_some_and(|play| play.asked.send((id, ask)).is_ok());
        if !sent {
            self.all.remove(&session);
            return Err(Failure::new(ErrorCode::InternalError, "the session has failed: a bug of hypedc"));
        }
        Ok(())
    }

    fn begin(&self, root: PathBuf, level: Level) -> Play {
        let (asked, requests) = unbounded::<(RequestId, Ask)>();
        let (now, told) = (self.now.clone(), self.told.clone());
        let thread = std::thread::spawn(move || {
            let spawn = |task: Task| {
                std::thread::spawn(task);
            };
            let mut session = Session::new(Box::new(now), root, level, Box::new(spawn));
            for (id, ask) in requests {
                let answer = catch_unwind(AssertUnwindSafe(|| match ask {
                    Ask::Request(request) => serde_json::to_value(session.answer(request)),
                    Ask::Lit(slot) => serde_json::to_value(session.lit(slot)),
                    Ask::Close {} => Ok(Value::Null),
                }));
                let has_failed = answer.is_err();
                let failure = |why: String| Failure::new(ErrorCode::InternalError, why);
                let answer = match answer {
                    Ok(answer) => answer.map_err(|error| failure(error.to_string())),
                    Err(_) => Err(failure("internal error in hypedc".to_string())),
                };
                if told.send(Told::Done(id, answer)).is_err() || has_failed {
                    return;
                }
            }
            // A search ends with its session.
            session.answer(Request::Stop);
        });
        Play { asked, thread }
    }

    /// The page, for the editor to show.
    pub fn page() -> Value {
        Value::String(PAGE.to_string())
    }
}

impl Drop for Plays {
    fn drop(&mut self) {
        for (_, Play { asked, thread }) in std::mem::take(&mut self.all) {
            drop(asked);
            let _ = thread.join();
        }
    }
}

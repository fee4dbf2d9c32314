//! Work that takes long, each on a thread of its own beside the server's: commands. A task tells how far it is, and ends when
//! it is cancelled: by its request, by its progress, or with the server. Few run at a time; others wait for their turn.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;

use crossbeam_channel::Sender;
use lsp_server::{ErrorCode, RequestId};
use serde_json::{Value, json};

use super::context::Failure;
use crate::lsp::Workspace;
use crate::lsp::commands::Monitor;
use crate::watch::{Progress, Watch};

/// Maximum number of tasks that run at the same time.
const MAX_RUNNING: usize = 2;
/// Progress is told in so many parts.
const PARTS: u64 = 100;

/// What a task tells the server.
pub(super) enum Told {
    /// How far it is, for the editor.
    Progress { token: Value, percentage: u64, message: String },
    /// Its result.
    Done(RequestId, Result<Value, Failure>),
}

/// What a task does.
pub(super) type Work = Box<dyn FnOnce(&TaskMonitor) -> Result<Value, Failure> + Send>;

/// The watch over a task.
pub(super) struct TaskMonitor {
    is_stopped: Arc<AtomicBool>,
    token: Option<Value>,
    told: Sender<Told>,
    disk: Arc<dyn Workspace>,
    /// The part of the work: its index and the number of all, and what it is.
    part: std::sync::Mutex<(u64, u64, String)>,
    /// The last percentage that was told.
    last: AtomicU64,
}

impl TaskMonitor {
    fn tell(&self, share: f64, detail: &str) {
        let Some(token) = &self.token else { return };
        let part = self.part.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (index, of, what) = &*part;
        let percentage = ((*index as f64 + share.clamp(0.0, 1.0)) / (*of).max(1) as f64 * PARTS as f64) as u64;
        // Never backwards, as the protocol says; a new part is told in any case.
        let before = self.last.fetch_max(percentage, Ordering::Relaxed);
        if percentage > before || detail.is_empty() {
            let message = if detail.is_empty() { what.clone() } else { format!("{what}: {detail}") };
            let percentage = percentage.max(before);
            let _ = self.told.send(Told::Progress { token: token.clone(), percentage, message });
        }
    }
}

impl Watch for TaskMonitor {
    fn stop(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    fn progress(&self, progress: Progress) {
        let share = progress.nodes as f64 / progress.budget.max(1) as f64;
        self.tell(share, &format!("{} of {} nodes", progress.nodes, progress.budget));
    }
}

impl Monitor for TaskMonitor {
    fn part(&self, index: usize, of: usize, what: &str) {
        *self.part.lock().unwrap_or_else(std::sync::PoisonError::into_inner) =
            (index as u64, of as u64, what.to_string());
        self.tell(0.0, "");
    }

    fn seconds(&self) -> f64 {
        self.disk.seconds()
    }
}

/// A task that runs or waits.
struct Task {
    id: RequestId,
    token: Option<Value>,
    is_stopped: Arc<AtomicBool>,
    /// Set until it runs.
    work: Option<(Work, TaskMonitor)>,
    thread: Option<JoinHandle<()>>,
}

/// All tasks.
pub(super) struct Tasks {
    told: Sender<Told>,
    disk: Arc<dyn Workspace>,
    all: VecDeque<Task>,
}

impl Tasks {
    pub fn new(told: Sender<Told>, disk: Arc<dyn Workspace>) -> Self {
        Tasks { told, disk, all: VecDeque::new() }
    }

    /// Begins a task for a request. With a token, its progress is told.
    pub fn begin(&mut self, id: RequestId, token: Option<Value>, work: Work) {
        let is_stopped = Arc::new(AtomicBool::new(false));
        let monitor = TaskMonitor {
            is_stopped: Arc::clone(&is_stopped),
            token: token.clone(),
            told: self.told.clone(),
            disk: Arc::clone(&self.disk),
            part: std::sync::Mutex::default(),
            last: AtomicU64::new(0),
        };
        self.all.push_back(Task { id, token, is_stopped, work: Some((work, monitor)), thread: None });
        self.start_next();
    }

    /// Runs those that wait, as far as there is room.
    fn start_next(&mut self) {
        let running = self.all.iter().filter(|task| task.thread.is_some()).count();
        for task in self.all.iter_mut().filter(|task| task.work.is_some()).take(MAX_RUNNING.saturating_sub(running)) {
            let Some((work, monitor)) = task.work.take() else { continue };
            let (id, told) = (task.id.clone(), self.told.clone());
            task.thread = Some(std::thread::spawn(move || {
                let result = catch_unwind(AssertUnwindSafe(|| work(&monitor)));
                let failed = || Failure::new(ErrorCode::InternalError, "internal error in hypedc");
                let result = match result.unwrap_or_else(|_| Err(failed())) {
                    Ok(_) if monitor.stop() => Err(cancelled()),
                    other => other,
                };
                let _ = told.send(Told::Done(id, result));
            }));
        }
    }

    /// Stops the task of a request; returns whether there is one. Its response comes when it has ended.
    pub fn cancel(&mut self, id: &RequestId) -> bool {
        self.stop(|task| task.id == *id)
    }

    /// Stops the task whose progress has a token.
    pub fn cancel_progress(&mut self, token: &Value) -> bool {
        self.stop(|task| task.token.as_ref() == Some(token))
    }

    fn stop(&mut self, is_meant: impl Fn(&Task) -> bool) -> bool {
        let Some(task) = self.all.iter_mut().find(|task| is_meant(task)) else { return false };
        task.is_stopped.store(true, Ordering::Relaxed);
        // One that has not begun is done.
        if task.work.take().is_some() {
            let _ = self.told.send(Told::Done(task.id.clone(), Err(cancelled())));
        }
        true
    }

    /// A task is done; returns the token of its progress.
    pub fn done(&mut self, id: &RequestId) -> Option<Value> {
        let at = self.all.iter().position(|task| task.id == *id)?;
        let task = self.all.remove(at)?;
        if let Some(thread) = task.thread {
            let _ = thread.join();
        }
        self.start_next();
        task.token
    }
}

impl Drop for Tasks {
    /// Ends all of them: the server has ended.
    fn drop(&mut self) {
        self.all.iter().for_each(|task| task.is_stopped.store(true, Ordering::Relaxed));
        for thread in self.all.iter_mut().filter_map(|task| task.thread.take()) {
            let _ = thread.join();
        }
    }
}

fn cancelled() -> Failure {
    Failure::new(ErrorCode::RequestCanceled, "cancelled")
}

/// The parameters of `$/progress` for the begin of a task.
pub(super) fn begun(token: &Value, title: &str) -> Value {
    let value = json!({ "kind": "begin", "title": title, "cancellable": true, "percentage": 0 });
    json!({ "token": token, "value": value })
}

/// Those of a report.
pub(super) fn reported(token: &Value, percentage: u64, message: &str) -> Value {
    let value = json!({ "kind": "report", "percentage": percentage, "message": message, "cancellable": true });
    json!({ "token": token, "value": value })
}

/// Those of its end.
pub(super) fn ended(token: &Value) -> Value {
    json!({ "token": token, "value": { "kind": "end" } })
}

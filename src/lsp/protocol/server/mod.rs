//! The server's main loop: receives messages, updates the documents, sends responses. Requests that need names wait
//! here until the worker has compiled the programs.

mod notifications;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, select, unbounded};
use gen_lsp_types as types;
use gen_lsp_types::{Notification as _, Uri};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId};
use serde::Serialize;
use serde_json::{Value, json};

use crate::lsp::Workspace;
use crate::lsp::buffers::Buffers;
use crate::lsp::documents::Documents;
use crate::lsp::protocol::background::Report;
use crate::lsp::protocol::broken;
use crate::lsp::protocol::capabilities::capabilities;
use crate::lsp::protocol::client::Client;
use crate::lsp::protocol::commands::{self, Begun};
use crate::lsp::protocol::context::{Context, Failure, response};
use crate::lsp::protocol::extensions;
use crate::lsp::protocol::findings::{Published, describe};
use crate::lsp::protocol::from_protocol::folders;
use crate::lsp::protocol::inbox::Inbox;
use crate::lsp::protocol::live::{Effects, Live};
use crate::lsp::protocol::play::Plays;
use crate::lsp::protocol::requests::{self, Needs};
use crate::lsp::protocol::tasks::{self, Tasks, Told};
use crate::lsp::protocol::tokens::SentTokens;
use crate::lsp::protocol::uri::path_of;
use crate::lsp::protocol::worker::{Event, Job, Stages, Worker};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::verdicts::ask::Budget;
use crate::lsp::verdicts::shown::Shown;
use crate::lsp::view::{ProgramState, View};

/// Options of the server.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// The time without changes after which the value analysis starts.
    pub debounce: Duration,
    /// What a search for a live verdict may use.
    pub verdict_nodes: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { debounce: Duration::from_millis(200), verdict_nodes: Budget::default().nodes }
    }
}

/// A language server.
pub struct Server {
    context: Context,
    sender: Sender<Message>,
    published: Published,
    folders: Arc<Vec<PathBuf>>,
    jobs: Sender<Job>,
    /// The number of the newest job.
    revision: u64,
    /// The revision as of which all open programs are compiled.
    open_compiled: Option<u64>,
    /// The revision as of which all programs of the workspace are compiled.
    all_compiled: Option<u64>,
    /// The revision as of which the worker was idle.
    idle: Option<u64>,
    /// The files that changed since the last job.
    changed: BTreeSet<PathBuf>,
    has_unsent_changes: bool,
    /// Whether the folders must be searched for programs again.
    rescan: bool,
    /// Requests whose preconditions do not hold yet.
    waiting: Vec<(Request, Needs)>,
    has_shut_down: bool,
    /// The id of the last request to the client.
    last_request: i32,
    /// Commands that run.
    tasks: Tasks,
    /// Play sessions.
    plays: Plays,
    /// The programs with a reported panic, until they are compiled again.
    failed: BTreeSet<PathBuf>,
    /// Snapshots that are replaced, until what replaces them is published: they are large.
    replaced: Vec<Arc<Snapshot>>,
    live: Live,
}

impl Server {
    /// Serves a connection until the client sends `exit` or disconnects. Returns whether it sent `shutdown` before.
    pub fn serve(connection: Connection, disk: Arc<dyn Workspace>, settings: Settings) -> bool {
        let Connection { sender, receiver } = connection;
        let connection = Connection { sender: sender.clone(), receiver: receiver.clone() };
        let Ok((id, params)) = connection.initialize_start() else { return false };
        let client = Client::from_params(&params);
        let folders = folders(&params);
        let result = types::InitializeResult {
            capabilities: capabilities(&client),
            server_info: Some(types::ServerInfo {
                name: "hypedc".into(),
                version: Some(env!("CARGO_PKG_VERSION").into()),
            }),
        };
        let (jobs, job_receiver) = unbounded();
        let (event_sender, events) = unbounded();
        let (told_sender, told) = unbounded();
        let has_ended = Arc::new(AtomicBool::new(false));
        let worker_has_ended = Arc::clone(&has_ended);
        let worker = Worker {
            has_ended: worker_has_ended,
            jobs: job_receiver,
            events: event_sender,
            disk: Arc::clone(&disk),
            stages: Stages::ALL,
            debounce: settings.debounce,
        };
        let thread = std::thread::spawn(move || worker.run());
        let budget = Budget { nodes: settings.verdict_nodes, ..Budget::default() };
        let (live, background, reports) =
            Live::new(client.wants_verdicts, budget, Arc::clone(&disk), Arc::clone(&has_ended));
        let background_thread = std::thread::spawn(move || background.run());
        let mut server = Server {
            context: Context {
                client,
                view: View {
                    documents: Documents::default(),
                    programs: BTreeMap::new(),
                    last_rename: None,
                    disk: Arc::clone(&disk),
                },
                tokens: SentTokens::default(),
                verdicts: Shown::default(),
                painted: Vec::new(),
            },
            sender,
            published: Published::default(),
            folders: Arc::new(folders),
            jobs,
            revision: 0,
            open_compiled: None,
            all_compiled: None,
            idle: None,
            changed: BTreeSet::new(),
            has_unsent_changes: true,
            rescan: true,
            waiting: Vec::new(),
            has_shut_down: false,
            last_request: 0,
            tasks: Tasks::new(told_sender.clone(), Arc::clone(&disk)),
            plays: Plays::new(Arc::clone(&disk), told_sender),
            failed: BTreeSet::new(),
            replaced: Vec::new(),
            live,
        };
        server.respond(id, Ok(result));
        let was_shut_down = server.run(&receiver, (&events, &told, &reports));
        has_ended.store(true, Ordering::Relaxed);
        drop(server);
        drop((events, reports));
        let _ = thread.join();
        let _ = background_thread.join();
        was_shut_down
    }

    fn run(
        &mut self,
        messages: &Receiver<Message>,
        (events, told, reports): (&Receiver<Event>, &Receiver<Told>, &Receiver<Report>),
    ) -> bool {
        loop {
            self.submit_job();
            select! {
                recv(messages) -> message => {
                    let Ok(message) = message else { return self.has_shut_down };
                    // All waiting messages make one job.
                    let Inbox { messages, given_up } = Inbox::of(message, messages);
                    given_up.into_iter().for_each(|(id, failure)| self.respond::<()>(id, Err(failure)));
                    let is_change = |message: &Message| match message {
                        Message::Notification(notification) => !notification.method.starts_with("$/"),
                        _ => false,
                    };
                    let changed = messages.iter().rposition(is_change).map_or(0, |at| at + 1);
                    for (at, message) in messages.into_iter().enumerate() {
                        // The worker compiles while requests are answered.
                        if at == changed {
                            self.submit_job();
                        }
                        if !self.message(message) {
                            return self.has_shut_down;
                        }
                        // Findings do not wait behind all requests of a key.
                        events.try_iter().for_each(|event| self.event(event));
                    }
                }
                recv(events) -> event => {
                    let Ok(event) = event else { return false };
                    // One at a time, they would wait behind the messages of one who types.
                    let count = events.len();
                    std::iter::once(event).chain(events.try_iter().take(count)).for_each(|event| self.event(event));
                }
                recv(reports) -> report => {
                    let Ok(report) = report else { return false };
                    self.report(report);
                }
                recv(told) -> told => {
                    let Ok(told) = told else { return false };
                    self.told(told);
                }
            }
        }
    }

    /// Sends the documents to the worker if they changed.
    fn submit_job(&mut self) {
        if !std::mem::take(&mut self.has_unsent_changes) {
            return;
        }
        self.revision += 1;
        self.context.painted.clear();
        self.live.changed(self.revision);
        let outdated = self.context.verdicts.changed(&self.changed);
        self.outdate(&outdated);
        self.plays.update(self.context.view.documents.all());
        let job = Job {
            revision: self.revision,
            open: Arc::clone(self.context.view.documents.all()),
            folders: Arc::clone(&self.folders),
            rescan: std::mem::take(&mut self.rescan),
            changed: std::mem::take(&mut self.changed),
        };
        let _ = self.jobs.send(job);
    }

    fn mark_changed(&mut self, path: PathBuf) {
        self.changed.insert(path);
        self.has_unsent_changes = true;
    }

    /// Compiles the open programs again that depend on files that are not open: nobody tells when such files change.
    fn read_again(&mut self) {
        let View { documents, programs, .. } = &self.context.view;
        let open = programs.values().filter(|state| documents.get(&state.current.root).is_some());
        let verdicts = &self.context.verdicts;
        let files =
            open.flat_map(|state| state.current.dependencies.iter().chain(verdicts.dependencies(&state.current.root)));
        let unseen: Vec<PathBuf> = files.filter(|path| documents.get(path).is_none()).cloned().collect();
        unseen.into_iter().for_each(|path| self.mark_changed(path));
    }

    /// Handles a message; returns false after `exit`.
    fn message(&mut self, message: Message) -> bool {
        match message {
            Message::Request(request) => self.request(request),
            Message::Notification(notification) if notification.method == "exit" => return false,
            Message::Notification(notification) => self.notification(notification),
            Message::Response(_) => {}
        }
        true
    }

    fn request(&mut self, request: Request) {
        if request.method == "shutdown" {
            self.has_shut_down = true;
            return self.respond(request.id, Ok(()));
        }
        if self.has_shut_down || request.method == "initialize" {
            let failure = Failure::new(ErrorCode::InvalidRequest, "the server has shut down or is already initialized");
            return self.respond::<()>(request.id, Err(failure));
        }
        if commands::is_task(&request.method) {
            return self.begin(request);
        }
        if request.method == "hypedc/play" {
            self.plays.update(self.context.view.documents.all());
            let asked = self.plays.ask(request.id.clone(), request.params);
            return if let Err(failure) = asked {
                self.respond::<()>(request.id, Err(failure))
            };
        }
        let needs = requests::needs(&request.method);
        if self.is_ready(needs) { self.dispatch(request) } else { self.waiting.push((request, needs)) }
    }

    /// Begins the task of a request, on the texts as they are now.
    fn begin(&mut self, request: Request) {
        let view = &self.context.view;
        let buffers = Buffers { open: Arc::clone(view.documents.all()), disk: Arc::clone(&view.disk) };
        let Begun { title, token, work } = match commands::task(&request, buffers, &self.context.verdicts) {
            Ok(begun) => begun,
            Err(failure) => return self.respond::<()>(request.id, Err(failure)),
        };
        let token = token.or_else(|| {
            self.context.client.shows_progress.then(|| {
                let token = json!(format!("hypedc {}", self.last_request + 1));
                self.send_request("window/workDoneProgress/create", json!({ "token": token }));
                token
            })
        });
        if let Some(token) = &token {
            self.notify("$/progress", tasks::begun(token, &title));
        }
        self.tasks.begin(request.id, token, work);
    }

    /// A task is on its way, or done.
    fn told(&mut self, told: Told) {
        match told {
            Told::Progress { token, percentage, message } => {
                self.notify("$/progress", tasks::reported(&token, percentage, &message));
            }
            Told::Done(id, result) => {
                if let Some(token) = self.tasks.done(&id) {
                    self.notify("$/progress", tasks::ended(&token));
                }
                self.respond(id, result);
            }
        }
    }

    fn notify(&self, method: &str, params: Value) {
        let _ = self.sender.send(Notification { method: method.into(), params }.into());
    }

    fn is_ready(&self, needs: Needs) -> bool {
        let current = |done: Option<u64>| !self.has_unsent_changes && done == Some(self.revision);
        match needs {
            Needs::Text => true,
            Needs::Open => current(self.open_compiled),
            Needs::All => current(self.all_compiled),
            Needs::Idle => current(self.idle),
            Needs::Asked => current(self.idle) && self.live.is_asked(self.revision),
        }
    }

    /// Handles the waiting requests whose preconditions hold now.
    fn resume(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        for (request, needs) in waiting {
            if self.is_ready(needs) { self.dispatch(request) } else { self.waiting.push((request, needs)) }
        }
    }

    fn event(&mut self, event: Event) {
        match event {
            Event::Compiled(snapshot) => {
                self.failed.remove(&snapshot.root);
                let before = self.context.view.programs.remove(&snapshot.root);
                let is_shown = self.is_shown(&snapshot.root);
                let old = before.as_ref().map(|state| &*state.current);
                self.published.compiled(old, &snapshot, is_shown, self.context.client.encoding);
                self.replaced.extend(before.as_ref().map(|state| Arc::clone(&state.current)));
                let (last_good, ranges) = before.map_or((None, None), |state| (state.last_good, state.ranges));
                let last_good = if snapshot.is_error_free() { Some(Arc::clone(&snapshot)) } else { last_good };
                let state = ProgramState { current: Arc::clone(&snapshot), last_good, findings: None, ranges };
                self.context.view.programs.insert(snapshot.root.clone(), state);
            }
            Event::Failed(path, why) => {
                let text = format!(
                    "hypedc failed on {}: {why}. This is a bug of hypedc: please report it with the text. The findings \
                     shown for the file are from before",
                    path.display()
                );
                self.show_error("window/logMessage", &text);
                // Only once, not after each keystroke.
                if self.failed.insert(path) {
                    self.show_error("window/showMessage", &text);
                }
            }
            Event::Removed(path) => {
                self.context.view.programs.remove(&path);
                self.published.removed(&path);
            }
            Event::OpenCompiled(revision) => {
                self.open_compiled = Some(revision);
                self.publish();
                self.resume();
                self.replaced.clear();
            }
            Event::AllCompiled(revision) => {
                self.all_compiled = Some(revision);
                if self.context.client.reports_closed {
                    self.publish();
                }
                self.resume();
                self.replaced.clear();
            }
            Event::Idle(revision) => {
                self.idle = Some(revision);
                self.ask();
                self.resume();
                if self.context.view.documents.dropped_much() {
                    self.context.view.disk.release_memory();
                }
            }
            Event::Analyzed(snapshot, found) => {
                let programs = &mut self.context.view.programs;
                let state = programs.get_mut(&snapshot.root).filter(|state| Arc::ptr_eq(&state.current, &snapshot));
                let Some(state) = state else { return };
                let (findings, ranges) = *found;
                self.published.analyzed(&snapshot, &findings, self.context.client.encoding);
                state.findings = Some(findings);
                // A program with errors is not analysed: keep the older ranges.
                state.ranges = ranges.or(state.ranges.take());
                self.publish();
                if self.context.client.refreshes_hints {
                    self.send_request("workspace/inlayHint/refresh", Value::Null);
                }
            }
        }
    }

    /// Asks the questions of the open programs, once all findings about them are known.
    fn ask(&mut self) {
        let Server { context, live, .. } = self;
        if !self.has_unsent_changes && self.idle == Some(self.revision) {
            live.ask(context, self.revision);
            let open: BTreeSet<PathBuf> = context.view.documents.all().keys().cloned().collect();
            self.forget_verdicts(|path| open.contains(path));
        }
    }

    /// Forgets the verdicts of programs that are no longer shown.
    fn forget_verdicts(&mut self, is_kept: impl Fn(&Path) -> bool) {
        let gone = self.context.verdicts.retain(is_kept);
        self.outdate(&gone);
    }

    /// The verdicts on some programs are out of date: what they find is withdrawn.
    fn outdate(&mut self, roots: &[PathBuf]) {
        for root in roots {
            self.published.asked(root, BTreeMap::new());
            self.show_verdicts(root);
        }
        if !roots.is_empty() {
            self.publish();
        }
    }

    /// Takes a report of the background thread.
    fn report(&mut self, report: Report) {
        let (effects, response) = self.live.report(&mut self.context, report, self.revision);
        let Effects { shown, failed, asks_again } = effects;
        for root in &shown {
            self.show_verdicts(root);
            let program = self.context.verdicts.program(root);
            let found = program.map(|program| broken::findings(root, program, self.context.client.encoding));
            self.published.asked(root, found.unwrap_or_default());
        }
        if !shown.is_empty() {
            self.publish();
            if self.context.client.refreshes_lenses {
                self.send_request("workspace/codeLens/refresh", Value::Null);
            }
        }
        if let Some(response) = response {
            let _ = self.sender.send(response.into());
        }
        if let Some((path, why)) = failed {
            self.event(Event::Failed(path, why));
        }
        if asks_again {
            self.ask();
        }
        self.resume();
    }

    /// Tells the editor the verdicts of a program, for clients that show them in their own way.
    fn show_verdicts(&self, root: &Path) {
        let Some(program) = self.context.verdicts.program(root) else { return };
        let params = extensions::verdicts(root, program, self.context.client.encoding);
        let _ = self.sender.send(Notification { method: "hypedc/verdicts".into(), params }.into());
    }

    /// Sends an error message to the editor: to its log, or as a pop-up.
    fn show_error(&self, method: &str, text: &str) {
        let params = json!({ "type": types::MessageType::Error, "message": text });
        self.notify(method, params);
    }

    /// Whether the findings of a program are shown: it is open, or the client asks for those of the whole workspace.
    fn is_shown(&self, root: &Path) -> bool {
        self.context.client.reports_closed || self.context.view.documents.get(root).is_some()
    }

    /// Publishes the diagnostics of documents for which they changed.
    fn publish(&mut self) {
        let (client, documents) = (&self.context.client, &self.context.view.documents);
        let is_open = |path: &Path| client.reports_closed || documents.get(path).is_some();
        let version = |uri: &str| {
            let path = path_of(&Uri(uri.into()));
            let snapshot = &self.context.view.programs.get(&path)?.current;
            snapshot.file(&path)?;
            Some(snapshot.document(&path)?.version)
        };
        for mut params in self.published.update(is_open, version) {
            params.diagnostics.iter_mut().for_each(|finding| describe(finding, client));
            let params = serde_json::to_value(params).unwrap_or_default();
            let method = String::from(types::PublishDiagnosticsNotification::METHOD);
            let _ = self.sender.send(Notification { method, params }.into());
        }
    }

    /// Sends a request to the client; its response is ignored.
    fn send_request(&mut self, method: &str, params: Value) {
        self.last_request += 1;
        let request = Request { id: RequestId::from(self.last_request), method: method.into(), params };
        let _ = self.sender.send(request.into());
    }

    fn respond<T: Serialize>(&self, id: RequestId, result: Result<T, Failure>) {
        let _ = self.sender.send(response(id, result).into());
    }

    /// Sends the response of the handler of a request.
    fn dispatch(&mut self, request: Request) {
        let request = match self.live.take(&self.context, self.revision, request) {
            Ok(response) => return response.into_iter().for_each(|response| drop(self.sender.send(response.into()))),
            Err(request) => request,
        };
        let response = requests::dispatch(&mut self.context, request);
        let _ = self.sender.send(response.into());
    }
}

//! Live verdicts and errands, on the server's side: what is given to the background thread, what of its reports is
//! still true, and what the editor is told. Only cheap work: the server's thread answers requests.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crossbeam_channel::{Receiver, Sender, unbounded};
use gen_lsp_types::Uri;
use lsp_server::{ErrorCode, Request, RequestId, Response};
use serde_json::Value;

use super::background::{Background, Brought, Errand, Job, Report, Task, What};
use super::context::{Context, Failure, PaintedWorld, response};
use super::extensions::{self, ChooseLevelParams, WayToParams, WorldParams};
use super::painting;
use super::uri::path_of;
use crate::lsp::Workspace;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::verdicts::ask::Budget;
use crate::lsp::verdicts::level::ChosenLevel;
use crate::lsp::verdicts::paint::TilePlace;

/// The methods that the background thread answers.
const ERRANDS: [&str; 4] = ["hypedc/levels", "hypedc/chooseLevel", "hypedc/paint", "hypedc/wayTo"];

/// The background thread as the server sees it.
pub(super) struct Live {
    /// Whether verdicts are asked for.
    pub is_on: bool,
    tasks: Sender<Task>,
    newest: Arc<AtomicU64>,
    /// The errands that are not answered.
    errands: BTreeMap<RequestId, PendingErrand>,
    /// The revision as of which all questions are asked.
    asked: Option<u64>,
}

struct PendingErrand {
    is_cancelled: Arc<AtomicBool>,
    root: PathBuf,
    /// The world of a request for levels.
    world: String,
    /// The documents that it is about.
    revision: u64,
}

/// What a report changes.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Effects {
    /// The programs with other verdicts.
    pub shown: BTreeSet<PathBuf>,
    /// A panic, and the program that it is about.
    pub failed: Option<(PathBuf, String)>,
    /// Whether the questions must be asked again.
    pub asks_again: bool,
}

impl Live {
    /// Starts with a thread that is not run yet.
    pub fn new(
        is_on: bool,
        budget: Budget,
        disk: Arc<dyn Workspace>,
        has_ended: Arc<AtomicBool>,
    ) -> (Live, Background, Receiver<Report>) {
        let (tasks, task_receiver) = unbounded();
        let (reports, report_receiver) = unbounded();
        let newest = Arc::new(AtomicU64::new(0));
        let background =
            Background { tasks: task_receiver, reports, disk, budget, newest: Arc::clone(&newest), has_ended };
        (Live { is_on, tasks, newest, errands: BTreeMap::new(), asked: None }, background, report_receiver)
    }

    /// The documents have changed: work about older ones is stopped.
    pub fn changed(&self, revision: u64) {
        self.newest.store(revision, Ordering::Relaxed);
    }

    /// Whether all questions are asked as of a revision.
    pub fn is_asked(&self, revision: u64) -> bool {
        !self.is_on || self.asked == Some(revision)
    }

    /// Asks the questions of all open programs without errors.
    pub fn ask(&mut self, context: &Context, revision: u64) {
        self.asked = None;
        let view = &context.view;
        let open = view.programs.values().map(|state| &state.current);
        let open = open.filter(|of| view.documents.get(&of.root).is_some() && of.is_error_free());
        let (programs, open) = (open.cloned().collect(), Arc::clone(view.documents.all()));
        let _ = self.tasks.send(Task::Ask { job: Job { revision, programs, open }, only_recalls: !self.is_on });
    }

    /// Takes a request that the background thread answers. Returns a response if it is answered at once; `Err` gives
    /// back a request that is for others.
    pub fn take(&mut self, context: &Context, revision: u64, request: Request) -> Result<Option<Response>, Request> {
        if !ERRANDS.contains(&request.method.as_str()) {
            return Err(request);
        }
        let Request { id, method, params } = request;
        let errand = errand(context, &method, params);
        let (snapshot, what, world) = match errand {
            Ok(errand) => errand,
            Err(failure) => return Ok(Some(response::<()>(id, Err(failure)))),
        };
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let pending =
            PendingErrand { is_cancelled: Arc::clone(&is_cancelled), root: snapshot.root.clone(), world, revision };
        self.errands.insert(id.clone(), pending);
        let open = Arc::clone(context.view.documents.all());
        let _ = self.tasks.send(Task::Errand(Box::new(Errand { id, snapshot, open, revision, is_cancelled, what })));
        Ok(None)
    }

    /// Cancels a request; returns whether the thread was to answer it.
    pub fn cancel(&mut self, id: &RequestId) -> bool {
        let errand = self.errands.remove(id);
        errand.inspect(|errand| errand.is_cancelled.store(true, Ordering::Relaxed)).is_some()
    }

    /// Takes a report: what is still true goes to the context. Returns what has changed, and the response to an errand.
    pub fn report(&mut self, context: &mut Context, report: Report, revision: u64) -> (Effects, Option<Response>) {
        let mut effects = Effects::default();
        match report {
            Report::Recalled(root, levels, last) => {
                if context.view.documents.get(&root).is_some() {
                    context.verdicts.chosen(&root, levels);
                    if self.is_on {
                        context.verdicts.recalled(&root, last);
                    }
                    effects.shown.insert(root);
                }
            }
            Report::Levels(root, levels) => {
                context.painted.retain(|of| of.root != root);
                context.verdicts.chosen(&root, levels);
                effects.shown.insert(root);
                effects.asks_again = true;
            }
            Report::Asked { revision: of, snapshot, read, asked } => {
                if self.is_on && is_true(context, &snapshot, (of, revision)) {
                    effects.shown.insert(snapshot.root.clone());
                    context.verdicts.asked(&snapshot, &read, asked);
                }
            }
            Report::Misfit { revision: of, snapshot, read, world, why } => {
                if self.is_on && is_true(context, &snapshot, (of, revision)) {
                    effects.shown.insert(snapshot.root.clone());
                    context.verdicts.misfit(&snapshot, read, world, why);
                }
            }
            Report::AllAsked(of) => {
                if of == revision {
                    self.asked = Some(of);
                    let Context { view, verdicts, .. } = context;
                    effects.shown =
                        verdicts.finished(|root| view.programs.get(root).is_some_and(|of| of.current.is_error_free()));
                }
            }
            Report::Brought(id, brought) => {
                let Some(errand) = self.errands.remove(&id) else { return (effects, None) };
                return (effects, Some(answer(context, id, (&errand, revision), brought)));
            }
            Report::Failed(root, why) => effects.failed = Some((root, why)),
        }
        (effects, None)
    }
}

/// Whether a report about a snapshot is about the text as it is now.
fn is_true(context: &Context, snapshot: &Arc<Snapshot>, (of, newest): (u64, u64)) -> bool {
    let current = context.view.programs.get(&snapshot.root);
    let is_open = context.view.documents.get(&snapshot.root).is_some();
    of == newest && is_open && current.is_some_and(|state| Arc::ptr_eq(&state.current, snapshot))
}

/// The program, the work and the world of a request.
fn errand(context: &Context, method: &str, params: Value) -> Result<(Arc<Snapshot>, What, String), Failure> {
    fn read<T: serde::de::DeserializeOwned>(params: Value) -> Result<T, Failure> {
        serde_json::from_value(params).map_err(|error| Failure::new(ErrorCode::InvalidParams, error.to_string()))
    }
    let snapshot = |uri: &Uri| {
        let state = context.view.programs.get(&path_of(uri));
        let snapshot = state.map(|state| Arc::clone(&state.current));
        snapshot.ok_or_else(|| Failure::new(ErrorCode::RequestFailed, "this is no program of the workspace"))
    };
    if method == "hypedc/chooseLevel" {
        let ChooseLevelParams { text_document, world, level } = read(params)?;
        let level = level.map(|level| ChosenLevel {
            map: extensions::level_path(&level.map),
            legend: level.legend.as_ref().map(|legend| extensions::level_path(legend)),
            tile: level.tile,
        });
        return Ok((snapshot(&text_document.uri)?, What::Choose { world: world.clone(), level }, world));
    }
    if method == "hypedc/wayTo" {
        let WayToParams { text_document, world, space, column, row } = read(params)?;
        let what = What::WayTo { world: world.clone(), place: TilePlace { space, column, row } };
        return Ok((snapshot(&text_document.uri)?, what, world));
    }
    let WorldParams { text_document, world, all } = read(params)?;
    let name = world.clone();
    let what = if method == "hypedc/paint" { What::Paint { world } } else { What::Levels { world, all } };
    Ok((snapshot(&text_document.uri)?, what, name))
}

/// The response to an errand.
fn answer(context: &mut Context, id: RequestId, (errand, newest): (&PendingErrand, u64), brought: Brought) -> Response {
    match brought {
        Brought::Levels(is_open, found) => {
            response(id, Ok(extensions::levels(&context.verdicts, (&errand.root, &errand.world), is_open, found)))
        }
        Brought::Painted(painted) => {
            let shown = painting::painted(&context.view, context.client.encoding, &errand.world, &painted);
            context.painted.retain(|of| of.root != errand.root || of.world != errand.world);
            let (root, world) = (errand.root.clone(), errand.world.clone());
            if errand.revision == newest {
                context.painted.push(PaintedWorld { root, world, painted });
            }
            response(id, Ok(shown))
        }
        Brought::WayTo(verdict) => {
            let level = context.verdicts.level(&errand.root, Some(&errand.world));
            response(id, Ok(painting::way_to(&verdict, level)))
        }
        Brought::Refused(why) => response::<()>(id, Err(Failure::new(ErrorCode::RequestFailed, why))),
        Brought::Outdated => {
            response::<()>(id, Err(Failure::new(ErrorCode::ContentModified, "the documents have changed")))
        }
        Brought::Nothing => response(id, Ok(())),
        Brought::Stopped => response::<()>(id, Err(Failure::new(ErrorCode::RequestFailed, "it was stopped"))),
    }
}

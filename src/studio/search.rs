//! A search that runs beside the play: prove, search, replay, as `hypedc reach` does it, from the frame that was shown
//! when it began.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::ir::{Program, WorldId};
use crate::reach::query::{Found, Phase, Query, QueryError, Session as Reach, Supervisor};
use crate::reach::{Conclusion, Limits, Settings, Target, Verdict};
use crate::sim::Script;
use crate::source::SourceMap;
use crate::watch::{Progress, Watch};

use super::history::paths_of;
use super::protocol::Searching;

/// Maximum number of positions of nodes that wait for the next answer.
const MAX_POINTS: usize = 20_000;

/// Work for another thread, or for the same one where there are no threads.
pub type Task = Box<dyn FnOnce() + Send>;
/// Takes how far a search is, while it runs.
pub type Listener = Box<dyn Fn(Searching) + Send + Sync>;

/// A search that runs or has ended.
pub(super) struct Search {
    shared: Arc<Shared>,
}

/// The question of a search.
pub(super) struct Question {
    pub program: Arc<Program>,
    pub sources: SourceMap,
    pub world: WorldId,
    pub target: Target,
    /// The inputs up to the frame from which it starts.
    pub after: Script,
    pub nodes: u64,
    pub seed: u64,
}

/// What the searching thread and the session share.
struct Shared {
    is_stopped: AtomicBool,
    progress: Mutex<Progress>,
    /// The positions of new nodes since the last answer.
    points: Mutex<Vec<[f64; 5]>>,
    /// The result.
    result: Mutex<Option<Searching>>,
    budget: u64,
    /// Told of all progress: where a search blocks the session, nobody polls it.
    listener: Option<Arc<Listener>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Watch for Shared {
    fn stop(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    fn progress(&self, progress: Progress) {
        *lock(&self.progress) = progress;
        if let Some(listener) = &self.listener {
            let points = std::mem::take(&mut *lock(&self.points));
            listener(Searching { is_running: true, points, ..of_progress(progress, self.budget) });
        }
    }

    fn node(&self, space: usize, at: [f32; 2], before: Option<[f32; 2]>) {
        let mut points = lock(&self.points);
        if points.len() < MAX_POINTS {
            let ([x, y], [from_x, from_y]) = (at.map(f64::from), before.unwrap_or(at).map(f64::from));
            points.push([space as f64, x, y, from_x, from_y]);
        }
    }
}

/// One watch for all phases.
struct Watched<'s>(&'s Shared);

impl Supervisor for Watched<'_> {
    fn supervise(&mut self, _: Phase, work: &mut dyn FnMut(&dyn Watch)) -> ControlFlow<()> {
        work(self.0);
        ControlFlow::Continue(())
    }
}

impl Search {
    /// Starts a search.
    pub fn start(question: Question, spawn: &dyn Fn(Task), listener: Option<Arc<Listener>>) -> Search {
        let shared = Arc::new(Shared {
            is_stopped: AtomicBool::new(false),
            progress: Mutex::default(),
            points: Mutex::default(),
            result: Mutex::default(),
            budget: question.nodes,
            listener,
        });
        let of_thread = Arc::clone(&shared);
        spawn(Box::new(move || {
            let result = question.answer(&of_thread);
            *lock(&of_thread.result) = Some(result);
        }));
        Search { shared }
    }

    /// How far it is.
    pub fn poll(&self) -> Searching {
        let result = lock(&self.shared.result);
        let points = std::mem::take(&mut *lock(&self.shared.points));
        if let Some(ended) = &*result {
            return Searching { points, ..ended.clone() };
        }
        let progress = *lock(&self.shared.progress);
        Searching { is_running: true, points, ..of_progress(progress, self.shared.budget) }
    }

    /// Asks it to end with what it has.
    pub fn stop(&self) {
        self.shared.is_stopped.store(true, Ordering::Relaxed);
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        self.stop();
    }
}

fn of_progress(progress: Progress, budget: u64) -> Searching {
    Searching {
        is_running: false,
        nodes: progress.nodes,
        budget,
        places: progress.places,
        points: Vec::new(),
        verdict: None,
        conclusion: None,
        script: None,
        ghost: Vec::new(),
    }
}

impl Question {
    fn answer(self, shared: &Shared) -> Searching {
        let Question { program, sources, world, target, after, nodes, seed } = self;
        let steps = after.len();
        let has_draws = program.entities.iter().any(|entity| !entity.chances.is_empty());
        let query = Query {
            settings: Settings { seed, records: true, ..Settings::default() },
            limits: Limits { nodes, ..Limits::default() },
            after: if steps > 0 { vec![after] } else { Vec::new() },
            // What is played draws by seed 0.
            chance: has_draws.then_some(0),
            ..Query::new(vec![target])
        };
        let session = Reach::new(&program, world, query, shared);
        let ended = |verdict: String| Searching {
            verdict: Some(verdict),
            conclusion: Some(Conclusion::Error.name().to_string()),
            ..of_progress(*lock(&shared.progress), nodes)
        };
        let mut found = match session.find_all(&mut Watched(shared)) {
            Ok(all) => match all.into_iter().next() {
                Some(found) => found,
                None => return ended("stopped before it began".to_string()),
            },
            Err(QueryError::Fault(fault, step)) => {
                return ended(format!("the run breaks a rule of the language at step {step}: {:?}", fault.kind));
            }
            Err(QueryError::Over { .. }) => return ended("the run is over: go back to an earlier frame".to_string()),
        };
        let answer = session.answer(&mut found, &sources);
        let mut verdict = vec![answer.verdict.words().to_string()];
        if let (Some(all), Some(seconds)) = (answer.steps, answer.seconds_of_play) {
            let more = all.saturating_sub(steps);
            let per_step = seconds / all.max(1) as f64;
            verdict[0] = format!("{} in {more} steps ({:.2} s)", verdict[0], more as f64 * per_step);
        } else if shared.stop() {
            verdict.push("the search was stopped".to_string());
        }
        verdict.extend(answer.reasons.iter().chain(&answer.assumptions).cloned());
        let script = script(&found);
        Searching {
            nodes: answer.nodes,
            places: answer.coverage.places,
            verdict: Some(verdict.join("; ")),
            conclusion: Some(answer.verdict.name().to_string()),
            ghost: script.map_or(Vec::new(), |script| paths_of(&session_simulator(&program, world), script, steps)),
            script: script.map(|script| script.text(&program, world)),
            ..of_progress(*lock(&shared.progress), nodes)
        }
    }
}

fn session_simulator(program: &Arc<Program>, world: WorldId) -> Arc<crate::sim::Simulator> {
    Arc::new(crate::sim::Simulator::new(program, world))
}

/// The script that leads to the target.
fn script<'f>(found: &'f Found<'_>) -> Option<&'f Script> {
    match &found.outcome.verdict {
        Verdict::Reached(plan) => Some(&plan.script),
        Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
    }
}

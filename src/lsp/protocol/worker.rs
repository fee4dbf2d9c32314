//! The worker thread: receives the newest state of the documents, compiles the programs that a change invalidates, and
//! runs the value analysis after a debounce time. A newer state interrupts the analysis.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender};

use crate::analysis::watched_findings;
use crate::diagnostic::Diagnostics;
use crate::source::FileId;
use crate::watch::Watch;

use crate::lsp::Workspace;
use crate::lsp::documents::OpenDocuments;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::values::Ranges;

/// A state of the documents, to be compiled.
pub(in crate::lsp) struct Job {
    /// Increases with each job.
    pub revision: u64,
    /// The open documents.
    pub open: Arc<OpenDocuments>,
    /// The folders of the workspace.
    pub folders: Arc<Vec<PathBuf>>,
    /// Whether programs may have been added to the folders or removed.
    pub rescan: bool,
    /// The files that changed since the last job.
    pub changed: BTreeSet<PathBuf>,
}

/// An event of the worker.
pub(in crate::lsp) enum Event {
    /// A program was compiled.
    Compiled(Arc<Snapshot>),
    /// A program was closed or deleted.
    Removed(PathBuf),
    /// All open programs are compiled as of a revision.
    OpenCompiled(u64),
    /// All programs of the workspace are compiled as of a revision.
    AllCompiled(u64),
    /// The worker is idle as of a revision.
    Idle(u64),
    /// The compilation or the analysis of a program panicked, with a message.
    Failed(PathBuf, String),
    /// The result of the value analysis of a snapshot. Without ranges if the program has errors.
    Analyzed(Arc<Snapshot>, Box<Analyzed>),
}

/// Findings of the value analysis, and ranges of values if there is a program.
type Analyzed = (Diagnostics, Option<Ranges>);

/// What the worker runs for each program; tests of the worker run less than the compiler.
pub(in crate::lsp) struct Stages {
    pub compile: fn(&Path, &Arc<OpenDocuments>, &dyn Workspace, Option<&Snapshot>) -> Snapshot,
    /// `None` without a program, or if the watch stopped it.
    pub analyze: fn(&Snapshot, &dyn Watch) -> Option<Box<Analyzed>>,
}

impl Stages {
    /// The compiler and the value analysis.
    pub const ALL: Stages = Stages { compile: Snapshot::compile, analyze };
}

fn analyze(snapshot: &Snapshot, watch: &dyn Watch) -> Option<Box<Analyzed>> {
    let compilation = &snapshot.ide.compilation;
    let program = compilation.program.as_ref()?;
    let (sources, reported) = (&compilation.sources, &compilation.diagnostics);
    let (found, spaces) = watched_findings(program, sources, FileId(0), reported, watch)?;
    Some(Box::new((found, Some(Ranges::of(program, &spaces)))))
}

/// Interrupts the analysis when there is a newer job, or when the server has ended.
struct NewerJob<'a>(&'a Receiver<Job>, &'a AtomicBool);

impl Watch for NewerJob<'_> {
    fn stop(&self) -> bool {
        !self.0.is_empty() || self.1.load(Ordering::Relaxed)
    }
}

/// After so long without work, a thread gives the memory back that it does not need any more.
const REST: Duration = Duration::from_millis(500);

/// What a thread is to do next; `None` once the server has ended. Meanwhile its free memory goes back to the system.
pub(super) fn next_of<T>(waiting: &Receiver<T>, disk: &dyn Workspace) -> Option<T> {
    match waiting.recv_timeout(REST) {
        Err(RecvTimeoutError::Timeout) => {
            disk.release_memory();
            waiting.recv().ok()
        }
        next => next.ok(),
    }
}

pub(in crate::lsp) struct Worker {
    pub jobs: Receiver<Job>,
    pub events: Sender<Event>,
    pub disk: Arc<dyn Workspace>,
    pub stages: Stages,
    /// Set when the server has ended.
    pub has_ended: Arc<AtomicBool>,
    /// The time without changes after which the value analysis starts.
    pub debounce: Duration,
}

/// The known programs, by path.
#[derive(Default)]
struct Programs {
    current: BTreeMap<PathBuf, Arc<Snapshot>>,
    /// Compiled before a change that affects them. A job that is interrupted leaves them to the next one.
    outdated: BTreeMap<PathBuf, Arc<Snapshot>>,
    /// Open programs that are compiled but not analysed.
    unanalyzed: BTreeSet<PathBuf>,
}

impl Programs {
    /// Forgets the programs that are not wanted; returns their paths.
    fn retain(&mut self, is_wanted: impl Fn(&PathBuf) -> bool) -> Vec<PathBuf> {
        let known = self.current.keys().chain(self.outdated.keys());
        let removed: Vec<PathBuf> = known.filter(|path| !is_wanted(path)).cloned().collect();
        for path in &removed {
            self.current.remove(path);
            self.outdated.remove(path);
            self.unanalyzed.remove(path);
        }
        removed
    }

    /// Marks the programs as outdated that depend on changed files.
    fn invalidate(&mut self, changed: &BTreeSet<PathBuf>) {
        let is_current = |snapshot: &Snapshot| snapshot.dependencies.is_disjoint(changed);
        let (current, outdated): (BTreeMap<_, _>, BTreeMap<_, _>) =
            std::mem::take(&mut self.current).into_iter().partition(|(_, snapshot)| is_current(snapshot));
        self.current = current;
        self.outdated.extend(outdated);
    }
}

impl Worker {
    /// Runs until the server has ended.
    pub fn run(self) {
        let mut programs = Programs::default();
        // All programs of the workspace's folders.
        let mut in_folders: BTreeSet<PathBuf> = BTreeSet::new();
        let mut next_job: Option<Job> = None;
        while let Some(job) = next_job.take().or_else(|| next_of(&self.jobs, &*self.disk)) {
            let job = self.merge_waiting(job);
            if job.rescan {
                in_folders = job.folders.iter().flat_map(|folder| self.disk.programs(folder)).collect();
            }
            if self.compile_job(&job, &in_folders, &mut programs).is_none() {
                return;
            }
            if programs.unanalyzed.is_empty() {
                if self.events.send(Event::Idle(job.revision)).is_err() {
                    return;
                }
                continue;
            }
            match self.jobs.recv_timeout(self.debounce) {
                Ok(next) => next_job = Some(next),
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => {
                    if self.analyze(&mut programs).is_none() {
                        return;
                    }
                    if programs.unanalyzed.is_empty() && self.events.send(Event::Idle(job.revision)).is_err() {
                        return;
                    }
                }
            }
        }
    }

    /// Merges all waiting jobs into the newest one.
    fn merge_waiting(&self, mut job: Job) -> Job {
        while let Ok(mut next) = self.jobs.try_recv() {
            next.changed.append(&mut job.changed);
            next.rescan |= job.rescan;
            job = next;
        }
        job
    }

    /// Compiles the programs that a job invalidates; `None` if the server has ended.
    fn compile_job(&self, job: &Job, in_folders: &BTreeSet<PathBuf>, programs: &mut Programs) -> Option<()> {
        let is_open = |path: &PathBuf| job.open.get(path).is_some_and(|document| document.is_program);
        for path in programs.retain(|path| is_open(path) || in_folders.contains(path)) {
            self.events.send(Event::Removed(path)).ok()?;
        }
        programs.invalidate(&job.changed);
        for path in job.open.keys().filter(|path| is_open(path)) {
            if !programs.current.contains_key(path) {
                let before = programs.outdated.remove(path);
                programs.current.extend(self.compile(path, job, before)?);
                programs.unanalyzed.insert(path.clone());
            }
        }
        self.events.send(Event::OpenCompiled(job.revision)).ok()?;
        for path in in_folders.iter().filter(|path| !job.open.contains_key(*path)) {
            if programs.current.contains_key(path) {
                continue;
            }
            if !self.jobs.is_empty() {
                return Some(());
            }
            let before = programs.outdated.remove(path);
            programs.current.extend(self.compile(path, job, before)?);
        }
        self.events.send(Event::AllCompiled(job.revision)).ok()
    }

    /// Compiles a program and returns its path and snapshot. If the compiler panics, the older snapshot remains. `None`
    /// if the server has ended.
    fn compile(
        &self,
        path: &Path,
        job: &Job,
        before: Option<Arc<Snapshot>>,
    ) -> Option<Option<(PathBuf, Arc<Snapshot>)>> {
        let compile = || (self.stages.compile)(path, &job.open, &*self.disk, before.as_deref());
        let snapshot = match catch_unwind(AssertUnwindSafe(compile)) {
            Ok(snapshot) => {
                let snapshot = Arc::new(snapshot);
                self.events.send(Event::Compiled(Arc::clone(&snapshot))).ok()?;
                Some(snapshot)
            }
            Err(panic) => {
                self.events.send(Event::Failed(path.to_path_buf(), message(&*panic))).ok()?;
                before
            }
        };
        Some(snapshot.map(|snapshot| (path.to_path_buf(), snapshot)))
    }

    /// Runs the value analysis until there is a newer job; `None` if the server has ended.
    fn analyze(&self, programs: &mut Programs) -> Option<()> {
        while let Some(path) = programs.unanalyzed.first().cloned() {
            if let Some(snapshot) = programs.current.get(&path) {
                let analyze = || (self.stages.analyze)(snapshot, &NewerJob(&self.jobs, &self.has_ended));
                let found = match catch_unwind(AssertUnwindSafe(analyze)) {
                    Ok(found) => found,
                    Err(panic) => {
                        self.events.send(Event::Failed(path.clone(), message(&*panic))).ok()?;
                        None
                    }
                };
                if !self.jobs.is_empty() {
                    return Some(());
                }
                let found = found.unwrap_or_default();
                self.events.send(Event::Analyzed(Arc::clone(snapshot), found)).ok()?;
            }
            programs.unanalyzed.remove(&path);
        }
        Some(())
    }
}

/// The message of a panic.
pub(super) fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_string())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use std::sync::Mutex;

    use crossbeam_channel::unbounded;

    use super::*;
    use crate::compile::{Compilation, IdeCompilation};
    use crate::sema::checked::Checked;
    use crate::source::{Files, ReadError, SourceMap};

    /// A folder with three programs of which one is deleted while the first is read for the second time.
    struct Folder {
        reads: Mutex<u32>,
        jobs: Mutex<Option<Sender<Job>>>,
        programs: Mutex<Vec<PathBuf>>,
    }

    impl Files for Folder {
        fn read(&self, path: &Path) -> Result<String, ReadError> {
            if path.ends_with("a.hyped") {
                let mut reads = self.reads.lock().unwrap();
                *reads += 1;
                if *reads == 2 {
                    self.programs.lock().unwrap().pop();
                    let jobs = self.jobs.lock().unwrap().take().unwrap();
                    jobs.send(job(3, &[])).unwrap();
                }
            }
            Ok("entity Empty {}".to_string())
        }
    }

    impl Workspace for Folder {
        fn programs(&self, _: &Path) -> Vec<PathBuf> {
            self.programs.lock().unwrap().clone()
        }
    }

    /// Reads the file.
    fn compile(path: &Path, open: &Arc<OpenDocuments>, disk: &dyn Workspace, _: Option<&Snapshot>) -> Snapshot {
        disk.read(path).unwrap();
        let (sources, diagnostics) = (SourceMap::new(), Diagnostics::default());
        let compilation = Compilation { sources, program: None, diagnostics, tests: Vec::new() };
        let ide = IdeCompilation { compilation, checked: Checked::default(), occurrences: Vec::new() };
        Snapshot::new(path, open, ide, [path.to_path_buf()].into())
    }

    fn job(revision: u64, changed: &[PathBuf]) -> Job {
        let (open, folders) = (Arc::default(), Arc::new(vec![PathBuf::from("/folder")]));
        Job { revision, open, folders, rescan: true, changed: changed.iter().cloned().collect() }
    }

    #[test]
    fn what_an_interrupted_job_invalidates_is_still_known() {
        let files = ["a", "b", "c"].map(|name| PathBuf::from(format!("/folder/{name}.hyped")));
        let (to_worker, jobs) = unbounded();
        let (events, from_worker) = unbounded();
        to_worker.send(job(1, &[])).unwrap();
        let disk = Arc::new(Folder {
            reads: Mutex::default(),
            jobs: Mutex::new(Some(to_worker.clone())),
            programs: Mutex::new(files.to_vec()),
        });
        let has_ended = Arc::default();
        let stages = Stages { compile, analyze: |_, _| None };
        let worker = Worker { jobs, events, disk, stages, has_ended, debounce: Duration::ZERO };
        std::thread::scope(|scope| {
            scope.spawn(|| worker.run());
            let is_done = |event: &Event| matches!(event, Event::Idle(1));
            assert!(from_worker.iter().any(|event| is_done(&event)));
            to_worker.send(job(2, &files)).unwrap();
            drop(to_worker);
            let events: Vec<Event> = from_worker.iter().collect();
            let removed = |event: &Event| matches!(event, Event::Removed(path) if *path == files[2]);
            assert_eq!(events.iter().filter(|event| removed(event)).count(), 1);
            assert!(!events.iter().any(|event| matches!(event, Event::AllCompiled(2))), "it is interrupted");
            assert!(events.iter().any(|event| matches!(event, Event::AllCompiled(3))));
        });
    }
}

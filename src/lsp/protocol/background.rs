//! The thread of all work that is below everything else: live verdicts, and errands that take long. It does one thing
//! at a time. A newer state of the documents stops what is about an older one; an errand comes before verdicts.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crossbeam_channel::{Receiver, Sender};
use lsp_server::RequestId;

use crate::ir::{Program, WorldId};
use crate::json::{self, Layout};
use crate::lsp::Workspace;
use crate::lsp::buffers::Buffers;
use crate::lsp::documents::OpenDocuments;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::verdicts::ask::{Asked, Budget, Subject, ask_world};
use crate::lsp::verdicts::level::{Candidate, ChosenLevel, candidates, misfit};
use crate::lsp::verdicts::memory::Memory;
use crate::lsp::verdicts::paint::{Canvas, Painted, TilePlace};
use crate::lsp::verdicts::verdict::{Question, Verdict};
use crate::source::{FileId, SourceMap};
use crate::watch::Watch;

use super::worker::{message, next_of};

/// Work for the thread.
pub(super) enum Task {
    /// Asks the questions of the open programs without errors, as of a revision; or only recalls what is remembered of
    /// them.
    Ask { job: Job, only_recalls: bool },
    /// Answers a request.
    Errand(Box<Errand>),
}

/// The open programs without errors.
pub(super) struct Job {
    pub revision: u64,
    pub programs: Vec<Arc<Snapshot>>,
    /// All open documents.
    pub open: Arc<OpenDocuments>,
}

/// A request that takes long.
pub(super) struct Errand {
    pub id: RequestId,
    /// The program as of the request.
    pub snapshot: Arc<Snapshot>,
    /// All open documents, and their revision.
    pub open: Arc<OpenDocuments>,
    pub revision: u64,
    /// Set if the answer is no longer wanted.
    pub is_cancelled: Arc<AtomicBool>,
    pub what: What,
}

/// What a request asks for.
pub(super) enum What {
    /// The levels, and which of them fit; or only the one that was chosen.
    Levels { world: String, all: bool },
    /// What a search and the known ways saw of each tile.
    Paint { world: String },
    /// Whether a player can get to a tile.
    WayTo { world: String, place: TilePlace },
    /// Chooses a level for the open map of a world.
    Choose { world: String, level: Option<ChosenLevel> },
}

/// What an errand has found.
pub(super) enum Brought {
    /// Whether the world leaves its map open, and the files that may be levels.
    Levels(bool, Vec<Candidate>),
    Painted(Painted),
    /// The verdict on a tile.
    WayTo(Verdict),
    Nothing,
    /// Why there is no answer.
    Refused(String),
    /// The documents have changed.
    Outdated,
    /// It was cancelled.
    Stopped,
}

/// An event of the thread.
pub(super) enum Report {
    /// What is remembered of a program: the levels that were chosen, and verdicts about an older text.
    Recalled(PathBuf, BTreeMap<String, ChosenLevel>, Vec<(Question, Verdict)>),
    /// The levels that were chosen for a program.
    Levels(PathBuf, BTreeMap<String, ChosenLevel>),
    /// Verdicts about a program, as of a revision; and the files that were read besides those of the snapshot.
    Asked { revision: u64, snapshot: Arc<Snapshot>, read: BTreeSet<PathBuf>, asked: Vec<Asked> },
    /// The level that was chosen for a world of a program cannot be its map, as of a revision: why.
    Misfit { revision: u64, snapshot: Arc<Snapshot>, read: BTreeSet<PathBuf>, world: String, why: String },
    /// All questions of all open programs are asked as of a revision.
    AllAsked(u64),
    /// The answer of an errand.
    Brought(RequestId, Brought),
    /// The work about a program panicked, with a message.
    Failed(PathBuf, String),
}

/// What is known about a program.
struct ProgramMemory {
    memory: Memory,
    /// By world: what it meant when all its questions were asked, and the verdicts.
    asked: BTreeMap<String, (Vec<u8>, Vec<Asked>)>,
    /// What was painted last, with its revision and its world.
    painted: Option<(u64, String, Painted)>,
}

pub(super) struct Background {
    pub tasks: Receiver<Task>,
    pub reports: Sender<Report>,
    pub disk: Arc<dyn Workspace>,
    pub budget: Budget,
    /// The newest revision of the documents.
    pub newest: Arc<AtomicU64>,
    /// Set when the server has ended.
    pub has_ended: Arc<AtomicBool>,
}

/// Stops the work about verdicts for newer documents, and for an errand.
struct AskWatch<'a>(&'a Background, u64);

impl Watch for AskWatch<'_> {
    fn stop(&self) -> bool {
        let AskWatch(background, revision) = self;
        !background.tasks.is_empty() || background.is_outdated(*revision)
    }
}

/// Stops an errand whose answer is no longer wanted, or that is about documents of another revision.
struct ErrandWatch<'a>(&'a Background, &'a AtomicBool, Option<u64>);

impl Watch for ErrandWatch<'_> {
    fn stop(&self) -> bool {
        let ErrandWatch(background, is_cancelled, revision) = self;
        let is_outdated = revision.is_some_and(|revision| background.is_outdated(revision));
        is_outdated || is_cancelled.load(Ordering::Relaxed) || background.has_ended.load(Ordering::Relaxed)
    }
}

impl Background {
    /// Runs until the server has ended.
    pub fn run(self) {
        let mut programs: BTreeMap<PathBuf, ProgramMemory> = BTreeMap::new();
        let mut unasked: Option<Job> = None;
        loop {
            let task = match unasked.is_some() {
                true => self.tasks.try_recv().ok(),
                false => match next_of(&self.tasks, &*self.disk) {
                    Some(task) => Some(task),
                    None => return,
                },
            };
            match task {
                Some(Task::Ask { job, only_recalls: true }) => {
                    unasked = None;
                    for snapshot in &job.programs {
                        self.program(snapshot, &mut programs);
                    }
                }
                Some(Task::Ask { job, .. }) => unasked = Some(job),
                Some(Task::Errand(errand)) => self.errand(*errand, &mut programs),
                None => {}
            }
            if self.has_ended.load(Ordering::Relaxed) {
                return;
            }
            if self.tasks.is_empty()
                && let Some(job) = unasked.take()
                && self.ask(&job, &mut programs).is_none()
                && !self.is_outdated(job.revision)
            {
                // An errand came between.
                unasked = Some(job);
            }
        }
    }

    fn is_outdated(&self, revision: u64) -> bool {
        self.newest.load(Ordering::Relaxed) != revision || self.has_ended.load(Ordering::Relaxed)
    }

    fn send(&self, report: Report) {
        // The server has ended if this fails.
        let _ = self.reports.send(report);
    }

    /// What is known about a program; read from the cache when it is first needed.
    fn program<'p>(&self, snapshot: &Snapshot, all: &'p mut BTreeMap<PathBuf, ProgramMemory>) -> &'p mut ProgramMemory {
        all.entry(snapshot.root.clone()).or_insert_with(|| {
            let memory = Memory::recall(&snapshot.root, &*self.disk);
            let last = memory.last().map(|(question, verdict)| (question.clone(), verdict.clone()));
            self.send(Report::Recalled(snapshot.root.clone(), memory.levels.clone(), last.collect()));
            ProgramMemory { memory, asked: BTreeMap::new(), painted: None }
        })
    }

    /// Asks the questions of some programs; `None` if it is stopped.
    fn ask(&self, job: &Job, all: &mut BTreeMap<PathBuf, ProgramMemory>) -> Option<()> {
        let watch = AskWatch(self, job.revision);
        for snapshot in &job.programs {
            let known = self.program(snapshot, all);
            let before = known.memory.clone();
            let ask = || self.ask_program(job, snapshot, known, &watch);
            let done = catch_unwind(AssertUnwindSafe(ask)).unwrap_or_else(|panic| {
                self.send(Report::Failed(snapshot.root.clone(), message(&*panic)));
                Some(())
            });
            if known.memory != before {
                known.memory.remember(&snapshot.root, &*self.disk);
            }
            done?;
        }
        self.send(Report::AllAsked(job.revision));
        Some(())
    }

    fn ask_program(
        &self,
        job: &Job,
        snapshot: &Arc<Snapshot>,
        known: &mut ProgramMemory,
        watch: &dyn Watch,
    ) -> Option<()> {
        let compilation = &snapshot.ide.compilation;
        let Some(program) = &compilation.program else { return Some(()) };
        for (world, table) in program.worlds.pairs() {
            // The worlds of imported files are asked about where these are open.
            if program.spans.worlds[world].name.file() != FileId(0) {
                continue;
            }
            if table.open.is_none() {
                // A map that is no longer open needs no level.
                if known.memory.levels.remove(&table.name).is_some() {
                    self.send(Report::Levels(snapshot.root.clone(), known.memory.levels.clone()));
                }
                let subject = Subject { program, sources: &compilation.sources, world, level: "" };
                self.ask_world((job.revision, snapshot, &BTreeSet::new()), subject, known, watch)?;
                continue;
            }
            let Some(level) = known.memory.levels.get(&table.name).cloned() else { continue };
            let (compilation, read) = Snapshot::with_level(&snapshot.root, level.file(), (&job.open, &*self.disk));
            let Some(program) = &compilation.program else {
                let (revision, snapshot, world) = (job.revision, Arc::clone(snapshot), table.name.clone());
                if let Some(why) = misfit(&compilation) {
                    self.send(Report::Misfit { revision, snapshot, read, world, why });
                }
                continue;
            };
            let Some(world) = program.world_named(&table.name) else { continue };
            let name = level.name(&snapshot.root);
            let subject = Subject { program, sources: &compilation.sources, world, level: &name };
            self.ask_world((job.revision, snapshot, &read), subject, known, watch)?;
        }
        Some(())
    }

    /// Asks the questions of a world, unless it means what it meant when they were asked before.
    fn ask_world(
        &self,
        (revision, snapshot, read): (u64, &Arc<Snapshot>, &BTreeSet<PathBuf>),
        subject: Subject<'_>,
        known: &mut ProgramMemory,
        watch: &dyn Watch,
    ) -> Option<()> {
        let report = |asked: Vec<Asked>| {
            let (snapshot, read) = (Arc::clone(snapshot), read.clone());
            self.send(Report::Asked { revision, snapshot, read, asked });
        };
        let name = &subject.program.worlds[subject.world].name;
        let meaning = meaning(subject);
        if let Some((_, asked)) = known.asked.get(name).filter(|(before, _)| Some(before) == meaning.as_ref()) {
            report(asked.clone());
            return Some(());
        }
        known.asked.remove(name);
        let mut all: Vec<Asked> = Vec::new();
        let done = ask_world(subject, &known.memory, self.budget, watch, &mut |asked| {
            all.extend(asked.iter().cloned());
            report(asked);
        });
        all.iter().for_each(|asked| known.memory.keep(&asked.question, &asked.verdict));
        done?;
        known.asked.extend(meaning.map(|meaning| (name.clone(), (meaning, all))));
        Some(())
    }

    fn errand(&self, errand: Errand, all: &mut BTreeMap<PathBuf, ProgramMemory>) {
        let known = self.program(&errand.snapshot, all);
        let brought = catch_unwind(AssertUnwindSafe(|| self.bring(&errand, known))).unwrap_or_else(|panic| {
            self.send(Report::Failed(errand.snapshot.root.clone(), message(&*panic)));
            Brought::Refused("internal error in hypedc".to_string())
        });
        self.send(Report::Brought(errand.id, brought));
    }

    fn bring(&self, errand: &Errand, known: &mut ProgramMemory) -> Brought {
        let Errand { snapshot, open, revision, is_cancelled, what, .. } = errand;
        let files = Buffers { open: Arc::clone(open), disk: Arc::clone(&self.disk) };
        let root = &snapshot.root;
        // What is about places in texts is no use once they have changed.
        let watch = ErrandWatch(self, is_cancelled, Some(*revision));
        let or_stopped = |brought: Result<Option<Brought>, String>| match brought {
            Ok(Some(brought)) => brought,
            Ok(None) if !self.is_outdated(*revision) => Brought::Stopped,
            Ok(None) => Brought::Outdated,
            Err(why) => Brought::Refused(why),
        };
        match what {
            What::Levels { world, all } => {
                let program = snapshot.ide.compilation.program.as_ref();
                let table = program.and_then(|program| Some(&program.worlds[program.world_named(world)?]));
                let is_open = table.is_some_and(|table| table.open.is_some());
                let watch = ErrandWatch(self, is_cancelled, None);
                match is_open && *all {
                    true => candidates(root, (open, &*self.disk), &watch)
                        .map_or(Brought::Stopped, |found| Brought::Levels(is_open, found)),
                    false => Brought::Levels(is_open, Vec::new()),
                }
            }
            What::Choose { world, level } => {
                known.asked.remove(world);
                known.painted = None;
                match level {
                    Some(level) => known.memory.levels.insert(world.clone(), level.clone()),
                    None => known.memory.levels.remove(world),
                };
                known.memory.remember(root, &*self.disk);
                self.send(Report::Levels(root.clone(), known.memory.levels.clone()));
                Brought::Nothing
            }
            What::Paint { world } => {
                let level = known.memory.levels.get(world);
                let canvas = Canvas { root, world, level, files: &files };
                let name = level.map(|level| level.name(root)).unwrap_or_default();
                let ways = known.memory.ways_in(world, &name);
                let painted = canvas.paint(&ways, self.budget, &watch);
                if let Ok(Some(painted)) = &painted {
                    known.painted = Some((*revision, world.clone(), painted.clone()));
                }
                or_stopped(painted.map(|painted| painted.map(Brought::Painted)))
            }
            What::WayTo { world, place } => {
                let painted = known.painted.as_ref().filter(|(of, name, _)| of == revision && name == world);
                if let Some(verdict) = painted.and_then(|(.., painted)| painted.way_to(place)) {
                    return Brought::WayTo(verdict);
                }
                let canvas = Canvas { root, world, level: known.memory.levels.get(world), files: &files };
                let verdict = canvas.way_to(place, self.budget, &watch);
                or_stopped(verdict.map(|verdict| verdict.map(Brought::WayTo)))
            }
        }
    }
}

/// Equal bytes for worlds with the same verdicts in the same words.
fn meaning(Subject { program, sources, world, level }: Subject<'_>) -> Option<Vec<u8>> {
    let mut bytes = json::bytes(&program.meaning(), Layout::Compact).ok()?;
    bytes.extend(level.as_bytes());
    bytes.extend(predicates(program, sources, world).into_bytes());
    Some(bytes)
}

/// The texts of the predicates that are asked about.
fn predicates(program: &Program, sources: &SourceMap, world: WorldId) -> String {
    let table = &program.worlds[world];
    let all = table.goals.iter().chain(table.nevers.iter()).map(|of| program.spans.exprs[of.holds]);
    all.filter(|span| sources.holds(*span)).map(|span| format!("\n{}", sources.slice(span))).collect()
}

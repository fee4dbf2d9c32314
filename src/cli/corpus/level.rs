//! One level of many: compiled with the program, searched for all targets, made into rows.

use std::path::PathBuf;
use std::time::Instant;

use cpu_time::ThreadTime;

use crate::compile::{Compilation, compile_changed};
use crate::corpus::{Key, Record, Row, Settings, StoredRow, Timing};
use crate::diagnostic::{Severity, render};
use crate::parallel::TaskContext;
use crate::reach::query::{Found, Kind, Session};

use crate::cli::args::ReachArgs;
use crate::cli::disk::Disk;
use crate::cli::reach::files::Destination;
use crate::cli::reach::question::{ReachChanges, query, refusal};
use crate::cli::reach::refuted::{Refuted, RunInfo, command_line};
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, find_world, level_sha256, program_sha256};
use crate::cli::watches::TaskWatch;

/// A level; `path` is `None` for a program that contains its maps.
#[derive(Debug, Clone)]
pub(in crate::cli) struct Level {
    pub path: Option<PathBuf>,
    /// Its name in file names, if there are several levels.
    pub name: Option<String>,
}

/// The context shared by all levels.
pub(in crate::cli) struct CorpusContext<'c> {
    pub args: &'c ReachArgs,
    pub world: String,
    /// The questions, in the order of their rows.
    pub targets: Vec<(Kind, String)>,
    pub settings: Settings,
    /// Whether each question is asked in this shard: the targets of the first level, then those of the next.
    pub is_asked: Vec<bool>,
    /// The rows of an earlier run.
    pub record: &'c Record,
}

/// The result of a question, with its index.
pub(in crate::cli) enum TaskResult {
    /// Taken from an earlier run.
    Stored(usize, Box<StoredRow>),
    /// Computed in this run.
    New(usize, Box<Row>),
    /// The run must end, as files cannot be written.
    Broken(String),
}

impl CorpusContext<'_> {
    /// Processes the level with this index; submits a result for each question, unless the run is stopped.
    pub fn level(&self, index: usize, level: &Level, task_context: &TaskContext<'_, TaskResult>) {
        let count = self.targets.len();
        let targets: Vec<usize> =
            (0..count).filter(|target| self.is_asked.get(index * count + target).is_some_and(|is| *is)).collect();
        if targets.is_empty() {
            return;
        }
        let path = level.path.as_deref();
        let level_sha256 = path.and_then(level_sha256);
        let blank = |target: usize, error: String| {
            let (kind, goal) = self.targets[target].clone();
            let key = Key { level: path.map(|p| p.display().to_string()), kind, goal };
            let file = self.args.file.display().to_string();
            let row = Row::failed(key, file, self.world.clone(), self.settings.clone(), error);
            Row { level_sha256: level_sha256.clone(), ..row }
        };
        let failed = |error: &str| {
            for &target in &targets {
                task_context.submit(TaskResult::New(target, Box::new(blank(target, error.to_string()))));
            }
        };
        let changes = ReachChanges::new(self.args);
        let Compilation { sources, program, diagnostics, .. } =
            compile_changed(&self.args.file, self.args.reading.of(path), &changes.changes(), &Disk);
        let Some(program) = program else {
            let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error);
            return failed(render::short(&sources, errors).trim_end());
        };
        let program_sha256 = program_sha256(&program);
        let mut loaded = Loaded { sources, program };
        let world = find_world(&loaded.program, &self.args.file, self.args.world.as_deref()).map_err(Refusal::of);
        let asked = world.and_then(|world| Ok((world, query(self.args, &mut loaded, world)?)));
        let (world, mut query) = match asked {
            Ok(asked) => asked,
            Err(refusal) => return failed(&refusal.text(&loaded.sources)),
        };
        // Threads are used for levels.
        query.settings.threads = 1;
        let blank =
            |target: usize| Row { program_sha256: Some(program_sha256.clone()), ..blank(target, String::new()) };
        let kept = |target: usize| self.record.same(&blank(target)).filter(|kept| self.has_files(level, &kept.row));
        // A search for another goal may refute the analysis on which a stored proof rests.
        let is_searched = targets.iter().any(|&target| kept(target).is_none());
        let rests_on_analysis = |kept: &StoredRow| kept.row.answer.answered_by.as_deref() == Some("analysis");
        let mut open = Vec::new();
        for &target in &targets {
            match kept(target).filter(|kept| !(is_searched && rests_on_analysis(kept))) {
                Some(kept) => task_context.submit(TaskResult::Stored(target, Box::new(kept.clone()))),
                None => open.push(target),
            }
        }
        if open.is_empty() {
            return;
        }
        let watch = TaskWatch::new(task_context, self.args.seconds);
        let started = Instant::now();
        let session = Session::new(&loaded.program, world, query, &watch);
        let analysis_seconds = started.elapsed().as_secs_f64();
        let answered = |target: usize, mut found: Found<'_>, timing: Timing| {
            let answer = session.answer(&mut found, &loaded.sources);
            let destination = self.destination(level, &answer.goal);
            let watch = TaskWatch::new(task_context, None);
            destination.save(&session, &found, &answer, &watch).map_err(|refusal| refusal.text(&loaded.sources))?;
            let fault = found.outcome.fault.map(|(fault, step)| fault.fact(&loaded.program, world, step));
            let fault = fault.map(|fact| Refusal::of(fact).text(&loaded.sources));
            Ok::<Row, String>(Row { answer, error: None, fault, timing, ..blank(target) })
        };
        // Proofs are delayed: the search for another goal of the level can refute the analysis.
        let mut waiting = Vec::new();
        for target in open {
            if task_context.is_over() {
                return;
            }
            let watch = TaskWatch::new(task_context, self.args.seconds);
            let (started, cpu_started) = (Instant::now(), cpu_seconds());
            let found = session.find(session.query().targets[target], &watch);
            let cpu_seconds = cpu_started.zip(cpu_seconds()).map(|(from, to)| to - from);
            let timing = Timing { seconds: started.elapsed().as_secs_f64(), cpu_seconds, analysis_seconds };
            if task_context.is_over() {
                // The search may be incomplete.
                return;
            }
            let row = match found {
                Ok(found) if found.outcome.rests_on_analysis() || session.refutation().is_some() => {
                    waiting.push((target, found, timing));
                    continue;
                }
                Ok(found) => match answered(target, found, timing) {
                    Ok(row) => row,
                    Err(why) => return task_context.submit(TaskResult::Broken(why)),
                },
                Err(error) => {
                    let error = refusal(self.args, &loaded, world, &error).text(&loaded.sources);
                    Row { error: Some(error), ..blank(target) }
                }
            };
            task_context.submit(TaskResult::New(target, Box::new(row)));
        }
        let refuted = session.refutation().map(|refutation| {
            let info = RunInfo { file: &self.args.file, level: path, seed: self.args.seed, command: command_line() };
            Refuted::saved(&loaded.program, world, &refutation, &info).line()
        });
        for (target, found, timing) in waiting {
            match answered(target, found, timing) {
                Ok(row) => {
                    task_context.submit(TaskResult::New(target, Box::new(Row { refuted: refuted.clone(), ..row })))
                }
                Err(why) => return task_context.submit(TaskResult::Broken(why)),
            }
        }
    }

    /// Whether the requested files exist.
    fn has_files(&self, level: &Level, row: &Row) -> bool {
        self.destination(level, &row.answer.goal).is_complete(row.answer.inputs.is_some())
    }

    fn destination<'d>(&'d self, level: &'d Level, goal: &'d str) -> Destination<'d> {
        Destination::new(self.args, level.name.as_deref(), goal, self.targets.len())
    }
}

/// CPU time of this thread, s; `None` if the system does not report it.
fn cpu_seconds() -> Option<f64> {
    ThreadTime::try_now().ok().map(|time| time.as_duration().as_secs_f64())
}

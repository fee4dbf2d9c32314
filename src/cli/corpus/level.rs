//! One level of many: compiled with the program, asked all questions, made into rows.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

use crate::compile::{Compilation, compile_constrained};
use crate::corpus::{Kept, Key, Record, Row, Settings, Timing};
use crate::diagnostic::{Severity, render};
use crate::parallel::TaskContext;
use crate::reach::query::{Found, Kind, Session};
use crate::watch::Watch;

use crate::cli::args::ReachArgs;
use crate::cli::disk::Disk;
use crate::cli::reach::files::Destination;
use crate::cli::reach::question::{extra_constraint, query, refusal};
use crate::cli::reach::refuted::{Occasion, Refuted, command_line};
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, find_world, level_sha256, program_sha256};

/// A level of many; none for a program that has its maps in it.
#[derive(Debug, Clone)]
pub(in crate::cli) struct Level {
    pub path: Option<PathBuf>,
    /// What it is called in the names of files, if there are several.
    pub name: Option<String>,
}

/// What all levels have in common.
pub(in crate::cli) struct Common<'c> {
    pub args: &'c ReachArgs,
    pub world: String,
    /// The questions, in the order of their rows.
    pub targets: Vec<(Kind, String)>,
    pub settings: Settings,
    /// What an earlier run found.
    pub record: &'c Record,
}

/// What comes of a question, with its number.
pub(in crate::cli) enum Done {
    /// As an earlier run found it.
    Kept(usize, Box<Kept>),
    /// Now.
    New(usize, Box<Row>),
    /// Nothing more can be done, as files cannot be written.
    Broken(String),
}

impl Common<'_> {
    /// Does a level; hands in something for each question, or less if all is to end.
    pub fn level(&self, level: &Level, desk: &TaskContext<'_, Done>) {
        let path = level.path.as_deref();
        let level_sha256 = path.and_then(level_sha256);
        let blank = |target: usize, error: String| {
            let (kind, goal) = self.targets[target].clone();
            let key = Key { level: path.map(|p| p.display().to_string()), kind, goal };
            let file = self.args.file.display().to_string();
            let row = Row::unasked(key, file, self.world.clone(), self.settings.clone(), error);
            Row { level_sha256: level_sha256.clone(), ..row }
        };
        let failed = |error: &str| {
            for target in 0..self.targets.len() {
                desk.hand_in(Done::New(target, Box::new(blank(target, error.to_string()))));
            }
        };
        let Compilation { sources, program, diagnostics } =
            compile_constrained(&self.args.file, self.args.reading.of(path), extra_constraint(self.args), &Disk);
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
        // The threads are for the levels.
        query.settings.threads = 1;
        let blank =
            |target: usize| Row { program_sha256: Some(program_sha256.clone()), ..blank(target, String::new()) };
        let kept = |target: usize| self.record.same(&blank(target)).filter(|kept| self.has_files(level, &kept.row));
        // A search for another goal may refute what a proof of an earlier run rests on.
        let is_searched = (0..self.targets.len()).any(|target| kept(target).is_none());
        let rests_on_analysis = |kept: &Kept| kept.row.answer.answered_by.as_deref() == Some("analysis");
        let mut open = Vec::new();
        for target in 0..self.targets.len() {
            match kept(target).filter(|kept| !(is_searched && rests_on_analysis(kept))) {
                Some(kept) => desk.hand_in(Done::Kept(target, Box::new(kept.clone()))),
                None => open.push(target),
            }
        }
        if open.is_empty() {
            return;
        }
        let watch = LevelWatch::new(desk, self.args.seconds);
        let started = Instant::now();
        let session = Session::new(&loaded.program, world, query, &watch);
        let analysis_seconds = started.elapsed().as_secs_f64();
        let answered = |target: usize, mut found: Found<'_>, timing: Timing| {
            let answer = session.answer(&mut found, &loaded.sources);
            let destination = self.destination(level, &answer.goal);
            let watch = LevelWatch::new(desk, None);
            destination.save(&session, &found, &answer, &watch).map_err(|refusal| refusal.text(&loaded.sources))?;
            let fault = found.outcome.fault.map(|(fault, step)| fault.fact(&loaded.program, world, step));
            let fault = fault.map(|fact| Refusal::of(fact).text(&loaded.sources));
            Ok::<Row, String>(Row { answer, error: None, fault, timing, ..blank(target) })
        };
        // A proof waits: the search for another goal of the level can refute the analysis that it rests on.
        let mut waiting = Vec::new();
        for target in open {
            if desk.is_over() {
                return;
            }
            let watch = LevelWatch::new(desk, self.args.seconds);
            let (started, cpu_started) = (Instant::now(), cpu_seconds());
            let found = session.find(session.query().targets[target], &watch);
            let cpu_seconds = cpu_started.zip(cpu_seconds()).map(|(from, to)| to - from);
            let timing = Timing { seconds: started.elapsed().as_secs_f64(), cpu_seconds, analysis_seconds };
            if desk.is_over() {
                // It may have been cut short.
                return;
            }
            let row = match found {
                Ok(found) if found.outcome.rests_on_analysis() || session.refutation().is_some() => {
                    waiting.push((target, found, timing));
                    continue;
                }
                Ok(found) => match answered(target, found, timing) {
                    Ok(row) => row,
                    Err(why) => return desk.hand_in(Done::Broken(why)),
                },
                Err(unasked) => {
                    let error = refusal(self.args, &loaded, world, &unasked).text(&loaded.sources);
                    Row { error: Some(error), ..blank(target) }
                }
            };
            desk.hand_in(Done::New(target, Box::new(row)));
        }
        let refuted = session.refutation().map(|refutation| {
            let occasion =
                Occasion { file: &self.args.file, level: path, seed: self.args.seed, command: command_line() };
            Refuted::kept(&loaded.program, world, &refutation, &occasion).line()
        });
        for (target, found, timing) in waiting {
            match answered(target, found, timing) {
                Ok(row) => desk.hand_in(Done::New(target, Box::new(Row { refuted: refuted.clone(), ..row }))),
                Err(why) => return desk.hand_in(Done::Broken(why)),
            }
        }
    }

    /// Whether the files that are asked for are there.
    fn has_files(&self, level: &Level, row: &Row) -> bool {
        self.destination(level, &row.answer.goal).is_complete(row.answer.inputs.is_some())
    }

    fn destination<'d>(&'d self, level: &'d Level, goal: &'d str) -> Destination<'d> {
        Destination::new(self.args, level.name.as_deref(), goal, self.targets.len())
    }
}

/// Processor time of this thread, s; none if the system does not tell.
fn cpu_seconds() -> Option<f64> {
    ThreadTime::try_now().ok().map(|time| time.as_duration().as_secs_f64())
}

/// Watches one search: its seconds, and whether all is to end.
struct LevelWatch<'w> {
    desk: &'w TaskContext<'w, Done>,
    until: Option<Instant>,
}

impl<'w> LevelWatch<'w> {
    fn new(desk: &'w TaskContext<'w, Done>, seconds: Option<f64>) -> Self {
        let until =
            seconds.and_then(|s| Duration::try_from_secs_f64(s).ok()).and_then(|s| Instant::now().checked_add(s));
        LevelWatch { desk, until }
    }
}

impl Watch for LevelWatch<'_> {
    fn stop(&self) -> bool {
        self.desk.is_over() || self.until.is_some_and(|until| Instant::now() >= until)
    }
}

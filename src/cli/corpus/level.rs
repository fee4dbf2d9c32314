//! One level of many: compiled with the program, asked all questions, made into rows.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

use crate::compile::{Compilation, compile_barred};
use crate::corpus::{Broken, Coverage, Exhausted, Kept, Key, Kind, Record, Row, Settings, Timing, Verdict};
use crate::diagnostic::{Severity, render};
use crate::parallel::TaskContext;
use crate::reach;
use crate::watch::Watch;

use crate::cli::args::ReachArgs;
use crate::cli::disk::Disk;
use crate::cli::reach::refuted::command_line;
use crate::cli::reach::result::{Answered, restart_text};
use crate::cli::reach::session::{Asked, Prepared, ReachSession, Refusal, barred, named, nodes_limit};
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

/// How a search is done, as rows have it.
pub(in crate::cli) fn row_settings(args: &ReachArgs, settings: &reach::Settings) -> Settings {
    Settings {
        hypedc: env!("CARGO_PKG_VERSION").to_string(),
        seed: settings.seed,
        planner: settings.planner.name().to_string(),
        bounds: settings.sampling.name().to_string(),
        metric: settings.measure.name().to_string(),
        hold: settings.hold,
        restart: restart_text(settings.restart),
        trees: settings.trees,
        legend: args.reading.legend.as_ref().map(|path| path.display().to_string()),
        tile: args.reading.tile,
        without: args.without.clone(),
        within: args.within.map(|time| time.to_string()),
        after: args.after.clone(),
        min_hold: args.min_hold.map(|time| time.to_string()),
        minimize: args.minimize,
        nodes_limit: args.nodes.or(args.seconds.is_none().then(|| nodes_limit(args))),
        seconds_limit: args.seconds,
        memory_limit: args.memory << 20,
    }
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
            let row = Row::of_error(key, file, self.world.clone(), self.settings.clone(), error);
            Row { level_sha256: level_sha256.clone(), ..row }
        };
        let failed = |error: &str| {
            for target in 0..self.targets.len() {
                desk.hand_in(Done::New(target, Box::new(blank(target, error.to_string()))));
            }
        };
        let Compilation { sources, program, diagnostics } =
            compile_barred(&self.args.file, self.args.reading.of(path), barred(self.args), &Disk);
        let Some(program) = program else {
            let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error);
            return failed(render::short(&sources, errors).trim_end());
        };
        let program_sha256 = program_sha256(&program);
        let mut loaded = Loaded { sources, program };
        let world = find_world(&loaded.program, &self.args.file, self.args.world.as_deref()).map_err(Refusal::of);
        let prepared = world.and_then(|world| Ok((world, Prepared::new(self.args, &mut loaded, world)?)));
        let (world, mut prepared) = match prepared {
            Ok(prepared) => prepared,
            Err(refusal) => return failed(&refusal.text(&loaded.sources)),
        };
        // The threads are for the levels.
        prepared.settings.threads = 1;
        let blank =
            |target: usize| Row { program_sha256: Some(program_sha256.clone()), ..blank(target, String::new()) };
        let kept = |target: usize| self.record.same(&blank(target)).filter(|kept| self.has_files(level, &kept.row));
        // A search for another goal may refute what a proof of an earlier run rests on.
        let is_searched = (0..self.targets.len()).any(|target| kept(target).is_none());
        let rests_on_analysis = |kept: &Kept| kept.row.answered_by.as_deref() == Some("analysis");
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
        let asking = ReachSession::new(self.args, &loaded, prepared, &LevelWatch::new(desk, self.args.seconds));
        // What refutes the analysis may come to light in the search for another goal of the level.
        let mut waiting = Vec::new();
        let timing = |seconds: f64, cpu_seconds: Option<f64>| Timing {
            seconds,
            cpu_seconds,
            analysis_seconds: asking.analysis_seconds,
        };
        let finished = |target: usize, mut asked: Asked, cpu: Option<f64>| {
            asking.save(&mut asked, level.name.as_deref()).map_err(|refusal| refusal.text(&loaded.sources))?;
            let fault = asked
                .outcome
                .fault
                .map(|(fault, step)| Refusal::of(fault.fact(&loaded.program, world, step)).text(&loaded.sources));
            let timing = timing(asked.answered.seconds, cpu);
            Ok::<Row, String>(Row { fault, timing, ..row(blank(target), asked) })
        };
        for target in open {
            if desk.is_over() {
                return;
            }
            let watch = LevelWatch::new(desk, self.args.seconds);
            let began = cpu_seconds();
            let found = asking.find_alone(asking.targets()[target], &watch);
            let cpu = began.zip(cpu_seconds()).map(|(from, to)| to - from);
            if desk.is_over() {
                // It may have been cut short.
                return;
            }
            let row = match found {
                Ok(found) if found.outcome.rests_on_analysis() || asking.refutation().is_some() => {
                    waiting.push((target, found, cpu));
                    continue;
                }
                Ok(found) => match finished(target, asking.answer(found), cpu) {
                    Ok(row) => row,
                    Err(why) => return desk.hand_in(Done::Broken(why)),
                },
                Err(refusal) => Row { error: Some(refusal.text(&loaded.sources)), ..blank(target) },
            };
            desk.hand_in(Done::New(target, Box::new(row)));
        }
        let refuted = asking.refuted(path, command_line()).map(|refuted| refuted.line());
        for (target, found, cpu) in waiting {
            match finished(target, asking.answer(found), cpu) {
                Ok(row) => desk.hand_in(Done::New(target, Box::new(Row { refuted: refuted.clone(), ..row }))),
                Err(why) => return desk.hand_in(Done::Broken(why)),
            }
        }
    }

    /// Whether the files that are asked for are there.
    fn has_files(&self, level: &Level, row: &Row) -> bool {
        let goal = (self.targets.len() > 1).then_some(row.goal.as_str());
        let is_there = |path: &Path| named(path, level.name.as_deref().into_iter().chain(goal)).exists();
        let inputs = self.args.save_inputs.as_ref().filter(|_| row.inputs.is_some());
        inputs.into_iter().chain(&self.args.svg).all(|path| is_there(path))
    }
}

/// The row of an answer.
fn row(blank: Row, asked: Asked) -> Row {
    let Answered { coverage: c, .. } = &asked.answered;
    let coverage = Coverage {
        place: c.place,
        places: c.places,
        mode_combinations: c.mode_combinations,
        places_with_modes: c.places_with_modes,
    };
    let a = asked.answered;
    Row {
        verdict: Verdict::Of(a.verdict),
        is_expected: a.is_expected,
        error: None,
        argument: a.argument,
        steps: a.steps,
        is_shortest: a.is_shortest,
        states: a.states,
        least_steps: a.least_steps,
        reads_between: a.reads_between,
        inputs: a.inputs,
        answered_by: Some(a.planner.to_string()),
        nodes: a.nodes,
        trees: a.trees,
        extensions: a.extensions,
        failures: a.failures,
        simulated_steps: a.simulated_steps,
        coverage,
        exhausted: a.exhausted.map(|(hold, states)| Exhausted { hold, states }),
        violations: a
            .violations
            .into_iter()
            .map(|v| Broken { never: v.never, steps: v.steps, inputs: v.inputs })
            .collect(),
        stopped: a.stopped,
        out_of_memory: a.out_of_memory,
        inputs_left_out: a.inputs_left_out,
        ..blank
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

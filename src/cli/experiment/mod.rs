//! `hypedc experiment`: runs planners many times on goals, and writes tables, CSV and JSON. This part has the clock,
//! the programs and the files; [`crate::experiment`] defines the runs and statistics.

pub(in crate::cli) mod args;

use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::Ordering;

use cpu_time::ThreadTime;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::analysis::{ConfigurationSpace, configuration_space};
use crate::compile::{Asked, Changes, Compilation, ExtraQuestion, question_name};
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::experiment::paper::{PLANNERS, Test};
use crate::experiment::{CSV_HEADER, Clock, Design, Question, Report, Run, RunError, conduct, csv_line};
use crate::ir::GoalId;
use crate::json::{self, Layout};
use crate::reach::{Limits, Planner, Problem, Proof};
use crate::sim::Simulator;

use crate::cli::Exit;
use crate::cli::report::{Loaded, has_maps, load_again, load_changed, plain_error, program_sha256, show, show_fact};
use crate::cli::sweep::{Sweep, swept};
use crate::cli::watches::interrupted;
use crate::parallel;
use args::{ExperimentArgs, ExperimentFormat, ExperimentOptions, FilesArgs, Known, PaperArgs};

/// CPU time of the calling thread: unaffected by other programs.
struct ThreadClock;

impl Clock for ThreadClock {
    fn seconds(&self) -> f64 {
        ThreadTime::try_now().map_or(0.0, |time| time.as_duration().as_secs_f64())
    }
}

/// A program, with its name in results.
struct Source {
    name: String,
    /// The numbers that were set, after a comma each.
    set: String,
    /// The numbers that are swept, with their values.
    swept: Vec<(String, String)>,
    paper: Option<Test>,
    loaded: Loaded,
}

/// A world of a program, analysed.
struct Analysed<'s> {
    source: &'s Source,
    sim: Simulator,
    space: ConfigurationSpace,
    seconds: f64,
}

pub(in crate::cli) fn run(args: &ExperimentArgs) -> io::Result<Exit> {
    if let Err(error) = ThreadTime::try_now() {
        plain_error(&format!("the system does not report the CPU time of a thread: {error}"))?;
        return Ok(Exit::Refused);
    }
    match &args.known {
        Some(Known::Paper(paper)) => run_paper(paper),
        None => run_files(&args.files),
    }
}

fn run_paper(args: &PaperArgs) -> io::Result<Exit> {
    let mut sources = Vec::new();
    for paper in Test::ALL.into_iter().filter(|test| args.tests.contains(&test.number())) {
        let Compilation { sources: files, program, diagnostics, .. } = paper.compile();
        let Some(program) = program else {
            show(&files, &diagnostics)?;
            return Ok(Exit::Refused);
        };
        let loaded = Loaded { sources: files, program };
        sources.push(Source {
            name: paper.name().to_string(),
            set: String::new(),
            swept: Vec::new(),
            paper: Some(paper),
            loaded,
        });
    }
    let is_selected = |source: &Source, goal: &str| source.paper != Some(Test::Two) || goal == args.goal.name();
    experiment(&sources, &is_selected, &PLANNERS, &args.options)
}

fn run_files(args: &FilesArgs) -> io::Result<Exit> {
    match swept(&args.numbers, |sweep| run_points(args, Some(sweep)))? {
        Some(exit) => Ok(exit),
        None => run_points(args, None),
    }
}

/// Runs an experiment on files, with each value of the numbers that are swept.
fn run_points(args: &FilesArgs, sweep: Option<&Sweep<'_>>) -> io::Result<Exit> {
    let mut sources = Vec::new();
    let fixed = args.numbers.fixed();
    let question = |text| ExtraQuestion { asked: Asked::Goal, world: None, text, origin: "--goal" };
    let questions: Vec<ExtraQuestion<'_>> = args.goal.iter().map(|text| question(text)).collect();
    let points = sweep.map_or(1, Sweep::points);
    for (file, point) in args.files.iter().flat_map(|file| (0..points).map(move |point| (file, point))) {
        let set = sweep.map_or(Vec::new(), |sweep| sweep.numbers(point));
        let numbers = [&fixed[..], &set].concat();
        let changes = Changes { numbers: &numbers, questions: &questions, ..Changes::default() };
        let load = if point == 0 { load_changed } else { load_again };
        let Some(loaded) = load(file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
        let swept = set.iter().map(|set| (set.path.to_string(), set.value.to_string())).collect();
        if !has_maps(&loaded, loaded.program.worlds.iter())? {
            return Ok(Exit::Refused);
        }
        let set = args.numbers.texts().iter().map(|set| format!(", {set}")).collect();
        sources.push(Source { name: file.display().to_string(), set, swept, paper: None, loaded });
    }
    let worlds = sources.iter().flat_map(|s| s.loaded.program.worlds.iter());
    let goals: Vec<&str> = worlds.flat_map(|w| w.goals.iter().map(|g| g.name.as_str())).collect();
    let asked: Vec<String> = args.goal.iter().map(|text| question_name(text)).collect();
    if let Some(name) = asked.iter().find(|name| !goals.contains(&name.as_str())) {
        let near = similar(name, goals.iter().copied());
        return refused(&sources, &format!("no goal `{name}` in these programs"), near);
    }
    if goals.is_empty() {
        return refused(&sources, "these programs have no goal", None);
    }
    let is_selected = |_: &Source, goal: &str| asked.is_empty() || asked.iter().any(|g| g == goal);
    experiment(&sources, &is_selected, &Planner::ALL, &args.options)
}

/// Reports why there is nothing to run.
fn refused(sources: &[Source], why: &str, near: Option<String>) -> io::Result<Exit> {
    if let Some(source) = sources.first() {
        show_fact(&source.loaded.sources, NoQuestion { why: why.to_string(), near, help: None })?;
    }
    Ok(Exit::Refused)
}

/// Runs an experiment on the selected goals, and writes the results.
fn experiment(
    sources: &[Source],
    is_selected: &dyn Fn(&Source, &str) -> bool,
    planners: &[Planner],
    options: &ExperimentOptions,
) -> io::Result<Exit> {
    let analysed = analysed(sources);
    let questions = questions(&analysed, is_selected);
    let design = Design {
        setups: options.setups(planners),
        seeds: options.seeds,
        seconds: options.seconds,
        limits: Limits { nodes: options.nodes.unwrap_or(u64::MAX), memory: options.memory << 20 },
    };
    // Files are opened first: a misspelt folder is reported now, not after an hour.
    let Some(mut csv) = opened(options.csv.as_deref())? else { return Ok(Exit::Refused) };
    let Some(mut json) = opened(options.json.as_deref())? else { return Ok(Exit::Refused) };
    let mut lines = Lines { design: &design, questions: &questions, file: csv.as_mut(), on_screen: None };
    if options.format == ExperimentFormat::Csv {
        lines.on_screen = Some(io::stdout());
    }
    if let Err(broken) = lines.write(&CSV_HEADER.join(",")) {
        return broken.report_to_user(options);
    }
    let bar = bar(design.runs(&questions));
    let flag = interrupted();
    let stop = || flag.load(Ordering::SeqCst);
    let mut broken = None;
    let mut each = |run: &Run| {
        bar.inc(1);
        match lines.run(run) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                broken = Some(error);
                ControlFlow::Break(())
            }
        }
    };
    let threads = parallel::threads(options.threads);
    let runs = conduct(&design, &questions, threads, &ThreadClock, &stop, &mut each);
    bar.finish_and_clear();
    if let Some(broken) = broken {
        return broken.report_to_user(options);
    }
    let runs = match runs {
        Ok(runs) => runs,
        Err(RunError { question, fault }) => {
            if let Some(at) = analysed.iter().find(|a| std::ptr::eq(&a.sim, questions[question].sim)) {
                let program = &at.source.loaded.program;
                show_fact(&at.source.loaded.sources, fault.fact(program, at.sim.world_id(), 0))?;
            }
            return Ok(Exit::Refused);
        }
    };
    let report = Report { design: &design, questions: &questions, runs: &runs };
    if let Some(file) = &mut json
        && let Err(error) = write_json(file, &report)
    {
        return WriteError::Json(error).report_to_user(options);
    }
    let mut out = io::stdout().lock();
    match options.format {
        ExperimentFormat::Text => write!(out, "{}", report.text())?,
        ExperimentFormat::Json => write_json(&mut out, &report)?,
        ExperimentFormat::Csv => {}
    }
    if stop() {
        writeln!(io::stderr(), "stopped after {} of {} runs", runs.len(), design.runs(&questions))?;
        return Ok(Exit::No);
    }
    Ok(Exit::Yes)
}

/// All worlds that have goals, analysed.
fn analysed(sources: &[Source]) -> Vec<Analysed<'_>> {
    let mut all = Vec::new();
    for source in sources {
        let program = &source.loaded.program;
        for (world, w) in program.worlds.pairs() {
            if w.goals.is_empty() {
                continue;
            }
            let began = ThreadClock.seconds();
            let space = configuration_space(program, world);
            let seconds = ThreadClock.seconds() - began;
            all.push(Analysed { source, sim: Simulator::new(program, world), space, seconds });
        }
    }
    all
}

fn questions<'a>(analysed: &'a [Analysed<'a>], is_selected: &dyn Fn(&Source, &str) -> bool) -> Vec<Question<'a>> {
    let mut questions = Vec::new();
    for Analysed { source, sim, space, seconds } in analysed {
        let goals: Vec<GoalId> =
            sim.world().goals.pairs().filter(|(_, g)| is_selected(source, &g.name)).map(|(id, _)| id).collect();
        let program_sha256 = program_sha256(&source.loaded.program);
        for goal in goals {
            questions.push(Question {
                test: match source.paper {
                    Some(_) => source.name.clone(),
                    None => format!("{}:{}{}", source.name, sim.world().name, source.set),
                },
                set: source.swept.clone(),
                paper: source.paper,
                sim,
                space,
                goal,
                program_sha256: program_sha256.clone(),
                analysis_seconds: *seconds,
                is_ruled_out: Proof::of(&Problem::new(sim, goal), space).is_some(),
            });
        }
    }
    questions
}

/// A progress bar, on a terminal only.
fn bar(runs: usize) -> ProgressBar {
    let target = if io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(runs as u64), target);
    let style = ProgressStyle::with_template("{spinner} {pos} of {len} runs  {elapsed}, about {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar
}

/// Opens an output file, if one is requested; reports a failure.
fn opened(path: Option<&Path>) -> io::Result<Option<Option<BufWriter<File>>>> {
    let Some(path) = path else { return Ok(Some(None)) };
    match File::create(path) {
        Ok(file) => Ok(Some(Some(BufWriter::new(file)))),
        Err(error) => {
            plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
            Ok(None)
        }
    }
}

/// Why results could not be written.
enum WriteError {
    Screen(io::Error),
    Csv(io::Error),
    Json(io::Error),
}

impl WriteError {
    /// Reports it; the caller reports a broken standard output.
    fn report_to_user(self, options: &ExperimentOptions) -> io::Result<Exit> {
        let (path, error) = match self {
            WriteError::Screen(error) => return Err(error),
            WriteError::Csv(error) => (&options.csv, error),
            WriteError::Json(error) => (&options.json, error),
        };
        let path = path.as_deref().unwrap_or(Path::new("")).display();
        plain_error(&format!("cannot write `{path}`: {error}"))?;
        Ok(Exit::Refused)
    }
}

/// The destinations of CSV lines. Each line is flushed, so that none is lost in a long experiment.
struct Lines<'l> {
    design: &'l Design,
    questions: &'l [Question<'l>],
    file: Option<&'l mut BufWriter<File>>,
    on_screen: Option<io::Stdout>,
}

impl Lines<'_> {
    fn run(&mut self, run: &Run) -> Result<(), WriteError> {
        self.write(&csv_line(self.design, self.questions, run))
    }

    fn write(&mut self, line: &str) -> Result<(), WriteError> {
        if let Some(file) = &mut self.file {
            writeln!(file, "{line}").and_then(|()| file.flush()).map_err(WriteError::Csv)?;
        }
        if let Some(out) = &mut self.on_screen {
            writeln!(out, "{line}").map_err(WriteError::Screen)?;
        }
        Ok(())
    }
}

fn write_json(out: &mut impl Write, report: &Report<'_>) -> io::Result<()> {
    json::write(&report.json(), Layout::Indented, out)?;
    writeln!(out)?;
    out.flush()
}

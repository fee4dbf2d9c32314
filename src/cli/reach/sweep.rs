//! `hypedc reach --set NAME=A..B/STEP`: the questions for each value of one or two numbers of the program, as a table, as
//! CSV, as JSON, and as a map of verdicts.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::Ordering;

use indicatif::{ProgressBar, ProgressDrawTarget};
use serde::Serialize;

use crate::compile::{Compilation, compile_changed};
use crate::corpus;
use crate::diagnostic::{Severity, render};
use crate::json::{self, Layout};
use crate::parallel::{self, TaskContext};
use crate::reach::Conclusion;
use crate::reach::query::{Answer, Kind, Session};
use crate::tabular::{Cell, Column, Table, csv};
use crate::view::{Shade, VerdictMap, VerdictPanel, verdict_map_svg};

use super::question::{ReachChanges, query, recorded_settings, refusal};
use super::refuted::{Refuted, RunInfo, command_line};
use crate::cli::Exit;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::disk::Disk;
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, choose_world, find_world, load_changed, plain_error, program_sha256, written};
use crate::cli::sweep::Sweep;
use crate::cli::watches::{TaskWatch, interrupted};

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// The verdicts over a sweep.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct SweepResult {
    /// The version of this format.
    version: u32,
    /// The path of the program.
    file: String,
    /// The world.
    world: String,
    /// How each point was searched.
    #[serde(flatten)]
    settings: corpus::Settings,
    /// The numbers that are swept.
    axes: Vec<Axis>,
    /// Whether the sweep was interrupted.
    stopped: bool,
    /// The points, in order; the second number varies fastest.
    points: Vec<Point>,
}

/// A number that is swept.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Axis {
    /// `Hero.jump_speed`
    name: String,
    /// Its values, as they are written.
    values: Vec<String>,
}

/// The answers for some values.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Point {
    /// The value of each number.
    values: Vec<String>,
    /// A hash of what the program with these values means; null if it does not compile.
    program_sha256: Option<String>,
    /// The answers, in the order of the questions.
    answers: Vec<Answer>,
    /// Why there are none: what is wrong with the program with these values.
    error: Option<String>,
    /// How a search has shown that the analysis is wrong about the world, a mistake of `hypedc`; null if none has.
    refuted: Option<String>,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(SweepResult)
}

pub(super) fn run(args: &ReachArgs, sweep: &Sweep<'_>) -> io::Result<Exit> {
    let of = &args.corpus;
    if args.explore
        || args.person.has_layers()
        || args.tree
        || args.save_inputs.is_some()
        || [&of.results, &of.junit, &of.baseline].iter().any(|path| path.is_some())
    {
        plain_error(
            "a sweep is a table of verdicts: `--csv`, `--svg` and `--format json` write it, other files are not written",
        )?;
        return Ok(Exit::Refused);
    }
    if args.map.len() > 1 || args.map.iter().any(|path| path.is_dir()) {
        plain_error("a sweep is about one level: give one with `--map`")?;
        return Ok(Exit::Refused);
    }
    // A bad question is bad for all values, so it is reported before any of them. A bad value is a row of its own, if
    // another one is good.
    let level = args.reading.of(args.map.first().map(AsRef::as_ref));
    let set = |point: usize| ReachChanges::new(args).setting(&sweep.numbers(point));
    let compiles = |point: &usize| compile_changed(&args.file, level, &set(*point).changes(), &Disk).program.is_some();
    let last = sweep.points().saturating_sub(1);
    let first = set([0, last, last / 2].into_iter().find(compiles).unwrap_or(0));
    let Some(mut loaded) = load_changed(&args.file, level, &first.changes())? else { return Ok(Exit::Refused) };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let query = match query(args, &mut loaded, world) {
        Ok(query) => query,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    let table = &loaded.program.worlds[world];
    let questions: Vec<(Kind, String)> =
        query.targets.iter().map(|target| (target.kind(), target.name(table).to_string())).collect();
    let flag = interrupted();
    let stop = || flag.load(Ordering::SeqCst);
    let bar = ProgressBar::with_draw_target(Some(sweep.points() as u64), ProgressDrawTarget::stderr());
    let mut points: Vec<Option<Point>> = std::iter::repeat_with(|| None).take(sweep.points()).collect();
    let task = |at: usize, context: &TaskContext<'_, Point>| context.submit(point(args, sweep, at, context));
    parallel::work(points.len(), parallel::threads(args.threads), &stop, &task, &mut |at, point| {
        bar.inc(1);
        if let Some(place) = points.get_mut(at) {
            *place = Some(point);
        }
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    let stopped = stop();
    // The searches of the last points of an interrupted sweep may be incomplete.
    let points: Vec<Point> = points.into_iter().map_while(|point| point).collect();
    let axis = |(name, values): &(&str, &[String])| Axis { name: name.to_string(), values: values.to_vec() };
    let result = SweepResult {
        version: RESULT_VERSION,
        file: args.file.display().to_string(),
        world: table.name.clone(),
        settings: recorded_settings(args, &query.settings),
        axes: sweep.axes.iter().map(axis).collect(),
        stopped,
        points,
    };
    let files = [(&args.corpus.csv, csv_text as fn(&SweepResult, &[(Kind, String)]) -> String), (&args.svg, svg)];
    for (path, text) in files {
        let Some(path) = path else { continue };
        if !written(path, &text(&result, &questions))? {
            return Ok(Exit::Refused);
        }
    }
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Human => write!(out, "{}", text(&result, sweep, &questions, args))?,
        ResultFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    let is_good = |point: &Point| point.error.is_none() && point.answers.iter().all(|answer| answer.is_expected);
    let is_yes = !stopped && result.points.iter().all(|point| is_good(point) && point.refuted.is_none());
    Ok(if is_yes { Exit::Yes } else { Exit::No })
}

/// Asks all questions about the program with the values of a point.
fn point(args: &ReachArgs, sweep: &Sweep<'_>, at: usize, task: &TaskContext<'_, Point>) -> Point {
    let values = sweep.values(at).into_iter().map(str::to_string).collect();
    let blank = Point { values, program_sha256: None, answers: Vec::new(), error: None, refuted: None };
    let path: Option<&Path> = args.map.first().map(AsRef::as_ref);
    let changes = ReachChanges::new(args).setting(&sweep.numbers(at));
    let Compilation { sources, program, diagnostics, .. } =
        compile_changed(&args.file, args.reading.of(path), &changes.changes(), &Disk);
    let Some(program) = program else {
        let errors = diagnostics.iter().filter(|found| found.severity == Severity::Error);
        return Point { error: Some(render::short(&sources, errors).trim_end().to_string()), ..blank };
    };
    let mut loaded = Loaded { sources, program };
    let world = find_world(&loaded.program, &args.file, args.world.as_deref()).map_err(Refusal::of);
    let asked = world.and_then(|world| Ok((world, query(args, &mut loaded, world)?)));
    let (world, mut query) = match asked {
        Ok(asked) => asked,
        Err(why) => return Point { error: Some(why.text(&loaded.sources)), ..blank },
    };
    // Threads are used for points.
    query.settings.threads = 1;
    query.settings.records = false;
    let watch = || TaskWatch::new(task, args.seconds);
    let session = Session::new(&loaded.program, world, query, &watch());
    let mut all = Vec::new();
    for &target in &session.query().targets {
        match session.find(target, &watch()) {
            Ok(found) => all.push(found),
            Err(error) => {
                let why = refusal(args, &loaded, world, &error).text(&loaded.sources);
                return Point { error: Some(why), ..blank };
            }
        }
    }
    let refuted = session.refutation().map(|refutation| {
        let info = RunInfo { file: &args.file, level: path, seed: args.seed, command: command_line() };
        Refuted::saved(&loaded.program, world, &refutation, &info).line()
    });
    Point {
        program_sha256: Some(program_sha256(&loaded.program)),
        // After all searches: one can withdraw the proof of another.
        answers: all.iter_mut().map(|found| session.answer(found, &loaded.sources)).collect(),
        refuted,
        ..blank
    }
}

impl Point {
    fn verdict(&self, question: usize) -> Conclusion {
        self.answers.get(question).map_or(Conclusion::Error, |answer| answer.verdict)
    }

    fn steps(&self, question: usize) -> Option<u64> {
        self.answers.get(question)?.steps
    }
}

/// What was found, in a few words, for each run of values with the same verdict: of one sweep only.
fn summary(result: &SweepResult, question: usize) -> String {
    let verdict = |point: &Point| point.verdict(question);
    let runs = result.points.chunk_by(|a, b| verdict(a) == verdict(b)).filter_map(|run| {
        let (first, last) = (run.first()?, run.last()?);
        let range = match run.len() {
            1 => format!("at {}", first.values.concat()),
            // Nothing is said of values in between.
            count => format!("at the {count} values from {} to {}", first.values.concat(), last.values.concat()),
        };
        Some(format!("{} {range}", verdict(first).words()))
    });
    runs.collect::<Vec<_>>().join(", ")
}

fn text(result: &SweepResult, sweep: &Sweep<'_>, questions: &[(Kind, String)], args: &ReachArgs) -> String {
    let SweepResult { file, world, settings, points, .. } = result;
    let set: String = settings.set.iter().map(|set| format!(", {set}")).collect();
    let mut out = format!("{file}, world {world}, seed {}{set}: {}\n", settings.seed, sweep.text());
    if !args.quiet {
        for (index, (kind, goal)) in questions.iter().enumerate() {
            out.push_str(&match sweep.axes.as_slice() {
                [_, (_, columns)] => format!("{} {goal}\n{}", kind.name(), matrix(result, columns.len(), index)),
                _ if questions.len() == 1 => table(points, sweep, index),
                _ => format!("{} {goal}\n{}", kind.name(), table(points, sweep, index)),
            });
        }
    }
    if sweep.axes.len() == 1 {
        for (index, (kind, goal)) in questions.iter().enumerate() {
            out.push_str(&format!("{} {goal}: {}\n", kind.name(), summary(result, index)));
        }
    } else if !args.quiet {
        out.push_str("a number is the steps of a path");
        let shown = Conclusion::ALL.into_iter().filter(|verdict| sign(*verdict).is_some());
        let is_there = |verdict: &Conclusion| {
            (0..questions.len()).any(|index| points.iter().any(|point| point.verdict(index) == *verdict))
        };
        let signs =
            shown.filter(is_there).filter_map(|verdict| Some(format!("{} {}", sign(verdict)?, verdict.words())));
        signs.for_each(|sign| out.push_str(&format!(", {sign}")));
        out.push('\n');
    }
    let mut errors: Vec<&str> = points.iter().filter_map(|point| point.error.as_deref()).collect();
    errors.dedup();
    errors.iter().for_each(|error| out.push_str(&format!("error: {error}\n")));
    points.iter().filter_map(|point| point.refuted.as_ref()).for_each(|why| out.push_str(&format!("{why}\n")));
    for (path, what) in [(&args.corpus.csv, "table"), (&args.svg, "drawn")] {
        if let Some(path) = path {
            out.push_str(&format!("{what}   {}\n", path.display()));
        }
    }
    if result.stopped {
        out.push_str(&format!("stopped after {} of {} points\n", points.len(), sweep.points()));
    }
    out
}

/// The sign of a verdict without a path in a small table.
fn sign(verdict: Conclusion) -> Option<&'static str> {
    match verdict {
        Conclusion::Reached | Conclusion::Violated => None,
        Conclusion::NotFound | Conclusion::NotAnswered => Some("?"),
        Conclusion::Exhausted => Some("~"),
        Conclusion::ProvenUnreachable => Some("x"),
        Conclusion::Error => Some("!"),
    }
}

/// A row for each value.
fn table(points: &[Point], sweep: &Sweep<'_>, question: usize) -> String {
    let mut columns = sweep.columns();
    columns.extend([Column::left("", "verdict"), Column::right("", "steps"), Column::right("", "seconds of play")]);
    columns.push(Column::right("", "nodes"));
    let mut table = Table::new(columns);
    for (at, point) in points.iter().enumerate() {
        let mut cells = sweep.cells(at);
        let answer = point.answers.get(question);
        cells.extend([
            point.verdict(question).words().into(),
            Cell::of(point.steps(question).map(|steps| steps as f64), |steps| format!("{steps:.0}")),
            Cell::of(answer.and_then(|answer| answer.seconds_of_play), |seconds| format!("{seconds:.2}")),
            Cell::of(answer.map(|answer| answer.nodes as f64), |nodes| format!("{nodes:.0}")),
        ]);
        table.push(cells);
    }
    table.text()
}

/// Two sweeps: the first downwards, the second to the right.
fn matrix(result: &SweepResult, columns: usize, question: usize) -> String {
    let [rows, across] = result.axes.as_slice() else { return String::new() };
    let mut heads = vec![Column::right("", rows.name.clone())];
    heads.extend(across.values.iter().map(|value| Column::right("", value.clone())));
    let mut table = Table::new(heads);
    let points = result.points.chunks(columns.max(1));
    for (value, row) in rows.values.iter().zip(points) {
        let mut cells: Vec<Cell> = vec![value.as_str().into()];
        cells.extend(row.iter().map(|point| match (sign(point.verdict(question)), point.steps(question)) {
            (None, Some(steps)) => steps.to_string().into(),
            (sign, _) => sign.unwrap_or("-").into(),
        }));
        cells.resize_with(columns + 1, Cell::empty);
        table.push(cells);
    }
    format!("to the right: {}\n{}", across.name, table.text())
}

/// A line for each point and question.
fn csv_text(result: &SweepResult, questions: &[(Kind, String)]) -> String {
    let names = result.axes.iter().map(|axis| axis.name.as_str());
    let rest = ["kind", "goal", "verdict", "steps", "seconds_of_play", "nodes", "inputs", "program_sha256", "error"];
    let mut out = csv::line(names.chain(rest)) + "\n";
    for point in &result.points {
        for (index, (kind, goal)) in questions.iter().enumerate() {
            let answer = point.answers.get(index);
            let text = |text: Option<String>| text.unwrap_or_default();
            let mut cells = point.values.clone();
            cells.extend([
                kind.name().to_string(),
                goal.clone(),
                point.verdict(index).name().to_string(),
                text(point.steps(index).map(|steps| steps.to_string())),
                text(answer.and_then(|answer| answer.seconds_of_play).map(|seconds| seconds.to_string())),
                text(answer.map(|answer| answer.nodes.to_string())),
                text(answer.and_then(|answer| answer.inputs.clone())),
                text(point.program_sha256.clone()),
                text(point.error.clone()),
            ]);
            out.push_str(&csv::line(cells));
            out.push('\n');
        }
    }
    out
}

/// How a map of verdicts shows one.
pub(in crate::cli) fn shade(verdict: Conclusion, kind: Kind) -> Shade {
    match (verdict, kind) {
        (Conclusion::Reached, _) => Shade::Reached,
        (Conclusion::Violated, _) => Shade::Violated,
        (Conclusion::ProvenUnreachable, Kind::Never) => Shade::Safe,
        (Conclusion::ProvenUnreachable, Kind::Goal) => Shade::Unreachable,
        (Conclusion::Exhausted, _) => Shade::Exhausted,
        (Conclusion::NotFound | Conclusion::NotAnswered, _) => Shade::Open,
        (Conclusion::Error, _) => Shade::Error,
    }
}

/// The map of verdicts, a panel for each question.
fn svg(result: &SweepResult, questions: &[(Kind, String)]) -> String {
    let panels = questions.iter().enumerate().map(|(index, (kind, goal))| VerdictPanel {
        title: format!("{} {goal}", kind.name()),
        cells: result.points.iter().map(|point| (shade(point.verdict(index), *kind), point.steps(index))).collect(),
    });
    let axes = result.axes.iter().map(|axis| (axis.name.clone(), axis.values.clone())).collect();
    let title = format!("{}, world {}", result.file, result.world);
    verdict_map_svg(&VerdictMap { title, axes, panels: panels.collect() })
}

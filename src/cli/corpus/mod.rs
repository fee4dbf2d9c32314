//! `hypedc reach` for many levels: selects levels, runs them on threads, writes the files and the summary. [`level`]
//! processes a single level; [`crate::corpus`] defines the rows.

pub(in crate::cli) mod args;
pub(in crate::cli) mod files;
pub(in crate::cli) mod level;
mod page;
mod shard;

use std::collections::BTreeSet;
use std::fs::{File, read_dir, write};
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use crate::compile::{Compilation, compile_changed};
use crate::corpus::{Comparison, Key, Record, Row, Shard, ShardHeader, StoredRow, junit, summary, table};
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Code, Severity};
use crate::json::{self, Layout};
use crate::parallel::{self, TaskContext};
use crate::reach::query::Kind;

use crate::cli::Exit;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::disk::Disk;
use crate::cli::reach::question::{ReachChanges, query, recorded_settings};
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, find_world, has_maps, load_changed, plain_error, written};
use crate::cli::watches::interrupted;
use files::{CsvFile, RecordFile, read};
use level::{CorpusContext, Level, TaskResult};

/// The version of the JSON result.
const RESULT_VERSION: u32 = 4;

/// The extensions of level files in a folder.
const EXTENSIONS: [&str; 3] = ["txt", "tmx", "tmj"];

/// Whether the arguments concern many levels, or use an option that only those have.
pub(in crate::cli) fn is_corpus_run(args: &ReachArgs) -> bool {
    // A sweep has a table of its own, of one level.
    if !args.numbers.sweeps().is_empty() {
        return false;
    }
    let of = &args.corpus;
    let wants = [&of.results, &of.csv, &of.junit, &of.baseline].iter().any(|path| path.is_some());
    wants || args.map.len() > 1 || args.map.iter().any(|path| path.is_dir())
}

/// Searches for the targets in each level.
pub(in crate::cli) fn run(args: &ReachArgs) -> io::Result<Exit> {
    if args.person.has_layers() {
        plain_error("`--skill` shows one level in layers: give one level with `--map`")?;
        return Ok(Exit::Refused);
    }
    if args.page.engine.is_some() {
        plain_error("`--engine` is for the page about one level, which plays it; the page of a table shows pictures")?;
        return Ok(Exit::Refused);
    }
    // A bad question is bad for all levels, so it is reported before any of them.
    let Some((mut loaded, takes_levels)) = load_questions(args)? else {
        return Ok(Exit::Refused);
    };
    let asked = find_world(&loaded.program, &args.file, args.world.as_deref()).map_err(Refusal::of);
    let asked = asked.and_then(|world| {
        let query = query(args, &mut loaded, world)?;
        let takes_levels = takes_levels || loaded.program.worlds[world].open.is_some();
        Ok((world, query, levels(args, takes_levels)?))
    });
    let (world, query, levels) = match asked {
        Ok(asked) => asked,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    let world = &loaded.program.worlds[world];
    if args.map.is_empty() && !has_maps(&loaded, [world])? {
        return Ok(Exit::Refused);
    }
    let targets: Vec<(Kind, String)> =
        query.targets.iter().map(|target| (target.kind(), target.name(world).to_string())).collect();
    let opened = shard::header(args, (&loaded.program, &world.name), &levels, &targets)
        .and_then(|shard| Ok((Files::open(args, shard.as_ref())?, shard)));
    let (files, shard) = match opened {
        Ok(opened) => opened,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    let none = Record::default();
    let record = files.record.as_ref().map_or(&none, |file| &file.found).clone();
    let context = CorpusContext {
        args,
        world: world.name.clone(),
        is_asked: shard::is_asked(shard.as_ref(), levels.len() * targets.len()),
        targets,
        settings: recorded_settings(args, &query.settings),
        record: &record,
    };
    Run { context, levels, files, started: Instant::now() }.go()
}

/// The program with its questions, and whether a level was needed for it. Without one the questions about instances
/// that only levels have cannot be read: then the first level that can be read serves.
fn load_questions(args: &ReachArgs) -> io::Result<Option<(Loaded, bool)>> {
    let open = args.reading.of(None);
    let changes = ReachChanges::new(args);
    let changes = &changes.changes();
    let is_compiled = args.file.extension().is_some_and(|extension| extension == "json");
    if !is_compiled && !args.map.is_empty() {
        let compiled = compile_changed(&args.file, open, changes, &Disk);
        let mut errors = compiled.diagnostics.iter().filter(|d| d.severity == Severity::Error);
        if compiled.program.is_none() && errors.all(|d| d.code == Code::NoQuestion) {
            // A level that is no level is a row of its own.
            for level in levels(args, true).unwrap_or_default() {
                let given = args.reading.of(level.path.as_deref());
                let Compilation { sources, program, .. } = compile_changed(&args.file, given, changes, &Disk);
                if let Some(program) = program {
                    return Ok(Some((Loaded { sources, program }, true)));
                }
            }
        }
    }
    Ok(load_changed(&args.file, open, changes)?.map(|loaded| (loaded, false)))
}

/// The files of a run.
struct Files {
    record: Option<RecordFile>,
    csv: Option<CsvFile>,
    baseline: Option<Record>,
}

impl Files {
    /// Opens all files early: a misspelt folder is reported now, not after an hour.
    fn open(args: &ReachArgs, shard: Option<&ShardHeader>) -> Result<Self, Refusal> {
        let of = &args.corpus;
        let baseline = of.baseline.as_deref().map(|path| read(path, "a baseline")).transpose()?;
        let record =
            of.results.as_deref().map(|path| RecordFile::open(path, shard)).transpose().map_err(Refusal::Plain)?;
        for path in of.junit.iter().chain(&args.page.html) {
            let opened = File::options().create(true).append(true).open(path);
            opened.map_err(|error| Refusal::Plain(format!("cannot write `{}`: {error}", path.display())))?;
        }
        let csv = of.csv.as_deref().map(CsvFile::create).transpose().map_err(Refusal::Plain)?;
        Ok(Files { record, csv, baseline })
    }
}

/// A run over all levels.
struct Run<'r> {
    context: CorpusContext<'r>,
    levels: Vec<Level>,
    files: Files,
    started: Instant,
}

impl Run<'_> {
    fn go(mut self) -> io::Result<Exit> {
        let args = self.context.args;
        let flag = interrupted();
        let stop = || flag.load(Ordering::SeqCst);
        let count = self.context.targets.len();
        let mut rows: Vec<Option<StoredRow>> = vec![None; self.levels.len() * count];
        let (mut kept, mut broken) = (0, None);
        let all = self.context.is_asked.iter().filter(|is| **is).count();
        let bar = bar(all);
        if let (Some(path), true) = (&args.corpus.results, self.files.record.as_ref().is_some_and(|file| file.was_cut))
        {
            writeln!(io::stderr(), "the last row of `{}` is incomplete and will be computed again", path.display())?;
        }
        let Run { context, levels, files, .. } = &mut self;
        let task = |at: usize, task_context: &TaskContext<'_, TaskResult>| context.level(at, &levels[at], task_context);
        parallel::work(levels.len(), parallel::threads(args.threads), &stop, &task, &mut |level, done| {
            bar.inc(1);
            let written = match done {
                TaskResult::Broken(why) => Err(why),
                TaskResult::Stored(target, row) => {
                    kept += 1;
                    files.csv.as_mut().map_or(Ok(()), |csv| csv.add(&row.row)).map(|()| (target, *row))
                }
                TaskResult::New(target, row) => files.add(*row).map(|row| (target, row)),
            };
            match written {
                Ok((target, row)) => {
                    rows[level * count + target] = Some(row);
                    ControlFlow::Continue(())
                }
                Err(why) => {
                    broken = broken.take().or(Some(why));
                    ControlFlow::Break(())
                }
            }
        });
        bar.finish_and_clear();
        if let Some(why) = broken {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
        let rows: Vec<&StoredRow> = rows.iter().flatten().collect();
        let is_stopped = rows.len() < all;
        let comparison = self.files.baseline.as_ref().map(|record| {
            let done: BTreeSet<Key> = rows.iter().map(|kept| kept.row.key()).collect();
            // A row that was not computed is not missing.
            let old =
                record.rows.iter().filter(|(key, _)| !is_stopped || done.contains(key)).map(|(_, kept)| &kept.row);
            Comparison::of(old, rows.iter().map(|kept| &kept.row), args.corpus.tolerance / 100.0)
        });
        let seconds = self.started.elapsed().as_secs_f64();
        let note = match kept {
            0 => String::new(),
            _ => format!(
                ", {kept} of them kept from `{}`",
                args.corpus.results.as_deref().unwrap_or(Path::new("")).display()
            ),
        };
        // Before anything is printed: the reader of the output may be gone.
        if let Err(why) = self.files.finish(args, &rows, is_stopped) {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
        let presentation = Presentation { args, rows: &rows, comparison: comparison.as_ref(), is_stopped };
        let note = format!("{note}; {seconds:.1} s");
        if let Some(path) = &args.page.html
            && !written(path, &presentation.page(&self.context.world, &note))?
        {
            return Ok(Exit::Refused);
        }
        presentation.show(&self.context.world, &note)?;
        if is_stopped {
            let on = match &args.corpus.results {
                Some(path) => format!("they are in `{}`, and the same command continues from there", path.display()),
                None => "with `--results FILE` they are kept, and the same command continues from there".to_string(),
            };
            writeln!(io::stderr(), "stopped when {} of {all} were done; {on}", rows.len())?;
        }
        let is_no = match &comparison {
            Some(comparison) => comparison.is_failure(),
            None => rows.iter().any(|kept| !kept.row.answer.is_expected),
        };
        // A wrong analysis is never expected.
        let is_refuted = rows.iter().any(|kept| kept.row.refuted.is_some());
        Ok(match is_stopped && args.corpus.shard.is_some() {
            // Schedulers may take an answer of no as done: that a shard is not done must show.
            true => Exit::Refused,
            false if is_no || is_stopped || is_refuted => Exit::No,
            false => Exit::Yes,
        })
    }
}

impl Files {
    /// Stores a row.
    fn add(&mut self, row: Row) -> Result<StoredRow, String> {
        let kept = StoredRow::new(row).map_err(|error| error.to_string())?;
        if let Some(record) = &mut self.record {
            record.add(&kept)?;
        }
        if let Some(csv) = &mut self.csv {
            csv.add(&kept.row)?;
        }
        Ok(kept)
    }

    /// Sorts the rows, and writes the files that are written once.
    fn finish(self, args: &ReachArgs, rows: &[&StoredRow], is_stopped: bool) -> Result<(), String> {
        if let Some(csv) = self.csv {
            csv.finish(rows)?;
        }
        // Rows of unprocessed levels stay for the next run.
        if let (Some(record), false) = (self.record, is_stopped) {
            let left_out = record.finish(rows)?;
            if let (1.., Some(path)) = (left_out, &args.corpus.results) {
                let rows = if left_out == 1 { "row was" } else { "rows were" };
                let _ = writeln!(
                    io::stderr(),
                    "{left_out} {rows} taken out of `{}`: no question of this run has them",
                    path.display()
                );
            }
        }
        if let Some(path) = &args.corpus.junit {
            let rows: Vec<&Row> = rows.iter().map(|kept| &kept.row).collect();
            let written = junit(&rows).and_then(|text| write(path, text));
            written.map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        }
        Ok(())
    }
}

/// The summary at the end.
struct Presentation<'t> {
    args: &'t ReachArgs,
    rows: &'t [&'t StoredRow],
    comparison: Option<&'t Comparison>,
    is_stopped: bool,
}

/// The answers about many levels.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct JsonResult<'t> {
    /// The version of this format.
    version: u32,
    /// The version of `hypedc`.
    hypedc: &'static str,
    /// The path of the program.
    file: String,
    /// The world.
    world: &'t str,
    /// Which part of the questions it is about; left out if it is about all.
    #[serde(skip_serializing_if = "Option::is_none")]
    shard: Option<Shard>,
    /// Whether the run was interrupted.
    stopped: bool,
    /// The rows.
    rows: Vec<&'t Row>,
    /// What changed since the baseline; null if there is none.
    changes: Option<&'t Comparison>,
}

/// The schema of the answers about many levels.
#[cfg(feature = "testing")]
pub(super) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(JsonResult<'_>)
}

impl Presentation<'_> {
    fn show(&self, world: &str, note: &str) -> io::Result<()> {
        let rows: Vec<&Row> = self.rows.iter().map(|kept| &kept.row).collect();
        let file = self.args.file.display().to_string();
        let mut out = io::stdout().lock();
        if self.args.format == ResultFormat::Json {
            let (is_stopped, changes) = (self.is_stopped, self.comparison);
            let (version, hypedc) = (RESULT_VERSION, env!("CARGO_PKG_VERSION"));
            let shard = self.args.corpus.shard;
            let result = JsonResult { version, hypedc, file, world, shard, stopped: is_stopped, rows, changes };
            json::write(&result, Layout::Indented, &mut out)?;
            return writeln!(out);
        }
        let shard = self.args.corpus.shard.map_or(String::new(), |shard| format!(", shard {shard}"));
        writeln!(out, "{file}, world {world}, seed {}{shard}", self.args.seed)?;
        write!(out, "{}", table(&rows))?;
        writeln!(out, "{}{note}", summary(&rows))?;
        if let (Some(comparison), Some(path)) = (self.comparison, &self.args.corpus.baseline) {
            write!(out, "{}", comparison.text(&path.display().to_string()))?;
        }
        Ok(())
    }
}

/// The selected levels, without duplicates.
fn levels(args: &ReachArgs, is_open: bool) -> Result<Vec<Level>, Refusal> {
    if args.tree {
        return Err(Refusal::Plain("`--tree` is for a single level: rows have no trees".to_string()));
    }
    if args.map.is_empty() {
        return Ok(vec![Level { path: None, name: None }]);
    }
    if !is_open {
        let why = format!("the world has its map in `{}`, and takes none from the command line", args.file.display());
        let help = Some("write `map level TILES` or `map level legend \"FILE\" tile 16 x 16` in a space".to_string());
        return Err(Refusal::of(NoQuestion { why, near: None, help }));
    }
    all_levels(&args.map).map_err(Refusal::Plain)
}

/// The levels of paths and folders, without duplicates.
pub(in crate::cli) fn all_levels(map: &[PathBuf]) -> Result<Vec<Level>, String> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for path in map {
        let found = if path.is_dir() { in_folder(path)? } else { vec![path.clone()] };
        for path in found {
            // A leading `./` does not change the name in the rows.
            let path = path.strip_prefix(".").map_or(path.clone(), Path::to_path_buf);
            if !paths.contains(&path) {
                paths.push(path);
            }
        }
    }
    let names = names(&paths);
    let is_one = paths.len() == 1;
    Ok(paths
        .into_iter()
        .zip(names)
        .map(|(path, name)| Level { path: Some(path), name: (!is_one).then_some(name) })
        .collect())
}

/// The levels in a folder, by name.
fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let cannot = |error: io::Error| format!("cannot read `{}`: {error}", folder.display());
    let mut found = Vec::new();
    for entry in read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        if path.is_file() && path.extension().is_some_and(|e| EXTENSIONS.iter().any(|known| e == *known)) {
            found.push(path);
        }
    }
    if found.is_empty() {
        let ends = EXTENSIONS.map(|e| format!("`.{e}`")).join(", ");
        return Err(format!("`{}` holds no level: no file that ends in {ends}", folder.display()));
    }
    found.sort();
    Ok(found)
}

/// Names of levels in file names: the file stem, or the whole path if two stems are equal.
fn names(paths: &[PathBuf]) -> Vec<String> {
    let stem = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let long = |path: &PathBuf| {
        let text = path.display().to_string();
        text.trim_start_matches(['.', '/']).replace(['/', '\\', ':', '.'], "-")
    };
    let stems: Vec<String> = paths.iter().map(stem).collect();
    let is_alone = |name: &String| stems.iter().filter(|other| *other == name).count() == 1;
    stems.iter().zip(paths).map(|(name, path)| if is_alone(name) { name.clone() } else { long(path) }).collect()
}

/// A progress bar, on a terminal only.
pub(in crate::cli) fn bar(questions: usize) -> ProgressBar {
    let target = if io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(questions as u64), target);
    let style = ProgressStyle::with_template("{spinner} {pos} of {len} done  {elapsed}, about {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar
}

//! `hypedc test`: runs the tests of programs in parallel, and shows what came of them. [`crate::suite`] runs one test.

pub(in crate::cli) mod args;
mod record;
mod text;
mod ways;

use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crate::compile::{Changes, Compilation, NumberSetting, TestCase, compile_changed};
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::ir::{Program, WorldId};
use crate::json::{self, Layout};
use crate::parallel;
use crate::source::SourceMap;
use crate::suite::{CoverageResult, NoWays, Subject, SuiteResult, TestOptions, Tested, Ways, junit, lcov, run_test};
use crate::watch::Watch;
use crate::why::{Covered, PlaceCoverage};

use crate::cli::Exit;
use crate::cli::args::ResultFormat;
use crate::cli::disk::Disk;
use crate::cli::report::{Loaded, colored, has_maps, plain_error, show, show_fact, written};
use crate::cli::watches::Interrupt;
use args::TestArgs;
use ways::WayFolder;

/// A program with its tests.
struct TestedFile {
    path: PathBuf,
    sources: SourceMap,
    program: Arc<Program>,
    /// The chosen tests.
    cases: Vec<TestCase>,
    ways: Box<dyn Ways>,
}

pub(in crate::cli) fn run(args: &TestArgs) -> io::Result<Exit> {
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    if let Some(goal) = &args.record {
        return record::run(args, goal, &numbers);
    }
    let Some((files, filtered)) = load(args, &numbers)? else { return Ok(Exit::Refused) };
    let started = Instant::now();
    let mut result = SuiteResult::new(args.seed, args.nodes, filtered);
    let covered = run_all(args, &files, &numbers, &mut result)?;
    result.seconds = started.elapsed().as_secs_f64();
    if let (Some(path), Some(covered)) = (&args.lcov, &covered)
        && !written(path, &lcov(covered))?
    {
        return Ok(Exit::Refused);
    }
    if let Some(path) = &args.junit
        && !written(path, &junit(&result.tests.iter().collect::<Vec<_>>())?)?
    {
        return Ok(Exit::Refused);
    }
    result.coverage = covered.filter(|_| args.coverage).as_ref().map(CoverageResult::new);
    match args.format {
        ResultFormat::Human => show_result(&files, &result)?,
        ResultFormat::Json => {
            let mut out = io::stdout().lock();
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    Ok(if result.failed == 0 && result.not_run == 0 { Exit::Yes } else { Exit::No })
}

/// The programs with the chosen tests, and the number of others; reports why there is nothing to test.
fn load(args: &TestArgs, numbers: &[NumberSetting<'_>]) -> io::Result<Option<(Vec<TestedFile>, usize)>> {
    let (mut files, mut filtered) = (Vec::new(), 0);
    let mut is_fine = true;
    for path in &args.files {
        let changes = Changes { numbers, ..Changes::default() };
        let Compilation { sources, program, diagnostics, mut tests } =
            compile_changed(path, args.level.file(), &changes, &Disk);
        let Some(program) = program else {
            show(&sources, &diagnostics)?;
            is_fine = false;
            continue;
        };
        let all = tests.len();
        let name = args.filter.as_ref().map(|text| text.to_lowercase());
        tests.retain(|case| {
            let is_named = name.as_ref().is_none_or(|text| case.name.to_lowercase().contains(text.as_str()));
            is_named && args.world.as_ref().is_none_or(|world| *world == case.world_name)
        });
        filtered += all - tests.len();
        let loaded = Loaded { sources, program };
        let worlds: BTreeSet<WorldId> = tests.iter().map(|case| case.world).collect();
        is_fine &= has_maps(&loaded, worlds.iter().map(|world| &loaded.program.worlds[*world]))?;
        let ways: Box<dyn Ways> = match (&args.ways, args.no_ways) {
            (Some(folder), _) => Box::new(WayFolder::of_project(folder.clone(), path)),
            (None, true) => Box::new(NoWays),
            (None, false) => WayFolder::in_cache().map_or(Box::new(NoWays), |ways| Box::new(ways) as Box<dyn Ways>),
        };
        let Loaded { sources, program } = loaded;
        files.push(TestedFile { path: path.clone(), sources, program, cases: tests, ways });
    }
    if !is_fine {
        return Ok(None);
    }
    if files.iter().all(|file| file.cases.is_empty()) {
        let (why, help) = match filtered {
            0 => {
                ("there are no tests", "add one to a world, such as `test \"the exit\" { reachable exit within 20s }`")
            }
            _ => ("no test is chosen", "leave out `--filter` or `--world` to run all tests"),
        };
        let blank = SourceMap::new();
        show_fact(&blank, NoQuestion { why: why.to_string(), near: None, help: Some(help.to_string()) })?;
        return Ok(None);
    }
    Ok(Some((files, filtered)))
}

/// The watch over one test: ctrl-C, and its time.
struct TestWatch {
    interrupt: Interrupt,
    started: Instant,
    seconds: Option<f64>,
}

impl Watch for TestWatch {
    fn stop(&self) -> bool {
        let is_late = |limit: f64| self.started.elapsed().as_secs_f64() >= limit;
        self.interrupt.stop() || self.seconds.is_some_and(is_late)
    }
}

/// Runs all tests and shows each in order; returns what they cover, if that is asked for.
fn run_all(
    args: &TestArgs,
    files: &[TestedFile],
    numbers: &[NumberSetting<'_>],
    result: &mut SuiteResult,
) -> io::Result<Option<PlaceCoverage>> {
    let tasks: Vec<(usize, usize)> =
        files.iter().enumerate().flat_map(|(file, of)| (0..of.cases.len()).map(move |case| (file, case))).collect();
    let covers = args.coverage || args.lcov.is_some();
    let task = |at: usize, context: &parallel::TaskContext<'_, Tested>| {
        let (file, case) = tasks[at];
        let (file, case) = (&files[file], &files[file].cases[case]);
        let watch = TestWatch { interrupt: Interrupt::new(), started: Instant::now(), seconds: args.seconds };
        let subject = Subject { file: &file.path, level: args.level.file(), numbers, files: &Disk };
        let options = TestOptions { nodes: args.nodes, seed: args.seed, covers, ways: &*file.ways };
        let mut tested = run_test(&subject, (&file.program, &file.sources), case, &options, &watch);
        tested.result.seconds = watch.started.elapsed().as_secs_f64();
        context.submit(tested);
    };
    let threads = parallel::threads(args.threads);
    let mut all: Vec<Option<Tested>> = tasks.iter().map(|_| None).collect();
    let (mut shown, mut failed) = (0, Ok(()));
    let interrupt = Interrupt::new();
    parallel::work(tasks.len(), threads, &|| interrupt.stop(), &task, &mut |at, tested| {
        all[at] = Some(tested);
        // Results are shown in the order of the tests, each as soon as those before it are there.
        while let Some(tested) = all.get(shown).and_then(Option::as_ref) {
            if args.format == ResultFormat::Human && !args.quiet && failed.is_ok() {
                failed = show_line(files, tasks[shown], tested);
            }
            shown += 1;
        }
        if failed.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    failed?;
    let mut sums: Vec<Option<Covered>> = files.iter().map(|_| None).collect();
    for ((file, _), tested) in tasks.iter().zip(all) {
        let Some(Tested { result: test, covered }) = tested else {
            result.not_run += 1;
            continue;
        };
        result.add(test);
        if let Some(covered) = covered {
            sums[*file].get_or_insert_with(|| Covered::new(&files[*file].program)).add(&covered);
        }
    }
    let mut places = PlaceCoverage::default();
    for (file, covered) in files.iter().zip(&sums) {
        let worlds: BTreeSet<WorldId> = file.cases.iter().map(|case| case.world).collect();
        if let Some(covered) = covered {
            places.add(covered.places(&file.program, &file.sources, &worlds));
        }
    }
    Ok(covers.then_some(places))
}

/// The line of a test, below that of its file.
fn show_line(files: &[TestedFile], (file, case): (usize, usize), tested: &Tested) -> io::Result<()> {
    let of = &files[file];
    let mut out = io::stdout().lock();
    if case == 0 {
        let count = of.cases.len() as u64;
        writeln!(out, "{}: {}", of.path.display(), crate::cli::reach::counted(count, "test"))?;
    }
    let worlds: BTreeSet<WorldId> = of.cases.iter().map(|case| case.world).collect();
    write!(out, "{}", text::line(&tested.result, worlds.len() > 1))?;
    out.flush()
}

/// The failures, the coverage and the summary.
fn show_result(files: &[TestedFile], result: &SuiteResult) -> io::Result<()> {
    let color = colored(io::stdout().is_terminal());
    let mut out = io::stdout().lock();
    if result.failed > 0 {
        writeln!(out, "\nfailures:\n")?;
    }
    for test in result.tests.iter().filter(|test| !test.passed) {
        let sources = files.iter().find(|file| file.path.display().to_string() == test.file).map(|file| &file.sources);
        if let Some(sources) = sources {
            writeln!(out, "{}\n", text::failures(test, sources, color).trim_end_matches('\n'))?;
        }
    }
    if result.failed == 0 {
        writeln!(out)?;
    }
    if let Some(coverage) = &result.coverage {
        writeln!(out, "{}", text::coverage(coverage))?;
    }
    write!(out, "{}", text::summary(result))
}

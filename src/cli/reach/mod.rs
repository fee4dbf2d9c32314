//! `hypedc reach`: searches for inputs that reach a world's goals, with one verdict each. [`crate::cli::corpus`]
//! handles several levels. This part reads the questions from the arguments, and shows and saves the answers;
//! [`crate::reach::query`] answers them.

mod explore;
pub(in crate::cli) mod files;
mod page;
pub(in crate::cli) mod question;
pub(in crate::cli) mod refuted;
mod result;
mod robust;
mod skill;
mod sweep;
mod text;
mod why_not;

pub(in crate::cli) use sweep::shade;
pub(in crate::cli) use text::{Detail as ScriptDetail, counted, with_luck};
#[cfg(feature = "testing")]
pub(in crate::cli) use {skill::json_schema as skill_schema, sweep::json_schema as sweep_schema};

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::time::Instant;

use crate::ir::{World, WorldId};
use crate::json::{self, Layout};
use crate::reach::Target;
use crate::reach::query::{Phase, Session, Supervisor, unpressed_words};
use crate::view::Images;
use crate::watch::Watch;

use crate::cli::Exit;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::page::{Way, carried};
use crate::cli::pictures::images;
use crate::cli::play::export::Carried;
use crate::cli::report::{Loaded, choose_world, load_changed, plain_error, show_fact};
use crate::cli::sweep::swept;
use crate::cli::watches::{CommandWatch, Interrupt};
use files::{Destination, Saved};
use page::{report, violations, way};
use question::{ReachChanges, query, recorded_settings, refusal};
use refuted::{Refuted, RunInfo, command_line};
use result::RunResult;
use text::{Detail, Shown, answer_text};

pub(in crate::cli) fn run(args: &ReachArgs) -> io::Result<Exit> {
    if let Some(exit) = swept(&args.numbers, |sweep| sweep::run(args, sweep))? {
        return Ok(exit);
    }
    let level = args.reading.of(args.map.first().map(AsRef::as_ref));
    let Some(mut loaded) = load_changed(&args.file, level, &ReachChanges::new(args).changes())? else {
        return Ok(Exit::Refused);
    };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else {
        return Ok(Exit::Refused);
    };
    let query = match query(args, &mut loaded, world) {
        Ok(query) => query,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    if args.person.has_layers() {
        return skill::run(args, &loaded, (world, query));
    }
    let carried = match carried(&args.page, &args.file, level) {
        Ok(carried) => carried,
        Err(why) => return why.show(),
    };
    // The analysis counts towards the time for the first goal.
    let watch = CommandWatch::new("analysis", args.seconds);
    let started = Instant::now();
    let session = Session::new(&loaded.program, world, query, &watch);
    let seconds = started.elapsed().as_secs_f64();
    watch.finish();
    if args.explore {
        return explore::run(args, &loaded, world, &session, seconds);
    }
    answer_all(args, &loaded, (world, &session), seconds, carried.as_ref())
}

/// Searches for all targets, then shows the answers: a search can refute an earlier proof.
fn answer_all(
    args: &ReachArgs,
    loaded: &Loaded,
    (world, session): (WorldId, &Session),
    analysis_seconds: f64,
    carried: Option<&Carried>,
) -> io::Result<Exit> {
    let program = &loaded.program;
    let images = match carried {
        Some(_) => images(program, &args.file),
        None => Ok(Images::default()),
    };
    let images = match images {
        Ok(images) => images,
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    let settings = recorded_settings(args, &session.query().settings);
    let mut result = RunResult::new(&args.file, session, settings, analysis_seconds);
    let detail = Detail::of(args);
    if args.format == ResultFormat::Human && detail != Detail::Quiet {
        write!(io::stdout(), "{}", result.head())?;
    }
    let mut phases = Phases::new(args, &program.worlds[world], analysis_seconds);
    let all = match session.find_all(&mut phases) {
        Ok(all) => all,
        Err(error) => {
            refusal(args, loaded, world, &error).show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    let targets = session.query().targets.len();
    let mut exit = if all.len() < targets { Exit::No } else { Exit::Yes };
    result.refuted = session.refutation().map(|refutation| {
        let level = args.map.first().map(AsRef::as_ref);
        let info = RunInfo { file: &args.file, level, seed: args.seed, command: command_line() };
        Refuted::saved(program, world, &refutation, &info)
    });
    if result.refuted.is_some() {
        exit = exit.max(Exit::No);
    }
    let (mut ways, mut violated) = (Vec::new(), Vec::new());
    for (mut found, searched) in all.into_iter().zip(phases.searched) {
        let answer = session.answer(&mut found, &loaded.sources);
        let destination = Destination::new(args, None, &answer.goal, targets);
        let saved: Saved = match destination.save(session, &found, &answer, &Interrupt::new()) {
            Ok(saved) => saved,
            Err(refusal) => {
                refusal.show(&loaded.sources)?;
                return Ok(Exit::Refused);
            }
        };
        if let Some((fault, step)) = found.outcome.fault {
            show_fact(&loaded.sources, fault.fact(program, world, step))?;
        }
        if args.format == ResultFormat::Human {
            let (query, has_rooms) = (session.query(), program.worlds[world].spaces.len() > 1);
            let seconds = searched.seconds;
            let step = program.worlds[world].step.seconds();
            let unpressed = unpressed_words(program, &program.worlds[world], &query.unpressed);
            let shown =
                Shown { query, unpressed, saved: &saved, seconds, step, has_rooms, detail, is_verbose: args.verbose };
            write!(io::stdout(), "{}", answer_text(&answer, &shown))?;
        }
        if !answer.is_expected {
            exit = exit.max(Exit::No);
        }
        if carried.is_some() {
            let watch = Interrupt::new();
            ways.push(way(session, &found, &answer, (&images, searched.seconds), &watch)?);
            violated.extend(violations(session, &found, &answer, &watch)?);
        }
        result.add(answer, &found.outcome, searched.seconds, args.tree);
    }
    if let (Some(carried), Some(target)) = (carried, &args.page.html) {
        let mut report = report(session, &result);
        for way in violated {
            let is_known = ways.iter().any(|of: &Way| (of.kind, &of.name) == (way.kind, &way.name));
            if !is_known {
                ways.push(way);
            }
        }
        report.ways = ways;
        if let Err(why) = carried.save(target, Some(&program.worlds[world].name), &report) {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    }
    match args.format {
        ResultFormat::Human => {
            write!(io::stdout(), "{}", result.tail(detail))?;
            if let Some(path) = &args.page.html {
                writeln!(io::stdout(), "  page {}", path.display())?;
            }
        }
        ResultFormat::Json => {
            let mut out = io::stdout().lock();
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    Ok(exit)
}

/// Watches each phase of the command: shows progress and enforces time limits.
struct Phases<'p> {
    args: &'p ReachArgs,
    world: &'p World,
    /// The time for the next search, s.
    next: Option<f64>,
    searched: Vec<Searched>,
}

/// The search for one target.
struct Searched {
    target: Target,
    seconds: f64,
    /// The time left for making its path faster, s.
    left: Option<f64>,
}

impl<'p> Phases<'p> {
    fn new(args: &'p ReachArgs, world: &'p World, analysis_seconds: f64) -> Self {
        Phases { args, world, next: args.seconds.map(|seconds| seconds - analysis_seconds), searched: Vec::new() }
    }
}

impl Supervisor for Phases<'_> {
    fn supervise(&mut self, phase: Phase, work: &mut dyn FnMut(&dyn Watch)) -> ControlFlow<()> {
        let watch = match phase {
            Phase::Search(target) => CommandWatch::new(target.name(self.world), self.next),
            Phase::Minimize(target) => {
                let searched = self.searched.iter().find(|searched| searched.target == target);
                CommandWatch::new(target.name(self.world), searched.and_then(|searched| searched.left))
            }
            Phase::MakeRobust(target) => {
                CommandWatch::counting((target.name(self.world), "nodes for an easier way"), self.args.seconds)
            }
            // A measurement takes what it takes.
            Phase::MeasureRobust(target) => CommandWatch::counting((target.name(self.world), "plays"), None),
            // Paths are short: replaying them takes no budget.
            Phase::Exchange => {
                work(&Interrupt::new());
                return ControlFlow::Continue(());
            }
        };
        work(&watch);
        watch.finish();
        if let Phase::Search(target) = phase {
            let seconds = watch.seconds();
            let left = self.next.map(|limit| (limit - seconds).max(0.0));
            self.searched.push(Searched { target, seconds, left });
            self.next = self.args.seconds;
        }
        if watch.is_interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Answers a command line of `hypedc reach` by the analysis of the same world in another file: the tests give a wrong
/// one. Returns whether the exit status is 0, and the verdict and the text of the first goal; `None` for other
/// arguments, or if a file is refused.
///
/// # Errors
/// As writing to the standard output.
#[cfg(feature = "testing")]
pub fn answer_by_analysis_of(
    file: &std::path::Path,
    arguments: &[&str],
) -> io::Result<Option<(bool, crate::reach::Conclusion, String)>> {
    use clap::Parser;

    use crate::cli::args::{Arguments, Command};
    use crate::compile::Changes;

    let arguments = Arguments::try_parse_from(arguments);
    let Ok(Arguments { command: Command::Reach(args), .. }) = &arguments else { return Ok(None) };
    let (level, world, none) = (|| args.reading.of(None), WorldId(0), Changes::default());
    let (Some(analysed), Some(mut loaded)) =
        (load_changed(file, level(), &none)?, load_changed(&args.file, level(), &none)?)
    else {
        return Ok(None);
    };
    let space = crate::analysis::configuration_space(&analysed.program, world);
    let Ok(query) = query(args, &mut loaded, world) else { return Ok(None) };
    let session = Session::with_space(&loaded.program, world, query, space);
    let exit = answer_all(args, &loaded, (world, &session), 0.0, None)?;
    let Ok(mut first) = session.find(Target::Goal(crate::ir::GoalId(0)), &crate::watch::Unwatched) else {
        return Ok(None);
    };
    let answer = session.answer(&mut first, &loaded.sources);
    let (query, saved) = (session.query(), Saved::default());
    let shown = Shown {
        query,
        unpressed: None,
        saved: &saved,
        seconds: 0.0,
        step: 0.0,
        has_rooms: false,
        detail: Detail::Full,
        is_verbose: false,
    };
    let text = answer_text(&answer, &shown);
    Ok(Some((exit == Exit::Yes, answer.verdict, text)))
}

//! `hypedc tune`: the smallest change of a number of a program with which a goal can be reached, or cannot any more.
//! [`crate::tune`] finds it; this part compiles, watches and shows.

pub(in crate::cli) mod args;
mod result;
mod text;
mod tiles;

#[cfg(feature = "testing")]
pub(in crate::cli) use {result::json_schema, tiles::json_schema as tiles_schema};

use std::io::{self, Write};
use std::time::Instant;

use crate::ask::{Without, read_scripts, unknown};
use crate::compile::{
    Asked, Changes, Compilation, ExtraConstraint, ExtraQuestion, NumberSetting, compile_changed, question_name,
    written_number,
};
use crate::diagnostic::{Severity, render};
use crate::ir::{World, WorldId};
use crate::json::{self, Layout};
use crate::reach::query::{Kind, Query};
use crate::reach::{Limits, Settings, Target};
use crate::tune::{Axis, Built, Host, MAX_AXES, Question, Tuned, Wanted, tune};
use crate::view::{VerdictMap, VerdictPanel, verdict_map_svg};
use crate::watch::Watch;

use crate::cli::Exit;
use crate::cli::args::ResultFormat;
use crate::cli::disk::Disk;
use crate::cli::goal::chosen_goal;
use crate::cli::reach::question::{NEVER, WITHOUT, asked_only};
use crate::cli::reach::refuted::{Refuted, RunInfo, command_line};
use crate::cli::reach::shade;
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, choose_world, find_world, load_changed, plain_error, program_sha256, written};
use crate::cli::watches::{CommandWatch, interrupted};
use args::{TuneArgs, Vary};
use result::{RESULT_VERSION, TuneResult, csv_text};
use text::result_text;

pub(in crate::cli) fn run(args: &TuneArgs) -> io::Result<Exit> {
    let refused = args.numbers.refusal().or_else(|| plain_refusal(args));
    if let Some(why) = refused {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let started = Instant::now();
    let host = Disked::new(args);
    let Some(mut loaded) = load_changed(&args.file, args.level.file(), &host.changes(&args.numbers.fixed()))? else {
        return Ok(Exit::Refused);
    };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let question = match question(args, &mut loaded, world) {
        Ok(question) => question,
        Err(refusal) => {
            refusal.show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    if let Some(change) = args.tiles {
        return tiles::run(args, (&host, loaded, world), question.query, change);
    }
    let found = tune(&host, &question);
    let result = record(args, &loaded, world, (&question, found), started.elapsed().as_secs_f64());
    show(args, &result)
}

/// What can be said without reading the program.
fn plain_refusal(args: &TuneArgs) -> Option<String> {
    let mut names: Vec<&str> = args.vary.iter().map(|vary| vary.path.as_str()).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Some(format!("`--vary {}` is given twice", twice[0]));
    }
    if args.vary.len() > MAX_AXES {
        return Some(format!("at most {MAX_AXES} numbers can be varied, not {}", args.vary.len()));
    }
    if args.svg.is_some() && args.vary.len() > 1 {
        return Some("`--svg` draws the values of one number".to_string());
    }
    None
}

/// Compiles from the disk.
struct Disked<'a> {
    args: &'a TuneArgs,
    questions: Vec<ExtraQuestion<'a>>,
    constraint: Option<ExtraConstraint<'a>>,
}

impl<'a> Disked<'a> {
    fn new(args: &'a TuneArgs) -> Self {
        let world = args.world.as_deref();
        let question = |asked, origin| move |text: &'a String| ExtraQuestion { asked, world, text, origin };
        let goal = args.goal.iter().map(question(Asked::Goal, "--goal"));
        let nevers = args.never.iter().map(question(Asked::Never, NEVER));
        let constraint = |predicate: &'a str| ExtraConstraint { world, name: WITHOUT, predicate, origin: WITHOUT };
        Disked {
            args,
            questions: goal.chain(nevers).collect(),
            constraint: args.without.as_deref().and_then(|text| Without::read(text).predicate()).map(constraint),
        }
    }

    fn changes<'c>(&'c self, numbers: &'c [NumberSetting<'c>]) -> Changes<'c> {
        Changes { questions: &self.questions, constraint: self.constraint, numbers }
    }
}

impl Host for Disked<'_> {
    fn build(&self, numbers: &[NumberSetting<'_>]) -> Result<Built, String> {
        let numbers = [self.args.numbers.fixed(), numbers.to_vec()].concat();
        let Compilation { sources, program, diagnostics, .. } =
            compile_changed(&self.args.file, self.args.level.file(), &self.changes(&numbers), &Disk);
        let Some(program) = program else {
            let errors = diagnostics.iter().filter(|found| found.severity == Severity::Error);
            return Err(render::short(&sources, errors).trim_end().to_string());
        };
        let world = find_world(&program, &self.args.file, self.args.world.as_deref());
        let world = world.map_err(|why| Refusal::of(why).text(&sources))?;
        Ok(Built { sources, program, world })
    }

    fn watched(&self, what: &str, work: &mut dyn FnMut(&dyn Watch)) {
        let watch = CommandWatch::new(what, self.args.seconds);
        work(&watch);
        watch.finish();
    }

    fn is_stopped(&self) -> bool {
        interrupted().load(std::sync::atomic::Ordering::SeqCst)
    }
}

/// The question of the arguments.
fn question(args: &TuneArgs, loaded: &mut Loaded, world: WorldId) -> Result<Question, Refusal> {
    let axes = args.vary.iter().map(|vary| axis(args, vary)).collect::<Result<Vec<Axis>, Refusal>>()?;
    let after = read_scripts(loaded, world, (&args.after, "--after"))?;
    let table = &loaded.program.worlds[world];
    let goal = chosen_goal(table, args.goal.as_deref()).map_err(Refusal::of)?;
    let min_hold = args.min_hold.map_or(1, |time| time.steps(table));
    let min_hold =
        u16::try_from(min_hold).map_err(|_| Refusal::Plain(format!("`--min-hold` is at most {} steps", u16::MAX)))?;
    let avoided = args.without.as_deref().map(Without::read);
    let unpressed = avoided.map_or(Ok(Vec::new()), |avoided| avoided.buttons(&loaded.program, table));
    let query = Query {
        settings: Settings { seed: args.seed, ..Settings::default() },
        limits: Limits { nodes: args.nodes, memory: args.memory << 20 },
        min_hold,
        within: args.within.map(|time| time.room(table)),
        // The compiler appends it.
        without: avoided
            .and_then(Without::predicate)
            .and_then(|_| table.nevers.ids().next_back())
            .into_iter()
            .collect(),
        unpressed: unpressed.map_err(Refusal::of)?,
        asked: asked_only(loaded, world),
        after,
        chance: args.chance,
        ..Query::new(vec![Target::Goal(goal)])
    };
    Ok(Question {
        axes,
        query,
        wanted: if args.prevent { Wanted::Prevented } else { Wanted::Reached },
        nevers: nevers(table, &args.never)?,
        samples: usize::from(args.samples),
    })
}

/// A number with what the program has.
fn axis(args: &TuneArgs, vary: &Vary) -> Result<Axis, Refusal> {
    let Vary { path, range, step } = vary;
    let written = written_number(&args.file, &Disk, path).map_err(Refusal::of)?;
    let set = args.numbers.fixed().into_iter().rev().find(|set| set.path == path.as_str());
    let base = set.map_or(written.literal, |set| set.value.parse().ok());
    let base = base.ok_or_else(|| {
        Refusal::Plain(format!(
            "`{path}` is no plain number in the program: say with `--set {path}=NUMBER` what to begin with"
        ))
    })?;
    Axis::new(path, &written.unit, base, *range, step.or(args.precision)).map_err(Refusal::Plain)
}

/// The `never`s with some names.
fn nevers(world: &World, names: &[String]) -> Result<Vec<Target>, Refusal> {
    let known: Vec<(Target, &str)> =
        world.nevers.pairs().map(|(id, never)| (Target::Never(id), never.name.as_str())).collect();
    let find = |text: &String| {
        let name = question_name(text);
        let found = known.iter().find(|(_, known)| *known == name);
        found.map(|(target, _)| *target).ok_or_else(|| unknown(world, Kind::Never, &name, &known))
    };
    names.iter().map(find).collect()
}

fn record(
    args: &TuneArgs,
    loaded: &Loaded,
    world: WorldId,
    (question, found): (&Question, Tuned),
    seconds: f64,
) -> TuneResult {
    let is_wanted_already = found.is_wanted_already();
    let refuted = found.refuted.as_ref().map(|(refutation, built)| {
        let info =
            RunInfo { file: &args.file, level: args.level.map.as_deref(), seed: args.seed, command: command_line() };
        Refuted::saved(&built.program, built.world, refutation, &info)
    });
    let set = |trial: usize| {
        let values = question.axes.iter().zip(&found.trials[trial].values);
        let changed = values.filter(|(axis, value)| **value != axis.base);
        changed.map(|(axis, value)| format!("{}={}", axis.name, Axis::text(*value))).collect()
    };
    let table = &loaded.program.worlds[world];
    TuneResult {
        version: RESULT_VERSION,
        file: args.file.display().to_string(),
        world: table.name.clone(),
        program_sha256: program_sha256(&loaded.program),
        set: args.numbers.texts(),
        goal: question.query.targets.first().map_or("", |target| target.name(table)).to_string(),
        prevent: args.prevent,
        without: args.without.clone(),
        after: args.after.clone(),
        seed: args.seed,
        nodes_limit: args.nodes,
        seconds_limit: args.seconds,
        change_set: found.change.as_ref().map_or(Vec::new(), |change| set(change.trial)),
        numbers: found.axes,
        trials: found.trials,
        parts: found.parts,
        change: found.change,
        is_wanted_already,
        stopped: found.is_stopped,
        refuted,
        seconds,
    }
}

/// Writes the files, and shows the result.
fn show(args: &TuneArgs, result: &TuneResult) -> io::Result<Exit> {
    let inputs = result.change.as_ref().and_then(|change| result.trials[change.trial].inputs.clone());
    let files = [
        (&args.csv, Some(csv_text(result))),
        (&args.svg, Some(svg(result))),
        (&args.save_inputs, inputs.map(|inputs| inputs + "\n")),
    ];
    for (path, text) in files {
        if let (Some(path), Some(text)) = (path, text)
            && !written(path, &text)?
        {
            return Ok(Exit::Refused);
        }
    }
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Human => write!(out, "{}", result_text(result, args))?,
        ResultFormat::Json => {
            json::write(result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    let is_yes = (result.change.is_some() || result.is_wanted_already) && !result.stopped && result.refuted.is_none();
    Ok(if is_yes { Exit::Yes } else { Exit::No })
}

/// The verdicts of the values of one number, in order.
fn svg(result: &TuneResult) -> String {
    let [axis] = result.numbers.as_slice() else { return String::new() };
    let mut trials: Vec<_> = result.trials.iter().collect();
    trials.sort_by(|a, b| a.values[0].total_cmp(&b.values[0]));
    let cells = trials.iter().map(|trial| (shade(trial.verdict, Kind::Goal), trial.steps)).collect();
    let values = trials.iter().map(|trial| Axis::text(trial.values[0])).collect();
    let panel = VerdictPanel { title: format!("goal {}", result.goal), cells };
    let title = format!("{}, world {}", result.file, result.world);
    verdict_map_svg(&VerdictMap { title, axes: vec![(axis.name.clone(), values)], panels: vec![panel] })
}

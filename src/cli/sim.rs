//! `hypedc sim`: runs a world with given inputs and shows its final state.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

mod page;

use crate::ask::{Observed, RunOutcome, run_svg};
use crate::compile::{Asked, Changes, ExtraQuestion, LevelFile, compile_changed, question_name};
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{GoalId, GroupId, Id, NeverId, Origin, Program, SlotId, World, WorldId};
use crate::json::{self, Layout};
use crate::sim::{Script, Simulator, TRACE_VERSION, TraceFormat, TraceHeader, TraceLines, TraceWriter, parse_script};
use crate::source::Files;
use crate::view::{Images, Recorder};

pub(super) use crate::ask::{RunEnd, drive};

use super::Exit;
use super::animation;
use super::args::output::is_standard;
use super::args::{ResultFormat, ScriptArgs, SimArgs, TraceFormatName};
use super::disk::Disk;
use super::page::carried;
use super::pictures;
use super::replay;
use super::report::{Loaded, choose_world, level_sha256, load_changed, plain_error, program_sha256, show, show_fact};
use super::sim_sweep;
use super::sweep::{refuses_csv, swept};
use super::watches::Interrupt;

pub(super) fn run(args: &SimArgs) -> io::Result<Exit> {
    if let Some(trace) = &args.replay {
        return replay::run(trace, args);
    }
    // The arguments have a program unless they have a trace to replay.
    let file = args.file.as_deref().unwrap_or(Path::new(""));
    if let Some(exit) = swept(&args.numbers, |sweep| sim_sweep::run(args, file, sweep))? {
        return Ok(exit);
    }
    if refuses_csv(args.csv.as_deref(), "`--trace run.csv` writes each step of a run")? {
        return Ok(Exit::Refused);
    }
    if args.format == ResultFormat::Json && args.trace.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        plain_error("`--trace -` and `--format json` both write to standard output")?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let questions = questions(args);
    let changes = Changes { questions: &questions, numbers: &numbers, ..Changes::default() };
    let Some(mut loaded) = load_changed(file, args.level.file(), &changes)? else {
        return Ok(Exit::Refused);
    };
    let Some(world) = choose_world(&loaded, file, args.world.as_deref())? else {
        return Ok(Exit::Refused);
    };
    let Some(script) = script(args, &mut loaded, world)? else {
        return Ok(Exit::Refused);
    };
    let expected = match Expected::new(&loaded.program.worlds[world], args) {
        Ok(expected) => expected,
        Err(fact) => {
            show_fact(&loaded.sources, fact)?;
            return Ok(Exit::Refused);
        }
    };
    let carried = match carried(&args.page, file, args.level.file()) {
        Ok(carried) => carried,
        Err(why) => return why.show(),
    };
    let sim = Simulator::new(&loaded.program, world);
    let frames = args.frames.unwrap_or(script.len());
    // The trace is that of the program as it is written: a predicate that is expected is no part of it.
    let written = written(args, file, &questions).map(|program| Simulator::new(&program, world));
    let mut trace = match &args.trace {
        Some(path) => {
            let sim = written.as_ref().unwrap_or(&sim);
            let header = header(sim, file, (args.level.file(), &args.numbers.texts()), (&script, args.chance), frames);
            match trace_writer(args, path, sim, &header)? {
                Some(trace) => Some(trace),
                None => return Ok(Exit::Refused),
            }
        }
        None => None,
    };
    if let (Some(written), Some(trace)) = (&written, &mut trace) {
        drive(written, (&script, args.chance), frames, &Interrupt::new(), &mut |step, input, state, _| {
            trace.state(step, input, state).map(|()| ControlFlow::Continue(()))
        })?;
    }
    let mut report = Observed::new(&sim);
    let draws = args.svg.is_some() || carried.is_some();
    let images = if draws || args.animation.gif.is_some() {
        pictures::images(&loaded.program, file)
    } else {
        Ok(Images::default())
    };
    let images = match images {
        Ok(images) => images,
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    let mut recorder = draws.then(|| Recorder::new(&sim));
    let ended = drive(&sim, (&script, args.chance), frames, &Interrupt::new(), &mut |step, input, state, scratch| {
        report.observe(step, state);
        report.record_events(step, scratch, state);
        if let Some(recorder) = &mut recorder {
            recorder.observe(step, input, state);
        }
        trace.as_mut().filter(|_| written.is_none()).map_or(Ok(()), |t| t.state(step, input, state))?;
        Ok(ControlFlow::Continue(()))
    })?;
    if let Some(trace) = trace {
        trace.finish()?;
    }
    let to_stdout = args.trace.as_deref().is_some_and(is_standard);
    let text = report.text(&file.display().to_string());
    if args.format == ResultFormat::Json {
        let inputs = script.text(&loaded.program, world);
        let mut out = io::stdout().lock();
        json::write(&report.result(file.display().to_string(), inputs, &ended), Layout::Indented, &mut out)?;
        writeln!(out)?;
    } else if !to_stdout {
        write!(io::stdout(), "{text}")?;
    }
    let findings = report.findings(&loaded.program, world);
    show(&loaded.sources, &findings)?;
    let unmet = expected.unmet(&report);
    unmet.iter().try_for_each(|why| plain_error(why))?;
    if let Some(recorder) = recorder {
        let inputs = script.text(&loaded.program, world);
        let outcome = RunOutcome::new(&report, &inputs, &ended, unmet.is_empty());
        let run = recorder.finish(&report.last, outcome.marks.clone());
        let picture = run_svg((&loaded.program, world), &run, &outcome, &images);
        if let Some(path) = &args.svg
            && let Err(error) = fs::write(path, &picture)
        {
            plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
            return Ok(Exit::Refused);
        }
        if let (Some(carried), Some(path)) = (&carried, &args.page.html) {
            let (unmet, findings, outcome) = (unmet.as_slice(), (&loaded.sources, &findings), &outcome);
            let said = page::Said { text: &text, unmet, findings, outcome, picture };
            let saved = page::save((carried, path), &sim, (&script, args.chance), said, &Interrupt::new())?;
            if let Err(why) = saved {
                plain_error(&why)?;
                return Ok(Exit::Refused);
            }
        }
    }
    if let Some(path) = &args.animation.gif {
        let runs = (&script, args.chance);
        if let Err(why) = animation::save(path, (&args.animation, &images), &sim, runs, frames, &Interrupt::new()) {
            plain_error(&why.words(path))?;
            return Ok(Exit::Refused);
        }
    }
    match ended {
        RunEnd::Done | RunEnd::LeftBounds | RunEnd::Enough => {}
        RunEnd::Fault(fault, step) => {
            show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
            return Ok(Exit::No);
        }
        RunEnd::Stopped(step) => {
            plain_error(&format!("stopped after step {step} of {frames}"))?;
            return Ok(Exit::No);
        }
    }
    Ok(if report.violated() || !unmet.is_empty() { Exit::No } else { Exit::Yes })
}

/// The program without predicates that are expected, if a trace is written and there may be some.
fn written(args: &SimArgs, file: &Path, questions: &[ExtraQuestion<'_>]) -> Option<Arc<Program>> {
    if args.trace.is_none() || questions.is_empty() {
        return None;
    }
    let numbers = args.numbers.fixed();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    compile_changed(file, args.level.file(), &changes, &Disk).program
}

/// A trace that is written to a file or to standard output.
type Trace<'s> = TraceWriter<'s, BufWriter<Box<dyn Write>>>;

/// Opens the file of a trace; reports why it cannot be written.
fn trace_writer<'s>(
    args: &SimArgs,
    path: &Path,
    sim: &'s Simulator,
    header: &TraceHeader,
) -> io::Result<Option<Trace<'s>>> {
    let to: Box<dyn Write> = match is_standard(path) {
        true => Box::new(io::stdout()),
        false => match File::create(path) {
            Ok(file) => Box::new(file),
            Err(error) => {
                plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
                return Ok(None);
            }
        },
    };
    Ok(Some(TraceWriter::new(TraceLines::new(sim, format(args, path)), BufWriter::new(to), header)?))
}

/// The expectations as questions: names, or predicates that the world gets as goals.
pub(super) fn questions(args: &SimArgs) -> Vec<ExtraQuestion<'_>> {
    let world = args.world.as_deref();
    let question = |asked, origin| move |text| ExtraQuestion { asked, world, text, origin };
    let expected = args.expect.iter().map(String::as_str).map(question(Asked::Goal, "--expect"));
    let excluded = args.expect_not.iter().map(String::as_str).map(question(Asked::Either, "--expect-not"));
    expected.chain(excluded).collect()
}

/// Everything that a run depends on.
pub(super) fn header(
    sim: &Simulator,
    file: &Path,
    (level, set): (LevelFile<'_>, &[String]),
    (script, chance): (&Script, Option<u64>),
    steps: u64,
) -> TraceHeader {
    let step = sim.world().step;
    TraceHeader {
        trace: TRACE_VERSION,
        hypedc: env!("CARGO_PKG_VERSION").to_string(),
        file: file.display().to_string(),
        program_sha256: program_sha256(sim.program()),
        level: level.map.map(|path| path.display().to_string()),
        level_sha256: level.map.and_then(level_sha256),
        legend: level.legend.map(|path| path.display().to_string()),
        tile: level.tile,
        set: set.to_vec(),
        world: sim.world().name.clone(),
        step: format!("{}/{}", step.numerator, step.denominator),
        inputs: script.text(sim.program(), sim.world_id()),
        chance: (!sim.draws().is_empty()).then(|| chance.unwrap_or_default()),
        steps,
    }
}

/// The format of the trace.
fn format(args: &SimArgs, path: &Path) -> TraceFormat {
    let is_csv = || path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    match args.trace_format {
        Some(TraceFormatName::Csv) => TraceFormat::Csv,
        None if is_csv() => TraceFormat::Csv,
        Some(TraceFormatName::Jsonl) | None => TraceFormat::Jsonl,
    }
}

/// The expectations about a run.
struct Expected {
    goals: Vec<GoalId>,
    not_goals: Vec<GoalId>,
    not_nevers: Vec<NeverId>,
}

impl Expected {
    fn new(world: &World, args: &SimArgs) -> Result<Self, NoQuestion> {
        let goals: Vec<&str> = world.goals.iter().map(|g| g.name.as_str()).collect();
        let nevers: Vec<&str> = world.nevers.iter().map(|n| n.name.as_str()).collect();
        let unknown = |kind: &str, name: &str, names: &[&str]| {
            let list: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
            NoQuestion {
                why: format!("no {kind} `{name}` in `{}`", world.name),
                near: similar(name, names.iter().copied()),
                help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
            }
        };
        let mut expected = Expected { goals: Vec::new(), not_goals: Vec::new(), not_nevers: Vec::new() };
        for name in args.expect.iter().map(|text| question_name(text)) {
            let id = world.goal_named(&name).ok_or_else(|| unknown("goal", &name, &goals))?;
            expected.goals.push(id);
        }
        for name in args.expect_not.iter().map(|text| question_name(text)) {
            let (goal, never) = (world.goal_named(&name), world.never_named(&name));
            if goal.is_none() && never.is_none() {
                return Err(unknown("goal and no never", &name, &[goals.as_slice(), nevers.as_slice()].concat()));
            }
            expected.not_goals.extend(goal);
            expected.not_nevers.extend(never);
        }
        Ok(expected)
    }

    /// The unmet expectations.
    fn unmet(&self, report: &Observed<'_>) -> Vec<String> {
        let world = report.sim.world();
        let held = |kind: &str, name: &str, step: u64| format!("`--expect-not {name}`: the {kind} held at step {step}");
        let first = |of: &[Option<u64>], id: usize| of.get(id).copied().flatten();
        let mut unmet = Vec::new();
        for &goal in &self.goals {
            if first(&report.goals, goal.index()).is_none() {
                let (name, steps) = (&world.goals[goal].name, report.steps);
                unmet.push(format!("`--expect {name}`: the goal was not reached in {steps} steps"));
            }
        }
        for &goal in &self.not_goals {
            let step = first(&report.goals, goal.index());
            unmet.extend(step.map(|step| held("goal", &world.goals[goal].name, step)));
        }
        for &never in &self.not_nevers {
            let step = first(&report.nevers, never.index());
            unmet.extend(step.map(|step| held("never", &world.nevers[never].name, step)));
        }
        unmet
    }
}

/// The requested script; reports why if there is none.
pub(super) fn script(args: &SimArgs, loaded: &mut Loaded, world: WorldId) -> io::Result<Option<Script>> {
    script_of(&args.script, (args.frames.is_some(), "--frames N"), loaded, world)
}

/// A script from an argument or from a file; an empty one where an option gives a number of steps.
pub(super) fn script_of(
    ScriptArgs { inputs, inputs_file }: &ScriptArgs,
    (has_steps, option): (bool, &str),
    loaded: &mut Loaded,
    world: WorldId,
) -> io::Result<Option<Script>> {
    let (path, text) = match (inputs, inputs_file) {
        (Some(text), _) => ("--inputs".into(), text.clone()),
        (None, Some(path)) => match Disk.read(path) {
            Ok(text) => (path.clone(), text),
            Err(error) => {
                show_fact(&loaded.sources, Unreadable { path: path.clone(), import: None, error })?;
                return Ok(None);
            }
        },
        (None, None) if has_steps => return Ok(Some(Script::default())),
        (None, None) => {
            let why = "no inputs and no number of steps".to_string();
            let help = Some(format!("give `--inputs 'right*40'`, `--inputs-file PATH` or `{option}`"));
            show_fact(&loaded.sources, NoQuestion { why, near: None, help })?;
            return Ok(None);
        }
    };
    let file = loaded.sources.add(path, text.clone());
    let (script, found) = parse_script(&loaded.program, world, file, &text);
    show(&loaded.sources, &found)?;
    Ok((!found.has_errors()).then_some(script))
}

impl Observed<'_> {
    fn text(&self, file: &str) -> String {
        let (program, world): (&Program, _) = (self.sim.program(), self.sim.world());
        let seconds = world.step.seconds() * self.steps as f64;
        let mut out = format!("{file}, world {}: {} steps ({seconds:.2} s)\n", world.name, self.steps);
        if self.last.is_empty() {
            return out;
        }
        let shown = |id: &SlotId| world.slots[*id].origin == Origin::Named || world.layout.slots[*id].alive(&self.last);
        let shown = world.slots.ids().filter(shown);
        let width = shown.map(|id| world.slots[id].name.chars().count()).max().unwrap_or(0);
        for (id, slot) in world.slots.pairs() {
            let entity = &program.entities[slot.entity];
            let layout = &world.layout.slots[id];
            if !layout.alive(&self.last) {
                if slot.origin == Origin::Named {
                    out.push_str(&format!("  {:width$}  (destroyed)\n", slot.name));
                }
                continue;
            }
            // A group of one mode says nothing beside others.
            let says = |group: &GroupId| entity.groups.len() == 1 || entity.groups[*group].modes.len() > 1;
            let modes: Vec<&str> = entity
                .groups
                .ids()
                .filter(says)
                .map(|g| entity.modes[entity.leaves[layout.leaf(&self.last, g)].mode].path.as_str())
                .collect();
            let mut values: Vec<String> = entity
                .vars
                .pairs()
                .map(|(var, name)| {
                    let at = |degree| layout.var(&self.last, var, degree);
                    format!("{name} = {:.3}, {name}' = {:.3}", at(0), at(1))
                })
                .collect();
            let discretes = entity.discretes.pairs();
            values.extend(
                discretes.map(|(d, v)| format!("{} = {}", v.name, v.domain.text(layout.discrete(&self.last, d)))),
            );
            values.extend(entity.refs.pairs().map(|(r, reference)| {
                let target = layout.reference(&self.last, r).map_or("none", |t| &world.slots[t].name);
                format!("{} = {target}", reference.name)
            }));
            out.push_str(&format!("  {:width$}  {}  {}\n", slot.name, modes.join(", "), values.join(", ")));
        }
        if let Some(slot) = self.left {
            let (player, space) = (&world.slots[slot].name, &world.spaces[self.sim.space(&self.last, slot)].name);
            let step = self.steps;
            out.push_str(&format!("  the run ends at step {step}: {player} has left the bounds of `{space}`\n"));
        }
        for (first, goal) in self.goals.iter().zip(world.goals.iter()) {
            out.push_str(&match first {
                Some(step) => format!("  goal {}: reached at step {step}\n", goal.name),
                None => format!("  goal {}: not reached\n", goal.name),
            });
        }
        for (first, never) in self.nevers.iter().zip(world.nevers.iter()) {
            if let Some(step) = first {
                out.push_str(&format!("  never {}: violated at step {step}\n", never.name));
            }
        }
        out
    }
}

/// Writes a script to a file.
pub(super) fn save_script(path: &Path, text: &str) -> io::Result<()> {
    fs::write(path, format!("{text}\n"))
}

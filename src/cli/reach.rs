//! `hypedc reach`: searches for inputs that bring about a world's goals, one verdict for each.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;

use crate::analysis::configuration_space;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{GoalId, WorldId};
use crate::reach::{Limits, Outcome, Problem, Sampling, Settings, Verdict, reach};
use crate::sim::Simulator;

use super::Answer;
use super::args::{ReachArgs, ResultFormat, SampleBounds};
use super::report::{Loaded, choose_world, load, plain_error, show_fact};
use super::sim::save_script;
use super::values;
use super::watching::CommandWatch;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 2;

#[derive(Serialize)]
struct RunResult<'a> {
    version: u32,
    hypedc: &'a str,
    file: String,
    world: &'a str,
    seed: u64,
    bounds: &'static str,
    analysis_seconds: f64,
    nodes_limit: u64,
    seconds_limit: Option<f64>,
    goals: Vec<GoalResult>,
}

#[derive(Serialize)]
struct GoalResult {
    goal: String,
    verdict: &'static str,
    /// Why it is proven unreachable.
    argument: Option<String>,
    /// Number of steps and length of the path; none if there is none.
    steps: Option<u64>,
    seconds_of_play: Option<f64>,
    inputs: Option<String>,
    nodes: u64,
    trees: u64,
    extensions: u64,
    failures: u64,
    simulated_steps: u64,
    seconds: f64,
    stopped: bool,
    inputs_left_out: bool,
    #[serde(skip)]
    saved: Option<PathBuf>,
}

pub(super) fn run(args: &ReachArgs) -> io::Result<Answer> {
    let Some(loaded) = load(&args.file, args.map.as_deref())? else {
        return Ok(Answer::Unasked);
    };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else {
        return Ok(Answer::Unasked);
    };
    let Some(goals) = choose_goals(&loaded, world, &args.goal)? else {
        return Ok(Answer::Unasked);
    };
    let sim = Simulator::new(&loaded.program, world);
    let started = Instant::now();
    let space = configuration_space(&loaded.program, world);
    let analysis_seconds = started.elapsed().as_secs_f64();
    let (sampling, bounds) = match args.bounds {
        SampleBounds::Naive => (Sampling::Naive, "naive"),
        SampleBounds::Reduced => (Sampling::Reduced, "reduced"),
    };
    let mut answer = Answer::Yes;
    let mut result = RunResult {
        version: RESULT_VERSION,
        hypedc: env!("CARGO_PKG_VERSION"),
        file: args.file.display().to_string(),
        world: &sim.world().name,
        seed: args.seed,
        bounds,
        analysis_seconds,
        nodes_limit: args.nodes,
        seconds_limit: args.seconds,
        goals: Vec::new(),
    };
    if args.format == ResultFormat::Human {
        let naive = if sampling == Sampling::Naive { ", naive bounds" } else { "" };
        writeln!(io::stdout(), "{}, world {}, seed {}{naive}", result.file, result.world, result.seed)?;
    }
    for &goal in &goals {
        let name = &sim.world().goals[goal].name;
        let problem = Problem::new(&sim, goal);
        let watch = CommandWatch::new(name, args.seconds);
        let settings = Settings { seed: args.seed, sampling, ..Settings::default() };
        let outcome = reach(&problem, &space, &settings, &Limits { nodes: args.nodes }, &watch);
        watch.finish();
        let outcome = match outcome {
            Ok(outcome) => outcome,
            Err(fault) => {
                show_fact(&loaded.sources, fault.fact(&loaded.program, world, 0))?;
                return Ok(Answer::Unasked);
            }
        };
        if let Some((fault, step)) = outcome.fault {
            show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
        }
        let mut row = row(&sim, name, &outcome, watch.seconds());
        let mut reasons = Vec::new();
        if let Verdict::Unreachable(proof) = &outcome.verdict {
            reasons = values::reasons(&loaded.sources, &loaded.program, sim.world(), proof);
            row.argument = Some(reasons.join("; "));
            if values::is_bounded(sim.world()) {
                reasons.push("a run ends where a player leaves the bounds of its space, below or beside".to_string());
            }
        }
        if let (Some(path), Some(inputs)) = (&args.save_inputs, &row.inputs) {
            let path = save_path(path, name, goals.len());
            if let Err(error) = save_script(&path, inputs) {
                plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
                return Ok(Answer::Unasked);
            }
            row.saved = Some(path);
        }
        if args.format == ResultFormat::Human {
            write!(io::stdout(), "{}", human(&row, &reasons))?;
        }
        if !matches!(outcome.verdict, Verdict::Reached(_)) {
            answer = answer.max(Answer::No);
        }
        result.goals.push(row);
        if watch.is_interrupted() {
            answer = answer.max(Answer::No);
            break;
        }
    }
    if args.format == ResultFormat::Json {
        let mut out = io::stdout().lock();
        serde_json::to_writer_pretty(&mut out, &result)?;
        writeln!(out)?;
    }
    Ok(answer)
}

/// The goals that were asked for, or all; shows why if there are none.
fn choose_goals(loaded: &Loaded, world: WorldId, wanted: &[String]) -> io::Result<Option<Vec<GoalId>>> {
    let goals = &loaded.program.worlds[world].goals;
    let world = &loaded.program.worlds[world].name;
    let mut chosen = Vec::new();
    for name in wanted {
        let Some(goal) = goals.find(|g| g.name == *name) else {
            let names: Vec<&str> = goals.iter().map(|g| g.name.as_str()).collect();
            let list: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
            let fact = NoQuestion {
                why: format!("no goal `{name}` in `{world}`"),
                near: similar(name, names.iter().copied()),
                help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
            };
            show_fact(&loaded.sources, fact)?;
            return Ok(None);
        };
        if !chosen.contains(&goal) {
            chosen.push(goal);
        }
    }
    if wanted.is_empty() {
        chosen.extend(goals.ids());
    }
    if chosen.is_empty() {
        let why = format!("`{world}` has no goal");
        let help = Some("add one, such as `goal arrive: near(hero, (416, 48), 16)`".to_string());
        show_fact(&loaded.sources, NoQuestion { why, near: None, help })?;
        return Ok(None);
    }
    Ok(Some(chosen))
}

fn row(sim: &Simulator<'_>, goal: &str, outcome: &Outcome, seconds: f64) -> GoalResult {
    let plan = match &outcome.verdict {
        Verdict::Reached(plan) => Some(plan),
        Verdict::NotFound | Verdict::Unreachable(_) => None,
    };
    let s = &outcome.statistics;
    GoalResult {
        goal: goal.to_string(),
        verdict: match outcome.verdict {
            Verdict::Reached(_) => "reached",
            Verdict::NotFound => "not found",
            Verdict::Unreachable(_) => "proven-unreachable",
        },
        argument: None,
        steps: plan.map(|p| p.steps),
        seconds_of_play: plan.map(|p| p.steps as f64 * sim.world().step.seconds()),
        inputs: plan.map(|p| p.script.text(sim.program(), sim.world_id())),
        nodes: s.nodes,
        trees: s.trees,
        extensions: s.extensions,
        failures: s.failures,
        simulated_steps: s.steps,
        seconds,
        stopped: outcome.stopped,
        inputs_left_out: outcome.truncated,
        saved: None,
    }
}

fn human(row: &GoalResult, reasons: &[String]) -> String {
    if row.argument.is_some() {
        let lines: String = reasons.iter().map(|r| format!("    {r}\n")).collect();
        return format!("  goal {}: proven unreachable, in no state that the world can be in\n{lines}", row.goal);
    }
    let trees = if row.trees == 1 { "tree" } else { "trees" };
    let mut out = format!("  goal {}: {}\n", row.goal, row.verdict);
    if let (Some(steps), Some(seconds)) = (row.steps, row.seconds_of_play) {
        out.push_str(&format!("    path    {steps} steps ({seconds:.2} s of play)\n"));
    }
    if let Some(inputs) = row.inputs.as_ref().filter(|i| !i.is_empty()) {
        out.push_str(&format!("    inputs  {inputs}\n"));
    }
    if let Some(path) = &row.saved {
        out.push_str(&format!("    saved   {}\n", path.display()));
    }
    out.push_str(&format!(
        "    search  {} nodes in {} {trees}, {:.3} s; {} of {} extensions failed\n",
        row.nodes, row.trees, row.seconds, row.failures, row.extensions
    ));
    if row.stopped {
        out.push_str("    stopped before the budget of nodes was spent\n");
    }
    if row.inputs_left_out {
        out.push_str("    some combinations of buttons were left out: there are too many\n");
    }
    if row.verdict == "not found" {
        out.push_str("    this proves nothing: a longer search may find a way\n");
    }
    out
}

/// The file for a goal's inputs; with several goals the goal's name goes before the extension.
fn save_path(path: &Path, goal: &str, goals: usize) -> PathBuf {
    if goals == 1 {
        return path.to_path_buf();
    }
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(".");
    name.push(goal);
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

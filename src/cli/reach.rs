//! `hypedc reach`: searches for inputs that bring about a world's goals, one verdict for each.

use std::fs::write;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::analysis::{ConfigurationSpace, configuration_space_without};
use crate::compile::Barred;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{ExprId, GoalId, NeverId, World, WorldId};
use crate::reach::{
    BadStart, Death, Limits, Measure, Outcome, Planner, Problem, Sampling, Settings, Target, Verdict, Visited, reach,
    shorten,
};
use crate::sim::{Script, Simulator, parse_script};
use crate::view::{Node, Search, Stop, search_svg};

use super::Answer;
use super::args::{MetricName, ReachArgs, ResultFormat, SampleBounds, Time};
use super::reach_result::{Answered, RunResult, Violation};
use super::report::{Loaded, choose_world, load_barred, plain_error, show, show_fact};
use super::sim::save_script;
use super::watching::CommandWatch;

/// What the predicate of `--without` is called.
const WITHOUT: &str = "without";

pub(super) fn run(args: &ReachArgs) -> io::Result<Answer> {
    let barred = args.without.as_deref().map(|predicate| Barred {
        world: args.world.as_deref(),
        name: WITHOUT,
        predicate,
        origin: "--without",
    });
    let Some(mut loaded) = load_barred(&args.file, args.reading.of(args.map.as_deref()), barred)? else {
        return Ok(Answer::Unasked);
    };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else {
        return Ok(Answer::Unasked);
    };
    let Some(targets) = choose_targets(&loaded, world, args)? else {
        return Ok(Answer::Unasked);
    };
    let Some(after) = read_scripts(&mut loaded, world, &args.after)? else {
        return Ok(Answer::Unasked);
    };
    let sim = Simulator::new(&loaded.program, world);
    let started = Instant::now();
    // A run is over where a `never` holds.
    let table = &loaded.program.worlds[world];
    let nevers: Vec<ExprId> = table.nevers.iter().map(|never| never.holds).collect();
    let space = configuration_space_without(&loaded.program, world, &nevers);
    let analysis_seconds = started.elapsed().as_secs_f64();
    let Some(settings) = settings(args, sim.world())? else {
        return Ok(Answer::Unasked);
    };
    let mut result = RunResult::new(args, &loaded.program, world, &settings, analysis_seconds);
    if args.format == ResultFormat::Human {
        write!(io::stdout(), "{}", result.head())?;
    }
    let mut run = Run { args, loaded: &loaded, sim: &sim, space: &space, settings, after, targets: targets.len() };
    let mut answer = Answer::Yes;
    for &target in &targets {
        let Some((answered, is_interrupted)) = run.ask(target)? else { return Ok(Answer::Unasked) };
        if args.format == ResultFormat::Human {
            write!(io::stdout(), "{}", answered.human(target))?;
        }
        if !answered.is_as_wished {
            answer = answer.max(Answer::No);
        }
        result.add(answered);
        if is_interrupted {
            answer = answer.max(Answer::No);
            break;
        }
    }
    match args.format {
        ResultFormat::Human => write!(io::stdout(), "{}", result.tail())?,
        ResultFormat::Json => {
            let mut out = io::stdout().lock();
            serde_json::to_writer_pretty(&mut out, &result)?;
            writeln!(out)?;
        }
    }
    Ok(answer)
}

/// One run of the command.
struct Run<'r> {
    args: &'r ReachArgs,
    loaded: &'r Loaded,
    sim: &'r Simulator<'r>,
    space: &'r ConfigurationSpace,
    settings: Settings,
    /// Where searches begin.
    after: Vec<Script>,
    /// How many questions there are.
    targets: usize,
}

impl Run<'_> {
    /// The question of a target; shows why there is none.
    fn problem(&self, target: Target) -> io::Result<Option<Problem<'_>>> {
        let world = self.sim.world();
        let mut problem = Problem::asking(self.sim, target);
        if self.args.without.is_some()
            && let Some(never) = world.nevers.iter().last()
        {
            problem = problem.without(never.holds);
        }
        for (script, text) in self.after.iter().zip(&self.args.after) {
            problem = match problem.after(script.clone()) {
                Ok(problem) => problem,
                Err(BadStart::Fault(fault, step)) => {
                    show_fact(&self.loaded.sources, fault.fact(&self.loaded.program, self.sim.world_id(), step))?;
                    return Ok(None);
                }
                Err(BadStart::Over(death, step)) => {
                    let why = match death {
                        Death::Never(id) => format!("`never {}` holds", world.nevers[id].name),
                        Death::Avoided => "the predicate of `--without` holds".to_string(),
                        Death::Outside => "the player is out of bounds".to_string(),
                    };
                    let why = format!("`--after \"{text}\"` leads nowhere: {why} after step {step}");
                    let help = Some("give a script whose run is not over at its end".to_string());
                    show_fact(&self.loaded.sources, NoQuestion { why, near: None, help })?;
                    return Ok(None);
                }
            };
        }
        Ok(Some(problem))
    }

    /// Asks one question; gives the answer and whether the user has had enough.
    fn ask(&mut self, target: Target) -> io::Result<Option<(Answered, bool)>> {
        let Some(problem) = self.problem(target)? else { return Ok(None) };
        let (program, world) = (&self.loaded.program, self.sim.world_id());
        let name = match target {
            Target::Goal(id) => &self.sim.world().goals[id].name,
            Target::Never(id) => &self.sim.world().nevers[id].name,
        };
        let watch = CommandWatch::new(name, self.args.seconds);
        let limits = Limits { nodes: nodes_limit(self.args), memory: self.args.memory << 20 };
        let outcome = reach(&problem, self.space, &self.settings, &limits, &watch);
        let mut outcome: Outcome = match outcome {
            Ok(outcome) => outcome,
            Err(fault) => {
                watch.finish();
                show_fact(&self.loaded.sources, fault.fact(program, world, 0))?;
                return Ok(None);
            }
        };
        let seconds = watch.seconds();
        if let (true, Verdict::Reached(plan)) = (self.args.minimize, &outcome.verdict) {
            let least = self.least_hold().unwrap_or(1);
            outcome.verdict = Verdict::Reached(shorten(&problem, plan, u32::from(least), &watch));
        }
        watch.finish();
        if let Some((fault, step)) = outcome.fault {
            show_fact(&self.loaded.sources, fault.fact(program, world, step))?;
        }
        let mut answered = Answered::new(self.loaded, self.sim, target, &outcome, seconds);
        let script = |script: &Script| script.text(program, world);
        answered.violations = outcome
            .violations
            .iter()
            .filter(|(never, _)| self.sim.world().nevers[*never].name != WITHOUT)
            .map(|(never, path)| Violation::new(self.sim.world(), *never, path.len(), script(path)))
            .collect();
        if let (Some(path), Some(inputs)) = (&self.args.save_inputs, &answered.inputs) {
            let path = save_path(path, name, self.targets);
            if let Err(error) = save_script(&path, inputs) {
                plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
                return Ok(None);
            }
            answered.saved = Some(path);
        }
        if let Some(path) = &self.args.svg {
            let path = save_path(path, name, self.targets);
            if let Err(error) = write(&path, self.picture(name, &answered, &outcome)) {
                plain_error(&format!("cannot write `{}`: {error}", path.display()))?;
                return Ok(None);
            }
            answered.drawn = Some(path);
        }
        if self.args.tree {
            answered.tree = Some(outcome.record.iter().map(|v| (v.parent, v.space.0, v.at[0], v.at[1])).collect());
        }
        Ok(Some((answered, watch.is_interrupted())))
    }

    /// What was found, as a picture.
    fn picture(&self, goal: &str, answered: &Answered, outcome: &Outcome) -> String {
        let node = |v: &Visited| Node { parent: v.parent, space: v.space, at: v.at };
        let nodes: Vec<Node> = outcome.record.iter().map(node).collect();
        let path = match &outcome.verdict {
            Verdict::Reached(plan) => self.stops(&plan.script),
            Verdict::NotFound | Verdict::Unreachable(_) => Vec::new(),
        };
        let notes = answered.notes();
        let search = Search { goal, verdict: answered.verdict(), nodes: &nodes, path: &path, notes: &notes };
        search_svg(&self.loaded.program, self.sim.world_id(), &search)
    }

    /// Where the first player is after each step of a script, and before the first.
    fn stops(&self, script: &Script) -> Vec<Stop> {
        let Some(player) = self.sim.world().players.iter().next().map(|p| p.slot) else { return Vec::new() };
        let mut scratch = self.sim.scratch();
        let Ok(mut state) = self.sim.initial(&mut scratch) else { return Vec::new() };
        let stop = |state: &[u8], changes: bool| {
            let (x, y) = self.sim.position(state, player);
            Stop { space: self.sim.space(state, player), at: [x, y], changes }
        };
        let mut stops = vec![stop(&state, false)];
        let mut last = None;
        for input in script.inputs() {
            if self.sim.step(&mut state, input, &mut scratch).is_err() {
                break;
            }
            stops.push(stop(&state, last.is_some_and(|last| last != input)));
            last = Some(input);
        }
        stops
    }

    fn least_hold(&self) -> Option<u16> {
        self.args.min_hold.map(|time| steps(time, self.sim.world()))
    }
}

/// How many nodes may grow.
pub(super) fn nodes_limit(args: &ReachArgs) -> u64 {
    args.nodes.unwrap_or(if args.seconds.is_some() { u64::MAX } else { Limits::default().nodes })
}

/// A time in steps of a world, at least one.
fn steps(time: Time, world: &World) -> u16 {
    match time {
        Time::Steps(steps) => steps.max(1),
        Time::Seconds(seconds) => (seconds / world.step.seconds()).ceil().clamp(1.0, f64::from(u16::MAX)) as u16,
    }
}

/// How to search; shows why there is no way to.
fn settings(args: &ReachArgs, world: &World) -> io::Result<Option<Settings>> {
    let planner = Planner::named(&args.planner).unwrap_or_default();
    let mut hold = args.hold;
    if let Some(least) = args.min_hold.map(|time| steps(time, world)) {
        let (low, high) = hold.unwrap_or(planner.hold());
        if args.hold.is_some() && high < least {
            plain_error(&format!("`--hold` is at most {high} steps, `--min-hold` at least {least}"))?;
            return Ok(None);
        }
        hold = Some((low.max(least), high.max(least)));
    }
    Ok(Some(Settings {
        seed: args.seed,
        planner,
        hold,
        restart: args.restart.unwrap_or_default(),
        sampling: match args.bounds {
            SampleBounds::Naive => Sampling::Naive,
            SampleBounds::Reduced => Sampling::Reduced,
        },
        measure: match args.metric {
            MetricName::Full => Measure::Full,
            MetricName::Xy => Measure::Positions,
        },
        trees: usize::from(args.trees),
        threads: usize::from(args.threads),
        records: args.svg.is_some() || args.tree,
        ..Settings::default()
    }))
}

/// Reads input scripts; shows what is wrong with them.
fn read_scripts(loaded: &mut Loaded, world: WorldId, texts: &[String]) -> io::Result<Option<Vec<Script>>> {
    let mut scripts = Vec::new();
    for text in texts {
        let file = loaded.sources.add("--after", text.clone());
        let (script, found) = parse_script(&loaded.program, world, file, text);
        if found.has_errors() {
            show(&loaded.sources, &found)?;
            return Ok(None);
        }
        scripts.push(script);
    }
    Ok(Some(scripts))
}

/// What was asked for, or all goals; shows why if there is nothing.
fn choose_targets(loaded: &Loaded, world: WorldId, args: &ReachArgs) -> io::Result<Option<Vec<Target>>> {
    let table = &loaded.program.worlds[world];
    let mut chosen = Vec::new();
    let goals: Vec<&str> = table.goals.iter().map(|g| g.name.as_str()).collect();
    let nevers: Vec<&str> = table.nevers.iter().map(|g| g.name.as_str()).filter(|n| *n != WITHOUT).collect();
    for (kind, names, wanted) in [("goal", &goals, &args.goal), ("never", &nevers, &args.never)] {
        for name in wanted {
            let Some(at) = names.iter().position(|n| n == name) else {
                let list: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
                let fact = NoQuestion {
                    why: format!("no {kind} `{name}` in `{}`", table.name),
                    near: similar(name, names.iter().copied()),
                    help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
                };
                show_fact(&loaded.sources, fact)?;
                return Ok(None);
            };
            let target = match kind {
                "goal" => Target::Goal(GoalId(at as u32)),
                _ => Target::Never(NeverId(at as u32)),
            };
            if !chosen.contains(&target) {
                chosen.push(target);
            }
        }
    }
    if args.goal.is_empty() && args.never.is_empty() {
        chosen.extend(table.goals.ids().map(Target::Goal));
    }
    if chosen.is_empty() {
        let why = format!("`{}` has no goal", table.name);
        let help = Some("add one, such as `goal arrive: near(hero, (416, 48), 16)`".to_string());
        show_fact(&loaded.sources, NoQuestion { why, near: None, help })?;
        return Ok(None);
    }
    Ok(Some(chosen))
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

//! What `hypedc reach` asks of a program with its level: goals, where to begin, how to search; and one answer after the
//! other. Nothing here shows anything: what stands in the way is a [`Refusal`].

use std::collections::BTreeSet;
use std::fs::write;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::analysis::{ConfigurationSpace, watched_space};
use crate::compile::Barred;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Diagnostics, Fact, render, similar};
use crate::ir::{ExprId, GoalId, NeverId, World, WorldId};
use crate::reach::{
    BadStart, Death, Guard, Limits, Measure, Outcome, Planner, Problem, Refutation, Sampling, Settings, Target,
    Verdict, Visited, hasten, reach, shorten,
};
use crate::sim::{Script, Simulator, parse_script};
use crate::source::SourceMap;
use crate::view::{Node, Search, Stop, search_svg};
use crate::watch::Watch;

use super::args::{MetricName, ReachArgs, SampleBounds, Time};
use super::reach_result::{Answered, Violation};
use super::refuted::{Occasion, Refuted};
use super::report::{Loaded, plain_error, show};
use super::sim::save_script;

/// What the predicate of `--without` is called.
const WITHOUT: &str = "without";

/// Why a question cannot be asked, or its answer not be kept.
pub(super) enum Refusal {
    Findings(Diagnostics),
    Plain(String),
}

impl Refusal {
    pub fn of(fact: impl Fact) -> Self {
        let mut found = Diagnostics::new();
        found.report(fact);
        Refusal::Findings(found)
    }

    /// Shows it on standard error.
    pub fn show(&self, sources: &SourceMap) -> io::Result<()> {
        match self {
            Refusal::Findings(found) => show(sources, found),
            Refusal::Plain(message) => plain_error(message),
        }
    }

    /// As text, a line for each finding.
    pub fn text(&self, sources: &SourceMap) -> String {
        match self {
            Refusal::Findings(found) => render::short(sources, found.iter()).trim_end().to_string(),
            Refusal::Plain(message) => message.clone(),
        }
    }
}

/// The predicate that may never hold, if there is one.
pub(super) fn barred(args: &ReachArgs) -> Option<Barred<'_>> {
    args.without.as_deref().map(|predicate| Barred {
        world: args.world.as_deref(),
        name: WITHOUT,
        predicate,
        origin: "--without",
    })
}

/// What the arguments mean for a world.
pub(super) struct Prepared {
    world: WorldId,
    pub targets: Vec<Target>,
    pub settings: Settings,
    /// Where searches begin.
    after: Vec<Script>,
}

impl Prepared {
    pub fn new(args: &ReachArgs, loaded: &mut Loaded, world: WorldId) -> Result<Self, Refusal> {
        let table = &loaded.program.worlds[world];
        let (targets, settings) = (choose_targets(table, args)?, settings(args, table)?);
        let after = read_scripts(loaded, world, &args.after)?;
        Ok(Prepared { world, targets, settings, after })
    }
}

/// A world with all that questions about it have in common.
pub(super) struct Asking<'a> {
    args: &'a ReachArgs,
    loaded: &'a Loaded,
    sim: Simulator<'a>,
    space: ConfigurationSpace,
    /// Holds all states that are made for any of the questions against the space, unless that is not wished.
    guard: Option<Guard>,
    prepared: Prepared,
    /// What the analysis of the world took, s.
    pub analysis_seconds: f64,
}

/// What a search has found about a question.
pub(super) struct Found {
    pub target: Target,
    pub outcome: Outcome,
    pub seconds: f64,
}

/// An answer, and how it was found.
pub(super) struct Asked {
    pub answered: Answered,
    pub outcome: Outcome,
}

impl<'a> Asking<'a> {
    /// Works out what the world can be, until it is stopped.
    pub fn new(args: &'a ReachArgs, loaded: &'a Loaded, prepared: Prepared, watch: &dyn Watch) -> Self {
        let started = Instant::now();
        let (program, world) = (&loaded.program, prepared.world);
        // A run is over where a `never` holds.
        let nevers: Vec<ExprId> = program.worlds[world].nevers.iter().map(|never| never.holds).collect();
        let space = watched_space(program, world, &nevers, watch);
        let analysis_seconds = started.elapsed().as_secs_f64();
        Asking::resting_on(args, loaded, prepared, space, analysis_seconds)
    }

    /// Rests its proofs on what the world can be.
    pub fn resting_on(
        args: &'a ReachArgs,
        loaded: &'a Loaded,
        prepared: Prepared,
        space: ConfigurationSpace,
        analysis_seconds: f64,
    ) -> Self {
        let (program, world) = (&loaded.program, prepared.world);
        let guard = (!args.no_check_states).then(|| Guard::new(&space, program, world));
        Asking { args, loaded, sim: Simulator::new(program, world), space, guard, prepared, analysis_seconds }
    }

    /// A run that shows that the analysis is wrong about this world, if the search for any of the answers has met one.
    pub fn refutation(&self) -> Option<Refutation> {
        self.guard.as_ref().and_then(Guard::refutation)
    }

    /// As results have it, with a file from which it can be seen again.
    pub fn refuted(&self, level: Option<&Path>, command: String) -> Option<Refuted> {
        let (program, world) = (&self.loaded.program, self.sim.world_id());
        let mut refuted = Refuted::new(program, world, &self.refutation()?);
        refuted.write(program, world, &Occasion { file: &self.args.file, level, seed: self.args.seed, command });
        Some(refuted)
    }

    /// Of what everything is taken to be possible, and why: each entity once, with its first instance.
    pub fn given_up(&self) -> Vec<String> {
        let world = self.sim.world();
        let mut seen = BTreeSet::new();
        let mut out = Vec::new();
        for (slot, space) in self.space.slots.pairs() {
            let Some(why) = space.why.filter(|_| seen.insert(world.slots[slot].entity)) else { continue };
            let (entity, slot) = (&self.loaded.program.entities[world.slots[slot].entity], &world.slots[slot]);
            out.push(format!("{}: {}, as for {}", entity.name, why.reason(), slot.name));
        }
        out
    }

    pub fn settings(&self) -> &Settings {
        &self.prepared.settings
    }

    pub fn targets(&self) -> &[Target] {
        &self.prepared.targets
    }

    /// Searches for an answer to one question.
    pub fn find(&self, target: Target, watch: &dyn Watch) -> Result<Found, Refusal> {
        let problem = self.problem(target)?;
        let (program, world) = (&self.loaded.program, self.sim.world_id());
        let limits = Limits { nodes: nodes_limit(self.args), memory: self.args.memory << 20 };
        let started = Instant::now();
        let outcome = reach(&problem, &self.space, self.settings(), &limits, watch);
        let seconds = started.elapsed().as_secs_f64();
        let mut outcome: Outcome = outcome.map_err(|fault| Refusal::of(fault.fact(program, world, 0)))?;
        if let (true, Verdict::Reached(plan)) = (self.args.minimize, &outcome.verdict) {
            let least = self.args.min_hold.map_or(1, |time| steps(time, self.sim.world()));
            let plan = hasten(&problem, &self.space, self.settings(), &limits, plan, watch);
            outcome.verdict = Verdict::Reached(shorten(&problem, &plan, u32::from(least), watch));
        }
        Ok(Found { target, outcome, seconds })
    }

    /// The answer to show, once all questions have been asked: what one search has met may refute what was proven before.
    pub fn answer(&self, found: Found) -> Asked {
        let (program, world) = (&self.loaded.program, self.sim.world_id());
        let Found { target, mut outcome, seconds } = found;
        if let Some(refutation) = self.refutation() {
            outcome.refute(&refutation);
        }
        let mut answered = Answered::new(self.loaded, &self.sim, target, &outcome, seconds);
        let script = |script: &Script| script.text(program, world);
        answered.violations = outcome
            .violations
            .iter()
            .filter(|(never, _)| self.sim.world().nevers[*never].name != WITHOUT)
            .map(|(never, path)| Violation::new(self.sim.world(), *never, path.len(), script(path)))
            .collect();
        if self.args.tree {
            answered.tree = Some(outcome.record.iter().map(|v| (v.parent, v.space.0, v.at[0], v.at[1])).collect());
        }
        Asked { answered, outcome }
    }

    /// The question of a target.
    fn problem(&self, target: Target) -> Result<Problem<'_>, Refusal> {
        let world = self.sim.world();
        let mut problem = Problem::asking(&self.sim, target);
        if let Some(guard) = &self.guard {
            problem = problem.guarded(guard);
        }
        if self.args.without.is_some()
            && let Some(never) = world.nevers.iter().last()
        {
            problem = problem.without(never.holds);
        }
        if let Some(time) = self.args.within {
            problem = problem.within(whole_steps(time, world));
        }
        for (script, text) in self.prepared.after.iter().zip(&self.args.after) {
            problem = problem.after(script.clone()).map_err(|bad| match bad {
                BadStart::Fault(fault, step) => {
                    Refusal::of(fault.fact(&self.loaded.program, self.sim.world_id(), step))
                }
                BadStart::Over(death, step) => {
                    let why = match death {
                        Death::Never(id) => format!("`never {}` holds", world.nevers[id].name),
                        Death::Avoided => "the predicate of `--without` holds".to_string(),
                        Death::Outside => "the player is out of bounds".to_string(),
                    };
                    let why = format!("`--after \"{text}\"` leads nowhere: {why} after step {step}");
                    let help = Some("give a script whose run is not over at its end".to_string());
                    Refusal::of(NoQuestion { why, near: None, help })
                }
            })?;
        }
        Ok(problem)
    }

    /// Writes the files that are asked for: the inputs, if a path was found, and the picture. Of several levels the name of
    /// this one goes into theirs.
    pub fn save(&self, asked: &mut Asked, level: Option<&str>) -> Result<(), Refusal> {
        let goal = (self.targets().len() > 1).then_some(asked.answered.goal.as_str());
        let named = |path: &Path| named(path, level.into_iter().chain(goal));
        let cannot =
            |path: &Path, error: io::Error| Refusal::Plain(format!("cannot write `{}`: {error}", path.display()));
        if let (Some(path), Some(inputs)) = (&self.args.save_inputs, &asked.answered.inputs) {
            let path = named(path);
            save_script(&path, inputs).map_err(|error| cannot(&path, error))?;
            asked.answered.saved = Some(path);
        }
        if let Some(path) = &self.args.svg {
            let path = named(path);
            write(&path, self.picture(asked)).map_err(|error| cannot(&path, error))?;
            asked.answered.drawn = Some(path);
        }
        Ok(())
    }

    /// What was found, as a picture.
    fn picture(&self, Asked { answered, outcome }: &Asked) -> String {
        let node = |v: &Visited| Node { parent: v.parent, space: v.space, at: v.at };
        let nodes: Vec<Node> = outcome.record.iter().map(node).collect();
        let path = match &outcome.verdict {
            Verdict::Reached(plan) => self.stops(&plan.script),
            Verdict::NotFound | Verdict::Unreachable(_) => Vec::new(),
        };
        let (goal, notes) = (answered.goal.as_str(), answered.notes());
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
}

/// What a target is called.
pub(super) fn target_name(world: &World, target: Target) -> &str {
    match target {
        Target::Goal(id) => &world.goals[id].name,
        Target::Never(id) => &world.nevers[id].name,
    }
}

/// How many nodes may grow.
pub(super) fn nodes_limit(args: &ReachArgs) -> u64 {
    args.nodes.unwrap_or(if args.seconds.is_some() { u64::MAX } else { Limits::default().nodes })
}

/// How many whole steps of a world a time has room for.
fn whole_steps(time: Time, world: &World) -> u32 {
    match time {
        Time::Steps(steps) => u32::from(steps),
        // What is a whole number of steps but for rounding is one.
        Time::Seconds(seconds) => (seconds / world.step.seconds() + 1e-6).floor() as u32,
    }
}

/// A time in steps of a world, at least one.
fn steps(time: Time, world: &World) -> u16 {
    match time {
        Time::Steps(steps) => steps.max(1),
        Time::Seconds(seconds) => (seconds / world.step.seconds()).ceil().clamp(1.0, f64::from(u16::MAX)) as u16,
    }
}

/// How to search.
fn settings(args: &ReachArgs, world: &World) -> Result<Settings, Refusal> {
    let planner = Planner::named(&args.planner).unwrap_or_default();
    let mut hold = args.hold;
    if let Some(least) = args.min_hold.map(|time| steps(time, world)) {
        let (low, high) = hold.unwrap_or(planner.hold());
        if args.hold.is_some() && high < least {
            let why = format!("`--hold` is at most {high} steps, `--min-hold` at least {least}");
            return Err(Refusal::Plain(why));
        }
        hold = Some((low.max(least), high.max(least)));
    }
    Ok(Settings {
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
        checks: !args.no_check_states,
        ..Settings::default()
    })
}

/// Reads input scripts.
fn read_scripts(loaded: &mut Loaded, world: WorldId, texts: &[String]) -> Result<Vec<Script>, Refusal> {
    let mut scripts = Vec::new();
    for text in texts {
        let file = loaded.sources.add("--after", text.clone());
        let (script, found) = parse_script(&loaded.program, world, file, text);
        if found.has_errors() {
            return Err(Refusal::Findings(found));
        }
        scripts.push(script);
    }
    Ok(scripts)
}

/// What was asked for, or all goals.
fn choose_targets(table: &World, args: &ReachArgs) -> Result<Vec<Target>, Refusal> {
    let mut chosen = Vec::new();
    let goals: Vec<&str> = table.goals.iter().map(|g| g.name.as_str()).collect();
    let nevers: Vec<&str> = table.nevers.iter().map(|g| g.name.as_str()).filter(|n| *n != WITHOUT).collect();
    for (kind, names, wanted) in [("goal", &goals, &args.goal), ("never", &nevers, &args.never)] {
        for name in wanted {
            let Some(at) = names.iter().position(|n| n == name) else {
                let list: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
                return Err(Refusal::of(NoQuestion {
                    why: format!("no {kind} `{name}` in `{}`", table.name),
                    near: similar(name, names.iter().copied()),
                    help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
                }));
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
        return Err(Refusal::of(NoQuestion { why, near: None, help }));
    }
    Ok(chosen)
}

/// A path with some words before its extension.
pub(super) fn named<'w>(path: &Path, words: impl IntoIterator<Item = &'w str>) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    for word in words {
        name.push(".");
        name.push(word);
    }
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

//! What `hypedc reach` asks of a program with its level: goals, where to begin, how to search; and one answer after the
//! other. Nothing here shows anything: what stands in the way is a [`Refusal`].

use std::collections::BTreeSet;
use std::fs::write;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::analysis::{ConfigurationSpace, watched_space};
use crate::compile::ExtraConstraint;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Diagnostics, Fact, render, similar};
use crate::ir::{ExprId, GoalId, NeverId, World, WorldId};
use crate::reach::{
    BadStart, End, Guard, Limits, Measure, Outcome, Plan, Planner, Problem, Refutation, Sampling, Settings, Target,
    Termination, Verdict, Visited, improve_duration, passed, reach, shorten,
};
use crate::sim::{Script, Simulator, parse_script};
use crate::source::SourceMap;
use crate::view::{Node, Search, Stop, search_svg};
use crate::watch::Watch;

use super::refuted::{Occasion, Refuted};
use super::result::{Answered, Question, Violation};
use crate::cli::args::{MetricName, ReachArgs, SampleBounds};
use crate::cli::report::{Loaded, plain_error, show};
use crate::cli::sim::save_script;
use crate::cli::time::{Time, held};

/// What the predicate of `--without` is called: no author can call one so.
const WITHOUT: &str = "--without";

/// Why a question cannot be asked, or its answer not be kept.
pub(in crate::cli) enum Refusal {
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
pub(in crate::cli) fn barred(args: &ReachArgs) -> Option<ExtraConstraint<'_>> {
    args.without.as_deref().map(|predicate| ExtraConstraint {
        world: args.world.as_deref(),
        name: WITHOUT,
        predicate,
        origin: WITHOUT,
    })
}

/// What the arguments mean for a world.
pub(in crate::cli) struct Prepared {
    world: WorldId,
    pub targets: Vec<Target>,
    pub settings: Settings,
    /// For how many steps an input is held at least.
    pub least_hold: u16,
    /// Where searches begin.
    after: Vec<Script>,
}

impl Prepared {
    pub fn new(args: &ReachArgs, loaded: &mut Loaded, world: WorldId) -> Result<Self, Refusal> {
        let table = &loaded.program.worlds[world];
        let (targets, least_hold) = (choose_targets(table, args)?, least_hold(args, table)?);
        let settings = settings(args, table, least_hold)?;
        let after = read_scripts(loaded, world, &args.after)?;
        Ok(Prepared { world, targets, settings, least_hold, after })
    }
}

/// A world with all that questions about it have in common.
pub(in crate::cli) struct ReachSession<'a> {
    args: &'a ReachArgs,
    loaded: &'a Loaded,
    sim: Simulator,
    space: ConfigurationSpace,
    /// Holds all states that are made for any of the questions against the space, unless that is not wished.
    guard: Option<Guard>,
    prepared: Prepared,
    /// What the analysis of the world took, s.
    pub analysis_seconds: f64,
}

/// What was found about a question.
pub(in crate::cli) struct Found<'q> {
    target: Target,
    /// None if it was stopped before it could be asked.
    problem: Option<Problem<'q>>,
    pub outcome: Outcome,
    seconds: f64,
}

impl Found<'_> {
    fn plan(&self) -> Option<&Plan> {
        match &self.outcome.verdict {
            Verdict::Reached(plan) => Some(plan),
            Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
        }
    }
}

/// An answer, and how it was found.
pub(in crate::cli) struct Asked {
    pub answered: Answered,
    pub outcome: Outcome,
}

impl<'a> ReachSession<'a> {
    /// Works out what the world can be, until it is stopped.
    pub fn new(args: &'a ReachArgs, loaded: &'a Loaded, prepared: Prepared, watch: &dyn Watch) -> Self {
        let started = Instant::now();
        let (program, world) = (&loaded.program, prepared.world);
        // A run is over where a `never` holds.
        let nevers: Vec<ExprId> = program.worlds[world].nevers.iter().map(|never| never.holds).collect();
        let space = watched_space(program, world, &nevers, watch);
        let analysis_seconds = started.elapsed().as_secs_f64();
        ReachSession::resting_on(args, loaded, prepared, space, analysis_seconds)
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
        ReachSession { args, loaded, sim: Simulator::new(program, world), space, guard, prepared, analysis_seconds }
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

    /// Searches for an answer to one question, whatever else is asked.
    pub fn find_alone(&self, target: Target, watch: &dyn Watch) -> Result<Found<'_>, Refusal> {
        let mut found = self.find(target, watch)?;
        self.minimize(&mut found, watch);
        Ok(found)
    }

    /// Searches for an answer.
    pub fn find(&self, target: Target, watch: &dyn Watch) -> Result<Found<'_>, Refusal> {
        let started = Instant::now();
        let Some(problem) = self.problem(target, watch)? else {
            let (outcome, seconds) = (Outcome::stopped(self.settings().planner), started.elapsed().as_secs_f64());
            return Ok(Found { target, problem: None, outcome, seconds });
        };
        let started = Instant::now();
        let outcome = reach(&problem, &self.space, self.settings(), &self.limits(), watch);
        let seconds = started.elapsed().as_secs_f64();
        let outcome = outcome.map_err(|fault| Refusal::of(fault.fact(&self.loaded.program, self.sim.world_id(), 0)))?;
        Ok(Found { target, problem: Some(problem), outcome, seconds })
    }

    /// Makes a way faster and simpler, if that is asked for.
    pub fn minimize(&self, found: &mut Found<'_>, watch: &dyn Watch) {
        let (Some(problem), Verdict::Reached(plan), true) =
            (&found.problem, &found.outcome.verdict, self.args.minimize)
        else {
            return;
        };
        let plan = improve_duration(problem, &self.space, self.settings(), &self.limits(), plan, watch);
        found.outcome.verdict = Verdict::Reached(shorten(problem, &plan, watch));
    }

    /// Takes for each question the shortest way that was found for any: what a way to a goal passes on is reached, too.
    /// Gives whether that has changed anything.
    pub fn exchange(&self, all: &mut [Found<'_>], watch: &dyn Watch) -> bool {
        if all.len() < 2 {
            return false;
        }
        let mut ways: Vec<(Script, u64, &'static str)> = Vec::new();
        for found in all.iter() {
            let violations = found.outcome.violations.iter().map(|(_, script)| script);
            for script in found.plan().map(|plan| &plan.script).into_iter().chain(violations) {
                if let Some(after) = self.given(script)
                    && !ways.iter().any(|(known, ..)| known == script)
                {
                    ways.push((script.clone(), after, found.outcome.planner));
                }
            }
        }
        let mut changed = false;
        for found in all {
            let Some(problem) = &found.problem else { continue };
            for (script, after, planner) in &ways {
                let steps = |plan: &Plan| plan.steps - plan.after;
                let known = match &found.outcome.verdict {
                    Verdict::Reached(plan) => Some(steps(plan)),
                    _ => None,
                };
                let plan = passed(problem, script, *after, watch);
                let Some(plan) = plan.filter(|plan| known.is_none_or(|known| steps(plan) < known)) else { continue };
                let outcome = &mut found.outcome;
                (outcome.verdict, outcome.end, outcome.planner) = (Verdict::Reached(plan), End::Answered, *planner);
                outcome.is_withdrawn = false;
                changed = true;
            }
        }
        changed
    }

    /// Simplifies a way that may come from another question, if that is asked for.
    pub fn simplify(&self, found: &mut Found<'_>, watch: &dyn Watch) {
        if let (Some(problem), Verdict::Reached(plan), true) =
            (&found.problem, &found.outcome.verdict, self.args.minimize)
        {
            found.outcome.verdict = Verdict::Reached(shorten(problem, plan, watch));
        }
    }

    /// How many of the first steps of a found script were given with `--after`.
    fn given(&self, script: &Script) -> Option<u64> {
        if self.prepared.after.is_empty() {
            return Some(0);
        }
        let lengths = self.prepared.after.iter().filter(|given| script.first(given.len()) == **given).map(Script::len);
        lengths.max()
    }

    /// The answer to show, once all questions have been asked: what one search has met may refute what was proven before.
    pub fn answer(&self, found: Found<'_>) -> Asked {
        let (program, world) = (&self.loaded.program, self.sim.world_id());
        let Found { target, mut outcome, seconds, .. } = found;
        if let Some(refutation) = self.refutation() {
            outcome.refute(&refutation);
        }
        let asked = Question { least_hold: self.prepared.least_hold, within: self.within() };
        let mut answered = Answered::new(self.loaded, &self.sim, target, asked, &outcome, seconds);
        let script = |script: &Script| script.text(program, world);
        answered.violations = outcome
            .violations
            .iter()
            .filter(|(never, _)| self.barred() != Some(*never))
            .map(|(never, path)| Violation::new(self.sim.world(), *never, path.len(), script(path)))
            .collect();
        if self.args.tree {
            answered.tree = Some(outcome.record.iter().map(|v| (v.parent, v.space.0, v.at[0], v.at[1])).collect());
        }
        Asked { answered, outcome }
    }

    fn limits(&self) -> Limits {
        Limits { nodes: nodes_limit(self.args), memory: self.args.memory << 20 }
    }

    /// The predicate of `--without`: the last `never` of the world.
    fn barred(&self) -> Option<NeverId> {
        self.args.without.as_ref().and_then(|_| self.sim.world().nevers.ids().next_back())
    }

    /// How many steps a way may take.
    fn within(&self) -> Option<u32> {
        self.args.within.map(|time| time.room(self.sim.world()))
    }

    /// The question of a target; none if the watch stopped a script that leads to where it begins.
    fn problem(&self, target: Target, watch: &dyn Watch) -> Result<Option<Problem<'_>>, Refusal> {
        let world = self.sim.world();
        let mut problem = Problem::asking(&self.sim, target).holding(self.prepared.least_hold);
        if let Some(guard) = &self.guard {
            problem = problem.guarded(guard);
        }
        if let Some(never) = self.barred() {
            problem = problem.without(world.nevers[never].holds);
        }
        if let Some(steps) = self.within() {
            problem = problem.within(steps);
        }
        for (script, text) in self.prepared.after.iter().zip(&self.args.after) {
            let (death, step) = match problem.after_watched(script.clone(), watch) {
                Ok(begun) => {
                    problem = begun;
                    continue;
                }
                Err(BadStart::Stopped) => return Ok(None),
                Err(BadStart::Fault(fault, step)) => {
                    return Err(Refusal::of(fault.fact(&self.loaded.program, self.sim.world_id(), step)));
                }
                Err(BadStart::Over(death, step)) => (death, step),
            };
            let why = match death {
                Termination::Never(id) => format!("`never {}` holds", world.nevers[id].name),
                Termination::Avoided => "the predicate of `--without` holds".to_string(),
                Termination::Outside => "the player is out of bounds".to_string(),
            };
            let why = format!("`--after \"{text}\"` leads nowhere: {why} after step {step}");
            let help = Some("give a script whose run is not over at its end".to_string());
            return Err(Refusal::of(NoQuestion { why, near: None, help }));
        }
        Ok(Some(problem))
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
            Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => Vec::new(),
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
pub(in crate::cli) fn target_name(world: &World, target: Target) -> &str {
    match target {
        Target::Goal(id) => &world.goals[id].name,
        Target::Never(id) => &world.nevers[id].name,
    }
}

/// How many nodes may grow.
pub(in crate::cli) fn nodes_limit(args: &ReachArgs) -> u64 {
    args.nodes.unwrap_or(if args.seconds.is_some() { u64::MAX } else { Limits::default().nodes })
}

/// For how many steps of a world an input is held at least.
fn least_hold(args: &ReachArgs, world: &World) -> Result<u16, Refusal> {
    let steps = args.min_hold.map_or(1, |time: Time| time.steps(world));
    u16::try_from(steps).map_err(|_| Refusal::Plain(format!("`--min-hold` is at most {} steps", u16::MAX)))
}

/// How to search.
fn settings(args: &ReachArgs, world: &World, least_hold: u16) -> Result<Settings, Refusal> {
    let planner = Planner::named(&args.planner).unwrap_or_default();
    let hold = args.hold.map(|hold| held(hold.steps(world))).transpose();
    let hold = hold.map_err(|why| Refusal::Plain(format!("`--hold`: {why}")))?;
    if let Some((_, high)) = hold.filter(|(_, high)| *high < least_hold) {
        let why = format!("`--hold` is at most {high} steps, `--min-hold` at least {least_hold}");
        return Err(Refusal::Plain(why));
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
    let mut nevers: Vec<&str> = table.nevers.iter().map(|g| g.name.as_str()).collect();
    if args.without.is_some() {
        nevers.pop();
    }
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
pub(in crate::cli) fn named<'w>(path: &Path, words: impl IntoIterator<Item = &'w str>) -> PathBuf {
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

//! Builds the query from the arguments of `hypedc reach`: targets, starts and settings. Invalid questions are refused
//! here, before any analysis.

use crate::ask::{Without, no_goal, read_scripts, targets};
use crate::compile::{Asked, Changes, ExtraConstraint, ExtraQuestion, NumberSetting, added_nevers};
use crate::corpus;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::ir::{NeverId, World, WorldId};
use crate::reach::query::{Query, QueryError, TimingErrors};
use crate::reach::{Limits, Measure, Planner, Sampling, Settings, Style, Target, Termination};

pub(in crate::cli) use crate::ask::WITHOUT;

use crate::cli::args::{MetricName, ReachArgs, SampleBounds, StyleName};
use crate::cli::refusal::Refusal;
use crate::cli::report::Loaded;
use crate::cli::time::{Time, held};
use crate::parallel;

/// The source of the goal of `--explore`, which nothing reaches.
const EXPLORE: &str = "--explore";
/// The source of predicates of `--skill-without`.
pub(in crate::cli) const SKILL_WITHOUT: &str = "--skill-without";
/// The source of predicates of `--never`.
pub(in crate::cli) const NEVER: &str = "--never";

/// What the arguments add to the program and change in it.
pub(in crate::cli) struct ReachChanges<'a> {
    questions: Vec<ExtraQuestion<'a>>,
    constraint: Option<ExtraConstraint<'a>>,
    numbers: Vec<NumberSetting<'a>>,
}

impl<'a> ReachChanges<'a> {
    pub fn new(args: &'a ReachArgs) -> Self {
        let world = args.world.as_deref();
        let question = |asked, origin| move |text: &'a String| ExtraQuestion { asked, world, text, origin };
        let goals = args.goal.iter().map(question(Asked::Goal, "--goal"));
        let nevers = args.never.iter().map(question(Asked::Never, NEVER));
        let without = args.person.skill_without.iter().filter(|text| Without::read(text).predicate().is_some());
        let without = without.map(question(Asked::Never, SKILL_WITHOUT));
        let is_wandering = args.explore || args.person.has_layers();
        let nowhere =
            is_wandering.then_some(ExtraQuestion { asked: Asked::Goal, world, text: "false", origin: EXPLORE });
        let constraint = |predicate: &'a str| ExtraConstraint { world, name: WITHOUT, predicate, origin: WITHOUT };
        ReachChanges {
            questions: goals.chain(nevers).chain(without).chain(nowhere).collect(),
            constraint: args.without.as_deref().and_then(|text| Without::read(text).predicate()).map(constraint),
            numbers: args.numbers.fixed(),
        }
    }

    /// As the compiler takes them.
    pub fn changes(&self) -> Changes<'_> {
        Changes { questions: &self.questions, constraint: self.constraint, numbers: &self.numbers }
    }

    /// With more numbers.
    pub fn setting(mut self, numbers: &[NumberSetting<'a>]) -> Self {
        self.numbers.extend(numbers);
        self
    }
}

/// The query of the arguments about a world.
pub(in crate::cli) fn query(args: &ReachArgs, loaded: &mut Loaded, world: WorldId) -> Result<Query, Refusal> {
    let table = &loaded.program.worlds[world];
    // The compiler appends it.
    let avoided = args.without.as_deref().map(Without::read);
    let without = avoided.and_then(Without::predicate).and_then(|_| table.nevers.ids().next_back());
    let unpressed = avoided.map_or(Ok(Vec::new()), |avoided| avoided.buttons(&loaded.program, table));
    let (targets, min_hold) = (chosen(table, args, without)?, min_hold(args, table)?);
    let errors = errors(args, table)?;
    let (settings, within) = (settings(args, table, min_hold)?, args.within.map(|time| time.room(table)));
    Ok(Query {
        settings,
        limits: Limits { nodes: node_limit(args), memory: args.memory << 20 },
        min_hold,
        within,
        without: without.into_iter().collect(),
        unpressed: unpressed.map_err(Refusal::of)?,
        asked: asked_only(loaded, world),
        after: read_scripts(loaded, world, (&args.after, "--after"))?,
        style: style(args),
        chance: args.chance,
        errors,
        ..Query::new(targets)
    })
}

/// Describes why a session cannot answer, in terms of the arguments.
pub(in crate::cli) fn refusal(args: &ReachArgs, loaded: &Loaded, world: WorldId, error: &QueryError) -> Refusal {
    let (index, reason, step) = match *error {
        QueryError::Fault(fault, step) => return Refusal::of(fault.fact(&loaded.program, world, step)),
        QueryError::Over { script, reason, step } => (script, reason, step),
    };
    let reason = match reason {
        Termination::Never(id) => format!("`never {}` holds", loaded.program.worlds[world].nevers[id].name),
        Termination::Avoided => "the predicate of `--without` holds".to_string(),
        Termination::Outside => "the player is out of bounds".to_string(),
    };
    let text = args.after.get(index).map_or("", String::as_str);
    let why = format!("`--after \"{text}\"` leads nowhere: {reason} after step {step}");
    let help = Some("give a script whose run is not over at its end".to_string());
    Refusal::of(NoQuestion { why, near: None, help })
}

/// The settings of a search as recorded in results and rows.
pub(in crate::cli) fn recorded_settings(args: &ReachArgs, settings: &Settings) -> corpus::Settings {
    let limits = Limits { nodes: node_limit(args), memory: args.memory << 20 };
    corpus::Settings {
        legend: args.reading.legend.as_ref().map(|path| path.display().to_string()),
        tile: args.reading.tile,
        set: args.numbers.texts(),
        without: args.without.clone(),
        within: args.within.map(|time| time.to_string()),
        after: args.after.clone(),
        min_hold: args.min_hold.map(|time| time.to_string()),
        robust: args.person.robust.as_ref().map(|robust| robust.text.clone()),
        reaction: args.person.reaction.map(|time| time.to_string()),
        minimize: args.minimize || args.style.is_some(),
        style: style(args).filter(|style| *style != Style::Fast).map(|style| style.name().to_string()),
        chance: args.chance,
        nodes_limit: args.nodes.or(args.seconds.is_none().then(|| node_limit(args))),
        seconds_limit: args.seconds,
        ..corpus::Settings::of(settings, &limits)
    }
}

/// How paths are made better, if they are.
fn style(args: &ReachArgs) -> Option<Style> {
    args.style.map(StyleName::style).or_else(|| args.minimize.then_some(Style::Fast))
}

/// Maximum number of nodes of a search.
fn node_limit(args: &ReachArgs) -> u64 {
    args.nodes.unwrap_or(if args.seconds.is_some() { u64::MAX } else { Limits::default().nodes })
}

/// Minimum number of steps of a world for which an input is held.
fn min_hold(args: &ReachArgs, world: &World) -> Result<u16, Refusal> {
    let steps = args.min_hold.or(args.person.reaction).map_or(1, |time: Time| time.steps(world));
    let option = if args.person.reaction.is_some() { "--reaction" } else { "--min-hold" };
    u16::try_from(steps).map_err(|_| Refusal::Plain(format!("`{option}` is at most {} steps", u16::MAX)))
}

/// The timing errors that paths should withstand.
fn errors(args: &ReachArgs, world: &World) -> Result<Option<TimingErrors>, Refusal> {
    match args.person.refusal(world) {
        Some(why) => Err(Refusal::Plain(why)),
        None => Ok(args.person.errors(world)),
    }
}

/// The search settings.
fn settings(args: &ReachArgs, world: &World, min_hold: u16) -> Result<Settings, Refusal> {
    let mut planner = Planner::named(&args.planner).unwrap_or_default();
    if args.explore && !args.person.has_layers() && planner == Planner::Auto {
        planner = Planner::Coverage;
    }
    let hold = args.hold.map(|hold| held(hold.steps(world))).transpose();
    let hold = hold.map_err(|why| Refusal::Plain(format!("`--hold`: {why}")))?;
    if let Some((_, high)) = hold.filter(|(_, high)| *high < min_hold) {
        let why = format!("`--hold` is at most {high} steps, `--min-hold` at least {min_hold}");
        return Err(Refusal::Plain(why));
    }
    if args.exhaust && planner != Planner::Auto {
        let why = format!("`--exhaust` goes on from `auto`, not from `{}`", planner.name());
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
        threads: parallel::threads(args.threads),
        records: !args.person.has_layers() && args.svg.is_some() || args.page.html.is_some() || args.tree,
        checks: !args.no_check_states,
        exhausts: args.exhaust,
        explains: !args.explore && !args.person.has_layers() && args.numbers.sweeps().is_empty(),
        ..Settings::default()
    })
}

/// The named targets, or all goals; of an exploration, the goal that nothing reaches.
fn chosen(world: &World, args: &ReachArgs, without: Option<NeverId>) -> Result<Vec<Target>, Refusal> {
    // The compiler appends it.
    let nowhere = world.goals.ids().next_back().map(Target::Goal);
    let has_layers = args.person.has_layers();
    if args.explore {
        return Ok(nowhere.filter(|_| !has_layers).into_iter().collect());
    }
    let is_offered =
        |target: Target| without.map(Target::Never) != Some(target) && !(has_layers && nowhere == Some(target));
    let chosen = targets(world, (&args.goal, &args.never), &is_offered)?;
    if chosen.is_empty() && !has_layers { Err(no_goal(world)) } else { Ok(chosen) }
}

/// The `never`s that the arguments add as questions: they are no rules of the world.
pub(in crate::cli) fn asked_only(loaded: &Loaded, world: WorldId) -> Vec<NeverId> {
    let added = |origin| added_nevers(&loaded.program, &loaded.sources, world, origin);
    [added(NEVER), added(SKILL_WITHOUT)].concat()
}

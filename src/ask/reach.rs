//! Questions about what is reached: goals and `never`s by name or predicate, and the answers as records.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Serialize;

use crate::compile::question_name;
use crate::corpus;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{World, WorldId};
use crate::reach::query::{Answer, Kind, Session};
use crate::reach::{Outcome, Target};
use crate::sim::{Script, parse_script};

use super::Loaded;
use super::hash::program_sha256;
use super::refusal::Refusal;
use super::refuted::Refuted;

/// The name of the `never` that is added for what paths must not do: not a valid name in a program.
pub const WITHOUT: &str = "--without";
/// The version of the JSON result.
const RESULT_VERSION: u32 = 6;

/// All answers of one run of the command.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct RunResult {
    /// The version of this format.
    pub version: u32,
    /// The path of the program.
    pub file: String,
    /// A hash of what the compiled program means.
    pub program_sha256: String,
    /// The world.
    pub world: String,
    /// How it was searched.
    #[serde(flatten)]
    pub settings: corpus::Settings,
    /// The duration of the analysis, s.
    pub analysis_seconds: f64,
    /// Entities of which the analysis knows nothing, and why.
    pub given_up: Vec<String>,
    /// The answers, in the order of the questions.
    pub goals: Vec<GoalResult>,
    /// A run that shows that the analysis is wrong about this world; null if there is none.
    pub refuted: Option<Refuted>,
}

/// One answer, with what depends on the machine and what is large.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct GoalResult {
    /// The answer.
    #[serde(flatten)]
    pub answer: Answer,
    /// The duration of the search, s.
    pub seconds: f64,
    /// How the coverage grew: nodes, places, combinations of modes, both.
    pub growth: Vec<[u64; 4]>,
    /// All nodes: the parent, and the first player's space, x and y. Null without `--tree`.
    pub tree: Option<Vec<(u32, u32, f32, f32)>>,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub fn reach_schema() -> schemars::Schema {
    schemars::schema_for!(RunResult)
}

impl RunResult {
    /// A result without answers.
    pub fn new(file: &Path, session: &Session, settings: corpus::Settings, analysis_seconds: f64) -> Self {
        let sim = session.simulator();
        RunResult {
            version: RESULT_VERSION,
            file: file.display().to_string(),
            program_sha256: program_sha256(sim.program()),
            world: sim.world().name.clone(),
            settings,
            analysis_seconds,
            given_up: given_up(session),
            goals: Vec::new(),
            refuted: None,
        }
    }

    /// Adds an answer; with all nodes of its search if they are wanted and recorded.
    pub fn add(&mut self, answer: Answer, outcome: &Outcome, seconds: f64, has_tree: bool) {
        let growth = outcome.covered.growth.iter().map(|(n, c)| [*n, c.places, c.modes, c.both]).collect();
        let nodes = || outcome.record.iter().map(|v| (v.parent, v.space.0, v.at[0], v.at[1])).collect();
        self.goals.push(GoalResult { answer, seconds, growth, tree: has_tree.then(nodes) });
    }
}

/// The entities whose analysis was given up, each with its first instance and the reason.
fn given_up(session: &Session) -> Vec<String> {
    let sim = session.simulator();
    let mut seen = BTreeSet::new();
    let mut out = Vec::new();
    for (id, space) in session.space().slots.pairs() {
        let slot = &sim.world().slots[id];
        let Some(why) = space.why.filter(|_| seen.insert(slot.entity)) else { continue };
        out.push(format!("{}: {}, as for {}", sim.program().entities[slot.entity].name, why.reason(), slot.name));
    }
    out
}

/// Reads input scripts.
///
/// # Errors
/// The findings of one that is wrong.
pub fn read_scripts(
    loaded: &mut Loaded,
    world: WorldId,
    (texts, origin): (&[String], &str),
) -> Result<Vec<Script>, Refusal> {
    let mut scripts = Vec::new();
    for text in texts {
        let file = loaded.sources.add(origin, text.clone());
        let (script, found) = parse_script(&loaded.program, world, file, text);
        if found.has_errors() {
            return Err(Refusal::Findings(found));
        }
        scripts.push(script);
    }
    Ok(scripts)
}

/// The named targets without duplicates, or all goals, as far as they are offered; none if the world has none.
///
/// # Errors
/// A name that the world does not have.
pub fn targets(
    world: &World,
    (goals, nevers): (&[String], &[String]),
    is_offered: &dyn Fn(Target) -> bool,
) -> Result<Vec<Target>, Refusal> {
    let known = |target: Target| is_offered(target).then(|| (target, target.name(world)));
    let known_goals: Vec<(Target, &str)> = world.goals.ids().map(Target::Goal).filter_map(known).collect();
    let known_nevers: Vec<(Target, &str)> = world.nevers.ids().map(Target::Never).filter_map(known).collect();
    let mut chosen = Vec::new();
    for (kind, known, names) in [(Kind::Goal, &known_goals, goals), (Kind::Never, &known_nevers, nevers)] {
        for text in names {
            let name = question_name(text);
            let found = known.iter().find(|(_, known)| *known == name);
            let target = found.ok_or_else(|| unknown(world, kind, &name, known))?.0;
            if !chosen.contains(&target) {
                chosen.push(target);
            }
        }
    }
    if goals.is_empty() && nevers.is_empty() {
        chosen.extend(known_goals.iter().map(|(target, _)| *target));
    }
    Ok(chosen)
}

/// Why nothing can be asked about a world without goals.
pub fn no_goal(world: &World) -> Refusal {
    let why = format!("`{}` has no goal", world.name);
    let help = "add one, such as `goal arrive: near(hero, (416, 48), 16)`, ask a predicate with `--goal`, or see what \
                there is with `--explore`";
    Refusal::of(NoQuestion { why, near: None, help: Some(help.to_string()) })
}

/// Refuses an unknown name of a goal or `never`.
pub fn unknown(world: &World, kind: Kind, name: &str, known: &[(Target, &str)]) -> Refusal {
    let list: Vec<String> = known.iter().map(|(_, known)| format!("`{known}`")).collect();
    Refusal::of(NoQuestion {
        why: format!("no {} `{name}` in `{}`", kind.name(), world.name),
        near: similar(name, known.iter().map(|(_, known)| *known)),
        help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
    })
}

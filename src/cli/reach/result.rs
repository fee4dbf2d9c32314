//! The result of one run of `hypedc reach`: its JSON, and the text before and after the answers.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::corpus;
use crate::reach::Outcome;
use crate::reach::query::{Answer, Counterexample, Kind, Session};

use super::question::recorded_settings;
use super::refuted::Refuted;
use super::text::{Detail, counted, with_luck};
use crate::cli::args::ReachArgs;
use crate::cli::report::program_sha256;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 6;

/// All answers of one run of the command.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(in crate::cli) struct RunResult {
    /// The version of this format.
    version: u32,
    /// The path of the program.
    file: String,
    /// A hash of what the compiled program means.
    program_sha256: String,
    /// The world.
    world: String,
    /// How it was searched.
    #[serde(flatten)]
    settings: corpus::Settings,
    /// The duration of the analysis, s.
    analysis_seconds: f64,
    /// Entities of which the analysis knows nothing, and why.
    given_up: Vec<String>,
    /// The answers, in the order of the questions.
    goals: Vec<GoalResult>,
    /// A run that shows that the analysis is wrong about this world; null if there is none.
    pub refuted: Option<Refuted>,
}

/// One answer, with what depends on the machine and what is large.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct GoalResult {
    #[serde(flatten)]
    answer: Answer,
    /// The duration of the search, s.
    seconds: f64,
    /// How the coverage grew: nodes, places, combinations of modes, both.
    growth: Vec<[u64; 4]>,
    /// All nodes: the parent, and the first player's space, x and y. Null without `--tree`.
    tree: Option<Vec<(u32, u32, f32, f32)>>,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(RunResult)
}

impl RunResult {
    pub fn new(args: &ReachArgs, session: &Session, analysis_seconds: f64) -> Self {
        let sim = session.simulator();
        RunResult {
            version: RESULT_VERSION,
            file: args.file.display().to_string(),
            program_sha256: program_sha256(sim.program()),
            world: sim.world().name.clone(),
            settings: recorded_settings(args, &session.query().settings),
            analysis_seconds,
            given_up: given_up(session),
            goals: Vec::new(),
            refuted: None,
        }
    }

    pub fn add(&mut self, args: &ReachArgs, answer: Answer, outcome: &Outcome, seconds: f64) {
        let growth = outcome.covered.growth.iter().map(|(n, c)| [*n, c.places, c.modes, c.both]).collect();
        let nodes = || outcome.record.iter().map(|v| (v.parent, v.space.0, v.at[0], v.at[1])).collect();
        self.goals.push(GoalResult { answer, seconds, growth, tree: args.tree.then(nodes) });
    }

    /// The lines before the answers.
    pub fn head(&self) -> String {
        let settings = &self.settings;
        let naive = if settings.bounds == "naive" { ", naive bounds" } else { "" };
        let metric = if settings.metric == "xy" { ", measured by positions" } else { "" };
        let set: String = settings.set.iter().map(|set| format!(", {set}")).collect();
        let without = settings.without.as_ref().map_or(String::new(), |p| format!(", without {p}"));
        let within = settings.within.as_ref().map_or(String::new(), |time| format!(", within {time}"));
        let after = match settings.after.as_slice() {
            [] => String::new(),
            [only] => format!(", after {only}"),
            several => format!(", after {} scripts", several.len()),
        };
        let hold = settings.min_hold.as_ref();
        let hold = hold.map_or(String::new(), |time| format!(", inputs held for at least {time}"));
        let reaction = settings.reaction.as_ref().map_or(String::new(), |time| format!(", reaction {time}"));
        let robust = settings.robust.as_ref().map_or(String::new(), |errors| format!(", timing errors {errors}"));
        let chance = settings.chance.map_or(String::new(), |seed| format!(", chance seed={seed}"));
        let given_up = self.given_up.iter().map(|why| format!("  everything is possible for {why}\n"));
        let given_up: String = given_up.collect();
        format!(
            "{}, world {}, seed {}{set}{naive}{metric}{without}{within}{hold}{reaction}{robust}{chance}{after}\n{given_up}",
            self.file, self.world, settings.seed
        )
    }

    /// The lines after the answers: each `never` that was violated on the way but not asked about, and a refutation.
    pub fn tail(&self, detail: Detail) -> String {
        let answers = || self.goals.iter().map(|goal| &goal.answer);
        let mut seen: BTreeSet<&String> = answers().filter(|a| a.kind == Kind::Never).map(|a| &a.goal).collect();
        let mut out = String::new();
        for Counterexample { never, steps, inputs, luck } in answers().flat_map(|answer| &answer.violations) {
            if seen.insert(never) {
                let steps = counted(*steps, "step");
                let luck = with_luck(luck.as_ref());
                out.push_str(&format!("  never {never}: can be violated{luck}, counterexample: {steps}\n"));
                if detail != Detail::Quiet {
                    out.push_str(&format!("    inputs  {}\n", detail.script(inputs)));
                }
            }
        }
        out.extend(self.refuted.as_ref().map(Refuted::human));
        out
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

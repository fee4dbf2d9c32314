//! What `hypedc reach` found, as text for people and as JSON for programs.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde::Serialize;

use crate::analysis::{Interval, Values};
use crate::ir::{Bounds, NeverId, Program, World, WorldId};
use crate::reach::{
    Argument, Conclusion, Count, Cut, End, Exhaustion, Outcome, Restart, Settings, Target, TooFar, Verdict,
};
use crate::sim::Simulator;

use super::refuted::Refuted;
use super::session::nodes_limit;
use crate::cli::args::ReachArgs;

use crate::cli::report::{Loaded, program_sha256};
use crate::cli::values;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 5;

/// All answers of one run of the command.
#[derive(Serialize)]
pub(in crate::cli) struct RunResult {
    version: u32,
    hypedc: &'static str,
    file: String,
    /// Of the flat IR: what else is compiled the same has the same.
    program_sha256: String,
    world: String,
    seed: u64,
    planner: &'static str,
    bounds: &'static str,
    metric: &'static str,
    hold: Option<(u16, u16)>,
    /// A number of nodes, `never`, or null: as the planner does by itself.
    restart: Option<String>,
    trees: usize,
    without: Option<String>,
    within: Option<String>,
    min_hold: Option<String>,
    after: Vec<String>,
    analysis_seconds: f64,
    /// Of what nothing is known, and why.
    pub given_up: Vec<String>,
    nodes_limit: Option<u64>,
    seconds_limit: Option<f64>,
    memory_limit: u64,
    goals: Vec<Answered>,
    /// How a search has shown that the analysis is wrong about this world; null if none has.
    pub refuted: Option<Refuted>,
}

impl RunResult {
    pub fn new(
        args: &ReachArgs,
        program: &Program,
        world: WorldId,
        settings: &Settings,
        analysis_seconds: f64,
    ) -> Self {
        RunResult {
            version: RESULT_VERSION,
            hypedc: env!("CARGO_PKG_VERSION"),
            file: args.file.display().to_string(),
            program_sha256: program_sha256(program),
            world: program.worlds[world].name.clone(),
            seed: args.seed,
            planner: settings.planner.name(),
            bounds: settings.sampling.name(),
            metric: settings.measure.name(),
            hold: settings.hold,
            restart: restart_text(settings.restart),
            trees: settings.trees,
            without: args.without.clone(),
            within: args.within.map(|time| time.to_string()),
            min_hold: args.min_hold.map(|time| time.to_string()),
            after: args.after.clone(),
            analysis_seconds,
            given_up: Vec::new(),
            nodes_limit: args.nodes.or(args.seconds.is_none().then(|| nodes_limit(args))),
            seconds_limit: args.seconds,
            memory_limit: args.memory << 20,
            goals: Vec::new(),
            refuted: None,
        }
    }

    pub fn add(&mut self, answered: Answered) {
        self.goals.push(answered);
    }

    /// The first line.
    pub fn head(&self) -> String {
        let naive = if self.bounds == "naive" { ", naive bounds" } else { "" };
        let metric = if self.metric == "xy" { ", measured by positions" } else { "" };
        let without = self.without.as_ref().map_or(String::new(), |p| format!(", without {p}"));
        let within = self.within.as_ref().map_or(String::new(), |time| format!(", within {time}"));
        let after = match self.after.as_slice() {
            [] => String::new(),
            [only] => format!(", after {only}"),
            several => format!(", after {} scripts", several.len()),
        };
        let hold = self.min_hold.as_ref().map_or(String::new(), |time| format!(", inputs held for at least {time}"));
        let given_up = self.given_up.iter().map(|why| format!("  everything is possible for {why}\n"));
        let given_up: String = given_up.collect();
        format!(
            "{}, world {}, seed {}{naive}{metric}{without}{within}{hold}{after}\n{given_up}",
            self.file, self.world, self.seed
        )
    }

    /// What was broken on the way, beside what was asked for.
    pub fn tail(&self) -> String {
        let asked = self.goals.iter().filter(|goal| goal.kind == "never").map(|goal| &goal.goal);
        let mut seen: BTreeSet<&String> = asked.collect();
        let mut out = String::new();
        for violation in self.goals.iter().flat_map(|goal| &goal.violations) {
            if seen.insert(&violation.never) {
                let Violation { never, steps, inputs } = violation;
                out.push_str(&format!(
                    "  never {never}: can be violated, counterexample: {}\n",
                    counted(*steps, "step")
                ));
                out.push_str(&format!("    inputs  {inputs}\n"));
            }
        }
        out.extend(self.refuted.as_ref().map(Refuted::human));
        out
    }
}

/// When trees are begun anew, as results have it; none: as the planner does by itself.
pub(in crate::cli) fn restart_text(restart: Restart) -> Option<String> {
    match restart {
        Restart::ByPlanner => None,
        Restart::After(nodes) => Some(nodes.to_string()),
        Restart::Never => Some("never".to_string()),
    }
}

/// A `never` that was broken on the way, and how.
#[derive(Serialize)]
pub(in crate::cli) struct Violation {
    pub never: String,
    pub steps: u64,
    pub inputs: String,
}

impl Violation {
    pub fn new(world: &World, never: NeverId, steps: u64, inputs: String) -> Self {
        Violation { never: world.nevers[never].name.clone(), steps, inputs }
    }
}

/// How much a search covered.
#[derive(Serialize)]
pub(in crate::cli) struct CoverageResult {
    /// The side of a place, px.
    pub place: f64,
    pub places: u64,
    pub mode_combinations: u64,
    pub places_with_modes: u64,
    /// How it grew: nodes, places, combinations, both.
    pub growth: Vec<[u64; 4]>,
    #[serde(skip)]
    pub half: Count,
}

/// Branches that were given up because a player left the search window of a space.
#[derive(Serialize)]
pub(in crate::cli) struct CutResult {
    pub space: String,
    pub left: f64,
    pub right: f64,
    pub bottom: f64,
    pub branches: u64,
}

impl CutResult {
    fn new(world: &World, &Cut { space, window, branches, .. }: &Cut) -> Self {
        let Bounds { left, right, bottom, top: _ } = window;
        CutResult { space: world.spaces[space].name.clone(), left, right, bottom, branches }
    }

    fn human(&self) -> String {
        let CutResult { space, left, right, bottom, branches } = self;
        let branches = if *branches == 1 { "1 branch".to_string() } else { format!("{branches} branches") };
        format!(
            "    {branches} left the search window of `{space}` (x in {left}..{right}, y >= {bottom}), beyond which \
             nothing was searched; add `bounds` to end runs there\n"
        )
    }
}

/// `1 step`, `2 steps`
fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// What ways a question admits.
#[derive(Debug, Clone, Copy)]
pub(in crate::cli) struct Question {
    /// For how many steps an input is held at least.
    pub least_hold: u16,
    /// How many steps a way may take.
    pub within: Option<u32>,
}

/// The answer to one question.
#[derive(Serialize)]
pub(in crate::cli) struct Answered {
    /// `goal` or `never`.
    pub kind: &'static str,
    pub goal: String,
    pub verdict: Conclusion,
    /// Why there is no way.
    pub argument: Option<String>,
    /// If all states were visited: how many there are.
    pub states: Option<u64>,
    /// If it takes more steps than it may: how many at least.
    pub least_steps: Option<u64>,
    /// Number of steps and length of the path; none if there is none.
    pub steps: Option<u64>,
    pub seconds_of_play: Option<f64>,
    /// Whether no inputs that the question admits (with axes at -1, 0 and 1) take fewer steps; null if there is no path.
    pub is_shortest: Option<bool>,
    /// Whether axes between -1, 0 and 1, which no search tries, can make a difference.
    pub reads_between: bool,
    pub inputs: Option<String>,
    /// Who had the answer.
    pub planner: &'static str,
    pub nodes: u64,
    pub trees: u64,
    pub extensions: u64,
    pub failures: u64,
    pub simulated_steps: u64,
    /// States held against what the analysis says the world can be.
    pub checked_states: u64,
    pub seconds: f64,
    /// Where nothing was found: the finest inputs that change only every so many steps and were all tried, and to how many
    /// states they lead.
    pub exhausted: Option<(u16, u64)>,
    /// Where nothing was found: what was given up at search windows.
    pub cuts: Vec<CutResult>,
    pub coverage: CoverageResult,
    pub violations: Vec<Violation>,
    pub stopped: bool,
    pub out_of_memory: bool,
    #[serde(skip)]
    pub is_spent: bool,
    /// Whether the planner has nothing more to try.
    #[serde(skip)]
    pub is_over: bool,
    pub inputs_left_out: bool,
    /// The parent of each node, and where the first player is: space, x, y. Null if it was not asked for.
    pub tree: Option<Vec<(u32, u32, f32, f32)>>,
    #[serde(skip)]
    pub saved: Option<PathBuf>,
    #[serde(skip)]
    pub drawn: Option<PathBuf>,
    #[serde(skip)]
    pub reasons: Vec<String>,
    /// What was asked, behind the verdict: ` within 60 steps`.
    #[serde(skip)]
    asked: String,
    #[serde(skip)]
    least_hold: u16,
    /// Whether the analysis shows that it holds in no state, however that is come to.
    #[serde(skip)]
    is_in_no_state: bool,
    #[serde(skip)]
    pub is_expected: bool,
}

impl Answered {
    pub fn new(
        loaded: &Loaded,
        sim: &Simulator,
        target: Target,
        question: Question,
        outcome: &Outcome,
        seconds: f64,
    ) -> Self {
        let world = sim.world();
        let (kind, goal) = match target {
            Target::Goal(id) => ("goal", &world.goals[id].name),
            Target::Never(id) => ("never", &world.nevers[id].name),
        };
        let plan = match &outcome.verdict {
            Verdict::Reached(plan) => Some(plan),
            Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
        };
        let mut reasons = match &outcome.verdict {
            Verdict::Unreachable(argument) => why(loaded, world, argument),
            Verdict::Exhausted(all) => vec![
                visited(*all),
                "values of axes between these were not tried, and can make a difference".to_string(),
            ],
            Verdict::Reached(_) | Verdict::NotFound => Vec::new(),
        };
        let argument = (!reasons.is_empty()).then(|| reasons.join("; "));
        if argument.is_some() && values::is_bounded(world) {
            reasons.push("a run ends where a player leaves the bounds of its space, below or beside".to_string());
        }
        if outcome.is_withdrawn {
            reasons.push("the analysis is wrong about this world, as shown below: its proof is withdrawn".to_string());
        }
        let s = &outcome.statistics;
        let covered = &outcome.covered;
        let Question { least_hold, within } = question;
        let hold = format!(" by inputs that are held for at least {least_hold} steps");
        let within = within.map(|steps| format!(" within {}", counted(u64::from(steps), "step")));
        Answered {
            kind,
            goal: goal.clone(),
            verdict: outcome.conclusion(target),
            argument,
            states: match outcome.verdict {
                Verdict::Unreachable(Argument::Exhaustion(all)) | Verdict::Exhausted(all) => Some(all.states),
                _ => None,
            },
            least_steps: match outcome.verdict {
                Verdict::Unreachable(Argument::Distance(far)) => Some(far.least),
                _ => None,
            },
            steps: plan.map(|p| p.steps),
            seconds_of_play: plan.map(|p| p.steps as f64 * world.step.seconds()),
            is_shortest: plan.map(|p| p.is_shortest),
            reads_between: outcome.reads_between,
            is_spent: outcome.end == End::Nodes,
            is_over: outcome.end == End::Answered,
            inputs: plan.map(|p| p.script.text(sim.program(), sim.world_id())),
            planner: outcome.planner,
            nodes: s.nodes,
            trees: s.trees,
            extensions: s.extensions,
            failures: s.failures,
            simulated_steps: s.steps,
            checked_states: s.checked,
            seconds,
            exhausted: outcome.exhausted,
            cuts: match outcome.verdict {
                Verdict::NotFound => outcome.cuts.iter().map(|cut| CutResult::new(world, cut)).collect(),
                _ => Vec::new(),
            },
            coverage: CoverageResult {
                place: crate::reach::PLACE,
                places: covered.all.places,
                mode_combinations: covered.all.modes,
                places_with_modes: covered.all.both,
                growth: covered.growth.iter().map(|(n, c)| [*n, c.places, c.modes, c.both]).collect(),
                half: covered.half,
            },
            violations: Vec::new(),
            stopped: outcome.end == End::Stopped,
            out_of_memory: outcome.end == End::Memory,
            inputs_left_out: outcome.truncated,
            tree: None,
            saved: None,
            drawn: None,
            reasons,
            asked: format!("{}{}", within.unwrap_or_default(), if least_hold > 1 { hold } else { String::new() }),
            least_hold,
            is_in_no_state: matches!(&outcome.verdict, Verdict::Unreachable(Argument::Analysis(_))),
            is_expected: outcome.conclusion(target).is_expected(target),
        }
    }

    /// In a word or two.
    pub fn verdict(&self) -> &'static str {
        self.verdict.words()
    }

    /// The figures, as lines under a picture.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let (Some(steps), Some(seconds)) = (self.steps, self.seconds_of_play) {
            notes.push(format!("path of {steps} steps, {seconds:.2} s of play"));
        }
        notes.extend(self.argument.clone());
        if self.nodes > 0 {
            let c = &self.coverage;
            notes.push(format!(
                "{} nodes, {} places of {} px, {} combinations of modes ({})",
                self.nodes, c.places, c.place, c.mode_combinations, self.planner
            ));
        }
        notes
    }

    /// As text.
    pub fn human(&self, target: Target) -> String {
        let (kind, goal, asked) = (self.kind, &self.goal, &self.asked);
        let is_never = matches!(target, Target::Never(_));
        let verdict = match self.verdict {
            // The analysis looks at states, however they are come to.
            Conclusion::ProvenUnreachable if self.is_in_no_state => match is_never {
                true => "proven, it holds in no state that the world can be in".to_string(),
                false => "proven unreachable, in no state that the world can be in".to_string(),
            },
            Conclusion::ProvenUnreachable if is_never => format!("proven, there is no way to break it{asked}"),
            Conclusion::ProvenUnreachable => format!("proven unreachable{asked}"),
            Conclusion::Exhausted if is_never => {
                format!("not answered, no way to break it with axes at -1, 0 and 1{asked}")
            }
            Conclusion::Exhausted => format!("no way with axes at -1, 0 and 1{asked}"),
            Conclusion::NotAnswered if !is_never => "not answered".to_string(),
            Conclusion::NotAnswered => "not answered, no way to break it was found".to_string(),
            Conclusion::Reached | Conclusion::Violated | Conclusion::NotFound => self.verdict.words().to_string(),
        };
        let mut out = format!("  {kind} {goal}: {verdict}\n");
        self.reasons.iter().for_each(|reason| out.push_str(&format!("    {reason}\n")));
        if let (Some(steps), Some(seconds)) = (self.steps, self.seconds_of_play) {
            let shortest = match self.is_shortest {
                Some(true) => self.shortest(),
                _ => "not proven shortest".to_string(),
            };
            out.push_str(&format!("    path    {} ({seconds:.2} s of play), {shortest}\n", counted(steps, "step")));
        }
        if let Some(inputs) = self.inputs.as_ref().filter(|i| !i.is_empty()) {
            out.push_str(&format!("    inputs  {inputs}\n"));
        }
        if let Some(path) = &self.saved {
            out.push_str(&format!("    saved   {}\n", path.display()));
        }
        if let Some(path) = &self.drawn {
            out.push_str(&format!("    drawn   {}\n", path.display()));
        }
        if self.nodes == 0 {
            return out;
        }
        let (nodes, trees, by) = (counted(self.nodes, "node"), counted(self.trees, "tree"), self.planner);
        out.push_str(&format!(
            "    search  {nodes} in {trees}, {:.3} s; {} of {} extensions failed ({by})\n",
            self.seconds, self.failures, self.extensions
        ));
        let is_open = self.verdict.is_open();
        if is_open {
            let c = &self.coverage;
            out.push_str(&format!(
                "    covered {} places of {} px, {} combinations of modes, {} of both; in the second half {}, {} and {} of \
                 them new\n",
                c.places,
                c.place,
                c.mode_combinations,
                c.places_with_modes,
                c.places - c.half.places,
                c.mode_combinations - c.half.modes,
                c.places_with_modes - c.half.both
            ));
        }
        if self.stopped {
            out.push_str("    stopped before the budget of nodes was spent\n");
        }
        if self.out_of_memory {
            out.push_str("    stopped because the memory is full; `--memory MIB` gives more\n");
        }
        if self.inputs_left_out {
            out.push_str("    some combinations of buttons were left out: there are too many\n");
        }
        if is_open {
            if let Some((hold, states)) = self.exhausted {
                out.push_str(&format!(
                    "    inputs that change only every {hold} steps (axes at -1, 0 and 1) lead to {}, not there; others may\n",
                    counted(states, "state")
                ));
            }
            self.cuts.iter().for_each(|cut| out.push_str(&cut.human()));
            out.push_str(&match (self.is_over, self.is_spent) {
                // All planners stop at the search window.
                (true, _) if !self.cuts.is_empty() => "    this proves nothing\n".to_string(),
                (true, _) => format!(
                    "    this proves nothing; `{by}` has nothing more to try, another `--planner` may find a way\n"
                ),
                (_, true) => {
                    "    this proves nothing: a longer search (`--nodes N`, `--seconds S`) may find a way\n".to_string()
                }
                _ => "    this proves nothing: a longer search may find a way\n".to_string(),
            });
        }
        out
    }
}

impl Answered {
    /// Among which ways the path is a shortest one.
    fn shortest(&self) -> String {
        let axes = if self.reads_between { " with axes at -1, 0 and 1" } else { "" };
        let hold = match self.least_hold {
            1 => String::new(),
            steps => format!(" by inputs that are held for at least {steps} steps"),
        };
        format!("shortest{axes}{hold}")
    }
}

/// Why something cannot be reached.
fn why(loaded: &Loaded, world: &World, argument: &Argument) -> Vec<String> {
    match argument {
        Argument::Analysis(proof) => values::reasons(&loaded.sources, &loaded.program, world, proof),
        Argument::Distance(TooFar { player, within: [x, y], least }) => {
            let name = &world.slots[*player].name;
            let range = |axis: &str, at: &Interval| values::relation(&format!("{name}.{axis}"), &Values::from(*at));
            let seconds = *least as f64 * world.step.seconds();
            vec![
                format!("by then {} and {}, where it cannot hold", range("x", x), range("y", y)),
                format!("it takes at least {} ({seconds:.2} s)", counted(*least, "step")),
            ]
        }
        Argument::Exhaustion(all) => vec![visited(*all)],
        Argument::Over => vec!["every run is over before it begins".to_string()],
    }
}

/// What an exhaustion has looked at.
fn visited(Exhaustion { states, least_hold }: Exhaustion) -> String {
    let held = match least_hold {
        1 => "that can change at every step".to_string(),
        steps => format!("that are held for at least {steps} steps"),
    };
    let states = if states == 1 { "the only state was".to_string() } else { format!("all {states} states were") };
    format!("{states} visited to which inputs lead {held}: all buttons, axes at -1, 0 and 1")
}

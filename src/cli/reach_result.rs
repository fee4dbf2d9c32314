//! What `hypedc reach` found, as text for people and as JSON for programs.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde::Serialize;

use crate::ir::{Bounds, NeverId, Program, World, WorldId};
use crate::reach::{Argument, Count, Cut, End, Outcome, Restart, Settings, Target, Verdict};
use crate::sim::Simulator;

use super::args::ReachArgs;
use super::asking::nodes_limit;
use super::refuted::Refuted;

use super::report::{Loaded, program_sha256};
use super::values;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 3;

/// All answers of one run of the command.
#[derive(Serialize)]
pub(super) struct RunResult {
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
        let given_up = self.given_up.iter().map(|why| format!("  everything is possible for {why}\n"));
        let given_up: String = given_up.collect();
        format!(
            "{}, world {}, seed {}{naive}{metric}{without}{within}{after}\n{given_up}",
            self.file, self.world, self.seed
        )
    }

    /// What was broken on the way, whatever was asked for.
    pub fn tail(&self) -> String {
        let mut seen = BTreeSet::new();
        let mut out = String::new();
        for violation in self.goals.iter().flat_map(|goal| &goal.violations) {
            if seen.insert(&violation.never) {
                let Violation { never, steps, inputs } = violation;
                out.push_str(&format!("  never {never}: can happen, as after {steps} steps\n"));
                out.push_str(&format!("    inputs  {inputs}\n"));
            }
        }
        out.extend(self.refuted.as_ref().map(Refuted::human));
        out
    }
}

/// When trees are begun anew, as results have it; none: as the planner does by itself.
pub(super) fn restart_text(restart: Restart) -> Option<String> {
    match restart {
        Restart::ByPlanner => None,
        Restart::After(nodes) => Some(nodes.to_string()),
        Restart::Never => Some("never".to_string()),
    }
}

/// A `never` that was broken on the way, and how.
#[derive(Serialize)]
pub(super) struct Violation {
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
pub(super) struct CoverageResult {
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
pub(super) struct CutResult {
    pub space: String,
    pub left: f64,
    pub right: f64,
    pub bottom: f64,
    pub branches: u64,
}

impl CutResult {
    fn new(world: &World, &Cut { space, window, branches }: &Cut) -> Self {
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

/// The answer to one question.
#[derive(Serialize)]
pub(super) struct Answered {
    /// `goal` or `never`.
    pub kind: &'static str,
    pub goal: String,
    pub verdict: &'static str,
    /// Why it is proven unreachable.
    pub argument: Option<String>,
    /// If it is proven by exhaustion: for how many steps inputs are held.
    pub proven_by_hold: Option<u16>,
    /// Number of steps and length of the path; none if there is none.
    pub steps: Option<u64>,
    pub seconds_of_play: Option<f64>,
    /// If no path of inputs held for so many steps each is shorter: for how many.
    pub shortest_by: Option<u16>,
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
    /// Where nothing was found: for how many steps inputs are held that are proven to lead nowhere, and to how many states.
    pub exhausted: Option<(u16, u64)>,
    /// Where nothing was found: what was given up at search windows.
    pub cuts: Vec<CutResult>,
    pub coverage: CoverageResult,
    pub violations: Vec<Violation>,
    pub stopped: bool,
    pub out_of_memory: bool,
    #[serde(skip)]
    pub is_spent: bool,
    pub inputs_left_out: bool,
    /// The parent of each node, and where the first player is: space, x, y. Null if it was not asked for.
    pub tree: Option<Vec<(u32, u32, f32, f32)>>,
    #[serde(skip)]
    pub saved: Option<PathBuf>,
    #[serde(skip)]
    pub drawn: Option<PathBuf>,
    #[serde(skip)]
    pub reasons: Vec<String>,
    #[serde(skip)]
    pub is_as_wished: bool,
}

impl Answered {
    pub fn new(loaded: &Loaded, sim: &Simulator<'_>, target: Target, outcome: &Outcome, seconds: f64) -> Self {
        let world = sim.world();
        let (kind, goal) = match target {
            Target::Goal(id) => ("goal", &world.goals[id].name),
            Target::Never(id) => ("never", &world.nevers[id].name),
        };
        let plan = match &outcome.verdict {
            Verdict::Reached(plan) => Some(plan),
            Verdict::NotFound | Verdict::Unreachable(_) => None,
        };
        let mut reasons = match &outcome.verdict {
            Verdict::Unreachable(argument) => why(loaded, world, argument),
            _ => Vec::new(),
        };
        let argument = (!reasons.is_empty()).then(|| reasons.join("; "));
        if argument.is_some() && values::is_bounded(world) && kind == "goal" {
            reasons.push("a run ends where a player leaves the bounds of its space, below or beside".to_string());
        }
        if outcome.is_withdrawn {
            reasons.push("the analysis is wrong about this world, as shown below: its proof is withdrawn".to_string());
        }
        let s = &outcome.statistics;
        let covered = &outcome.covered;
        Answered {
            kind,
            goal: goal.clone(),
            verdict: match (&outcome.verdict, kind) {
                (Verdict::Reached(_), "goal") => "reached",
                (Verdict::Reached(_), _) => "violated",
                (Verdict::NotFound, _) if outcome.is_withdrawn => "not answered",
                (Verdict::NotFound, _) => "not found",
                (Verdict::Unreachable(_), _) => "proven-unreachable",
            },
            argument,
            steps: plan.map(|p| p.steps),
            seconds_of_play: plan.map(|p| p.steps as f64 * world.step.seconds()),
            shortest_by: plan.and_then(|p| p.shortest_by),
            proven_by_hold: match outcome.verdict {
                Verdict::Unreachable(Argument::Exhaustion { states: 1.., hold }) => Some(hold),
                _ => None,
            },
            is_spent: outcome.end == End::Nodes,
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
            is_as_wished: match kind {
                "goal" => plan.is_some(),
                _ => plan.is_none(),
            },
        }
    }

    /// In a word or two.
    pub fn verdict(&self) -> &'static str {
        self.verdict
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
        let (kind, goal) = (self.kind, &self.goal);
        let mut out = match (self.verdict, target) {
            ("proven-unreachable", _) if self.planner == "analysis" => {
                format!("  {kind} {goal}: proven unreachable, in no state that the world can be in\n")
            }
            ("proven-unreachable", _) => match self.proven_by_hold {
                Some(hold @ 2..) => {
                    format!("  {kind} {goal}: proven unreachable by inputs that are held for {hold} steps each\n")
                }
                _ => format!("  {kind} {goal}: proven unreachable\n"),
            },
            ("not found", Target::Never(_)) => format!("  {kind} {goal}: no way to break it was found\n"),
            (verdict, _) => format!("  {kind} {goal}: {verdict}\n"),
        };
        self.reasons.iter().for_each(|reason| out.push_str(&format!("    {reason}\n")));
        if let (Some(steps), Some(seconds)) = (self.steps, self.seconds_of_play) {
            let shortest = match self.shortest_by {
                Some(1) => ", as few as there can be".to_string(),
                Some(hold) => format!(", as few as inputs that are held for {hold} steps each can do"),
                None => String::new(),
            };
            out.push_str(&format!("    path    {steps} steps ({seconds:.2} s of play){shortest}\n"));
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
        let (trees, by) = (if self.trees == 1 { "tree" } else { "trees" }, self.planner);
        out.push_str(&format!(
            "    search  {} nodes in {} {trees}, {:.3} s; {} of {} extensions failed ({by})\n",
            self.nodes, self.trees, self.seconds, self.failures, self.extensions
        ));
        if self.verdict == "not found" {
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
        if self.verdict == "not found" {
            if let Some((hold, states)) = self.exhausted {
                out.push_str(&format!(
                    "    inputs that are held for {hold} steps each lead nowhere: all their {states} states were visited\n"
                ));
            }
            self.cuts.iter().for_each(|cut| out.push_str(&cut.human()));
            let longer = if self.is_spent { " (`--nodes N`, `--seconds S`)" } else { "" };
            out.push_str(&format!("    this proves nothing: a longer search{longer} may find a way\n"));
        }
        out
    }
}

/// Why something cannot be reached.
fn why(loaded: &Loaded, world: &World, argument: &Argument) -> Vec<String> {
    match argument {
        Argument::Analysis(proof) => values::reasons(&loaded.sources, &loaded.program, world, proof),
        Argument::Exhaustion { states: 0, .. } => vec!["every run is over before it begins".to_string()],
        Argument::Exhaustion { states, hold } => {
            let held = if *hold == 1 { "a step".to_string() } else { format!("{hold} steps") };
            vec![format!(
                "all {states} states were visited that inputs lead to which are held for {held} each (axes at -1, 0, 1)"
            )]
        }
    }
}

//! Where a player gets stuck: the question, and its answer as a record, from which JSON and text are made.

use std::path::Path;

use serde::Serialize;

use crate::analysis::watched_space;
use crate::ir::{ExprId, GoalId, Program, World, WorldId};
use crate::reach::stuck::{
    Candidate, CandidateAnswer, CandidateLimits, ExactAnswer, Gap, Spot, StateCounts, Unknown, WayIn, find_candidates,
    find_stuck,
};
use crate::reach::{Limits, Problem};
use crate::sim::{Fault, Script, Simulator};
use crate::watch::Watch;

use super::hash::program_sha256;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;
/// Maximum number of ways in a result.
const MAX_WAYS: usize = 100;

/// What is known of the soft locks of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StuckVerdict {
    /// All states were visited, and the goal can be reached from each that does not end anyway.
    None,
    /// All states were visited, and some are stuck.
    Stuck,
    /// There are places from which no search arrived.
    Candidates,
    /// From all places that were found, a search arrived; there may be others.
    NoneFound,
    /// The goal cannot be reached at all: all states were visited.
    Unreachable,
    /// Nothing can be said.
    Unknown,
}

/// Where a player gets stuck.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct StuckResult {
    /// The version of this format.
    pub version: u32,
    /// The path of the program.
    pub file: String,
    /// A hash of what the compiled program means.
    pub program_sha256: String,
    /// The world.
    pub world: String,
    /// Numbers of the program that were set.
    pub set: Vec<String>,
    /// The goal.
    pub goal: String,
    /// The answer.
    pub verdict: StuckVerdict,
    /// Whether axes between -1, 0 and 1, which are not tried, can make a difference: then nothing is proven.
    pub reads_between: bool,
    /// The numbers of states; null if not all were visited.
    pub states: Option<StateCounts>,
    /// Why not all states were visited; null if they were.
    pub not_all_states: Option<String>,
    /// Why nothing can be said; null if something can.
    pub unknown: Option<String>,
    /// Places at which players rest that were found, where not all states were visited.
    pub rest_places: Option<u64>,
    /// Of those, the ones of which nothing is known as the budget was spent.
    pub open_places: u64,
    /// The number of stuck places, or of candidates: there can be more than `ways`.
    pub places: u64,
    /// The ways into them.
    pub ways: Vec<StuckWay>,
    /// The duration of all searches, s.
    pub seconds: f64,
}

/// A way into a place from which the goal cannot be reached.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct StuckWay {
    /// Where the players are.
    pub place: String,
    /// Whether it is proven that the goal cannot be reached from there.
    pub proven: bool,
    /// If it is not: the nodes of the search that did not arrive.
    pub nodes: Option<u64>,
    /// The number of steps.
    pub steps: u64,
    /// The duration in the world, s.
    pub seconds_of_play: f64,
    /// The input of the last step, with which the goal is lost; null for a candidate.
    pub last_input: Option<String>,
    /// Of a candidate: where the players were at rest before.
    pub from: Option<String>,
    /// What differs soon after from what would be without the last input.
    pub changes: Vec<String>,
    /// The stuck states, or the places of the candidate, that are behind.
    pub behind: u64,
    /// Whether most of these are behind no other place with a shorter way; of a candidate always.
    pub is_apart: bool,
    /// The inputs, as a script.
    pub inputs: String,
}

impl StuckWay {
    /// The record of a way of a world of which all states were visited.
    pub fn exact(way: &WayIn, proven: bool, program: &Program, world: WorldId) -> Self {
        let mut last = Script::default();
        last.push(&way.last, 1);
        let steps = way.script.len();
        StuckWay {
            place: way.place.clone(),
            proven,
            nodes: None,
            steps,
            seconds_of_play: steps as f64 * program.worlds[world].step.seconds(),
            last_input: Some(last.text(program, world)),
            from: None,
            changes: way.changes.clone(),
            behind: way.behind,
            is_apart: way.is_apart,
            inputs: way.script.text(program, world),
        }
    }

    /// The record of a candidate.
    pub fn candidate(way: &Candidate, program: &Program, world: WorldId) -> Self {
        let steps = way.script.len();
        StuckWay {
            place: way.place.clone(),
            proven: way.is_proven,
            nodes: Some(way.nodes),
            steps,
            seconds_of_play: steps as f64 * program.worlds[world].step.seconds(),
            last_input: None,
            from: Some(way.from.clone()),
            changes: way.changes.clone(),
            behind: way.places,
            is_apart: true,
            inputs: way.script.text(program, world),
        }
    }
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub fn stuck_schema() -> schemars::Schema {
    schemars::schema_for!(StuckResult)
}

/// The budget of a question about where players get stuck.
#[derive(Debug, Clone, Copy)]
pub struct StuckLimits {
    /// Maximum number of states: where there are more, nothing is proven, and places are looked for that may be stuck.
    pub states: u64,
    /// Maximum number of nodes of that search, and again of the searches from the places that it finds.
    pub nodes: u64,
    /// Maximum memory for states, bytes.
    pub memory: u64,
    /// The seed of the search for candidates.
    pub seed: u64,
    /// The limit of time that the watches keep, s: for words only.
    pub seconds: Option<f64>,
}

/// The watches of the answer.
pub struct StuckWatches<'w> {
    /// While all states are visited.
    pub exact: &'w dyn Watch,
    /// Of the whole.
    pub whole: &'w dyn Watch,
    /// Whether a person has stopped it.
    pub is_interrupted: &'w dyn Fn() -> bool,
}

/// What is drawn of an answer.
#[derive(Debug, Default)]
pub struct StuckDrawn {
    /// Where the first player is stuck.
    pub spots: Vec<Spot>,
    /// The ways in.
    pub scripts: Vec<Script>,
}

/// An answer.
pub struct StuckAnswer {
    /// The record.
    pub result: StuckResult,
    /// What is drawn of it.
    pub drawn: StuckDrawn,
    /// A run-time error that was met on the way, with its step.
    pub fault: Option<(Fault, u64)>,
}

/// Visits all states; if that cannot be done, searches for candidates. The record has neither numbers that were set nor its
/// duration.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule.
pub fn answer_stuck(
    file: &Path,
    (sim, goal): (&Simulator, GoalId),
    limits: &StuckLimits,
    watches: &StuckWatches<'_>,
) -> Result<StuckAnswer, Fault> {
    let mut answer = StuckAnswer { result: empty(file, sim, goal), drawn: StuckDrawn::default(), fault: None };
    let (result, watch) = (&mut answer.result, watches.whole);
    let problem = Problem::new(sim, goal);
    let [all, nodes] = [limits.states, limits.nodes].map(|nodes| Limits { nodes, memory: limits.memory });
    // The search for candidates needs time, too.
    let gap = match find_stuck(&problem, &all, MAX_WAYS, watches.exact)? {
        Ok(exact) => {
            answer.drawn = add_exact(result, exact, sim);
            return Ok(answer);
        }
        Err(gap) => gap,
    };
    if let Gap::Fault(fault, step) = gap {
        // The search goes on around it.
        answer.fault = Some((fault, step));
    }
    let stopped = Stopped { is_interrupted: (watches.is_interrupted)(), seconds: limits.seconds };
    result.not_all_states = Some(gap_words(gap, &all, sim.world(), stopped));
    if watch.stop() {
        result.unknown = Some(unknown_words(Unknown::Stopped, stopped));
        return Ok(answer);
    }
    let nevers: Vec<ExprId> = sim.world().nevers.iter().map(|never| never.holds).collect();
    let space = watched_space(sim.program(), sim.world_id(), &nevers, watch);
    match find_candidates(&problem, &space, &CandidateLimits { limits: nodes, seed: limits.seed }, watch)? {
        Ok(found) => answer.drawn = add_candidates(result, found, sim),
        Err(unknown) => {
            let stopped = Stopped { is_interrupted: (watches.is_interrupted)(), ..stopped };
            result.unknown = Some(unknown_words(unknown, stopped));
        }
    }
    Ok(answer)
}

/// The record before anything is known.
fn empty(file: &Path, sim: &Simulator, goal: GoalId) -> StuckResult {
    StuckResult {
        version: RESULT_VERSION,
        file: file.display().to_string(),
        program_sha256: program_sha256(sim.program()),
        world: sim.world().name.clone(),
        set: Vec::new(),
        goal: sim.world().goals[goal].name.clone(),
        verdict: StuckVerdict::Unknown,
        reads_between: false,
        states: None,
        not_all_states: None,
        unknown: None,
        rest_places: None,
        open_places: 0,
        places: 0,
        ways: Vec::new(),
        seconds: 0.0,
    }
}

fn add_exact(result: &mut StuckResult, exact: ExactAnswer, sim: &Simulator) -> StuckDrawn {
    result.verdict = match exact.counts.stuck {
        _ if !exact.starts_well => StuckVerdict::Unreachable,
        0 => StuckVerdict::None,
        _ => StuckVerdict::Stuck,
    };
    result.reads_between = exact.reads_between;
    result.states = Some(exact.counts);
    result.places = exact.places as u64;
    let record = |way| StuckWay::exact(way, !exact.reads_between, sim.program(), sim.world_id());
    result.ways = exact.ways.iter().map(record).collect();
    StuckDrawn { spots: exact.spots, scripts: exact.ways.into_iter().map(|way| way.script).collect() }
}

fn add_candidates(result: &mut StuckResult, answer: CandidateAnswer, sim: &Simulator) -> StuckDrawn {
    result.verdict = if answer.candidates.is_empty() { StuckVerdict::NoneFound } else { StuckVerdict::Candidates };
    (result.rest_places, result.open_places) = (Some(answer.rest_places), answer.open_places);
    result.places = answer.candidates.len() as u64;
    let shown = || answer.candidates.iter().take(MAX_WAYS);
    result.ways = shown().map(|way| StuckWay::candidate(way, sim.program(), sim.world_id())).collect();
    let scripts = shown().map(|way| way.script.clone()).collect();
    StuckDrawn { spots: answer.spots, scripts }
}

/// What stopped a search.
#[derive(Clone, Copy)]
struct Stopped {
    /// Whether ctrl-C was pressed.
    is_interrupted: bool,
    /// The limit of time.
    seconds: Option<f64>,
}

impl Stopped {
    fn words(self) -> String {
        match self.seconds.filter(|_| !self.is_interrupted) {
            Some(seconds) => format!("`--seconds {seconds}` allows no more"),
            None => "the search was interrupted".to_string(),
        }
    }
}

/// Why nothing can be said, and what helps.
fn unknown_words(unknown: Unknown, stopped: Stopped) -> String {
    match unknown {
        Unknown::NotFound => "no way to the goal was found from the start; `hypedc reach` tells more".to_string(),
        Unknown::Unreachable => "the goal cannot be reached from the start; `hypedc reach` tells why".to_string(),
        Unknown::NoRest => "players never rest in this world, so that there are no places to search from".to_string(),
        Unknown::Stopped => format!("places to get stuck were not looked for to the end: {}", stopped.words()),
    }
}

/// Why not all states were visited, and what helps.
fn gap_words(gap: Gap, limits: &Limits, world: &World, stopped: Stopped) -> String {
    match gap {
        Gap::Inputs => "there are too many combinations of buttons".to_string(),
        Gap::Draws => "nature draws from too many values".to_string(),
        Gap::Window(space) => {
            let space = &world.spaces[space].name;
            format!("a player can leave all that there is in `{space}`; `bounds` end a run there")
        }
        Gap::Fault(..) => "the program has a run-time error".to_string(),
        Gap::Nodes => format!("more than `--states {}` allows", limits.nodes),
        Gap::Memory => "the memory is full; `--memory MIB` gives more".to_string(),
        Gap::Stopped => stopped.words(),
    }
}

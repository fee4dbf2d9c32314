//! The result of `hypedc stuck` as a record, from which JSON and text are made.

use serde::Serialize;

use crate::ir::{Program, WorldId};
use crate::reach::stuck::{Candidate, StateCounts, WayIn};
use crate::sim::Script;

/// The version of the JSON result.
pub(super) const RESULT_VERSION: u32 = 1;

/// What is known of the soft locks of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub(super) enum StuckVerdict {
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
pub(super) struct StuckResult {
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
    pub ways: Vec<WayResult>,
    /// The duration of all searches, s.
    pub seconds: f64,
}

/// A way into a place from which the goal cannot be reached.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct WayResult {
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

impl WayResult {
    /// The record of a way of a world of which all states were visited.
    pub fn exact(way: &WayIn, proven: bool, program: &Program, world: WorldId) -> Self {
        let mut last = Script::default();
        last.push(&way.last, 1);
        let steps = way.script.len();
        WayResult {
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
        WayResult {
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
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(StuckResult)
}

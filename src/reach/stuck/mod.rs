//! Soft locks: states that can be reached from which the goal cannot be.
//!
//! Where all states can be visited, the answer is exact: a backward search over the graph of all states tells which of
//! them arrive (`graph.rs`, `fates.rs`), and the steps from those to the others are the points of no return
//! (`ways_in.rs`). Luck is no obstacle: nature draws whatever helps.
//!
//! Elsewhere there are candidates: places from which no search arrives (`candidates.rs`). They are looked for among the
//! places at which players rest (`roadmap.rs`), which random ways connect (`rollout.rs`).

mod candidates;
mod fates;
mod graph;
mod place;
mod roadmap;
mod rollout;
mod ways_in;

pub use candidates::{Candidate, CandidateAnswer, CandidateLimits, Unknown, find_candidates};
pub use graph::Gap;
pub use place::PlayerPlace;
pub use ways_in::WayIn;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::ir::SpaceId;
use crate::sim::Fault;
use crate::watch::Watch;

use super::controls::reads_between;
use super::problem::Problem;
use super::search::Limits;
use super::tree::NodeId;
use fates::{Fate, fates};
use graph::{Explorer, StateGraph};
use place::Places;
use ways_in::ways_in;

/// The numbers of states of each fate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct StateCounts {
    /// All states that can be reached before the run is over, up to those in which the goal holds.
    pub all: u64,
    /// Those in which the goal holds.
    pub goals: u64,
    /// Those from which some inputs reach the goal, the goals included.
    pub arriving: u64,
    /// Those from which none do, but some go on for ever.
    pub stuck: u64,
    /// The stuck ones in which no input changes anything any more.
    pub dead_ends: u64,
    /// Those from which none do, and all end the run sooner or later, or leave no player.
    pub doomed: u64,
}

/// A place in a picture: the space and the position of the first player, px.
pub type Spot = (SpaceId, [f32; 2]);

/// The answer where all states were visited.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactAnswer {
    /// The numbers of states.
    pub counts: StateCounts,
    /// Whether the goal can be reached at all.
    pub starts_well: bool,
    /// The shortest ways in, the shortest first.
    pub ways: Vec<WayIn>,
    /// The number of places that have one.
    pub places: usize,
    /// Where the first player gets stuck, or is in no other states; in no order.
    pub spots: Vec<Spot>,
    /// Whether axes between -1, 0 and 1, which are not tried, can make a difference: then nothing is proven.
    pub reads_between: bool,
}

/// Visits all states and tells which are stuck.
///
/// # Errors
/// A [`Fault`] if the initial state breaks a rule. Within it, the reason if there may be states that cannot be visited.
pub fn find_stuck(
    problem: &Problem<'_>,
    limits: &Limits,
    ways: usize,
    watch: &dyn Watch,
) -> Result<Result<ExactAnswer, Gap>, Fault> {
    let Some(explorer) = Explorer::new(problem, watch)? else {
        // Every run is over before its first step, or nothing was begun.
        let none = ExactAnswer {
            counts: StateCounts::default(),
            starts_well: false,
            ways: Vec::new(),
            places: 0,
            spots: Vec::new(),
            reads_between: false,
        };
        return Ok(if watch.stop() { Err(Gap::Stopped) } else { Ok(none) });
    };
    if explorer.leaves_out_inputs() {
        return Ok(Err(Gap::Inputs));
    }
    let (graph, controls) = match explorer.explore(limits) {
        Ok(all) => all,
        Err(gap) => return Ok(Err(gap)),
    };
    if controls.truncated {
        return Ok(Err(Gap::Inputs));
    }
    let fates = fates(&graph.first, &graph.next, &graph.is_goal, &graph.is_gone);
    let (ways, places) = ways_in(problem, (&graph, &controls), &fates, ways);
    Ok(Ok(ExactAnswer {
        counts: counts(&graph, &fates),
        starts_well: fates.first() == Some(&Fate::Arrives),
        ways,
        places,
        spots: spots(problem, &graph, &fates),
        reads_between: reads_between(problem),
    }))
}

fn counts(graph: &StateGraph, fates: &[Fate]) -> StateCounts {
    let mut counts = StateCounts { all: graph.len() as u64, ..StateCounts::default() };
    for (state, fate) in (0u32..).zip(fates) {
        counts.goals += u64::from(graph.is_goal[state as usize]);
        match fate {
            Fate::Arrives => counts.arriving += 1,
            Fate::Doomed => counts.doomed += 1,
            Fate::Stuck => {
                counts.stuck += 1;
                let is_dead_end = graph.successors(state) == [state] && !graph.can_end[state as usize];
                counts.dead_ends += u64::from(is_dead_end);
            }
        }
    }
    counts
}

/// Where the first player is stuck whatever else is the case, and where it gets stuck on the ways in: most places of a
/// puzzle are also part of its solution.
fn spots(problem: &Problem<'_>, graph: &StateGraph, fates: &[Fate]) -> Vec<Spot> {
    let Some(&player) = problem.players().first() else { return Vec::new() };
    let places = Places::new(problem);
    // For each tile, where the first stuck state has the player, and whether the tile is shaded.
    let mut tiles: BTreeMap<(SpaceId, (i64, i64)), (Spot, bool)> = BTreeMap::new();
    let mut buffer = Vec::new();
    let mut place_of = |state: u32| {
        let bytes = graph.tree.state(NodeId(state), &mut buffer);
        let (x, y) = problem.sim.position(bytes, player);
        let space = problem.sim.space(bytes, player);
        ((space, places.tile(bytes, player)), (space, [x as f32, y as f32]))
    };
    for (state, _) in (0u32..).zip(fates).filter(|(_, fate)| **fate == Fate::Stuck) {
        let (tile, spot) = place_of(state);
        tiles.entry(tile).or_insert((spot, true));
    }
    let arriving = || (0u32..).zip(fates).filter(|(_, fate)| **fate == Fate::Arrives).map(|(state, _)| state);
    for state in arriving() {
        if let Some((_, is_shaded)) = tiles.get_mut(&place_of(state).0) {
            *is_shaded = false;
        }
    }
    for next in arriving().flat_map(|state| graph.successors(state)) {
        if fates[*next as usize] == Fate::Stuck
            && let Some((_, is_shaded)) = tiles.get_mut(&place_of(*next).0)
        {
            *is_shaded = true;
        }
    }
    tiles.into_values().filter(|(_, is_shaded)| *is_shaded).map(|(spot, _)| spot).collect()
}

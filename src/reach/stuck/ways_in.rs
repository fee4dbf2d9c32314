//! The points of no return of a complete graph: where a state that can still arrive leads to one that is stuck.

use std::collections::BTreeMap;

use crate::ordered::Ordered;
use crate::sim::{Input, Script};

use super::super::controls::ControlSets;
use super::super::problem::Problem;
use super::super::tree::NodeId;
use super::fates::Fate;
use super::graph::{StateGraph, input_of, script_to};
use super::place::{Places, PlayerPlace};

/// Maximum number of steps for which nothing is pressed until the consequences of an input show.
const SETTLING: u64 = 60;

/// A way to a place from which the goal cannot be reached, while it can from the state before the last step.
#[derive(Debug, Clone, PartialEq)]
pub struct WayIn {
    /// Where the players are after it, in words.
    pub place: String,
    /// The inputs from the initial state.
    pub script: Script,
    /// The input of its last step.
    pub last: Input,
    /// What differs soon after from what would be without the last input, in words, of all but the players.
    pub changes: Vec<String>,
    /// The number of stuck states that can be reached by it: by all ways into the same place.
    pub behind: u64,
    /// Whether most of these are behind no other place with a shorter way.
    pub is_apart: bool,
}

/// All ways into one place.
struct Group {
    /// The last state that arrives and the first that is stuck, of the shortest way.
    shortest: (u32, u32),
    steps: u32,
    /// The stuck states that they lead to.
    entered: Vec<u32>,
}

/// A place with all ways into it.
struct Ranked {
    place: Vec<PlayerPlace>,
    group: Group,
    /// The number of stuck states behind it that are behind no place with a shorter way.
    new: u64,
    behind: u64,
}

impl Ranked {
    fn is_apart(&self) -> bool {
        2 * self.new > self.behind
    }
}

/// The shortest way into each place, at most `limit` of them, and the number of places: first those that lead elsewhere than
/// all shorter ones, then by length and by what is behind them.
pub(super) fn ways_in(
    problem: &Problem<'_>,
    (graph, controls): (&StateGraph, &ControlSets),
    fates: &[Fate],
    limit: usize,
) -> (Vec<WayIn>, usize) {
    let places = Places::new(problem);
    let groups = groups(graph, fates, &places);
    let all = groups.len();
    let mut ranked: Vec<Ranked> =
        groups.into_iter().map(|(place, group)| Ranked { place, group, new: 0, behind: 0 }).collect();
    ranked.order_by_key(|ranked| ranked.group.steps);
    let mut seen = vec![false; graph.len()];
    for ranked in &mut ranked {
        ranked.new = count_behind(graph, &ranked.group.entered, &mut seen);
    }
    // The shortest ways, of which those of the same length as the last one compete by size, and those behind which most is
    // new: to count what is behind all of them would take too long.
    let last = ranked.get(limit.saturating_sub(1)).map_or(u32::MAX, |ranked| ranked.group.steps);
    let mut news: Vec<u64> = ranked.iter().map(|ranked| ranked.new).filter(|new| *new > 0).collect();
    news.sort_unstable_by_key(|new| u64::MAX - new);
    let least = news.get(limit.saturating_sub(1)).copied().unwrap_or(1);
    let (mut short, mut large) = (0, 0);
    ranked.retain(|ranked| {
        let is_short = ranked.group.steps <= last && short < 2 * limit;
        let is_large = ranked.new >= least && large < limit;
        (short, large) = (short + usize::from(is_short), large + usize::from(is_large));
        is_short || is_large
    });
    for ranked in &mut ranked {
        ranked.behind = count_behind(graph, &ranked.group.entered, &mut vec![false; graph.len()]);
    }
    ranked.order_by_key(|ranked| (!ranked.is_apart(), ranked.group.steps, u64::MAX - ranked.behind));
    ranked.truncate(limit);
    let ways = ranked.iter().filter_map(|ranked| {
        let way = way_in(problem, (graph, controls), ranked.group.shortest, &places)?;
        Some(WayIn { place: places.words(&ranked.place), behind: ranked.behind, is_apart: ranked.is_apart(), ..way })
    });
    (ways.collect(), all)
}

/// The steps from states that arrive to states that are stuck, by the place that they lead to.
fn groups(graph: &StateGraph, fates: &[Fate], places: &Places<'_>) -> BTreeMap<Vec<PlayerPlace>, Group> {
    let mut groups: BTreeMap<Vec<PlayerPlace>, Group> = BTreeMap::new();
    let mut buffer = Vec::new();
    let arriving = (0u32..).zip(fates).filter(|(_, fate)| **fate == Fate::Arrives);
    for (from, _) in arriving {
        let steps = graph.tree.depth(NodeId(from)) + 1;
        for &to in graph.successors(from) {
            if fates[to as usize] != Fate::Stuck {
                continue;
            }
            let key = places.players(graph.tree.state(NodeId(to), &mut buffer));
            let group = groups.entry(key).or_insert_with(|| Group { shortest: (from, to), steps, entered: Vec::new() });
            if steps < group.steps {
                (group.shortest, group.steps) = ((from, to), steps);
            }
            group.entered.push(to);
        }
    }
    groups
}

/// The number of states that can be reached from some stuck ones, these included, and were not seen before: all are stuck
/// or doomed.
fn count_behind(graph: &StateGraph, entered: &[u32], seen: &mut [bool]) -> u64 {
    let mut open: Vec<u32> = Vec::new();
    let mut count = 0;
    let mut visit = |state: u32, open: &mut Vec<u32>| {
        if !std::mem::replace(&mut seen[state as usize], true) {
            count += 1;
            open.push(state);
        }
    };
    entered.iter().for_each(|state| visit(*state, &mut open));
    while let Some(state) = open.pop() {
        graph.successors(state).iter().for_each(|next| visit(*next, &mut open));
    }
    count
}

/// A way in, replayed from the initial state; `None` if the replay does not confirm it.
fn way_in(
    problem: &Problem<'_>,
    (graph, controls): (&StateGraph, &ControlSets),
    (from, to): (u32, u32),
    places: &Places<'_>,
) -> Option<WayIn> {
    let sim = problem.sim;
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).ok()?;
    for input in script_to(graph, controls, from, None).inputs() {
        sim.step(&mut state, input, &mut scratch).ok()?;
    }
    let mut buffer = Vec::new();
    let target = graph.tree.state(NodeId(to), &mut buffer);
    let set = graph.tree.set(NodeId(from));
    let leads_there = |index: &usize| {
        let mut next = state.clone();
        sim.step(&mut next, &input_of(controls, set, *index), &mut scratch).is_ok() && *next == *target
    };
    let index = (0..controls.count(set)).find(leads_there);
    debug_assert!(index.is_some(), "a way in must replay");
    let index = index?;
    let last = input_of(controls, set, index);
    let script = script_to(graph, controls, from, Some(index));
    let changes = changes(problem, &state, &last, places);
    Some(WayIn { place: String::new(), changes, script, last, behind: 0, is_apart: false })
}

/// What an input changes: the differences to what would be without it, once nothing moves any more. What moves anyway does
/// not count.
fn changes(problem: &Problem<'_>, from: &[u8], input: &Input, places: &Places<'_>) -> Vec<String> {
    let sim = problem.sim;
    let mut scratch = sim.scratch();
    let nothing = Input::nothing(sim.world().players.len());
    let (mut with, mut without) = (from.to_vec(), from.to_vec());
    for step in 0..SETTLING {
        let first = if step == 0 { input } else { &nothing };
        let before = (with.clone(), without.clone());
        let mut go = |state: &mut Vec<u8>, input: &Input| {
            // A run that is over goes no further.
            let is_over = !problem.judge(state).is_ok_and(|status| !status.is_over(problem.target));
            let input = sim.draw(0, step, input);
            is_over || sim.step(state, &input, &mut scratch).is_ok()
        };
        if !go(&mut with, first) || !go(&mut without, &nothing) {
            return Vec::new();
        }
        if step > 0 && before == (with.clone(), without.clone()) {
            break;
        }
    }
    places.differences(&without, &with, &places.others())
}

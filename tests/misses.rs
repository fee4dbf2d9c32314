//! Nearest misses are true: in worlds whose answers are known by construction, the nearest state is as near as the line
//! about the goal says, and a brute force over all states, written from the simulator alone, agrees with that line.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::questions::inputs;
use crate::support::{Disk, files, program, script_of, sized};
use hypedc::compile::{Asked, Changes, Compilation, ExtraQuestion, compile, compile_changed};
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::query::{Answer, Query, Session};
use hypedc::reach::why_not::{PartState, Point, WhyNot};
use hypedc::reach::{Limits, Settings, Target};
use hypedc::sim::{Simulator, State};
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;

/// Nodes of each search.
const NODES: u64 = 10_000;
/// How far a distance may be from the truth: a pixel, a step, a unit.
const PRECISION: f64 = 1.0;

/// What a goal misses by. The line about an unreachable goal in `tests/verdicts` and `tests/misses` ends with the parts that
/// are missing in the nearest state, and perhaps where and when that is: `[hero.x > 190: 28 px; door in open: is in locked;
/// at x: 68; at step: 64]`.
struct Miss {
    /// The text of the part.
    part: String,
    /// The distance with its unit, or what is said instead.
    by: Result<(f64, String), String>,
}

/// A goal with what is known of it.
struct Case {
    path: PathBuf,
    goal: String,
    /// The parts that are missing.
    misses: Vec<Miss>,
    /// What else is known of the nearest state.
    places: Vec<Miss>,
    program: Arc<Program>,
    sources: SourceMap,
    world: WorldId,
    id: GoalId,
}

impl Case {
    fn name(&self) -> String {
        format!("{} {}", self.path.display(), self.goal)
    }
}

fn miss(text: &str) -> Miss {
    let (part, by) = text.trim().split_once(": ").unwrap_or_else(|| panic!("no distance in `{text}`"));
    let (number, unit) = by.split_once(' ').unwrap_or((by, ""));
    let by = number.parse().map(|number| (number, unit.to_string())).map_err(|_| by.to_string());
    Miss { part: part.to_string(), by }
}

/// The goals of the worlds of a folder that say what they miss by.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for folder in ["tests/verdicts", "tests/misses"] {
        for path in files(folder, "hyped").into_iter().filter(|path| path.parent() == Some(Path::new(folder))) {
            let text = std::fs::read_to_string(&path).unwrap();
            for line in text.lines().map_while(|line| line.strip_prefix("// ")) {
                let Some((head, misses)) = line.strip_suffix(']').and_then(|line| line.rsplit_once(" [")) else {
                    continue;
                };
                let goal = head.split_once(": ").unwrap().0.strip_prefix("unreachable ").unwrap();
                let compiled = compile(&path, &Disk);
                let sources = compiled.sources.clone();
                let program = program(compiled);
                let find = |(world, id): (WorldId, _)| {
                    let table: &hypedc::ir::World = &program.worlds[world];
                    (table.goals[id].name == goal).then_some((world, id))
                };
                let all = program.worlds.pairs().flat_map(|(world, w)| w.goals.ids().map(move |id| (world, id)));
                let (world, id) = { all }.find_map(find).unwrap_or_else(|| panic!("{}: {goal}", path.display()));
                let (places, misses) = misses.split(';').map(miss).partition(|miss| miss.part.starts_with("at "));
                cases.push(Case { path: path.clone(), goal: goal.into(), misses, places, program, sources, world, id });
            }
        }
    }
    cases
}

/// The answer to a goal.
fn answer(case: &Case) -> Answer {
    let target = Target::Goal(case.id);
    let mut query = Query::new(vec![target]);
    query.settings = Settings { explains: true, ..Settings::default() };
    query.limits = Limits { nodes: NODES, ..Limits::default() };
    let session = Session::new(&case.program, case.world, query, &Unwatched);
    let mut found = session.find(target, &Unwatched).unwrap();
    session.answer(&mut found, &case.sources)
}

#[test]
fn the_nearest_state_is_as_near_as_it_is_known_to_be() {
    let cases = cases();
    let worlds: BTreeSet<_> = cases.iter().map(|case| (&case.path, case.world)).collect();
    let mut wrong = String::new();
    for case in &cases {
        let answer = answer(case);
        let why: &WhyNot = answer.why_not.as_ref().unwrap_or_else(|| panic!("{}: {answer:?}", case.name()));
        let nearest = why.nearest.as_ref().unwrap_or_else(|| panic!("{}: no state", case.name()));
        let found: Vec<&PartState> = nearest.parts.iter().filter(|part| !part.holds).collect();
        let agrees = |(part, miss): (&&PartState, &Miss)| match &miss.by {
            Ok((distance, unit)) => {
                part.text == miss.part
                    && part.unit == *unit
                    && part.distance.is_some_and(|d| (d - distance).abs() <= PRECISION)
            }
            // Of two doors that one key opens, either is the one that stays shut.
            Err(words) => part.words.replace('`', "") == *words,
        };
        let at = &nearest.at;
        let is_there = case.places.iter().all(|place| {
            let found = match &*place.part {
                "at x" => at.x,
                "at y" => at.y,
                "at step" => at.step as f64,
                other => panic!("{}: {other}", case.name()),
            };
            place.by.as_ref().is_ok_and(|(known, _)| (found - known).abs() <= PRECISION)
        });
        if found.len() != case.misses.len() || !found.iter().zip(&case.misses).all(agrees) || !is_there {
            let phrases: Vec<String> = nearest.parts.iter().map(PartState::phrase).collect();
            wrong += &format!(
                "{}: {:?}, step {} at x {}: {}\n",
                case.name(),
                answer.verdict,
                at.step,
                at.x,
                phrases.join("; ")
            );
        }
        replays(case, &nearest.at);
        why.parts.iter().filter_map(|part| part.at.as_ref()).for_each(|at| replays(case, at));
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(worlds.len() >= 40, "{} worlds", worlds.len());
}

/// The inputs lead to the place after the number of steps.
fn replays(case: &Case, at: &Point) {
    let sim = Simulator::new(&case.program, case.world);
    let script = script_of(&case.program, case.world, &at.inputs);
    assert_eq!(script.len(), at.step);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        assert!(!is_over(&sim, &state), "{}: {}", case.name(), at.inputs);
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    assert!(!is_over(&sim, &state), "{}: {}", case.name(), at.inputs);
    if let Some(player) = sim.world().players.iter().next() {
        assert_eq!(sim.position(&state, player.slot), (at.x, at.y), "{}: {}", case.name(), at.inputs);
    }
}

fn is_over(sim: &Simulator, state: &State) -> bool {
    sim.violated(state).unwrap().is_some() || sim.left_bounds(state).is_some()
}

/// All states of all runs that are not over; none if there are too many.
fn all_states(sim: &Simulator) -> Option<Vec<State>> {
    let inputs = inputs(sim.program(), sim.world_id());
    let mut scratch = sim.scratch();
    let first = sim.initial(&mut scratch).unwrap();
    let mut known = HashSet::from([first.clone()]);
    let mut states = vec![first];
    states.retain(|state| !is_over(sim, state));
    let mut at = 0;
    while at < states.len() {
        for input in &inputs {
            let mut state = states[at].clone();
            sim.step(&mut state, input, &mut scratch).unwrap();
            if !is_over(sim, &state) && known.insert(state.clone()) {
                states.push(state);
            }
        }
        at += 1;
        if states.len() > sized(40_000, 1_000_000) {
            return None;
        }
    }
    Some(states)
}

/// A part of a goal, weakened by a distance; none if it has none.
fn weakened(part: &str, by: f64) -> Option<String> {
    if part.starts_with("near(") && part.ends_with(')') {
        return Some(format!("{} + {by:.6})", part.strip_suffix(')')?));
    }
    if let Some((a, b)) = part.split_once(" == ") {
        return Some(format!("abs({a} - ({b})) <= {by:.6}"));
    }
    let op = [" >= ", " <= ", " > ", " < "].into_iter().find(|op| part.contains(op))?;
    let (a, b) = part.split_once(op)?;
    let sign = if op.contains('>') { "+" } else { "-" };
    (!part.contains(" or ") && b.find(['<', '>']).is_none()).then(|| format!("{a} {sign} {by:.6}{op}{b}"))
}

/// The parts that a goal joins with `and`, each comparison by itself.
fn conjuncts(text: &str) -> Vec<String> {
    let split = |part: &str| match part.split(" < ").collect::<Vec<_>>()[..] {
        [low, middle, high] => vec![format!("{low} < {middle}"), format!("{middle} < {high}")],
        _ => vec![part.to_string()],
    };
    text.split(" and ").flat_map(split).collect()
}

/// The goal with its missing parts weakened by their distances and a little more (true) or less. Parts without a distance
/// are left out: with them, the states can only be farther.
fn weakened_goal(case: &Case, more: f64) -> Option<String> {
    let span = case.program.spans.exprs[case.program.worlds[case.world].goals[case.id].holds];
    let mut parts = conjuncts(case.sources.slice(span));
    let mut has_distance = false;
    for miss in &case.misses {
        let Ok((distance, _)) = &miss.by else {
            parts.retain(|part| *part != miss.part);
            continue;
        };
        let part = parts.iter_mut().find(|part| **part == miss.part)?;
        // What need not be nearer at all need not be asked.
        *part = weakened(part, (distance + more).max(0.0))?;
        has_distance = true;
    }
    has_distance.then(|| parts.join(" and "))
}

/// In all states of finite worlds: some are as near as it is known, and none is nearer by more than a little.
#[test]
fn brute_force_finds_nothing_nearer() {
    let (mut checked, mut left) = (0, Vec::new());
    let mut states: (Option<(PathBuf, WorldId)>, Option<Vec<State>>) = (None, None);
    for case in &cases() {
        let (Some(near), Some(nearer)) = (weakened_goal(case, 0.01), weakened_goal(case, -PRECISION - 0.01)) else {
            left.push(format!("{} has no distance", case.name()));
            continue;
        };
        let of = (case.path.clone(), case.world);
        if states.0.as_ref() != Some(&of) {
            states = (Some(of), all_states(&Simulator::new(&case.program, case.world)));
        }
        let Some(states) = &states.1 else {
            left.push(format!("{} is large", case.name()));
            continue;
        };
        let world = &case.program.worlds[case.world].name;
        let question = |text| ExtraQuestion { asked: Asked::Goal, world: Some(world), text, origin: "known" };
        let questions = [question(&near), question(&nearer)];
        let changes = Changes { questions: &questions, ..Changes::default() };
        let compiled: Compilation = compile_changed(&case.path, Default::default(), &changes, &Disk);
        let program = program(compiled);
        let sim = Simulator::new(&program, case.world);
        let count = |goal: GoalId| states.iter().filter(|state| sim.goal(state, goal).unwrap()).count();
        let holds = |text: &str| count(sim.world().goal_named(text).unwrap_or_else(|| panic!("{}", case.name())));
        assert_eq!(count(case.id), 0, "{}", case.name());
        assert!(holds(&near) > 0, "{}: of {} states none is as near as that: {near}", case.name(), states.len());
        let is_far = case.misses.iter().any(|miss| miss.by.as_ref().is_ok_and(|(by, _)| *by > PRECISION));
        assert!(!is_far || holds(&nearer) == 0, "{}: some state is nearer: {nearer}", case.name());
        checked += 1;
    }
    assert!(checked >= 25, "{checked}: {left:#?}");
}

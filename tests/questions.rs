//! `reach` answers precisely the given query: the tried inputs, the shortest path, and the extent of a proof.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::{HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use std::time::Duration;

use crate::support::{Disk, files, program, script, sized};
use hypedc::analysis::configuration_space;
use hypedc::compile::compile;
use hypedc::ir::{Id, Program, SlotId, WorldId};
use hypedc::reach::{
    Argument, Limits, Outcome, Planner, Problem, Settings, StateStatus, Style, Target, Verdict, exhaust, reach,
    search as grow,
};
use hypedc::sim::{Input, PlayerInput, Script, Simulator, State};
use hypedc::watch::Unwatched;
use proptest::prelude::*;
use serde_json::Value;

const WORLD: WorldId = WorldId(0);

/// The folders of the worlds of these tests: some once had a false verdict.
const FOLDERS: [&str; 2] = ["tests/questions", "tests/analysis/found/small"];

fn world(name: &str) -> Arc<Program> {
    let paths = FOLDERS.map(|folder| Path::new(folder).join(name).with_extension("hyped"));
    program(compile(paths.iter().find(|path| path.exists()).unwrap(), &Disk))
}

fn target(program: &Program, name: &str) -> Target {
    let table = &program.worlds[WORLD];
    let goal = table.goals.pairs().find(|(_, g)| g.name == name).map(|(id, _)| Target::Goal(id));
    goal.or(table.nevers.pairs().find(|(_, n)| n.name == name).map(|(id, _)| Target::Never(id))).unwrap()
}

fn asked(problem: &Problem<'_>, planner: Planner, seed: u64, nodes: u64) -> Outcome {
    let space = configuration_space(problem.sim.program(), problem.sim.world_id());
    let settings = Settings { planner, seed, ..Settings::default() };
    grow(problem, &space, &settings, &Limits { nodes, ..Limits::default() }, &Unwatched).unwrap()
}

/// All combinations of buttons, and of axes at -1, 0 and 1.
pub fn inputs(program: &Program, world: WorldId) -> Vec<Input> {
    let world = &program.worlds[world];
    let mut all = vec![Input::nothing(world.players.len())];
    for (id, player) in world.players.pairs() {
        let entity = &program.entities[world.slots[player.slot].entity];
        let mut multiply = |variants: &[&dyn Fn(&mut PlayerInput)]| {
            let each = |input: &Input| -> Vec<Input> {
                let with = |variant: &&dyn Fn(&mut PlayerInput)| {
                    let mut input = input.clone();
                    variant(&mut input.0[id.index()]);
                    input
                };
                variants.iter().map(with).collect()
            };
            all = all.iter().flat_map(each).collect();
        };
        for button in 0..entity.buttons.len() {
            multiply(&[&|_| {}, &|p| p.buttons |= 1 << button]);
        }
        for axis in 0..entity.axes.len() {
            multiply(&[&|p| p.axes[axis] = -1.0, &|_| {}, &|p| p.axes[axis] = 1.0]);
        }
    }
    all
}

/// The result of a breadth-first search: the minimum number of steps to the target by inputs that are held for a
/// minimum number of steps; none if there is no path; no result if that takes too many nodes.
fn by_steps(problem: &Problem<'_>, least: usize, most: usize) -> Option<Option<u64>> {
    let inputs = inputs(problem.sim.program(), WORLD);
    let mut scratch = problem.sim.scratch();
    let initial = problem.sim.initial(&mut scratch).unwrap();
    let mut known: HashSet<(State, usize, usize)> = HashSet::new();
    let mut open = VecDeque::from([(initial, usize::MAX, least, 0)]);
    while let Some((state, held, count, depth)) = open.pop_front() {
        match problem.judge(&state).unwrap() {
            StateStatus::Goal => return Some(Some(depth)),
            StateStatus::Dead(_) => continue,
            StateStatus::Open => {}
        }
        if known.len() > most {
            return None;
        }
        for (number, input) in inputs.iter().enumerate().filter(|(n, _)| *n == held || count >= least) {
            let mut next = state.clone();
            problem.sim.step(&mut next, input, &mut scratch).unwrap();
            let count = if number == held { (count + 1).min(least) } else { 1 };
            if known.insert((next.clone(), number, count)) {
                open.push_back((next, number, count, depth + 1));
            }
        }
    }
    Some(None)
}

/// Each goal and each `never` of the small worlds.
fn small_questions() -> Vec<(String, Arc<Program>, Target)> {
    let here = FOLDERS.into_iter().flat_map(|folder| files(folder, "hyped"));
    let is_world = |path: &PathBuf| path.parent() == Some(Path::new("tests/verdicts"));
    let verdicts = files("tests/verdicts", "hyped").into_iter().filter(is_world);
    let mut all = Vec::new();
    for path in here.chain(verdicts) {
        let program = program(compile(&path, &Disk));
        let Some(table) = program.worlds.iter().next() else { continue };
        let goals = table.goals.ids().map(Target::Goal).chain(table.nevers.ids().map(Target::Never));
        all.extend(goals.map(|target| (path.display().to_string(), program.clone(), target)));
    }
    all
}

#[test]
fn exhaustion_agrees_with_a_search_step_by_step() {
    let (mut found, mut proven, mut visits) = (0, 0, [0; 2]);
    for (name, program, target) in small_questions() {
        let sim = Simulator::new(&program, WORLD);
        for least in [1_u16, 2, 3, 7, 12] {
            let problem = Problem::asking(&sim, target).holding(least);
            let Some(expected) = by_steps(&problem, usize::from(least), 3_000) else { continue };
            let what = format!("{name} {target:?}, held for {least}");
            let limits = Limits { nodes: 100_000, ..Limits::default() };
            let visited = exhaust(&problem, &limits, 2, &Unwatched).unwrap();
            match (visited.as_ref().map(|outcome| &outcome.verdict), expected) {
                (Some(Verdict::Reached(plan)), Some(steps)) => {
                    assert!(holds(&plan.script, 0, least), "{what}: {:?}", plan.script);
                    assert_eq!((plan.steps, plan.is_shortest), (steps, true), "{what}");
                    visits[0] += 1;
                }
                (Some(Verdict::Exhausted(all) | Verdict::Unreachable(Argument::Exhaustion(all))), None) => {
                    assert_eq!(all.min_hold, least, "{what}");
                    visits[1] += 1;
                }
                (None | Some(Verdict::NotFound), _) => {}
                other => panic!("{what}, all states: {other:?}"),
            }
            for planner in [Planner::Exhaustive, Planner::BestFirst] {
                let outcome = asked(&problem, planner, 1, 100_000);
                match (&outcome.verdict, expected) {
                    (Verdict::Reached(plan), Some(steps)) => {
                        found += 1;
                        assert!(holds(&plan.script, 0, least), "{what}: {:?}", plan.script);
                        if planner == Planner::Exhaustive {
                            let is_known = outcome.cuts.iter().all(|cut| u64::from(cut.soonest) + 1 >= steps);
                            assert_eq!((plan.steps, plan.is_shortest), (steps, is_known), "{what}");
                        }
                        assert!(!plan.is_shortest || plan.steps == steps, "{what}");
                    }
                    (Verdict::Exhausted(all) | Verdict::Unreachable(Argument::Exhaustion(all)), None) => {
                        assert_eq!(all.min_hold, least, "{what}");
                        proven += 1;
                    }
                    (Verdict::Unreachable(Argument::Over), None) => {}
                    (Verdict::NotFound, None) if !outcome.cuts.is_empty() => {}
                    // A button or an axis that nothing reads makes no difference here, and a run-time error proves nothing.
                    other => panic!("{what}, {planner:?}: {other:?}"),
                }
            }
        }
    }
    assert!(found > 100 && proven > 60, "{found} {proven}");
    assert!(visits[0] > 50 && visits[1] > 30, "{visits:?}");
}

/// Whether each input except the last is held for a number of steps.
fn holds(script: &Script, after: u64, least: u16) -> bool {
    let mut end = 0;
    let ends: Vec<u64> = script
        .steps
        .iter()
        .map(|s| {
            end += u64::from(s.count);
            end
        })
        .collect();
    let all = script.steps.iter().zip(ends).rev().skip(1);
    all.into_iter().all(|(s, end)| end < after || s.count >= u32::from(least))
}

#[test]
fn all_planners_hold_inputs_from_the_seam_on() {
    let mut found = 0;
    for (name, goal) in [("minhold", "spot"), ("hold", "stop"), ("passing", "far"), ("pit", "flag")] {
        let program = world(name);
        let sim = Simulator::new(&program, WORLD);
        for begin in ["", "right*3", "-*20 right*3", "right*30 left*29 -*1"] {
            let begin = script(&program, begin);
            let mut problem = Problem::asking(&sim, target(&program, goal)).holding(14);
            if !begin.is_empty() {
                let Ok(begun) = problem.after(begin.clone()) else { continue };
                problem = begun;
            }
            for (planner, seed) in Planner::ALL.into_iter().zip(1..) {
                if let Verdict::Reached(plan) = asked(&problem, planner, seed, 600).verdict {
                    assert!(holds(&plan.script, plan.after, 14), "{name} {planner:?}: {:?}", plan.script);
                    assert_eq!((plan.after, &plan.script.first(begin.len())), (begin.len(), &begin));
                    let space = configuration_space(&program, WORLD);
                    let short = hypedc::reach::shorten(&problem, &space, &plan, Style::Fast, &Unwatched);
                    assert!(holds(&short.script, short.after, 14), "{name} {planner:?}: {:?}", short.script);
                    found += 1;
                }
            }
        }
    }
    assert!(found > 40, "{found}");
}

#[test]
fn what_is_steered_between_the_ends_is_not_exhausted() {
    // In 35 steps of full speed one is too far or not there; by half of it one is where one wants to be.
    let program = world("hold");
    let sim = Simulator::new(&program, WORLD);
    let outcome = asked(&Problem::asking(&sim, target(&program, "stop")).within(35), Planner::Exhaustive, 1, 10_000);
    assert!(matches!(outcome.verdict, Verdict::Exhausted(_)) && outcome.reads_between, "{:?}", outcome.verdict);
    // Of signs, their ends are all there is.
    let program = world("steps");
    let sim = Simulator::new(&program, WORLD);
    let outcome = asked(&Problem::asking(&sim, target(&program, "away")), Planner::Exhaustive, 1, 10_000);
    assert!(matches!(outcome.verdict, Verdict::Unreachable(Argument::Exhaustion(_))), "{:?}", outcome.verdict);
    assert!(!outcome.reads_between);
}

#[test]
fn no_tree_is_begun_again_and_again_without_hope() {
    let program = world("pit");
    let sim = Simulator::new(&program, WORLD);
    for planner in Planner::ALL {
        let problem = Problem::asking(&sim, target(&program, "flag")).within(20);
        let outcome = asked(&problem, planner, 1, 200_000);
        assert!(!matches!(outcome.verdict, Verdict::Reached(_)), "{planner:?}");
        assert!(outcome.statistics.trees < 5_000, "{planner:?}: {} trees", outcome.statistics.trees);
    }
}

#[test]
fn too_little_time_is_proven_at_once() {
    for (name, goal, never, perhaps) in
        [("hold", "stop", 30, 36), ("minhold", "spot", 60, 90), ("pit", "flag", 80, 136)]
    {
        let program = world(name);
        let sim = Simulator::new(&program, WORLD);
        let space = configuration_space(&program, WORLD);
        let ask = |steps| {
            let problem = Problem::asking(&sim, target(&program, goal)).within(steps);
            reach(&problem, &space, &Settings::default(), &Limits { nodes: 1, ..Limits::default() }, &Unwatched)
                .unwrap()
        };
        let Verdict::Unreachable(Argument::Distance(far)) = ask(never).verdict else { panic!("{name}: no proof") };
        assert!(far.least > u64::from(never) && far.least <= u64::from(perhaps), "{name}: {far:?}");
        assert!(!matches!(ask(perhaps).verdict, Verdict::Unreachable(_)), "{name}");
    }
    // Whatever puts the player elsewhere may bring it anywhere.
    for (name, goal) in [("tunnel", "eat"), ("linkout", "out")] {
        let program = world(name);
        let sim = Simulator::new(&program, WORLD);
        let space = configuration_space(&program, WORLD);
        assert!(
            space
                .within_steps(&program, WORLD, SlotId(0), [16.0, 16.0], 1)
                .is_none_or(|[x, _]| x.high == f64::INFINITY),
            "{name}"
        );
        let problem = Problem::asking(&sim, target(&program, goal)).within(10);
        let outcome = asked(&problem, Planner::DistanceGuided, 1, 100);
        assert!(!matches!(outcome.verdict, Verdict::Unreachable(_)), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: sized(80, 2_000), ..ProptestConfig::default() })]

    /// Whatever a player does, it gets no farther than the bound.
    #[test]
    fn no_player_gets_farther_than_it_can(
        which in any::<prop::sample::Index>(),
        choices in prop::collection::vec((any::<prop::sample::Index>(), 1usize..30), 1..12),
    ) {
        let examples = ["examples"].into_iter().chain(FOLDERS).flat_map(|folder| files(folder, "hyped"));
        let all: Vec<PathBuf> = examples.chain(files("tests/verdicts", "hyped")).collect();
        let path: &PathBuf = which.get(&all);
        let program = program(compile(path, &Disk));
        prop_assume!(!program.worlds.is_empty() && program.worlds[WORLD].open.is_none());
        let sim = Simulator::new(&program, WORLD);
        let nevers: Vec<_> = sim.world().nevers.iter().map(|n| n.holds).collect();
        let space = hypedc::analysis::configuration_space_without(&program, WORLD, &nevers);
        let inputs = inputs(&program, WORLD);
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let players: Vec<SlotId> = sim.world().players.iter().map(|p| p.slot).collect();
        let first: Vec<(f64, f64)> = players.iter().map(|slot| sim.position(&state, *slot)).collect();
        let mut steps = 0;
        'run: for (index, count) in choices {
            for _ in 0..count {
                let is_over = sim.step(&mut state, index.get(&inputs), &mut scratch).is_err();
                if is_over || sim.violated(&state).unwrap().is_some() {
                    break 'run;
                }
                steps += 1;
                let is_out = players.iter().any(|&slot| {
                    let (x, y) = sim.position(&state, slot);
                    let bounds = sim.world().spaces[sim.space(&state, slot)].bounds;
                    bounds.is_some_and(|b| x < b.left || b.right < x || y < b.bottom)
                });
                if is_out {
                    break 'run;
                }
                for (&slot, first) in players.iter().zip(&first) {
                    if !sim.world().layout.slots[slot].alive(&state) {
                        continue;
                    }
                    let Some([x, y]) = space.within_steps(&program, WORLD, slot, [first.0, first.1], steps) else { continue };
                    let at = sim.position(&state, slot);
                    prop_assert!(x.contains(at.0) && y.contains(at.1), "{:?}: {:?} after {steps}, not in {x:?} {y:?}", path, at);
                }
            }
        }
    }
}

fn hypedc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap()
}

/// The exit code, and the output on both streams.
fn told(arguments: &[&str]) -> (i32, String) {
    let output = hypedc(arguments);
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    (output.status.code().unwrap(), text)
}

fn has(arguments: &[&str], code: i32, parts: &[&str]) {
    let (found, text) = told(arguments);
    assert_eq!(found, code, "{arguments:?}: {text}");
    for part in parts {
        assert!(text.contains(part), "{arguments:?}: no `{part}` in {text}");
    }
}

const HOLD: &str = "tests/analysis/found/small/hold.hyped";
const MINHOLD: &str = "tests/analysis/found/small/minhold.hyped";
const STEPS: &str = "tests/questions/steps.hyped";
const PASSING: &str = "tests/questions/passing.hyped";
const PIT_PROOF: &str = "tests/analysis/found/small/pit_proof.hyped";

#[test]
fn inputs_change_at_any_step_once_they_were_held() {
    let shortest =
        ["36 steps", "shortest with axes at -1, 0 and 1 by inputs that are held for at least 10 steps", "right*35 -"];
    has(&["reach", HOLD, "--min-hold", "10frames", "--planner", "exhaustive"], 0, &shortest);
    let (code, text) = told(&["reach", HOLD, "--hold", "10frames", "--planner", "exhaustive"]);
    assert!(code == 1 && text.contains("goal stop: not found") && !text.contains("proven"), "{text}");
    has(&["reach", MINHOLD, "--min-hold", "12frames"], 0, &["goal spot: reached"]);
    has(&["reach", STEPS, "--goal", "spot", "--planner", "exhaustive"], 0, &["14 steps", "shortest\n", "right*13 -"]);
}

/// What was tried by coarse inputs is information: its line says nothing of a proof.
#[test]
fn coarse_inputs_prove_nothing() {
    let text = "entity A { param speed = 60\n axis horizontal\n collider body: rect(0, 0, 8, 8)\n x' = speed * sign(horizontal)\n mode m { } }\n\
        world W { step 1/60\n space s { bounds rect(0, 0, 700, 40); place a: A at (350, 8) }\n player 1: a\n\
        never odd: a.x == 351 and a.x' == 60 }\n";
    let path = written("coarse.hyped", text);
    let (code, text) = told(&["reach", &path, "--never", "odd", "--planner", "exhaustive", "--hold", "10frames"]);
    assert_eq!(code, 1, "{text}");
}

/// A `never` counts in the state in which bounds or another one end a run, too: the analysis must not leave that out.
#[test]
fn a_never_is_proven_by_what_the_world_can_be() {
    let text = "entity A { param speed = 60\n axis horizontal\n collider body: rect(0, 0, 8, 8)\n x' = speed * horizontal\n mode m { } }\n\
        world W { step 1/60\n collide body with wall: block\n space s { bounds rect(0, 0, 100, 40); place a: A at (8, 8)\n\
        rect wall (60, 0, 16, 40) }\n player 1: a\n\
        never risen: a.y > 8\n never through: a.x > 61\n never outside: a.x < 0\n never twice: a.x < 2 and a.x > -1 }\n";
    let path = written("nevers.hyped", text);
    for never in ["risen", "through"] {
        let proven = format!("never {never}: proven, it holds in no reachable state");
        has(&["reach", &path, "--never", never], 0, &[&proven, "never holds"]);
    }
    // One is broken out of bounds, the other where the first of both is not yet.
    has(&["reach", &path, "--never", "outside"], 1, &["never outside: "]);
    let (_, text) = told(&["reach", &path, "--never", "outside"]);
    assert!(!text.contains("proven"), "{text}");
    has(&["reach", &path, "--never", "twice"], 1, &["never twice: violated"]);
    let text = std::fs::read_to_string(&path).unwrap().replace("never twice: a.x < 2 and a.x > -1 ", "");
    let path = written("nevers_2.hyped", &text);
    has(&["reach", &path, "--never", "outside"], 1, &["never outside: violated"]);
}

#[test]
fn a_never_is_proven_or_not_answered() {
    has(
        &["reach", STEPS, "--never", "away", "--planner", "exhaustive"],
        0,
        &["never away: proven, it cannot be violated\n", "all buttons, axes at -1, 0 and 1"],
    );
    has(
        &["reach", STEPS, "--never", "away", "--planner", "exhaustive", "--min-hold", "5frames"],
        0,
        &["proven, it cannot be violated by inputs that are held for at least 5 steps\n"],
    );
    has(
        &["reach", STEPS, "--never", "away", "--planner", "rrt", "--nodes", "50"],
        1,
        &["never away: not answered, no way to break it was found\n", "this proves nothing"],
    );
    has(&["reach", STEPS, "--never", "left"], 1, &["never left: violated"]);
    has(&["reach", PIT_PROOF, "--never", "hurt", "--planner", "exhaustive"], 1, &["never hurt: violated"]);
    let (_, text) = told(&["reach", STEPS, "--never", "away", "--planner", "exhaustive", "--format", "json"]);
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&json["version"], &json["goals"][0]["verdict"]), (&6.into(), &"proven-unreachable".into()));
    let (_, text) = told(&["reach", STEPS, "--never", "away", "--planner", "rrt", "--nodes", "50", "--format", "json"]);
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["goals"][0]["verdict"], "not-answered");
    let still = written(
        "still_never.hyped",
        "entity Rock { }\nworld W {\n    space main { place rock: Rock at (3, 4) }\n    never gone: not near(rock, (3, 4), 0)\n}\n",
    );
    has(&["reach", &still, "--never", "gone"], 0, &["the only state was visited"]);
    has(&["reach", "--help"], 0, &["Exit codes: 0 if every question is answered as expected"]);
}

#[test]
fn rows_tell_the_same() {
    let csv = temporary("questions.csv");
    let junit = temporary("questions.xml");
    let of = |planner: &str| {
        let files = ["--csv", csv.to_str().unwrap(), "--junit", junit.to_str().unwrap()];
        let question = ["reach", STEPS, "--never", "away", "--planner", planner, "--nodes", "3000"];
        let (code, text) = told(&[&question[..], &files[..]].concat());
        (code, text, std::fs::read_to_string(&csv).unwrap(), std::fs::read_to_string(&junit).unwrap())
    };
    let (code, text, csv, junit) = of("exhaustive");
    assert!(code == 0 && text.contains("proven unreachable") && csv.contains("proven-unreachable"), "{text}{csv}");
    assert!(junit.contains("failures=\"0\""), "{junit}");
    let (code, text, csv, junit) = of("rrt");
    assert!(code == 1 && text.contains("not answered") && csv.contains("not-answered"), "{text}{csv}");
    assert!(junit.contains("failures=\"1\"") && junit.contains("type=\"not-answered\""), "{junit}");
}

#[test]
fn a_goal_on_the_way_is_no_farther_than_there() {
    let goals = |more: &[&str]| -> Vec<(u64, Option<bool>)> {
        let (_, text) = told(&[&["reach", PASSING, "--format", "json"], more].concat());
        let json: Value = serde_json::from_str(&text).unwrap();
        let goals = json["goals"].as_array().unwrap().iter();
        goals.map(|g| (g["steps"].as_u64().unwrap(), g["is_shortest"].as_bool())).collect()
    };
    for seed in sized(&["1"][..], &["1", "2", "3"]) {
        for more in [&["--seed", seed][..], &["--seed", seed, "--minimize"]] {
            let found = goals(&[&["--planner", "rrt"], more].concat());
            assert!(found[0].0 < found[1].0, "{found:?}");
        }
        // Each path alone can be longer than the other one's passage; a goal that is not found is found by the other.
        let found = goals(&["--seed", seed, "--never", "far_right", "--goal", "near_by", "--goal", "far"]);
        assert!(found.iter().all(|(_, shortest)| *shortest == Some(false)), "{found:?}");
        assert!(found[0].0 < found[1].0 && found[1].0 < found[2].0, "{found:?}");
    }
    let (_, text) = told(&["reach", PASSING, "--goal", "near_by", "--planner", "rrt"]);
    assert!(text.contains(" steps, not proven shortest\n"), "{text}");
}

#[test]
fn times_have_units() {
    has(&["reach", HOLD, "--within", "30"], 2, &["--within", "write `30s` or `30frames`"]);
    has(&["reach", HOLD, "--min-hold", "12"], 2, &["--min-hold", "write `12s` or `12frames`"]);
    has(&["reach", HOLD, "--hold", "12"], 2, &["--hold", "write `12s` or `12frames`"]);
    has(&["reach", HOLD, "--within", "soon"], 2, &["a time such as"]);
    has(&["reach", HOLD, "--planner", "rrt", "--exhaust"], 2, &["`--exhaust` goes on from `auto`"]);
    has(&["reach", HOLD, "--min-hold", "99999999frames"], 2, &["`--min-hold` is at most 65535 steps"]);
    has(&["reach", HOLD, "--within", "500ms"], 1, &["proven unreachable within 30 steps", "it takes at least"]);
    has(&["reach", HOLD, "--within", "100000frames", "--hold", "10..20frames", "--seconds", "5"], 0, &["reached"]);
    has(&["reach", HOLD, "--min-hold", "0.2s", "--planner", "exhaustive"], 0, &["at least 12 steps"]);
    has(&["experiment", HOLD, "--hold", "10"], 2, &["write `10s` or `10frames`"]);
}

/// A place for files of this test run.
fn temporary(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn written(name: &str, text: &str) -> String {
    let path = temporary(name);
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn any_number_of_threads_will_do() {
    let result = |threads: &str| {
        let (code, text) = told(&["reach", MINHOLD, "--trees", "6", "--threads", threads, "--planner", "rrt"]);
        let path = text.lines().find(|line| line.contains("inputs")).unwrap().to_string();
        (code, path)
    };
    assert_eq!(result("65535"), result("1"));
    has(&["reach", MINHOLD, "--trees", "65535", "--threads", "65535", "--nodes", "3000"], 1, &["not found"]);
}

#[test]
#[cfg(unix)]
fn only_regular_files_are_read() {
    let pipe = temporary("pipe.hyped");
    let _ = std::fs::remove_file(&pipe);
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let pipe = pipe.to_str().unwrap();
    let folder = env!("CARGO_TARGET_TMPDIR");
    for (path, what) in [(pipe, "a named pipe"), ("/dev/zero", "a device"), (folder, "a folder")] {
        let why = format!("error[E0001]: cannot read `{path}`: it is {what}, not a regular file");
        let commands: [&[&str]; 8] = [
            &["check", path],
            &["fmt", path],
            &["sim", path, "--frames", "3"],
            &["sim", HOLD, "--inputs-file", path],
            &["sim", "--replay", path],
            &["reach", path],
            &["import", "xml", path],
            &["reach", HOLD, "--csv", "/dev/null", "--baseline", path],
        ];
        for command in commands {
            has(command, 2, &[&why]);
        }
    }
    has(&["reach", HOLD, "--results", pipe], 2, &["it is a named pipe, not a regular file"]);
    // A line without an end is not kept in memory.
    let trace = temporary("long.jsonl");
    std::fs::File::create(&trace).unwrap().set_len(1 << 28).unwrap();
    has(&["sim", "--replay", trace.to_str().unwrap()], 2, &["a line is longer than 16 MiB"]);
    std::fs::remove_file(&trace).unwrap();
}

/// A replay can be stopped at any time.
#[test]
#[cfg(unix)]
fn long_scripts_are_interrupted_at_once() {
    let trace = temporary("endless.jsonl");
    let commands: [&[&str]; 3] = [
        &["reach", MINHOLD, "--after", "-*100000000"],
        &["sim", MINHOLD, "--inputs", "-*100000000"],
        &["sim", MINHOLD, "--inputs", "-*100000000", "--trace", trace.to_str().unwrap()],
    ];
    for command in commands {
        let mut child = Command::new(env!("CARGO_BIN_EXE_hypedc"))
            .args(command)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(500));
        assert!(child.try_wait().unwrap().is_none(), "{command:?} is over");
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let code = child.wait().unwrap().code();
        assert_eq!(code, Some(1), "{command:?}");
    }
    let _ = std::fs::remove_file(&trace);
}

/// A world with a `never` that is called as the option is.
const CALLED_WITHOUT: &str = "entity A { button go
mode stand { x' = 0; when held(go) -> walk }
mode walk { x' = 60; when not held(go) -> stand }
}
world W { space main { place a: A at (0, 0) }; player 1: a
goal there: a.x > 30
never without: a.x > 60 }
";

#[test]
fn a_predicate_of_the_command_line_is_a_predicate_and_nothing_else() {
    let folder = std::env::temp_dir().join(format!("hypedc-without-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("w.hyped");
    std::fs::write(&file, CALLED_WITHOUT).unwrap();
    let asked = |more: &[&str]| {
        let all = [&["reach", file.to_str().unwrap(), "--seed", "1", "--nodes", "3000"], more].concat();
        let output = hypedc(&all);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).replace(file.to_str().unwrap(), "w.hyped");
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    };
    // The author's own `never` is still there.
    let (code, shown, _) = asked(&["--without", "a.x > 10"]);
    assert!(code == 1 && shown.contains("goal there: proven unreachable"), "{shown}");
    let (code, shown, _) = asked(&["--without", "a.x < -10", "--never", "without"]);
    assert!(code == 1 && shown.contains("never without: violated"), "{shown}");
    let mut findings = String::new();
    for predicate in [
        "a.x > 10\nnever other: true",
        "a.x > 10; player 2: a",
        "a.x >",
        "",
        "b.x > 3",
        "a.x",
        "a.x > 10 }",
        "a.y > 1s",
    ] {
        let (code, shown, error) = asked(&["--without", predicate]);
        assert_eq!((code, shown.as_str()), (2, ""), "{predicate}");
        findings += &format!("{predicate}\n{error}\n");
    }
    insta::assert_snapshot!(findings);
    std::fs::remove_dir_all(&folder).unwrap();
}

//! What must always hold of a search: a path replays, the same seed gives the same bytes, and "reached" is never said
//! of what cannot be.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use std::path::Path;

use hypedc::analysis::configuration_space;
use hypedc::compile::compile;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{Limits, Outcome, Plan, Problem, Settings, Verdict, reach};
use hypedc::sim::{Simulator, parse_script};
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;
use proptest::prelude::*;
use support::{Disk, compile_text, program};

const WORLD: WorldId = WorldId(0);

fn example(path: &str) -> Program {
    program(compile(Path::new(path), &Disk))
}

fn search(program: &Program, goal: u32, seed: u64, nodes: u64) -> Outcome {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::new(&sim, GoalId(goal));
    let space = configuration_space(program, WORLD);
    let settings = Settings { seed, ..Settings::default() };
    reach(&problem, &space, &settings, &Limits { nodes }, &Unwatched).unwrap()
}

/// Writes the script as text, reads it back, runs it: the goal holds at its end and not before, no `never` holds.
fn replay(program: &Program, goal: u32, plan: &Plan) {
    let text = plan.script.text(program, WORLD);
    let file = SourceMap::new().add("inputs", text.clone());
    let (script, found) = parse_script(program, WORLD, file, &text);
    assert!(found.is_empty(), "{text}: {found:?}");
    assert_eq!(script, plan.script, "{text}");
    let sim = Simulator::new(program, WORLD);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let mut steps = 0;
    for input in script.inputs() {
        assert!(!sim.goal(&state, GoalId(goal)).unwrap(), "the goal holds before the end of {text}");
        sim.step(&mut state, input, &mut scratch).unwrap();
        assert_eq!(sim.violated(&state).unwrap(), None, "{text}");
        steps += 1;
    }
    assert!(sim.goal(&state, GoalId(goal)).unwrap(), "{text}");
    assert_eq!(steps, plan.steps);
}

#[test]
fn the_papers_tests_are_solved_for_every_seed() {
    for (path, goals) in [("examples/paper/test1.hyped", 1), ("examples/paper/test2.hyped", 2)] {
        let program = example(path);
        for goal in 0..goals {
            for seed in 1..=50 {
                match search(&program, goal, seed, 500_000).verdict {
                    Verdict::Reached(plan) => replay(&program, goal, &plan),
                    other => panic!("{path}, goal {goal}, seed {seed}: {other:?}"),
                }
            }
        }
    }
}

#[test]
fn with_platforms_that_stand_still_nothing_is_reached() {
    let text = std::fs::read_to_string("examples/paper/platforms.hyped").unwrap();
    let robot = std::fs::read_to_string("examples/paper/robot.hyped").unwrap();
    let world = std::fs::read_to_string("examples/paper/test1.hyped").unwrap();
    let still = text.replace("speed = 30", "speed = 0");
    assert_ne!(still, text);
    let world: String = world.lines().filter(|l| !l.starts_with("import")).map(|l| format!("{l}\n")).collect();
    let program = program(compile_text(&format!("{still}{robot}{world}")));
    for seed in 1..=5 {
        let outcome = search(&program, 0, seed, 20_000);
        assert_eq!(outcome.verdict, Verdict::NotFound);
        assert!(outcome.statistics.nodes >= 20_000);
    }
}

#[test]
fn a_goal_that_holds_at_the_start_needs_no_step() {
    let program = program(compile_text(
        "entity Rock { }
         world W {
             space main { place rock: Rock at (3, 4) }
             goal here: near(rock, (0, 0), 5)
             goal there: rock.x > 3
         }",
    ));
    let Verdict::Reached(plan) = search(&program, 0, 1, 10).verdict else { panic!("not found") };
    assert_eq!(plan.steps, 0);
    // Without a player there is one thing to do, and without a space's map nowhere to fall.
    assert_eq!(search(&program, 1, 1, 10).verdict, Verdict::NotFound);
}

#[test]
fn never_comes_before_the_goal() {
    let text = |never: &str| {
        format!(
            "entity Ball {{ x' = 60 }}
             world W {{
                 space main {{ place ball: Ball at (0, 0) }}
                 goal far: ball.x >= 100
                 {never}
             }}"
        )
    };
    let free = program(compile_text(&text("")));
    let Verdict::Reached(plan) = search(&free, 0, 1, 100).verdict else { panic!("not found") };
    assert_eq!(plan.steps, 100);
    let barred = program(compile_text(&text("never there: ball.x >= 50")));
    assert_eq!(search(&barred, 0, 1, 1_000).verdict, Verdict::NotFound);
    let at_once = program(compile_text(&text("never there: ball.x >= 100")));
    assert_eq!(search(&at_once, 0, 1, 1_000).verdict, Verdict::NotFound);
}

#[test]
fn a_branch_ends_below_and_beside_the_bounds_but_not_above() {
    let text = |bounds: &str, goal: &str| {
        format!(
            "entity Kite {{
                 axis horizontal, vertical
                 envelope x' by horizontal {{ sustain 60 }}
                 envelope y' by vertical {{ sustain 60 }}
             }}
             world W {{
                 space main {{ place kite: Kite at (5, 5); {bounds} }}
                 player 1: kite
                 goal there: {goal}
             }}"
        )
    };
    for (goal, inside) in
        [("kite.y > 200", true), ("kite.y < -20", false), ("kite.x < -20", false), ("kite.x > 120", false)]
    {
        let free = program(compile_text(&text("", goal)));
        assert!(matches!(search(&free, 0, 1, 20_000).verdict, Verdict::Reached(_)), "{goal} without bounds");
        let bounded = program(compile_text(&text("bounds rect(0, 0, 100, 100)", goal)));
        assert_eq!(matches!(search(&bounded, 0, 1, 20_000).verdict, Verdict::Reached(_)), inside, "{goal}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Levels of a few random gaps and walls: whatever is reached replays, and twice the same seed is the same.
    #[test]
    fn paths_replay_and_seeds_repeat(
        seed in any::<u64>(),
        columns in prop::collection::vec(0usize..4, 8..20),
        speed in 40u32..200,
        jump in 100u32..400,
    ) {
        // 0 a gap, 1 floor, 2 floor with a wall of one tile, 3 a platform above a gap
        let mut rows = [String::from("......"), "......".into(), "......".into(), "......".into(), "######".into()];
        for kind in columns {
            for (row, symbols) in rows.iter_mut().zip(["....", "....", "...#", "..#.", ".##."]) {
                row.push(symbols.chars().nth(kind).unwrap());
            }
        }
        rows[3].push('G');
        rows[4].push('#');
        for row in rows.iter_mut().take(3) {
            row.push('.');
        }
        let map = rows.join("\n");
        let text = format!(
            "entity Hero {{
                 axis horizontal
                 button jump
                 collider body: rect(0, 0, 12, 14)
                 y'' = -600
                 envelope x' by horizontal {{ attack accel 800; sustain {speed}; release accel 900 }}
                 mode air {{ when touching(body, wall, below) -> ground }}
                 mode ground {{
                     when pressed(jump) -> air {{ y' := {jump} }}
                     when not touching(body, wall, below) -> air
                 }}
             }}
             world W {{
                 collide body with wall: block
                 collide body with goal: sense
                 tiles t 16 x 16 {{ '.': empty; '#': wall; 'G': goal }}
                 space main {{
                     map t \"
{map}
                     \"
                     place hero: Hero at (8, 16)
                 }}
                 player 1: hero
                 goal flag: hero touching goal
             }}"
        );
        let program = program(compile_text(&text));
        let first = search(&program, 0, seed, 3_000);
        let second = search(&program, 0, seed, 3_000);
        prop_assert_eq!(&first, &second);
        if let Verdict::Reached(plan) = &first.verdict {
            replay(&program, 0, plan);
            let Verdict::Reached(again) = &second.verdict else { panic!("the same search ends the same") };
            prop_assert_eq!(plan.script.text(&program, WORLD), again.script.text(&program, WORLD));
        }
    }
}

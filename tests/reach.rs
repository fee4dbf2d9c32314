//! Invariants of searches: a path replays, the same seed gives the same bytes, and an unreachable goal is never
//! "reached".

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, compile_text, files, program, script, script_of};
use hypedc::analysis::configuration_space;
use hypedc::compile::compile;
use hypedc::ir::{GoalId, Program, SlotId, VarId, WorldId};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{
    Argument, Limits, Metric, Outcome, Plan, Planner, Point, Problem, Proof, Quantity, Sampling, Settings, Style,
    Target, Verdict, least_steps, reach, search as grow,
};
use hypedc::sim::Simulator;
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;

const WORLD: WorldId = WorldId(0);

fn example(path: &str) -> Arc<Program> {
    program(compile(Path::new(path), &Disk))
}

fn search(program: &Arc<Program>, goal: u32, seed: u64, nodes: u64) -> Outcome {
    search_in(program, goal, seed, nodes, Sampling::Reduced)
}

fn search_in(program: &Arc<Program>, goal: u32, seed: u64, nodes: u64, sampling: Sampling) -> Outcome {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::new(&sim, GoalId(goal));
    let space = configuration_space(program, WORLD);
    let settings = Settings { seed, sampling, planner: Planner::Rrt, ..Settings::default() };
    reach(&problem, &space, &settings, &Limits { nodes, ..Limits::default() }, &Unwatched).unwrap()
}

/// Writes the script as text, reads it back, runs it: the goal holds at its end and not before, no `never` holds.
fn replay(program: &Arc<Program>, goal: u32, plan: &Plan) {
    let text = plan.script.text(program, WORLD);
    let script = script(program, &text);
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
    assert!(matches!(search(&program, 1, 1, 10).verdict, Verdict::Unreachable(_)));
    assert_eq!(search_regardless(&program, 1, 10).0.verdict, Verdict::NotFound);
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

/// Searches without the proofs of the analysis.
fn search_regardless(program: &Arc<Program>, goal: u32, nodes: u64) -> (Outcome, Option<Proof>) {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::new(&sim, GoalId(goal));
    let space = configuration_space(program, WORLD);
    let settings = Settings { planner: Planner::Rrt, sampling: Sampling::Naive, ..Settings::default() };
    let outcome = grow(&problem, &space, &settings, &Limits { nodes, ..Limits::default() }, &Unwatched).unwrap();
    (outcome, Proof::of(&problem, &space))
}

fn jumper(goal: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity Hero {{
             axis horizontal
             button jump
             collider body: rect(0, 0, 12, 14)
             y'' = -600
             envelope x' by horizontal {{ sustain 60 }}
             mode air {{ when touching(body, wall, below) -> ground }}
             mode ground {{
                 y' = -30
                 when pressed(jump) -> air {{ y' := 240 }}
                 when not touching(body, wall, below) -> air
             }}
         }}
         world W {{
             collide body with wall: block
             tiles t 16 x 16 {{ '.': empty; '#': wall }}
             space main {{
                 map t \"
                     ..........
                     ..........
                     ..........
                     ..........
                     ##########
                 \"
                 bounds rect(0, 0, 160, 80)
                 place hero: Hero at (8, 16)
             }}
             player 1: hero
             goal there: {goal}
         }}"
    )))
}

#[test]
fn a_goal_above_the_highest_jump_is_proven_unreachable() {
    // The floor is at 16, and a jump of 240 px/s under 600 px/s² rises by less than 48 px.
    for (goal, holds, reads) in [
        ("hero.y > 64", false, vec![Quantity::Var(SlotId(0), VarId(1), 0)]),
        ("hero.x > 20 and (hero.y > 64 or hero.y > 80)", false, vec![Quantity::Var(SlotId(0), VarId(1), 0)]),
        ("not hero.y <= 64", true, vec![Quantity::Var(SlotId(0), VarId(1), 0)]),
        (
            "near(hero, (80, 90), 20)",
            false,
            vec![Quantity::Var(SlotId(0), VarId(0), 0), Quantity::Var(SlotId(0), VarId(1), 0)],
        ),
    ] {
        let program = jumper(goal);
        let Verdict::Unreachable(Argument::Analysis(proof)) = search(&program, 0, 1, 1_000).verdict else {
            panic!("{goal}: no proof")
        };
        for part in &proof.parts {
            assert_eq!(part.holds, holds, "{goal}");
            let read: Vec<Quantity> = part.reads.iter().map(|(quantity, _)| *quantity).collect();
            assert_eq!(read, reads, "{goal}");
            let (_, height) = part.reads.last().unwrap();
            let top = height.hull().unwrap().high;
            assert!((60.0..=64.0).contains(&top), "{goal}: {top}");
        }
        assert_eq!(search_regardless(&program, 0, 2_000).0.verdict, Verdict::NotFound, "{goal}");
    }
    let program = jumper("hero.y > 60");
    let Verdict::Reached(plan) = search(&program, 0, 1, 1_000).verdict else { panic!("a jump is that high") };
    replay(&program, 0, &plan);
}

#[test]
fn a_goal_that_holds_only_out_of_bounds_is_neither_reached_nor_open() {
    for goal in ["hero.x < 0", "hero.x > 160"] {
        let (outcome, proof) = search_regardless(&jumper(goal), 0, 5_000);
        assert_eq!(outcome.verdict, Verdict::NotFound, "{goal}");
        assert!(proof.is_some(), "{goal}");
    }
}

/// The scripts of the examples reach their goals.
#[test]
fn what_the_examples_reach_is_not_proven_unreachable() {
    let mut goals = 0;
    for path in files("examples", "hyped").into_iter().chain(files("tests/conformance", "hyped")) {
        let program = compile(&path, &Disk).program.unwrap();
        // In a world that leaves its map open, nobody is placed yet.
        for world in program.worlds.ids().filter(|world| program.worlds[*world].open.is_none()) {
            let space = configuration_space(&program, world);
            for goal in program.worlds[world].goals.ids() {
                let name = &program.worlds[world].goals[goal].name;
                assert!(space.can_hold(&program, world, goal), "{}: {name}", path.display());
                goals += 1;
            }
        }
    }
    assert!(goals > 20);
}

#[test]
fn samples_are_drawn_from_what_can_be() {
    let program = example("examples/paper/test1.hyped");
    let sim = Simulator::new(&program, WORLD);
    let space = configuration_space(&program, WORLD);
    let metric = Metric::new(&sim, &space, Sampling::Reduced);
    let naive = Metric::new(&sim, &space, Sampling::Naive);
    // The height of a platform and its speed, which follow from its mode, are no coordinates.
    let brown = SlotId(1);
    let of_brown =
        metric.coordinates().iter().filter(|c| matches!(c.quantity, Quantity::Var(slot, ..) if slot == brown));
    let quantities: Vec<Quantity> = of_brown.map(|c| c.quantity).collect();
    assert_eq!(quantities, [Quantity::Var(brown, VarId(0), 0)]);
    assert!(metric.coordinates().len() < naive.coordinates().len() / 2);
    let at = metric.coordinates().iter().position(|c| c.quantity == quantities[0]).unwrap();
    let mode = metric.mode_index(brown, program.entities[sim.world().slots[brown].entity].groups.ids().next().unwrap());
    let x = &metric.coordinates()[at];
    let mut rng = Pcg64::seed_from_u64(1);
    let mut sample = Point::default();
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..2_000 {
        metric.sample(&mut rng, &mut sample);
        assert_eq!((sample.reals.len(), sample.modes.len()), (metric.coordinates().len(), metric.modes()));
        let leaf = sample.modes[mode.unwrap()];
        let own = space.slots[brown].configurations.iter().find(|c| c.leaves[0].0 as f32 == leaf).unwrap();
        let hull = own.vars[VarId(0)][0].hull().unwrap();
        let (low, high) = (x.scaled(hull.low), x.scaled(hull.high));
        assert!((low..=high).contains(&sample.reals[at]), "{leaf}: {} not in {low}..{high}", sample.reals[at]);
        seen.insert(leaf as u32);
    }
    assert_eq!(seen.len(), 3);
}

#[test]
fn naive_bounds_solve_the_papers_tests_too() {
    for (path, goals) in [("examples/paper/test1.hyped", 1), ("examples/paper/test2.hyped", 2)] {
        let program = example(path);
        for (goal, seed) in (0..goals).flat_map(|goal| (1..=5).map(move |seed| (goal, seed))) {
            match search_in(&program, goal, seed, 500_000, Sampling::Naive).verdict {
                Verdict::Reached(plan) => replay(&program, goal, &plan),
                other => panic!("{path}, goal {goal}, seed {seed}: {other:?}"),
            }
        }
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
        let (regardless, proof) = search_regardless(&program, 0, 2_000);
        prop_assert!(proof.is_none() || regardless.verdict == Verdict::NotFound, "{:?}", proof);
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

/// A walker in a room with a chamber of solid rock, which has a gap of some width.
fn chamber(gap: f64, goal: &str) -> Arc<Program> {
    let text = format!(
        "entity Walker {{
             axis horizontal, vertical
             collider body, player: rect(0, 0, 12, 12)
             mode walk {{ envelope (x', y') by (horizontal, vertical) {{ sustain 80 }} }}
         }}
         world Rock {{
             collide body with wall: block
             collide player with gold: sense
             space main {{
                 bounds rect(0, 0, 200, 100)
                 rect wall (0, 0, 200, 8)
                 rect wall (0, 92, 200, 8)
                 rect wall (0, 0, 8, 100)
                 rect wall (192, 0, 8, 100)
                 rect wall (80, 30, 8, 40)
                 rect wall (120, 30, 8, 40)
                 rect wall (80, 62, 48, 8)
                 rect wall (80, 30, {}, 8)
                 rect gold (100, 46, 8, 8)
                 place hero: Walker at (20, 20)
             }}
             player 1: hero
             goal inside: {goal}
         }}",
        40.0 - gap
    );
    program(compile_text(&text))
}

/// A walker in a room of long walls, with a way into a second one in its far corner, where the goal is.
fn two_mazes(goal: &str) -> Arc<Program> {
    let text = format!(
        "entity Hero {{
            param speed = 120
            axis horizontal, vertical
            collider body: rect(1, 1, 14, 14)
            mode walking {{
                x' = speed * horizontal
                y' = speed * vertical
                follow links
            }}
        }}
        entity Chest {{ collider chest: rect(0, 0, 16, 16) }}
        world Mazes {{
            collide body with wall: block
            collide body with chest: sense
            tiles maze 16 x 16 {{
                '.': empty
                '#': wall
            }}
            space first {{
                map maze \"
                    ####################
                    #..................#
                    #.################.#
                    #.#..............#.#
                    #.#.############.#.#
                    #.#.#..........#.#.#
                    #.#.#.########.#.#.#
                    #.#.#........#.#.#.#
                    #.#.##########.#.#.#
                    #.#............#.#.#
                    #.##############.#.#
                    #................#.#
                    ##################.#
                    #..................#
                    ####################
                \"
                place hero: Hero at (96, 112)
                link rect(12, 12, 8, 24) -> second at rect(278, 200, 8, 24)
            }}
            space second {{
                map maze \"
                    ####################
                    #..................#
                    #.##################
                    #..................#
                    ##################.#
                    #..................#
                    ####################
                \"
                place chest: Chest at (272, 16)
            }}
            player 1: hero
            goal there: {goal}
        }}"
    );
    program(compile_text(&text.replace("rect(278, 200, 8, 24)", "rect(270, 76, 8, 24)")))
}

#[test]
fn distances_lead_round_walls_and_through_links() {
    let goals =
        ["hero touching chest", "near(hero, chest, 20)", "inside(hero, second) and hero.y < 40 and hero.x > 240"];
    for goal in goals {
        let program = two_mazes(goal);
        for seed in 1..=3 {
            let sim = Simulator::new(&program, WORLD);
            let problem = Problem::new(&sim, GoalId(0));
            let space = configuration_space(&program, WORLD);
            let settings = Settings { seed, planner: Planner::DistanceGuided, ..Settings::default() };
            let limits = Limits { nodes: 5_000, ..Limits::default() };
            let outcome = grow(&problem, &space, &settings, &limits, &Unwatched).unwrap();
            let Verdict::Reached(plan) = outcome.verdict else { panic!("{goal}, seed {seed}: {:?}", outcome.verdict) };
            replay(&program, 0, &plan);
        }
    }
}

/// A button counts as springs let go, and no mode before reads it; they need longer than an input is held.
#[test]
fn what_only_a_later_mode_reads_is_held_before() {
    let program = program(compile_text(
        "entity Hero {
            button jump
            collider body: rect(0, 0, 8, 8)
            discrete springs: int 0..6 = 0

            mode ground { y' = 0; when pressed(jump) -> pressed_down }
            mode pressed_down { y' = 0; when timer >= 1.5s -> thrown }
            mode thrown {
                y' = 60
                when not held(jump) -> ground { springs := 0 }
                when timer >= 0.1s -> pressed_down { springs += 1 }
            }
        }
        world Springs {
            step 1/60
            space main { bounds rect(-100, -100, 200, 400); place hero: Hero at (0, 0) }
            player 1: hero
            goal up: hero.springs >= 4
        }",
    ));
    for planner in [Planner::DistanceGuided, Planner::Coverage] {
        for seed in 1..=5 {
            let sim = Simulator::new(&program, WORLD);
            let problem = Problem::new(&sim, GoalId(0));
            let space = configuration_space(&program, WORLD);
            let settings = Settings { seed, planner, ..Settings::default() };
            let limits = Limits { nodes: 20_000, ..Limits::default() };
            let outcome = grow(&problem, &space, &settings, &limits, &Unwatched).unwrap();
            let Verdict::Reached(plan) = outcome.verdict else {
                panic!("{planner:?}, seed {seed}: {:?}", outcome.verdict)
            };
            replay(&program, 0, &plan);
        }
    }
}

#[test]
fn walls_beyond_the_bounds_are_no_trouble() {
    let walls = [(-400, 0), (400, 0), (0, -400), (0, 400), (400, 400)];
    for (x, y) in walls {
        let text = format!(
            "entity Hero {{
                param speed = 60
                axis horizontal
                collider body: rect(0, 0, 16, 16)
                x' = speed * horizontal
            }}
            world Room {{
                collide body with wall: block
                space main {{
                    bounds rect(0, 0, 160, 160)
                    rect wall (64, 0, 16, 160)
                    rect wall ({x}, {y}, 16, 16)
                    place hero: Hero at (16, 16)
                }}
                player 1: hero
                goal far: hero.x > 100
            }}"
        );
        let program = program(compile_text(&text));
        let outcome = search(&program, 0, 1, 100);
        assert!(
            matches!(outcome.verdict, Verdict::Unreachable(Argument::Analysis(_))),
            "{x}, {y}: {:?}",
            outcome.verdict
        );
    }
}

#[test]
fn what_is_walled_off_is_proven_unreachable() {
    for goal in ["hero touching gold", "near(hero, (98, 46), 6)", "95 < hero.x < 105 and 40 < hero.y < 50"] {
        let program = chamber(0.0, goal);
        assert!(matches!(search(&program, 0, 1, 1_000).verdict, Verdict::Unreachable(_)), "{goal}");
        assert_eq!(search_regardless(&program, 0, 5_000).0.verdict, Verdict::NotFound, "{goal}");
        // Through a gap one gets in.
        let program = chamber(24.0, goal);
        let Verdict::Reached(plan) = search(&program, 0, 1, 50_000).verdict else { panic!("{goal}: there is a gap") };
        replay(&program, 0, &plan);
    }
}

/// A hall whose goal takes a hundred steps at full speed.
fn hall() -> Arc<Program> {
    let text = "entity Walker {\n    param speed = 60\n    axis move\n    collider body: rect(0, 0, 8, 8)\n    x' = speed * move\n    y' = 0\n}\n\
        world Hall {\n    step 1/60\n    space main {\n        bounds rect (-50, 0, 300, 50)\n        \
        place walker: Walker at (0, 10)\n    }\n    player 1: walker\n    goal far: walker.x > 99.5\n}\n";
    program(compile_text(text))
}

/// There is time for as many steps as are given.
fn walk_within(steps: u32, planner: Planner, seed: u64, analysed: bool) -> Verdict {
    let program = hall();
    let sim = Simulator::new(&program, WORLD);
    let problem = Problem::new(&sim, GoalId(0)).within(steps);
    let space = configuration_space(&program, WORLD);
    let settings = Settings { seed, planner, ..Settings::default() };
    let ask = if analysed { reach } else { grow };
    let outcome = ask(&problem, &space, &settings, &Limits { nodes: 20_000, ..Limits::default() }, &Unwatched);
    let verdict = outcome.unwrap().verdict;
    if let Verdict::Reached(plan) = &verdict {
        replay(&program, 0, plan);
    }
    verdict
}

#[test]
fn what_takes_too_long_does_not_count() {
    for planner in Planner::ALL {
        let is_exhaustive = [Planner::Exhaustive, Planner::Auto].contains(&planner);
        for analysed in [true, false] {
            match walk_within(99, planner, 1, analysed) {
                Verdict::Unreachable(Argument::Distance(far)) => assert!(analysed && far.least == 100, "{planner:?}"),
                // How far the axis is moved is read, too.
                Verdict::Exhausted(_) => assert!(is_exhaustive && !analysed, "{planner:?}"),
                Verdict::NotFound => assert!(!is_exhaustive && !analysed, "{planner:?}"),
                other => panic!("{planner:?}: {other:?}"),
            }
        }
    }
    assert!(matches!(walk_within(100, Planner::Exhaustive, 1, true), Verdict::Reached(plan) if plan.steps == 100));
    for seed in 1..=10 {
        assert!(
            matches!(walk_within(130, Planner::Auto, seed, true), Verdict::Reached(plan) if plan.steps <= 130),
            "{seed}"
        );
    }
}

#[test]
fn no_way_is_shorter_than_the_fastest_player_needs() {
    let program = hall();
    let (sim, space) = (Simulator::new(&program, WORLD), configuration_space(&program, WORLD));
    let problem = Problem::new(&sim, GoalId(0));
    let least = |most| least_steps(&problem, &space, most, &Unwatched).unwrap();
    for most in [100, 101, 130, 10_000] {
        assert_eq!(least(most), Some(100), "of {most} steps");
    }
    // A run that is faster than the analysis admits: it says nothing.
    assert_eq!([0, 1, 99].map(least), [None; 3]);
    // Also after a number of steps, and what takes no longer is shortest.
    let begun = script_of(&program, WORLD, "move=1*40 -*3");
    for after in [Vec::new(), vec![begun]] {
        let (given, left) = if after.is_empty() { (0, 100) } else { (43, 60) };
        let query = Query { after, style: Some(Style::Fast), ..Query::new(vec![Target::Goal(GoalId(0))]) };
        let session = Session::new(&program, WORLD, query, &Unwatched);
        let mut found = session.find(Target::Goal(GoalId(0)), &Unwatched).unwrap();
        let answer = session.answer(&mut found, &SourceMap::new());
        assert_eq!((answer.steps, answer.least_steps), (Some(given + left), Some(given + left)));
        assert_eq!(answer.is_shortest, Some(true));
    }
}

//! The border of a space: a run of any player ends at declared `bounds`, and at nothing else. A search that stops
//! before them proves nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use crate::support::{Disk, compile_text, program, script};
use hypedc::analysis::configuration_space;
use hypedc::compile::compile;
use hypedc::ir::{GoalId, NeverId, Program, WorldId};
use hypedc::reach::{
    Exhaustion, Limits, Outcome, Planner, Problem, Settings, StateStatus, Target, Termination, Verdict, reach,
};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

fn of_file(name: &str) -> Arc<Program> {
    let paths = ["tests/border", "tests/analysis/found/small"];
    let paths = paths.map(|folder| Path::new(folder).join(format!("{name}.hyped")));
    program(compile(paths.iter().find(|path| path.exists()).unwrap(), &Disk))
}

fn ask(problem: &Problem<'_>, planner: Planner, hold: Option<(u16, u16)>) -> Outcome {
    let space = configuration_space(problem.sim.program(), WORLD);
    let settings = Settings { planner, hold, ..Settings::default() };
    reach(problem, &space, &settings, &Limits { nodes: 20_000, ..Limits::default() }, &Unwatched).unwrap()
}

/// A walker on a map of 96 × 32 px without walls at its sides; `more` is added to the space, `asked` to the world.
fn meadow(more: &str, asked: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity Walker {{
            param speed = 60
            axis horizontal
            collider body: rect(0, 0, 16, 16)
            x' = speed * horizontal
        }}
        world Meadow {{
            collide body with wall: block
            tiles t 16 x 16 {{ '.': empty; '#': wall }}
            space main {{
                map t \"
                    ......
                    ######
                \"
                place hero: Walker at (32, 16)
                {more}
            }}
            player 1: hero
            {asked}
        }}"
    )))
}

const GOAL: Target = Target::Goal(GoalId(0));

#[test]
fn what_happens_outside_of_the_map_is_found() {
    for (name, target) in [
        ("pit", Target::Never(NeverId(0))),
        ("pit_proof", Target::Never(NeverId(0))),
        ("tunnel", GOAL),
        ("linkout", GOAL),
    ] {
        let program = of_file(name);
        let sim = Simulator::new(&program, WORLD);
        for planner in Planner::ALL {
            // With single steps there are too many states.
            let hold = matches!(planner, Planner::Exhaustive | Planner::BestFirst).then_some((10, 10));
            let outcome = ask(&Problem::asking(&sim, target), planner, hold);
            let Verdict::Reached(plan) = outcome.verdict else { panic!("{name}, {planner:?}: {outcome:?}") };
            let mut state = sim.initial(&mut sim.scratch()).unwrap();
            for input in plan.script.inputs() {
                sim.step(&mut state, input, &mut sim.scratch()).unwrap();
            }
            let holds = match target {
                Target::Goal(goal) => sim.goal(&state, goal).unwrap(),
                Target::Never(never) => sim.violated(&state).unwrap() == Some(never),
            };
            assert!(holds, "{name}, {planner:?}");
        }
    }
}

#[test]
fn nothing_is_proven_where_a_search_stopped_by_itself() {
    // The walker can walk away for ever.
    let program = meadow("", "goal up: hero.y > 100");
    let sim = Simulator::new(&program, WORLD);
    let space = configuration_space(&program, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    for (planner, hold) in [
        (Planner::Exhaustive, (10, 10)),
        (Planner::Exhaustive, (1, 1)),
        (Planner::BestFirst, (10, 10)),
        (Planner::BestFirst, (1, 1)),
        (Planner::Auto, (1, 40)),
    ] {
        let settings = Settings { planner, hold: Some(hold), ..Settings::default() };
        let limits = Limits { nodes: 20_000, ..Limits::default() };
        // Without the analysis, which proves it.
        let outcome = hypedc::reach::search(&problem, &space, &settings, &limits, &Unwatched).unwrap();
        assert_eq!(outcome.verdict, Verdict::NotFound, "{planner:?}");
        assert_eq!(outcome.exhausted, None, "{planner:?}");
        let [cut] = outcome.cuts.as_slice() else { panic!("{planner:?}: {:?}", outcome.cuts) };
        assert!(cut.branches > 0);
        // The map is 96 px wide; around it, there are two bodies.
        assert_eq!((cut.window.left, cut.window.right), (-32.0, 128.0));
    }
    // Bounds end its runs, and those of everybody else.
    let program = meadow("bounds rect(0, 0, 80, 32)", "goal up: hero.y > 100");
    let sim = Simulator::new(&program, WORLD);
    let space = configuration_space(&program, WORLD);
    let settings = Settings { planner: Planner::Exhaustive, ..Settings::default() };
    let limits = Limits { nodes: 20_000, ..Limits::default() };
    let problem = Problem::new(&sim, GoalId(0));
    let outcome = hypedc::reach::search(&problem, &space, &settings, &limits, &Unwatched).unwrap();
    assert!(matches!(outcome.verdict, Verdict::Exhausted(Exhaustion { states: 1.., .. })), "{outcome:?}");
    assert_eq!(outcome.cuts, []);
}

#[test]
fn searches_go_as_far_as_anything_is_compared_with() {
    // Compared in the goal, in the guard of an edge through a parameter, in an update, and around a point.
    for (edge, goal) in [
        ("", "hero.x > 700"),
        ("", "hero.x + 100 < -500"),
        ("", "near(hero, (900, 16), 20)"),
        ("when x < -far { x := 900 }", "hero.x > 200"),
        ("when x - 10 > far -> gone", "hero in gone"),
        ("when x > 90 { x := -1000 }", "hero in walking and hero.x < -900"),
    ] {
        let program = program(compile_text(&format!(
            "entity Walker {{
                param far = 300
                param speed = 100
                axis horizontal
                collider body: rect(0, 0, 16, 16)
                x' = speed * horizontal
                initial mode walking {{ {edge} }}
                mode gone {{ }}
            }}
            world Plain {{
                tiles t 16 x 16 {{ '.': empty }}
                space main {{
                    map t \"
                        ......
                    \"
                    place hero: Walker at (32, 0)
                }}
                player 1: hero
                goal there: {goal}
            }}"
        )));
        let sim = Simulator::new(&program, WORLD);
        let outcome = ask(&Problem::new(&sim, GoalId(0)), Planner::BestFirst, Some((10, 10)));
        assert!(matches!(outcome.verdict, Verdict::Reached(_)), "{edge} {goal}: {outcome:?}");
    }
}

#[test]
fn what_is_compared_is_seen_at_any_speed() {
    // A step takes it from above the pit to 1700 px below.
    let program = program(compile_text(
        "entity Stone {
            button go
            collider body: rect(0, 0, 8, 8)
            initial mode lies { when held(go) -> falls }
            mode falls { y' = -102400; when y < -16 -> lost }
            mode lost { y' = 0 }
        }
        world Shaft {
            step 1/60
            tiles t 16 x 16 { '.': empty }
            space main {
                map t \"
                    .
                \"
                place stone: Stone at (0, 0)
            }
            player 1: stone
            goal lost: stone in lost
        }",
    ));
    let sim = Simulator::new(&program, WORLD);
    for planner in [Planner::Exhaustive, Planner::Rrt] {
        let outcome = ask(&Problem::new(&sim, GoalId(0)), planner, Some((1, 1)));
        assert!(matches!(outcome.verdict, Verdict::Reached(_)), "{planner:?}: {outcome:?}");
    }
}

#[test]
fn no_way_is_called_the_shortest_where_another_may_lead_around() {
    let asked = "goal right: hero.x > 60";
    for (more, is_known) in [("", true), ("bounds rect(0, 0, 80, 32)", true)] {
        let program = meadow(more, asked);
        let sim = Simulator::new(&program, WORLD);
        let outcome = ask(&Problem::new(&sim, GoalId(0)), Planner::Exhaustive, None);
        let Verdict::Reached(plan) = outcome.verdict else { panic!("{more}: {outcome:?}") };
        assert_eq!(plan.is_shortest, is_known, "{more}");
    }
    // The path to the other side is so long that some states leave the window before.
    let program = meadow("", "goal right: hero.x > 120");
    let sim = Simulator::new(&program, WORLD);
    let outcome = ask(&Problem::new(&sim, GoalId(0)), Planner::Exhaustive, None);
    let Verdict::Reached(plan) = outcome.verdict else { panic!("{outcome:?}") };
    assert!(!plan.is_shortest, "{:?}", outcome.cuts);
    // A path is the shortest only if no path could have continued outside and arrived sooner: it steps right 1 px at a
    // time.
    let soonest = outcome.cuts[0].soonest;
    for (steps, is_known) in [(soonest + 1, true), (soonest + 2, false)] {
        let program = meadow("", &format!("goal right: hero.x > {}.5", 32 + steps - 1));
        let sim = Simulator::new(&program, WORLD);
        let outcome = ask(&Problem::new(&sim, GoalId(0)), Planner::Exhaustive, None);
        let Verdict::Reached(plan) = outcome.verdict else { panic!("{outcome:?}") };
        assert_eq!((plan.steps, plan.is_shortest), (u64::from(steps), is_known), "{:?}", outcome.cuts);
    }
}

#[test]
fn a_search_can_begin_outside() {
    let program = meadow("", "goal back: hero.x > -0.5 and hero.x < 0.5");
    let sim = Simulator::new(&program, WORLD);
    let problem = Problem::new(&sim, GoalId(0)).after(script(&program, "horizontal=-1*300")).unwrap();
    let outcome = ask(&problem, Planner::BestFirst, Some((1, 1)));
    assert!(matches!(outcome.verdict, Verdict::Reached(_)), "{outcome:?}");
}

#[test]
fn bounds_end_a_run_where_a_never_counts_and_a_goal_does_not() {
    // At the first step at which x < 0: 33 steps of 1 px.
    let more = "bounds rect(0, 0, 80, 32)";
    let program = meadow(more, "goal left: hero.x < 0\n goal above: hero.y > 16\n never left_too: hero.x < 0");
    let sim = Simulator::new(&program, WORLD);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let inputs = script(&program, "horizontal=-1*33");
    for input in inputs.inputs() {
        assert_eq!(sim.left_bounds(&state), None);
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    assert_eq!(sim.left_bounds(&state), Some(sim.world().players[hypedc::ir::PlayerId(0)].slot));
    assert_eq!(Problem::new(&sim, GoalId(0)).judge(&state), Ok(StateStatus::Dead(Termination::Never(NeverId(0)))));
    assert_eq!(Problem::asking(&sim, Target::Never(NeverId(0))).judge(&state), Ok(StateStatus::Goal));
    let program = meadow(more, "goal left: hero.x < 0");
    let sim = Simulator::new(&program, WORLD);
    assert_eq!(Problem::new(&sim, GoalId(0)).judge(&state), Ok(StateStatus::Dead(Termination::Outside)));
    // Without bounds, nothing ends.
    let program = meadow("", "goal left: hero.x < 0");
    let sim = Simulator::new(&program, WORLD);
    assert_eq!(sim.left_bounds(&state), None);
    assert_eq!(Problem::new(&sim, GoalId(0)).judge(&state), Ok(StateStatus::Goal));
}

/// Standard output and standard error of the command, and whether it succeeds.
fn hypedc(arguments: &[&str]) -> (String, String, bool) {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.success())
}

#[test]
fn sim_ends_where_a_player_leaves_the_bounds() {
    let file = "tests/border/bounded.hyped";
    let left = "horizontal=-1*60";
    let (out, _, yes) = hypedc(&["sim", file, "--inputs", left]);
    assert!(yes);
    assert!(out.contains("33 steps"), "{out}");
    assert!(out.contains("the run ends at step 33: hero has left the bounds of `main`"), "{out}");
    assert!(out.contains("goal out: not reached"), "{out}");
    let (_, error, yes) = hypedc(&["sim", file, "--inputs", left, "--expect", "out"]);
    assert!(!yes);
    assert!(error.contains("the goal was not reached in 33 steps"), "{error}");
    let (trace, _, _) = hypedc(&["sim", file, "--inputs", left, "--trace", "-"]);
    assert_eq!(trace.lines().count(), 1 + 34, "{trace}");
    // A walker inside has no verdict about the border.
    let (out, _, yes) = hypedc(&["sim", file, "--inputs", "horizontal=-1*20"]);
    assert!(yes && !out.contains("the run ends"), "{out}");
}

#[test]
fn reach_tells_where_it_stopped() {
    let file = "tests/border/open.hyped";
    let (out, _, _) = hypedc(&["reach", file, "--planner", "exhaustive"]);
    assert!(out.contains("not found"), "{out}");
    assert!(out.contains("left the search window of `main` (x in -32..128, y >= -32)"), "{out}");
    assert!(out.contains("add `bounds` to end runs there"), "{out}");
    assert!(!out.contains("proven"), "{out}");
}

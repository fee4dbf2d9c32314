//! Questions about spaces that wrap: a goal behind a wall is found the way around, no proof is made because of the
//! seam, and what is proven stays proven.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;

use crate::support::{compile_text, program};
use hypedc::analysis::configuration_space;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{Limits, Outcome, Planner, Problem, Settings, Verdict, reach};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

/// A walker on a floor of twelve tiles with a wall of full height in the middle; `wrap` is added to the space.
fn hall(wrap: &str, goal: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity Walker {{
            param speed = 96
            axis horizontal
            collider body: rect(0, 0, 16, 16)
            x' = speed * horizontal
            y'' = -400
        }}
        world Hall {{
            step 1/30
            collide body with wall: block
            tiles t 16 x 16 {{ '.': empty; '#': wall }}
            space main {{
                map t \"
                    #####.######
                    .....#......
                    .....#......
                    ############
                \"
                bounds rect(0, 0, 192, 64)
                {wrap}
                place hero: Walker at (48, 16)
            }}
            player 1: hero
            goal asked: {goal}
        }}"
    )))
}

fn ask(program: &Arc<Program>, planner: Planner, hold: Option<(u16, u16)>, time: Option<u32>) -> Outcome {
    let sim = Simulator::new(program, WORLD);
    let mut problem = Problem::new(&sim, GoalId(0));
    if let Some(time) = time {
        problem = problem.within(time);
    }
    let space = configuration_space(program, WORLD);
    let settings = Settings { planner, hold, ..Settings::default() };
    reach(&problem, &space, &settings, &Limits { nodes: 20_000, ..Limits::default() }, &Unwatched).unwrap()
}

#[test]
fn the_way_around_is_found() {
    for goal in
        ["hero.x > 100", "near(hero, (112, 16), 8)", "near(hero, (304, 16), 8)", "hero touching wall and hero.x > 90"]
    {
        let program = hall("wrap horizontal", goal);
        for (planner, hold) in [
            (Planner::Auto, None),
            (Planner::Exhaustive, Some((5, 5))),
            (Planner::DistanceGuided, None),
            (Planner::Rrt, None),
        ] {
            let outcome = ask(&program, planner, hold, None);
            assert!(matches!(outcome.verdict, Verdict::Reached(_)), "{goal}, {planner:?}: {:?}", outcome.verdict);
            // A lower bound of the time left must not cut it off: the way is 96 px long at most, 3.2 px a step.
            let outcome = ask(&program, planner, hold, Some(60));
            assert!(matches!(outcome.verdict, Verdict::Reached(_)), "{goal}, {planner:?}: {:?}", outcome.verdict);
        }
    }
}

#[test]
fn without_a_seam_there_is_no_way() {
    let program = hall("", "hero.x > 100");
    let outcome = ask(&program, Planner::Exhaustive, Some((5, 5)), None);
    assert!(!matches!(outcome.verdict, Verdict::Reached(_)), "{:?}", outcome.verdict);
}

#[test]
fn what_cannot_be_is_still_proven() {
    for goal in ["hero.x > 192", "hero.x < 0", "near(hero, (0, 400), 100)"] {
        let program = hall("wrap horizontal", goal);
        let outcome = ask(&program, Planner::Auto, None, None);
        assert!(matches!(outcome.verdict, Verdict::Unreachable(_)), "{goal}: {:?}", outcome.verdict);
    }
}

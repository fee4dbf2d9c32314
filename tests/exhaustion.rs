//! Visiting all states in few bytes: what it proves agrees with other searches, whatever it leaves out.

use std::sync::Arc;

use crate::support::{compile_text, program};
use hypedc::analysis::configuration_space;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{Argument, Limits, Outcome, Planner, Problem, Settings, Verdict, exhaust, reach, search};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

/// A hero who jumps over three tiles, and bounces from what has a head. The gap has ten.
fn gap(others: &str, things: &str) -> Arc<Program> {
    gap_of(10, others, things)
}

fn gap_of(tiles: usize, others: &str, things: &str) -> Arc<Program> {
    let text = format!(
        r#"
entity Hero {{
    param speed = 240
    axis move
    button jump
    collider body: rect(0, 0, 16, 16)
    collider feet: rect(0, 0, 16, 4)
    clamp y' >= -240
    x' = speed * sign(move)
    mode ground {{
        y' = -30
        when pressed(jump) -> air {{ y' := 240 }}
        when not touching(body, solid, below) -> air {{ y' := 0 }}
    }}
    initial mode air {{
        y'' = -900
        when touching(feet, head) -> air {{ y' := 240 }}
        when touching(body, solid, below) -> ground
    }}
}}
{others}
world Gap {{
    step 1/30
    collide body with solid: block
    collide feet with head: sense
    collide body with crate: block
    tiles t 16 x 16 {{ '.': empty; '#': solid }}
    space main {{
        bounds rect(0, -32, 320, 400)
        map t "
            ....................
            ....................
            ....................
            ....................
            ####################
        "
        place hero: Hero at (16, 16)
        {things}
    }}
    player 1: hero
    goal end: hero.x >= 272
    never fell: hero.y < 0
}}
"#
    );
    let text = text.replace("####################", &format!("######{}{}", ".".repeat(tiles), "#".repeat(14 - tiles)));
    program(compile_text(&text))
}

fn asked(program: &Arc<Program>, threads: usize) -> Outcome {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    let limits = Limits { nodes: 400_000, ..Limits::default() };
    exhaust(&problem, &limits, threads, &Unwatched).unwrap().unwrap()
}

/// The number of instances that were left out of a proof.
fn left_out(outcome: &Outcome) -> Option<u32> {
    match outcome.verdict {
        Verdict::Unreachable(Argument::Exhaustion(all)) => Some(all.left_out),
        _ => None,
    }
}

#[test]
fn a_gap_that_is_too_wide_is_proven_so() {
    let outcome = asked(&gap("", ""), 1);
    assert_eq!(left_out(&outcome), Some(0), "{outcome:?}");
    assert_eq!(asked(&gap("", ""), 3), outcome, "whatever the number of threads");
}

const BIRD: &str = "entity Bird { collider head: rect(0, 8, 16, 8) }";
const WALKER: &str = "entity Walker {
    collider head: rect(0, 8, 16, 8)
    collider body: rect(0, 0, 16, 12)
    mode right {
        x' = 60
        when touching(body, head) -> left
    }
    initial mode left {
        x' = -60
        when x <= 20 -> right
    }
}";

#[test]
fn others_that_cannot_help_are_left_out() {
    for (others, things, count) in [
        // Too high.
        (BIRD, "place bird: Bird at (40, 120)", 1),
        // A bounce here leads no further.
        (BIRD, "place bird: Bird at (40, 12)", 1),
        (BIRD, "place a: Bird at (40, 12)\nplace b: Bird at (140, 200)", 2),
        // Never as far as the gap.
        (&WALKER.replace("when touching(body, head)", "when x >= 60"), "place a: Walker at (40, 16)", 1),
    ] {
        let outcome = asked(&gap(others, things), 2);
        assert_eq!(left_out(&outcome), Some(count), "{things}: {outcome:?}");
    }
}

#[test]
fn what_helps_by_a_contact_is_not_left_out_of_account() {
    for (others, things) in [
        // Two birds to bounce from.
        (BIRD, "place a: Bird at (128, 16)\nplace b: Bird at (200, 16)"),
        // Something that turns wherever it is touched may be anywhere.
        (WALKER, "place a: Walker at (40, 16)"),
        (&WALKER.replace("x <= 20", "x <= -1000"), "place a: Walker at (280, 16)"),
    ] {
        let outcome = asked(&gap(others, things), 1);
        assert!(matches!(outcome.verdict, Verdict::Reached(_) | Verdict::NotFound), "{things}: {outcome:?}");
    }
    let program = gap(BIRD, "place a: Bird at (128, 16)\nplace b: Bird at (200, 16)");
    let sim = Simulator::new(&program, WORLD);
    let space = configuration_space(&program, WORLD);
    let settings = Settings { planner: Planner::Exhaustive, ..Settings::default() };
    let limits = Limits::default();
    let outcome = search(&Problem::new(&sim, GoalId(0)), &space, &settings, &limits, &Unwatched).unwrap();
    assert!(matches!(outcome.verdict, Verdict::Reached(_)), "it can be passed: {outcome:?}");
}

#[test]
fn what_acts_otherwise_takes_part() {
    let crates = "entity Crate { collider crate: rect(0, 0, 16, 16) }";
    let lift = "entity Lift { kinematic collider solid: rect(0, 0, 32, 8); x' = 30 }";
    let killer = "entity Killer { ref prey: Hero
        initial mode waiting { when timer > 1s { destroy prey } } }";
    for (others, things) in [
        (crates, "place a: Crate at (40, 16)"),
        (lift, "place a: Lift at (-200, 200)"),
        (killer, "place a: Killer at (40, 16) { prey = hero }"),
    ] {
        let outcome = asked(&gap(others, things), 1);
        assert!(left_out(&outcome).is_none_or(|count| count == 0), "{things}: {outcome:?}");
    }
}

/// The widest gap that can be passed is found, one that is wider is proven; `auto` says the same.
#[test]
fn each_gap_is_either_passed_or_proven() {
    let mut passed = Vec::new();
    for width in 1..=10 {
        let program = gap_of(width, BIRD, "place bird: Bird at (40, 120)");
        let sim = Simulator::new(&program, WORLD);
        let problem = Problem::new(&sim, GoalId(0));
        let limits = Limits { nodes: 400_000, ..Limits::default() };
        let outcome = exhaust(&problem, &limits, 1, &Unwatched).unwrap().unwrap();
        let space = configuration_space(&program, WORLD);
        let known = reach(&problem, &space, &Settings::default(), &Limits::default(), &Unwatched).unwrap();
        match (&outcome.verdict, &known.verdict) {
            (Verdict::Reached(plan), Verdict::Reached(other)) => {
                assert!(plan.is_shortest && plan.steps <= other.steps, "{width}");
                passed.push(width);
            }
            (Verdict::Unreachable(Argument::Exhaustion(_)), Verdict::Unreachable(_)) => {}
            both => panic!("{width}: {both:?}"),
        }
    }
    assert!(passed.len() > 1 && passed.len() < 9 && passed.iter().zip(1..).all(|(a, b)| *a == b), "{passed:?}");
}

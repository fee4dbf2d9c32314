//! Places that a player cannot reach although nothing blocks it: too high, too far, not with its abilities. With
//! slightly more speed, height or width it can: the search finds a path.

use hypedc::analysis::{ConfigurationSpace, at_most, configuration_space};
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{Limits, Problem, Settings, Verdict, search};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;
use std::sync::Arc;

use crate::support::{compile_text, program};

const HERO: &str = "entity Hero {
    param speed = 90
    param gravity = -700
    param jump_speed = JUMP
    param cut_speed = 80
    axis horizontal
    button jump
    collider body: rect(1, 0, 14, 15)
    clamp y' >= -300
    mode alive {
        x' = speed * horizontal
        y'' = gravity
        when y < -32 -> dead
        initial mode ground {
            when pressed(jump) -> rising { y' := jump_speed }
            when not touching(body, wall, below) -> falling
        }
        mode air {
            when touching(body, wall, below) and y' <= 0 -> ground
            mode falling { }
            mode rising {
                when not held(jump) -> falling { y' := min(y', cut_speed) }
                when y' <= 0 -> falling
            }
        }
    }
    mode dead { x' = 0; y' = 0 }
}";

fn world(map: &str, goal: &str, jump: u32) -> String {
    HERO.replace("JUMP", &jump.to_string())
        + &format!(
            "
world W {{
    step 1/60
    collide body with wall: block
    tiles t 16 x 16 {{ '.': empty; '#': wall }}
    space main {{
        map t \"{map}        \"
        place hero: Hero at (16, 32)
    }}
    player 1: hero
    goal there: {goal}
}}"
        )
}

fn verdicts(text: &str) -> (bool, bool) {
    let program = program(compile_text(text));
    let space = configuration_space(&program, WorldId(0)).by_place(&program, WorldId(0), &[], &Unwatched);
    let space = space.by_flight(&program, WorldId(0), &[], &mut at_most(40_000), &Unwatched);
    of_first_goal(&program, &space)
}

/// Whether a space rules out the first goal, and whether a search finds a path to it.
pub fn of_first_goal(program: &Arc<Program>, space: &ConfigurationSpace) -> (bool, bool) {
    let is_ruled_out = !space.can_hold(program, WorldId(0), GoalId(0));
    let sim = Simulator::new(program, WorldId(0));
    let problem = Problem::new(&sim, GoalId(0));
    let limits = Limits { nodes: if is_ruled_out { 2_000 } else { 60_000 }, ..Limits::default() };
    let outcome = search(&problem, space, &Settings::default(), &limits, &Unwatched).unwrap();
    (is_ruled_out, matches!(outcome.verdict, Verdict::Reached(_)))
}

const WALL: &str = "
            ............
            ............
            ......#.....
            ......#.....
            ......#.....
            ......#.....
            ############
            ############
";
const PIT: &str = "
            ............
            ............
            ......#.....
            ......#.....
            ......#.....
            ......#.....
            ###..#######
            ###..#######
";

#[test]
fn a_wall_is_too_high() {
    for map in [WALL, PIT] {
        // A jump of 300 rises by 64 px minus half a step, one of 310 by more.
        for (jump, can) in [(100, false), (230, false), (250, false), (320, true)] {
            let (is_ruled_out, is_reached) = verdicts(&world(map, "hero.x > 120 and hero.y > 20", jump));
            assert_eq!((is_ruled_out, is_reached), (!can, can), "{jump} {map}");
        }
    }
}

/// Five heroes, each before a wall as high as their jump, slightly higher or slightly lower.
#[test]
fn walls_as_high_as_jumps() {
    for jump in [180, 220, 260, 300, 340] {
        let verdicts = |height: f64| {
            let top = 32.0 + height;
            let text = HERO.replace("JUMP", &jump.to_string())
                + &format!(
                    "
world W {{
    step 1/60
    collide body with wall: block
    space main {{
        rect wall (0, 0, 400, 32)
        rect wall (-16, 0, 16, 300)
        rect wall (400, 0, 16, 300)
        rect wall (160, 0, 48, {top})
        place hero: Hero at (16, 32)
    }}
    player 1: hero
    goal there: hero.x > 300
}}"
                );
            verdicts(&text)
        };
        let rise = f64::from(jump * jump) / 1400.0;
        assert_eq!(verdicts(rise + 6.0), (true, false), "{jump}: too high");
        assert_eq!(verdicts(rise - 6.0), (false, true), "{jump}: low enough");
    }
}

#[test]
fn a_ledge_is_too_high() {
    let map = "
            ............
            ............
            ............
            ........####
            ............
            ............
            ############
            ############
";
    for (jump, can) in [(200, false), (230, false), (320, true)] {
        let (is_ruled_out, is_reached) = verdicts(&world(map, "hero.x > 140 and hero.y > 76", jump));
        assert_eq!((is_ruled_out, is_reached), (!can, can), "{jump}");
    }
}

#[test]
fn a_gap_is_too_narrow() {
    let map = |gap: u32| {
        format!(
            "
world W {{
    step 1/60
    collide body with wall: block
    space main {{
        rect wall (0, 0, 192, 32)
        rect wall (96, {}, 16, 200)
        rect wall (-16, 0, 16, 300)
        rect wall (192, 0, 16, 300)
        place hero: Hero at (16, 32)
    }}
    player 1: hero
    goal there: hero.x > 120
}}",
            32 + gap
        )
    };
    for (gap, can) in [(3, false), (4, false), (15, true), (16, true)] {
        let text = HERO.replace("JUMP", "230") + &map(gap);
        let (is_ruled_out, is_reached) = verdicts(&text);
        assert_eq!((is_ruled_out, is_reached), (!can, can), "{gap}");
    }
}

/// A wall is looked up by place; it must not be listed in each of millions of tiles.
#[test]
fn a_wall_may_be_very_long() {
    let text = HERO.replace("JUMP", "230")
        + "
world W {
    step 1/60
    collide body with wall: block
    space main {
        rect wall (-50000000, 0, 100000000, 32)
        rect wall (160, 0, 48, 200)
        place hero: Hero at (16, 32)
    }
    player 1: hero
    goal there: hero.x > 300
}";
    let program = program(compile_text(&text));
    let space = configuration_space(&program, WorldId(0)).by_place(&program, WorldId(0), &[], &Unwatched);
    let places = |space: &ConfigurationSpace| space.slots.iter().next().unwrap().configurations.len();
    assert!(places(space.finest()) > places(&space), "it is told apart by place");
}

/// Two of a kind that differ only in where they begin do not see the same: one has another beside it, and can be stepped on.
#[test]
fn those_who_see_their_like_are_not_alike() {
    for side in [16, -16] {
        let text = format!(
            "entity Hero {{
    param speed = 60
    axis horizontal
    button jump
    collider body: rect(0, 0, 12, 12)
    collider feet: rect(0, 0, 12, 4) when in air
    clamp y' >= -240
    x' = speed * horizontal
    mode ground {{
        y' = -30
        when not touching(body, wall, below) -> air {{ y' := 0 }}
        when pressed(jump) -> air {{ y' := 240 }}
    }}
    initial mode air {{
        y'' = -900
        when touching(feet, head) -> air {{ y' := 600 }}
        when touching(body, wall, below) and y' <= 0 -> ground
    }}
}}
entity Critter {{
    collider box, seen: rect(0, 0, 16, 16)
    collider top, head: rect(0, 0, 16, 16) when in up
    y' = -30
    initial mode still {{ when touching(box at ({side}, 0), seen) -> up }}
    mode up {{ }}
}}
world W {{
    step 1/60
    collide body with wall: block
    collide box with wall: block
    collide feet with head: sense
    collide box with seen: sense
    tiles t 16 x 16 {{ '.': empty; '#': wall; 'E': spawn Critter }}
    space main {{
        map t \"
            ................
            ................
            ................
            ................
            ................
            ................
            ................
            ..........EE....
            ################
            ################
        \"
        place hero: Hero at (32, 40)
    }}
    player 1: hero
    goal there: hero.y > 130
}}"
        );
        assert_eq!(verdicts(&text), (false, true), "{side}");
    }
}

//! Reachable regions of players whose colliders alternate, that meet doors, or that move between rooms: closed chambers
//! stay closed. With an entrance, the search finds a path into them.

use hypedc::analysis::configuration_space;
use hypedc::ir::WorldId;

use super::by_place::of_first_goal;
use crate::support::{compile_text, program};

/// A hero that runs and flies, with a small or a big collider by a condition.
const HERO: &str = "entity Hero {
    param speed = 240
    axis horizontal, vertical
    button grow
    collider body: rect(1, 0, 14, 15) when in size.small
    collider body: rect(1, 0, 14, 30) when in size.big
    group movement {
        mode free {
            x' = speed * horizontal
            y' = speed * vertical
            FOLLOW
        }
    }
    group size {
        mode small { GROW }
        mode big { when released(grow) -> small }
    }
}";

fn verdicts(text: &str) -> (bool, bool) {
    let program = program(compile_text(text));
    of_first_goal(&program, &configuration_space(&program, WorldId(0)))
}

fn hero(grow: &str, follow: &str) -> String {
    HERO.replace("GROW", grow).replace("FOLLOW", follow)
}

/// A chamber of 32 px, with a wall of a tile's thickness on its right, or without that tile.
fn chamber(tile: char) -> String {
    format!(
        "
            ############
            #..........#
            #....#######
            #....#.....#
            #....{tile}.....#
            #....#.....#
            ############
"
    )
}

fn world(map: &str, goal: &str) -> String {
    format!(
        "
world W {{
    step 1/60
    collide body with wall: block
    tiles t 16 x 16 {{ '.': empty; '#': wall }}
    space main {{
        map t \"{map}        \"
        place hero: Hero at (32, 32)
    }}
    player 1: hero
    goal there: {goal}
}}"
    )
}

#[test]
fn a_collider_with_a_guard_is_kept_out() {
    for (tile, is_open) in [('#', false), ('.', true)] {
        let text = hero("", "") + &world(&chamber(tile), "hero.x > 100 and hero.y < 70");
        assert_eq!(verdicts(&text), (!is_open, is_open), "{tile}");
    }
}

/// A player that grows in the gap is pushed through the ceiling: the analysis has no verdict then.
#[test]
fn what_grows_inside_of_something_is_not_kept_out() {
    let text = hero("when pressed(grow) -> big", "") + &world(&chamber('#'), "hero.x > 100 and hero.y < 70");
    let (is_ruled_out, _) = verdicts(&text);
    assert!(!is_ruled_out, "the gap above the chamber is too low for who is big");
}

#[test]
fn a_door_that_stays_shut_keeps_one_out() {
    let door = |opens: &str| {
        format!(
            "
entity Door {{
    kinematic collider door: rect(0, 0, 16, 16) when in locked
    mode locked {{ {opens} }}
    mode open {{ }}
}}"
        )
    };
    let hero = hero("", "").replace("mode free {", "mode free { when touching(body, flag) { }");
    let with_door = |opens: &str| {
        let world = world(&chamber('.'), "hero.x > 100 and hero.y < 70");
        let world = world.replace("collide body with wall: block", "collide body with wall, door: block");
        hero.clone() + &door(opens) + &world.replace("player 1", "place door: Door at (80, 32) in main\n    player 1")
    };
    let placed = |text: String| {
        text.replace(
            "place hero: Hero at (32, 32)\n",
            "place hero: Hero at (32, 32)\n        place door: Door at (80, 32)\n",
        )
        .replace("place door: Door at (80, 32) in main\n", "")
    };
    for (opens, is_open) in [("", false), ("when touching(door, body) -> open", true)] {
        assert_eq!(verdicts(&placed(with_door(opens))), (!is_open, is_open), "{opens}");
    }
}

#[test]
fn from_room_to_room_chambers_stay_closed() {
    let rooms = |tile: char| {
        format!(
            "
world W {{
    step 1/60
    collide body with wall: block
    tiles t 16 x 16 {{ '.': empty; '#': wall }}
    space first {{
        map t \"
            ########
            #......#
            #.......
            #......#
            ########
        \"
        place hero: Hero at (32, 32)
        link rect(112, 32, 16, 16) -> second at rect(16, 32, 16, 16)
    }}
    space second {{
        map t \"{}        \"
    }}
    player 1: hero
    goal there: inside(hero, second) and hero.x > 100 and hero.y < 70
}}",
            chamber(tile)
        )
    };
    for (tile, is_open) in [('#', false), ('.', true)] {
        let text = hero("", "follow links") + &rooms(tile);
        assert_eq!(verdicts(&text), (!is_open, is_open), "{tile}");
    }
}

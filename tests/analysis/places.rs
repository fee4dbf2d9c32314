//! What probes prove on a grid: walls of tiles shut a player in although nothing collides, place by place; with one wall
//! less it is not shut in, and nothing is claimed.

use hypedc::analysis::configuration_space;
use hypedc::ir::WorldId;
use hypedc::watch::Unwatched;

use crate::support::{compile_text, program};

/// Whether a goal is ruled out, at once or with the player distinguished by place.
fn ruled_out(hero: &str, map: &str, more: &str, goal: &str) -> (bool, bool) {
    let text = format!(
        "entity Hero {{
            param cell: px = 16
            button right, left, up, down
            discrete dx: int -1..1 = 0
            axis horizontal
            collider body: rect(0, 0, 16, 16)
            {hero}
        }}
        entity Crate {{ collider crate: rect(0, 0, 16, 16) }}
        entity Door {{
            collider door: rect(0, 0, 16, 16) when in shut
            mode shut {{ }}
            mode open {{ when timer > 1s -> shut }}
        }}
        world W {{
            tiles t 16 x 16 {{ '.': empty; '#': wall }}
            space main {{
                map t \"{map}        \"
                place hero: Hero at (16, 16)
                {more}
            }}
            player 1: hero
            goal there: {goal}
        }}"
    );
    let program = program(compile_text(&text));
    let goal = program.worlds[WorldId(0)].goals.ids().next().unwrap();
    let space = configuration_space(&program, WorldId(0));
    let at_once = !space.can_hold(&program, WorldId(0), goal);
    let space = space.by_place(&program, WorldId(0), &[], &Unwatched);
    (at_once, !space.can_hold(&program, WorldId(0), goal))
}

const STEPS: &str = "mode walk {
    when pressed(right) and not touching(body at (16, 0), wall) { x += 16 }
    when pressed(left) and not touching(body at (-16, 0), wall) { x -= 16 }
    when pressed(up) and not touching(body at (0, 16), wall) { y += 16 }
    when pressed(down) and not touching(body at (0, -16), wall) { y -= 16 }
}";

/// One step at a time, so that no corner is cut.
const TURNS: &str = "mode walk {
    when pressed(right) and not touching(body at (16, 0), wall) -> rest { x += 16 }
    when pressed(left) and not touching(body at (-16, 0), wall) -> rest { x -= 16 }
    when pressed(up) and not touching(body at (0, 16), wall) -> rest { y += 16 }
    when pressed(down) and not touching(body at (0, -16), wall) -> rest { y -= 16 }
}
mode rest { when not (held(right) or held(left) or held(up) or held(down)) -> walk }";

const ROOM: &str = "
    ############
    #..........#
    #..........#
    ############
";

const MAZE: &str = "
    ############
    #....#.....#
    ####.#####.#
    #......#...#
    ############
";

#[test]
fn a_room_shuts_in() {
    for goal in ["hero.x < 15.9", "hero.x > 160.1", "hero.y < 15.9", "hero.y > 32.1"] {
        assert!(ruled_out(STEPS, ROOM, "", goal).1, "{goal}");
    }
    assert_eq!(ruled_out(STEPS, ROOM, "", "hero.x == 160 and hero.y == 32"), (false, false), "it can be there");
    let hole = ROOM.replace("#..........#\n    ####", "#...........\n    ####");
    assert_ne!(hole, ROOM);
    assert_eq!(ruled_out(STEPS, &hole, "", "hero.x > 176"), (false, false), "there is a hole");
    let blind = STEPS.replace("body at (16, 0), wall", "body at (16, 0), crate");
    assert_eq!(ruled_out(&blind, ROOM, "", "hero.x > 160"), (false, false), "it asks for something else");
}

#[test]
fn a_maze_shuts_in_by_place() {
    for goal in ["hero.x > 96", "hero.x == 96 and hero.y == 48", "hero.x == 48 and hero.y == 32"] {
        assert!(ruled_out(TURNS, MAZE, "", goal).1, "{goal}");
    }
    for goal in ["hero.x == 64 and hero.y == 48", "hero.x == 96"] {
        assert_eq!(ruled_out(TURNS, MAZE, "", goal), (false, false), "{goal}");
    }
    let hole = MAZE.replace("#......#...#", "#..........#");
    assert_eq!(ruled_out(TURNS, &hole, "", "hero.x == 128 and hero.y == 16"), (false, false), "there is a hole");
}

#[test]
fn an_offset_that_depends_on_values_is_known_by_them() {
    let hero = "mode still {
        when horizontal > 0 -> going { dx := 1 }
        when horizontal < 0 -> going { dx := -1 }
    }
    mode going {
        when not touching(body at (dx * cell, 0), wall) -> still { x += dx * cell }
        else -> still
    }";
    assert!(ruled_out(hero, ROOM, "", "hero.x > 160").1);
    assert!(ruled_out(hero, ROOM, "", "hero.x < 16").1);
    assert_eq!(ruled_out(hero, ROOM, "", "hero.x == 160"), (false, false));
}

#[test]
fn what_never_moves_is_sure_and_what_comes_and_goes_is_not() {
    let hero = "mode walk { when not touching(body at (16, 0), crate) and not touching(body at (16, 0), door)
        and not touching(body at (16, 0), wall) { x += 16 } }";
    assert_eq!(ruled_out(hero, ROOM, "place crate: Crate at (80, 16)", "hero.x > 64"), (true, true));
    assert_eq!(ruled_out(hero, ROOM, "place crate: Crate at (80, 32)", "hero.x > 64"), (false, false), "beside it");
    assert_eq!(ruled_out(hero, ROOM, "place crate: Crate at (80, 16)", "hero.x == 64"), (false, false));
    assert_eq!(ruled_out(hero, ROOM, "place door: Door at (80, 16)", "hero.x > 64"), (true, true), "it never opens");
    let opens = "place door: Door at (80, 16)\n place crate: Crate at (300, 300)";
    let hero = hero
        .replace("mode walk {", "ref door: Door\n mode walk { when touching(body at (64, 0), door) as d { destroy d }");
    assert_eq!(ruled_out(&hero, ROOM, opens, "hero.x > 64"), (false, false), "it can be gone");
}

//! Minimised random programs that once had a state outside of their space.

use hypedc::ir::WorldId;

use super::run::run;
use crate::support::{compile_text, program};

/// Asserts that no state of a random run is outside.
fn inside(text: &str) {
    let program = program(compile_text(text));
    let run = run(&program, WorldId(0), 300, 1);
    assert!(run.outside.is_empty() && run.states == 300, "{}", run.outside.join("\n"));
}

/// A stationary instance pushes one that begins inside of it, although neither moves.
#[test]
fn who_begins_inside_of_a_standing_thing_is_pushed_out() {
    inside(
        "entity Foe { collider foe: rect(0, 0, 16, 16) }
         entity Block { kinematic collider block: rect(0, 0, 48, 8) }
         world W {
             collide foe with block: block
             space main { place foe: Foe at (64, 64); place block: Block at (32, 64) }
         }",
    );
}

/// An update moves a stationary instance over another one, without a velocity.
#[test]
fn what_an_update_puts_somewhere_pushes() {
    inside(
        "entity Foe { collider foe: rect(0, 0, 16, 16) }
         entity Block {
             kinematic collider block: rect(0, 0, 48, 8)
             mode only { when timer >= 0.1 and x < 100 { x := x + 40 } }
         }
         world W {
             collide foe with block: block
             space main { place foe: Foe at (64, 64); place block: Block at (0, 64) }
         }",
    );
}

/// A link is followed from the position after the updates of that step.
#[test]
fn an_update_moves_what_goes_through_a_link() {
    inside(
        "entity Hero {
             mode only { follow links; when timer >= 0.1 { x := 200; y := -30 } }
         }
         world W {
             space main { place hero: Hero at (64, 64); link rect(32, 32, 150, 90) -> other at rect(20, 40, 60, 60) }
             space other { link rect(0, 0, 90, 90) -> main at rect(64, 64, 60, 40) }
         }",
    );
    inside(
        "entity Hero { mode only { follow links { x := 5 } } }
         world W {
             space main { place hero: Hero at (64, 64); link rect(32, 32, 150, 90) -> other at rect(20, 40, 60, 60) }
             space other { }
         }",
    );
}

/// A rider also moves by itself, so that it can end beside all places where it could stand on its carrier.
#[test]
fn who_is_carried_goes_by_itself_as_well() {
    inside(
        "entity Rider {
             param reach: px = 60
             continuous turn = 0
             collider rider: rect(0, 0, 16, 16)
             turn' = 40
             x = reach * sin(turn)
         }
         entity Lift {
             param reach: px = 30
             continuous turn = 0
             kinematic collider lift: rect(0, 0, 16, 16)
             turn' = 47
             x = reach * sin(turn)
         }
         world W {
             collide rider with lift: block, carry
             space main { place rider: Rider at (0, 16); place lift: Lift at (0, 0) }
         }",
    );
    inside(
        "entity Rider {
             collider rider: rect(0, 0, 16, 16)
             mode only { when timer >= 0.1 and x < 30 { x := 60 } when x > 30 { x := 0 } }
         }
         entity Lift {
             kinematic collider lift: rect(0, 0, 16, 16)
             mode right { x' = 200; when x >= 50 -> left }
             mode left { x' = -200; when x <= 0 -> right }
         }
         world W {
             collide rider with lift: block, carry
             space main { place rider: Rider at (0, 16); place lift: Lift at (0, 0) }
         }",
    );
}

/// Flows read other instances in the middle of a step, after updates and before flows.
#[test]
fn a_flow_reads_what_an_update_has_just_written() {
    inside(
        "entity Runner {
             mode run { x' = 60; when timer >= 0.1 -> run { x' := 150 } }
         }
         entity Watcher {
             ref whom: any
             continuous charge = 0
             mode only { charge' = if(whom is Runner, whom.x', 0) }
         }
         world W {
             space main {
                 place watcher: Watcher at (0, 0) { whom = runner }
                 place runner: Runner at (0, 0)
             }
         }",
    );
}

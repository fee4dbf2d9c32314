//! `start.x` and `start.y`: the place of an instance that is placed, made by a tile, or spawned.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::{compile_text, goals_after};
use hypedc::diagnostic::render;

/// The goals that hold after half a second in a world with these entities and items.
fn after(entities: &str, items: &str, goals: &str) -> Vec<String> {
    goals_after(
        &format!(
            "{entities} world W {{ step 1/60
 space main {{ {items} }}
 {goals} }}"
        ),
        "-*30",
    )
}

#[test]
fn it_stays_where_the_instance_was_placed() {
    let walker = "entity A {
        discrete far: int 0..9 = 0
        mode going { x' = 60; y' = -30; when x - start.x >= 10 and start.y - y >= 5 { far := 1 } }
    }";
    let goals = "goal seen: one.far == 1
 goal there: one.x > 70";
    assert_eq!(after(walker, "place one: A at (43, 7)", goals), ["seen", "there"]);
}

#[test]
fn defaults_initial_values_colliders_and_other_entities_read_it() {
    let entity = "entity A {
        param left = start.x - 5
        param middle = (left + start.x) / 2
        continuous height = start.y + 1
        discrete at: int 0..99 = 0
        collider body: rect(0, 0, 1 + start.x, 1)
        mode only { when left == 15 and middle == 17.5 { at := 3 } }
    }
    entity Wall { collider wall: rect(0, 0, 1, 1) }";
    let items = "place one: A at (20, 30)
    place wall: Wall at (40.5, 30)";
    let goals = "goal kept: one.at == 3
 goal high: one.height == 31
 goal other: one.middle == 17.5
        goal wide: one touching wall; collide body with wall: sense";
    assert_eq!(after(entity, items, goals), ["kept", "high", "other", "wide"]);
}

#[test]
fn each_life_of_a_slot_has_its_own() {
    // The second bullet takes the slot of the first, and begins where the gun is by then.
    let entities = "entity Gun {
        ref bullet: Bullet
        discrete shots: int 0..9 = 0
        mode only {
            x' = 60
            when bullet is none and shots == 0 { bullet := spawn Bullet(y = 9); shots += 1 }
            when bullet is none and shots == 1 { bullet := spawn Bullet(x = x + 100); shots += 1 }
        }
    }
    entity Bullet {
        continuous from_x = start.x
        continuous from_y = start.y
        mode flying { x' = 300; when timer >= 0.05 -> gone }
        mode gone { when timer >= 0 { destroy self } }
    }";
    // In the third step the first bullet flies, in the eighth the second.
    let goals = "goal first: any Bullet.from_x == 0 and any Bullet.from_y == 9
        goal second: any Bullet.from_x == 106 and any Bullet.from_y == 2";
    let text = format!(
        "{entities} world W {{ step 1/60
 limit Bullet 1
 space main {{ place gun: Gun at (0, 2) }}
 {goals} }}"
    );
    let seen: Vec<Vec<String>> = (1..12).map(|steps| goals_after(&text, &format!("-*{steps}"))).collect();
    let seen: Vec<&[String]> = seen.iter().map(Vec::as_slice).filter(|goals| !goals.is_empty()).collect();
    assert!(seen.iter().any(|goals| *goals == ["first"]), "{seen:?}");
    assert!(seen.iter().any(|goals| *goals == ["second"]), "{seen:?}");
}

#[test]
fn tiles_and_behaviours_have_it() {
    let entities = "behavior Stays { mode only { when start.x == 32 and start.y == 0 { at := 1 } } }
        entity A { discrete at: int 0..1 = 0; use Stays }
        entity B { discrete start: int 0..5 = 4; discrete at: int 0..9 = 0; mode only { when start == 4 { at := 1 } } }
        entity C { ref start: A; discrete at: int 0..1 = 0
            mode only { when start is A and start.x == 0 { at := 1 } } }";
    let items = "map t \"
..A
    \"
    place b: B at (0, 0)
    place a: A at (0, 0)
    place c: C at (3, 3) { start = a }";
    let goals = "tiles t 16 x 16 { '.': empty; 'A': spawn A }
        goal tile: any A.at == 1
 goal own: b.at == 1
 goal reference: c.at == 1";
    assert_eq!(after(entities, items, goals), ["tile", "own", "reference"]);
}

#[test]
fn it_cannot_be_written_or_have_primes() {
    let findings = |body: &str| {
        let text = format!(
            "entity A {{ {body} }} world W {{ step 1/60; space main {{ place a: A at (0, 0) }} goal g: a.x > 1 }}"
        );
        let compilation = compile_text(&text);
        render::short(&compilation.sources, compilation.diagnostics.iter())
    };
    insta::assert_snapshot!(
        [
            "mode m { when x > start.z -> m }",
            "mode m { when x > start.x' -> m }",
            "mode m { when x > start.x -> m { start.x := 4 } }",
            "mode m { when timer > start.x -> m }",
            "collider a: rect(0, 0, 16 + start.y', 16)",
        ]
        .map(findings)
        .join("\n")
    );
}

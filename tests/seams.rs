//! Spaces that wrap, step by step: walking over the seam, contacts and pushes across it, and spaces without an end.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;

use crate::support::{compile_text, count, program, run, slot};
use hypedc::ir::{Program, SlotId, VarId, WorldId};
use hypedc::sim::{Input, Simulator};

const WORLD: WorldId = WorldId(0);

/// A walker with gravity, `hero` at a place, in a space that wraps.
fn walking(space: &str, more: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity Hero {{
            param speed = 96
            axis horizontal
            collider body: rect(0, 0, 16, 16)
            discrete bumps: int 0..99 = 0
            x' = speed * horizontal
            y'' = -400
            always {{
                when touching(body, wall, left) or touching(body, wall, right) {{ bumps := min(bumps + 1, 99) }}
            }}
        }}
        entity Crate {{ collider crate: rect(0, 0, 16, 16) }}
        entity Lift {{ param speed = 60; kinematic collider lift: rect(0, 0, 32, 8); x' = speed }}
        entity Shot {{ param speed = 240; collider shot: circle(2, 2, 2); x' = speed; y' = speed / 2 }}
        {more}
        world W {{
            step 1/60
            collide body, crate, shot with wall: block
            collide body with lift: block, carry
            collide body with crate, shot: block
            tiles t 16 x 16 {{ '.': empty; '#': wall }}
            space main {{
                {space}
            }}
            player 1: hero
        }}"
    )))
}

#[test]
fn a_floor_goes_on_across_the_seam() {
    // Of tiles, of one rectangle as long as the space, of one that lies on the seam, of short ones that touch there.
    for floor in [
        "map t \"\n.....\n.....\n#####\n\"",
        "bounds rect(0, 0, 80, 48)\nrect wall (0, 0, 80, 16)",
        "bounds rect(0, 0, 80, 48)\nrect wall (-16, 0, 48, 16)\nrect wall (32, 0, 32, 16)",
        "bounds rect(0, 0, 80, 48)\nrect wall (0, 0, 30, 16)\nrect wall (30, 0, 50, 16)",
    ] {
        let program = walking(&format!("{floor}\nwrap horizontal\nplace hero: Hero at (24, 16)"), "");
        let hero = slot(&program, "hero");
        for inputs in ["right*400", "left*400"] {
            let mut crossed = 0;
            let mut last = 24.0;
            let (_, state) = run(&program, inputs, |sim, state| {
                let (x, y) = sim.position(state, hero);
                assert_eq!(y, 16.0, "{floor}: at {x}");
                assert!((0.0..80.0).contains(&x), "{floor}: {x}");
                crossed += usize::from((x - last).abs() > 40.0);
                last = x;
            });
            assert_eq!((crossed, count(&program, &state, "bumps")), (8, 0), "{floor} {inputs}");
        }
    }
}

#[test]
fn a_wall_behind_the_seam_blocks() {
    for wall in [
        "map t \"\n#....\n#....\n#####\n\"",
        "bounds rect(0, 0, 80, 48)\nrect wall (0, 0, 80, 16)\nrect wall (0, 16, 16, 32)",
        "bounds rect(0, 0, 80, 48)\nrect wall (0, 0, 80, 16)\nrect wall (80, 16, 16, 32)",
    ] {
        let program = walking(&format!("{wall}\nwrap horizontal\nplace hero: Hero at (32, 16)"), "");
        let hero = slot(&program, "hero");
        let (sim, state) = run(&program, "right*120", |_, _| {});
        assert_eq!(sim.position(&state, hero), (64.0, 16.0), "{wall}");
        assert!(count(&program, &state, "bumps") > 0, "{wall}");
        let (sim, state) = run(&program, "left*120", |_, _| {});
        assert_eq!(sim.position(&state, hero), (16.0, 16.0), "{wall}");
    }
}

#[test]
fn instances_meet_and_push_across_the_seam() {
    let floor = "bounds rect(0, 0, 160, 48)\nrect wall (0, 0, 160, 16)\nwrap horizontal";
    // The hero stands over the seam and pushes the crate at the other end to the right.
    let program = walking(&format!("{floor}\nplace hero: Hero at (120, 16)\nplace crate: Crate at (4, 16)"), "");
    let (hero, crate_) = (slot(&program, "hero"), slot(&program, "crate"));
    let mut met = 0;
    run(&program, "right*30", |sim, state| {
        let ((x, _), (c, _)) = (sim.position(state, hero), sim.position(state, crate_));
        let apart = (c - x).rem_euclid(160.0);
        assert!(apart > 15.1, "{x} {c}");
        met += usize::from(apart < 16.9);
    });
    assert!(met > 5, "{met}");
    // And to the left, the other way around.
    let program = walking(&format!("{floor}\nplace hero: Hero at (8, 16)\nplace crate: Crate at (150, 16)"), "");
    let (sim, state) = run(&program, "left*30", |_, _| {});
    let (x, _) = sim.position(&state, slot(&program, "crate"));
    assert!(x < 145.0, "{x}");
}

#[test]
fn many_instances_meet_across_both_seams_as_in_the_middle() {
    // The same crowd in the middle of the space and over its corner has the same contacts.
    let crowd = |x: f64, y: f64| {
        let mut places = String::from("bounds rect(0, 0, 400, 400)\nwrap horizontal\nwrap vertical\n");
        for at in 0..90 {
            let (column, row) = (f64::from(at % 10), f64::from(at / 10));
            places += &format!("place c{at}: Crate at ({}, {})\n", x + 13.5 * column, y + 14.25 * row);
        }
        places += &format!("place hero: Hero at ({}, {})", x + 60.5, y + 60.5);
        let text = walking(&places, "");
        let world = &text.worlds[WORLD];
        assert_eq!(world.slots.len(), 91);
        text
    };
    let positions = |program: &Arc<Program>, from: (f64, f64)| {
        let (sim, state) = run(program, "right*4", |_, _| {});
        let around = |at: f64, from: f64| ((at - from + 100.0).rem_euclid(400.0) * 1e6).round();
        let at = |slot| {
            let (x, y) = sim.position(&state, slot);
            (around(x, from.0), around(y, from.1))
        };
        program.worlds[WORLD].slots.ids().map(at).collect::<Vec<_>>()
    };
    let middle = positions(&crowd(100.0, 100.0), (100.0, 100.0));
    for from in [(340.0, 100.0), (100.0, 340.0), (340.0, 350.0), (399.0, 399.0)] {
        assert_eq!(positions(&crowd(from.0, from.1), from), middle, "{from:?}");
    }
}

#[test]
fn a_lift_carries_its_rider_across_the_seam() {
    let program = walking(
        "bounds rect(0, 0, 160, 96)\nwrap horizontal\nplace hero: Hero at (120, 40)\nplace lift: Lift at (112, 32)",
        "",
    );
    let (hero, lift) = (slot(&program, "hero"), slot(&program, "lift"));
    let mut crossed = false;
    run(&program, "-*200", |sim, state| {
        let ((x, y), (l, _)) = (sim.position(state, hero), sim.position(state, lift));
        crossed |= x < l;
        assert!(((x - l).rem_euclid(160.0) - 8.0).abs() < 1e-9 && y == 40.0, "{x} {y} {l}");
    });
    assert!(crossed);
}

#[test]
fn a_void_has_no_end() {
    let program = walking(
        "bounds rect(-20, -10, 100, 64)\nwrap horizontal\nwrap vertical\nplace hero: Hero at (0, 0)
         place shot: Shot at (50, 10)",
        "",
    );
    let (hero, shot) = (slot(&program, "hero"), slot(&program, "shot"));
    let mut crossed = [0; 2];
    let mut last = (50.0, 10.0);
    run(&program, "-*240", |sim, state| {
        assert_eq!(sim.left_bounds(state), None);
        for slot in [hero, shot] {
            let (x, y) = sim.position(state, slot);
            assert!((-20.0..80.0).contains(&x) && (-10.0..54.0).contains(&y), "{x} {y}");
        }
        let at = sim.position(state, shot);
        crossed[0] += usize::from((at.0 - last.0).abs() > 50.0);
        crossed[1] += usize::from((at.1 - last.1).abs() > 32.0);
        last = at;
    });
    assert!(crossed[0] >= 9 && crossed[1] >= 7, "{crossed:?}");
}

#[test]
fn what_begins_beyond_a_border_is_brought_in() {
    let program = walking("bounds rect(0, 0, 80, 48)\nwrap horizontal\nplace hero: Hero at (-8, 16)", "");
    let sim = Simulator::new(&program, WORLD);
    let state = sim.initial(&mut sim.scratch()).unwrap();
    assert_eq!(sim.position(&state, slot(&program, "hero")), (72.0, 16.0));
}

#[test]
fn a_world_that_wraps_allocates_nothing_more_and_is_read_back() {
    let program = walking("bounds rect(0, 0, 80, 48)\nwrap vertical\nplace hero: Hero at (8, 16)", "");
    let [across, up] = program.worlds[WORLD].spaces.iter().next().unwrap().periods;
    assert_eq!((across, up.map(|up| (up.low, up.high))), (None, Some((0.0, 48.0))));
    let (sim, mut state) = run(&program, "-*60", |_, _| {});
    let before = state.clone();
    let mut scratch = sim.scratch();
    sim.step(&mut state, &Input::default(), &mut scratch).unwrap();
    let layout = &program.worlds[WORLD].layout.slots[SlotId(0)];
    assert!(layout.var(&state, VarId::Y, 1) < layout.var(&before, VarId::Y, 1), "it falls for ever");
}

//! Slopes, step by step: walking over any terrain, jumping off, walls beside slopes, ceilings, one-way slopes, sensors.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::sync::Arc;

use proptest::prelude::*;

use crate::support::{compile_text, count, goals_after, program, run, script, slot};
use hypedc::ir::{Program, VarId, WorldId};
use hypedc::sim::Simulator;

const WORLD: WorldId = WorldId(0);

/// The kinds of tiles: a character for each pair of heights in quarters of a tile.
fn symbol(left: i32, right: i32) -> char {
    match (left, right) {
        (0, 0) => '.',
        (4, 4) => '#',
        _ => char::from(b'A' + (5 * left + right) as u8),
    }
}

fn tile_set(more: &str) -> String {
    let mut out = String::from("tiles t 16 x 16 { '.': empty; '#': wall\n");
    for (left, right) in (0..5).flat_map(|left| (0..5).map(move |right| (left, right))) {
        if (left, right) != (0, 0) && (left, right) != (4, 4) {
            writeln!(out, "'{}': wall slope (0, {})-(16, {}){more}", symbol(left, right), 4 * left, 4 * right).unwrap();
        }
    }
    out + "}\n"
}

/// A walker with gravity, `hero` at a place; `lost` counts the steps without ground, `bumps` those against a side.
fn walking(body: &str, (speed, gravity): (f64, f64), steps: i32, world: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity Hero {{
            param speed = {speed}
            param jump_speed = 160
            axis horizontal
            button jump
            collider body: {body}
            discrete lost: int 0..9999 = 0
            discrete bumps: int 0..9999 = 0
            x' = speed * horizontal
            y'' = {gravity}
            always {{
                when not touching(body, wall, below) {{ lost := min(lost + 1, 9999) }}
            }}
            always {{
                when touching(body, wall, left) or touching(body, wall, right) {{ bumps := min(bumps + 1, 9999) }}
            }}
            always {{
                when pressed(jump) and touching(body, wall, below) {{ y' := jump_speed }}
            }}
        }}
        world W {{
            step 1/{steps}
            {world}
            player 1: hero
        }}"
    )))
}

/// A terrain by the heights of the sides of its columns, in quarters of a tile.
#[derive(Debug, Clone)]
struct Terrain(Vec<i32>);

impl Terrain {
    /// From choices: how the next column goes on.
    fn new(choices: &[i32]) -> Terrain {
        let mut heights = vec![12];
        for choice in choices {
            let from: i32 = *heights.last().unwrap();
            // The columns of a row reach from one of its lines to the next.
            let low = match from.rem_euclid(4) {
                0 if *choice < 0 => from - 4,
                other => from - other,
            };
            let to = if *choice == 0 { from } else { low + choice.rem_euclid(5) };
            heights.push(to.clamp(4, 24).clamp(low.max(4), (low + 4).min(24)));
        }
        Terrain(heights)
    }

    fn map(&self) -> String {
        let mut out = String::from("map t \"\n");
        for row in (0..9).rev() {
            for pair in self.0.windows(2) {
                let within = |height: i32| (height - 4 * row).clamp(0, 4);
                out.push(symbol(within(pair[0]), within(pair[1])));
            }
            out.push('\n');
        }
        out + "\"\n"
    }

    /// The highest point over an interval, px.
    fn top(&self, left: f64, right: f64) -> f64 {
        let at = |x: f64| {
            let column = ((x / 16.0).floor().max(0.0) as usize).min(self.0.len() - 2);
            let (from, to) = (f64::from(4 * self.0[column]), f64::from(4 * self.0[column + 1]));
            from + (to - from) * ((x - 16.0 * column as f64) / 16.0)
        };
        let inside = (0..self.0.len()).map(|side| 16.0 * side as f64).filter(|x| left < *x && *x < right);
        inside.chain([left, right]).map(at).fold(f64::NEG_INFINITY, f64::max)
    }
}

fn terrain() -> impl Strategy<Value = Terrain> {
    prop::collection::vec(-5..6i32, 30).prop_map(|choices| Terrain::new(&choices))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn a_walker_follows_any_terrain(
        terrain in terrain(),
        (width, height) in (3..30i32, 6..30i32),
        speed in 10..240i32,
        gravity in prop_oneof![Just(0), Just(-400), -1200..0i32],
        steps in 30..240i32,
        kind in prop_oneof![2 => Just("block"), 1 => Just("block from above")],
        from in 100..300i32,
    ) {
        let (width, height) = (f64::from(width) + 0.5, f64::from(height));
        let (x, far) = (f64::from(from), f64::from(speed) / f64::from(steps));
        // What goes over the whole of a slope's end in one step is not above what it comes to.
        prop_assume!(kind == "block" || far <= width);
        let y = terrain.top(x, x + width);
        let world = format!(
            "collide body with wall: {kind}\n{}space main {{ {} place hero: Hero at ({x}, {y}) }}",
            tile_set(""),
            terrain.map(),
        );
        let body = format!("rect(0, 0, {width}, {height})");
        let program = walking(&body, (f64::from(speed), f64::from(gravity)), steps, &world);
        let hero = slot(&program, "hero");
        for (inputs, way) in [("right", far), ("left", -far)] {
            let room = if way > 0.0 { 480.0 - width - x } else { x };
            let count_steps = ((room / far) as i32 - 2).clamp(1, 400);
            let mut expected = x;
            let (_, state) = run(&program, &format!("{inputs}*{count_steps}"), |sim, state| {
                expected += way;
                let (x, y) = sim.position(state, hero);
                assert!((x - expected).abs() < 1e-6, "{x} is not {expected}");
                let top = terrain.top(x, x + width);
                assert!((y - top).abs() < 1e-6, "at {x}: {y}, not {top}");
                assert!(program.worlds[WORLD].layout.slots[hero].var(state, VarId::Y, 1) <= 0.0);
            });
            assert_eq!((count(&program, &state, "lost"), count(&program, &state, "bumps")), (0, 0));
        }
    }

    #[test]
    fn what_falls_on_any_terrain_comes_to_rest_on_it(
        terrain in terrain(),
        from in 80..380i32,
        (width, speed) in (3..30i32, -200..200i32),
    ) {
        let width = f64::from(width) + 0.25;
        let world = format!(
            "collide body with wall: block\n{}space main {{ {} place hero: Hero at ({from}, 120) }}",
            tile_set(" breakable"),
            terrain.map(),
        );
        let program = walking(&format!("rect(0, 0, {width}, 12)"), (f64::from(speed), -400.0), 60, &world);
        let hero = slot(&program, "hero");
        let (sim, state) = run(&program, "right*20 -*120", |sim, state| {
            let (x, y) = sim.position(state, hero);
            assert!(y >= terrain.top(x, x + width) - 1e-6, "{x} {y}");
        });
        let (x, y) = sim.position(&state, hero);
        assert!((y - terrain.top(x, x + width)).abs() < 1e-6);
        assert_eq!(count(&program, &state, "bumps"), 0);
    }
}

/// A hill 16 px high with a peak one tile wide, and what else a map has; the hero is `(x, y)`.
fn hill(collide: &str, map: &str, place: &str) -> Arc<Program> {
    let tiles = "tiles t 16 x 16 { '.': empty; '#': wall
        '/': wall slope (0, 0)-(16, 16)
        'L': wall slope (0, 16)-(16, 0)
        'h': wall slope (0, 8)-(16, 8)
        'c': cloud slope (0, 0)-(16, 16)
        's': spike slope (0, 0)-(16, 16)
        'b': wall, brick slope (0, 16)-(16, 0) breakable }";
    walking("rect(0, 0, 16, 16)", (96.0, -400.0), 60, &format!("{collide}\n{tiles}\nspace main {{ {map}\n{place} }}"))
}

const BLOCK: &str = "collide body with wall: block";

#[test]
fn a_jump_leaves_a_slope_at_once() {
    let map = "map t \"\n............\n../#L.......\n############\n\"";
    // Up the slope, down it, and standing on it.
    for (inputs, from, y) in
        [("right", 20.0, 20.0), ("left", 36.0, 32.0), ("right", 66.0, 30.0), ("left", 70.0, 26.0), ("-", 20.0, 20.0)]
    {
        let program = hill(BLOCK, map, &format!("place hero: Hero at ({from}, {y})"));
        let hero = slot(&program, "hero");
        let mut last = None;
        run(&program, &format!("{inputs}*4 {inputs}+jump*8").replace("-+jump", "jump"), |sim, state| {
            let (_, y) = sim.position(state, hero);
            let speed = program.worlds[WORLD].layout.slots[hero].var(state, VarId::Y, 1);
            if let Some((step, start)) = last {
                let way = 160.0 - 400.0 * f64::from(step) / 60.0;
                assert!((speed - way).abs() < 1e-9, "{inputs} {from}: {speed}, not {way}");
                assert!(y > start, "{inputs} {from}: {y}");
                last = Some((step + 1, y));
            } else if speed > 0.0 {
                last = Some((2, y));
            }
        });
        assert!(last.is_some(), "{inputs} {from}: it never jumps");
    }
}

#[test]
fn sides_of_slopes_are_walls() {
    // From the high end, from underneath, against a wall that the slope leads down to, against a slab.
    let from_right = hill(BLOCK, "map t \"\n........\n../.....\n########\n\"", "place hero: Hero at (64, 16)");
    let (sim, state) = run(&from_right, "left*60", |_, _| {});
    assert_eq!(sim.position(&state, slot(&from_right, "hero")), (48.0, 16.0));
    assert!(count(&from_right, &state, "bumps") > 0);

    let under = hill(BLOCK, "map t \"\n../.....\n........\n########\n\"", "place hero: Hero at (32, 16)");
    let (sim, state) = run(&under, "jump*2", |_, _| {});
    assert_eq!(sim.position(&state, slot(&under, "hero")), (32.0, 16.0));

    let valley = hill(BLOCK, "map t \"\n.....#..\n..#L.#..\n########\n\"", "place hero: Hero at (32, 32)");
    let hero = slot(&valley, "hero");
    run(&valley, "right*90", |sim, state| {
        let (x, y) = sim.position(state, hero);
        let top = if x < 48.0 { 32.0 } else { (32.0 - (x - 48.0)).max(16.0) };
        assert!((y - top).abs() < 1e-9 && x <= 64.0, "{x} {y}");
    });

    // The wall leaves no room for the whole body beside the slope: it rests where it is stopped.
    let narrow = hill(BLOCK, "map t \"\n....#...\n..#L#...\n########\n\"", "place hero: Hero at (30, 32)");
    let hero = slot(&narrow, "hero");
    let (sim, state) = run(&narrow, "right*90", |_, _| {});
    assert_eq!(sim.position(&state, hero), (48.0, 32.0));

    let slab = hill(BLOCK, "map t \"\n........\n....h...\n########\n\"", "place hero: Hero at (16, 16)");
    let (sim, state) = run(&slab, "right*60", |_, _| {});
    assert_eq!(sim.position(&state, slot(&slab, "hero")), (48.0, 16.0));
}

#[test]
fn a_slope_does_not_lift_into_a_ceiling() {
    for ceiling in ["......####", "....../###", "#########."] {
        let map = format!("map t \"\n..........\n{ceiling}\n..........\n...../#...\n##########\n\"");
        let program = hill(BLOCK, &map, "place hero: Hero at (48, 16)");
        let hero = slot(&program, "hero");
        let mut best = 0.0_f64;
        let (sim, state) = run(&program, "right*120", |sim, state| {
            let (x, y) = sim.position(state, hero);
            assert!(y <= 32.0 + 1e-9, "{ceiling}: {x} {y}");
            best = best.max(x);
        });
        // There is just enough room on top.
        assert!(sim.position(&state, hero).0 > 96.0, "{ceiling}: {best}");
    }
    let program = hill(
        BLOCK,
        "map t \"\n..........\n......####\n.....h/##.\n...../####\n##########\n\"",
        "place hero: Hero at (48, 16)",
    );
    let hero = slot(&program, "hero");
    let (sim, state) = run(&program, "right*120", |sim, state| {
        let (x, y) = sim.position(state, hero);
        assert!(y <= 32.0 + 1e-9 && x < 90.0, "{x} {y}");
    });
    let (x, _) = sim.position(&state, hero);
    let (sim, state) = run(&program, "right*120 left*60", |_, _| {});
    assert!(sim.position(&state, hero).0 < x - 20.0, "it is stuck");
}

#[test]
fn a_slope_from_above_only() {
    let map = "map t \"\n........\n........\n..c.....\n........\n########\n\"";
    let collide = "collide body with wall: block\ncollide body with cloud: block from above";
    // Through it from below, then onto it.
    let program = hill(collide, map, "place hero: Hero at (32, 16)");
    let hero = slot(&program, "hero");
    let mut highest = 0.0_f64;
    run(&program, "jump*40 -*40", |sim, state| highest = highest.max(sim.position(state, hero).1));
    assert!(highest > 40.0, "{highest}");
    let falling = hill(collide, map, "place hero: Hero at (28, 70)");
    let (sim, state) = run(&falling, "-*90", |_, _| {});
    let (x, y) = sim.position(&state, slot(&falling, "hero"));
    assert!((y - (32.0 + (x + 16.0 - 32.0))).abs() < 1e-9, "{x} {y}");
}

#[test]
fn sensors_and_probes_end_at_the_line() {
    let text = |shape: &str, x: f64, y: f64| {
        program(compile_text(&format!(
            "entity Hero {{
                collider body: {shape}
                discrete met: int 0..1 = 0
                discrete taken: int 0..1 = 0
                always {{ when touching(body, spike) {{ met := 1 }} }}
                always {{ when touching(body at (0, 0), spike) {{ taken := 1 }} }}
            }}
            world W {{
                step 1/60
                collide body with spike: sense
                tiles t 16 x 16 {{ '.': empty; 's': spike slope (0, 0)-(16, 16) }}
                space main {{
                    map t \"\n.s.\n\"
                    place hero: Hero at ({x}, {y})
                }}
                player 1: hero
            }}"
        )))
    };
    let found = |shape: &str, x: f64, y: f64| {
        let program = text(shape, x, y);
        let (_, state) = run(&program, "-*1", |_, _| {});
        (count(&program, &state, "met") == 1, count(&program, &state, "taken") == 1)
    };
    let rect = "rect(0, 0, 4, 4)";
    assert_eq!(found(rect, 16.0, 5.0), (false, false));
    assert_eq!(found(rect, 16.0, 4.0), (true, false), "it touches the line");
    assert_eq!(found(rect, 16.0, 3.9), (true, true));
    assert_eq!(found(rect, 32.0, 3.9), (true, false), "beside the high end");
    // The corner of the square around the disc is below the line, the disc is not.
    let disc = "circle(0, 0, 4)";
    assert_eq!(found(disc, 22.0, 12.0), (false, false));
    assert_eq!(found(disc, 22.0, 11.0), (true, true));
    assert_eq!(found(disc, 24.0, 3.0), (true, true), "inside");
}

#[test]
fn slopes_go_on_across_a_seam() {
    // A peak at the seam, and a plateau over it.
    for (row, heights) in [("L...../", [1, 0, 0, 0, 0, 0, 0, 1]), ("#L.../#", [1, 1, 0, 0, 0, 0, 1, 1])] {
        let map = format!("wrap horizontal\nmap t \"\n.......\n{row}\n#######\n\"");
        let program = hill(BLOCK, &map, "place hero: Hero at (40, 16)");
        let hero = slot(&program, "hero");
        let at = |x: f64| {
            let column = (x.rem_euclid(112.0) / 16.0).floor();
            let (from, to) = (heights[column as usize], heights[column as usize + 1]);
            16.0 + 16.0 * f64::from(from) + f64::from(to - from) * (x.rem_euclid(112.0) - 16.0 * column)
        };
        for inputs in ["right*300", "left*300"] {
            let (mut crossed, mut last) = (0, 40.0);
            let (_, state) = run(&program, inputs, |sim, state| {
                let (x, y) = sim.position(state, hero);
                let sides = (0..16).map(|side| 16.0 * f64::from(side)).filter(|side| x < *side && *side < x + 16.0);
                let top = sides.chain([x, x + 16.0 - 1e-9]).map(at).fold(0.0, f64::max);
                assert!((y - top).abs() < 1e-6, "{row} {inputs}: {y} at {x}, not {top}");
                crossed += usize::from((x - last).abs() > 60.0);
                last = x;
            });
            assert_eq!((count(&program, &state, "lost"), count(&program, &state, "bumps")), (0, 0), "{row} {inputs}");
            assert!(crossed >= 4, "{row} {inputs}: {crossed}");
        }
    }
}

#[test]
fn a_slope_that_breaks_is_gone() {
    let program = program(compile_text(
        "entity Hero {
            button dig
            collider body: rect(0, 0, 16, 16)
            y'' = -400
            always { when pressed(dig) and touching(body, brick, below) as b { destroy b } }
        }
        world W {
            step 1/60
            collide body with wall: block
            tiles t 16 x 16 { '.': empty; '#': wall; 'b': wall, brick slope (0, 16)-(16, 0) breakable }
            space main {
                map t \"\n....\n.b..\n####\n\"
                place hero: Hero at (20, 32)
            }
            player 1: hero
        }",
    ));
    let hero = slot(&program, "hero");
    let (sim, state) = run(&program, "-*20", |_, _| {});
    assert_eq!(sim.position(&state, hero), (20.0, 28.0));
    let (sim, state) = run(&program, "-*20 dig -*30", |_, _| {});
    assert_eq!((sim.position(&state, hero), sim.broken_tiles(&state).len()), ((20.0, 16.0), 1));
}

#[test]
fn a_step_over_slopes_allocates_nothing() {
    let program = hill(BLOCK, "map t \"\n........\n../#L...\n########\n\"", "place hero: Hero at (16, 16)");
    let sim = Simulator::new(&program, WORLD);
    let (mut scratch, inputs) = (sim.scratch(), script(&program, "right*60"));
    let mut state = sim.initial(&mut scratch).unwrap();
    let inputs: Vec<_> = inputs.inputs().cloned().collect();
    let info = allocation_counter::measure(|| {
        for input in &inputs {
            sim.step(&mut state, input, &mut scratch).unwrap();
        }
    });
    assert_eq!(info.count_total, 0);
}

#[test]
fn many_instances_that_rest_on_slopes_touch_them() {
    let place =
        |at: usize| format!("place p{at}: Plate at ({}, {})", 16 * at + 4, if at.is_multiple_of(2) { 6 } else { 20 });
    let plates: Vec<String> = (0..20).map(place).collect();
    let text = format!(
        "entity Plate {{
             collider plate: rect(0, 0, 4, 4)
             collider base: rect(0, 0, 4, 4)
             mode dark {{ when touching(plate, ground) -> lit }}
             mode lit {{ }}
         }}
         entity Ball {{ collider ball: rect(0, 0, 4, 4); mode rolling {{ x' = 60; y'' = -400 }} }}
         world W {{
             step 1/60
             collide plate with ground: sense
             collide ball with ground: block
             tiles t 16 x 16 {{ '.': empty; '/': ground slope (0, 0)-(16, 16) }}
             space main {{
                 map t \"
                     ....................
                     ////////////////////
                 \"
                 place ball: Ball at (0, 32)
                 {}
             }}
             goal low: p0 in lit and p18 in lit
             goal high: p1 in lit or p19 in lit
             goal rests: ball.y > -1 and ball.y < 20
         }}",
        plates.join("\n")
    );
    assert_eq!(goals_after(&text, "-*30"), ["low", "rests"]);
}

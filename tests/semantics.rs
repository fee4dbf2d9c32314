//! The meaning of programs, rule by rule: small worlds whose next states are known by hand.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::{compile_text, goals_after, program, script};
use hypedc::ir::{Program, SlotId, VarId, WorldId};
use hypedc::sim::{Input, Scratch, Simulator, State};
use std::sync::Arc;

/// A run of the first world of a program.
struct Run<'p> {
    program: &'p Program,
    sim: Simulator,
    scratch: Scratch,
    state: State,
}

impl<'p> Run<'p> {
    fn new(program: &'p Arc<Program>) -> Self {
        let sim = Simulator::new(program, WorldId(0));
        let mut scratch = sim.scratch();
        let state = sim.initial(&mut scratch).unwrap();
        Run { program, sim, scratch, state }
    }

    fn step(&mut self, inputs: &str) {
        for input in script(self.program, inputs).inputs() {
            self.sim.step(&mut self.state, input, &mut self.scratch).unwrap();
        }
    }

    fn slot(&self, name: &str) -> SlotId {
        self.program.worlds[WorldId(0)].slots.find(|s| s.name == name).unwrap()
    }

    /// `x`, `y'` … of an instance.
    fn var(&self, slot: &str, variable: &str) -> f64 {
        let name = variable.trim_end_matches('\'');
        let degree = (variable.len() - name.len()) as u8;
        let slot = self.slot(slot);
        let world = &self.program.worlds[WorldId(0)];
        let entity = &self.program.entities[world.slots[slot].entity];
        let var: VarId = entity.vars.find(|v| **v == *name).unwrap();
        world.layout.slots[slot].var(&self.state, var, degree)
    }

    fn discrete(&self, slot: &str, name: &str) -> i32 {
        let slot = self.slot(slot);
        let world = &self.program.worlds[WorldId(0)];
        let entity = &self.program.entities[world.slots[slot].entity];
        world.layout.slots[slot].discrete(&self.state, entity.discretes.find(|d| d.name == name).unwrap())
    }

    /// The active innermost modes, one for each group.
    fn modes(&self, slot: &str) -> Vec<&str> {
        let slot = self.slot(slot);
        let world = &self.program.worlds[WorldId(0)];
        let entity = &self.program.entities[world.slots[slot].entity];
        let leaf = |group| world.layout.slots[slot].leaf(&self.state, group);
        entity.groups.ids().map(|g| entity.modes[entity.leaves[leaf(g)].mode].path.as_str()).collect()
    }
}

/// One entity, placed once as `a` under player 1, in a world without a map.
fn alone(entity: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity A {{ {entity} }}
         world W {{ step 1/10; space main {{ place a: A at (0, 0) }} player 1: a }}"
    )))
}

#[test]
fn the_outermost_edge_wins_and_then_source_order() {
    let p = alone(
        "button go
         mode outer {
             when held(go) -> second
             when held(go) -> first
             mode inner { when held(go) -> other }
             mode other { }
         }
         mode first { }
         mode second { }",
    );
    let mut run = Run::new(&p);
    assert_eq!(run.modes("a"), ["outer.inner"]);
    run.step("-");
    assert_eq!(run.modes("a"), ["outer.inner"]);
    run.step("go");
    assert_eq!(run.modes("a"), ["second"]);
}

#[test]
fn updates_read_the_state_before_and_the_last_one_wins() {
    let p = alone(
        "discrete n: int 0..99 = 1
         discrete m: int 0..99 = 10
         mode a {
             when n < 50 { n := m; m := n }
             mode b {
                 when n == 10 -> c { n := n + 5 }
             }
             mode c {
                 m := 77
                 when n == 15 -> d { m := m + 1 }
                 mode d { n := 40; when n == 40 { n := 41 } }
             }
         }",
    );
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.discrete("a", "n"), run.discrete("a", "m")), (10, 1), "values are exchanged");
    // The edge to c: internal first (n 1, m 10), entries of c (m 77) and d (n 40), then its own (n 15).
    run.step("-");
    assert_eq!((run.discrete("a", "n"), run.discrete("a", "m")), (15, 77));
    assert_eq!(run.modes("a"), ["a.c.d"]);
    // c stays active: only d is left and entered again.
    run.step("-");
    assert_eq!((run.discrete("a", "n"), run.discrete("a", "m")), (40, 78));
    // Without a target nothing is entered.
    run.step("-");
    assert_eq!((run.discrete("a", "n"), run.discrete("a", "m")), (41, 40));
}

#[test]
fn timers_count_steps_and_start_anew_when_a_mode_is_entered() {
    let p = alone(
        "button back
         mode a {
             mode b { when timer >= 0.3 -> c }
             mode c { when held(back) -> b; when timer >= 2frames -> c { x := x + 1 } }
             when timer(a) >= 10 -> a
         }",
    );
    let mut run = Run::new(&p);
    run.step("-*3");
    assert_eq!(run.modes("a"), ["a.b"]);
    run.step("-");
    assert_eq!(run.modes("a"), ["a.c"]);
    run.step("-*2");
    assert_eq!(run.var("a", "x"), 1.0, "two steps after it was entered");
    run.step("-*2");
    assert_eq!(run.var("a", "x"), 2.0, "a self-edge starts it anew");
    run.step("back -*2");
    assert_eq!(run.modes("a"), ["a.b"]);
    run.step("-");
    assert_eq!(run.modes("a"), ["a.c"]);
}

#[test]
fn an_edge_to_an_ancestor_leaves_and_enters_it() {
    let p = alone(
        "discrete n: int 0..99 = 0
         mode a {
             n := n + 1
             mode b { when true -> c }
             mode c { when timer >= 0.1 -> a }
         }",
    );
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.modes("a"), run.discrete("a", "n")), (vec!["a.c"], 0), "a stays, so it is not entered");
    run.step("-");
    assert_eq!((run.modes("a"), run.discrete("a", "n")), (vec!["a.b"], 1));
}

#[test]
fn flows_of_every_degree_and_none() {
    let p = alone(
        "button off
         continuous p = 1
         continuous q = 2
         x'' = 10
         y' = 5
         p = q
         mode on { when held(off) -> off_ }
         mode off_ { x' = 3; mode inner { y = x; initial mode deeper { when timer >= 1 -> none_ } mode none_ { } } }
         group_free = 1"
            .replace("group_free = 1", "")
            .as_str(),
    );
    let mut run = Run::new(&p);
    run.step("-*2");
    assert_eq!((run.var("a", "x''"), run.var("a", "x'"), run.var("a", "x")), (10.0, 2.0, 0.1 + 0.2));
    assert_eq!((run.var("a", "y''"), run.var("a", "y'"), run.var("a", "y")), (0.0, 5.0, 1.0));
    assert_eq!((run.var("a", "p"), run.var("a", "p'"), run.var("a", "q")), (2.0, 0.0, 2.0));
    let before = run.var("a", "x");
    run.step("off");
    assert_eq!((run.var("a", "x''"), run.var("a", "x'")), (0.0, 3.0), "the inner flow replaces the outer one");
    assert_eq!(run.var("a", "y"), before, "right sides are read before anything moves");
}

#[test]
fn without_a_flow_the_last_acceleration_stays() {
    let p = alone("mode a { x'' = 10; when timer >= 0.2 -> b } mode b { }");
    let mut run = Run::new(&p);
    run.step("-*2");
    let velocity = run.var("a", "x'");
    run.step("-*3");
    assert_eq!(run.modes("a"), ["b"]);
    assert_eq!(run.var("a", "x''"), 10.0);
    assert!((run.var("a", "x'") - velocity - 3.0).abs() < 1e-12);
}

#[test]
fn groups_run_side_by_side_and_drive_what_is_theirs() {
    let p = alone(
        "button grow, go
         y'' = -10
         group size { mode small { when pressed(grow) -> big } mode big { y' = 1 } }
         group move { mode stand { when held(go) and in size.big -> walk } mode walk { x' = 7 } }",
    );
    let mut run = Run::new(&p);
    run.step("grow+go");
    assert_eq!(run.modes("a"), ["size.big", "move.stand"], "guards read the state before the step");
    assert_eq!(run.var("a", "y'"), 1.0);
    run.step("go");
    assert_eq!(run.modes("a"), ["size.big", "move.walk"]);
    assert_eq!(run.var("a", "x'"), 7.0);
}

#[test]
fn buttons_are_pressed_and_released_at_one_step() {
    let p = alone(
        "button b
         discrete pressed_: int 0..99 = 0
         discrete held_: int 0..99 = 0
         discrete released_: int 0..99 = 0
         mode a {
             when pressed(b) { pressed_ := pressed_ + 1 }
             when held(b) { held_ := held_ + 1 }
             when released(b) { released_ := released_ + 1 }
         }",
    );
    let mut run = Run::new(&p);
    run.step("b*3 -*2 b*2");
    assert_eq!(["pressed_", "held_", "released_"].map(|n| run.discrete("a", n)), [2, 5, 1]);
}

#[test]
fn a_two_way_envelope_rises_holds_and_falls() {
    let text = |release: &str| {
        format!(
            "axis horizontal
             discrete ice: bool = false
             envelope x' by horizontal {{ attack accel 200; sustain 50; release {release}; while not in slip }}
             mode dry {{ }} mode slip {{ }}"
        )
    };
    let p = alone(&text("accel 100"));
    let mut run = Run::new(&p);
    let mut seen = Vec::new();
    for step in ["right", "right", "right", "right", "-", "-", "left", "left", "left", "left", "left"] {
        run.step(step);
        seen.push(run.var("a", "x'"));
    }
    assert_eq!(seen, [20.0, 40.0, 50.0, 50.0, 40.0, 30.0, 10.0, -10.0, -30.0, -50.0, -50.0]);
    run.step("left+right");
    assert_eq!(run.var("a", "x'"), -40.0, "opposite directions cancel");
    for (release, expected) in
        [("hold", 50.0), ("instant", 0.0), ("to 30", 30.0), ("over 0.5s", 40.0), ("accel 300 to 35", 35.0)]
    {
        let p = alone(&text(release));
        let mut run = Run::new(&p);
        run.step("right*5 -");
        assert_eq!(run.var("a", "x'"), expected, "release {release}");
    }
    let p = alone("axis steer; envelope x' by steer { attack over 0.5s; sustain 50 } mode a { }");
    let mut run = Run::new(&p);
    run.step("steer=0.25");
    assert_eq!(run.var("a", "x'"), 10.0, "the sign of the axis counts, and the way takes 0.5 s");
}

/// Entities in a level of tiles; the first is player 1's.
fn level(entities: &str, collide: &str, map: &str, places: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "{entities}
         world W {{
             step 1/10
             {collide}
             tiles t 10 x 10 {{ '.': empty; '#': wall; 'o': wall, \"odd tile\" }}
             space main {{
                 map t \"
{map}
                 \"
                 {places}
             }}
         }}"
    )))
}

const BALL: &str = "entity Ball {
    param vx = 0
    param vy = 0
    collider body: rect(0, 0, 4, 4)
    mode go { when timer >= 0 -> free { x' := vx; y' := vy } }
    mode free { }
}";

#[test]
fn both_axes_are_pushed_out_at_once_and_velocities_into_walls_stop() {
    let p = level(
        BALL,
        "collide body with wall: block",
        "..#\n..#\n###",
        "place a: Ball at (14, 12) { vx = 30; vy = -30 }",
    );
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("a", "y")), (16.0, 10.0));
    assert_eq!((run.var("a", "x'"), run.var("a", "y'")), (0.0, 0.0));
}

#[test]
fn kept_velocities_bounce_nothing_and_leaving_ones_stay() {
    let keep = "collide body with wall: block, keep velocity";
    let p = level(BALL, keep, "...\n###", "place a: Ball at (3, 11) { vx = 20; vy = -20 }");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "y"), run.var("a", "y'")), (10.0, -20.0));
    // Inside of a floor, but on its way out.
    let p = level(BALL, "collide body with wall: block", "...\n###", "place a: Ball at (3, 8) { vy = 10 }");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "y"), run.var("a", "y'")), (10.0, 10.0));
}

#[test]
fn seams_between_tiles_do_not_bump() {
    let runner = "entity Ball {
        collider body: rect(0, 0, 4, 4)
        x' = 33
        y'' = -100
    }";
    let p = level(runner, "collide body with wall: block", "..........\n##########", "place a: Ball at (0, 10)");
    let mut run = Run::new(&p);
    for _ in 0..25 {
        let before = run.var("a", "x");
        run.step("-");
        assert!((run.var("a", "x") - before - 3.3).abs() < 1e-9, "it slides freely");
        assert_eq!(run.var("a", "y"), 10.0);
    }
}

#[test]
fn of_two_equal_depths_the_vertical_one_counts() {
    let p =
        level(BALL, "collide body with wall: block", "...\n#..", "place a: Ball at (11, 11) { vx = -30; vy = -30 }");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("a", "y")), (8.0, 10.0));
    assert_eq!((run.var("a", "x'"), run.var("a", "y'")), (-30.0, 0.0));
}

#[test]
fn a_face_that_a_neighbour_covers_pushes_nobody() {
    // Into the seam of a wall of two tiles: of the lower one it is nearer to the top, where the upper one is.
    let p = level(BALL, "collide body with wall: block", "#..\n#..", "place a: Ball at (11, 9) { vx = -30; vy = 0 }");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("a", "y")), (10.0, 9.0));
}

#[test]
fn touching_knows_tags_and_sides_and_corners_do_not_count() {
    let probe = "entity Probe {
        discrete below: bool = false
        discrete right: bool = false
        discrete odd_: bool = false
        collider body: rect(0, 0, 4, 4)
        mode a { when true {
            below := touching(body, wall, below); right := touching(wall, right); odd_ := touching(body, \"odd tile\")
        } }
    }";
    let at = |x: f64, y: f64| {
        let place = format!("place a: Probe at ({x}, {y})");
        let p = level(probe, "collide body with wall: block", "..o\n...\n##.", &place);
        let mut run = Run::new(&p);
        run.step("-");
        ["below", "right", "odd_"].map(|n| run.discrete("a", n) == 1)
    };
    assert_eq!(at(3.0, 10.0), [true, false, false], "standing exactly on an edge");
    assert_eq!(at(3.0, 10.001), [false, false, false]);
    assert_eq!(at(16.0, 24.0), [false, true, true], "beside the odd tile");
    assert_eq!(at(20.0, 10.0), [false, false, false], "a corner is no contact");
    assert_eq!(at(16.0, 16.0), [false, false, false], "a corner is no contact");
}

#[test]
fn two_that_can_move_share_the_push_and_kinematic_ones_never_move() {
    let entities = "entity Crate { collider box: rect(0, 0, 10, 10) }
                    entity Wall { kinematic collider box: rect(0, 0, 10, 10) }";
    let p =
        level(entities, "collide box with box: block", "....", "place a: Crate at (0, 0)\nplace b: Crate at (6, 0)");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("b", "x")), (-2.0, 8.0));
    let p = level(entities, "collide box with box: block", "....", "place a: Wall at (0, 0)\nplace b: Crate at (6, 1)");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("b", "x"), run.var("b", "y")), (0.0, 10.0, 1.0));
    let p = level(entities, "collide box with box: block", "....", "place a: Wall at (0, 0)\nplace b: Wall at (6, 1)");
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("b", "x")), (0.0, 6.0));
}

#[test]
fn colliders_are_there_while_their_guard_holds() {
    let p = level(
        "entity Ghost {
             collider body: rect(0, 0, 4, 4) when in solid
             y' = -10
             mode thin { when timer >= 0.2 -> solid }
             mode solid { }
         }",
        "collide body with wall: block",
        "...\n...\n###",
        "place a: Ghost at (3, 10)",
    );
    let mut run = Run::new(&p);
    run.step("-*2");
    assert_eq!(run.var("a", "y"), 8.0, "it sinks into the floor");
    run.step("-");
    assert_eq!(run.var("a", "y"), 10.0, "and is pushed out of it");
}

#[test]
fn something_at_rest_stays_at_rest() {
    let p = level(
        "entity Rock { collider body: rect(0.1, -0.3, 4.7, 3.9); y'' = -300 }",
        "collide body with wall: block",
        "...\n...\n###",
        "place a: Rock at (3.3, 10.3)",
    );
    let mut run = Run::new(&p);
    run.step("-*10");
    let (x, y) = (run.var("a", "x"), run.var("a", "y"));
    run.step("-*100000");
    assert_eq!((run.var("a", "x"), run.var("a", "y")), (x, y));
}

#[test]
fn functions_compute_what_they_say() {
    let cases = [
        ("min(3, -2)", -2.0),
        ("max(3, -2)", 3.0),
        ("abs(-2.5)", 2.5),
        ("sign(-7) + sign(0) + sign(3)", 0.0),
        ("clamp(7, 1, 5)", 5.0),
        ("floor(-1.5)", -2.0),
        ("ceil(-1.5)", -1.0),
        ("round(2.5) + round(-2.5) + round(0.4)", 0.0),
        ("sqrt(2.25)", 1.5),
        ("if(x < 1, 4, 5)", 4.0),
        ("cos(zero)", 1.0),
        ("sin(zero)", 0.0),
        ("atan2(1, 1) * 4", std::f64::consts::PI),
        ("mod(7, 3) + mod(-1, 4) * 10 + mod(-8, 4)", 31.0),
        ("mod(0 - 0.25, 1)", 0.75),
        ("mod(5, -3)", -1.0),
        ("sin(pi / 2) + tau / pi", 3.0),
        ("2 + 3 * 4 - 6 / 4", 12.5),
        ("-2 - -3", 1.0),
        ("if(not x > 1 and 1 < 2, 1, 0)", 1.0),
    ];
    for (expression, expected) in cases {
        // Through a variable that has the dimension of whatever it is given.
        let p = alone(&format!("param zero = 0; continuous v = 0; v = {expression}"));
        let mut run = Run::new(&p);
        run.step("-");
        assert!((run.var("a", "v") - expected).abs() < 1e-15, "{expression} = {}", run.var("a", "v"));
    }
}

#[test]
fn rectangles_stand_free_and_need_no_map() {
    let p = program(compile_text(&format!(
        "{BALL}
         world W {{
             step 1/10
             collide body with wall, ice: block
             space main {{
                 rect wall, ice (-20, -10, 40, 10)
                 place a: Ball at (3, 1) {{ vx = 10; vy = -20 }}
             }}
         }}"
    )));
    let mut run = Run::new(&p);
    run.step("-");
    assert_eq!((run.var("a", "x"), run.var("a", "y"), run.var("a", "y'")), (4.0, 0.0, 0.0));
    run.step("-*100");
    assert!(run.var("a", "x") > 100.0 && run.var("a", "y") == 0.0, "nothing pulls it down beyond the edge");
}

#[test]
fn the_initial_mode_can_depend_on_parameters() {
    let p = program(compile_text(
        "entity A {
             param level = 0
             button go
             mode a {
                 mode plain { }
                 initial mode usual { }
                 initial when level > 1 mode hard { initial when level > 2 mode harder { } initial mode soft { } mode odd { } }
                 when pressed(go) -> b
             }
             initial when level < 0 mode b { when pressed(go) -> a }
         }
         world W {
             space main {
                 place one: A at (0, 0)
                 place two: A at (0, 0) { level = 2 }
                 place three: A at (0, 0) { level = 3 }
                 place none_: A at (0, 0) { level = -1 }
             }
             player 1: three
         }",
    ));
    let mut run = Run::new(&p);
    let modes = |run: &Run<'_>| ["one", "two", "three", "none_"].map(|n| run.modes(n)[0].to_string());
    assert_eq!(modes(&run), ["a.usual", "a.hard.soft", "a.hard.harder", "b"]);
    run.step("go");
    assert_eq!(run.modes("three"), ["b"]);
    run.step("- go");
    assert_eq!(run.modes("three"), ["a.hard.harder"], "the guard decides whenever the mode is entered");
}

#[test]
fn so_many_frames_are_so_many_steps() {
    for step in ["1/10", "1/20", "1/50", "1/60", "1/30", "0.04"] {
        for frames in 1..=60 {
            let program = program(compile_text(&format!(
                "entity A {{
                     discrete on_time: bool = false
                     mode waiting {{ when timer >= {frames}frames -> done {{ on_time := timer <= {frames}frames }} }}
                     mode done {{ }}
                 }}
                 world W {{ step {step}; space main {{ place a: A at (0, 0) }} }}"
            )));
            let mut run = Run::new(&program);
            run.step(&format!("-*{frames}"));
            assert_eq!(run.modes("a"), ["waiting"], "{frames} steps of {step}");
            run.step("-");
            assert_eq!((run.modes("a"), run.discrete("a", "on_time")), (vec!["done"], 1), "{frames} steps of {step}");
        }
    }
}

#[test]
fn who_stands_on_what_is_carried_is_carried_whatever_the_order_of_places() {
    let places = ["place lift: Lift at (0, 0)", "place crate: Crate at (0, 4)", "place hero: Hero at (0, 8)"];
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let places = order.map(|i| places[i]).join("\n");
        let program = program(compile_text(&format!(
            "entity Lift {{ kinematic collider lift: rect(0, 0, 8, 4); x' = 10 }}
             entity Crate {{ collider crate: rect(0, 0, 8, 4); y'' = -10 }}
             entity Hero {{ collider body: rect(0, 0, 4, 4); y'' = -10 }}
             world W {{
                 step 1/10
                 collide crate with lift: block, carry
                 collide body with crate: block, carry
                 space main {{ {places} }}
             }}"
        )));
        let mut run = Run::new(&program);
        run.step("-*10");
        let at = ["lift", "crate", "hero"].map(|name| run.var(name, "x"));
        assert_eq!(at, [10.0; 3], "{places}");
    }
}

#[test]
fn lines_of_the_same_strength_hold_in_both_directions() {
    for lines in [
        "collide a with b: block from above; collide b with a: block from above",
        "collide b with a: block from above; collide a with b: block from above",
    ] {
        for (low, high) in [("A", "B"), ("B", "A")] {
            let program = program(compile_text(&format!(
                "entity A {{ param v = 0; collider a: rect(0, 0, 4, 4); y' = v }}
                 entity B {{ param v = 0; collider b: rect(0, 0, 4, 4); y' = v }}
                 world W {{
                     step 1/10
                     {lines}
                     space main {{ place low: {low} at (0, 0); place high: {high} at (0, 6) {{ v = -10 }} }}
                 }}"
            )));
            let mut run = Run::new(&program);
            run.step("-*3");
            assert_eq!(run.var("high", "y") - run.var("low", "y"), 4.0, "{lines}, {high} on {low}");
        }
    }
}

#[test]
fn a_velocity_that_leaves_the_finite_numbers_stops_the_run_though_the_position_is_clamped() {
    let huge = format!("1{0} * 1{0}", "0".repeat(154));
    let program = program(compile_text(&format!(
        "entity A {{ clamp x in 0..10; x'' = {huge} }}
         world W {{ step 1; space main {{ place a: A at (0, 0) }} }}"
    )));
    let mut run = Run::new(&program);
    run.step("-");
    let input = Input::nothing(0);
    let fault = run.sim.step(&mut run.state, &input, &mut run.scratch).unwrap_err();
    assert!(matches!(fault.kind, hypedc::sim::FaultKind::Diverged(VarId(0), _)), "{fault:?}");
}

#[test]
fn a_first_value_that_a_spawn_gives_is_not_worked_out_beside() {
    let program = program(compile_text(
        "entity Shot { param p = 0; continuous c = 1 / p; discrete n: int 0..9 = round(20 + p) }
         entity A { mode only { when timer < 1frames { spawn Shot(c = 5, n = 7) } } }
         world W { step 1/10; limit Shot 1; space main { place a: A at (0, 0) } }",
    ));
    let mut run = Run::new(&program);
    run.step("-");
    assert_eq!((run.var("Shot#1", "c"), run.discrete("Shot#1", "n")), (5.0, 7));
}

#[test]
fn what_a_clamp_hides_stops_the_run_too() {
    // The position stays in its bounds while its derivatives leave the numbers.
    let fault = |entity: &str| {
        let p = alone(&entity.replace("HUGE", &format!("({} * {})", 1e200, 1e108)));
        let sim = Simulator::new(&p, WorldId(0));
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let steps = 1..=100;
        let failed = steps.map(|_| sim.step(&mut state, &Input::default(), &mut scratch)).find_map(Result::err);
        failed.map(|fault| fault.fact(&p, WorldId(0), 1).what)
    };
    let speed = "clamp x in -8..8; mode m { x'' = HUGE }";
    assert_eq!(fault(speed).unwrap(), "`x'` left the finite numbers");
    assert_eq!(fault("clamp x in -8..8; clamp x' in -9..9; mode m { x'' = HUGE }"), None, "all of it is bounded");
    // Huge numbers whose sum is none are numbers.
    assert_eq!(fault("mode m { x' = HUGE; when true { x := HUGE } }"), None);
}

#[test]
fn what_rests_obeys_clamps_and_timers() {
    let program = program(compile_text(
        "entity Crate {
             button far
             clamp x <= 100
             mode still {
                 when pressed(far) { x := 500 }
                 when timer >= 5frames -> later
             }
             mode later { x' = 0 }
         }
         entity Drifter { clamp x' >= 60; mode idle { y' = 0 } }
         entity Idler { clamp x' in -1..1; mode idle { x' = 0; y' = 0 } }
         world W { step 1/60
             space main { place crate: Crate at (0, 7); place drifter: Drifter at (0, 0); place idler: Idler at (3, 4) }
             player 1: crate
         }",
    ));
    let mut run = Run::new(&program);
    run.step("-");
    assert_eq!((run.var("crate", "x"), run.var("drifter", "x")), (0.0, 1.0));
    run.step("far");
    assert_eq!((run.var("crate", "x"), run.var("crate", "y")), (100.0, 7.0));
    assert_eq!(run.modes("crate"), ["still"]);
    run.step("-*4");
    assert_eq!(run.modes("crate"), ["later"]);
    assert_eq!((run.var("drifter", "x"), run.var("drifter", "x'")), (6.0, 60.0));
    assert_eq!((run.var("idler", "x"), run.var("idler", "y")), (3.0, 4.0));
}

/// A hero of 16 px in a world of rectangles and tiles.
fn among(walls: &str, entity: &str, at: &str) -> Arc<Program> {
    program(compile_text(&format!(
        "entity A {{ collider body: rect(0, 0, 16, 16)
             {entity} }}
         world W {{ step 1/60
             collide body with wall: block
             tiles t 16 x 16 {{ '.': empty; '#': wall }}
             space main {{ {walls}
                 place a: A at {at} }}
             player 1: a }}"
    )))
}

#[test]
fn rectangles_that_touch_form_one_surface() {
    // It falls fast onto the seam: across, it overlaps each of the two by less than along.
    let falls = |walls: &str, x: f64| {
        let p = among(walls, "y'' = -6000", &format!("({x}, 60)"));
        let mut run = Run::new(&p);
        run.step("-*60");
        (run.var("a", "x"), run.var("a", "y"))
    };
    let two = "rect wall (0, 0, 64, 16)\nrect wall (64, 0, 64, 16)";
    let tile = "map t \"\n........\n........\n####....\n\"\nrect wall (64, 0, 64, 16)";
    let small = "rect wall (0, 0, 64, 16)\nrect wall (64, 8, 64, 8)\nrect wall (64, 0, 64, 8)";
    let apart = "rect wall (0, 0, 64, 16)\nrect wall (64.0005, 0, 64, 16)";
    let over = "rect wall (0, 0, 70, 16)\nrect wall (58, 0, 70, 16)";
    for walls in [two, tile, small, apart, over] {
        for x in 0..32 {
            let x = 46.0 + f64::from(x) / 1.5;
            assert_eq!(falls(walls, x), (x, 16.0), "{walls}");
        }
    }
    // Along a wall of several parts nothing stumbles, whichever way it goes.
    for (flow, at, along, across) in
        [("x' = 300; y' = -60", "(0, 16)", "x", "y"), ("x' = 60; y' = -300", "(48, 200)", "y", "x")]
    {
        let part = |i: i32| match along {
            "x" => format!("rect wall ({}, 0, 10, 16)\n", i * 10),
            _ => format!("rect wall (64, {}, 16, 10)\n", i * 10),
        };
        let walls: String = (0..30).map(part).collect();
        let p = among(&walls, flow, at);
        let mut run = Run::new(&p);
        let (from, side) = (run.var("a", along), run.var("a", across));
        run.step("-*30");
        assert!((run.var("a", along) - from).abs() > 149.0, "{along}: {} to {}", from, run.var("a", along));
        assert_eq!(run.var("a", across), side);
    }
    // A face that is covered only where the body is not is open.
    let lower = "rect wall (0, 0, 64, 64)\nrect wall (64, 0, 64, 16)";
    let p = among(lower, "x' = -300", "(80, 30)");
    let mut run = Run::new(&p);
    run.step("-*30");
    assert_eq!((run.var("a", "x"), run.var("a", "y")), (64.0, 30.0));
}

#[test]
fn a_world_without_a_space_has_no_slots() {
    let p = program(compile_text("entity A { mode only { when true { spawn A } } } world W { limit A 1 }"));
    assert_eq!(p.worlds[WorldId(0)].slots.len(), 0);
}

/// A gun that makes a crate every second step, which keeps it; button `crush` destroys the placed one.
const CRATES: &str = "
    entity Crate { }
    entity Gun {
        button make, crush
        ref old: Crate
        ref new: Crate
        discrete sees: bool = false
        mode only {
            when new is Crate and new.x == 50 { sees := true }
            when pressed(make) { new := spawn Crate(x = 50) }
            when pressed(crush) { destroy old }
        }
    }";

#[test]
fn what_was_placed_and_is_gone_leaves_room() {
    let p = program(compile_text(&format!(
        "{CRATES} world W {{
             step 1/10; limit Crate 1
             space main {{ place crate: Crate at (7, 0); place gun: Gun at (0, 0) {{ old = crate; new = crate }} }}
             player 1: gun
             goal gone: crate.x == 7
             goal one: any Crate and gun.sees
         }}"
    )));
    let world = &p.worlds[WorldId(0)];
    let mut run = Run::new(&p);
    let alive = |run: &Run<'_>, slot: &str| world.layout.slots[run.slot(slot)].alive(&run.state);
    run.step("make -");
    assert!(alive(&run, "crate") && !alive(&run, "Crate#1"), "one is alive, and none may be more");
    run.step("crush+make -");
    assert!(!alive(&run, "crate") && !alive(&run, "Crate#1"), "what is destroyed in this step still counts");
    run.step("make - -");
    assert!(!alive(&run, "crate") && alive(&run, "Crate#1"), "there is room, and the name stays with what is gone");
    let questions = world.goals.iter().map(|g| run.sim.holds(&run.state, g.holds).unwrap()).collect::<Vec<_>>();
    assert_eq!(questions, [false, true]);
}

#[test]
fn no_more_are_alive_than_the_limit_says() {
    let p = program(compile_text(&format!(
        "{CRATES} world W {{
             step 1/10; limit Crate 3
             tiles t 16 x 16 {{ '.': empty; 'c': spawn Crate }}
             space main {{
                 map t \"
                     .c
                 \"
                 place crate: Crate at (7, 0); place gun: Gun at (0, 0) {{ old = crate }}
             }}
             player 1: gun
         }}"
    )));
    let world = &p.worlds[WorldId(0)];
    let mut run = Run::new(&p);
    let living = |run: &Run<'_>| {
        let crates = world.slots.pairs().filter(|(_, s)| s.name.to_lowercase().starts_with("crate"));
        crates.filter(|(id, _)| world.layout.slots[*id].alive(&run.state)).count()
    };
    run.step("make - make - make -");
    assert_eq!(living(&run), 3);
    run.step("crush - make - make -");
    assert_eq!(living(&run), 3);
}

#[test]
fn there_is_one_zero() {
    // A negative zero could be told from the other by the direction that it points in.
    let sees =
        "initial mode here { when atan2(p, -1) < 0 or atan2(c, -1) < 0 or atan2(x, -1) < 0 -> there } mode there { }";
    let text = format!(
        "entity Shot {{ param p = 0; continuous c = -p; {sees} }}
         entity A {{ param q = 0; mode only {{ when timer < 1frames {{ spawn Shot(p = -q, x = -q); spawn Shot(c = -q) }} }} }}
         world W {{
             step 1/10; limit Shot 4
             space main {{
                 place shot: Shot at (-0, 0) {{ p = -0 }}
                 place other: Shot at (0, -0) {{ c = -0 }}
                 place a: A at (0, 0)
             }}
         }}"
    );
    let program = program(compile_text(&text));
    let mut run = Run::new(&program);
    run.step("- - -");
    for slot in ["shot", "other", "Shot#1", "Shot#2"] {
        assert_eq!(run.modes(slot), ["here"], "{slot}");
        assert!(["x", "c"].iter().all(|var| run.var(slot, var).is_sign_positive()), "{slot}");
    }
}

#[test]
fn what_is_spawned_has_counters_that_are_never_zero() {
    let text = "entity Shot { discrete power: int 2..9 = 3; discrete debt: int -9..-2 = -3; mode only { } }
         entity A { mode only { when timer < 1frames { spawn Shot(power = 5) } } }
         world W {
             step 1/10
             limit Shot 2
             space main { place a: A at (0, 0) }
             goal spawned: any Shot.power == 5 and any Shot.debt == -3
         }";
    // An empty slot keeps the ranges, too: the program is verified.
    assert_eq!(goals_after(text, "-"), ["spawned"]);
}

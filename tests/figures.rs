//! How players move, measured, against what can be worked out. A step adds the acceleration to the velocity, and then
//! the velocity to the position: after n steps of a jump with speed v and acceleration a, the height is
//! n v dt + a dt² n (n + 1) / 2.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::{Disk, compile_text, files, program};
use hypedc::compile::compile;
use hypedc::diff::{Figures, Jump, Press, measure, player_changes};
use hypedc::ir::WorldId;
use hypedc::watch::{Meter, Unwatched};

const DT: f64 = 1.0 / 60.0;
/// Noise of rounding.
const NOISE: f64 = 1e-6;

/// A world with an entity that stands on a floor.
fn world(step: &str, entity: &str) -> String {
    format!(
        "entity Hero {{ collider body: rect(0, 0, 16, 16)
        {entity} }}
        world W {{
            step {step}
            collide body with wall: block
            space main {{
                rect wall (-400, 0, 800, 16)
                place hero: Hero at (0, 16)
            }}
            player 1: hero
            goal far: hero.x > 300
        }}"
    )
}

fn all_figures(text: &str) -> Vec<Figures> {
    let program = program(compile_text(text));
    measure(&program, WorldId(0), &Meter::new(&Unwatched)).unwrap()
}

fn figures(step: &str, entity: &str) -> Figures {
    let mut all = all_figures(&world(step, entity));
    assert_eq!(all.len(), 1, "the hero stands");
    assert_eq!(all[0].ground, ["wall"]);
    all.remove(0)
}

/// The jump of an input; `with` are the others that are held.
fn jump<'f>(figures: &'f Figures, input: &str, press: Press, with: &str, running: bool) -> &'f Jump {
    let is_it = |jump: &&Jump| {
        (jump.input.as_str(), jump.press, jump.with.as_str(), jump.running) == (input, press, with, running)
    };
    figures.jumps.iter().find(is_it).unwrap_or_else(|| panic!("no {input} with `{with}` in {figures:#?}"))
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= NOISE, "{found} instead of {expected}");
}

/// Rise, length and duration of a jump.
#[track_caller]
fn assert_jump(jump: &Jump, rise: f64, length: f64, steps: f64, dt: f64) {
    assert_near(jump.rise, rise);
    assert_near(jump.length.unwrap(), length);
    assert_near(jump.seconds.unwrap(), steps * dt);
}

/// The height after n steps.
fn height(n: f64, speed: f64, acceleration: f64, dt: f64) -> f64 {
    n * speed * dt + acceleration * dt * dt * n * (n + 1.0) / 2.0
}

/// Rise and number of steps in the air, with a constant acceleration: the velocity after n steps is v + n a dt.
fn arc(speed: f64, acceleration: f64, dt: f64) -> (f64, f64) {
    let quick = speed / (-acceleration * dt);
    (height(quick.ceil() - 1.0, speed, acceleration, dt), (2.0 * quick - 1.0).ceil())
}

/// Falls, and jumps with a button from the ground.
const PLAIN: &str = "
    button jump
    axis horizontal
    param walk = 90
    x' = walk * horizontal
    y'' = -910
    initial mode ground { when pressed(jump) and touching(body, wall, below) -> air { y' := 251 } }
    mode air { when touching(body, wall, below) -> ground }";

#[test]
fn a_plain_jump_is_an_arc() {
    for (step, dt) in [("1/60", 1.0 / 60.0), ("1/50", 1.0 / 50.0), ("1/144", 1.0 / 144.0)] {
        let of = figures(step, PLAIN);
        let (rise, steps) = arc(251.0, -910.0, dt);
        for press in [Press::Held, Press::Tapped] {
            assert_jump(jump(&of, "jump", press, "", false), rise, 0.0, steps, dt);
            for with in ["left", "right"] {
                assert_jump(jump(&of, "jump", press, with, false), rise, steps * 90.0 * dt, steps, dt);
                let running = jump(&of, "jump", press, with, true);
                assert_jump(running, rise, steps * 90.0 * dt, steps, dt);
                assert_near(running.speed, 90.0);
            }
        }
        assert_eq!(of.jumps.len(), 10, "an axis does not lead off the ground: {of:#?}");
        let modes: Vec<&str> = of.speeds.iter().map(|speed| speed.mode.as_str()).collect();
        assert_eq!(modes, ["ground", "air"]);
        assert_near(of.speeds[1].sideways, 90.0);
        assert_near(of.speeds[1].up, 251.0 - 910.0 * dt);
        // In the last step it lands, and the floor takes the speed.
        assert_near(of.speeds[1].down, (steps - 1.0) * 910.0 * dt - 251.0);
    }
}

#[test]
fn a_button_that_is_held_rises_higher() {
    let of = figures(
        "1/60",
        "button jump
        group feet {
            initial mode ground { when pressed(jump) and touching(body, wall, below) -> rising { y' := 300 } }
            mode rising { y'' = -610; when not held(jump) or y' < 0 -> falling }
            mode falling { y'' = -1810; when touching(body, wall, below) -> ground }
        }",
    );
    // Tapped: one step in `rising`, then in `falling`.
    let first = 300.0 - 610.0 * DT;
    let (more, steps) = arc(first, -1810.0, DT);
    // The second arc begins a step above the ground, so that it lands later than that arc.
    let above = first * DT;
    let landed = (1..).map(f64::from).find(|n| above + height(*n, first, -1810.0, DT) <= 0.0).unwrap();
    assert!(landed >= steps);
    assert_jump(jump(&of, "jump", Press::Tapped, "", false), above + more, 0.0, 1.0 + landed, DT);
    // Held: in `rising` until after the step in which the speed is below 0.
    let n = (300.0 / (610.0 * DT)).floor() + 1.0;
    let (rise, _) = arc(300.0, -610.0, DT);
    let (top, speed) = (height(n, 300.0, -610.0, DT), 300.0 - n * 610.0 * DT);
    let landed = (1..).map(f64::from).find(|n| top + height(*n, speed, -1810.0, DT) <= 0.0).unwrap();
    assert_jump(jump(&of, "jump", Press::Held, "", false), rise, 0.0, n + landed, DT);
}

#[test]
fn a_run_up_makes_a_jump_longer() {
    let of = figures(
        "1/60",
        "button jump, dash
        axis horizontal
        param walk = 100
        param run = 160
        y'' = -900
        x' = if(held(dash), run, walk) * horizontal
        initial mode ground { when pressed(jump) and touching(body, wall, below) -> air { y' := 247 } }
        mode air { when touching(body, wall, below) -> ground }",
    );
    let (rise, steps) = arc(247.0, -900.0, DT);
    for (with, speed) in [("right", 100.0), ("right+dash", 160.0), ("left", 100.0), ("left+dash", 160.0)] {
        let found = jump(&of, "jump", Press::Held, with, true);
        assert_jump(found, rise, steps * speed * DT, steps, DT);
        assert_near(found.speed, speed);
    }
}

#[test]
fn a_speed_that_grows_is_waited_for() {
    let of = figures(
        "1/60",
        "button jump
        axis horizontal
        clamp x' in -125..125
        y'' = -905
        param push: px/s^2 = 60
        x'' = push * horizontal
        initial mode ground { when pressed(jump) and touching(body, wall, below) -> air { y' := 203 } }
        mode air { when touching(body, wall, below) -> ground }",
    );
    let (rise, steps) = arc(203.0, -905.0, DT);
    assert_jump(jump(&of, "jump", Press::Held, "right", true), rise, steps * 125.0 * DT, steps, DT);
    // From standing still the speed grows in the air.
    let n = steps;
    assert_jump(jump(&of, "jump", Press::Held, "right", false), rise, height(n, 0.0, 60.0, DT), n, DT);
    assert!(of.speeds.iter().all(|speed| speed.sideways <= 125.0 + NOISE));
}

#[test]
fn a_jump_can_be_charged() {
    let of = figures(
        "1/60",
        "button jump
        param more: px/s^2 = 200
        initial mode ground { when pressed(jump) and touching(body, wall, below) -> charging }
        mode charging { when released(jump) -> air { y' := 101 + more * timer } }
        mode air { y'' = -890; when touching(body, wall, below) -> ground }",
    );
    // Let go after a second: the timer is at 1 s.
    let (rise, steps) = arc(301.0, -890.0, DT);
    assert_jump(jump(&of, "jump", Press::Released, "", false), rise, 0.0, steps, DT);
    let (rise, steps) = arc(101.0 + 200.0 * DT, -890.0, DT);
    assert_jump(jump(&of, "jump", Press::Tapped, "", false), rise, 0.0, steps, DT);
    assert!(of.jumps.iter().all(|jump| jump.press != Press::Held), "held, it stays on the ground");
}

#[test]
fn an_axis_can_direct_a_jump() {
    // A frog that does not walk.
    let of = figures(
        "1/60",
        "button jump
        axis horizontal
        param aside = 70
        y'' = -800
        initial mode ground {
            x' = 0
            when released(jump) and touching(body, wall, below) -> air { y' := 210; x' := aside * horizontal }
        }
        mode air { when touching(body, wall, below) -> ground }",
    );
    let (rise, steps) = arc(210.0, -800.0, DT);
    for (with, length) in [("", 0.0), ("left", steps * 70.0 * DT), ("right", steps * 70.0 * DT)] {
        assert_jump(jump(&of, "jump", Press::Released, with, false), rise, length, steps, DT);
    }
    assert!(of.jumps.iter().all(|jump| !jump.running));
}

#[test]
fn a_fall_can_have_a_greatest_speed() {
    let of = figures(
        "1/60",
        "button jump
        clamp y' in -120..400
        initial mode ground { when pressed(jump) and touching(body, wall, below) -> air { y' := 302 } }
        mode air { y'' = -900; when touching(body, wall, below) -> ground }",
    );
    let (rise, _) = arc(302.0, -900.0, DT);
    // The first step at which the speed is at its limit; what the clamp cuts off of that step does not move it.
    let n = (422.0 / 15.0_f64).floor();
    let left = height(n, 302.0, -900.0, DT);
    let steps = n + (left / 2.0).ceil();
    assert_jump(jump(&of, "jump", Press::Held, "", false), rise, 0.0, steps, DT);
    assert_near(of.speeds.iter().find(|speed| speed.mode == "air").unwrap().down, 120.0);
}

#[test]
fn a_jump_need_not_be_an_arc() {
    // By an end of an axis: up for half a second at 121 px/s, and down at 97 px/s.
    let of = figures(
        "1/60",
        "axis vertical
        initial mode ground { when vertical > 0 and touching(body, wall, below) -> up }
        mode up { y' = 121; when timer >= 0.5s -> down }
        mode down { y' = -97; when touching(body, wall, below) -> ground }",
    );
    let rise = 30.0 * 121.0 * DT;
    let steps = 30.0 + (rise / (97.0 * DT)).ceil();
    assert_jump(jump(&of, "up", Press::Tapped, "", false), rise, 0.0, steps, DT);
    assert_near(of.speeds.iter().find(|speed| speed.mode == "up").unwrap().up, 121.0);
}

#[test]
fn who_never_stands_is_not_measured() {
    let flies = world("1/60", "axis horizontal, vertical; param v = 80; x' = v * horizontal; y' = v * vertical");
    assert!(all_figures(&flies).is_empty());
    let floats = world("1/60", "button up; y'' = if(held(up), 300, -300); clamp y' in -20..20; x' = 40");
    // It stands, but does not stand still; what it does from there is measured.
    assert_eq!(all_figures(&floats).len(), 1);
    let off = PLAIN.replace("touching(body, wall, below) -> ground", "timer > 99s -> ground");
    assert!(
        all_figures(&world("1/60", &off))[0].jumps.iter().all(|jump| jump.seconds.is_some()),
        "it lands all the same"
    );
}

/// Of all examples: the same figures each time, and none that no run can have.
#[test]
fn examples_are_measured_the_same_way_twice() {
    let mut measured = 0;
    for path in files("examples", "hyped") {
        let program = program(compile(&path, &Disk));
        for world in program.worlds.ids() {
            let measure = || measure(&program, world, &Meter::new(&Unwatched)).unwrap();
            let (once, twice) = (measure(), measure());
            assert_eq!(player_changes(&once, &twice), [], "{}", path.display());
            for jump in once.iter().flat_map(|figures| &figures.jumps) {
                measured += 1;
                assert!(jump.rise > 0.0 && jump.length.is_some() == jump.seconds.is_some(), "{jump:?}");
            }
        }
    }
    assert!(measured > 20, "{measured}");
}

//! The smallest changes of numbers: thresholds of jumps, gaps and times that can be worked out, from both sides.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;

use hypedc::compile::{Changes, Compilation, NumberSetting, compile_changed, written_number};
use hypedc::ir::{GoalId, WorldId};
use hypedc::reach::query::Query;
use hypedc::reach::{Conclusion, Limits, Target};
use hypedc::sim::Simulator;
use hypedc::tune::{
    Axis, Built, Host, LevelHost, Question, TileChange, TileEdit, TileQuestion, TilesFound, Trial, Tuned, Wanted,
    tile_edits, tune, tune_tiles,
};
use hypedc::watch::{Unwatched, Watch};

use crate::support::{Text, assert_leads_to, script};

const GOAL: GoalId = GoalId(0);
const STEP: f64 = 1.0 / 60.0;
/// How far a threshold may be from the closed form, relative to it.
const PRECISION: f64 = 0.01;

/// Compiles a text.
struct Texts<'t>(&'t str);

impl Host for Texts<'_> {
    fn build(&self, numbers: &[NumberSetting<'_>]) -> Result<Built, String> {
        let changes = Changes { numbers, ..Changes::default() };
        let Compilation { sources, program, diagnostics, .. } =
            compile_changed(Path::new("test.hyped"), Default::default(), &changes, &Text(self.0));
        let program = program.ok_or_else(|| format!("{diagnostics:?}"))?;
        Ok(Built { sources, program, world: WorldId(0) })
    }

    fn watched(&self, _: &str, work: &mut dyn FnMut(&dyn Watch)) {
        work(&Unwatched);
    }

    fn is_stopped(&self) -> bool {
        false
    }
}

/// What is found when some numbers of a text are varied.
fn tuned(text: &str, vary: &[(&str, f64, f64)], ask: impl FnOnce(&mut Question)) -> Tuned {
    let axis = |(path, low, high): &(&str, f64, f64)| {
        let written = written_number(Path::new("test.hyped"), &Text(text), path).ok().unwrap();
        Axis::new(path, &written.unit, written.literal.unwrap(), (*low, *high), None).unwrap()
    };
    let query = Query { limits: Limits { nodes: 1_500, ..Limits::default() }, ..Query::new(vec![Target::Goal(GOAL)]) };
    let axes = vary.iter().map(axis).collect();
    let mut question = Question { axes, query, wanted: Wanted::Reached, nevers: Vec::new(), samples: 4 };
    ask(&mut question);
    let found = tune(&Texts(text), &question);
    assert!(found.refuted.is_none() && !found.is_stopped);
    check_ways(text, &found);
    found
}

/// Every way that was found leads to the goal with the values of its trial.
fn check_ways(text: &str, found: &Tuned) {
    for trial in &found.trials {
        let Some(inputs) = &trial.inputs else { continue };
        let values: Vec<String> = trial.values.iter().map(|value| Axis::text(*value)).collect();
        let numbers: Vec<NumberSetting<'_>> =
            found.axes.iter().zip(&values).map(|(axis, value)| NumberSetting { path: &axis.name, value }).collect();
        let built = Texts(text).build(&numbers).unwrap();
        let sim = Simulator::new(&built.program, built.world);
        assert_leads_to(&sim, &script(&built.program, inputs), GOAL);
    }
    // Nothing that is reached is in a part that is proven.
    for part in &found.parts {
        for trial in found.trials.iter().filter(|trial| trial.verdict == Conclusion::Reached) {
            let is_there = found.axes.iter().enumerate().all(|(at, axis)| match at == part.number {
                true => part.from <= trial.values[at] && trial.values[at] <= part.to,
                false => trial.values[at] == axis.base,
            });
            assert!(!is_there, "{part:?} has {trial:?}");
        }
    }
}

/// The change of the only number, with the next smaller one that was tried.
fn threshold(found: &Tuned) -> (&Trial, &Trial) {
    let change = found.change.as_ref().unwrap_or_else(|| panic!("{:#?}", found.trials));
    (&found.trials[change.trial], &found.trials[change.before])
}

/// A threshold is found from both sides.
fn assert_near(found: &Tuned, known: f64, what: &str) {
    let (turned, before) = threshold(found);
    let (inner, outer) = (before.values[0], turned.values[0]);
    let room = PRECISION * known.abs();
    assert!((outer - known).abs() <= room, "{what}: found at {outer}, known {known}");
    assert!((inner - known).abs() <= room, "{what}: not at {inner}, known {known}");
    assert!(turned.is_wanted && !before.is_wanted);
    // The known threshold lies between the two.
    let slack = 1e-9 * known.abs();
    assert!(
        inner.min(outer) <= known + slack && known - slack <= inner.max(outer),
        "{what}: {inner}, {known}, {outer}"
    );
}

/// A hero in the open who jumps, and moves only in the air.
fn jumper(jump: f64, gravity: f64, speed: f64, goal: &str) -> String {
    format!(
        r#"
entity Hero {{
    param jump_speed = {jump}
    param gravity = {gravity}
    param speed = {speed}
    button jump
    axis horizontal
    collider body: rect(0, 0, 16, 16)
    initial mode ground {{
        x' = 0
        y'' = gravity
        when pressed(jump) and touching(body, wall, below) -> air {{ y' := jump_speed }}
    }}
    mode air {{
        x' = speed * horizontal
        y'' = gravity
        when touching(body, wall, below) -> ground
    }}
}}
world Test {{
    step 1/60
    collide body with wall: block
    tiles room 16 x 16 {{
        '.': empty
        '#': wall
    }}
    space main {{
        bounds rect(-400, -200, 2400, 3000)
        map room "
            ...
            ...
            .#.
        "
        place hero: Hero at (16, 16)
    }}
    player 1: hero
    goal done: {goal}
}}
"#
    )
}

/// How high a jump goes, by the sum of its steps.
fn height(jump: f64, gravity: f64) -> f64 {
    let steps = (jump / (-gravity * STEP)).floor();
    steps * jump * STEP + gravity * STEP * STEP * steps * (steps + 1.0) / 2.0
}

/// The number of steps after which a jump is back on its level or above it for the last time.
fn air(jump: f64, gravity: f64) -> f64 {
    (0..10_000)
        .map(f64::from)
        .take_while(|n| n * jump * STEP + gravity * STEP * STEP * n * (n + 1.0) / 2.0 >= 0.0)
        .last()
        .unwrap()
}

/// Where a growing function passes a value.
fn solved(low: f64, high: f64, passes: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..80 {
        let middle = low.midpoint(high);
        if passes(middle) { high = middle } else { low = middle }
    }
    high
}

#[test]
fn the_speed_of_a_jump_is_found_and_all_below_it_is_proven() {
    for (gravity, up) in [(-900.0, 40.0), (-900.0, 70.3), (-600.0, 24.0), (-1500.0, 96.0), (-400.0, 51.5)] {
        let text = jumper(120.0, gravity, 60.0, &format!("hero.y >= {}", 16.0 + up));
        let found = tuned(&text, &[("Hero.jump_speed", 100.0, 700.0)], |_| {});
        let known = solved(100.0, 700.0, |jump| height(jump, gravity) >= up);
        assert_near(&found, known, &format!("a jump of {up}"));
        let end = found.parts.iter().filter(|part| part.from <= 120.0).map(|part| part.to).fold(0.0, f64::max);
        assert!(end < known && known - end <= 2.0 * PRECISION * known, "proven up to {end}, known {known}");
    }
}

#[test]
fn a_weaker_gravity_is_found() {
    for (jump, up) in [(300.0, 60.0), (240.0, 45.0)] {
        let text = jumper(jump, -1400.0, 60.0, &format!("hero.y >= {}", 16.0 + up));
        let found = tuned(&text, &[("Hero.gravity", -1500.0, -200.0)], |_| {});
        let known = solved(-1500.0, -200.0, |gravity| height(jump, gravity) >= up);
        assert_near(&found, known, &format!("a jump of {up}"));
        assert!(found.change.as_ref().is_some_and(|change| !change.is_proven_smallest));
    }
}

#[test]
fn the_speed_over_a_gap_is_found() {
    for (jump, gap) in [(300.0, 90.0), (260.0, 41.0), (420.0, 200.0)] {
        let text = jumper(jump, -900.0, 30.0, &format!("hero.x >= {} and hero.y >= 16", 16.0 + gap));
        // One jump only.
        let text = text.replace("        when touching(body, wall, below) -> ground\n", "");
        let found = tuned(&text, &[("Hero.speed", 20.0, 600.0)], |_| {});
        assert_near(&found, gap / (air(jump, -900.0) * STEP), &format!("a gap of {gap}"));
    }
}

#[test]
fn a_speed_that_is_just_in_time_is_found() {
    for (steps, far) in [(20, 60.0), (45, 200.0)] {
        let text = jumper(200.0, -20.0, 30.0, &format!("hero.x >= {}", 16.0 + far));
        let found = tuned(&text, &[("Hero.speed", 20.0, 600.0)], |question| {
            question.query.within = Some(steps);
            question.query.limits.nodes = 6_000;
        });
        assert_near(&found, far / (f64::from(steps) * STEP), &format!("{far} px in {steps} steps"));
    }
}

#[test]
fn what_prevents_a_goal_is_proven() {
    let text = jumper(400.0, -900.0, 60.0, "hero.y >= 66");
    let found = tuned(&text, &[("Hero.jump_speed", 100.0, 500.0)], |question| question.wanted = Wanted::Prevented);
    assert_near(&found, solved(100.0, 500.0, |jump| height(jump, -900.0) >= 50.0), "no jump of 50");
    let (turned, before) = threshold(&found);
    assert_eq!((turned.verdict, before.verdict), (Conclusion::ProvenUnreachable, Conclusion::Reached));
}

#[test]
fn numbers_change_together_only_if_one_is_not_enough() {
    let goal = "hero.x >= 100 and hero.y >= 56";
    let text = jumper(200.0, -900.0, 60.0, goal);
    let alone = [("Hero.jump_speed", 100.0, 1200.0), ("Hero.speed", 40.0, 90.0)];
    let found = tuned(&text, &alone, |_| {});
    let (turned, _) = threshold(&found);
    assert!(turned.values[0] > 200.0 && turned.values[1] == 60.0, "{turned:?}");
    let both = [("Hero.jump_speed", 150.0, 320.0), ("Hero.speed", 40.0, 240.0)];
    let found = tuned(&text, &both, |_| {});
    let (turned, _) = threshold(&found);
    assert!(turned.values[0] != 200.0 && turned.values[1] != 60.0, "{turned:?}");
    assert!(found.change.as_ref().is_some_and(|change| !change.is_proven_smallest));
}

/// From where a script leads to, the goal counts only from there on; what is replayed begins in the same way.
#[test]
fn a_question_after_a_script_begins_there() {
    let text = jumper(120.0, -900.0, 60.0, "hero.y >= 60 and hero.x < 20");
    let program = Texts(&text).build(&[]).unwrap().program;
    let found = tuned(&text, &[("Hero.jump_speed", 100.0, 600.0)], |question| {
        question.query.after = vec![script(&program, "-*30")];
    });
    assert_near(&found, solved(100.0, 600.0, |jump| height(jump, -900.0) >= 44.0), "a jump after half a second");
    for trial in found.trials.iter().filter(|trial| trial.verdict == Conclusion::Reached) {
        let inputs = script(&program, trial.inputs.as_ref().unwrap());
        assert_eq!(inputs.first(30), script(&program, "-*30"), "{trial:?}");
        assert!(inputs.len() > 30, "{trial:?}");
    }
}

/// A path on which something never holds.
#[test]
fn a_question_without_something_leaves_it_out() {
    let text =
        jumper(120.0, -900.0, 60.0, "hero.y >= 60").replace("goal done", "never left: hero.x < 16\n    goal done");
    let found = tuned(&text, &[("Hero.jump_speed", 100.0, 600.0)], |question| {
        question.query.without = vec![hypedc::ir::NeverId(0)];
    });
    assert_near(&found, solved(100.0, 600.0, |jump| height(jump, -900.0) >= 44.0), "a jump that does not go left");
}

#[test]
fn a_broken_never_does_not_count() {
    let plain = jumper(200.0, -900.0, 60.0, "hero.y >= 60");
    let text = plain.replace("goal done", "never high: hero.y >= 90\n    goal done");
    let found = tuned(&text, &[("Hero.jump_speed", 100.0, 600.0)], |question| {
        question.nevers = vec![Target::Never(hypedc::ir::NeverId(0))];
    });
    let (turned, _) = threshold(&found);
    assert_eq!(turned.nevers.len(), 1);
    assert_eq!(turned.nevers[0].verdict, Conclusion::ProvenUnreachable, "{turned:?}");
    let high = found.trials.iter().filter(|trial| trial.values[0] > 400.0);
    for trial in high {
        assert!(trial.verdict == Conclusion::Reached && !trial.is_wanted, "{trial:?}");
    }
}

#[test]
fn nothing_changes_where_nothing_needs_to() {
    let text = jumper(400.0, -900.0, 60.0, "hero.y >= 40");
    let found = tuned(&text, &[("Hero.jump_speed", 100.0, 500.0)], |_| {});
    assert!(found.is_wanted_already() && found.change.is_none() && found.trials.len() == 1);
}

/// A world of its own, a number of it, the range, the nodes of each search, and where the answer turns.
struct Threshold {
    what: &'static str,
    text: String,
    vary: (&'static str, f64, f64),
    nodes: u64,
    within: Option<u32>,
    known: f64,
}

/// A world of one player in a space with steps of 1/64 s.
fn small(entities: &str, world: &str, goal: &str) -> String {
    format!(
        "{entities}
world Test {{
    step 1/64
    collide body with floor: block
    collide body with cloud: block from above
    space main {{
        bounds rect(-400, -200, 2400, 3000)
{world}
    }}
    player 1: hero
    goal done: {goal}
}}
"
    )
}

/// Runs a pixel a step, and jumps with a speed: after k steps it rises by that less k times 8 px/s.
fn runner(jump: f64, more: &str) -> String {
    format!(
        "entity Hero {{
    param speed = 64
    param jump_speed = {jump}
    axis horizontal
    button jump
    collider body, player: rect(0, 0, 16, 16)
    envelope x' by horizontal {{ sustain speed }}
    mode ground {{
        y' = 0
        when not touching(body, floor, below) and not touching(body, cloud, below) -> air
        when pressed(jump) -> air {{ y' := jump_speed }}
    }}
    initial mode air {{
        y'' = -512
        when touching(body, floor, below) and y' <= 0 -> ground
        when touching(body, cloud, below) and y' <= 0 -> ground
        {more}
    }}
}}
"
    )
}

/// How high a jump with a speed goes, by the sum of its steps.
fn rise(speed: f64) -> f64 {
    (1..1000).map(|k| (speed - 8.0 * f64::from(k)) / 64.0).take_while(|way| *way > 0.0).sum()
}

/// Worlds of their own kinds, each with a number whose threshold can be worked out.
fn thresholds() -> Vec<Threshold> {
    let base = |what, text, vary, known| Threshold { what, text, vary, nodes: 1_500, within: None, known };
    let ground = "        rect floor (0, 0, 400, 32)\n";
    let walker = "entity Hero {
    param speed = 64
    axis horizontal
    collider body, player: rect(0, 0, 12, 12)
    envelope x' by horizontal { sustain speed }
}
";
    vec![
        // From x = 99 to x = 162, with a foot of a pixel at both ends: 78 px and anything less.
        Threshold {
            nodes: 10_000,
            ..base(
                "a gap whose width is a constant",
                small(
                    &format!("const gap: px = 120\n{}", runner(256.0, "")),
                    "        rect floor (0, 0, 100, 32)\n        rect floor (100 + gap, 0, 300, 32)
        place hero: Hero at (69, 32)",
                    "hero.x > 110 and hero in ground",
                ),
                ("gap", 20.0, 120.0),
                78.0,
            )
        },
        base(
            "a jump onto a cloud",
            small(
                &runner(128.0, ""),
                &format!("{ground}        rect cloud (0, 132, 400, 4)\n        place hero: Hero at (30, 32)"),
                "hero in ground and hero.y >= 136",
            ),
            ("Hero.jump_speed", 100.0, 500.0),
            solved(100.0, 500.0, |jump| rise(jump) >= 104.0),
        ),
        // Twice the height: at the top, the second jump is like the first.
        Threshold {
            nodes: 4_000,
            ..base(
                "a second jump in the air",
                small(
                    &runner(120.0, "when pressed(jump) -> second { y' := jump_speed }")
                        .replace("    initial mode", "    mode second { y'' = -512 }\n    initial mode"),
                    &format!("{ground}        place hero: Hero at (30, 32)"),
                    "hero.y >= 182",
                ),
                ("Hero.jump_speed", 100.0, 500.0),
                solved(100.0, 500.0, |jump| 2.0 * rise(jump) >= 150.0),
            )
        },
        // 320 px/s down after 40 steps; a share of it up, of which gravity takes 8 px/s in the same step.
        base(
            "a ball that bounces",
            "entity Ball {
    param spring: 1 = 0.5
    discrete bounces: int 0..3 = 0
    collider ball: rect(0, 0, 8, 8)
    y'' = -512
    mode only { when touching(ball, floor, below) and y' < 0 { y' := -spring * y'; bounces := min(bounces + 1, 3) } }
}
world Test {
    step 1/64
    collide ball with floor: block, keep velocity
    space main {
        rect floor (0, -16, 160, 16)
        place hero: Ball at (64, 100)
    }
    goal done: hero.bounces == 1 and hero.y >= 75
}
"
            .to_string(),
            ("Ball.spring", 0.4, 1.0),
            solved(0.4, 1.0, |spring| rise(320.0 * spring) >= 75.0),
        ),
        base(
            "a gate that is open for a time",
            small(
                &format!(
                    "{walker}entity Gate {{
    param stays: s = 0.1
    kinematic collider floor: rect(0, 0, 8, 60) when in shut
    collider late: rect(0, 0, 8, 60) when in over
    mode shut {{ when timer >= 2s -> open }}
    mode open {{ when timer >= stays -> over }}
    mode over {{ }}
}}
"
                ),
                "        place hero: Hero at (20, 20)\n        place gate: Gate at (80, 0)",
                "hero.x > 100",
            )
            .replace(
                "    player 1",
                "    collide player with late: sense\n    never late: hero touching late\n    player 1",
            ),
            ("Gate.stays", 0.1, 0.8),
            GATE,
        ),
        // The sum of n speeds, each A/64 more than the one before, for 1/64 s.
        Threshold {
            within: Some(64),
            ..base(
                "a car that accelerates",
                small(
                    "entity Hero {
    param pull = 60
    axis horizontal
    collider body: rect(0, 0, 12, 12)
    envelope x' by horizontal { attack accel pull; sustain 1000 }
}
",
                    "        place hero: Hero at (20, 20)",
                    "hero.x >= 120",
                ),
                ("Hero.pull", 50.0, 600.0),
                100.0 * 64.0 * 64.0 / (64.0 * 65.0 / 2.0),
            )
        },
        // 128 steps of 1/64 s.
        Threshold {
            within: Some(128),
            ..base(
                "an oven that heats",
                small(
                    "entity Hero {
    param heating = 10
    continuous heat: 1 = 0
    button on
    mode cold { when held(on) -> hot }
    mode hot { heat' = heating; when not held(on) -> cold }
}
",
                    "        place hero: Hero at (20, 20)",
                    "hero.heat >= 90",
                ),
                ("Hero.heating", 5.0, 100.0),
                45.0,
            )
        },
        // A pixel a step while there is fuel.
        base(
            "a rocket with fuel",
            small(
                "entity Hero {
    param tank: s = 1
    continuous used: s = 0
    button fire
    collider body: rect(0, 0, 12, 12)
    mode waiting { when held(fire) -> flying }
    mode flying {
        y' = 64
        used' = 1
        when used >= tank -> falling
    }
    mode falling { y' = -64 }
}
",
                "        place hero: Hero at (20, 0)",
                "hero.y >= 200",
            ),
            ("Hero.tank", 0.5, 5.0),
            // The 200th step is taken if less than all was used after 199.
            199.0 / 64.0,
        ),
        // 84 px in 128 steps, against the wind.
        Threshold {
            within: Some(128),
            ..base(
                "a wind that is too strong",
                small(
                    "entity Hero {
    param speed = 64
    param wind = 40
    axis horizontal
    collider body: rect(0, 0, 12, 12)
    x' = speed * horizontal - wind
}
",
                    "        place hero: Hero at (16, 20)",
                    "hero.x >= 100",
                ),
                ("Hero.wind", 0.0, 64.0),
                22.0,
            )
        },
        // The hero stands before the wall at x = 68.
        base(
            "a guard who sees so far",
            small(
                &format!(
                    "{walker}entity Guard {{
    param sight = 10
    mode calm {{ when near(any Hero, self, sight) -> alarmed }}
    mode alarmed {{ }}
}}
"
                ),
                "        rect floor (80, 0, 8, 60)\n        place hero: Hero at (20, 20)\n        place sentry: Guard at (120, 20)",
                "sentry in alarmed",
            ),
            ("Guard.sight", 5.0, 300.0),
            52.0,
        ),
    ]
}

/// For a gate: it opens in step 129, when the hero gets to x = 69. In the step in which it is over, the hero is at 69 and a
/// pixel more for each step that it stays; there, it has to be beyond 88, where it still touches.
const GATE: f64 = 19.0 / 64.0;

#[test]
fn thresholds_of_ten_worlds_are_found_from_both_sides() {
    let all = thresholds();
    assert_eq!(all.len(), 10);
    for Threshold { what, text, vary, nodes, within, known } in all {
        let found = tuned(&text, &[vary], |question| {
            (question.query.within, question.query.limits.nodes) = (within, nodes);
        });
        assert_near(&found, known, what);
        let (turned, before) = threshold(&found);
        assert_eq!(turned.verdict, Conclusion::Reached, "{what}");
        assert!(matches!(before.verdict, Conclusion::NotFound | Conclusion::ProvenUnreachable), "{what}: {before:?}");
    }
}

/// A value that is given where an instance is placed does not follow the default.
#[test]
fn a_given_value_stays() {
    let text = jumper(120.0, -900.0, 60.0, "hero.y >= 60").replace("at (16, 16)", "at (16, 16) { jump_speed = 150 }");
    let found = tuned(&text, &[("Hero.jump_speed", 100.0, 600.0)], |_| {});
    assert!(found.change.is_none());
    assert_eq!(found.parts.len(), 1, "{:?}", found.parts);
    assert_eq!((found.parts[0].from, found.parts[0].to), (100.0, 600.0));
}

// Tiles.

/// A level of text, whose rows are put into a program.
struct Rows<'t> {
    program: &'t str,
    rows: &'t [&'t str],
}

impl Rows<'_> {
    fn text(&self, edits: &[TileEdit]) -> String {
        let mut rows: Vec<Vec<char>> = self.rows.iter().map(|row| row.chars().collect()).collect();
        for edit in edits {
            let cell = &mut rows[edit.row - 1][edit.column - 1];
            assert_eq!(*cell, edit.from);
            *cell = edit.to;
        }
        let rows: Vec<String> = rows.into_iter().map(|row| row.into_iter().collect()).collect();
        self.program.replace("{MAP}", &rows.join("\n"))
    }
}

impl LevelHost for Rows<'_> {
    fn build(&self, edits: &[TileEdit]) -> Result<Built, String> {
        Texts(&self.text(edits)).build(&[])
    }

    fn watched(&self, _: &str, work: &mut dyn FnMut(&dyn Watch)) {
        work(&Unwatched);
    }

    fn is_stopped(&self) -> bool {
        false
    }
}

/// Walks from cell to cell.
const WALKER: &str = r#"
entity Walker {
    axis horizontal
    axis vertical
    collider body: rect(0, 0, 16, 16)
    mode walking {
        when touching(body at (0, 0), door) -> outside
        when horizontal > 0 and not touching(body at (16, 0), wall) { x += 16 }
        when horizontal < 0 and not touching(body at (-16, 0), wall) { x += -16 }
        when vertical > 0 and horizontal == 0 and not touching(body at (0, 16), wall) { y += 16 }
        when vertical < 0 and horizontal == 0 and not touching(body at (0, -16), wall) { y += -16 }
    }
    mode outside { }
}
world Maze {
    step 1/60
    collide body with wall: sense
    tiles maze 16 x 16 {
        '.': empty
        '#': wall
        'D': door
        '@': spawn Walker as walker
    }
    space main {
        map maze "
{MAP}
        "
    }
    player 1: walker
    goal out: walker in outside
}
"#;

/// What is found in a maze when walls can be removed or added.
fn in_maze(rows: &[&str], wanted: Wanted, change: TileChange, most: usize) -> TilesFound {
    let host = Rows { program: WALKER, rows };
    let edits = tile_edits(&host.build(&[]).unwrap(), change, Some('#')).unwrap();
    // The outer walls stay.
    let inside = |edit: &TileEdit| (2..rows.len()).contains(&edit.row) && (2..rows[0].len()).contains(&edit.column);
    let edits = edits.into_iter().filter(inside).collect();
    let query = Query { limits: Limits { nodes: 4_000, ..Limits::default() }, ..Query::new(vec![Target::Goal(GOAL)]) };
    let found = tune_tiles(&host, &TileQuestion { query, wanted, edits, most }).unwrap();
    if let Some(set) = &found.set {
        let built = host.build(&set.edits).unwrap();
        match &set.trial.inputs {
            Some(inputs) => {
                let sim = Simulator::new(&built.program, built.world);
                assert_leads_to(&sim, &script(&built.program, inputs), GOAL);
            }
            None => assert_eq!(set.trial.verdict, Conclusion::ProvenUnreachable),
        }
    }
    found
}

/// The number of walls between the walker and the door, of the way with the fewest.
fn walls_between(rows: &[&str]) -> usize {
    let cells: Vec<Vec<char>> = rows.iter().map(|row| row.chars().collect()).collect();
    let mut least = vec![vec![usize::MAX; cells[0].len()]; cells.len()];
    let find = |what: char| {
        let at = |(row, line): (usize, &Vec<char>)| Some((row, line.iter().position(|cell| *cell == what)?));
        cells.iter().enumerate().find_map(at).unwrap()
    };
    let (start, door) = (find('@'), find('D'));
    let mut open = vec![(start, 0)];
    while let Some(((row, column), walls)) = open.pop() {
        let is_inside = (1..cells.len() - 1).contains(&row) && (1..cells[0].len() - 1).contains(&column);
        let walls = walls + usize::from(cells[row][column] == '#');
        if !is_inside || least[row][column] <= walls {
            continue;
        }
        least[row][column] = walls;
        open.extend([(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)].map(|at| (at, walls)));
    }
    least[door.0][door.1]
}

#[test]
fn the_fewest_walls_are_removed() {
    let mazes: [&[&str]; 4] = [
        &["#######", "#@.#.D#", "#..#..#", "#######"],
        &["#########", "#@.#.#.D#", "#..#.#..#", "#########"],
        &["########", "#@#...D#", "#.######", "#.#....#", "########"],
        &["#########", "#@.##..D#", "#..##...#", "#..#.#..#", "#########"],
    ];
    for rows in mazes {
        let found = in_maze(rows, Wanted::Reached, TileChange::Remove, 2);
        let known = walls_between(rows);
        let set = found.set.unwrap_or_else(|| panic!("{rows:?}"));
        assert_eq!(set.edits.len(), known, "{rows:?}: {set:?}");
        assert_eq!(set.trial.verdict, Conclusion::Reached);
        assert!(set.is_fewest, "{rows:?}: {set:?}");
    }
    let thick: &[&str] = &["#########", "#@.###.D#", "#..###..#", "#########"];
    assert_eq!(walls_between(thick), 3);
    assert!(in_maze(thick, Wanted::Reached, TileChange::Remove, 2).set.is_none());
}

#[test]
fn the_fewest_walls_are_added() {
    let one: &[&str] = &["########", "#@.#..D#", "#......#", "#..#...#", "########"];
    let set = in_maze(one, Wanted::Prevented, TileChange::Add, 2).set.unwrap();
    assert_eq!((set.edits.len(), set.is_fewest), (1, true), "{set:?}");
    let two: &[&str] = &["########", "#@.#..D#", "#......#", "#......#", "########"];
    let set = in_maze(two, Wanted::Prevented, TileChange::Add, 2).set.unwrap();
    assert_eq!((set.edits.len(), set.is_fewest), (2, true), "{set:?}");
    let open = in_maze(two, Wanted::Reached, TileChange::Add, 2);
    assert!(open.set.is_none() && open.base.is_some_and(|base| base.verdict == Conclusion::Reached));
}

/// A step to jump from.
#[test]
fn a_step_is_added_under_a_jump() {
    let text = jumper(280.0, -900.0, 60.0, "hero.y >= 64")
        .replace("            ...\n            ...\n            .#.\n", "{MAP}\n");
    let text = text.replace("at (16, 16)", "at (32, 16)");
    let rows = ["........", "........", "........", "########"];
    let host = Rows { program: &text, rows: &rows };
    let edits = tile_edits(&host.build(&[]).unwrap(), TileChange::Add, None).unwrap();
    let query = Query { limits: Limits { nodes: 4_000, ..Limits::default() }, ..Query::new(vec![Target::Goal(GOAL)]) };
    let found = tune_tiles(&host, &TileQuestion { query, wanted: Wanted::Reached, edits, most: 2 }).unwrap();
    let set = found.set.unwrap();
    assert_eq!(set.edits.len(), 1, "{set:?}");
    assert_eq!(set.edits[0].to, '#', "{set:?}");
    assert_eq!(set.is_fewest, found.base.is_some_and(|base| base.verdict == Conclusion::ProvenUnreachable));
}

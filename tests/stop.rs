//! Everything can be stopped promptly, whatever a step costs, and accepts any number without a panic.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::support::{compile_text, program};
use hypedc::analysis::{GivenUp, configuration_space, watched_space};
use hypedc::compile::{LevelFile, compile_with};
use hypedc::diagnostic::render;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{Limits, Planner, Problem, Settings, Verdict, reach};
use hypedc::sim::{Input, Simulator};
use hypedc::source::{Files, ReadError};
use hypedc::watch::{Meter, WORK_PER_POLL, Watch};

const WORLD: WorldId = WorldId(0);

/// Counts polls, and stops the work after a number of them.
struct Counting {
    asked: AtomicU64,
    max_polls: u64,
}

impl Counting {
    fn new(max_polls: u64) -> Self {
        Counting { asked: AtomicU64::new(0), max_polls }
    }

    fn asked(&self) -> u64 {
        self.asked.load(Ordering::Relaxed)
    }
}

impl Watch for Counting {
    fn stop(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) + 1 >= self.max_polls
    }
}

/// A number of bodies in one place that push each other.
fn crowd(count: usize) -> Arc<Program> {
    let mut places = String::new();
    for i in 0..count {
        writeln!(places, "place b{i}: Ball at ({}, 0)", i % 7).unwrap();
    }
    program(compile_text(&format!(
        "entity Ball {{ button go; collider ball: rect(0, 0, 16, 16)
            mode a {{ x' = 10; when touching(ball, ball) -> b }}
            mode b {{ x' = if(held(go), -10, 5); when timer > 3frames -> a }} }}
         world W {{ collide ball with ball: sense
            space main {{ {places} }}; player 1: b0; goal far: b0.x > 100000 }}"
    )))
}

#[test]
fn a_step_counts_the_code_that_it_evaluates() {
    const EDGES: u64 = 20_000;
    const STEPS: u64 = 100;
    let edges: String = (0..EDGES).map(|i| format!("when x > {} -> a\n", i + 1)).collect();
    let p = program(compile_text(&format!(
        "entity A {{ mode a {{ {edges} }} }}
         world W {{ space main {{ place a: A at (0, 0) }} }}"
    )));
    let (sim, watch) = (Simulator::new(&p, WORLD), Counting::new(u64::MAX));
    let (meter, mut scratch) = (Meter::new(&watch), sim.scratch());
    let mut state = sim.initial(&mut scratch).unwrap();
    for _ in 0..STEPS {
        sim.metered_step(&mut state, &Input::nothing(0), &mut scratch, &meter).unwrap();
    }
    // At least a unit for each guard.
    assert!(watch.asked() >= STEPS * EDGES / WORK_PER_POLL, "{}", watch.asked());
}

#[test]
fn the_faces_of_piled_rectangles_are_work() {
    // Each rectangle lies around the one before, whose faces it covers.
    const RECTS: u64 = 3_000;
    let rects: String = (1..=RECTS)
        .map(|i| format!("rect wall ({}, {}, {}, {})\n", -10 * i as i64, -10 * i as i64, 20 * i, 20 * i))
        .collect();
    let p = program(compile_text(&format!(
        "entity A {{ collider body: rect(0, 0, 5, 5); mode a {{ x' = 1 }} }}
         world W {{ collide body with wall: block; space main {{ {rects} place a: A at (0, 0) }} }}"
    )));
    let sim = Simulator::new(&p, WORLD);
    let mut scratch = sim.scratch();
    let all = Counting::new(u64::MAX);
    sim.metered_initial(&mut scratch, &Meter::new(&all)).unwrap();
    assert!(all.asked() >= RECTS * RECTS / 2 / WORK_PER_POLL, "{}", all.asked());
    let second = Counting::new(2);
    let meter = Meter::new(&second);
    sim.metered_initial(&mut scratch, &meter).unwrap();
    assert!(meter.is_stopped() && second.asked() == 2);
}

#[test]
fn a_search_among_many_bodies_is_asked_by_work_done() {
    let p = crowd(150);
    let sim = Simulator::new(&p, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    let space = configuration_space(&p, WORLD);
    for planner in [Planner::Auto, Planner::Rrt, Planner::RgRrt, Planner::Exhaustive] {
        let watch = Counting::new(u64::MAX);
        let settings = Settings { planner, ..Settings::default() };
        let limits = Limits { nodes: 60, ..Limits::default() };
        let outcome = reach(&problem, &space, &settings, &limits, &watch).unwrap();
        let compared = outcome.statistics.steps * 150 * 149 / 2;
        let between = compared / watch.asked().max(1);
        assert!(between < 8 * WORK_PER_POLL, "{}: {between} comparisons between two questions", planner.name());
    }
}

#[test]
fn a_search_ends_soon_after_it_is_told() {
    let p = crowd(150);
    let sim = Simulator::new(&p, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    let space = configuration_space(&p, WORLD);
    for planner in [Planner::Auto, Planner::Rrt, Planner::RgRrt, Planner::Exhaustive, Planner::BestFirst] {
        let watch = Counting::new(3);
        let settings = Settings { planner, ..Settings::default() };
        let outcome = reach(&problem, &space, &settings, &Limits::default(), &watch).unwrap();
        assert!(matches!(outcome.verdict, Verdict::NotFound), "what is stopped proves nothing");
        let steps = outcome.statistics.steps * 150 * 149 / 2;
        assert!(steps < 32 * WORK_PER_POLL, "{}: {steps} comparisons after all", planner.name());
    }
}

#[test]
fn an_analysis_that_is_stopped_knows_nothing() {
    let p = crowd(12);
    let all = Counting::new(u64::MAX);
    watched_space(&p, WORLD, &[], &all);
    assert!(all.asked() > 2);
    let max_polls = std::iter::successors(Some(1), |p| Some(p * 3)).take_while(|p| *p < all.asked());
    for max_polls in max_polls.chain([all.asked()]) {
        let watch = Counting::new(max_polls);
        let space = watched_space(&p, WORLD, &[], &watch);
        assert!(space.slots.iter().all(|s| s.why == Some(GivenUp::Stopped)), "after {max_polls} questions");
        assert!(space.can_hold(&p, WORLD, GoalId(0)));
        assert!(watch.asked() <= max_polls + 2, "it ends at once");
    }
}

/// A level beside a program.
struct Beside<'a>(&'a str, &'a str);

impl Files for Beside<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        match path.to_str() {
            Some("test.hyped") => Ok(self.0.to_string()),
            Some("level.ldtk" | "level.tmj") => Ok(self.1.to_string()),
            _ => Err(ReadError::Unreadable("no such file".into())),
        }
    }
}

/// A program is refused, or analysed, run and searched.
fn answered(text: &str, level: Option<(&str, &str)>) {
    let (path, content) = level.unzip();
    let given = LevelFile { map: path.map(Path::new), ..LevelFile::default() };
    let compiled = compile_with(Path::new("test.hyped"), given, &Beside(text, content.unwrap_or_default()));
    let shown = render::human(&compiled.sources, compiled.diagnostics.iter(), false);
    let Some(p) = compiled.program else {
        assert!(!shown.is_empty());
        return;
    };
    let sim = Simulator::new(&p, WORLD);
    let mut scratch = sim.scratch();
    let Ok(mut state) = sim.initial(&mut scratch) else { return };
    for _ in 0..20 {
        if sim.step(&mut state, &Input::nothing(p.worlds[WORLD].players.len()), &mut scratch).is_err() {
            break;
        }
    }
    let space = configuration_space(&p, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    for planner in [Planner::Auto, Planner::RgRrt] {
        let settings = Settings { planner, ..Settings::default() };
        let limits = Limits { nodes: 40, ..Limits::default() };
        let _ = reach(&problem, &space, &settings, &limits, &hypedc::watch::Unwatched);
    }
}

#[test]
fn a_step_among_thousands_ends_soon_after_it_is_told() {
    let p = crowd(1_500);
    let sim = Simulator::new(&p, WORLD);
    let mut scratch = sim.scratch();
    let watch = Counting::new(1);
    let meter = Meter::new(&watch);
    sim.metered_initial(&mut scratch, &meter).unwrap();
    let pairs = 1_500 * 1_499 / 2;
    assert!(meter.is_stopped() && scratch.work() < pairs / 4, "{} of {pairs} pairs", scratch.work());
    // This one is never stopped: it polls continuously.
    let mut state = sim.initial(&mut scratch).unwrap();
    let watch = Counting::new(u64::MAX);
    let meter = Meter::new(&watch);
    sim.metered_step(&mut state, &Input::nothing(1), &mut scratch, &meter).unwrap();
    assert!(watch.asked() >= pairs / WORK_PER_POLL, "{}", watch.asked());
}

#[test]
fn a_search_among_thousands_ends_soon_after_it_is_told() {
    let p = crowd(1_500);
    let sim = Simulator::new(&p, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    let space = watched_space(&p, WORLD, &[], &Counting::new(1));
    for planner in [Planner::Auto, Planner::Rrt, Planner::RgRrt, Planner::Exhaustive] {
        let settings = Settings { planner, ..Settings::default() };
        let outcome = reach(&problem, &space, &settings, &Limits::default(), &Counting::new(3)).unwrap();
        assert_eq!(outcome.verdict, Verdict::NotFound, "{}", planner.name());
        assert!(outcome.statistics.steps < 5, "{}: {} steps", planner.name(), outcome.statistics.steps);
    }
}

#[test]
fn what_is_met_is_asked_of_by_work_done() {
    // Each has its own parameter, so all of them are analysed.
    let places: String = (0..700).map(|i| format!("place b{i}: Ball at ({i}, 0) {{ speed = {i} }}\n")).collect();
    let p = program(compile_text(&format!(
        "entity Ball {{ param speed = 1; collider ball: rect(0, 0, 16, 16); mode a {{ x' = speed }} }}
         world W {{ collide ball with ball: block, carry; space main {{ {places} }} }}"
    )));
    // The kinds are compared pair by pair, before anything moves.
    let watch = Counting::new(1);
    let space = watched_space(&p, WORLD, &[], &watch);
    assert!(watch.asked() > 0);
    assert!(space.slots.iter().all(|slot| slot.why == Some(GivenUp::Stopped)));
}

#[test]
fn places_are_flooded_by_work_done() {
    let row: String = ".#.#..".repeat(40);
    let map: String = (0..200).map(|y| format!("{}\n", &row[y % 3..])).collect();
    let widest = map.lines().map(str::len).min().unwrap();
    let map: String = map.lines().map(|line| format!("{}\n", &line[..widest])).collect();
    let p = program(compile_text(&format!(
        "entity Ball {{ button go; collider ball: rect(0, 0, 8, 8); mode a {{ x' = if(held(go), 60, -60) }} }}
         world W {{ collide ball with wall: block; tiles t 16 x 16 {{ '.': empty\n'#': wall }}
            space main {{ map t \"\n{map}\"\nplace b: Ball at (4, 4) }}; player 1: b; goal far: b.x > 100000 }}"
    )));
    let asked = |max_polls| {
        let watch = Counting::new(max_polls);
        let space = watched_space(&p, WORLD, &[], &watch);
        (watch.asked(), space.slots.iter().all(|slot| slot.why == Some(GivenUp::Stopped)))
    };
    let (all, is_given_up) = asked(u64::MAX);
    assert!(all > 2 && !is_given_up, "{all} questions");
    for max_polls in 1..all.min(8) {
        let (asked, is_given_up) = asked(max_polls);
        assert!(is_given_up && asked < max_polls + 4, "{asked} questions, told at {max_polls}");
    }
}

/// A number as a program may have it: words are short.
fn literal(number: f64) -> String {
    let part: f64 = if number.abs() > 1e200 { 1e108 } else { 1e-150 };
    match number == 0.0 || (1e-200..1e200).contains(&number.abs()) {
        true => number.to_string(),
        false => format!("({} * {part})", number / part),
    }
}

/// The numbers that are inserted.
const EXTREMES: [f64; 7] = [1e308, -1e308, 1e30, 1e11, 1e-300, -0.0, 5e-324];

#[test]
fn any_number_anywhere_is_taken_or_refused() {
    // Each `#` is a number.
    let text = "entity Hero { button go; param speed = #80
        collider body: rect(#0, #0, #16, #16)
        collider ring: circle(#4, #4, #4)
        continuous z = #3
        clamp y' in -200..#200
        mode a { x' = if(held(go), speed, -speed); y'' = #-400; z' = #2; when touching(body, wall) -> b { x := #5 } }
        mode b { x'' = #9; y' = #7; when timer > 2frames -> a; follow links } }
        world W { collide body with wall: block; collide ring with wall: sense
        tiles t #16 x #16 { '.': empty; '_': wall }
        space main { map t \"\n....\n.__.\n____\n\"
        rect wall (#0, #80, #99, #8)
        bounds rect(#0, #0, #64, #48)
        place hero: Hero at (#8, #32) { speed = #70; y' = #1 }
        link rect(#0, #0, #8, #8) -> other at rect(#0, #0, #8, #8) }
        space other { rect wall (#0, #-8, #99, #8) }
        player 1: hero
        goal g: near(hero, (#50, #40), #8) and hero.z < #99 }";
    let parts: Vec<&str> = text.split('#').collect();
    let is_number = |part: &&str| part.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    let numbers: Vec<usize> = (1..parts.len()).filter(|i| is_number(&parts[*i])).collect();
    assert!(numbers.len() > 30);
    let plain = text.replace('#', "");
    let compiled = compile_text(&plain);
    let shown = render::human(&compiled.sources, compiled.diagnostics.iter(), false);
    assert!(compiled.program.is_some(), "{shown}");
    for &at in &numbers {
        for extreme in EXTREMES {
            let mut out = parts[0].to_string();
            for (i, part) in parts.iter().enumerate().skip(1) {
                let rest = part.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-');
                match (i == at, is_number(part)) {
                    (true, _) => write!(out, "{}{rest}", literal(extreme)).unwrap(),
                    (_, true) => out.push_str(part),
                    (_, false) => out.push_str(part),
                }
            }
            answered(&out, None);
        }
    }
}

#[test]
fn any_number_in_a_level_is_taken_or_refused() {
    let text = "entity H { collider body: rect(0, 0, 16, 16); mode m { x' = 10 } }
        entity Slime { collider e: rect(0, 0, 8, 8) }
        world W { collide body with wall, e: block
        space main { map level
        place h: H at (16, 16) }
        player 1: h; goal g: h.x > 1000 }";
    let ldtk = "{ \"jsonVersion\": \"1.5.3\", \"defs\": { \"layers\": [{ \"uid\": 7, \"intGridValues\":
        [{ \"value\": 1, \"identifier\": \"wall\" }] }] }, \"levels\": [{ \"identifier\": \"A\", \"layerInstances\":
        [{ \"__identifier\": \"Ground\", \"__type\": \"IntGrid\", \"layerDefUid\": 7, \"__cWid\": 3, \"__cHei\": 2,
        \"__gridSize\": SIDE, \"intGridCsv\": [0,0,0,1,1,1] }, { \"__identifier\": \"Things\", \"__type\": \"Entities\",
        \"__cWid\": 3, \"__cHei\": 2, \"__gridSize\": SIDE, \"__pxTotalOffsetX\": MOVED,
        \"entityInstances\": [{ \"__identifier\": \"Slime\", \"px\": [AT, AT], \"width\": SIZE, \"height\": SIZE,
        \"__pivot\": [1, 1], \"fieldInstances\": [] }] }] }] }";
    for part in ["SIDE", "MOVED", "AT", "SIZE"] {
        for extreme in EXTREMES {
            let rest = [("SIDE", "16"), ("MOVED", "0"), ("AT", "8"), ("SIZE", "8")];
            let level = ldtk.replace(part, &extreme.to_string());
            let level = rest.iter().fold(level, |level, (name, value)| level.replace(name, value));
            answered(text, Some(("level.ldtk", &level)));
        }
    }
    let far = compile_with(
        Path::new("test.hyped"),
        LevelFile { map: Some(Path::new("level.ldtk")), ..LevelFile::default() },
        &Beside(text, &ldtk.replace("SIDE", "1e300").replace("MOVED", "0").replace("AT", "8").replace("SIZE", "8")),
    );
    let found = render::short(&far.sources, far.diagnostics.iter());
    assert!(found.contains("E0507") && found.contains("at most 1000000000000 px"), "{found}");
}

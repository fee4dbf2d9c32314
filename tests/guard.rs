//! The monitor checks every state of a search against the analysis: nothing lies outside; after a violation, nothing is
//! proven.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{create_dir_all, read_dir, read_to_string, remove_dir_all, write};
use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, compile_text, files, program, script};
use hypedc::analysis::{ConfigurationSpace, configuration_space};
use hypedc::cli::answer_by_analysis_of;
use hypedc::compile::compile;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{
    Argument, Conclusion, Limits, Monitor, Outcome, Planner, Problem, Settings, Style, Verdict, improve_duration,
    reach, search, shorten,
};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);
const FAST: GoalId = GoalId(0);
const FAR: GoalId = GoalId(1);

fn limits(nodes: u64) -> Limits {
    Limits { nodes, ..Limits::default() }
}

#[test]
fn nothing_that_a_search_makes_lies_outside() {
    let mut paths = files("tests/analysis/found", "hyped");
    paths.extend(["test1", "test2"].map(|name| Path::new("examples/paper").join(format!("{name}.hyped"))));
    paths.extend(["balloon", "link"].map(|name| Path::new("examples").join(format!("{name}.hyped"))));
    let mut checked = 0;
    for path in paths {
        let program = program(compile(&path, &Disk));
        for world in program.worlds.ids().filter(|w| program.worlds[*w].open.is_none()) {
            let space = configuration_space(&program, world);
            let sim = Simulator::new(&program, world);
            for (goal, planner) in program.worlds[world].goals.ids().zip([Planner::Auto, Planner::Exhaustive]) {
                let problem = Problem::new(&sim, goal);
                let settings = Settings { planner, ..Settings::default() };
                let Ok(outcome) = search(&problem, &space, &settings, &limits(1_500), &Unwatched) else { continue };
                assert_eq!(outcome.refuted, None, "{}", path.display());
                assert_eq!(outcome.statistics.checked, outcome.statistics.nodes, "{}", path.display());
                checked += outcome.statistics.checked;
            }
        }
    }
    assert!(checked > 5_000, "{checked} states were looked at");
}

/// A program whose player walks at a speed.
fn source(speed: u32) -> String {
    format!(
        "entity Walker {{
            button go
            mode still {{ x' = 0; when held(go) -> moving }}
            mode moving {{ x' = {speed} }}
        }}
        world Field {{
            space main {{ place walker: Walker at (0, 0) }}
            player 1: walker
            goal fast: walker.x' > 50
            goal far: walker.x > 40
        }}\n"
    )
}

fn walker(speed: u32) -> Arc<Program> {
    program(compile_text(&source(speed)))
}

/// A fast walker, with the configuration space of a slow one: a wrong analysis.
fn wrong() -> (Arc<Program>, ConfigurationSpace) {
    (walker(60), configuration_space(&walker(30), WORLD))
}

fn ask(problem: &Problem<'_>, space: &ConfigurationSpace, settings: &Settings) -> Outcome {
    reach(problem, space, settings, &limits(500), &Unwatched).unwrap()
}

#[test]
fn whatever_searches_finds_what_is_outside() {
    let (program, space) = wrong();
    let sim = Simulator::new(&program, WORLD);
    for planner in Planner::ALL {
        let settings = Settings { planner, ..Settings::default() };
        let outcome = ask(&Problem::new(&sim, FAR), &space, &settings);
        assert!(matches!(outcome.verdict, Verdict::Reached(_)), "{planner:?}: what was found was replayed");
        let refuted = outcome.refuted.unwrap();
        assert_eq!(refuted.steps, refuted.script.len());
        let beyond = &refuted.outside.beyond[0];
        let found = [&refuted.outside.instance, &beyond.variable, &beyond.value, &beyond.allowed];
        assert_eq!(found, ["walker", "x'", "60", "30"], "{planner:?}");
        // The first state of the path that is outside, and none before.
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let monitor = Monitor::new(&space, &program, WORLD);
        for input in refuted.script.inputs() {
            assert_eq!(monitor.outside(&sim, &state), None);
            sim.step(&mut state, input, &mut scratch).unwrap();
        }
        assert_eq!(monitor.outside(&sim, &state), Some(refuted.outside));
    }
}

#[test]
fn a_refuted_analysis_proves_nothing() {
    let (program, space) = wrong();
    let sim = Simulator::new(&program, WORLD);
    let monitor = Monitor::new(&space, &program, WORLD);
    let of = |goal: GoalId| Problem::new(&sim, goal).monitored(&monitor);
    let settings = Settings::default();
    // Without a check, it is proven.
    let mut before = ask(&of(FAST), &space, &settings);
    assert!(matches!(before.verdict, Verdict::Unreachable(Argument::Analysis(_))));
    assert!(before.rests_on_analysis() && before.refuted.is_none());
    assert!(ask(&of(FAR), &space, &settings).refuted.is_some());
    before.refute(&monitor.refutation().unwrap());
    assert_eq!((&before.verdict, before.is_withdrawn), (&Verdict::NotFound, true));
    let after = ask(&of(FAST), &space, &settings);
    assert_eq!((&after.verdict, after.is_withdrawn), (&Verdict::NotFound, true));
    assert_eq!(after.refuted, monitor.refutation());
}

#[test]
fn the_way_to_where_a_search_begins_is_looked_at() {
    let (program, space) = wrong();
    let sim = Simulator::new(&program, WORLD);
    let problem = Problem::new(&sim, FAST).after(script(&program, "-*3 go*2")).unwrap();
    let outcome = ask(&problem, &space, &Settings::default());
    assert_eq!((&outcome.verdict, outcome.is_withdrawn), (&Verdict::NotFound, true));
    assert_eq!(outcome.refuted.unwrap().script, script(&program, "-*3 go"), "the first that is outside");
    let unchecked = ask(&problem, &space, &Settings { checks: false, ..Settings::default() });
    assert!(unchecked.rests_on_analysis() && unchecked.refuted.is_none());
    assert_eq!(unchecked.statistics.checked, 0);
}

#[test]
fn replayed_ways_are_looked_at() {
    let (program, space) = wrong();
    let sim = Simulator::new(&program, WORLD);
    let unchecked = Settings { checks: false, ..Settings::default() };
    let Verdict::Reached(plan) = ask(&Problem::new(&sim, FAR), &space, &unchecked).verdict else { panic!() };
    for way in [0, 1] {
        let monitor = Monitor::new(&space, &program, WORLD);
        let problem = Problem::new(&sim, FAR).monitored(&monitor);
        match way {
            0 => drop(shorten(&problem, &space, &plan, Style::Fast, &Unwatched)),
            _ => drop(improve_duration(&problem, &space, &unchecked, &limits(500), &plan, &Unwatched)),
        }
        assert!(monitor.refutation().is_some(), "{way}");
    }
}

#[test]
fn who_searches_side_by_side_does_not_matter() {
    let (program, space) = wrong();
    let sim = Simulator::new(&program, WORLD);
    let of = |threads: usize| {
        let settings = Settings { trees: 4, threads, ..Settings::default() };
        ask(&Problem::new(&sim, FAR), &space, &settings).refuted.unwrap()
    };
    assert_eq!(of(1), of(3));
}

/// The analysis of a slower world simulates a wrong analysis.
#[test]
fn a_wrong_analysis_is_told_kept_and_fails_the_command() {
    let folder = std::env::temp_dir().join(format!("hypedc-refuted-{}", std::process::id()));
    create_dir_all(&folder).unwrap();
    let (slow, fast) = (folder.join("slow.hyped"), folder.join("fast.hyped"));
    write(&slow, source(30)).unwrap();
    write(&fast, source(60)).unwrap();
    let answer = |file: &Path, more: &[&str]| {
        let arguments = ["hypedc", "reach", file.to_str().unwrap(), "--nodes", "500"];
        answer_by_analysis_of(&slow, &[&arguments, more].concat()).unwrap().unwrap()
    };
    let written = || {
        let names = read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name.ends_with(".txt")).collect();
        names.sort();
        names
    };

    let (is_yes, verdict, _) = answer(&slow, &[]);
    assert_eq!((is_yes, verdict), (false, Conclusion::ProvenUnreachable));
    assert!(written().is_empty(), "of itself, it is right");

    let (is_yes, verdict, text) = answer(&fast, &[]);
    assert_eq!((is_yes, verdict), (false, Conclusion::NotAnswered));
    assert!(text.contains("the analysis is wrong about this world"));
    // The answer is the expected one, but the analysis is refuted.
    assert!(!answer(&fast, &["--goal", "far", "--seed", "7"]).0);
    assert!(answer(&fast, &["--goal", "far", "--no-check-states"]).0);
    assert!(!answer(&fast, &["--goal", "far", "--format", "json"]).0);
    let first = "hypedc-refuted-Field-1.txt";
    assert_eq!(written(), ["hypedc-refuted-Field-1-2.txt", first, "hypedc-refuted-Field-7.txt"]);
    let text = read_to_string(folder.join(first)).unwrap();
    for part in ["walker in moving: x' is 60, allowed is 30", "world    Field", "seed     1"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(text.lines().any(|line| line.starts_with("inputs   ") && line.ends_with("go")), "{text}");
    remove_dir_all(&folder).unwrap();
}

//! Shortcuts: ways are freed of loops and led past detours, and of what they were needed for nothing is lost.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;

use crate::support::{Disk, assert_leads_to, compile_text, program, script};
use hypedc::compile::{LevelFile, compile_with};
use hypedc::ir::WorldId;
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Effort, Plan, Problem, Settings, Target, Verdict, plan_from_script, search, take_shortcuts};
use hypedc::sim::Simulator;
use hypedc::watch::{PollLimit, Unwatched};

const WORLD: WorldId = WorldId(0);

/// A walker on two floors with a pit between them. To the left lies a key, at the right end is a gate, which is open for a
/// second of every three.
const FLOORS: &str = "
    entity Walker {
        param speed: px/s = 80
        axis horizontal
        button jump
        discrete keys: int 0..1 = 0
        collider body: rect(0, 0, 12, 16)
        condition stands = touching(body, wall, below)
        mode alive {
            when touching(body, item) and keys == 0 { keys := 1 }
            initial mode ground {
                x' = speed * horizontal
                y' = 0
                when pressed(jump) -> air { y' := 240 }
                when not stands -> air
            }
            mode air {
                x' = speed * horizontal
                y'' = -700
                when stands and y' <= 0 -> ground
            }
        }
    }
    entity Key {
        collider item: rect(0, 0, 8, 8)
        x' = 0
        y' = 0
    }
    entity Gate {
        collider bars, wall: rect(0, 0, 8, 48) when in shut
        x' = 0
        y' = 0
        initial mode shut { when timer >= 2s -> open }
        mode open { when timer >= 1s -> shut }
    }
    world W { step 1/60
        collide body with wall: block
        collide body with item: sense
        tiles t 16 x 16 { '.': empty; '#': wall }
        space main {
            map t \"
                ########################
                #......................#
                #......................#
                #......................#
                ##########..############
            \"
            bounds rect(0, 0, 384, 80)
            place hero: Walker at (100, 16)
            place key: Key at (20, 18)
            place gate: Gate at (300, 16)
        }
        player 1: hero
        goal flag: hero.x > 260
        goal both: hero.x > 260 and hero.keys == 1
        goal behind: hero.x > 320
    }";

/// A question, with the plan that inputs are for it after some others.
fn planned<'s>(sim: &'s Simulator, goal: &str, [after, inputs]: [&str; 2], min_hold: u16) -> (Problem<'s>, Plan) {
    let program = sim.program();
    let goal = program.worlds[WORLD].goals.pairs().find(|(_, g)| g.name == goal).unwrap().0;
    let given = script(program, after);
    let query = Query { after: vec![given.clone()], min_hold, ..Query::new(vec![Target::Goal(goal)]) };
    let problem = query.problem(sim, Target::Goal(goal), &Unwatched).unwrap().unwrap();
    let whole = script(program, &format!("{after} {inputs}"));
    let plan = plan_from_script(&problem, &whole, given.len(), &Unwatched).unwrap();
    (problem, plan)
}

/// The plan after shortcuts, which leads to the goal with the inputs that were given and those of the plan.
fn shorter(problem: &Problem<'_>, plan: &Plan, effort: Effort) -> Plan {
    let taken = take_shortcuts(problem, plan, effort, &Unwatched);
    let replayed = plan_from_script(problem, &taken.script, plan.after, &Unwatched).unwrap();
    assert_eq!((replayed.steps, taken.script.len(), taken.after), (taken.steps, taken.steps, plan.after));
    assert!(taken.steps <= plan.steps);
    assert_eq!(taken.script.first(plan.after), plan.script.first(plan.after), "what was given stays");
    assert!(taken.script.steps.iter().all(|part| plan.script.steps.iter().any(|other| other.input == part.input)));
    taken
}

#[test]
fn loops_and_detours_are_left_out() {
    let program = program(compile_text(FLOORS));
    let sim = Simulator::new(&program, WORLD);
    // 160 px at 80 px/s, over the pit.
    let direct = "right*41 right+jump*90";
    for detour in ["left*30 right*30", "-*90", "jump*2 -*60", "left*15 left+jump*30 -*12 right*45"] {
        let (problem, plan) = planned(&sim, "flag", ["right*5 left*5", &format!("{detour} {direct}")], 1);
        let brief = shorter(&problem, &plan, Effort::Brief(10_000));
        let thorough = shorter(&problem, &plan, Effort::Thorough);
        assert!(plan.steps - plan.after >= 180 && brief.steps - brief.after <= 124, "{detour}: {}", brief.steps);
        assert!(thorough.steps <= brief.steps, "{detour}: {}", thorough.steps);
    }
}

#[test]
fn what_a_detour_was_for_stays() {
    let program = program(compile_text(FLOORS));
    let sim = Simulator::new(&program, WORLD);
    let (problem, plan) = planned(&sim, "both", ["", "right*30 left*92 right*103 right+jump*120"], 1);
    let taken = shorter(&problem, &plan, Effort::Thorough);
    // To the key and back: 72 and 232 px.
    assert!(plan.steps > 290 && (225..=244).contains(&taken.steps), "{} {}", plan.steps, taken.steps);
    let (problem, plan) = planned(&sim, "behind", ["", "left*20 right*61 right+jump*220"], 1);
    let taken = shorter(&problem, &plan, Effort::Thorough);
    // The gate is shut for two seconds, and 32 px are left then.
    assert!(plan.steps >= 230 && (144..=200).contains(&taken.steps), "{} {}", plan.steps, taken.steps);
}

#[test]
fn inputs_are_held_for_their_minimum_time() {
    let program = program(compile_text(FLOORS));
    let sim = Simulator::new(&program, WORLD);
    let (problem, plan) = planned(&sim, "flag", ["", "left*20 right*40 left*20 right*41 right+jump*90"], 20);
    let taken = shorter(&problem, &plan, Effort::Thorough);
    assert!(taken.steps < plan.steps, "{}", taken.steps);
    let held = &taken.script.steps[..taken.script.steps.len() - 1];
    assert!(held.iter().all(|part| part.count >= 20), "{held:?}");
}

#[test]
fn a_stop_loses_nothing() {
    let program = program(compile_text(FLOORS));
    let sim = Simulator::new(&program, WORLD);
    let (problem, plan) = planned(&sim, "flag", ["", "left*30 right*71 right+jump*90"], 1);
    for polls in 0..12 {
        let taken = take_shortcuts(&problem, &plan, Effort::Thorough, &PollLimit::new(polls));
        let replayed = plan_from_script(&problem, &taken.script, 0, &Unwatched).unwrap();
        assert!(replayed.steps == taken.steps && taken.steps <= plan.steps, "{polls}");
    }
}

#[test]
fn ways_through_levels_do_not_go_round_in_circles() {
    for (program_file, map) in [("kid-icarus/kid_icarus", "kidicarus_1"), ("mega-man/mega_man", "megaman_1_4")] {
        let file = Path::new("examples").join(format!("{program_file}.hyped"));
        let map = file.with_file_name(format!("{map}.txt"));
        let level = LevelFile { map: Some(&map), ..LevelFile::default() };
        let program = program(compile_with(&file, level, &Disk));
        let (goal, _) = program.worlds[WORLD].goals.pairs().find(|(_, g)| g.name == "end").unwrap();
        let query = Query::new(vec![Target::Goal(goal)]);
        let (settings, limits) = (Settings { hastens: false, ..query.settings }, query.limits);
        let session = Session::new(&program, WORLD, query, &Unwatched);
        let found = session.find(Target::Goal(goal), &Unwatched).unwrap();
        let Verdict::Reached(plan) = found.outcome.verdict else { panic!("not found") };
        assert_leads_to(session.simulator(), &plan.script, goal);
        let problem = Problem::new(session.simulator(), goal);
        let outcome = search(&problem, session.space(), &settings, &limits, &Unwatched).unwrap();
        let Verdict::Reached(first) = outcome.verdict else { panic!("not found") };
        let taken = shorter(&problem, &first, Effort::Brief(outcome.statistics.steps));
        assert!(taken.steps * 5 < first.steps * 4, "{} of {}", taken.steps, first.steps);
        assert!(plan.steps * 5 < first.steps * 4, "{} of {}", plan.steps, first.steps);
    }
}

//! No answer that a replay denies: in random worlds, the bare simulator replays the inputs of each nearest state, of each
//! change that turns an answer, and of each way to where one gets stuck; from there, random inputs never arrive.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::analysis::generate as lively;
use crate::oracle::generate as tiny;
use crate::support::{Text, script_of, sized, stir};
use hypedc::analysis::configuration_space;
use hypedc::compile::{Asked, Changes, Compilation, ExtraQuestion, NumberSetting, compile_changed, written_number};
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::stuck::{CandidateLimits, find_candidates, find_stuck};
use hypedc::reach::why_not::{PartState, Point};
use hypedc::reach::{Conclusion, Limits, Problem, Settings, Target};
use hypedc::sim::{Input, Script, Simulator, State};
use hypedc::tune::{Axis, Built, Host, Question, Wanted, tune};
use hypedc::watch::{Unwatched, Watch};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const WORLD: WorldId = WorldId(0);
const GOAL: GoalId = GoalId(0);

/// Random programs that are valid, each with the seed of its choices.
fn programs(count: u64, generate: fn(&[u16]) -> String) -> impl Iterator<Item = (u64, String, Built)> {
    (1..=count).filter_map(move |seed| {
        let mut rng = Pcg64::seed_from_u64(seed);
        let choices: Vec<u16> = (0..rng.random_range(40..500)).map(|_| rng.random()).collect();
        let text = generate(&choices);
        let built = compiled(&text, &[], &[]).ok()?;
        (!built.program.worlds[WORLD].goals.is_empty()).then_some((seed, text, built))
    })
}

fn compiled(text: &str, numbers: &[NumberSetting<'_>], questions: &[ExtraQuestion<'_>]) -> Result<Built, String> {
    let changes = Changes { numbers, questions, ..Changes::default() };
    let Compilation { sources, program, diagnostics, .. } =
        compile_changed(Path::new("test.hyped"), Default::default(), &changes, &Text(text));
    let program = program.filter(|program| !program.worlds.is_empty()).ok_or_else(|| format!("{diagnostics:?}"))?;
    Ok(Built { sources, program, world: WORLD })
}

fn limits(nodes: u64) -> Limits {
    Limits { nodes, ..Limits::default() }
}

/// Runs a script: no run is over before its last step. The state after it, unless a step breaks a rule.
fn after(sim: &Simulator, script: &Script, what: &str) -> Option<State> {
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).ok()?;
    for input in script.inputs() {
        assert!(!is_over(sim, &state), "{what}: the run is over before");
        sim.step(&mut state, input, &mut scratch).unwrap_or_else(|fault| panic!("{what}: {fault:?}"));
    }
    Some(state)
}

fn is_over(sim: &Simulator, state: &State) -> bool {
    sim.violated(state).unwrap().is_some() || sim.left_bounds(state).is_some()
}

/// Whether a goal holds in the state after a script that is written as text.
fn arrives(program: &Arc<Program>, goal: GoalId, inputs: &str, what: &str) -> bool {
    let sim = Simulator::new(program, WORLD);
    let state = after(&sim, &script_of(program, WORLD, inputs), what).unwrap();
    sim.goal(&state, goal).unwrap() && sim.left_bounds(&state).is_none()
}

/// The state of a nearest miss has what is said of it, and the goal does not hold there.
fn confirm(text: &str, (program, goal): (&Arc<Program>, GoalId), at: &Point, parts: &[&PartState], what: &str) {
    let what = format!("{what}: `{}`", at.inputs);
    let asked: BTreeMap<&str, bool> =
        parts.iter().filter(|part| !part.text.is_empty()).map(|part| (&*part.text, part.holds)).collect();
    let question = |text| ExtraQuestion { asked: Asked::Goal, world: None, text, origin: "part" };
    let questions: Vec<ExtraQuestion<'_>> = asked.keys().copied().map(question).collect();
    let built = compiled(text, &[], &questions).unwrap_or_else(|why| panic!("{what}: {why}"));
    let sim = Simulator::new(&built.program, WORLD);
    let script = script_of(program, WORLD, &at.inputs);
    assert_eq!(script.len(), at.step, "{what}");
    let state = after(&sim, &script, &what).unwrap();
    assert!(!is_over(&sim, &state), "{what}");
    assert!(!sim.goal(&state, goal).unwrap(), "{what}: the goal holds");
    if let Some(player) = sim.world().players.iter().next() {
        assert_eq!(sim.position(&state, player.slot), (at.x, at.y), "{what}");
    }
    for (part, holds) in asked {
        let id = sim.world().goal_named(part).unwrap_or_else(|| panic!("{what}: {part}"));
        // What breaks a rule does not hold.
        assert_eq!(sim.goal(&state, id).unwrap_or(false), holds, "{what}: {part}");
    }
}

#[test]
fn nearest_states_are_as_the_simulator_says() {
    let (mut reached, mut near) = (0, 0);
    let all = programs(sized(60, 2_000), tiny::program).chain(programs(sized(25, 500), lively::program));
    for (seed, text, Built { sources, program, .. }) in all {
        for goal in program.worlds[WORLD].goals.ids().take(2) {
            let target = Target::Goal(goal);
            let mut query = Query::new(vec![target]);
            query.settings = Settings { explains: true, seed, ..Settings::default() };
            query.limits = limits(200);
            let session = Session::new(&program, WORLD, query, &Unwatched);
            let Ok(mut found) = session.find(target, &Unwatched) else { continue };
            let answer = session.answer(&mut found, &sources);
            let what = format!("{text}\nseed {seed}, goal {goal:?}, {:?}", answer.verdict);
            if let Some(inputs) = answer.inputs.as_ref().filter(|_| answer.verdict == Conclusion::Reached) {
                assert!(arrives(&program, goal, inputs, &what), "{what}: {inputs}");
                reached += 1;
            }
            let Some(why) = &answer.why_not else { continue };
            let nearest = why.nearest.iter().map(|nearest| (&nearest.at, nearest.parts.iter().collect::<Vec<_>>()));
            let each = why.parts.iter().filter_map(|part| Some((part.at.as_ref()?, vec![&part.part])));
            for (at, parts) in nearest.chain(each) {
                assert!(parts.len() < 2 || parts.iter().any(|part| !part.holds), "{what}: all parts hold");
                confirm(&text, (&program, goal), at, &parts, &what);
                near += 1;
            }
        }
    }
    assert!(reached > 20 && near > 40, "{reached} reached, {near} near");
}

/// Compiles a text with some numbers.
struct Texts<'t>(&'t str);

impl Host for Texts<'_> {
    fn build(&self, numbers: &[NumberSetting<'_>]) -> Result<Built, String> {
        compiled(self.0, numbers, &[])
    }

    fn watched(&self, _: &str, work: &mut dyn FnMut(&dyn Watch)) {
        work(&Unwatched);
    }

    fn is_stopped(&self) -> bool {
        false
    }
}

#[test]
fn changes_turn_answers_as_the_simulator_says() {
    let (mut ways, mut parts) = (0, 0);
    let all = programs(sized(60, 1_000), tiny::program).chain(programs(sized(15, 300), lively::program));
    for (seed, text, _) in all {
        let mut rng = Pcg64::seed_from_u64(seed);
        let paths = match text.contains("param s:") {
            true => ["Hero.s", "Hero.l"],
            false => ["Hero.speed", "Hero.size"],
        };
        let path = paths[rng.random_range(0..2)];
        let Ok(written) = written_number(Path::new("test.hyped"), &Text(&text), path) else { continue };
        let Some(base) = written.literal else { continue };
        let far = base.abs().max(16.0);
        let axis = Axis::new(path, &written.unit, base, (base - far, base + far), Some(far / 8.0)).unwrap();
        let query = Query { limits: limits(60), ..Query::new(vec![Target::Goal(GOAL)]) };
        let wanted = [Wanted::Reached, Wanted::Prevented][rng.random_range(0..2)];
        let question = Question { axes: vec![axis], query, wanted, nevers: Vec::new(), samples: 2 };
        let found = tune(&Texts(&text), &question);
        let what = format!("{text}\nseed {seed}, {path}, {wanted:?}");
        assert!(found.refuted.is_none(), "{what}: {:?}", found.refuted.map(|(refutation, _)| refutation));
        for trial in &found.trials {
            let value = Axis::text(trial.values[0]);
            let number = NumberSetting { path, value: &value };
            let Ok(Built { program, .. }) = compiled(&text, &[number], &[]) else {
                assert!(trial.error.is_some(), "{what}: {trial:?}");
                continue;
            };
            assert_eq!(trial.verdict == Conclusion::Reached, trial.inputs.is_some(), "{what}: {trial:?}");
            if let Some(inputs) = &trial.inputs {
                assert!(arrives(&program, GOAL, inputs, &what), "{what}: {trial:?}");
                ways += 1;
            } else if trial.verdict == Conclusion::ProvenUnreachable {
                never_arrives(&program, &Script::default(), &mut rng, &format!("{what}: {trial:?}"));
            }
        }
        // Of a part that is proven, values that were not tried.
        for part in &found.parts {
            let value = Axis::text(rng.random_range(part.from..=part.to));
            let number = NumberSetting { path, value: &value };
            let Ok(Built { program, .. }) = compiled(&text, &[number], &[]) else { continue };
            never_arrives(&program, &Script::default(), &mut rng, &format!("{what}: at {value} in {part:?}"));
            parts += 1;
        }
    }
    assert!(ways > 20 && parts > 5, "{ways} ways, {parts} parts");
}

/// Random inputs after a script do not lead to the goal.
fn never_arrives(program: &Arc<Program>, script: &Script, rng: &mut Pcg64, what: &str) {
    let sim = Simulator::new(program, WORLD);
    let Some(from) = after(&sim, script, what) else { return };
    let mut scratch = sim.scratch();
    for _ in 0..8 {
        let mut state = from.clone();
        let mut input = Input::nothing(sim.world().players.len());
        for step in 0..60 {
            if is_over(&sim, &state) {
                break;
            }
            assert!(!sim.goal(&state, GOAL).unwrap(), "{what}: {step} steps later");
            if rng.random_range(0..4) == 0 {
                stir(&mut input, rng);
                // What lies between is not tried by searches.
                input.0.iter_mut().for_each(|player| player.axes.iter_mut().for_each(|axis| *axis = axis.round()));
            }
            let drawn = sim.draw(rng.random(), step, &input);
            if sim.step(&mut state, &drawn, &mut scratch).is_err() {
                break;
            }
        }
    }
}

#[test]
fn who_is_stuck_does_not_arrive() {
    let (mut exact, mut ways, mut candidates) = (0, 0, 0);
    let all = programs(sized(150, 3_000), tiny::program).chain(programs(sized(20, 500), lively::program));
    for (seed, text, Built { program, .. }) in all {
        let mut rng = Pcg64::seed_from_u64(seed);
        let sim = Simulator::new(&program, WORLD);
        let problem = Problem::new(&sim, GOAL);
        let what = format!("{text}\nseed {seed}");
        if let Ok(Ok(answer)) = find_stuck(&problem, &limits(2_000), 5, &Unwatched) {
            exact += 1;
            for way in &answer.ways {
                never_arrives(&program, &way.script, &mut rng, &format!("{what}: stuck at {}", way.place));
                ways += 1;
            }
            if !answer.starts_well && !answer.reads_between {
                never_arrives(&program, &Script::default(), &mut rng, &format!("{what}: from the start"));
            }
            continue;
        }
        let space = configuration_space(&program, WORLD);
        let few = CandidateLimits { limits: limits(500), seed };
        let Ok(Ok(answer)) = find_candidates(&problem, &space, &few, &Unwatched) else { continue };
        for candidate in &answer.candidates {
            let state = after(&sim, &candidate.script, &what);
            assert!(state.is_some_and(|state| !is_over(&sim, &state) && !sim.goal(&state, GOAL).unwrap()), "{what}");
            if candidate.is_proven {
                never_arrives(&program, &candidate.script, &mut rng, &format!("{what}: {candidate:?}"));
            }
            candidates += 1;
        }
    }
    assert!(exact > 10, "{exact} exact answers, {ways} ways, {candidates} candidates");
}

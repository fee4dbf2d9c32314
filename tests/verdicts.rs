//! Verdicts are never wrong: worlds whose answers are known by construction (`tests/verdicts/*.hyped`) and all examples,
//! searched by every planner. Every way that is reported is read back from its text and replayed by the bare simulator.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};

use crate::support::{Disk, by_turn, files, is_long, program, script_of, sized};
use hypedc::analysis::{ConfigurationSpace, configuration_space, configuration_space_without};
use hypedc::compile::{ExtraConstraint, LevelFile, compile, compile_constrained};
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::parallel::{TaskContext, work};
use hypedc::reach::{
    Argument, Limits, Outcome, Plan, Planner, Problem, Proof, Sampling, Settings, Style, Target, Verdict,
    improve_duration, reach, search as grow, shorten,
};
use hypedc::sim::{Script, Simulator};
use hypedc::watch::{Unwatched, Watch};

/// What is true of a goal. Each goal of a world in `tests/verdicts` has a comment line that begins with one of these in
/// lower case, its name, and why. A script between backticks in that line reaches the goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    /// Reachable with inputs that are held for ten steps each.
    Reachable,
    /// Reachable only with inputs that change more often.
    Fine,
    /// Reachable only with an axis between its ends and its middle, which no search tries.
    Steered,
    Unreachable,
}

const ANSWERS: [(&str, Answer); 4] = [
    ("reachable", Answer::Reachable),
    ("fine", Answer::Fine),
    ("steered", Answer::Steered),
    ("unreachable", Answer::Unreachable),
];

/// A goal with its answer.
struct Case {
    file: String,
    goal: String,
    answer: Answer,
    /// A path to it, if the file has one.
    way: Option<String>,
    program: Arc<Program>,
    world: WorldId,
    id: GoalId,
}

/// All goals of all worlds of the folder.
fn cases() -> Vec<Case> {
    let is_world = |path: &PathBuf| path.parent() == Some(Path::new("tests/verdicts"));
    files("tests/verdicts", "hyped").into_iter().filter(is_world).flat_map(|path| cases_of(&path)).collect()
}

fn cases_of(path: &Path) -> Vec<Case> {
    let text = std::fs::read_to_string(path).unwrap();
    let program = program(compile(path, &Disk));
    let file = path.file_stem().unwrap().to_str().unwrap().to_string();
    let lines = text.lines().map_while(|line| line.strip_prefix("// "));
    let cases: Vec<Case> = lines
        .map(|line| {
            let (head, why) = line.split_once(": ").unwrap_or_else(|| panic!("{file}: no reason in `{line}`"));
            let (answer, goal) = head.split_once(' ').unwrap_or_else(|| panic!("{file}: no goal in `{line}`"));
            let (_, answer) = ANSWERS.iter().find(|(word, _)| *word == answer).unwrap_or_else(|| panic!("{line}"));
            let (world, id) = program
                .worlds
                .pairs()
                .flat_map(|(world, w)| w.goals.pairs().map(move |(id, g)| (world, id, &g.name)))
                .find_map(|(world, id, name)| (name == goal).then_some((world, id)))
                .unwrap_or_else(|| panic!("{file}: there is no goal {goal}"));
            let way = why.split('`').nth(1).map(str::to_string);
            Case { file: file.clone(), goal: goal.into(), answer: *answer, way, program: program.clone(), world, id }
        })
        .collect();
    let goals: usize = program.worlds.iter().map(|w| w.goals.len()).sum();
    assert_eq!(cases.len(), goals, "{file}: one line for each goal");
    cases
}

/// What a way must do: from a question that need not know how it was found.
struct Question<'a> {
    what: &'a str,
    program: &'a Arc<Program>,
    world: WorldId,
    target: Target,
}

impl Question<'_> {
    /// Writes the script as text, reads it back, runs it: what is asked for holds at its end, but not before (after the
    /// steps that were given), no other `never` holds on the way, and every player stays in the bounds of its space.
    fn replay(&self, plan: &Plan) {
        let Question { what, program, world, .. } = *self;
        let text = plan.script.text(program, world);
        let script = script_of(program, world, &text);
        assert_eq!(script, plan.script, "{what}: {text}");
        assert_eq!(script.len(), plan.steps, "{what}: {text}");
        self.run(&script, plan.after);
    }

    fn run(&self, script: &Script, after: u64) {
        let what = format!("{}: {}", self.what, script.text(self.program, self.world));
        let sim = Simulator::new(self.program, self.world);
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let mut inputs = script.inputs();
        for step in 0.. {
            let holds = match self.target {
                Target::Goal(goal) => sim.goal(&state, goal).unwrap(),
                Target::Never(never) => sim.holds(&state, sim.world().nevers[never].holds).unwrap(),
            };
            let input = inputs.next();
            // A counterexample may break other rules in its last step.
            if input.is_some() || matches!(self.target, Target::Goal(_)) {
                assert_eq!(sim.violated(&state).unwrap(), None, "{what}: after {step}");
                assert!(is_within(&sim, &state), "{what}: outside after {step}");
            }
            let Some(input) = input else {
                assert!(holds, "{what}: it does not hold in the end");
                break;
            };
            assert!(!holds || step < after, "{what}: it holds before the end, after {step}");
            sim.step(&mut state, input, &mut scratch).unwrap();
        }
    }
}

/// Whether each player that lives is in its space.
fn is_within(sim: &Simulator, state: &[u8]) -> bool {
    let world = sim.world();
    world.players.iter().filter(|p| world.layout.slots[p.slot].alive(state)).all(|player| {
        let (x, y) = sim.position(state, player.slot);
        let bounds = world.spaces[sim.space(state, player.slot)].bounds;
        bounds.is_none_or(|b| b.left <= x && x <= b.right && b.bottom <= y)
    })
}

fn limits(nodes: u64) -> Limits {
    Limits { nodes, ..Limits::default() }
}

/// The verdict is not against the answer, whatever the analysis would have said.
fn agrees(case: &Case, outcome: &Outcome, how: &str) {
    let what = format!("{} {}, {how}", case.file, case.goal);
    match &outcome.verdict {
        Verdict::NotFound => {}
        Verdict::Reached(plan) => {
            let target = Target::Goal(case.id);
            Question { what: &what, program: &case.program, world: case.world, target }.replay(plan);
            assert!(matches!(case.answer, Answer::Reachable | Answer::Fine), "{what}: reached");
        }
        Verdict::Unreachable(_) => assert_eq!(case.answer, Answer::Unreachable, "{what}"),
        Verdict::Exhausted(_) => {
            assert!(matches!(case.answer, Answer::Steered | Answer::Unreachable), "{what}: exhausted");
        }
    }
}

#[test]
fn no_planner_contradicts_what_is_known() {
    let cases = cases();
    assert!(cases.iter().map(|c| &c.file).collect::<std::collections::BTreeSet<_>>().len() >= 36);
    for case in &cases {
        let sim = Simulator::new(&case.program, case.world);
        let problem = Problem::new(&sim, case.id);
        let space = configuration_space(&case.program, case.world);
        let proof = Proof::of(&problem, &space);
        assert!(proof.is_none() || case.answer == Answer::Unreachable, "{} {}: {proof:?}", case.file, case.goal);
        let ways =
            [(1, Sampling::Reduced, None), (2, Sampling::Naive, Some((1, 1))), (3, Sampling::Reduced, Some((1, 30)))];
        for (planner, turn) in Planner::ALL.into_iter().zip(case.goal.len()..) {
            for &(seed, sampling, hold) in by_turn(&ways, turn) {
                let settings = Settings { planner, seed, sampling, hold, ..Settings::default() };
                let outcome = grow(&problem, &space, &settings, &limits(200), &Unwatched).unwrap();
                agrees(case, &outcome, &format!("{settings:?}"));
            }
        }
    }
}

#[test]
fn exhaustion_of_inputs_of_one_step_finds_what_there_is() {
    for case in &cases() {
        let sim = Simulator::new(&case.program, case.world);
        let space = configuration_space(&case.program, case.world);
        let settings = Settings { planner: Planner::Exhaustive, hold: Some((1, 1)), ..Settings::default() };
        let problem = Problem::new(&sim, case.id);
        let outcome = grow(&problem, &space, &settings, &limits(sized(8_000, 15_000)), &Unwatched).unwrap();
        agrees(case, &outcome, "exhaustively, one step each");
    }
}

#[test]
fn ways_that_are_written_by_hand_lead_there() {
    let mut ways = 0;
    for case in &cases() {
        let Some(way) = &case.way else {
            assert_ne!(case.answer, Answer::Steered, "{}: a way to {}", case.file, case.goal);
            continue;
        };
        assert_ne!(case.answer, Answer::Unreachable, "{} {}", case.file, case.goal);
        let what = format!("{} {}", case.file, case.goal);
        let target = Target::Goal(case.id);
        let question = Question { what: &what, program: &case.program, world: case.world, target };
        question.run(&script_of(&case.program, case.world, way), 0);
        ways += 1;
    }
    assert!(ways >= 5, "{ways}");
}

/// What `auto` says of each goal; where inputs must change more often, with inputs of one step.
#[test]
fn auto_finds_what_there_is_and_proves_what_it_can() {
    let mut lines = String::new();
    for case in &cases() {
        let sim = Simulator::new(&case.program, case.world);
        let problem = Problem::new(&sim, case.id);
        let space = configuration_space(&case.program, case.world);
        let hold = (case.answer == Answer::Fine).then_some((1, 1));
        let settings = Settings { hold, ..Settings::default() };
        let outcome = reach(&problem, &space, &settings, &limits(sized(60_000, 120_000)), &Unwatched).unwrap();
        agrees(case, &outcome, "auto");
        let is_reached = matches!(outcome.verdict, Verdict::Reached(_));
        let can_be = matches!(case.answer, Answer::Reachable | Answer::Fine);
        assert_eq!(is_reached, can_be, "{} {}: {:?}", case.file, case.goal, outcome.verdict);
        let verdict = match outcome.verdict {
            Verdict::Reached(_) => "reached",
            Verdict::NotFound => "not found",
            Verdict::Unreachable(Argument::Analysis(_)) => "unreachable, by the analysis",
            Verdict::Unreachable(Argument::Exhaustion(_)) => "unreachable, by exhaustion",
            Verdict::Unreachable(Argument::Over) => "unreachable, as every run is over",
            Verdict::Unreachable(Argument::Distance(_)) => "unreachable, as it is too far",
            Verdict::Exhausted(_) => "exhausted",
        };
        let fine = if hold.is_some() { " (inputs of 1 step)" } else { "" };
        writeln!(lines, "{} {}{fine}: {verdict}", case.file, case.goal).unwrap();
    }
    insta::assert_snapshot!(lines);
}

/// Stops after a number of polls.
struct PollLimit(AtomicU32);

impl Watch for PollLimit {
    fn stop(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| Some(left.saturating_sub(1))) == Ok(1)
            || self.0.load(Ordering::Relaxed) == 0
    }
}

/// Shortens a path: the result replays, is no worse in any respect, has the same beginning, and holds inputs as long.
fn shortens(question: &Question<'_>, problem: &Problem<'_>, space: &ConfigurationSpace, plan: &Plan) {
    // How long each input is held; what nature draws meanwhile is no change of it.
    let parts = |plan: &Plan| {
        let alike = plan.script.steps.chunk_by(|a, b| a.input.0 == b.input.0);
        alike.map(|held| held.iter().map(|step| step.count).sum()).collect::<Vec<u32>>()
    };
    let shortest = |plan: &Plan| parts(plan).split_last().and_then(|(_, held)| held.iter().min().copied());
    let shortest = |plan: &Plan| shortest(plan).unwrap_or(u32::MAX);
    for least in [0, if plan.after == 0 { shortest(plan).min(10) } else { 0 }] {
        let held = problem.clone().holding(least as u16);
        let short = shorten(&held, space, plan, Style::Fast, &PollLimit(AtomicU32::new(sized(6, 12))));
        question.replay(&short);
        let what = question.what;
        assert_eq!(short.after, plan.after, "{what}");
        assert!(short.steps <= plan.steps && parts(&short).len() <= parts(plan).len(), "{what}");
        assert!(least == 0 || shortest(&short) >= least, "{what}: {least}");
        let first = |plan: &Plan| plan.script.inputs().take(plan.after as usize).cloned().collect::<Vec<_>>();
        assert_eq!(first(&short), first(plan), "{what}");
    }
}

/// Searches for a faster path: the result replays, and is no slower; if it has the same duration, it is the same.
fn hastens(
    question: &Question<'_>,
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    plan: &Plan,
) {
    let fast = improve_duration(problem, space, settings, &limits(sized(200, 500)), plan, &Unwatched);
    question.replay(&fast);
    assert!(fast.steps - fast.after < plan.steps - plan.after || fast == *plan, "{}", question.what);
}

/// A world of an example, with its configuration space, which all tests of this file share.
struct ExampleWorld {
    file: String,
    program: Arc<Program>,
    id: WorldId,
    space: OnceLock<ConfigurationSpace>,
}

impl ExampleWorld {
    fn space(&self) -> &ConfigurationSpace {
        self.space.get_or_init(|| configuration_space(&self.program, self.id))
    }

    /// Each goal and each `never`, with its name.
    fn targets(&self) -> impl Iterator<Item = (Target, &str)> {
        let world = &self.program.worlds[self.id];
        let goals = world.goals.pairs().map(|(id, g)| (Target::Goal(id), &*g.name));
        goals.chain(world.nevers.pairs().map(|(id, n)| (Target::Never(id), &*n.name)))
    }
}

/// The worlds of all examples, but for one whose steps take ten times as long as those of most others.
fn examples() -> &'static [ExampleWorld] {
    static WORLDS: OnceLock<Vec<ExampleWorld>> = OnceLock::new();
    WORLDS.get_or_init(|| {
        let paths = files("examples", "hyped").into_iter().filter(|path| !path.ends_with("lode_runner.hyped"));
        let worlds = paths.flat_map(|path| {
            let (program, file) = (program(compile(&path, &Disk)), path.display().to_string());
            let ids: Vec<WorldId> = program.worlds.ids().collect();
            let world = move |id| ExampleWorld {
                file: file.clone(),
                program: Arc::clone(&program),
                id,
                space: OnceLock::new(),
            };
            ids.into_iter().map(world)
        });
        worlds.collect()
    })
}

/// Asks about each goal and each `never` of each world of the examples, on all cores.
fn every_question<T: Send>(ask: impl Fn(&Question<'_>, &ConfigurationSpace) -> T + Sync) -> Vec<T> {
    let of_world = |world: &'static ExampleWorld| {
        // The steps of these take long: one question will do.
        let is_slow = ["asteroids.hyped", "pac_man.hyped"].iter().any(|name| world.file.ends_with(name));
        let count = if is_slow && !is_long() { 1 } else { usize::MAX };
        world.targets().take(count).map(move |(target, name)| (world, target, name))
    };
    let questions: Vec<(&ExampleWorld, Target, &str)> = examples().iter().flat_map(of_world).collect();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut answers = Vec::new();
    let ask = |at: usize, context: &TaskContext<'_, T>| {
        let (world, target, name) = questions[at];
        let what = format!("{} {} {name}", world.file, world.program.worlds[world.id].name);
        let question = Question { what: &what, program: &world.program, world: world.id, target };
        context.submit(ask(&question, world.space()));
    };
    work(questions.len(), threads, &|| false, &ask, &mut |_, answer| {
        answers.push(answer);
        ControlFlow::Continue(())
    });
    assert_eq!(answers.len(), questions.len());
    answers
}

/// A third of the planners are asked each question, and `auto`.
#[test]
fn what_is_reported_of_the_examples_replays_and_repeats() {
    let counts = every_question(|question, space| {
        let mut reached = 0;
        let sim = Simulator::new(question.program, question.world);
        let problem = Problem::asking(&sim, question.target);
        for (planner, seed) in Planner::ALL.into_iter().zip(1..) {
            let is_asked = (seed + question.what.len() as u64).is_multiple_of(3);
            if !is_asked && !is_long() && planner != Planner::Auto {
                continue;
            }
            let sampling = if seed % 3 == 0 { Sampling::Naive } else { Sampling::Reduced };
            let settings = Settings { planner, seed, sampling, ..Settings::default() };
            // The analysis before a search does not depend on the planner.
            let ask = if planner == Planner::Auto { reach } else { grow };
            let run = || ask(&problem, space, &settings, &limits(sized(400, 1_000)), &Unwatched).unwrap();
            let outcome = run();
            if is_asked {
                assert_eq!(outcome, run(), "{} {settings:?}", question.what);
            }
            for (never, script) in &outcome.violations {
                Question { target: Target::Never(*never), ..*question }.run(script, 0);
            }
            if let Verdict::Reached(plan) = &outcome.verdict {
                question.replay(plan);
                shortens(question, &problem, space, plan);
                hastens(question, &problem, space, &settings, plan);
                reached += 1;
            }
        }
        match question.target {
            Target::Goal(_) => (reached, 0),
            Target::Never(_) => (0, reached),
        }
    });
    let (goals, nevers) = counts.into_iter().fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    assert!(goals > sized(30, 60) && nevers > 12, "{goals} goals and {nevers} nevers reached");
}

/// Several trees have the same result on any number of threads.
#[test]
fn threads_change_nothing() {
    every_question(|question, space| {
        let sim = Simulator::new(question.program, question.world);
        let problem = Problem::asking(&sim, question.target);
        for &planner in by_turn(&[Planner::Auto, Planner::Rrt, Planner::Coverage], question.what.len()) {
            let with = |threads| {
                let settings = Settings { planner, trees: 4, threads, seed: 7, ..Settings::default() };
                let ask = if planner == Planner::Auto { reach } else { grow };
                ask(&problem, space, &settings, &limits(sized(500, 800)), &Unwatched).unwrap()
            };
            let alone = with(1);
            assert_eq!(alone, with(3), "{} {}", question.what, planner.name());
            if let Verdict::Reached(plan) = &alone.verdict {
                question.replay(plan);
            }
        }
    });
}

/// A search continues from the end of a part of a path, or from several such states.
#[test]
fn ways_go_on_from_where_a_script_leads() {
    let found = every_question(|question, space| {
        let mut found = 0;
        if !is_long() && question.what.len().is_multiple_of(2) {
            return 0;
        }
        let sim = Simulator::new(question.program, question.world);
        let problem = Problem::asking(&sim, question.target);
        let settings = Settings::default();
        let outcome = reach(&problem, space, &settings, &limits(sized(1_500, 3_000)), &Unwatched).unwrap();
        let Verdict::Reached(whole) = outcome.verdict else { return 0 };
        let part = |length: u64| {
            let mut script = Script::default();
            whole.script.inputs().take(length as usize).for_each(|input| script.push(input, 1));
            script
        };
        let (third, half) = (part(whole.steps / 3), part(whole.steps / 2));
        let later = Problem::asking(&sim, question.target).after(third.clone()).unwrap();
        let later = later.after(half.clone()).unwrap();
        let planners = [(Planner::Auto, 1), (Planner::Rrt, 2), (Planner::EgRrt, 1), (Planner::Exhaustive, 2)];
        for ((planner, trees), seed) in planners.into_iter().zip(3..) {
            if !is_long() && (seed + question.what.len() as u64).is_multiple_of(2) {
                continue;
            }
            let settings = Settings { planner, seed, trees, ..Settings::default() };
            let outcome = grow(&later, space, &settings, &limits(1_000), &Unwatched).unwrap();
            let Verdict::Reached(plan) = &outcome.verdict else { continue };
            question.replay(plan);
            let start = [&third, &half].into_iter().find(|s| s.len() == plan.after).unwrap();
            assert!(plan.script.inputs().zip(start.inputs()).all(|(a, b)| a == b), "{}", question.what);
            shortens(question, &later, space, plan);
            hastens(question, &later, space, &settings, plan);
            found += 1;
        }
        found
    });
    let found: u32 = found.into_iter().sum();
    assert!(found > sized(12, 50), "{found}");
}

/// A goal of a world, with one more `never`; how the analysis and all planners answer.
fn without(file: &str, goal: &str, predicate: &str) -> Vec<Verdict> {
    let path = Path::new("tests/verdicts").join(file).with_extension("hyped");
    let constraint = ExtraConstraint { world: None, name: "without", predicate, origin: "test" };
    let program = program(compile_constrained(&path, LevelFile::default(), Some(constraint), &Disk));
    let world = WorldId(0);
    let id = program.worlds[world].goals.find(|g| g.name == goal).unwrap();
    let sim = Simulator::new(&program, world);
    let nevers: Vec<_> = program.worlds[world].nevers.iter().map(|n| n.holds).collect();
    let space = configuration_space_without(&program, world, &nevers);
    let problem = Problem::new(&sim, id);
    let ask = |planner| {
        let settings = Settings { planner, ..Settings::default() };
        let verdict = reach(&problem, &space, &settings, &limits(20_000), &Unwatched).unwrap().verdict;
        if let Verdict::Reached(plan) = &verdict {
            let what = format!("{file} {goal} without {predicate}");
            Question { what: &what, program: &program, world, target: Target::Goal(id) }.replay(plan);
        }
        verdict
    };
    [Planner::Auto, Planner::RgRrt, Planner::Exhaustive].map(ask).into()
}

#[test]
fn what_is_needed_is_not_done_without() {
    let is_reached = |verdicts: &[Verdict]| verdicts.iter().any(|v| matches!(v, Verdict::Reached(_)));
    // The key is needed behind the door, but not before it.
    let needed = without("key_before_door", "behind", "hero.keys > 0");
    assert!(needed.iter().any(|v| matches!(v, Verdict::Unreachable(_))), "{needed:?}");
    assert!(!is_reached(&needed), "{needed:?}");
    assert!(is_reached(&without("key_before_door", "behind", "hero.x > 140")));
    // Either door will do.
    assert!(is_reached(&without("one_key_two_doors", "keyless", "two in open")));
    assert!(!is_reached(&without("one_key_two_doors", "keyless", "one in open")));
}

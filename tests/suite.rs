//! Tests in programs: what `hypedc test` prints, that a claim gets the answer of `sim` and `reach`, that nothing else depends
//! on tests, and that ways which were kept change no verdict.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use hypedc::compile::{Compilation, LevelFile, SearchKind, TestCase, TestClaimKind, When, compile};
use hypedc::ir::{Program, WorldId};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Conclusion, Limits, Target};
use hypedc::sim::{Script, Simulator};
use hypedc::source::{Files, SourceMap};
use hypedc::suite::{NoWays, Recorded, Subject, TestOptions, TestResult, WayName, Ways, insert_test, run_test};
use hypedc::watch::Unwatched;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::support::{Disk, Text, compile_text, files, program};

const NODES: u64 = 20_000;

/// A new folder for a test, with copies of some files.
fn folder(name: &str, copies: &[&str]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("suite").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for copy in copies {
        fs::copy(copy, folder.join(Path::new(copy).file_name().unwrap())).unwrap();
    }
    folder
}

fn hypedc(folder: &Path, arguments: &[&str]) -> Output {
    let cache = folder.join("cache");
    let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
    command.args(arguments).current_dir(folder).env("XDG_CACHE_HOME", cache).output().unwrap()
}

/// The whole output of a command without its seconds, and its exit code.
fn said(output: &Output) -> String {
    let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let line = |line: &str| line.split("; finished in").next().unwrap().to_string();
    let lines: Vec<String> = text.lines().map(line).collect();
    format!("{}\nexit code {}\n", lines.join("\n"), output.status.code().unwrap())
}

/// Without measured times.
fn untimed(text: &str) -> String {
    let is_timed = |line: &&str| line.trim_start().starts_with("\"seconds\"");
    text.lines().filter(|line| !is_timed(line)).collect::<Vec<_>>().join("\n")
}

#[test]
fn tests_that_pass_and_tests_that_fail_look_like_this() {
    let folder = folder("looks", &["tests/suite/cellar.hyped", "tests/suite/failing.hyped"]);
    insta::with_settings!({ snapshot_path => "suite", prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("pass", said(&hypedc(&folder, &["test", "cellar.hyped"])));
        insta::assert_snapshot!("fail", said(&hypedc(&folder, &["test", "cellar.hyped", "failing.hyped"])));
        let covered = hypedc(&folder, &["test", "failing.hyped", "--filter", "by", "--coverage", "--lcov", "lcov"]);
        let lcov = fs::read_to_string(folder.join("lcov")).unwrap();
        insta::assert_snapshot!("coverage", format!("{}{lcov}", said(&covered)));
        hypedc(&folder, &["test", "failing.hyped", "--filter", "a", "--junit", "junit.xml"]);
        let junit = fs::read_to_string(folder.join("junit.xml")).unwrap();
        let mut parts = junit.split("time=\"");
        let mut untimed = parts.next().unwrap().to_string();
        untimed.extend(parts.map(|part| format!("time=\"…{}", &part[part.find('"').unwrap()..])));
        insta::assert_snapshot!("junit", untimed);
        let json = hypedc(&folder, &["test", "failing.hyped", "--filter", "by", "--format", "json", "--coverage"]);
        let json = String::from_utf8(json.stdout).unwrap().replace(env!("CARGO_PKG_VERSION"), "VERSION");
        insta::assert_snapshot!("json", self::untimed(&json));
    });
}

#[test]
fn what_cannot_be_tested_is_refused() {
    let folder = folder("refused", &["tests/suite/cellar.hyped", "examples/balloon.hyped"]);
    fs::write(folder.join("wrong.hyped"), "world W { test \"a\" { } }").unwrap();
    for (arguments, words) in [
        (&["test", "balloon.hyped"][..], "there are no tests"),
        (&["test", "cellar.hyped", "--filter", "nothing"], "no test is chosen"),
        (&["test", "wrong.hyped"], "E0511"),
        (&["test", "cellar.hyped", "wrong.hyped"], "E0511"),
        (&["test", "missing.hyped"], "E0001"),
    ] {
        let said = said(&hypedc(&folder, arguments));
        assert!(said.contains(words) && said.contains("exit code 2"), "{arguments:?}: {said}");
        assert!(!said.contains("... ok"), "{said}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = folder("threads", &["tests/suite/cellar.hyped", "tests/suite/failing.hyped"]);
    let run = |threads: &str| {
        let files = ["test", "failing.hyped", "cellar.hyped", "--format", "json", "--coverage", "--threads", threads];
        untimed(&String::from_utf8(hypedc(&folder, &files).stdout).unwrap())
    };
    // The second run replays the ways that the first one found.
    let first = run("1");
    assert_eq!(first, run("3"));
    assert!(first.contains("\"passed\": false") && first.contains("\"inputs\": \""));
}

#[test]
fn the_tests_of_the_examples_pass() {
    let all: Vec<String> = files("examples", "hyped").iter().map(|path| path.display().to_string()).collect();
    let tested: Vec<&str> = all
        .iter()
        .map(String::as_str)
        .filter(|path| fs::read_to_string(path).unwrap().lines().any(|line| line.starts_with("    test \"")))
        .collect();
    assert!(tested.len() >= 3, "{tested:?}");
    let arguments: Vec<&str> = ["test", "--no-ways"].into_iter().chain(tested).collect();
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
}

// Nothing else depends on tests.

/// The text without its tests.
fn without_tests(text: &str) -> String {
    let mut lines = text.lines();
    let mut kept = String::new();
    while let Some(line) = lines.next() {
        if line.starts_with("    test \"") {
            lines.by_ref().take_while(|line| *line != "    }").for_each(drop);
            continue;
        }
        kept.push_str(line);
        kept.push('\n');
    }
    kept
}

#[test]
fn a_program_means_the_same_without_its_tests() {
    let json = |program: &Program| serde_json::to_string(&program.meaning()).unwrap();
    let mut count = 0;
    for path in files("examples", "hyped").into_iter().chain(files("tests/suite", "hyped")) {
        let text = fs::read_to_string(&path).unwrap();
        let plain = without_tests(&text);
        if plain == text {
            continue;
        }
        count += 1;
        struct Plain<'a>(&'a Path, &'a str);
        impl Files for Plain<'_> {
            fn read(&self, path: &Path) -> Result<String, hypedc::source::ReadError> {
                if path == self.0 { Ok(self.1.to_string()) } else { Disk.read(path) }
            }
        }
        let [with, without] = [program(compile(&path, &Disk)), program(compile(&path, &Plain(&path, &plain)))];
        assert_eq!(json(&with), json(&without), "{}", path.display());
    }
    assert!(count >= 5, "{count}");
}

#[test]
fn a_tag_that_only_a_test_names_is_none_of_the_program() {
    let world = |test: &str| {
        format!(
            "entity A {{ collider a: rect(0, 0, 8, 8) }}
            world W {{ space s {{ place a: A at (0, 0); rect b (0, 20, 8, 8) }} {test} }}
            world V {{ space s {{ place a: A at (0, 0); rect later (0, 20, 8, 8) }} }}"
        )
    };
    let [plain, tested] = ["", "test \"t\" { expect a touching later never; expect a.x < 3 at 1s }"]
        .map(|test| compile_text(&world(test)));
    assert_eq!(tested.tests.len(), 1);
    let json = |compiled: Compilation| serde_json::to_string(&program(compiled).meaning()).unwrap();
    assert_eq!(json(plain), json(tested));
}

// Claims have the answers of `sim` and `reach`.

struct Written {
    program: Arc<Program>,
    sources: SourceMap,
    cases: Vec<TestCase>,
}

fn written(text: &str) -> Written {
    let compiled = compile_text(text);
    let (cases, sources) = (compiled.tests.clone(), compiled.sources.clone());
    Written { program: program(compiled), sources, cases }
}

fn results(text: &str, ways: &dyn Ways) -> Vec<TestResult> {
    let Written { program, sources, cases } = written(text);
    let files = Text(text);
    let file = Path::new("test.hyped");
    let subject = Subject { file, level: LevelFile::default(), numbers: &[], files: &files };
    let options = TestOptions { nodes: NODES, seed: 1, covers: false, ways };
    let run = |case: &TestCase| run_test(&subject, (&program, &sources), case, &options, &Unwatched).result;
    cases.iter().map(run).collect()
}

/// A ball between walls, with a switch and a clock; it can leave the bounds above.
const BALL: &str = "entity Ball {
    param speed: px/s = 60
    discrete hits: int 0..9 = 0
    axis horizontal
    button jump
    collider body: rect(0, 0, 8, 8)
    x' = speed * sign(horizontal)
    mode low { y' = 0; when pressed(jump) -> high { hits := min(hits + 1, 9) } }
    mode high { y' = 30; when timer >= 0.2s -> low }
}
world W {
    step 1/20
    collide body with wall: block
    space s {
        rect wall (-8, 0, 8, 64)
        rect wall (72, 0, 8, 64)
        bounds rect(-20, 0, 120, 200)
        place ball: Ball at (32, 0)
    }
    player 1: ball
    goal far: ball.x > 60
    goal up: ball.y > 20 and ball.hits < 3
    never top: ball.y > 40
";

#[test]
fn expectations_are_what_a_plain_simulation_says() {
    let mut rng = Pcg64::seed_from_u64(7);
    let predicates = [
        "ball.x > 40",
        "ball.y > 3 and ball.hits < 2",
        "far",
        "up",
        "ball in high",
        "top",
        "not ball in low",
        "ball.x <= 32",
    ];
    let (mut held, mut all) = (0, 0);
    for _ in 0..40 {
        let words = ["right", "left", "-", "jump", "right+jump"];
        let script: Vec<String> = (0..rng.random_range(1..6))
            .map(|_| format!("{}*{}", words[rng.random_range(0..words.len())], rng.random_range(1..12)))
            .collect();
        let script = script.join(" ");
        let predicate = predicates[rng.random_range(0..predicates.len())];
        let step = rng.random_range(0..40_u32);
        let moments = [
            format!("at {step}frames"),
            "at end".into(),
            format!("by {step}frames"),
            "by end".into(),
            "always".into(),
            "never".into(),
        ];
        let moment = &moments[rng.random_range(0..moments.len())];
        let text = format!("{BALL} test \"t\" {{ inputs \"{script}\"; expect {predicate} {moment} }} }}");
        // The same predicate as a goal, looked at in every state of the run.
        let asked = match predicate {
            "far" | "up" | "top" => BALL.to_string(),
            _ => format!("{BALL} goal asked: {predicate}"),
        };
        let program = program(compile_text(&format!("{asked} }}")));
        let world = &program.worlds[WorldId(0)];
        let holds = match predicate {
            "top" => world.nevers[world.never_named("top").unwrap()].holds,
            name @ ("far" | "up") => world.goals[world.goal_named(name).unwrap()].holds,
            _ => world.goals[world.goal_named("asked").unwrap()].holds,
        };
        let steps = if moment.ends_with("frames") { step } else { 0 };
        let states = states(&program, &crate::support::script(&program, &script), steps);
        let seen: Vec<bool> = states.1.iter().map(|state| states.0.holds(state, holds).unwrap()).collect();
        let expected = match moment.split(' ').next().unwrap() {
            "at" if moment == "at end" => *seen.last().unwrap(),
            "at" => seen[step as usize],
            "by" if moment == "by end" => seen.contains(&true),
            "by" => seen[..=step as usize].contains(&true),
            "always" => !seen.contains(&false),
            _ => !seen.contains(&true),
        };
        let results = results(&text, &NoWays);
        let [result] = results.as_slice() else { panic!("{text}") };
        assert_eq!(result.claims[0].passed, expected, "{script}: {predicate} {moment}: {}", result.claims[0].answer);
        let is_violated = states.1.iter().any(|state| states.0.violated(state).unwrap().is_some());
        assert_eq!(result.problems.is_empty(), predicate == "top" || !is_violated, "{:?}", result.problems);
        assert_eq!(result.passed, expected && result.problems.is_empty());
        (held, all) = (held + usize::from(expected), all + 1);
    }
    assert!(held > 8 && held < all - 8, "{held} of {all}");
}

/// The states of a run, the initial one included.
fn states(program: &Arc<Program>, script: &Script, least: u32) -> (Simulator, Vec<hypedc::sim::State>) {
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut all = vec![sim.initial(&mut scratch).unwrap()];
    let nothing = hypedc::sim::Input::nothing(1);
    let steps = script.len().max(u64::from(least)) as usize;
    for input in script.inputs().chain(std::iter::repeat(&nothing)).take(steps) {
        let mut state = all.last().unwrap().clone();
        sim.step(&mut state, input, &mut scratch).unwrap();
        all.push(state);
    }
    (sim, all)
}

#[test]
fn claims_about_all_runs_are_the_verdicts_of_reach() {
    let predicates =
        ["far", "up", "top", "ball.x > 64", "ball.x > 65", "ball.hits > 2", "ball.y < 0", "ball.y > 39 and ball.x < 1"];
    let mut seen = std::collections::BTreeSet::new();
    for predicate in predicates {
        for (word, within) in
            [("reachable", ""), ("unreachable", " within 1s"), ("never", ""), ("unfound", " within 2s")]
        {
            let is_goal = matches!(word, "reachable" | "unreachable");
            if is_goal == (predicate == "top") && matches!(predicate, "top" | "far" | "up") {
                continue;
            }
            let text = format!("{BALL} test \"t\" {{ {word} {predicate}{within} }} }}");
            let results = results(&text, &NoWays);
            let added = match (predicate, is_goal) {
                ("far" | "up" | "top", _) => String::new(),
                (_, true) => format!("goal asked: {predicate}"),
                (_, false) => format!("never asked: {predicate}"),
            };
            let program = program(compile_text(&format!("{BALL} {added} }}")));
            let world = &program.worlds[WorldId(0)];
            let name = if added.is_empty() { predicate } else { "asked" };
            let target = match is_goal {
                true => Target::Goal(world.goal_named(name).unwrap()),
                false => Target::Never(world.never_named(name).unwrap()),
            };
            let asked = match target {
                Target::Never(id) if name == "asked" => vec![id],
                _ => Vec::new(),
            };
            let seconds: u32 = within.trim_start_matches(" within ").trim_end_matches('s').parse().unwrap_or(0);
            let query = Query {
                limits: Limits { nodes: NODES, ..Limits::default() },
                within: (seconds > 0).then_some(seconds * 20),
                asked,
                ..Query::new(vec![target])
            };
            let session = Session::new(&program, WorldId(0), query, &Unwatched);
            let mut found = session.find(target, &Unwatched).unwrap();
            let verdict = session.answer(&mut found, &SourceMap::new()).verdict;
            let claim = &results[0].claims[0];
            assert_eq!(claim.verdict, Some(verdict), "{word} {predicate}{within}");
            let expected = match word {
                "reachable" => verdict == Conclusion::Reached,
                "unreachable" | "never" => verdict == Conclusion::ProvenUnreachable,
                _ => verdict != Conclusion::Violated,
            };
            assert_eq!(claim.passed, expected, "{word} {predicate}{within}: {verdict:?}");
            seen.insert((word, verdict));
        }
    }
    assert!(seen.len() >= 6, "{seen:?}");
}

#[test]
fn what_is_needed_is_both_a_way_and_a_proof() {
    let claim = |claim: &str| {
        let text = format!("{BALL} test \"t\" {{ {claim} }} }}");
        results(&text, &NoWays)[0].passed
    };
    assert!(claim("reachable ball.y > 3 not without ball.hits > 0"));
    assert!(claim("unreachable ball.y > 3 without ball.hits > 0"));
    assert!(claim("reachable ball.x > 50 without ball.hits > 0"));
    assert!(!claim("reachable ball.x > 50 not without ball.hits > 0"), "there is a way without");
    assert!(!claim("reachable ball.x > 65 not without ball.hits > 0"), "there is no way at all");
    assert!(!claim("unreachable ball.x > 50 without ball.hits > 0"));
}

// Ways that were kept.

/// Answers each question with the same script.
struct Always(&'static str);

impl Ways for Always {
    fn find(&self, _: &Program, _: &WayName<'_>) -> Option<String> {
        Some(self.0.to_string())
    }

    fn keep(&self, _: &Program, _: &WayName<'_>, _: &str) {}
}

#[test]
fn a_stale_way_changes_no_verdict() {
    let claims = "reachable far within 10s; unreachable ball.x > 65; unreachable far; never top; unfound ball.hits > 1 within 9s; \
                  reachable ball.y > 3 not without ball.hits > 0";
    let tests: Vec<String> =
        claims.split("; ").enumerate().map(|(at, claim)| format!("test \"{at}\" {{ {claim} }}\n")).collect();
    let text = format!("{BALL} {} }}", tests.concat());
    let verdicts = |ways: &dyn Ways| -> Vec<(bool, Option<Conclusion>)> {
        results(&text, ways).iter().map(|result| (result.passed, result.claims[0].verdict)).collect()
    };
    let expected = verdicts(&NoWays);
    assert_eq!(expected.iter().filter(|(passed, _)| *passed).count(), 3);
    for stale in
        ["", "left*40", "no script at all", "right*300", "jump -*3 jump -*5 jump -*9 right*60 jump*2", "2:jump"]
    {
        assert_eq!(verdicts(&Always(stale)), expected, "{stale}");
    }
}

#[test]
fn ways_are_kept_in_a_folder_and_replayed() {
    let folder = folder("ways", &["tests/suite/cellar.hyped"]);
    let test = |more: &[&str]| {
        let arguments: Vec<&str> = ["test", "cellar.hyped"].into_iter().chain(more.iter().copied()).collect();
        said(&hypedc(&folder, &arguments))
    };
    let first = test(&["--ways", "ways"]);
    let kept: Vec<PathBuf> = fs::read_dir(folder.join("ways")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(kept.len(), 1, "{kept:?}");
    assert_eq!(first, test(&["--ways", "ways"]));
    fs::write(&kept[0], "left*3").unwrap();
    assert_eq!(first, test(&["--ways", "ways"]));
    assert_ne!(fs::read_to_string(&kept[0]).unwrap(), "left*3", "a new way is kept in its place");
    assert_eq!(first, test(&["--no-ways"]));
    assert!(first.contains("3 passed"));
}

// Recorded tests.

#[test]
fn recorded_tests_pass_and_change_nothing_else() {
    for example in ["balloon", "hills", "flappy"] {
        let source = format!("examples/{example}.hyped");
        let folder = folder(&format!("record-{example}"), &[&source]);
        let file = format!("{example}.hyped");
        let before = fs::read_to_string(folder.join(&file)).unwrap();
        let goal =
            program(compile(Path::new(&source), &Disk)).worlds[WorldId(0)].goals.iter().next().unwrap().name.clone();
        let recorded = hypedc(&folder, &["test", &file, "--record", &goal, "--name", "a way to the goal"]);
        assert!(recorded.status.success(), "{}", said(&recorded));
        let after = fs::read_to_string(folder.join(&file)).unwrap();
        assert_eq!(without_tests(&after).replace("\n\n}", "\n}"), before, "only an insertion");
        let formatted = hypedc(&folder, &["fmt", "--check", &file]);
        assert!(formatted.status.success(), "{}", said(&formatted));
        let passed = said(&hypedc(&folder, &["test", &file]));
        assert!(passed.contains("test a way to the goal ... ok") && passed.contains("exit code 0"), "{passed}");
        let again = said(&hypedc(&folder, &["test", &file, "--record", &goal, "--name", "a way to the goal"]));
        assert!(again.contains("has a test `a way to the goal` already") && again.contains("exit code 2"), "{again}");
        assert_eq!(fs::read_to_string(folder.join(&file)).unwrap(), after);
    }
}

#[test]
fn what_is_not_reached_is_not_recorded() {
    let folder = folder("record-nothing", &["tests/suite/cellar.hyped"]);
    let before = fs::read_to_string(folder.join("cellar.hyped")).unwrap();
    let said = said(&hypedc(&folder, &["test", "cellar.hyped", "--record", "hero.keys > 1"]));
    assert!(said.contains("proven unreachable") && said.contains("exit code 1"), "{said}");
    assert_eq!(fs::read_to_string(folder.join("cellar.hyped")).unwrap(), before);
}

#[test]
fn an_inserted_test_is_read_as_it_was_meant() {
    let script = "right*3 jump -*20 ".repeat(30);
    let recorded =
        Recorded { world: "W", test: "long", inputs: script.trim_end(), seed: Some(3), predicate: "ball.x > 60" };
    let text = insert_test(&format!("{BALL}}}\n"), &recorded).unwrap();
    let Written { program, cases, .. } = written(&text);
    let [case] = cases.as_slice() else { panic!("{text}") };
    assert_eq!((case.name.as_str(), case.seed), ("long", Some(3)));
    assert_eq!(case.script, Some(crate::support::script(&program, &script)));
    assert!(matches!(case.claims[0].kind, TestClaimKind::Expect(When::AtEnd)));
}

#[test]
fn claims_are_read_as_they_are_written() {
    let text = format!(
        "{BALL} test \"t\" {{ chance seed 9
            reachable ball.x > 60 // not the goal
                and ball.y < 3 without ball.hits > 0 within 2.03s
            expect far by 0.5s }} }}"
    );
    let cases = written(&text).cases;
    let [case] = cases.as_slice() else { panic!() };
    assert_eq!(case.claims[0].predicate, "ball.x > 60 and ball.y < 3");
    let TestClaimKind::Search(search) = &case.claims[0].kind else { panic!() };
    assert_eq!(search.kind, SearchKind::Reachable);
    assert_eq!((search.without.as_deref(), search.is_needed, search.within), (Some("ball.hits > 0"), false, Some(40)));
    assert!(matches!(case.claims[1].kind, TestClaimKind::Expect(When::By(10))));
    assert_eq!((case.script.clone(), case.seed), (None, Some(9)));
}

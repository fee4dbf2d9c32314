//! The command line as a user sees it: its output, on which stream, and its exit codes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use crate::support::files;
use serde_json::Value;

fn hypedc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap()
}

/// Exit code, standard output and standard error as one text.
fn shown(arguments: &[&str]) -> String {
    let output = hypedc(arguments);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!(
        "$ hypedc {}\n--- exit {}\n{}--- standard error\n{}",
        arguments.join(" "),
        output.status.code().unwrap(),
        text(&output.stdout),
        text(&output.stderr)
    )
}

fn code(arguments: &[&str]) -> i32 {
    hypedc(arguments).status.code().unwrap()
}

/// A path for files of this test run.
fn temporary(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn written(name: &str, text: &str) -> String {
    let path = temporary(name);
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

const TEST1: &str = "examples/paper/test1.hyped";
const TEST2: &str = "examples/paper/test2.hyped";

#[test]
fn examples_check_clean() {
    let examples = files("examples", "hyped");
    let paths: Vec<&str> = examples.iter().map(|p| p.to_str().unwrap()).collect();
    let output = hypedc(&[&["check", "--format", "short"], paths.as_slice()].concat());
    assert_eq!((output.status.code(), output.stdout.as_slice(), output.stderr.as_slice()), (Some(0), &[][..], &[][..]));
}

#[test]
fn check_finds_all_mistakes_in_one_run() {
    insta::assert_snapshot!(shown(&["check", "--format", "short", "tests/ui/syntax_errors.hyped"]));
    let unreadable = shown(&["check", "no/such/file.hyped"]);
    assert!(unreadable.contains("exit 2") && unreadable.contains("cannot read `no/such/file.hyped`"), "{unreadable}");
    assert_eq!(code(&["check", TEST1, "no/such/file.hyped", "tests/ui/step.hyped"]), 2);
    assert_eq!(code(&["check", TEST1, "tests/ui/step.hyped"]), 1);
    assert_eq!(code(&["check"]), 2);
    assert_eq!(code(&["check", "examples"]), 2);
}

#[test]
fn deep_and_long_programs_get_an_answer() {
    let times = |text: &str, count: usize| text.repeat(count);
    let deep = 20_000;
    let programs = [
        ("parens", format!("const a = {}1{}\n", times("(", deep), times(")", deep)), "E0004"),
        ("open_parens", format!("const a = {}", times("(", deep)), "E0004"),
        ("modes", format!("entity A {{ {}{} }}\n", times("mode a {", deep), times("}", deep)), "E0004"),
        ("open_modes", format!("entity A {{ {}", times("mode a {\n", deep)), "E0004"),
        ("nots", format!("entity A {{ mode a {{ when {} true -> a }} }}\n", times("not ", deep)), "E0005"),
        ("terms", format!("const a = 1{}\n", times(" + 1", 1_000_000)), "E0005"),
        ("lines", format!("const a = 1{}\n", times("\n+ 1", 1_000_000)), "E0005"),
        ("products", format!("const a = 1{}\n", times("\n* 1", 1_000_000)), "E0005"),
        ("comparisons", format!("const a = 1{}\n", times("\n== 1", 1_000_000)), "E0005"),
        ("negations", format!("const a = {}1\n", times("-", deep)), "E0005"),
        ("name", format!("const {} = 1\n", times("a", 1_000_000)), "E0003"),
    ];
    for (name, text, expected) in programs {
        let path = written(&format!("deep_{name}.hyped"), &text);
        for format in ["human", "short"] {
            let output = hypedc(&["check", "--format", format, &path]);
            let found = String::from_utf8_lossy(&output.stdout).into_owned();
            assert_eq!(output.status.code(), Some(1), "{name}");
            assert!(found.contains(expected) && found.len() < 2_000, "{name}: {} bytes", found.len());
        }
    }
}

/// The exit code of a `check` and its findings, one a line; the folder of this test run is left out.
fn checked(path: &str) -> (i32, String) {
    let output = hypedc(&["check", "--format", "short", path]);
    let found = String::from_utf8(output.stdout).unwrap();
    (output.status.code().unwrap(), found.replace(&format!("{}/", env!("CARGO_TARGET_TMPDIR")), ""))
}

#[test]
fn odd_files_get_an_answer() {
    let answer = |name: &str, text: &[u8]| {
        let path = temporary(name);
        std::fs::write(&path, text).unwrap();
        checked(path.to_str().unwrap())
    };
    let no = |code: i32, found: &str| (code, format!("{found}\n"));
    assert_eq!(answer("empty.hyped", b""), (0, String::new()));
    assert_eq!(answer("crlf.hyped", b"\xef\xbb\xbfentity A {\r\n    x' = 3\r\n}\r\n"), (0, String::new()));
    // Places are counted without the mark and the carriage returns.
    assert_eq!(
        answer("crlf_wrong.hyped", b"\xef\xbb\xbfentity A {\r\n    x' = lost\r\n}\r\n"),
        no(1, "crlf_wrong.hyped:2:10: error[E0201]: no variable, parameter or constant named `lost`")
    );
    assert_eq!(
        answer("mark_wrong.hyped", b"\xef\xbb\xbfentitiy A { }\n").1,
        "mark_wrong.hyped:1:1: error[E0101]: unexpected `entitiy`\n"
    );
    assert_eq!(
        answer("bytes.hyped", b"a\xff\xfe"),
        no(2, "error[E0002]: `bytes.hyped` is not UTF-8 text: byte 1 fits no character")
    );
    let line = answer("line.hyped", "entity A { } ".repeat(4_000_000).as_bytes());
    assert_eq!(line, no(2, "error[E0003]: `line.hyped` is too large: 49.6 MiB, less than 16 MiB are read"));
    std::fs::remove_file(temporary("line.hyped")).unwrap();
    let folder = temporary("folder.hyped");
    std::fs::create_dir_all(&folder).unwrap();
    let (code, found) = checked(folder.to_str().unwrap());
    assert!(code == 2 && found.starts_with("error[E0001]: cannot read `folder.hyped`: "), "{found}");
    let (code, found) = checked("no/such/file.hyped");
    assert_eq!((code, found), no(2, "error[E0001]: cannot read `no/such/file.hyped`: no such file or directory"));
}

#[test]
#[cfg(unix)]
fn what_must_not_be_read_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let path = written("secret.hyped", "entity A { }\n");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    // A superuser may read this file too.
    if std::fs::read(&path).is_err() {
        let expected = "error[E0001]: cannot read `secret.hyped`: permission denied\n";
        assert_eq!(checked(&path), (2, expected.to_string()));
    }
    let link = temporary("link.hyped");
    let _ = std::fs::remove_file(&link);
    std::os::unix::fs::symlink("link.hyped", &link).unwrap();
    let (code, found) = checked(link.to_str().unwrap());
    assert!(code == 2 && found.starts_with("error[E0001]: cannot read `link.hyped`: "), "{found}");
}

#[test]
fn imports_in_a_circle_are_told_with_the_way() {
    let own = written("own.hyped", "import \"own.hyped\"\nentity A { }\n");
    let expected = "own.hyped:1:8: error[E0204]: files import each other: `own.hyped` → `own.hyped`\n";
    assert_eq!(checked(&own), (1, expected.to_string()));
    let first = written("first.hyped", "import \"second.hyped\"\nentity A { x' = v }\nconst v = 3\n");
    written("second.hyped", "import \"third.hyped\"\nentity B { }\n");
    written("third.hyped", "import \"./first.hyped\"\nentity C { }\n");
    let (code, found) = checked(&first);
    let way = "`first.hyped` → `second.hyped` → `third.hyped` → `./first.hyped`";
    assert_eq!((code, found), (1, format!("third.hyped:1:8: error[E0204]: files import each other: {way}\n")));
    let lost = written("lost.hyped", "import \"nowhere.hyped\"\nentity A { use Walk() }\n");
    let expected = "lost.hyped:1:8: error[E0001]: cannot read `nowhere.hyped`: no such file or directory\n";
    assert_eq!(checked(&lost), (1, expected.to_string()));
}

#[test]
fn people_see_the_first_mistakes() {
    let text: String = (0..250).map(|i| format!("entity A{i} {{ x' = lost{i} }}\n")).collect();
    let path = written("many.hyped", &text);
    let human = hypedc(&["check", &path]);
    let found = String::from_utf8(human.stdout).unwrap();
    assert_eq!(found.matches("error[E0201]").count(), 100);
    assert!(found.ends_with("\n\n… and 150 more, all of which `--format short` shows\n\n"), "{found}");
    assert!(String::from_utf8(human.stderr).unwrap().contains(": 250 errors"));
    assert_eq!(checked(&path).1.lines().count(), 250);
    let json = hypedc(&["check", "--format", "json", &path]);
    let json: Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["findings"].as_array().unwrap().len(), 250);
}

#[test]
fn findings_without_end_are_counted() {
    let modes: String = (0..5).map(|m| format!("mode m{m} {{ x' = lost }}\n")).collect();
    let text: String = (0..5_000).map(|i| format!("entity A{i} {{ {modes} }}\n")).collect();
    let path = written("endless.hyped", &text);
    let output = hypedc(&["check", "--format", "json", &path]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["findings"].as_array().unwrap().len(), 10_000);
    assert_eq!(json["programs"][0]["errors"], 25_000);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.ends_with(": more than 10000 findings; the other 15000 are only counted\n"), "{message}");
}

#[test]
fn the_ir_is_text_and_json() {
    insta::assert_snapshot!(shown(&["ir", TEST2]));
    let output = hypedc(&["ir", TEST2, "--format", "json"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let (version, program) = (&json["hypedc_program"], &json["program"]);
    assert_eq!(version, 1);
    assert_eq!(program["worlds"][0]["slots"][0]["name"], "hero");
    assert_eq!(program["exprs"].as_array().unwrap().len(), program["spans"]["exprs"].as_array().unwrap().len());
    assert_eq!(code(&["ir", "tests/ui/step.hyped"]), 2);
}

#[test]
fn a_compiled_program_stands_where_its_text_does() {
    let compiled = temporary("compiled.json");
    let compiled = compiled.to_str().unwrap();
    std::fs::write(compiled, hypedc(&["ir", TEST1, "--format", "json"]).stdout).unwrap();
    for question in [
        &["sim", "FILE", "--inputs", "right*40 left+right*3 -*10"][..],
        &["reach", "FILE", "--seed", "3", "--nodes", "5000", "--threads", "1", "--format", "json"],
        &["bounds", "FILE"],
        &["graph", "FILE"],
    ] {
        let said = |file: &str| {
            let arguments: Vec<&str> = question.iter().map(|a| if *a == "FILE" { file } else { a }).collect();
            let output = hypedc(&arguments);
            let text = String::from_utf8(output.stdout).unwrap().replace(file, "FILE");
            // The time and the hash of the file are not compared.
            let is_apart = |line: &str| ["\"seconds\"", "analysis_seconds", "sha256"].iter().any(|w| line.contains(w));
            let lines = text.lines().filter(|line| !is_apart(line)).map(str::to_string);
            (output.status.code(), lines.collect::<Vec<_>>())
        };
        assert_eq!(said(TEST1), said(compiled), "{question:?}");
    }
}

#[test]
fn a_compiled_program_that_cannot_be_run_is_refused() {
    let text = String::from_utf8(hypedc(&["ir", TEST1, "--format", "json"]).stdout).unwrap();
    let refused = |name: &str, text: &str| {
        let file = temporary(name);
        std::fs::write(&file, text).unwrap();
        let file = file.to_str().unwrap();
        assert_eq!(code(&["sim", file, "--inputs", "-*2"]), 2);
        shown(&["sim", file, "--inputs", "-*2"]).replace(file, name)
    };
    let mut far: Value = serde_json::from_str(&text).unwrap();
    far["program"]["entities"][2]["edges"][0]["target"] = 77.into();
    insta::assert_snapshot!(
        [
            refused("newer.json", &text.replace("\"hypedc_program\": 1", "\"hypedc_program\": 9")),
            refused("other.json", "{}"),
            refused("cut.json", &text[..3000]),
            refused("far.json", &far.to_string()),
        ]
        .join("\n")
    );
}

#[test]
fn sim_runs_scripts_and_writes_traces() {
    insta::assert_snapshot!(shown(&["sim", TEST1, "--inputs", "right*40 left+right*3 -*10"]));
    let trace = temporary("trace.jsonl");
    let trace = trace.to_str().unwrap();
    assert_eq!(code(&["sim", TEST2, "--inputs", "right*3 right+jump -", "--frames", "9", "--trace", trace]), 0);
    let lines: Vec<Value> =
        std::fs::read_to_string(trace).unwrap().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(lines.len(), 11, "a header and the states 0 to 9");
    assert_eq!(lines[0]["world"], "Test2");
    assert_eq!(lines[1]["step"], 0);
    assert_eq!(lines[4]["inputs"], serde_json::json!(["right"]));
    assert_eq!(lines[5]["inputs"], serde_json::json!(["right", "jump"]));
    let hero = &lines[10]["instances"]["hero"];
    assert_eq!((&hero["entity"], &hero["space"]), (&"Mario".into(), &"main".into()));
    assert_eq!(hero["x"].as_array().unwrap().len(), 3);
    assert_eq!(hero["modes"].as_array().unwrap().len(), 1);
}

#[test]
fn sim_says_what_is_wrong_with_inputs() {
    let mut all = String::new();
    for script in ["rihgt*3", "right*x", "right*99999999999", "2:right", "right=0.5", "+", "right*3 jump"] {
        all.push_str(&shown(&["sim", TEST1, "--inputs", script]));
    }
    all.push_str(&shown(&["sim", TEST2, "--inputs", "horizontal horizontal=2 left=1 jump=1"]));
    all.push_str(&shown(&["sim", TEST2, "--inputs", "jmup fire"]));
    all.push_str(&shown(&["sim", TEST1]));
    insta::assert_snapshot!(all);
    assert_eq!(code(&["sim", TEST1, "--inputs-file", "no/such/file"]), 2);
    assert_eq!(code(&["sim", TEST1, "--frames", "3", "--trace", "no/such/folder/trace"]), 2);
}

#[test]
fn a_fault_stops_the_step_and_is_shown() {
    let fault = written(
        "fault.hyped",
        "entity Counter {
    discrete count: int 0..3 = 0
    mode a { when timer >= 1frames { count := count + 1 } }
}
entity Divider {
    param speed = 60
    param end = 10
    x' = speed * end / (end - y)
    y' = speed
}
world Counting { space main { place counter: Counter at (0, 0) } }
world Dividing { space main { place divider: Divider at (0, 0) } }
",
    );
    for (world, step, what) in [("Counting", 5, "left its range"), ("Dividing", 11, "division by zero")] {
        let output = hypedc(&["sim", &fault, "--world", world, "--frames", "100"]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains(&format!("step {step} stopped")) && error.contains(what), "{error}");
    }
}

#[test]
fn reach_answers_with_exit_codes() {
    assert_eq!(code(&["reach", TEST1]), 0);
    assert_eq!(code(&["reach", TEST2, "--goal", "drawn", "--seed", "7"]), 0);
    assert_eq!(code(&["reach", TEST1, "--nodes", "2"]), 1);
    assert_eq!(code(&["reach", TEST1, "--seconds", "0", "--nodes", "1000000000", "--seed", "3"]), 1);
    assert_eq!(code(&["reach", TEST1, "--bounds", "naive"]), 0);
    assert_eq!(code(&["reach", TEST1, "--bounds", "exact"]), 2);
    let still = written(
        "still.hyped",
        "entity Rock { }\nworld W {\n    space main { place rock: Rock at (3, 4) }\n    goal there: rock.x > 3\n}\n",
    );
    let proven = hypedc(&["reach", &still, "--format", "json"]);
    assert_eq!(proven.status.code(), Some(1));
    let json: Value = serde_json::from_slice(&proven.stdout).unwrap();
    assert_eq!(json["goals"][0]["verdict"], "proven-unreachable");
    assert_eq!(json["goals"][0]["reasons"][0], "`rock.x > 3` never holds: rock.x = 3");
    let mut all = String::new();
    all.push_str(&shown(&["reach", TEST1, "--goal", "arive"]));
    all.push_str(&shown(&["reach", TEST1, "--world", "Test2"]));
    all.push_str(&shown(&["reach", "examples/paper/robot.hyped"]));
    all.push_str(&shown(&["reach", "tests/conformance/flappy_long.hyped"]));
    insta::assert_snapshot!(all);
    assert_eq!(code(&["reach", "no/such/file.hyped"]), 2);
    assert_eq!(code(&["reach", TEST1, "--seconds", "soon"]), 2);
    assert_eq!(code(&["reach", "tests/ui/step.hyped"]), 2);
}

#[test]
fn tune_says_what_it_can_change() {
    let out = hypedc(&["tune", "examples/mario.hyped"]);
    let message = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2));
    assert!(message.contains("--vary") && message.contains("--tiles"), "{message}");
    assert_eq!(code(&["tune", "examples/mario.hyped", "--vary", "Mario.x=1..2", "--tiles", "add"]), 2);
}

#[test]
fn reach_saves_inputs_that_replay_and_repeat() {
    let mut saved = Vec::new();
    for name in ["first.inputs", "second.inputs"] {
        let path = temporary(name);
        let arguments = ["reach", TEST2, "--seed", "11", "--format", "json", "--save-inputs", path.to_str().unwrap()];
        let json: Value = serde_json::from_slice(&hypedc(&arguments).stdout).unwrap();
        for goal in json["goals"].as_array().unwrap() {
            assert_eq!(goal["verdict"], "reached");
            let file = temporary(&name.replace(".inputs", &format!(".{}.inputs", goal["goal"].as_str().unwrap())));
            let script = std::fs::read_to_string(&file).unwrap();
            assert_eq!(script.trim_end(), goal["inputs"].as_str().unwrap());
            let output = hypedc(&["sim", TEST2, "--inputs-file", file.to_str().unwrap()]);
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let reached = format!("goal {}: reached at step {}\n", goal["goal"].as_str().unwrap(), goal["steps"]);
            assert!(text.contains(&reached), "{text}");
            saved.push(script);
        }
    }
    assert_eq!(saved.len(), 4);
    assert_eq!(saved[..2], saved[2..]);
}

#[test]
fn a_level_is_given_on_the_command_line() {
    let (open, closed, level) = ("tests/maps/open.hyped", "tests/maps/own.hyped", "tests/maps/mario-1-1.txt");
    let runs: [&[&str]; 3] = [&["ir"], &["sim", "--frames", "3"], &["reach"]];
    for run in runs {
        let run_with = |file: &str, map: &[&str]| {
            let output = hypedc(&[run, &[file], map].concat());
            (output.status.code().unwrap(), String::from_utf8_lossy(&output.stderr).into_owned())
        };
        let (code, error) = run_with(open, &[]);
        assert!(code == 2 && error.contains("error[E0602]") && error.contains("--map PATH"), "{run:?}: {error}");
        let (code, error) = run_with(closed, &["--map", level]);
        assert!(code == 2 && error.contains("error[E0602]") && error.contains("map level"), "{run:?}: {error}");
        let (code, error) = run_with(open, &["--map", "no/such/level.txt"]);
        assert!(code == 2 && error.contains("cannot read `no/such/level.txt`"), "{run:?}: {error}");
        assert_eq!(run_with(open, &["--map", level]), (0, String::new()), "{run:?}");
    }
    assert_eq!(code(&["check", open]), 0);
    assert_eq!(code(&["check", open, "--map", level]), 0);
    let all = written("all_open.hyped", "world Any { space main { map level } }\n");
    let (legend, small) = ("tests/maps/smb.json", "tests/maps/editors/valley.tmj");
    let runs: [&[&str]; 4] = [&["check"], &["ir"], &["sim", "--frames", "3"], &["bounds"]];
    for run in runs {
        let run_with = |options: &[&str]| code(&[run, &[all.as_str(), "--map", level], options].concat());
        assert_eq!(run_with(&["--legend", legend, "--tile", "16x16"]), 0, "{run:?}");
        assert_eq!(run_with(&["--legend", legend]), if run == ["check"] { 1 } else { 2 }, "{run:?}");
        assert_eq!(run_with(&["--legend", legend, "--tile", "0x16"]), 2, "{run:?}");
        assert_ne!(code(&[run, &[all.as_str(), "--map", small, "--tile", "8"]].concat()), 0, "{run:?}");
    }
    assert_eq!(code(&["check", closed, "--map", level]), 2);
    assert_eq!(code(&["check", open, "--map", "no/such/level.txt"]), 2);
    let wrong = written("wrong_level.txt", "---\n-%\n");
    let output = hypedc(&["check", "--format", "short", open, "--map", &wrong]);
    let found = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1));
    assert!(found.contains("wrong_level.txt:2:1: error[E0501]: row 2 has 2 tiles, others have 3"), "{found}");
    assert!(found.contains("wrong_level.txt:2:2: error[E0501]: no tile `%`"), "{found}");
}

/// Runs `hypedc` with a text on standard input: exit code, standard output, standard error.
fn answered(arguments: &[&str], input: &[u8]) -> (i32, Vec<u8>, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_hypedc"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    let output = child.wait_with_output().unwrap();
    (output.status.code().unwrap(), output.stdout, String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn fmt_rewrites_what_is_not_formatted() {
    let (messy, tidy) = ("entity A{\n  x'=3\n}\n", "entity A {\n    x' = 3\n}\n");
    let path = written("messy.hyped", messy);
    let bad = written("bad.hyped", "entity A { mode }\n");
    let marked = written("marked.hyped", &format!("\u{feff}{}", tidy.replace('\n', "\r\n")));
    let long = written("long.hyped", &format!("const a = 1{}\n", " ".repeat(300)));
    let folder = temporary("").to_string_lossy().into_owned();
    let all = shown(&["fmt", "--check", &path, TEST1, &bad, "no/such/file.hyped", &marked, &long]);
    insta::assert_snapshot!(all.replace(&folder, ""));
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    assert_eq!(read(&path), messy, "a check changes nothing");
    assert_eq!(code(&["fmt", "--check", &path]), 1);
    assert_eq!(code(&["fmt", &path, &bad]), 1);
    assert_eq!(code(&["fmt", &path, &bad, "no/such/file.hyped"]), 2);
    assert_eq!((read(&path).as_str(), read(&bad).as_str()), (tidy, "entity A { mode }\n"));
    assert_eq!(code(&["fmt", "--check", &path]), 0);
    assert_eq!(code(&["fmt", &marked]), 0);
    assert_eq!(read(&marked), tidy.replace('\n', "\r\n"), "the byte order mark goes, the line ends stay");
    assert_eq!(code(&["fmt"]), 2);
    assert_eq!(code(&["fmt", "examples"]), 2);
}

#[test]
fn fmt_touches_only_what_it_changes_and_loses_nothing() {
    let folder = temporary("fmt_folder");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir(&folder).unwrap();
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    std::fs::write(at("tidy.hyped"), "const a = 1\n").unwrap();
    std::fs::write(at("messy.hyped"), "const  a = 1\n").unwrap();
    std::fs::write(at("locked.hyped"), "const  a = 1\n").unwrap();
    let mut permissions = std::fs::metadata(at("locked.hyped")).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(at("locked.hyped"), permissions).unwrap();
    let modified = |name: &str| std::fs::metadata(at(name)).unwrap().modified().unwrap();
    let before = modified("tidy.hyped");
    let output = hypedc(&["fmt", &at("tidy.hyped"), &at("messy.hyped"), &at("locked.hyped")]);
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &[][..]));
    assert!(String::from_utf8_lossy(&output.stderr).contains("locked.hyped`: it is read-only"));
    assert_eq!(modified("tidy.hyped"), before);
    assert_eq!(std::fs::read_to_string(at("messy.hyped")).unwrap(), "const a = 1\n");
    assert_eq!(std::fs::read_to_string(at("locked.hyped")).unwrap(), "const  a = 1\n");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3, "nothing is left beside them");
}

#[cfg(unix)]
#[test]
fn fmt_keeps_links_and_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let path = written("linked.hyped", "const  a = 1\n");
    let link = temporary("link.hyped");
    let _ = std::fs::remove_file(&link);
    std::os::unix::fs::symlink(&path, &link).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
    assert_eq!(code(&["fmt", link.to_str().unwrap()]), 0);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "const a = 1\n");
    assert_eq!(std::fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
}

#[test]
fn fmt_goes_from_standard_input_to_standard_output() {
    let tidy = b"const a = 1\n".to_vec();
    assert_eq!(answered(&["fmt", "-"], b"const  a=1"), (0, tidy.clone(), String::new()));
    assert_eq!(answered(&["fmt", "-"], &tidy), (0, tidy.clone(), String::new()));
    assert_eq!(answered(&["fmt", "-", "--check"], &tidy), (0, Vec::new(), String::new()));
    let (code, shown, _) = answered(&["fmt", "-", "--check"], b"const a = 1");
    assert_eq!(
        (code, String::from_utf8_lossy(&shown).as_ref()),
        (1, "<stdin>:1: not formatted\n  - const a = 1 (no line end)\n  + const a = 1\n")
    );
    let (code, shown, error) = answered(&["fmt", "-"], b"const a");
    assert!(code == 1 && shown.is_empty() && error.contains("<stdin>:1:7"), "{error}");
    let (code, shown, error) = answered(&["fmt", "-"], &[b'a', 0xff]);
    assert!(code == 2 && shown.is_empty() && error.contains("error[E0002]"), "{error}");
}

#[test]
fn a_hyphen_names_no_file() {
    for arguments in [["--svg", "-"], ["--save-inputs", "-"], ["--html", "-"], ["--junit", "-"], ["--csv", "-"]] {
        let text = shown(&[&["reach", TEST1], arguments.as_slice()].concat());
        assert!(text.contains("--- exit 2") && text.contains("standard output has the result already"), "{text}");
    }
    assert!(!PathBuf::from("-").exists());
    // Where standard output can have it, it does.
    let entity = "tests/import/xml/mario.char.xml";
    let imported = |more: &[&str]| hypedc(&[&["import", "xml", entity], more].concat());
    assert_eq!(imported(&["-o", "-"]).stdout, imported(&[]).stdout);
    let text = shown(&["reach", TEST1, "--skill", "soon"]);
    assert!(text.contains("a number of steps such as `12`, or a time such as"), "{text}");
}

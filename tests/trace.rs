//! Traces of `hypedc sim`: equivalent JSON lines and CSV, runs that are reproduced from their header alone, and
//! expectations on the result of a run.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;
use std::process::Command;

use hypedc::tabular::csv;
use serde_json::Value;

/// Two instances, one of which is spawned later; all kinds of columns.
const GAME: &str = "entity Hero {
    button fire
    discrete shots: int 0..9 = 0
    discrete _ready: bool = true
    discrete _mood: {calm, angry} = calm
    ref _last: Shot
    collider body: rect(0, 0, 8, 8)
    x' = 60
    group arms {
        mode idle { when pressed(fire) and shots < 9 -> firing { shots := shots + 1; _ready := false; _mood := angry } }
        mode firing { when timer >= 3frames -> idle { _ready := true } }
    }
    group legs { mode walking { } }
}
entity Shot { x' = 200 }
world W {
    step 1/50
    space main { place hero: Hero at (0.1, 0) }
    player 1: hero
    goal far: hero.x > 10
    goal shot: hero.shots > 1
    never lost: hero.x > 40
}
";

struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("trace").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let place = Place(folder);
        place.write("game.hyped", GAME);
        place
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }

    /// Exit code, standard output, standard error.
    fn sim(&self, arguments: &[&str]) -> (i32, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
        let output = command.arg("sim").args(arguments).current_dir(&self.0).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    }
}

/// A script that reaches all there is, short of `lost`.
const SCRIPT: &str = "fire -*4 fire*2 -*9";

#[test]
fn csv_holds_what_json_lines_hold() {
    let place = Place::new("csv");
    let run = |arguments: &[&str]| {
        let (code, _, error) = place.sim(&[&["game.hyped", "--inputs", SCRIPT], arguments].concat());
        assert_eq!((code, error.as_str()), (0, ""));
    };
    run(&["--trace", "a.csv"]);
    run(&["--trace", "b.txt", "--trace-format", "csv"]);
    run(&["--trace", "a.jsonl"]);
    let (text, json) = (place.read("a.csv"), place.read("a.jsonl"));
    assert_eq!(text, place.read("b.txt"));
    let (mut lines, mut states) = (text.lines(), json.lines());
    assert_eq!(lines.next().unwrap().strip_prefix("# ").unwrap(), states.next().unwrap(), "the same header");
    let columns = csv::cells(lines.next().unwrap());
    let expected = "step,inputs,hero.space,hero.mode.arms,hero.mode.legs,hero.x,hero.x',hero.x'',hero.y,hero.y',hero.y'',\
                    hero.shots,hero._ready,hero._mood,hero._last,hero.timer.arms.firing,goal.far,goal.shot,never.lost";
    assert_eq!(columns.join(","), expected);
    let mut count = 0;
    for (line, state) in lines.zip(states) {
        let cells = csv::cells(line);
        assert_eq!(cells.len(), columns.len());
        let state: Value = serde_json::from_str(state).unwrap();
        let hero = &state["instances"]["hero"];
        let cell = |name: &str| cells[columns.iter().position(|c| c == name).unwrap()].as_str();
        let number = |name: &str| cell(name).parse::<f64>().unwrap();
        assert_eq!(number("step"), f64::from(count));
        let inputs: Vec<&str> = state["inputs"].as_array().unwrap().iter().map(|i| i.as_str().unwrap()).collect();
        assert_eq!(cell("inputs"), inputs.join("+"));
        assert_eq!(cell("hero.space"), hero["space"]);
        assert_eq!([cell("hero.mode.arms"), cell("hero.mode.legs")], [&hero["modes"][0], &hero["modes"][1]]);
        for (degree, name) in ["hero.x", "hero.x'", "hero.x''"].iter().enumerate() {
            assert_eq!(number(name), hero["x"][degree].as_f64().unwrap(), "to the bit");
        }
        assert_eq!(number("hero.shots"), hero["shots"].as_f64().unwrap());
        assert_eq!(cell("hero._ready"), hero["_ready"].to_string());
        assert_eq!((cell("hero._mood"), cell("hero._last")), (hero["_mood"].as_str().unwrap(), ""));
        assert_eq!(number("hero.timer.arms.firing"), hero["timers"]["arms.firing"].as_f64().unwrap());
        for goal in ["far", "shot"] {
            let held = state["goals"].as_array().is_some_and(|goals| goals.iter().any(|g| g == goal));
            assert_eq!(cell(&format!("goal.{goal}")), held.to_string());
        }
        count += 1;
    }
    assert_eq!(count, 17, "the states 0 to 16");
}

#[test]
fn what_is_not_there_has_empty_cells() {
    let place = Place::new("absent");
    let text = "entity Nest { button go; mode a { when pressed(go) -> b { spawn Bird(x = 3, y = 4) } } mode b { } }
entity Bird { x' = 5 }
world W {
    limit Bird 1
    space main { place nest: Nest at (0, 0) }
    player 1: nest
}
";
    place.write("game.hyped", text);
    let (code, _, error) = place.sim(&["game.hyped", "--inputs", "- go -", "--trace", "a.csv"]);
    assert_eq!((code, error.as_str()), (0, ""));
    let trace = place.read("a.csv");
    let rows: Vec<Vec<String>> = trace.lines().skip(1).map(csv::cells).collect();
    let at = rows[0].iter().position(|c| c.ends_with(".x") && !c.starts_with("nest")).unwrap();
    let birds: Vec<&str> = rows[1..].iter().map(|row| row[at].as_str()).collect();
    assert_eq!(birds[..2], ["", ""]);
    assert!(birds[3].parse::<f64>().unwrap() > 3.0, "{birds:?}");
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "columns stay");
}

#[test]
fn a_run_is_made_again_from_its_header_alone() {
    let place = Place::new("replay");
    for name in ["a.csv", "a.jsonl"] {
        let run = ["game.hyped", "--inputs", SCRIPT, "--frames", "30", "--trace", name];
        assert_eq!(place.sim(&run).0, 0);
        let again = place.sim(&["--replay", name]);
        assert_eq!(again, (0, format!("{name}: all 30 steps are the same\n"), String::new()));
        let trace = place.read(name);
        let lines: Vec<&str> = trace.lines().collect();
        // The state at step 7 stands in one line of each; its numbers are the only ones to be changed.
        let at = lines.iter().position(|l| l.starts_with("7,") || l.starts_with("{\"step\":7,")).unwrap();
        let x = ["8.5", "8.500000000000002", "8.499999999999998"];
        let changed = x.iter().find_map(|x| lines[at].contains(x).then(|| lines[at].replacen(x, "8.25", 1)));
        let changed = changed.unwrap_or_else(|| panic!("{}", lines[at]));
        let with = |line: &str| [&lines[..at], &[line], &lines[at + 1..]].concat().join("\n") + "\n";
        place.write("changed", &with(&changed));
        let (code, shown, _) = place.sim(&["--replay", "changed"]);
        let place_of_x = if name == "a.csv" { "hero.x: 8.25" } else { "instances.hero.x[0]: 8.25" };
        let told = format!("changed: step 7 is the first to differ, in {place_of_x} in the trace, 8.");
        assert!(code == 1 && shown.starts_with(&told), "{shown}");
        place.write("cut", &(lines[..at].join("\n") + "\n"));
        let cut = place.sim(&["--replay", "cut"]);
        assert_eq!(cut, (1, "cut: the trace ends before step 7\n".to_string(), String::new()));
        place.write("long", &format!("{trace}{}\n", lines[at]));
        let (code, shown, _) = place.sim(&["--replay", "long"]);
        assert!(code == 1 && shown.starts_with("long: the trace goes on where the run is over: "), "{shown}");
    }
}

#[test]
fn a_trace_of_another_program_is_told() {
    let place = Place::new("another");
    assert_eq!(place.sim(&["game.hyped", "--inputs", SCRIPT, "--trace", "a.jsonl"]).0, 0);
    place.write("fast.hyped", &GAME.replace("x' = 60", "x' = 61"));
    let (code, shown, _) = place.sim(&["fast.hyped", "--replay", "a.jsonl"]);
    assert_eq!(code, 1);
    assert!(
        shown.starts_with("a.jsonl: recorded with a different program than fast.hyped\n  SHA-256 of the trace  "),
        "{shown}"
    );
    assert!(
        shown.contains("step 1 is the first to differ, in instances.hero.x[0]: 1.3 in the trace, 1.32 now"),
        "{shown}"
    );
    place.write("same.hyped", &format!("entity Unused {{ }}\n{GAME}"));
    let (code, shown, _) = place.sim(&["same.hyped", "--replay", "a.jsonl"]);
    assert!(
        code == 1 && shown.contains("a different program") && shown.contains("all 16 steps are the same"),
        "{shown}"
    );
    // A level is part of what a trace depends on.
    let open = GAME.replace("space main {", "tiles own 8 x 8 { '.': empty }\n    space main { map level own\n   ");
    place.write("open.hyped", &open);
    place.write("level.txt", "........\n");
    let run = ["open.hyped", "--map", "level.txt", "--frames", "3", "--trace", "b.csv"];
    let ran = place.sim(&run);
    assert_eq!(ran.0, 0, "{}", ran.2);
    assert_eq!(place.sim(&["--replay", "b.csv"]).0, 0, "the header names the level");
    place.write("level.txt", ".......\n");
    let (code, shown, _) = place.sim(&["--replay", "b.csv"]);
    assert!(code == 1 && shown.contains("recorded with a different program or level"), "{shown}");
}

#[test]
fn what_cannot_be_replayed_is_told() {
    let place = Place::new("refused");
    assert_eq!(place.sim(&["game.hyped", "--inputs", SCRIPT, "--trace", "a.jsonl"]).0, 0);
    place.write("old.jsonl", &place.read("a.jsonl").replacen("{\"trace\":2,", "{\"trace\":1,", 1));
    place.write("none.jsonl", "step,inputs\n");
    place.write("lost.jsonl", &place.read("a.jsonl").replacen("game.hyped", "lost.hyped", 1));
    for (name, expected) in [
        ("old.jsonl", "a trace of version 1"),
        ("none.jsonl", "cannot replay `none.jsonl`"),
        ("nowhere.jsonl", "cannot read `nowhere.jsonl`"),
        ("lost.jsonl", "cannot read `lost.hyped`"),
    ] {
        let (code, shown, error) = place.sim(&["--replay", name]);
        assert_eq!((code, shown.as_str()), (2, ""), "{name}");
        assert!(error.contains(expected), "{name}: {error}");
    }
    assert_eq!(place.sim(&["--replay", "a.jsonl", "--inputs", "-"]).0, 2);
    assert_eq!(place.sim(&["--inputs", "-"]).0, 2, "a program is needed");
    assert_eq!(place.sim(&["game.hyped", "--inputs", "-", "--trace-format", "csv"]).0, 2);
}

#[test]
fn what_is_expected_makes_the_exit_code() {
    let place = Place::new("expected");
    let run = |arguments: &[&str]| place.sim(&[&["game.hyped", "--inputs", SCRIPT], arguments].concat());
    let (code, shown, error) = run(&["--expect", "far", "--expect", "shot", "--expect-not", "lost"]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(shown.contains("goal far: reached at step 9\n"), "{shown}");
    let (code, _, error) = run(&["--frames", "8", "--expect", "far", "--expect", "shot"]);
    assert_eq!((code, error.as_str()), (1, "error: `--expect far`: the goal was not reached in 8 steps\n"));
    let (code, _, error) = run(&["--expect-not", "far"]);
    assert_eq!((code, error.as_str()), (1, "error: `--expect-not far`: the goal held at step 9\n"));
    let (code, _, error) = run(&["--frames", "60", "--expect-not", "lost"]);
    assert_eq!((code, error.as_str()), (1, "error: `--expect-not lost`: the never held at step 34\n"));
    let (code, _, error) = run(&["--expect", "fer"]);
    assert!(code == 2 && error.contains("no goal `fer`") && error.contains("did you mean `far`?"), "{error}");
    let (code, _, error) = run(&["--expect-not", "nobody"]);
    assert!(code == 2 && error.contains("there is `far`, `shot`, `lost`"), "{error}");
    assert_eq!(run(&["--expect", "lost"]).0, 2, "a `never` is nothing to hope for");
}

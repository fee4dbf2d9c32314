//! The JSON Schemas in `docs/schemas`: they are those of the code, and what the commands write is as they say.
//!
//! `UPDATE=1 cargo test --test language schemas` rewrites them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::files;
use hypedc::cli::schemas;
use serde_json::Value;

const FOLDER: &str = "docs/schemas";

fn text(arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments.split_whitespace()).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// What a command writes to standard output.
fn written(arguments: &str) -> Value {
    serde_json::from_str(&text(arguments)).unwrap_or_else(|e| panic!("{arguments}: {e}"))
}

/// The objects of a file of JSON lines.
fn lines(path: &Path) -> Vec<Value> {
    std::fs::read_to_string(path).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Holds values against the schema of a name, and the same values with a key that is misspelt.
fn validate(name: &str, values: &[Value]) {
    assert!(!values.is_empty());
    let schema = schemas().into_iter().find(|(n, _)| *n == name).unwrap().1;
    let validator = jsonschema::draft202012::new(&schema).unwrap();
    for value in values {
        if let Some(error) = validator.iter_errors(value).next() {
            panic!("{name}: {error} at {}", error.instance_path());
        }
        let mut keys = Vec::new();
        fields(value, String::new(), &mut keys);
        for (object, key) in keys.iter().step_by(keys.len() / 60 + 1) {
            let mut broken = value.clone();
            let fields = broken.pointer_mut(object).unwrap().as_object_mut().unwrap();
            let old = fields.remove(key).unwrap();
            fields.insert(format!("{key}_"), old);
            assert!(!validator.is_valid(&broken), "{name}: `{key}` in `{object}` has another name");
        }
    }
}

/// The keys of all objects, with the pointers to these; those of instances and of their variables are the program's.
fn fields(value: &Value, at: String, out: &mut Vec<(String, String)>) {
    match value {
        Value::Array(all) => all.iter().enumerate().for_each(|(i, value)| fields(value, format!("{at}/{i}"), out)),
        Value::Object(all) => {
            for (key, value) in all {
                out.push((at.clone(), key.clone()));
                if key != "instances" {
                    fields(value, format!("{at}/{key}"), out);
                }
            }
        }
        _ => {}
    }
}

/// A file of this test run.
fn temporary(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("schemas");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    let _ = std::fs::remove_file(&path);
    path
}

#[test]
fn the_documentation_has_the_schemas_of_the_code() {
    let mut expected: Vec<PathBuf> = Vec::new();
    for (name, schema) in schemas() {
        let path = Path::new(FOLDER).join(format!("{name}.json"));
        let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(kept == text, "{} is another; `UPDATE=1 cargo test --test language schemas` writes it", path.display());
        expected.push(path);
    }
    expected.sort();
    assert_eq!(files(FOLDER, "json"), expected);
}

#[test]
fn findings_are_as_their_schema_says() {
    let named = ["misspelt_words", "habits", "dimension_conflict", "idle_edge", "import_cycle"];
    let paths: Vec<String> = named.iter().map(|n| format!("tests/ui/{n}.hyped")).collect();
    let found = written(&format!("check --format json {}", paths.join(" ")));
    assert!(found["findings"].as_array().unwrap().len() > 4);
    validate("findings", &[found, written("check --format json examples/balloon.hyped")]);
}

#[test]
fn bounds_are_as_their_schema_says() {
    let examples = ["balloon", "frog", "link", "paper/test1", "switch_door"];
    let all: Vec<Value> =
        examples.iter().map(|name| written(&format!("bounds --format json examples/{name}.hyped"))).collect();
    validate("bounds", &all);
}

#[test]
fn stuck_places_are_as_their_schema_says() {
    let questions = ["examples/sokoban.hyped --world First", "examples/flappy.hyped --states 1000 --nodes 2000"];
    let all: Vec<Value> = questions.iter().map(|q| written(&format!("stuck --format json {q}"))).collect();
    validate("stuck", &all);
}

#[test]
fn changes_are_as_their_schema_says() {
    let of = "tune --format json examples/balloon.hyped --nodes 300 --samples 2";
    let asked =
        ["--vary Balloon.lift=20..60", "--vary Balloon.lift=100..200 --goal balloon.y>500 --never balloon.y>800"];
    validate("tune", &asked.map(|q| written(&format!("{of} {q}"))));
    let of = "tune --format json examples/balloon.hyped --nodes 300 --max 1";
    let asked = ["--tiles add --goal balloon.y>9000", "--tiles remove", "--tiles add --prevent"];
    validate("tune-tiles", &asked.map(|q| written(&format!("{of} {q}"))));
}

#[test]
fn comparisons_are_as_their_schema_says() {
    let text = std::fs::read_to_string("examples/frog.hyped").unwrap();
    let lower = text.replace("param more_up = 240", "param more_up = 120");
    assert_ne!(lower, text);
    let path = temporary("frog.hyped");
    std::fs::write(&path, lower).unwrap();
    let of = format!("diff --format json --nodes 300 examples/frog.hyped {}", path.display());
    validate("diff", &[written(&of), written(&format!("{of} --no-search"))]);
}

#[test]
fn results_are_as_their_schema_says() {
    let questions = [
        "examples/paper/test2.hyped --goal drawn --tree",
        "examples/paper/test1.hyped --within 20frames",
        "examples/link.hyped --goal treasure --without hero.keys>0",
        "examples/platforms.hyped --never stung --nodes 300",
        "examples/frog.hyped --nodes 40 --planner rrt --after -*10",
        "examples/frog.hyped --goal crossed --nodes 1000 --robust sigma=1frame,trials=200",
    ];
    let all: Vec<Value> = questions.iter().map(|q| written(&format!("reach --format json {q}"))).collect();
    validate("results", &all);
}

#[test]
fn other_answers_of_reach_are_as_their_schemas_say() {
    let explored = ["examples/link.hyped --nodes 200", "examples/mario.hyped --nodes 100 --set Mario.gravity=-900"];
    let all = explored.map(|q| written(&format!("reach --explore --format json {q}")));
    validate("exploration", &all);
    let layers = [
        "examples/balloon.hyped --nodes 100 --skill 9,30",
        "examples/link.hyped --nodes 50 --skill-without hero.keys>0",
    ];
    validate("skill", &layers.map(|q| written(&format!("reach --format json {q}"))));
    let sweeps = [
        "examples/balloon.hyped --nodes 100 --set Balloon.lift=20..60/20",
        "examples/balloon.hyped --nodes 100 --set Balloon.lift=20..60/20 --set Balloon.sink=-80..-40/40 --never balloon.x<-9",
    ];
    validate("sweep", &sweeps.map(|q| written(&format!("reach --format json {q}"))));
}

#[test]
fn reasons_are_as_their_schema_says() {
    let of = "why --format json examples/link.hyped --inputs-file examples/inputs/link.inputs";
    let asked = ["--at 0", "--at 300", "--instance guard --at 20", "--mode dead --not", "--edge 33 --not"];
    validate("why", &asked.map(|q| written(&format!("{of} {q}"))));
}

#[test]
fn runs_are_as_their_schema_says() {
    let link = "examples/link.hyped --inputs-file examples/inputs/link.inputs";
    let runs = [link.to_string(), format!("{link} --frames 10"), "examples/balloon.hyped --inputs -*90".to_string()];
    validate("sim", &runs.map(|run| written(&format!("sim --format json {run}"))));
}

#[test]
fn rows_are_as_their_schema_says() {
    let (rows, again) = (temporary("rows.jsonl"), temporary("again.jsonl"));
    let broken = temporary("broken.txt");
    std::fs::write(&broken, "--\n-\n").unwrap();
    let of = "reach examples/smb/smb.hyped --nodes 300 --map examples/smb/mario-1-1.txt";
    text(&format!("{of} {} --results {}", broken.display(), rows.display()));
    let options = format!("--goal end --baseline {} --results {} --format json", rows.display(), again.display());
    let levels = written(&format!("{of} {options}"));
    assert!(lines(&rows).iter().any(|row| row["verdict"] == "error"));
    validate("row", &lines(&rows));
    validate("levels", &[levels]);
}

#[test]
fn shards_are_as_their_schemas_say() {
    let rows = temporary("shard.jsonl");
    let of = "reach examples/smb/smb.hyped --nodes 300 --map examples/smb/mario-1-1.txt examples/smb/mario-1-2.txt";
    let levels = written(&format!("{of} --shard 2/2 --results {} --format json", rows.display()));
    assert_eq!(levels["shard"]["index"], 2);
    validate("levels", &[levels]);
    let mut lines = lines(&rows);
    let all = lines.split_off(1);
    validate("shard", &lines);
    validate("row", &all);
}

#[test]
fn experiments_are_as_their_schema_says() {
    let few = "--seeds 2 --nodes 200 --planners rrt --bounds reduced --format json";
    let of = |what: &str| written(&format!("experiment {what} {few}"));
    validate("experiment", &[of("paper --tests 1"), of("examples/balloon.hyped")]);
}

#[test]
fn traces_are_as_their_schemas_say() {
    for name in ["balloon", "link", "mario", "boss"] {
        let inputs = format!("examples/inputs/{name}.inputs");
        let trace = text(&format!("sim examples/{name}.hyped --inputs-file {inputs} --trace -"));
        let mut all: Vec<Value> = trace.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let states = all.split_off(1);
        validate("trace-header", &all);
        validate("trace-line", &states.into_iter().step_by(50).collect::<Vec<_>>());
    }
}

//! Reports as pages: what a page carries is what the command prints, and its inputs lead where it says. `.ci/web` opens
//! them in a browser.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

fn temporary(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Exit code, standard output and standard error.
fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

/// Writes a page with something in place of the engine; its report, and the text that was printed.
fn reported(name: &str, arguments: &[&str]) -> (Value, Value, String) {
    let (page, engine) = (temporary(&format!("{name}.html")), temporary(&format!("{name}.wasm")));
    std::fs::write(&engine, b"\0asm\x01\0\0\0").unwrap();
    let paths = ["--html", page.to_str().unwrap(), "--engine", engine.to_str().unwrap()];
    let (code, out, error) = run(&[arguments, &paths].concat());
    assert!(code < 2, "{error}");
    let text = std::fs::read_to_string(&page).unwrap();
    let data = |id: &str| {
        let begin = format!("id=\"{id}\">");
        let from = text.find(&begin).unwrap() + begin.len();
        let length = text[from..].find("</script>").unwrap();
        serde_json::from_str(&text[from..from + length]).unwrap()
    };
    (data("report"), data("project"), out)
}

/// What is printed about a run with these inputs.
fn end(file: &str, script: &str) -> String {
    let (code, out, error) = run(&["sim", file, "--inputs", script]);
    assert!(code < 2, "{error}");
    out
}

#[test]
fn a_page_says_what_is_printed_and_its_inputs_lead_there() {
    let file = "examples/platforms.hyped";
    let (report, project, out) = reported("platforms", &["reach", file]);
    assert_eq!(project["world"], "Chasm");
    assert_eq!(out.lines().next(), report["title"].as_str());
    let ways = report["ways"].as_array().unwrap();
    // Two goals, and what was violated on the way to them.
    assert_eq!(ways.iter().filter(|way| way["kind"] == "goal").count(), 2, "{ways:?}");
    assert!(ways.iter().any(|way| way["kind"] == "never"), "{ways:?}");
    for way in ways {
        let (kind, name) = (way["kind"].as_str().unwrap(), way["name"].as_str().unwrap());
        let verdict = format!("  {kind} {name}: {}", way["verdict"].as_str().unwrap());
        assert!(out.lines().any(|line| line.starts_with(&verdict)), "{verdict}: {out}");
        let witness = &way["witness"];
        let ghost = witness["ghost"].as_array().unwrap();
        let steps = witness["steps"].as_u64().unwrap();
        assert_eq!(ghost[0].as_array().unwrap().len() as u64, steps + 1);
        let said = end(file, witness["script"].as_str().unwrap());
        let held = if kind == "goal" { "reached" } else { "violated" };
        assert!(said.contains(&format!("{kind} {name}: {held} at step {steps}\n")), "{said}");
        if kind == "goal" {
            let lines = way["lines"].as_array().unwrap();
            assert!(lines.iter().all(|line| out.contains(line.as_str().unwrap())), "{lines:?}");
            // Roots and nodes of the search.
            let cells = way["covered"].as_array().unwrap();
            let nodes: i64 = cells.iter().map(|cell| cell[3].as_i64().unwrap()).sum();
            assert!(lines[1].as_str().unwrap().starts_with(&format!("search  {nodes} nodes")), "{nodes}: {lines:?}");
        }
        let picture = way["picture"].as_str();
        assert!(kind == "never" || picture.unwrap().starts_with("<svg"), "{picture:?}");
    }
}

#[test]
fn a_proof_has_its_reason_and_no_inputs_where_nothing_is_nearer() {
    let file = "tests/verdicts/axis_and_button.hyped";
    let (report, ..) = reported("lift", &["reach", file, "--goal", "lift", "--without", "car.x > 190"]);
    let way = &report["ways"][0];
    assert_eq!((&way["tone"], &way["witness"]), (&Value::from("proof"), &Value::Null));
    assert!(way["lines"][0].as_str().unwrap().contains("never holds"), "{way}");
    assert!(report["title"].as_str().unwrap().ends_with("without car.x > 190"), "{report}");
}

/// What nature draws is in the inputs: the page draws by another seed.
#[test]
fn the_page_of_a_run_carries_what_nature_drew() {
    let file = temporary("coins.hyped");
    let text = "entity Gambler {
            chance roll: 1..6
            discrete sum: int 0..60 = 0
            always { when roll > 0 { sum += roll } }
            mode playing { }
        }
        world Table { space main { place gambler: Gambler at (0, 0) } goal rich: gambler.sum > 20 }";
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let (report, _, out) = reported("coins", &["sim", file, "--frames", "9", "--chance", "seed=5"]);
    let way = &report["ways"][0];
    assert_eq!(way["witness"]["steps"], 9);
    let script = way["witness"]["script"].as_str().unwrap();
    assert_eq!(end(file, script), out);
    assert_ne!(run(&["sim", file, "--frames", "9"]).1, out, "seeds differ");
    let moments = way["moments"].as_array().unwrap();
    assert!(moments.iter().all(|of| of["text"] == "goal rich" && out.contains(&format!("step {}", of["frame"]))));
    assert!(!moments.is_empty(), "{out}");
}

#[test]
fn pages_that_cannot_be_are_refused_before_any_work() {
    let page = temporary("none.html");
    let page = page.to_str().unwrap();
    for command in [&["reach", "examples/balloon.hyped"][..], &["sim", "examples/balloon.hyped", "--frames", "9"]] {
        let (code, out, error) = run(&[command, &["--html", page, "--engine", "README.md"]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{error}");
        assert!(error.contains("`README.md` is no module of WebAssembly"), "{error}");
    }
    let level = "tests/maps/mario-1-1.txt";
    let many =
        ["reach", "tests/maps/open.hyped", "--map", level, "tests/maps", "--html", page, "--engine", "README.md"];
    let (code, _, error) = run(&many);
    assert!(code == 2 && error.contains("`--engine` is for the page about one level"), "{error}");
    // The page carries the text as it is written.
    for setting in ["lift=90", "lift=90..120/10"] {
        let setting = format!("Balloon.{setting}");
        let (code, out, error) = run(&["reach", "examples/balloon.hyped", "--set", &setting, "--html", page]);
        assert_eq!((code, out.as_str()), (2, ""), "{error}");
        assert!(error.contains("cannot be used with"), "{error}");
    }
    assert_eq!(run(&["reach", "examples/balloon.hyped", "--explore", "--html", page]).0, 2);
    assert_eq!(run(&["sim", "--replay", "run.jsonl", "--html", page]).0, 2);
    assert!(!temporary("none.html").exists());
}

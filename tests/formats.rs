//! The output of `check` for tools: the JSON object and the SARIF log, validated against the format's schema.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::files;
use hypedc::diagnostic::Code;
use serde_json::Value;

fn hypedc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_slice(&hypedc(arguments).stdout).unwrap()
}

/// The schema of SARIF 2.1.0 by OASIS.
fn sarif_schema() -> Value {
    let mut schema: Value = serde_json::from_str(include_str!("schemas/sarif-2.1.0.json")).unwrap();
    // The pattern for a language's code is no regular expression. We name no language.
    for place in ["run", "toolComponent"] {
        schema["definitions"][place]["properties"]["language"].as_object_mut().unwrap().remove("pattern");
    }
    schema
}

/// Every region in a value.
fn regions<'v>(value: &'v Value, out: &mut Vec<(&'v Value, &'v Value)>) {
    match value {
        Value::Object(fields) => {
            if let (Some(location), Some(region)) = (fields.get("artifactLocation"), fields.get("region")) {
                out.push((location, region));
            }
            fields.values().for_each(|v| regions(v, out));
        }
        Value::Array(values) => values.iter().for_each(|v| regions(v, out)),
        _ => {}
    }
}

#[test]
fn sarif_logs_fit_the_schema() {
    let validator = jsonschema::validator_for(&sarif_schema()).unwrap();
    let programs: Vec<String> = files("tests/ui", "hyped")
        .iter()
        .chain(&files("examples/paper", "hyped"))
        .map(|p| p.display().to_string())
        .collect();
    let mut arguments = vec!["check", "--format", "sarif", "no/such file.hyped"];
    arguments.extend(programs.iter().map(String::as_str));
    let log = json(&arguments);
    let wrong: Vec<String> =
        validator.iter_errors(&log).map(|e| format!("{}: {e}", e.instance_path())).take(5).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    let run = &log["runs"][0];
    let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
    assert_eq!(rules.len(), Code::ALL.len());
    assert!(rules.iter().all(|rule| rule["help"]["text"].as_str().unwrap().len() > 200));
    let results = run["results"].as_array().unwrap();
    assert!(results.len() > 100, "{}", results.len());
    for result in results {
        let rule = &rules[result["ruleIndex"].as_u64().unwrap() as usize];
        assert_eq!(rule["id"], result["ruleId"]);
        assert_eq!(rule["defaultConfiguration"]["level"], result["level"]);
    }
    let unreadable = results.iter().find(|r| r["ruleId"] == "E0001").unwrap();
    assert_eq!(unreadable["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], "no/such%20file.hyped");
    // Lines and columns of a region agree with its bytes.
    let mut all = Vec::new();
    regions(run, &mut all);
    assert!(all.len() > results.len());
    for (location, region) in all {
        let text = std::fs::read_to_string(location["uri"].as_str().unwrap()).unwrap();
        let number = |name: &str| region[name].as_u64().unwrap() as usize;
        let place = |byte: usize| {
            let before = &text[..byte];
            let line = before.matches('\n').count() + 1;
            let start = before.rfind('\n').map_or(0, |at| at + 1);
            (line, text[start..byte].encode_utf16().count() + 1)
        };
        let (from, to) = (number("byteOffset"), number("byteOffset") + number("byteLength"));
        assert_eq!(place(from), (number("startLine"), number("startColumn")), "{location} {region}");
        assert_eq!(place(to), (number("endLine"), number("endColumn")), "{location} {region}");
    }
}

#[test]
fn json_has_every_part_of_a_finding() {
    let path =
        written("parts.hyped", "entity A {\n    param speed = 60\n    x' = sped\n    y'' = speed\n    y' = speed\n}\n");
    let text = String::from_utf8(hypedc(&["check", "--format", "json", &path]).stdout).unwrap();
    insta::assert_snapshot!(text.replace(&path, "parts.hyped").replace(env!("CARGO_PKG_VERSION"), "VERSION"));
}

#[test]
fn nothing_else_goes_to_standard_output() {
    for format in ["json", "sarif"] {
        for (file, code) in [("examples/flappy.hyped", 0), ("tests/ui/step.hyped", 1), ("no/such.hyped", 2)] {
            let output = hypedc(&["check", "--format", format, file]);
            assert_eq!(output.status.code(), Some(code), "{format} {file}");
            assert!(serde_json::from_slice::<Value>(&output.stdout).unwrap().is_object());
            assert_eq!(output.stderr, b"", "{format} {file}");
        }
    }
}

#[test]
fn a_finding_of_a_shared_file_comes_once() {
    let shared = written("shared.hyped", "entity Shared { x' = sped }\n");
    let import = format!("import \"{}\"\n", Path::new(&shared).file_name().unwrap().to_str().unwrap());
    let (one, other) = (written("shares_one.hyped", &import), written("shares_other.hyped", &import));
    let object = json(&["check", "--format", "json", &one, &other]);
    assert_eq!(object["findings"].as_array().unwrap().len(), 1, "{object}");
    assert_eq!(object["programs"][1]["errors"], 1);
    let log = json(&["check", "--format", "sarif", &one, &other]);
    assert_eq!(log["runs"][0]["results"].as_array().unwrap().len(), 1);
}

#[test]
fn warnings_can_be_denied() {
    let code = |arguments: &[&str]| hypedc(arguments).status.code().unwrap();
    let warns = "tests/ui/idle_edge.hyped";
    assert_eq!(code(&["check", warns]), 0);
    assert_eq!(code(&["check", "--deny", "warnings", "examples/flappy.hyped"]), 0);
    for format in ["human", "short", "json", "sarif"] {
        let output = hypedc(&["check", "--deny", "warnings", "--format", format, warns]);
        assert_eq!(output.status.code(), Some(1), "{format}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("warning") && text.contains("W0401"), "{text}");
    }
}

#[test]
fn colours_are_for_terminals_alone() {
    let output = hypedc(&["check", "tests/ui/step.hyped"]);
    assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b));
}

fn written(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("formats_{name}"));
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

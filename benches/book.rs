//! The measured tables of `docs/benchmarks.md`: `cargo bench --bench book` measures them, which takes about half an hour,
//! keeps the results in `benches/results`, with the machine, the date and the version, and writes the tables into the page.
//!
//! `cargo bench --bench book -- paper levels` measures only the tables that are named, and `-- --write` none: then the page is
//! written from the files of results as they are. Runs are one at a time; seconds are CPU time, those of levels seconds on
//! the clock. Without `--bench` nothing is measured.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "it says what it does, and measures time")]

#[path = "results/tables.rs"]
mod tables;

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde_json::{Value, json};
use tables::{PAGE, Results, TABLES, path_of, with_table};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|a| a == "--bench") {
        return;
    }
    let named: Vec<&String> = arguments.iter().filter(|a| !a.starts_with("--")).collect();
    let writes = arguments.iter().any(|a| a == "--write");
    for (name, table) in TABLES.iter().filter(|(name, _)| named.is_empty() || named.iter().any(|n| n == name)) {
        println!("{name} …");
        let path = path_of(name);
        let mut results = match writes {
            true if !Path::new(&path).exists() => continue,
            true => Results::of_file(&std::fs::read_to_string(&path).unwrap()),
            false => Results::measured(about(), hypedc),
        };
        let table = table(&mut results);
        std::fs::write(&path, results.text()).unwrap();
        let page = std::fs::read_to_string(PAGE).unwrap();
        std::fs::write(PAGE, with_table(&page, name, &table, &results)).unwrap();
    }
}

/// What a command prints as JSON, with the seconds that all of it took. Its exit code is that of its answers.
fn hypedc(arguments: &str) -> Value {
    let start = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments.split_whitespace()).output().unwrap();
    let seconds = start.elapsed().as_secs_f64();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut answer: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{arguments}: {error}"));
    for goal in answer["goals"].as_array_mut().into_iter().flatten() {
        goal["whole_seconds"] = json!(seconds);
    }
    answer
}

/// The machine, the date and the version.
fn about() -> Value {
    let said = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().ok()?;
        let text = String::from_utf8_lossy(&output.stdout).trim().to_string();
        (!text.is_empty()).then_some(text)
    };
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let processor =
        info.lines().find_map(|line| Some(line.strip_prefix("model name")?.split_once(':')?.1.trim().to_string()));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    json!({
        "machine": format!("{}, {cores} cores, {system}", processor.unwrap_or("an unknown processor".into())),
        "date": said("date", &["-u", "+%Y-%m-%d"]),
        "hypedc": env!("CARGO_PKG_VERSION"),
        "commit": said("git", &["describe", "--always", "--dirty"]),
    })
}

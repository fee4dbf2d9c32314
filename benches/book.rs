//! The measured tables of `docs/benchmarks.md`: `cargo bench --bench book` measures them and writes them into the page, each
//! between its comments `<!-- measured: NAME -->` and `<!-- end -->`. It takes about half an hour.
//!
//! `cargo bench --bench book -- paper levels` measures only the tables that are named. Runs are one at a time; seconds are
//! CPU time, those of levels seconds on the clock. Without `--bench` nothing is measured.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "it says what it does, and measures time")]

use std::process::Command;
use std::time::Instant;

use serde_json::Value;

const PAGE: &str = "docs/benchmarks.md";

/// Measures a table.
type Measurement = fn() -> String;

/// The tables by name.
const TABLES: [(&str, Measurement); 4] =
    [("paper", paper), ("worlds", worlds), ("levels", levels), ("samples", samples)];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|a| a == "--bench") {
        return;
    }
    let named: Vec<&String> = arguments.iter().filter(|a| !a.starts_with("--")).collect();
    for (name, measure) in TABLES {
        if named.is_empty() || named.iter().any(|n| *n == name) {
            println!("{name} …");
            let page = std::fs::read_to_string(PAGE).unwrap();
            std::fs::write(PAGE, with_table(&page, name, &measure())).unwrap();
        }
    }
}

/// The page with another table between the comments of a name.
fn with_table(page: &str, name: &str, table: &str) -> String {
    let (before, rest) = page.split_once(&format!("<!-- measured: {name} -->\n")).unwrap();
    let (_, after) = rest.split_once("<!-- end -->").unwrap();
    format!("{before}<!-- measured: {name} -->\n\n{table}\n<!-- end -->{after}")
}

/// What a command prints as JSON. Its exit code is that of its answers.
fn hypedc(arguments: &str) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments.split_whitespace()).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{arguments}: {error}"))
}

/// The rows or the runs of an experiment, of planners that restart as they do by default.
fn experiment(arguments: &str, part: &str) -> Vec<Value> {
    let result = hypedc(&format!("experiment {arguments} --threads 1 --format json"));
    result[part].as_array().unwrap().iter().filter(|row| row["restarts"] != "never").cloned().collect()
}

fn find<'r>(rows: &'r [Value], fields: &[(&str, &str)]) -> &'r Value {
    rows.iter().find(|row| fields.iter().all(|(key, value)| row[key] == *value)).unwrap_or_else(|| panic!("{fields:?}"))
}

fn median(mut numbers: Vec<f64>) -> f64 {
    assert!(!numbers.is_empty());
    numbers.sort_by(f64::total_cmp);
    (numbers[(numbers.len() - 1) / 2] + numbers[numbers.len() / 2]) / 2.0
}

/// A whole number with commas between thousands.
fn whole(number: f64) -> String {
    let digits = format!("{number:.0}");
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).unwrap()).collect();
    groups.join(",")
}

/// The median of a field of a row, such as `goal_nodes`.
fn of(row: &Value, field: &str) -> f64 {
    row[field]["median"].as_f64().unwrap()
}

fn paper() -> String {
    let planners = ["auto", "distance-guided", "coverage", "rrt", "rc-rrt", "rg-rrt", "eg-rrt"];
    let rows = experiment(&format!("paper --bounds reduced --seconds 20 --planners {}", planners.join(",")), "rows");
    let mut out = String::from("| | Test 1: nodes | ms | Test 2, as drawn: nodes | ms |\n|---|---|---|---|---|\n");
    for planner in planners {
        let [one, two] = [("test1", "arrive"), ("test2", "drawn")]
            .map(|(test, goal)| find(&rows, &[("planner", planner), ("test", test), ("goal", goal)]));
        assert!([one, two].iter().all(|row| row["runs"] == row["successes"]), "{planner} does not always reach it");
        let cells = |row: &Value| format!("{} | {:.1}", whole(of(row, "goal_nodes")), 1e3 * of(row, "goal_seconds"));
        out.push_str(&format!("| `{planner}` | {} | {} |\n", cells(one), cells(two)));
    }
    out
}

fn worlds() -> String {
    let planners = ["auto", "distance-guided", "coverage"];
    let mut out = String::from(
        "| world, goal | `auto` | | | `distance-guided` | | | `coverage` | | |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut files: Vec<_> = std::fs::read_dir("benches/worlds").unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in files {
        let options = "--bounds reduced --seeds 3 --nodes 100000 --seconds 4";
        let question = format!("{} {options} --planners {}", file.display(), planners.join(","));
        let runs = experiment(&question, "runs");
        let is_first = |run: &&Value| run["planner"] == planners[0] && run["seed"] == 1;
        for goal in runs.iter().filter(is_first).map(|run| run["goal"].as_str().unwrap()) {
            let world = file.file_stem().unwrap().to_str().unwrap();
            out.push_str(&format!("| `{world}`, {goal} |"));
            for planner in planners {
                let mine = || runs.iter().filter(|run| run["planner"] == planner && run["goal"] == goal);
                let reached = mine().filter(|run| run["verdict"] == "reached").count();
                let middle = |field: &str| median(mine().map(|run| run[field].as_f64().unwrap()).collect());
                out.push_str(&format!(" {reached} | {} | {:.2} |", whole(middle("nodes")), middle("seconds")));
            }
            out.push('\n');
        }
    }
    out
}

/// Levels of the corpus: a name, the program, and the level if the program leaves its map open.
const LEVELS: [(&str, &str, &str); 7] = [
    ("`smb`, 1-1", "smb/smb.hyped --goal end", "smb/mario-1-1.txt"),
    ("`smb`, 1-2", "smb/smb.hyped --goal end", "smb/mario-1-2.txt"),
    ("`smb`, 1-3", "smb/smb.hyped --goal end", "smb/mario-1-3.txt"),
    ("`smb`, 5-3", "smb/smb.hyped --goal end", "smb/mario-5-3.txt"),
    ("`smb`, 8-1", "smb/smb.hyped --goal end", "smb/mario-8-1.txt"),
    ("`tloz1_1`, last", "zelda/tloz1_1.hyped --goal last", ""),
    ("`kid_icarus`, end", "kid-icarus/kid_icarus.hyped --goal end", ""),
];

fn levels() -> String {
    let mut out = String::from(
        "| level, goal | reached | median nodes | median s | longest s | s of play | with `--minimize` | s |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (name, program, level) in LEVELS {
        let map = if level.is_empty() { String::new() } else { format!("--map examples/{level}") };
        let ask = |seed: u64, options: &str| {
            let result = hypedc(&format!("reach examples/{program} {map} --seed {seed} {options} --format json"));
            result["goals"][0].clone()
        };
        let column = |answers: &[Value], field: &str| -> Vec<f64> {
            answers.iter().filter_map(|answer| answer[field].as_f64()).collect()
        };
        let plain: Vec<Value> = (1..=10).map(|seed| ask(seed, "")).collect();
        let (mut minimal, mut whole_seconds) = (Vec::new(), Vec::new());
        for seed in 1..=5 {
            // The seconds of an answer are those of the search alone.
            let start = Instant::now();
            minimal.push(ask(seed, "--minimize"));
            whole_seconds.push(start.elapsed().as_secs_f64());
        }
        let reached = plain.iter().filter(|answer| answer["verdict"] == "reached").count();
        let seconds = column(&plain, "seconds");
        let longest = seconds.iter().fold(0.0, |a: f64, b| a.max(*b));
        out.push_str(&format!(
            "| {name} | {reached} of 10 | {} | {:.2} | {longest:.2} | {:.0} | {:.0} | {:.0} |\n",
            whole(median(column(&plain, "nodes"))),
            median(seconds),
            median(column(&plain, "seconds_of_play")),
            median(column(&minimal, "seconds_of_play")),
            median(whole_seconds),
        ));
    }
    out
}

fn samples() -> String {
    let questions = [
        ("Test 1", "paper --tests 1", "arrive"),
        ("Test 2, goal as drawn", "paper --tests 2", "drawn"),
        ("`car`, a lap", "examples/car.hyped", "lap"),
        ("`frog`, crossed", "examples/frog.hyped", "crossed"),
        ("`homing`, open", "examples/homing.hyped", "open"),
        ("`platforms`, flag", "examples/platforms.hyped", "flag"),
        ("`switch_door`, inside", "examples/switch_door.hyped", "inside"),
    ];
    let mut out = String::from("| | naive | | reduced | |\n|---|---|---|---|---|\n");
    for (name, question, goal) in questions {
        // Other goals, and the planner as it was published, can take all of the time.
        let only = if question.starts_with("paper") { String::new() } else { format!("--goal {goal}") };
        let rows = experiment(&format!("{question} {only} --planners rrt --seeds 20 --seconds 5"), "rows");
        let cells = ["naive", "reduced"].map(|bounds| {
            let row = find(&rows, &[("bounds", bounds), ("goal", goal)]);
            format!("{} | {:.3} s", whole(of(row, "goal_nodes")), of(row, "goal_seconds"))
        });
        out.push_str(&format!("| {name} | {} |\n", cells.join(" | ")));
    }
    out
}

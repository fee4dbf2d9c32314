//! `hypedc experiment`: tables, CSV and JSON of a tiny experiment, the same whatever the threads and the folder.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// The limit of nodes ends runs, long before their seconds: results do not depend on the machine.
const TINY: [&str; 7] = ["paper", "--seeds", "2", "--seconds", "600", "--nodes", "300"];

const HEADER: &str = "test,goal,planner,restarts,bounds,metric,hold,seed,verdict,nodes,trees,extensions,steps,seconds,\
                      path_steps,program_sha256,version,set";

fn experiment_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).arg("experiment").args(arguments).current_dir(folder).output().unwrap()
}

fn experiment(arguments: &[&str]) -> Output {
    experiment_in(Path::new(env!("CARGO_MANIFEST_DIR")), arguments)
}

/// Standard output of an experiment that must succeed.
fn text(arguments: &[&str]) -> String {
    let output = experiment(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), errors.as_ref()), (Some(0), ""), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&text(&[arguments, &["--format", "json"]].concat())).unwrap()
}

fn tiny(more: &[&str]) -> String {
    text(&[&TINY, more].concat())
}

fn temporary(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The cells of a CSV whose cells hold no commas, header first, seconds left out.
fn cells(csv: &str) -> Vec<Vec<&str>> {
    csv.lines()
        .map(|line| line.split(',').enumerate().filter(|(column, _)| *column != 13).map(|(_, cell)| cell).collect())
        .collect()
}

#[test]
fn the_papers_tables_have_a_row_for_each_planner_beside_the_papers_figures() {
    let text = tiny(&[]);
    for title in ["Test 1 of the paper (its Table 1), goal arrive", "Test 2 of the paper (its Table 2), goal drawn"] {
        assert_eq!(text.lines().filter(|l| *l == title).count(), 1, "{title}\n{text}");
    }
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|l| l.starts_with("naive ") || l.starts_with("reduced "))
        .map(|l| l.split_whitespace().collect())
        .collect();
    // Two tests, two kinds of bounds, four planners, each without and with restarts.
    assert_eq!(rows.len(), 32, "{text}");
    for (index, row) in rows.iter().enumerate() {
        let bounds = if index / 8 % 2 == 0 { "naive" } else { "reduced" };
        let planner = ["rrt", "rc-rrt", "rg-rrt", "eg-rrt"][index / 2 % 4];
        let restarts = if index % 2 == 0 { "never" } else { "2000" };
        assert_eq!(row[..3], [bounds, planner, restarts], "{text}");
        // The paper has nothing for planners with restarts.
        assert_eq!(row.len(), if index % 2 == 0 { 14 } else { 10 }, "{row:?}");
        let (reached, of) = row[8].split_once('/').unwrap();
        assert!(reached.parse::<u32>().unwrap() <= 2 && of == "2", "{row:?}");
    }
    assert_eq!(rows[0][10..], ["1087", "334", "4.87", "27/50"], "{text}");
    assert_eq!(rows[30][10..], ["107", "38", "6.33", "43/50"], "{text}");
    for fact in ["seeds 1 to 2", "at most 600 s of CPU time a run, or 300 nodes", "20 s a run", "wall-clock", "SHA-256"]
    {
        assert!(text.contains(fact), "{fact}\n{text}");
    }
}

#[test]
fn runs_are_the_same_for_one_and_two_threads_in_the_same_order() {
    let one = tiny(&["--format", "csv", "--threads", "1"]);
    let two = tiny(&["--format", "csv", "--threads", "2"]);
    assert_eq!(cells(&one), cells(&two));
    let mut lines = one.lines();
    assert_eq!(lines.next(), Some(HEADER));
    assert_eq!(lines.clone().count(), 2 * 2 * 4 * 2 * 2);
    for (index, line) in lines.enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 18, "{line}");
        assert_eq!(cells[7], ["1", "2"][index % 2], "{line}");
        assert!(cells[9].parse::<u64>().unwrap() <= 300, "{line}");
        assert!(cells[13].parse::<f64>().unwrap() < 600.0, "{line}");
        // A path is reported if there is one.
        assert_eq!(cells[8] == "reached", cells[14].parse::<u64>().is_ok(), "{line}");
        assert_eq!(cells[15].len(), 64, "{line}");
        assert_eq!(cells[16], env!("CARGO_PKG_VERSION"), "{line}");
    }
}

#[test]
fn rows_are_what_runs_come_to() {
    // A jump on the spot reaches this goal, so that some runs succeed.
    let more = ["--tests", "2", "--goal", "configured", "--planners", "rrt", "--bounds", "reduced", "--metric", "both"];
    let found = json(&[&TINY[..], &more].concat());
    assert_eq!((&found["version"], &found["settings"]["seeds"]), (&Value::from(1), &Value::from(2)));
    assert_eq!(found["settings"]["nodes"], 300);
    let (rows, runs) = (found["rows"].as_array().unwrap(), found["runs"].as_array().unwrap());
    assert_eq!((rows.len(), runs.len()), (4, 8));
    let mut successes = 0;
    for row in rows {
        let same = |run: &&Value| run["metric"] == row["metric"] && run["restarts"] == row["restarts"];
        let mine: Vec<&Value> = runs.iter().filter(same).collect();
        let mean = |runs: &[&Value], name: &str| {
            let sum: f64 = runs.iter().map(|r| r[name].as_f64().unwrap()).sum();
            sum / runs.len() as f64
        };
        assert_eq!(mine.len(), 2);
        let reached: Vec<&Value> = mine.iter().copied().filter(|r| r["verdict"] == "reached").collect();
        assert_eq!(row["successes"], reached.len(), "{row}");
        assert_eq!(row["nodes"]["mean"].as_f64(), Some(mean(&mine, "nodes")), "{row}");
        if !reached.is_empty() {
            assert_eq!(row["goal_nodes"]["mean"].as_f64(), Some(mean(&reached, "nodes")), "{row}");
        }
        assert_eq!(row["paper"].is_null(), row["restarts"] != "never", "{row}");
        successes += reached.len();
    }
    assert!(successes > 0, "{rows:?}");
}

#[test]
fn the_paper_needs_no_files_and_its_programs_are_those_of_the_examples() {
    let folder = temporary("experiment_elsewhere");
    std::fs::create_dir_all(&folder).unwrap();
    let narrow =
        ["--planners", "rrt", "--bounds", "reduced", "--format", "csv", "--csv", "runs.csv", "--json", "all.json"];
    let output = experiment_in(&folder, &[&TINY[..], &narrow].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(read("runs.csv"), String::from_utf8(output.stdout).unwrap());
    let found: Value = serde_json::from_str(&read("all.json")).unwrap();
    assert_eq!(found["runs"].as_array().unwrap().len(), 8);
    let files = ["examples/paper/test1.hyped", "examples/paper/test2.hyped"];
    let options = ["--seeds", "1", "--nodes", "2", "--planners", "rrt", "--goal", "arrive", "--goal", "drawn"];
    let own = json(&[&files[..], &options].concat());
    for (index, file) in files.iter().enumerate() {
        let (known, own) = (&found["questions"][index], &own["questions"][index]);
        assert_eq!(known["program_sha256"], own["program_sha256"], "{file}");
        assert_eq!(known["goal"], own["goal"], "{file}");
    }
}

#[test]
fn any_programs_goals_can_be_compared_by_all_planners() {
    let files = ["examples/switch_door.hyped", "examples/balloon.hyped"];
    let text =
        text(&[&files[..], &["--seeds", "1", "--seconds", "600", "--nodes", "40", "--planners", "all"]].concat());
    let goals = text.lines().filter(|l| l.contains(", goal ")).count();
    assert!(goals >= 2 && text.contains("examples/balloon.hyped:Valley, goal over"), "{text}");
    let rows = text.lines().filter(|l| l.starts_with("naive ") || l.starts_with("reduced ")).count();
    // All fifteen planners, eleven of which with and without restarts, with both bounds.
    assert_eq!(rows % (2 * 26), 0, "{text}");
    assert!(rows > 0 && !text.contains("the paper") && !text.contains("Test 2"), "{text}");
}

#[test]
fn what_the_analysis_rules_out_is_not_searched() {
    let path = temporary("experiment_ruled_out.hyped");
    let program = "entity Stone { }\n\
                   world W {\n space main { place stone: Stone at (0, 0) }\n goal away: stone.x > 10\n}\n";
    std::fs::write(&path, program).unwrap();
    let path = path.to_str().unwrap();
    let found = json(&[path]);
    assert_eq!(found["questions"][0]["is_ruled_out"], true);
    assert_eq!((found["runs"].as_array().unwrap().len(), found["rows"].as_array().unwrap().len()), (0, 0));
    assert!(text(&[path]).contains("proven unreachable"));
}

#[test]
fn a_run_ends_with_its_budget_of_seconds() {
    let found = json(&["paper", "--tests", "1", "--seeds", "1", "--seconds", "0", "--planners", "rrt"]);
    for run in found["runs"].as_array().unwrap() {
        assert_eq!(run["verdict"], "not-found");
        // The clock is read between few samples.
        assert!(run["nodes"].as_u64().unwrap() <= 64, "{run}");
    }
    assert_eq!(found["settings"]["nodes"], Value::Null);
}

#[test]
#[cfg(unix)]
fn ctrl_c_stops_and_reports_what_there_is() {
    let csv = temporary("experiment_stopped.csv");
    let _ = std::fs::remove_file(&csv);
    let options = ["paper", "--tests", "2", "--goal", "configured", "--planners", "rrt", "--bounds", "reduced"];
    // Each run takes next to nothing, all of them take for ever.
    let many = ["--seeds", "10000000", "--csv", csv.to_str().unwrap()];
    let child = Command::new(env!("CARGO_BIN_EXE_hypedc"))
        .arg("experiment")
        .args([&options[..], &many].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while std::fs::read_to_string(&csv).map_or(0, |text| text.lines().count()) < 3 {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let (text, errors) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.starts_with("stopped after ") && errors.ends_with(" of 20000000 runs\n"), "{errors}");
    let runs = std::fs::read_to_string(&csv).unwrap().lines().count() - 1;
    assert!(errors.contains(&format!(" {runs} of ")) && text.contains(&format!("/{runs}*")), "{errors}{text}");
    assert!(text.contains("* stopped before all of the 10000000 runs were done"), "{text}");
}

#[test]
fn bad_questions_are_told_and_not_asked() {
    let example = "examples/balloon.hyped";
    let nowhere = "no/such/folder/runs.csv";
    for (arguments, expected) in [
        (&["paper", "--planners", "rrt,teleport"][..], "teleport"),
        (&["paper", "--tests", "3"], "3 is not in 1..=2"),
        (&["paper", "--seeds", "0"], "--seeds"),
        (&["paper", "--seconds", "soon"], "--seconds"),
        (&["paper", "--hold", "9..3frames"], "the shorter one"),
        (&["paper", "--hold", "0.1s"], "a number of steps"),
        (&["paper", "--goal", "moon"], "drawn"),
        (&["paper", "--csv", nowhere], nowhere),
        (&["paper", "--json", nowhere], nowhere),
        (&[], "<FILE>"),
        (&["no_such.hyped"], "no_such.hyped"),
        (&[example, "--goal", "ovre"], "did you mean `over`"),
        (&["examples/paper/robot.hyped"], "no goal"),
    ] {
        let output = experiment(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}\n{errors}");
        assert!(output.stdout.is_empty() && errors.contains(expected), "{arguments:?}\n{errors}");
    }
}

#[test]
fn a_sweep_has_a_column_for_its_values() {
    let sweep = ["examples/balloon.hyped", "--seeds", "1", "--nodes", "200", "--seconds", "600", "--planners", "rrt"];
    let sweep = [&sweep[..], &["--bounds", "reduced", "--set", "Balloon.drift=50..80/30"]].concat();
    let shown = text(&sweep);
    let rows: Vec<Vec<&str>> =
        shown.lines().filter(|line| line.contains("rrt ")).map(|line| line.split_whitespace().collect()).collect();
    let values: Vec<&str> = rows.iter().filter(|row| row[1] == "reduced").map(|row| row[0]).collect();
    assert_eq!(values, ["50", "50", "80", "80"], "{shown}");
    assert_eq!(shown.matches(", goal over\n").count(), 1, "{shown}");
    let csv = text(&[&sweep[..], &["--format", "csv"]].concat());
    let ends: Vec<&str> = csv.lines().skip(1).map(|line| line.rsplit(',').next().unwrap()).collect();
    assert_eq!(ends, ["Balloon.drift=50", "Balloon.drift=50", "Balloon.drift=80", "Balloon.drift=80"], "{csv}");
    let found = json(&sweep);
    for (part, count) in [("questions", 2), ("runs", 4), ("rows", 4)] {
        let all = found[part].as_array().unwrap();
        assert_eq!(all.len(), count);
        assert!(all.iter().any(|row| row["set"][0] == "Balloon.drift=80"), "{part}");
    }
}

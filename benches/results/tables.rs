//! The tables of measurements in `docs/benchmarks.md`, made from the files of results beside this one. A file of results
//! holds what commands answered, with the machine, the date and the version; `cargo bench --bench book` measures them.

use std::collections::BTreeMap;

use serde_json::{Value, json};

/// The page with the tables, each between its comments `<!-- measured: NAME -->` and `<!-- end -->`.
pub const PAGE: &str = "docs/benchmarks.md";

/// Makes a table from results.
type Table = fn(&mut Results) -> String;

/// The tables by name.
pub const TABLES: [(&str, Table); 4] = [("paper", paper), ("worlds", worlds), ("levels", levels), ("samples", samples)];

/// The path of the results of a table.
pub fn path_of(table: &str) -> String {
    format!("benches/results/{table}.json")
}

/// Answers by the commands that gave them.
pub struct Results {
    /// Carries out a command that has no answer yet.
    ask: Option<fn(&str) -> Value>,
    /// The machine, the date, the version.
    pub about: Value,
    answers: BTreeMap<String, Value>,
}

impl Results {
    /// Results that are measured as they are asked for.
    pub fn measured(about: Value, ask: fn(&str) -> Value) -> Results {
        Results { ask: Some(ask), about, answers: BTreeMap::new() }
    }

    /// The results of a file.
    pub fn of_file(text: &str) -> Results {
        let file: Value = serde_json::from_str(text).unwrap();
        let answers = file["answers"].as_object().unwrap().iter().map(|(key, value)| (key.clone(), value.clone()));
        Results { ask: None, about: file["about"].clone(), answers: answers.collect() }
    }

    /// The text of the file.
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(&json!({ "about": self.about, "answers": self.answers })).unwrap() + "\n"
    }

    /// What a command answers; of its parts only some fields are kept.
    fn answer(&mut self, command: &str, part: &str, fields: &[&str]) -> Vec<Value> {
        if !self.answers.contains_key(command) {
            let ask = self.ask.unwrap_or_else(|| panic!("no result of `{command}`"));
            let all = ask(command);
            let kept = all[part].as_array().unwrap().iter().map(|row| {
                let fields = fields.iter().chain(&["whole_seconds"]);
                let fields = fields.filter(|field| !row[**field].is_null());
                fields.map(|field| ((*field).to_string(), row[*field].clone())).collect::<serde_json::Map<_, _>>()
            });
            self.answers.insert(command.to_string(), kept.collect());
        }
        self.answers[command].as_array().unwrap().clone()
    }

    /// The rows or the runs of an experiment, of planners that restart as they do by default.
    fn experiment(&mut self, arguments: &str, part: &str) -> Vec<Value> {
        let fields = match part {
            "rows" => {
                &["planner", "bounds", "test", "goal", "restarts", "runs", "successes", "goal_nodes", "goal_seconds"][..]
            }
            _ => &["planner", "goal", "seed", "restarts", "verdict", "nodes", "seconds"],
        };
        let rows = self.answer(&format!("experiment {arguments} --threads 1 --format json"), part, fields);
        rows.into_iter().filter(|row| row["restarts"] != "never").collect()
    }

    /// What was measured where and when, in a sentence.
    fn sentence(&self) -> String {
        let of = |field: &str| self.about[field].as_str().unwrap_or("unknown").to_string();
        format!("Measured on {} with hypedc {} ({}) on {}.", of("date"), of("hypedc"), of("commit"), of("machine"))
    }
}

/// The page with another table between the comments of a name.
pub fn with_table(page: &str, name: &str, table: &str, results: &Results) -> String {
    let (before, rest) = page.split_once(&format!("<!-- measured: {name} -->\n")).unwrap();
    let (_, after) = rest.split_once("<!-- end -->").unwrap();
    format!("{before}<!-- measured: {name} -->\n\n{table}\n{}\n\n<!-- end -->{after}", results.sentence())
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

fn paper(results: &mut Results) -> String {
    let planners = ["auto", "distance-guided", "coverage", "rrt", "rc-rrt", "rg-rrt", "eg-rrt"];
    let rows =
        results.experiment(&format!("paper --bounds reduced --seconds 20 --planners {}", planners.join(",")), "rows");
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

fn worlds(results: &mut Results) -> String {
    let planners = ["auto", "distance-guided", "coverage"];
    let mut out = String::from(
        "| world, goal | `auto` | | | `distance-guided` | | | `coverage` | | |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut files: Vec<_> = std::fs::read_dir("benches/worlds").unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in files {
        let options = "--bounds reduced --seeds 3 --nodes 100000 --seconds 4";
        let question = format!("{} {options} --planners {}", file.display(), planners.join(","));
        let runs = results.experiment(&question, "runs");
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
const LEVELS: [(&str, &str, &str); 9] = [
    ("`smb`, 1-1", "smb/smb.hyped --goal end", "smb/mario-1-1.txt"),
    ("`smb`, 1-2", "smb/smb.hyped --goal end", "smb/mario-1-2.txt"),
    ("`smb`, 1-3", "smb/smb.hyped --goal end", "smb/mario-1-3.txt"),
    ("`smb`, 5-3", "smb/smb.hyped --goal end", "smb/mario-5-3.txt"),
    ("`smb`, 8-1", "smb/smb.hyped --goal end", "smb/mario-8-1.txt"),
    ("`tloz1_1`, last", "zelda/tloz1_1.hyped --goal last", ""),
    ("`kid_icarus`, end", "kid-icarus/kid_icarus.hyped --goal end", "kid-icarus/kidicarus_1.txt"),
    ("`mega_man`, 1-1, end", "mega-man/mega_man.hyped --goal end", "mega-man/megaman_1_1.txt"),
    ("`mega_man`, 1-4, end", "mega-man/mega_man.hyped --goal end", "mega-man/megaman_1_4.txt"),
];

fn levels(results: &mut Results) -> String {
    let mut out = String::from(
        "| level, goal | reached | median nodes | median s | longest s | s of play | with `--minimize` | s |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (name, program, level) in LEVELS {
        let map = if level.is_empty() { String::new() } else { format!("--map examples/{level}") };
        let mut ask = |seed: u64, options: &str| {
            let command = format!("reach examples/{program} {map} --seed {seed} {options} --format json");
            let fields = ["verdict", "nodes", "seconds", "seconds_of_play"];
            results.answer(&command, "goals", &fields).remove(0)
        };
        let column = |answers: &[Value], field: &str| -> Vec<f64> {
            answers.iter().filter_map(|answer| answer[field].as_f64()).collect()
        };
        let plain: Vec<Value> = (1..=10).map(|seed| ask(seed, "")).collect();
        // The seconds of an answer are those of the search alone.
        let minimal: Vec<Value> = (1..=5).map(|seed| ask(seed, "--minimize")).collect();
        let whole_seconds = column(&minimal, "whole_seconds");
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

fn samples(results: &mut Results) -> String {
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
        let rows = results.experiment(&format!("{question} {only} --planners rrt --seeds 20 --seconds 5"), "rows");
        let cells = ["naive", "reduced"].map(|bounds| {
            let row = find(&rows, &[("bounds", bounds), ("goal", goal)]);
            format!("{} | {:.3} s", whole(of(row, "goal_nodes")), of(row, "goal_seconds"))
        });
        out.push_str(&format!("| {name} | {} |\n", cells.join(" | ")));
    }
    out
}

//! `hypedc reach` on many levels: rows that do not depend on threads, runs that are killed and resumed, levels that do
//! not compile, JUnit, comparison with a baseline.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;

/// A walker that can step and jump; its level is given later.
const GAME: &str = "entity Walker {
    button right, jump
    collider body: rect(0, 0, 12, 15)
    y'' = -900
    group legs {
        mode air {
            when y' <= 0 and touching(body, rock, below) -> ground
        }
        mode ground {
            when not touching(body, rock, below) -> air
            when pressed(jump) -> air { y' := 320 }
        }
    }
    group run {
        mode stand { x' = 0; when held(right) -> walk }
        mode walk { x' = 90; when not held(right) -> stand }
    }
}
world Open {
    step 1/60
    collide body with rock: block
    collide body with flag: sense
    tiles own 16 x 16 {
        '.': empty
        '#': rock
        'F': flag
        'P': spawn Walker as hero
    }
    space main { map level own }
    player 1: hero
    goal out: hero touching flag
    goal up: hero.y > 40
    never fell: hero.y < -32
}
";

/// An open level, one with a step, one with a wall that is too high, one with a pit.
pub const LEVELS: [(&str, &str); 4] = [
    ("a", "..........\n..........\nP........F\n##########\n"),
    ("b", "..........\n..........\nP....#...F\n##########\n"),
    ("c", ".....#....\n.....#....\n.....#....\n.....#....\n.....#....\nP....#...F\n##########\n"),
    ("d", "..........\n..........\nP........F\n####..####\n"),
];

/// A separate folder with the game and its levels.
pub struct TestFolder(pub PathBuf);

impl TestFolder {
    pub fn new(name: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("corpus").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("levels")).unwrap();
        let place = TestFolder(folder);
        place.write("game.hyped", GAME);
        LEVELS.iter().for_each(|(name, text)| place.write(&format!("levels/{name}.txt"), text));
        place
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }

    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
        command.args(["reach", "game.hyped"]).args(arguments.split_whitespace()).current_dir(&self.0);
        command
    }

    pub fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Exit code, standard output, standard error.
    pub fn answer(&self, arguments: &str) -> (i32, String, String) {
        let output = self.run(arguments);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    }

    /// The rows of a file without what depends on the machine.
    pub fn rows(&self, name: &str) -> Vec<Value> {
        untimed(&self.read(name))
    }
}

pub fn untimed(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| {
            let mut row: Value = serde_json::from_str(line).unwrap();
            let timing = row.as_object_mut().unwrap().remove("timing").unwrap();
            assert_eq!(timing.as_object().unwrap().len(), 3, "{timing}");
            row
        })
        .collect()
}

/// The verdicts of rows.
fn verdicts(rows: &[Value]) -> Vec<(String, String, String)> {
    let text = |row: &Value, name: &str| row[name].as_str().unwrap_or_default().to_string();
    rows.iter().map(|row| (text(row, "level"), text(row, "goal"), text(row, "verdict"))).collect()
}

#[test]
fn rows_are_the_same_on_any_number_of_threads() {
    let place = TestFolder::new("threads");
    let mut all = Vec::new();
    for threads in [1, 4] {
        let of = format!("--map levels --nodes 3000 --results {threads}.jsonl --csv {threads}.csv --threads {threads}");
        let (code, shown, error) = place.answer(&of);
        assert_eq!((code, error.as_str()), (1, ""), "{shown}");
        all.push(place.rows(&format!("{threads}.jsonl")));
    }
    assert_eq!(all[0], all[1]);
    let expected = [
        ("a", "out", "reached"),
        ("a", "up", "reached"),
        ("b", "out", "reached"),
        ("b", "up", "reached"),
        ("c", "out", "not-found"),
        ("c", "up", "reached"),
        ("d", "out", "reached"),
        ("d", "up", "reached"),
    ]
    .map(|(level, goal, verdict)| (format!("levels/{level}.txt"), goal.to_string(), verdict.to_string()));
    assert_eq!(verdicts(&all[0]), expected);
    // One level after the other has the same result.
    for (level, _) in LEVELS {
        let of = format!("--map levels/{level}.txt --nodes 3000 --format json");
        let alone: Value = serde_json::from_slice(&place.run(&of).stdout).unwrap();
        let rows: Vec<&Value> = all[0].iter().filter(|r| r["level"] == format!("levels/{level}.txt")).collect();
        for (row, goal) in rows.iter().zip(alone["goals"].as_array().unwrap()) {
            for (field, value) in goal.as_object().unwrap() {
                if !["seconds", "growth", "tree"].contains(&field.as_str()) {
                    assert_eq!(row[field], *value, "{level}: {field}");
                }
            }
            assert_eq!(row["program_sha256"], alone["program_sha256"]);
        }
    }
    // The CSV holds the same but for its last three columns.
    let untimed = |text: String| -> Vec<String> {
        text.lines().map(|line| line.rsplitn(4, ',').last().unwrap().to_string()).collect()
    };
    let csv = untimed(place.read("1.csv"));
    assert_eq!(csv, untimed(place.read("4.csv")));
    assert_eq!(csv.len(), 1 + expected.len());
    assert!(csv[1].starts_with("4,levels/a.txt,goal,out,reached,true,"), "{}", csv[1]);
}

#[test]
fn a_run_that_is_killed_goes_on() {
    let place = TestFolder::new("killed");
    for index in 0..6 {
        place.write(&format!("levels/slow{index}.txt"), LEVELS[2].1);
    }
    let of = "--map levels --goal out --nodes 4000 --threads 2";
    assert_eq!(place.run(&format!("{of} --results whole.jsonl")).status.code(), Some(1));
    let whole = place.rows("whole.jsonl");
    assert_eq!(whole.len(), 10);
    for rows in [0, 1, 3, 6, 9] {
        let name = format!("after{rows}.jsonl");
        let path = place.0.join(&name);
        let mut child = place
            .command(&format!("{of} --results {name}"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Killed when a number of rows is written, or else after it ended.
        let lines = |path: &Path| std::fs::read(path).map_or(0, |text| text.iter().filter(|b| **b == b'\n').count());
        while lines(&path) < rows && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = child.kill();
        child.wait().unwrap();
        let before = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(lines(&path) >= rows.min(10));
        let (code, shown, _) = place.answer(&format!("{of} --results {name}"));
        assert_eq!(code, 1, "{shown}");
        assert_eq!(place.rows(&name), whole, "killed after {rows} rows");
        // Finished rows are not repeated: even the times are those of the killed run.
        let now = place.read(&name);
        for line in before.split_inclusive('\n').filter(|line| line.ends_with('\n')) {
            assert!(now.contains(line), "done again after {rows} rows: {line}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_run_that_is_interrupted_says_how_to_go_on() {
    let place = TestFolder::new("interrupted");
    place.write("levels/a.txt", LEVELS[0].1);
    let of = "--map levels --goal out --nodes 1000000000 --planner coverage --results rows.jsonl --threads 1";
    let child = place.command(of).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // `c` never ends.
    let lines = || std::fs::read(place.0.join("rows.jsonl")).map_or(0, |t| t.iter().filter(|b| **b == b'\n').count());
    while lines() < 2 {
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_millis(20));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{error}");
    let message = "stopped when 2 of 4 were done; they are in `rows.jsonl`, and the same command continues from there";
    assert!(error.contains(message), "{error}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 levels: 2 reached"));
    let levels: Vec<String> = verdicts(&place.rows("rows.jsonl")).into_iter().map(|(level, ..)| level).collect();
    assert_eq!(levels, ["levels/a.txt", "levels/b.txt"]);
    place.write("levels/c.txt", LEVELS[0].1);
    let (code, shown, _) = place.answer(of);
    assert_eq!(code, 0, "{shown}");
    assert!(shown.contains("4 levels: 4 reached, 2 of them kept"), "{shown}");
}

#[test]
fn rows_are_in_order_whoever_reads_the_table() {
    let place = TestFolder::new("unread");
    let of = "--map levels/c.txt levels/a.txt levels/d.txt levels/b.txt --goal out --nodes 3000 --threads 4";
    let mut child = place.command(&format!("{of} --results rows.jsonl")).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    child.wait().unwrap();
    let levels: Vec<String> = verdicts(&place.rows("rows.jsonl")).into_iter().map(|(level, ..)| level).collect();
    assert_eq!(levels, ["levels/c.txt", "levels/a.txt", "levels/d.txt", "levels/b.txt"]);
}

#[test]
fn two_runs_do_not_write_to_one_file() {
    let place = TestFolder::new("locked");
    let file = std::fs::File::create(place.0.join("rows.jsonl")).unwrap();
    file.lock().unwrap();
    let (code, _, error) = place.answer("--map levels --goal up --results rows.jsonl");
    assert!(code == 2 && error.contains("another `hypedc` is writing to `rows.jsonl`"), "{error}");
    // A process that another test is starting holds a copy of the file until it runs.
    file.unlock().unwrap();
    assert_eq!(place.answer("--map levels --goal up --results rows.jsonl").0, 0);
}

#[test]
fn a_line_that_was_cut_off_is_done_anew() {
    let place = TestFolder::new("cut");
    let of = "--map levels/a.txt levels/b.txt levels/c.txt --goal up --results rows.jsonl";
    assert_eq!(place.run(of).status.code(), Some(0));
    let (text, whole) = (place.read("rows.jsonl"), place.rows("rows.jsonl"));
    let second = text.find('\n').unwrap() + 1;
    let third = second + text[second..].find('\n').unwrap() + 1;
    for end in [0, 1, 5, second - 1, second, second + 1, second + 100, third - 1, third, third + 9, text.len() - 1] {
        place.write("rows.jsonl", &text[..end]);
        let (code, shown, error) = place.answer(of);
        assert_eq!(code, 0, "cut at {end}: {error}");
        assert_eq!(place.rows("rows.jsonl"), whole, "cut at {end}");
        let is_cut = ![0, second - 1, second, third - 1, third, text.len() - 1].contains(&end);
        assert_eq!(error.contains("is incomplete"), is_cut, "cut at {end}: {error}");
        let kept = if end < second - 1 {
            0
        } else if end < third - 1 {
            1
        } else if end < text.len() - 1 {
            2
        } else {
            3
        };
        let message = format!("{kept} of them kept from `rows.jsonl`");
        assert_eq!(shown.contains(&message), kept > 0, "cut at {end}: {shown}");
    }
}

#[test]
fn only_what_changed_is_done_anew() {
    let place = TestFolder::new("changed");
    let of = "--map levels --goal up --results rows.jsonl";
    let kept = |arguments: &str| {
        let (_, shown, error) = place.answer(arguments);
        let message = shown.split(" of them kept").next().filter(|before| before.len() < shown.len());
        (message.map_or(0, |t| t.rsplit(' ').next().unwrap().parse::<usize>().unwrap()), error)
    };
    assert_eq!(kept(of), (0, String::new()));
    assert_eq!(kept(of).0, 4);
    place.write("levels/b.txt", &LEVELS[1].1.replace("#...F", "##..F"));
    assert_eq!(kept(of).0, 3, "another level");
    assert_eq!(kept(&format!("{of} --seed 2")).0, 0, "other settings");
    assert_eq!(kept(&format!("{of} --seed 2 --threads 3")).0, 4, "threads are no setting");
    place.write("game.hyped", &GAME.replace("320", "330"));
    assert_eq!(kept(&format!("{of} --seed 2")).0, 0, "another program");
    // Layout, comments and documentation do not matter.
    let changed = GAME.replace("320", "330").replace("{ y' := 330 }", "{\n  // As high as a wall.\n y' :=   330 }");
    place.write("game.hyped", &format!("/// A walker.\n{}", changed.trim_start()));
    assert!(
        Command::new(env!("CARGO_BIN_EXE_hypedc"))
            .arg("fmt")
            .arg(place.0.join("game.hyped"))
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(kept(&format!("{of} --seed 2")).0, 4, "another layout");
    // One level removed and one added: the file has the requested ones, in their order.
    std::fs::remove_file(place.0.join("levels/a.txt")).unwrap();
    place.write("levels/bb.txt", LEVELS[0].1);
    let (count, error) = kept(&format!("{of} --seed 2"));
    assert!(count == 3 && error.contains("1 row was taken out of `rows.jsonl`"), "{error}");
    let levels: Vec<String> = verdicts(&place.rows("rows.jsonl")).into_iter().map(|(level, ..)| level).collect();
    assert_eq!(levels, ["levels/b.txt", "levels/bb.txt", "levels/c.txt", "levels/d.txt"]);
    // Requested files are written, whatever is kept.
    assert_eq!(kept(&format!("{of} --seed 2 --save-inputs way.inputs")).0, 0);
    assert_eq!(kept(&format!("{of} --seed 2 --save-inputs way.inputs --svg way.svg")).0, 0);
    assert_eq!(kept(&format!("{of} --seed 2 --save-inputs way.inputs --svg way.svg")).0, 4);
    for name in ["way.b.inputs", "way.bb.inputs", "way.d.svg"] {
        assert!(!place.read(name).is_empty(), "{name}");
    }
}

#[test]
fn levels_that_do_not_compile_have_rows_of_their_own() {
    let place = TestFolder::new("errors");
    place.write("levels/b.txt", "..\n.\n");
    place.write("levels/c.txt", "P?\n##\n");
    let (code, shown, error) = place.answer("--map levels levels/none.txt --goal up --results r.jsonl --junit r.xml");
    assert_eq!((code, error.as_str()), (1, ""), "{shown}");
    let rows = place.rows("r.jsonl");
    let found: Vec<String> = verdicts(&rows).into_iter().map(|(.., verdict)| verdict).collect();
    assert_eq!(found, ["reached", "error", "error", "reached", "error"]);
    let errors: Vec<&str> = rows.iter().filter_map(|row| row["error"].as_str()).collect();
    assert!(errors[0].contains("levels/b.txt:2:1: error[E0501]: row 2 has 1 tile"), "{}", errors[0]);
    assert!(errors[1].contains("levels/c.txt:1:2: error[E0501]: no tile `?`"), "{}", errors[1]);
    assert!(errors[2].contains("cannot read `levels/none.txt`"), "{}", errors[2]);
    assert!(
        rows[1]["program_sha256"].is_null() && rows[1]["level_sha256"].is_string() && rows[4]["level_sha256"].is_null()
    );
    assert!(shown.contains("5 levels: 2 reached, 3 error"), "{shown}");
    // Repaired levels are run, the others stay as they are.
    place.write("levels/b.txt", LEVELS[1].1);
    let (_, shown, _) = place.answer("--map levels levels/none.txt --goal up --results r.jsonl");
    assert!(shown.contains("5 levels: 3 reached, 2 error, 2 of them kept"), "{shown}");
}

#[test]
fn what_is_asked_wrongly_is_told_before_all_levels() {
    let place = TestFolder::new("wrong");
    place.write("other.jsonl", "entity A { }\n");
    place.write("closed.hyped", &GAME.replace("map level own", "map own \"\nP#\n\""));
    std::fs::create_dir(place.0.join("empty")).unwrap();
    for (arguments, expected) in [
        ("--map levels --goal nowhere", "no goal `nowhere`"),
        ("--map levels --world Elsewhere", "no world `Elsewhere`"),
        ("--map levels --after fly*3", "fly"),
        ("--map levels --without hero.z>3", "hero.z"),
        ("--map levels --tree", "--tree"),
        ("--map empty", "holds no level"),
        ("--results r.jsonl", "leaves its map to the command line"),
        ("--map levels --results other.jsonl", "`other.jsonl` is unchanged; line 1"),
        ("--map levels --baseline other.jsonl", "`other.jsonl` is not a baseline; line 1"),
        ("--map levels --baseline none.jsonl", "cannot read `none.jsonl`"),
        ("--map levels --results no/folder/r.jsonl", "cannot write `no/folder/r.jsonl`"),
        ("--map levels --csv no/folder/r.csv", "cannot write `no/folder/r.csv`"),
        ("--map levels --junit no/folder/r.xml", "cannot write `no/folder/r.xml`"),
        ("--map levels --tolerance 3", "--baseline"),
    ] {
        let (code, shown, error) = place.answer(arguments);
        assert_eq!((code, shown.as_str()), (2, ""), "{arguments}: {error}");
        assert!(error.contains(expected), "{arguments}: {error}");
    }
    assert_eq!(place.read("other.jsonl"), "entity A { }\n", "what is something else stays");
    let mut closed = Command::new(env!("CARGO_BIN_EXE_hypedc"));
    let closed = closed.args(["reach", "closed.hyped", "--map", "levels"]).current_dir(&place.0).output().unwrap();
    assert_eq!(closed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&closed.stderr).contains("takes none from the command line"));
}

#[test]
fn a_page_has_a_row_with_a_picture_for_each_question() {
    let place = TestFolder::new("page");
    let of = "--map levels --goal out --nodes 3000";
    place.write("levels/z & co.txt", "..\n...\n");
    place.run(&format!("{of} --results old.jsonl"));
    place.write("levels/a.txt", LEVELS[2].1);
    std::fs::rename(place.0.join("levels/d.txt"), place.0.join("levels/e.txt")).unwrap();
    let kept = format!("{of} --results rows.jsonl --baseline old.jsonl --html page.html");
    assert_eq!(place.answer(&kept).0, 1);
    let page = place.read("page.html");
    let row = |level: &str| {
        let start = page.find(&format!("<tr><td>levels/{level}.txt")).unwrap_or_else(|| panic!("{level} in {page}"));
        page[start + 4..].split("<tr>").next().unwrap().to_string()
    };
    for (level, words) in [
        ("a", &["not found", "lost: was reached", "not among"][..]),
        ("b", &["class=\"good\">reached", " steps</small>"]),
        ("c", &["class=\"open\">not found"]),
        ("e", &["reached", "new"]),
        ("z &amp; co", &["class=\"bad\">error", "E0501"]),
        ("d", &["not asked any more", "was reached"]),
    ] {
        let text = row(level);
        assert!(words.iter().all(|word| text.contains(word)), "{level}: {text}");
        // A level that cannot be read, or is gone, has none.
        assert_eq!(text.contains("<img"), !matches!(level, "z &amp; co" | "d"), "{level}: {text}");
    }
    assert!(page.contains("since old.jsonl: 3 as before, 1 not asked any more") && !page.contains("<script"), "{page}");
    // A row that is kept has the same picture as one that was computed.
    place.run(&kept);
    let pictures = |page: &str| page.split("<img").skip(1).map(str::to_string).collect::<Vec<_>>();
    assert_eq!(pictures(&place.read("page.html")), pictures(&page));
}

#[test]
fn a_baseline_tells_what_changed() {
    let place = TestFolder::new("baseline");
    let of = "--map levels --nodes 3000";
    assert_eq!(place.run(&format!("{of} --results old.jsonl")).status.code(), Some(1), "`c` is not solved");
    let (code, shown, _) = place.answer(&format!("{of} --baseline old.jsonl"));
    assert_eq!(code, 0, "as before is no worse: {shown}");
    assert!(shown.ends_with("since old.jsonl: 8 as before\n"), "{shown}");
    // One goal is found, one is lost, one path is longer; one level is removed and one added.
    place.write("levels/c.txt", LEVELS[0].1);
    place.write("levels/b.txt", LEVELS[2].1);
    let wide = "..........................\n..........................\nP........................F\n##########################\n";
    place.write("levels/a.txt", wide);
    std::fs::rename(place.0.join("levels/d.txt"), place.0.join("levels/e.txt")).unwrap();
    let (code, shown, _) = place.answer(&format!("{of} --goal out --baseline old.jsonl --minimize"));
    assert_eq!(code, 1, "{shown}");
    for line in [
        "  lost    levels/b.txt, goal out: reached → not found any more, not known to be worse\n",
        "  found   levels/c.txt, goal out: not found → reached, which may have been so before\n",
        "  new     levels/e.txt, goal out: reached\n",
        "  gone    levels/d.txt, goal out: was reached\n",
        "  gone    levels/a.txt, goal up: was reached\n",
        "  longer  levels/a.txt, goal out: ",
    ] {
        assert!(shown.contains(line), "{line}in\n{shown}");
    }
    let (_, shown, _) = place.answer(&format!("{of} --goal out --baseline old.jsonl --minimize --tolerance 10000%"));
    assert!(!shown.contains("longer"), "{shown}");
    let (code, json, _) = place.answer(&format!("{of} --goal out --baseline old.jsonl --format json"));
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((code, json["version"].as_u64(), json["stopped"].as_bool()), (1, Some(4), Some(false)));
    assert_eq!(json["rows"].as_array().unwrap().len(), 4);
    let flip = &json["changes"]["flips"][0];
    let brief = ["level", "goal", "from", "to", "change"].map(|field| flip[field].as_str().unwrap());
    assert_eq!(brief, ["levels/b.txt", "out", "reached", "not-found", "lost"]);
}

#[test]
fn junit_is_what_continuous_integration_reads() {
    let place = TestFolder::new("junit");
    place.write("levels/d.txt", "P?\n");
    let of = "--map levels --never fell --goal out --nodes 3000 --junit r.xml";
    assert_eq!(place.run(of).status.code(), Some(1));
    let text = place.read("r.xml");
    // Times, hashes and ways differ from one machine or version to the next.
    let mut plain = String::new();
    for line in text.lines() {
        let is_hash = line.contains("_sha256") || line.contains("name=\"hypedc\"");
        let line = match (is_hash, line.find(" time=\"")) {
            (true, _) => continue,
            (_, None) if line.contains("<system-out>") => {
                assert!(line.contains("right"), "{line}");
                "      <system-out>…</system-out>".to_string()
            }
            (_, Some(at)) => {
                let (before, after) = line.split_at(at);
                let rest = after[7..].split_once('"').unwrap();
                assert!(rest.0.parse::<f64>().unwrap() >= 0.0);
                format!("{before} time=\"…\"{}", rest.1)
            }
            (_, None) => line.to_string(),
        };
        plain.push_str(&line);
        plain.push('\n');
    }
    insta::assert_snapshot!(plain);
    // Valid for the schema of Jenkins' xUnit plugin.
    let read = roxmltree::Document::parse(&text).unwrap();
    for node in read.descendants().filter(roxmltree::Node::is_element) {
        let (inside, required, allowed): (&[&str], &[&str], &[&str]) = match node.tag_name().name() {
            "testsuites" => (&["testsuite"], &[], &["name", "tests", "failures", "errors", "time"]),
            "testsuite" => {
                (&["properties", "testcase"], &["name", "tests", "failures", "errors"], &["file", "time", "skipped"])
            }
            "properties" => (&["property"], &[], &[]),
            "property" => (&[], &["name", "value"], &[]),
            "testcase" => (&["failure", "error", "system-out"], &["name"], &["classname", "time"]),
            "failure" | "error" => (&[], &[], &["message", "type"]),
            "system-out" => (&[], &[], &[]),
            other => panic!("no element `{other}`"),
        };
        assert!(required.iter().all(|name| node.has_attribute(*name)), "{node:?}");
        assert!(node.attributes().all(|a| required.contains(&a.name()) || allowed.contains(&a.name())), "{node:?}");
        assert!(node.children().filter(|n| n.is_element()).all(|n| inside.contains(&n.tag_name().name())), "{node:?}");
    }
    let count = |name: &str| read.descendants().filter(|n| n.has_tag_name(name)).count().to_string();
    let root = read.root_element();
    for (attribute, element) in [("tests", "testcase"), ("failures", "failure"), ("errors", "error")] {
        assert_eq!(root.attribute(attribute), Some(count(element).as_str()), "{attribute}");
    }
}

#[test]
fn levels_of_the_corpus_are_searched_by_a_program_of_their_legend() {
    let place = TestFolder::new("vglc");
    for name in ["open.hyped", "walker.hyped", "smb.json"] {
        place.write(name, &std::fs::read_to_string(Path::new("tests/maps").join(name)).unwrap());
    }
    let level = std::fs::read_to_string("tests/maps/mario-1-1.txt").unwrap();
    place.write("levels/mario-1-1.txt", &level);
    // The same level, started in the middle.
    let half: String = level.lines().map(|row| format!("{}\n", &row[row.len() / 2..])).collect();
    place.write("levels/mario-1-2.txt", &half);
    let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
    let levels = ["--map", "levels/mario-1-1.txt", "levels/mario-1-2.txt", "--results", "r.jsonl"];
    let output = command.args(["reach", "open.hyped"]).args(levels).current_dir(&place.0).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let rows = place.rows("r.jsonl");
    let steps: Vec<u64> = rows.iter().map(|row| row["steps"].as_u64().unwrap()).collect();
    // 168 px at 90 px/s, with a start from rest.
    assert!(steps.iter().all(|steps| *steps > 100), "{steps:?}");
    assert_ne!(rows[0]["program_sha256"], rows[1]["program_sha256"]);
}

#[test]
fn the_player_may_be_in_the_levels_alone() {
    let place = TestFolder::new("player");
    place.write("game.hyped", &GAME.replace("        'P': spawn Walker as hero\n", ""));
    let ground = "<layer id=\"1\" name=\"rock\" width=\"4\" height=\"2\"><data encoding=\"csv\">0,0,0,0,\n1,1,1,1</data></layer>";
    let tiles = "<tileset firstgid=\"1\" name=\"t\" tilewidth=\"16\" tileheight=\"16\" tilecount=\"1\" columns=\"1\"/>";
    for (name, at, flag) in [("near", 0, 32), ("far", 0, 48)] {
        let objects = format!(
            "<object id=\"1\" name=\"hero\" type=\"Walker\" x=\"{at}\" y=\"0\" width=\"16\" height=\"16\"/>
             <object id=\"2\" type=\"flag\" x=\"{flag}\" y=\"0\" width=\"16\" height=\"16\"/>"
        );
        let map = format!(
            "<map orientation=\"orthogonal\" width=\"4\" height=\"2\" tilewidth=\"16\" tileheight=\"16\" infinite=\"0\">
             {tiles}{ground}<objectgroup id=\"2\" name=\"things\">{objects}</objectgroup></map>"
        );
        place.write(&format!("{name}.tmx"), &map);
    }
    place.write("broken.tmx", "<map");
    let of = "--map broken.tmx near.tmx far.tmx --goal out --nodes 4000 --results rows.jsonl";
    let (code, shown, error) = place.answer(of);
    assert_eq!((code, error.contains("E0201")), (1, false), "{shown}{error}");
    let rows = place.rows("rows.jsonl");
    let steps: Vec<Option<u64>> = rows.iter().map(|row| row["steps"].as_u64()).collect();
    assert!(steps[0].is_none() && rows[0]["error"].as_str().unwrap().contains("broken.tmx"), "{rows:?}");
    assert!(steps[1].is_some() && steps[1] < steps[2], "{steps:?}");
    // Each level by itself says the same.
    let (code, shown, error) = place.answer("--map near.tmx --goal out --nodes 4000");
    assert!(code == 0 && shown.contains("out"), "{shown}{error}");
    // A bad question is refused before any level.
    let (code, _, error) = place.answer("--map near.tmx far.tmx --goal nowhere");
    assert!(code == 2 && error.contains("no goal `nowhere`"), "{error}");
    // Without a level one error says what is missing.
    let (code, _, error) = place.answer("--goal out");
    assert!(code == 2 && error.matches("error[").count() == 1 && error.contains("error[E0602]"), "{error}");
    let check = |options: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
        let command = command.args(["check", "--format", "short", "game.hyped"]).args(options);
        let output = command.current_dir(&place.0).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8_lossy(&output.stdout).lines().count())
    };
    assert_eq!(check(&[]), (1, 1));
    assert_eq!(check(&["--map", "near.tmx"]), (0, 0));
    assert_eq!(check(&["--map", "no/such.tmx"]), (2, 1));
}

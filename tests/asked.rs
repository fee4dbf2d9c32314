//! Questions and numbers of the command line: predicates as goals, `never`s and expectations, numbers that are set, sweeps,
//! explorations.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;

use hypedc::compile::{Asked, Changes, ExtraQuestion, LevelFile, NumberSetting, compile, compile_changed};
use hypedc::ir::WorldId;
use serde_json::Value;

use crate::support::Text;

/// A jumper before a ledge, which is two rooms: no link leads to the second.
const GAME: &str = "const width = 16
behavior Falls(pull) {
    param weight = pull
}
entity Hero {
    use Falls(pull = -720)
    param jump_speed = 240
    param rest = 500ms
    param doubled = 2 * jump_speed
    button right, jump
    collider body: rect(0, 0, width, 16)
    mode ground {
        x' = 0
        when pressed(jump) -> air { y' := jump_speed }
        when held(right) -> walk
        when not touching(body, rock, below) -> air
    }
    mode walk {
        x' = 90
        when not held(right) -> ground
    }
    mode air {
        x' = 60
        y'' = weight
        when touching(body, rock, below) and timer > rest / 100 -> ground
    }
}
world Ledge {
    step 1/60
    collide body with rock: block
    tiles land 16 x 16 {
        '.': empty
        '#': rock
        'H': spawn Hero as hero
    }
    space main {
        bounds rect(0, 0, 160, 160)
        map land \"
            ##########
            #........#
            #........#
            #........#
            #........#
            #......###
            #......###
            #H.....###
            ##########
        \"
    }
    space cellar {
        bounds rect(0, 0, 64, 48)
    }
    condition high = hero.y > 30
    player 1: hero
    goal up: hero.x > 104 and hero.y >= 64
    goal right: hero.x > 60
    never flown: hero.y > 900
}
";

/// A folder of its own with the game.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("asked-{name}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("game.hyped"), GAME).unwrap();
        Folder(folder)
    }

    /// The exit code, standard output, and standard error.
    fn run(&self, arguments: &[&str]) -> (i32, String, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).current_dir(&self.0).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let (_, shown, error) = self.run(&[arguments, &["--format", "json"]].concat());
        serde_json::from_str(&shown).unwrap_or_else(|why| panic!("{why}: {shown}{error}"))
    }
}

#[test]
fn predicates_are_goals_whose_paths_are_replayed_by_others() {
    let folder = Folder::new("goals");
    let asked = "hero.x > 70 and hero.y > 20";
    let (code, shown, _) = folder.run(&[
        "reach",
        "game.hyped",
        "--goal",
        asked,
        "--goal",
        "right",
        "--goal",
        "high",
        "--save-inputs",
        "way.inputs",
    ]);
    assert_eq!(code, 0, "{shown}");
    for goal in [asked, "right", "high"] {
        assert!(shown.contains(&format!("goal {goal}: reached in ")) && shown.contains(", in `main`"), "{shown}");
    }
    let saved = "way.hero-x-gt-70-and-hero-y-gt-20.inputs";
    let (code, shown, error) =
        folder.run(&["sim", "game.hyped", "--inputs-file", saved, "--expect", asked, "--expect-not", "hero.x > 200"]);
    assert_eq!(code, 0, "{shown}{error}");
    let (code, shown, error) =
        folder.run(&["sim", "game.hyped", "--inputs-file", "way.high.inputs", "--expect", "high"]);
    assert_eq!(code, 0, "{shown}{error}");
    let (code, _, error) = folder.run(&["sim", "game.hyped", "--inputs-file", saved, "--expect-not", asked]);
    assert!(code == 1 && error.contains("the goal held at step"), "{error}");
}

#[test]
fn names_come_first_and_mistakes_have_their_places() {
    let folder = Folder::new("mistakes");
    let mut all = String::new();
    for question in [
        &["reach", "game.hyped", "--goal", "rigth"][..],
        &["reach", "game.hyped", "--goal", "flown"],
        &["reach", "game.hyped", "--never", "flwn"],
        &["reach", "game.hyped", "--goal", "hero.speed > 3"],
        &["reach", "game.hyped", "--goal", "hero.x > 3", "--never", "hero.x >"],
        &["reach", "game.hyped", "--never", "hero.x > 3s"],
        &["sim", "game.hyped", "--frames", "3", "--expect", "hero.x"],
        &["experiment", "game.hyped", "--goal", "hero.z > 3"],
        &["sim", "game.hyped", "--frames", "3", "--set", "Hero.jump_sped=3"],
        &["sim", "game.hyped", "--frames", "3", "--set", "jump_speed=3"],
        &["sim", "game.hyped", "--frames", "3", "--set", "Hero.rest=3s + 1px"],
        &["sim", "game.hyped", "--frames", "3", "--set", "Hero.jump_speed=fast"],
        &["sim", "game.hyped", "--frames", "3", "--set", "Hero.jump_speed"],
        &["reach", "game.hyped", "--set", "Hero.jump_speed=200..100/10"],
        &["ir", "game.hyped", "--set", "Hero.jump_speed=200..300/10"],
        &["reach", "game.hyped", "--set", "Hero.jump_speed=200..300/1", "--set", "width=1..200/1"],
        &["reach", "game.hyped", "--set", "width=3..5/1", "--map", "a", "b"],
        &["reach", "game.hyped", "--explore", "--goal", "up"],
        &["reach", "game.hyped", "--set", "width=8", "--html", "page.html"],
    ] {
        let (code, shown, error) = folder.run(question);
        assert_eq!((code, shown.as_str()), (2, ""), "{question:?}");
        all += &format!("$ hypedc {}\n{error}\n", question.join(" "));
    }
    insta::assert_snapshot!(all);
}

#[test]
fn a_never_that_is_asked_is_no_rule() {
    // All ways to the right pass where the `never` holds: it would end them all if it were one of the world.
    let folder = Folder::new("never");
    let asked = ["reach", "game.hyped", "--goal", "right", "--never", "hero.x > 40 and hero.x < 44"];
    let (code, shown, _) = folder.run(&asked);
    assert_eq!(code, 1, "{shown}");
    assert!(
        shown.contains("goal right: reached") && shown.contains("never hero.x > 40 and hero.x < 44: violated"),
        "{shown}"
    );
    // One that nothing violates is proven, beside a goal that is reached.
    let (code, shown, _) = folder.run(&["reach", "game.hyped", "--goal", "right", "--never", "hero.x < -100"]);
    assert!(code == 0 && shown.contains("never hero.x < -100: proven"), "{shown}");
    // A rule of the world ends a run: with it as `--without`, nothing is reached.
    let (_, shown, _) = folder.run(&[
        "reach",
        "game.hyped",
        "--goal",
        "right",
        "--without",
        "hero.x > 40 and hero.x < 44",
        "--nodes",
        "2000",
    ]);
    assert!(!shown.contains("goal right: reached"), "{shown}");
}

#[test]
fn rows_have_the_text_of_the_question_and_resume() {
    let folder = Folder::new("rows");
    let open = GAME.replace("space cellar {\n        bounds rect(0, 0, 64, 48)\n    }", "");
    let map =
        open.find("map land \"").unwrap()..open.find("    }\n    \n").or(open.find("    }\n    condition")).unwrap();
    let open = format!("{}map level land\n{}", &open[..map.start], &open[map.end..]);
    std::fs::write(folder.0.join("open.hyped"), &open).unwrap();
    std::fs::create_dir_all(folder.0.join("levels")).unwrap();
    for (name, row) in [("a", "H........."), ("b", "H....#....")] {
        std::fs::write(folder.0.join(format!("levels/{name}.txt")), format!("..........\n{row}\n##########\n"))
            .unwrap();
    }
    let asked = [
        "reach",
        "open.hyped",
        "--map",
        "levels",
        "--goal",
        "hero.x  >  100",
        "--nodes",
        "2000",
        "--results",
        "r.jsonl",
    ];
    let (code, shown, error) = folder.run(&[&asked[..], &["--set", "Hero.jump_speed=300"]].concat());
    assert_eq!(code, 0, "{shown}{error}");
    let rows = || -> Vec<Value> {
        let text = std::fs::read_to_string(folder.0.join("r.jsonl")).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let first = rows();
    assert!(first.iter().all(|row| row["goal"] == "hero.x > 100" && row["spaces"][0] == "main"), "{first:?}");
    assert!(first.iter().all(|row| row["settings"]["set"][0] == "Hero.jump_speed=300"), "{first:?}");
    let (_, shown, _) = folder.run(&[&asked[..], &["--set", "Hero.jump_speed=300"]].concat());
    assert!(shown.contains("2 of them kept"), "{shown}");
    // Another number is another program.
    let (_, shown, _) = folder.run(&[&asked[..], &["--set", "Hero.jump_speed=310"]].concat());
    assert!(!shown.contains("kept"), "{shown}");
    assert_ne!(first[0]["program_sha256"], rows()[0]["program_sha256"]);
}

#[test]
fn numbers_are_set_as_if_they_were_written() {
    let written = |from: &str, to: &str| {
        assert_eq!(GAME.matches(from).count(), 1, "{from}");
        let text = GAME.replace(from, to);
        let compiled = compile(Path::new("test.hyped"), &Text(&text));
        compiled.program.unwrap_or_else(|| panic!("{:?}", compiled.diagnostics))
    };
    let set = |path: &str, value: &str| {
        let numbers = [NumberSetting { path, value }];
        let changes = Changes { numbers: &numbers, ..Changes::default() };
        let compiled = compile_changed(Path::new("test.hyped"), LevelFile::default(), &changes, &Text(GAME));
        compiled.program.unwrap_or_else(|| panic!("{path}={value}: {:?}", compiled.diagnostics))
    };
    let meaning = |program: &hypedc::ir::Program| serde_json::to_string(&program.meaning()).unwrap();
    let plain = meaning(&compile(Path::new("test.hyped"), &Text(GAME)).program.unwrap());
    for (path, value, from, to) in [
        ("Hero.jump_speed", "310", "jump_speed = 240", "jump_speed = 310"),
        ("Hero.jump_speed", "-2.5", "jump_speed = 240", "jump_speed = -2.5"),
        ("Hero.jump_speed", "2 * width * 10", "jump_speed = 240", "jump_speed = 2 * width * 10"),
        // A plain number has the unit that is written.
        ("Hero.rest", "300", "rest = 500ms", "rest = 300ms"),
        ("Hero.rest", "0.25s", "rest = 500ms", "rest = 0.25s"),
        ("Hero.doubled", "3", "doubled = 2 * jump_speed", "doubled = 3"),
        ("width", "12", "const width = 16", "const width = 12"),
        // That of a behaviour is one of the entity that uses it.
        ("Hero.weight", "-500", "pull = -720", "pull = -500"),
    ] {
        let is = meaning(&set(path, value));
        assert_eq!(is, meaning(&written(from, to)), "{path}={value}");
        assert_ne!(is, plain, "{path}={value}");
    }
}

#[test]
fn a_trace_repeats_the_numbers_that_were_set_and_no_expectation() {
    let folder = Folder::new("trace");
    let run = [
        "sim",
        "game.hyped",
        "--inputs",
        "right*10 -*2 jump*5 -*30",
        "--set",
        "Hero.jump_speed=200",
        "--trace",
        "t.csv",
    ];
    let (code, shown, error) = folder.run(&[&run[..], &["--expect", "hero.y > 30"]].concat());
    assert_eq!(code, 0, "{shown}{error}");
    let (code, shown, error) = folder.run(&["sim", "--replay", "t.csv"]);
    assert!(code == 0 && shown.contains("all 47 steps are the same"), "{shown}{error}");
}

#[test]
fn a_sweep_finds_the_jump_that_simulation_finds() {
    let folder = Folder::new("sweep");
    let sweep = "Hero.jump_speed=240..300/10";
    let found = folder.json(&["reach", "game.hyped", "--goal", "up", "--nodes", "3000", "--set", sweep]);
    // The height of a jump, by simulation of the jump alone.
    let (_, shown, _) = folder.run(&["sim", "game.hyped", "--inputs", "-*9 jump*40", "--set", sweep]);
    let heights: Vec<f64> =
        shown.lines().skip(2).map(|line| line.split_whitespace().last().unwrap().parse().unwrap()).collect();
    let points = found["points"].as_array().unwrap();
    assert_eq!((points.len(), heights.len()), (7, 7), "{shown}");
    let mut both = [0, 0];
    for (point, height) in points.iter().zip(heights) {
        let is_reached = point["answers"][0]["verdict"] == "reached";
        // Its top is 64 px high, and a body that is as high as that is pushed onto it.
        assert_eq!(is_reached, height >= 64.0, "{height}: {point}");
        both[usize::from(is_reached)] += 1;
        if is_reached {
            let (inputs, value) =
                (point["answers"][0]["inputs"].as_str().unwrap(), point["values"][0].as_str().unwrap());
            let set = format!("Hero.jump_speed={value}");
            let (code, shown, error) =
                folder.run(&["sim", "game.hyped", "--set", &set, "--inputs", inputs, "--expect", "up"]);
            assert_eq!(code, 0, "{shown}{error}");
        }
    }
    assert!(both[0] > 1 && both[1] > 1, "{both:?}");
}

#[test]
fn sweeps_are_tables_and_maps() {
    let folder = Folder::new("tables");
    let one = ["--set", "Hero.jump_speed=240..300/20"];
    let two = [&one[..], &["--set", "Hero.weight=-800..-600/100"]].concat();
    let mut all = String::new();
    for (command, numbers) in [
        (&["reach", "game.hyped", "--goal", "up", "--nodes", "800", "--csv", "one.csv"][..], &one[..]),
        (
            &["reach", "game.hyped", "--goal", "up", "--never", "hero.y > 70", "--nodes", "800", "--svg", "two.svg"],
            &two,
        ),
        (&["sim", "game.hyped", "--inputs", "right*20 -*2 jump*30"], &one),
        (&["sim", "game.hyped", "--inputs", "right*20 -*2 jump*30", "--csv", "sim.csv"], &one),
        (&["sim", "game.hyped", "--inputs", "right*20", "--csv", "run.csv"], &[]),
        (&["bounds", "game.hyped"], &one),
        (&["bounds", "game.hyped", "--csv", "bounds.csv"], &one),
        (&["bounds", "game.hyped", "--csv", "bounds.csv"], &[]),
        (&["reach", "game.hyped", "--goal", "right", "--quiet"], &["--set", "width=0..16/8"]),
    ] {
        let arguments = [command, numbers].concat();
        let (code, shown, error) = folder.run(&arguments);
        all += &format!("$ hypedc {}\n{shown}{error}[exit {code}]\n\n", arguments.join(" "));
    }
    insta::assert_snapshot!(all);
    let csv = std::fs::read_to_string(folder.0.join("one.csv")).unwrap();
    assert!(csv.starts_with("Hero.jump_speed,kind,goal,verdict,steps") && csv.lines().count() == 5, "{csv}");
    for (name, begins) in [("sim.csv", "Hero.jump_speed,steps,goal "), ("bounds.csv", "Hero.jump_speed,goal ")] {
        let csv = std::fs::read_to_string(folder.0.join(name)).unwrap();
        assert!(csv.starts_with(begins) && csv.lines().count() == 5, "{csv}");
    }
    let svg = std::fs::read_to_string(folder.0.join("two.svg")).unwrap();
    assert_eq!(svg.matches("<rect class=\"cell").count(), 2 * 12 + svg.matches("width=\"26\" height=\"18\"").count());
    assert!(
        svg.contains("goal up") && svg.contains("never hero.y &gt; 70") && svg.contains("nothing is proven"),
        "{svg}"
    );
}

#[test]
fn an_exploration_says_what_was_found_and_never_that_something_cannot_be() {
    let folder = Folder::new("explore");
    let (code, shown, error) = folder.run(&["reach", "game.hyped", "--explore", "--nodes", "2000"]);
    assert_eq!(code, 0, "{shown}{error}");
    assert!(shown.contains("rooms   1 of 2 entered; not: `cellar`"), "{shown}");
    // The floor before the ledge has six tiles; the ledge, two, is too high.
    assert!(shown.contains("floors  6 of 8 tiles stood on; not: x 112 to 144 at y 64"), "{shown}");
    assert!(shown.contains("modes   3 of 3 entered") && shown.contains("may still be reachable"), "{shown}");
    for word in ["cannot", "never", "unreachable"] {
        assert!(!shown.contains(word), "{word}: {shown}");
    }
    // A higher jump stands on it, too.
    let set = ["--set", "Hero.jump_speed=320"];
    let found = folder.json(&[&["reach", "game.hyped", "--explore", "--nodes", "2000"][..], &set].concat());
    let main = &found["spaces"][0];
    assert_eq!((main["tops"].as_u64(), main["tops_stood_on"].as_u64()), (Some(8), Some(8)), "{main}");
    // Six columns by seven rows before the ledge, and two by four above it.
    let cells = (main["cells"].as_u64().unwrap(), main["cells_entered"].as_u64().unwrap());
    assert!(cells.0 == 6 * 7 + 2 * 4 && cells.1 > 30 && cells.1 <= cells.0, "{main}");
}

#[test]
fn questions_of_the_library_are_names_or_predicates() {
    let asked = |text: &'static str, asked: Asked| {
        let questions = [ExtraQuestion { asked, world: None, text, origin: "test" }];
        let changes = Changes { questions: &questions, ..Changes::default() };
        let compiled = compile_changed(Path::new("test.hyped"), LevelFile::default(), &changes, &Text(GAME));
        let program = compiled.program.unwrap();
        let world = &program.worlds[WorldId(0)];
        (world.goals.len(), world.nevers.len())
    };
    assert_eq!(asked("up", Asked::Goal), (2, 1));
    assert_eq!(asked("upp", Asked::Goal), (2, 1), "a name that nothing has is added nowhere");
    assert_eq!(asked("high", Asked::Goal), (3, 1), "a condition is a predicate");
    assert_eq!(asked("hero.x > 3", Asked::Goal), (3, 1));
    assert_eq!(asked("hero.x > 3", Asked::Never), (2, 2));
    assert_eq!(asked("flown", Asked::Either), (2, 1));
    assert_eq!(asked("up", Asked::Never), (2, 1));
}

//! `hypedc diff` is true: pairs of programs of which it is known what the change broke, and comparisons of programs with
//! themselves.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use hypedc::compile::{Compilation, compile};
use hypedc::diff::{Budget, Class, Side, Version, changes, compare, diverge, outline};
use hypedc::ir::{ModeId, Program, WorldId};
use hypedc::reach::Limits;
use hypedc::reach::query::Kind;
use hypedc::sim::Simulator;
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;
use serde_json::Value;

use crate::support::{Disk, Text, files, script, slot};

/// Jumps, keys and a door.
const GAME: &str = "// A hero that jumps, and a door.
const floor = 16

entity Hero {
    param jump_speed = 300
    param run = 90

    button jump
    axis horizontal
    discrete keys: int 0..3 = 0

    collider body: rect(0, 0, 16, 16)

    x' = run * horizontal
    y'' = -900

    initial mode ground {
        when pressed(jump) and touching(body, wall, below) -> air { y' := jump_speed }
    }
    mode air {
        when touching(body, wall, below) -> ground
    }
    always {
        when touching(body, key) { keys := 1 }
    }
}

entity Door {
    ref hero: Hero
    kinematic collider wall: rect(0, 0, 8, 64) when in shut
    mode shut {
        when near(hero, self, 40) -> open
    }
    mode open { }
}

world Cellar {
    step 1/60
    collide body with wall: block
    collide body with key: sense
    space main {
        bounds rect(0, 0, 320, 160)
        rect wall (0, 0, 320, 16)
        rect wall (0, 16, 8, 100)
        rect wall (312, 16, 8, 100)
        rect key (16, 16, 16, 16)
        place hero: Hero at (64, floor)
        place door: Door at (200, floor) { hero = hero }
    }
    player 1: hero
    goal apple: hero.y >= 60
    goal out: hero.x > 240
    goal rich: hero.keys > 0
    never high: hero.y > 80
}
";

/// A budget that is enough for what is found.
const BRIEF: [&str; 2] = ["--nodes", "300"];

/// A folder with two programs.
struct Pair(PathBuf);

impl Pair {
    fn new(name: &str, old: &str, new: &str) -> Pair {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("diff").join(name);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("old.hyped"), old).unwrap();
        std::fs::write(folder.join("new.hyped"), new).unwrap();
        Pair(folder)
    }

    /// Exit code and outputs of `hypedc diff`.
    fn run(&self, more: &[&str]) -> (i32, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
        let output = command.args(["diff", "old.hyped", "new.hyped"]).args(more).current_dir(&self.0).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    }

    fn json(&self, more: &[&str]) -> (i32, Value) {
        let (code, out, err) = self.run(&[more, &["--format", "json"]].concat());
        (code, serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}{err}")))
    }
}

/// The game and a change of it.
fn changed(name: &str, from: &str, to: &str) -> Pair {
    assert!(GAME.contains(from), "{from}");
    Pair::new(name, GAME, &GAME.replace(from, to))
}

fn question<'j>(result: &'j Value, goal: &str) -> &'j Value {
    let levels = result["levels"].as_array().unwrap().iter();
    let mut all = levels.flat_map(|level| level["questions"].as_array().unwrap());
    all.find(|question| question["goal"] == goal).unwrap_or_else(|| panic!("no {goal} in {result}"))
}

fn verdicts(result: &Value, goal: &str) -> [String; 3] {
    let question = question(result, goal);
    [&question["class"], &question["old"]["verdict"], &question["new"]["verdict"]]
        .map(|word| word.as_str().unwrap().to_string())
}

/// What the programs say: `param Hero.jump_speed 300 280`.
fn parts(result: &Value) -> Vec<String> {
    let word = |value: &Value| value.as_str().unwrap_or("-").to_string();
    let part = |change: &Value| ["change", "what", "name", "old", "new"].map(|field| word(&change[field])).join(" ");
    result["changes"].as_array().unwrap().iter().map(part).collect()
}

#[test]
fn a_jump_that_is_too_low_is_worse_and_the_way_back_is_better() {
    // At 300 px/s it rises by 47.5 px, to 63.5; at 280 by 41.3, to 57.3.
    let lower = changed("lower", "jump_speed = 300", "jump_speed = 280");
    let (code, result) = lower.json(&BRIEF);
    assert_eq!((code, result["is_worse"].as_bool()), (1, Some(true)));
    assert_eq!(parts(&result), ["changed param Hero.jump_speed 300 280"]);
    assert_eq!(verdicts(&result, "apple"), ["worse", "reached", "proven-unreachable"]);
    assert!(question(&result, "apple")["old_way"]["holds"].is_null());
    assert_eq!(verdicts(&result, "out")[0], "same", "it needs no jump");
    let rise = |side: &str| result["figures"][0][side][0]["jumps"][0]["rise"].as_f64().unwrap();
    assert!((rise("old") - 47.5).abs() < 1e-6, "{}", rise("old"));
    // 280 / 15 = 18.67: the speed is above 0 for 18 steps, which rise by 18 * 280 / 60 - 18 * 19 / 8.
    assert!((rise("new") - (84.0 - 42.75)).abs() < 1e-6, "{}", rise("new"));
    let higher = Pair::new("higher", &GAME.replace("jump_speed = 300", "jump_speed = 280"), GAME);
    let (code, result) = higher.json(&BRIEF);
    assert_eq!(
        (code, verdicts(&result, "apple")),
        (0, ["better", "proven-unreachable", "reached"].map(str::to_string))
    );
}

#[test]
fn a_never_that_is_newly_violated_is_worse() {
    // At 400 px/s it rises by 86.7 px.
    let (code, result) = changed("high", "jump_speed = 300", "jump_speed = 400").json(&BRIEF);
    assert_eq!(code, 1);
    assert_eq!(verdicts(&result, "high"), ["worse", "proven-unreachable", "violated"]);
    assert_eq!(verdicts(&result, "apple")[0], "same");
}

#[test]
fn a_door_that_needs_a_key_is_told_where_the_way_ends() {
    let locked = changed("locked", "when near(hero, self, 40) ->", "when near(hero, self, 40) and hero.keys > 0 ->");
    let (code, result) = locked.json(&["--goal", "out"]);
    assert_eq!(code, 0, "there is another way");
    let out = question(&result, "out");
    assert_eq!(verdicts(&result, "out"), ["way", "reached", "reached"]);
    let other = &out["old_way"]["divergence"]["other"];
    assert_eq!(other["instance"], "door");
    let said = other["new"]["what"].to_string();
    assert!(said.contains("`shut -> open` is not taken") && said.contains("hero.keys > 0"), "{said}");
    // The way that is shown passes by the key and through the door.
    let Compilation { program, .. } = compile(&locked.0.join("new.hyped"), &Disk);
    let program = program.unwrap();
    let sim = Simulator::new(&program, WorldId(0));
    let (mut scratch, hero) = (sim.scratch(), slot(&program, "hero"));
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script(&program, out["new"]["inputs"].as_str().unwrap()).inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    assert!(sim.position(&state, hero).0 > 240.0);
    // Without a key the door never opens, and that is proven.
    let text = std::fs::read_to_string(locked.0.join("new.hyped")).unwrap().replace("rect key (16, 16, 16, 16)", "");
    let (code, result) = Pair::new("keyless", GAME, &text).json(&["--goal", "door in open"]);
    let expected = ["worse", "reached", "proven-unreachable"].map(str::to_string);
    assert_eq!((code, verdicts(&result, "door in open")), (1, expected));
    let way = &question(&result, "door in open")["old_way"];
    let new = &way["divergence"]["new"];
    assert_eq!(new["step"], way["steps"], "the way ends where the door opens: {way}");
    assert_eq!(new["missing"][0], "`door in open`", "{way}");
}

#[test]
fn what_is_not_found_is_lost_and_not_worse() {
    // Both variables count the same, which intervals do not see, and no search ends.
    let counting = "continuous a = 0; continuous b = 0; a' = run; b' = run;\n    x' = run * horizontal";
    let old = GAME.replace("x' = run * horizontal", counting);
    let new = old.replace("goal out: hero.x > 240", "goal out: hero.x > 240 and hero.a > hero.b + 5");
    let pair = Pair::new("lost", &old, &new);
    let (code, result) = pair.json(&["--goal", "out", "--nodes", "300"]);
    assert_eq!((code, verdicts(&result, "out")), (0, ["lost", "reached", "not-found"].map(str::to_string)));
    assert_eq!(result["is_worse"], false);
    let nodes = question(&result, "out")["new"]["nodes"].as_u64().unwrap();
    assert!(nodes > 300, "a second search begins along the old way: {nodes}");
    let (code, text, _) = pair.run(&["--goal", "out", "--nodes", "300", "--deny", "lost"]);
    assert_eq!(code, 1);
    assert!(text.contains("not found any more") && text.contains("not known to be worse"), "{text}");
    // The other way round it is found, and may have been so before.
    let (code, result) = Pair::new("found", &new, &old).json(&["--goal", "out", "--nodes", "300"]);
    assert_eq!((code, verdicts(&result, "out")[0].as_str()), (0, "found"));
}

#[test]
fn what_means_the_same_is_the_same() {
    let commented = GAME.replace("param run = 90", "// As fast as it gets.\n    param run = 90");
    let (code, text, _) = Pair::new("commented", GAME, &commented).run(&["--deny", "changes"]);
    assert_eq!(code, 0);
    assert_eq!(text, "old.hyped → new.hyped: nothing changed: both programs mean the same\n");
}

#[test]
fn a_renamed_entity_plays_as_before() {
    let renamed = GAME.replace("entity Hero {", "entity Knight {").replace(": Hero", ": Knight");
    let pair = Pair::new("renamed", GAME, &renamed);
    let (code, result) = pair.json(&BRIEF);
    assert_eq!(code, 0);
    assert_eq!(parts(&result)[0], "renamed entity Hero Hero Knight");
    for goal in ["apple", "out", "high"] {
        assert_eq!(verdicts(&result, goal)[0], "same");
    }
    assert!(result["figures"][0]["changes"].as_array().unwrap().is_empty());
    assert_eq!(pair.run(&["--deny", "changes"]).0, 1);
    // Another name for the player: players are paired by number.
    let pair = Pair::new("player", GAME, &GAME.replace("hero: Hero", "tom: Hero").replace("hero = hero", "hero = tom"));
    let text = std::fs::read_to_string(pair.0.join("new.hyped")).unwrap();
    let text = text
        .replace("player 1: hero", "player 1: tom")
        .replace("hero.x", "tom.x")
        .replace("hero.y", "tom.y")
        .replace("hero.keys > 0\n    never", "tom.keys > 0\n    never");
    let (code, result) = Pair::new("player", GAME, &text.replace("ref tom: Hero", "ref hero: Hero")).json(&BRIEF);
    assert_eq!((code, verdicts(&result, "apple")[0].as_str()), (0, "same"));
}

/// A game whose levels are files.
fn levels(name: &str) -> Pair {
    let (head, _) = GAME.split_once("entity Door").unwrap();
    let old = format!(
        "{head}world Course {{
            step 1/60
            collide body with wall: block
            collide body with key: sense
            collide body with exit: sense
            tiles own 16 x 16 {{
                '.': empty
                '#': wall
                'K': key
                'E': exit
                'P': spawn Hero as hero
            }}
            space main {{ map level own }}
            player 1: hero
            goal out: hero touching exit
        }}"
    );
    let pair = Pair::new(name, &old, &old.replace("jump_speed = 300", "jump_speed = 220"));
    std::fs::create_dir_all(pair.0.join("levels")).unwrap();
    // An exit on the ground, one that is too high for a jump by 23 px, and one that both jumps reach.
    for (name, text) in [
        ("a", "#........#\n#........#\n#........#\n#P......E#\n##########\n"),
        ("b", "#...E....#\n#........#\n#........#\n#P.......#\n##########\n"),
        ("c", "#........#\n#........#\n#...E....#\n#P.......#\n##########\n"),
    ] {
        std::fs::write(pair.0.join(format!("levels/{name}.txt")), text).unwrap();
    }
    pair
}

#[test]
fn levels_are_compared_one_by_one() {
    let pair = levels("levels");
    let of: &[&str] = &["--map", "levels", "--nodes", "300"];
    let (code, result) = pair.json(of);
    assert_eq!(code, 1);
    let row =
        |level: &Value| [&level["level"], &level["questions"][0]["class"]].map(|v| v.as_str().unwrap().to_string());
    let rows: Vec<[String; 2]> = result["levels"].as_array().unwrap().iter().map(row).collect();
    let expected = [["levels/a.txt", "same"], ["levels/b.txt", "worse"], ["levels/c.txt", "same"]];
    assert_eq!(rows, expected);
    let more = |more: &[&str]| pair.run(&[of, more].concat()).1;
    assert_eq!(more(&["--threads", "1"]), more(&["--threads", "3"]));
    let shown = [more(&[]), more(&["--format", "markdown"])];
    insta::assert_snapshot!(shown.join("\n----\n\n"));
    // The level itself changes.
    std::fs::create_dir_all(pair.0.join("before")).unwrap();
    for name in ["a", "b", "c"] {
        std::fs::copy(pair.0.join(format!("levels/{name}.txt")), pair.0.join(format!("before/{name}.txt"))).unwrap();
    }
    std::fs::write(pair.0.join("levels/c.txt"), "#........#\n#........#\n#...E...E#\n#P.......#\n##########\n")
        .unwrap();
    std::fs::write(pair.0.join("new.hyped"), std::fs::read_to_string(pair.0.join("old.hyped")).unwrap()).unwrap();
    let (code, result) = pair.json(&["--map", "levels", "--old-map", "before", "--nodes", "300"]);
    assert_eq!(code, 0);
    let of = |level: usize| &result["levels"][level];
    assert_eq!([of(0)["is_same"].as_bool(), of(2)["is_same"].as_bool()], [Some(true), Some(false)]);
    let map = &of(2)["maps"][0];
    assert_eq!((map["tiles"].as_u64(), map["first"].to_string()), (Some(1), "[9,3]".to_string()));
    // One that does not compile any more is worse.
    std::fs::write(pair.0.join("levels/c.txt"), "#?\n").unwrap();
    let (code, result) = pair.json(&["--map", "levels", "--old-map", "before", "--nodes", "300"]);
    assert_eq!((code, result["levels"][2]["is_broken"].as_bool()), (1, Some(true)));
}

#[test]
fn text_and_markdown_say_what_broke() {
    let pair = changed("shown", "jump_speed = 300", "jump_speed = 280");
    let locked =
        changed("shown_locked", "when near(hero, self, 40) ->", "when near(hero, self, 40) and hero.keys > 0 ->");
    let mut all = Vec::new();
    for (pair, more) in [
        (&pair, &["--nodes", "300"][..]),
        (&pair, &["--nodes", "300", "--format", "markdown"]),
        (&pair, &["--no-search"]),
        (&locked, &["--goal", "out"]),
        (&pair, &["--goal", "aple"]),
        (&pair, &["--world", "Celar"]),
        (&pair, &["--map", "levels"]),
    ] {
        let (code, out, err) = pair.run(more);
        all.push(format!("$ hypedc diff old.hyped new.hyped {}\n{out}{err}[exit {code}]\n", more.join(" ")));
    }
    insta::assert_snapshot!(all.join("\n"));
}

/// An example with its texts.
fn read(path: &Path) -> (Arc<Program>, SourceMap) {
    let Compilation { program, sources, .. } = compile(path, &Disk);
    (program.unwrap(), sources)
}

/// A program has the parts of itself, however it is laid out; a run of it does not differ from itself.
#[test]
fn examples_do_not_differ_from_themselves() {
    let mut runs = 0;
    for path in files("examples", "hyped") {
        let once = outline(&path, &Disk);
        assert!(!once.is_empty(), "{}", path.display());
        assert_eq!(changes(&once, &outline(&path, &Disk)), [], "{}", path.display());
        let name = path.strip_prefix("examples").unwrap().with_extension("inputs");
        let inputs = Path::new("examples/inputs").join(name);
        if !inputs.exists() {
            continue;
        }
        let (program, sources) = read(&path);
        let sim = Simulator::new(&program, WorldId(0));
        let text = std::fs::read_to_string(inputs).unwrap();
        let script = script(&program, &text);
        let side = Side { sim: &sim, sources: &sources, script: &script, asked: &[], target: None };
        let found = diverge(side, side);
        assert!(found.player.is_none() && found.other.is_none() && found.old == found.new, "{found:?}");
        runs += 1;
    }
    assert!(runs > 15, "{runs}");
}

/// The layout and comments of an example do not count.
#[test]
fn layout_does_not_count() {
    let mut compared = 0;
    for path in files("examples", "hyped") {
        let text = std::fs::read_to_string(&path).unwrap();
        if text.contains("import \"") {
            continue;
        }
        let other = text.replace("    ", "  ").replace("{ ", "{   ");
        let other = format!("// A comment.\n{other}");
        let file = Path::new("test.hyped");
        // Rows of maps are text in quotes: the same but for their indentation.
        let found = changes(&outline(file, &Text(&text)), &outline(file, &Text(&other)));
        assert_eq!(found, [], "{}", path.display());
        compared += 1;
    }
    assert!(compared > 15, "{compared}");
}

/// Searches of both programs and replays between them: an example has the same answers as itself.
#[test]
fn examples_answer_as_they_do() {
    for name in ["balloon", "frog", "switch_door", "paper/test1", "hills"] {
        let path = PathBuf::from(format!("examples/{name}.hyped"));
        let (program, sources) = read(&path);
        let version = Version { program: &program, sources: &sources, world: WorldId(0), asked: &[] };
        let world = &program.worlds[WorldId(0)];
        let mut questions: Vec<(Kind, String)> = Vec::new();
        questions.extend(world.goals.iter().map(|goal| (Kind::Goal, goal.name.clone())));
        questions.extend(world.nevers.iter().map(|never| (Kind::Never, never.name.clone())));
        let limits = Limits { nodes: 300, ..Limits::default() };
        let found = compare(version, version, &questions, Budget { limits, seed: 1 }, &Unwatched);
        assert_eq!((found.comparisons.len(), found.is_refuted), (questions.len(), false));
        for of in &found.comparisons {
            assert_eq!((of.class, of.old.verdict), (Class::Same, of.new.verdict), "{name}: {of:?}");
            assert!(of.old_way.as_ref().is_none_or(|way| way.holds == Some(way.steps)), "{name}: {of:?}");
        }
    }
}

/// The first difference is where it is: modes of the hero and the door, compared by another simulation.
#[test]
fn the_first_difference_is_where_it_is() {
    let texts = [GAME.to_string(), GAME.replace("jump_speed = 300", "jump_speed = 250")];
    let inputs = "-*3 right*20 right+jump*5 right*60 jump*40 left*30 right+jump*100";
    let compiled = |text: &String| {
        let Compilation { program, sources, .. } = compile(Path::new("test.hyped"), &Text(text));
        (program.unwrap(), sources)
    };
    let [old, new] = [compiled(&texts[0]), compiled(&texts[1])];
    let active = |program: &Arc<Program>| -> Vec<Vec<ModeId>> {
        let sim = Simulator::new(program, WorldId(0));
        let (mut scratch, hero) = (sim.scratch(), slot(program, "hero"));
        let mut state = sim.initial(&mut scratch).unwrap();
        let mut all = vec![sim.instance(&state, hero).modes().collect()];
        for input in script(program, inputs).inputs() {
            sim.step(&mut state, input, &mut scratch).unwrap();
            all.push(sim.instance(&state, hero).modes().collect());
        }
        all
    };
    let (was, is) = (active(&old.0), active(&new.0));
    let by_mode = was.iter().zip(&is).position(|(was, is)| was != is).unwrap() as u64;
    let sims = [Simulator::new(&old.0, WorldId(0)), Simulator::new(&new.0, WorldId(0))];
    let scripts = [script(&old.0, inputs), script(&new.0, inputs)];
    let side = |at: usize, sources| Side { sim: &sims[at], sources, script: &scripts[at], asked: &[], target: None };
    let found = diverge(side(0, &old.1), side(1, &new.1));
    let player = found.player.unwrap();
    // The contact that ends the jump is a step before the mode changes.
    assert_eq!((player.step, player.instance.as_str()), (by_mode - 1, "hero"));
    assert!(player.new.what[0].contains("touching(body, wall, below) holds"), "{player:?}");
}

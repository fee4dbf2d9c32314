//! Live verdicts: what stands above goals and `never`s, when it is out of date, and what an edit has broken.

use std::path::Path;
use std::sync::Arc;

use hypedc::compile::compile;
use hypedc::lsp::{Settings, Workspace};
use hypedc::sim::{Simulator, parse_script};
use hypedc::source::SourceMap;
use serde_json::{Value, json};

use super::client::{Client, Memory};
use super::levels::Disk;
use super::session::{position, uri};

const GAME: &str = "entity Hero {
    param speed = 60
    button right
    mode still {
        x' = 0
        when held(right) -> going
    }
    mode going {
        x' = speed
        when not held(right) -> still
    }
}
world W {
    step 1/60
    space main {
        bounds rect(0, 0, 320, 32)
        place hero: Hero at (0, 0)
    }
    player 1: hero
    goal over: hero.x > 30
    goal back: hero.x < 0
    never far: hero.x > 400
    never near: hero.x > 60
}
";

fn start(disk: &Arc<Disk>, nodes: u64, options: Value) -> Client {
    let settings = Settings { verdict_nodes: nodes, ..Settings::default() };
    Client::start_with(Arc::clone(disk) as Arc<dyn Workspace>, json!({}), options, settings)
}

/// The titles of the verdicts on a program, as clients are told them, with whether they are current.
fn titles(client: &Client) -> Vec<(String, String, bool)> {
    let last = client.verdicts.last().expect("verdicts");
    let of = |verdict: &Value| {
        let text = |key: &str| verdict[key].as_str().unwrap().to_string();
        (text("name"), text("title"), verdict["isCurrent"].as_bool().unwrap())
    };
    let mut all: Vec<_> = last["verdicts"].as_array().unwrap().iter().map(of).collect();
    all.sort();
    all
}

fn title(client: &Client, name: &str) -> String {
    titles(client).into_iter().find(|(of, ..)| of == name).unwrap().1
}

/// Replaces the first text that is like that.
fn replace(client: &mut Client, text: &mut String, old: &str, new: &str) {
    let at = text.find(old).unwrap();
    let range = json!({ "start": position(text, at), "end": position(text, at + old.len()) });
    text.replace_range(at..at + old.len(), new);
    client.change(&uri("a.hyped"), json!([{ "range": range, "text": new }]));
}

/// The findings with some codes.
fn found(client: &Client, codes: &[&str]) -> Vec<Value> {
    let shown = client.shown.get(&uri("a.hyped")).and_then(Value::as_array).cloned().unwrap_or_default();
    shown.into_iter().filter(|found| codes.contains(&found["code"].as_str().unwrap())).collect()
}

/// The same in words.
fn told(client: &Client) -> String {
    let of = |of: &Value| {
        format!("{} {}: {}\n{}\n", of["severity"], of["code"], of["message"].as_str().unwrap(), of["data"])
    };
    found(client, &BROKEN).iter().map(of).collect()
}

const BROKEN: [&str; 3] = ["broken-goal", "broken-never", "lost-way"];

#[test]
fn verdicts_stand_above_goals_and_nevers() {
    let mut client = start(&Disk::new(&[]), 2_000, Value::Null);
    client.open(&uri("a.hyped"), GAME);
    client.asked();
    let all: Vec<String> = titles(&client).into_iter().map(|(name, title, _)| format!("{name}: {title}")).collect();
    insta::assert_snapshot!(all.join("\n"));
    let lenses = client.lenses(&uri("a.hyped"));
    let of = |title: &str| lenses.iter().find(|(of, _)| of.starts_with(title)).unwrap().1.clone();
    let play = of("✓ ");
    assert_eq!(play["command"], "hypedc.play");
    assert!(play["arguments"][4].as_str().unwrap().contains("right*"), "{play}");
    assert_eq!(of("✗ proven")["command"], "hypedc.reach");
    assert_eq!(of("✗ broken in")["command"], "hypedc.play");
    assert!(client.stop());
}

#[test]
fn an_edit_outdates_a_verdict_until_it_is_asked_again() {
    let mut client = start(&Disk::new(&[]), 2_000, Value::Null);
    let mut text = GAME.to_string();
    client.open(&uri("a.hyped"), &text);
    client.asked();
    assert!(client.verdicts.iter().all(|of| of["verdicts"].as_array().unwrap().iter().all(|v| v["isCurrent"] == true)));
    let before = client.verdicts.len();
    replace(&mut client, &mut text, "speed = 60", "speed = 120");
    let lenses = client.lenses(&uri("a.hyped"));
    assert!(lenses.iter().any(|(title, _)| title.starts_with("… was ✓ ") && !title.contains("play")), "{lenses:?}");
    assert!(!lenses.iter().any(|(title, command)| title.starts_with('…') && command["command"] == "hypedc.play"));
    client.asked();
    assert!(client.verdicts[before]["verdicts"].as_array().unwrap().iter().all(|v| v["isCurrent"] == false));
    assert!(title(&client, "over").starts_with("✓ "));
    // A text with errors is not asked about.
    replace(&mut client, &mut text, "goal over: hero.x", "goal over: hero.");
    client.asked();
    assert!(titles(&client).iter().all(|(_, title, is_current)| title.starts_with("… was ") && !is_current));
    replace(&mut client, &mut text, "goal over: hero.", "goal over: hero.x");
    client.asked();
    assert!(titles(&client).iter().all(|(.., is_current)| *is_current));
    // A goal that is gone has no verdict, and none in a closed document.
    replace(&mut client, &mut text, "    goal back: hero.x < 0\n", "");
    client.asked();
    assert_eq!(titles(&client).len(), 3);
    client.close(&uri("a.hyped"));
    client.asked();
    assert_eq!(titles(&client), []);
    assert!(client.stop());
}

#[test]
fn a_goal_that_an_edit_breaks_is_found() {
    let mut client = start(&Disk::new(&[]), 2_000, Value::Null);
    let mut text = GAME.to_string();
    client.open(&uri("a.hyped"), &text);
    client.asked();
    assert_eq!(found(&client, &BROKEN), Vec::<Value>::new());
    replace(&mut client, &mut text, "speed = 60", "speed = 0");
    client.asked();
    let broken = found(&client, &BROKEN);
    insta::assert_snapshot!(told(&client));
    assert_eq!(broken[0]["range"]["start"], position(&text, text.find("over").unwrap()));
    // While one types, nothing is claimed.
    replace(&mut client, &mut text, "speed = 0", "speed = 0.");
    client.settle();
    assert_eq!(found(&client, &BROKEN), Vec::<Value>::new());
    replace(&mut client, &mut text, "speed = 0.", "speed = 45");
    client.asked();
    assert_eq!(found(&client, &["broken-goal", "lost-way"]), Vec::<Value>::new());
    assert!(title(&client, "over").starts_with("✓ "));
    assert!(client.stop());
}

#[test]
fn what_a_search_does_not_find_is_not_called_broken() {
    let mut client = start(&Disk::new(&[]), 600, Value::Null);
    let hard = endless();
    let goal = hard.split_once("goal open: ").unwrap().1.split_once('\n').unwrap().0.to_string();
    let mut text = hard.replace(&goal, "lock.n0 == 7");
    client.open(&uri("a.hyped"), &text);
    client.asked();
    assert!(title(&client, "open").starts_with("✓ "));
    replace(&mut client, &mut text, "open: lock.n0 == 7", &format!("open: {goal}"));
    client.asked();
    assert!(title(&client, "open").starts_with("? "), "{}", title(&client, "open"));
    insta::assert_snapshot!(told(&client));
    assert!(client.stop());
}

#[test]
fn a_never_that_an_edit_breaks_is_found() {
    let mut client = start(&Disk::new(&[]), 2_000, Value::Null);
    let mut text = GAME.replace("speed = 60", "speed = 0");
    client.open(&uri("a.hyped"), &text);
    client.asked();
    assert_eq!(title(&client, "near"), "✓ proven: hero.x = 0");
    replace(&mut client, &mut text, "speed = 0", "speed = 60");
    client.asked();
    insta::assert_snapshot!(told(&client));
    assert!(client.stop());
}

#[test]
fn verdicts_are_remembered_and_are_old_until_they_are_asked_again() {
    let disk = Disk::new(&[]);
    let mut client = start(&disk, 2_000, Value::Null);
    client.open(&uri("a.hyped"), GAME);
    client.asked();
    assert!(client.stop());
    let mut client = start(&disk, 2_000, Value::Null);
    client.open(&uri("a.hyped"), GAME);
    client.asked();
    let first = client.verdicts[0]["verdicts"].as_array().unwrap();
    assert_eq!(first.len(), 4);
    assert!(first.iter().all(|of| of["isCurrent"] == false && of["title"].as_str().unwrap().starts_with("… was ")));
    assert!(titles(&client).iter().all(|(.., is_current)| *is_current));
    assert!(client.stop());
    // What is damaged is ignored, and no evidence.
    for damage in ["", "{", "[]", "{\"version\":1}", "null"] {
        disk.cache.lock().unwrap().values_mut().for_each(|text| *text = damage.to_string());
        let mut client = start(&disk, 2_000, Value::Null);
        client.open(&uri("a.hyped"), GAME);
        client.asked();
        assert!(title(&client, "over").starts_with("✓ "));
        assert!(client.stop());
    }
    // A false memory is no evidence: all that it claims is asked again.
    disk.cache.lock().unwrap().values_mut().for_each(|text| {
        *text = text.replace("\"reached\"", "\"proven-unreachable\"").replace("right*", "-*");
    });
    let mut client = start(&disk, 2_000, Value::Null);
    client.open(&uri("a.hyped"), GAME);
    client.asked();
    assert!(title(&client, "over").starts_with("✓ "));
    assert!(client.stop());
}

#[test]
fn verdicts_can_be_turned_off() {
    for options in [json!({ "verdicts": false }), json!({ "hypedc": { "verdicts": false } })] {
        let mut client = start(&Disk::new(&[]), 2_000, options);
        client.open(&uri("a.hyped"), GAME);
        client.asked();
        assert!(client.verdicts.iter().all(|of| of["verdicts"].as_array().unwrap().is_empty()));
        assert!(client.lenses(&uri("a.hyped")).iter().all(|(title, _)| title.starts_with('▶')));
        let configure = |is_on: bool| json!({ "settings": { "hypedc": { "verdicts": is_on } } });
        client.notify("workspace/didChangeConfiguration", configure(true));
        client.asked();
        assert_eq!(titles(&client).len(), 4);
        client.notify("workspace/didChangeConfiguration", configure(false));
        client.asked();
        assert_eq!(titles(&client), []);
        assert!(client.stop());
    }
}

/// A world whose goal needs a search that does not end soon.
fn endless() -> String {
    let locks: String = (0..12).map(|n| format!("    discrete n{n}: int 0..99 = 0\n")).collect();
    let turns: String =
        (0..12).map(|n| format!("        when pressed(b{n}) {{ n{n} := mod(n{n} + 7, 100) }}\n")).collect();
    let buttons: Vec<String> = (0..12).map(|n| format!("b{n}")).collect();
    let goal: Vec<String> = (0..12).map(|n| format!("lock.n{n} == {}", 50 + n)).collect();
    format!(
        "entity Lock {{\n    button {}\n{locks}    mode shut {{\n{turns}    }}\n}}\nworld W {{\n    step 1/60\n    space main {{ \
         place lock: Lock at (0, 0) }}\n    player 1: lock\n    goal open: {}\n}}\n",
        buttons.join(", "),
        goal.join(" and ")
    )
}

#[test]
fn a_search_is_given_up_at_the_next_key() {
    // With this many nodes it would take hours.
    let mut client = start(&Disk::new(&[]), u64::MAX, Value::Null);
    let mut text = endless();
    client.open(&uri("a.hyped"), &text);
    client.settle();
    assert!(!client.shown.contains_key(&uri("a.hyped")), "{:?}", client.shown);
    for n in 0..5 {
        replace(&mut client, &mut text, &format!("= {n}\n    mode"), &format!("= {}\n    mode", n + 1));
        client.settle();
    }
    assert!(client.verdicts.iter().all(|of| of["verdicts"].as_array().unwrap().is_empty()), "nothing is claimed");
    assert_eq!(found(&client, &BROKEN), Vec::<Value>::new());
    // An errand comes between, and the search goes on.
    let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "world": "W" });
    client.request("hypedc/levels", params).unwrap();
    assert!(client.stop(), "the end of the server does not wait for it, either");
}

/// Whether inputs lead to a goal, or break a `never`, at their last step.
fn leads_there(text: &str, (kind, name): (&str, &str), inputs: &str) -> bool {
    let disk = Memory([("/game/a.hyped".into(), text.to_string())].into());
    let program = compile(Path::new("/game/a.hyped"), &disk).program.unwrap();
    let world = program.world_named("W").unwrap();
    let mut sources = SourceMap::new();
    let file = sources.add("way", inputs);
    let (script, errors) = parse_script(&program, world, file, inputs);
    let sim = Simulator::new(&program, world);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        // A run is over when a `never` holds or a player is out of bounds.
        if errors.has_errors() || sim.violated(&state).unwrap().is_some() || sim.left_bounds(&state).is_some() {
            return false;
        }
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    let table = &program.worlds[world];
    match kind {
        "goal" => sim.violated(&state).unwrap().is_none() && sim.goal(&state, table.goal_named(name).unwrap()).unwrap(),
        _ => sim.holds(&state, table.nevers[table.never_named(name).unwrap()].holds).unwrap(),
    }
}

/// What is claimed is so, whatever was edited before: ways lead there on the newest text, and what is proven is not
/// refuted by any way that was known.
#[test]
fn what_is_claimed_of_a_text_is_so() {
    let disk = Disk::new(&[]);
    let mut client = start(&disk, 300, Value::Null);
    let mut text = GAME.to_string();
    client.open(&uri("a.hyped"), &text);
    let mut known: Vec<String> = Vec::new();
    let mut claims = 0;
    for (from, to) in [
        ("speed = 60", "speed = 90"),
        ("hero.x > 30", "hero.x > 55"),
        ("> 60", "> 70"),
        ("speed = 90", "speed = 0"),
        ("speed = 0", "speed = -90"),
        ("hero.x < 0", "hero.x < 8"),
        ("button right", "button rightwards"),
        ("held(right) -> going", "held(rightwards) -> going"),
        ("not held(right)", "not held(rightwards)"),
        ("speed = -90", "speed = 120"),
        ("hero.x > 400", "hero.x > 56"),
        ("when not held", "when held"),
        ("at (0, 0)", "at (40, 0)"),
    ] {
        replace(&mut client, &mut text, from, to);
        client.asked();
        for verdict in client.verdicts.last().unwrap()["verdicts"].as_array().unwrap().clone() {
            if verdict["isCurrent"] == false {
                continue;
            }
            let question = (verdict["kind"].as_str().unwrap(), verdict["name"].as_str().unwrap());
            if let Some(inputs) = verdict["inputs"].as_str() {
                assert!(leads_there(&text, question, inputs), "{text}\n{verdict}");
                known.push(inputs.to_string());
                claims += 1;
            }
            if verdict["verdict"] == "proven-unreachable" {
                let refuted = known.iter().find(|inputs| leads_there(&text, question, inputs));
                assert_eq!(refuted, None, "{text}\n{verdict}");
                claims += 1;
            }
        }
    }
    assert!(claims > 20, "{claims}");
    assert!(client.stop());
}

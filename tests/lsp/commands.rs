//! Commands of the server: they run the texts of the editor, tell how far they are, end when they are cancelled, and block
//! nothing.

use serde_json::{Value, json};

use super::client::Client;

const URI: &str = "file:///game/a.hyped";

/// A walk to the right, in a world with a goal, a `never` and two tests.
fn program(limit: u32) -> String {
    format!(
        "entity Walker {{ param speed = 60
    axis horizontal

    mode walking {{
        x' = speed * horizontal
        when x > 10 -> far
    }}
    mode far {{
        x' = speed * horizontal
    }}
}}

world Road {{
    step 1/60

    space main {{
        bounds rect(0, 0, 320, 32)
        place hero: Walker at (0, 0)
    }}
    player 1: hero

    goal there: hero.x > {limit}
    never back: hero.x < 0

    test \"it goes\" {{
        inputs \"right*30\"
        expect hero.x > 20 at end
    }}
    test \"it flies\" {{
        inputs \"right*30\"
        expect hero.y > 20 at end
    }}
}}
"
    )
}

/// A goal that is hard to find and not proven impossible: a search takes all of its nodes.
fn hard() -> String {
    let lamps: String = (0..12)
        .map(|lamp| {
            format!(
                "    group lamp{lamp} {{\n        mode off{lamp} {{ when pressed(key) and timer > {} and timer < {} -> on{lamp} }}\n        mode on{lamp} {{ when pressed(key) -> off{lamp} }}\n    }}\n",
                0.31 + 0.173 * f64::from(lamp),
                0.33 + 0.173 * f64::from(lamp),
            )
        })
        .collect();
    let all: Vec<String> = (0..12).map(|lamp| format!("hero in on{lamp}")).collect();
    format!(
        "entity Lamps {{\n    button key\n{lamps}}}\n\nworld Hall {{\n    step 1/60\n    space main {{\n        \
         place hero: Lamps at (0, 0)\n    }}\n    player 1: hero\n    goal lit: {}\n}}\n",
        all.join(" and ")
    )
}

fn open(text: &str) -> Client {
    let capabilities = json!({ "window": { "workDoneProgress": true } });
    let mut client = Client::start(&[("/game/a.hyped", &program(1))], capabilities);
    client.open(URI, text);
    client
}

fn execute(client: &mut Client, command: &str, about: Value) -> Result<Value, (i32, String)> {
    client.request("workspace/executeCommand", json!({ "command": command, "arguments": [about] }))
}

#[test]
fn commands_run_the_text_of_the_editor() {
    let mut client = open(&program(25));
    let offered = &client.capabilities["capabilities"]["executeCommandProvider"]["commands"];
    assert_eq!(*offered, json!(["hypedc.reach", "hypedc.sim", "hypedc.test", "hypedc.why"]));

    let found =
        execute(&mut client, "hypedc.reach", json!({ "uri": URI, "goals": ["there"], "nevers": ["back"] })).unwrap();
    assert_eq!(found["goals"][0]["verdict"], "reached");
    // The goal of the file on the disk is reached after a step or two.
    assert!(found["goals"][0]["steps"].as_u64().unwrap() >= 25, "{found}");
    assert_eq!(found["goals"][1]["kind"], "never");
    // Pictures come on request, for each goal and for a run.
    assert_eq!(found.get("pictures"), None);
    let about = json!({ "uri": URI, "goals": ["there"], "picture": true });
    let drawn = execute(&mut client, "hypedc.reach", about).unwrap();
    assert_eq!(drawn["pictures"][0]["name"], "there");
    assert!(drawn["pictures"][0]["svg"].as_str().unwrap().starts_with("<svg"), "{drawn}");
    let about = json!({ "uri": URI, "inputs": "right*30", "picture": true });
    let drawn = execute(&mut client, "hypedc.sim", about).unwrap();
    assert!(drawn["pictures"][0]["svg"].as_str().unwrap().contains("30 steps"), "{drawn}");
    let by_lens = json!({ "command": "hypedc.reach", "arguments": [URI, "Road", "there"] });
    let by_lens = client.request("workspace/executeCommand", by_lens).unwrap();
    assert_eq!(by_lens["goals"][0]["inputs"], found["goals"][0]["inputs"]);

    let ran = execute(&mut client, "hypedc.sim", json!({ "uri": URI, "inputs": "right*30" })).unwrap();
    assert_eq!(ran["goals"], json!([{ "name": "there", "step": 26, "seconds": 26.0 / 60.0 }]));
    assert_eq!(ran["instances"][0]["modes"], json!(["far"]));

    let why = json!({ "uri": URI, "inputs": "right*30", "at": 12, "mode": "far" });
    let why = execute(&mut client, "hypedc.why", why).unwrap();
    assert_eq!(why["why"]["edges"][0]["place"]["line"], 6);

    let tested = execute(&mut client, "hypedc.test", json!({ "uri": URI, "coverage": true })).unwrap();
    assert_eq!((&tested["passed"], &tested["failed"]), (&json!(1), &json!(1)));
    assert_eq!(tested["tests"][1]["claims"][0]["place"]["line"], 31);
    assert_eq!(tested["tests"][1]["claims"][0]["parts"][0]["sides"], json!([0.0, 20.0]));
    assert_eq!(tested["coverage"]["modes"].as_array().unwrap().len(), 2);
    let one = json!({ "uri": URI, "tests": ["it goes"] });
    assert_eq!(execute(&mut client, "hypedc.test", one).unwrap()["filtered"], 1);

    let numbers = json!({ "uri": URI, "inputs": "right*30", "set": ["nothing=3"] });
    for (command, about, says) in [
        ("hypedc.reach", json!({ "uri": URI, "goals": ["nowhere"] }), "no goal `nowhere`"),
        ("hypedc.sim", json!({ "uri": URI, "inputs": "leap*3" }), "leap"),
        ("hypedc.sim", numbers, "nothing"),
        ("hypedc.sim", json!({ "uri": URI, "world": "Sea" }), "no world `Sea`"),
        ("hypedc.sim", json!({ "uri": URI, "input": "right" }), "unknown field `input`"),
        ("hypedc.sim", json!({ "inputs": "right" }), "`uri`"),
        ("hypedc.fly", json!({ "uri": URI }), "no command"),
    ] {
        let (_, why) = execute(&mut client, command, about).unwrap_err();
        assert!(why.contains(says), "{why}");
    }
    client.change(URI, json!([{ "text": "entity A { mode a { when true -> nowhere } }" }]));
    let (_, why) = execute(&mut client, "hypedc.sim", json!({ "uri": URI })).unwrap_err();
    assert!(why.starts_with("/game/a.hyped:1: no mode named `nowhere`"), "{why}");
    assert!(client.stop());
}

#[test]
fn a_search_can_be_without_a_button() {
    let text = "entity Hero {\n    button go\n    mode a {\n        when pressed(go) -> b\n    }\n    mode b { }\n}\n\n\
                world W {\n    step 1/60\n    space main {\n        place hero: Hero at (0, 0)\n    }\n    \
                player 1: hero\n    goal there: hero in b\n}\n";
    let mut client = open(text);
    let mut verdict = |without: Value| {
        let about = json!({ "uri": URI, "goals": ["there"], "without": without, "nodes": 500 });
        execute(&mut client, "hypedc.reach", about).map(|found| found["goals"][0]["verdict"].clone())
    };
    assert_eq!(verdict(Value::Null).unwrap(), "reached");
    assert_ne!(verdict(json!("held(go)")).unwrap(), "reached");
    let (_, why) = verdict(json!("held(leap)")).unwrap_err();
    assert!(why.contains("no player of `W` has a button `leap`"), "{why}");
    assert!(client.stop());
}

/// What a result says that does not depend on the time it took.
fn timeless(mut value: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                fields.retain(|key, _| !["seconds", "analysis_seconds", "filtered"].contains(&key.as_str()));
                fields.values_mut().for_each(strip);
            }
            Value::Array(all) => all.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut value);
    value
}

#[test]
fn results_are_those_of_the_command_line() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("lsp-commands");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("a.hyped");
    std::fs::write(&path, program(25)).unwrap();
    let path = path.to_str().unwrap();
    let uri = format!("file://{path}");
    let mut client = Client::start(&[], json!({}));
    client.open(&uri, &program(25));
    let run = "right*30";
    for (command, options, about) in [
        ("reach", vec!["--goal", "there", "--never", "back"], json!({ "goals": ["there"], "nevers": ["back"] })),
        ("reach", vec!["--goal", "hero.y > 3"], json!({ "goals": ["hero.y > 3"] })),
        ("reach", vec!["--without", "hero in far", "--seed", "3"], json!({ "without": "hero in far", "seed": 3 })),
        ("sim", vec!["--inputs", run], json!({ "inputs": run })),
        ("test", vec!["--no-ways", "--coverage"], json!({ "coverage": true })),
        ("why", vec!["--inputs", run, "--at", "12"], json!({ "inputs": run, "at": 12 })),
        (
            "why",
            vec!["--inputs", "-*9", "--mode", "far", "--not"],
            json!({ "inputs": "-*9", "mode": "far", "not": true }),
        ),
    ] {
        let mut all = about.as_object().unwrap().clone();
        all.insert("uri".into(), json!(uri));
        let by_server = execute(&mut client, &format!("hypedc.{command}"), Value::Object(all)).unwrap();
        let arguments = [vec![command, path, "--format", "json"], options].concat();
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_hypedc")).args(&arguments).output().unwrap();
        let by_command: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(timeless(by_server), timeless(by_command), "{arguments:?}");
    }
    assert!(client.stop());
}

#[test]
fn a_search_tells_its_progress_blocks_nothing_and_ends_when_it_is_cancelled() {
    for by_progress in [false, true] {
        let mut client = open(&hard());
        let about = json!({ "uri": URI, "nodes": 50_000_000 });
        let token = json!("mine");
        let params = json!({ "command": "hypedc.reach", "arguments": [about], "workDoneToken": token });
        let search = client.send("workspace/executeCommand", params);
        // Others are answered meanwhile, and edits are taken.
        client.change(URI, json!([{ "text": program(25) }]));
        let short = execute(&mut client, "hypedc.sim", json!({ "uri": URI, "inputs": "right*3" })).unwrap();
        assert_eq!(short["steps"], 3);
        let hover = json!({ "textDocument": { "uri": URI }, "position": { "line": 0, "character": 8 } });
        assert_ne!(client.request("textDocument/hover", hover).unwrap(), Value::Null);
        match by_progress {
            true => client.notify("window/workDoneProgress/cancel", json!({ "token": token })),
            false => {
                let id: Value = serde_json::to_value(&search).unwrap();
                client.notify("$/cancelRequest", json!({ "id": id }));
            }
        }
        assert_eq!(client.answer(&search).unwrap_err().0, -32800);
        let of_search: Vec<&Value> = client.progress.iter().filter(|told| told["token"] == token).collect();
        assert_eq!(of_search[0]["value"]["kind"], "begin");
        assert_eq!(of_search[0]["value"]["cancellable"], true);
        assert_eq!(of_search.last().unwrap()["value"]["kind"], "end");
        // That of the other command has a token of the server.
        assert!(client.progress.iter().any(|told| told["token"] != token));
        assert!(client.stop());
    }
}

#[test]
fn progress_is_told_in_numbers_that_grow() {
    let mut client = open(&hard());
    let params =
        json!({ "command": "hypedc.reach", "arguments": [{ "uri": URI, "nodes": 3_000 }], "workDoneToken": 7 });
    let found = client.request("workspace/executeCommand", params).unwrap();
    assert_eq!(found["goals"][0]["verdict"], "not-found", "the search takes all of its nodes");
    let reports = client.progress.iter().filter(|told| told["token"] == 7 && told["value"]["kind"] == "report");
    let numbers: Vec<u64> = reports.map(|told| told["value"]["percentage"].as_u64().unwrap()).collect();
    assert!(numbers.len() > 5 && numbers.is_sorted() && *numbers.last().unwrap() <= 100, "{numbers:?}");
    assert!(client.stop());
}

#[test]
fn a_server_that_ends_ends_its_searches() {
    let mut client = open(&hard());
    for _ in 0..5 {
        let about = json!({ "uri": URI, "nodes": 50_000_000 });
        client.send("workspace/executeCommand", json!({ "command": "hypedc.reach", "arguments": [about] }));
    }
    assert!(client.stop());
}

#[test]
fn what_can_be_run_is_listed() {
    let mut client =
        Client::start(&[("/game/b.hyped", "world Open {\n    space s {\n        map level t\n    }\n}\n")], json!({}));
    client.open(URI, &program(25));
    let all = client.request("hypedc/tests", json!({})).unwrap();
    let names = |of: &Value| -> Vec<String> {
        of.as_array().unwrap().iter().map(|named| named["name"].as_str().unwrap().to_string()).collect()
    };
    let a = &all[0]["worlds"][0];
    assert_eq!((&all[0]["uri"], &a["name"], &a["isOpen"]), (&json!(URI), &json!("Road"), &json!(false)));
    assert_eq!((names(&a["goals"]), names(&a["nevers"])), (vec!["there".to_string()], vec!["back".to_string()]));
    assert_eq!(names(&a["tests"]), ["it goes", "it flies"]);
    assert_eq!(a["tests"][0]["selectionRange"]["start"], json!({ "line": 24, "character": 10 }));
    assert_eq!(all[1]["worlds"][0]["isOpen"], true);
    let one = client.request("hypedc/tests", json!({ "textDocument": { "uri": URI } })).unwrap();
    assert_eq!(one, json!([all[0]]));
    assert!(client.stop());
}

#[test]
fn a_run_in_the_editor_lights_its_modes_and_becomes_a_test() {
    let mut client = open(&program(25));
    let ask = |client: &mut Client, what: Value| {
        let mut params = json!({ "session": 1, "uri": URI });
        params.as_object_mut().unwrap().extend(what.as_object().unwrap().clone());
        client.request("hypedc/play", params).unwrap()
    };
    let opened = ask(&mut client, json!({ "request": { "ask": "open", "world": "Road" } }));
    assert_eq!((&opened["answer"], &opened["scene"]["goals"]), (&json!("opened"), &json!(["there"])));
    ask(&mut client, json!({ "request": { "ask": "load", "script": "right*20" } }));
    let places = |lit: &Value| -> Vec<(String, u64)> {
        let modes = lit["modes"].as_array().unwrap().iter();
        modes.map(|of| (of["mode"].as_str().unwrap().to_string(), of["place"]["line"].as_u64().unwrap())).collect()
    };
    ask(&mut client, json!({ "request": { "ask": "seek", "frame": 5 } }));
    let lit = ask(&mut client, json!({ "lit": null }));
    assert_eq!((&lit["frame"], places(&lit)), (&json!(5), vec![("walking".to_string(), 4)]));
    assert_eq!(lit["edges"][0]["atoms"][0]["sides"], json!([4.0, 10.0]));
    ask(&mut client, json!({ "request": { "ask": "seek", "frame": 15 } }));
    assert_eq!(places(&ask(&mut client, json!({ "lit": null }))), [("far".to_string(), 8)]);
    // A new text is played with the same inputs.
    client.change(URI, json!([{ "text": program(25).replace("x > 10", "x > 17") }]));
    ask(&mut client, json!({ "request": { "ask": "reload" } }));
    assert_eq!(places(&ask(&mut client, json!({ "lit": null }))), [("walking".to_string(), 4)]);
    let script = ask(&mut client, json!({ "request": { "ask": "script" } }));
    assert_eq!(script["text"], "right*20");
    assert_eq!(ask(&mut client, json!({ "close": {} })), Value::Null);

    let record = |predicate: &str| json!({ "uri": URI, "test": "new", "inputs": "right*20", "predicate": predicate });
    let recorded = client.request("hypedc/record", record("hero.x > 15")).unwrap();
    let text = recorded["text"].as_str().unwrap();
    assert!(
        text.contains("test \"new\" {\n        inputs \"right*20\"\n        expect hero.x > 15 at end\n"),
        "{text}"
    );
    let (_, why) = client.request("hypedc/record", record("hero.x > 25")).unwrap_err();
    assert!(why.contains("does not pass"), "{why}");
    assert!(client.request("hypedc/page", Value::Null).unwrap().as_str().unwrap().starts_with("<!doctype html>"));
    assert!(client.stop());
}

//! What a list of completions begins with, and what it leaves out, as an editor sees it.

use serde_json::{Value, json};

use super::client::Client;
use super::session::{position, uri};

const RUNNER: &str = "entity Runner {
    param gravity = -400
    param hop_time = 0.4s
    param walk_speed = 60
    param dash_speed = 90

    axis way
    button jump, dash

    discrete facing: {left, right} = right
    discrete is_angry: bool = false

    collider body: rect(0, 0, 12, 24)

    condition grounded = touching(body, wall, below)

    group legs {
        mode walking {
            x' = walk_speed * way
            when pressed(jump) and grounded -> hopping
            when pressed(dash) -> dashing
            when touching(body, coin) as c { destroy c }
        }
        mode hopping {
            y'' = gravity
            when timer > hop_time -> walking
        }
        mode dashing {
            x' = if(facing == left, -dash_speed, dash_speed)
            when timer > hop_time -> walking { is_angry := true; facing := left }
        }
    }
    group mood {
        mode calm { when is_angry -> angry }
        mode angry { when not is_angry -> calm }
    }
}
world W {
    step 1/60
    collide body with wall: block
    collide body with coin: sense
    space s { place runner: Runner at (0, 0) }
    player 1: runner
}
";

/// The items where a part of the text is replaced by another, in which `|` is the cursor.
fn items(capabilities: &Value, old: &str, new: &str) -> Vec<Value> {
    let mut items = answer(capabilities, old, new, json!({ "triggerKind": 1 })).as_array().unwrap().clone();
    items.sort_by_key(|item| item["sortText"].as_str().unwrap().to_string());
    items
}

/// The answer to a request for them, with why they are asked for.
fn answer(capabilities: &Value, old: &str, new: &str, why: Value) -> Value {
    assert!(RUNNER.contains(old), "{old}");
    let mut client = Client::start(&[], capabilities.clone());
    client.open(&uri("a.hyped"), RUNNER);
    client.settle();
    let mut text = RUNNER.replacen(old, new, 1);
    let byte = text.find('|').unwrap();
    text.remove(byte);
    client.change(&uri("a.hyped"), json!([{ "text": text }]));
    let document = json!({ "uri": uri("a.hyped") });
    let params = json!({ "textDocument": document, "position": position(&text, byte), "context": why });
    let answer = client.request("textDocument/completion", params).unwrap();
    assert!(client.stop());
    answer
}

fn with_snippets() -> Value {
    json!({
        "textDocument": { "completion": { "completionItem": { "snippetSupport": true } } },
        "experimental": { "commands": { "commands": ["editor.action.triggerSuggest"] } },
    })
}

fn labels(old: &str, new: &str) -> Vec<String> {
    let items = items(&with_snippets(), old, new);
    items.iter().map(|item| item["label"].as_str().unwrap().to_string()).collect()
}

#[test]
fn speeds_are_first_where_a_speed_is_wanted() {
    let found = labels("x' = if(facing == left, -dash_speed, dash_speed)", "x' = |");
    let params: Vec<&String> = found
        .iter()
        .filter(|label| label.ends_with("_speed") || label.ends_with("_time") || *label == "gravity")
        .collect();
    assert_eq!(params, ["dash_speed", "walk_speed", "gravity", "hop_time"], "{found:?}");
    let found = labels("y'' = gravity", "y'' = |");
    assert_eq!(found.first().map(String::as_str), Some("gravity"), "{found:?}");
    let found = labels("timer > hop_time -> walking\n", "timer > |\n");
    assert_eq!(found.first().map(String::as_str), Some("hop_time"), "{found:?}");
}

#[test]
fn the_values_of_a_variable_are_first_after_it() {
    for (old, new) in [
        ("facing == left", "facing == |"),
        ("facing := left", "facing := |"),
        ("discrete facing: {left, right} = right", "discrete facing: {left, right} = |"),
    ] {
        let mut found = labels(old, new);
        found.truncate(2);
        found.sort();
        assert_eq!(found, ["left", "right"], "{new}");
    }
    let mut found = labels("is_angry := true", "is_angry := |");
    found.truncate(3);
    assert!(found.contains(&"true".into()) && found.contains(&"false".into()), "{found:?}");
}

#[test]
fn groups_are_offered_after_in() {
    let found = items(&with_snippets(), "when is_angry -> angry", "when in | -> angry");
    let group = |name: &str| found.iter().find(|item| item["label"] == name).unwrap()["textEdit"]["newText"].clone();
    assert_eq!((group("legs"), group("mood")), (json!("legs.$0"), json!("mood.$0")));
    let found = labels("when is_angry -> angry", "when in legs.| -> angry");
    let mut found: Vec<&str> = found.iter().map(String::as_str).collect();
    found.sort_unstable();
    assert_eq!(found, ["dashing", "hopping", "walking"]);
}

#[test]
fn an_accepted_call_opens_the_list_of_its_buttons() {
    let found = items(&with_snippets(), "when pressed(dash)", "when pre|");
    let item = found.iter().find(|item| item["label"] == "pressed").unwrap();
    assert_eq!(item["textEdit"]["newText"], "pressed($1)");
    assert_eq!(item["command"]["command"], "editor.action.triggerSuggest");
    let mut found = labels("when pressed(dash)", "when pressed(|)");
    found.truncate(2);
    found.sort();
    assert_eq!(found, ["dash", "jump"]);
}

#[test]
fn snippets_are_before_keywords_of_the_same_name() {
    for (old, new) in [("    button jump", "    |\n    button jump"), ("    step 1/60", "    |\n    step 1/60")] {
        let found = labels(old, new);
        let place = |label: &str| found.iter().position(|other| other == label);
        let snippets: Vec<&String> = found.iter().filter(|label| label.ends_with(" …")).collect();
        assert!(snippets.len() > 3, "{found:?}");
        for snippet in snippets {
            let keyword = snippet.split(' ').next().unwrap();
            assert!(place(keyword).is_none_or(|keyword| place(snippet).unwrap() < keyword), "{snippet}: {found:?}");
        }
    }
}

#[test]
fn an_editor_without_placeholders_gets_no_snippets() {
    let found = items(&json!({}), "    button jump", "    |\n    button jump");
    let is_snippet = |item: &&Value| item["label"].as_str().unwrap().ends_with('…');
    assert!(found.iter().any(|item| item["label"] == "mode") && !found.iter().any(|item| is_snippet(&item)));
}

#[test]
fn the_word_that_is_being_typed_is_not_offered() {
    for (old, new, typed) in [
        ("when pressed(dash)", "when gro| and pressed(dash)", "gro"),
        ("-> hopping", "-> hoppi|", "hoppi"),
        ("touching(body, coin)", "touching(body, coi|)", "coi"),
        ("collide body with coin", "collide body with coi|", "coi"),
    ] {
        let found = labels(old, new);
        assert!(!found.is_empty() && !found.contains(&typed.to_string()), "{new}: {found:?}");
    }
}

#[test]
fn what_an_edge_touches_is_offered_on_it() {
    let found = labels("{ destroy c }", "{ destroy | }");
    assert!(found.iter().take(2).any(|label| label == "c"), "{found:?}");
    let found = labels("as c { destroy c }", "as c and | { destroy c }");
    assert!(found.contains(&"c".into()), "{found:?}");
    let found = labels("when timer > hop_time -> walking\n", "when timer > |\n");
    assert!(!found.contains(&"c".into()), "{found:?}");
}

#[test]
fn modes_that_are_only_asked_for_are_offered_to_be_declared() {
    let found =
        labels("    group mood {", "    group mood {\n        mode wild { when in lost_mode -> calm }\n        mode |");
    assert_eq!(found, ["lost_mode"], "`calm` is declared");
}

#[test]
fn a_list_opens_by_itself_where_its_first_items_are_likely() {
    let typed = |old: &str, new: &str, by: &str| {
        let answer = answer(&with_snippets(), old, new, json!({ "triggerKind": 2, "triggerCharacter": by }));
        answer.as_array().map_or_else(|| answer.clone(), |items| json!(items.len() >= 2))
    };
    // After `when` nearly everything can follow: there is no list before the first letter, which asks again.
    let nothing = json!({ "isIncomplete": true, "items": [] });
    assert_eq!(typed("when timer > hop_time -> walking\n", "when |\n", " "), nothing);
    assert!(labels("when timer > hop_time -> walking\n", "when |\n").len() > 10, "who asks gets it");
    // A type, a button, a mode.
    assert_eq!(typed("discrete is_angry: bool = false", "discrete is_angry: |", " "), json!(true));
    assert_eq!(typed("pressed(dash)", "pressed(|)", "("), json!(true));
    assert_eq!(typed("-> dashing", "->|", ">"), json!(true));
    assert_eq!(typed("-> dashing", "-> |", " "), json!(true));
}

//! What helps while one writes: completion, signatures, colours, hints, what can be run.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::SLIME;
use super::client::Client;
use super::session::{Session, uri};

/// A text that stands in the middle of being written: `|` is the cursor.
fn completed(session: &mut Session, old: &str, new: &str) {
    completed_in(session, SLIME, old, new);
}

fn completed_in(session: &mut Session, whole: &str, old: &str, new: &str) {
    let mut text = whole.replacen(old, new, 1);
    let byte = text.find('|').unwrap();
    text.remove(byte);
    session.client.open(&uri("slime.hyped"), whole);
    session.client.settle();
    session.client.change(&uri("slime.hyped"), json!([{ "text": text }]));
    let params = json!({
        "textDocument": { "uri": uri("slime.hyped") },
        "position": super::session::position(&text, byte),
    });
    let items = session.client.request("textDocument/completion", params).unwrap();
    let mut shown: Vec<String> = Vec::new();
    for item in items.as_array().unwrap() {
        let detail = item["detail"].as_str().map(|d| format!(" ({d})")).unwrap_or_default();
        shown.push(format!("{}{}", item["label"].as_str().unwrap(), detail));
    }
    session.note(new.trim());
    session.write_lines(&shown);
}

#[test]
fn completion_knows_the_place() {
    let mut session = Session::new(&[]);
    for (old, new) in [
        ("-> air { y' := jump_speed }", "-> |"),
        ("-> air { y' := jump_speed }", "-> a|"),
        ("when pressed(jump)", "when pressed(|"),
        ("touching(body, wall, below)", "touching(|"),
        ("touching(body, wall, below)", "touching(body, wall, |"),
        ("{ y' := jump_speed }", "{ |"),
        ("facing == left,", "facing == |,"),
        ("hero.x > slime.x and hero in air", "hero.|"),
        ("hero.x > slime.x and hero in air", "hero in |"),
        ("hero.x > slime.x and hero in air", "near(|"),
        ("hero touching enemy", "hero touching |"),
        ("{ speed = 40 }", "{ |"),
        ("slime: Slime at", "slime: | at"),
        ("player 1: hero", "player 1: |"),
        ("collide body with enemy: sense", "collide body with enemy: |"),
        ("    goal over", "    |\n    goal over"),
        ("const floor_height", "|\nconst floor_height"),
        ("    button jump", "    |\n    button jump"),
        ("const floor_height = 16\n\nworld Room {", "entity Open {\n    mode on {\n\nworld Room {\n    |"),
        ("{ speed = 40 }", "{\n    }\n    |"),
        ("const floor_height = 16\n", "entity Open {\n|"),
        ("y' = 0\n", "y' = |\n"),
        ("// A slime", "// A |slime"),
        ("    goal over", "    look |\n    goal over"),
        ("    goal over", "    look enemy, |\n    goal over"),
        ("    goal over", "    look enemy: |\n    goal over"),
    ] {
        completed(&mut session, old, new);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn completion_knows_the_settings_of_tiles() {
    let text = "entity Pac { }
entity Ghost { param speed = 1; ref pac: Pac; discrete mood: {calm, angry} = calm }
world W {
    tiles t 1 x 1 { '.': empty; 'P': spawn Pac as pac; 'G': spawn Ghost as blinky { speed = 2 } }
    space r {
        map t \"
            P.G
        \"
    }
    space s { map tiled \"a.tmx\" { blob: spawn Ghost { mood = calm } } }
}
";
    let mut session = Session::new(&[]);
    for (old, new) in [
        ("{ speed = 2 }", "{ speed = 2; | }"),
        ("{ speed = 2 }", "{ pac = | }"),
        ("{ mood = calm }", "{ | }"),
        ("{ mood = calm }", "{ mood = | }"),
        ("'G': spawn Ghost", "'G': spawn |"),
    ] {
        completed_in(&mut session, text, old, new);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn conditions_are_offered_where_they_are_visible() {
    let text = "behavior B { condition calm = y < 3; mode q { when calm { y := 0 } } }
entity A {
    condition low = y < 3
    mode m {
        condition late = timer > 1s
        when late and low -> n
    }
    mode n { when low -> m }
}
world W { condition up = a.y > 3; goal g: up; space s { place a: A at (0, 0) } }
";
    let mut session = Session::new(&[]);
    for (old, new) in [
        ("when late and low -> n", "when |"),
        ("when low -> m", "when |"),
        ("goal g: up", "goal g: |"),
        ("when calm {", "when | {"),
        ("condition low = y < 3", "condition |"),
        ("condition low = y < 3", "condition low = y < 3 |"),
    ] {
        completed_in(&mut session, text, old, new);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn signals_are_offered_by_who_receives_them() {
    let text = "entity Ship {
    signal score(points)
    signal hit
    ref mine: Mine
    mode m {
        when received(score) and score.points > 2 { send mine.explode(3); send all Mine.calm; send self.hit }
    }
}
entity Mine { signal explode(size); signal calm }
";
    let mut session = Session::new(&[]);
    for (old, new) in [
        ("received(score)", "received(|)"),
        ("score.points > 2", "score.| > 2"),
        ("send mine.explode(3)", "send |"),
        ("send mine.explode(3)", "send mine.|"),
        ("send all Mine.calm", "send all |"),
        ("send all Mine.calm", "send all Mine.|"),
        ("send self.hit", "send self.|"),
        ("signal hit", "signal |"),
    ] {
        completed_in(&mut session, text, old, new);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn what_is_given_already_is_not_offered() {
    let text = "behavior Moves(speed, way, far) { x' = speed * way; clamp x <= far }
behavior Other(none_of_this) { y = none_of_this }
entity Ball { param heavy = 1; ref owner: any; discrete side: {near, far} = far }
entity A {
    use Moves(way = max(1, 2), speed = 3, far = 9)
    mode m { when timer > 1 { spawn Ball(x = 3, owner = self) } }
}
world W { limit Ball 2; space s { place a: A at (0, 0); place b: Ball at (0, 0) { heavy = 2 } } }
";
    let mut session = Session::new(&[]);
    for (old, new) in [
        ("way = max(1, 2), speed = 3, far = 9", "|"),
        ("speed = 3, far = 9", "|"),
        ("speed = 3,", "|,"),
        ("x = 3, owner = self", "x = 3, |"),
        ("heavy = 2 }", "| }"),
        ("{ heavy = 2 }", "{ heavy = 2; | }"),
        ("speed = 3", "speed = |"),
        ("heavy = 2", "owner = |"),
        ("owner = self", "owner = |"),
        ("heavy = 2", "side = |"),
        ("owner = self", "side = |"),
    ] {
        completed_in(&mut session, text, old, new);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn what_goes_on_with_a_statement_is_offered() {
    let text = "entity Coin { param worth = 5; collider coin: rect(0, 0, 8, 8) }
entity A {
    discrete hp: int 0..3 = 3
    continuous reach = 0
    axis way
    button go
    collider a: rect(0, 0, 4, 4)
    envelope reach by way { attack over 0.1s to 12; sustain 9 }
    clamp x <= 90
    group legs {
        mode still { when entering(hurt.yes) or pressed(go) -> walking }
        mode walking { when hp > 1 and touching(a, coin) as c and c is Coin and c.worth > 1 -> still }
    }
    group hurt { mode yes { }; mode no { } }
}
world W {
    collide a with coin: sense
    tiles t 4 x 4 { '.': empty; 'c': spawn Coin as first }
    space s { map t \"
        .c
        \"
        place hero: A at (0, 0)
        link rect(0, 0, 4, 4) -> s at rect(4, 0, 4, 4) when hero.hp > 0 }
    player 1: hero
    goal g: hero.x > 3 and hero in hurt.no
}
";
    let mut session = Session::new(&[]);
    for (old, new) in [
        ("-> walking", "-> |"),
        ("entering(hurt.yes)", "entering(|)"),
        ("hp > 1 and", "hp | and"),
        ("as c and c is", "| and c is"),
        ("-> walking", "-> walking |"),
        ("c.worth > 1", "c.|"),
        ("touching(a, coin)", "touching(a |)"),
        ("touching(a, coin)", "touching(a at (|"),
        ("touching(a, coin)", "touching(a at (4, 0), |"),
        ("reach by way", "|"),
        ("reach by way", "reach |"),
        ("reach by way", "reach by way |"),
        ("over 0.1s to 12", "over 0.1s |"),
        ("clamp x <= 90", "clamp |"),
        ("rect(0, 0, 4, 4)\n", "rect(0, 0, 4, 4) |\n"),
        ("a with coin", "a |"),
        ("tiles t 4 x 4", "tiles t 4 |"),
        ("spawn Coin as first", "spawn Coin |"),
        ("hero: A at", "hero: A |"),
        ("-> s at rect(4", "-> s |"),
        ("map t \"", "map t | \""),
        ("hero.x > 3 and hero in hurt.no", "hero |"),
        ("hero.x > 3 and hero in hurt.no", "hero in hurt.|"),
        ("hero.x > 3 and hero in hurt.no", "any A in |"),
        ("hero.x > 3 and hero in hurt.no", "hero.x > 3 |"),
        ("param worth = 5", "param worth = |"),
        ("player 1: hero", "player 1: hero |"),
    ] {
        completed_in(&mut session, text, old, new);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn programs_are_offered_to_be_imported() {
    let mut session = Session::new(&[("parts/coin.hyped", ""), ("other.hyped", ""), ("level.txt", "")]);
    for (file, text) in [("a.hyped", "import \"o|\"\n"), ("parts/b.hyped", "import \"|\n")] {
        let byte = text.find('|').unwrap();
        session.open(file, &text.replace('|', ""));
        session.client.settle();
        let position = super::session::position(text, byte);
        session.ask("textDocument/completion", file, json!({ "position": position }));
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn calls_show_what_they_take() {
    let mut session = Session::new(&[]);
    session.open("a.hyped", "behavior Moves(speed, way) { x' = speed }\nentity A { use Moves(way = 1, ; x' = max(1, min(2, 3)); mode m { when touching(a, b) { } } }\n");
    session.open("b.hyped", "entity Ball { param heavy = 1; ref owner: any }\nentity A { mode m { when timer > 1 { spawn Ball(owner = self, x = 3) } } }\n");
    for place in ["owner = |self", "x = |3"] {
        session.ask_at("textDocument/signatureHelp", "b.hyped", place, json!({}));
    }
    for place in ["(way = |1", "way = 1, |", "min(|2", "max(1,| ", "touching(|a", "touching(a, |b", "x' = |speed"] {
        session.ask_at("textDocument/signatureHelp", "a.hyped", place, json!({}));
    }
    insta::assert_snapshot!(session.end());
}

/// Tokens with their words.
fn tokens(text: &str, data: &Value, legend: &Value) -> Vec<String> {
    let numbers: Vec<usize> = data.as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as usize).collect();
    let lines: Vec<&str> = text.lines().collect();
    let (mut line, mut column) = (0, 0);
    let mut out = Vec::new();
    for token in numbers.chunks(5) {
        column = if token[0] == 0 { column + token[1] } else { token[1] };
        line += token[0];
        let units: Vec<u16> = lines[line].encode_utf16().skip(column).take(token[2]).collect();
        let word = String::from_utf16(&units).unwrap();
        let names: Vec<&str> =
            legend["tokenModifiers"].as_array().unwrap().iter().map(|m| m.as_str().unwrap()).collect();
        let of: Vec<&str> = (0..names.len()).filter(|at| token[4] >> at & 1 == 1).map(|at| names[at]).collect();
        let kind = legend["tokenTypes"][token[3]].as_str().unwrap();
        out.push(format!("{}:{column} {word}: {kind} {}", line + 1, of.join(" ")).trim_end().to_string());
    }
    out
}

#[test]
fn names_have_colours() {
    let text = "// \u{1f40a} one\nentity A {\n    param v = 2s\n    mode m { x' = max(v, 1); when timer > v -> n }\n    mode n { }\n}\nworld W { space s { map t \"\n    ..\n    \" } }\n";
    let mut session = Session::new(&[]);
    session.client.open(&uri("a.hyped"), text);
    let legend = session.client.capabilities["capabilities"]["semanticTokensProvider"]["legend"].clone();
    let document = json!({ "textDocument": { "uri": uri("a.hyped") } });
    let full = session.client.request("textDocument/semanticTokens/full", document.clone()).unwrap();
    session.write_lines(&tokens(text, &full["data"], &legend));
    session.open("a.hyped", &text.replace("max(v", "max(v + v"));
    let mut delta = document.clone();
    delta["previousResultId"] = full["resultId"].clone();
    session.ask_all("textDocument/semanticTokens/full/delta", delta);
    let mut range = document;
    range["range"] = json!({ "start": { "line": 2, "character": 0 }, "end": { "line": 3, "character": 0 } });
    session.ask_all("textDocument/semanticTokens/range", range);
    insta::assert_snapshot!(session.end());
}

#[test]
fn a_tag_has_one_colour_wherever_it_stands() {
    let text = "entity Hero {
    collider body, \"soft spot\": rect(0, 0, 8, 8)
    mode walk {
        when touching(body, wall) or touching(\"soft spot\", spike) -> fall
        when count(spike) > 0 and touching(body, coin) -> fall
    }
    mode fall { }
}
entity Coin {
    collider coin: rect(0, 0, 8, 8)
    mode lies { }
}
world W {
    collide body with wall: block
    collide \"soft spot\" with spike, coin: sense
    tiles Tiles 8 x 8 {
        '.': empty
        '#': wall
        '^': spike
    }
    space main {
        map Tiles \"
        ..
        ##
        \"
        place hero: Hero at (0, 0)
        place coin: Coin at (0, 0)
    }
    goal hurt: hero touching spike
}
";
    for grammar in [false, true] {
        let capabilities = json!({ "textDocument": { "semanticTokens": { "augmentsSyntaxTokens": grammar } } });
        let mut client = Client::start(&[], capabilities);
        client.open(&uri("a.hyped"), text);
        let legend = client.capabilities["capabilities"]["semanticTokensProvider"]["legend"].clone();
        let document = json!({ "textDocument": { "uri": uri("a.hyped") } });
        let full = client.request("textDocument/semanticTokens/full", document).unwrap();
        let mut kinds: BTreeMap<String, (usize, BTreeSet<String>)> = BTreeMap::new();
        for token in tokens(text, &full["data"], &legend) {
            let (word, kind) = token.split_once(' ').unwrap().1.rsplit_once(": ").unwrap();
            if kind.starts_with("label") {
                let role = kind.replace(" declaration", "");
                let (count, all) = kinds.entry(word.to_string()).or_default();
                *count += 1;
                all.insert(role);
            }
        }
        let shown: Vec<String> = kinds.iter().map(|(tag, (count, all))| format!("{tag} {count}: {all:?}")).collect();
        insta::assert_snapshot!("colours_of_tags", shown.join("\n"));
        assert!(kinds.values().all(|(_, all)| all.len() == 1), "{shown:?}");
        let different: BTreeSet<_> = kinds.values().map(|(_, all)| all).collect();
        assert_eq!(different.len(), kinds.len(), "{shown:?}");
    }
}

#[test]
fn an_editor_with_a_grammar_hears_of_names_alone() {
    let text = "// one\nentity A {\n    param v = 2\n    mode m { x' = max(v, 1) }\n}\n";
    let capabilities = json!({ "textDocument": { "semanticTokens": { "augmentsSyntaxTokens": true } } });
    let mut client = Client::start(&[], capabilities);
    client.open(&uri("a.hyped"), text);
    let legend = client.capabilities["capabilities"]["semanticTokensProvider"]["legend"].clone();
    let document = json!({ "textDocument": { "uri": uri("a.hyped") } });
    let full = client.request("textDocument/semanticTokens/full", document).unwrap();
    let shown = tokens(text, &full["data"], &legend);
    let words: Vec<&str> = shown.iter().map(|line| line.split_whitespace().nth(1).unwrap()).collect();
    assert_eq!(words, ["A:", "v:", "m:", "x:", "v:"], "{shown:?}");
}

#[test]
fn hints_stand_between_the_words() {
    let mut session = Session::new(&[]);
    // What a search finds may come before or after the lenses.
    session
        .client
        .notify("workspace/didChangeConfiguration", json!({ "settings": { "hypedc": { "verdicts": false } } }));
    session.open("slime.hyped", SLIME);
    session.client.settle();
    let whole = json!({ "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } } });
    session.ask("textDocument/inlayHint", "slime.hyped", whole);
    session.ask("textDocument/codeLens", "slime.hyped", json!({}));
    insta::assert_snapshot!(session.end());
}

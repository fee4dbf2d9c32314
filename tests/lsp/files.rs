//! Files of a folder: paths that follow renames, names that other files have; formatting while one types; hovers of
//! what is no name.

use hypedc::lsp::Settings;
use serde_json::json;

use super::client::Client;
use super::session::{Session, position, uri};

#[test]
fn paths_follow_renames() {
    let mut session = Session::new(&[
        ("parts/slime.hyped", "import \"base.hyped\"\nentity Slime { use Walk }\n"),
        ("parts/base.hyped", "behavior Walk { x' = 3 }\n"),
        ("levels/one.txt", "....\n####\n"),
    ]);
    session.open(
        "a.hyped",
        "import \"parts/slime.hyped\" // é\nworld W {\n    tiles t 16 x 16 { '.': empty; '#': wall }\n    \
         space s {\n        map t from \"levels/one.txt\"\n    }\n}\n",
    );
    let rename = |from: &str, to: &str| json!({ "files": [{ "oldUri": uri(from), "newUri": uri(to) }] });
    session.ask_all("workspace/willRenameFiles", rename("parts/slime.hyped", "slimes/green.hyped"));
    session.ask_all("workspace/willRenameFiles", rename("parts", "entities"));
    session.ask_all("workspace/willRenameFiles", rename("levels/one.txt", "levels/first.txt"));
    session.ask_all("workspace/willRenameFiles", rename("a.hyped", "games/a.hyped"));
    session.ask_all("workspace/willRenameFiles", rename("a.hyped", "b.hyped"));
    insta::assert_snapshot!(session.end());
}

#[test]
fn names_of_other_files_come_with_their_import() {
    let mut client = Client::start(&[("/game/parts/slime.hyped", "entity Slime { x' = 3 }\n")], json!({}));
    let text = "world W {\n    space s {\n        place a: Sl\n    }\n}\n";
    client.open(&uri("a.hyped"), text);
    client.settle();
    let at = position(text, text.find("Sl").unwrap() + 2);
    let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "position": at });
    let found = client.request("textDocument/completion", params).unwrap();
    let slime = found.as_array().unwrap().iter().find(|item| item["label"] == "Slime").unwrap();
    assert_eq!(slime["additionalTextEdits"][0]["newText"], "import \"parts/slime.hyped\"\n\n");
    let range = json!({ "start": at, "end": at });
    let text = text.replace("Sl\n", "Slime at (0, 0)\n");
    client.change(&uri("a.hyped"), json!([{ "text": text }]));
    let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "range": range, "context": { "diagnostics": [] } });
    let actions = client.request("textDocument/codeAction", params).unwrap();
    let titles: Vec<&str> =
        actions.as_array().unwrap().iter().map(|action| action["title"].as_str().unwrap()).collect();
    assert!(titles.contains(&"import `parts/slime.hyped`"), "{titles:?}");
    assert!(titles.contains(&"declare `entity Slime`"), "{titles:?}");
    assert!(client.stop());
}

#[test]
fn files_are_offered_in_quotes() {
    let files = [("/game/levels/one.txt", "..\n"), ("/game/levels/two.json", "{}"), ("/game/b.hyped", "")];
    let mut client = Client::start(&files, json!({}));
    for (line, expected) in [
        ("        map t from \"|\"", vec!["levels/one.txt"]),
        ("        map vglc \"levels/one.txt\" legend \"|\"", vec!["levels/two.json"]),
    ] {
        let text = format!("world W {{\n    space s {{\n{}\n    }}\n}}\n", line.replace('|', ""));
        client.open(&uri("a.hyped"), &text);
        let at = json!({ "line": 2, "character": line.find('|').unwrap() });
        let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "position": at });
        let found = client.request("textDocument/completion", params).unwrap();
        let labels: Vec<&str> = found.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap()).collect();
        assert_eq!(labels, expected);
    }
    assert!(client.stop());
}

#[test]
fn lines_are_formatted_while_one_types() {
    let mut session = Session::new(&[]);
    session.open("a.hyped", "entity A {\n  param v=1\n    \n    mode m {\n    y'=2 }\n}\n");
    let ask = |session: &mut Session, line: u32, character: u32, typed: &str| {
        let at = json!({ "line": line, "character": character });
        let options = json!({ "position": at, "ch": typed, "options": { "tabSize": 4, "insertSpaces": true } });
        session.ask("textDocument/onTypeFormatting", "a.hyped", options);
    };
    ask(&mut session, 2, 4, "\n");
    ask(&mut session, 4, 10, "}");
    session.open("a.hyped", "world W { space s { map t \"\n  ..\n  \n    \" } }\n");
    ask(&mut session, 2, 2, "\n");
    insta::assert_snapshot!(session.end());
}

#[test]
fn sides_units_and_tiles_have_hovers() {
    let text = "entity A {\n    collider body: rect(0, 0, 8, 8)\n    invariant y > -9\n    mode m { when touching(body, wall, below) and timer > 0.5s -> n }\n    \
        mode n { }\n}\nworld W {\n    tiles t 16 x 16 {\n        '.': empty\n        '#': wall // hard\n        'A': spawn A\n    }\n    space s {\n        map t \"\n            .A..\n            ..##\n        \"\n    }\n}\n";
    let mut session = Session::new(&[]);
    session.open("a.hyped", text);
    for place in ["wall, |below", "0|.5s", "|invariant", "'.': |empty", ".|A..", "..#|#", ".A.|."] {
        session.ask_at("textDocument/hover", "a.hyped", place, json!({}));
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn findings_of_files_that_are_not_open_are_shown_on_request() {
    let disk = super::client::Memory(
        [
            ("/game/bad.hyped".into(), "entity A { x' = sped }\n".to_string()),
            ("/game/good.hyped".into(), String::new()),
        ]
        .into(),
    );
    let options = json!({ "workspaceDiagnostics": true });
    let mut client = Client::start_with(std::sync::Arc::new(disk), json!({}), options, Settings::default());
    client.settle();
    assert_eq!(client.shown[&uri("bad.hyped")][0]["code"], "E0201");
    client.open(&uri("bad.hyped"), "entity A { x' = 3 }\n");
    client.settle();
    assert_eq!(client.shown[&uri("bad.hyped")], json!([]));
    client.close(&uri("bad.hyped"));
    client.settle();
    assert_eq!(client.shown[&uri("bad.hyped")][0]["code"], "E0201");
    assert_eq!(client.shown.get(&uri("good.hyped")), None);
    assert!(client.stop());
}

#[test]
fn findings_name_the_pages_of_their_codes_where_the_client_has_some() {
    let text = "entity A { mode a { when true -> nowhere } }\n";
    let files = || std::sync::Arc::new(super::client::Memory::default());
    let mut client = Client::start_with(files(), json!({}), json!(null), Settings::default());
    client.open(&uri("a.hyped"), text);
    client.settle();
    assert_eq!(client.shown[&uri("a.hyped")][0].get("codeDescription"), None);
    let page = client.request("hypedc/explain", json!({ "code": "E0201" })).unwrap();
    assert!(page["markdown"].as_str().unwrap().starts_with("# E0201: "), "{page}");
    let (_, why) = client.request("hypedc/explain", json!({ "code": "E9999" })).unwrap_err();
    assert!(why.contains("no code `E9999`"), "{why}");
    assert!(client.stop());

    let options = json!({ "explainUri": "https://example.org/codes/{code}.html" });
    let mut client = Client::start_with(files(), json!({}), options, Settings::default());
    client.open(&uri("a.hyped"), text);
    client.settle();
    let found = client.shown[&uri("a.hyped")][0].clone();
    assert_eq!(found["codeDescription"], json!({ "href": "https://example.org/codes/E0201.html" }));
    // The finding of a code action is the same one.
    let about = json!({
        "textDocument": { "uri": uri("a.hyped") },
        "range": found["range"],
        "context": { "diagnostics": [found] },
    });
    let actions = client.request("textDocument/codeAction", about).unwrap();
    assert_eq!(actions[0]["diagnostics"][0], found);
    assert!(client.stop());
}

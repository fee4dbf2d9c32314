//! The language server as an editor sees it: sessions over a connection in memory, recorded as snapshots; texts and
//! findings after any edits; requests at any place of broken texts.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod actions;
mod client;
mod commands;
mod current;
mod edits;
mod files;
mod levels;
mod memory;
mod names;
mod offered;
mod paint;
mod service;
mod session;
mod typing;
mod verdicts;
mod writing;

use serde_json::json;

use client::Client;
use session::Session;

const SLIME: &str = include_str!("lsp/slime.hyped");

#[test]
fn findings_come_while_one_types_and_go_when_they_are_mended() {
    let mut session = Session::new(&[]);
    session.open("a.hyped", "entity A {\n    mode up { when y > 3 -> dwn }\n    mode down { y' = -1 }\n}\n");
    session.show_findings();
    session.replace("a.hyped", "dwn", "down");
    session.show_findings();
    session.replace("a.hyped", "down }", "{");
    session.show_findings();
    session.close("a.hyped");
    session.show_findings();
    insta::assert_snapshot!(session.end());
}

#[test]
fn findings_of_imported_files_are_shown_there() {
    let mut session = Session::new(&[("parts/slime.hyped", "entity Slime { x' = sped }\n")]);
    session.open("a.hyped", "import \"parts/slime.hyped\"\n");
    session.show_findings();
    session.open("parts/slime.hyped", "entity Slime { x' = 3 }\n");
    session.show_findings();
    session.close("parts/slime.hyped");
    session.replace("a.hyped", "parts/slime", "none");
    session.show_findings();
    insta::assert_snapshot!(session.end());
}

#[test]
fn findings_come_again_when_the_text_around_them_changes() {
    let mut session = Session::new(&[]);
    session.open("bad.hyped", "entity A {\n    x' = sped\n}\n");
    session.open("good.hyped", "entity B {\n    x' = 3\n}\n");
    session.client.settle();
    let before = session.client.published.len();
    session.replace("good.hyped", "B", "C");
    session.client.settle();
    assert_eq!(session.client.published.len(), before);
    session.replace("bad.hyped", "A", "Angle");
    session.client.settle();
    assert_eq!(session.client.published.len(), before + 1);
}

#[test]
fn what_values_tell_is_shown() {
    let mut session = Session::new(&[]);
    session.open("slime.hyped", SLIME);
    session.show_findings();
    insta::assert_snapshot!(session.end());
}

/// The findings that came since the last time, one line for each time.
fn published(session: &mut Session) {
    let of = |found: &serde_json::Value| {
        let found = found.as_array().unwrap().iter();
        let places = found.map(|d| format!("{} in line {}", d["code"].as_str().unwrap(), d["range"]["start"]["line"]));
        places.collect::<Vec<_>>().join(", ")
    };
    let lines: Vec<String> = session.client.published.drain(..).map(|(_, found)| of(&found)).collect();
    session.write_lines(&lines);
}

#[test]
fn what_values_tell_stays_until_more_is_known() {
    let mut session = Session::new(&[]);
    session.open("slime.hyped", SLIME);
    session.client.settle();
    published(&mut session);
    for (old, new) in [
        ("/// Walks", "\n\n/// Walks"),
        ("param run = 60", "param run = 61"),
        ("y' < -300", "y' < -250"),
        ("const floor_height = 16", "const floor_height = "),
        ("const floor_height = ", "const floor_height = 16"),
    ] {
        session.replace("slime.hyped", old, new);
        session.client.settle();
        published(&mut session);
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn texts_are_formatted() {
    let mut session = Session::new(&[]);
    session.open("a.hyped", "entity A {\n  param v=1\n\n    x' = v\n  mode m{y'=2}\n}\n");
    session.ask("textDocument/formatting", "a.hyped", json!({ "options": { "tabSize": 4, "insertSpaces": true } }));
    let range = json!({ "start": { "line": 4, "character": 0 }, "end": { "line": 4, "character": 1 } });
    let options = json!({ "range": range, "options": { "tabSize": 4, "insertSpaces": true } });
    session.ask("textDocument/rangeFormatting", "a.hyped", options);
    session.open("b.hyped", "entity {");
    session.ask("textDocument/formatting", "b.hyped", json!({ "options": { "tabSize": 4, "insertSpaces": true } }));
    insta::assert_snapshot!(session.end());
}

#[test]
fn texts_have_a_shape() {
    let mut session = Session::new(&[]);
    session.open("slime.hyped", SLIME);
    session.ask("textDocument/documentSymbol", "slime.hyped", json!({}));
    session.ask("textDocument/foldingRange", "slime.hyped", json!({}));
    let at = session.place("slime.hyped", "speed|)");
    session.ask("textDocument/selectionRange", "slime.hyped", json!({ "positions": [at] }));
    insta::assert_snapshot!(session.end());
}

/// An outline, one line for each of its parts: name, detail, the word that is selected.
fn outline(symbols: &serde_json::Value, text: &str, depth: usize, out: &mut Vec<String>) {
    for symbol in symbols.as_array().into_iter().flatten() {
        let range = &symbol["selectionRange"];
        let (line, at) = (range["start"]["line"].as_u64().unwrap(), range["start"]["character"].as_u64().unwrap());
        let rest = &text.lines().nth(line as usize).unwrap()[at as usize..];
        let (name, detail) = (symbol["name"].as_str().unwrap(), symbol["detail"].as_str().unwrap_or_default());
        out.push(format!("{}{name} ({detail}) at {line}:{at} {rest:.12}", "    ".repeat(depth)));
        outline(&symbol["children"], text, depth + 1, out);
    }
}

#[test]
fn all_that_is_declared_is_in_the_outline() {
    let text = include_str!("lsp/outline.hyped");
    let mut session = Session::new(&[]);
    session.open("outline.hyped", text);
    let document = json!({ "textDocument": { "uri": session::uri("outline.hyped") } });
    let symbols = session.client.request("textDocument/documentSymbol", document).unwrap();
    let mut lines = Vec::new();
    outline(&symbols, text, 0, &mut lines);
    session.write_lines(&lines);
    insta::assert_snapshot!(session.end());
}

#[test]
fn fixes_are_offered() {
    let mut session = Session::new(&[]);
    session.open(
        "a.hyped",
        "entity A {\n    mode up { when y > 3 -> dwn }\n    mode down { x' = 3; when x = 2 -> up }\n}\n",
    );
    let start = session.place("a.hyped", "|dwn");
    let params = json!({ "range": { "start": start, "end": start }, "context": { "diagnostics": [] } });
    session.ask("textDocument/codeAction", "a.hyped", params);
    insta::assert_snapshot!(session.end());
}

#[test]
fn a_server_ends_in_order() {
    let mut client = Client::start(&[], json!({}));
    assert_eq!(client.capabilities["capabilities"]["positionEncoding"], "utf-16");
    assert_eq!(client.request("no/such", json!({})).unwrap_err().0, -32601);
    assert_eq!(client.request("textDocument/hover", json!(3)).unwrap_err().0, -32602);
    assert!(client.stop());
    let client = Client::start(&[], json!({ "general": { "positionEncodings": ["utf-8", "utf-16"] } }));
    assert_eq!(client.capabilities["capabilities"]["positionEncoding"], "utf-8");
}

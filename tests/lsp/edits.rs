//! Any edits, any requests: the server has the editor's text, shows what `check` finds in it, and answers all it is asked.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::time::Duration;

use hypedc::compile::{LevelFile, check_with};
use lsp_server::{Message, RequestId};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::SLIME;
use super::client::{Client, Memory};

const URI: &str = "file:///game/a.hyped";

/// What is written into texts: whole words of the language, and what breaks them.
const PIECES: &[&str] = &[
    "",
    " ",
    "\n",
    "\r\n",
    "\r",
    "}",
    "{",
    "(",
    ")",
    "\"",
    "'",
    "/",
    "//",
    "///",
    ".",
    "->",
    ":=",
    "=",
    "x'",
    "\u{1f40a}",
    "é",
    "mode m { }",
    "when y > 3 -> m",
    "entity E {\r\n    param p = 2\r\n}\r\n",
    "world",
    "held(jump)",
    "hero.",
    "touching",
    "import \"b.hyped\"\n",
    "behavior B(p) { x' = p }\n",
    "use B(p = 3)",
    "goal g: ",
    "\u{feff}",
    "\0",
];

const METHODS: &[&str] = &[
    "hover",
    "definition",
    "references",
    "documentHighlight",
    "prepareRename",
    "rename",
    "completion",
    "signatureHelp",
    "prepareCallHierarchy",
    "documentSymbol",
    "foldingRange",
    "selectionRange",
    "formatting",
    "rangeFormatting",
    "codeAction",
    "codeLens",
    "documentLink",
    "inlayHint",
    "semanticTokens/full",
    "semanticTokens/range",
];

/// A change: what is taken away, by fractions of the text, and what comes there; without a place: of all.
type Edit = (Option<(f64, f64)>, usize);

/// The text as an editor keeps it: UTF-16 code units.
fn units(text: &str) -> Vec<u16> {
    text.encode_utf16().collect()
}

/// Where each line begins and where its text ends, in code units.
fn lines(units: &[u16]) -> Vec<(usize, usize)> {
    let (mut out, mut start, mut at) = (Vec::new(), 0, 0);
    while at < units.len() {
        let length = match (units[at], units.get(at + 1)) {
            (13, Some(10)) => 2,
            (13 | 10, _) => 1,
            _ => 0,
        };
        if length > 0 {
            out.push((start, at));
            start = at + length;
        }
        at += length.max(1);
    }
    out.push((start, units.len()));
    out
}

fn position(units: &[u16], at: usize) -> Value {
    let lines = lines(units);
    let line = lines.iter().rposition(|(start, _)| *start <= at).unwrap();
    json!({ "line": line, "character": at - lines[line].0 })
}

/// The nearest place to a fraction of a text that is not inside of a character, nor of a line end.
fn place(units: &[u16], fraction: f64) -> usize {
    let mut at = (units.len() as f64 * fraction) as usize;
    let inside = |at: usize| {
        at > 0
            && at < units.len()
            && ((0xdc00..0xe000).contains(&units[at]) || (units[at - 1] == 13 && units[at] == 10))
    };
    while inside(at) {
        at -= 1;
    }
    at
}

fn edit(text: &mut Vec<u16>, (at, piece): &Edit) -> Value {
    let new = PIECES[*piece % PIECES.len()];
    let Some((a, b)) = at else {
        *text = units(SLIME);
        return json!({ "text": SLIME });
    };
    // Most changes are small.
    let (a, b) = (*a, a + (b - a) * 0.02);
    let (a, b) = (place(text, a.min(b).max(0.0)), place(text, a.max(b).min(1.0)));
    let range = json!({ "start": position(text, a), "end": position(text, b) });
    text.splice(a..b, units(new));
    json!({ "range": range, "text": new })
}

/// What `check` finds in a file: code, first line, and where it begins.
fn checked(text: &str) -> BTreeSet<(String, String, u64, u64)> {
    let disk = Memory(BTreeMap::from([(PathBuf::from("/game/a.hyped"), text.to_string())]));
    let found = check_with(Path::new("/game/a.hyped"), LevelFile::default(), &disk);
    let of = |d: &hypedc::diagnostic::Diagnostic| {
        let file = found.sources.iter().next().unwrap().1;
        let at = d.primary.as_ref().map_or((1, 1), |l| file.line_column_utf16(l.span.range().start));
        // A byte order mark is a column of the editor's, and none of the compiler's.
        let mark = usize::from(text.starts_with('\u{feff}') && at.0 == 1 && d.primary.is_some());
        (d.code.text().to_string(), d.message.clone(), at.0 as u64 - 1, (at.1 - 1 + mark) as u64)
    };
    found.diagnostics.iter().map(of).collect()
}

fn shown(client: &Client) -> BTreeSet<(String, String, u64, u64)> {
    let found = client.shown.get(URI).and_then(Value::as_array).cloned().unwrap_or_default();
    let of = |d: &Value| {
        let first = d["message"].as_str().unwrap().lines().next().unwrap_or_default().to_string();
        let start = &d["range"]["start"];
        let number = |key: &str| start[key].as_u64().unwrap();
        (d["code"].as_str().unwrap().to_string(), first, number("line"), number("character"))
    };
    found.iter().map(of).collect()
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let place = prop_oneof![1 => Just(None), 30 => (0.0..1.0, 0.0..1.0).prop_map(Some)];
    prop::collection::vec((place, 0..PIECES.len()), 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_server_has_the_editors_text_and_finds_what_check_finds(edits in edits()) {
        let mut client = Client::start(&[], json!({}));
        let mut text = units(SLIME);
        client.open(URI, SLIME);
        for some in edits.chunks(3) {
            let changes: Vec<Value> = some.iter().map(|e| edit(&mut text, e)).collect();
            client.change(URI, json!(changes));
            let now = String::from_utf16(&text).unwrap();
            let had = client.request("hypedc/text", json!({ "textDocument": { "uri": URI } })).unwrap();
            prop_assert_eq!(had.as_str().unwrap(), &now);
            client.settle();
            prop_assert_eq!(shown(&client), checked(&now));
        }
        prop_assert!(client.stop());
    }

    #[test]
    fn requests_anywhere_in_broken_texts_are_answered(
        edits in edits(),
        asked in prop::collection::vec((0..METHODS.len(), 0.0..1.1, 0.0..1.1, 0..4usize), 1..40),
    ) {
        let mut client = Client::start(&[("/game/b.hyped", "entity Other { }\n")], json!({}));
        let mut text = units(SLIME);
        client.open(URI, SLIME);
        for e in &edits {
            let change = edit(&mut text, e);
            client.change(URI, json!([change]));
        }
        for (method, a, b, which) in asked {
            // Lines and columns that are not there, too; and documents that are not open.
            let at = |f: f64| match which {
                0 => json!({ "line": (f * 99.0) as u32, "character": (f * 999.0) as u32 }),
                _ => position(&text, place(&text, f.min(1.0))),
            };
            let uri = if which == 1 && a > 1.0 { "file:///game/none.hyped" } else { URI };
            let params = json!({
                "textDocument": { "uri": uri }, "position": at(a), "positions": [at(a), at(b)],
                "range": { "start": at(a), "end": at(b) }, "newName": "other",
                "options": { "tabSize": 4, "insertSpaces": true },
                "context": { "includeDeclaration": true, "diagnostics": [], "triggerKind": 1, "isRetrigger": false },
            });
            let answer = client.request(&format!("textDocument/{}", METHODS[method]), params);
            if let Err((code, message)) = answer {
                prop_assert_eq!((METHODS[method], code), (METHODS[method], -32803), "{}", message);
            }
        }
        prop_assert!(client.stop());
    }
}

#[test]
fn a_request_that_waits_can_be_cancelled_and_closed_documents_are_no_harm() {
    let mut client = Client::start(&[], json!({}));
    client.open(URI, SLIME);
    client.close(URI);
    client.change(URI, json!([{ "text": "entity A { }" }]));
    client.settle();
    let params = json!({ "textDocument": { "uri": URI }, "position": { "line": 3, "character": 3 } });
    assert_eq!(client.request("textDocument/hover", params.clone()).unwrap(), Value::Null);
    client.open(URI, SLIME);
    // Cancelled too late, and never sent.
    let id = client.send("textDocument/hover", params);
    assert!(client.answer(&id).is_ok());
    client.notify("$/cancelRequest", json!({ "id": 5 }));
    client.notify("$/cancelRequest", json!({ "id": 5_000 }));
    assert!(client.stop());
}

/// A client that writes faster than the server answers.
#[test]
fn what_is_cancelled_or_void_before_it_is_begun_is_given_up() {
    let text: String = (0..300).map(|number| SLIME.replace("entity Slime", &format!("entity Slime{number}"))).collect();
    let mut client = Client::start(&[], json!({}));
    client.open(URI, &text);
    let params = json!({ "textDocument": { "uri": URI } });
    let start = json!({ "line": 0, "character": 0 });
    let mut asked = Vec::new();
    for _ in 0..30 {
        client.change(URI, json!([{ "range": { "start": start, "end": start }, "text": "// a\n" }]));
        let outline = client.send("textDocument/documentSymbol", params.clone());
        let folds = client.send("textDocument/foldingRange", params.clone());
        client.notify("$/cancelRequest", json!({ "id": folds }));
        asked.push((outline, folds));
    }
    let mut codes: HashMap<RequestId, i32> = HashMap::new();
    while codes.len() < 2 * asked.len() {
        if let Message::Response(response) = client.receive(Duration::from_secs(120)).unwrap() {
            codes.insert(response.id, response.response_result.err().map_or(0, |error| error.code));
        }
    }
    let answers: Vec<[i32; 2]> = asked.iter().map(|(outline, folds)| [codes[outline], codes[folds]]).collect();
    // The outline of a text that has changed since is not made; a request that is cancelled as it waits is not begun.
    assert!(answers.iter().any(|[outline, _]| *outline == -32801), "{answers:?}");
    assert!(answers.iter().any(|[_, folds]| *folds == -32800), "{answers:?}");
    let allowed = |[outline, folds]: &[i32; 2]| [0, -32801].contains(outline) && [0, -32800, -32801].contains(folds);
    assert!(answers.iter().all(allowed), "{answers:?}");
    assert_eq!(answers.last().unwrap()[0], 0, "the last outline is of the text as it is");
    assert!(client.stop());
}

#[test]
fn a_failure_of_the_compiler_is_told_and_loses_nothing() {
    let mut client = Client::start(&[], json!({}));
    let broken = "entity A { mode a { when true -> nowhere } }";
    client.open(URI, broken);
    client.settle();
    let before = client.shown[URI].clone();
    assert!(!before.as_array().unwrap().is_empty());
    // The import cannot be read without a panic.
    let fails = "import \"fails.hyped\"\n";
    for letter in ["", "//"] {
        client.change(URI, json!([{ "text": format!("{fails}{letter}{broken}") }]));
        client.settle();
        assert_eq!(client.shown[URI], before, "what was shown stays");
    }
    let of = |method: &str| client.messages.iter().filter(|(how, _)| how == method).count();
    assert_eq!((of("window/showMessage"), of("window/logMessage")), (1, 2), "{:?}", client.messages);
    assert!(client.messages[0].1.contains("this file makes the compiler fail"), "{:?}", client.messages);
    client.change(URI, json!([{ "text": "entity A { }" }]));
    client.settle();
    assert_eq!(client.shown[URI], json!([]), "it goes on");
    assert!(client.stop());
}

#[test]
fn while_the_compiler_fails_places_are_the_same_lines_and_columns_of_the_text_before() {
    let mut client = Client::start(&[], json!({}));
    client.open(URI, "entity Pear { }\nentity Apple { }\n");
    client.settle();
    client.change(URI, json!([{ "text": "import \"fails.hyped\" // é\nentity Apple { }\n" }]));
    client.settle();
    for (character, range) in [(7, true), (12, true), (13, false), (99, false)] {
        let at = json!({ "line": 1, "character": character });
        let params = json!({ "textDocument": { "uri": URI }, "position": at });
        let renamed = client.request("textDocument/prepareRename", params).unwrap();
        let (start, end) = (json!({ "line": 1, "character": 7 }), json!({ "line": 1, "character": 12 }));
        let name = json!({ "range": { "start": start, "end": end }, "placeholder": "Apple" });
        assert_eq!(renamed, if range { name } else { Value::Null }, "column {character}");
    }
    assert!(client.stop());
}

//! Code actions as an editor applies them: each way to mend a finding mends it, and adds no error; each refactoring
//! keeps what the program does.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use hypedc::compile::{Compilation, LevelFile, check_with};
use hypedc::diagnostic::page::{Example, Page, Side};
use hypedc::diagnostic::{Code, Severity};
use hypedc::ir::WorldId;
use hypedc::sim::{Simulator, TraceFormat, TraceLines};
use hypedc::source::FileId;
use hypedc::syntax::parse;
use serde_json::{Value, json};

use super::client::{Client, Memory};
use super::session::{position, uri};

/// The files of an editor's folder.
type Files = BTreeMap<String, String>;

const PROGRAM: &str = "program.hyped";

fn capabilities() -> Value {
    json!({ "workspace": { "workspaceEdit": { "resourceOperations": ["create"] } } })
}

fn start(files: &Files) -> Client {
    let named: Vec<(String, &String)> = files.iter().map(|(file, text)| (format!("/game/{file}"), text)).collect();
    let on_disk: Vec<(&str, &str)> = named.iter().map(|(file, text)| (file.as_str(), text.as_str())).collect();
    let mut client = Client::start(&on_disk, capabilities());
    client.open(&uri(PROGRAM), &files[PROGRAM]);
    client.settle();
    client
}

/// The byte of a position.
fn byte(text: &str, at: &Value) -> usize {
    let line: usize = text.split_inclusive('\n').take(at["line"].as_u64().unwrap() as usize).map(str::len).sum();
    let rest = text.get(line..).unwrap_or_default();
    let units = at["character"].as_u64().unwrap() as usize;
    let column: usize =
        rest.chars().scan(0, |seen, c| (*seen < units).then(|| (*seen += c.len_utf16(), c.len_utf8()).1)).sum();
    line + column
}

fn edited(text: &str, edits: &[Value]) -> String {
    let mut edits: Vec<(usize, usize, &str)> = edits
        .iter()
        .map(|e| (byte(text, &e["range"]["start"]), byte(text, &e["range"]["end"]), e["newText"].as_str().unwrap()))
        .collect();
    edits.sort();
    edits.iter().rev().fold(text.to_string(), |mut text, (start, end, new)| {
        text.replace_range(start..end, new);
        text
    })
}

/// The files after an action.
fn applied(files: &Files, action: &Value) -> Files {
    let mut files = files.clone();
    let edit = &action["edit"];
    let name = |uri: &Value| uri.as_str().unwrap().strip_prefix("file:///game/").unwrap().to_string();
    for (uri, edits) in edit["changes"].as_object().into_iter().flatten() {
        let file = name(&json!(uri));
        let new = edited(&files[&file], edits.as_array().unwrap());
        files.insert(file, new);
    }
    for change in edit["documentChanges"].as_array().into_iter().flatten() {
        if change["kind"] == "create" {
            assert!(files.insert(name(&change["uri"]), String::new()).is_none(), "a file is overwritten");
            continue;
        }
        let file = name(&change["textDocument"]["uri"]);
        let new = edited(&files[&file], change["edits"].as_array().unwrap());
        files.insert(file, new);
    }
    files
}

fn actions(client: &mut Client, range: &Value) -> Vec<Value> {
    let params = json!({
        "textDocument": { "uri": uri(PROGRAM) }, "range": range, "context": { "diagnostics": [] },
    });
    client.request("textDocument/codeAction", params).unwrap().as_array().unwrap().clone()
}

fn checked(files: &Files) -> Compilation {
    let disk = files.iter().map(|(file, text)| (PathBuf::from(format!("/game/{file}")), text.clone())).collect();
    check_with(&Path::new("/game").join(PROGRAM), LevelFile::default(), &Memory(disk))
}

/// The number of errors, and of findings of a code with a message.
fn counts(found: &Compilation, code: &str, message: &str) -> (usize, usize) {
    let errors = found.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    (errors, found.diagnostics.iter().filter(|d| d.code.text() == code && d.message == message).count())
}

/// The lines that differ.
fn changes(before: &Files, after: &Files) -> Vec<String> {
    let mut out = Vec::new();
    for (file, new) in after {
        let old: Vec<&str> = before.get(file).map_or(Vec::new(), |text| text.lines().collect());
        let new: Vec<&str> = new.lines().collect();
        let same = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
        let rest = old.len().min(new.len()) - same;
        let tail = old.iter().rev().zip(new.iter().rev()).take(rest).take_while(|(a, b)| a == b).count();
        if old != new && file != PROGRAM {
            out.push(format!("  in {file}"));
        }
        out.extend(old[same..old.len() - tail].iter().map(|line| format!("  - {line}").trim_end().to_string()));
        out.extend(new[same..new.len() - tail].iter().map(|line| format!("  + {line}").trim_end().to_string()));
    }
    out
}

/// Applies each way to mend the findings of a program; adds the codes that have one, and writes down the changes.
fn mend(files: &Files, mended: &mut BTreeSet<String>, log: &mut String) {
    let before = checked(files);
    let mut client = start(files);
    let found = client.shown.get(&uri(PROGRAM)).and_then(Value::as_array).cloned().unwrap_or_default();
    let mut seen = BTreeSet::new();
    for finding in &found {
        let code = finding["code"].as_str().unwrap();
        let message = finding["message"].as_str().unwrap().lines().next().unwrap().to_string();
        for action in actions(&mut client, &finding["range"]) {
            let title = action["title"].as_str().unwrap();
            let of = &action["diagnostics"][0];
            let is_own = of["code"] == finding["code"] && of["range"] == finding["range"];
            if action["kind"] != "quickfix" || !is_own || !seen.insert((finding.to_string(), title.to_string())) {
                continue;
            }
            let after = applied(files, &action);
            let again = checked(&after);
            let (errors, count) = counts(&before, code, &message);
            let (errors_after, left) = counts(&again, code, &message);
            let shown = changes(files, &after).join("\n");
            assert!(errors_after <= errors, "{code}: {title} adds an error\n{shown}\n{:?}", again.diagnostics);
            assert!(left < count, "{code}: {title} does not mend\n{shown}\n{:?}", again.diagnostics);
            let broken = |text: &str| parse(FileId(0), text).1.counts().0;
            assert!(broken(&after[PROGRAM]) <= broken(&files[PROGRAM]), "{code}: {title} breaks the text\n{shown}");
            log.push_str(&format!("{code}: {title}\n{shown}\n"));
            mended.insert(code.to_string());
        }
    }
    assert!(client.stop());
}

/// The text of an example.
fn text(example: &Example<'_>) -> Option<String> {
    let mut text = example.lines.join("\n") + "\n";
    for dots in example.settings("dots") {
        text = text.replacen('…', &dots.repeat(example.setting("times")?.parse().ok()?), 1);
    }
    example.setting("encoding").is_none().then_some(text)
}

#[test]
fn each_way_to_mend_a_finding_mends_it() {
    let (mut mended, mut log) = (BTreeSet::new(), String::new());
    for code in Code::ALL {
        let page = Page::of(*code);
        let mut files = Files::new();
        for example in page.examples().filter(|e| e.side.is_none_or(|s| s == Side::Wrong) && e.language != "sh") {
            let Some(text) = text(example) else { continue };
            files.insert(example.setting("file").unwrap_or(PROGRAM).to_string(), text);
        }
        if files.get(PROGRAM).is_some_and(|text| text.len() < 20_000) {
            mend(&files, &mut mended, &mut log);
        }
    }
    let world = |space: &str, more: &str| {
        format!(
            "entity Hero {{\n    button jump\n    collider body: rect(0, 0, 8, 8)\n    y'' = -300\n}}\n\nworld Room {{\n    \
             space main {{\n{space}    }}\n{more}}}\n"
        )
    };
    for text in [
        "entity Hero {\n    button jump\n    mode a { when pressed(jmp) and fast -> b { y' := lift } }\n}\n".to_string(),
        "entity Hero {\n    discrete keys: int = 0\n    mode a { when keys > 3 and received(hit) -> a { keys := 0 } }\n}\n".into(),
        "entity Hero {\n    envelope x' by walk {\n        attack accel 300\n        sustain 60\n        release accel 600\n    }\n}\n".into(),
        "entity Hero {\n    use Fall\n    x' = clamp(x)\n    collider body: rect(0, 0, -8, 8)\n}\n".into(),
        "behavior Fall(pull) { y'' = pull }\nentity Hero {\n    use Fall\n}\n".into(),
        world("        place hero: Her at (0, 0)\n        place foe: Slime at (9, 9)\n", "    player 1: hero\n"),
        world("", "    player 1: hero\n    goal right: hero.x > 9\n"),
        world("        map cave \"\n            ##\n        \"\n", ""),
        world("        place hero: Hero at (0, 0)\n        link rect(0, 0, 8, 8) -> attic at rect(0, 0, 8, 8)\n", "    player 1: hero\n    player 1: hero\n"),
    ] {
        log.push_str("---\n");
        mend(&Files::from([(PROGRAM.into(), text)]), &mut mended, &mut log);
    }
    insta::assert_snapshot!(log);
    assert!(mended.len() >= 35, "{} codes: {mended:?}", mended.len());
}

/// The trace of a run of the first world.
fn trace(files: &Files, inputs: &str) -> Vec<String> {
    let compiled = checked(files);
    let program = compiled.program.unwrap_or_else(|| panic!("{:?}", compiled.diagnostics));
    let mut lines = Vec::new();
    let script = crate::support::script(&program, inputs);
    let sim = Simulator::new(&program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let shown = TraceLines::new(&sim, TraceFormat::Csv);
    for (step, input) in script.inputs().take(240).enumerate() {
        if sim.step(&mut state, input, &mut scratch).is_err() {
            break;
        }
        lines.push(shown.state(step as u64, input, &state).unwrap());
    }
    lines
}

/// The refactorings at a range.
fn refactorings(client: &mut Client, range: &Value) -> Vec<Value> {
    let all = actions(client, range);
    all.into_iter().filter(|action| action["kind"].as_str().unwrap().starts_with("refactor")).collect()
}

/// A program in which `«…»` is selected, or `|` is the cursor; gives it without the marks, and the range.
fn marked(text: &str) -> (String, Value) {
    let start = text.find(['«', '|']).unwrap();
    let plain = text.replace(['«', '»', '|'], "");
    let end = text.find('»').map_or(start, |end| end - '«'.len_utf8());
    (plain.clone(), json!({ "start": position(&plain, start), "end": position(&plain, end) }))
}

#[test]
fn refactorings_keep_the_program() {
    let world = "world Room {\n    space main {\n        place hero: Hero at (0, 40)\n    }\n    player 1: hero\n}\n";
    let entity = |body: &str| format!("entity Hero {{\n    button jump\n\n{body}}}\n\n{world}");
    let edges = "    mode a {\n        when timer > 20frames and not held(jump) or y < 3 -> b\n        else { y' := 4 }\n    }\n    mode b { }\n";
    let mut log = String::new();
    for text in [
        entity("    mode a { y'' = -|400 }\n"),
        entity("    param pull = 4\n    mode a { y'' = «-400 * pull» }\n"),
        entity("    mode a { y'' = -400; when |y < 20 and held(jump) -> b }\n    mode b { y'' = 9 }\n"),
        entity("    mode a { y'' = -400; when timer > 1s and «y < 20 and y > 3» -> b }\n    mode b { y'' = 9 }\n"),
        entity("    «x' = 30\n    y'' = -400»\n    mode a { when held(jump) -> b }\n    mode b { x' = 3 }\n"),
        format!("const pull = 3 + 4\n\n{}", entity("    mode a { y'' = -pull| * 3; x'' = pull }\n")),
        entity("    condition |low = y < 20 or y > 90\n    mode a { y'' = -400; when low and timer > 3frames -> b }\n    mode b { y'' = 9 }\n"),
        entity(&edges.replace("when timer", "when |timer")),
        entity("    mode a { y'' = -400; when |not (y > 20 and timer > 1s) -> b }\n    mode b { x' = if(y |> 3, 20, 30) }\n".replacen("y |>", "y >", 1).as_str()),
        entity("    mode a { x' = |if(y > 3 and timer < 1s, 20, 30) }\n"),
        format!("{}{}", entity("    mode a { }\n"), "entity Big|Slime {\n    // slow\n    x' = 3\n}\n"),
    ] {
        let (plain, range) = marked(&text);
        let files = Files::from([(PROGRAM.to_string(), plain)]);
        let mut client = start(&files);
        for action in refactorings(&mut client, &range) {
            let after = applied(&files, &action);
            let title = action["title"].as_str().unwrap();
            for inputs in ["-*120", "jump*3 -*30 jump*40 -*40"] {
                assert_eq!(trace(&files, inputs), trace(&after, inputs), "{title}\n{}", after[PROGRAM]);
            }
            log.push_str(&format!("{}: {title}\n{}\n", action["kind"].as_str().unwrap(), changes(&files, &after).join("\n")));
        }
        assert!(client.stop());
    }
    insta::assert_snapshot!(log);
}

#[test]
fn refactorings_anywhere_in_examples_keep_their_runs() {
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    for (name, every) in [("flappy", 7), ("pong", 17), ("cavern", 83), ("frog", 53), ("mario", 131)] {
        let text = std::fs::read_to_string(format!("examples/{name}.hyped")).unwrap();
        let inputs = std::fs::read_to_string(format!("examples/inputs/{name}.inputs")).unwrap_or("-*60".into());
        let files = Files::from([(PROGRAM.to_string(), text.clone())]);
        let before = trace(&files, &inputs);
        let mut client = start(&files);
        let starts: Vec<usize> = text.match_indices(char::is_whitespace).map(|(at, _)| at + 1).collect();
        for at in starts.into_iter().step_by(every).filter(|at| text.is_char_boundary(*at)) {
            let place = position(&text, at.min(text.len()));
            for action in refactorings(&mut client, &json!({ "start": place, "end": place })) {
                let after = applied(&files, &action);
                assert_eq!(trace(&after, &inputs), before, "{name}: {}\n{}", action["title"], after[PROGRAM]);
                *kinds.entry(action["title"].as_str().unwrap().split('`').next().unwrap().to_string()).or_default() +=
                    1;
            }
        }
        assert!(client.stop());
    }
    assert!(kinds.len() >= 3 && kinds.values().sum::<usize>() >= 10, "{kinds:?}");
}

#[test]
fn an_editor_that_resolves_actions_gets_the_edits_of_large_programs_later() {
    let text =
        format!("entity Hero {{\n    mode a {{ y'' = -400 }}\n}}\n{}", "// a line of a long text\n".repeat(4_000));
    let capabilities = json!({ "textDocument": { "codeAction": { "resolveSupport": { "properties": ["edit"] } } } });
    let mut client = Client::start(&[], capabilities);
    client.open(&uri(PROGRAM), &text);
    let at = position(&text, text.find("400").unwrap());
    let listed = refactorings(&mut client, &json!({ "start": at, "end": at }));
    let constant = listed.iter().find(|action| action["title"] == "extract a constant").unwrap();
    assert_eq!(constant["edit"], Value::Null);
    let resolved = client.request("codeAction/resolve", constant.clone()).unwrap();
    let after = applied(&Files::from([(PROGRAM.to_string(), text)]), &resolved);
    assert!(
        after[PROGRAM].starts_with("const new_constant = 400\n\nentity Hero {\n    mode a { y'' = -new_constant }\n")
    );
    client.change(&uri(PROGRAM), json!([{ "text": "entity A { }\n" }]));
    assert_eq!(client.request("codeAction/resolve", constant.clone()).unwrap_err().0, -32803);
    assert!(client.stop());
}

#[test]
fn a_condition_is_extracted_from_any_part_of_a_conjunction_and_from_nothing_that_means_more() {
    let text = |guard: &str| {
        let entity =
            format!("entity A {{\n    initial mode a {{\n        when {guard} -> b\n    }}\n    mode b {{ }}\n}}\n");
        format!("{entity}\nworld W {{\n    space main {{ place a: A at (0, 0) }}\n}}\n")
    };
    let extracted = |guard: &str, part: &str| {
        let text = text(guard);
        let mut client = Client::start(&[], json!({}));
        client.open(&uri(PROGRAM), &text);
        let start = text.find(part).unwrap();
        let range = json!({ "start": position(&text, start), "end": position(&text, start + part.len()) });
        let listed = refactorings(&mut client, &range);
        let condition = listed.iter().find(|action| action["title"] == "extract a condition");
        let after = condition.map(|action| applied(&Files::from([(PROGRAM.to_string(), text)]), action));
        assert!(client.stop());
        let after = after?.remove(PROGRAM)?;
        let guard = after.lines().find_map(|line| line.trim().strip_prefix("when ")?.strip_suffix(" -> b"))?;
        let condition = after.lines().find_map(|line| line.trim().strip_prefix("condition new_condition = "))?;
        Some((guard.to_string(), condition.to_string()))
    };
    let both = |guard: &str, condition: &str| Some((guard.to_string(), condition.to_string()));
    let (three, mixed) = ("x > 1 and y > 2 and x < 9", "x > 1 and y > 2 or x < 9");
    assert_eq!(extracted(three, "y > 2 and x < 9"), both("x > 1 and new_condition", "y > 2 and x < 9"));
    assert_eq!(extracted(three, "x > 1 and y > 2"), both("new_condition and x < 9", "x > 1 and y > 2"));
    assert_eq!(extracted(mixed, "x > 1 and y > 2"), both("new_condition or x < 9", "x > 1 and y > 2"));
    assert_eq!(extracted(mixed, "y > 2 or x < 9"), None);
    assert_eq!(extracted("x > 1 and y > 2 * 3 and x < 9", "3 and x < 9"), None);
}

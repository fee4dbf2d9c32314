//! Painted maps: tiles at their places in the text, what was seen of them, and the inputs that lead there.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hypedc::compile::LevelFile;
use hypedc::compile::compile_with;
use hypedc::lsp::{Settings, Workspace};
use hypedc::sim::{Simulator, parse_script};
use hypedc::source::SourceMap;
use serde_json::{Value, json};

use super::client::{Client, Memory};
use super::levels::{Disk, OPEN};
use super::session::uri;

/// A hero on a floor; he cannot pass the wall, behind which there is more.
const LEVEL: &str = "........\n.....#..\n########\n";

fn start(files: &[(&str, &str)]) -> Client {
    let settings = Settings { verdict_nodes: 2_000, ..Settings::default() };
    Client::start_with(Disk::new(files) as Arc<dyn Workspace>, json!({}), Value::Null, settings)
}

fn about(more: Value) -> Value {
    let mut all = json!({ "textDocument": { "uri": uri("a.hyped") }, "world": "W" });
    all.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    all
}

/// The map as it is painted: `.` not seen, `-` seen, `=` on the way, `S` stood on.
fn drawn(space: &Value) -> String {
    let columns = space["columns"].as_u64().unwrap() as usize;
    let sign = |at: usize| match () {
        () if space["stoodOn"][at] == true => 'S',
        () if space["onWay"][at] == true => '=',
        () if space["first"][at].is_u64() => '-',
        () => '.',
    };
    let all: Vec<char> = (0..space["kind"].as_array().unwrap().len()).map(sign).collect();
    all.chunks(columns).map(|row| row.iter().collect::<String>() + "\n").collect()
}

fn inline() -> String {
    let rows: String = LEVEL.lines().map(|row| format!("            {row}\n")).collect();
    OPEN.replace("map level land", &format!("map land \"\n{rows}        \""))
}

#[test]
fn tiles_are_painted_at_their_places() {
    let mut client = start(&[("level.txt", LEVEL)]);
    let text = inline();
    client.open(&uri("a.hyped"), &text);
    client.asked();
    let painted = client.request("hypedc/paint", about(json!({}))).unwrap();
    let space = &painted["spaces"][0];
    assert_eq!(drawn(space), "........\n====-...\nSSSSS...\n");
    assert_eq!(
        (&space["space"], &space["uri"], &space["columns"]),
        (&json!("main"), &json!(uri("a.hyped")), &json!(8))
    );
    // Each character is where the tile says that it is.
    let lines: Vec<&str> = text.lines().collect();
    for (row, level) in LEVEL.lines().enumerate() {
        let place = &space["rows"][row];
        let line = lines[place["line"].as_u64().unwrap() as usize];
        let from = place["columns"][0].as_u64().unwrap() as usize;
        assert_eq!(&line[from..from + 8], level);
        for (column, symbol) in level.chars().enumerate() {
            let kind = &space["kinds"][space["kind"][row * 8 + column].as_u64().unwrap() as usize];
            assert_eq!(kind["symbol"], json!(symbol));
        }
    }
    // In the open level of another file, the places are in that file.
    let mut client = start(&[("level.txt", LEVEL)]);
    client.open(&uri("a.hyped"), OPEN);
    let refused = client.request("hypedc/paint", about(json!({}))).unwrap_err();
    assert!(refused.1.contains("choose a level"), "{refused:?}");
    client.request("hypedc/chooseLevel", about(json!({ "level": { "map": "/game/level.txt" } }))).unwrap();
    let open = client.request("hypedc/paint", about(json!({}))).unwrap();
    assert_eq!(
        (&open["spaces"][0]["uri"], &open["spaces"][0]["rows"][1]["line"]),
        (&json!(uri("level.txt")), &json!(1))
    );
    assert_eq!(open["spaces"][0]["first"], space["first"]);
    assert!(client.stop());
}

#[test]
fn the_inputs_to_a_tile_lead_there() {
    let mut client = start(&[]);
    let text = inline();
    client.open(&uri("a.hyped"), &text);
    client.asked();
    let disk = Memory([(PathBuf::from("/game/a.hyped"), text)].into());
    let program = compile_with(Path::new("/game/a.hyped"), LevelFile::default(), &disk).program.unwrap();
    let world = program.world_named("W").unwrap();
    let sim = Simulator::new(&program, world);
    // With and without a painted map.
    for is_painted in [false, true] {
        if is_painted {
            client.request("hypedc/paint", about(json!({}))).unwrap();
        }
        for (row, column, is_reached) in
            [(1, 0, true), (1, 3, true), (1, 4, true), (1, 5, false), (0, 2, false), (1, 7, false)]
        {
            let place = about(json!({ "space": "main", "column": column, "row": row }));
            let found = client.request("hypedc/wayTo", place).unwrap();
            assert_eq!(found["verdict"] == "reached", is_reached, "{row} {column}: {found}");
            let Some(inputs) = found["inputs"].as_str() else { continue };
            let mut sources = SourceMap::new();
            let file = sources.add("way", inputs);
            let (script, errors) = parse_script(&program, world, file, inputs);
            assert!(!errors.has_errors());
            let mut scratch = sim.scratch();
            let mut state = sim.initial(&mut scratch).unwrap();
            for input in script.inputs() {
                sim.step(&mut state, input, &mut scratch).unwrap();
            }
            let (x, y) = sim.position(&state, program.worlds[world].players.iter().next().unwrap().slot);
            let (left, bottom) = (f64::from(column) * 16.0, f64::from(2 - row) * 16.0);
            assert!(x + 8.0 > left && x < left + 16.0 && y + 8.0 > bottom && y < bottom + 16.0, "{x} {y} {found}");
        }
    }
    assert!(client.stop());
}

#[test]
fn a_painting_of_an_older_text_is_refused() {
    let settings = Settings { verdict_nodes: u64::MAX, ..Settings::default() };
    let mut client =
        Client::start_with(Disk::new(&[]) as Arc<dyn Workspace>, json!({}), json!({ "verdicts": false }), settings);
    let text = inline();
    client.open(&uri("a.hyped"), &text);
    client.settle();
    let painting = client.send("hypedc/paint", about(json!({})));
    client.change(&uri("a.hyped"), json!([{ "text": format!("{text}\n") }]));
    let (code, _) = client.answer(&painting).unwrap_err();
    assert_eq!(code, -32801, "content modified");
    // One that is cancelled ends, too.
    client.settle();
    let painting = client.send("hypedc/paint", about(json!({})));
    let id = painting.to_string();
    client.notify("$/cancelRequest", json!({ "id": id.parse::<i32>().unwrap() }));
    let (code, _) = client.answer(&painting).unwrap_err();
    assert_eq!(code, -32800);
    assert!(client.stop());
}

/// The hover of a tile of the inline map.
fn hover(client: &mut Client, row: usize, column: usize) -> String {
    let line = inline().lines().position(|line| line.trim() == "........").unwrap() + row;
    let position = json!({ "line": line, "character": 12 + column });
    let about = json!({ "textDocument": { "uri": uri("a.hyped") }, "position": position });
    let found = client.request("textDocument/hover", about).unwrap();
    found["contents"]["value"].as_str().unwrap().to_string()
}

#[test]
fn a_hover_tells_what_was_seen_of_a_tile() {
    let mut client = start(&[]);
    client.open(&uri("a.hyped"), &inline());
    client.asked();
    let plain = hover(&mut client, 1, 2);
    assert!(plain.contains("column 2, row 1 of `W.main`") && !plain.contains("eached"), "{plain}");
    client.request("hypedc/paint", about(json!({}))).unwrap();
    let on_way = hover(&mut client, 1, 2);
    assert!(on_way.contains("First reached at step") && on_way.contains(", on a way that was found;"), "{on_way}");
    assert!(on_way.contains("Inputs that lead here: `right*"), "{on_way}");
    let beyond = hover(&mut client, 1, 7);
    assert!(beyond.contains("nodes of a search, which proves nothing."), "{beyond}");
    let floor = hover(&mut client, 2, 0);
    assert!(floor.contains("'#': wall") && floor.contains("A player stood on it."), "{floor}");
    // What was seen is about the text as it was.
    client.change(&uri("a.hyped"), json!([{ "text": format!("{}\n", inline()) }]));
    assert!(!hover(&mut client, 1, 2).contains("eached"));
    assert!(client.stop());
}

#[test]
fn a_hover_offers_to_ask_about_a_tile() {
    let capabilities = json!({ "experimental": { "commands": { "commands": ["hypedc.tile"] } } });
    let settings = Settings { verdict_nodes: 2_000, ..Settings::default() };
    let mut client = Client::start_with(Disk::new(&[]) as Arc<dyn Workspace>, capabilities, Value::Null, settings);
    client.open(&uri("a.hyped"), &inline());
    client.asked();
    let offer = |hover: &str, title: &str| {
        let link = hover.split_once(&format!("[{title}](command:hypedc.tile?")).expect(hover).1;
        let json = percent_encoding::percent_decode_str(link.split_once(')').unwrap().0).decode_utf8().unwrap();
        serde_json::from_str::<Value>(&json).unwrap()
    };
    let place = json!([uri("a.hyped"), "W", "main", 2, 1]);
    assert_eq!(offer(&hover(&mut client, 1, 2), "Can one get here?"), place);
    client.request("hypedc/paint", about(json!({}))).unwrap();
    assert_eq!(offer(&hover(&mut client, 1, 2), "Play the inputs that lead here"), place);
    assert!(client.stop());
}

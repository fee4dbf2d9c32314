//! Worlds that leave their map open: the levels that fit are offered, and the choice is kept.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use hypedc::lsp::{Settings, Workspace};
use hypedc::source::{Files, ReadError};
use serde_json::{Value, json};

use super::client::{Client, Memory};
use super::session::uri;

/// A disk with levels and a cache.
#[derive(Default)]
pub struct Disk {
    pub files: Memory,
    pub cache: Mutex<BTreeMap<String, String>>,
}

impl Disk {
    pub fn new(files: &[(&str, &str)]) -> Arc<Disk> {
        let files = files.iter().map(|(file, text)| (PathBuf::from(format!("/game/{file}")), (*text).to_string()));
        Arc::new(Disk { files: Memory(files.collect()), cache: Mutex::default() })
    }
}

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.files.read(path)
    }
}

impl Workspace for Disk {
    fn programs(&self, folder: &Path) -> Vec<PathBuf> {
        self.files.programs(folder)
    }

    fn levels(&self, folder: &Path) -> Vec<PathBuf> {
        let is_level = |path: &&PathBuf| path.starts_with(folder) && path.extension().is_some_and(|e| e == "txt");
        self.files.0.keys().filter(is_level).cloned().collect()
    }

    fn recall(&self, key: &str) -> Option<String> {
        self.cache.lock().unwrap().get(key).cloned()
    }

    fn remember(&self, key: &str, text: &str) {
        self.cache.lock().unwrap().insert(key.to_string(), text.to_string());
    }
}

pub const OPEN: &str = "entity Hero {
    button right
    collider body: rect(0, 0, 8, 8)
    mode still {
        x' = 0
        when held(right) -> going
    }
    mode going {
        x' = 60
        when not held(right) -> still
    }
}
world W {
    step 1/60
    collide body with wall: block
    tiles land 16 x 16 {
        '.': empty
        '#': wall
    }
    space main {
        map level land
        place hero: Hero at (0, 16)
    }
    player 1: hero
    goal over: hero.x > 40
}
";

fn levels(client: &mut Client) -> Value {
    client.request("hypedc/levels", json!({ "textDocument": { "uri": uri("a.hyped") }, "world": "W" })).unwrap()
}

fn choose(client: &mut Client, level: Value) {
    let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "world": "W", "level": level });
    client.request("hypedc/chooseLevel", params).unwrap();
}

#[test]
fn a_level_of_an_open_map_is_chosen_once() {
    let files = [("free.txt", "......\n######\n"), ("shut.txt", "..#...\n######\n"), ("notes.txt", "to do\n")];
    let disk = Disk::new(&files);
    let start = || Client::start_with(Arc::clone(&disk) as _, json!({}), Value::Null, Settings::default());
    let mut client = start();
    client.open(&uri("a.hyped"), OPEN);
    client.asked();
    let commands = |client: &mut Client| -> Vec<(String, Value)> {
        let lenses = client.lenses(&uri("a.hyped")).into_iter();
        lenses.map(|(title, command)| (title, command["arguments"].clone())).collect()
    };
    let (file, lens) = (uri("a.hyped"), |title: &str, arguments: Value| (title.to_string(), arguments));
    let unchosen = [
        lens("▶ simulate", json!([file, "W", "ask"])),
        lens("choose a level", json!([file, "W"])),
        lens("▶ search for this goal", json!([file, "W", "over", "ask"])),
    ];
    assert_eq!(commands(&mut client), unchosen);
    let offered = levels(&mut client);
    assert_eq!(offered["chosen"], Value::Null);
    let fits: Vec<(&str, bool)> = offered["levels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|level| (level["name"].as_str().unwrap(), level["fits"].as_bool().unwrap()))
        .collect();
    assert_eq!(fits, [("free.txt", true), ("shut.txt", true), ("notes.txt", false)]);
    assert!(offered["levels"][2]["why"].as_str().is_some_and(|why| !why.is_empty()));

    choose(&mut client, json!({ "map": "/game/free.txt" }));
    client.asked();
    let level = json!({ "map": "/game/free.txt" });
    let chosen = commands(&mut client);
    assert_eq!(chosen[0], lens("▶ simulate", json!([file, "W", level])));
    assert_eq!(chosen[1], lens("level: free.txt", json!([file, "W"])));
    assert!(chosen[2].0.starts_with("✓ "), "{chosen:?}");
    assert_eq!(chosen[3], lens("▶ search for this goal", json!([file, "W", "over", level])));

    // A command need not name the world.
    let arguments = json!({ "uri": file, "inputs": "" });
    let ran = client.request("workspace/executeCommand", json!({ "command": "hypedc.sim", "arguments": [arguments] }));
    assert!(ran.is_ok(), "{ran:?}");

    choose(&mut client, json!({ "map": "file:///game/shut.txt" }));
    client.asked();
    let chosen = commands(&mut client);
    assert!(chosen[2].0.starts_with("✗ proven: "), "{chosen:?}");
    // On another level nothing was broken.
    assert!(client.shown.get(&file).is_none_or(|found| found.as_array().unwrap().is_empty()), "{:?}", client.shown);
    assert!(client.stop());

    // It is kept.
    let mut client = start();
    client.open(&uri("a.hyped"), OPEN);
    client.asked();
    assert_eq!(commands(&mut client)[1].0, "level: shut.txt");
    choose(&mut client, Value::Null);
    client.asked();
    assert_eq!(commands(&mut client), unchosen);
    assert!(client.stop());
}

#[test]
fn an_edit_of_the_chosen_level_is_asked_about() {
    let disk = Disk::new(&[("level.txt", "......\n######\n")]);
    let mut client = Client::start_with(disk, json!({}), Value::Null, Settings::default());
    client.open(&uri("a.hyped"), OPEN);
    choose(&mut client, json!({ "map": "/game/level.txt" }));
    client.asked();
    let title = |client: &mut Client| client.lenses(&uri("a.hyped"))[2].0.clone();
    let before = title(&mut client);
    assert!(before.starts_with("✓ "), "{before}");
    client.open(&uri("level.txt"), "..#...\n######\n");
    assert!(title(&mut client).starts_with("… was ✓ "));
    client.asked();
    let after = title(&mut client);
    assert!(after.starts_with("✗ proven: "), "{after}");
    let broken = |client: &Client| client.shown[&uri("a.hyped")].to_string().contains("broken-goal");
    assert!(broken(&client));
    // A level that can no longer be the map is a finding, until it can.
    let misfit = |client: &Client| client.shown[&uri("a.hyped")].to_string();
    client.change(&uri("level.txt"), json!([{ "text": "...Z..\n######\n" }]));
    client.asked();
    let found = misfit(&client);
    assert!(found.contains("level-misfit") && found.contains("`level.txt` does not fit `W`: "), "{found}");
    let settings = |is_on: bool| json!({ "settings": { "hypedc": { "verdicts": is_on } } });
    client.notify("workspace/didChangeConfiguration", settings(false));
    client.settle();
    assert!(!misfit(&client).contains("level-misfit"), "verdicts are off");
    client.notify("workspace/didChangeConfiguration", settings(true));
    client.asked();
    assert!(misfit(&client).contains("level-misfit"));
    client.change(&uri("level.txt"), json!([{ "text": "..#...\n######\n" }]));
    client.asked();
    assert!(!misfit(&client).contains("level-misfit"));
    // While the level is another one, nothing is claimed.
    client.change(&uri("level.txt"), json!([{ "text": "......\n######\n" }]));
    title(&mut client);
    assert!(!broken(&client));
    assert!(client.stop());
}

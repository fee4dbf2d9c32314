//! What is shown is about the text as it is now: lines that are being typed, names that were deleted, files that changed
//! on the disk.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use hypedc::lsp::Workspace;
use hypedc::source::{Files, ReadError};
use serde_json::{Value, json};

use super::client::{Client, Memory};
use super::session::{position, uri};

/// A disk that changes.
#[derive(Default)]
struct Disk(Mutex<Memory>);

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.0.lock().unwrap().read(path)
    }
}

impl Workspace for Disk {
    fn programs(&self, folder: &Path) -> Vec<PathBuf> {
        self.0.lock().unwrap().programs(folder)
    }
}

impl Disk {
    fn write(&self, file: &str, text: &str) {
        self.0.lock().unwrap().0.insert(PathBuf::from(format!("/game/{file}")), text.to_string());
    }
}

/// The codes that are shown for a file, with whether they fade.
fn shown(client: &mut Client, file: &str) -> Vec<(String, bool)> {
    client.settle();
    let found = client.shown.get(&uri(file)).and_then(Value::as_array).cloned().unwrap_or_default();
    found.iter().map(|d| (d["code"].as_str().unwrap().to_string(), !d["tags"].is_null())).collect()
}

fn save(client: &mut Client, file: &str) {
    client.notify("textDocument/didSave", json!({ "textDocument": { "uri": uri(file) } }));
}

#[test]
fn a_line_that_is_being_typed_does_not_fade() {
    let mut client = Client::start(&[], json!({}));
    let text = "entity A {\n    discrete n: int 0..9 = 0\n    mode a {\n        when n > 0 { n := 0 }\n    }\n}\n";
    client.open(&uri("a.hyped"), text);
    client.settle();
    let typed = "        when n > 3\n";
    let at = json!({ "start": { "line": 4, "character": 0 }, "end": { "line": 4, "character": 0 } });
    client.change(&uri("a.hyped"), json!([{ "range": at, "text": typed }]));
    let idle = |fades: bool| ("W0401".to_string(), fades);
    assert!(shown(&mut client, "a.hyped").contains(&idle(false)));
    // Elsewhere, or once it is saved, it is finished.
    let elsewhere = json!({ "start": { "line": 0, "character": 7 }, "end": { "line": 0, "character": 8 } });
    client.change(&uri("a.hyped"), json!([{ "range": elsewhere, "text": "B" }]));
    assert!(shown(&mut client, "a.hyped").contains(&idle(true)));
    client.change(&uri("a.hyped"), json!([{ "range": at, "text": "" }, { "range": at, "text": typed }]));
    assert!(shown(&mut client, "a.hyped").contains(&idle(false)));
    save(&mut client, "a.hyped");
    assert!(shown(&mut client, "a.hyped").contains(&idle(true)));
    assert!(client.stop());
}

#[test]
fn a_deleted_name_is_not_offered() {
    let mut client = Client::start(&[], json!({}));
    let text = |tags: &str, guard: &str| {
        format!(
            "entity A {{\n    collider {tags}: rect(0, 0, 8, 8)\n    mode still {{\n        when {guard} -> gone\n    }}\n    \
             mode gone {{ }}\n}}\n"
        )
    };
    let offered = |client: &mut Client, text: &str| -> Vec<String> {
        let at = text.find(" -> gone").unwrap();
        let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "position": position(text, at) });
        let items = client.request("textDocument/completion", params).unwrap();
        items.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap().to_string()).collect()
    };
    client.open(&uri("a.hyped"), &text("body, coin", "touching(body, coin)"));
    client.settle();
    let broken = text("body", "touching(");
    client.change(&uri("a.hyped"), json!([{ "text": broken }]));
    let names = offered(&mut client, &broken);
    assert!(names.contains(&"body".to_string()), "{names:?}");
    assert!(!names.contains(&"coin".to_string()), "{names:?}");
    // What a broken text does not resolve is still offered.
    let unread = text("body, coin = 3", "touching(");
    client.change(&uri("a.hyped"), json!([{ "text": unread }]));
    let names = offered(&mut client, &unread);
    assert!(names.contains(&"coin".to_string()), "{names:?}");
    assert!(client.stop());
}

#[test]
fn a_level_that_changed_on_the_disk_is_read_when_something_is_saved() {
    let disk = Arc::new(Disk::default());
    let level = |rows: &str| disk.write("level.txt", rows);
    level("..\n##\n");
    let text = "world W {\n    step 1/60\n    tiles land 16 x 16 {\n        '.': empty\n        '#': wall\n    }\n    \
        space main {\n        map land from \"level.txt\"\n    }\n}\n";
    let mut client = Client::start_on(Arc::clone(&disk) as Arc<dyn Workspace>, json!({}));
    client.open(&uri("a.hyped"), text);
    let before = shown(&mut client, "a.hyped");
    level("..\n#?\n");
    assert_eq!(shown(&mut client, "a.hyped"), before);
    save(&mut client, "a.hyped");
    let after = shown(&mut client, "a.hyped");
    let level = shown(&mut client, "level.txt");
    assert_ne!((after, level.len()), (before, 0));
    assert!(client.stop());
}

#[test]
fn a_tag_is_not_renamed_to_another() {
    let mut client = Client::start(&[], json!({}));
    let text = "entity A {\n    collider enemy: rect(0, 0, 8, 8)\n    collider body: rect(0, 0, 4, 4)\n}\n\
        world W {\n    step 1/60\n    collide enemy with body: sense\n}\n";
    client.open(&uri("a.hyped"), text);
    let mut rename = |new: &str| {
        let position = position(text, text.find("enemy").unwrap());
        let params = json!({ "textDocument": { "uri": uri("a.hyped") }, "position": position, "newName": new });
        client.request("textDocument/rename", params)
    };
    let (_, why) = rename("body").unwrap_err();
    assert_eq!(why, "there is a tag `body` already: the two would be one");
    assert!(rename("foe").unwrap().to_string().matches("foe").count() == 2);
    assert!(rename("enemy").is_ok());
    assert!(client.stop());
}

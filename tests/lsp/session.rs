//! A session with a server, written down so that people can read it: what was asked, and the answer with its places shown
//! as `LINE:COLUMN-LINE:COLUMN` and the text there.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::client::Client;

/// A session, and what was written down of it.
pub struct Session {
    pub client: Client,
    texts: BTreeMap<String, String>,
    log: String,
}

/// The URI of a file of the folder.
pub fn uri(file: &str) -> String {
    format!("file:///game/{file}")
}

/// Line and column of a byte of a text without wide characters before it.
pub fn position(text: &str, byte: usize) -> Value {
    let line = text[..byte].matches('\n').count();
    let start = text[..byte].rfind('\n').map_or(0, |at| at + 1);
    json!({ "line": line, "character": text[start..byte].encode_utf16().count() })
}

impl Session {
    /// A folder with some files, none of them open.
    pub fn new(files: &[(&str, &str)]) -> Self {
        let named: Vec<(String, &str)> = files.iter().map(|(f, text)| (format!("/game/{f}"), *text)).collect();
        let on_disk: Vec<(&str, &str)> = named.iter().map(|(f, text)| (f.as_str(), *text)).collect();
        let capabilities = json!({
            "textDocument": { "completion": { "completionItem": { "snippetSupport": true } } },
        });
        let texts = files.iter().map(|(f, text)| ((*f).to_string(), (*text).to_string())).collect();
        Session { client: Client::start(&on_disk, capabilities), texts, log: String::new() }
    }

    pub fn open(&mut self, file: &str, text: &str) {
        self.client.open(&uri(file), text);
        self.texts.insert(file.into(), text.into());
        self.note(&format!("open {file}"));
    }

    pub fn close(&mut self, file: &str) {
        self.client.close(&uri(file));
        self.note(&format!("close {file}"));
    }

    /// Puts a text in place of the first that is like that.
    pub fn replace(&mut self, file: &str, old: &str, new: &str) {
        let text = self.texts.get_mut(file).unwrap();
        let at = text.find(old).unwrap();
        let range = json!({ "start": position(text, at), "end": position(text, at + old.len()) });
        text.replace_range(at..at + old.len(), new);
        self.client.change(&uri(file), json!([{ "range": range, "text": new }]));
        self.note(&format!("in {file}, {old:?} becomes {new:?}"));
    }

    /// The place of `|` in a piece of text that is there without it.
    pub fn place(&self, file: &str, piece: &str) -> Value {
        let text = &self.texts[file];
        let at = text.find(&piece.replace('|', "")).unwrap_or_else(|| panic!("{piece} is not in {file}"));
        position(text, at + piece.find('|').unwrap())
    }

    pub fn note(&mut self, text: &str) {
        self.log.push_str(&format!("--- {text}\n"));
    }

    /// Asks something of a document, and writes down the answer.
    pub fn ask(&mut self, method: &str, file: &str, mut params: Value) {
        let shown = short(&params, "", &self.texts);
        params["textDocument"] = json!({ "uri": uri(file) });
        let answer = self.client.request(method, params);
        self.note(format!("{method} {file} {}", shown.trim()).trim_end());
        self.write(file, &answer);
    }

    /// Asks something of a place of a document.
    pub fn ask_at(&mut self, method: &str, file: &str, piece: &str, mut params: Value) -> Value {
        params["position"] = self.place(file, piece);
        params["textDocument"] = json!({ "uri": uri(file) });
        let answer = self.client.request(method, params);
        self.note(&format!("{method} {file} at {piece:?}"));
        self.write(file, &answer);
        answer.unwrap_or_default()
    }

    /// Asks something, and writes down the answer.
    pub fn ask_all(&mut self, method: &str, params: Value) -> Value {
        let shown = short(&params, "", &self.texts);
        let answer = self.client.request(method, params);
        self.note(format!("{method} {}", shown.trim()).trim_end());
        self.write("", &answer);
        answer.unwrap_or_default()
    }

    /// Writes down some lines.
    pub fn write_lines(&mut self, lines: &[String]) {
        lines.iter().for_each(|line| self.log.push_str(&format!("{line}\n")));
    }

    fn write(&mut self, file: &str, answer: &Result<Value, (i32, String)>) {
        match answer {
            Ok(value) => self.log.push_str(&short(value, file, &self.texts)),
            Err((code, message)) => self.log.push_str(&format!("error {code}: {message}\n")),
        }
    }

    /// Writes down what is shown once there is nothing left to do.
    pub fn show_findings(&mut self) {
        self.client.settle();
        self.note("findings");
        for (uri, found) in &self.client.shown {
            let file = uri.strip_prefix("file:///game/").unwrap_or(uri);
            let text = short(found, file, &self.texts);
            self.log.push_str(&format!("{file}:{}{text}", if text == "[]\n" { " " } else { "\n" }));
        }
    }

    /// Ends the server; gives what was written down.
    pub fn end(self) -> String {
        assert!(self.client.stop());
        self.log
    }
}

/// A value as an outline, ranges shortened and with the text they hold.
fn short(value: &Value, file: &str, texts: &BTreeMap<String, String>) -> String {
    let mut out = String::new();
    outline(value, file, texts, 0, &mut out);
    out
}

fn outline(value: &Value, file: &str, texts: &BTreeMap<String, String>, depth: usize, out: &mut String) {
    let pad = "  ".repeat(depth);
    match value {
        Value::Object(map) if map.is_empty() => out.push_str("{}\n"),
        Value::Object(map) if is_range(value) => {
            let shown = range(value, texts.get(file).map(String::as_str));
            out.push_str(&format!("{shown}\n"));
            let _ = map;
        }
        Value::Object(map) if map.len() == 2 && map.contains_key("line") => {
            out.push_str(&format!("{}:{}\n", map["line"], map["character"]));
        }
        Value::Object(map) => {
            let own = map.get("uri").and_then(Value::as_str).and_then(|u| u.strip_prefix("file:///game/"));
            let file = own.unwrap_or(file);
            if depth > 0 {
                out.push('\n');
            }
            for (key, inner) in map {
                let key = key.strip_prefix("file:///game/").unwrap_or(key);
                let inside = if texts.contains_key(key) { key } else { file };
                out.push_str(&format!("{pad}{key}: "));
                outline(inner, inside, texts, depth + 1, out);
            }
        }
        Value::Array(list) if list.is_empty() => out.push_str("[]\n"),
        Value::Array(list) if list.iter().all(Value::is_number) => {
            out.push_str(&format!("{}\n", serde_json::to_string(list).unwrap()));
        }
        Value::Array(list) => {
            if depth > 0 {
                out.push('\n');
            }
            for inner in list {
                let mut item = String::new();
                outline(inner, file, texts, depth + 1, &mut item);
                out.push_str(&format!("{pad}- {}", item.trim_start()));
            }
        }
        Value::String(text) => {
            let text = text.strip_prefix("file:///game/").unwrap_or(text);
            let indented = text.replace('\n', &format!("\n{pad}"));
            out.push_str(&format!("{indented}\n"));
        }
        other => out.push_str(&format!("{other}\n")),
    }
}

fn is_range(value: &Value) -> bool {
    value.as_object().is_some_and(|map| map.len() == 2 && map.contains_key("start") && map.contains_key("end"))
}

fn range(value: &Value, text: Option<&str>) -> String {
    let (start, end) = (&value["start"], &value["end"]);
    let places = format!("{}:{}-{}:{}", start["line"], start["character"], end["line"], end["character"]);
    let byte = |text: &str, at: &Value| {
        let line: usize = text.split_inclusive('\n').take(at["line"].as_u64().unwrap() as usize).map(str::len).sum();
        line + at["character"].as_u64().unwrap() as usize
    };
    let held = text.and_then(|text| text.get(byte(text, start)..byte(text, end)));
    match held.filter(|held| !held.is_empty()) {
        Some(held) => {
            let first = held.lines().next().unwrap_or_default();
            let more = if held.lines().nth(1).is_some() { " …" } else { "" };
            format!("{places} `{first}{more}`")
        }
        None => places,
    }
}

//! Latency of the language server in programs of 200, 2,000 and 20,000 lines, over pipes in one process: from a key to
//! its findings and to its completions, and of a hover; for single keys, and while a line is typed every 25 ms with all
//! requests that an editor sends. `cargo bench --bench lsp` prints medians and 95th percentiles; with a number, as in
//! `cargo bench --bench lsp -- 20000`, for a program of so many lines alone.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "the table is what it is for, and it looks at the clock"
)]

#[path = "../tests/lsp/client.rs"]
mod client;
mod large;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use client::{Client, Memory};
use cpu_time::ProcessTime;
use hypedc::lsp::Settings;
use lsp_server::{Message, RequestId};
use serde_json::{Value, json};

const URI: &str = "file:///game/large.hyped";
/// The time between two keys of a burst.
const KEY: Duration = Duration::from_millis(25);
/// What is typed, in the middle of the program.
const TYPED: &str = "        when timer > 0.25 and x >= 3 { x := min(x, 7) } -> leftwards\n";
/// The number of characters of it that are typed one by one in a large program.
const SINGLE: usize = 20;
/// How often it is typed and deleted again in bursts.
const BURSTS: usize = 3;

/// A number of measured times, in ms.
#[derive(Default)]
struct Times(Vec<f64>);

impl Times {
    fn add(&mut self, time: Duration) {
        self.0.push(time.as_secs_f64() * 1e3);
    }

    fn percentile(&self, share: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let rank = (share * sorted.len() as f64).ceil() as usize;
        sorted[rank.clamp(1, sorted.len()) - 1]
    }

    fn row(&self) -> String {
        let (median, tail, most) = (self.percentile(0.5), self.percentile(0.95), self.percentile(1.0));
        format!("{median:8.2} {tail:8.2} {most:8.2}   of {}", self.0.len())
    }
}

/// A place in the text where a line is typed.
#[derive(Clone, Copy)]
struct Place {
    line: usize,
    character: usize,
}

impl Place {
    fn params(self) -> Value {
        json!({
            "textDocument": { "uri": URI }, "position": { "line": self.line, "character": self.character },
            "context": { "triggerKind": 1 },
        })
    }
}

/// A key: what it puts in, or that it deletes the character before.
fn press(client: &mut Client, place: &mut Place, key: Option<char>) {
    let before = *place;
    let (start, text) = match key {
        Some('\n') => {
            *place = Place { line: place.line + 1, character: 0 };
            (before, "\n".to_string())
        }
        Some(key) => {
            place.character += 1;
            (before, key.to_string())
        }
        None => {
            place.character -= 1;
            (*place, String::new())
        }
    };
    let of = |place: Place| json!({ "line": place.line, "character": place.character });
    client.change(URI, json!([{ "range": { "start": of(start), "end": of(before) }, "text": text }]));
}

/// The keys that type the first characters of a line and delete them again.
fn keys(count: usize) -> impl Iterator<Item = Option<char>> {
    let line: Vec<char> = TYPED.trim_end().chars().take(count).collect();
    let deleted = line.len();
    line.into_iter().map(Some).chain((0..deleted).map(|_| None))
}

fn capabilities() -> Value {
    json!({ "textDocument": {
        "semanticTokens": { "requests": { "full": { "delta": true } }, "tokenTypes": [], "tokenModifiers": [], "formats": ["relative"] },
        "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
        "completion": { "completionItem": { "snippetSupport": true } },
        "publishDiagnostics": { "versionSupport": true, "relatedInformation": true },
    } })
}

/// Single keys: the next one comes when all is done.
fn alone(client: &mut Client, start: Place, count: usize) {
    let mut place = start;
    // `speed`, in the line above.
    let named = Place { line: start.line - 1, character: "        x' = s".len() };
    let [mut findings, mut cpu, mut idle, mut completions, mut hovers] = [(); 5].map(|()| Times::default());
    for (at, key) in keys(count).enumerate() {
        let (began, used) = (Instant::now(), ProcessTime::now());
        press(client, &mut place, key);
        if at % 2 == 0 {
            client.published(URI);
            findings.add(began.elapsed());
            cpu.add(used.elapsed());
        } else {
            client.request("textDocument/completion", place.params()).unwrap();
            completions.add(began.elapsed());
        }
        client.settle();
        idle.add(used.elapsed());
        let began = Instant::now();
        let hover = client.request("textDocument/hover", named.params()).unwrap();
        hovers.add(began.elapsed());
        assert!(hover["contents"].is_object(), "{hover}");
    }
    println!("  alone   key to findings       {}", findings.row());
    println!("          the same, CPU         {}", cpu.row());
    println!("          key to idle, CPU      {}", idle.row());
    println!("          key to completions    {}", completions.row());
    println!("          hover                 {}", hovers.row());
}

/// What an editor asks after each key.
const ASKED: [&str; 7] = [
    "textDocument/completion",
    "textDocument/hover",
    "textDocument/semanticTokens/full",
    "textDocument/inlayHint",
    "textDocument/codeLens",
    "textDocument/foldingRange",
    "textDocument/documentSymbol",
];

/// What is under way while keys come.
struct Burst<'a> {
    client: &'a mut Client,
    /// When each version was sent.
    sent: BTreeMap<i64, Instant>,
    /// The requests that are not answered, by their number in `ASKED`.
    asked: BTreeMap<RequestId, (usize, Instant)>,
    /// The newest request of each kind.
    newest: [Option<RequestId>; ASKED.len()],
    /// From a key to the findings of the text with it.
    findings: Times,
    /// From a request to its answer, by its number in `ASKED`.
    answers: [Times; ASKED.len()],
    /// The number of requests that were given up.
    cancelled: usize,
}

impl Burst<'_> {
    fn receive_until(&mut self, end: Instant) {
        while let Some(message) = self.client.receive(end.saturating_duration_since(Instant::now())) {
            match message {
                Message::Notification(note) if note.method == "textDocument/publishDiagnostics" => {
                    if let Some(sent) = note.params["version"].as_i64().and_then(|version| self.sent.get(&version)) {
                        self.findings.add(sent.elapsed());
                    }
                }
                Message::Response(response) => {
                    let Some((kind, sent)) = self.asked.remove(&response.id) else { continue };
                    match response.response_result {
                        Ok(_) => self.answers[kind].add(sent.elapsed()),
                        Err(_) => self.cancelled += 1,
                    }
                }
                _ => {}
            }
        }
    }

    /// Asks what an editor asks; a request of the same kind that is not answered is given up, as editors do.
    fn ask(&mut self, place: Place) {
        for (kind, method) in ASKED.iter().enumerate() {
            if let Some(id) = self.newest[kind].take().filter(|id| self.asked.contains_key(id)) {
                let id: Value = serde_json::to_value(&id).unwrap();
                self.client.notify("$/cancelRequest", json!({ "id": id }));
            }
            let mut params = place.params();
            if *method == "textDocument/inlayHint" {
                let [start, end] = [place.line.saturating_sub(30), place.line + 30];
                params["range"] =
                    json!({ "start": { "line": start, "character": 0 }, "end": { "line": end, "character": 0 } });
            }
            let id = self.client.send(method, params);
            self.asked.insert(id.clone(), (kind, Instant::now()));
            self.newest[kind] = Some(id);
        }
    }
}

/// A line is typed and deleted, a key each 25 ms, with all requests.
fn burst(client: &mut Client, start: Place) {
    let used = ProcessTime::now();
    let mut burst = Burst {
        client,
        sent: BTreeMap::new(),
        asked: BTreeMap::new(),
        newest: Default::default(),
        findings: Times::default(),
        answers: Default::default(),
        cancelled: 0,
    };
    let mut place = start;
    let mut next = Instant::now();
    for key in keys(TYPED.len()) {
        burst.receive_until(next);
        press(burst.client, &mut place, key);
        let version = i64::from(burst.client.version());
        burst.sent.insert(version, Instant::now());
        burst.ask(place);
        next += KEY;
    }
    // The last answers.
    let began = Instant::now();
    while !burst.asked.is_empty() && began.elapsed() < Duration::from_secs(60) {
        burst.receive_until(Instant::now() + KEY);
    }
    burst.receive_until(Instant::now() + 4 * KEY);
    println!("  burst   key to findings       {}", burst.findings.row());
    for (method, times) in ASKED.iter().zip(&burst.answers) {
        let name = method.trim_start_matches("textDocument/");
        match times.0.is_empty() {
            true => println!("          {name:21} none"),
            false => println!("          {name:21} {}", times.row()),
        }
    }
    println!("          given up: {}; CPU {:.0} ms", burst.cancelled, used.elapsed().as_secs_f64() * 1e3);
    client.settle();
}

/// Requests about the whole of one long line, for lengths that double: what is in proportion to the length doubles, too.
fn long_lines() {
    println!("one line, CPU in ms: key to findings, tokens, completions in it");
    for terms in [12_500, 25_000, 50_000] {
        let sum = vec!["timer > 1"; 200].join(" or ");
        let tags: Vec<String> = (0..terms).map(|number| format!("tag{number}")).collect();
        let tail = format!("    mode a {{ when {sum} -> a }}\n}}\n");
        let text = format!("entity A {{\n    collider {}: rect(0, 0, 8, 8)\n{tail}", tags.join(", "));
        let mut client = Client::start(&[], capabilities());
        client.open(URI, &text);
        client.settle();
        let line = text.lines().nth(1).unwrap();
        let end = line.find(':').unwrap();
        let mut place = Place { line: 1, character: end };
        let mut row = Vec::new();
        let mut used = ProcessTime::now();
        press(&mut client, &mut place, Some('x'));
        client.settle();
        row.push(used.elapsed());
        for method in ["textDocument/semanticTokens/full", "textDocument/completion"] {
            used = ProcessTime::now();
            assert!(!client.request(method, place.params()).unwrap().is_null(), "{method}");
            row.push(used.elapsed());
        }
        let row: Vec<String> = row.iter().map(|time| format!("{:8.1}", time.as_secs_f64() * 1e3)).collect();
        println!("  {:4.0} kB {}", line.len() as f64 / 1e3, row.join(" "));
        assert!(client.stop());
    }
}

/// The memory of this process, in MB.
fn resident() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or_default();
    line.trim().trim_end_matches(" kB").parse::<f64>().unwrap_or(f64::NAN) / 1e3
}

fn main() {
    println!("ms: median, 95th percentile, longest");
    let asked: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let everything = asked.is_empty();
    for lines in if everything { vec![200, 2_000, 20_000] } else { asked } {
        let text = large::realistic(lines);
        // Into the mode nearest to the middle of the file that goes to `leftwards`.
        let modes = text.match_indices("        when x >= right -> leftwards").map(|(at, _)| at);
        let at = modes.min_by_key(|at| at.abs_diff(text.len() / 2)).unwrap();
        let start = Place { line: text[..at].matches('\n').count(), character: 0 };
        let mut client = Client::start_patient(
            Arc::new(Memory::default()),
            capabilities(),
            json!({}),
            Settings { debounce: Duration::from_millis(200), ..Settings::default() },
        );
        client.open(URI, &text);
        client.settle();
        // An empty line, to type into.
        let mut place = start;
        press(&mut client, &mut place, Some('\n'));
        client.settle();
        println!("{} lines, {:.0} kB", text.lines().count(), text.len() as f64 / 1e3);
        // After each of them all values are worked out anew.
        alone(&mut client, start, if lines > 2_000 { SINGLE } else { TYPED.len() });
        for _ in 0..BURSTS {
            burst(&mut client, start);
        }
        let held = resident();
        client.close(URI);
        client.settle();
        println!("  resident: {held:.0} MB, {:.0} MB when it is closed", resident());
        assert!(client.stop());
    }
    if everything {
        long_lines();
    }
}

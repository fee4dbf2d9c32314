//! Latency from a keystroke to its findings, in programs of 2,000 and 20,000 lines: over a connection in memory, the
//! whole server with its worker. `cargo bench --bench lsp` prints the times.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]

#[path = "../tests/lsp/client.rs"]
mod client;
mod large;

use client::Client;
use criterion::{Criterion, criterion_group, criterion_main};
use serde_json::json;

const URI: &str = "file:///game/large.hyped";

fn keystrokes(c: &mut Criterion) {
    let mut group = c.benchmark_group("lsp");
    group.sample_size(20);
    for lines in [2_000, 20_000] {
        let text = large::realistic(lines);
        // In the middle of the file, the name of an edge's target loses its last letter and gets it back.
        let at = text.len() / 2 + text[text.len() / 2..].find(" -> leftwards").unwrap() + " -> leftward".len();
        let line = text[..at].matches('\n').count();
        let character = at - text[..at].rfind('\n').unwrap() - 1;
        let mut client = Client::start(&[], json!({}));
        client.open(URI, &text);
        client.settle();
        let mut is_whole = true;
        group.bench_function(format!("keystroke to findings/{lines} lines"), |b| {
            b.iter(|| {
                let end = character + usize::from(is_whole);
                let range = json!({
                    "start": { "line": line, "character": character }, "end": { "line": line, "character": end },
                });
                client.change(URI, json!([{ "range": range, "text": if is_whole { "" } else { "s" } }]));
                is_whole = !is_whole;
                client.published(URI);
            });
        });
        assert!(client.stop());
    }
    group.finish();
}

criterion_group!(benches, keystrokes);
criterion_main!(benches);

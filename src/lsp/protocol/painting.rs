//! The responses to `hypedc/paint` and `hypedc/wayTo`: maps and their tiles, at their places in the texts.

use serde_json::{Value, json};

use super::extensions::level_json;
use super::positions;
use super::uri::uri_of;
use crate::lsp::text::document_text::Encoding;
use crate::lsp::verdicts::level::ChosenLevel;
use crate::lsp::verdicts::paint::{Painted, PaintedSpace};
use crate::lsp::verdicts::verdict::Verdict;
use crate::lsp::view::View;
use crate::reach::query::Kind;

/// The response to `hypedc/paint`.
pub(super) fn painted(view: &View, encoding: Encoding, world: &str, painted: &Painted) -> Value {
    let spaces: Vec<Value> = painted.spaces.iter().map(|of| space(view, encoding, of)).collect();
    json!({
        "world": world,
        "nodes": painted.nodes,
        "secondsPerStep": painted.seconds_per_step,
        "spaces": spaces,
    })
}

fn space(view: &View, encoding: Encoding, of: &PaintedSpace) -> Value {
    let document = view.documents.get(&of.path);
    // The rows of levels that are not open are read as they are compiled.
    let text = view.text(&of.path).or_else(|| {
        let text = view.disk.read(&of.path).ok()?;
        Some(std::sync::Arc::new(crate::lsp::text::document_text::Text::new(text)))
    });
    let row = |bytes: &std::ops::Range<usize>| {
        let text = text.as_ref()?;
        let characters = text.code().get(bytes.clone())?.char_indices().map(|(at, _)| bytes.start + at);
        // Where each character begins, and where the last one ends.
        let all = characters.chain([bytes.end]).map(|byte| positions::position(text, byte, encoding));
        let all: Vec<_> = all.collect();
        let line = all.first()?.line;
        Some(json!({ "line": line, "columns": all.iter().map(|at| at.character).collect::<Vec<u32>>() }))
    };
    let tiles = &of.tiles;
    json!({
        "space": of.name,
        "uri": document.map_or_else(|| uri_of(&of.path).0, |document| document.uri.clone()),
        "version": document.map(|document| document.version),
        "columns": of.columns,
        "rows": of.rows.iter().map(row).collect::<Vec<Option<Value>>>(),
        "kinds": of.kinds.iter().map(|(symbol, tags)| json!({ "symbol": symbol, "tags": tags })).collect::<Vec<Value>>(),
        "kind": tiles.iter().map(|tile| tile.kind).collect::<Vec<usize>>(),
        "first": tiles.iter().map(|tile| tile.first.as_ref().map(|(steps, _)| *steps)).collect::<Vec<Option<u64>>>(),
        "visits": tiles.iter().map(|tile| tile.visits).collect::<Vec<u64>>(),
        "onWay": tiles.iter().map(|tile| tile.is_on_way).collect::<Vec<bool>>(),
        "stoodOn": tiles.iter().map(|tile| tile.is_stood_on).collect::<Vec<bool>>(),
    })
}

/// The response to `hypedc/wayTo`.
pub(super) fn way_to(verdict: &Verdict, level: Option<&ChosenLevel>) -> Value {
    let way = verdict.way.as_ref();
    json!({
        "title": verdict.title(Kind::Goal).trim_end_matches(" · play"),
        "verdict": verdict.conclusion.name(),
        "details": verdict.details(),
        "steps": way.map(|way| way.steps),
        "seconds": way.map(|way| way.seconds),
        "inputs": way.map(|way| &way.inputs),
        "level": level.map(level_json),
    })
}

//! The responses to `hypedc/paint` and `hypedc/wayTo`: maps and their tiles, at their places in the texts; and what hovers
//! tell of a painted tile.

use std::path::Path;

use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::{Value, json};

use super::client::TILE;
use super::context::Context;
use super::extensions::level_json;
use super::positions;
use super::uri::uri_of;
use crate::lsp::features::hover_more::MapTile;
use crate::lsp::text::document_text::Encoding;
use crate::lsp::verdicts::level::ChosenLevel;
use crate::lsp::verdicts::paint::{Painted, PaintedSpace, PaintedTile};
use crate::lsp::verdicts::verdict::Verdict;
use crate::lsp::view::View;
use crate::reach::query::Kind;

/// Maximum length of inputs in a hover.
const MAX_INPUTS: usize = 300;

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

/// What a hover tells of a tile beside its meaning: what was seen of it, how one gets there, or an offer to ask.
pub(super) fn tile_lines(context: &Context, path: &Path, tile: &MapTile) -> Vec<String> {
    let text = context.view.text(path);
    let seen = context.painted.iter().filter(|of| of.world == tile.world).find_map(|of| {
        let found = of.painted.tile_at(path, text.as_ref()?.code(), tile.bytes.start)?;
        Some((&of.root, &of.painted, found))
    });
    let mut lines = Vec::new();
    if let Some((_, painted, found)) = seen {
        lines.push(seen_line(painted, found));
    }
    let inputs = seen.and_then(|(_, _, found)| found.first.as_ref()).map(|(_, inputs)| inputs);
    match (context.client.asks_about_tiles, inputs) {
        (true, _) => {
            let root = seen.map_or(path, |(root, ..)| root.as_path());
            let document = context.view.documents.get(root);
            let uri = document.map_or_else(|| uri_of(root).0, |document| document.uri.clone());
            let about = json!([uri, tile.world, tile.space, tile.column, tile.line]).to_string();
            let about = utf8_percent_encode(&about, NON_ALPHANUMERIC);
            let title = if inputs.is_some() { "Play the inputs that lead here" } else { "Can one get here?" };
            lines.push(format!("[{title}](command:{TILE}?{about})"));
        }
        (false, Some(inputs)) if inputs.len() <= MAX_INPUTS => lines.push(format!("Inputs that lead here: `{inputs}`")),
        (false, _) => {}
    }
    lines
}

/// `First reached at step 40 (0.67 s), on a way that was found; 12 visits. A player stood on it.`
fn seen_line(painted: &Painted, tile: &PaintedTile) -> String {
    let seen = match &tile.first {
        Some((steps, _)) => {
            let seconds = *steps as f64 * painted.seconds_per_step;
            let on = if tile.is_on_way { ", on a way that was found" } else { "" };
            let visits = if tile.visits == 1 { "visit" } else { "visits" };
            format!("First reached at step {steps} ({seconds:.2} s){on}; {} {visits}.", tile.visits)
        }
        None => format!("Not reached with {} nodes of a search, which proves nothing.", painted.nodes),
    };
    if tile.is_stood_on { format!("{seen} A player stood on it.") } else { seen }
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

//! Maps from rows of characters: written between quotes in a `.hyped` file, or the lines of a text file.

use crate::ir::{Breakable, Slope, TileKind, TileMap};

use std::collections::BTreeMap;

use serde::de::IgnoredAny;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::TooMany;
use crate::diagnostic::catalogue::world::{EmptyMap, NotRows, RowLength, UnknownTile};
use crate::source::{FileId, Span};

use super::MAX_TILES;

/// A tile of the tile set of a map.
#[derive(Clone)]
pub struct InlineTile<T> {
    /// Its character.
    pub symbol: char,
    /// Its tags.
    pub tags: Vec<T>,
    /// The line up to which it is solid.
    pub slope: Option<Slope>,
    /// Whether it can be broken.
    pub breakable: Option<Breakable>,
}

/// The rows of a text file: its lines, trimmed at both ends, without empty ones at the end. Returns none for a binary
/// file or a file of another format; the finding names the format.
pub fn text_rows<'t>(text: &'t str, file: FileId, diagnostics: &mut Diagnostics) -> Option<Vec<(&'t str, Span)>> {
    if let Some((at, what, help)) = other_format(text) {
        let length = text.get(at..).and_then(|rest| rest.chars().next()).map_or(0, char::len_utf8);
        diagnostics.report(NotRows { at: Span::new(file, at, at + length), what, help });
        return None;
    }
    let mut rows = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let row = line.trim();
        let from = start + (line.len() - line.trim_start().len());
        rows.push((row, Span::new(file, from, from + row.len())));
        start += line.len();
    }
    while rows.last().is_some_and(|(row, _)| row.is_empty()) {
        rows.pop();
    }
    Some(rows)
}

/// The byte at which another format is recognised, the name of the format, and help.
fn other_format(text: &str) -> Option<(usize, &'static str, Option<&'static str>)> {
    if let Some(at) = text.find(|c: char| c.is_control() && !c.is_whitespace()) {
        return Some((at, "binary data", None));
    }
    let trimmed = text.trim_start();
    let start = text.len() - trimmed.len();
    if trimmed.starts_with("<?xml") {
        return Some((start, "XML", None));
    }
    let is_json = trimmed.starts_with(['{', '[']) && serde_json::from_str::<IgnoredAny>(trimmed).is_ok();
    is_json.then_some((
        start,
        "JSON",
        Some("a legend is named after its level: `map vglc \"LEVEL\" legend \"LEGEND\" …`"),
    ))
}

/// The most frequent character of a row.
fn frequent(row: &str) -> char {
    let mut counts: BTreeMap<char, usize> = BTreeMap::new();
    row.chars().for_each(|c| *counts.entry(c).or_default() += 1);
    counts.into_iter().max_by_key(|(_, count)| *count).map_or('.', |(c, _)| c)
}

/// Where the characters of a row after the first `columns` begin.
fn rest_of(row: &str, span: Span, columns: usize) -> usize {
    span.range().start + row.char_indices().nth(columns).map_or(row.len(), |(byte, _)| byte)
}

/// Reads the rows of a map, top row first, each with its span. `set` is the name of the tile set and its place; it has
/// at most 65,536 tiles, and `others` are its characters that no row uses. Returns none if a row or a character does
/// not fit; the findings say which.
pub fn inline_map<T: Clone>(
    rows: &[(&str, Span)],
    whole: Span,
    set: (&str, Span),
    tile: (f64, f64),
    (tiles, others): (&[InlineTile<T>], &[char]),
    diagnostics: &mut Diagnostics,
) -> Option<TileMap<T>> {
    let Some(&(_, first_span)) = rows.first() else {
        diagnostics.report(EmptyMap { at: whole });
        return None;
    };
    // The most frequent length is the intended one; the first row of that length is shown beside the others.
    let mut lengths: Vec<usize> = rows.iter().map(|(row, _)| row.chars().count()).collect();
    lengths.sort_unstable();
    let runs = lengths.chunk_by(|a, b| a == b);
    let columns = runs.max_by_key(|run| (run.len(), run[0])).map_or(0, |run| run[0]);
    let model = rows.iter().find(|(row, _)| row.chars().count() == columns).map_or(first_span, |(_, span)| *span);
    if columns == 0 {
        diagnostics.report(EmptyMap { at: whole });
        return None;
    }
    let count = columns.saturating_mul(rows.len());
    if count > MAX_TILES {
        diagnostics.report(TooMany { what: "tiles".into(), count: count as u64, limit: MAX_TILES as u64, at: whole });
        return None;
    }
    let mut fits = true;
    let known: BTreeMap<char, u16> = tiles.iter().map(|t| t.symbol).zip(0..).collect();
    let mut unknown: BTreeMap<char, (Span, usize)> = BTreeMap::new();
    let mut cells = vec![0u16; count];
    for (index, (row, span)) in rows.iter().enumerate() {
        let length = row.chars().count();
        if length != columns {
            fits = false;
            let (fill, rest) = (frequent(row), Span::new(span.file(), rest_of(row, *span, columns), span.range().end));
            diagnostics.report(RowLength { at: *span, row: index + 1, length, expected: columns, model, fill, rest });
        }
        let base = (rows.len() - 1 - index) * columns;
        for (column, (byte, symbol)) in row.char_indices().enumerate() {
            match known.get(&symbol) {
                Some(&kind) if column < columns => cells[base + column] = kind,
                Some(_) => {}
                None => {
                    let start = span.range().start + byte;
                    let at = Span::new(span.file(), start, start + symbol.len_utf8());
                    unknown.entry(symbol).or_insert((at, 0)).1 += 1;
                }
            }
        }
    }
    for (symbol, (at, count)) in unknown {
        fits = false;
        let known = known.keys().chain(others).copied().collect();
        diagnostics.report(UnknownTile { symbol, at, count, tiles: set.0.to_string(), declared: set.1, known });
    }
    let kind =
        |t: &InlineTile<T>| TileKind { symbol: t.symbol, tags: t.tags.clone(), slope: t.slope, breakable: t.breakable };
    let kinds = tiles.iter().map(kind).collect();
    fits.then_some(TileMap { columns, rows: rows.len(), tile, kinds, cells })
}

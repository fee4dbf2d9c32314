//! Hovers of what is no name and no keyword: sides, `empty`, numbers with units, tiles of maps.

use std::ops::Range;

use crate::syntax::ast::{Item, Map, MapSource, SpaceItem, Tile, World, WorldItem};

use super::hover::Hover;
use crate::lsp::location::{FileOffset, Location};
use crate::lsp::text::cursor::{Block, CursorContext};
use crate::lsp::text::document_text::Text;
use crate::lsp::text::lexer::{Kind, tokens};
use crate::lsp::view::View;

/// The sides of a contact.
const SIDES: &[(&str, &str)] = &[
    ("below", "What is touched is under this collider: it stands on it."),
    ("above", "What is touched is over this collider: it hits it with its head, or carries it."),
    ("left", "What is touched is to the left of this collider."),
    ("right", "What is touched is to the right of this collider."),
];

/// A tile of an inline map.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct MapTile {
    pub world: String,
    pub space: String,
    /// From 0 at the left.
    pub column: usize,
    /// From 0 at the bottom.
    pub row: usize,
    /// From 0 at the top.
    pub line: usize,
    pub symbol: char,
    /// The statement that says what it stands for.
    pub declared: Option<String>,
    /// The range of the character.
    pub bytes: Range<usize>,
}

/// The hover at a position; `more` adds lines to that of a tile.
pub(super) fn hover_more(view: &View, at: &FileOffset, more: &dyn Fn(&MapTile) -> Vec<String>) -> Option<Hover> {
    let document = view.documents.get(&at.path)?;
    let code = document.text.code();
    let (bytes, markdown) = match map_tile(&document.text, at.byte) {
        Some(tile) => {
            let MapTile { world, space, symbol, column, row, .. } = &tile;
            let place = format!("`{symbol}` in column {column}, row {row} of `{world}.{space}`, counted from 0 below");
            let declared = tile.declared.as_ref().map(|line| format!("```hyped\n{line}\n```"));
            let parts: Vec<String> = declared.into_iter().chain([place]).chain(more(&tile)).collect();
            (tile.bytes, parts.join("\n\n"))
        }
        None => word(code, at.byte)?,
    };
    let text = std::sync::Arc::clone(&document.text);
    Some(Hover { at: Location { path: at.path.clone(), text, bytes }, markdown })
}

/// The hover of a side, of `empty`, of a number with a unit.
fn word(code: &str, byte: usize) -> Option<(Range<usize>, String)> {
    let token = tokens(code).find(|token| byte < token.at.end).filter(|token| token.at.start <= byte)?;
    let text = token.text(code);
    let cursor = CursorContext::at(code, token.at.start);
    let markdown = match token.kind {
        Kind::Number => unit(text)?,
        Kind::Word if text == "empty" && matches!(cursor.block(), Some(Block::Tiles | Block::Kinds)) => {
            "`empty`: no tag: nothing touches the tile, and nothing is stopped by it.\n\n```hyped\n'.': empty\n```"
                .into()
        }
        Kind::Word => {
            cursor.calls.last().filter(|call| call.name == "touching" && call.argument > 0)?;
            let (side, description) = SIDES.iter().find(|(side, _)| *side == text)?;
            format!("`{side}`: a side. {description}\n\n```hyped\nwhen touching(body, wall, {side}) -> next\n```")
        }
        _ => return None,
    };
    Some((token.at, markdown))
}

/// The description of a number with a unit.
fn unit(text: &str) -> Option<String> {
    let at = text.find(|c: char| c.is_ascii_alphabetic())?;
    let (number, unit) = text.split_at(at);
    let value: f64 = number.parse().ok()?;
    match unit {
        "s" => Some(format!("`{text}`: a time, {} ms", value * 1000.0)),
        "ms" => Some(format!("`{text}`: a time, {} s", value / 1000.0)),
        "frames" => Some(format!("`{text}`: a time in steps of the world: at `step 1/60`, {:.4} s", value / 60.0)),
        _ => None,
    }
}

/// The tile of an inline map at an offset.
pub(in crate::lsp) fn map_tile(text: &Text, byte: usize) -> Option<MapTile> {
    let code = text.code();
    let worlds =
        text.tree().items.iter().filter_map(|item| if let Item::World(world) = item { Some(world) } else { None });
    worlds.into_iter().filter(|world| world.span.range().contains(&byte)).find_map(|world| in_world(world, code, byte))
}

fn in_world(world: &World, code: &str, byte: usize) -> Option<MapTile> {
    let spaces = world.items.iter().filter_map(|i| if let WorldItem::Space(space) = i { Some(space) } else { None });
    for space in spaces {
        let maps = space.items.iter().filter_map(|i| if let SpaceItem::Map(map) = i { Some(&**map) } else { None });
        for Map { source, .. } in maps.filter(|map| map.span.range().contains(&byte)) {
            let MapSource::Inline(set, rows) = source else { continue };
            let (index, row) = rows.iter().enumerate().find(|(_, row)| row.span.range().contains(&byte))?;
            let start = row.span.range().start;
            let before = code.get(start..byte)?;
            let symbol = code.get(byte..)?.chars().next()?;
            let tiles = world.items.iter().find_map(|item| match item {
                WorldItem::Tiles(tiles) if tiles.name.text == set.text => Some(tiles),
                _ => None,
            });
            let tile = tiles.and_then(|tiles| tiles.tiles.iter().find(|tile| tile.symbol == symbol));
            return Some(MapTile {
                world: world.name.text.to_string(),
                space: space.name.text.to_string(),
                column: before.chars().count(),
                row: rows.len() - 1 - index,
                line: index,
                symbol,
                declared: tile.map(|tile| declaration(tile, code)),
                bytes: byte..byte + symbol.len_utf8(),
            });
        }
    }
    None
}

/// The line that declares a tile.
fn declaration(tile: &Tile, code: &str) -> String {
    let at = tile.symbol_span.range().start;
    let start = code.get(..at).and_then(|before| before.rfind(['\n', '{', ';'])).map_or(0, |at| at + 1);
    let line = code.get(start..).and_then(|rest| rest.split(['\n', ';']).next()).unwrap_or_default();
    let line = line.split("//").next().unwrap_or(line).trim();
    line.strip_suffix(['{', '}']).unwrap_or(line).trim_end().to_string()
}

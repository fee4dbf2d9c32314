//! Maps of spaces: inline, from text files, from levels of the Video Game Level Corpus, or given on the command line.

use std::collections::BTreeSet;

use crate::diagnostic::catalogue::names::DuplicateName;
use crate::level::{InlineTile, inline_map, legend, text_rows};
use crate::source::{FileId, Span};
use crate::syntax::ast::{self, MapSource, Name};

use super::checked::World;
use super::ids::SpaceId;
use super::names::{Table, unknown};
use super::population::Population;
use super::world::TileSet;
use super::{Checker, MAX_TILE_KINDS};

impl Checker<'_> {
    /// Reads a map into its space, and makes the instances of its tiles.
    pub(super) fn map(
        &mut self,
        map: &ast::Map,
        sets: &Table<TileSet<'_>>,
        first: &mut Option<Span>,
        (id, world): (SpaceId, &mut World),
        population: &mut Population,
    ) {
        if let Some(first) = *first {
            let name = world.spaces[id].name.text.clone();
            self.diagnostics.report(DuplicateName { kind: "the map of", name, first, second: map.span });
            return;
        }
        *first = Some(map.span);
        let sources = self.sources;
        let level = |file: FileId| text_rows(sources.file(file).text(), file);
        match &map.source {
            MapSource::Inline(tiles, rows) => {
                let rows: Vec<(&str, Span)> = rows.iter().map(|r| (r.text.as_str(), r.span)).collect();
                self.own_tiles(Some(rows), tiles, tiles.span, sets, (id, world), population);
            }
            MapSource::Text(tiles, path) => {
                let rows = self.text(path).map(level);
                self.own_tiles(rows, tiles, path.span, sets, (id, world), population);
            }
            MapSource::Vglc(path, legend) => {
                let rows = self.text(path).map(level);
                self.legend_tiles(rows, legend, path.span, (id, world), population);
            }
            MapSource::Open(tiles) => {
                self.open(id, world);
                self.own_tiles(self.level.map(level), tiles, map.span, sets, (id, world), population);
            }
            MapSource::OpenLegend(legend) => {
                self.open(id, world);
                self.legend_tiles(self.level.map(level), legend, map.span, (id, world), population);
            }
        }
    }

    /// The file that a map names, if it could be read.
    fn text(&self, path: &Name) -> Option<FileId> {
        self.texts.get(&path.span).copied()
    }

    /// Notes that the world's map is to be given on the command line.
    fn open(&mut self, id: SpaceId, world: &mut World) {
        self.checked.has_open_map = true;
        if self.level.is_none() {
            world.open = Some(id);
        }
    }

    /// A map with a tile set of the program; without rows only the set is checked.
    fn own_tiles(
        &mut self,
        rows: Option<Vec<(&str, Span)>>,
        tiles: &Name,
        at: Span,
        sets: &Table<TileSet<'_>>,
        (id, world): (SpaceId, &mut World),
        population: &mut Population,
    ) {
        let Some(set) = sets.get(&tiles.text) else {
            let fact = unknown("tile set", &tiles.text, tiles.span, sets.names());
            self.report_unknown(fact);
            return;
        };
        let called = format!("tiles {}", set.name.text);
        let declared = (called.as_str(), set.name.span);
        world.spaces[id].map =
            rows.and_then(|rows| inline_map(&rows, at, declared, set.tile, &set.tiles, &mut self.diagnostics));
        self.tile_instances(world, id, set, at, population);
    }

    /// A map whose tiles a legend describes, but for those that the program gives itself; without rows only these are
    /// checked, and the legend.
    fn legend_tiles(
        &mut self,
        rows: Option<Vec<(&str, Span)>>,
        syntax: &ast::Legend,
        at: Span,
        (id, world): (SpaceId, &mut World),
        population: &mut Population,
    ) {
        let lengths = &mut world.lengths;
        let (width, height) = (self.tile_side(&syntax.width, lengths), self.tile_side(&syntax.height, lengths));
        let known = self.text(&syntax.path);
        let known = known.and_then(|file| legend(self.sources.file(file), file, &mut self.diagnostics));
        let mut set = TileSet { name: syntax.path.clone(), tile: (1.0, 1.0), tiles: Vec::new(), spawns: Vec::new() };
        // What is wrong with the legend or with a side is said already.
        let mut rows = rows.filter(|_| known.is_some());
        match width.zip(height) {
            Some(tile) => set.tile = tile,
            None => rows = None,
        }
        // Tiles that the level does not have would only use up the numbers of tags and kinds.
        let cells = rows.iter().flatten().flat_map(|(row, _)| row.chars());
        let mut needed: BTreeSet<char> = cells.collect();
        for own in &syntax.tiles {
            needed.remove(&own.symbol);
        }
        for (symbol, tags) in known.into_iter().flatten() {
            if !needed.contains(&symbol) {
                self.checked.other_tags.extend(tags);
                continue;
            }
            if set.tiles.len() >= MAX_TILE_KINDS {
                self.too_many("kinds of tiles", MAX_TILE_KINDS, syntax.path.span);
                rows = None;
                break;
            }
            let tags = tags.into_iter().filter(|tag| tag != "empty");
            let tags = tags.map(|text| self.tag(&Name { text, span: syntax.path.span })).collect();
            set.tiles.push(InlineTile { symbol, tags });
            set.spawns.push(None);
        }
        self.tile_kinds(&syntax.tiles, &mut set);
        let declared = (syntax.path.text.as_str(), syntax.path.span);
        world.spaces[id].map =
            rows.and_then(|rows| inline_map(&rows, at, declared, set.tile, &set.tiles, &mut self.diagnostics));
        self.tile_instances(world, id, &set, at, population);
    }
}

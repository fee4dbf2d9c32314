//! Maps of spaces: inline, from text files, from levels of the Video Game Level Corpus, or given on the command line.
//! Maps of level editors continue in `editor_level`.

use std::collections::BTreeSet;

use crate::diagnostic::catalogue::names::DuplicateName;
use crate::diagnostic::catalogue::world::{KnownReading, NoCharacters, RedundantLegend, UnreadLevel};
use crate::ir::{Extremes, SpaceId, TileMap};
use crate::level::{Format, InlineTile, inline_map, legend, text_rows};
use crate::source::{FileId, Span};
use crate::syntax::ast::{self, MapSource, Name};
use crate::syntax::occurrence::NameKind;
use crate::syntax::{ANY_SYMBOL, symbol_name};

use super::checked::World;
use super::names::{Table, unknown};
use super::population::Population;
use super::world::TileSet;
use super::{Checker, MAX_TILE_KINDS};

/// The rows of a map, top row first; `None` if unknown.
type Rows<'r> = Option<Vec<(&'r str, Span)>>;

/// The program's own definition of a map's characters.
enum ProgramTiles<'s, 't> {
    /// A tile set.
    Set(&'s TileSet<'t>),
    /// A block of the map.
    Block(&'t [ast::Tile]),
}

/// The meaning of a map's characters.
struct MapContext<'s, 't> {
    own: ProgramTiles<'s, 't>,
    /// A legend for all other characters, as named in the program, and its file if it could be read.
    legend: Option<(Name, Option<FileId>)>,
    /// Width and height of a tile, px; `None` if they are wrong or unknown.
    tile: Option<(f64, f64)>,
    /// The span for findings about the whole map.
    at: Span,
}

impl<'a> Checker<'a> {
    /// Reads a map into its space, and makes the instances of its tiles.
    pub(super) fn map<'t>(
        &mut self,
        map: &'t ast::Map,
        sets: &Table<TileSet<'t>>,
        first: &mut Option<Span>,
        (id, world): (SpaceId, &mut World),
        population: &mut Population,
    ) {
        if let Some(first) = *first {
            let name = world.spaces[id].name.text.to_string();
            self.diagnostics.report(DuplicateName { kind: "the map of", name, first, second: map.span });
            return;
        }
        *first = Some(map.span);
        match &map.source {
            MapSource::Inline(tiles, rows) => {
                let rows: Vec<(&str, Span)> = rows.iter().map(|r| (&*r.text, r.span)).collect();
                let reading = self.own_set(tiles, sets, tiles.span);
                self.text_map(Some(rows), reading, (id, world), population);
            }
            MapSource::Text(tiles, path) => {
                let rows = self.text(path).and_then(|file| self.rows(file));
                let reading = self.own_set(tiles, sets, path.span);
                self.text_map(rows, reading, (id, world), population);
            }
            MapSource::Vglc(path, legend) => {
                let rows = self.text(path).and_then(|file| self.rows(file));
                let reading = self.with_legend(legend, path.span, world);
                self.text_map(rows, Some(reading), (id, world), population);
            }
            MapSource::Open(tiles) => {
                let reading = self.own_set(tiles, sets, map.span);
                self.open(reading, &[], (id, world), population);
            }
            MapSource::OpenLegend(legend) => {
                let reading = self.with_legend(legend, map.span, world);
                self.open(Some(reading), &[], (id, world), population);
            }
            MapSource::Tiled(path, kinds) => {
                let file = self.text(path).map(|file| (Format::Tiled, file, None));
                self.no_characters(kinds);
                self.editor_map(file, &kinds.kinds, path.span, (id, world), population);
            }
            MapSource::Ldtk(path, part, kinds) => {
                let part = part.as_ref().map(|part| &*part.text);
                let file = self.text(path).map(|file| (Format::Ldtk, file, part));
                self.no_characters(kinds);
                self.editor_map(file, &kinds.kinds, path.span, (id, world), population);
            }
            MapSource::OpenAll(kinds) => {
                let reading =
                    MapContext { own: ProgramTiles::Block(&kinds.tiles), legend: None, tile: None, at: map.span };
                self.open(Some(reading), &kinds.kinds, (id, world), population);
                if self.level.map.is_none() {
                    self.editor_map(None, &kinds.kinds, map.span, (id, world), population);
                }
            }
        }
    }

    /// The file that a map names, if it could be read.
    fn text(&self, path: &Name) -> Option<FileId> {
        self.texts.get(&path.span).copied()
    }

    /// The rows of a level, if the file contains them.
    fn rows(&mut self, file: FileId) -> Rows<'a> {
        let sources = self.sources;
        text_rows(sources.file(file).text(), file, &mut self.diagnostics)
    }

    /// Reports characters in a map whose tiles have names.
    fn no_characters(&mut self, kinds: &ast::Kinds) {
        for tile in &kinds.tiles {
            self.diagnostics.report(NoCharacters { at: tile.symbol_span });
        }
    }

    /// Uses a tile set of the program, if there is one of this name.
    fn own_set<'s, 't>(&mut self, name: &Name, sets: &'s Table<TileSet<'t>>, at: Span) -> Option<MapContext<'s, 't>> {
        if let Some((declared, _)) = sets.entry(&name.text) {
            self.record_use(NameKind::TileSet, name.span, declared.span);
        }
        let Some(set) = sets.get(&name.text) else {
            let fact = unknown("tile set", &name.text, name.span, sets.names());
            self.report_unknown(fact);
            return None;
        };
        Some(MapContext { own: ProgramTiles::Set(set), legend: None, tile: Some(set.tile), at })
    }

    /// Uses a legend, except for tiles that the program defines.
    fn with_legend<'s, 't>(&mut self, syntax: &'t ast::Legend, at: Span, world: &mut World) -> MapContext<'s, 't> {
        let lengths = &mut world.lengths;
        let (width, height) = (self.tile_side(&syntax.width, lengths), self.tile_side(&syntax.height, lengths));
        let legend = Some((syntax.path.clone(), self.text(&syntax.path)));
        MapContext { own: ProgramTiles::Block(&syntax.tiles), legend, tile: width.zip(height), at }
    }

    /// A map from the command line, present or missing. Its legend and tile size take precedence over those of the
    /// world.
    fn open(
        &mut self,
        reading: Option<MapContext<'_, '_>>,
        kinds: &[ast::Kind],
        (id, world): (SpaceId, &mut World),
        to: &mut Population,
    ) {
        self.checked.has_open_map = true;
        if self.level.map.is_none() {
            world.open = Some(id);
            self.awaited = Some(reading.as_ref().map_or(world.spaces[id].name.span, |reading| reading.at));
        }
        let Some(mut reading) = reading else { return };
        if let Some((file, format)) = self.level.map.and_then(|f| Some((f, Format::of(&self.sources.file(f).path)?))) {
            let part = self.level.part.clone();
            let given = [(self.level.legend.is_some(), "--legend"), (self.level.tile.is_some(), "--tile")];
            for (_, option) in given.into_iter().filter(|(is_given, _)| *is_given) {
                let path = self.sources.file(file).path.display().to_string();
                self.diagnostics.report(KnownReading { at: reading.at, option, path });
            }
            return self.editor_map(Some((format, file, part.as_deref())), kinds, reading.at, (id, world), to);
        }
        if let Some(file) = self.level.legend {
            let text = self.sources.file(file).path.display().to_string();
            reading.legend = Some((Name { text: text.into(), span: Span::new(file, 0, 0) }, Some(file)));
        }
        reading.tile = self.level.tile.or(reading.tile);
        let empty = matches!(reading.own, ProgramTiles::Block([]));
        let missing = (empty && reading.legend.is_none(), reading.tile.is_none());
        if let (Some(file), true) = (self.level.map, missing.0 || missing.1) {
            let path = self.sources.file(file).path.display().to_string();
            self.diagnostics.report(UnreadLevel { at: reading.at, path, legend: missing.0, tile: missing.1 });
            return self.text_map(None, Some(reading), (id, world), to);
        }
        let rows = self.level.map.and_then(|file| self.rows(file));
        self.text_map(rows, Some(reading), (id, world), to);
    }

    /// A map from rows of characters. Without readable rows, only the program's own definitions and the legend are
    /// checked.
    fn text_map(
        &mut self,
        mut rows: Rows<'_>,
        reading: Option<MapContext<'_, '_>>,
        (id, world): (SpaceId, &mut World),
        population: &mut Population,
    ) {
        let Some(MapContext { own, legend, tile, at }) = reading else { return };
        let called = match &own {
            ProgramTiles::Set(set) => Name { text: format!("tiles {}", set.name.text).into(), span: set.name.span },
            ProgramTiles::Block(_) => {
                legend.as_ref().map_or(Name { text: "map level".into(), span: at }, |(name, _)| name.clone())
            }
        };
        let mut set = TileSet {
            name: called.clone(),
            tile: tile.unwrap_or((1.0, 1.0)),
            tiles: Vec::new(),
            spawns: Vec::new(),
            others: Vec::new(),
        };
        if let Some((name, file)) = legend {
            self.legend_tiles(&name, file, &own, &mut rows, &mut set);
        }
        match own {
            ProgramTiles::Set(own) => {
                set.tiles.extend(own.tiles.iter().map(InlineTile::clone));
                set.spawns.extend(own.spawns.iter().copied());
            }
            ProgramTiles::Block(tiles) => self.tile_kinds(tiles, &mut set, tile, world),
        }
        if let Some(rows) = &rows {
            self.excuse_symbols(rows, &mut set);
        }
        // A wrong side is already reported.
        let rows = rows.filter(|_| tile.is_some());
        let declared = (&*called.text, called.span);
        world.spaces[id].map = rows.and_then(|rows| {
            inline_map(&rows, at, declared, set.tile, (&set.tiles, &set.others), &mut self.diagnostics)
        });
        if let Some((width, height)) = world.spaces[id].map.as_ref().map(TileMap::size)
            && self.length(width.greatest(height), at).is_none()
        {
            world.spaces[id].map = None;
            return;
        }
        self.tile_instances(world, id, &set, at, population);
    }

    /// Adds the characters whose tiles could not be parsed, which is reported already.
    fn excuse_symbols(&self, rows: &[(&str, Span)], set: &mut TileSet<'_>) {
        let excuses_all = self.poisoned_names.contains(ANY_SYMBOL);
        if !excuses_all && !self.poisoned_names.iter().any(|name| name.starts_with(ANY_SYMBOL)) {
            return;
        }
        let used: BTreeSet<char> = rows.iter().flat_map(|(row, _)| row.chars()).collect();
        let known: BTreeSet<char> = set.tiles.iter().map(|tile| tile.symbol).collect();
        let excused = used.difference(&known).copied();
        let excused = excused.filter(|symbol| excuses_all || self.poisoned_names.contains(&symbol_name(*symbol)));
        let room = MAX_TILE_KINDS.saturating_sub(set.tiles.len());
        let tile = |symbol| InlineTile { symbol, tags: Vec::new(), slope: None, breakable: None };
        set.tiles.extend(excused.take(room).map(tile));
    }

    /// Adds the tiles of a legend that the level uses and the program does not define; drops the rows if the legend
    /// cannot be read.
    fn legend_tiles(
        &mut self,
        name: &Name,
        file: Option<FileId>,
        own: &ProgramTiles<'_, '_>,
        rows: &mut Rows<'_>,
        set: &mut TileSet<'_>,
    ) {
        let known = file.and_then(|file| legend(self.sources.file(file), file, &mut self.diagnostics));
        let Some(known) = known else {
            *rows = None;
            return;
        };
        let owned: BTreeSet<char> = match own {
            ProgramTiles::Set(set) => set.tiles.iter().map(|t| t.symbol).collect(),
            ProgramTiles::Block(tiles) => tiles.iter().map(|t| t.symbol).collect(),
        };
        if let ProgramTiles::Set(own) = own
            && known.iter().all(|(symbol, _)| owned.contains(symbol))
        {
            self.diagnostics.report(RedundantLegend {
                legend: name.text.to_string(),
                tiles: own.name.text.to_string(),
                at: own.name.span,
            });
        }
        // Unused tiles would only take up tags and kinds.
        let cells = rows.iter().flatten().flat_map(|(row, _)| row.chars());
        let needed: BTreeSet<char> = cells.filter(|symbol| !owned.contains(symbol)).collect();
        for (symbol, tags) in known {
            if !needed.contains(&symbol) {
                self.checked.other_tags.extend(tags);
                set.others.extend((!owned.contains(&symbol)).then_some(symbol));
                continue;
            }
            if set.tiles.len() >= MAX_TILE_KINDS {
                self.too_many("kinds of tiles", MAX_TILE_KINDS, name.span);
                *rows = None;
                break;
            }
            let tags = tags.into_iter().filter(|tag| tag != "empty");
            let tags = tags.map(|text| self.tag(&Name { text: text.into(), span: name.span })).collect();
            set.tiles.push(InlineTile { symbol, tags, slope: None, breakable: None });
            set.spawns.push(None);
        }
    }
}

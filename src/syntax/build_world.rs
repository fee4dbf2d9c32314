//! Builds the syntax tree from pest's pairs: worlds, tiles, spaces, goals, conditions.

use pest::iterators::Pair;

use super::Rule;
use super::ast::{
    Assignment, Breakable, Collide, Condition, Expr, Kind, Kinds, Legend, Limit, Link, Map, MapSource, Name, Place,
    PlaceHeight, Player, Question, Rectangle, Response, Slope, Solid, Space, SpaceItem, TagLook, Tile, TileSpawn,
    Tiles, WorldItem, Wrap,
};
use super::build::Builder;
use super::part::{Part, Parts, parts};
use crate::source::Span;

/// The rules of the parts of spaces.
const SPACE_ITEMS: Parts<SpaceItem> = Parts {
    next: Rule::next_space_item,
    plain: Rule::next_space_item,
    build: |b, pair, end| Some((b.space_item(pair), end)),
};
/// The rules of the tiles of a set.
const TILES: Parts<Tile> = Parts {
    next: Rule::next_tile,
    plain: Rule::next_tile,
    build: |b, pair, end| {
        let tile = if pair.as_rule() == Rule::bad_tile {
            b.bad_tile(Rule::only_tile, pair);
            None
        } else {
            b.tile(pair)
        };
        Some((tile, end))
    },
};

impl<'a> Builder<'a> {
    /// A part of a world.
    pub(super) fn world_part(&mut self, pair: &Pair<'_, Rule>, end: usize) -> Part<WorldItem> {
        let (start, inner) = (self.start_of(pair), parts(pair));
        match pair.as_rule() {
            Rule::space_head => {
                let name = self.name(inner.first()?);
                let (items, end) = self.block(&SPACE_ITEMS, end)?;
                Some((Some(WorldItem::Space(Space { name, items, span: self.span(start, end) }.into())), end))
            }
            Rule::tiles_head => {
                let name = self.name(inner.first()?);
                let size = parts(inner.get(1)?);
                let length = |at: usize| size.get(at).and_then(|length| self.primary(length));
                let (width, height) = (length(0), length(1));
                let (tiles, end) = self.block(&TILES, end)?;
                let span = self.span(start, end);
                let set = width.zip(height).map(|(width, height)| Tiles { name, width, height, tiles, span });
                Some((set.map(|set| WorldItem::Tiles(set.into())), end))
            }
            Rule::test_head => {
                let (test, end) = self.test(pair, end)?;
                Some((test.map(|test| WorldItem::Test(test.into())), end))
            }
            Rule::bad_world_item => {
                self.bad(Rule::only_world_item, pair);
                Some((None, end))
            }
            _ => Some((self.world_item(pair), end)),
        }
    }

    /// A part of a space.
    fn space_item(&mut self, pair: &Pair<'_, Rule>) -> Option<SpaceItem> {
        match pair.as_rule() {
            Rule::link => self.link(pair).map(|l| SpaceItem::Link(l.into())),
            Rule::solid => self.solid(pair),
            Rule::bounds => self.rectangle(parts(pair).first()?, pair).map(|r| SpaceItem::Bounds(r.into())),
            Rule::wrap => {
                let is_vertical = parts(pair).first()?.as_str() == "vertical";
                Some(SpaceItem::Wrap(Wrap { is_vertical, span: self.span_of(pair) }))
            }
            Rule::map => self.map(pair).map(|m| SpaceItem::Map(m.into())),
            Rule::place => self.place(pair).map(|p| SpaceItem::Place(p.into())),
            _ => {
                self.bad(Rule::only_space_item, pair);
                None
            }
        }
    }

    fn world_item(&mut self, pair: &Pair<'_, Rule>) -> Option<WorldItem> {
        let inner = parts(pair);
        let span = self.span_of(pair);
        let first = inner.first()?;
        Some(match pair.as_rule() {
            Rule::step => WorldItem::Step(self.expression(first)?.into()),
            Rule::collide => {
                let (left, right) = (self.names(first), self.names(inner.get(1)?));
                WorldItem::Collide(Collide { left, right, response: self.response(inner.get(2)?)?, span }.into())
            }
            Rule::limit => {
                let (entity, count) = (self.name(first), self.expression(inner.get(1)?)?);
                WorldItem::Limit(Limit { entity, count, span }.into())
            }
            Rule::tag_look => {
                let (tags, appearance) = (self.names(first), self.appearance(inner.get(1)?)?);
                WorldItem::Look(TagLook { tags, appearance, span }.into())
            }
            Rule::player => {
                let (number, instance) = (self.name(first), self.name(inner.get(1)?));
                WorldItem::Player(Player { number, instance, span }.into())
            }
            Rule::condition => WorldItem::Condition(self.condition(pair)?.into()),
            Rule::goal => WorldItem::Goal(self.question(&inner)?.into()),
            Rule::never => WorldItem::Never(self.question(&inner)?.into()),
            _ => return None,
        })
    }

    fn question(&mut self, inner: &[Pair<'_, Rule>]) -> Option<Question> {
        Some(Question { name: self.name(inner.first()?), predicate: self.expression(inner.get(1)?)? })
    }

    /// `condition name = predicate`, also of an entity.
    pub(super) fn condition(&mut self, pair: &Pair<'_, Rule>) -> Option<Condition> {
        let inner = parts(pair);
        let value = inner.iter().rfind(|p| p.as_rule() == Rule::expression)?;
        Some(Condition { name: self.name(inner.first()?), value: self.expression(value)?, span: self.span_of(pair) })
    }

    fn response(&mut self, pair: &Pair<'_, Rule>) -> Option<Response> {
        let bounce = match pair.clone().into_inner().find(|p| p.as_rule() == Rule::bounce) {
            Some(bounce) => Some(self.expression(parts(&bounce).first()?)?),
            None => None,
        };
        let has = |rule: Rule| pair.clone().into_inner().any(|p| p.as_rule() == rule);
        Some(Response {
            block: has(Rule::word_block),
            from_above: has(Rule::word_above),
            keep_velocity: has(Rule::keep_velocity),
            carry: has(Rule::carry),
            bounce,
            span: self.span_of(pair),
        })
    }

    fn tiles(&mut self, block: &Pair<'_, Rule>) -> Vec<Tile> {
        let mut tiles = Vec::new();
        for tile in parts(block) {
            match tile.as_rule() {
                Rule::bad_tile => self.bad_tile(Rule::only_tile, &tile),
                _ => tiles.extend(self.tile(&tile)),
            }
        }
        tiles
    }

    fn tile(&mut self, pair: &Pair<'_, Rule>) -> Option<Tile> {
        let inner = parts(pair);
        let symbol = inner.first()?;
        let character = symbol.clone().into_inner().next()?.as_str().chars().next()?;
        let (tags, spawn) = self.meaning(inner.get(1)?)?;
        let slope = self.slope(&inner)?;
        let breakable = self.breakable(&inner)?;
        Some(Tile { symbol: character, symbol_span: self.span_of(symbol), tags, slope, breakable, spawn })
    }

    /// `slope (x, y)-(x, y)`, if that is written; none if it cannot be read.
    #[allow(clippy::option_option, reason = "what is left out, and what cannot be read")]
    fn slope(&mut self, tile: &[Pair<'_, Rule>]) -> Option<Option<Box<Slope>>> {
        let Some(pair) = tile.iter().find(|pair| pair.as_rule() == Rule::slope) else { return Some(None) };
        let points = parts(pair);
        let end = |at: usize| -> Option<[Expr; 2]> { self.expressions(&parts(points.get(at)?))?.try_into().ok() };
        let ends = [end(0)?, end(1)?];
        Some(Some(Box::new(Slope { ends, span: self.span_of(pair) })))
    }

    /// `breakable restore after time`, if that is written; none if it cannot be read.
    #[allow(clippy::option_option, reason = "what is left out, and what cannot be read")]
    fn breakable(&mut self, tile: &[Pair<'_, Rule>]) -> Option<Option<Box<Breakable>>> {
        let Some(pair) = tile.iter().find(|pair| pair.as_rule() == Rule::breakable) else { return Some(None) };
        let restore = parts(pair).into_iter().find(|part| part.as_rule() == Rule::restore);
        let time = restore.and_then(|restore| parts(&restore).into_iter().find(|p| p.as_rule() == Rule::expression));
        let restore = match time {
            Some(time) => Some(self.expression(&time)?),
            None => None,
        };
        Some(Some(Box::new(Breakable { restore, span: self.span_of(pair) })))
    }

    /// The meaning of a tile: tags, or a spawn.
    fn meaning(&mut self, what: &Pair<'_, Rule>) -> Option<(Vec<Name>, Option<TileSpawn>)> {
        if what.as_rule() != Rule::tile_spawn {
            return Some((self.names(what), None));
        }
        let inner = parts(what);
        let entity = self.name(inner.first()?);
        let of = |rule: Rule| inner.iter().find(|part| part.as_rule() == rule);
        let name = of(Rule::tile_name).and_then(|named| Some(self.name(parts(named).first()?)));
        let settings = self.settings(of(Rule::settings));
        let whole = self.span_of(what);
        let last = name.as_ref().map_or(entity.span, |name| name.span);
        let span = Span::new(whole.file(), whole.range().start, last.range().end);
        Some((Vec::new(), Some(TileSpawn { entity, name, settings, span, whole })))
    }

    /// The settings of an instance.
    fn settings(&mut self, block: Option<&Pair<'_, Rule>>) -> Vec<Assignment> {
        let mut settings = Vec::new();
        for setting in block.map(parts).unwrap_or_default() {
            match setting.as_rule() {
                Rule::bad_setting => self.bad(Rule::only_setting, &setting),
                _ => settings.extend(self.assignment(&setting)),
            }
        }
        settings
    }

    fn kinds(&mut self, block: Option<&Pair<'_, Rule>>) -> Kinds {
        let mut found = Kinds::default();
        for item in block.map(parts).unwrap_or_default() {
            match item.as_rule() {
                Rule::bad_kind => self.bad_tile(Rule::only_kind, &item),
                Rule::tile => found.tiles.extend(self.tile(&item)),
                _ => {
                    let inner = parts(&item);
                    let Some((name, what)) = inner.first().zip(inner.get(1)) else { continue };
                    let Some((tags, spawn)) = self.meaning(what) else { continue };
                    let Some((slope, breakable)) = self.slope(&inner).zip(self.breakable(&inner)) else { continue };
                    found.kinds.push(Kind { name: self.name(name), tags, slope, breakable, spawn });
                }
            }
        }
        found
    }

    fn map(&mut self, pair: &Pair<'_, Rule>) -> Option<Map> {
        let map = parts(pair).into_iter().next()?;
        let inner = parts(&map);
        let Some(first) = inner.first() else {
            return Some(Map { source: MapSource::OpenAll(Kinds::default()), span: self.span_of(pair) });
        };
        let source = match map.as_rule() {
            Rule::map_inline => {
                let rows = parts(inner.get(1)?)
                    .iter()
                    .filter(|row| row.as_rule() == Rule::map_row)
                    .filter_map(|row| row.clone().into_inner().find(|c| c.as_rule() == Rule::map_cells))
                    .map(|cells| self.name(&cells))
                    .collect();
                MapSource::Inline(self.name(first), rows)
            }
            Rule::map_from => MapSource::Text(self.name(first), self.name(inner.get(1)?)),
            Rule::map_vglc => MapSource::Vglc(self.name(first), self.legend(inner.get(1)?, inner.get(2))?),
            _ if first.as_rule() == Rule::legend => MapSource::OpenLegend(self.legend(first, inner.get(1))?),
            Rule::map_tiled => MapSource::Tiled(self.name(first), self.kinds(inner.get(1))),
            Rule::map_ldtk => {
                let level = inner.get(1).filter(|p| p.as_rule() == Rule::text).map(|p| self.name(p));
                let block = inner.iter().find(|p| p.as_rule() == Rule::kind_block);
                MapSource::Ldtk(self.name(first), level, self.kinds(block))
            }
            _ if first.as_rule() == Rule::kind_block => MapSource::OpenAll(self.kinds(Some(first))),
            _ => MapSource::Open(self.name(first)),
        };
        Some(Map { source, span: self.span_of(pair) })
    }

    fn legend(&mut self, pair: &Pair<'_, Rule>, tiles: Option<&Pair<'_, Rule>>) -> Option<Legend> {
        let inner = parts(pair);
        let size = parts(inner.get(1)?);
        Some(Legend {
            path: self.name(inner.first()?),
            width: self.primary(size.first()?)?,
            height: self.primary(size.get(1)?)?,
            tiles: tiles.map_or(Vec::new(), |block| self.tiles(block)),
            span: self.span_of(pair),
        })
    }

    fn link(&mut self, pair: &Pair<'_, Rule>) -> Option<Link> {
        let inner = parts(pair);
        let guard = match inner.get(3) {
            Some(guard) => Some(self.expression(guard)?),
            None => None,
        };
        Some(Link {
            from: self.rectangle(inner.first()?, inner.first()?)?,
            space: self.name(inner.get(1)?),
            to: self.rectangle(inner.get(2)?, inner.get(2)?)?,
            guard,
            span: self.span_of(pair),
        })
    }

    fn solid(&self, pair: &Pair<'_, Rule>) -> Option<SpaceItem> {
        let inner = parts(pair);
        let tags = self.names(inner.first()?);
        let rectangle = self.rectangle(inner.get(1)?, pair)?;
        Some(SpaceItem::Solid(Solid { tags, rectangle }.into()))
    }

    fn rectangle(&self, pair: &Pair<'_, Rule>, line: &Pair<'_, Rule>) -> Option<Rectangle> {
        let sides: [Expr; 4] = self.expressions(&parts(pair))?.try_into().ok()?;
        Some(Rectangle { sides: Box::new(sides), span: self.span_of(line) })
    }

    fn place(&mut self, pair: &Pair<'_, Rule>) -> Option<Place> {
        let inner = parts(pair);
        let point = parts(inner.get(2)?);
        let settings = self.settings(inner.get(3));
        Some(Place {
            name: self.name(inner.first()?),
            entity: self.name(inner.get(1)?),
            x: self.expression(point.first()?)?,
            y: match point.get(1)? {
                standing if standing.as_rule() == Rule::standing => {
                    PlaceHeight::Above(self.name(parts(standing).iter().find(|part| part.as_rule() == Rule::tag)?))
                }
                y => PlaceHeight::At(self.expression(y)?),
            },
            settings,
            span: self.span_of(pair),
        })
    }
}

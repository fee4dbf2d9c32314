//! The syntax tree from pest's pairs: worlds, tiles, spaces, goals.

use pest::iterators::Pair;

use super::Rule;
use super::ast::{
    Collide, Expr, Map, Place, Player, Question, Rectangle, Response, Solid, Space, SpaceItem, Tile, Tiles, World,
    WorldItem,
};
use super::build::{Builder, parts};

impl Builder<'_> {
    pub(super) fn world(&mut self, pair: &Pair<'_, Rule>, doc: Option<String>) -> Option<World> {
        let inner = parts(pair);
        let name = self.name(inner.first()?);
        let mut items = Vec::new();
        for item in parts(inner.get(1)?) {
            match item.as_rule() {
                Rule::bad_world_item => self.bad(Rule::only_world_item, &item),
                Rule::later_world_item => self.later(&item),
                _ => items.extend(self.world_item(&item)),
            }
        }
        Some(World { name, items, doc, span: self.span_of(pair) })
    }

    fn world_item(&mut self, pair: &Pair<'_, Rule>) -> Option<WorldItem> {
        let inner = parts(pair);
        let span = self.span_of(pair);
        let first = inner.first()?;
        Some(match pair.as_rule() {
            Rule::step => WorldItem::Step(self.expression(first)?),
            Rule::collide => WorldItem::Collide(Collide {
                left: self.names(first),
                right: self.names(inner.get(1)?),
                response: self.response(inner.get(2)?),
                span,
            }),
            Rule::tiles => {
                let size = parts(inner.get(1)?);
                let mut tiles = Vec::new();
                for tile in parts(inner.get(2)?) {
                    match tile.as_rule() {
                        Rule::bad_tile => self.bad(Rule::only_tile, &tile),
                        _ => tiles.extend(self.tile(&tile)),
                    }
                }
                WorldItem::Tiles(Tiles {
                    name: self.name(first),
                    width: self.primary(size.first()?)?,
                    height: self.primary(size.get(1)?)?,
                    tiles,
                    span,
                })
            }
            Rule::space => {
                let mut items = Vec::new();
                for item in parts(inner.get(1)?) {
                    match item.as_rule() {
                        Rule::bad_space_item => self.bad(Rule::only_space_item, &item),
                        Rule::later_space_item => self.later(&item),
                        Rule::solid => items.extend(self.solid(&item)),
                        Rule::bounds => {
                            let rectangle = parts(&item).first().and_then(|r| self.rectangle(r, &item));
                            items.extend(rectangle.map(SpaceItem::Bounds));
                        }
                        Rule::map => items.extend(self.map(&item).map(SpaceItem::Map)),
                        Rule::place => items.extend(self.place(&item).map(|p| SpaceItem::Place(Box::new(p)))),
                        _ => {}
                    }
                }
                WorldItem::Space(Space { name: self.name(first), items, span })
            }
            Rule::player => {
                WorldItem::Player(Player { number: self.name(first), instance: self.name(inner.get(1)?), span })
            }
            Rule::goal => WorldItem::Goal(self.question(&inner)?),
            Rule::never => WorldItem::Never(self.question(&inner)?),
            _ => return None,
        })
    }

    fn question(&mut self, inner: &[Pair<'_, Rule>]) -> Option<Question> {
        Some(Question { name: self.name(inner.first()?), predicate: self.expression(inner.get(1)?)? })
    }

    fn response(&self, pair: &Pair<'_, Rule>) -> Response {
        let has = |rule: Rule| pair.clone().into_inner().any(|p| p.as_rule() == rule);
        Response {
            block: has(Rule::word_block),
            from_above: has(Rule::word_above),
            keep_velocity: has(Rule::keep_velocity),
            carry: has(Rule::carry),
            span: self.span_of(pair),
        }
    }

    fn tile(&mut self, pair: &Pair<'_, Rule>) -> Option<Tile> {
        let inner = parts(pair);
        let symbol = inner.first()?;
        let character = symbol.clone().into_inner().next()?.as_str().chars().next()?;
        let tags = inner.get(1)?;
        if tags.as_rule() == Rule::later_tile {
            self.later(tags);
        }
        let tags = if tags.as_rule() == Rule::tags { self.names(tags) } else { Vec::new() };
        Some(Tile { symbol: character, symbol_span: self.span_of(symbol), tags })
    }

    fn map(&mut self, pair: &Pair<'_, Rule>) -> Option<Map> {
        let inner = parts(pair);
        let rows = parts(inner.get(1)?)
            .iter()
            .filter(|row| row.as_rule() == Rule::map_row)
            .filter_map(|row| row.clone().into_inner().find(|c| c.as_rule() == Rule::map_cells))
            .map(|cells| self.name(&cells))
            .collect();
        Some(Map { tiles: self.name(inner.first()?), rows, span: self.span_of(pair) })
    }

    fn solid(&self, pair: &Pair<'_, Rule>) -> Option<SpaceItem> {
        let inner = parts(pair);
        let tags = self.names(inner.first()?);
        let rectangle = self.rectangle(inner.get(1)?, pair)?;
        Some(SpaceItem::Solid(Solid { tags, rectangle }))
    }

    fn rectangle(&self, pair: &Pair<'_, Rule>, line: &Pair<'_, Rule>) -> Option<Rectangle> {
        let sides: [Expr; 4] = self.expressions(&parts(pair))?.try_into().ok()?;
        Some(Rectangle { sides: Box::new(sides), span: self.span_of(line) })
    }

    fn place(&mut self, pair: &Pair<'_, Rule>) -> Option<Place> {
        let inner = parts(pair);
        let point = parts(inner.get(2)?);
        let mut settings = Vec::new();
        if let Some(block) = inner.get(3) {
            for setting in parts(block) {
                match setting.as_rule() {
                    Rule::bad_setting => self.bad(Rule::only_setting, &setting),
                    _ => settings.extend(self.assignment(&setting)),
                }
            }
        }
        Some(Place {
            name: self.name(inner.first()?),
            entity: self.name(inner.get(1)?),
            x: self.expression(point.first()?)?,
            y: self.expression(point.get(1)?)?,
            settings,
            span: self.span_of(pair),
        })
    }
}

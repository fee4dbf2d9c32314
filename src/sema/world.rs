//! Worlds: the step, collision rules, tiles and maps, placed instances with their initial values, players, goals.

use crate::ir::{Arithmetic, Bounce, Id, IdVec, MAX_COLLIDE_LINES, Origin, Push, Response, SpaceId, TagId};
use crate::ordered::Ordered;

use std::rc::Rc;

use crate::diagnostic::catalogue::syntax::Misplaced;
use crate::diagnostic::catalogue::types::OutOfRange;
use crate::diagnostic::catalogue::world::{BadPlayer, BadStep, BadTile, MissingLevel};
use crate::level::{InlineTile, MAX_LENGTH};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, Name, SpaceItem, WorldItem};
use crate::syntax::occurrence::NameKind;

use super::checked::{CollideRule, Link, Player, Question, Solid, Space, Term, TermKind, World};
use super::constant::ConstantContext;
use super::expression::{Scope, WorldNames};
use super::names::{Table, unknown};
use super::population::Population;
use super::room::{MapSize, Room};
use super::test::Questions;
use super::{Checker, MAX_TILE_KINDS};

/// A tile set: its size, its tiles, and their spawns.
pub(super) struct TileSet<'a> {
    pub name: Name,
    pub tile: (f64, f64),
    pub tiles: Vec<InlineTile<TagId>>,
    /// Per tile.
    pub spawns: Vec<Option<&'a ast::TileSpawn>>,
    /// Characters of a legend that the level does not use.
    pub others: Vec<char>,
}

impl Checker<'_> {
    /// Checks a world and adds it to the program.
    pub(super) fn world(&mut self, syntax: &ast::World) {
        self.record_declaration(NameKind::World, &syntax.name);
        self.worlds.declare(&syntax.name, (), &mut self.diagnostics);
        let mut world = World {
            name: syntax.name.clone(),
            step: (1, 60),
            lengths: Vec::new(),
            times: Vec::new(),
            collide: Vec::new(),
            body: syntax.items.iter().find_map(|item| match item {
                WorldItem::Tiles(tiles) => Some(tiles.name.span),
                WorldItem::Space(space) => Some(space.name.span),
                _ => None,
            }),
            spaces: IdVec::new(),
            instances: IdVec::new(),
            limits: Vec::new(),
            looks: Vec::new(),
            map_looks: Vec::new(),
            players: IdVec::new(),
            goals: IdVec::new(),
            nevers: IdVec::new(),
            tests: Vec::new(),
            conditions: Box::default(),
            open: None,
            span: syntax.span,
        };
        let mut steps: Table<()> = Table::new("the step");
        let mut sets: Table<TileSet<'_>> = Table::new("tile set");
        // Settings of tiles may be numbers of steps.
        for item in &syntax.items {
            let WorldItem::Step(e) = item else { continue };
            let name = Name { text: "step".into(), span: e.span };
            if steps.declare(&name, (), &mut self.diagnostics)
                && let Some(step) = self.step_of(e)
            {
                world.step = step;
            }
        }
        self.step = world.step;
        for item in &syntax.items {
            match item {
                WorldItem::Tiles(tiles) => self.tiles(tiles, &mut sets, &mut world),
                WorldItem::Collide(line) if world.collide.len() == MAX_COLLIDE_LINES => {
                    self.too_many("lines of `collide`", MAX_COLLIDE_LINES, line.span);
                    break;
                }
                WorldItem::Collide(line) => world.collide.extend(self.collide(line)),
                _ => {}
            }
        }
        let mut population = Population::new(world.step);
        let mut spaces: Table<SpaceId> = Table::new("space");
        let mut sizes = Vec::new();
        let parts = syntax.items.iter().filter_map(|i| if let WorldItem::Space(s) = i { Some(s) } else { None });
        // Maps first: what else is in a space can be measured by any of them.
        for space in parts.clone() {
            let id = world.spaces.push(Space {
                name: space.name.clone(),
                map: None,
                solids: Vec::new(),
                bounds: None,
                wraps: [false; 2],
                links: Vec::new(),
            });
            self.record_declaration(NameKind::Space, &space.name);
            spaces.declare(&space.name, id, &mut self.diagnostics);
            let mut map_at = None;
            for (at, item) in space.items.iter().enumerate() {
                if let SpaceItem::Map(map) = item {
                    population.part = (id, at);
                    self.map(map, &sets, &mut map_at, (id, &mut world), &mut population);
                }
            }
            let size = MapSize::of(world.spaces[id].map.as_ref());
            self.has_unread_map |= map_at.is_some() && !size.is_known;
            sizes.push((space.name.clone(), map_at.map(|_| size)));
        }
        for (id, space) in parts.enumerate() {
            let id = SpaceId(id as u32);
            let mut bounds: Table<()> = Table::new("the bounds of");
            let mut wraps = Vec::new();
            for (at, item) in space.items.iter().enumerate() {
                match item {
                    SpaceItem::Map(_) | SpaceItem::Link(_) => {}
                    SpaceItem::Solid(solid) => {
                        let tags = solid.tags.iter().map(|t| self.carried(t)).collect();
                        if let Some(rect) = self.rectangle(&solid.rectangle, &sizes, &mut world.lengths) {
                            let span = solid.rectangle.span;
                            world.spaces[id].solids.push(Solid { tags, rect, span });
                        }
                    }
                    SpaceItem::Bounds(rectangle) => {
                        let name = Name { text: space.name.text.clone(), span: rectangle.span };
                        if bounds.declare(&name, (), &mut self.diagnostics) {
                            world.spaces[id].bounds = self.rectangle(rectangle, &sizes, &mut world.lengths);
                        }
                    }
                    SpaceItem::Wrap(wrap) => wraps.push(*wrap),
                    SpaceItem::Place(place) => {
                        population.part = (id, at);
                        let room = Room { spaces: &sizes, id, map: world.spaces[id].map.as_ref() };
                        self.placed(place, id, &mut population, &room);
                    }
                }
            }
            self.wraps(&wraps, &mut world.spaces[id], sizes[id.index()].1.is_some());
        }
        population.sort();
        self.named_tiles(&mut population);
        world.limits = self.limits(syntax, &mut population);
        world.looks = self.tag_looks(syntax);
        self.placed_references(&mut population);
        world.instances = population.instances;
        let mut names = WorldNames::new(world.instances.iter().map(|i| (i.name.clone(), i.entity)).collect(), sizes);
        names.tiles = world.open.is_none().then(|| self.tags_of_tiles(&world));
        self.world_conditions(syntax, &names, &Scope::predicate(&names));
        self.links(syntax, &names, &spaces, &mut world);
        self.players(syntax, &mut world);
        let mut goals: Table<()> = Table::new("goal");
        let mut nevers: Table<()> = Table::new("never");
        let scope = Scope::predicate(&names);
        for item in &syntax.items {
            let (question, table) = match item {
                WorldItem::Goal(q) => (q, &mut goals),
                WorldItem::Never(q) => (q, &mut nevers),
                _ => continue,
            };
            let is_goal = matches!(item, WorldItem::Goal(_));
            self.record_declaration(if is_goal { NameKind::Goal } else { NameKind::Never }, &question.name);
            let fresh = table.declare(&question.name, (), &mut self.diagnostics);
            if let Some(predicate) = self.guard(&question.predicate, &scope).filter(|_| fresh) {
                let checked = Question { name: question.name.clone(), predicate };
                if is_goal {
                    world.goals.push(checked);
                } else {
                    world.nevers.push(checked);
                }
            }
        }
        self.tests(syntax, &Questions { goals: &goals, nevers: &nevers }, &scope, &mut world);
        world.conditions = self.take_conditions(&scope).into();
        self.awaited_instances(&world);
        self.checked.worlds.push(world);
    }

    /// Reports the names that only a level can explain, once for the world.
    fn awaited_instances(&mut self, world: &World) {
        let mut names = std::mem::take(&mut self.awaited_names);
        let Some(map) = self.awaited.take() else { return };
        names.order_by_key(|name| name.at);
        // A level that cannot be read is already reported.
        let Some(first) = names.first().filter(|_| !self.level.is_unread) else { return };
        let mut all: Vec<String> = names.iter().map(|name| name.name.clone()).collect();
        let mut seen = std::collections::BTreeSet::new();
        all.retain(|name| seen.insert(name.clone()));
        let near = names.iter().find_map(|of| Some((of.name.clone(), of.near()?.to_string())));
        self.diagnostics.report(MissingLevel {
            at: first.at,
            names: all,
            world: world.name.text.to_string(),
            map,
            near,
        });
    }

    /// `1/60`, `0.02`, `16ms`: an exact fraction of a second.
    fn step_of(&mut self, e: &Expr) -> Option<(u64, u64)> {
        let term = self.number(e, &Scope::constant())?;
        let (numerator, denominator) = match &term.kind {
            TermKind::Arithmetic(Arithmetic::Divide, sides) => {
                let [a, b] = sides.as_ref();
                (self.evaluated(a, ConstantContext::LITERALS)?, self.evaluated(b, ConstantContext::LITERALS)?)
            }
            _ => (self.evaluated(&term, ConstantContext::LITERALS)?, 1.0),
        };
        let fraction = exact(numerator).zip(exact(denominator)).and_then(|((a, b), (c, d))| {
            let (n, m) = (a.checked_mul(d)?, b.checked_mul(c)?);
            let g = gcd(n, m);
            (n > 0 && m > 0).then(|| (n / g, m / g))
        });
        let fraction = fraction.filter(|&(n, m)| n <= m.saturating_mul(10) && m / n <= 1_000_000 && m < 1 << 32);
        if fraction.is_none() {
            self.diagnostics.report(BadStep { at: e.span });
        }
        fraction
    }

    fn collide(&mut self, line: &ast::Collide) -> Option<CollideRule> {
        let left = line.left.iter().map(|t| self.tag(t)).collect();
        let right = line.right.iter().map(|t| self.tag(t)).collect();
        let r = &line.response;
        let wrong = [
            (r.from_above, "`from above`"),
            (r.carry, "`carry`"),
            (r.keep_velocity, "`keep velocity`"),
            (r.bounce.is_some(), "`bounce`"),
        ];
        if let Some((_, what)) = wrong.into_iter().find(|(used, _)| *used && !r.block) {
            self.diagnostics.report(Misplaced { at: r.span, what, inside: "`sense`", belongs: "after `block`" });
            return None;
        }
        let push = match (r.block, r.from_above) {
            (true, true) => Push::FromAbove,
            (true, false) => Push::Block,
            (false, _) => Push::Sense,
        };
        let bounce = match &r.bounce {
            Some(share) => self.bounce(share, r)?,
            None => Bounce::NONE,
        };
        let response = Response { push, stop: r.block && !r.keep_velocity, carry: r.carry, bounce };
        Some(CollideRule { left, right, response, span: line.span })
    }

    /// The share of the velocity that is turned back.
    fn bounce(&mut self, share: &Expr, response: &ast::Response) -> Option<Bounce> {
        let term = self.number(share, &Scope::constant())?;
        let value = self.evaluated(&term, ConstantContext::LITERALS)?;
        if response.keep_velocity {
            self.diagnostics.report(Misplaced {
                at: share.span,
                what: "`bounce`",
                inside: "a response with `keep velocity`",
                belongs: "alone after `block`: a velocity is kept or turned back",
            });
            return None;
        }
        let bounce = Bounce::new(value);
        if bounce.is_none() {
            let (what, range) = (format!("a bounce of {value}"), "0..1".into());
            self.diagnostics.report(OutOfRange { at: share.span, what, range });
        }
        bounce
    }

    /// A tile's width or height, px.
    pub(super) fn tile_side(&mut self, e: &Expr, lengths: &mut Vec<Term>) -> Option<f64> {
        let term = self.number(e, &Scope::constant())?;
        let value = self.evaluated(&term, ConstantContext::LITERALS)?;
        lengths.push(term);
        if value > 0.0 {
            return self.length(value, e.span);
        }
        self.diagnostics.report(OutOfRange {
            at: e.span,
            what: format!("a tile's side of {value} px"),
            range: "what is above 0 px".into(),
        });
        None
    }

    fn tiles<'t>(&mut self, tiles: &'t ast::Tiles, sets: &mut Table<TileSet<'t>>, world: &mut World) {
        self.record_declaration(NameKind::TileSet, &tiles.name);
        let lengths = &mut world.lengths;
        let (width, height) = (self.tile_side(&tiles.width, lengths), self.tile_side(&tiles.height, lengths));
        let mut set = TileSet {
            name: tiles.name.clone(),
            tile: (1.0, 1.0),
            tiles: Vec::new(),
            spawns: Vec::new(),
            others: Vec::new(),
        };
        self.tile_kinds(&tiles.tiles, &mut set, width.zip(height), world);
        match (width, height) {
            (Some(w), Some(h)) => {
                set.tile = (w, h);
                sets.declare(&tiles.name, set, &mut self.diagnostics);
            }
            _ => {
                self.poisoned_names.insert(tiles.name.text.to_string());
            }
        }
    }

    /// Adds tiles to a set; replaces definitions of a legend.
    pub(super) fn tile_kinds<'t>(
        &mut self,
        tiles: &'t [ast::Tile],
        set: &mut TileSet<'t>,
        size: Option<(f64, f64)>,
        world: &mut World,
    ) {
        let mut symbols: Table<()> = Table::new("tile");
        for tile in tiles {
            if set.tiles.len() >= MAX_TILE_KINDS {
                self.too_many("kinds of tiles", MAX_TILE_KINDS, tile.symbol_span);
                break;
            }
            if tile.symbol.is_whitespace() || tile.symbol == '"' {
                self.diagnostics.report(BadTile { at: tile.symbol_span });
                continue;
            }
            let name = Name { text: tile.symbol.to_string().into(), span: tile.symbol_span };
            if symbols.declare(&name, (), &mut self.diagnostics) {
                self.checked.other_tags.extend(tile.tags.iter().map(|t| t.text.to_string()));
                let tags = tile.tags.iter().filter(|t| t.text != "empty").map(|t| self.carried(t));
                let tags: Vec<TagId> = tags.collect();
                let ends = self.slope_ends(tile.slope.as_deref(), world);
                let slope = ends.zip(size).and_then(|(ends, size)| self.slope(&ends, size));
                let breakable = self.breakable(tile.breakable.as_deref(), &tags, &mut world.times);
                self.tile_spawn(tile.spawn.as_ref());
                let kind = InlineTile { symbol: tile.symbol, tags, slope, breakable };
                match set.tiles.iter().position(|t| t.symbol == tile.symbol) {
                    Some(known) => {
                        set.tiles[known] = kind;
                        set.spawns[known] = tile.spawn.as_ref();
                    }
                    None => {
                        set.tiles.push(kind);
                        set.spawns.push(tile.spawn.as_ref());
                    }
                }
            }
        }
    }

    /// Checks what a tile spawns, but for the name of an unknown entity.
    pub(super) fn tile_spawn(&mut self, spawn: Option<&ast::TileSpawn>) {
        let Some(spawn) = spawn else { return };
        if let Some(entity) = self.entity_named(&spawn.entity) {
            let settings = self.settings(entity, &spawn.settings, spawn.span, self.step, &Scope::constant());
            self.spawn_settings.insert(spawn.span, settings.map(Rc::new));
        }
        if let Some(name) = &spawn.name {
            self.record_declaration(NameKind::Instance, name);
        }
    }

    /// A coordinate or a size in a world, if it is not too large.
    pub(super) fn length(&mut self, value: f64, at: Span) -> Option<f64> {
        if value.abs() <= MAX_LENGTH {
            return Some(value);
        }
        let range = format!("-{MAX_LENGTH} px to {MAX_LENGTH} px");
        self.diagnostics.report(OutOfRange { at, what: format!("{value} px"), range });
        None
    }

    /// Links to other spaces.
    fn links(&mut self, syntax: &ast::World, names: &WorldNames, spaces: &Table<SpaceId>, world: &mut World) {
        let scope = Scope::predicate(names);
        let syntax = syntax.items.iter().filter_map(|i| if let WorldItem::Space(s) = i { Some(s) } else { None });
        for (id, space) in syntax.enumerate() {
            let id = SpaceId(id as u32);
            for item in &space.items {
                let SpaceItem::Link(link) = item else { continue };
                let from = self.rectangle(&link.from, &names.spaces, &mut world.lengths);
                let to = self.rectangle(&link.to, &names.spaces, &mut world.lengths);
                let guard = link.guard.as_ref().map(|g| self.guard(g, &scope));
                if let Some((declared, _)) = spaces.entry(&link.space.text) {
                    self.record_use(NameKind::Space, link.space.span, declared.span);
                }
                let Some(&target) = spaces.get(&link.space.text) else {
                    let fact = unknown("space", &link.space.text, link.space.span, spaces.names());
                    self.report_unknown(fact);
                    continue;
                };
                let guard = match guard {
                    Some(None) => continue,
                    Some(guard) => guard,
                    None => None,
                };
                if let (Some(from), Some(to)) = (from, to) {
                    world.spaces[id].links.push(Link { from, space: target, to, guard, span: link.span });
                }
            }
        }
    }

    fn players(&mut self, syntax: &ast::World, world: &mut World) {
        for item in &syntax.items {
            let WorldItem::Player(player) = item else {
                continue;
            };
            let number = player.number.text.parse::<u32>().ok().filter(|&n| (1..=64).contains(&n));
            let Some(number) = number else {
                let why = "a player is a whole number from 1 to 64".to_string();
                let free = Some((player.number.span, 1));
                self.diagnostics.report(BadPlayer { at: player.number.span, why, other: None, free });
                continue;
            };
            let named = |i: &&super::checked::Instance| i.origin == Origin::Named;
            let Some(slot) = world.instances.find(|i| named(&i) && i.name.text == player.instance.text) else {
                let known = world.instances.iter().filter(named).map(|i| &i.name);
                let is_entity = self.checked.entities.iter().any(|e| e.name.text == player.instance.text);
                let suggestion = is_entity.then(|| {
                    let name = &player.instance.text;
                    format!(
                        "`{name}` is an entity; name an instance of it, `place hero: {name} at (0, 0)` in a space or \
                         `'@': spawn {name} as hero` in tiles, and write `player 1: hero`"
                    )
                });
                let fact =
                    unknown("instance", &player.instance.text, player.instance.span, known).suggestion(suggestion);
                self.report_unknown(fact);
                continue;
            };
            self.record_use(NameKind::Instance, player.instance.span, world.instances[slot].name.span);
            let clash = world.players.iter().find(|p| p.number == number || p.slot == slot);
            if let Some(other) = clash {
                let why = if other.number == number {
                    format!("player {number} is declared twice")
                } else {
                    format!("two players control `{}`", player.instance.text)
                };
                let is_free = |n: &u32| !world.players.iter().any(|p| p.number == *n);
                let free = (1..=64).find(is_free).filter(|_| other.number == number);
                let free = free.map(|n| (player.number.span, n));
                self.diagnostics.report(BadPlayer { at: player.span, why, other: Some(other.span), free });
                continue;
            }
            world.players.push(Player { number, slot, span: player.span });
        }
    }
}

/// A number as an exact fraction, if it has at most nine decimals.
fn exact(value: f64) -> Option<(u64, u64)> {
    (0..=9).map(|k| 10u64.pow(k)).find_map(|scale| {
        let scaled = (value * scale as f64).round();
        let fits = (0.0..1e15).contains(&scaled) && scaled / scale as f64 == value;
        fits.then_some((scaled as u64, scale))
    })
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a.max(1) } else { gcd(b, a % b) }
}

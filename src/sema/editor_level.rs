//! Maps from level editors: resolves the names in a level, its rectangles as `rect`s and its objects as instances, as
//! if the program had placed them.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::catalogue::world::{BadLevel, TileInstances, UnknownObject, UnknownSetting, as_tag};
use crate::diagnostic::similar;
use crate::ir::{Breakable, EntityId, Id, Origin, Slope, SlotId, SpaceId, TagId, TileKind, TileMap};
use crate::level::{EditorLevel, Format, Meaning, Object, Value, read_level};
use crate::source::{FileId, Span};
use crate::syntax::ast::{self, Expr, ExprKind, Name, PlaceHeight};

use super::Checker;
use super::checked::{Given, Instance, LevelName, Solid, World};
use super::names::{Table, unknown};
use super::population::Population;
use super::room::Room;
use super::slope::SlopeEnds;

/// The kinds in a map's block, by name.
type Kinds<'k> = BTreeMap<&'k str, &'k ast::Kind>;

impl Checker<'_> {
    /// Reads a level into its space, and makes its instances. Without a file only the block is checked; its named
    /// instances are made once if the map is still missing.
    pub(super) fn editor_map(
        &mut self,
        file: Option<(Format, FileId, Option<&str>)>,
        block: &[ast::Kind],
        at: Span,
        (id, world): (SpaceId, &mut World),
        population: &mut Population,
    ) {
        let mut kinds: Kinds<'_> = BTreeMap::new();
        let mut declared: Table<()> = Table::new("name of the level");
        // A cell can have several names; it can be broken if one of them says so, and so it is a slope.
        let mut breakable: BTreeMap<&str, Breakable> = BTreeMap::new();
        let mut ends: BTreeMap<&str, SlopeEnds> = BTreeMap::new();
        for kind in block {
            if let Some(of) = self.slope_ends(kind.slope.as_deref(), world) {
                ends.entry(&kind.name.text).or_insert(of);
            }
            let tags: Vec<TagId> = match &kind.breakable {
                Some(_) => kind.tags.iter().filter(|tag| tag.text != "empty").map(|tag| self.carried(tag)).collect(),
                None => Vec::new(),
            };
            if let Some(how) = self.breakable(kind.breakable.as_deref(), &tags, &mut world.times) {
                breakable.entry(&kind.name.text).or_insert(how);
            }
            self.checked.other_tags.extend(kind.tags.iter().map(|tag| tag.text.to_string()));
            if declared.declare(&kind.name, (), &mut self.diagnostics) && self.is_entity(kind) {
                kinds.insert(&kind.name.text, kind);
            }
        }
        let sources = self.sources;
        let level = file.and_then(|(format, file, part)| {
            let meaning = |name: &str| meaning(&kinds, &self.entities, name);
            read_level(format, file, part, sources, &meaning, &mut self.diagnostics)
        });
        let Some(level) = level else {
            if file.is_some() || world.open != Some(id) {
                // Its contents are unknown, which is already reported.
                self.poisoned_names.insert("*".into());
            }
            let spawns = kinds.values().filter_map(|kind| kind.spawn.as_ref());
            let named = spawns.filter_map(|spawn| Some((spawn, spawn.name.as_ref()?)));
            for (spawn, name) in named.filter(|_| world.open == Some(id)) {
                let Some(&entity) = self.entities.get(&spawn.entity.text) else { continue };
                population.names.declare(name, (), &mut self.diagnostics);
                self.spawned_by_tile(spawn, entity, (name.clone(), Origin::Named), (id, (0.0, 0.0)), population);
            }
            return;
        };
        let EditorLevel { columns, rows, tile, kinds: names, cells, rectangles, objects, art } = level;
        let objects_too = rectangles.iter().flat_map(|(names, ..)| names).map(|name| (name, true));
        let unexplained = names.iter().flatten().map(|name| (name, false)).chain(objects_too);
        let unexplained: BTreeMap<&String, bool> =
            unexplained.filter(|(name, _)| !kinds.contains_key(name.as_str())).collect();
        self.checked.level_names.extend(unexplained.into_iter().map(|(name, is_object)| {
            let near = similar(name, kinds.keys().copied()).and_then(|near| {
                let meaning = stands_for(kinds.get(near.as_str())?);
                Some((near, meaning))
            });
            LevelName { name: name.clone(), map: at, is_object, near }
        }));
        let slopes: BTreeMap<&str, Slope> =
            ends.iter().filter_map(|(name, ends)| Some((*name, self.slope(ends, tile)?))).collect();
        let tags = |of: &mut Self, names: &[String]| of.tags_of(&kinds, names, at);
        let symbols = ['.', '#'].into_iter().chain('a'..='z').chain('A'..='Z').chain('\u{100}'..);
        let tile_kinds = names.iter().zip(symbols);
        let tile_kinds = tile_kinds.map(|(names, symbol)| TileKind {
            symbol,
            tags: tags(self, names),
            slope: names.iter().find_map(|name| slopes.get(name.as_str()).copied()),
            breakable: names.iter().find_map(|name| breakable.get(name.as_str()).copied()),
        });
        let tile_kinds = tile_kinds.collect();
        world.map_looks.extend(art.and_then(|art| self.map_look(art, id)));
        world.spaces[id].map = Some(TileMap { columns, rows, tile, kinds: tile_kinds, cells });
        for (names, rect, span) in rectangles {
            let tags = tags(self, &names);
            world.spaces[id].solids.push(Solid { tags, rect, span });
        }
        self.objects(&objects, &kinds, at, id, population);
        let read: BTreeSet<FileId> = objects.iter().map(|t| t.at.file()).chain(file.map(|(_, file, _)| file)).collect();
        self.diagnostics.strip_fixes(|file| read.contains(&file));
    }

    /// Whether a kind names an entity of the program; reports an unknown one.
    fn is_entity(&mut self, kind: &ast::Kind) -> bool {
        let Some(spawn) = &kind.spawn else { return true };
        self.tile_spawn(Some(spawn));
        if self.entities.get(&spawn.entity.text).is_some() {
            return true;
        }
        let fact = unknown("entity", &spawn.entity.text, spawn.entity.span, self.entities.names());
        self.report_unknown(fact);
        false
    }

    /// The entity that a name of the level stands for.
    fn entity_of(&self, kinds: &Kinds<'_>, name: &str) -> Option<EntityId> {
        let name = match kinds.get(name) {
            Some(kind) => &kind.spawn.as_ref()?.entity.text,
            None => name,
        };
        self.entities.get(name).copied()
    }

    fn tags_of(&mut self, kinds: &Kinds<'_>, names: &[String], at: Span) -> Vec<TagId> {
        let mut tags = Vec::new();
        for name in names {
            match kinds.get(name.as_str()) {
                Some(kind) => {
                    for tag in kind.tags.iter().filter(|tag| tag.text != "empty") {
                        tags.push(self.carried(tag));
                    }
                }
                None => tags.push(self.tag(&Name { text: name.as_str().into(), span: at })),
            }
        }
        tags.sort_unstable();
        tags.dedup();
        tags
    }

    /// Makes the instances of a level.
    fn objects(&mut self, objects: &[Object], kinds: &Kinds<'_>, at: Span, id: SpaceId, population: &mut Population) {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        let mut called: BTreeMap<&str, usize> = BTreeMap::new();
        let mut unknown: BTreeMap<&str, (Span, usize)> = BTreeMap::new();
        let mut targets: BTreeSet<&str> = BTreeSet::new();
        for object in objects {
            if self.entity_of(kinds, &object.class).is_none() {
                unknown.entry(&object.class).or_insert((object.at, 0)).1 += 1;
                continue;
            }
            *counts.entry(&object.class).or_insert(0) += 1;
            *called.entry(&object.name).or_insert(0) += 1;
            let values = object.settings.iter().map(|setting| &setting.value);
            targets.extend(values.filter_map(|v| if let Value::Object(id) = v { Some(id.as_str()) } else { None }));
        }
        for (class, (span, count)) in unknown {
            let near = similar(class, self.entities.names().map(|known| known.text));
            let class = class.to_string();
            self.diagnostics.report(UnknownObject { at: span, class, count, near, map: at });
        }
        for (name, kind) in kinds {
            let Some(spawned) = kind.spawn.as_ref().and_then(|spawn| spawn.name.as_ref()) else { continue };
            let count = counts.get(name).copied().unwrap_or(0);
            if count != 1 {
                let (tile, name, count) = ((*name).to_string(), spawned.text.to_string(), count as u64);
                self.diagnostics.report(TileInstances { at: spawned.span, name, tile, count, map: at });
                self.poisoned_names.insert(spawned.text.to_string());
            }
        }
        // All names must be known before references are resolved.
        let mut made: Vec<(EntityId, Name, Origin)> = Vec::new();
        let mut ids: BTreeMap<&str, String> = BTreeMap::new();
        let known = || objects.iter().filter(|object| self.entity_of(kinds, &object.class).is_some());
        let known: Vec<&Object> = known().collect();
        for object in &known {
            let Some(entity) = self.entity_of(kinds, &object.class) else { continue };
            let spawned = kinds.get(object.class.as_str()).and_then(|kind| kind.spawn.as_ref()?.name.clone());
            let spawned = spawned.filter(|_| counts.get(object.class.as_str()) == Some(&1));
            let own = Some(&object.name).filter(|name| !name.is_empty() && called.get(name.as_str()) == Some(&1));
            let own = own.map(|name| Name { text: name.as_str().into(), span: object.at });
            let is_target = !object.id.is_empty() && targets.contains(object.id.as_str());
            let (name, origin) = match spawned.or(own) {
                Some(name) => (name, Origin::Named),
                None if is_target => (self.unnamed(population, entity, object.at), Origin::Named),
                None => (self.unnamed(population, entity, object.at), Origin::Tile),
            };
            ids.insert(&object.id, name.text.to_string());
            made.push((entity, name, origin));
        }
        let mut unset: BTreeMap<(EntityId, &str), (Span, usize)> = BTreeMap::new();
        for (object, (entity, name, origin)) in known.iter().zip(made) {
            let mut settings = Vec::new();
            for setting in &object.settings {
                let bare = setting.name.trim_end_matches('\'');
                let Some(what) = self.value_named(entity, bare) else {
                    unset.entry((entity, &setting.name)).or_insert((setting.at, 0)).1 += 1;
                    continue;
                };
                let is_reference = matches!(what, Given::Ref(_));
                match value(&setting.value, is_reference, &ids) {
                    Ok(None) => {}
                    Ok(Some(kind)) => {
                        let primes = (setting.name.len() - bare.len()) as u32;
                        let variable = ast::Variable { text: bare.into(), primes, span: setting.at };
                        let value = Expr { kind, span: setting.at };
                        settings.push(ast::Assignment::new(variable, value, setting.at));
                    }
                    Err(why) => {
                        self.diagnostics.report(BadLevel { at: setting.at, why: format!("`{}` {why}", setting.name) });
                    }
                }
            }
            // What the block says goes for what the level leaves out. Wrong settings are already reported.
            let spawn = kinds.get(object.class.as_str()).and_then(|kind| kind.spawn.as_ref());
            let spawn = spawn.filter(|spawn| matches!(self.spawn_settings.get(&spawn.span), Some(Some(_))));
            for of_kind in spawn.iter().flat_map(|spawn| &spawn.settings) {
                let same = |own: &ast::Assignment| {
                    (&own.variable.text, own.variable.primes) == (&of_kind.variable.text, of_kind.variable.primes)
                };
                if !settings.iter().any(same) {
                    settings.push(of_kind.clone());
                }
            }
            if origin == Origin::Named {
                population.names.declare(&name, (), &mut self.diagnostics);
            }
            let number = |value: f64| Expr { kind: ExprKind::Number(value, None), span: object.at };
            let place = ast::Place {
                name: name.clone(),
                entity: self.checked.entities[entity].name.clone(),
                x: number(object.position.0),
                y: PlaceHeight::At(number(object.position.1)),
                settings,
                span: object.at,
            };
            let slot = SlotId::from_index(population.instances.len());
            match self.place(&place, id, population.step, slot, &mut population.references, &Room::UNKNOWN) {
                Some(instance) => drop(self.populate(population, Instance { origin, ..instance })),
                None => drop(self.poisoned_names.insert(name.text.to_string())),
            }
        }
        for ((entity, name), (span, count)) in unset {
            let e = self.checked.entities[entity].clone();
            let known = e.params.iter().map(|p| &p.name).chain(e.discretes.iter().map(|d| &d.name));
            let known = known.chain(e.refs.iter().map(|r| &r.name)).chain(e.vars.iter().map(|v| &v.name));
            let near = similar(name, known.map(|name| &*name.text));
            let (name, entity) = (name.to_string(), e.name.text.to_string());
            self.diagnostics.report(UnknownSetting { at: span, name, entity, count, near });
        }
    }
}

/// What a line of the block says, after the colon.
fn stands_for(kind: &ast::Kind) -> String {
    match &kind.spawn {
        Some(spawn) => format!("spawn {}", spawn.entity.text),
        None => kind.tags.iter().map(|tag| as_tag(&tag.text)).collect::<Vec<_>>().join(", "),
    }
}

/// The meaning of a name in the level.
fn meaning(kinds: &Kinds<'_>, entities: &Table<EntityId>, name: &str) -> Meaning {
    match kinds.get(name) {
        Some(kind) if kind.spawn.is_some() => Meaning::Entity,
        Some(kind) if kind.tags.iter().all(|tag| tag.text == "empty") => Meaning::Nothing,
        Some(_) => Meaning::Tags,
        None if entities.get(name).is_some() => Meaning::Entity,
        None if name == "empty" => Meaning::Nothing,
        None => Meaning::Tags,
    }
}

/// A property's value as an expression; `None` if it sets nothing, an error if no entity can have such a value.
fn value(value: &Value, is_reference: bool, ids: &BTreeMap<&str, String>) -> Result<Option<ExprKind>, &'static str> {
    let path = |text: &str| ExprKind::Name(text.into(), 0);
    match value {
        Value::Number(number) if !is_reference => Ok(Some(ExprKind::Number(*number, None))),
        Value::Truth(truth) if !is_reference => Ok(Some(ExprKind::Bool(*truth))),
        Value::Text(text) if text.is_empty() => Ok(None),
        Value::Text(text) => Ok(Some(path(text))),
        Value::Object(id) if is_reference => match ids.get(id.as_str()) {
            Some(name) => Ok(Some(path(name))),
            None => Err("refers to what is no instance of this level"),
        },
        Value::Object(_) => Err("is no reference of the entity"),
        Value::Number(_) | Value::Truth(_) => Err("is a reference: its value must be an object"),
        Value::Other => Err("has a value that no entity can have: a list, a colour, a point"),
    }
}

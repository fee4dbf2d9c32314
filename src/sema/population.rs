//! The slots of a world: placed instances, instances made by tiles, and free slots of a `limit`.

use crate::ir::{EntityId, Id, IdVec, MAX_INSTANCES, Origin, RefId, SlotId, SpaceId, Subject, VarId};
use crate::ordered::Ordered;

use std::collections::BTreeMap;

use crate::diagnostic::catalogue::names::DuplicateName;
use crate::diagnostic::catalogue::types::{OutOfRange, TypeMismatch};
use crate::diagnostic::catalogue::world::{MissingLimit, OverLimit, TileInstances};
use crate::source::Span;
use crate::syntax::ast::{self, Name, Word, WorldItem};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{Action, Instance, Term, TermKind, World};
use super::constant::ConstantContext;
use super::expression::Scope;
use super::names::{Table, unknown};
use super::room::Room;
use super::world::TileSet;

/// The instances of a world under construction.
pub(super) struct Population {
    /// All slots.
    pub instances: IdVec<SlotId, Instance>,
    /// The world's step as a fraction of seconds.
    pub step: (u64, u64),
    pub names: Table<()>,
    /// Targets of references of placed instances, by name.
    pub references: Vec<(SlotId, RefId, Name)>,
    /// Number of unnamed slots of each entity.
    unnamed: BTreeMap<EntityId, usize>,
    /// The tiles with a name, by the span of it: a name is of one instance of the world.
    named_tiles: BTreeMap<Span, NamedTile>,
    full: bool,
    /// The part of the world that makes instances now: its space, and its place among the parts of it.
    pub part: (SpaceId, usize),
    /// Per instance, the part that made it.
    parts: Vec<(SpaceId, usize)>,
}

/// A tile that spawns an instance with a name.
struct NamedTile {
    name: Name,
    symbol: char,
    count: u64,
    /// The map in which it was found last, or the first one that could have it.
    map: Span,
}

impl Population {
    pub fn new(step: (u64, u64)) -> Self {
        Population {
            instances: IdVec::new(),
            step,
            names: Table::new("instance"),
            references: Vec::new(),
            unnamed: BTreeMap::new(),
            named_tiles: BTreeMap::new(),
            full: false,
            part: (SpaceId(0), 0),
            parts: Vec::new(),
        }
    }

    /// Puts the instances in the order of the text: those of maps are made first, as places are measured by maps.
    pub fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.instances.len()).collect();
        order.order_by_key(|slot| self.parts.get(*slot));
        if order.is_sorted() {
            return;
        }
        let mut slots = vec![SlotId(0); order.len()];
        for (new, old) in order.iter().enumerate() {
            slots[*old] = SlotId::from_index(new);
        }
        let sorted = order.iter().map(|old| self.instances[SlotId::from_index(*old)].clone());
        self.instances = sorted.collect();
        for (slot, ..) in &mut self.references {
            // Of what was not made, because there are too many, a reference is left as it is.
            *slot = slots.get(slot.index()).copied().unwrap_or(*slot);
        }
    }
}

impl Checker<'_> {
    pub(super) fn populate(&mut self, population: &mut Population, instance: Instance) -> Option<SlotId> {
        if population.instances.is_full(MAX_INSTANCES) {
            if !std::mem::replace(&mut population.full, true) {
                self.too_many("instances", MAX_INSTANCES, instance.span);
            }
            return None;
        }
        population.parts.push(population.part);
        Some(population.instances.push(instance))
    }

    /// The name of the next instance without a name.
    pub(super) fn unnamed(&self, population: &mut Population, entity: EntityId, span: Span) -> Name {
        let number = population.unnamed.entry(entity).or_insert(0);
        *number += 1;
        Name { text: format!("{}#{number}", self.checked.entities[entity].name.text).into(), span }
    }

    /// `place name: Entity at (x, y) { … }`
    pub(super) fn placed(&mut self, place: &ast::Place, space: SpaceId, population: &mut Population, room: &Room<'_>) {
        self.record_declaration(NameKind::Instance, &place.name);
        population.names.declare(&place.name, (), &mut self.diagnostics);
        let slot = SlotId::from_index(population.instances.len());
        match self.place(place, space, population.step, slot, &mut population.references, room) {
            Some(instance) => {
                self.populate(population, instance);
            }
            // Goals may still refer to it.
            None => {
                self.poisoned_names.insert(place.name.text.to_string());
            }
        }
    }

    /// Makes the instances of the tiles of a map, row by row from the top. If the map is still missing, named instances
    /// are made once, so that the rest of the world can be checked.
    pub(super) fn tile_instances(
        &mut self,
        world: &World,
        id: SpaceId,
        set: &TileSet<'_>,
        at: Span,
        population: &mut Population,
    ) {
        let entities: Vec<Option<EntityId>> = set
            .spawns
            .iter()
            .map(|spawn| {
                let spawn = (*spawn)?;
                if let Some(&entity) = self.entities.get(&spawn.entity.text) {
                    return Some(entity);
                }
                let fact = unknown("entity", &spawn.entity.text, spawn.entity.span, self.entities.names());
                self.report_unknown(fact);
                None
            })
            .collect();
        let Some(map) = &world.spaces[id].map else {
            let named = set.spawns.iter().zip(&entities);
            let named = named.filter_map(|(spawn, entity)| Some(((*spawn)?, spawn.as_ref()?.name.as_ref()?, *entity)));
            for (spawn, name, entity) in named {
                let Some(entity) = entity.filter(|_| world.open == Some(id)) else {
                    self.poisoned_names.insert(name.text.to_string());
                    continue;
                };
                population.names.declare(name, (), &mut self.diagnostics);
                self.spawned_by_tile(spawn, entity, (name.clone(), Origin::Named), (id, (0.0, 0.0)), population);
            }
            return;
        };
        for (spawn, tile) in set.spawns.iter().zip(&set.tiles) {
            if let Some(name) = spawn.and_then(|s| s.name.as_ref()) {
                let unseen = NamedTile { name: name.clone(), symbol: tile.symbol, count: 0, map: at };
                population.named_tiles.entry(name.span).or_insert(unseen);
            }
        }
        for row in (0..map.rows).rev() {
            for column in 0..map.columns {
                let Some(kind) = map.kind(column as i64, row as i64) else { continue };
                let (Some(&Some(spawn)), Some(&Some(entity))) = (set.spawns.get(kind), entities.get(kind)) else {
                    continue;
                };
                let seen = spawn.name.as_ref().and_then(|name| population.named_tiles.get_mut(&name.span));
                let (name, origin) = match seen {
                    Some(tile) => {
                        tile.count += 1;
                        tile.map = at;
                        let (name, count) = (tile.name.clone(), tile.count);
                        let text = if count > 1 { format!("{}#{count}", name.text).into() } else { name.text.clone() };
                        if count == 1 {
                            population.names.declare(&name, (), &mut self.diagnostics);
                        }
                        (Name { text, span: name.span }, Origin::Named)
                    }
                    None => (self.unnamed(population, entity, spawn.span), Origin::Tile),
                };
                let position = (column as f64 * map.tile.0, row as f64 * map.tile.1);
                self.spawned_by_tile(spawn, entity, (name, origin), (id, position), population);
            }
        }
    }

    /// Reports names of tiles that are not in the maps of the world exactly once.
    pub(super) fn named_tiles(&mut self, population: &mut Population) {
        for (_, NamedTile { name, symbol, count, map }) in std::mem::take(&mut population.named_tiles) {
            if count == 1 {
                continue;
            }
            let (text, tile) = (name.text.to_string(), symbol.to_string());
            self.diagnostics.report(TileInstances { at: name.span, name: text, tile, count, map });
            if count == 0 {
                self.poisoned_names.insert(name.text.to_string());
            }
        }
    }

    /// Checks the `limit` lines and makes their free slots; every entity that is spawned must have a limit.
    ///
    /// The slot of a placed instance is never reused, since goals and references of the world name it. What is
    /// destroyed leaves room for another one all the same, so such instances do not take a free slot away.
    pub(super) fn limits(&mut self, syntax: &ast::World, population: &mut Population) -> Vec<(EntityId, u32)> {
        let mut known = Vec::new();
        let destructible = self.destructible();
        let mut limits: BTreeMap<EntityId, Span> = BTreeMap::new();
        for item in &syntax.items {
            let WorldItem::Limit(limit) = item else { continue };
            let Some(entity) = self.entity_named(&limit.entity) else {
                let fact = unknown("entity", &limit.entity.text, limit.entity.span, self.entities.names());
                self.report_unknown(fact);
                continue;
            };
            if let Some(first) = limits.get(&entity) {
                let name = limit.entity.text.to_string();
                let kind = "the limit of";
                self.diagnostics.report(DuplicateName { kind, name, first: *first, second: limit.span });
                continue;
            }
            limits.insert(entity, limit.span);
            let term = self.number(&limit.count, &Scope::constant());
            let Some(count) = term.and_then(|t| self.evaluated(&t, ConstantContext::LITERALS)) else { continue };
            if count.fract() != 0.0 || !(0.0..=MAX_INSTANCES as f64).contains(&count) {
                let range = format!("the whole numbers from 0 to {MAX_INSTANCES}");
                self.diagnostics.report(OutOfRange {
                    at: limit.count.span,
                    what: format!("a limit of {count}"),
                    range,
                });
                continue;
            }
            let of = |i: &&Instance| i.entity == entity;
            let living = population.instances.iter().filter(of).count();
            if living > count as usize {
                let last = population.instances.iter().filter(of).nth(count as usize).map(|i| i.span);
                let name = limit.entity.text.to_string();
                self.diagnostics.report(OverLimit { at: limit.span, name, living, limit: count as usize, one: last });
                continue;
            }
            // Without a space nothing can spawn or exist.
            let has_space = syntax.items.iter().any(|item| matches!(item, WorldItem::Space(_)));
            known.push((entity, count as u32));
            let stays = |i: &&Instance| i.entity == entity && (i.origin != Origin::Named || !destructible[entity]);
            let taken = population.instances.iter().filter(stays).count();
            for _ in (taken..count as usize).filter(|_| has_space) {
                let name = self.unnamed(population, entity, limit.span);
                let made = self.free_instance(entity, name, limit.span);
                self.populate(population, made);
            }
        }
        self.spawned_entities(syntax, &limits, population);
        known
    }

    /// For each entity, whether anything may destroy an instance of it.
    fn destructible(&self) -> IdVec<EntityId, bool> {
        let entities = &self.checked.entities;
        let mut found: IdVec<EntityId, bool> = entities.iter().map(|_| false).collect();
        for (id, entity) in entities.pairs() {
            for action in entity.actions() {
                let Action::Destroy(Term { kind: TermKind::Instance(subject), .. }) = action else { continue };
                let of = match subject {
                    Subject::Me => Some(id),
                    Subject::Ref(reference) => entity.refs[*reference].entity,
                    Subject::Probed(probe) => entity.probed(*probe),
                    Subject::Member(entity) => Some(*entity),
                    Subject::Slot(_) | Subject::Touched(_) => None,
                };
                match of {
                    Some(entity) => found[entity] = true,
                    // It may have any entity.
                    None => return entities.iter().map(|_| true).collect(),
                }
            }
        }
        found
    }

    /// Checks that every entity that can be spawned in the world has a limit.
    fn spawned_entities(&mut self, syntax: &ast::World, limits: &BTreeMap<EntityId, Span>, population: &Population) {
        let mut living: Vec<EntityId> = Vec::new();
        let mut missing: Vec<(EntityId, Span)> = Vec::new();
        let mut next: Vec<EntityId> = population.instances.iter().map(|i| i.entity).collect();
        while let Some(entity) = next.pop() {
            if living.contains(&entity) {
                continue;
            }
            living.push(entity);
            let e = &self.checked.entities[entity];
            for action in e.actions() {
                let Action::Spawn(spawn) = action else { continue };
                next.push(spawn.entity);
                let known = limits.contains_key(&spawn.entity);
                if !known && !missing.iter().any(|(e, _)| *e == spawn.entity) {
                    missing.push((spawn.entity, spawn.span));
                }
            }
        }
        for (entity, spawn) in missing {
            let name = self.checked.entities[entity].name.text.to_string();
            self.diagnostics.report(MissingLimit { at: syntax.name.span, name, spawn });
        }
    }

    /// Resolves the references of placed instances; all instances must be known.
    pub(super) fn placed_references(&mut self, population: &mut Population) {
        let named = population.instances.pairs().filter(|(_, i)| i.origin == Origin::Named);
        let named: BTreeMap<Word, SlotId> = named.rev().map(|(slot, i)| (i.name.text.clone(), slot)).collect();
        for (slot, reference, name) in std::mem::take(&mut population.references) {
            let Some(&target) = named.get(&name.text) else {
                let named = population.instances.iter().filter(|i| i.origin == Origin::Named);
                let fact = unknown("instance", &name.text, name.span, named.map(|i| &*i.name.text));
                self.report_unknown(fact);
                continue;
            };
            self.record_use(NameKind::Instance, name.span, population.instances[target].name.span);
            let Some(own) = population.instances.get(slot).map(|i| i.entity) else { continue };
            let wanted = self.checked.entities[own].refs[reference].entity;
            let found = population.instances[target].entity;
            if let Some(wanted) = wanted.filter(|w| *w != found) {
                let instance = |e: EntityId| format!("an instance of `{}`", self.checked.entities[e].name.text);
                let (found, expected) = (instance(found), instance(wanted));
                self.diagnostics.report(TypeMismatch { at: name.span, found, expected, help: None });
                continue;
            }
            population.instances[slot].refs[reference] = Some(target);
        }
    }

    /// A slot that is empty at the start.
    fn free_instance(&self, entity: EntityId, name: Name, span: Span) -> Instance {
        let e = &self.checked.entities[entity];
        Instance {
            name,
            origin: Origin::Free,
            entity,
            space: SpaceId(0),
            params: e.params.iter().map(|_| 0.0).collect(),
            vars: e.vars.iter().map(|_| [0.0; 3]).collect(),
            // In its range, as every value of a program.
            discretes: e.discretes.iter().map(|d| 0.clamp(d.range.0, d.range.1)).collect(),
            refs: e.refs.iter().map(|_| None).collect(),
            given: Vec::new(),
            span,
        }
    }

    /// An instance that a tile makes, with the tile's settings.
    pub(super) fn spawned_by_tile(
        &mut self,
        spawn: &ast::TileSpawn,
        entity: EntityId,
        (name, origin): (Name, Origin),
        (space, position): (SpaceId, (f64, f64)),
        population: &mut Population,
    ) {
        let settings = self.spawn_settings.get(&spawn.span).cloned().flatten();
        let made = settings.and_then(|settings| {
            let mut values = settings.values.clone();
            values.vars[VarId::X][0] = Some(position.0);
            values.vars[VarId::Y][0] = Some(position.1);
            let step = population.step;
            let made = self.instance_of(entity, values, name.clone(), origin, space, step, spawn.span)?;
            Some((Instance { given: settings.given.clone(), ..made }, settings))
        });
        let Some((instance, settings)) = made else {
            // Goals may still refer to it.
            self.poisoned_names.insert(name.text.to_string());
            return;
        };
        if let Some(slot) = self.populate(population, instance) {
            let named = settings.references.iter();
            population.references.extend(named.map(|(reference, name)| (slot, *reference, name.clone())));
        }
    }
}

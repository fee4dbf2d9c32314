//! Suggestions for unknown names: how the language writes what a name means in another place, in another language or in
//! another game engine.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::EntityId;
use crate::syntax::NO_POWER;
use crate::syntax::ast::{self, Item, MapSource, SpaceItem, TileSpawn, Word, WorldItem};

use super::Checker;
use super::checked::Entity;
use super::expression::Scope;

/// The instances that worlds place, with their entities; for suggestions before worlds are checked.
pub(super) fn placed(files: &[ast::File]) -> BTreeMap<Word, Word> {
    let worlds =
        files.iter().flat_map(|f| &f.items).filter_map(|i| if let Item::World(w) = i { Some(w) } else { None });
    let mut placed = BTreeMap::new();
    let mut add = |name: &ast::Name, entity: &ast::Name| {
        placed.entry(name.text.clone()).or_insert_with(|| entity.text.clone());
    };
    for item in worlds.flat_map(|world| &world.items) {
        match item {
            WorldItem::Space(space) => {
                for item in &space.items {
                    match item {
                        SpaceItem::Place(place) => add(&place.name, &place.entity),
                        SpaceItem::Map(map) => {
                            spawns(&map.source).for_each(|s| s.name.iter().for_each(|name| add(name, &s.entity)));
                        }
                        _ => {}
                    }
                }
            }
            WorldItem::Tiles(tiles) => {
                let spawns = tiles.tiles.iter().filter_map(|tile| tile.spawn.as_ref());
                spawns.for_each(|s| s.name.iter().for_each(|name| add(name, &s.entity)));
            }
            _ => {}
        }
    }
    placed
}

/// The instances of a map's block.
fn spawns(map: &MapSource) -> impl Iterator<Item = &TileSpawn> {
    let (tiles, kinds): (&[ast::Tile], &[ast::Kind]) = match map {
        MapSource::Vglc(_, legend) | MapSource::OpenLegend(legend) => (&legend.tiles, &[]),
        MapSource::Tiled(_, block) | MapSource::Ldtk(_, _, block) | MapSource::OpenAll(block) => {
            (&block.tiles, &block.kinds)
        }
        MapSource::Inline(..) | MapSource::Text(..) | MapSource::Open(_) => (&[], &[]),
    };
    let kinds = kinds.iter().filter_map(|kind| kind.spawn.as_ref());
    tiles.iter().filter_map(|tile| tile.spawn.as_ref()).chain(kinds)
}

/// A suggestion for a name that is not a value: how to use what it names, or how to write what it means elsewhere.
pub(super) fn suggestion(name: &str, scope: &Scope<'_>) -> Option<String> {
    let names = scope.names?;
    let is_mode = || scope.entity.is_some_and(|entity| entity.modes.iter().any(|mode| mode.name.text == name));
    if names.buttons.get(name).is_some() {
        return Some(format!("`{name}` is a button: `pressed({name})`, `held({name})` and `released({name})` ask it"));
    }
    if is_mode() {
        return Some(format!("`{name}` is a mode: `in {name}` asks whether it is active"));
    }
    rate(name).or_else(|| value(name))
}

/// How the language writes a velocity with a conventional name.
pub(super) fn rate(name: &str) -> Option<String> {
    let of = match name {
        "vx" | "dx" | "velx" | "xvel" | "speed_x" | "velocity_x" | "x_velocity" => "x",
        "vy" | "dy" | "vely" | "yvel" | "speed_y" | "velocity_y" | "y_velocity" => "y",
        _ => return None,
    };
    Some(format!("a velocity is the rate of a position: `{of}'`"))
}

const RANDOMNESS: &str = "a random number is a `chance`, which each step draws anew: `chance roll: 1..6` in the entity";

/// What takes the place of a write to a chance, and of a read of another instance's.
pub(super) fn drawn(entity: &Entity, name: &str) -> Option<String> {
    let is_chance = entity.chances.iter().any(|chance| chance.name.text == name);
    is_chance.then(|| {
        format!("`{name}` is a `chance` that nature draws for `{}` alone; a `discrete` can keep it", entity.name.text)
    })
}

fn is_random(name: &str) -> bool {
    let name = name.to_lowercase();
    ["rand", "random", "rnd", "randint", "randf", "randi", "randrange", "randomize"].contains(&name.as_str())
        || name.starts_with("random_")
        || name.starts_with("rand_")
}

/// How the language writes a value that others have.
fn value(name: &str) -> Option<String> {
    Some(match name {
        "dt" | "delta" | "delta_time" | "deltaTime" | "timestep" => {
            format!("there is no `{name}`: a flow is per second, so `x' = 60` moves 60 px in each second")
        }
        "horizontal" | "vertical" => format!("an axis is declared in the entity: `axis {name}`"),
        "time" | "elapsed" | "seconds" => "`timer` is the time since the mode was entered, s".into(),
        "PI" | "TAU" => format!("the number is written `{}`", name.to_lowercase()),
        _ if is_random(name) => RANDOMNESS.into(),
        _ => return None,
    })
}

/// How the language writes a function that others have.
pub(super) fn function(name: &str) -> Option<String> {
    Some(match name {
        "pow" | "sqr" | "square" => NO_POWER.into(),
        "hypot" | "length" => {
            "the length of a way is `sqrt(a * a + b * b)`, that to an instance `distance(target)`".into()
        }
        "dist" => "the distance to an instance is `distance(target)`, to a point `distance((x, y))`".into(),
        "lerp" | "mix" => "between two values: `a + (b - a) * part`".into(),
        "sgn" | "signum" => "the sign is `sign(a)`".into(),
        "fabs" => "the size is `abs(a)`".into(),
        "fmod" | "modulo" | "remainder" => "the remainder is `mod(a, b)`".into(),
        "int" | "trunc" => "a number is made whole by `floor`, `ceil` or `round`".into(),
        "ceiling" => "the next whole number above is `ceil(a)`".into(),
        "atan" | "arctan" => "the angle of a direction is `atan2(y, x)`".into(),
        "iff" | "cond" | "choose" | "select" | "ternary" => "a choice is `if(condition, a, b)`".into(),
        "collides" | "colliding" | "overlaps" | "collision" => "a contact is asked with `touching(tag)`".into(),
        _ if is_random(name) => RANDOMNESS.into(),
        _ => return None,
    })
}

/// How the input that an unknown button names is asked.
pub(super) fn button(name: &str, scope: &Scope<'_>) -> Option<String> {
    let names = scope.names?;
    if names.axes.get(name).is_some() {
        return Some(format!("`{name}` is an axis, a number from -1 to 1: `{name} > 0`"));
    }
    let (axis, sign) = match name {
        "left" => ("horizontal", '<'),
        "right" => ("horizontal", '>'),
        "down" => ("vertical", '<'),
        "up" => ("vertical", '>'),
        _ if names.buttons.names().next().is_none() => {
            return Some(format!("a button is declared in the entity: `button {name}`"));
        }
        _ => return None,
    };
    let declared = match names.axes.get(axis) {
        Some(_) => String::new(),
        None => format!(", with `axis {axis}` in the entity"),
    };
    Some(format!("`{name}` is a direction of an axis: `{axis} {sign} 0`{declared}"))
}

/// The side that a word of another language means.
pub(crate) fn side(word: &str) -> Option<&'static str> {
    Some(match word {
        "bottom" | "down" | "under" | "underneath" | "beneath" | "feet" | "lower" => "below",
        "top" | "up" | "over" | "upper" => "above",
        _ => return None,
    })
}

impl Checker<'_> {
    /// How a name that is no reference of the entity is read: an instance of a world, an entity.
    pub(super) fn unreferenced(&self, name: &str, scope: &Scope<'_>) -> Option<String> {
        let me = scope.entity?;
        if name == "this" {
            return Some("an entity's own names stand alone: `x`".into());
        }
        let (what, entity, reference) = match self.placed.get(name) {
            Some(entity) => ("an instance of a world", &**entity, name.to_string()),
            None if self.entities.get(name).is_some() => ("an entity", name, name.to_lowercase()),
            None => return None,
        };
        let mine = self.placed.iter().find(|(_, of)| **of == me.name.text).map(|(mine, _)| mine);
        let value = if what == "an entity" { "…" } else { name };
        let setting = match mine {
            Some(mine) => format!(": `place {mine}: {} at (…) {{ {reference} = {value} }}`", me.name.text),
            None => format!(" where a `{}` is placed or spawned", me.name.text),
        };
        Some(format!("`{name}` is {what}: declare `ref {reference}: {entity}`, and set it{setting}"))
    }

    /// The instance of a world that has a value of this name.
    pub(super) fn value_of_instance(&mut self, name: &str, scope: &Scope<'_>) -> Option<String> {
        let world = scope.world?;
        let entities: BTreeSet<EntityId> = world.instances.iter().map(|(_, entity)| *entity).collect();
        let entity = entities.into_iter().find(|entity| self.value_named(*entity, name).is_some())?;
        let (instance, _) = world.instances.iter().find(|(_, of)| *of == entity)?;
        Some(format!("a predicate reads it of an instance: `{}.{name}`", instance.text))
    }

    /// The name of an entity, if a reference has a known one.
    pub(super) fn entity_name(&self, entity: Option<EntityId>) -> Option<String> {
        Some(self.checked.entities[entity?].name.text.to_string())
    }
}

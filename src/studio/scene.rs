//! A world as the page draws it: what does not change, and a state.

use crate::ir::{
    Bounds, Entity, EntityId, Id, Look, MapLook, Origin, Push, SlotId, Space, SpaceId, TagId, TagSet, TileMap, World,
};
use crate::sim::Simulator;

use super::protocol::{
    ColliderInfo, EntityInfo, Frame, LinkInfo, MapArt, MapInfo, PlayerInfo, Role, Scene, SlotInfo, SolidInfo,
    SpaceInfo, TileInfo,
};

/// The side of a space without anything in it, px.
const EMPTY_SIDE: f64 = 256.0;
/// What is added around a space without written bounds and without a map, px.
const MARGIN: f64 = 32.0;

/// What does not change while a world runs.
pub(super) fn scene(path: &str, sim: &Simulator) -> Scene {
    let (program, world) = (&**sim.program(), sim.world());
    let player = |(_, player): (_, &crate::ir::Player)| {
        let entity = &program.entities[world.slots[player.slot].entity];
        PlayerInfo {
            number: player.number,
            slot: player.slot.0,
            buttons: entity.buttons.iter().cloned().collect(),
            axes: entity.axes.iter().cloned().collect(),
        }
    };
    let slot = |(id, slot): (SlotId, &crate::ir::Slot)| SlotInfo {
        name: slot.name.clone(),
        entity: slot.entity.index(),
        player: world.players.pairs().find(|(_, player)| player.slot == id).map(|(id, _)| id.index()),
    };
    Scene {
        path: path.to_string(),
        world: world.name.clone(),
        step: world.step.seconds(),
        tags: program.tags.iter().cloned().collect(),
        players: world.players.pairs().map(player).collect(),
        spaces: world.spaces.pairs().map(|(id, _)| space_info(sim, id)).collect(),
        entities: program.entities.pairs().map(|(id, entity)| entity_info(sim, id, entity)).collect(),
        slots: world.slots.pairs().map(slot).collect(),
        goals: world.goals.iter().map(|goal| goal.name.clone()).collect(),
        nevers: world.nevers.iter().map(|never| never.name.clone()).collect(),
    }
}

/// What static geometry with some tags is for the players, or else for anything.
fn role(sim: &Simulator, tags: TagSet) -> Role {
    let (program, world) = (sim.program(), sim.world());
    let of_players = world.strongest_push(program, world.player_entities(), tags);
    match of_players.or_else(|| world.strongest_push(program, program.entities.ids(), tags)) {
        Some(Push::Block) => Role::Solid,
        Some(Push::FromAbove) => Role::OneWay,
        Some(Push::Sense) => Role::Sensed,
        None if program.is_probed(tags) => Role::Sensed,
        None => Role::Scenery,
    }
}

fn tag_numbers(tags: &[TagId]) -> Vec<usize> {
    tags.iter().map(|tag| tag.index()).collect()
}

fn numbers(tags: TagSet) -> Vec<usize> {
    tags.iter().map(Id::index).collect()
}

/// What static geometry with some tags looks like.
fn look(sim: &Simulator, tags: TagSet) -> Option<Look> {
    sim.program().looks.of_tags(sim.world_id(), tags).cloned()
}

fn entity_info(sim: &Simulator, id: EntityId, entity: &Entity) -> EntityInfo {
    let world = sim.world();
    let tags = entity.colliders.iter().map(|collider| collider.tags).fold(TagSet::default(), TagSet::with);
    let is_solid = |tags: TagSet| {
        let mut pushing = world.collide.iter().filter(|line| line.response.push != Push::Sense);
        pushing.any(|line| line.left.meets(tags) || line.right.meets(tags))
    };
    let collider = |collider: &crate::ir::Collider| ColliderInfo {
        tags: numbers(collider.tags),
        is_round: collider.shape.is_round(),
        is_solid: is_solid(collider.tags),
    };
    EntityInfo {
        name: entity.name.to_string(),
        doc: entity.doc.as_ref().map(ToString::to_string),
        look: sim.program().looks.of_entity(id).cloned().or_else(|| look(sim, tags)),
        colliders: entity.colliders.iter().map(collider).collect(),
        modes: entity.modes.iter().map(|mode| mode.path.clone()).collect(),
    }
}

fn space_info(sim: &Simulator, id: SpaceId) -> SpaceInfo {
    let (world, space) = (sim.world(), &sim.world().spaces[id]);
    let corners = |b: Bounds| [b.left, b.bottom, b.right, b.top];
    let solid = |solid: &crate::ir::Solid| SolidInfo {
        tags: numbers(solid.tags),
        role: role(sim, solid.tags),
        look: look(sim, solid.tags),
        area: corners(solid.bounds),
    };
    let link = |link: &crate::ir::Link| LinkInfo { area: corners(link.from), space: link.space.index() };
    SpaceInfo {
        name: space.name.clone(),
        extent: corners(space.extent().unwrap_or_else(|| extent_of_contents(world, space, id))),
        wraps: space.periods.each_ref().map(Option::is_some),
        map: space.map.as_ref().map(|map| map_info(sim, id, map)),
        solids: space.solids.iter().map(solid).collect(),
        links: space.links.iter().map(link).collect(),
    }
}

/// A rectangle around everything that is in a space at first.
fn extent_of_contents(world: &World, space: &Space, id: SpaceId) -> Bounds {
    let fixed = space.solids.iter().map(|solid| solid.bounds).chain(space.links.iter().map(|link| link.from));
    let placed = world.slots.iter().filter(|slot| slot.space == id && slot.origin != Origin::Free).map(|slot| {
        let mut at = slot.vars.iter().map(|values| values[0]);
        let (x, y) = (at.next().unwrap_or(0.0), at.next().unwrap_or(0.0));
        Bounds::new([x - MARGIN, y - MARGIN, 2.0 * MARGIN, 2.0 * MARGIN])
    });
    let finite = |b: &Bounds| [b.left, b.right, b.bottom, b.top].iter().all(|side| side.is_finite());
    let around = fixed.chain(placed).filter(finite).reduce(Bounds::join);
    let all = around.unwrap_or(Bounds::new([0.0, 0.0, EMPTY_SIDE, EMPTY_SIDE]));
    Bounds { left: all.left - MARGIN, right: all.right + MARGIN, bottom: all.bottom - MARGIN, top: all.top + MARGIN }
}

fn map_info(sim: &Simulator, space: SpaceId, map: &TileMap<TagId>) -> MapInfo {
    let names = |tags: &[TagId]| {
        let names: Vec<&str> = tags.iter().filter_map(|tag| sim.program().tags.get(*tag).map(String::as_str)).collect();
        if names.is_empty() { "empty".to_string() } else { names.join(", ") }
    };
    let kind = |kind: &crate::ir::TileKind<TagId>| TileInfo {
        symbol: kind.symbol.to_string(),
        label: names(&kind.tags),
        role: role(sim, kind.tags.iter().copied().collect()),
        look: look(sim, kind.tags.iter().copied().collect()),
        tags: tag_numbers(&kind.tags),
        slope: kind.slope.map(|slope| [0.0, slope.left, map.tile.0, slope.right]),
        breakable: kind.breakable.is_some(),
    };
    // A kind without tags is air.
    let is_air = |kind: u16| map.kinds.get(usize::from(kind)).is_none_or(|kind| kind.tags.is_empty());
    let rows = map.cells.chunks(map.columns.max(1)).rev();
    let cells = rows.flatten().map(|&kind| if is_air(kind) { -1 } else { i32::from(kind) }).collect();
    MapInfo {
        columns: map.columns,
        rows: map.rows,
        tile: [map.tile.0, map.tile.1],
        // Told by the text.
        brushes: Vec::new(),
        brushes_left_out: 0,
        unpainted: None,
        is_drawn_by_rules: false,
        kinds: map.kinds.iter().map(kind).collect(),
        cells,
        art: sim.program().looks.of_map(sim.world_id(), space).map(|look| art(look, map.columns)),
    }
}

fn art(look: &MapLook, columns: usize) -> MapArt {
    let MapLook { pictures, tiles, stacks, cells, .. } = look.clone();
    let cells = cells.chunks(columns.max(1)).rev().flatten().copied().collect();
    MapArt { pictures, tiles, stacks, cells }
}

/// A state.
pub(super) fn frame(sim: &Simulator, state: &[u8], at: u64) -> Frame {
    let world = sim.world();
    let mut bodies = Vec::new();
    for instance in sim.instances(state) {
        let (x, y) = instance.position();
        bodies.extend([f64::from(instance.slot().0), instance.space().index() as f64, x, y, 0.0]);
        let (count, mut colliders) = (bodies.len() - 1, 0.0);
        for (id, b) in instance.colliders() {
            bodies.extend([id.index() as f64, b.left, b.bottom, b.right, b.top]);
            colliders += 1.0;
        }
        bodies[count] = colliders;
    }
    let broken = sim.broken_tiles(state).into_iter().filter_map(|tile| {
        let (space, column, row) = sim.place_of_tile(tile)?;
        let map = world.spaces[space].map.as_ref()?;
        Some([space.index(), map.rows.saturating_sub(row + 1) * map.columns + column])
    });
    // A predicate that breaks a rule does not hold.
    let holds = |predicate| sim.holds(state, predicate).unwrap_or(false);
    Frame {
        at,
        bodies,
        broken: broken.collect(),
        goals: world.goals.pairs().filter(|(_, goal)| holds(goal.holds)).map(|(id, _)| id.index()).collect(),
        nevers: world.nevers.pairs().filter(|(_, never)| holds(never.holds)).map(|(id, _)| id.index()).collect(),
    }
}

/// The space and the position of each player that is there.
pub(super) fn places(sim: &Simulator, state: &[u8]) -> Vec<Option<[f64; 3]>> {
    let place = |player: &crate::ir::Player| {
        let instance = sim.instance(state, player.slot);
        let ((x, y), space) = (instance.position(), instance.space());
        instance.is_alive().then(|| [space.index() as f64, x, y])
    };
    sim.world().players.iter().map(place).collect()
}

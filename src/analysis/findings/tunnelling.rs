//! Bodies that are too fast for what blocks them. Contacts are looked for where bodies are after a step, not on the way,
//! and a contact pushes a body back to the side from which it came. So it passes what is in its way if its end lies
//! behind that altogether: if it goes farther in a step than that is thick and itself is long, along an axis.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::values::Tunnels;
use crate::ir::{
    EntityId, Id, IdVec, ParamId, Program, Push, Shape, SlotId, SpaceId, TagId, TagSet, TileMap, VarId, World, WorldId,
};
use crate::source::Span;

use super::super::evaluate::Configuration;
use super::super::values::Interval;
use super::super::{ConfigurationSpace, configuration_space};
use super::{Scene, words};

/// Lengths that differ by less are the same, px.
const ROUNDING: f64 = 1e-6;

/// Reports the bodies of some entities, each axis once, at the greatest excess.
pub(super) fn tunnelling(scene: &Scene<'_>, is_ours: impl Fn(&EntityId) -> bool, found: &mut Diagnostics) {
    let mut worst: BTreeMap<(EntityId, usize), (f64, Tunnels)> = BTreeMap::new();
    for (&id, free) in &scene.worlds {
        let world = &scene.original.worlds[id];
        // Bounds stop falls: where the speed is too high without them, they are asked.
        let bounded: OnceCell<ConfigurationSpace> = OnceCell::new();
        let has_bounds = !world.players.is_empty() && world.spaces.iter().any(|s| s.bounds.is_some());
        let mut tiles = Tiles::new();
        for slot in world.slots.ids().filter(|s| is_ours(&world.slots[*s].entity)) {
            let entity = world.slots[slot].entity;
            for axis in 0..2 {
                let of = |space| Course { scene, id, world, space, slot, axis };
                let Some(mut tunnel) = of(free).tunnel(&mut tiles) else { continue };
                if has_bounds {
                    let space = bounded.get_or_init(|| configuration_space(scene.original, id));
                    match of(space).tunnel(&mut tiles) {
                        Some(less) => tunnel = less,
                        None => continue,
                    }
                }
                let excess = tunnel.speed.abs() * tunnel.step / (tunnel.thickness + tunnel.extent);
                let known = worst.get(&(entity, axis)).map(|(excess, _)| *excess);
                // What nothing bounds is no sign of a mistake: a fall with no floor below it is one.
                if tunnel.speed.is_finite() && known.is_none_or(|known| known < excess) {
                    worst.insert((entity, axis), (excess, tunnel));
                }
            }
        }
    }
    for (_, tunnel) in worst.into_values() {
        found.report(tunnel);
    }
}

/// Of the map of a space, the tags of its tiles.
type Tiles = BTreeMap<SpaceId, Vec<TagSet>>;

/// The course of a slot along an axis.
struct Course<'a> {
    scene: &'a Scene<'a>,
    id: WorldId,
    world: &'a World,
    space: &'a ConfigurationSpace,
    slot: SlotId,
    axis: usize,
}

/// A collider: its tags, and from where to where it reaches relative to the position.
struct Body {
    tags: TagSet,
    kinematic: bool,
    reach: Interval,
    at: Span,
}

/// Something that blocks.
struct Obstacle {
    tags: TagSet,
    thickness: f64,
    /// How fast it moves itself, px/s.
    speed: f64,
    name: String,
    at: Span,
}

impl Course<'_> {
    fn program(&self) -> &Program {
        self.scene.program
    }

    /// Where it is too fast, by how much most.
    fn tunnel(&self, tiles: &mut Tiles) -> Option<Tunnels> {
        let found = &self.space.slots[self.slot];
        if found.is_given_up || found.configurations.is_empty() {
            return None;
        }
        let bodies: Vec<Body> = self.bodies(self.slot)?.into_iter().filter(|b| !b.kinematic).collect();
        if bodies.is_empty() {
            return None;
        }
        let obstacles = self.obstacles(&bodies, tiles);
        let step = self.world.step.seconds();
        let mut worst: Option<(f64, Tunnels)> = None;
        for obstacle in &obstacles {
            let met: Vec<(&Body, bool)> = bodies
                .iter()
                .filter_map(|b| {
                    let meeting = self.world.meeting(b.tags, obstacle.tags)?;
                    match meeting.response.push {
                        Push::Sense => None,
                        Push::Block => Some((b, false)),
                        // It blocks from above alone.
                        Push::FromAbove => (self.axis == 1 && meeting.first_on_second).then_some((b, true)),
                    }
                })
                .collect();
            // Colliders of one body hold each other up: what is between the outermost counts as long.
            let Some(reach) = met.iter().map(|(b, _)| b.reach).reduce(Interval::or) else { continue };
            let from_above = met.iter().all(|(_, from_above)| *from_above);
            let extent = reach.high - reach.low;
            for at in &found.configurations {
                let Some(speed) = self.speed(at, from_above) else { continue };
                let speed = speed + obstacle.speed.copysign(speed);
                let excess = speed.abs() * step / (obstacle.thickness + extent);
                if speed.abs() * step <= obstacle.thickness + extent + ROUNDING
                    || worst.as_ref().is_some_and(|(known, _)| *known >= excess)
                {
                    continue;
                }
                let entity = self.world.slots[self.slot].entity;
                let e = &self.program().entities[entity];
                let spans = &self.program().spans.entities[entity];
                let mode = at.leaves.first().map(|l| e.leaves[*l].mode);
                let tunnels = Tunnels {
                    at: met.first().map_or(spans.name, |(b, _)| b.at),
                    velocity: words::derivative(e, VarId::from_index(self.axis), 1),
                    speed,
                    step,
                    mode: mode.map(|m| (e.modes[m].path.clone(), spans.modes[m])),
                    over: (obstacle.name.clone(), obstacle.at),
                    thickness: obstacle.thickness,
                    extent,
                };
                worst = Some((excess, tunnels));
            }
        }
        worst.map(|(_, tunnels)| tunnels)
    }

    /// The fastest it can be, with its sign.
    fn speed(&self, at: &Configuration, downwards: bool) -> Option<f64> {
        let hull = at.vars[VarId::from_index(self.axis)][1].hull()?;
        let speed = if downwards || hull.high < -hull.low { hull.low } else { hull.high };
        (speed != 0.0 && !(downwards && speed > 0.0)).then_some(speed)
    }

    /// The colliders of a slot whose size never changes; none if one of them does.
    fn bodies(&self, slot: SlotId) -> Option<Vec<Body>> {
        let program = self.program();
        let entity = self.world.slots[slot].entity;
        let params: IdVec<ParamId, f64> = self.space.overall[slot]
            .params
            .iter()
            .map(|p| p.constant())
            .collect::<Option<Vec<f64>>>()?
            .into_iter()
            .collect();
        let number = |id| program.constant(id, &params, self.world.step);
        let spans = &program.spans.entities[entity].colliders;
        let body = |(id, c): (_, &crate::ir::Collider)| {
            let (low, length) = match c.shape {
                Shape::Rect([x, y, width, height]) => match self.axis {
                    0 => (number(x)?, number(width)?),
                    _ => (number(y)?, number(height)?),
                },
                Shape::Circle([x, y, radius]) => {
                    let radius = number(radius)?;
                    (number(if self.axis == 0 { x } else { y })? - radius, 2.0 * radius)
                }
            };
            let reach = Interval { low, high: low + length };
            Some(Body { tags: c.tags, kinematic: c.kinematic, reach, at: spans[id] })
        };
        program.entities[entity].colliders.pairs().map(body).collect()
    }

    /// What there is in the spaces that the slot can be in.
    fn obstacles(&self, bodies: &[Body], tiles: &mut Tiles) -> Vec<Obstacle> {
        let spans = &self.program().spans.worlds[self.id];
        let spaces = &self.space.overall[self.slot].spaces;
        let mut out = Vec::new();
        for &space in spaces {
            let s = &self.world.spaces[space];
            for (solid, at) in s.solids.iter().zip(&spans.solids[space]) {
                let b = solid.bounds;
                let thickness = if self.axis == 0 { b.right - b.left } else { b.top - b.bottom };
                let name = "this `rect`".to_string();
                out.push(Obstacle { tags: solid.tags, thickness, speed: 0.0, name, at: *at });
            }
            let Some(map) = &s.map else { continue };
            // Of tiles in a row, those behind give no way back: their faces are covered. So one of them is all there is.
            let thickness = if self.axis == 0 { map.tile.0 } else { map.tile.1 };
            for tags in tiles.entry(space).or_insert_with(|| used(map)).iter().copied() {
                let name = format!("the tiles of `{}`", s.name);
                out.push(Obstacle { tags, thickness, speed: 0.0, name, at: spans.spaces[space] });
            }
        }
        for other in self.world.slots.ids().filter(|s| *s != self.slot) {
            let overall = &self.space.overall[other];
            if !overall.can_live || overall.spaces.is_disjoint(spaces) {
                continue;
            }
            let velocity = overall.vars[VarId::from_index(self.axis)][1].hull();
            let speed = velocity.map_or(0.0, |v| v.low.abs().max(v.high.abs()));
            if !speed.is_finite() {
                continue;
            }
            let name = &self.world.slots[other].name;
            for body in self.bodies(other).into_iter().flatten() {
                out.push(Obstacle {
                    tags: body.tags,
                    thickness: body.reach.high - body.reach.low,
                    speed,
                    name: format!("`{name}`"),
                    at: spans.slots[other],
                });
            }
        }
        out.retain(|o| o.thickness > 0.0 && bodies.iter().any(|b| self.blocks(b.tags, o.tags)));
        out
    }

    /// Whether a contact pushes.
    fn blocks(&self, mine: TagSet, other: TagSet) -> bool {
        self.world.meeting(mine, other).is_some_and(|m| m.response.push != Push::Sense)
    }
}

/// The tags of the tiles that stand somewhere in a map.
fn used(map: &TileMap<TagId>) -> Vec<TagSet> {
    let mut stands = vec![false; map.kinds.len()];
    for kind in &map.cells {
        if let Some(stands) = stands.get_mut(usize::from(*kind)) {
            *stands = true;
        }
    }
    let kinds = map.kinds.iter().zip(stands).filter(|(_, stands)| *stands);
    kinds.map(|(k, _)| k.tags.iter().copied().collect()).collect()
}

//! Bodies that are too fast for what blocks them. Contacts are detected at the positions after a step, not on the way,
//! and a contact pushes a body back to the side from which it came. So a body passes an obstacle if one step takes it
//! completely behind it: along an axis, the step is longer than the obstacle's thickness plus the body's extent.

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::values::Tunnels;
use crate::ir::{
    Drive, EntityId, Id, IdVec, ParamId, Program, Push, SlotId, SpaceId, TagId, TagSet, TileMap, VarId, World, WorldId,
};
use crate::source::Span;

use super::super::{ConfigurationSpace, configuration_space};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};

/// Tolerance for comparing lengths, px.
const ROUNDING: f64 = 1e-6;

/// For each entity and axis, the body with the greatest excess.
#[derive(Default)]
pub(super) struct Tunnelling {
    worst: BTreeMap<(EntityId, usize), (f64, Tunnels)>,
}

impl Tunnelling {
    /// Examines the bodies of some entities in a world; `free` is the configuration space without bounds.
    pub fn examine(
        &mut self,
        program: &Program,
        id: WorldId,
        free: &ConfigurationSpace,
        is_ours: impl Fn(&EntityId) -> bool,
    ) {
        let world = &program.worlds[id];
        let has_bounds = !world.players.is_empty() && world.spaces.iter().any(|s| s.bounds.is_some());
        // Bounds limit falls: where the speed is too high without them, the bounded space decides.
        let bounded: OnceCell<ConfigurationSpace> = OnceCell::new();
        for axis in 0..2 {
            let first = AxisWorld::new(program, id, free, axis);
            let second: OnceCell<AxisWorld<'_>> = OnceCell::new();
            for slot in world.slots.ids().filter(|s| is_ours(&world.slots[*s].entity)) {
                if first.tunnel(slot, false).is_none() {
                    continue;
                }
                let course = match has_bounds {
                    true => second.get_or_init(|| {
                        let space = bounded.get_or_init(|| configuration_space(program, id));
                        AxisWorld::new(program, id, space, axis)
                    }),
                    false => &first,
                };
                // An unbounded speed is no sign of a mistake: a fall without a floor below it has one.
                let Some((excess, tunnel)) = course.tunnel(slot, true) else { continue };
                let key = (world.slots[slot].entity, axis);
                if self.worst.get(&key).is_none_or(|(known, _)| *known < excess) {
                    self.worst.insert(key, (excess, tunnel));
                }
            }
        }
    }

    /// Reports each body at its greatest excess.
    pub fn report(self, found: &mut Diagnostics) {
        for (_, tunnel) in self.worst.into_values() {
            found.report(tunnel);
        }
    }
}

/// A collider: its tags and its extent along the axis, relative to the position.
struct Body {
    tags: TagSet,
    kinematic: bool,
    reach: Interval,
    at: Span,
}

/// Something that may block.
struct Obstacle {
    tags: TagSet,
    /// px
    thickness: f64,
    /// Its own velocity, px/s.
    velocity: Interval,
    spaces: BTreeSet<SpaceId>,
    name: String,
    at: Span,
    /// The slot that owns it, if there is exactly one.
    owner: Option<SlotId>,
}

/// A world, seen along one axis.
struct AxisWorld<'a> {
    program: &'a Program,
    id: WorldId,
    world: &'a World,
    space: &'a ConfigurationSpace,
    axis: usize,
    /// All obstacles; of each kind only the worst.
    obstacles: Vec<Obstacle>,
}

impl<'a> AxisWorld<'a> {
    fn new(program: &'a Program, id: WorldId, space: &'a ConfigurationSpace, axis: usize) -> Self {
        let world = &program.worlds[id];
        let mut course = AxisWorld { program, id, world, space, axis, obstacles: Vec::new() };
        course.obstacles = course.statics();
        course.obstacles.extend(course.movers());
        course
    }

    fn velocity(&self, of: &[Values; 3]) -> Option<Interval> {
        of[1].hull()
    }

    /// The worst case in which a slot is too fast, with its excess factor; with `bounded`, only finite speeds count.
    fn tunnel(&self, slot: SlotId, bounded: bool) -> Option<(f64, Tunnels)> {
        let found = &self.space.slots[slot];
        if found.is_given_up || found.configurations.is_empty() {
            return None;
        }
        let bodies: Vec<Body> = self.bodies(slot)?.into_iter().filter(|b| !b.kinematic).collect();
        let step = self.world.step.seconds();
        let mut worst: Option<(f64, Tunnels)> = None;
        for obstacle in self.obstacles.iter().filter(|o| o.owner != Some(slot)) {
            let pushes = |b: &Body| {
                let meeting = self.world.meeting(b.tags, obstacle.tags)?;
                match meeting.response.push {
                    Push::Sense => None,
                    Push::Block => Some(false),
                    // It blocks only from above.
                    Push::FromAbove => (self.axis == 1 && meeting.first_on_second).then_some(true),
                }
            };
            let met: Vec<(&Body, bool)> = bodies.iter().filter_map(|b| Some((b, pushes(b)?))).collect();
            // The colliders of a body stop together, so everything between the outermost ends counts as its extent.
            let Some(reach) = met.iter().map(|(b, _)| b.reach).reduce(Interval::or) else { continue };
            let from_above = met.iter().all(|(_, from_above)| *from_above);
            let extent = reach.high - reach.low;
            for at in found.configurations.iter().filter(|c| !c.spaces.is_disjoint(&obstacle.spaces)) {
                let Some(own) = self.velocity(&at.vars[VarId::from_index(self.axis)]) else { continue };
                let nearing = own.minus(obstacle.velocity);
                let down = if nearing.low < 0.0 { nearing.low } else { 0.0 };
                let speed = if from_above || nearing.high < -down { down } else { nearing.high };
                let excess = speed.abs() * step / (obstacle.thickness + extent);
                let passes = speed.abs() * step > obstacle.thickness + extent + ROUNDING;
                if passes && (speed.is_finite() || !bounded) && worst.as_ref().is_none_or(|(known, _)| *known < excess)
                {
                    let body = met.first().map(|(b, _)| b.at);
                    worst = Some((excess, self.finding((slot, at), body, obstacle, speed, extent)));
                }
            }
        }
        worst
    }

    fn finding(
        &self,
        (slot, at): (SlotId, &Configuration),
        body: Option<Span>,
        obstacle: &Obstacle,
        speed: f64,
        extent: f64,
    ) -> Tunnels {
        let entity = self.world.slots[slot].entity;
        let e = &self.program.entities[entity];
        let spans = &self.program.spans.entities[entity];
        let var = VarId::from_index(self.axis);
        let drives = |drive: &Drive| match *drive {
            Drive::Coast(v) | Drive::Flow { var: v, .. } => v == var,
            Drive::Envelope(id, _) => e.envelopes[id].vars.contains(&var),
        };
        let moving = at.leaves.iter().find(|l| e.leaves[**l].drives.iter().any(drives));
        Tunnels {
            at: body.unwrap_or(spans.name),
            velocity: e.variable_text(var, 1),
            speed,
            mode: moving.map(|l| spans.modes[e.leaves[*l].mode]),
            step: self.world.step.seconds(),
            over: (obstacle.name.clone(), obstacle.at),
            moves: obstacle.velocity != Interval::point(0.0),
            thickness: obstacle.thickness,
            extent,
        }
    }

    /// The colliders of a slot; `None` unless the sizes of all of them are constant.
    fn bodies(&self, slot: SlotId) -> Option<Vec<Body>> {
        let program = self.program;
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
            let (low, length) = c.shape.along(self.axis, number)?;
            let reach = Interval { low, high: low + length };
            Some(Body { tags: c.tags, kinematic: c.kinematic, reach, at: spans[id] })
        };
        program.entities[entity].colliders.pairs().map(body).collect()
    }

    /// Static obstacles; of those with the same tags in a space, the thinnest.
    fn statics(&self) -> Vec<Obstacle> {
        let spans = &self.program.spans.worlds[self.id];
        let mut thinnest: BTreeMap<(SpaceId, u64), Obstacle> = BTreeMap::new();
        let mut add = |space: SpaceId, tags: TagSet, thickness: f64, name: String, at: Span| {
            let velocity = Interval::point(0.0);
            let obstacle = Obstacle { tags, thickness, velocity, spaces: [space].into(), name, at, owner: None };
            let known = thinnest.get(&(space, tags.0));
            if thickness > 0.0 && known.is_none_or(|k| thickness < k.thickness) {
                thinnest.insert((space, tags.0), obstacle);
            }
        };
        for (space, s) in self.world.spaces.pairs() {
            for (solid, at) in s.solids.iter().zip(&spans.solids[space]) {
                let b = solid.bounds;
                let thickness = if self.axis == 0 { b.right - b.left } else { b.top - b.bottom };
                add(space, solid.tags, thickness, "this `rect`".to_string(), *at);
            }
            let Some(map) = &s.map else { continue };
            // In a row of tiles, the covered faces of those behind do not push, so the thickness is that of one tile.
            let thickness = if self.axis == 0 { map.tile.0 } else { map.tile.1 };
            for tags in used(map) {
                add(space, tags, thickness, format!("the tiles of `{}`", s.name), spans.spaces[space]);
            }
        }
        thinnest.into_values().collect()
    }

    /// Moving obstacles; colliders of the same kind and size are merged, with the hull of their velocities.
    fn movers(&self) -> Vec<Obstacle> {
        type Kind = (EntityId, usize, u64, BTreeSet<SpaceId>);
        let spans = &self.program.spans.worlds[self.id];
        let mut kinds: BTreeMap<Kind, Obstacle> = BTreeMap::new();
        for slot in self.world.slots.ids().filter(|s| self.space.overall[*s].can_live) {
            let overall = &self.space.overall[slot];
            let velocity = self.velocity(&overall.vars[VarId::from_index(self.axis)]);
            let Some(velocity) = velocity.filter(|v| v.low.is_finite() && v.high.is_finite()) else { continue };
            for (index, body) in self.bodies(slot).into_iter().flatten().enumerate() {
                let s = &self.world.slots[slot];
                let thickness = body.reach.high - body.reach.low;
                let kind = (s.entity, index, thickness.to_bits(), overall.spaces.clone());
                let known = kinds.entry(kind).or_insert_with(|| Obstacle {
                    tags: body.tags,
                    thickness,
                    velocity,
                    spaces: overall.spaces.clone(),
                    name: format!("`{}`", s.name),
                    at: spans.slots[slot],
                    owner: Some(slot),
                });
                known.velocity = known.velocity.or(velocity);
                known.owner = known.owner.filter(|owner| *owner == slot);
            }
        }
        kinds.into_values().filter(|o| o.thickness > 0.0).collect()
    }
}

/// The tags of the tiles that occur in a map.
fn used(map: &TileMap<TagId>) -> Vec<TagSet> {
    let mut is_used = vec![false; map.kinds.len()];
    for kind in &map.cells {
        if let Some(is_used) = is_used.get_mut(usize::from(*kind)) {
            *is_used = true;
        }
    }
    let kinds = map.kinds.iter().zip(is_used).filter(|(_, is_used)| *is_used);
    kinds.map(|(k, _)| k.tags.iter().copied().collect()).collect()
}

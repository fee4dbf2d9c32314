//! The gap between the bodies of an instance and what it is to touch, between the boxes around them, px.

use crate::ir::{Bounds, Extremes, Id, Origin, Period, SlotId, Space, SpaceId, TagSet, TouchId};
use crate::sim::Simulator;

use super::super::goal_positions::extent;
use super::super::problem::Problem;
use super::lack::{Lack, ROOM};
use super::rooms::ways_to;
use super::unit::Unit;

/// What it counts as if the body that is to touch is not there, in tiles of 16 px.
const NO_BODY: f64 = 4.0;

/// A contact that is needed.
#[derive(Debug)]
pub(super) struct Contact {
    slot: SlotId,
    /// Tags of the own bodies.
    mine: TagSet,
    /// Tags of what is to be touched.
    other: TagSet,
    /// For each space, tiles and rectangles that last, neighbours as one.
    statics: Vec<Vec<Bounds>>,
    /// A box around these.
    hulls: Vec<Option<Bounds>>,
    /// Slots whose instances may have such a body.
    slots: Vec<SlotId>,
    /// A box around all own bodies, relative to the position; none if it varies.
    body: Option<Bounds>,
    /// For each space, the number of rooms to the nearest one that has something to touch.
    rooms: Vec<u32>,
}

impl Contact {
    /// The contact of a query of a slot's entity; `None` if nothing that lasts can be touched.
    pub fn new(problem: &Problem<'_>, slot: SlotId, touch: TouchId) -> Option<Contact> {
        let (program, world) = (problem.sim.program(), problem.sim.world());
        let entity = &program.entities[world.slots[slot].entity];
        let touch = entity.touches.get(touch)?;
        let (mine, other) = (touch.mine, TagSet::of(touch.other));
        let statics: Vec<Vec<Bounds>> = world.spaces.iter().map(|space| static_boxes(space, other)).collect();
        let has_body = |of: &SlotId| {
            *of != slot && program.entities[world.slots[*of].entity].colliders.iter().any(|c| c.tags.meets(other))
        };
        let slots: Vec<SlotId> = world.slots.ids().filter(has_body).collect();
        let can_be = |space: SpaceId| {
            let is_there = |of: &SlotId| world.slots[*of].origin != Origin::Free && world.slots[*of].space == space;
            !statics[space.index()].is_empty() || slots.iter().any(is_there)
        };
        let mut own = entity.colliders.iter().filter(|collider| collider.tags.meets(mine));
        let body = own.try_fold(None, |hull: Option<Bounds>, collider| {
            let body = extent(problem, slot, collider)?;
            Some(Some(hull.map_or(body, |hull| hull.join(body))))
        });
        let rooms = ways_to(world, can_be);
        let hulls: Vec<Option<Bounds>> =
            statics.iter().map(|boxes| boxes.iter().copied().reduce(Bounds::join)).collect();
        let is_any = !slots.is_empty() || hulls.iter().any(Option::is_some);
        is_any.then(|| Contact { slot, mine, other, statics, hulls, slots, body: body.flatten(), rooms })
    }

    /// What is missing in a state in which there is no contact.
    pub fn lack(&self, sim: &Simulator, state: &[u8], limit: f64, unit: Unit) -> Lack {
        let me = sim.instance(state, self.slot);
        let (space, position) = (me.space(), me.position());
        let (table, index) = (&sim.world().spaces[space], space.index());
        if let (Some(body), Some(hull), true) = (self.body, self.hulls[index], self.slots.is_empty()) {
            let least = gap(&body.placed(position), &hull, table.periods) * unit.weight();
            if least >= limit {
                return Lack::unmeasured(least);
            }
        }
        let mut least = f64::INFINITY;
        let mut has_body = false;
        for (id, own) in me.colliders() {
            if !me.entity().colliders[id].tags.meets(self.mine) {
                continue;
            }
            has_body = true;
            least = least.least(self.gap_from(sim, state, space, &own.placed(position)));
        }
        if !has_body && let Some(body) = self.body {
            least = self.gap_from(sim, state, space, &body.placed(position));
        }
        match (least < f64::INFINITY, has_body) {
            (true, true) => Lack { holds: false, distance: Some(least), cost: 1e-9 + least * unit.weight() },
            (true, false) => Lack::unmeasured(NO_BODY + least * unit.weight()),
            (false, _) => match self.rooms[index] {
                u32::MAX => Lack::unmeasured(8.0 * ROOM),
                rooms => Lack::unmeasured(f64::from(rooms.max(1)) * ROOM),
            },
        }
    }

    /// Whose contact it is.
    pub fn slot(&self) -> SlotId {
        self.slot
    }

    /// Whether an own body is there in a state.
    pub fn has_body(&self, sim: &Simulator, state: &[u8]) -> bool {
        let me = sim.instance(state, self.slot);
        me.colliders().any(|(id, _)| me.entity().colliders[id].tags.meets(self.mine))
    }

    /// The number of rooms to the nearest one that has something to touch from the first, as far as it is known.
    pub fn rooms_away(&self, space: SpaceId) -> Option<u32> {
        self.rooms.get(space.index()).copied().filter(|rooms| (1..u32::MAX).contains(rooms))
    }

    /// Whether there is something to touch in the room of the instance.
    pub fn is_in_room(&self, sim: &Simulator, state: &[u8]) -> bool {
        let space = sim.space(state, self.slot);
        let is_there = |of: &SlotId| {
            let other = sim.instance(state, *of);
            other.is_alive() && other.space() == space
        };
        self.hulls[space.index()].is_some() || self.slots.iter().any(is_there)
    }

    fn gap_from(&self, sim: &Simulator, state: &[u8], space: SpaceId, own: &Bounds) -> f64 {
        let periods = sim.world().spaces[space].periods;
        let mut least = f64::INFINITY;
        for there in &self.statics[space.index()] {
            least = least.least(gap(own, there, periods));
        }
        for slot in &self.slots {
            let other = sim.instance(state, *slot);
            if !other.is_alive() || other.space() != space {
                continue;
            }
            for (id, there) in other.colliders() {
                if other.entity().colliders[id].tags.meets(self.other) {
                    least = least.least(gap(own, &there.placed(other.position()), periods));
                }
            }
        }
        least
    }
}

/// The distance between two boxes, by the shorter way in a space that wraps.
fn gap(a: &Bounds, b: &Bounds, [x, y]: [Option<Period>; 2]) -> f64 {
    let along = |(a_low, a_high): (f64, f64), (b_low, b_high): (f64, f64), period: Option<Period>| {
        let apart = |shift: f64| (b_low + shift - a_high).greatest(a_low - b_high - shift).greatest(0.0);
        match period {
            None => apart(0.0),
            Some(period) => apart(0.0).least(apart(period.size())).least(apart(-period.size())),
        }
    };
    let across = along((a.left, a.right), (b.left, b.right), x);
    let up = along((a.bottom, a.top), (b.bottom, b.top), y);
    if up == 0.0 {
        across
    } else if across == 0.0 {
        up
    } else {
        (across * across + up * up).sqrt()
    }
}

/// The rectangles and tiles of a space with some tags that last; tiles side by side are one box, and so are equal rows.
fn static_boxes(space: &Space, tags: TagSet) -> Vec<Bounds> {
    let mut boxes: Vec<Bounds> =
        space.solids.iter().filter(|solid| solid.tags.meets(tags)).map(|solid| solid.bounds).collect();
    let Some(map) = &space.map else { return boxes };
    let is_wanted = |kind: &crate::ir::TileKind<crate::ir::TagId>| {
        kind.lasts() && kind.tags.iter().copied().collect::<TagSet>().meets(tags)
    };
    let wanted: Vec<bool> = map.kinds.iter().map(is_wanted).collect();
    let mut open: Vec<Bounds> = Vec::new();
    for row in 0..map.rows {
        let mut runs: Vec<Bounds> = Vec::new();
        for column in 0..map.columns {
            let cell = row * map.columns + column;
            if !map.cells.get(cell).is_some_and(|kind| wanted.get(usize::from(*kind)).copied().unwrap_or(false)) {
                continue;
            }
            let tile = Bounds::new(map.rectangle(cell));
            match runs.last_mut().filter(|run| run.right == tile.left) {
                Some(run) => run.right = tile.right,
                None => runs.push(tile),
            }
        }
        let mut next = Vec::with_capacity(runs.len());
        for run in runs {
            let is_same = |known: &Bounds| {
                (known.left, known.right) == (run.left, run.right)
                    && (known.top == run.bottom || known.bottom == run.top)
            };
            match open.iter().position(is_same) {
                Some(at) => next.push(open.swap_remove(at).join(run)),
                None => next.push(run),
            }
        }
        boxes.append(&mut open);
        open = next;
    }
    boxes.append(&mut open);
    boxes
}

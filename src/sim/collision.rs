//! The collision phase: carrying, boxes, contacts, contact bits, pushes.
//!
//! A contact exists between two active colliders of one space that a `collide` line pairs, when they overlap or
//! touch along an edge. All contacts are found before anything is pushed.

use std::cell::Cell;

use crate::ir::{
    Bounds, ColliderId, ExprId, Id, IdVec, Meeting, Origin, Program, Push, Shape, Side, SlotId, TagSet, VarId, World,
};

use super::broad::{Broad, sweep};
use super::contact::{Contact, Rect, Stops, meet, opposite, resolve};
use super::evaluate::Reader;
use super::fault::Fault;
use super::simulator::{Scratch as StepScratch, Simulator};

/// What is known of a world's colliders before it runs.
#[derive(Debug)]
pub(super) struct Collision {
    bodies: Vec<Body>,
    /// Bodies that share their tags.
    kinds: Vec<Kind>,
    /// For each space, for each kind of tile: its tags.
    tile_tags: Vec<Vec<TagSet>>,
    broad: Broad,
    /// Whether anything carries.
    carries: bool,
}

/// A collider of a slot.
#[derive(Debug)]
struct Body {
    slot: SlotId,
    collider: ColliderId,
    kind: usize,
    kinematic: bool,
    /// The box, where it never changes: x and y of the lower-left corner, width, height.
    fixed: Option<[f64; 4]>,
}

/// What bodies with the same tags have in common.
#[derive(Debug)]
struct Kind {
    tags: TagSet,
    /// With each kind: how they meet.
    kinds: Vec<Option<Meeting>>,
    /// For each space, for each kind of tile: how they meet.
    tiles: Vec<Vec<Option<Meeting>>>,
    /// For each space, for each free-standing rectangle: how they meet.
    solids: Vec<Vec<Option<Meeting>>>,
    /// For each space, whether any kind of tile can be met.
    meets_tiles: Vec<bool>,
}

/// Working memory.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    boxes: Vec<Rect>,
    order: Vec<u32>,
    /// For each slot: how far it is pushed, x and y.
    pushes: Vec<[f64; 2]>,
    /// For each slot: the directions in which its velocity is stopped.
    stops: Vec<Stops>,
}

impl Collision {
    /// Prepares a world.
    pub fn new(program: &Program, world: &World) -> Self {
        let tile_tags: Vec<Vec<TagSet>> = world
            .spaces
            .iter()
            .map(|s| s.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect()).collect())
            .collect();
        let mut all_tags: Vec<TagSet> = Vec::new();
        let mut bodies = Vec::new();
        for (slot, s) in world.slots.pairs() {
            for (collider, c) in program.entities[s.entity].colliders.pairs() {
                let kind = all_tags.iter().position(|t| *t == c.tags).unwrap_or_else(|| {
                    all_tags.push(c.tags);
                    all_tags.len() - 1
                });
                let fixed = fixed_box(program, world, slot, &c.shape);
                bodies.push(Body { slot, collider, kind, kinematic: c.kinematic, fixed });
            }
        }
        let kinds: Vec<Kind> = all_tags
            .iter()
            .map(|&tags| {
                let with = |others: &[TagSet]| others.iter().map(|&o| world.meeting(tags, o)).collect::<Vec<_>>();
                let tiles: Vec<_> = tile_tags.iter().map(|kinds| with(kinds)).collect();
                let solids =
                    world.spaces.iter().map(|s| s.solids.iter().map(|x| world.meeting(tags, x.tags)).collect());
                let meets_tiles = tiles.iter().map(|kinds| kinds.iter().any(Option::is_some)).collect();
                Kind { tags, kinds: with(&all_tags), tiles, solids: solids.collect(), meets_tiles }
            })
            .collect();
        let broad = Broad::new(bodies.len(), |i, j| {
            let (a, b): (&Body, &Body) = (&bodies[i], &bodies[j]);
            if a.slot == b.slot { None } else { kinds[a.kind].kinds[b.kind] }
        });
        let carries = world.collide.iter().any(|c| c.response.carry);
        Collision { bodies, kinds, tile_tags, broad, carries }
    }

    /// Working memory for this world.
    pub fn scratch(&self, world: &World) -> Scratch {
        Scratch {
            boxes: vec![Rect::default(); self.bodies.len()],
            order: Vec::with_capacity(self.bodies.len()),
            pushes: vec![[0.0; 2]; world.slots.len()],
            stops: vec![Stops::default(); world.slots.len()],
        }
    }
}

/// The box of a collider whose numbers read nothing but parameters that never change.
fn fixed_box(program: &Program, world: &World, slot: SlotId, shape: &Shape) -> Option<[f64; 4]> {
    let slot = &world.slots[slot];
    let none = IdVec::new();
    let params = if slot.origin == Origin::Named { &slot.params } else { &none };
    box_of(shape, |id| program.constant(id, params, world.step))
}

/// A shape's box: x and y of the lower-left corner, width, height.
fn box_of(shape: &Shape, number: impl Fn(ExprId) -> Option<f64>) -> Option<[f64; 4]> {
    Some(match shape {
        Shape::Rect([x, y, width, height]) => [number(*x)?, number(*y)?, number(*width)?, number(*height)?],
        Shape::Circle([x, y, radius]) => {
            let (x, y, radius) = (number(*x)?, number(*y)?, number(*radius)?);
            [x - radius, y - radius, 2.0 * radius, 2.0 * radius]
        }
    })
}

/// A contact with something that never moves.
struct Hit {
    other: TagSet,
    meeting: Meeting,
    contact: Contact,
}

impl Simulator<'_> {
    /// Finds all contacts and, with `push`, resolves the blocking ones.
    pub(super) fn collide(&self, state: &mut [u8], scratch: &mut StepScratch, push: bool) -> Result<(), Fault> {
        if push && self.collision.carries {
            self.carry(state, &scratch.start);
        }
        self.place_boxes(state, scratch)?;
        let StepScratch { start, collision, .. } = scratch;
        let Scratch { boxes, order, pushes, stops } = collision;
        for id in self.world().slots.ids() {
            let entity = self.entity(id);
            self.layout(id).clear_touches(state, entity.touches.len(), entity.bound);
        }
        pushes.fill([0.0; 2]);
        stops.fill(Stops::default());
        let bodies = &self.collision.bodies;
        let mut found = |i: usize, j: usize, meeting: Meeting| {
            self.pair(state, (i, j), meeting, boxes, start, pushes, stops);
        };
        match &self.collision.broad {
            Broad::Listed(pairs) => {
                for &(i, j, meeting) in pairs {
                    let (i, j) = (i as usize, j as usize);
                    if boxes[i].active && boxes[j].active && boxes[i].space == boxes[j].space {
                        found(i, j, meeting);
                    }
                }
            }
            Broad::Swept => sweep(boxes, order, |i, j| {
                let (a, b) = (&bodies[i], &bodies[j]);
                if a.slot != b.slot
                    && let Some(meeting) = self.collision.kinds[a.kind].kinds[b.kind]
                {
                    found(i, j, meeting);
                }
            }),
        }
        for (body, rect) in bodies.iter().zip(boxes.iter()) {
            if rect.active {
                let at = body.slot.index();
                let back = self.back(state, body.slot, start);
                self.collide_solids(state, body, rect, back, (&mut pushes[at], &mut stops[at]));
                self.collide_tiles(state, body, rect, back, (&mut pushes[at], &mut stops[at]));
            }
        }
        if push {
            for id in self.world().slots.ids() {
                self.push(state, id, pushes[id.index()], stops[id.index()]);
            }
        }
        Ok(())
    }

    /// Moves what stands on a carrier along with it, lowest slot first, and forgets who stands where.
    fn carry(&self, state: &mut [u8], start: &[(f64, f64)]) {
        for me in self.world().slots.ids() {
            let layout = self.layout(me);
            let Some(carrier) = layout.carrier(state).filter(|_| layout.acts(state)) else { continue };
            if self.layout(carrier).acts(state) && self.space(state, carrier) == layout.space(state) {
                let (x, y) = self.position(state, carrier);
                let (from_x, from_y) = start[carrier.index()];
                let (own_x, own_y) = self.position(state, me);
                layout.set_var(state, VarId(0), 0, own_x + (x - from_x));
                layout.set_var(state, VarId(1), 0, own_y + (y - from_y));
            }
            layout.set_carrier(state, None);
        }
    }

    /// From where a slot is to where it was as the continuous phase began.
    fn back(&self, state: &[u8], slot: SlotId, start: &[(f64, f64)]) -> (f64, f64) {
        let (x, y) = self.position(state, slot);
        let (from_x, from_y) = start[slot.index()];
        (from_x - x, from_y - y)
    }

    /// Moves all boxes to where their instances are.
    fn place_boxes(&self, state: &[u8], scratch: &mut StepScratch) -> Result<(), Fault> {
        let StepScratch { frames, collision, .. } = scratch;
        let fault = Cell::new(None);
        for (body, rect) in self.collision.bodies.iter().zip(collision.boxes.iter_mut()) {
            let layout = self.layout(body.slot);
            rect.active = layout.acts(state);
            if !rect.active {
                continue;
            }
            let collider = &self.entity(body.slot).colliders[body.collider];
            let reader = Reader { sim: self, state, frames, taken: &[], fault: &fault, me: body.slot };
            if !collider.guard.is_none_or(|guard| reader.truth(guard)) {
                rect.active = false;
                continue;
            }
            let read = || box_of(&collider.shape, |id| Some(reader.number(id))).unwrap_or_default();
            let [x, y, width, height] = body.fixed.unwrap_or_else(read);
            let (px, py) = self.position(state, body.slot);
            rect.left = px + x;
            rect.right = rect.left + width;
            rect.bottom = py + y;
            rect.top = rect.bottom + height;
            rect.space = layout.space(state).0;
            rect.round = matches!(collider.shape, Shape::Circle(_));
            // A collider that shrank to nothing touches nothing.
            rect.active = width > 0.0 && height > 0.0;
        }
        Self::settle(&fault)
    }

    /// Two bodies of one space.
    #[allow(clippy::too_many_arguments, reason = "the parts of the working memory are borrowed one by one")]
    fn pair(
        &self,
        state: &mut [u8],
        (i, j): (usize, usize),
        meeting: Meeting,
        boxes: &[Rect],
        start: &[(f64, f64)],
        pushes: &mut [[f64; 2]],
        stops: &mut [Stops],
    ) {
        let (a, b) = (&self.collision.bodies[i], &self.collision.bodies[j]);
        let (back_a, back_b) = (self.back(state, a.slot, start), self.back(state, b.slot, start));
        let back = (back_a.0 - back_b.0, back_a.1 - back_b.1);
        let Some(contact) = meet(&boxes[i], &boxes[j], back, meeting, |_| (false, false)) else { return };
        let side = contact.side;
        let kinds = &self.collision.kinds;
        self.touch(state, a, kinds[b.kind].tags, Some(b.slot), side);
        self.touch(state, b, kinds[a.kind].tags, Some(a.slot), opposite(side));
        if meeting.response.carry {
            let stands = |state: &mut [u8], rider: &Body, on: &Body| {
                let layout = self.layout(rider.slot);
                if !rider.kinematic && layout.carrier(state).is_none_or(|c| on.slot < c) {
                    layout.set_carrier(state, Some(on.slot));
                }
            };
            match side {
                Side::Below if meeting.first_on_second => stands(state, a, b),
                Side::Above if meeting.second_on_first => stands(state, b, a),
                _ => {}
            }
        }
        if meeting.response.push == Push::Sense {
            return;
        }
        let share = if a.kinematic || b.kinematic { 1.0 } else { 0.5 };
        for (body, side) in [(a, side), (b, opposite(side))] {
            if !body.kinematic {
                let contact = Contact { side, depth: contact.depth * share };
                let at = body.slot.index();
                resolve(contact, meeting.response.stop, &mut pushes[at], &mut stops[at]);
            }
        }
    }

    /// Sets the contact bits of one body for a contact with something tagged `other`.
    fn touch(&self, state: &mut [u8], body: &Body, other: TagSet, instance: Option<SlotId>, side: Side) {
        let layout = self.layout(body.slot);
        let mine = self.collision.kinds[body.kind].tags;
        for (id, touch) in self.entity(body.slot).touches.pairs() {
            let on_side = touch.side.is_none_or(|wanted| wanted == side);
            if !on_side || !touch.mine.meets(mine) || !other.meets(TagSet::of(touch.other)) {
                continue;
            }
            if touch.bound {
                let Some(instance) = instance else { continue };
                if layout.touched(state, id).is_none_or(|known| instance < known) {
                    layout.set_touched(state, id, Some(instance));
                }
            }
            layout.set_touch(state, id);
        }
    }

    /// A contact with something that never moves: the body alone is pushed.
    fn hit(&self, state: &mut [u8], body: &Body, hit: &Hit, (push, stops): (&mut [f64; 2], &mut Stops)) {
        self.touch(state, body, hit.other, None, hit.contact.side);
        if hit.meeting.response.push != Push::Sense && !body.kinematic {
            resolve(hit.contact, hit.meeting.response.stop, push, stops);
        }
    }

    fn collide_solids(
        &self,
        state: &mut [u8],
        body: &Body,
        rect: &Rect,
        back: (f64, f64),
        (push, stops): (&mut [f64; 2], &mut Stops),
    ) {
        let space = self.layout(body.slot).space(state);
        let solids = &self.world().spaces[space].solids;
        for (solid, meeting) in solids.iter().zip(&self.collision.kinds[body.kind].solids[space.index()]) {
            let Some(meeting) = *meeting else { continue };
            let Bounds { left, right, bottom, top } = solid.bounds;
            let other = Rect { left, right, bottom, top, active: true, ..Rect::default() };
            let Some(contact) = meet(rect, &other, back, meeting, |_| (false, false)) else { continue };
            self.hit(state, body, &Hit { other: solid.tags, meeting, contact }, (push, stops));
        }
    }

    fn collide_tiles(
        &self,
        state: &mut [u8],
        body: &Body,
        rect: &Rect,
        back: (f64, f64),
        (push, stops): (&mut [f64; 2], &mut Stops),
    ) {
        let space = self.layout(body.slot).space(state);
        let kind = &self.collision.kinds[body.kind];
        let (Some(map), true) = (&self.world().spaces[space].map, kind.meets_tiles[space.index()]) else {
            return;
        };
        let meetings = &kind.tiles[space.index()];
        let (width, height) = map.tile;
        // A tile that is touched along its edge counts, so the range is closed at both ends.
        let columns = range(rect.left, rect.right, width, map.columns);
        let rows = range(rect.bottom, rect.top, height, map.rows);
        let tags = &self.collision.tile_tags[space.index()];
        let meeting = |column: i64, row: i64| map.kind(column, row).and_then(|kind| meetings[kind]);
        let blocks = |column: i64, row: i64| meeting(column, row).is_some_and(|m| m.response.push == Push::Block);
        for column in columns {
            for row in rows.clone() {
                let Some(kind) = map.kind(column, row) else { continue };
                let Some(found) = meetings[kind] else { continue };
                let (left, bottom) = (column as f64 * width, row as f64 * height);
                let tile =
                    Rect { left, right: left + width, bottom, top: bottom + height, active: true, ..Rect::default() };
                // The faces turned to the body; one that a neighbour covers never gives the side.
                let contact = meet(rect, &tile, back, found, |overlap| {
                    let beside = if overlap.x_side == Side::Right { column - 1 } else { column + 1 };
                    let over = if overlap.y_side == Side::Above { row - 1 } else { row + 1 };
                    (blocks(beside, row), blocks(column, over))
                });
                let Some(contact) = contact else { continue };
                self.hit(state, body, &Hit { other: tags[kind], meeting: found, contact }, (push, stops));
            }
        }
    }

    fn push(&self, state: &mut [u8], slot: SlotId, push: [f64; 2], stops: Stops) {
        let layout = self.layout(slot);
        let axes = [(VarId(0), stops.left, stops.right), (VarId(1), stops.below, stops.above)];
        for ((var, low, high), push) in axes.into_iter().zip(push) {
            if push != 0.0 {
                let position = layout.var(state, var, 0);
                layout.set_var(state, var, 0, position + push);
            }
            if low || high {
                let velocity = layout.var(state, var, 1);
                if (low && velocity < 0.0) || (high && velocity > 0.0) {
                    layout.set_var(state, var, 1, 0.0);
                }
            }
        }
    }
}

/// The tiles whose closed extent meets `low..=high`, cut to those of the map.
fn range(low: f64, high: f64, size: f64, count: usize) -> std::ops::RangeInclusive<i64> {
    let first = ((low / size).ceil() - 1.0).max(0.0) as i64;
    let last = (high / size).floor().min(count as f64 - 1.0) as i64;
    first..=last
}

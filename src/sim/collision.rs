//! The collision phase: boxes, contacts, contact bits, pushes.
//!
//! A contact exists between two active colliders of one space that a `collide` line pairs, when they overlap or
//! touch along an edge. All contacts are found before anything is pushed.

use std::cell::Cell;

use crate::ir::{Bounds, ColliderId, Id, Program, Response, Side, SlotId, TagSet, VarId, World};

use super::evaluate::Reader;
use super::fault::Fault;
use super::simulator::{Scratch as StepScratch, Simulator};

/// What is known of a world's colliders before it runs.
#[derive(Debug)]
pub(super) struct Collision {
    bodies: Vec<Body>,
    /// For each space, for each kind of tile: its tags.
    tile_tags: Vec<Vec<TagSet>>,
    /// Pairs of bodies that can meet, with what a contact does.
    pairs: Vec<(usize, usize, Response)>,
}

/// A collider of a slot.
#[derive(Debug)]
struct Body {
    slot: SlotId,
    collider: ColliderId,
    tags: TagSet,
    kinematic: bool,
    /// The rectangle, where it never changes.
    fixed: Option<[f64; 4]>,
    /// For each space, for each kind of tile: what a contact does.
    tiles: Vec<Vec<Option<Response>>>,
    /// For each space, for each free-standing rectangle: what a contact does.
    solids: Vec<Vec<Option<Response>>>,
}

/// A rectangle in a space.
#[derive(Debug, Clone, Copy, Default)]
struct Rect {
    left: f64,
    right: f64,
    bottom: f64,
    top: f64,
    active: bool,
}

/// Working memory.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    boxes: Vec<Rect>,
    /// For each slot: how far it is pushed, x and y.
    pushes: Vec<[f64; 2]>,
    /// For each slot: the directions in which its velocity is stopped.
    stops: Vec<Stops>,
}

/// Sides on which a velocity is set to 0.
#[derive(Debug, Clone, Copy, Default)]
struct Stops {
    left: bool,
    right: bool,
    above: bool,
    below: bool,
}

/// How two boxes touch: the side of the first, and how deep, px.
#[derive(Debug, Clone, Copy)]
struct Contact {
    side: Side,
    depth: f64,
}

/// Overlaps of two boxes along both axes, each with the side of the first that it is on.
struct Overlap {
    x: f64,
    x_side: Side,
    y: f64,
    y_side: Side,
}

impl Overlap {
    /// None if the boxes are apart or touch in a corner only.
    fn of(a: &Rect, b: &Rect) -> Option<Overlap> {
        let (right, left) = (a.right - b.left, b.right - a.left);
        let (above, below) = (a.top - b.bottom, b.top - a.bottom);
        if right < 0.0 || left < 0.0 || above < 0.0 || below < 0.0 {
            return None;
        }
        let (x, x_side) = if right <= left { (right, Side::Right) } else { (left, Side::Left) };
        let (y, y_side) = if above <= below { (above, Side::Above) } else { (below, Side::Below) };
        if x == 0.0 && y == 0.0 {
            return None;
        }
        Some(Overlap { x, x_side, y, y_side })
    }

    fn horizontal(&self) -> Contact {
        Contact { side: self.x_side, depth: self.x }
    }

    fn vertical(&self) -> Contact {
        Contact { side: self.y_side, depth: self.y }
    }

    /// Along the axis of least penetration, ties vertical.
    fn least(&self) -> Contact {
        if self.x < self.y { self.horizontal() } else { self.vertical() }
    }
}

fn opposite(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    }
}

impl Collision {
    /// Prepares a world.
    pub fn new(program: &Program, world: &World) -> Self {
        let mut bodies = Vec::new();
        let tile_tags: Vec<Vec<TagSet>> = world
            .spaces
            .iter()
            .map(|s| s.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect()).collect())
            .collect();
        for (slot, s) in world.slots.pairs() {
            for (collider, c) in program.entities[s.entity].colliders.pairs() {
                let tiles =
                    tile_tags.iter().map(|kinds| kinds.iter().map(|&k| world.response(c.tags, k)).collect()).collect();
                let solids = world
                    .spaces
                    .iter()
                    .map(|s| s.solids.iter().map(|x| world.response(c.tags, x.tags)).collect())
                    .collect();
                let fixed = fixed_rect(program, world, slot, c.rect);
                bodies.push(Body { slot, collider, tags: c.tags, kinematic: c.kinematic, fixed, tiles, solids });
            }
        }
        let mut pairs = Vec::new();
        for (i, a) in bodies.iter().enumerate() {
            for (j, b) in bodies.iter().enumerate().skip(i + 1) {
                if a.slot != b.slot {
                    pairs.extend(world.response(a.tags, b.tags).map(|response| (i, j, response)));
                }
            }
        }
        Collision { bodies, tile_tags, pairs }
    }

    /// Working memory for this world.
    pub fn scratch(&self, world: &World) -> Scratch {
        Scratch {
            boxes: vec![Rect::default(); self.bodies.len()],
            pushes: vec![[0.0; 2]; world.slots.len()],
            stops: vec![Stops::default(); world.slots.len()],
        }
    }
}

/// The rectangle of a collider whose numbers read nothing but parameters.
fn fixed_rect(program: &Program, world: &World, slot: SlotId, rect: [crate::ir::ExprId; 4]) -> Option<[f64; 4]> {
    let params = &world.slots[slot].params;
    let mut values = [0.0; 4];
    for (value, id) in values.iter_mut().zip(rect) {
        *value = program.constant(id, params, world.step)?;
    }
    Some(values)
}

impl Simulator<'_> {
    /// Finds all contacts and, with `push`, resolves the blocking ones.
    pub(super) fn collide(&self, state: &mut [u8], scratch: &mut StepScratch, push: bool) -> Result<(), Fault> {
        self.place_boxes(state, scratch)?;
        let Scratch { boxes, pushes, stops } = &mut scratch.collision;
        for id in self.world().slots.ids() {
            self.layout(id).clear_touches(state, self.entity(id).touches.len());
        }
        pushes.fill([0.0; 2]);
        stops.fill(Stops::default());
        for &(i, j, response) in &self.collision.pairs {
            if !boxes[i].active || !boxes[j].active {
                continue;
            }
            let (a, b) = (&self.collision.bodies[i], &self.collision.bodies[j]);
            if self.layout(a.slot).space(state) != self.layout(b.slot).space(state) {
                continue;
            }
            let Some(contact) = Overlap::of(&boxes[i], &boxes[j]).map(|o| o.least()) else {
                continue;
            };
            self.touch(state, a, b.tags, contact.side);
            self.touch(state, b, a.tags, opposite(contact.side));
            let Response::Block { keep_velocity } = response else {
                continue;
            };
            let share = if a.kinematic || b.kinematic { 1.0 } else { 0.5 };
            for (body, side) in [(a, contact.side), (b, opposite(contact.side))] {
                if !body.kinematic {
                    let depth = contact.depth * share;
                    let at = body.slot.index();
                    resolve(Contact { side, depth }, keep_velocity, &mut pushes[at], &mut stops[at]);
                }
            }
        }
        for (body, rect) in self.collision.bodies.iter().zip(boxes.iter()) {
            if rect.active {
                let at = body.slot.index();
                self.collide_solids(state, body, rect, &mut pushes[at], &mut stops[at]);
                self.collide_tiles(state, body, rect, &mut pushes[at], &mut stops[at]);
            }
        }
        if push {
            for id in self.world().slots.ids() {
                self.push(state, id, pushes[id.index()], stops[id.index()]);
            }
        }
        Ok(())
    }

    /// Moves all boxes to where their instances are.
    fn place_boxes(&self, state: &[u8], scratch: &mut StepScratch) -> Result<(), Fault> {
        let StepScratch { frames, collision, .. } = scratch;
        let fault = Cell::new(None);
        for (body, rect) in self.collision.bodies.iter().zip(collision.boxes.iter_mut()) {
            let collider = &self.entity(body.slot).colliders[body.collider];
            let reader = Reader { sim: self, state, frames, fault: &fault, me: body.slot };
            rect.active = self.layout(body.slot).alive(state) && collider.guard.is_none_or(|guard| reader.truth(guard));
            if !rect.active {
                continue;
            }
            let [x, y, width, height] = body.fixed.unwrap_or_else(|| collider.rect.map(|id| reader.number(id)));
            let (px, py) = self.position(state, body.slot);
            rect.left = px + x;
            rect.right = rect.left + width;
            rect.bottom = py + y;
            rect.top = rect.bottom + height;
            // A collider that shrank to nothing touches nothing.
            rect.active = width > 0.0 && height > 0.0;
        }
        Self::settle(&fault)
    }

    /// Sets the contact bits of one body for a contact with something tagged `other`.
    fn touch(&self, state: &mut [u8], body: &Body, other: TagSet, side: Side) {
        let layout = self.layout(body.slot);
        for (id, touch) in self.entity(body.slot).touches.pairs() {
            let on_side = touch.side.is_none_or(|wanted| wanted == side);
            if on_side && touch.mine.meets(body.tags) && other.meets(TagSet::of(touch.other)) {
                layout.set_touch(state, id);
            }
        }
    }

    /// A contact with something that never moves: the body alone is pushed.
    fn meet(
        &self,
        state: &mut [u8],
        body: &Body,
        other: TagSet,
        response: Response,
        contact: Contact,
        (push, stops): (&mut [f64; 2], &mut Stops),
    ) {
        self.touch(state, body, other, contact.side);
        if let (Response::Block { keep_velocity }, false) = (response, body.kinematic) {
            resolve(contact, keep_velocity, push, stops);
        }
    }

    fn collide_solids(&self, state: &mut [u8], body: &Body, rect: &Rect, push: &mut [f64; 2], stops: &mut Stops) {
        let space = self.layout(body.slot).space(state);
        let solids = &self.world().spaces[space].solids;
        for (solid, response) in solids.iter().zip(&body.solids[space.index()]) {
            let Some(response) = *response else { continue };
            let Bounds { left, right, bottom, top } = solid.bounds;
            let other = Rect { left, right, bottom, top, active: true };
            let Some(contact) = Overlap::of(rect, &other).map(|o| o.least()) else { continue };
            self.meet(state, body, solid.tags, response, contact, (push, stops));
        }
    }

    fn collide_tiles(&self, state: &mut [u8], body: &Body, rect: &Rect, push: &mut [f64; 2], stops: &mut Stops) {
        let space = self.layout(body.slot).space(state);
        let Some(map) = &self.world().spaces[space].map else {
            return;
        };
        let responses = &body.tiles[space.index()];
        if responses.iter().all(Option::is_none) {
            return;
        }
        let (width, height) = map.tile;
        // A tile that is touched along its edge counts, so the range is closed at both ends.
        let columns = range(rect.left, rect.right, width, map.columns);
        let rows = range(rect.bottom, rect.top, height, map.rows);
        let tags = &self.collision.tile_tags[space.index()];
        let response = |column: i64, row: i64| map.kind(column, row).and_then(|kind| responses[kind]);
        let blocks = |column: i64, row: i64| matches!(response(column, row), Some(Response::Block { .. }));
        for column in columns {
            for row in rows.clone() {
                let Some(kind) = map.kind(column, row) else { continue };
                let Some(found) = responses[kind] else { continue };
                let (left, bottom) = (column as f64 * width, row as f64 * height);
                let tile = Rect { left, right: left + width, bottom, top: bottom + height, active: true };
                let Some(overlap) = Overlap::of(rect, &tile) else {
                    continue;
                };
                // The faces turned to the body; one that a neighbour covers never gives the side.
                let beside = if overlap.x_side == Side::Right { column - 1 } else { column + 1 };
                let over = if overlap.y_side == Side::Above { row - 1 } else { row + 1 };
                let contact = match (blocks(beside, row), blocks(column, over)) {
                    (true, false) => overlap.vertical(),
                    (false, true) => overlap.horizontal(),
                    _ => overlap.least(),
                };
                self.meet(state, body, tags[kind], found, contact, (push, stops));
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

/// Adds a blocking contact to what pushes an instance: per axis the deepest counts. Touching alone does nothing.
fn resolve(contact: Contact, keep_velocity: bool, push: &mut [f64; 2], stops: &mut Stops) {
    if contact.depth <= 0.0 {
        return;
    }
    let (axis, sign, stop) = match contact.side {
        Side::Left => (0, 1.0, &mut stops.left),
        Side::Right => (0, -1.0, &mut stops.right),
        Side::Below => (1, 1.0, &mut stops.below),
        Side::Above => (1, -1.0, &mut stops.above),
    };
    if contact.depth > push[axis].abs() {
        push[axis] = sign * contact.depth;
    }
    *stop |= !keep_velocity;
}

/// The tiles whose closed extent meets `low..=high`, cut to those of the map.
fn range(low: f64, high: f64, size: f64, count: usize) -> std::ops::RangeInclusive<i64> {
    let first = ((low / size).ceil() - 1.0).max(0.0) as i64;
    let last = (high / size).floor().min(count as f64 - 1.0) as i64;
    first..=last
}

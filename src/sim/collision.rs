//! The collision phase: carrying, boxes, contacts, contact bits, pushes.
//!
//! A contact exists between two active colliders of one space that a `collide` rule pairs, if they overlap or touch
//! along an edge. All contacts are detected before anything is pushed.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::ir::{
    Bounce, Bounds, ColliderId, Entity, EntityId, ExprId, Id, IdVec, Program, Push, Shape, Side, SlotId, Solid,
    SpaceId, TagSet, World,
};

use crate::watch::Meter;

use super::actor::{Actor, fixed_box, leaves};
use super::broad_phase::{BroadPhase, Sweep, each, is_few};
use super::contact::{Contact, Displacement, Rect, meet, opposite};
use super::covered_faces::Adjacency;
use super::encounter::Encounter;
use super::fault::Fault;
use super::recall::{Nothing, Recall};
use super::seam::{Images, MAX_IMAGES, Seams, solids};
use super::simulator::{Scratch as StepScratch, Simulator};
use super::slope::Slopes;
use super::state::PositionLayout;
use super::tiles::Grid;

/// Data about a world's colliders, prepared once.
#[derive(Debug)]
pub(super) struct Collision {
    /// Those of instances that may move in the order of their slots, then those of all others.
    pub bodies: Vec<Body>,
    /// The number of the former; only they have boxes in the working memory.
    pub moving: usize,
    /// Their kinds.
    pub kinds: Vec<Kind>,
    pub broad_phase: BroadPhase,
    /// The bounces of all rules, weakest first; the first is none.
    bounces: Vec<Bounce>,
    /// Whether any rule carries.
    carries: bool,
    /// The slots with contact queries, but for those that are only looked at when something touches them.
    pub contact_readers: Vec<usize>,
    /// The slots that can be pushed and carried.
    pub movable: Vec<usize>,
    /// The bodies of instances that may move and can touch a static obstacle.
    meeting: Vec<usize>,
    /// Whether no space wraps and no map has slopes.
    pub is_common: bool,
    /// Cost of moving all instances and their boxes, in units of work.
    moves: u64,
    /// For each space, which static obstacles are adjacent.
    pub adjacency: Vec<Adjacency>,
    /// For each space, the columns and the rows of its map.
    pub grids: Vec<[Grid; 2]>,
    /// For each space, its free-standing rectangles, with those beyond a seam.
    pub solids: Vec<Vec<Solid>>,
    /// For each pair of sets of tags, whether a contact has an effect.
    pub effects: Vec<Vec<bool>>,
    /// What repeats in each space, if any space wraps.
    pub seams: Option<Seams>,
    /// The slopes of all maps, if there are any.
    pub slopes: Option<Box<Slopes>>,
    /// For each space, whether it wraps or its map has slopes, if that holds for any.
    pub rare_maps: Option<Box<[bool]>>,
}

/// A collider of a slot.
#[derive(Debug)]
pub(super) struct Body {
    pub slot: SlotId,
    pub kind: usize,
    /// The index of its set of tags.
    pub set: usize,
    pub kinematic: bool,
    /// The offsets of its instance's position, space and life in a state.
    pub layout: PositionLayout,
    /// Whether it can touch any static obstacle.
    pub meets: bool,
    /// The box, if it is constant: x and y of the lower-left corner, width, height.
    pub fixed: Option<[f64; 4]>,
    /// Whether it is a constant, non-empty rectangle whose presence needs no evaluation.
    pub is_plain: bool,
    /// If its presence depends on one leaf: the offset of the leaf in a state, and the leaves in which it is active.
    pub by_leaf: Option<(usize, Arc<[bool]>)>,
    /// Its shape, and what must hold for it to be there, for a body that is not plain.
    pub shape: Shape,
    pub guard: Option<ExprId>,
}

/// Data shared by the bodies of one collider of one entity.
#[derive(Debug)]
pub(super) struct Kind {
    pub tags: TagSet,
    /// For each set of tags: the rule of a contact, and the contact bits that it sets.
    pub sets: Vec<Option<Encounter>>,
    /// For each space, for each kind of tile.
    pub tiles: Vec<Vec<Option<Encounter>>>,
    /// For each space, for each free-standing rectangle.
    pub solids: Vec<Vec<Option<Encounter>>>,
    /// For each space, whether it can touch any kind of tile.
    pub meets_tiles: Vec<bool>,
    /// For each space, whether it can touch any free-standing rectangle.
    pub meets_solids: Vec<bool>,
}

/// Cost of moving an instance or a box, in units of work.
const MOVED: u64 = 4;

/// Working memory.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    pub boxes: Vec<Rect>,
    pub sweep: Sweep,
    /// For each set of tags, the active bodies; and whether they are still those.
    active: Vec<Vec<u32>>,
    pub is_listed: bool,
    /// For each slot, its displacement by contacts.
    pub displacements: Vec<Displacement>,
    /// The boxes that are seen beyond a seam.
    pub images: Images,
    /// For each contact query that can name a tile, the length of the edge along which it touches the one it keeps, px.
    pub lengths: Vec<f64>,
    /// Amount of work so far.
    pub work: u64,
}

impl Collision {
    /// Prepares a world, some slots of which are never left by their instances.
    pub fn new(program: &Program, world: &World, still: &IdVec<SlotId, bool>) -> Self {
        let bounces: BTreeSet<Bounce> = world.collide.iter().map(|c| c.response.bounce).chain([Bounce::NONE]).collect();
        let bounces: Vec<Bounce> = bounces.into_iter().collect();
        let tile_tags: Vec<Vec<TagSet>> = world
            .spaces
            .iter()
            .map(|s| s.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect()).collect())
            .collect();
        let statics: Vec<Vec<Solid>> = world.spaces.iter().map(solids).collect();
        let mut of_kinds: Vec<(EntityId, ColliderId)> = Vec::new();
        let mut first_kind: BTreeMap<EntityId, usize> = BTreeMap::new();
        // Bodies with the same tags touch in the same way, and there are far fewer sets of tags than kinds.
        let (mut of_sets, mut sets): (Vec<TagSet>, BTreeMap<u64, usize>) = Default::default();
        let mut bodies = Vec::new();
        for (slot, s) in world.slots.pairs() {
            let colliders = &program.entities[s.entity].colliders;
            let first = *first_kind.entry(s.entity).or_insert_with(|| {
                of_kinds.extend(colliders.ids().map(|c| (s.entity, c)));
                of_kinds.len() - colliders.len()
            });
            for (collider, c) in colliders.pairs() {
                let kind = first + collider.index();
                let fixed = fixed_box(program, world, slot, &c.shape);
                let by_leaf = c.guard.and_then(|guard| {
                    let (group, leaves) = leaves(program, &program.entities[s.entity], guard)?;
                    Some((world.layout.slots[slot].leaf_offset(group), leaves.into()))
                });
                let is_plain = (c.guard.is_none() || by_leaf.is_some()) && !c.shape.is_round();
                let is_there = fixed.is_some_and(|[.., width, height]| width > 0.0 && height > 0.0);
                let is_plain = is_plain && is_there;
                let layout = PositionLayout::of(&world.layout.slots[slot]);
                let set = *sets.entry(c.tags.0).or_insert_with(|| {
                    of_sets.push(c.tags);
                    of_sets.len() - 1
                });
                bodies.push(Body {
                    slot,
                    kind,
                    set,
                    kinematic: c.kinematic,
                    layout,
                    meets: false,
                    fixed,
                    is_plain,
                    by_leaf,
                    shape: c.shape,
                    guard: c.guard,
                });
            }
        }
        let tags_of = |(entity, collider): (EntityId, ColliderId)| program.entities[entity].colliders[collider].tags;
        let kinds: Vec<Kind> = of_kinds
            .iter()
            .map(|&(entity, collider)| {
                let tags = tags_of((entity, collider));
                let with = |other: TagSet| Encounter::new(world, &bounces, &program.entities[entity], tags, other);
                let tiles: Vec<Vec<_>> = tile_tags.iter().map(|k| k.iter().map(|&t| with(t)).collect()).collect();
                let solids: Vec<Vec<_>> =
                    statics.iter().map(|solids| solids.iter().map(|x| with(x.tags)).collect()).collect();
                let any = |lists: &[Vec<Option<Encounter>>]| {
                    lists.iter().map(|l| l.iter().any(Option::is_some)).collect::<Vec<bool>>()
                };
                let (meets_tiles, meets_solids) = (any(&tiles), any(&solids));
                let sets = of_sets.iter().map(|&set| with(set)).collect();
                Kind { tags, sets, tiles, solids, meets_tiles, meets_solids }
            })
            .collect();
        // The sort is stable.
        bodies.sort_by_key(|body: &Body| still[body.slot]);
        let moving = bodies.partition_point(|body| !still[body.slot]);
        for body in &mut bodies {
            let Kind { meets_tiles, meets_solids, .. } = &kinds[body.kind];
            body.meets = meets_tiles.iter().chain(meets_solids).any(|&meets| meets);
        }
        // Contacts without an effect need not be found.
        let count = of_sets.len();
        let mut effects = vec![vec![false; count]; count];
        for kind in &kinds {
            let Some(&mine) = sets.get(&kind.tags.0) else { continue };
            let does = |with: &Option<Encounter>| with.as_ref().is_some_and(|with| !with.is_idle());
            for theirs in (0..count).filter(|&set| does(&kind.sets[set])) {
                effects[mine][theirs] = true;
                effects[theirs][mine] = true;
            }
        }
        let ids: Vec<(usize, SlotId)> = bodies[..moving].iter().map(|b: &Body| (b.set, b.slot)).collect();
        let broad_phase = BroadPhase::new(&ids, count, |a, b| effects[a][b]);
        let carries = world.collide.iter().any(|c| c.response.carry);
        let of = |slot: SlotId| &program.entities[world.slots[slot].entity];
        let slots_with = |has: &dyn Fn(&Entity) -> bool| {
            world.slots.ids().filter(|&s| has(of(s))).map(Id::index).collect::<Vec<usize>>()
        };
        let contact_readers = slots_with(&|e| !e.touches.is_empty());
        let mut movable = slots_with(&|e| e.colliders.iter().any(|c| !c.kinematic));
        movable.retain(|slot| !still[SlotId::from_index(*slot)]);
        let moves = MOVED * (still.iter().filter(|is| !**is).count() + moving) as u64;
        let adjacency =
            world.spaces.iter().zip(&statics).map(|(space, solids)| Adjacency::new(space, solids)).collect();
        let (grids, seams, slopes) = (Grid::of(world), Seams::of(world), Slopes::of(world));
        let has_slopes = |space: SpaceId| slopes.as_ref().is_some_and(|s| !s.of_space(space.index()).is_empty());
        let rare_maps = world.spaces.pairs().map(|(id, space)| space.wraps() || has_slopes(id));
        let rare_maps = Some(rare_maps.collect::<Box<[bool]>>()).filter(|rare| rare.contains(&true));
        Collision {
            meeting: (0..moving).filter(|body| bodies[*body].meets).collect(),
            is_common: seams.is_none() && slopes.is_none(),
            bodies,
            moving,
            moves,
            kinds,
            broad_phase,
            bounces,
            carries,
            contact_readers,
            movable,
            adjacency,
            grids,
            solids: statics,
            effects,
            seams,
            slopes,
            rare_maps,
        }
    }

    /// Working memory for this world.
    pub fn scratch(&self, world: &World, kept: usize) -> Scratch {
        Scratch {
            boxes: vec![Rect::default(); self.moving],
            sweep: Sweep::with_capacity(if matches!(self.broad_phase, BroadPhase::Kinds(_)) {
                self.moving * if self.seams.is_some() { 1 + MAX_IMAGES } else { 1 }
            } else {
                0
            }),
            active: self.broad_phase.buffers(),
            is_listed: false,
            displacements: vec![Displacement::NONE; world.slots.len()],
            images: self.seams.as_ref().map_or_else(Images::default, |_| Images::for_boxes(self.moving)),
            lengths: vec![0.0; kept],
            work: 0,
        }
    }
}

impl Simulator {
    /// As [`Simulator::collide`], where a call matters little: a copy less to compile.
    #[inline(never)]
    pub(super) fn collide_apart(
        &self,
        state: &mut [u8],
        scratch: &mut StepScratch,
        push: bool,
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        self.collide(state, scratch, (push, &mut Nothing), meter)
    }

    /// Detects all contacts and, with `push`, resolves the blocking ones, but for those that are known; returns early if
    /// the meter stops it.
    #[inline(always)]
    pub(super) fn collide<R: Recall>(
        &self,
        state: &mut [u8],
        scratch: &mut StepScratch,
        (push, recall): (bool, &mut R),
        meter: &Meter<'_>,
    ) -> Result<(), Fault> {
        if push && self.collision.carries {
            self.carry(state, &scratch.start);
        }
        let is_rare = !self.collision.is_common;
        if is_rare && let Some(seams) = &self.collision.seams {
            self.bring_in(seams, state, &mut scratch.start);
        }
        if R::IS_ANY {
            for &slot in recall.moving() {
                self.place_boxes(state, scratch, recall.bodies(slot as usize))?;
            }
        } else {
            self.place_boxes(state, scratch, 0..self.collision.moving)?;
        }
        let Scratch { boxes, sweep, active, is_listed, displacements, work, .. } = &mut scratch.collision;
        *work = work.wrapping_add(self.collision.moves);
        let mut clear = |slot: usize| {
            let Actor { layout, touches, bound, .. } = &self.actors[slot];
            layout.clear_touches(state, *touches, *bound);
        };
        if R::IS_ANY {
            for nth in 0..recall.unsettled() {
                clear(recall.unsettled_slot(nth));
                displacements[recall.unsettled_slot(nth)] = Displacement::NONE;
            }
        } else {
            self.collision.contact_readers.iter().for_each(|slot| clear(*slot));
            for &slot in &self.collision.movable {
                displacements[slot] = Displacement::NONE;
            }
        }
        let bodies = &self.collision.bodies[..self.collision.moving];
        // Whoever another one is near is looked at.
        let mut look_at = |state: &mut [u8], displacements: &mut [Displacement], pair: [usize; 2]| {
            for slot in pair.map(|body| bodies[body].slot.index()) {
                if recall.meet(slot, state) {
                    displacements[slot] = Displacement::NONE;
                }
            }
        };
        match &self.collision.broad_phase {
            BroadPhase::Listed(pairs) => {
                *work = work.wrapping_add(pairs.len() as u64);
                for &(i, j) in pairs {
                    let (i, j) = (i as usize, j as usize);
                    if boxes[i].active && boxes[j].active && boxes[i].is_near(&boxes[j]) {
                        look_at(state, displacements, [i, j]);
                        self.pair(state, (i, j), [&boxes[i], &boxes[j]], displacements);
                    }
                }
            }
            BroadPhase::Kinds(pairs) => {
                if !std::mem::replace(is_listed, true) {
                    active.iter_mut().for_each(Vec::clear);
                    for (at, body) in bodies.iter().enumerate() {
                        if boxes[at].active {
                            active[body.set].push(at as u32);
                        }
                    }
                }
                let mut visit = |i: usize, j: usize| {
                    if bodies[i].slot != bodies[j].slot {
                        look_at(state, displacements, [i, j]);
                        self.pair(state, (i, j), [&boxes[i], &boxes[j]], displacements);
                    }
                };
                let compared = match is_few(pairs, active) {
                    Some(few) => {
                        each(pairs, active, boxes, &mut visit);
                        few
                    }
                    None => {
                        let meets = |body: usize| pairs.meets[bodies[body].set];
                        sweep.pairs(boxes, meets, meter, visit)
                    }
                };
                *work = work.wrapping_add(compared as u64);
            }
        }
        if is_rare && let Some(seams) = &self.collision.seams {
            self.collide_across(seams, state, &mut scratch.collision, meter);
        }
        if let Some(still) = &self.still {
            self.collide_still(still, state, scratch, meter);
        }
        if meter.is_stopped() {
            return Ok(());
        }
        let Scratch { boxes, displacements, lengths, .. } = &mut scratch.collision;
        let lengths = Cell::from_mut(lengths.as_mut_slice()).as_slice_of_cells();
        let mut collide_body = |state: &mut [u8], at: usize| {
            let (body, rect) = (&bodies[at], &boxes[at]);
            if !rect.active {
                return false;
            }
            let kind = &self.collision.kinds[body.kind];
            let at = body.slot.index();
            let mut looked_at = 0;
            if kind.meets_solids[rect.space as usize] {
                looked_at += self.collide_solids(state, body, rect, &mut displacements[at], meter);
            }
            if kind.meets_tiles[rect.space as usize] {
                looked_at += self.collide_tiles(state, body, rect, (&mut displacements[at], lengths), meter);
            }
            meter.spend(looked_at as u64)
        };
        if R::IS_ANY {
            for nth in 0..recall.unsettled() {
                let slot = recall.unsettled_slot(nth);
                let before = meter.total();
                for at in recall.bodies(slot).filter(|at| bodies[*at].meets) {
                    if collide_body(state, at) {
                        return Ok(());
                    }
                }
                recall.add_work(slot, meter.total() - before);
            }
        } else {
            for &at in &self.collision.meeting {
                if collide_body(state, at) {
                    return Ok(());
                }
            }
        }
        if is_rare && let Some(slopes) = &self.collision.slopes {
            self.collide_slopes(slopes, state, &mut scratch.collision, push, meter);
        }
        if push {
            let displacements = &mut scratch.collision.displacements;
            let mut push_out = |slot: usize| {
                let [x, y] = displacements[slot].push;
                if x != 0.0 || y != 0.0 {
                    displacements[slot].push_out(state, &self.actors[slot].layout, &self.collision.bounces);
                }
            };
            if R::IS_ANY {
                (0..recall.unsettled()).for_each(|nth| push_out(recall.unsettled_slot(nth)));
            } else {
                self.collision.movable.iter().for_each(|slot| push_out(*slot));
            }
            if is_rare && let Some(seams) = &self.collision.seams {
                self.bring_in(seams, state, &mut scratch.start);
            }
        }
        Ok(())
    }

    /// Handles two bodies of one space.
    pub(super) fn pair(
        &self,
        state: &mut [u8],
        (i, j): (usize, usize),
        [first, second]: [&Rect; 2],
        displacements: &mut [Displacement],
    ) {
        let (a, b) = (&self.collision.bodies[i], &self.collision.bodies[j]);
        let kinds = &self.collision.kinds;
        let (Some(of_a), Some(of_b)) = (&kinds[a.kind].sets[b.set], &kinds[b.kind].sets[a.set]) else { return };
        let meeting = of_a.meeting;
        let back = (first.back.0 - second.back.0, first.back.1 - second.back.1);
        let Some(contact) = meet(first, second, back, meeting, |_| (false, false)) else { return };
        let side = contact.side;
        self.touch(state, a, of_a, Some(b.slot), side);
        self.touch(state, b, of_b, Some(a.slot), opposite(side));
        if meeting.response.carry {
            let board = |state: &mut [u8], rider: &Body, on: &Body| {
                let layout = self.layout(rider.slot);
                if !rider.kinematic && layout.moving_carrier(state).is_none_or(|c| on.slot < c) {
                    layout.set_moving_carrier(state, Some(on.slot));
                }
            };
            match side {
                Side::Below if meeting.first_on_second => board(state, a, b),
                Side::Above if meeting.second_on_first => board(state, b, a),
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
                displacements[body.slot.index()].add(contact, of_a.stop);
            }
        }
    }

    /// Sets the contact bits of one body for a contact.
    #[inline]
    fn touch(&self, state: &mut [u8], body: &Body, with: &Encounter, instance: Option<SlotId>, side: Side) {
        let actor = &self.actors[body.slot.index()];
        actor.layout.set_touches(state, with.bits[side as usize]);
        if with.more {
            self.touch_more(state, actor, self.collision.kinds[body.kind].tags, with.tags, instance, side);
        }
    }

    /// Sets bound contact bits, and those beyond the first 64.
    #[cold]
    fn touch_more(
        &self,
        state: &mut [u8],
        actor: &Actor,
        mine: TagSet,
        other: TagSet,
        instance: Option<SlotId>,
        side: Side,
    ) {
        let layout = &actor.layout;
        for (id, touch) in actor.entity.touches.pairs() {
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

    /// Handles a contact with a static obstacle: only the body is pushed.
    #[inline]
    pub(super) fn static_contact(
        &self,
        state: &mut [u8],
        body: &Body,
        with: &Encounter,
        contact: Contact,
        displacement: &mut Displacement,
    ) {
        self.touch(state, body, with, None, contact.side);
        if with.meeting.response.push != Push::Sense && !body.kinematic {
            displacement.add(contact, with.stop);
        }
    }

    /// Handles the rectangles of a body's space; returns their number.
    #[inline(always)]
    pub(super) fn collide_solids(
        &self,
        state: &mut [u8],
        body: &Body,
        rect: &Rect,
        displacement: &mut Displacement,
        meter: &Meter<'_>,
    ) -> usize {
        let space = rect.space as usize;
        let solids = &self.collision.solids[space];
        let kind = &self.collision.kinds[body.kind];
        for (index, with) in kind.solids[space].iter().enumerate() {
            let Some(with) = with else { continue };
            let Bounds { left, right, bottom, top } = solids[index].bounds;
            let other = Rect { left, right, bottom, top, active: true, ..Rect::default() };
            let mut corner = None;
            let contact = meet(rect, &other, rect.back, with.meeting, |overlap| {
                if !self.can_be_covered((kind, space), index) {
                    return (false, false);
                }
                let covered = self.covered(state, (kind, space), (rect, &other), overlap, (false, false), meter);
                if covered == (true, true) && overlap.came_diagonally(rect.back) {
                    corner = Some([overlap.horizontal(), overlap.vertical()]);
                }
                covered
            });
            let Some(contact) = contact else { continue };
            self.static_contact(state, body, with, contact, displacement);
            self.corner_contact(body, with, corner, displacement);
        }
        solids.len()
    }
}

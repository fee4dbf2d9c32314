//! What an instance can meet: which contacts can be, and what they can do to its position and speed.
//!
//! A push puts an edge of a collider onto an edge of what blocks it. So what is pushed by what never moves ends where
//! edges meet, and a contact with a blocking surface tells where the body is.

use crate::ir::{Id, IdVec, Meeting, Program, Push, Shape, Side, SlotId, SpaceId, TagSet, TouchId, VarId, World};

use super::evaluate::{Configuration, Overall};
use super::values::{Interval, Values};

/// Edges that meet are this near, px: positions are rounded.
const ROUNDING: f64 = 1e-6;

/// What is known of the contacts of every slot.
#[derive(Debug, Default, Clone)]
pub(super) struct Surroundings {
    slots: IdVec<SlotId, Contacts>,
}

/// What is known of the contacts of one slot.
#[derive(Debug, Default, Clone)]
struct Contacts {
    /// Of each contact question, whether it can hold.
    touchable: Vec<bool>,
    /// Of each contact question, where the instance is when it holds.
    aligned: Vec<Option<(VarId, Values)>>,
    /// Of both axes, where a push can put the instance; none if nothing pushes it.
    edges: [Option<Values>; 2],
    /// Of both axes, how fast what pushes it can move, px/s.
    pushers: [f64; 2],
    /// Whether a push can be longer than a step: something may begin inside of something.
    may_penetrate: bool,
    /// Whether a push stops the velocity into the surface.
    stops: bool,
    /// Whether pushes can leave the velocity, or end anywhere: by what can move, too.
    is_loose: bool,
    /// Of both axes, where a carrier can take the instance.
    carried: [Option<Values>; 2],
}

/// A box relative to a position, px: of both axes, the least low end and the greatest high end.
type Extent = [Interval; 2];

impl Surroundings {
    /// From what the slots can be.
    pub fn new(program: &Program, world: &World, slots: &IdVec<SlotId, Overall>) -> Self {
        let scene = Scene { program, world, slots };
        Surroundings { slots: world.slots.ids().map(|slot| scene.contacts(slot)).collect() }
    }

    /// Whether a contact question can hold.
    pub fn can_touch(&self, slot: SlotId, touch: TouchId) -> bool {
        self.slots[slot].touchable.get(touch.index()).copied().unwrap_or(true)
    }

    /// Where an instance is while a contact question holds: a coordinate, and its values.
    pub fn aligned(&self, slot: SlotId, touch: TouchId) -> Option<&(VarId, Values)> {
        self.slots[slot].aligned.get(touch.index())?.as_ref()
    }

    /// What a collision can do: `before` as the movement began, `moved` after it.
    pub fn collide(&self, slot: SlotId, step: f64, before: &Configuration, moved: &mut Configuration) {
        let contacts = &self.slots[slot];
        for axis in 0..2 {
            let var = VarId(axis as u32);
            if let Some(places) = &contacts.carried[axis] {
                moved.vars[var][0] = moved.vars[var][0].or(places);
                moved.energy[var] = None;
            }
            let Some(edges) = &contacts.edges[axis] else { continue };
            let way = before.vars[var][0].hull().zip(moved.vars[var][0].hull()).map(|(a, b)| a.or(b));
            let Some(way) = way else { continue };
            let far = contacts.pushers[axis] * step + ROUNDING;
            let pushed = match contacts.may_penetrate {
                true => edges.clone(),
                false => edges.within(Interval { low: way.low - far, high: way.high + far }),
            };
            if pushed.is_none() {
                continue;
            }
            let [position, velocity, _] = &mut moved.vars[var];
            *position = position.or(&pushed);
            if contacts.stops {
                *velocity = velocity.or(&Values::point(0.0));
            }
            moved.energy[var] = match (moved.energy[var], pushed.hull()) {
                (Some((fall, energy)), Some(at)) if !contacts.is_loose && contacts.stops => {
                    // What is pushed without being stopped moves away from the surface, slower than that does.
                    let slow = contacts.pushers[axis];
                    Some((fall, energy.or(fall.energy(at, Interval { low: -slow, high: slow }))))
                }
                _ => None,
            };
        }
    }
}

/// The world that contacts are looked for in.
struct Scene<'a> {
    program: &'a Program,
    world: &'a World,
    slots: &'a IdVec<SlotId, Overall>,
}

/// A collider: its tags, whether it is never pushed, its box, whether that is always the same and there.
struct Body {
    tags: TagSet,
    kinematic: bool,
    extent: Option<Extent>,
    is_steady: bool,
}

impl Scene<'_> {
    fn bodies(&self, slot: SlotId) -> Vec<Body> {
        let s = &self.world.slots[slot];
        let entity = &self.program.entities[s.entity];
        let fixed = self.slots[slot].params.iter().all(|p| p.constant().is_some());
        let number = |id| fixed.then(|| self.program.constant(id, &s.params, self.world.step)).flatten();
        let body = |c: &crate::ir::Collider| {
            let sides = match c.shape {
                Shape::Rect([x, y, width, height]) => {
                    (|| Some([number(x)?, number(y)?, number(width)?, number(height)?]))()
                }
                Shape::Circle([x, y, r]) => (|| {
                    let (x, y, r) = (number(x)?, number(y)?, number(r)?);
                    Some([x - r, y - r, 2.0 * r, 2.0 * r])
                })(),
            };
            let extent = sides.map(|[x, y, width, height]| {
                [Interval { low: x, high: x + width }, Interval { low: y, high: y + height }]
            });
            Body { tags: c.tags, kinematic: c.kinematic, extent, is_steady: extent.is_some() && c.guard.is_none() }
        };
        entity.colliders.iter().map(body).collect()
    }

    fn meeting(&self, a: TagSet, b: TagSet) -> Option<Meeting> {
        self.world.meeting(a, b)
    }

    /// The tags of what never moves in the spaces that a slot can be in.
    fn statics(&self, spaces: impl Iterator<Item = SpaceId>) -> Vec<TagSet> {
        let mut out = Vec::new();
        for space in spaces.map(|s| &self.world.spaces[s]) {
            out.extend(space.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect::<TagSet>()));
            out.extend(space.solids.iter().map(|s| s.tags));
        }
        out
    }

    fn contacts(&self, slot: SlotId) -> Contacts {
        let entity = &self.program.entities[self.world.slots[slot].entity];
        let overall = &self.slots[slot];
        let mine = self.bodies(slot);
        let statics = self.statics(overall.spaces.iter().copied());
        let others: Vec<(SlotId, Body)> = self
            .world
            .slots
            .ids()
            .filter(|s| *s != slot && self.slots[*s].can_live)
            .flat_map(|s| self.bodies(s).into_iter().map(move |b| (s, b)))
            .collect();
        let touchable = entity.touches.iter().map(|touch| {
            let own = mine.iter().filter(|b| b.tags.meets(touch.mine));
            let tag = TagSet::of(touch.other);
            own.into_iter().any(|b| {
                let meets = |tags: &TagSet| tags.meets(tag) && self.meeting(b.tags, *tags).is_some();
                statics.iter().any(meets) || others.iter().any(|(_, o)| meets(&o.tags))
            })
        });
        let mut out = Contacts { touchable: touchable.collect(), ..Contacts::default() };
        let movable: Vec<&Body> = mine.iter().filter(|b| !b.kinematic).collect();
        let pushes = |a: TagSet, b: TagSet| self.meeting(a, b).filter(|m| m.response.push != Push::Sense);
        let mut edges: [Vec<Interval>; 2] = [Vec::new(), Vec::new()];
        let mut carried: [Vec<Interval>; 2] = [Vec::new(), Vec::new()];
        let mut is_pushed = false;
        let steady = mine.iter().all(|b| b.is_steady);
        let mut anywhere = false;
        for body in &movable {
            let meetings = statics.iter().filter_map(|tags| pushes(body.tags, *tags));
            for meeting in meetings {
                is_pushed = true;
                out.stops |= meeting.response.stop;
                out.is_loose |= !meeting.response.stop;
            }
            match body.extent {
                Some(extent) => self.static_edges(overall, body.tags, extent, &mut edges),
                None => anywhere |= is_pushed,
            }
            for (other, o) in &others {
                let Some(meeting) = pushes(body.tags, o.tags) else { continue };
                is_pushed = true;
                out.stops |= meeting.response.stop;
                out.is_loose |= !meeting.response.stop || !o.kinematic;
                // What a body pushes it may push into a wall.
                out.may_penetrate = true;
                let (Some(extent), Some(theirs)) = (body.extent, o.extent) else {
                    anywhere = true;
                    continue;
                };
                for axis in 0..2 {
                    let var = VarId(axis as u32);
                    let [position, velocity, _] = &self.slots[*other].vars[var];
                    let speed = velocity.hull().map_or(0.0, |v| v.low.abs().max(v.high.abs()));
                    out.pushers[axis] = out.pushers[axis].max(speed);
                    let Some(at) = position.hull() else { continue };
                    let reach = Interval {
                        low: at.low + theirs[axis].low - extent[axis].high - ROUNDING,
                        high: at.high + theirs[axis].high - extent[axis].low + ROUNDING,
                    };
                    if o.kinematic {
                        // Its low and high edges, wherever it is.
                        let before = theirs[axis].low - extent[axis].high;
                        let after = theirs[axis].high - extent[axis].low;
                        for offset in [before, after] {
                            edges[axis].extend(position.intervals().iter().map(|i| Interval {
                                low: i.low + offset - ROUNDING,
                                high: i.high + offset + ROUNDING,
                            }));
                        }
                    } else {
                        edges[axis].push(reach);
                    }
                    if meeting.response.carry {
                        carried[axis].push(reach);
                    }
                }
            }
        }
        if is_pushed {
            out.may_penetrate |= !steady || self.may_jump(slot);
            out.edges = match anywhere {
                true => [Some(Values::all()), Some(Values::all())],
                false => edges.map(|e| Some(Values::any(e))),
            };
            out.carried = carried.map(|c| if c.is_empty() { None } else { Some(Values::any(c)) });
            if anywhere {
                out.carried = out.carried.map(|c| c.map(|_| Values::all()));
            }
            out.aligned = self.alignments(slot, &mine, &statics, &others, &out);
        }
        out
    }

    /// Where the edges of a box meet those of what never moves and blocks it.
    fn static_edges(&self, overall: &Overall, tags: TagSet, extent: Extent, edges: &mut [Vec<Interval>; 2]) {
        let blocks = |other: TagSet| self.meeting(tags, other).is_some_and(|m| m.response.push != Push::Sense);
        let mut add = |axis: usize, low: f64, high: f64| {
            for at in [low - extent[axis].high, high - extent[axis].low] {
                edges[axis].push(Interval { low: at - ROUNDING, high: at + ROUNDING });
            }
        };
        for space in overall.spaces.iter().map(|s| &self.world.spaces[*s]) {
            for solid in space.solids.iter().filter(|s| blocks(s.tags)) {
                add(0, solid.bounds.left, solid.bounds.right);
                add(1, solid.bounds.bottom, solid.bounds.top);
            }
            let Some(map) = &space.map else { continue };
            let kinds: Vec<bool> = map.kinds.iter().map(|k| blocks(k.tags.iter().copied().collect())).collect();
            let (mut columns, mut rows) = (vec![false; map.columns], vec![false; map.rows]);
            for (at, kind) in map.cells.iter().enumerate().filter(|(_, kind)| kinds[usize::from(**kind)]) {
                let _ = kind;
                columns[at % map.columns] = true;
                rows[at / map.columns] = true;
            }
            let (width, height) = map.tile;
            for column in columns.iter().enumerate().filter(|(_, b)| **b).map(|(i, _)| i as f64) {
                add(0, column * width, column * width + width);
            }
            for row in rows.iter().enumerate().filter(|(_, b)| **b).map(|(i, _)| i as f64) {
                add(1, row * height, row * height + height);
            }
        }
    }

    /// Whether something can put an instance inside of what blocks it: it is spawned, goes through links, is put
    /// somewhere by an update, a flow or a clamp, or begins there.
    fn may_jump(&self, slot: SlotId) -> bool {
        use crate::ir::{Drive, Origin, Place};
        let s = &self.world.slots[slot];
        let entity = &self.program.entities[s.entity];
        let is_position = |var: VarId| var.index() < 2;
        let updates = |a: &crate::ir::Actions| {
            a.updates.iter().any(|u| matches!(u.place, Place::Var(var, 0) if is_position(var)))
        };
        let actions = entity.edges.iter().map(|e| &e.actions).chain(entity.modes.iter().map(|m| &m.entry));
        let drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|l| &l.drives));
        s.origin != Origin::Named
            || !entity.follows.is_empty()
            || actions.into_iter().any(updates)
            || entity.clamps.iter().any(|c| c.degree == 0 && is_position(c.var))
            || drives.into_iter().any(|d| matches!(d, Drive::Flow { var, degree: 0, .. } if is_position(*var)))
            || entity.envelopes.iter().any(|e| e.degree == 0 && e.vars.iter().any(|v| is_position(*v)))
            || self.begins_inside(slot)
    }

    /// Whether a slot's instance is placed inside of what blocks it, or too fast for the thinnest of it.
    fn begins_inside(&self, slot: SlotId) -> bool {
        let s = &self.world.slots[slot];
        let at = |axis: u32| s.vars[VarId(axis)][0];
        let space = &self.world.spaces[s.space];
        self.bodies(slot).iter().filter(|b| !b.kinematic).any(|body| {
            let Some(extent) = body.extent else { return true };
            let side = |axis: usize| Interval {
                low: extent[axis].low + at(axis as u32),
                high: extent[axis].high + at(axis as u32),
            };
            let (x, y) = (side(0), side(1));
            let blocks = |tags: TagSet| self.meeting(body.tags, tags).is_some_and(|m| m.response.push != Push::Sense);
            let inside = |left: f64, right: f64, bottom: f64, top: f64| {
                x.low < right - ROUNDING
                    && left + ROUNDING < x.high
                    && y.low < top - ROUNDING
                    && bottom + ROUNDING < y.high
            };
            let solids = space.solids.iter().filter(|s| blocks(s.tags)).map(|s| s.bounds);
            let mut found = solids.into_iter().any(|b| inside(b.left, b.right, b.bottom, b.top));
            if let Some(map) = &space.map {
                let kinds: Vec<bool> = map.kinds.iter().map(|k| blocks(k.tags.iter().copied().collect())).collect();
                let (width, height) = map.tile;
                found |= map.cells.iter().enumerate().any(|(at, kind)| {
                    let (column, row) = ((at % map.columns) as f64, (at / map.columns) as f64);
                    kinds[usize::from(*kind)]
                        && inside(column * width, (column + 1.0) * width, row * height, (row + 1.0) * height)
                });
            }
            found
        })
    }

    /// Of each contact question, where the instance is when it holds: on an edge, if all that it asks for blocks.
    fn alignments(
        &self,
        slot: SlotId,
        mine: &[Body],
        statics: &[TagSet],
        others: &[(SlotId, Body)],
        contacts: &Contacts,
    ) -> Vec<Option<(VarId, Values)>> {
        let entity = &self.program.entities[self.world.slots[slot].entity];
        let movers = others.iter().any(|(_, o)| {
            !o.kinematic
                && mine.iter().any(|b| {
                    !b.kinematic && self.meeting(b.tags, o.tags).is_some_and(|m| m.response.push != Push::Sense)
                })
        });
        let aligned = |touch: &crate::ir::Touch| {
            let axis = match touch.side? {
                Side::Left | Side::Right => 0,
                Side::Above | Side::Below => 1,
            };
            let tag = TagSet::of(touch.other);
            let asked = statics.iter().copied().chain(others.iter().map(|(_, o)| o.tags)).filter(|t| t.meets(tag));
            let own: Vec<&Body> = mine.iter().filter(|b| b.tags.meets(touch.mine)).collect();
            let blocks = asked.into_iter().all(|tags| {
                own.iter().all(|b| match self.meeting(b.tags, tags) {
                    Some(m) => m.response.push == Push::Block && !b.kinematic,
                    None => true,
                })
            });
            if !blocks || movers {
                return None;
            }
            Some((VarId(axis as u32), contacts.edges[axis].clone()?))
        };
        entity.touches.iter().map(aligned).collect()
    }
}

//! What an instance can meet: which contacts can be, and what they can do to its position and speed.
//!
//! A push puts an edge of a collider onto an edge of what blocks it. So what is pushed by what never moves ends where
//! edges meet, and a contact with a blocking surface tells where the body is.

use std::collections::BTreeSet;

use crate::ir::{Id, IdVec, Push, SlotId, SpaceId, TagSet, Touch, TouchId, VarId};

use super::evaluate::{Configuration, Overall};
use super::scene::{Body, Edges, Pair, ROUNDING, Scene, disjoin, face, sides};
use super::values::{Interval, Values};

/// What is known of the contacts of every slot.
#[derive(Debug, Default, Clone)]
pub(super) struct Surroundings {
    contacts: Vec<Contacts>,
    of: IdVec<SlotId, usize>,
}

/// What is known of the contacts of one slot.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Contacts {
    /// Of each contact question, whether it can hold.
    touchable: Vec<bool>,
    /// Of each contact question, where the instance is when it holds.
    aligned: Vec<Option<(VarId, Values)>>,
    /// Where a push can put the instance.
    edges: Edges,
    is_pushed: bool,
    /// Whether pushes can end anywhere.
    anywhere: bool,
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

/// What is known of all instances of a kind.
struct Crowd {
    /// How many there can be.
    count: usize,
    spaces: BTreeSet<SpaceId>,
    position: [Values; 2],
    /// px/s
    speed: [f64; 2],
}

impl Surroundings {
    /// From what the slots can be. The scene must be prepared for their kinds in their spaces.
    pub fn new(scene: &Scene<'_>, slots: &IdVec<SlotId, Overall>) -> Self {
        let crowds: Vec<Crowd> = scene.kinds.iter().map(|kind| Crowd::new(&kind.slots, slots)).collect();
        let mut out = Surroundings::default();
        let mut known: Vec<(usize, &BTreeSet<SpaceId>)> = Vec::new();
        for (slot, overall) in slots.pairs() {
            let key = (scene.of[slot], &overall.spaces);
            let number = known.iter().position(|k| *k == key).unwrap_or_else(|| {
                known.push(key);
                out.contacts.push(contacts(scene, key.0, key.1, &crowds));
                known.len() - 1
            });
            out.of.push(number);
        }
        out
    }

    /// Whether a contact question can hold.
    pub fn can_touch(&self, slot: SlotId, touch: TouchId) -> bool {
        self.of(slot).touchable.get(touch.index()).copied().unwrap_or(true)
    }

    /// Where an instance is while a contact question holds: a coordinate, and its values.
    pub fn aligned(&self, slot: SlotId, touch: TouchId) -> Option<&(VarId, Values)> {
        self.of(slot).aligned.get(touch.index())?.as_ref()
    }

    /// What is known of the contacts of a slot.
    pub fn of(&self, slot: SlotId) -> &Contacts {
        &self.contacts[self.of[slot]]
    }

    /// What a collision can do: `before` as the movement began, `moved` after it.
    pub fn collide(&self, slot: SlotId, step: f64, before: &Configuration, moved: &mut Configuration) {
        let contacts = self.of(slot);
        for axis in 0..2 {
            let var = VarId(axis as u32);
            if let Some(places) = &contacts.carried[axis] {
                moved.vars[var][0] = moved.vars[var][0].or(places);
                moved.energy[var] = None;
            }
            if !contacts.is_pushed {
                continue;
            }
            let way = before.vars[var][0].hull().zip(moved.vars[var][0].hull()).map(|(a, b)| a.or(b));
            let Some(way) = way else { continue };
            let far = contacts.pushers[axis] * step + ROUNDING;
            let within = match contacts.may_penetrate {
                true => Interval::ALL,
                false => Interval { low: way.low - far, high: way.high + far },
            };
            let pushed = match contacts.anywhere {
                true => Values::all(),
                false => Values::any(contacts.edges[axis].iter().flat_map(|edges| between(edges, within))),
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

/// Those of some edges in order that meet an interval.
fn between(edges: &[Interval], within: Interval) -> impl Iterator<Item = Interval> + '_ {
    let first = edges.partition_point(|e| e.high < within.low);
    edges[first..].iter().copied().take_while(move |e| e.low <= within.high)
}

impl Crowd {
    fn new(of: &[SlotId], slots: &IdVec<SlotId, Overall>) -> Crowd {
        let live = || of.iter().map(|s| &slots[*s]).filter(|o| o.can_live);
        let all = |axis: u32, degree: usize| {
            Values::any(live().filter_map(|o| o.vars.get(VarId(axis))).flat_map(|v| v[degree].intervals().to_vec()))
        };
        let speed = |axis| all(axis, 1).hull().map_or(0.0, |v| v.low.abs().max(v.high.abs()));
        Crowd {
            count: live().count(),
            spaces: live().flat_map(|o| o.spaces.iter().copied()).collect(),
            position: [all(0, 0), all(1, 0)],
            speed: [speed(0), speed(1)],
        }
    }
}

fn contacts(scene: &Scene<'_>, me: usize, spaces: &BTreeSet<SpaceId>, crowds: &[Crowd]) -> Contacts {
    let kind = &scene.kinds[me];
    let entity = &scene.program.entities[kind.entity];
    // What is known of the spaces it can be in; there are none before it is there.
    let statics: Vec<_> = spaces.iter().filter_map(|s| scene.statics(me, *s)).collect();
    let there = |pair: &&Pair| {
        let crowd = &crowds[pair.kind];
        crowd.count > usize::from(pair.kind == me) && crowd.spaces.iter().any(|s| spaces.contains(s))
    };
    let pairs: Vec<&Pair> = scene.pairs[me].iter().filter(there).collect();
    let body = |pair: &Pair| (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
    let asks = |touch: &Touch, pair: &Pair| {
        let (mine, theirs) = body(pair);
        mine.tags.meets(touch.mine) && theirs.tags.meets(TagSet::of(touch.other))
    };
    let mut out = Contacts {
        touchable: entity
            .touches
            .pairs()
            .map(|(id, touch)| {
                statics.iter().any(|s| s.touchable.get(id.index()) == Some(&true))
                    || pairs.iter().any(|p| asks(touch, p))
            })
            .collect(),
        ..Contacts::default()
    };
    for found in &statics {
        out.is_pushed |= found.pushes;
        out.stops |= found.stops;
        out.is_loose |= found.slips;
        out.anywhere |= found.anywhere;
        for (edges, more) in out.edges.iter_mut().flatten().zip(found.edges.iter().flatten()) {
            edges.extend(more);
        }
    }
    let mut carried: [Vec<Interval>; 2] = [Vec::new(), Vec::new()];
    let mut is_moved_by_movers = false;
    for pair in pairs.iter().filter(|p| p.meeting.response.push != Push::Sense) {
        let (mine, theirs) = body(pair);
        if mine.kinematic {
            continue;
        }
        out.is_pushed = true;
        out.stops |= pair.meeting.response.stop;
        out.is_loose |= !pair.meeting.response.stop || !theirs.kinematic;
        is_moved_by_movers |= !theirs.kinematic;
        // What a body pushes it may push into a wall.
        out.may_penetrate = true;
        pushed_by(&mut out, &mut carried, pair, mine, theirs, &crowds[pair.kind]);
    }
    if !out.is_pushed {
        return out;
    }
    out.edges.iter_mut().flatten().for_each(disjoin);
    out.may_penetrate |= kind.jumps || !kind.bodies.iter().all(|b| b.is_steady);
    out.carried = carried.map(|c| if c.is_empty() { None } else { Some(Values::any(c)) });
    if out.anywhere {
        out.carried = out.carried.map(|c| c.map(|_| Values::all()));
    }
    let aligned = |(id, touch): (TouchId, &Touch)| {
        let (axis, end) = face(touch.side?);
        let pushes = |p: &&Pair| p.meeting.response.push != Push::Sense && !body(p).0.kinematic;
        let by_all = statics.iter().all(|s| s.pushed.get(id.index()) == Some(&true))
            && pairs.iter().filter(|p| asks(touch, p)).all(pushes);
        if !by_all || is_moved_by_movers || out.anywhere {
            return None;
        }
        Some((VarId(axis as u32), Values::any(out.edges[axis][end].iter().copied())))
    };
    out.aligned = entity.touches.pairs().map(aligned).collect();
    out
}

/// Where another body can push one, and take it along.
fn pushed_by(
    out: &mut Contacts,
    carried: &mut [Vec<Interval>; 2],
    pair: &Pair,
    mine: &Body,
    theirs: &Body,
    crowd: &Crowd,
) {
    let (Some(extent), Some(other)) = (mine.extent, theirs.extent) else {
        out.anywhere = true;
        return;
    };
    for axis in 0..2 {
        out.pushers[axis] = out.pushers[axis].max(crowd.speed[axis]);
        let Some(at) = crowd.position[axis].hull() else { continue };
        let reach = Interval {
            low: at.low + other[axis].low - extent[axis].high - ROUNDING,
            high: at.high + other[axis].high - extent[axis].low + ROUNDING,
        };
        for side in sides(pair.meeting).filter(|s| face(*s).0 == axis) {
            let end = face(side).1;
            if !theirs.kinematic {
                out.edges[axis][end].push(reach);
                continue;
            }
            // Its low and high edges, wherever it is.
            let offset = match end {
                0 => other[axis].high - extent[axis].low,
                _ => other[axis].low - extent[axis].high,
            };
            out.edges[axis][end].extend(
                crowd.position[axis]
                    .intervals()
                    .iter()
                    .map(|i| Interval { low: i.low + offset - ROUNDING, high: i.high + offset + ROUNDING }),
            );
        }
        if pair.meeting.response.carry {
            carried[axis].push(reach);
        }
    }
}

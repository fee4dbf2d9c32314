//! What an instance can meet: which contacts can be, and what they can do to its position and speed.
//!
//! A push puts an edge of a collider onto an edge of what blocks it. So what is pushed by what never moves ends where
//! edges meet, and a contact with a blocking surface tells where the body is.

use std::collections::BTreeSet;

use crate::ir::{Id, IdVec, Push, SlotId, SpaceId, TagSet, Touch, TouchId, VarId};

use super::evaluate::{Configuration, Overall};
use super::region::Region;
use super::scene::{Body, Edges, Pair, ROUNDING, Scene, disjoin, face, near, rounded_step, sides_of};
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
    /// Of each contact question, along both axes, where the instance is when it holds.
    places: Vec<[Values; 2]>,
    /// Where a push can put the instance.
    edges: Edges,
    /// So, where it is not deep inside of anything.
    faces: Edges,
    /// Of both axes, the size of the thinnest thing that pushes it, px.
    thinnest: [f64; 2],
    /// Of both axes, how far a push can be where it is deep inside of something, px.
    longest: [f64; 2],
    is_pushed: bool,
    /// How far a push across may leave it inside of something, px.
    sunk: f64,
    /// Whether pushes can end anywhere.
    anywhere: bool,
    /// Of both axes, how fast what pushes it can move, px/s.
    pushers: [f64; 2],
    /// Whether it can be deep inside of something: what is put somewhere, or pushed.
    may_penetrate: bool,
    /// Whether a push stops the velocity into the surface.
    stops: bool,
    /// Whether pushes can leave the velocity, or end anywhere: by what can move, too.
    is_loose: bool,
    /// Of both axes, where a carrier can take the instance.
    carried: [Option<Values>; 2],
    /// Where it can get, in each of its spaces.
    regions: Vec<(SpaceId, Region)>,
}

/// What is known of all instances of a kind.
struct Crowd {
    /// How many there can be.
    count: usize,
    spaces: BTreeSet<SpaceId>,
    position: [Values; 2],
    /// px/s
    speed: [f64; 2],
    /// Of both axes, how far a push can be, px.
    push: [f64; 2],
    /// How far a step takes it along an axis, px, if it is held by what never moves and never inside of it.
    held: Option<f64>,
    /// Whether each is in one place for ever.
    stays: bool,
}

impl Surroundings {
    /// From what the slots can be. The scene must be prepared for their kinds in their spaces.
    pub fn new(scene: &mut Scene<'_>, slots: &IdVec<SlotId, Overall>) -> Self {
        let mut crowds: Vec<Crowd> = scene.kinds.iter().map(|kind| Crowd::new(&kind.slots, slots)).collect();
        for kind in 0..crowds.len() {
            (crowds[kind].push, crowds[kind].held) = pushable(scene, kind, &crowds);
        }
        let mut out = Surroundings::default();
        let mut known: Vec<(usize, &BTreeSet<SpaceId>)> = Vec::new();
        for (slot, overall) in slots.pairs() {
            let key = (scene.of[slot], &overall.spaces);
            let number = known.iter().position(|k| *k == key).unwrap_or_else(|| {
                known.push(key);
                let mut contacts = contacts(scene, key.0, key.1, &crowds);
                if let Some(far) = crowds[key.0].held {
                    let region = |space: &SpaceId| Some((*space, scene.region(key.0, *space, far)?.clone()));
                    contacts.regions = key.1.iter().map(region).collect::<Option<_>>().unwrap_or_default();
                }
                out.contacts.push(contacts);
                known.len() - 1
            });
            out.of.push(number);
        }
        out
    }

    /// Along both axes, where an instance is while a contact question holds.
    pub fn places(&self, slot: SlotId, touch: TouchId) -> &[Values; 2] {
        const ANYWHERE: [Values; 2] = [Values::all(), Values::all()];
        self.of(slot).places.get(touch.index()).unwrap_or(&ANYWHERE)
    }

    /// Where an instance can get, in each of the spaces it can be in; none if that is not known.
    pub fn regions(&self, slot: SlotId) -> &[(SpaceId, Region)] {
        &self.of(slot).regions
    }

    /// What is known of the contacts of a slot.
    pub fn of(&self, slot: SlotId) -> &Contacts {
        &self.contacts[self.of[slot]]
    }

    /// What a collision can do: `before` as the movement began, `moved` after it; `own` is how far the instance has gone
    /// by itself along both axes since the last collision.
    pub fn collide(
        &self,
        slot: SlotId,
        step: f64,
        own: [Interval; 2],
        before: &Configuration,
        moved: &mut Configuration,
    ) {
        let contacts = self.of(slot);
        for ((axis, places), own) in (0..).zip(&contacts.carried).zip(own) {
            if let Some(places) = places {
                let var = VarId(axis);
                // It stood near the carrier, and has gone from there by itself and with it.
                moved.vars[var][0] = moved.vars[var][0].or(&places.map(|i| i.plus(own)));
                moved.energy[var] = None;
            }
        }
        if !contacts.is_pushed {
            return;
        }
        self.push(contacts, step, before, moved);
        if !contacts.regions.is_empty() {
            let (x, y) = (moved.vars[VarId(0)][0], moved.vars[VarId(1)][0]);
            let cut = moved.spaces.iter().map(|space| self.within_region(slot, *space, &x, &y));
            let all = cut.reduce(|a, b| [a[0].or(&b[0]), a[1].or(&b[1])]);
            let [x, y] = all.unwrap_or([Values::none(), Values::none()]);
            moved.vars[VarId(0)][0] = x;
            moved.vars[VarId(1)][0] = y;
        }
    }

    /// What is left of the positions of an instance in a space where it can get.
    pub fn within_region(&self, slot: SlotId, space: SpaceId, x: &Values, y: &Values) -> [Values; 2] {
        let mut regions = self.of(slot).regions.iter();
        regions.find(|(s, _)| *s == space).map_or([*x, *y], |(_, region)| region.cut(x, y))
    }

    fn push(&self, contacts: &Contacts, step: f64, before: &Configuration, moved: &mut Configuration) {
        let speed = |axis: usize| moved.vars[VarId(axis as u32)][1].hull().map_or(0.0, |v| v.high.max(-v.low));
        let far = [0, 1].map(|axis| (speed(axis) + contacts.pushers[axis]) * step);
        let deep = contacts.may_penetrate || (0..2).any(|axis| far[axis] + ROUNDING >= contacts.thinnest[axis]);
        // What comes in along one axis is pushed out along the other where that is less.
        let far = far[0].max(far[1]) + contacts.sunk + ROUNDING;
        for axis in 0..2 {
            let var = VarId(axis as u32);
            let way = before.vars[var][0].hull().zip(moved.vars[var][0].hull()).map(|(a, b)| a.or(b));
            let Some(way) = way else { continue };
            let far = far + if deep { contacts.longest[axis] } else { 0.0 };
            let within = Interval { low: way.low - far, high: way.high + far };
            let [position, velocity, _] = &mut moved.vars[var];
            let Some(free) = velocity.hull() else { continue };
            let pushed = contacts.push(axis, within, deep, position);
            if pushed == [None; 2] {
                continue;
            }
            if contacts.stops {
                *velocity = velocity.or(&Values::point(0.0));
            }
            let slow = contacts.pushers[axis];
            moved.energy[var] = match moved.energy[var] {
                Some((fall, energy)) if !contacts.is_loose && contacts.stops => {
                    Some((fall, fall.pushed(energy, pushed, free, slow)))
                }
                _ => None,
            };
        }
    }
}

impl Contacts {
    /// Along an axis, over which positions a push may take an instance that moves at most so fast, px/s: towards higher
    /// and towards lower coordinates. None if it can be taken anywhere.
    pub fn helped(&self, axis: usize, speed: [f64; 2], step: f64) -> Option<[Vec<Interval>; 2]> {
        if self.anywhere || self.carried[axis].is_some() || speed.iter().any(|s| !s.is_finite()) {
            return None;
        }
        if !self.is_pushed {
            return Some([Vec::new(), Vec::new()]);
        }
        let far = [0, 1].map(|a| (speed[a] + self.pushers[a]) * step);
        let deep = self.may_penetrate || (0..2).any(|a| far[a] + ROUNDING >= self.thinnest[a]);
        // What comes in along one axis is pushed out along the other where that is less.
        let far = far[0].max(far[1]) + self.sunk + ROUNDING + if deep { self.longest[axis] } else { 0.0 };
        let [low, high] = if deep { &self.edges[axis] } else { &self.faces[axis] };
        let up = low.iter().map(|e| Interval { low: e.low - far, high: e.high + ROUNDING }).collect();
        let down = high.iter().map(|e| Interval { low: e.low - ROUNDING, high: e.high + far }).collect();
        Some([up, down])
    }

    /// Adds to a position where pushes within an interval can put it; gives what is around them, by the low and by the
    /// high side.
    fn push(&self, axis: usize, within: Interval, deep: bool, position: &mut Values) -> [Option<Interval>; 2] {
        if self.anywhere {
            *position = Values::all();
            return [Some(Interval::ALL); 2];
        }
        let edges = if deep { &self.edges } else { &self.faces };
        let ends = edges[axis].each_ref().map(|edges| between(edges, within));
        let around = |edges: &[Interval]| Some(Interval { low: edges.first()?.low, high: edges.last()?.high });
        let hulls = ends.map(around);
        if hulls.iter().flatten().any(|hull| !Values::from(*hull).is_within(position)) {
            let known = *position;
            let is_new = |e: &Interval| !known.intervals().iter().any(|i| i.low <= e.low && e.high <= i.high);
            let new = ends.into_iter().flatten().copied().filter(is_new);
            *position = Values::any(known.intervals().iter().copied().chain(new));
        }
        hulls
    }
}

/// Those of some edges in order that meet an interval.
fn between(edges: &[Interval], within: Interval) -> &[Interval] {
    let first = edges.partition_point(|e| e.high < within.low);
    let after = edges.partition_point(|e| e.low <= within.high);
    edges.get(first..after).unwrap_or_default()
}

impl Crowd {
    fn new(of: &[SlotId], slots: &IdVec<SlotId, Overall>) -> Crowd {
        let live = || of.iter().map(|s| &slots[*s]).filter(|o| o.can_live);
        let all = |axis: u32, degree: usize| {
            Values::any(live().filter_map(|o| o.vars.get(VarId(axis))).flat_map(|v| v[degree].intervals().to_vec()))
        };
        let speed = |axis: usize| live().map(|o| o.speed[axis]).fold(0.0, f64::max);
        Crowd {
            count: live().count(),
            spaces: live().flat_map(|o| o.spaces.iter().copied()).collect(),
            position: [all(0, 0), all(1, 0)],
            speed: [speed(0), speed(1)],
            push: [0.0; 2],
            held: None,
            stays: live().all(|o| {
                let is_fixed = |axis| o.vars.get(VarId(axis)).is_some_and(|v| v[0].constant().is_some());
                is_fixed(0) && is_fixed(1) && o.spaces.len() == 1
            }),
        }
    }
}

/// Those of what a kind meets that can be there, in some spaces.
fn met<'s>(scene: &'s Scene<'_>, me: usize, spaces: &BTreeSet<SpaceId>, crowds: &[Crowd]) -> Vec<&'s Pair> {
    let there = |pair: &&Pair| {
        let crowd = &crowds[pair.kind];
        crowd.count > usize::from(pair.kind == me) && crowd.spaces.iter().any(|s| spaces.contains(s))
    };
    scene.pairs[me].iter().filter(there).collect()
}

/// Whether what pushes a body can do so while that stands still: then it may push it into a wall, or be inside of it.
fn can_come_over(scene: &Scene<'_>, pair: &Pair, crowds: &[Crowd]) -> bool {
    let theirs = &scene.kinds[pair.kind].bodies[pair.theirs];
    let crowd = &crowds[pair.kind];
    let moves = crowd.speed != [0.0; 2] || !crowd.stays;
    let appears = scene.kinds[pair.kind].appears;
    moves || !theirs.kinematic || appears || theirs.extent.is_none() || !scene.is_settled(pair.kind)
}

/// Of both axes, how far instances of a kind can be pushed in a step, px.
fn pushable(scene: &Scene<'_>, me: usize, crowds: &[Crowd]) -> ([f64; 2], Option<f64>) {
    let (kind, crowd) = (&scene.kinds[me], &crowds[me]);
    let step = scene.world.step.seconds();
    let mut is_pushed = false;
    let mut deep = kind.jumps;
    let (mut far, mut longest) = (crowd.speed.map(|s| s * step), [0.0_f64; 2]);
    for found in crowd.spaces.iter().filter_map(|s| scene.statics(me, *s)).filter(|s| s.pushes) {
        is_pushed = true;
        deep |= found.anywhere;
        for axis in 0..2 {
            longest[axis] = longest[axis].max(found.longest[axis]);
            deep |= far[axis] + ROUNDING >= found.thinnest[axis];
        }
    }
    for pair in met(scene, me, &crowd.spaces, crowds) {
        let (mine, theirs) = (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        if pair.meeting.response.push == Push::Sense || mine.kinematic {
            continue;
        }
        is_pushed = true;
        deep |= can_come_over(scene, pair, crowds) || mine.extent.is_none();
        for axis in 0..2 {
            longest[axis] = longest[axis].max(Scene::size(mine)[axis] + Scene::size(theirs)[axis]);
            far[axis] = far[axis].max((crowd.speed[axis] + crowds[pair.kind].speed[axis]) * step);
        }
    }
    let far = far[0].max(far[1]);
    let push =
        |axis: usize| if is_pushed { 2.0 * far + ROUNDING + if deep { longest[axis] } else { 0.0 } } else { 0.0 };
    ([0, 1].map(push), (is_pushed && !deep).then_some(far))
}

fn contacts(scene: &Scene<'_>, me: usize, spaces: &BTreeSet<SpaceId>, crowds: &[Crowd]) -> Contacts {
    let kind = &scene.kinds[me];
    let entity = &scene.program.entities[kind.entity];
    // What is known of the spaces it can be in; there are none before it is there.
    let statics: Vec<_> = spaces.iter().filter_map(|s| scene.statics(me, *s)).collect();
    let pairs = met(scene, me, spaces, crowds);
    let body = |pair: &Pair| (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
    let mut out = Contacts { thinnest: [f64::INFINITY; 2], ..Contacts::default() };
    for found in &statics {
        out.is_pushed |= found.pushes;
        out.stops |= found.stops;
        out.is_loose |= found.slips;
        out.anywhere |= found.anywhere;
        for axis in 0..2 {
            out.thinnest[axis] = out.thinnest[axis].min(found.thinnest[axis]);
            out.longest[axis] = out.longest[axis].max(found.longest[axis]);
            for end in 0..2 {
                out.edges[axis][end].extend(&found.edges[axis][end]);
                out.faces[axis][end].extend(&found.faces[axis][end]);
            }
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
        out.may_penetrate |= can_come_over(scene, pair, crowds);
        let crowd = &crowds[pair.kind];
        // Both can be pushed after they have met; the carrier can be put elsewhere.
        let step = scene.world.step.seconds();
        let slack = [0, 1].map(|a| crowds[me].push[a] + crowd.push[a] + crowd.speed[a] * step);
        pushed_by(&mut out, &mut carried, pair, (mine, theirs), crowd, slack);
    }
    for edges in out.edges.iter_mut().chain(&mut out.faces).flatten() {
        disjoin(edges);
    }
    out.may_penetrate |= kind.jumps || out.anywhere;
    out.sunk = rounded_step(crowds[me].held.unwrap_or(0.0));
    out.carried = carried.map(|c| if c.is_empty() { None } else { Some(Values::any(c)) });
    if out.anywhere {
        out.carried = out.carried.map(|c| c.map(|_| Values::all()));
    }
    let deep = out.may_penetrate || (0..2).any(|a| crowds[me].push[a] >= out.thinnest[a]);
    let places = |(id, touch): (TouchId, &Touch)| {
        let asks = |pair: &&&Pair| {
            let (mine, theirs) = body(pair);
            mine.tags.meets(touch.mine) && theirs.tags.meets(TagSet::of(touch.other))
        };
        let asked: Vec<&&Pair> = pairs.iter().filter(asks).collect();
        let mut places = [0, 1].map(|axis| {
            // Contacts are found before anything is pushed.
            let moved = crowds[me].push[axis];
            let wide = |i: Interval, by: f64| Interval { low: i.low - by, high: i.high + by };
            let of_statics = statics.iter().filter_map(|s| s.places.get(id.index())).flat_map(|p| &p[axis]);
            let of_others = asked.iter().flat_map(|pair| {
                let (mine, theirs) = body(pair);
                let crowd = &crowds[pair.kind];
                let extent = theirs.extent.map_or(Interval::ALL, |e| e[axis]);
                let at = crowd.position[axis].intervals().iter();
                at.map(move |at| {
                    let place = near(mine.extent, axis, (at.low + extent.low, at.high + extent.high));
                    wide(place, moved + crowd.push[axis])
                })
            });
            Values::any(of_statics.map(|p| wide(*p, moved)).chain(of_others))
        });
        let pushes = |p: &&&Pair| p.meeting.response.push != Push::Sense && !body(p).0.kinematic;
        let by_all = statics.iter().all(|s| s.pushed.get(id.index()) == Some(&true)) && asked.iter().all(pushes);
        if let (Some(side), true) = (touch.side, by_all && !is_moved_by_movers && !out.anywhere) {
            let (axis, end) = face(side);
            let edges = if deep { &out.edges } else { &out.faces };
            places[axis] = places[axis].and(&Values::any(edges[axis][end].iter().copied()));
        }
        places
    };
    out.places = entity.touches.pairs().map(places).collect();
    out
}

/// Where another body can push one, and take it along.
fn pushed_by(
    out: &mut Contacts,
    carried: &mut [Vec<Interval>; 2],
    pair: &Pair,
    (mine, theirs): (&Body, &Body),
    crowd: &Crowd,
    slack: [f64; 2],
) {
    let (Some(extent), Some(other)) = (mine.extent, theirs.extent) else {
        out.anywhere = true;
        return;
    };
    for axis in 0..2 {
        out.pushers[axis] = out.pushers[axis].max(crowd.speed[axis]);
        let sizes = other[axis].high - other[axis].low;
        out.thinnest[axis] = out.thinnest[axis].min(sizes);
        out.longest[axis] = out.longest[axis].max(sizes + extent[axis].high - extent[axis].low);
        let Some(at) = crowd.position[axis].hull() else { continue };
        let reach = near(mine.extent, axis, (at.low + other[axis].low, at.high + other[axis].high));
        for side in sides_of(pair.meeting).filter(|s| face(*s).0 == axis) {
            let end = face(side).1;
            // By its low and high edges, wherever it is; what moves itself can be pushed from there to anywhere near.
            let edges: Vec<Interval> = match theirs.kinematic {
                false => vec![reach],
                true => {
                    let offset = match end {
                        0 => other[axis].high - extent[axis].low,
                        _ => other[axis].low - extent[axis].high,
                    };
                    let at = crowd.position[axis].intervals().iter();
                    at.map(|i| Interval { low: i.low + offset - ROUNDING, high: i.high + offset + ROUNDING }).collect()
                }
            };
            out.edges[axis][end].extend(&edges);
            out.faces[axis][end].extend(&edges);
        }
        if pair.meeting.response.carry {
            carried[axis].push(Interval { low: reach.low - slack[axis], high: reach.high + slack[axis] });
        }
    }
}

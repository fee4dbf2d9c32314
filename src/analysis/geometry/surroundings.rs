//! What an instance can meet: which contacts can be, and what they can do to its position and speed.
//!
//! A push puts an edge of a collider onto an edge of what blocks it. So what is pushed by what never moves ends where
//! edges meet, and a contact with a blocking surface tells where the body is.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{Id, IdVec, LeafId, Origin, SlotId, SpaceId, TagSet, Touch, TouchId, VarId};

use crate::analysis::domain::configuration::{Configuration, Overall};
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::{Body, Edges, Pair, ROUNDING, TOLERANCE, disjoin, face, near, rounded, sides_of};
use crate::analysis::geometry::crowd::{Crowd, crowds, met, pushes};
use crate::analysis::geometry::local::Surfaces;
use crate::analysis::geometry::presence::Cover;
use crate::analysis::geometry::region::{Obstacle, Region};
use crate::analysis::geometry::scene::Scene;

/// What is known of the contacts of every slot.
#[derive(Debug, Default, Clone)]
pub(in crate::analysis) struct Surroundings {
    contacts: Vec<Contacts>,
    of: IdVec<SlotId, usize>,
}

/// What is known of the contacts of one slot.
#[derive(Debug, Default, Clone, PartialEq)]
pub(in crate::analysis) struct Contacts {
    /// Of each contact question, along both axes, where the instance is when it holds.
    places: Vec<[Values; 2]>,
    /// Where a push can put the instance.
    edges: Edges,
    /// So, where it is never deep inside of anything.
    faces: Edges,
    /// Of both axes, how far a push can be at most, px: it ends beside what pushes.
    longest: [f64; 2],
    is_pushed: bool,
    /// The positions at which anything that pushes can be met.
    near: Option<[Interval; 2]>,
    /// The same, of what never moves alone.
    near_statics: Option<[Interval; 2]>,
    /// Whether it is never inside of what pushes it when a step begins, so that a push takes it no further than the step
    /// has.
    is_gentle: bool,
    /// Whether pushes can end anywhere.
    anywhere: bool,
    /// Whether a push stops the velocity into the surface.
    stops: bool,
    /// Whether pushes can leave the velocity, or end anywhere: by what can move, too.
    is_loose: bool,
    /// Of both axes, where a carrier can take the instance.
    carried: [Option<Values>; 2],
    /// While which leaves it is kept out of what blocks it.
    cover: Cover,
    /// Where it can get then, in each of its spaces.
    regions: Vec<(SpaceId, Region)>,
    /// Where it is distinguished by place: what never moves, in each space.
    surfaces: Vec<(SpaceId, Arc<Surfaces>)>,
    /// So: what never moves although it could, as far as it pushes it.
    obstacles: Vec<(SpaceId, Surfaces)>,
    /// Of each contact question, along both axes, where the instance is when it holds of another one.
    places_of_others: Vec<[Values; 2]>,
}

/// How an instance has come to where it is when contacts are found.
pub(in crate::analysis) struct Way {
    /// Where it was as the continuous phase began.
    pub from: [Values; 2],
    /// Along both axes, how far it has gone by itself since the last collision, px.
    pub own: [Interval; 2],
    /// Of both axes, how far velocities have taken it since then, px.
    pub far: [f64; 2],
}

impl Surroundings {
    /// From what the slots can be; nothing is known if it is stopped. The scene must be prepared for their kinds in their
    /// spaces.
    pub fn new(scene: &mut Scene<'_>, slots: &IdVec<SlotId, Overall>) -> Self {
        let crowds = crowds(scene, slots);
        if scene.meter.is_stopped() {
            return Surroundings::unknown(slots);
        }
        let mut out = Surroundings::default();
        let mut known: Vec<(usize, &BTreeSet<SpaceId>)> = Vec::new();
        for (slot, overall) in slots.pairs() {
            let key = (scene.of[slot], &overall.spaces);
            if scene.meter.spend(known.len() as u64) {
                return Surroundings::unknown(slots);
            }
            let number = known.iter().position(|k| *k == key).unwrap_or_else(|| {
                known.push(key);
                let mut contacts = contacts(scene, key.0, key.1, &crowds);
                if contacts.is_gentle {
                    let step = crowds[key.0].near_step;
                    let obstacles = |space: &SpaceId| crowds[key.0].obstacles.get(space).map_or(&[][..], Vec::as_slice);
                    let region =
                        |space: &SpaceId| Some((*space, scene.region(key.0, *space, step, obstacles(space))?.clone()));
                    contacts.regions = key.1.iter().map(region).collect::<Option<_>>().unwrap_or_default();
                }
                out.contacts.push(contacts);
                known.len() - 1
            });
            out.of.push(number);
        }
        out
    }

    /// Where nothing is known.
    pub fn unknown(slots: &IdVec<SlotId, Overall>) -> Self {
        let near = Some([Interval::ALL; 2]);
        let anywhere = Contacts { anywhere: true, is_pushed: true, near, near_statics: near, ..Contacts::default() };
        Surroundings { contacts: vec![anywhere], of: slots.iter().map(|_| 0).collect() }
    }

    /// Along both axes, where an instance is while a contact question holds.
    pub fn places(&self, slot: SlotId, touch: TouchId) -> &[Values; 2] {
        const ANYWHERE: [Values; 2] = [Values::all(), Values::all()];
        self.of(slot).places.get(touch.index()).unwrap_or(&ANYWHERE)
    }

    /// Boxes around where an instance of a configuration is while a contact question holds; none if it is not distinguished
    /// by place.
    pub fn touched(&self, slot: SlotId, id: TouchId, touch: &Touch, at: &Configuration) -> Option<Vec<[Interval; 2]>> {
        let contacts = self.of(slot);
        if contacts.surfaces.is_empty() || !contacts.is_gentle {
            return None;
        }
        let hulls = [at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()];
        let mut out = Vec::new();
        let [Some(x), Some(y)] = hulls else { return Some(out) };
        let others = contacts.places_of_others.get(id.index())?;
        if let (Some(x), Some(y)) = (others[0].within(x).hull(), others[1].within(y).hull()) {
            out.push([x, y]);
        }
        // What is named is an instance.
        if !touch.bound {
            let far = contacts.longest[0].max(contacts.longest[1]);
            for (space, surfaces) in contacts.surfaces.iter().filter(|(space, _)| at.spaces.contains(space)) {
                let mut also = contacts.obstacles.iter().filter(|(of, _)| of == space).map(|(_, s)| s);
                surfaces.touched(touch, [x, y], far, also.next(), &mut out);
            }
        }
        Some(out)
    }

    /// Whether an instance is never deep inside of what pushes it.
    pub fn is_gentle(&self, slot: SlotId) -> bool {
        self.of.get(slot).is_some_and(|of| self.contacts[*of].is_gentle)
    }

    /// Whether an instance is never inside of what blocks it while some leaves are active.
    pub fn is_covered(&self, slot: SlotId, leaves: &[LeafId]) -> bool {
        let contacts = self.of.get(slot).map(|of| &self.contacts[*of]);
        contacts.is_some_and(|c| c.is_gentle && c.covers(leaves))
    }

    /// Where an instance can get while it is covered, in each of the spaces it can be in; none if that is not known.
    pub fn regions(&self, slot: SlotId) -> &[(SpaceId, Region)] {
        &self.of(slot).regions
    }

    /// While which leaves it is.
    pub fn cover(&self, slot: SlotId) -> &Cover {
        &self.of(slot).cover
    }

    /// What is known of the contacts of a slot.
    pub fn of(&self, slot: SlotId) -> &Contacts {
        &self.contacts[self.of[slot]]
    }

    /// The collision phase: `moved` is what the continuous phase leads to. Returns where the instance is when contacts are
    /// found.
    pub fn collide(&self, slot: SlotId, way: &Way, moved: &mut Configuration) -> [Values; 2] {
        let contacts = self.of(slot);
        for ((axis, places), own) in (0..).zip(&contacts.carried).zip(way.own) {
            if let Some(places) = places {
                let var = VarId(axis);
                // It was near the carrier, and has gone from there by itself and with it.
                moved.vars[var][0] = moved.vars[var][0].or(&places.map(|i| i.plus(own)));
                moved.energy[var] = None;
            }
        }
        let contact = [moved.vars[VarId::X][0], moved.vars[VarId::Y][0]];
        if !contacts.is_pushed || !is_near(contacts.near, &contact) {
            return contact;
        }
        contacts.push_out(way, moved);
        if !contacts.regions.is_empty() && contacts.covers(&moved.leaves) {
            let (x, y) = (moved.vars[VarId::X][0], moved.vars[VarId::Y][0]);
            let cut = moved.spaces.iter().map(|space| self.within_region(slot, *space, &x, &y));
            let all = cut.reduce(|a, b| [a[0].or(&b[0]), a[1].or(&b[1])]);
            let [x, y] = all.unwrap_or([Values::none(), Values::none()]);
            moved.vars[VarId::X][0] = x;
            moved.vars[VarId::Y][0] = y;
        }
        contact
    }

    /// Whether an instance at some positions can meet something that never moves.
    pub fn is_near_statics(&self, slot: SlotId, at: &[Values; 2]) -> bool {
        is_near(self.of(slot).near_statics, at)
    }

    /// What is left of the positions of an instance in a space where it can get.
    pub fn within_region(&self, slot: SlotId, space: SpaceId, x: &Values, y: &Values) -> [Values; 2] {
        let mut regions = self.of(slot).regions.iter();
        regions.find(|(s, _)| *s == space).map_or([*x, *y], |(_, region)| region.cut(x, y))
    }
}

/// Whether positions lie within a box.
fn is_near(within: Option<[Interval; 2]>, at: &[Values; 2]) -> bool {
    within.is_some_and(|near| (0..2).all(|axis| !at[axis].within(near[axis]).is_none()))
}

impl Contacts {
    fn covers(&self, leaves: &[LeafId]) -> bool {
        self.cover.covers(leaves)
    }

    /// Pushes out what overlaps something. Of the pushes along an axis the deepest counts, so that it ends where edges
    /// meet whatever else pushes.
    fn push_out(&self, way: &Way, moved: &mut Configuration) {
        let slack = TOLERANCE + ROUNDING;
        let far = way.far[0].max(way.far[1]) + slack;
        let local = self.local_edges(far, moved);
        for axis in 0..2 {
            let var = VarId::XY[axis];
            let [position, velocity, _] = &mut moved.vars[var];
            let (Some(at), Some(free)) = (position.hull(), velocity.hull()) else { continue };
            let within = match way.from[axis].hull().filter(|_| self.is_gentle) {
                // What it overlaps now it did not before. If that was beside it along this axis, it goes back no further than
                // to where it was. Else it has moved into it along the other axis: it is pushed along this one where that is
                // the shorter way.
                Some(from) => {
                    let across = far.min(way.far[1 - axis] + slack);
                    let highest = (from.high + slack).max(at.high + across);
                    let lowest = (from.low - slack).min(at.low - across);
                    let (up, down) = (Interval { low: at.low, high: highest }, Interval { low: lowest, high: at.high });
                    [up, down].map(rounded)
                }
                None => {
                    let far = if self.is_gentle { far } else { self.longest[axis] };
                    [rounded(Interval { low: at.low - far, high: at.high + far }); 2]
                }
            };
            let edges = match &local {
                Some(edges) => edges,
                None if self.is_gentle => &self.faces,
                None => &self.edges,
            };
            let pushed = self.push(&edges[axis], within, position);
            if pushed == [None; 2] {
                continue;
            }
            if self.stops {
                *velocity = velocity.or(&Values::point(0.0));
            }
            moved.energy[var] = match moved.energy[var] {
                Some((fall, energy)) if !self.is_loose && self.stops => Some((fall, fall.pushed(energy, pushed, free))),
                _ => None,
            };
        }
    }

    /// Where what never moves near to an instance can push it, if it is distinguished by place.
    fn local_edges(&self, far: f64, at: &Configuration) -> Option<Edges> {
        if self.surfaces.is_empty() || !self.is_gentle {
            return None;
        }
        let mut out = Edges::default();
        if let (Some(x), Some(y)) = (at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()) {
            let surfaces = self.surfaces.iter().map(|(space, s)| (space, s.as_ref()));
            let all = surfaces.chain(self.obstacles.iter().map(|(space, s)| (space, s)));
            for (_, surfaces) in all.filter(|(space, _)| at.spaces.contains(space)) {
                surfaces.edges([x, y], far, &at.leaves, &mut out);
            }
        }
        out.iter_mut().flatten().for_each(disjoin);
        Some(out)
    }

    /// Along an axis, over which positions a push may take an instance that moves at most so fast, px/s: towards higher
    /// and towards lower coordinates. None if it can be taken anywhere.
    pub fn helped(&self, axis: usize, speed: [f64; 2], step: f64) -> Option<[Vec<Interval>; 2]> {
        if self.anywhere || self.carried[axis].is_some() || speed.iter().any(|s| !s.is_finite()) {
            return None;
        }
        if !self.is_pushed {
            return Some([Vec::new(), Vec::new()]);
        }
        // What comes in along one axis is pushed out along the other where that is less. What is inside of something goes
        // to beside it.
        let far = match self.is_gentle {
            true => speed[0].max(speed[1]) * step + TOLERANCE + ROUNDING,
            false => self.longest[axis] + ROUNDING,
        };
        let [low, high] = if self.is_gentle { &self.faces[axis] } else { &self.edges[axis] };
        let up = low.iter().map(|e| Interval { low: e.low - far, high: e.high + ROUNDING }).collect();
        let down = high.iter().map(|e| Interval { low: e.low - ROUNDING, high: e.high + far }).collect();
        Some([up, down])
    }

    /// Adds to a position where pushes within intervals can put it; returns what is around them, by the low and by the
    /// high side.
    fn push(&self, edges: &[Vec<Interval>; 2], within: [Interval; 2], position: &mut Values) -> [Option<Interval>; 2] {
        if self.anywhere {
            *position = Values::all();
            return [Some(Interval::ALL); 2];
        }
        let ends = [between(&edges[0], within[0]), between(&edges[1], within[1])];
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

fn contacts(scene: &Scene<'_>, me: usize, spaces: &BTreeSet<SpaceId>, crowds: &[Crowd]) -> Contacts {
    let kind = &scene.kinds[me];
    let entity = &scene.program.entities[kind.entity];
    // What is known of the spaces it can be in; there are none before it is there.
    let statics: Vec<_> = spaces.iter().filter_map(|s| scene.statics(me, *s)).collect();
    let pairs = met(scene, me, spaces, crowds);
    let body = |pair: &Pair| (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
    let mut out = Contacts {
        longest: crowds[me].push,
        is_gentle: crowds[me].gentle.is_some(),
        near: kind.near,
        near_statics: kind.near,
        cover: kind.cover(),
        surfaces: scene.surfaces[me].clone(),
        obstacles: obstacles(scene, me, &crowds[me]),
        ..Contacts::default()
    };
    for found in &statics {
        out.is_pushed |= found.pushes;
        out.stops |= found.stops;
        out.is_loose |= found.slips;
        out.anywhere |= found.anywhere;
        for axis in 0..2 {
            for end in 0..2 {
                out.edges[axis][end].extend(&found.edges[axis][end]);
                out.faces[axis][end].extend(&found.faces[axis][end]);
            }
        }
    }
    let mut carried: [Vec<Interval>; 2] = [Vec::new(), Vec::new()];
    let mut is_moved_by_movers = false;
    for pair in pairs.iter().filter(|p| pushes(scene, me, p)) {
        let (mine, theirs) = body(pair);
        out.is_pushed = true;
        out.stops |= pair.meeting.response.stop;
        out.is_loose |= !pair.meeting.response.stop || !theirs.kinematic;
        is_moved_by_movers |= !theirs.kinematic;
        let crowd = &crowds[pair.kind];
        // It may have been pushed since it was on the carrier; what never moves carries nothing along.
        let slack = [0, 1].map(|axis| crowds[me].push[axis] + crowd.displacement[axis]);
        let slack = crowd.still.is_none().then_some(slack);
        pushed_by(&mut out, &mut carried, pair, (mine, theirs), crowd, slack);
    }
    for edges in out.edges.iter_mut().chain(&mut out.faces).flatten() {
        disjoin(edges);
    }
    out.carried = carried.map(|c| if c.is_empty() { None } else { Some(Values::any(c)) });
    if out.anywhere {
        out.carried = out.carried.map(|c| c.map(|_| Values::all()));
    }
    let asked = |touch: &Touch| {
        let asks = |pair: &&&Pair| {
            let (mine, theirs) = body(pair);
            mine.tags.meets(touch.mine) && theirs.tags.meets(TagSet::of(touch.other))
        };
        pairs.iter().filter(asks).copied().collect::<Vec<&Pair>>()
    };
    // Boxes in which it touches another instance.
    let others = |touch: &Touch| {
        let asked = asked(touch);
        [0, 1].map(|axis| {
            let moved = if out.is_pushed { crowds[me].push[axis] } else { 0.0 };
            Values::any(asked.iter().flat_map(|pair| {
                let (mine, theirs) = body(pair);
                let extent = theirs.extent.map_or(Interval::ALL, |e| e[axis]);
                let at = crowds[pair.kind].contact[axis].intervals().iter();
                at.map(move |at| {
                    let place = near(mine.extent, axis, (at.low + extent.low, at.high + extent.high));
                    rounded(Interval { low: place.low - moved, high: place.high + moved })
                })
            }))
        })
    };
    let places_of_others: Vec<[Values; 2]> = entity.touches.iter().map(others).collect();
    let places = |(id, touch): (TouchId, &Touch)| {
        let asked = asked(touch);
        let mut places = [0, 1].map(|axis| {
            // Contacts are found before anything is pushed.
            let moved = if out.is_pushed { crowds[me].push[axis] } else { 0.0 };
            let wide = |i: Interval, by: f64| rounded(Interval { low: i.low - by, high: i.high + by });
            let of_statics = statics.iter().filter_map(|s| s.places.get(id.index())).flat_map(|p| &p[axis]);
            let of_others = places_of_others[id.index()][axis];
            Values::any(of_statics.map(|place| wide(*place, moved)).chain(of_others.intervals().iter().copied()))
        });
        let is_pushing = |p: &&Pair| pushes(scene, me, p);
        let by_all = statics.iter().all(|s| s.pushed.get(id.index()) == Some(&true)) && asked.iter().all(is_pushing);
        if let (Some(side), true) = (touch.side, by_all && !is_moved_by_movers && !out.anywhere) {
            let (axis, end) = face(side);
            // A push to the other side may have won; before the first step nothing is pushed.
            let ends: Vec<Interval> = match out.is_gentle {
                true => out.faces[axis][end].clone(),
                false => out.edges[axis].iter().flatten().copied().collect(),
            };
            let first = kind.slots.iter().map(|s| &scene.world.slots[*s]).filter(|s| s.origin != Origin::Free);
            let first = first.map(|s| Interval::point(s.vars[VarId::XY[axis]][0]));
            places[axis] = places[axis].and(&Values::any(ends.into_iter().chain(first)));
        }
        places
    };
    out.places = entity.touches.pairs().map(places).collect();
    out.places_of_others = places_of_others;
    out
}

/// What pushes a kind and never moves although it could, where the kind is distinguished by place.
fn obstacles(scene: &Scene<'_>, me: usize, crowd: &Crowd) -> Vec<(SpaceId, Surfaces)> {
    let kind = &scene.kinds[me];
    if scene.surfaces[me].is_empty() {
        return Vec::new();
    }
    let of = |(space, obstacles): (&SpaceId, &Vec<Obstacle>)| (*space, Surfaces::of(scene.world, kind, obstacles));
    crowd.obstacles.iter().map(of).collect()
}

/// Where another body can push one, and take it along.
fn pushed_by(
    out: &mut Contacts,
    carried: &mut [Vec<Interval>; 2],
    pair: &Pair,
    (mine, theirs): (&Body, &Body),
    crowd: &Crowd,
    slack: Option<[f64; 2]>,
) {
    let (Some(extent), Some(other)) = (mine.extent, theirs.extent) else {
        out.anywhere = true;
        out.near = Some([Interval::ALL; 2]);
        return;
    };
    let mut reaches = [Interval::ALL; 2];
    for axis in 0..2 {
        let Some(at) = crowd.contact[axis].hull() else { continue };
        let reach = near(mine.extent, axis, (at.low + other[axis].low, at.high + other[axis].high));
        reaches[axis] = reach;
        for side in sides_of(pair.meeting).filter(|s| face(*s).0 == axis) {
            let end = face(side).1;
            // By its low and high edges, wherever it is; what moves itself goes half the way.
            let edges: Vec<Interval> = match theirs.kinematic {
                false => vec![reach],
                true => {
                    let offset = match end {
                        0 => other[axis].high - extent[axis].low,
                        _ => other[axis].low - extent[axis].high,
                    };
                    let at = crowd.contact[axis].intervals().iter();
                    at.map(|i| rounded(Interval { low: i.low + offset, high: i.high + offset })).collect()
                }
            };
            out.edges[axis][end].extend(&edges);
            out.faces[axis][end].extend(&edges);
        }
        if let Some(slack) = slack.filter(|_| pair.meeting.response.carry) {
            carried[axis].push(Interval { low: reach.low - slack[axis], high: reach.high + slack[axis] });
        }
    }
    out.near = Some(out.near.map_or(reaches, |near| [near[0].or(reaches[0]), near[1].or(reaches[1])]));
}

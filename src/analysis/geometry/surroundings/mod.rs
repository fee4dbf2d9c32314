//! The contacts that an instance can have, and their effect on its position and speed.
//!
//! A push moves an edge of a collider onto an edge of the obstacle. So a body that a static obstacle pushes ends at a
//! known position, and a contact with a blocking surface determines the position of the body.

mod apart;
mod places;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{Bounce, Extremes, Id, IdVec, LeafId, Origin, SlotId, SpaceId, TagSet, Touch, TouchId, VarId, World};

use crate::analysis::domain::configuration::{Configuration, Overall};
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::{Body, Edges, Pair, ROUNDING, TOLERANCE, disjoin, face, near, rounded, sides_of};
use crate::analysis::geometry::kind_summary::{KindSummary, kind_summaries, met, pushes};
use crate::analysis::geometry::local::Surfaces;
use crate::analysis::geometry::presence::KeptOut;
use crate::analysis::geometry::region::{Obstacle, Region};
use crate::analysis::geometry::scene::Scene;
use crate::analysis::geometry::seam;

use places::Places;

/// The possible contacts of every slot.
#[derive(Debug, Default, Clone)]
pub(in crate::analysis) struct Surroundings {
    contacts: Vec<Contacts>,
    of: IdVec<SlotId, usize>,
}

/// The possible contacts of one slot.
#[derive(Debug, Default, Clone, PartialEq)]
pub(in crate::analysis) struct Contacts {
    /// For each contact query, per axis, the positions at which it can hold.
    places: Vec<[Values; 2]>,
    /// Where pushes end.
    edges: Edges,
    /// Where pushes end if the instance is never deep inside an obstacle.
    faces: Edges,
    /// Per axis, the maximum length of a push, px: it ends beside the obstacle.
    longest: [f64; 2],
    is_pushed: bool,
    /// The positions at which it can touch something that pushes it.
    near: Option<[Interval; 2]>,
    /// The same for static obstacles only.
    near_statics: Option<[Interval; 2]>,
    /// Whether it is never inside an obstacle when a step begins, so that a push is never longer than the step.
    has_bounded_pushes: bool,
    /// Whether pushes can end anywhere.
    anywhere: bool,
    /// Whether slopes push it: along x back to where it came from, too, and down to the ground as it walks.
    slopes: bool,
    /// Whether a push stops the velocity into the surface.
    stops: bool,
    /// How pushes turn the velocity into the surface back.
    bounces: BTreeSet<Bounce>,
    /// Whether pushes can keep the velocity or end anywhere, including pushes by moving obstacles.
    is_loose: bool,
    /// Per axis, where a carrier can take the instance.
    carried: [Option<Values>; 2],
    /// The condition under which it is kept out of blocking obstacles.
    kept_out: KeptOut,
    /// The reachable region under that condition, in each of its spaces.
    regions: Vec<(SpaceId, Region)>,
    /// If it is distinguished by place: the static obstacles of each space.
    surfaces: Vec<(SpaceId, Arc<Surfaces>)>,
    /// The same for stationary instances that push it.
    obstacles: Vec<(SpaceId, Surfaces)>,
    /// For each contact query, per axis, the positions at which it can hold for another instance.
    places_of_others: Vec<[Values; 2]>,
    /// The same by place, if the others are told apart by theirs; empty if not.
    boxes_of_others: Vec<Option<Places>>,
}

/// How an instance has moved before contacts are detected.
pub(in crate::analysis) struct Motion {
    /// Its position at the start of the continuous phase.
    pub from: [Values; 2],
    /// Per axis, its own displacement since the last collision, px.
    pub own: [Interval; 2],
    /// The same since the continuous phase began.
    pub by: [Interval; 2],
    /// Per axis, the length of the step, s, if it has moved by its velocity alone.
    pub step: [Option<f64>; 2],
    /// Per axis, the displacement by velocities since then, px.
    pub far: [f64; 2],
}

impl Surroundings {
    /// Computes the contacts of all slots; everything is unknown if the meter runs out. The scene must be prepared for
    /// the kinds of the slots in their spaces.
    pub fn new(scene: &mut Scene<'_>, slots: &IdVec<SlotId, Overall>) -> Self {
        let summaries = kind_summaries(scene, slots);
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
                let mut contacts = contacts(scene, key.0, key.1, &summaries);
                if contacts.has_bounded_pushes {
                    let step = summaries[key.0].near_step;
                    let obstacles =
                        |space: &SpaceId| summaries[key.0].obstacles.get(space).map_or(&[][..], Vec::as_slice);
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

    /// Assumes every contact.
    pub fn unknown(slots: &IdVec<SlotId, Overall>) -> Self {
        let near = Some([Interval::ALL; 2]);
        let anywhere = Contacts { anywhere: true, is_pushed: true, near, near_statics: near, ..Contacts::default() };
        Surroundings { contacts: vec![anywhere], of: slots.iter().map(|_| 0).collect() }
    }

    /// Per axis, the positions at which a contact query of an instance can hold.
    pub fn places(&self, slot: SlotId, touch: TouchId) -> &[Values; 2] {
        const ANYWHERE: [Values; 2] = [Values::all(), Values::all()];
        self.of(slot).places.get(touch.index()).unwrap_or(&ANYWHERE)
    }

    /// Boxes that contain the positions of a configuration at which a contact query can hold; `None` if the slot is not
    /// distinguished by place.
    pub fn touched(&self, slot: SlotId, id: TouchId, touch: &Touch, at: &Configuration) -> Option<Vec<[Interval; 2]>> {
        let contacts = self.of(slot);
        if contacts.surfaces.is_empty() || !contacts.has_bounded_pushes {
            return None;
        }
        let hulls = [at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()];
        let mut out = Vec::new();
        let [Some(x), Some(y)] = hulls else { return Some(out) };
        let others = contacts.places_of_others.get(id.index())?;
        if let Some(Some(boxes)) = contacts.boxes_of_others.get(id.index()) {
            at.spaces.iter().for_each(|space| boxes.within(*space, [x, y], &mut out));
        } else if let (Some(x), Some(y)) = (others[0].within(x).hull(), others[1].within(y).hull()) {
            out.push([x, y]);
        }
        // A bound contact query names an instance, or a tile that can be broken.
        if !touch.bound || touch.tiles {
            let far = contacts.longest[0].greatest(contacts.longest[1]);
            // It moves by no more than it can be pushed.
            let is_carried = contacts.carried.iter().any(Option::is_some);
            let back = (!is_carried).then_some(2.0 * far);
            for (space, surfaces) in contacts.surfaces.iter().filter(|(space, _)| at.spaces.contains(space)) {
                let mut also = contacts.obstacles.iter().filter(|(of, _)| of == space).map(|(_, s)| s);
                // What was not pushed along y touches nothing there that pushes.
                let pushed = [true, at.trace.is_none_or(|trace| trace.pushed != [false; 2])];
                surfaces.touched(touch, ([x, y], pushed), (far, back), also.next(), &mut out);
            }
        }
        Some(out)
    }

    /// Boxes of the positions of a configuration at which a contact query surely holds: its contacts are those of the
    /// collision phase after which it is there, with the same leaves.
    pub fn surely_touched(&self, slot: SlotId, touch: &Touch, at: &Configuration) -> Vec<[Interval; 2]> {
        let (Some(trace), Some(space)) = (at.trace, at.spaces.first()) else { return Vec::new() };
        let hulls = [at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()];
        let [Some(x), Some(y)] = hulls else { return Vec::new() };
        let contacts = self.of(slot);
        // With several groups, an edge of one may have changed the leaves since.
        let is_one = at.leaves.len() == 1 && at.spaces.len() == 1;
        if touch.bound || !is_one || !contacts.obstacles.is_empty() || !self.can_tell_apart(slot) {
            return Vec::new();
        }
        let far = contacts.longest[0].greatest(contacts.longest[1]);
        let of = contacts.surfaces.iter().filter(|(of, _)| of == space);
        of.flat_map(|(_, of)| of.surely_touched(touch, ([x, y], trace.pushed), far, &at.leaves)).collect()
    }

    /// Whether an instance is never deep inside an obstacle.
    pub fn has_bounded_pushes(&self, slot: SlotId) -> bool {
        self.of.get(slot).is_some_and(|of| self.contacts[*of].has_bounded_pushes)
    }

    /// Whether an instance is kept out of blocking obstacles in some leaves.
    pub fn is_kept_out(&self, slot: SlotId, leaves: &[LeafId]) -> bool {
        let contacts = self.of.get(slot).map(|of| &self.contacts[*of]);
        contacts.is_some_and(|c| c.has_bounded_pushes && c.holds_for(leaves))
    }

    /// The reachable regions of an instance while it is kept out of blocking obstacles, in each of its spaces; empty if
    /// unknown.
    pub fn regions(&self, slot: SlotId) -> &[(SpaceId, Region)] {
        &self.of(slot).regions
    }

    /// The condition under which an instance is kept out of blocking obstacles.
    pub fn kept_out(&self, slot: SlotId) -> &KeptOut {
        &self.of(slot).kept_out
    }

    /// The possible contacts of a slot.
    pub fn of(&self, slot: SlotId) -> &Contacts {
        &self.contacts[self.of[slot]]
    }

    /// The collision phase; `moved` is the result of the continuous phase. Returns the positions when contacts are
    /// detected.
    pub fn collide(&self, world: &World, slot: SlotId, mut motion: Motion, moved: &mut Configuration) -> [Values; 2] {
        let contacts = self.of(slot);
        for ((axis, places), own) in (0..).zip(&contacts.carried).zip(motion.own) {
            if let Some(places) = places {
                let var = VarId(axis);
                // It was near the carrier, and has moved with it and by itself since.
                moved.vars[var][0] = moved.vars[var][0].or(&places.map(|i| i.plus(own)));
                moved.energy[var] = None;
            }
        }
        for axis in 0..2 {
            if seam::into_reach(world, axis, moved) {
                motion.from[axis] = Values::all();
            }
        }
        let contact = [moved.vars[VarId::X][0], moved.vars[VarId::Y][0]];
        if !contacts.is_pushed || !is_near(contacts.near, &contact) {
            return contact;
        }
        contacts.push_out(&motion, moved);
        if !contacts.regions.is_empty() && contacts.holds_for(&moved.leaves) {
            let (x, y) = (moved.vars[VarId::X][0], moved.vars[VarId::Y][0]);
            let cut = moved.spaces.iter().map(|space| self.within_region(slot, *space, &x, &y));
            let all = cut.reduce(|a, b| [a[0].or(&b[0]), a[1].or(&b[1])]);
            let [x, y] = all.unwrap_or([Values::none(), Values::none()]);
            moved.vars[VarId::X][0] = x;
            moved.vars[VarId::Y][0] = y;
        }
        contact
    }

    /// Whether an instance at some positions can touch a static obstacle.
    pub fn is_near_statics(&self, slot: SlotId, at: &[Values; 2]) -> bool {
        is_near(self.of(slot).near_statics, at)
    }

    /// Restricts positions in a space to the reachable region.
    pub fn within_region(&self, slot: SlotId, space: SpaceId, x: &Values, y: &Values) -> [Values; 2] {
        let mut regions = self.of(slot).regions.iter();
        regions.find(|(s, _)| *s == space).map_or([*x, *y], |(_, region)| region.cut(x, y))
    }
}

/// Whether positions overlap a box.
fn is_near(within: Option<[Interval; 2]>, at: &[Values; 2]) -> bool {
    within.is_some_and(|near| (0..2).all(|axis| !at[axis].within(near[axis]).is_none()))
}

impl Contacts {
    fn holds_for(&self, leaves: &[LeafId]) -> bool {
        self.kept_out.holds_for(leaves)
    }

    /// Pushes the body out of overlaps. Of the pushes along an axis the deepest wins, so the result lies at an end of a
    /// push, whatever else pushes.
    fn push_out(&self, motion: &Motion, moved: &mut Configuration) {
        let slack = TOLERANCE + ROUNDING;
        let far = motion.far[0].greatest(motion.far[1]) + slack;
        let local = self.local_edges(far, moved);
        for axis in 0..2 {
            let var = VarId::XY[axis];
            let [position, velocity, _] = &mut moved.vars[var];
            if self.slopes && axis == 0 {
                *position = position.or(&motion.from[axis].map(rounded));
            }
            let (Some(at), Some(free)) = (position.hull(), velocity.hull()) else { continue };
            let within = match motion.from[axis].hull().filter(|_| self.has_bounded_pushes) {
                // It did not overlap the obstacle before. If the obstacle was beside it along this axis, it is pushed
                // back at most to where it was. Otherwise it has entered along the other axis, and is pushed along this
                // one only where that is shorter.
                Some(from) => {
                    let across = far.least(motion.far[1 - axis] + slack);
                    let highest = (from.high + slack).greatest(at.high + across);
                    let lowest = (from.low - slack).least(at.low - across);
                    let (up, down) = (Interval { low: at.low, high: highest }, Interval { low: lowest, high: at.high });
                    [up, down].map(rounded)
                }
                None => {
                    let far = if self.has_bounded_pushes { far } else { self.longest[axis] };
                    [rounded(Interval { low: at.low - far, high: at.high + far }); 2]
                }
            };
            let edges = match &local {
                Some(edges) => edges,
                None if self.has_bounded_pushes => &self.faces,
                None => &self.edges,
            };
            let pushed = self.push(&edges[axis], within, position);
            if pushed == [None; 2] {
                continue;
            }
            let before = *velocity;
            if self.stops {
                *velocity = velocity.or(&Values::point(0.0));
            }
            for bounce in &self.bounces {
                let turned = |i: Interval| Interval { low: bounce.turned(i.high), high: bounce.turned(i.low) };
                *velocity = velocity.or(&before.map(turned));
            }
            moved.energy[var] = match moved.energy[var] {
                Some((fall, energy)) if !self.is_loose && self.stops && self.bounces.is_empty() => {
                    Some((fall, fall.pushed(energy, pushed, free)))
                }
                _ => None,
            };
        }
    }

    /// Where nearby static obstacles can push an instance, if it is distinguished by place.
    fn local_edges(&self, far: f64, at: &Configuration) -> Option<Edges> {
        if self.surfaces.is_empty() || !self.has_bounded_pushes {
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

    /// The intervals along an axis over which pushes can move an instance of a maximum speed, px/s: towards higher and
    /// towards lower coordinates. `None` if it can be moved anywhere.
    pub fn push_reach(&self, axis: usize, speed: [f64; 2], step: f64) -> Option<[Vec<Interval>; 2]> {
        if self.anywhere || self.slopes || self.carried[axis].is_some() || speed.iter().any(|s| !s.is_finite()) {
            return None;
        }
        if !self.is_pushed {
            return Some([Vec::new(), Vec::new()]);
        }
        // A body that enters along one axis is pushed out along the other where that is shorter. A body inside an
        // obstacle is pushed to its side.
        let far = match self.has_bounded_pushes {
            true => speed[0].greatest(speed[1]) * step + TOLERANCE + ROUNDING,
            false => self.longest[axis] + ROUNDING,
        };
        let [low, high] = if self.has_bounded_pushes { &self.faces[axis] } else { &self.edges[axis] };
        let up = low.iter().map(|e| Interval { low: e.low - far, high: e.high + ROUNDING }).collect();
        let down = high.iter().map(|e| Interval { low: e.low - ROUNDING, high: e.high + far }).collect();
        Some([up, down])
    }

    /// Adds the ends of pushes within two intervals to a position; returns their hulls, by the low and by the high
    /// side.
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

/// The edges, out of an ordered list, that overlap an interval.
fn between(edges: &[Interval], within: Interval) -> &[Interval] {
    let first = edges.partition_point(|e| e.high < within.low);
    let after = edges.partition_point(|e| e.low <= within.high);
    edges.get(first..after).unwrap_or_default()
}

fn contacts(scene: &Scene<'_>, me: usize, spaces: &BTreeSet<SpaceId>, summaries: &[KindSummary]) -> Contacts {
    let kind = &scene.kinds[me];
    let entity = &scene.program.entities[kind.entity];
    // Empty before the instance exists in any space.
    let statics: Vec<_> = spaces.iter().filter_map(|s| scene.statics(me, *s)).collect();
    let pairs = met(scene, me, spaces, summaries);
    let body = |pair: &Pair| (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
    let mut out = Contacts {
        longest: summaries[me].push,
        has_bounded_pushes: summaries[me].push_bound.is_some(),
        near: kind.near,
        near_statics: kind.near,
        kept_out: kind.kept_out_while(),
        surfaces: scene.surfaces[me].clone(),
        obstacles: obstacles(scene, me, &summaries[me]),
        ..Contacts::default()
    };
    for found in &statics {
        out.is_pushed |= found.pushes;
        out.stops |= found.stops;
        out.is_loose |= found.slips;
        out.bounces.extend(&found.bounces);
        out.anywhere |= found.anywhere;
        out.slopes |= found.slopes;
        out.is_loose |= found.slopes;
        for axis in 0..2 {
            for end in 0..2 {
                out.edges[axis][end].extend(&found.edges[axis][end]);
                out.faces[axis][end].extend(&found.faces[axis][end]);
            }
        }
    }
    if out.slopes {
        // What stands a little above the ground is kept on it, too.
        let wide = |i: Interval| Interval { low: i.low - 2.0 * TOLERANCE, high: i.high + 2.0 * TOLERANCE };
        out.near = out.near.map(|near| near.map(wide));
        out.near_statics = out.near;
    }
    let mut carried: [Vec<Interval>; 2] = [Vec::new(), Vec::new()];
    let mut is_moved_by_movers = false;
    for pair in pairs.iter().filter(|p| pushes(scene, me, p)) {
        let (mine, theirs) = body(pair);
        out.is_pushed = true;
        out.stops |= pair.meeting.response.stop;
        out.is_loose |= !pair.meeting.response.stop || !theirs.kinematic;
        out.bounces.extend(Some(pair.meeting.response.bounce).filter(|bounce| !bounce.is_none()));
        is_moved_by_movers |= !theirs.kinematic;
        let summary = &summaries[pair.kind];
        // It may have been pushed since it was on the carrier; a stationary instance carries nothing.
        let slack = [0, 1].map(|axis| summaries[me].push[axis] + summary.displacement[axis]);
        let slack = summary.stationary.is_none().then_some(slack);
        let contact = [0, 1].map(|axis| seam::seen(scene.world, spaces, axis, &summary.contact[axis]));
        pushed_by(&mut out, &mut carried, pair, (mine, theirs), &contact, slack);
    }
    for edges in out.edges.iter_mut().chain(&mut out.faces).flatten() {
        disjoin(edges);
    }
    let mut axis = 0;
    out.carried = carried.map(|c| {
        // Across a seam, nothing is known of where a carrier takes it.
        let is_free = seam::wraps(scene.world, spaces, std::mem::replace(&mut axis, 1));
        let places = if is_free { Values::all() } else { Values::any(c.iter().copied()) };
        (!c.is_empty()).then_some(places)
    });
    if out.anywhere {
        out.carried = out.carried.map(|c| c.map(|_| Values::all()));
    }
    let asked = |touch: &Touch| {
        let asks = |pair: &&&Pair| {
            let (mine, theirs) = body(pair);
            is_about(touch, mine, theirs)
        };
        pairs.iter().filter(asks).copied().collect::<Vec<&Pair>>()
    };
    // Positions at which it touches another instance.
    let others = |touch: &Touch| {
        let asked = asked(touch);
        [0, 1].map(|axis| {
            let moved = if out.is_pushed { summaries[me].push[axis] } else { 0.0 };
            Values::any(asked.iter().flat_map(|pair| {
                let (mine, theirs) = body(pair);
                let extent = theirs.extent.map_or(Interval::ALL, |e| e[axis]);
                let seen = seam::seen(scene.world, spaces, axis, &summaries[pair.kind].contact[axis]);
                let at = seen.intervals().to_vec().into_iter();
                at.map(move |at| met_from(mine, axis, at.plus(extent), moved))
            }))
        })
    };
    let places_of_others: Vec<[Values; 2]> = entity.touches.iter().map(others).collect();
    let places = |(id, touch): (TouchId, &Touch)| {
        let asked = asked(touch);
        let mut places = [0, 1].map(|axis| {
            // Contacts are detected before pushes.
            let moved = if out.is_pushed { summaries[me].push[axis] } else { 0.0 };
            let wide = |i: Interval, by: f64| rounded(Interval { low: i.low - by, high: i.high + by });
            let of_statics = statics.iter().filter_map(|s| s.places.get(id.index())).flat_map(|p| &p[axis]);
            let of_others = places_of_others[id.index()][axis];
            let all = of_statics.map(|place| wide(*place, moved)).chain(of_others.intervals().iter().copied());
            seam::wrapped(scene.world, spaces, axis, &Values::any(all))
        });
        let is_pushing = |p: &&Pair| pushes(scene, me, p);
        let by_all = statics.iter().all(|s| s.pushed.get(id.index()) == Some(&true)) && asked.iter().all(is_pushing);
        if let (Some(side), true) = (touch.side, by_all && !is_moved_by_movers && !out.anywhere && !out.slopes) {
            let (axis, end) = face(side);
            // A push to the other side may have won; nothing is pushed before the first step.
            let ends: Vec<Interval> = match out.has_bounded_pushes {
                true => out.faces[axis][end].clone(),
                false => out.edges[axis].iter().flatten().copied().collect(),
            };
            let first = kind.slots.iter().map(|s| &scene.world.slots[*s]).filter(|s| s.origin != Origin::Free);
            let first = first.map(|s| Interval::point(s.vars[VarId::XY[axis]][0]));
            let ends = seam::wrapped(scene.world, spaces, axis, &Values::any(ends.into_iter().chain(first)));
            places[axis] = places[axis].and(&ends);
        }
        places
    };
    out.places = entity.touches.pairs().map(places).collect();
    out.places_of_others = places_of_others;
    out
}

/// Whether a contact query is about a pair of bodies.
fn is_about(touch: &Touch, mine: &Body, theirs: &Body) -> bool {
    mine.tags.meets(touch.mine) && theirs.tags.meets(TagSet::of(touch.other))
}

/// The positions along an axis from which a body has met another one, if both were moved by at most some px since.
fn met_from(mine: &Body, axis: usize, theirs: Interval, moved: f64) -> Interval {
    let place = near(mine.extent, axis, (theirs.low, theirs.high));
    rounded(Interval { low: place.low - moved, high: place.high + moved })
}

/// The surfaces of stationary instances that push a kind, if it is distinguished by place.
fn obstacles(scene: &Scene<'_>, me: usize, summary: &KindSummary) -> Vec<(SpaceId, Surfaces)> {
    let kind = &scene.kinds[me];
    if scene.surfaces[me].is_empty() {
        return Vec::new();
    }
    let of = |(space, obstacles): (&SpaceId, &Vec<Obstacle>)| (*space, Surfaces::of(scene.world, kind, obstacles));
    summary.obstacles.iter().map(of).collect()
}

/// Adds where another body can push and carry a body.
fn pushed_by(
    out: &mut Contacts,
    carried: &mut [Vec<Interval>; 2],
    pair: &Pair,
    (mine, theirs): (&Body, &Body),
    contact: &[Values; 2],
    slack: Option<[f64; 2]>,
) {
    let (Some(extent), Some(other)) = (mine.extent, theirs.extent) else {
        out.anywhere = true;
        out.near = Some([Interval::ALL; 2]);
        return;
    };
    let mut reaches = [Interval::ALL; 2];
    for axis in 0..2 {
        let Some(at) = contact[axis].hull() else { continue };
        let reach = near(mine.extent, axis, (at.low + other[axis].low, at.high + other[axis].high));
        reaches[axis] = reach;
        for side in sides_of(pair.meeting).filter(|s| face(*s).0 == axis) {
            let end = face(side).1;
            // By its low and high edges, wherever it is; two movable bodies share the push.
            let edges: Vec<Interval> = match theirs.kinematic {
                false => vec![reach],
                true => {
                    let offset = match end {
                        0 => other[axis].high - extent[axis].low,
                        _ => other[axis].low - extent[axis].high,
                    };
                    let at = contact[axis].intervals().iter();
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

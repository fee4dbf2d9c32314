//! The collision phase for an instance whose configurations are told apart: what is pushed and what is not, and what is
//! pushed to each edge, are configurations of their own.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{Extremes, SlotId, Touch, VarId};

use crate::analysis::domain::configuration::{Configuration, Trace};
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::{Pair, ROUNDING, TOLERANCE, rounded};
use crate::analysis::geometry::grid::Grid;
use crate::analysis::geometry::scene::Scene;

use super::places::Places;
use super::{Contacts, Motion, Surroundings, is_about, is_near, met_from};

impl Surroundings {
    /// Whether only static obstacles push an instance, never further than it has moved.
    pub fn can_tell_apart(&self, slot: SlotId) -> bool {
        let contacts = self.of(slot);
        let is_carried = contacts.carried.iter().any(Option::is_some);
        contacts.has_bounded_pushes
            && !contacts.surfaces.is_empty()
            && !contacts.anywhere
            && !contacts.slopes
            && !is_carried
    }

    /// The kinds that contact queries of an instance can be about.
    pub fn asked_kinds(scene: &Scene<'_>, slot: SlotId) -> BTreeSet<usize> {
        let touches = &scene.program.entities[scene.world.slots[slot].entity].touches;
        touches.iter().flat_map(|touch| asked(scene, scene.of[slot], touch)).map(|pair| pair.kind).collect()
    }

    /// Where contacts of an instance with others can be, if these are told apart by place: for each of their kinds, all
    /// configurations after a step.
    pub fn tell_others(&mut self, scene: &Scene<'_>, slot: SlotId, others: &BTreeMap<usize, Vec<Configuration>>) {
        let touches = &scene.program.entities[scene.world.slots[slot].entity].touches;
        let me = scene.of[slot];
        let boxes = |touch: &Touch| {
            let mut places = Vec::new();
            for pair in asked(scene, me, touch) {
                let (mine, theirs) = (&scene.kinds[me].bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
                let all = others.get(&pair.kind)?;
                let (_, extent) = (mine.extent?, theirs.extent?);
                let first = scene.kinds[pair.kind].slots.first()?;
                let there = |at: &&Configuration| theirs.presence.as_ref().is_none_or(|p| p.is_there(&at.leaves));
                for at in all.iter().filter(there) {
                    // Contacts are detected before either is pushed.
                    let place = |axis: usize| {
                        let moved = self.of(slot).longest[axis] + self.of(*first).longest[axis];
                        let at = at.vars[VarId::XY[axis]][0].hull()?;
                        Some(met_from(mine, axis, at.plus(extent[axis]), moved))
                    };
                    let (x, y) = (place(0)?, place(1)?);
                    places.extend(at.spaces.iter().map(|space| (*space, [x, y])));
                }
            }
            Some(Places::new(places))
        };
        let boxes = touches.iter().map(boxes).collect();
        let contacts = self.of[slot];
        self.contacts[contacts].boxes_of_others = boxes;
    }

    /// The collision phase for an instance of which [`Surroundings::can_tell_apart`] holds. `moved` is the result of the
    /// continuous phase; `None` if it can be in several spaces.
    pub fn collide_apart(
        &self,
        slot: SlotId,
        motion: &Motion,
        moved: &Configuration,
        grids: &[Grid],
    ) -> Option<Vec<Configuration>> {
        let contacts = self.of(slot);
        let space = moved.spaces.first().filter(|_| moved.spaces.len() == 1)?;
        let grid = grids.iter().find(|grid| grid.space == *space)?;
        let contact = VarId::XY.map(|var| moved.vars[var][0]);
        if !contacts.is_pushed || !is_near(contacts.near, &contact) {
            let is_disturbed = moved.trace.is_none_or(|trace| trace.is_disturbed);
            let trace = Some(Trace { is_disturbed, pushed: [false; 2] });
            return Some(vec![Configuration { trace, ..moved.clone() }]);
        }
        let is_kept_out = self.is_kept_out(slot, &moved.leaves);
        let mut out = Vec::new();
        for x in contact[0].intervals() {
            for y in contact[1].intervals() {
                for (sides, _) in grid.parts([*x, *y]) {
                    let mut part = moved.clone();
                    place(&mut part, sides);
                    let is_free = |sides| !is_kept_out || grid.is_free(sides);
                    for pushed in contacts.pushed(motion, part, is_free) {
                        let (Some(x), Some(y)) = (pushed.vars[VarId::X][0].hull(), pushed.vars[VarId::Y][0].hull())
                        else {
                            continue;
                        };
                        for (sides, is_blocked) in grid.parts([x, y]) {
                            if !(is_blocked && is_kept_out) {
                                let mut part = pushed.clone();
                                place(&mut part, sides);
                                out.push(part);
                            }
                        }
                    }
                }
            }
        }
        Some(out)
    }
}

/// The pairs of bodies that a contact query is about.
fn asked<'s>(scene: &'s Scene<'_>, me: usize, touch: &Touch) -> Vec<&'s Pair> {
    let asks = |pair: &&Pair| {
        let (mine, theirs) = (&scene.kinds[me].bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        mine.is_live && theirs.is_live && is_about(touch, mine, theirs)
    };
    scene.pairs[me].iter().filter(asks).collect()
}

fn place(at: &mut Configuration, sides: [Interval; 2]) {
    for (var, side) in VarId::XY.into_iter().zip(sides) {
        at.set(var, 0, Values::from(side));
    }
}

/// The velocities towards higher and towards lower coordinates, px/s.
const UP: Interval = Interval { low: 0.0, high: f64::INFINITY };
const DOWN: Interval = Interval { low: f64::NEG_INFINITY, high: 0.0 };
/// Speed that is below what rounding can make of it, px/s.
const SLIGHT: f64 = 0.01;

/// A push along an axis.
struct Pushed {
    /// The side that is pushed.
    end: usize,
    /// Where it ends.
    edge: Interval,
    /// The positions along the other axis before it.
    across: Interval,
    /// The velocities after it.
    velocity: Values,
    /// Whether they are what they were before.
    keeps: bool,
}

impl Contacts {
    /// A part of a configuration, pushed to each edge that it may be pushed to, along one axis or both, and not pushed.
    /// `is_free` tells whether a box of positions has any outside of obstacles.
    fn pushed(
        &self,
        motion: &Motion,
        mut part: Configuration,
        is_free: impl Fn([Interval; 2]) -> bool,
    ) -> Vec<Configuration> {
        let slack = TOLERANCE + ROUNDING;
        let far = motion.far[0].greatest(motion.far[1]) + slack;
        let mut pushes: [Vec<Pushed>; 2] = [Vec::new(), Vec::new()];
        let hulls = VarId::XY.map(|var| part.vars[var][0].hull());
        let [Some(x), Some(y)] = hulls else { return Vec::new() };
        let at = [x, y];
        for axis in 0..2 {
            let var = VarId::XY[axis];
            let Some(from) = motion.from[axis].hull() else { return Vec::new() };
            // Where this part has come from, and how fast.
            let own = rounded(at[axis].minus(motion.by[axis]));
            let from = from.and(own).unwrap_or(from);
            if let (Some(step), Some(known)) = (motion.step[axis].filter(|_| axis == 1), part.vars[var][1].hull()) {
                let far = rounded(at[axis].minus(from));
                // What differs by rounding only is not worth telling apart.
                let low = Some(far.low / step).filter(|low| known.low + SLIGHT < *low);
                let high = Some(far.high / step).filter(|high| *high < known.high - SLIGHT);
                let cut = Interval { low: low.unwrap_or(known.low), high: high.unwrap_or(known.high) };
                part.set(var, 1, part.vars[var][1].within(cut));
            }
            // As in `Contacts::push_out`.
            let across = far.least(motion.far[1 - axis] + slack);
            let highest = (from.high + slack).greatest(at[axis].high + across);
            let lowest = (from.low - slack).least(at[axis].low - across);
            let (up, down) =
                (Interval { low: at[axis].low, high: highest }, Interval { low: lowest, high: at[axis].high });
            let within = [up, down].map(rounded);
            let velocity = part.vars[var][1];
            let met = self.pushes(far, axis, &part);
            let met: Vec<_> = met.into_iter().filter(|(end, edge, _)| within[*end].and(*edge).is_some()).collect();
            let stopped = |end: usize, is_touching: bool| {
                // Only what goes into a surface is stopped.
                let (away, into) = if end == 0 { (UP, DOWN) } else { (DOWN, UP) };
                // Where both sides touch something, each stops what goes into it, whichever pushes.
                let is_between = met.iter().any(|(other, ..)| *other != end);
                let turning = if is_between { velocity } else { velocity.within(into) };
                let may_turn = turning.hull().is_some_and(|hull| hull != Interval::point(0.0));
                let mut after = if self.stops && may_turn { Values::point(0.0) } else { Values::none() };
                for bounce in self.bounces.iter().filter(|_| may_turn) {
                    let turned = |i: Interval| Interval { low: bounce.turned(i.high), high: bounce.turned(i.low) };
                    after = after.or(&turning.map(turned));
                }
                // Nor is what only touches it.
                let keeps = is_touching || self.is_loose || !self.stops;
                [(after, false), (if keeps { velocity } else { velocity.within(away) }, true)]
            };
            for &(end, edge, across) in &met {
                let all = stopped(end, edge.and(at[axis]).is_some());
                let all = all.into_iter().filter(|(velocity, _)| !velocity.is_none());
                pushes[axis].extend(all.map(|(velocity, keeps)| Pushed { end, edge, across, velocity, keeps }));
            }
        }
        let mut out = Vec::new();
        let mut add = |x: Option<&Pushed>, y: Option<&Pushed>| {
            // Where it was before it was pushed along the other axis.
            let along = |mine: Option<&Pushed>, other: Option<&Pushed>, at: Interval| match (mine, other) {
                (Some(mine), _) => mine.edge,
                (None, Some(other)) => other.across,
                (None, None) => at,
            };
            let sides = [along(x, y, at[0]), along(y, x, at[1])];
            if !is_free(sides) {
                return;
            }
            let mut pushed = part.clone();
            place(&mut pushed, sides);
            let is_disturbed = part.trace.is_none_or(|trace| trace.is_disturbed);
            let mut trace = Trace { is_disturbed, pushed: [false; 2] };
            for (var, push) in VarId::XY.into_iter().zip([x, y]) {
                if let Some(push) = push {
                    pushed.set(var, 1, push.velocity);
                    if var == VarId::Y {
                        trace.pushed[push.end] = true;
                        trace.is_disturbed |= !push.keeps;
                    }
                }
            }
            pushed.trace = Some(trace);
            out.push(pushed);
        };
        add(None, None);
        let [across, up] = &pushes;
        across.iter().for_each(|x| add(Some(x), None));
        up.iter().for_each(|y| add(None, Some(y)));
        let near = |edge: Interval, across: Interval| {
            across.and(Interval { low: edge.low - far, high: edge.high + far }).is_some()
        };
        // Whether it is the same with the push along y alone.
        let is_same = |x: &Pushed, y: &Pushed| {
            let velocity = &part.vars[VarId::X][1];
            y.across.low <= x.edge.low && x.edge.high <= y.across.high && x.velocity.is_within(velocity)
        };
        for x in across {
            for y in up {
                if near(x.edge, y.across) && near(y.edge, x.across) && !is_same(x, y) {
                    add(Some(x), Some(y));
                }
            }
        }
        out
    }

    /// Where nearby static obstacles can push an instance along an axis; see `Surfaces::pushes`.
    fn pushes(&self, far: f64, axis: usize, at: &Configuration) -> Vec<(usize, Interval, Interval)> {
        let (Some(x), Some(y)) = (at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()) else { return Vec::new() };
        let surfaces = self.surfaces.iter().map(|(space, s)| (space, s.as_ref()));
        let all = surfaces.chain(self.obstacles.iter().map(|(space, s)| (space, s)));
        let here = all.filter(|(space, _)| at.spaces.contains(space));
        here.flat_map(|(_, surfaces)| surfaces.pushes([x, y], far, axis, &at.leaves)).collect()
    }
}

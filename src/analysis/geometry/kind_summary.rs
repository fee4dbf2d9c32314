//! The instances of a kind as others meet them: where they are, how far a step moves them, and whether pushes on them
//! are bounded because they are never deep inside an obstacle.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{Bounds, Extremes, IdVec, Origin, Push, SlotId, SpaceId, VarId};

use crate::analysis::domain::configuration::Overall;
use crate::analysis::domain::values::Values;
use crate::analysis::geometry::body::{Body, Kind, Pair, ROUNDING, TOLERANCE, along};
use crate::analysis::geometry::region::Obstacle;
use crate::analysis::geometry::scene::Scene;

/// A summary of all instances of a kind.
pub(in crate::analysis) struct KindSummary {
    /// Maximum number of instances.
    count: usize,
    spaces: BTreeSet<SpaceId>,
    /// Positions when contacts are detected, px.
    pub contact: [Values; 2],
    /// Maximum distance per step along an axis near static obstacles, px.
    pub near_step: f64,
    /// Maximum distance per step along each axis, including carriers; px.
    pub displacement: [f64; 2],
    /// Maximum length of a push, px, if it is bounded by the length of a step.
    pub push_bound: Option<f64>,
    /// Maximum length of a push along each axis, px.
    pub push: [f64; 2],
    /// All instances, if none ever moves or appears later.
    pub stationary: Option<Vec<Stationary>>,
    /// If pushes are bounded, the stationary instances that push those of the kind.
    pub obstacles: BTreeMap<SpaceId, Vec<Obstacle>>,
}

/// An instance that never moves.
pub(in crate::analysis) struct Stationary {
    space: SpaceId,
    at: [f64; 2],
    /// For each collider, whether it is always active.
    is_always_present: Vec<bool>,
}

/// Summarizes each kind; the result is incomplete if the scene's meter runs out.
pub(in crate::analysis) fn kind_summaries(scene: &mut Scene<'_>, slots: &IdVec<SlotId, Overall>) -> Vec<KindSummary> {
    let mut summaries: Vec<KindSummary> = scene.kinds.iter().map(|kind| KindSummary::new(scene, kind, slots)).collect();
    carry(scene, &mut summaries);
    for kind in 0..summaries.len() {
        if scene.meter.spend(scene.pairs[kind].len() as u64) {
            break;
        }
        let push_bound = push_bound(scene, kind, &summaries);
        summaries[kind].push = match &push_bound {
            Some((far, _)) => [*far; 2],
            None => longest(scene, kind, &summaries),
        };
        (summaries[kind].push_bound, summaries[kind].obstacles) =
            push_bound.map_or_else(Default::default, |(far, obstacles)| (Some(far), obstacles));
    }
    summaries
}

impl KindSummary {
    fn new(scene: &Scene<'_>, kind: &Kind, slots: &IdVec<SlotId, Overall>) -> KindSummary {
        let step = scene.world.step.seconds();
        let live = || kind.slots.iter().map(|s| &slots[*s]).filter(|o| o.can_live);
        let contact = |axis: usize| Values::any(live().flat_map(|o| o.contact[axis].intervals().to_vec()));
        let far = |axis: usize| live().map(|o| o.speed[axis]).fold(0.0, f64::greatest) * step;
        KindSummary {
            count: live().count(),
            spaces: live().flat_map(|o| o.spaces.iter().copied()).collect(),
            contact: [contact(0), contact(1)],
            near_step: live().flat_map(|o| o.near_speed).fold(0.0, f64::greatest) * step,
            displacement: [far(0), far(1)],
            push_bound: None,
            push: [0.0; 2],
            stationary: stationary(scene, kind, slots),
            obstacles: BTreeMap::new(),
        }
    }
}

/// The instances of a kind, if each stays at its initial position and never disappears and returns.
fn stationary(scene: &Scene<'_>, kind: &Kind, slots: &IdVec<SlotId, Overall>) -> Option<Vec<Stationary>> {
    let is_spawned = || scene.program.entities.iter().any(|e| e.spawns.iter().any(|s| s.entity == kind.entity));
    let live: Vec<SlotId> = kind.slots.iter().copied().filter(|s| slots[*s].can_live).collect();
    let comes = |s: &SlotId| match scene.world.slots[*s].origin {
        Origin::Named => false,
        Origin::Tile => is_spawned(),
        Origin::Free => true,
    };
    if kind.appears || live.iter().any(comes) {
        return None;
    }
    let of = |slot: SlotId| {
        let (overall, first) = (&slots[slot], &scene.world.slots[slot]);
        let is_at = |axis: usize| {
            let var = VarId::XY[axis];
            let at = Values::point(first.vars[var][0]);
            overall.contact[axis] == at && overall.vars[var][0] == at && overall.speed[axis] == 0.0
        };
        if !is_at(0) || !is_at(1) || overall.spaces.len() != 1 {
            return None;
        }
        let is_always_present = |body: &Body| {
            let is_away = body.presence.as_ref().is_none_or(|p| p.among(&overall.leaves).can_fail);
            !overall.can_be_absent && !is_away
        };
        Some(Stationary {
            space: *overall.spaces.first()?,
            at: [first.vars[VarId::X][0], first.vars[VarId::Y][0]],
            is_always_present: kind.bodies.iter().map(is_always_present).collect(),
        })
    };
    live.into_iter().map(of).collect()
}

/// The pairs of a kind that can touch in some spaces.
pub(in crate::analysis) fn met<'s>(
    scene: &'s Scene<'_>,
    me: usize,
    spaces: &BTreeSet<SpaceId>,
    summaries: &[KindSummary],
) -> Vec<&'s Pair> {
    let there = |pair: &&Pair| {
        let summary = &summaries[pair.kind];
        let (mine, theirs) = (&scene.kinds[me].bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        let can_meet = mine.is_live && theirs.is_live && summary.count > usize::from(pair.kind == me);
        can_meet && summary.spaces.iter().any(|s| spaces.contains(s))
    };
    scene.pairs[me].iter().filter(there).collect()
}

/// Whether a pair pushes the first of the two.
pub(in crate::analysis) fn pushes(scene: &Scene<'_>, me: usize, pair: &Pair) -> bool {
    pair.meeting.response.push != Push::Sense && !scene.kinds[me].bodies[pair.mine].kinematic
}

/// Adds the displacement of carriers, which may be carried themselves.
fn carry(scene: &Scene<'_>, summaries: &mut [KindSummary]) {
    let own: Vec<[f64; 2]> = summaries.iter().map(|c| c.displacement).collect();
    let rounds = summaries.len() + 1;
    for round in 0..=rounds {
        let mut changed = false;
        for me in 0..summaries.len() {
            if scene.meter.spend(scene.pairs[me].len() as u64) {
                return;
            }
            let carriers = met(scene, me, &summaries[me].spaces, summaries).into_iter();
            let carriers: Vec<usize> =
                carriers.filter(|p| p.meeting.response.carry && pushes(scene, me, p)).map(|p| p.kind).collect();
            for (axis, own) in own[me].iter().enumerate() {
                let most = carriers.iter().map(|c| summaries[*c].displacement[axis]).fold(0.0, f64::greatest);
                // A displacement that still grows after as many rounds as there are kinds is unbounded: the kind
                // carries itself.
                let sum = own + most;
                if sum > summaries[me].displacement[axis] {
                    summaries[me].displacement[axis] = if round == rounds { f64::INFINITY } else { sum };
                    changed = true;
                }
            }
        }
        if !changed {
            return;
        }
    }
}

/// Bound of a push, px, for instances that are never inside an obstacle when a step begins: a push is then no longer
/// than the step. Only static or stationary obstacles that are present from the start may push them; these must be
/// thicker than a step and must not leave gaps that are slightly too narrow. Returns the stationary obstacles as well.
fn push_bound(
    scene: &mut Scene<'_>,
    me: usize,
    summaries: &[KindSummary],
) -> Option<(f64, BTreeMap<SpaceId, Vec<Obstacle>>)> {
    let (kind, summary) = (&scene.kinds[me], &summaries[me]);
    let far = summary.near_step;
    // Whether regions hang together across a seam is not looked at.
    let wraps = summary.spaces.iter().any(|space| scene.world.spaces[*space].wraps());
    if wraps || kind.can_be_inside || !far.is_finite() || !scene.is_precise(me) {
        return None;
    }
    let is_thin = |thickness: f64| far + TOLERANCE + ROUNDING >= thickness;
    for found in summary.spaces.iter().filter_map(|s| scene.statics(me, *s)).filter(|s| s.pushes) {
        // A tile that is broken opens what is beside it, and one that comes back can come back around a body.
        if found.breaks || found.anywhere || found.thinnest.into_iter().any(is_thin) || !found.is_steady {
            return None;
        }
    }
    // A body no larger than a step can lie completely beside a face that a neighbour covers, and is then pushed to
    // another side by any distance.
    let mut pushed = kind.bodies.iter().filter(|b| b.is_pushed && b.is_live).map(Body::size);
    if pushed.any(|sizes| sizes.into_iter().any(is_thin)) {
        return None;
    }
    let obstacles = obstacles(scene, me, summaries)?;
    let is_put_inside = |(space, obstacles): (&SpaceId, &Vec<Obstacle>)| scene.is_inside_of(me, *space, obstacles);
    let sizes = obstacles.values().flatten().flat_map(|o| along(o.bounds)).map(|(low, high)| high - low);
    if sizes.into_iter().any(is_thin) || obstacles.iter().any(is_put_inside) {
        return None;
    }
    let spaces = summary.spaces.clone();
    let of = |space: &SpaceId| obstacles.get(space).map_or(&[][..], Vec::as_slice);
    let is_known = spaces.iter().all(|space| scene.region(me, *space, far, of(space)).is_some());
    is_known.then_some((far + TOLERANCE + ROUNDING, obstacles))
}

/// The colliders of stationary instances that push those of a kind; `None` if anything else pushes them.
fn obstacles(scene: &Scene<'_>, me: usize, summaries: &[KindSummary]) -> Option<BTreeMap<SpaceId, Vec<Obstacle>>> {
    let spaces = &summaries[me].spaces;
    let mut out: BTreeMap<SpaceId, Vec<Obstacle>> = BTreeMap::new();
    for pair in met(scene, me, spaces, summaries).into_iter().filter(|pair| pushes(scene, me, pair)) {
        let (mine, theirs) = (&scene.kinds[me].bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        let (stationary, extent) = (summaries[pair.kind].stationary.as_ref()?, theirs.extent?);
        if !theirs.kinematic || theirs.presence.is_none() || mine.presence.is_none() || mine.extent.is_none() {
            return None;
        }
        for instance in stationary.iter().filter(|s| spaces.contains(&s.space)) {
            let [x, y] = instance.at;
            let bounds = Bounds {
                left: x + extent[0].low,
                right: x + extent[0].high,
                bottom: y + extent[1].low,
                top: y + extent[1].high,
            };
            let obstacle =
                Obstacle { bounds, tags: theirs.tags, is_always_present: instance.is_always_present[pair.theirs] };
            let known = out.entry(instance.space).or_default();
            if !known.contains(&obstacle) {
                known.push(obstacle);
            }
        }
    }
    Some(out)
}

/// Maximum length of a push along each axis, px: it ends beside the obstacle.
fn longest(scene: &Scene<'_>, me: usize, summaries: &[KindSummary]) -> [f64; 2] {
    let (kind, summary) = (&scene.kinds[me], &summaries[me]);
    let mut longest = [0.0_f64; 2];
    for found in summary.spaces.iter().filter_map(|s| scene.statics(me, *s)) {
        for (longest, found) in longest.iter_mut().zip(found.longest) {
            *longest = longest.greatest(found);
        }
    }
    for pair in met(scene, me, &summary.spaces, summaries).into_iter().filter(|pair| pushes(scene, me, pair)) {
        let (mine, theirs) = (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        for (axis, longest) in longest.iter_mut().enumerate() {
            *longest = longest.greatest(mine.size()[axis] + theirs.size()[axis]);
        }
    }
    longest
}

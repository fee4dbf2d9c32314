//! What the instances of a kind are together, as those see them who meet them: where they are, how far they move, and
//! whether they are gentle, which is what most is known of: they are never deep inside of anything.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{Bounds, IdVec, Origin, Push, SlotId, SpaceId, VarId};

use crate::analysis::domain::configuration::Overall;
use crate::analysis::domain::values::Values;
use crate::analysis::geometry::body::{Body, Kind, Pair, ROUNDING, TOLERANCE, along};
use crate::analysis::geometry::region::Obstacle;
use crate::analysis::geometry::scene::Scene;

/// What is known of all instances of a kind.
pub(in crate::analysis) struct Crowd {
    /// How many there can be.
    count: usize,
    spaces: BTreeSet<SpaceId>,
    /// Where they are when contacts are found, px.
    pub contact: [Values; 2],
    /// How far a step takes them along an axis where there is something that never moves, px.
    pub near_step: f64,
    /// Of both axes, how far a step takes them, what carries them included; px.
    pub displacement: [f64; 2],
    /// How far a push can be, px, if it is gentle.
    pub gentle: Option<f64>,
    /// Of both axes, how far a push can be, px.
    pub push: [f64; 2],
    /// Each of them, if none ever moves or comes later.
    pub still: Option<Vec<Still>>,
    /// What never moves although it could, and pushes those of the kind, if they are gentle.
    pub obstacles: BTreeMap<SpaceId, Vec<Obstacle>>,
}

/// An instance that never moves.
pub(in crate::analysis) struct Still {
    space: SpaceId,
    at: [f64; 2],
    /// Of each collider, whether it is always there.
    is_sure: Vec<bool>,
}

/// What is known of the instances of each kind; not all of it if the scene's meter stops it.
pub(in crate::analysis) fn crowds(scene: &mut Scene<'_>, slots: &IdVec<SlotId, Overall>) -> Vec<Crowd> {
    let mut crowds: Vec<Crowd> = scene.kinds.iter().map(|kind| Crowd::new(scene, kind, slots)).collect();
    carry(scene, &mut crowds);
    for kind in 0..crowds.len() {
        if scene.meter.spend(scene.pairs[kind].len() as u64) {
            break;
        }
        let gentle = gentle(scene, kind, &crowds);
        crowds[kind].push = match &gentle {
            Some((far, _)) => [*far; 2],
            None => longest(scene, kind, &crowds),
        };
        (crowds[kind].gentle, crowds[kind].obstacles) =
            gentle.map_or_else(Default::default, |(far, obstacles)| (Some(far), obstacles));
    }
    crowds
}

impl Crowd {
    fn new(scene: &Scene<'_>, kind: &Kind, slots: &IdVec<SlotId, Overall>) -> Crowd {
        let step = scene.world.step.seconds();
        let live = || kind.slots.iter().map(|s| &slots[*s]).filter(|o| o.can_live);
        let contact = |axis: usize| Values::any(live().flat_map(|o| o.contact[axis].intervals().to_vec()));
        let far = |axis: usize| live().map(|o| o.speed[axis]).fold(0.0, f64::max) * step;
        Crowd {
            count: live().count(),
            spaces: live().flat_map(|o| o.spaces.iter().copied()).collect(),
            contact: [contact(0), contact(1)],
            near_step: live().flat_map(|o| o.near_speed).fold(0.0, f64::max) * step,
            displacement: [far(0), far(1)],
            gentle: None,
            push: [0.0; 2],
            still: still(scene, kind, slots),
            obstacles: BTreeMap::new(),
        }
    }
}

/// The instances of a kind, if each is always where it was at first, and never gone and back.
fn still(scene: &Scene<'_>, kind: &Kind, slots: &IdVec<SlotId, Overall>) -> Option<Vec<Still>> {
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
        let is_sure = |body: &Body| {
            let is_away = body.presence.as_ref().is_none_or(|p| p.among(&overall.leaves).can_fail);
            !overall.can_be_absent && !is_away
        };
        Some(Still {
            space: *overall.spaces.first()?,
            at: [first.vars[VarId::X][0], first.vars[VarId::Y][0]],
            is_sure: kind.bodies.iter().map(is_sure).collect(),
        })
    };
    live.into_iter().map(of).collect()
}

/// Those of what a kind meets that can be there, in some spaces.
pub(in crate::analysis) fn met<'s>(
    scene: &'s Scene<'_>,
    me: usize,
    spaces: &BTreeSet<SpaceId>,
    crowds: &[Crowd],
) -> Vec<&'s Pair> {
    let there = |pair: &&Pair| {
        let crowd = &crowds[pair.kind];
        let (mine, theirs) = (&scene.kinds[me].bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        let can_meet = mine.is_live && theirs.is_live && crowd.count > usize::from(pair.kind == me);
        can_meet && crowd.spaces.iter().any(|s| spaces.contains(s))
    };
    scene.pairs[me].iter().filter(there).collect()
}

/// Whether a pair pushes the first of the two.
pub(in crate::analysis) fn pushes(scene: &Scene<'_>, me: usize, pair: &Pair) -> bool {
    pair.meeting.response.push != Push::Sense && !scene.kinds[me].bodies[pair.mine].kinematic
}

/// Adds to what a step moves those that are carried how far it moves what carries them, which may be carried itself.
fn carry(scene: &Scene<'_>, crowds: &mut [Crowd]) {
    let own: Vec<[f64; 2]> = crowds.iter().map(|c| c.displacement).collect();
    let rounds = crowds.len() + 1;
    for round in 0..=rounds {
        let mut changed = false;
        for me in 0..crowds.len() {
            if scene.meter.spend(scene.pairs[me].len() as u64) {
                return;
            }
            let carriers = met(scene, me, &crowds[me].spaces, crowds).into_iter();
            let carriers: Vec<usize> =
                carriers.filter(|p| p.meeting.response.carry && pushes(scene, me, p)).map(|p| p.kind).collect();
            for (axis, own) in own[me].iter().enumerate() {
                let most = carriers.iter().map(|c| crowds[*c].displacement[axis]).fold(0.0, f64::max);
                // What still grows after as many rounds as there are kinds carries itself.
                let sum = own + most;
                if sum > crowds[me].displacement[axis] {
                    crowds[me].displacement[axis] = if round == rounds { f64::INFINITY } else { sum };
                    changed = true;
                }
            }
        }
        if !changed {
            return;
        }
    }
}

/// How far a push can take instances of a kind, px, if they are never inside of what pushes them when a step begins: a
/// push is then no longer than the step was. Nothing may push them but what never moves and does not come later, which must
/// be thicker than a step, and leave no gaps that are a little too narrow. And what of it are instances.
fn gentle(scene: &mut Scene<'_>, me: usize, crowds: &[Crowd]) -> Option<(f64, BTreeMap<SpaceId, Vec<Obstacle>>)> {
    let (kind, crowd) = (&scene.kinds[me], &crowds[me]);
    let far = crowd.near_step;
    if kind.jumps || !far.is_finite() || !scene.is_precise(me) {
        return None;
    }
    let is_thin = |thickness: f64| far + TOLERANCE + ROUNDING >= thickness;
    for found in crowd.spaces.iter().filter_map(|s| scene.statics(me, *s)).filter(|s| s.pushes) {
        if found.anywhere || found.thinnest.into_iter().any(is_thin) || !found.is_steady {
            return None;
        }
    }
    // Who is no larger than a step can lie as a whole beside the part of a face that a neighbour covers: the push goes to
    // another side then, however far that is.
    let mut pushed = kind.bodies.iter().filter(|b| b.is_pushed && b.is_live).map(Body::size);
    if pushed.any(|sizes| sizes.into_iter().any(is_thin)) {
        return None;
    }
    let obstacles = obstacles(scene, me, crowds)?;
    let is_put_inside = |(space, obstacles): (&SpaceId, &Vec<Obstacle>)| scene.is_inside_of(me, *space, obstacles);
    let sizes = obstacles.values().flatten().flat_map(|o| along(o.bounds)).map(|(low, high)| high - low);
    if sizes.into_iter().any(is_thin) || obstacles.iter().any(is_put_inside) {
        return None;
    }
    let spaces = crowd.spaces.clone();
    let of = |space: &SpaceId| obstacles.get(space).map_or(&[][..], Vec::as_slice);
    let is_known = spaces.iter().all(|space| scene.region(me, *space, far, of(space)).is_some());
    is_known.then_some((far + TOLERANCE + ROUNDING, obstacles))
}

/// The colliders of instances that push those of a kind, if those instances never move; none if something else does.
fn obstacles(scene: &Scene<'_>, me: usize, crowds: &[Crowd]) -> Option<BTreeMap<SpaceId, Vec<Obstacle>>> {
    let spaces = &crowds[me].spaces;
    let mut out: BTreeMap<SpaceId, Vec<Obstacle>> = BTreeMap::new();
    for pair in met(scene, me, spaces, crowds).into_iter().filter(|pair| pushes(scene, me, pair)) {
        let (mine, theirs) = (&scene.kinds[me].bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        let (still, extent) = (crowds[pair.kind].still.as_ref()?, theirs.extent?);
        if !theirs.kinematic || theirs.presence.is_none() || mine.presence.is_none() || mine.extent.is_none() {
            return None;
        }
        for instance in still.iter().filter(|s| spaces.contains(&s.space)) {
            let [x, y] = instance.at;
            let bounds = Bounds {
                left: x + extent[0].low,
                right: x + extent[0].high,
                bottom: y + extent[1].low,
                top: y + extent[1].high,
            };
            let obstacle = Obstacle { bounds, tags: theirs.tags, is_sure: instance.is_sure[pair.theirs] };
            let known = out.entry(instance.space).or_default();
            if !known.contains(&obstacle) {
                known.push(obstacle);
            }
        }
    }
    Some(out)
}

/// Of both axes, how far a push can be, px: it ends beside what pushes.
fn longest(scene: &Scene<'_>, me: usize, crowds: &[Crowd]) -> [f64; 2] {
    let (kind, crowd) = (&scene.kinds[me], &crowds[me]);
    let mut longest = [0.0_f64; 2];
    for found in crowd.spaces.iter().filter_map(|s| scene.statics(me, *s)) {
        for (longest, found) in longest.iter_mut().zip(found.longest) {
            *longest = longest.max(found);
        }
    }
    for pair in met(scene, me, &crowd.spaces, crowds).into_iter().filter(|pair| pushes(scene, me, pair)) {
        let (mine, theirs) = (&kind.bodies[pair.mine], &scene.kinds[pair.kind].bodies[pair.theirs]);
        for (axis, longest) in longest.iter_mut().enumerate() {
            *longest = longest.max(mine.size()[axis] + theirs.size()[axis]);
        }
    }
    longest
}

//! Records a run for a picture while it is simulated. The record stays small: standing still costs nothing, and a very
//! long way is kept at larger and larger distances.

use crate::ir::{Extremes, SlotId, Space, VarId};
use crate::ordered::Ordered;
use crate::sim::{Input, Instance, PlayerInput, Simulator};

use super::track::{Mark, Part, Pose, Run, Stop, Track};

/// Number of stops, and of shapes, of a way at which every second one is left out.
const MAX_STOPS: usize = 60_000;
const MAX_POSES: usize = 4_000;
/// Minimum distance of two stops once a way is thinned, px.
const FIRST_GAP: f64 = 0.25;
/// A change of a collider's size that shows, px.
const SIZE_CHANGE: f64 = 1.5;

/// Records the states of a run.
pub struct Recorder<'s> {
    sim: &'s Simulator,
    run: Run,
    /// For each slot, what is known of the life that goes on.
    open: Vec<Option<Open>>,
    /// The last inputs.
    inputs: Option<Vec<PlayerInput>>,
}

/// A life that goes on.
struct Open {
    /// Its index among the tracks.
    track: usize,
    /// The step before.
    last: Stop,
    speed: f64,
    /// Minimum distances of stops and of shapes, px.
    gap: f64,
    pose_gap: f64,
}

impl<'s> Recorder<'s> {
    /// Before the first state.
    pub fn new(sim: &'s Simulator) -> Recorder<'s> {
        let open = sim.world().slots.iter().map(|_| None).collect();
        Recorder { sim, run: Run::default(), open, inputs: None }
    }

    /// Records a state: the first one, with step 0, and then the one after each step, with the step's input.
    pub fn observe(&mut self, step: u64, input: &Input, state: &[u8]) {
        let world = self.sim.world();
        let moves = world.slots.ids().filter(|slot| world.layout.slots[*slot].rest.is_none());
        for slot in moves {
            let instance = self.sim.instance(state, slot);
            if instance.is_alive() {
                let changes = step > 0 && self.changes(slot, input);
                self.observe_instance(step, changes, instance);
            } else if let Some(open) = self.open[slot.0 as usize].take() {
                let track = &mut self.run.tracks[open.track];
                end(track, open.last);
                track.is_destroyed = true;
            }
        }
        if step > 0 {
            self.inputs = Some(input.0.to_vec());
        }
    }

    /// Whether the inputs of the player of a slot differ from the last ones; the first ones do not.
    fn changes(&self, slot: SlotId, input: &Input) -> bool {
        let player = self.sim.world().slots[slot].player;
        player
            .zip(self.inputs.as_ref())
            .is_some_and(|(player, last)| last.get(player.0 as usize).is_some_and(|last| *last != input.of(player)))
    }

    fn observe_instance(&mut self, step: u64, changes: bool, instance: Instance<'_>) {
        let (x, y) = instance.position();
        let mut stop = Stop { step, space: instance.space(), at: [x, y], changes, jumps: false };
        let speed = VarId::XY.iter().map(|&var| instance.var(var, 1).abs()).sum::<f64>();
        let slot = instance.slot();
        let Some(open) = &mut self.open[slot.0 as usize] else {
            self.open[slot.0 as usize] =
                Some(Open { track: self.run.tracks.len(), last: stop, speed, gap: 0.0, pose_gap: 1.0 });
            let poses = vec![pose(instance)];
            self.run.tracks.push(Track { slot, stops: vec![stop], poses, is_destroyed: false });
            return;
        };
        let track = &mut self.run.tracks[open.track];
        let moved = distance(&self.sim.world().spaces[stop.space], open.last.at, stop.at);
        let allowed = 2.0 * self.sim.world().step.seconds() * open.speed.greatest(speed);
        stop.jumps = open.last.space != stop.space || (moved > allowed && moved > allowed + size(&parts(instance)));
        if stop.jumps {
            end(track, open.last);
        }
        let known = track.stops.last().map_or(f64::INFINITY, |last| far(last.at, stop.at));
        if stop.jumps || changes || (known > 0.0 && known >= open.gap) {
            track.stops.push(stop);
        }
        if stop.jumps || track.poses.last().is_none_or(|last| differs(last, open.pose_gap, instance)) {
            track.poses.push(pose(instance));
        }
        if track.stops.len() > MAX_STOPS {
            open.gap = (2.0 * open.gap).greatest(FIRST_GAP);
            thin(&mut track.stops, |stop| stop.jumps);
        }
        if track.poses.len() > MAX_POSES {
            open.pose_gap *= 2.0;
            thin(&mut track.poses, |_| false);
        }
        (open.last, open.speed) = (stop, speed);
    }

    /// The run; `marks` are what became true in it, in any order. `state` is the last state.
    pub fn finish(mut self, state: &[u8], mut marks: Vec<Mark>) -> Run {
        for (slot, open) in self.sim.world().slots.ids().zip(&self.open) {
            let Some(open) = open else { continue };
            let track = &mut self.run.tracks[open.track];
            end(track, open.last);
            let last = pose(self.sim.instance(state, slot));
            if track.poses.last() != Some(&last) {
                track.poses.push(last);
            }
        }
        let world = self.sim.world();
        self.run.tracks.retain(|track| world.slots[track.slot].player.is_some() || track.stops.len() > 1);
        marks.order_by_key(|mark| mark.step);
        Run { marks, ..self.run }
    }
}

/// Ends a way, or a part of it before a jump, at its true end.
fn end(track: &mut Track, last: Stop) {
    if track.stops.last().is_some_and(|stop| stop.space == last.space && stop.at != last.at) {
        track.stops.push(Stop { jumps: false, changes: false, ..last });
    }
}

/// Leaves out every second entry that need not be kept.
fn thin<T>(entries: &mut Vec<T>, keep: impl Fn(&T) -> bool) {
    let mut index = 0;
    entries.retain(|entry| {
        index += 1;
        index % 2 == 1 || keep(entry)
    });
}

fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

fn parts(instance: Instance<'_>) -> Vec<Part> {
    let colliders = &instance.entity().colliders;
    let part = |(id, bounds)| {
        let collider = &colliders[id];
        Part { bounds, round: collider.shape.is_round(), tags: collider.tags }
    };
    instance.colliders().map(part).collect()
}

fn pose(instance: Instance<'_>) -> Pose {
    let (x, y) = instance.position();
    Pose { space: instance.space(), at: [x, y], parts: parts(instance) }
}

/// The longest side of all colliders.
fn size(parts: &[Part]) -> f64 {
    let sides =
        parts.iter().map(|part| (part.bounds.right - part.bounds.left).greatest(part.bounds.top - part.bounds.bottom));
    sides.fold(0.0, f64::greatest)
}

/// Whether an instance has moved by its own size times a factor since a pose, or has another shape.
fn differs(last: &Pose, factor: f64, instance: Instance<'_>) -> bool {
    let (x, y) = instance.position();
    let (moved, own) = (far(last.at, [x, y]), size(&last.parts));
    if moved >= factor * own.greatest(1.0) || last.space != instance.space() {
        return true;
    }
    let now = parts(instance);
    let count = now.len() != last.parts.len();
    let sizes = last.parts.iter().zip(&now).any(|(a, b)| {
        let side = |p: &Part| [p.bounds.right - p.bounds.left, p.bounds.top - p.bounds.bottom];
        side(a).iter().zip(side(b)).any(|(a, b)| (a - b).abs() > SIZE_CHANGE)
    });
    count || (sizes && moved >= 0.25 * factor * own)
}

/// The distance of two places of one space, across its seams if that is shorter.
fn distance(space: &Space, a: [f64; 2], b: [f64; 2]) -> f64 {
    let way = |axis: usize| {
        let way = b[axis] - a[axis];
        space.periods[axis].map_or(way, |period| period.shortest(way))
    };
    libm::hypot(way(0), way(1))
}

#[cfg(test)]
mod tests {
    use crate::ir::SpaceId;

    use super::*;

    #[test]
    fn long_ways_are_thinned_between_jumps() {
        let stop = |step| Stop { step, space: SpaceId(0), at: [step as f64, 0.0], changes: false, jumps: step == 5 };
        let mut stops: Vec<Stop> = (0..8).map(stop).collect();
        thin(&mut stops, |stop| stop.jumps);
        assert_eq!(stops.iter().map(|stop| stop.step).collect::<Vec<_>>(), [0, 2, 4, 5, 6]);
    }
}

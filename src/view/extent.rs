//! What part of a space is shown: its level, and around it as much of what happened as does not make the level small.

use crate::ir::{Bounds, Origin, Program, SpaceId, World};

use super::body::{Body, placed, position};
use super::frame::{grown, is_proper, joined, shared};

/// How many of the visited points are asked where most of them are.
const SAMPLE: usize = 20_000;
/// What is shown of a space without anything.
const SIDE: f64 = 64.0;

/// What has been in a space.
#[derive(Debug, Clone, Default)]
pub(super) struct Presence {
    /// How often.
    pub visits: usize,
    /// Where nearly all visits were.
    pub visited: Option<Bounds>,
    /// Where the path is.
    pub path: Option<Bounds>,
}

impl Presence {
    /// From visited points and points of the path.
    pub fn new(points: impl Iterator<Item = [f64; 2]> + Clone, path: impl Iterator<Item = [f64; 2]>) -> Presence {
        let finite = |point: &[f64; 2]| point.iter().all(|x| x.is_finite());
        let visits = points.clone().count();
        let sample = points.filter(finite).step_by(visits.div_ceil(SAMPLE).max(1));
        let (mut xs, mut ys): (Vec<f64>, Vec<f64>) = sample.map(|[x, y]| (x, y)).unzip();
        let range = |values: &mut Vec<f64>| {
            values.sort_unstable_by(f64::total_cmp);
            let few = values.len() / 400;
            Some((*values.get(few)?, *values.get(values.len() - 1 - few)?))
        };
        let visited = range(&mut xs).zip(range(&mut ys)).map(|((left, right), (bottom, top))| Bounds {
            left,
            right,
            bottom,
            top,
        });
        let path = path.filter(finite).map(|[x, y]| Bounds::new([x, y, 0.0, 0.0])).reduce(joined);
        Presence { visits, visited, path }
    }
}

/// The part of a space that is shown; `body` is the size of the player.
pub(super) fn extent(program: &Program, world: &World, id: SpaceId, presence: &Presence, body: f64) -> Bounds {
    let space = &world.spaces[id];
    let map = space.map_rectangle();
    let solids = space.solids.iter().map(|solid| solid.bounds).chain(space.links.iter().map(|link| link.from));
    let level = map.into_iter().chain(solids).filter(|b| is_proper(*b)).reduce(joined);
    let things = world.slots.pairs().filter(|(_, slot)| slot.origin != Origin::Free && slot.space == id);
    let things = things.flat_map(|(of, slot)| {
        let at = position(slot);
        let parts = Body::new(program, world, of).parts;
        let boxes: Vec<Bounds> = parts.iter().map(|part| placed(part, slot)).collect();
        boxes.into_iter().chain([Bounds::new([at[0], at[1], 0.0, 0.0])])
    });
    let things = things.filter(|b| is_proper(*b)).reduce(joined);
    let presence = [presence.visited.map(|b| (b, 0.5)), presence.path.map(|b| (b, 1.0)), things.map(|b| (b, 1.0))];
    let view = match level {
        // What is outside of the level is shown only as far as the level stays the main thing.
        Some(level) => presence.into_iter().flatten().fold(level, |view, (part, share)| {
            let room = share * shorter(level);
            let inside = shared(grown(part, body / 2.0), grown(level, room));
            if is_proper(inside) { joined(view, inside) } else { view }
        }),
        None => {
            let content = presence.into_iter().flatten().map(|(part, _)| part).reduce(joined);
            let bounds = space.bounds.filter(|b| is_proper(*b));
            match (content, bounds) {
                (Some(content), Some(bounds)) => {
                    joined(content, shared(bounds, grown(content, longer(content).max(SIDE))))
                }
                (content, bounds) => content.or(bounds).unwrap_or(Bounds::new([0.0; 4])),
            }
        }
    };
    let margin = if map == Some(view) { 0.0 } else { (0.02 * longer(view)).max(body / 4.0) };
    let view = grown(view, margin);
    let missing = |low: f64, high: f64| ((SIDE - (high - low)) / 2.0).max(0.0);
    let (x, y) = (missing(view.left, view.right), missing(view.bottom, view.top));
    Bounds { left: view.left - x, right: view.right + x, bottom: view.bottom - y, top: view.top + y }
}

fn longer(b: Bounds) -> f64 {
    (b.right - b.left).max(b.top - b.bottom)
}

fn shorter(b: Bounds) -> f64 {
    (b.right - b.left).min(b.top - b.bottom)
}

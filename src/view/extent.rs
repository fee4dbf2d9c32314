//! The visible part of a space: its level, and as much of the activity around it as does not make the level small.

use crate::ir::{Bounds, Extremes, Origin, Program, SpaceId, World};

use super::body::{Body, placed, position};
use super::frame::{grown, is_proper, shared};

/// Number of sampled visits from which the extent of most visits is estimated.
const SAMPLE: usize = 20_000;
/// Size of the visible part of an empty space.
const SIDE: f64 = 64.0;

/// The visits of a search and its path in a space.
#[derive(Debug, Clone, Default)]
pub(super) struct Visits {
    /// The number of visits.
    pub count: usize,
    /// The bounds of nearly all visits.
    pub visited: Option<Bounds>,
    /// The bounds of the path.
    pub path: Option<Bounds>,
}

impl Visits {
    /// From visited points and points of the path.
    pub fn new(points: impl Iterator<Item = [f64; 2]> + Clone, path: impl Iterator<Item = [f64; 2]>) -> Visits {
        let finite = |point: &[f64; 2]| point.iter().all(|x| x.is_finite());
        let count = points.clone().count();
        let sample = points.filter(finite).step_by(count.div_ceil(SAMPLE).max(1));
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
        let path = path.filter(finite).map(|[x, y]| Bounds::new([x, y, 0.0, 0.0])).reduce(Bounds::join);
        Visits { count, visited, path }
    }
}

/// The visible part of a space with a margin; `body` is the size of the player.
pub(super) fn extent(program: &Program, world: &World, id: SpaceId, visits: &Visits, body: f64) -> Bounds {
    let view = content(program, world, id, visits, body);
    let is_map = world.spaces[id].map_rectangle() == Some(view);
    at_least(grown(view, if is_map { 0.0 } else { (0.02 * longer(view)).greatest(body / 4.0) }), SIDE)
}

/// The part of a space with something to see; `body` is the size of the player.
pub(super) fn content(program: &Program, world: &World, id: SpaceId, visits: &Visits, body: f64) -> Bounds {
    let space = &world.spaces[id];
    let map = space.map_rectangle();
    let solids = space.solids.iter().map(|solid| solid.bounds).chain(space.links.iter().map(|link| link.from));
    let level = map.into_iter().chain(solids).filter(|b| is_proper(*b)).reduce(Bounds::join);
    let things = world.slots.pairs().filter(|(_, slot)| slot.origin != Origin::Free && slot.space == id);
    let things = things.flat_map(|(of, slot)| {
        let at = position(slot);
        let parts = Body::new(program, world, of).parts;
        let boxes: Vec<Bounds> = parts.iter().map(|part| placed(part, slot)).collect();
        boxes.into_iter().chain([Bounds::new([at[0], at[1], 0.0, 0.0])])
    });
    let things = things.filter(|b| is_proper(*b)).reduce(Bounds::join);
    let parts = [visits.visited.map(|b| (b, 0.5)), visits.path.map(|b| (b, 1.0)), things.map(|b| (b, 1.0))];
    match level {
        // Activity outside of the level is shown only while the level dominates the picture.
        Some(level) => parts.into_iter().flatten().fold(level, |view, (part, share)| {
            // Without a map, a level may be no more than a floor.
            let room = share * if map.is_some() { shorter(level) } else { longer(level) };
            let inside = shared(grown(part, body / 2.0), grown(level, room));
            if is_proper(inside) { view.join(inside) } else { view }
        }),
        None => {
            let content = parts.into_iter().flatten().map(|(part, _)| part).reduce(Bounds::join);
            let bounds = space.bounds.filter(|b| is_proper(*b));
            match (content, bounds) {
                (Some(content), Some(bounds)) => {
                    content.join(shared(bounds, grown(content, longer(content).greatest(SIDE))))
                }
                (content, bounds) => content.or(bounds).unwrap_or(Bounds::new([0.0; 4])),
            }
        }
    }
}

/// A rectangle with sides of a minimum length.
fn at_least(view: Bounds, side: f64) -> Bounds {
    let missing = |low: f64, high: f64| ((side - (high - low)) / 2.0).greatest(0.0);
    let (x, y) = (missing(view.left, view.right), missing(view.bottom, view.top));
    Bounds { left: view.left - x, right: view.right + x, bottom: view.bottom - y, top: view.top + y }
}

fn longer(b: Bounds) -> f64 {
    (b.right - b.left).greatest(b.top - b.bottom)
}

fn shorter(b: Bounds) -> f64 {
    (b.right - b.left).least(b.top - b.bottom)
}

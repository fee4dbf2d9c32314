//! A k-d tree over a fixed range of points (Bentley, *Multidimensional Binary Search Trees Used for Associative
//! Searching*, 1975), built by `kiddo`. The tree only proposes candidates: its distances are rounded differently, so
//! every candidate within a small tolerance of the best is measured again.

use std::fmt::Debug;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::linear::{Best, Linear, Query};
use crate::ir::Extremes;

/// Maximum number of varying coordinates; above it, a tree visits nearly all points.
pub(super) const MAX_AXES: usize = 12;
/// Numbers of nearest places to request in turn, if all before were removed or refused.
const CANDIDATES: [NonZeroUsize; 2] = [NonZeroUsize::MIN.saturating_add(7), NonZeroUsize::MIN.saturating_add(63)];
/// The end of a linked list.
const NONE: u32 = u32::MAX;

/// A point of the tree: its place, and the next point at the same place.
#[derive(Debug, Clone, Copy)]
struct Member {
    place: u32,
    next: u32,
}

/// The points of a range of slots.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    slots: Range<usize>,
    /// The varying coordinates; the tree contains only these.
    axes: Vec<usize>,
    /// The constant coordinates, with their values.
    fixed: Vec<(usize, f32)>,
    index: Arc<dyn StaticTree>,
    /// For each place, the lowest live slot.
    places: Vec<u32>,
    /// For each slot.
    members: Vec<Member>,
    removed: usize,
}

/// The coordinates that vary over a range of live points.
pub(super) fn varying(points: &Linear, slots: Range<usize>) -> Vec<usize> {
    let mut rest = slots.clone();
    let Some(first) = rest.next() else {
        return Vec::new();
    };
    let varies = |&row: &usize| rest.clone().any(|slot| points.value(slot, row) != points.value(first, row));
    (0..points.reals()).filter(varies).collect()
}

impl Tree {
    /// Approximate memory use, bytes: each place has its coordinates and a number.
    pub fn bytes(&self) -> usize {
        let place = (self.axes.len() + 2) * size_of::<f32>();
        self.members.capacity() * size_of::<Member>() + self.places.capacity() * (size_of::<u32>() + place)
    }

    /// Builds a tree over a range of live points and its varying coordinates.
    pub fn build(points: &Linear, slots: Range<usize>, axes: Vec<usize>) -> Option<Tree> {
        let fixed = (0..points.reals()).filter(|row| !axes.contains(row));
        let fixed = fixed.map(|row| (row, points.value(slots.start, row))).collect();
        let mut members = vec![Member { place: 0, next: NONE }; slots.len()];
        let places = gather(points, &slots, &axes, &mut members);
        let index = build(points, &axes, &places)?;
        Some(Tree { slots, axes, fixed, index, places, members, removed: 0 })
    }

    /// The slots that it covers.
    pub fn slots(&self) -> Range<usize> {
        self.slots.clone()
    }

    /// Updates the tree after one of its points was removed; returns whether most of them are removed.
    pub fn after_remove(&mut self, points: &Linear, slot: usize) -> bool {
        let place = &mut self.places[self.members[slot - self.slots.start].place as usize];
        while *place != NONE && !points.is_live(*place as usize) {
            *place = self.members[*place as usize - self.slots.start].next;
        }
        self.removed += 1;
        2 * self.removed > self.slots.len()
    }

    /// Searches for a nearer accepted point.
    pub fn search(&self, points: &Linear, query: &Query<'_>, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        let search = Search { tree: self, points, reach: Reach::new(self, query), query };
        search.run(best, accept);
        best.searched += self.slots.len();
    }
}

/// Groups points with equal coordinates into places, in the order of their slots.
fn gather(points: &Linear, slots: &Range<usize>, axes: &[usize], members: &mut [Member]) -> Vec<u32> {
    let key = |slot: usize| {
        let mix = |key: u64, &axis: &usize| {
            let bits = u64::from(points.value(slot, axis).to_bits());
            (key ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
        };
        axes.iter().fold(0, mix)
    };
    let mut keys: Vec<(u64, u32)> = slots.clone().map(|slot| (key(slot), slot as u32)).collect();
    keys.sort_unstable();
    let mut places = Vec::new();
    for alike in keys.chunk_by(|a, b| a.0 == b.0) {
        let mut before = NONE;
        for &(_, slot) in alike {
            let same = before != NONE
                && axes.iter().all(|&axis| points.value(before as usize, axis) == points.value(slot as usize, axis));
            if same {
                members[before as usize - slots.start].next = slot;
            } else {
                places.push(slot);
            }
            members[slot as usize - slots.start].place = places.len() as u32 - 1;
            before = slot;
        }
    }
    places
}

/// The distance in the tree up to which a point can be the nearest.
struct Reach {
    /// The squared distance that all points of the tree have in other coordinates.
    outside: f64,
    /// Relative tolerance between two sums of the same squares: more than the rounding errors of both sums and of the
    /// tree's bounds, which change at every level.
    slack: f64,
}

impl Reach {
    fn new(tree: &Tree, query: &Query<'_>) -> Self {
        let square = |d: f32| f64::from(d * d);
        let fixed = tree.fixed.iter().map(|&(row, value)| square(value - query.reals[row]));
        let modes = query.differing as f64 * f64::from(query.penalty);
        let terms = (query.reals.len() + query.differing + 64) as f64;
        Reach { outside: fixed.sum::<f64>() + modes, slack: 2.0 * terms * f64::from(f32::EPSILON) }
    }

    /// `None` if no point of the tree can be the nearest.
    fn radius(&self, best: &Best) -> Option<f32> {
        let within = f64::from(best.distance) * (1.0 + self.slack) - self.outside;
        (within >= 0.0).then(|| ((within * (1.0 + self.slack)) as f32).least(f32::MAX))
    }
}

struct Search<'s> {
    tree: &'s Tree,
    points: &'s Linear,
    query: &'s Query<'s>,
    reach: Reach,
}

impl Search<'_> {
    fn run(&self, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        let Some(mut radius) = self.reach.radius(best) else {
            return;
        };
        let mut at = [0.0; MAX_AXES];
        for (value, &axis) in at.iter_mut().zip(&self.tree.axes) {
            *value = self.query.reals[axis];
        }
        // The best of fewer points does not bound the number of points within its distance.
        if best.is_none() || best.searched < self.tree.slots.len() {
            let (distance, place) = self.tree.index.nearest(&at);
            if distance > radius {
                return;
            }
            if !self.consider(place, best, accept) {
                return self.search_candidates(&at, best, accept);
            }
            let Some(nearer) = self.reach.radius(best) else {
                return;
            };
            radius = nearer;
        }
        self.tree.index.within(&at, radius, &mut |place| {
            self.consider(place, best, accept);
        });
    }

    /// Takes the first accepted point of a place, if it is nearer; returns false if there is none.
    fn consider(&self, place: u32, best: &mut Best, accept: &mut impl FnMut(usize) -> bool) -> bool {
        let mut slot = self.tree.places[place as usize];
        if slot == NONE {
            return false;
        }
        let distance = self.points.distance(slot as usize, self.query);
        while slot != NONE {
            let index = self.points.index(slot as usize);
            if self.points.is_live(slot as usize) {
                if !best.is_beaten_by(distance, index) {
                    return true;
                }
                if accept(index) {
                    (best.distance, best.index) = (distance, index);
                    return true;
                }
            }
            slot = self.tree.members[slot as usize - self.tree.slots.start].next;
        }
        false
    }

    /// The nearest place had no accepted point: tries more and more places, then all.
    fn search_candidates(&self, at: &[f32; MAX_AXES], best: &mut Best, accept: &mut impl FnMut(usize) -> bool) {
        let mut seen = -1.0;
        for few in CANDIDATES {
            let Some(radius) = self.reach.radius(best) else {
                return;
            };
            let found = self.tree.index.nearest_few(at, few, radius);
            for &(distance, place) in &found {
                if f64::from(distance) > seen {
                    self.consider(place, best, accept);
                }
            }
            if found.len() < few.get() {
                return;
            }
            seen = found.last().map_or(seen, |last| f64::from(last.0) * (1.0 - self.reach.slack));
            if self.reach.radius(best).is_none_or(|radius| f64::from(radius) < seen) {
                return;
            }
        }
        self.points.scan(self.tree.slots(), self.query, best, accept);
    }
}

/// A static tree of any dimension; its items are places.
trait StaticTree: Debug + Send + Sync {
    fn nearest(&self, at: &[f32; MAX_AXES]) -> (f32, u32);
    /// The nearest places within a squared distance, in order.
    fn nearest_few(&self, at: &[f32; MAX_AXES], few: NonZeroUsize, radius: f32) -> Vec<(f32, u32)>;
    /// All places within a squared distance, in any order.
    fn within(&self, at: &[f32; MAX_AXES], radius: f32, visit: &mut dyn FnMut(u32));
}

impl<const K: usize> StaticTree for ImmutableKdTree<f32, K> {
    fn nearest(&self, at: &[f32; MAX_AXES]) -> (f32, u32) {
        let at = std::array::from_fn(|axis| at[axis]);
        let found = self.query(&at).nearest_one::<SquaredEuclidean<f32>>().execute();
        (found.distance, found.item)
    }

    fn nearest_few(&self, at: &[f32; MAX_AXES], few: NonZeroUsize, radius: f32) -> Vec<(f32, u32)> {
        let at = std::array::from_fn(|axis| at[axis]);
        let found = self.query(&at).nearest_n::<SquaredEuclidean<f32>>(few).within(radius).execute();
        found.into_iter().map(|found| (found.distance, found.item)).collect()
    }

    fn within(&self, at: &[f32; MAX_AXES], radius: f32, visit: &mut dyn FnMut(u32)) {
        let at = std::array::from_fn(|axis| at[axis]);
        self.query(&at).within::<SquaredEuclidean<f32>>(radius).unsorted().visit(|found| visit(found.item));
    }
}

/// A static tree of the smallest compiled dimension that has room for the axes; the other coordinates are 0.
fn build(points: &Linear, axes: &[usize], places: &[u32]) -> Option<Arc<dyn StaticTree>> {
    fn of<const K: usize>(points: &Linear, axes: &[usize], places: &[u32]) -> Option<Arc<dyn StaticTree>> {
        let coordinate = |slot: &u32, axis: usize| axes.get(axis).map_or(0.0, |&row| points.value(*slot as usize, row));
        let tree = ImmutableKdTree::<f32, K>::new_from_source(places, coordinate, |place, _| place as u32);
        tree.ok().map(|tree| Arc::new(tree) as Arc<dyn StaticTree>)
    }
    // A level that splits a constant 0 is wasted; but each compiled dimension takes seconds to build, and 7 kB of the
    // engine of the page, which has fewer.
    let of = match axes.len() {
        #[cfg(not(target_family = "wasm"))]
        0..=2 => of::<2>,
        #[cfg(not(target_family = "wasm"))]
        3 => of::<3>,
        #[cfg(not(target_family = "wasm"))]
        4 => of::<4>,
        #[cfg(not(target_family = "wasm"))]
        5 | 6 => of::<6>,
        0..=8 => of::<8>,
        9..=12 => of::<12>,
        _ => return None,
    };
    of(points, axes, places)
}

//! The broad phase: finds pairs of boxes that may touch. A world with few pairs stores them as a list. Otherwise the
//! active boxes are compared kind by kind as long as this makes few pairs; else they are swept in strips (after Baraff,
//! *Dynamic Simulation of Non-Penetrating Rigid Bodies*, 1992, who sweeps them all at once), so that the cost grows
//! with the number of boxes and neighbours, not quadratically.

use crate::ir::{Extremes, SlotId};

use crate::watch::Meter;

use super::contact::Rect;

/// Maximum number of pairs that are stored as a list.
const MAX_LISTED: usize = 64;

/// Pairs of bodies that can touch.
#[derive(Debug)]
pub(super) enum BroadPhase {
    /// All pairs.
    Listed(Vec<(u32, u32)>),
    /// Found in each step, from the pairs of kinds that can touch; the first index is not above the second.
    Kinds(Kinds),
}

/// The kinds of bodies that can touch.
#[derive(Debug)]
pub(super) struct Kinds {
    pairs: Vec<(usize, usize)>,
    /// For each kind, whether it is in any of the pairs.
    pub meets: Vec<bool>,
    /// Number of bodies of each kind.
    counts: Vec<usize>,
}

/// Cost of a candidate pair in a sweep, in units of work.
const CONTACT: u64 = 4;

/// The cost of sorting one box, in comparisons.
pub(super) const PAIRS_PER_BOX: usize = 12;

impl BroadPhase {
    /// Prepares bodies, given as their kind, below `kinds`, and their slot; `meet` tells whether two kinds can touch.
    pub fn new(bodies: &[(usize, SlotId)], kinds: usize, meet: impl Fn(usize, usize) -> bool) -> Self {
        let mut of_kinds: Vec<Vec<usize>> = vec![Vec::new(); kinds];
        for (at, body) in bodies.iter().enumerate() {
            of_kinds[body.0].push(at);
        }
        let all = (0..kinds).flat_map(|a| (a..kinds).map(move |b| (a, b)));
        let pairs: Vec<(usize, usize)> = all.filter(|(a, b)| meet(*a, *b)).collect();
        let mut listed = Vec::new();
        for &(a, b) in &pairs {
            for &i in &of_kinds[a] {
                let others = of_kinds[b].iter().filter(|&&j| bodies[i].1 != bodies[j].1 && (a != b || i < j));
                listed.extend(others.map(|&j| (i.min(j) as u32, i.max(j) as u32)).take(MAX_LISTED + 1));
                if listed.len() > MAX_LISTED {
                    let meets = (0..kinds).map(|kind| pairs.iter().any(|(a, b)| *a == kind || *b == kind)).collect();
                    return BroadPhase::Kinds(Kinds { pairs, meets, counts: of_kinds.iter().map(Vec::len).collect() });
                }
            }
        }
        // In the order of bodies.
        listed.sort_unstable();
        BroadPhase::Listed(listed)
    }

    /// Buffers for the bodies of each kind.
    pub fn buffers(&self) -> Vec<Vec<u32>> {
        match self {
            BroadPhase::Listed(_) => Vec::new(),
            BroadPhase::Kinds(kinds) => kinds.counts.iter().map(|count| Vec::with_capacity(*count)).collect(),
        }
    }
}

/// The number of pairs among the bodies of each kind, if comparing them all costs less than sorting.
#[inline]
pub(super) fn is_few(kinds: &Kinds, active: &[Vec<u32>]) -> Option<usize> {
    let pairs = |&(a, b): &(usize, usize)| match a == b {
        true => active[a].len() * active[a].len().saturating_sub(1) / 2,
        false => active[a].len() * active[b].len(),
    };
    let boxes = active.iter().map(Vec::len).sum::<usize>();
    Some(kinds.pairs.iter().map(pairs).sum::<usize>()).filter(|pairs| *pairs <= boxes * PAIRS_PER_BOX)
}

/// Calls `visit` with every pair of active boxes of one space that overlap or touch and whose kinds can, the lower
/// index first.
#[inline]
pub(super) fn each(kinds: &Kinds, active: &[Vec<u32>], boxes: &[Rect], visit: &mut impl FnMut(usize, usize)) {
    for &(a, b) in &kinds.pairs {
        for (nth, &i) in active[a].iter().enumerate() {
            let others = if a == b { &active[b][nth + 1..] } else { &active[b][..] };
            let rect = &boxes[i as usize];
            for &j in others {
                if rect.is_near(&boxes[j as usize]) {
                    visit(i.min(j) as usize, i.max(j) as usize);
                }
            }
        }
    }
}

/// A box in a strip that it touches; ordered for the sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    space: u32,
    strip: u32,
    /// The left edge, as an integer in the same order.
    left: u64,
    body: u32,
    /// The lowest strip that the box touches.
    lowest: u32,
}

/// The working memory of a sweep.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    entries: Vec<Entry>,
}

impl Sweep {
    /// With capacity for a number of boxes.
    pub fn with_capacity(boxes: usize) -> Self {
        // With strips of the average box height, all boxes together span about as many strips as there are boxes, plus
        // the strips at both of their ends.
        Sweep { entries: Vec::with_capacity(3 * boxes) }
    }

    /// Calls `visit` with every pair of active boxes of one space that overlap or touch and for which `meets` holds,
    /// the lower index first, until the meter stops it. Returns the number of comparisons.
    pub fn pairs(
        &mut self,
        boxes: &[Rect],
        meets: impl Fn(usize) -> bool,
        meter: &Meter<'_>,
        mut visit: impl FnMut(usize, usize),
    ) -> usize {
        let Sweep { entries } = self;
        entries.clear();
        let active = || boxes.iter().enumerate().filter(|(body, b)| b.active && meets(*body)).map(|(_, b)| b);
        let floor = active().fold(f64::INFINITY, |low, b| low.least(b.bottom));
        let height = active().map(|b| b.top - b.bottom).sum::<f64>() / active().count() as f64;
        // The cast saturates: boxes that are very far up share the last strip.
        let strip = |y: f64| ((y - floor) / height) as u32;
        for (body, b) in boxes.iter().enumerate().filter(|(body, b)| b.active && meets(*body)) {
            let (lowest, left) = (strip(b.bottom), ordered(b.left));
            let touched = lowest..=strip(b.top);
            entries.extend(touched.map(|strip| Entry { space: b.space, strip, left, body: body as u32, lowest }));
        }
        entries.sort_unstable();
        let mut compared = entries.len();
        for (at, a) in entries.iter().enumerate() {
            let mut seen = 0;
            let end = ordered(boxes[a.body as usize].right);
            for b in &entries[at + 1..] {
                if b.left > end || (b.space, b.strip) != (a.space, a.strip) {
                    break;
                }
                seen += 1;
                // Two boxes may share several strips; the lowest one reports them.
                let (i, j) = (a.body as usize, b.body as usize);
                if a.strip == a.lowest.max(b.lowest) && boxes[i].is_near(&boxes[j]) {
                    visit(i.min(j), i.max(j));
                }
            }
            compared += seen;
            // Boxes at one place are all neighbours: thousands of them make millions of pairs.
            if meter.spend(CONTACT * seen as u64) {
                break;
            }
        }
        compared
    }
}

/// An integer in the same order as a real number.
fn ordered(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::watch::Unwatched;

    /// Boxes on whole numbers, so that edges meet; some large, some far away.
    fn rects() -> impl Strategy<Value = Vec<Rect>> {
        let side = prop_oneof![8 => 1..9, 1 => 50..90];
        let place = || prop_oneof![30 => -20i64..20, 1 => -1_000_000_000_000..1_000_000_000_000i64];
        let rect = (place(), place(), side.clone(), side, 0..2u32, prop::bool::weighted(0.9));
        let rect = rect.prop_map(|(x, y, width, height, space, active)| {
            let (left, bottom) = (x as f64, y as f64);
            let (right, top) = (left + f64::from(width), bottom + f64::from(height));
            Rect { left, right, bottom, top, active, space, ..Rect::default() }
        });
        prop::collection::vec(rect, 0..40)
    }

    proptest! {
        #[test]
        fn a_sweep_finds_each_near_pair_once(boxes in rects()) {
            let mut expected = Vec::new();
            for j in 0..boxes.len() {
                for i in 0..j {
                    if boxes[i].active && boxes[j].active && boxes[i].is_near(&boxes[j]) {
                        expected.push((i, j));
                    }
                }
            }
            let mut found = Vec::new();
            let mut sweep = Sweep::with_capacity(boxes.len());
            let capacity = sweep.entries.capacity();
            sweep.pairs(&boxes, |_| true, &Meter::new(&Unwatched), |i, j| found.push((i, j)));
            prop_assert_eq!(sweep.entries.capacity(), capacity);
            found.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn kind_by_kind_each_near_pair_that_can_meet_is_found_once(
            boxes in rects(),
            kinds in prop::collection::vec(0..3usize, 40),
            meets in prop::collection::vec(any::<bool>(), 9),
        ) {
            let meet = |a: usize, b: usize| meets[a.min(b) * 3 + a.max(b)];
            let mut active = vec![Vec::new(); 3];
            let mut expected = Vec::new();
            for j in (0..boxes.len()).filter(|j| boxes[*j].active) {
                active[kinds[j]].push(j as u32);
                for i in (0..j).filter(|i| boxes[*i].active && boxes[*i].is_near(&boxes[j])) {
                    if meet(kinds[i], kinds[j]) {
                        expected.push((i, j));
                    }
                }
            }
            let pairs = (0..3).flat_map(|a| (a..3).map(move |b| (a, b))).filter(|(a, b)| meet(*a, *b)).collect();
            let mut found = Vec::new();
            each(&Kinds { pairs, meets: vec![true; 3], counts: vec![40; 3] }, &active, &boxes, &mut |i, j| found.push((i, j)));
            found.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}

//! The broad phase: which boxes may meet. A world of few pairs keeps them as a list; in others the boxes are swept in
//! strips (after Baraff, *Dynamic Simulation of Non-Penetrating Rigid Bodies*, 1992, who sweeps them all at once), so
//! that the cost grows with the boxes and their neighbours, not with their square.

use super::contact::Rect;

/// Up to so many pairs are kept as a list.
const MAX_LISTED: usize = 64;

/// Pairs of bodies that can meet.
#[derive(Debug)]
pub(super) enum Broad {
    /// All of them.
    Listed(Vec<(u32, u32)>),
    /// Found anew in every step.
    Swept,
}

impl Broad {
    /// Prepares so many bodies; `meet` tells whether two of them can.
    pub fn new(bodies: usize, meet: impl Fn(usize, usize) -> bool) -> Self {
        let mut listed = Vec::new();
        for i in 0..bodies {
            for j in i + 1..bodies {
                if meet(i, j) {
                    listed.push((i as u32, j as u32));
                    if listed.len() > MAX_LISTED {
                        return Broad::Swept;
                    }
                }
            }
        }
        Broad::Listed(listed)
    }
}

/// A box in a strip that it touches; in the order of the sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    space: u32,
    strip: u32,
    /// The left edge, as a number that orders as the edge does.
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
    /// For so many boxes.
    pub fn with_room(boxes: usize) -> Self {
        // With strips as high as a box on average, all boxes together span as many strips as there are boxes; a
        // box also touches those where it begins and ends.
        Sweep { entries: Vec::with_capacity(3 * boxes) }
    }

    /// Calls `visit` with every pair of active boxes of one space that overlap or touch, the lower index first.
    pub fn pairs(&mut self, boxes: &[Rect], mut visit: impl FnMut(usize, usize)) {
        let Sweep { entries } = self;
        entries.clear();
        let active = || boxes.iter().filter(|b| b.active);
        let floor = active().fold(f64::INFINITY, |low, b| low.min(b.bottom));
        let height = active().map(|b| b.top - b.bottom).sum::<f64>() / active().count() as f64;
        // A cast stops at the ends of its type: what is very far up shares the last strip.
        let strip = |y: f64| ((y - floor) / height) as u32;
        for (body, b) in (0..).zip(boxes).filter(|(_, b)| b.active) {
            let (lowest, left) = (strip(b.bottom), ordered(b.left));
            let touched = lowest..=strip(b.top);
            entries.extend(touched.map(|strip| Entry { space: b.space, strip, left, body, lowest }));
        }
        entries.sort_unstable();
        for (at, a) in entries.iter().enumerate() {
            let end = ordered(boxes[a.body as usize].right);
            for b in &entries[at + 1..] {
                if b.left > end || (b.space, b.strip) != (a.space, a.strip) {
                    break;
                }
                // Two boxes may share several strips; the lowest of these tells of them.
                let (i, j) = (a.body as usize, b.body as usize);
                if a.strip == a.lowest.max(b.lowest) && boxes[i].is_near(&boxes[j]) {
                    visit(i.min(j), i.max(j));
                }
            }
        }
    }
}

/// A whole number that orders as a real one does.
fn ordered(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

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
            let mut sweep = Sweep::with_room(boxes.len());
            let room = sweep.entries.capacity();
            sweep.pairs(&boxes, |i, j| found.push((i, j)));
            prop_assert_eq!(sweep.entries.capacity(), room);
            found.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}

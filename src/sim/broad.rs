//! The broad phase: which boxes may meet. A world of few pairs keeps them as a list; in others the boxes are sorted
//! along the axis on which they are spread out more and swept (Baraff, *Dynamic Simulation of Non-Penetrating Rigid
//! Bodies*, 1992), so that the cost grows with the boxes and their neighbours, not with their square.

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

/// Calls `visit` with every pair of active boxes of one space that overlap or touch, the lower index first. `order` is
/// working memory.
pub(super) fn sweep(boxes: &[Rect], order: &mut Vec<u32>, mut visit: impl FnMut(usize, usize)) {
    order.clear();
    order.extend((0..boxes.len() as u32).filter(|&i| boxes[i as usize].active));
    let of = |i: u32| &boxes[i as usize];
    let spread = |low: &dyn Fn(&Rect) -> f64| {
        let (least, greatest) = order.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), &i| {
            let at = low(of(i));
            (least.min(at), greatest.max(at))
        });
        greatest - least
    };
    let upright = spread(&|r| r.bottom) > spread(&|r| r.left);
    let range = |i: u32| if upright { (of(i).bottom, of(i).top) } else { (of(i).left, of(i).right) };
    order.sort_unstable_by(|&a, &b| {
        of(a).space.cmp(&of(b).space).then(range(a).0.total_cmp(&range(b).0)).then(a.cmp(&b))
    });
    for (at, &i) in order.iter().enumerate() {
        let (_, end) = range(i);
        for &j in &order[at + 1..] {
            if range(j).0 > end || of(i).space != of(j).space {
                break;
            }
            if of(i).is_near(of(j)) {
                visit(i.min(j) as usize, i.max(j) as usize);
            }
        }
    }
}

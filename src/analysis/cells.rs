//! How the plane of an instance's positions is cut, so that what it can be is told apart by where it is: a disjunctive
//! completion by location (Cousot and Cousot, *Systematic design of program analysis frameworks*, POPL 1979).
//!
//! What falls out of a level falls for ever, faster and faster; that must not be mixed with how fast it moves where there
//! is something to be met. So there is a cell for what lies around all that never moves, and one each below and beside.

use crate::ir::{VarId, World};

use super::evaluate::Configuration;
use super::scene::{Kind, along, near};
use super::tiles::Tiles;
use super::values::Interval;

/// A cell, by its number.
pub(super) type CellId = u32;

/// How far beyond what can be met a cell ends, px.
const MARGIN: f64 = 1.0;

/// The cells of a kind of instances; they cover the plane, and share their edges.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells(Vec<[Interval; 2]>);

impl Cells {
    /// The whole plane.
    pub fn whole() -> Cells {
        Cells(vec![[Interval::ALL; 2]])
    }

    /// Around everything that never moves and that a kind can meet, in whatever space; below it and beside it.
    pub fn around(kind: &Kind) -> Cells {
        let Some([x, y]) = kind.near else { return Cells::whole() };
        let x = Interval { low: x.low - MARGIN, high: x.high + MARGIN };
        let bottom = y.low - MARGIN;
        let above = Interval { low: bottom, high: f64::INFINITY };
        Cells(vec![
            [x, above],
            [Interval::ALL, Interval { low: f64::NEG_INFINITY, high: bottom }],
            [Interval { low: f64::NEG_INFINITY, high: x.low }, above],
            [Interval { low: x.high, high: f64::INFINITY }, above],
        ])
    }

    /// Cuts a configuration to a cell.
    pub fn cut(&self, cell: CellId, at: &mut Configuration) {
        if let Some([x, y]) = self.0.get(cell as usize) {
            at.set(VarId(0), 0, at.vars[VarId(0)][0].within(*x));
            at.set(VarId(1), 0, at.vars[VarId(1)][0].within(*y));
        }
    }

    /// What a configuration is in each of the cells that it can be in.
    pub fn split(&self, at: Configuration) -> Vec<(CellId, Configuration)> {
        let (x, y) = (VarId(0), VarId(1));
        if let [_] = self.0[..] {
            return vec![(0, at)];
        }
        let mut out = Vec::new();
        for (id, cell) in (0..).zip(&self.0) {
            let meets = |var: VarId, axis: usize| !at.vars[var][0].within(cell[axis]).is_none();
            if meets(x, 0) && meets(y, 1) {
                let mut part = at.clone();
                self.cut(id, &mut part);
                out.push((id, part));
            }
        }
        out
    }
}

/// Around the positions at which a collider of a kind can meet anything that never moves; none if it never can.
pub(super) fn near_statics(world: &World, kind: &Kind) -> Option<[Interval; 2]> {
    let mut hull: Option<[Interval; 2]> = None;
    for body in &kind.bodies {
        for space in world.spaces.ids() {
            let tiles = Tiles::new(world, space);
            let kinds: Vec<bool> = tiles.tags.iter().map(|t| world.meeting(body.tags, *t).is_some()).collect();
            let solids = world.spaces[space].solids.iter().filter(|s| world.meeting(body.tags, s.tags).is_some());
            let boxes = tiles.boxes(|kind| kinds[kind]).map(along).chain(solids.map(|s| along(s.bounds)));
            for sides in boxes {
                let at = [0, 1].map(|axis| near(body.extent, axis, sides[axis]));
                hull = Some(hull.map_or(at, |h| [h[0].or(at[0]), h[1].or(at[1])]));
            }
        }
    }
    hull
}

//! The partition of the plane by which configurations are distinguished: a disjunctive completion by location (Cousot
//! and Cousot, *Systematic design of program analysis frameworks*, POPL 1979).
//!
//! An instance that falls out of a level accelerates without bound, which must not be mixed with its speed near
//! obstacles. So there is one cell around all static obstacles, one below and one on each side.
//!
//! On request, players are distinguished by place: the plane is cut at all lines at which pushes can end, so that each
//! cell lies completely inside or outside of blocking obstacles; discrete variables with few values are distinguished,
//! too. This shows step by step what a player cannot reach with its speed, height and jumps.

use std::sync::Arc;

use crate::ir::{DiscreteId, Entity, SpaceId, VarId, World};
use crate::watch::Meter;

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::Interval;
use crate::analysis::geometry::body::{Kind, along, near, rounded};
use crate::analysis::geometry::grid::{Grid, MARGIN};
use crate::analysis::geometry::local::Surfaces;
use crate::analysis::geometry::tiles::Tiles;

/// The number of a cell.
pub(in crate::analysis) type CellId = u32;

/// Maximum number of fine cells.
const MAX_CELLS: usize = 4_000;
/// Maximum number of values of a discrete variable that are distinguished, and of combinations of them.
const MAX_VALUES: i32 = 4;
const MAX_COMBINATIONS: u32 = 16;

/// The cells of a kind; they cover the plane and share their edges.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) enum Cells {
    /// The same in all spaces.
    Coarse(Vec<[Interval; 2]>),
    /// By place, and by the values of some discrete variables.
    Fine(Fine),
}

/// Cells between all lines at which pushes end.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) struct Fine {
    /// The number of the first cell of each.
    grids: Vec<(u32, Grid)>,
    discretes: Vec<(DiscreteId, (i32, i32))>,
    /// Number of cells for each combination of discrete values.
    count: u32,
}

impl Cells {
    /// The whole plane.
    pub fn whole() -> Cells {
        Cells::Coarse(vec![[Interval::ALL; 2]])
    }

    /// One cell around all static obstacles that a kind can touch in any space, one below and one on each side.
    pub fn around(kind: &Kind) -> Cells {
        let Some([x, y]) = kind.near else { return Cells::whole() };
        let x = Interval { low: x.low - MARGIN, high: x.high + MARGIN };
        let bottom = y.low - MARGIN;
        let above = Interval { low: bottom, high: f64::INFINITY };
        Cells::Coarse(vec![
            [x, above],
            [Interval::ALL, Interval { low: f64::NEG_INFINITY, high: bottom }],
            [Interval { low: f64::NEG_INFINITY, high: x.low }, above],
            [Interval { low: x.high, high: f64::INFINITY }, above],
        ])
    }

    /// Cells between all lines at which pushes end and the answers of probes change, if there are not too many. `probed`
    /// returns the latter, `blocking` the positions inside
    /// blocking obstacles of a space.
    pub fn fine(
        kind: &Kind,
        entity: &Entity,
        surfaces: &[(SpaceId, Arc<Surfaces>)],
        probed: impl Fn(SpaceId) -> [Vec<f64>; 2],
        blocking: impl Fn(SpaceId) -> Vec<[Interval; 2]>,
    ) -> Option<Cells> {
        let probed: Vec<[Vec<f64>; 2]> = surfaces.iter().map(|(space, _)| probed(*space)).collect();
        let hull = |axis: usize| {
            let lines = probed.iter().flat_map(|lines| &lines[axis]).map(|x| Interval::point(*x));
            lines.chain(kind.near.map(|near| near[axis])).reduce(Interval::or)
        };
        let around = [hull(0)?, hull(1)?];
        let mut out = Fine { grids: Vec::new(), discretes: Vec::new(), count: 0 };
        for ((space, surfaces), probed) in surfaces.iter().zip(probed) {
            let left = MAX_CELLS.saturating_sub(out.count as usize);
            let grid = Grid::new(*space, surfaces, probed, around, left, || blocking(*space))?;
            let first = out.count;
            out.count += (grid.count(0) * grid.count(1)) as u32;
            out.grids.push((first, grid));
        }
        let mut combinations = 1;
        for (id, discrete) in entity.discretes.pairs() {
            let values = discrete.range.1.saturating_sub(discrete.range.0).saturating_add(1);
            if values <= MAX_VALUES && combinations * values as u32 <= MAX_COMBINATIONS {
                combinations *= values as u32;
                out.discretes.push((id, discrete.range));
            }
        }
        Some(Cells::Fine(out))
    }

    /// Restricts a configuration to a cell.
    pub fn cut(&self, cell: CellId, at: &mut Configuration) {
        match self {
            Cells::Coarse(cells) => {
                if let Some(sides) = cells.get(cell as usize) {
                    within(sides, at);
                }
            }
            Cells::Fine(fine) => fine.cut(cell, at),
        }
    }

    /// Splits a configuration by the cells that it overlaps; if `is_kept_out`, without blocked cells.
    pub fn split(&self, at: Configuration, is_kept_out: bool) -> Vec<(CellId, Configuration)> {
        let cells = match self {
            Cells::Coarse(cells) if cells.len() == 1 => return vec![(0, at)],
            Cells::Coarse(cells) => cells,
            Cells::Fine(fine) => return fine.split(&at, is_kept_out),
        };
        let mut out = Vec::new();
        for (id, cell) in (0..).zip(cells) {
            if (0..2).all(|axis| !at.vars[VarId(axis)][0].within(cell[axis as usize]).is_none()) {
                let mut part = at.clone();
                within(cell, &mut part);
                out.push((id, part));
            }
        }
        out
    }
}

fn within(sides: &[Interval; 2], at: &mut Configuration) {
    for axis in 0..2 {
        let var = VarId(axis);
        at.set(var, 0, at.vars[var][0].within(sides[axis as usize]));
    }
}

impl Fine {
    fn cut(&self, cell: CellId, at: &mut Configuration) {
        let (mut combination, number) = (cell / self.count.max(1), cell % self.count.max(1));
        let Some((first, grid)) = self.grids.iter().rev().find(|(first, _)| *first <= number) else { return };
        let (number, across) = ((number - first) as usize, grid.count(0));
        let sides = [grid.side(0, number % across), grid.side(1, number / across)].map(rounded);
        within(&sides, at);
        if at.spaces.len() > 1 {
            at.spaces = Arc::new([grid.space].into());
        }
        for (id, (low, high)) in &self.discretes {
            let values = (high - low + 1) as u32;
            let value = f64::from(*low + (combination % values) as i32);
            combination /= values;
            at.set_discrete(*id, at.discretes[*id].within(Interval::point(value)));
        }
    }

    /// The combinations of discrete values that a configuration can have.
    fn combinations(&self, at: &Configuration) -> Vec<u32> {
        let mut out = vec![0];
        let mut step = 1;
        for (id, (low, high)) in &self.discretes {
            let values = (*low..=*high).filter(|v| at.discretes[*id].contains(f64::from(*v)));
            let values: Vec<u32> = values.map(|v| (v - low) as u32 * step).collect();
            out = out.into_iter().flat_map(|c| values.iter().map(move |v| c + v)).collect();
            step *= (high - low + 1) as u32;
        }
        out
    }

    /// Maximum number of parts into which a configuration is split.
    pub fn count_parts(&self, at: &Configuration) -> usize {
        let hulls = [at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()];
        let [Some(x), Some(y)] = hulls else { return 0 };
        let of = |grid: &Grid| grid.range(0, x).count().saturating_mul(grid.range(1, y).count());
        let cells: usize = self.grids.iter().map(|(_, g)| g).filter(|g| at.spaces.contains(&g.space)).map(of).sum();
        cells.saturating_mul(self.combinations(at).len())
    }

    fn split(&self, at: &Configuration, is_kept_out: bool) -> Vec<(CellId, Configuration)> {
        let hulls = [at.vars[VarId::X][0].hull(), at.vars[VarId::Y][0].hull()];
        let [Some(x), Some(y)] = hulls else { return Vec::new() };
        let combinations = self.combinations(at);
        let mut out = Vec::new();
        for (first, grid) in self.grids.iter().filter(|(_, g)| at.spaces.contains(&g.space)) {
            for row in grid.range(1, y) {
                for column in grid.range(0, x) {
                    let number = row * grid.count(0) + column;
                    if is_kept_out && grid.is_blocked[number] {
                        continue;
                    }
                    for combination in &combinations {
                        let id = combination * self.count + first + number as u32;
                        let mut part = at.clone();
                        self.cut(id, &mut part);
                        if !part.is_impossible() {
                            out.push((id, part));
                        }
                    }
                }
            }
        }
        out
    }
}

/// The hull of the positions at which a collider of a kind can touch a static obstacle; `None` if it never can, or if
/// the meter runs out.
pub(in crate::analysis) fn near_statics(world: &World, kind: &Kind, meter: &Meter<'_>) -> Option<[Interval; 2]> {
    let mut hull: Option<[Interval; 2]> = None;
    for body in &kind.bodies {
        for space in world.spaces.ids() {
            let tiles = Tiles::new(world, space);
            if tiles.spend(meter) || meter.spend(world.spaces[space].solids.len() as u64) {
                return None;
            }
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

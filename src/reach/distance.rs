//! How far a player is from the goal: the number of places on the shortest way through what never blocks it, whatever it
//! can do, as in Barraquand and Latombe, *Robot Motion Planning: A Distributed Representation Approach*, 1991. Ways through
//! links count as one. What the planner that is led by distances (`planners/lead.rs`) follows.

use std::collections::VecDeque;

use crate::ir::{Bounds, Id, Push, SlotId, SpaceId, TagSet};

use super::coverage::PLACE;
use super::problem::Problem;
use super::whereabouts::{Place, extent, wanted};

/// With more places than that there is no field.
const MOST_PLACES: usize = 1 << 21;
/// How far above the bounds of a space, and around what is in one without bounds, there are places; px.
const MARGIN: f64 = 8.0 * PLACE;
/// At so many positions along each side of a place is tried whether the player fits there.
const TRIED: usize = 4;
/// No way is known.
const FAR: u32 = u32::MAX;

/// The distances of a player's places to the goal.
#[derive(Debug)]
pub(super) struct Distances {
    /// Whose.
    pub player: SlotId,
    grids: Vec<Grid>,
    /// What counts for places from which no way is known: more than for all others.
    far: u32,
}

/// The places of a space.
#[derive(Debug)]
struct Grid {
    left: f64,
    bottom: f64,
    columns: usize,
    rows: usize,
    /// Row by row from the lowest: the positions that are blocked, a bit for each; then, the distance.
    blocked: Vec<u16>,
    distances: Vec<u32>,
}

impl Distances {
    /// Of the first player of whom the goal says where it has to be.
    pub fn new(problem: &Problem<'_>) -> Option<Self> {
        let (player, goal) = wanted(problem)?;
        let mut distances = Distances { player, grids: Vec::new(), far: 0 };
        let mut count = 0;
        for space in problem.sim.world().spaces.ids() {
            let grid = Grid::new(problem, player, space, &goal)?;
            count += grid.columns * grid.rows;
            if count > MOST_PLACES {
                return None;
            }
            distances.grids.push(grid);
        }
        distances.flood(problem, &goal);
        let known = distances.grids.iter().flat_map(|g| &g.distances).filter(|d| **d != FAR);
        distances.far = known.max()? + 1;
        Some(distances)
    }

    /// Of a position.
    pub fn of(&self, space: SpaceId, x: f64, y: f64) -> u32 {
        let grid = &self.grids[space.index()];
        let at = |value: f64, low: f64, count: usize| (((value - low) / PLACE).max(0.0) as usize).min(count - 1);
        let cell = at(y, grid.bottom, grid.rows) * grid.columns + at(x, grid.left, grid.columns);
        grid.distances[cell].min(self.far)
    }

    fn flood(&mut self, problem: &Problem<'_>, goal: &[Place]) {
        let mut open: VecDeque<(SpaceId, usize)> = VecDeque::new();
        for (space, grid) in self.grids.iter_mut().enumerate() {
            let space = SpaceId(space as u32);
            for place in goal.iter().filter(|p| p.space.is_none_or(|s| s == space)) {
                let cells = grid.cells(place.x, place.y);
                open.extend(cells.into_iter().filter(|cell| grid.reach(*cell, 0)).map(|cell| (space, cell)));
            }
        }
        let spaces = &problem.sim.world().spaces;
        while let Some((space, cell)) = open.pop_front() {
            let grid = &mut self.grids[space.index()];
            let next = grid.distances[cell] + 1;
            let (column, row) = (cell % grid.columns, cell / grid.columns);
            let sides = [
                (column > 0).then(|| cell - 1),
                (column + 1 < grid.columns).then(|| cell + 1),
                (row > 0).then(|| cell - grid.columns),
                (row + 1 < grid.rows).then(|| cell + grid.columns),
            ];
            open.extend(sides.into_iter().flatten().filter(|cell| grid.reach(*cell, next)).map(|cell| (space, cell)));
            // Where links come out, they have gone in.
            let at = (grid.left + column as f64 * PLACE, grid.bottom + row as f64 * PLACE);
            for (from, link) in spaces.pairs().flat_map(|(id, s)| s.links.iter().map(move |l| (id, l))) {
                let is_out = link.space == space
                    && at.0 <= link.to.right
                    && link.to.left <= at.0 + PLACE
                    && at.1 <= link.to.top
                    && link.to.bottom <= at.1 + PLACE;
                if is_out {
                    let grid = &mut self.grids[from.index()];
                    let cells = grid.cells((link.from.left, link.from.right), (link.from.bottom, link.from.top));
                    open.extend(cells.into_iter().filter(|cell| grid.reach(*cell, next)).map(|cell| (from, cell)));
                }
            }
        }
    }
}

impl Grid {
    fn new(problem: &Problem<'_>, player: SlotId, id: SpaceId, goal: &[Place]) -> Option<Self> {
        let world = problem.sim.world();
        let space = &world.spaces[id];
        let area = match space.bounds {
            Some(bounds) => Bounds { top: bounds.top + MARGIN, ..bounds },
            None => around(problem, player, id, goal),
        };
        let count = |low: f64, high: f64| ((high - low) / PLACE).ceil().max(1.0);
        let (columns, rows) = (count(area.left, area.right), count(area.bottom, area.top));
        if columns * rows > MOST_PLACES as f64 {
            return None;
        }
        let (columns, rows) = (columns as usize, rows as usize);
        let places = columns * rows;
        let mut grid = Grid {
            left: area.left,
            bottom: area.bottom,
            columns,
            rows,
            blocked: vec![0; places],
            distances: vec![FAR; places],
        };
        grid.block(problem, player, id);
        Some(grid)
    }

    /// Marks the positions at which the player lies inside of what never moves.
    fn block(&mut self, problem: &Problem<'_>, player: SlotId, id: SpaceId) {
        let world = problem.sim.world();
        let entity = &problem.sim.program().entities[world.slots[player].entity];
        let blocks = |mine: TagSet, tags: TagSet| {
            world.meeting(mine, tags).is_some_and(|meeting| meeting.response.push == Push::Block)
        };
        let space = &world.spaces[id];
        let kinds: Vec<TagSet> =
            space.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.iter().copied().collect()).collect();
        let solids = |mine: TagSet| space.solids.iter().filter(move |s| blocks(mine, s.tags));
        // What every shape of it covers: one that is seldom there says little of where it fits.
        let bodies = entity.colliders.iter().filter(|c| {
            !c.kinematic && (solids(c.tags).next().is_some() || kinds.iter().any(|tags| blocks(c.tags, *tags)))
        });
        let mut core: Option<(TagSet, Bounds)> = None;
        for collider in bodies {
            let Some(extent) = extent(problem, player, collider) else { return };
            core = Some(match core {
                None => (collider.tags, extent),
                Some((tags, b)) => (
                    tags,
                    Bounds {
                        left: b.left.max(extent.left),
                        right: b.right.min(extent.right),
                        bottom: b.bottom.max(extent.bottom),
                        top: b.top.min(extent.top),
                    },
                ),
            });
        }
        let Some((tags, core)) = core else { return };
        for solid in solids(tags) {
            self.mark(solid.bounds, core);
        }
        let Some(map) = &space.map else { return };
        let is_wall: Vec<bool> = kinds.iter().map(|kind| blocks(tags, *kind)).collect();
        for (cell, _) in map.cells.iter().enumerate().filter(|(_, kind)| is_wall[usize::from(**kind)]) {
            self.mark(Bounds::new(map.rectangle(cell)), core);
        }
    }

    /// Marks the positions at which a body overlaps a box.
    fn mark(&mut self, wall: Bounds, body: Bounds) {
        // Strictly between these positions it does.
        let (left, right) = (wall.left - body.right, wall.right - body.left);
        let (bottom, top) = (wall.bottom - body.top, wall.top - body.bottom);
        let apart = PLACE / TRIED as f64;
        let range = |low: f64, high: f64, from: f64, count: usize| {
            let first = ((low - from) / apart).floor() + 1.0;
            let after = ((high - from) / apart).ceil();
            let most = (count * TRIED) as f64;
            (first.clamp(0.0, most) as usize)..(after.clamp(0.0, most) as usize)
        };
        let across = range(left, right, self.left, self.columns);
        for y in range(bottom, top, self.bottom, self.rows) {
            for x in across.clone() {
                let bit = (y % TRIED) * TRIED + x % TRIED;
                self.blocked[(y / TRIED) * self.columns + x / TRIED] |= 1 << bit;
            }
        }
    }

    /// The cells that a box meets.
    fn cells(&self, x: (f64, f64), y: (f64, f64)) -> Vec<usize> {
        let range = |(low, high): (f64, f64), from: f64, count: usize| {
            let most = count as f64;
            let first = ((low - from) / PLACE).floor().clamp(0.0, most) as usize;
            let after = (((high - from) / PLACE).floor() + 1.0).clamp(0.0, most) as usize;
            first..after
        };
        let across = range(x, self.left, self.columns);
        let rows = range(y, self.bottom, self.rows);
        rows.flat_map(|row| across.clone().map(move |column| row * self.columns + column)).collect()
    }

    /// Gives a free place its distance; whether it had none.
    fn reach(&mut self, cell: usize, distance: u32) -> bool {
        let is_new = self.distances[cell] == FAR && self.blocked[cell] != u16::MAX;
        if is_new {
            self.distances[cell] = distance;
        }
        is_new
    }
}

/// A box around what is known to be in a space without bounds.
fn around(problem: &Problem<'_>, player: SlotId, id: SpaceId, goal: &[Place]) -> Bounds {
    let world = problem.sim.world();
    let space = &world.spaces[id];
    let begin = world.slots[player].vars.iter().take(2).map(|v| v[0]).collect::<Vec<f64>>();
    let point = |x: f64, y: f64| Bounds { left: x, right: x, bottom: y, top: y };
    let finite = |(low, high): (f64, f64)| {
        let low_or = if low.is_finite() { low } else { high };
        let high_or = if high.is_finite() { high } else { low };
        low_or.is_finite().then_some((low_or, high_or))
    };
    let goals = goal.iter().filter(|p| p.space.is_none_or(|s| s == id)).map(|p| {
        let (x, y) = (finite(p.x).unwrap_or((begin[0], begin[0])), finite(p.y).unwrap_or((begin[1], begin[1])));
        Bounds { left: x.0, right: x.1, bottom: y.0, top: y.1 }
    });
    let links = space.links.iter().map(|l| l.from);
    let into = world.spaces.iter().flat_map(|s| &s.links).filter(|l| l.space == id).map(|l| l.to);
    let first = point(begin[0], begin[1]);
    let all = space.solids.iter().map(|s| s.bounds).chain(goals).chain(links).chain(into);
    let hull = all.fold(first, |a, b| Bounds {
        left: a.left.min(b.left),
        right: a.right.max(b.right),
        bottom: a.bottom.min(b.bottom),
        top: a.top.max(b.top),
    });
    Bounds {
        left: hull.left - MARGIN,
        right: hull.right + MARGIN,
        bottom: hull.bottom - MARGIN,
        top: hull.top + MARGIN,
    }
}

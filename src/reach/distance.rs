//! How far a player is from the goal: the number of places on the shortest way through what never blocks it, whatever it
//! can do, as in Barraquand and Latombe, *Robot Motion Planning: A Distributed Representation Approach*, 1991. Ways through
//! links count as one. What the planner that is led by distances (`planners/lead.rs`) follows; and the least time that the
//! rest of the way takes, by the greatest velocities, where there is a time to keep.

use std::collections::VecDeque;

use crate::analysis::ConfigurationSpace;
use crate::ir::{Bounds, Id, Push, SlotId, SpaceId, TagSet, VarId};
use crate::watch::Meter;

use super::coverage::PLACE;
use super::problem::Problem;
use super::whereabouts::{Place, extent, wanted};

/// With more places than that there is no field.
const MAX_PLACES: usize = 1 << 21;
/// How far above the bounds of a space, and around what is in one without bounds, there are places; px.
const MARGIN: f64 = 8.0 * PLACE;
/// The number of positions along each side of a place at which the player is tried.
const TRIED: usize = 4;
/// No way is known.
const FAR: u32 = u32::MAX;

/// The distances of a player's places to the goal.
#[derive(Debug)]
pub(super) struct Distances {
    /// Whose.
    pub player: SlotId,
    grids: Vec<Grid>,
    /// Of each place, how many places away the goal is.
    places: Field,
    /// What counts for places from which no way is known: more than for all others.
    far: u32,
    pace: Option<Pace>,
}

/// A number for each place of each space.
type Field = Vec<Vec<u32>>;

/// How fast a player gets on at best.
#[derive(Debug)]
struct Pace {
    /// The least places to the side, and up or down, on any way to the goal.
    places: [Field; 2],
    /// The steps that a place takes at least.
    steps: [f64; 2],
}

/// What a way costs: for a place to the side, for one up or down, for a link.
type Costs = [u32; 3];

/// The places of a space.
#[derive(Debug)]
struct Grid {
    left: f64,
    bottom: f64,
    columns: usize,
    rows: usize,
    /// Row by row from the lowest: the positions that are blocked, a bit for each.
    blocked: Vec<u16>,
}

impl Distances {
    /// Of the first player of whom the goal says where it has to be.
    /// None if it is stopped.
    pub fn new(problem: &Problem<'_>, space: &ConfigurationSpace, meter: &Meter<'_>) -> Option<Self> {
        let (player, goal) = wanted(problem)?;
        let mut grids = Vec::new();
        let mut count = 0;
        for id in problem.sim.world().spaces.ids() {
            let grid = Grid::new(problem, player, id, &goal, meter)?;
            count += grid.columns * grid.rows;
            if count > MAX_PLACES {
                return None;
            }
            grids.push(grid);
        }
        let places = flood(&grids, problem, &goal, [1, 1, 1], meter);
        let far = places.iter().flatten().filter(|d| **d != FAR).max()? + 1;
        let pace = problem.time().map(|_| Pace {
            places: [[1, 0, 0], [0, 1, 0]].map(|costs| flood(&grids, problem, &goal, costs, meter)),
            steps: VarId::XY.map(|var| {
                let fastest = fastest(space, player, var) * problem.sim.world().step.seconds();
                if fastest > 0.0 { PLACE / fastest } else { 0.0 }
            }),
        });
        if meter.is_stopped() {
            return None;
        }
        Some(Distances { player, grids, places, far, pace })
    }

    /// Of a position.
    pub fn of(&self, space: SpaceId, x: f64, y: f64) -> u32 {
        self.places[space.index()][self.cell(space, x, y)].min(self.far)
    }

    /// How many steps the rest of the way takes at least, as far as is known, if nothing carries the player.
    pub fn least_steps(&self, space: SpaceId, x: f64, y: f64) -> u32 {
        let Some(pace) = &self.pace else { return 0 };
        let cell = self.cell(space, x, y);
        let along = pace.places.iter().zip(pace.steps).map(|(field, steps)| {
            // What is in a place may be at its edge.
            let places = field[space.index()][cell];
            if places == FAR { 0.0 } else { f64::from(places.saturating_sub(1)) * steps }
        });
        along.fold(0.0, f64::max) as u32
    }

    /// The place of a position.
    fn cell(&self, space: SpaceId, x: f64, y: f64) -> usize {
        let grid = &self.grids[space.index()];
        let at = |value: f64, low: f64, count: usize| (((value - low) / PLACE).max(0.0) as usize).min(count - 1);
        at(y, grid.bottom, grid.rows) * grid.columns + at(x, grid.left, grid.columns)
    }
}

/// The greatest velocity of a player along an axis, px/s; infinite where nothing is known.
fn fastest(space: &ConfigurationSpace, player: SlotId, var: VarId) -> f64 {
    let slot = &space.slots[player];
    if slot.is_given_up {
        return f64::INFINITY;
    }
    let velocities = slot.configurations.iter().flat_map(|c| c.vars[var][1].intervals());
    velocities.map(|v| v.low.abs().max(v.high.abs())).fold(0.0, f64::max)
}

/// What the cheapest way to the goal costs from each place; costs are 0 or 1 (breadth first with two ends). Cut short if
/// it is stopped.
fn flood(
    grids: &[Grid],
    problem: &Problem<'_>,
    goal: &[Place],
    [across, along, through]: Costs,
    meter: &Meter<'_>,
) -> Field {
    let mut field: Field = grids.iter().map(|grid| vec![FAR; grid.blocked.len()]).collect();
    let mut open: VecDeque<(SpaceId, usize, u32)> = VecDeque::new();
    for (space, grid) in grids.iter().enumerate() {
        let space = SpaceId(space as u32);
        for place in goal.iter().filter(|p| p.space.is_none_or(|s| s == space)) {
            let cells = grid.cells(place.x, place.y).into_iter().filter(|cell| grid.is_free(*cell));
            open.extend(cells.map(|cell| (space, cell, 0)));
        }
    }
    let spaces = &problem.sim.world().spaces;
    let links = spaces.iter().map(|s| s.links.len() as u64).sum::<u64>();
    while let Some((space, cell, cost)) = open.pop_front() {
        if meter.spend(8 + links) {
            break;
        }
        let known = &mut field[space.index()][cell];
        if *known <= cost {
            continue;
        }
        *known = cost;
        let mut go = |space: SpaceId, cell: usize, more: u32| {
            if grids[space.index()].is_free(cell) && field[space.index()][cell] > cost + more {
                let next = (space, cell, cost + more);
                if more == 0 { open.push_front(next) } else { open.push_back(next) }
            }
        };
        let grid = &grids[space.index()];
        let (column, row) = (cell % grid.columns, cell / grid.columns);
        let sides = [
            (column > 0).then(|| (cell - 1, across)),
            (column + 1 < grid.columns).then(|| (cell + 1, across)),
            (row > 0).then(|| (cell - grid.columns, along)),
            (row + 1 < grid.rows).then(|| (cell + grid.columns, along)),
        ];
        sides.into_iter().flatten().for_each(|(cell, more)| go(space, cell, more));
        // Where links come out, they have gone in.
        let at = (grid.left + column as f64 * PLACE, grid.bottom + row as f64 * PLACE);
        for (from, link) in spaces.pairs().flat_map(|(id, s)| s.links.iter().map(move |l| (id, l))) {
            let is_out = link.space == space
                && at.0 <= link.to.right
                && link.to.left <= at.0 + PLACE
                && at.1 <= link.to.top
                && link.to.bottom <= at.1 + PLACE;
            if is_out {
                let (x, y) = ((link.from.left, link.from.right), (link.from.bottom, link.from.top));
                grids[from.index()].cells(x, y).into_iter().for_each(|cell| go(from, cell, through));
            }
        }
    }
    field
}

impl Grid {
    fn new(problem: &Problem<'_>, player: SlotId, id: SpaceId, goal: &[Place], meter: &Meter<'_>) -> Option<Self> {
        let world = problem.sim.world();
        let space = &world.spaces[id];
        let area = match space.bounds {
            Some(bounds) => Bounds { top: bounds.top + MARGIN, ..bounds },
            None => around(problem, player, id, goal),
        };
        let count = |low: f64, high: f64| ((high - low) / PLACE).ceil().max(1.0);
        let (columns, rows) = (count(area.left, area.right), count(area.bottom, area.top));
        if columns * rows > MAX_PLACES as f64 {
            return None;
        }
        let (columns, rows) = (columns as usize, rows as usize);
        let places = columns * rows;
        let mut grid = Grid { left: area.left, bottom: area.bottom, columns, rows, blocked: vec![0; places] };
        grid.block(problem, player, id, meter);
        Some(grid)
    }

    /// Marks the positions at which the player lies inside of what never moves.
    fn block(&mut self, problem: &Problem<'_>, player: SlotId, id: SpaceId, meter: &Meter<'_>) {
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
            self.mark(solid.bounds, core, meter);
        }
        let Some(map) = &space.map else { return };
        let is_wall: Vec<bool> = kinds.iter().map(|kind| blocks(tags, *kind)).collect();
        for (cell, _) in map.cells.iter().enumerate().filter(|(_, kind)| is_wall[usize::from(**kind)]) {
            self.mark(Bounds::new(map.rectangle(cell)), core, meter);
        }
    }

    /// Marks the positions at which a body overlaps a box.
    fn mark(&mut self, wall: Bounds, body: Bounds, meter: &Meter<'_>) {
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
            if meter.spend(across.len() as u64 + 8) {
                return;
            }
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

    /// Whether the player fits anywhere in a place.
    fn is_free(&self, cell: usize) -> bool {
        self.blocked[cell] != u16::MAX
    }
}

/// A box around what is known to be in a space without bounds. Around a map there are no places but those that something
/// lies at: ways around the outside are seldom possible, and always short.
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
    let all = space.solids.iter().map(|s| s.bounds).chain(goals).chain(links).chain(into);
    match space.map_rectangle() {
        Some(map) => {
            let hull = all.fold(map, Bounds::join);
            Bounds { top: hull.top + MARGIN, ..hull }
        }
        None => {
            let hull = all.fold(point(begin[0], begin[1]), Bounds::join);
            Bounds {
                left: hull.left - MARGIN,
                right: hull.right + MARGIN,
                bottom: hull.bottom - MARGIN,
                top: hull.top + MARGIN,
            }
        }
    }
}

//! The distance field of the goal: the number of places on the shortest path around static obstacles, whatever the
//! player's abilities, as in Barraquand and Latombe, *Robot Motion Planning: A Distributed Representation Approach*,
//! 1991. A link counts as one place. Used by `planners/distance_guided.rs` and `planners/time_guided.rs`. Also a lower
//! bound of the remaining time, from the maximum velocities.

use std::collections::VecDeque;

use crate::analysis::ConfigurationSpace;
use crate::ir::{Bounds, Extremes, Id, Push, SlotId, Space, SpaceId, TagId, TagSet, TileKind, VarId, World};
use crate::sim::Simulator;
use crate::watch::Meter;

use super::around::images;
use super::coverage::PLACE;
use super::gates::gates;
use super::goal_positions::{Lead, PositionBox, extent, lead, subgoals_of};
use super::problem::Problem;
use super::stages::{Stage, Ways, stages};

/// Maximum number of places; above it, there is no field.
const MAX_PLACES: usize = 1 << 21;
/// Margin above the bounds of a space, and around the contents of a space without bounds, px.
const MARGIN: f64 = 8.0 * PLACE;
/// Number of positions per side of a place at which the player's body is tested.
const SAMPLES: usize = 4;
/// No path is known.
pub(super) const UNREACHABLE: u32 = u32::MAX;

/// Distances from places to the goal, for one player, or for another instance on whose position the goal depends.
#[derive(Debug)]
pub(super) struct DistanceField {
    /// Whose distances.
    slot: SlotId,
    /// Whether the goal is there, and not only an edge that leads on.
    is_goal: bool,
    grids: Vec<Grid>,
    /// What leads to each subgoal, in the order in which they are to come about, and to the goal.
    stages: Vec<Stage>,
    min_time: MinTime,
}

/// A number for each place of each space.
pub(super) type CostField = Vec<Vec<u32>>;

/// Lower bounds of the time to the goal.
#[derive(Debug)]
struct MinTime {
    /// Minimum numbers of horizontal and vertical moves on any path to the goal.
    places: [CostField; 2],
    /// Minimum number of steps per place, along each axis.
    steps: [f64; 2],
}

/// Costs of a path: per horizontal move, per vertical move, per link.
type Costs = [u32; 3];

/// The places of a space.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    left: f64,
    bottom: f64,
    columns: usize,
    rows: usize,
    /// The core of the player's body with its tags, if obstacles block it.
    core: Option<(TagSet, Bounds)>,
    /// Row by row from the lowest: one bit for each blocked position.
    blocked: Vec<u16>,
}

impl DistanceField {
    /// For the first player, or else the first instance, whose position the goal restricts. `None` if there is none, if
    /// there are too many places, or if the meter runs out.
    pub fn new(problem: &Problem<'_>, space: &ConfigurationSpace, meter: &Meter<'_>) -> Option<Self> {
        let Lead { slot, boxes: goal, is_goal, before } = lead(problem, space)?;
        let mut grids = Vec::new();
        let mut count = 0;
        let all: Vec<PositionBox> = before.iter().flat_map(|subgoal| &subgoal.boxes).chain(&goal).copied().collect();
        for id in problem.sim.world().spaces.ids() {
            let grid = Grid::new(problem, slot, id, &all, meter)?;
            count += grid.columns * grid.rows;
            if count > MAX_PLACES {
                return None;
            }
            grids.push(grid);
        }
        let of_gates = |fact| subgoals_of(problem, space, slot, fact);
        let ways = Ways::new(problem, slot, &grids, gates(problem, space, slot), meter);
        let stages = stages(&ways, (before, &goal), &of_gates)?;
        let min_time = MinTime {
            places: [[1, 0, 0], [0, 1, 0]].map(|costs| flood(&grids, problem, &goal, costs, meter)),
            steps: VarId::XY.map(|var| {
                let fastest = fastest(space, slot, var) * problem.sim.world().step.seconds();
                // What is pushed has no velocity, and a mode may be entered in another way.
                if is_goal && fastest > 0.0 { PLACE / fastest } else { 0.0 }
            }),
        };
        if meter.is_stopped() {
            return None;
        }
        Some(DistanceField { slot, is_goal, grids, stages, min_time })
    }

    /// Whether the goal is where they lead; else an edge is only taken from there if its guard holds as well.
    pub fn is_goal(&self) -> bool {
        self.is_goal
    }

    /// Whose distances they are.
    pub fn slot(&self) -> SlotId {
        self.slot
    }

    /// The distance in a state: over the subgoals that are still to come about.
    pub fn of(&self, sim: &Simulator, state: &[u8]) -> u32 {
        self.from(sim, state, sim.space(state, self.slot), sim.position(state, self.slot))
    }

    /// The distance in a state as if the player were elsewhere.
    pub fn from(&self, sim: &Simulator, state: &[u8], space: SpaceId, at: (f64, f64)) -> u32 {
        let (stage, rest) = self.stage(sim, state);
        self.stages[stage].of(space, self.grids[space.index()].cell(at)).saturating_add(rest)
    }

    /// The stage in a state, and the distance from where it comes about to the goal.
    fn stage(&self, sim: &Simulator, state: &[u8]) -> (usize, u32) {
        let last = self.stages.len() - 1;
        let is_open = |stage: &usize| self.stages[*stage].is_open(sim, state);
        let Some(first) = (0..last).find(is_open) else { return (last, 0) };
        let (mut at, mut rest) = (first, 0u32);
        for next in (first + 1..last).filter(is_open).chain([last]) {
            rest = rest.saturating_add(self.stages[at].hops[next]);
            at = next;
        }
        (first, rest)
    }

    /// A key of the subgoals that are still to come about in a state; 0 if there are none at all.
    pub fn subgoals(&self, sim: &Simulator, state: &[u8]) -> u64 {
        let last = self.stages.len() - 1;
        (0..last).filter(|stage| self.stages[*stage].is_open(sim, state)).fold(0, |key, stage| key | 1 << stage)
    }

    /// Whether it is known where any of it comes about.
    pub fn leads_to_places(&self) -> bool {
        self.stages.iter().any(|stage| !stage.places.is_empty())
    }

    /// Whether there are subgoals.
    pub fn has_subgoals(&self) -> bool {
        self.stages.len() > 1
    }

    /// The distance in a state, in places, that changes with each px: within a place towards those that are nearer.
    pub fn fine(&self, sim: &Simulator, state: &[u8]) -> f64 {
        let ((x, y), space) = (sim.position(state, self.slot), sim.space(state, self.slot));
        let (grid, (_, cell)) = (&self.grids[space.index()], self.cell(sim, state));
        let (column, row) = (cell % grid.columns, cell / grid.columns);
        let (stage, rest) = self.stage(sim, state);
        let stage = &self.stages[stage];
        let here = f64::from(stage.of(space, cell)) + f64::from(rest);
        let Some(places) = stage.places.get(space.index()) else { return here };
        // Which of the two places beside it is nearer, and how far it is into this one from the middle.
        let along = |at: f64, low: f64, index: usize, count: usize, apart: usize| {
            let into = ((at - low) / PLACE - index as f64).clamp(0.0, 1.0) - 0.5;
            let own = places[cell].min(stage.far);
            let before = index > 0 && places[cell - apart] < own;
            let after = index + 1 < count && places[cell + apart] < own;
            match (before, after) {
                (true, false) => into,
                (false, true) => -into,
                _ => 0.0,
            }
        };
        let across = along(x, grid.left, column, grid.columns, 1);
        let upwards = along(y, grid.bottom, row, grid.rows, grid.columns);
        here + across + upwards
    }

    /// A lower bound of the number of steps to the goal from a state, if nothing carries the player; 0 if none is known.
    pub fn least_steps(&self, sim: &Simulator, state: &[u8]) -> u32 {
        let (space, cell) = self.cell(sim, state);
        let along = self.min_time.places.iter().zip(self.min_time.steps).map(|(field, steps)| {
            // The player may be at the edge of the place.
            let places = field[space.index()][cell];
            if places == UNREACHABLE { 0.0 } else { f64::from(places.saturating_sub(1)) * steps }
        });
        along.fold(0.0, f64::greatest) as u32
    }

    /// The space and the place in a state.
    fn cell(&self, sim: &Simulator, state: &[u8]) -> (SpaceId, usize) {
        let space = sim.space(state, self.slot);
        (space, self.grids[space.index()].cell(sim.position(state, self.slot)))
    }
}

/// The maximum velocity of a player along an axis, px/s; infinite if unknown.
fn fastest(space: &ConfigurationSpace, player: SlotId, var: VarId) -> f64 {
    let slot = &space.slots[player];
    if slot.is_given_up {
        return f64::INFINITY;
    }
    let velocities = slot.configurations.iter().flat_map(|c| c.vars[var][1].intervals());
    velocities.map(|v| v.low.abs().greatest(v.high.abs())).fold(0.0, f64::greatest)
}

/// The cost of the cheapest path to the goal from each place, by a 0-1 breadth-first search. Incomplete if the meter
/// runs out.
pub(super) fn flood(
    grids: &[Grid],
    problem: &Problem<'_>,
    goal: &[PositionBox],
    [across, along, through]: Costs,
    meter: &Meter<'_>,
) -> CostField {
    let mut field: CostField = grids.iter().map(|grid| vec![UNREACHABLE; grid.blocked.len()]).collect();
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
        // The last place before a seam may be narrower than the others, so the way over it costs nothing.
        let [around, up] = spaces[space].periods.map(|period| period.is_some());
        let (last, top) = (grid.columns - 1, grid.rows - 1);
        let seams = [
            (around && column == 0).then(|| cell + last),
            (around && column == last).then(|| cell - last),
            (up && row == 0).then(|| cell + top * grid.columns),
            (up && row == top).then(|| cell - top * grid.columns),
        ];
        seams.into_iter().flatten().for_each(|cell| go(space, cell, 0));
        // Links are followed backwards, from exit to entrance.
        let at = (grid.left + column as f64 * PLACE, grid.bottom + row as f64 * PLACE);
        for (from, link) in spaces.pairs().flat_map(|(id, s)| s.links.iter().map(move |l| (id, l))) {
            let is_out =
                |to: PositionBox| at.0 <= to.x.1 && to.x.0 <= at.0 + PLACE && at.1 <= to.y.1 && to.y.0 <= at.1 + PLACE;
            let to =
                PositionBox { space: Some(space), x: (link.to.left, link.to.right), y: (link.to.bottom, link.to.top) };
            if link.space == space && images(problem.sim.world(), to).into_iter().any(is_out) {
                let (x, y) = ((link.from.left, link.from.right), (link.from.bottom, link.from.top));
                grids[from.index()].cells(x, y).into_iter().for_each(|cell| go(from, cell, through));
            }
        }
    }
    field
}

/// Whether something with some tags blocks a body.
fn blocks(world: &World, mine: TagSet, tags: TagSet) -> bool {
    push(world, mine, tags) == Push::Block
}

/// How something with some tags pushes a body.
pub(super) fn push(world: &World, mine: TagSet, tags: TagSet) -> Push {
    world.meeting(mine, tags).map_or(Push::Sense, |meeting| meeting.response.push)
}

/// The tags of each kind of tiles.
fn kinds(space: &Space) -> Vec<TagSet> {
    space.map.iter().flat_map(|map| &map.kinds).map(|kind| kind.tags.iter().copied().collect()).collect()
}

/// The core of the player's body, which static obstacles of a space hold up, with its tags: the intersection of all its
/// shapes, as a shape that is seldom active says little about where the player fits.
pub(super) fn body(
    problem: &Problem<'_>,
    player: SlotId,
    id: SpaceId,
    holds: impl Fn(TagSet, TagSet) -> bool,
) -> Option<(TagSet, Bounds)> {
    let world = problem.sim.world();
    let entity = &problem.sim.program().entities[world.slots[player].entity];
    let (space, kinds) = (&world.spaces[id], kinds(&world.spaces[id]));
    let bodies = entity.colliders.iter().filter(|c| {
        let by_solid = space.solids.iter().any(|solid| holds(c.tags, solid.tags));
        !c.kinematic && (by_solid || kinds.iter().any(|tags| holds(c.tags, *tags)))
    });
    let mut core: Option<(TagSet, Bounds)> = None;
    for collider in bodies {
        let extent = extent(problem, player, collider)?;
        core = Some(match core {
            None => (collider.tags, extent),
            Some((tags, b)) => (
                tags,
                Bounds {
                    left: b.left.greatest(extent.left),
                    right: b.right.least(extent.right),
                    bottom: b.bottom.greatest(extent.bottom),
                    top: b.top.least(extent.top),
                },
            ),
        });
    }
    core
}

impl Grid {
    fn new(
        problem: &Problem<'_>,
        player: SlotId,
        id: SpaceId,
        goal: &[PositionBox],
        meter: &Meter<'_>,
    ) -> Option<Self> {
        let world = problem.sim.world();
        let space = &world.spaces[id];
        let area = match space.bounds {
            Some(bounds) => Bounds { top: bounds.top + MARGIN, ..bounds },
            None => around(problem, player, id, goal),
        };
        let [x, y] = space.periods;
        let area = Bounds {
            left: x.map_or(area.left, |x| x.low),
            right: x.map_or(area.right, |x| x.high),
            bottom: y.map_or(area.bottom, |y| y.low),
            top: y.map_or(area.top, |y| y.high),
        };
        let count = |low: f64, high: f64| ((high - low) / PLACE).ceil().greatest(1.0);
        let (columns, rows) = (count(area.left, area.right), count(area.bottom, area.top));
        if columns * rows > MAX_PLACES as f64 {
            return None;
        }
        let (columns, rows) = (columns as usize, rows as usize);
        let places = columns * rows;
        let core = body(problem, player, id, |mine, tags| blocks(world, mine, tags));
        let mut grid = Grid { left: area.left, bottom: area.bottom, columns, rows, core, blocked: vec![0; places] };
        grid.block(problem, id, meter);
        Some(grid)
    }

    /// Marks the positions at which the player overlaps static obstacles.
    fn block(&mut self, problem: &Problem<'_>, id: SpaceId, meter: &Meter<'_>) {
        let Some((tags, _)) = self.core else { return };
        let (world, space) = (problem.sim.world(), &problem.sim.world().spaces[id]);
        for solid in space.solids.iter().filter(|solid| blocks(world, tags, solid.tags)) {
            self.close(problem, id, solid.bounds, meter);
        }
        let Some(map) = &space.map else { return };
        // A tile that can be broken is no wall, nor is a slope: the distance is too short rather than too long.
        let is_wall = |(tags_of, kind): (&TagSet, &TileKind<TagId>)| kind.lasts() && blocks(world, tags, *tags_of);
        let is_wall: Vec<bool> = kinds(space).iter().zip(&map.kinds).map(is_wall).collect();
        for (cell, _) in map.cells.iter().enumerate().filter(|(_, kind)| is_wall[usize::from(**kind)]) {
            self.close(problem, id, Bounds::new(map.rectangle(cell)), meter);
        }
    }

    /// Whether something with some tags blocks the player.
    pub fn is_blocked_by(&self, problem: &Problem<'_>, tags: TagSet) -> bool {
        self.core.is_some_and(|(mine, _)| blocks(problem.sim.world(), mine, tags))
    }

    /// Marks the positions at which the player overlaps a box.
    pub fn close(&mut self, problem: &Problem<'_>, id: SpaceId, wall: Bounds, meter: &Meter<'_>) {
        let Some((_, core)) = self.core else { return };
        let all = PositionBox { space: Some(id), x: (wall.left, wall.right), y: (wall.bottom, wall.top) };
        for PositionBox { x: (left, right), y: (bottom, top), .. } in images(problem.sim.world(), all) {
            self.mark(Bounds { left, right, bottom, top }, core, meter);
        }
    }

    /// Marks the positions at which a body overlaps a box.
    fn mark(&mut self, wall: Bounds, body: Bounds, meter: &Meter<'_>) {
        // They overlap strictly between these positions.
        let (left, right) = (wall.left - body.right, wall.right - body.left);
        let (bottom, top) = (wall.bottom - body.top, wall.top - body.bottom);
        let apart = PLACE / SAMPLES as f64;
        let range = |low: f64, high: f64, from: f64, count: usize| {
            let first = ((low - from) / apart).floor() + 1.0;
            let after = ((high - from) / apart).ceil();
            let most = (count * SAMPLES) as f64;
            (first.clamp(0.0, most) as usize)..(after.clamp(0.0, most) as usize)
        };
        let across = range(left, right, self.left, self.columns);
        for y in range(bottom, top, self.bottom, self.rows) {
            if meter.spend(across.len() as u64 + 8) {
                return;
            }
            for x in across.clone() {
                let bit = (y % SAMPLES) * SAMPLES + x % SAMPLES;
                self.blocked[(y / SAMPLES) * self.columns + x / SAMPLES] |= 1 << bit;
            }
        }
    }

    /// The cells that a box overlaps.
    pub fn cells(&self, x: (f64, f64), y: (f64, f64)) -> Vec<usize> {
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

    /// The place of a position.
    pub fn cell(&self, (x, y): (f64, f64)) -> usize {
        let at = |value: f64, low: f64, count: usize| (((value - low) / PLACE).greatest(0.0) as usize).min(count - 1);
        at(y, self.bottom, self.rows) * self.columns + at(x, self.left, self.columns)
    }

    /// Whether the player fits somewhere in a place.
    fn is_free(&self, cell: usize) -> bool {
        self.blocked[cell] != u16::MAX
    }
}

/// A box around the known contents of a space without bounds. Around a map, only places with contents count: paths
/// around the outside are seldom possible, and would be short.
fn around(problem: &Problem<'_>, player: SlotId, id: SpaceId, goal: &[PositionBox]) -> Bounds {
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

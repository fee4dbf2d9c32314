//! Where the way of a player that falls ends in the direction of a goal: the place nearest to it on which the player
//! stood in the search, and what is between there and the goal according to the map and free-standing geometry. A
//! barrier is named only if it is larger than every jump that was seen.

use crate::ir::{Bounds, Drive, EntityId, Extremes, Push, SlotId, SpaceId, TagSet, VarId};
use crate::sim::Simulator;

use super::super::coverage::PLACE;
use super::super::explore::{Explorer, Top};
use super::super::goal_positions::{PositionBox, goal_positions};
use super::super::problem::Problem;
use super::explain::column;
use super::gauge::Seen;
use super::record::{Barrier, WayEnd};
use super::words::shown;

/// How near a body is to what it stands on, px.
const NEAR: f64 = 0.05;
/// How near two pieces of footing are that have no gap between them, px.
const SEAM: f64 = 0.5;

/// A place at which the player stood.
struct Stand {
    space: SpaceId,
    at: (f64, f64),
    body: Bounds,
}

/// Where the way ends. `None` if the player does not fall, or if the goal is not at a place.
pub(super) fn way_end(problem: &Problem<'_>, seen: &Seen) -> Option<WayEnd> {
    let (player, goals) = goal_positions(problem)?;
    if problem.players().first() != Some(&player) || !falls(problem, player) {
        return None;
    }
    let explored = Explorer::new(problem.sim).explored();
    let mut nearest: Option<((f64, f64), Stand, PositionBox)> = None;
    for state in &seen.rests {
        let space = problem.sim.space(state, player);
        let Some(stand) = stand(problem.sim, player, state, &explored.spaces.get(space.0 as usize)?.tops) else {
            continue;
        };
        for goal in &goals {
            let Some(away) = goal.away(space, stand.at) else { continue };
            if nearest.as_ref().is_none_or(|(known, ..)| away < *known) {
                nearest = Some((away, Stand { ..stand }, *goal));
            }
        }
    }
    let ((across, _), stand, goal) = nearest?;
    let tops = &explored.spaces.get(stand.space.0 as usize)?.tops;
    let terrain = Terrain { problem, player, space: stand.space, tops };
    Some(if across > 0.0 { terrain.ahead(&stand, &goal, seen) } else { terrain.above(&stand, &goal, seen) })
}

/// Whether something pulls a player down.
fn falls(problem: &Problem<'_>, player: SlotId) -> bool {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let slot = &world.slots[player];
    let entity = &program.entities[slot.entity];
    let mut drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|leaf| &leaf.drives));
    drives.any(|drive| match drive {
        Drive::Flow { var: VarId::Y, degree: 2, value } => {
            program.constant(*value, &slot.params, world.step).is_some_and(|value| value < 0.0)
        }
        _ => false,
    })
}

/// Where a player stands in a state, if it stands on geometry.
fn stand(sim: &Simulator, player: SlotId, state: &[u8], tops: &[Top]) -> Option<Stand> {
    let instance = sim.instance(state, player);
    let at = instance.position();
    let is_solid = |tags: TagSet| {
        let mut pushing = sim.world().collide.iter().filter(|line| line.response.push != Push::Sense);
        pushing.any(|line| line.left.meets(tags) || line.right.meets(tags))
    };
    let bodies = instance.colliders().filter(|(id, _)| is_solid(instance.entity().colliders[*id].tags));
    let mut bodies = bodies.map(|(_, body)| body.placed(at));
    bodies
        .find(|body| {
            tops.iter().any(|top| (body.bottom - top.y).abs() <= NEAR && body.left < top.to && body.right > top.from)
        })
        .map(|body| Stand { space: instance.space(), at, body })
}

/// What is between a place and a goal.
struct Terrain<'a> {
    problem: &'a Problem<'a>,
    player: SlotId,
    space: SpaceId,
    tops: &'a [Top],
}

impl Terrain<'_> {
    fn entity(&self) -> EntityId {
        self.problem.sim.world().slots[self.player].entity
    }

    /// The geometry that blocks the player.
    fn blocks(&self) -> Vec<Bounds> {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let space = &world.spaces[self.space];
        let blocks = |tags: TagSet| world.strongest_push(program, [self.entity()], tags) == Some(Push::Block);
        let mut all: Vec<Bounds> =
            space.solids.iter().filter(|solid| blocks(solid.tags)).map(|solid| solid.bounds).collect();
        if let Some(map) = &space.map {
            let is_wall: Vec<bool> = map
                .kinds
                .iter()
                .map(|kind| kind.slope.is_none() && blocks(kind.tags.iter().copied().collect()))
                .collect();
            let cells = map.cells.iter().enumerate();
            let walls = cells.filter(|(_, kind)| is_wall.get(usize::from(**kind)).copied().unwrap_or(false));
            all.extend(walls.map(|(cell, _)| Bounds::new(map.rectangle(cell))));
        }
        all
    }

    /// A goal above or below the place.
    fn above(&self, stand: &Stand, goal: &PositionBox, seen: &Seen) -> WayEnd {
        let needed = goal.y.0 - stand.at.1;
        if needed <= seen.highest.size || !needed.is_finite() {
            return self.unknown(stand);
        }
        let size = self.sized(needed, stand.space, 1);
        let words =
            format!("from {} the goal needs a rise of {size}, and {}", self.place(stand), highest(seen, Some(needed)));
        self.end(stand, Barrier::Height, Some((needed, 1)), words)
    }

    /// A goal to the left or to the right.
    fn ahead(&self, stand: &Stand, goal: &PositionBox, seen: &Seen) -> WayEnd {
        // Everything is mirrored if the goal is to the left.
        let sign = if goal.x.0 > stand.at.0 { 1.0 } else { -1.0 };
        let turned = |low: f64, high: f64| if sign > 0.0 { (low, high) } else { (-high, -low) };
        let (back, front) = turned(stand.body.left, stand.body.right);
        let (feet, head) = (stand.body.bottom, stand.body.top);
        let tops: Vec<(f64, f64, f64)> = self
            .tops
            .iter()
            .map(|top| {
                let (from, to) = turned(top.from, top.to);
                (from, to, top.y)
            })
            .collect();
        // How far the floor goes on at this height.
        let mut edge = f64::NEG_INFINITY;
        let floor = |from: f64, to: f64, y: f64| (y - feet).abs() <= NEAR && from < front && to > back;
        for (_, to, _) in tops.iter().filter(|(from, to, y)| floor(*from, *to, *y)) {
            edge = edge.greatest(*to);
        }
        while let Some((_, to, _)) =
            tops.iter().find(|(from, to, y)| (y - feet).abs() <= NEAR && *from <= edge + SEAM && *to > edge + SEAM)
        {
            edge = *to;
        }
        let goal_at = if sign > 0.0 { goal.x.0 } else { -goal.x.1 };
        let blocks: Vec<Bounds> = self
            .blocks()
            .into_iter()
            .map(|b| {
                let (left, right) = turned(b.left, b.right);
                Bounds { left, right, ..b }
            })
            .collect();
        let faces = |b: &&Bounds| b.left >= front - SEAM && b.bottom < head - NEAR && b.top > feet + NEAR;
        let wall = blocks.iter().filter(faces).min_by(|a, b| a.left.total_cmp(&b.left));
        // What is further away was not seen to be where the way ends.
        let is_close = |end: f64| end - front <= 2.0 * PLACE;
        let is_in_front = |wall: &&Bounds| wall.left <= edge + SEAM && wall.left <= goal_at + (front - back);
        if let Some(wall) = wall.filter(is_in_front) {
            if !is_close(wall.left) {
                return self.unknown(stand);
            }
            return self.wall(&self.moved(stand, sign * wall.left, sign), &blocks, wall.left, seen);
        }
        if edge >= goal_at || edge == f64::NEG_INFINITY || !is_close(edge) {
            return self.unknown(stand);
        }
        let stand = self.moved(stand, sign * edge, sign);
        let ahead = || tops.iter().filter(|(_, to, _)| *to > edge + SEAM);
        let is_in_reach = |top: &&(f64, f64, f64)| top.2 - feet <= seen.highest.size;
        // What is too high to jump on, like a ceiling, is no end of a gap as long as there is another one.
        let is_any_in_reach = ahead().any(|top| is_in_reach(&top));
        let ends = || ahead().filter(|top| !is_any_in_reach || is_in_reach(top));
        let next = ends().map(|(from, ..)| from.greatest(edge)).fold(f64::INFINITY, f64::least);
        let width = next - edge;
        let beyond = ends().filter(|(from, ..)| from.greatest(edge) <= next + SEAM);
        let rise = beyond.map(|(.., y)| y - feet).fold(f64::INFINITY, f64::least).greatest(0.0);
        if next == f64::INFINITY {
            let words = format!("{}: no footing from there to the goal, and {}", self.ends(&stand), longest(seen));
            return self.end(&stand, Barrier::Gap, None, words);
        }
        // A body is on both sides of a gap a little.
        if width - (front - back) > seen.longest.size {
            let size = self.sized(width, stand.space, 0);
            let words = format!("{}: a gap of {size}, and {}", self.ends(&stand), longest(seen));
            return self.end(&stand, Barrier::Gap, Some((width, 0)), words);
        }
        if rise > seen.highest.size {
            let words = format!(
                "{}: the next footing is {} higher, and {}",
                self.ends(&stand),
                self.sized(rise, stand.space, 1),
                highest(seen, Some(rise))
            );
            return self.end(&stand, Barrier::Height, Some((rise, 1)), words);
        }
        self.unknown(&stand)
    }

    /// A wall that begins at a distance along the way.
    fn wall(&self, stand: &Stand, blocks: &[Bounds], from: f64, seen: &Seen) -> WayEnd {
        let mut top = stand.body.bottom;
        // A body does not fit through a lower opening.
        let height = stand.body.top - stand.body.bottom;
        while let Some(block) = blocks.iter().find(|b| {
            b.left <= from + SEAM && b.right > from + SEAM && b.top > top + NEAR && b.bottom < top + height - NEAR
        }) {
            top = block.top;
        }
        let rise = top - stand.body.bottom;
        if rise <= seen.highest.size {
            return self.unknown(stand);
        }
        let space = &self.problem.sim.world().spaces[stand.space];
        let is_closed = space.map_rectangle().is_some_and(|map| top >= map.top - NEAR);
        let high = if is_closed { ", up to the top of the map".to_string() } else { String::new() };
        let size = self.sized(rise, stand.space, 1);
        let words = format!("{}: a wall of {size}{high}, and {}", self.ends(stand), highest(seen, Some(rise)));
        self.end(stand, Barrier::Wall, Some((rise, 1)), words)
    }

    /// As if the player stood at the end of its way.
    fn moved(&self, stand: &Stand, end: f64, sign: f64) -> Stand {
        let half = (stand.body.right - stand.body.left) / 2.0;
        let by = end - sign * half - f64::midpoint(stand.body.left, stand.body.right);
        let body = Bounds { left: stand.body.left + by, right: stand.body.right + by, ..stand.body };
        Stand { body, at: (stand.at.0 + by, stand.at.1), ..*stand }
    }

    fn unknown(&self, stand: &Stand) -> WayEnd {
        let words = format!("the player stood nearest at {}; nothing is known to bar the way on", self.place(stand));
        self.end(stand, Barrier::Unknown, None, words)
    }

    fn ends(&self, stand: &Stand) -> String {
        format!("the way ends at {}", self.place(stand))
    }

    fn column(&self, stand: &Stand) -> Option<usize> {
        let middle = f64::midpoint(stand.body.left, stand.body.right);
        column(&self.problem.sim.world().spaces[stand.space], middle)
    }

    fn place(&self, stand: &Stand) -> String {
        let spaces = &self.problem.sim.world().spaces;
        let at = match self.column(stand) {
            Some(column) => format!("column {column}"),
            None => format!("({}, {})", shown(stand.at.0), shown(stand.at.1)),
        };
        if spaces.len() > 1 { format!("{at} of `{}`", spaces[stand.space].name) } else { at }
    }

    fn tiles(&self, size: f64, space: SpaceId, axis: usize) -> Option<f64> {
        let map = self.problem.sim.world().spaces[space].map.as_ref()?;
        Some(size / if axis == 0 { map.tile.0 } else { map.tile.1 })
    }

    /// A length in px, and in tiles where there is a map.
    fn sized(&self, size: f64, space: SpaceId, axis: usize) -> String {
        match self.tiles(size, space, axis) {
            Some(tiles) => {
                let tiles = shown((tiles * 10.0).round() / 10.0);
                format!("{tiles} tile{} ({} px)", if tiles == "1" { "" } else { "s" }, shown(size))
            }
            None => format!("{} px", shown(size)),
        }
    }

    fn end(&self, stand: &Stand, barrier: Barrier, size: Option<(f64, usize)>, words: String) -> WayEnd {
        WayEnd {
            space: self.problem.sim.world().spaces[stand.space].name.clone(),
            x: stand.at.0,
            y: stand.at.1,
            column: self.column(stand),
            barrier,
            size: size.map(|(size, _)| size),
            tiles: size.and_then(|(size, axis)| self.tiles(size, stand.space, axis)),
            words,
        }
    }
}

/// The highest jump that was seen. It is rounded down where it would look as high as what is needed.
fn highest(seen: &Seen, needed: Option<f64>) -> String {
    let size = seen.highest.size;
    if size <= 0.0 {
        return "no jump was seen".to_string();
    }
    let text = shown(size);
    let is_same = needed.is_some_and(|needed| shown(needed) == text);
    let text = if is_same { format!("{size:.3}") } else { text };
    format!("the highest jump seen rises {text} px")
}

/// The longest jump that was seen.
fn longest(seen: &Seen) -> String {
    if seen.longest.size <= 0.0 {
        return "no jump to the same height was seen".to_string();
    }
    format!("the longest jump seen is {} px long", shown(seen.longest.size))
}

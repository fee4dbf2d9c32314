//! Collisions: every pair is checked, tiles are separate rectangles.

use hypedc::ir::{Breakable, Push, Response, Side, TagId};

use std::collections::BTreeSet;

use hypedc::sema::checked::{CollideRule, Shape};

use super::model::{Along, Contact, Fault, Oracle, State};
use super::slope::Ends;
use super::step::Passing;

/// Maximum previous overlap that counts as outside, px.
pub const TOLERANCE: f64 = 0.001;

/// A rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    pub left: f64,
    pub bottom: f64,
    pub right: f64,
    pub top: f64,
}

impl Area {
    fn new([x, y, width, height]: [f64; 4]) -> Self {
        Area { left: x, bottom: y, right: x + width, top: y + height }
    }
}

/// A collider, tile or rectangle.
#[derive(Debug, Clone)]
pub struct Body {
    /// The instance; none for tiles and rectangles.
    pub slot: Option<usize>,
    pub tags: BTreeSet<TagId>,
    /// Whether it is never pushed.
    pub fixed: bool,
    pub area: Area,
    /// Centre and radius of a disc.
    pub disc: Option<(f64, f64, f64)>,
    /// The displacement back to its position at the beginning of the flows.
    pub back: (f64, f64),
    /// The space of static geometry.
    pub space: Option<usize>,
    /// The column and the row of a tile.
    pub tile: Option<(i64, i64)>,
    /// The line up to which a tile is solid.
    pub slope: Option<Ends>,
}

/// A face of static geometry.
struct Face {
    at: f64,
    /// Whether its normal points towards larger coordinates.
    looks_up: bool,
}

impl Face {
    /// Whether an interval from `low` to `high` is adjacent to it on the outside.
    fn is_outside(&self, low: f64, high: f64) -> bool {
        match self.looks_up {
            true => low <= self.at + TOLERANCE && high > self.at + TOLERANCE,
            false => high >= self.at - TOLERANCE && low < self.at - TOLERANCE,
        }
    }
}

/// Whether intervals cover all from `low` to `high`.
fn covers(stretches: Vec<(f64, f64)>, low: f64, high: f64) -> bool {
    let (mut reach, mut is_met) = (low, false);
    loop {
        let before = reach;
        for (start, end) in &stretches {
            if *start <= reach + TOLERANCE && *end >= reach - TOLERANCE {
                is_met = true;
                reach = reach.max(*end);
            }
        }
        if is_met && reach >= high - TOLERANCE {
            return true;
        }
        if reach <= before {
            return false;
        }
    }
}

/// A contact of two bodies.
pub struct Meeting {
    pub one: usize,
    pub two: usize,
    pub response: Response,
    /// The side of the first one.
    pub side: Side,
    /// The sides of the first one on which it is pushed, and the distances.
    pub pushes: Vec<(Side, f64)>,
    /// Whether the first one has left tags of the line, and the second one right ones.
    pub first_on_second: bool,
    /// The same with the roles exchanged.
    pub second_on_first: bool,
    /// How far the first one is moved down, since it walks down a slope.
    pub lowers: f64,
    /// How far along x the first one was moved before it was looked at.
    pub moved: f64,
}

impl Oracle<'_> {
    /// Finds the contacts before the first step; nothing is pushed.
    pub fn find_contacts(&self, state: &mut State, passing: &Passing) -> Result<(), Fault> {
        let mut start = state.clone();
        self.come_in(&mut start, state);
        let bodies = self.bodies(&start, state, passing)?;
        let meetings = self.all_meetings(&bodies, state, false);
        self.note(state, &bodies, &meetings);
        Ok(())
    }

    /// All contacts: those with slopes after all others; with `keep`, what walks is kept on the ground.
    fn all_meetings(&self, bodies: &[Body], state: &State, keep: bool) -> Vec<Meeting> {
        let mut meetings = self.meetings(bodies, state);
        let net = |meetings: &[Meeting], slot: usize, (low, high): (Side, Side)| {
            let pushes = pushes_of(slot, bodies, meetings);
            let deepest = |side: Side| pushes.iter().filter(|p| p.0 == side).map(|p| p.1).fold(0.0, f64::max);
            let (up, down) = (deepest(low), deepest(high));
            if up >= down { up } else { -down }
        };
        let slots = 0..state.things.len();
        let pushed: Vec<f64> = slots.clone().map(|slot| net(&meetings, slot, (Side::Left, Side::Right))).collect();
        meetings.extend(self.slope_meetings(bodies, state, &pushed));
        for slot in slots.filter(|slot| keep && state.things[*slot].is_some()) {
            let is_free =
                pushes_of(slot, bodies, &meetings).iter().all(|(side, ..)| [Side::Left, Side::Right].contains(side));
            if is_free {
                meetings.extend(self.kept(bodies, state, slot, pushed[slot]));
            }
        }
        meetings
    }

    /// `start` is the state as the flows of this step began.
    pub fn collide(&self, start: &State, state: &mut State, passing: &Passing) -> Result<(), Fault> {
        self.carry(start, state, passing);
        let mut start = start.clone();
        self.come_in(&mut start, state);
        let bodies = self.bodies(&start, state, passing)?;
        let meetings = self.all_meetings(&bodies, state, true);
        self.note(state, &bodies, &meetings);
        self.push(state, &bodies, &meetings);
        self.come_in(&mut start, state);
        Ok(())
    }

    /// Moves riders along with their carriers, starting from carriers that do not ride.
    fn carry(&self, start: &State, state: &mut State, passing: &Passing) {
        let of = |slot: usize| state.things[slot].as_ref().filter(|_| passing.acts(slot)).and_then(|t| t.carrier);
        let mut riders: Vec<(usize, usize)> =
            (0..state.things.len()).filter_map(|slot| Some((slot, of(slot)?))).collect();
        while !riders.is_empty() {
            let is_free = |(_, on): &(usize, usize)| riders.iter().all(|(rider, _)| rider != on);
            // In a cycle the lowest slot goes first.
            let next = riders.iter().position(is_free).unwrap_or(0);
            let (slot, on) = riders.remove(next);
            let (Some(was), Some(is)) = (&start.things[on], &state.things[on]) else { continue };
            let thing = state.things[slot].as_ref().unwrap();
            if !passing.acts(on) || is.space != thing.space {
                continue;
            }
            let way = [0, 1].map(|axis| is.vars[axis][0] - was.vars[axis][0]);
            let thing = state.things[slot].as_mut().unwrap();
            thing.vars[0][0] += way[0];
            thing.vars[1][0] += way[1];
        }
    }

    /// All active colliders.
    fn bodies(&self, start: &State, state: &State, passing: &Passing) -> Result<Vec<Body>, Fault> {
        let mut bodies = Vec::new();
        for (slot, thing) in state.things.iter().enumerate() {
            let Some(thing) = thing.as_ref().filter(|_| passing.acts(slot)) else { continue };
            let code = self.code(state, slot);
            for collider in self.entity(slot).colliders.iter() {
                let is_there = match &collider.guard {
                    Some(guard) => code.holds(guard)?,
                    None => true,
                };
                if !is_there {
                    continue;
                }
                let numbers: Result<Vec<f64>, Fault> = collider.shape.numbers().iter().map(|t| code.value(t)).collect();
                let (numbers, (x, y)) = (numbers?, thing.position());
                let from = start.things[slot].as_ref().unwrap().position();
                let area = match (&collider.shape, numbers.as_slice()) {
                    (Shape::Rect(_), &[dx, dy, width, height]) => Area::new([x + dx, y + dy, width, height]),
                    (Shape::Circle(_), &[dx, dy, r]) => Area::new([x + (dx - r), y + (dy - r), 2.0 * r, 2.0 * r]),
                    _ => unreachable!(),
                };
                let middle = |low: f64, high: f64| (low + high) / 2.0;
                let disc = matches!(collider.shape, Shape::Circle(_)).then(|| {
                    (middle(area.left, area.right), middle(area.bottom, area.top), (area.right - area.left) / 2.0)
                });
                let is_empty = match (&collider.shape, numbers.as_slice()) {
                    (Shape::Rect(_), &[.., width, height]) => width <= 0.0 || height <= 0.0,
                    (_, numbers) => numbers[2] <= 0.0,
                };
                if is_empty {
                    continue;
                }
                bodies.push(Body {
                    slot: Some(slot),
                    tags: collider.tags.iter().copied().collect(),
                    fixed: collider.kinematic,
                    area,
                    disc,
                    back: (from.0 - x, from.1 - y),
                    space: None,
                    tile: None,
                    slope: None,
                });
            }
        }
        for space in 0..self.world.spaces.len() {
            bodies.extend(self.still(space, state));
        }
        Ok(bodies)
    }

    /// The static geometry of a space.
    fn still(&self, number: usize, state: &State) -> Vec<Body> {
        let space = self.world.spaces.iter().nth(number).unwrap();
        let body = |tags: &[TagId], area: Area, tile| Body {
            slot: None,
            tags: tags.iter().copied().collect(),
            fixed: true,
            area,
            disc: None,
            back: (0.0, 0.0),
            space: Some(number),
            tile,
            slope: None,
        };
        let mut bodies: Vec<Body> = space.solids.iter().map(|s| body(&s.tags, Area::new(s.rect), None)).collect();
        if let Some(map) = &space.map {
            for row in 0..map.rows {
                for column in 0..map.columns {
                    let kind = &map.kinds[usize::from(map.cells[row * map.columns + column])];
                    let tags = &kind.tags;
                    let is_there = !state.broken.contains_key(&(number, row * map.columns + column));
                    if is_there && !tags.is_empty() {
                        let (width, height) = map.tile;
                        let area = Area {
                            left: column as f64 * width,
                            bottom: row as f64 * height,
                            right: column as f64 * width + width,
                            top: row as f64 * height + height,
                        };
                        let slope = kind.slope.map(|slope| Ends { left: slope.left, right: slope.right });
                        bodies.push(Body { slope, ..body(tags, area, Some((column as i64, row as i64))) });
                    }
                }
            }
        }
        let size = space.map.as_ref().map_or((0, 0), |map| (map.columns as i64, map.rows as i64));
        bodies.into_iter().flat_map(|body| self.repeated(body, size)).collect()
    }

    /// The space and the cell of a tile.
    fn cell(&self, body: &Body) -> Option<(usize, usize)> {
        let (space, (column, row)) = (body.space?, body.tile?);
        let map = self.space(space).map.as_ref()?;
        let (column, row) = (column.rem_euclid(map.columns as i64), row.rem_euclid(map.rows as i64));
        Some((space, row as usize * map.columns + column as usize))
    }

    /// Whether the tile of a cell can be broken, and how.
    pub fn breakable(&self, space: usize, cell: usize) -> Option<Breakable> {
        let map = self.space(space).map.as_ref()?;
        map.kinds[usize::from(map.cells[cell])].breakable
    }

    /// The response to a contact: the strongest of all matching lines; and whether the first body has left tags of such
    /// a line and the second one right ones, and with the roles exchanged.
    pub fn response(&self, one: &Body, two: &Body) -> Option<(Response, bool, bool)> {
        let has = |body: &Body, tags: &[TagId]| tags.iter().any(|t| body.tags.contains(t));
        let matches = |line: &CollideRule| {
            let ways = (has(one, &line.left) && has(two, &line.right), has(two, &line.left) && has(one, &line.right));
            (ways != (false, false)).then_some((line.response, ways.0, ways.1))
        };
        let all: Vec<(Response, bool, bool)> = self.world.collide.iter().filter_map(matches).collect();
        let strongest = all.iter().map(|(response, ..)| *response).max()?;
        let strong = || all.iter().filter(|(response, ..)| *response == strongest);
        Some((strongest, strong().any(|line| line.1), strong().any(|line| line.2)))
    }

    /// All pairs that touch. The first one is an instance's.
    fn meetings(&self, bodies: &[Body], state: &State) -> Vec<Meeting> {
        let space = |body: &Body| body.slot.map(|slot| state.things[slot].as_ref().unwrap().space);
        let count = bodies.iter().filter(|b| b.slot.is_some()).count();
        let mut meetings = Vec::new();
        for i in 0..count {
            for j in 0..bodies.len() {
                let (one, two) = (&bodies[i], &bodies[j]);
                if two.slope.is_some() {
                    continue;
                }
                let is_pair =
                    if j < count { two.slot > one.slot && space(two) == space(one) } else { two.space == space(one) };
                let seen = match two.slot.filter(|_| is_pair) {
                    Some(_) => self.seen(space(one).unwrap(), one, two),
                    None => vec![(one.clone(), two.clone())],
                };
                if is_pair {
                    meetings.extend(seen.iter().filter_map(|(one, two)| self.meeting((i, j), (one, two), bodies)));
                }
            }
        }
        meetings
    }

    fn meeting(&self, (i, j): (usize, usize), (one, two): (&Body, &Body), bodies: &[Body]) -> Option<Meeting> {
        let (response, first_on_second, second_on_first) = self.response(one, two)?;
        let (a, b) = (one.area, two.area);
        // The approach of the second one in the frame of the first.
        let (back_x, back_y) = (one.back.0 - two.back.0, one.back.1 - two.back.1);
        // The distance that the first one would have to move to each side.
        let (to_left, to_right) = (a.right - b.left, b.right - a.left);
        let (to_below, to_above) = (a.top - b.bottom, b.top - a.bottom);
        let ways = [to_left, to_right, to_below, to_above];
        let lies_against = |along: [f64; 2]| along.contains(&0.0);
        let is_corner = lies_against([to_left, to_right]) && lies_against([to_below, to_above]);
        if ways.iter().any(|way| *way < 0.0) || is_corner {
            return None;
        }
        let met = |side, depth| Meeting {
            one: i,
            two: j,
            response,
            pushes: vec![(side, depth)],
            side,
            first_on_second,
            second_on_first,
            lowers: 0.0,
            moved: 0.0,
        };
        if response.push == Push::FromAbove {
            if first_on_second && b.top - (a.bottom + back_y) <= TOLERANCE {
                return Some(met(Side::Below, to_above));
            }
            if second_on_first && (a.top + back_y) - b.bottom <= TOLERANCE {
                return Some(met(Side::Above, to_below));
            }
            return None;
        }
        if response.push == Push::Sense && (one.disc.is_some() || two.disc.is_some()) && !shapes_meet(one, two) {
            return None;
        }
        // On each axis it moves back in the direction that it came from.
        let from_left = to_left + back_x <= to_right - back_x;
        let from_below = to_below + back_y <= to_above - back_y;
        let level = if from_left { (Side::Right, to_left) } else { (Side::Left, to_right) };
        let upright = if from_below { (Side::Above, to_below) } else { (Side::Below, to_above) };
        let neighbour = |dx: i64, dy: i64| {
            let other = two.tile.and_then(|_| self.tile_beside(bodies, one, two, (dx, dy)));
            other.filter(|other| self.response(one, other).is_some_and(|(r, ..)| r.push == Push::Block))
        };
        // A slope covers a side that it is as high as.
        let is_level_face_covered = |dx: i64| {
            let size = two.area.top - two.area.bottom;
            two.tile.is_some()
                && self.height_beside(bodies, one, two, dx).is_some_and(|height| height >= size - TOLERANCE)
        };
        let least = if level.1 < upright.1 { level } else { upright };
        let mut is_level_covered = is_level_face_covered(if from_left { -1 } else { 1 });
        let mut is_upright_covered =
            neighbour(0, if from_below { -1 } else { 1 }).is_some_and(|other| match other.slope {
                None => true,
                // The upper face of what is under a slope, for what does not come from above and can be pushed aside.
                Some(_) => {
                    let at = Body { area: self.cell_area(two, (0, 1)).unwrap(), ..other.clone() };
                    !from_below && !is_level_covered && !self.came_from_above(bodies, one, &at, one.start())
                }
            });
        // Faces between tiles depend only on neighbours; rectangles count up to a cell further.
        let is_near_rectangle = self.is_near_rectangle(bodies, two);
        if two.slot.is_none() && is_near_rectangle && !(is_level_covered && is_upright_covered) {
            // The part of a face beside the first one, and the direction of its normal.
            let x = Face { at: if from_left { b.left } else { b.right }, looks_up: !from_left };
            let y = Face { at: if from_below { b.bottom } else { b.top }, looks_up: !from_below };
            let (bottom, top) = (a.bottom.max(b.bottom), a.top.min(b.top));
            let (left, right) = (a.left.max(b.left), a.right.min(b.right));
            let blocks = |other: &&Body| {
                other.space == two.space && self.response(one, other).is_some_and(|(r, ..)| r.push == Push::Block)
            };
            let areas: Vec<Area> = bodies
                .iter()
                .filter(|o| o.slot.is_none() && o.slope.is_none())
                .filter(blocks)
                .map(|o| o.area)
                .collect();
            let level_by_others = || self.is_side_covered(bodies, one, two.space, (x.at, x.looks_up), (bottom, top));
            let upright_by_others = || {
                let outside = areas.iter().filter(|o| y.is_outside(o.bottom, o.top));
                covers(outside.map(|o| (o.left, o.right)).collect(), left, right)
            };
            // Only the face of the shortest push is checked, or the opposite one if that is covered.
            (is_level_covered, is_upright_covered) = if least == level {
                match is_level_covered || level_by_others() {
                    true => (true, is_upright_covered || upright_by_others()),
                    false => (false, false),
                }
            } else {
                match is_upright_covered || upright_by_others() {
                    true => (is_level_covered || level_by_others(), true),
                    false => (false, false),
                }
            };
        }
        let (side, depth) = match (is_level_covered, is_upright_covered) {
            (true, false) => upright,
            (false, true) => level,
            _ => least,
        };
        let mut meeting = met(side, depth);
        if is_level_covered && is_upright_covered {
            let gap_x = if from_left { to_left + back_x } else { to_right - back_x };
            let gap_y = if from_below { to_below + back_y } else { to_above - back_y };
            let around = gap_x <= TOLERANCE && gap_y <= TOLERANCE;
            if around {
                meeting.pushes = vec![level, upright];
            }
        }
        Some(meeting)
    }

    /// Whether rectangles are near a tile: only then more than its neighbours can cover it.
    pub fn is_near_rectangle(&self, bodies: &[Body], two: &Body) -> bool {
        let size = two.space.and_then(|space| self.world.spaces.iter().nth(space)?.map.as_ref()).map(|map| map.tile);
        two.tile.zip(size).is_none_or(|((column, row), (width, height))| {
            let is_near = |at: i64, low: f64, high: f64, size: f64| {
                let cells = ((low - TOLERANCE) / size).floor() - 1.0..((high + TOLERANCE) / size).ceil() + 1.0;
                cells.contains(&(at as f64))
            };
            bodies.iter().filter(|o| o.slot.is_none() && o.tile.is_none() && o.space == two.space).any(|o| {
                is_near(column, o.area.left, o.area.right, width) && is_near(row, o.area.bottom, o.area.top, height)
            })
        })
    }

    /// Whether what blocks lies along all of a part of a left or right side; a slope does up to its line.
    pub fn is_side_covered(
        &self,
        bodies: &[Body],
        one: &Body,
        space: Option<usize>,
        (at, looks_up): (f64, bool),
        (low, high): (f64, f64),
    ) -> bool {
        let face = Face { at, looks_up };
        let blocks = |other: &&Body| {
            let is_there = other.slot.is_none() && other.space == space;
            is_there && self.response(one, other).is_some_and(|(r, ..)| r.push == Push::Block)
        };
        let outside = bodies.iter().filter(blocks).filter(|o| face.is_outside(o.area.left, o.area.right));
        let along = outside.filter_map(|o| {
            let height = o.slope.map(|ends| if looks_up { ends.left } else { ends.right });
            let top = height.map_or(o.area.top, |height| o.area.bottom + height);
            (top > o.area.bottom).then_some((o.area.bottom, top))
        });
        covers(along.collect(), low, high)
    }

    /// Records the contacts of instances.
    fn note(&self, state: &mut State, bodies: &[Body], meetings: &[Meeting]) {
        for thing in state.things.iter_mut().flatten() {
            thing.contacts.clear();
            thing.carrier = None;
        }
        for meeting in meetings {
            let (one, two) = (&bodies[meeting.one], &bodies[meeting.two]);
            let sides = [
                (one, two, meeting.side, meeting.first_on_second),
                (two, one, opposite(meeting.side), meeting.second_on_first),
            ];
            for (mine, other, side, may_stand) in sides {
                let Some(slot) = mine.slot else { continue };
                let thing = state.things[slot].as_mut().unwrap();
                let mine_there = mine.area_moved(meeting.moved);
                let part = other.part(mine_there);
                let along = match side {
                    Side::Left | Side::Right => mine_there.top.min(part.top) - mine_there.bottom.max(part.bottom),
                    Side::Above | Side::Below => mine_there.right.min(part.right) - mine_there.left.max(part.left),
                };
                let cell = self.cell(other).filter(|(space, cell)| self.breakable(*space, *cell).is_some());
                thing.contacts.insert(Contact {
                    mine: mine.tags.clone(),
                    other: other.tags.clone(),
                    side,
                    who: other.slot,
                    tile: cell.map(|(_, cell)| Along { length: (along + 0.0).to_bits(), cell }),
                });
                let stands = meeting.response.carry && may_stand && side == Side::Below && !mine.fixed;
                if let Some(on) = other.slot.filter(|on| stands && thing.carrier.is_none_or(|c| *on < c)) {
                    thing.carrier = Some(on);
                }
            }
        }
    }

    /// Resolves blocking contacts.
    fn push(&self, state: &mut State, bodies: &[Body], meetings: &[Meeting]) {
        let start = state.clone();
        for (slot, thing) in state.things.iter_mut().enumerate().filter_map(|(slot, t)| Some((slot, t.as_mut()?))) {
            let pushes = pushes_of(slot, bodies, meetings);
            let is_meant = |meeting: &&Meeting| bodies[meeting.one].slot == Some(slot);
            let lowers = meetings.iter().filter(is_meant).map(|meeting| meeting.lowers).fold(0.0, f64::max);
            for (axis, low, high) in [(0, Side::Left, Side::Right), (1, Side::Below, Side::Above)] {
                let deepest = |side: Side| pushes.iter().filter(|p| p.0 == side).map(|p| p.1).fold(0.0, f64::max);
                let turned = |side: Side| pushes.iter().filter(|p| p.0 == side).filter_map(|p| p.2).reduce(f64::max);
                let (up, down) = (deepest(low), deepest(high));
                let was = start.things[slot].as_ref().unwrap().vars[axis];
                let [x, v, _] = &mut thing.vars[axis];
                let lowers = if axis == 1 { lowers } else { 0.0 };
                *x = was[0]
                    + if lowers > 0.0 {
                        -lowers
                    } else if up >= down {
                        up
                    } else {
                        -down
                    }
                    + 0.0;
                if lowers > 0.0 && was[1] < 0.0 {
                    *v = 0.0;
                }
                let into = if was[1] < 0.0 { turned(low) } else { turned(high).filter(|_| was[1] > 0.0) };
                if let Some(share) = into {
                    *v = if share == 0.0 { 0.0 } else { -(share * was[1]) };
                }
            }
        }
    }
}

/// All pushes of an instance: the side, the distance, and the share of the velocity that is turned back if it is stopped.
fn pushes_of(slot: usize, bodies: &[Body], meetings: &[Meeting]) -> Vec<(Side, f64, Option<f64>)> {
    let mut pushes: Vec<(Side, f64, Option<f64>)> = Vec::new();
    for meeting in meetings.iter().filter(|m| m.response.push != Push::Sense) {
        let (one, two) = (&bodies[meeting.one], &bodies[meeting.two]);
        let share = if one.fixed || two.fixed { 1.0 } else { 0.5 };
        for (side, depth) in &meeting.pushes {
            for (mine, side) in [(one, *side), (two, opposite(*side))] {
                if mine.slot == Some(slot) && !mine.fixed && *depth > 0.0 {
                    let turned = meeting.response.stop.then(|| meeting.response.bounce.share());
                    pushes.push((side, depth * share, turned));
                }
            }
        }
    }
    pushes
}

/// Whether two shapes touch of which at least one is a circle.
fn shapes_meet(one: &Body, two: &Body) -> bool {
    match (one.disc, two.disc) {
        (Some((x, y, r)), Some((ox, oy, or))) => (x - ox) * (x - ox) + (y - oy) * (y - oy) <= (r + or) * (r + or),
        (Some((x, y, r)), None) | (None, Some((x, y, r))) => {
            let b = if one.disc.is_some() { two.area } else { one.area };
            let beyond = |at: f64, low: f64, high: f64| {
                if at < low {
                    low - at
                } else if at > high {
                    at - high
                } else {
                    0.0
                }
            };
            let (dx, dy) = (beyond(x, b.left, b.right), beyond(y, b.bottom, b.top));
            let distance = dx * dx + dy * dy;
            distance < r * r || (distance == r * r && (dx == 0.0 || dy == 0.0))
        }
        (None, None) => true,
    }
}

fn opposite(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    }
}

//! Slopes, by the letter of the reference: found after all else, for a collider where the pushes along x take it.

use hypedc::ir::{Push, Response, Side};

use super::collide::{Area, Body, Meeting, TOLERANCE};
use super::model::{Oracle, State};

/// The heights of the ends of a line above the lower edge of its tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    pub left: f64,
    pub right: f64,
}

impl Ends {
    /// How much it rises to the right.
    fn steep(self, tile: Area) -> f64 {
        (self.right - self.left) / (tile.right - tile.left)
    }

    /// The highest point over an interval, of which the nearest inside of the tile counts.
    pub fn top(self, tile: Area, (left, right): (f64, f64)) -> f64 {
        let x = if self.right > self.left { right } else { left };
        if x <= tile.left {
            tile.bottom + self.left
        } else if x >= tile.right {
            tile.bottom + self.right
        } else {
            tile.bottom + (self.left + (x - tile.left) * self.steep(tile))
        }
    }

    /// The square of the distance of a point from what is below the line.
    pub fn distance(self, tile: Area, (x, y): (f64, f64)) -> f64 {
        if tile.left <= x && x <= tile.right && tile.bottom <= y && y <= self.top(tile, (x, x)) {
            return 0.0;
        }
        let corners = [
            (tile.left, tile.bottom),
            (tile.right, tile.bottom),
            (tile.right, tile.bottom + self.right),
            (tile.left, tile.bottom + self.left),
        ];
        let sides = (0..4).map(|at| (corners[at], corners[(at + 1) % 4]));
        let from = |((ax, ay), (bx, by)): ((f64, f64), (f64, f64))| {
            let (dx, dy) = (bx - ax, by - ay);
            let length = dx * dx + dy * dy;
            let along = if length > 0.0 { (((x - ax) * dx + (y - ay) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
            let (dx, dy) = (x - (ax + along * dx), y - (ay + along * dy));
            dx * dx + dy * dy
        };
        sides.map(from).fold(f64::INFINITY, f64::min)
    }
}

fn moved(a: Area, (x, y): (f64, f64)) -> Area {
    Area { left: a.left + x, right: a.right + x, bottom: a.bottom + y, top: a.top + y }
}

impl Body {
    /// Its box as the flows began.
    pub fn start(&self) -> Area {
        moved(self.area, self.back)
    }

    /// Its box, moved along x.
    pub fn area_moved(&self, x: f64) -> Area {
        moved(self.area, (x, 0.0))
    }

    /// The box that a tile or rectangle is to another one.
    pub fn part(&self, area: Area) -> Area {
        let top = self.slope.map_or(self.area.top, |ends| ends.top(self.area, (area.left, area.right)));
        Area { top, ..self.area }
    }
}

impl Oracle<'_> {
    /// The tile at another place of the map that a collider meets.
    pub fn tile_beside<'b>(
        &self,
        bodies: &'b [Body],
        one: &Body,
        two: &Body,
        (dx, dy): (i64, i64),
    ) -> Option<&'b Body> {
        let (column, row) = two.tile?;
        let space = self.space(two.space?);
        let count = space.map.as_ref().map_or((1, 1), |map| (map.columns as i64, map.rows as i64));
        let around = |at: i64, count: i64, wraps: bool| if wraps { at.rem_euclid(count) } else { at };
        let cell =
            |(column, row): (i64, i64)| (around(column, count.0, space.wraps[0]), around(row, count.1, space.wraps[1]));
        let wanted = Some(cell((column + dx, row + dy)));
        let is_there = |other: &&Body| other.space == two.space && other.tile.map(cell) == wanted;
        bodies.iter().find(|other| is_there(other) && self.response(one, other).is_some())
    }

    /// The box of the tile at another place of the map.
    pub fn cell_area(&self, two: &Body, (dx, dy): (i64, i64)) -> Option<Area> {
        let (column, row) = two.tile?;
        let (width, height) = self.space(two.space?).map.as_ref()?.tile;
        let (left, bottom) = ((column + dx) as f64 * width, (row + dy) as f64 * height);
        Some(Area { left, bottom, right: left + width, top: bottom + height })
    }

    fn blocks(&self, one: &Body, other: &Body) -> bool {
        self.response(one, other).is_some_and(|(response, ..)| response.push == Push::Block)
    }

    /// How high the tile beside another one is where they meet, if it blocks.
    pub fn height_beside(&self, bodies: &[Body], one: &Body, two: &Body, dx: i64) -> Option<f64> {
        let other = self.tile_beside(bodies, one, two, (dx, 0)).filter(|other| self.blocks(one, other))?;
        let size = two.area.top - two.area.bottom;
        Some(other.slope.map_or(size, |ends| if dx < 0 { ends.right } else { ends.left }))
    }

    /// Whether a collider stood above the line of a slope as the flows began.
    pub fn came_from_above(&self, bodies: &[Body], one: &Body, two: &Body, start: Area) -> bool {
        let (ends, tile) = (two.slope.unwrap(), two.area);
        let size = tile.top - tile.bottom;
        // The gradient of a slope that joins an end, upwards to it.
        let joined = |dx: i64, end: f64| {
            let (dy, end) = if end == 0.0 { (-1, size) } else { (0, end) };
            let Some(ends) = self.tile_beside(bodies, one, two, (dx, dy)).and_then(|other| other.slope) else {
                return 0.0;
            };
            let joins = if dx < 0 { ends.right == end } else { ends.left == end };
            let rise = if dx < 0 { ends.right - ends.left } else { ends.left - ends.right };
            if joins { rise / (tile.right - tile.left) } else { 0.0 }
        };
        let height = if start.right < tile.left {
            let steep = ends.steep(tile).max(joined(-1, ends.left)).max(0.0);
            tile.bottom + ends.left - steep * (tile.left - start.right)
        } else if start.left > tile.right {
            let steep = (-ends.steep(tile)).max(joined(1, ends.right)).max(0.0);
            tile.bottom + ends.right - steep * (start.left - tile.right)
        } else {
            ends.top(tile, (start.left, start.right))
        };
        start.bottom >= height - TOLERANCE
    }

    /// The contacts with slopes; `pushed` are the pushes along x so far, by slot.
    pub fn slope_meetings(&self, bodies: &[Body], state: &State, pushed: &[f64]) -> Vec<Meeting> {
        let mut out = Vec::new();
        for (i, one) in bodies.iter().enumerate() {
            let Some(slot) = one.slot else { continue };
            let space = state.things[slot].as_ref().unwrap().space;
            for (j, two) in bodies.iter().enumerate().filter(|(_, two)| two.slope.is_some() && two.space == Some(space))
            {
                out.extend(self.slope_meeting((i, j), (one, two), bodies, pushed[slot]));
            }
        }
        out
    }

    fn slope_meeting(
        &self,
        (i, j): (usize, usize),
        (one, two): (&Body, &Body),
        bodies: &[Body],
        pushed: f64,
    ) -> Option<Meeting> {
        let (response, first_on_second, second_on_first) = self.response(one, two)?;
        let (ends, tile, start) = (two.slope.unwrap(), two.area, one.start());
        let a = moved(one.area, (pushed, 0.0));
        let b = two.part(a);
        let ways = [a.right - b.left, b.right - a.left, a.top - b.bottom, b.top - a.bottom];
        let [to_left, to_right, to_below, to_above] = ways;
        let lies_beside = to_left == 0.0 || to_right == 0.0;
        if ways.iter().any(|way| *way < 0.0) || (lies_beside && (to_below == 0.0 || to_above == 0.0)) {
            return None;
        }
        let back = (start.left - a.left, start.bottom - a.bottom);
        let from_left = to_left + back.0 <= to_right - back.0;
        let from_below = to_below + back.1 <= to_above - back.1;
        let face = if from_left { ends.left } else { ends.right };
        if lies_beside && face == 0.0 {
            return None;
        }
        let met = |side, depth| {
            let pushes = vec![(side, depth)];
            Some(Meeting {
                one: i,
                two: j,
                response,
                pushes,
                side,
                first_on_second,
                second_on_first,
                lowers: 0.0,
                moved: pushed,
            })
        };
        let is_above = !lies_beside && self.came_from_above(bodies, one, two, start);
        let was_under = start.top <= tile.bottom + TOLERANCE;
        if response.push == Push::FromAbove {
            return match () {
                () if first_on_second && is_above => met(Side::Below, to_above),
                () if second_on_first && was_under => met(Side::Above, to_below),
                () => None,
            };
        }
        if let Some((x, y, r)) = one.disc.filter(|_| response.push == Push::Sense)
            && ends.distance(tile, (x + pushed, y)) >= r * r
        {
            return None;
        }
        if is_above {
            let lifted = moved(a, (0.0, to_above));
            let is_hit = |other: &&Body| {
                let b = other.area;
                start.top <= b.bottom + TOLERANCE
                    && lifted.top > b.bottom + TOLERANCE
                    && lifted.right - b.left > TOLERANCE
                    && b.right - lifted.left > TOLERANCE
            };
            let mut others = bodies.iter().filter(|o| o.slot.is_none() && o.space == two.space && self.blocks(one, o));
            let way = one.area.left - start.left;
            if response.push == Push::Block && to_above > 0.0 && way != 0.0 && others.any(|other| is_hit(&other)) {
                return match way > 0.0 {
                    true => met(Side::Right, way.min(one.area.right - tile.left)),
                    false => met(Side::Left, (-way).min(tile.right - one.area.left)),
                };
            }
            return met(Side::Below, to_above);
        }
        let level = if from_left { (Side::Right, to_left - pushed) } else { (Side::Left, to_right + pushed) };
        let upright = if from_below { (Side::Above, to_below) } else { (Side::Below, to_above) };
        let was_beside = match from_left {
            true => start.right <= tile.left + TOLERANCE,
            false => start.left >= tile.right - TOLERANCE,
        };
        let is_level_covered = face > 0.0 && {
            let beside = self.height_beside(bodies, one, two, if from_left { -1 } else { 1 });
            beside.is_some_and(|beside| beside >= face - TOLERANCE)
                || self.is_near_rectangle(bodies, two)
                    && self.is_side_covered(
                        bodies,
                        one,
                        two.space,
                        (if from_left { tile.left } else { tile.right }, !from_left),
                        (a.bottom.max(tile.bottom), a.top.min(tile.bottom + face)),
                    )
        };
        if was_beside && !is_level_covered && !(from_below && was_under) {
            return met(level.0, level.1);
        }
        let beneath = self.tile_beside(bodies, one, two, (0, -1));
        let is_upright_covered = from_below && beneath.is_some_and(|o| o.slope.is_none() && self.blocks(one, o));
        let least = if (if from_left { to_left } else { to_right }) < upright.1 { level } else { upright };
        let (side, depth) = match (is_level_covered, is_upright_covered) {
            (true, false) => upright,
            (false, true) => level,
            _ => least,
        };
        met(side, depth)
    }

    /// What keeps an instance on the ground, if anything does: contacts that move it down.
    pub fn kept(&self, bodies: &[Body], state: &State, slot: usize, pushed: f64) -> Vec<Meeting> {
        let space = state.things[slot].as_ref().unwrap().space;
        let height = self.space(space).map.as_ref().map_or(0.0, |map| map.tile.1);
        let own = || {
            let own = bodies.iter().enumerate().filter(|(_, body)| body.slot == Some(slot) && !body.fixed);
            own.filter(|(_, body)| body.area.bottom <= body.start().bottom)
        };
        let holds = |(response, first_on_second, _): &(Response, bool, bool)| {
            let can_hold = response.push == Push::Block || response.push == Push::FromAbove && *first_on_second;
            can_hold && response.stop && response.bounce.share() == 0.0
        };
        // What a box of a body can stand on: the body, how far it is below, how steep it is.
        let grounds = |one: &Body, area: Area| -> Vec<(usize, f64, f64, bool)> {
            let statics = bodies.iter().enumerate().filter(|(_, two)| two.slot.is_none() && two.space == Some(space));
            let holding = statics.filter(|(_, two)| self.response(one, two).is_some_and(|met| holds(&met)));
            let ground = |(j, two): (usize, &Body)| {
                let part = two.part(area);
                let is_over = area.right - part.left > TOLERANCE && part.right - area.left > TOLERANCE;
                let gap = area.bottom - part.top;
                let steep = two.slope.map_or(0.0, |ends| ends.steep(two.area).abs());
                (is_over && gap <= height).then_some((j, gap, steep, two.slope.is_some()))
            };
            holding.filter_map(ground).collect()
        };
        let has_slopes = self.space(space).map.as_ref().is_some_and(|map| map.kinds.iter().any(|k| k.slope.is_some()));
        let meets_tiles = |one: &Body| {
            let kinds = self.space(space).map.iter().flat_map(|map| &map.kinds);
            kinds.clone().any(|kind| {
                let tile = Body { tags: kind.tags.iter().copied().collect(), ..one.clone() };
                self.response(one, &tile).is_some()
            })
        };
        if !has_slopes {
            return Vec::new();
        }
        let own: Vec<(usize, &Body)> = own().filter(|(_, one)| meets_tiles(one)).collect();
        let mut stood: Option<f64> = None;
        let (mut on_slope, mut nearest): (bool, Option<(f64, f64, bool, f64)>) = (false, None);
        for (_, one) in &own {
            for (_, gap, steep, is_slope) in grounds(one, one.start()) {
                if gap.abs() <= TOLERANCE {
                    stood = Some(stood.unwrap_or(0.0).max(steep));
                    on_slope |= is_slope;
                }
            }
            let here = moved(one.area, (pushed, 0.0));
            let way = (here.left - one.start().left).abs();
            for (_, gap, steep, is_slope) in grounds(one, here) {
                if gap >= 0.0 && nearest.is_none_or(|(known, ..)| gap < known) {
                    nearest = Some((gap, steep, is_slope, way));
                }
            }
        }
        let (Some(stood), Some((gap, steep, is_slope, way))) = (stood, nearest) else { return Vec::new() };
        if gap == 0.0 || !(on_slope || is_slope) || gap > way * stood.max(steep) + TOLERANCE {
            return Vec::new();
        }
        let mut out = Vec::new();
        for (i, one) in own {
            for (j, below, ..) in grounds(one, moved(one.area, (pushed, 0.0))) {
                if below == gap {
                    let (response, first_on_second, second_on_first) = self.response(one, &bodies[j]).unwrap();
                    let (side, pushes) = (Side::Below, Vec::new());
                    out.push(Meeting {
                        one: i,
                        two: j,
                        response,
                        pushes,
                        side,
                        first_on_second,
                        second_on_first,
                        lowers: gap,
                        moved: pushed,
                    });
                }
            }
        }
        out
    }
}

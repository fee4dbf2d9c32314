//! Spaces that wrap, by brute force: everything is repeated on all sides, and every repetition is looked at.

use hypedc::sema::checked::Space;

use super::collide::{Area, Body};
use super::model::{Oracle, State};

/// How often something is repeated to each side where the way around is not known beforehand.
const MANY: i32 = 60;

impl Oracle<'_> {
    pub fn space(&self, number: usize) -> &Space {
        self.world.spaces.iter().nth(number).unwrap()
    }

    /// The borders between which a space repeats, along each axis.
    pub fn borders(&self, space: usize) -> [Option<(f64, f64)>; 2] {
        let space = self.space(space);
        let map = space.map.as_ref().map(|map| [0.0, 0.0, map.size().0, map.size().1]);
        [0, 1].map(|axis| {
            let sides = space.bounds.or(map).filter(|_| space.wraps[axis])?;
            Some((sides[axis], sides[axis] + sides[axis + 2]))
        })
    }

    /// Brings every position between the borders, and where it was in `start` along with it.
    pub fn come_in(&self, start: &mut State, state: &mut State) {
        for (thing, was) in state.things.iter_mut().zip(&mut start.things) {
            let Some(thing) = thing else { continue };
            for (axis, borders) in self.borders(thing.space).into_iter().enumerate() {
                let Some((low, high)) = borders else { continue };
                let at = thing.vars[axis][0];
                if low <= at && at < high {
                    continue;
                }
                let around = high - low;
                let to = at - around * ((at - low) / around).floor();
                let to = if to < low || to >= high { low } else { to };
                thing.vars[axis][0] = to + 0.0;
                if let Some(was) = was {
                    was.vars[axis][0] += to - at;
                }
            }
        }
    }

    /// The way with the least length among all that lead as far.
    pub fn shortest(&self, space: usize, axis: usize, way: f64) -> f64 {
        let Some((low, high)) = self.borders(space)[axis] else { return way };
        let ways = (-MANY..=MANY).map(|turns| way - (high - low) * f64::from(turns));
        ways.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap()
    }

    /// Static geometry with all its repetitions that can be met.
    pub fn repeated(&self, body: Body, columns: (i64, i64)) -> Vec<Body> {
        let mut all = vec![body];
        for (axis, borders) in self.borders(all[0].space.unwrap()).into_iter().enumerate() {
            let Some((low, high)) = borders else { continue };
            let around = high - low;
            let seen = |body: &Body, turns: i32| {
                let at = [body.area.left, body.area.bottom][axis];
                match body.tile {
                    Some(_) => (-1..=1).contains(&turns),
                    None => (low - 2.0 * around..high + around).contains(&(at + f64::from(turns) * around)),
                }
            };
            let copy = |body: &Body, turns: i32| {
                let mut body = body.clone();
                let way = f64::from(turns) * around;
                if let Some((column, row)) = &mut body.tile {
                    *[column, row][axis] += i64::from(turns) * [columns.0, columns.1][axis];
                }
                body.area = match axis {
                    0 => Area { left: body.area.left + way, right: body.area.right + way, ..body.area },
                    _ => Area { bottom: body.area.bottom + way, top: body.area.top + way, ..body.area },
                };
                body
            };
            let all_turns = |body: &Body| -> Vec<Body> {
                (-MANY..=MANY).filter(|turns| seen(body, *turns)).map(|turns| copy(body, turns)).collect()
            };
            all = all.iter().flat_map(all_turns).collect();
        }
        all
    }

    /// Two bodies of instances as they are seen from each other: as they are, and across the seams. The one on the left,
    /// or below, is taken one period further.
    pub fn seen(&self, space: usize, one: &Body, two: &Body) -> Vec<(Body, Body)> {
        let [x, y] = self.borders(space).map(|borders| borders.map(|(low, high)| high - low));
        let turns = |around: Option<f64>| if around.is_some() { -1..=1 } else { 0..=0 };
        let mut all = Vec::new();
        for across in turns(x) {
            for up in turns(y) {
                let way =
                    |sign: i32| (f64::from(sign * across) * x.unwrap_or(0.0), f64::from(sign * up) * y.unwrap_or(0.0));
                all.push(match (across, up) {
                    (0, 0) => (one.clone(), two.clone()),
                    (1, _) | (0, 1) => (one.clone(), two.shifted(way(1))),
                    _ => (one.shifted(way(-1)), two.clone()),
                });
            }
        }
        all
    }
}

impl Body {
    fn shifted(&self, (x, y): (f64, f64)) -> Body {
        let Area { left, bottom, right, top } = self.area;
        let area = Area { left: left + x, bottom: bottom + y, right: right + x, top: top + y };
        let middle = |low: f64, high: f64| (low + high) / 2.0;
        let disc = self
            .disc
            .map(|_| (middle(area.left, area.right), middle(area.bottom, area.top), (area.right - area.left) / 2.0));
        let mut moved = self.clone();
        (moved.area, moved.disc) = (area, disc);
        moved
    }
}

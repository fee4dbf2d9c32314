//! Spaces that wrap. A step is analysed in the plane without seams, in which static obstacles are repeated on both
//! sides; at its end, positions are brought between the borders. What goes farther than the repetitions reach can be
//! anywhere.

use std::sync::Arc;

use crate::ir::{Bounds, Extremes, Period, Solid, Space, SpaceId, TileMap, VarId, World};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::rounding;

/// A copy of a world whose static obstacles are repeated; `None` if no space wraps. The first column and row of a
/// repeated map are those of [`origin`].
pub(in crate::analysis) fn unrolled(world: &World) -> Option<World> {
    if !world.spaces.iter().any(Space::wraps) {
        return None;
    }
    let mut world = world.clone();
    for space in world.spaces.iter_mut() {
        let periods = space.periods;
        for (axis, period) in periods.into_iter().enumerate() {
            let Some(period) = period else { continue };
            space.solids = space.solids.iter().flat_map(|solid| repeated(solid, axis, period)).collect();
        }
        let [across, up] = periods.map(|period| if period.is_some() { 3 } else { 1 });
        if let Some(map) = &mut space.map {
            let row = |row: &[u16]| row.repeat(across);
            let rows: Vec<u16> = map.cells.chunks(map.columns.max(1)).flat_map(row).collect();
            *map = TileMap {
                columns: map.columns * across,
                rows: map.rows * up,
                cells: rows.repeat(up),
                kinds: std::mem::take(&mut map.kinds),
                tile: map.tile,
            };
        }
    }
    Some(world)
}

/// The number of the first column and of the first row of a map, which may be repeated.
pub(in crate::analysis) fn origin<T>(space: &Space, map: &TileMap<T>) -> [i64; 2] {
    let first = |count: usize, axis: usize| if space.periods[axis].is_some() { -(count as i64 / 3) } else { 0 };
    [first(map.columns, 0), first(map.rows, 1)]
}

/// A rectangle as often as a collider can meet it from between the borders.
fn repeated(solid: &Solid, axis: usize, period: Period) -> Vec<Solid> {
    let low = if axis == 0 { solid.bounds.left } else { solid.bounds.bottom };
    let first = ((low - period.low) / period.size()).floor();
    let at = |turns: f64| {
        let way = (turns - first) * period.size();
        let Bounds { left, right, bottom, top } = solid.bounds;
        let bounds = match axis {
            0 => Bounds { left: left + way, right: right + way, bottom, top },
            _ => Bounds { left, right, bottom: bottom + way, top: top + way },
        };
        Solid { bounds, ..solid.clone() }
    };
    [-2.0, -1.0, 0.0, 1.0].map(at).into()
}

/// The values brought into a period.
fn inside(period: Period, values: &Values) -> Values {
    let whole = Interval { low: period.low, high: period.high };
    let is_inside = |i: &Interval| period.contains(i.low) && period.contains(i.high);
    if values.intervals().iter().all(is_inside) {
        return *values;
    }
    let size = period.size();
    let mut out = Vec::new();
    for interval in values.intervals() {
        if is_inside(interval) {
            out.push(*interval);
            continue;
        }
        let slack = rounding(interval.low).greatest(rounding(interval.high));
        let turns = ((interval.low - period.low) / size).floor();
        let way = turns * size;
        let (low, high) = (interval.low - way - slack, interval.high - way + slack);
        // It is not if an end is infinite, or if the numbers are too coarse.
        let is_part = high - low < size - slack && slack < size / 4.0;
        if !is_part {
            return whole.into();
        }
        // What rounding leaves beyond a border lies on the lower one.
        out.extend(Interval { low, high }.and(whole));
        if low < period.low + slack {
            out.push(Interval { low: (low + size).least(period.high), high: period.high });
            out.push(Interval::point(period.low));
        }
        if high > period.high - slack {
            out.push(Interval { low: period.low, high: (high - size).greatest(period.low) });
        }
    }
    Values::any(out)
}

/// The values of a coordinate in some spaces, brought between the borders where those wrap.
pub(in crate::analysis) fn wrapped<'s>(
    world: &World,
    spaces: impl IntoIterator<Item = &'s SpaceId>,
    axis: usize,
    values: &Values,
) -> Values {
    let each = spaces.into_iter().map(|space| match world.spaces[*space].periods[axis] {
        Some(period) => inside(period, values),
        None => *values,
    });
    each.reduce(|a, b| a.or(&b)).unwrap_or(*values)
}

/// Brings the position of an instance between the borders of its spaces.
pub(in crate::analysis) fn bring_in(world: &World, at: &mut Configuration) {
    if !at.spaces.iter().any(|space| world.spaces[*space].wraps()) {
        return;
    }
    for axis in 0..2 {
        let var = VarId::XY[axis];
        let position = at.vars[var][0];
        let inside = wrapped(world, &*Arc::clone(&at.spaces), axis, &position);
        if inside != position {
            at.set(var, 0, inside);
            at.forget_energy(var);
        }
    }
}

/// Restricts a position that was widened to what lies between the borders, where all spaces have them.
pub(in crate::analysis) fn keep_in(world: &World, at: &mut Configuration) {
    for axis in 0..2 {
        let borders = |space: &SpaceId| {
            let period = world.spaces[*space].periods[axis]?;
            Some(Interval { low: period.low, high: period.high })
        };
        let all: Option<Vec<Interval>> = at.spaces.iter().map(borders).collect();
        if let Some(borders) = all.and_then(|all| all.into_iter().reduce(Interval::or)) {
            let var = VarId::XY[axis];
            at.set(var, 0, at.vars[var][0].within(borders));
        }
    }
}

/// Whether one of some spaces wraps along an axis.
pub(in crate::analysis) fn wraps<'s>(
    world: &World,
    spaces: impl IntoIterator<Item = &'s SpaceId>,
    axis: usize,
) -> bool {
    spaces.into_iter().any(|space| world.spaces[*space].periods[axis].is_some())
}

/// Whether a box around a position reaches farther than half of what repeats in some space.
pub(in crate::analysis) fn reaches_around(world: &World, extent: [Interval; 2]) -> bool {
    let periods = world.spaces.iter().flat_map(|space| space.periods.into_iter().zip(extent));
    periods
        .into_iter()
        .any(|(period, side)| period.is_some_and(|period| side.high.greatest(-side.low) > period.size() / 2.0))
}

/// Brings an instance that has moved to where the repeated obstacles reach: from half a period before the lower border
/// to half a period after the upper one. Returns whether it may have come from anywhere.
pub(in crate::analysis) fn into_reach(world: &World, axis: usize, moved: &mut Configuration) -> bool {
    let var = VarId::XY[axis];
    let spaces = Arc::clone(&moved.spaces);
    let is_out = |space: &SpaceId| {
        let Some(period) = world.spaces[*space].periods[axis] else { return false };
        let half = 0.499 * period.size();
        let hull = moved.vars[var][0].hull();
        hull.is_some_and(|hull| hull.low < period.low - half || hull.high > period.high + half)
    };
    let is_far = spaces.iter().any(is_out);
    if is_far {
        let all = spaces.iter().filter_map(|space| {
            let period = world.spaces[*space].periods[axis]?;
            Some(Interval { low: period.low, high: period.high })
        });
        let position = moved.vars[var][0].or(&Values::any(all));
        // Where all spaces wrap, nothing else is left.
        let is_everywhere = spaces.iter().all(|space| world.spaces[*space].periods[axis].is_some());
        let position = if is_everywhere { wrapped(world, &*spaces, axis, &position) } else { position };
        moved.set(var, 0, position);
        moved.forget_energy(var);
    }
    is_far
}

/// The positions of others as they can be seen from an instance within reach: repeated on both sides.
pub(in crate::analysis) fn seen<'s>(
    world: &World,
    spaces: impl IntoIterator<Item = &'s SpaceId>,
    axis: usize,
    values: &Values,
) -> Values {
    let each = spaces.into_iter().map(|space| {
        let Some(period) = world.spaces[*space].periods[axis] else { return *values };
        let near = inside(period, values);
        let turns = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turns| turns * period.size());
        let moved = |way: f64| {
            near.intervals().iter().map(move |i| {
                let slack = if way == 0.0 { 0.0 } else { rounding(i.low).greatest(rounding(i.high)) };
                Interval { low: i.low + way - slack, high: i.high + way + slack }
            })
        };
        Values::any(turns.into_iter().flat_map(moved))
    });
    each.reduce(|a, b| a.or(&b)).unwrap_or(*values)
}

/// The shortest ways in some space that lead as far as some ways.
pub(in crate::analysis) fn shortest(world: &World, axis: usize, ways: &Values) -> Values {
    let each = world.spaces.iter().map(|space| {
        let Some(period) = space.periods[axis] else { return *ways };
        let size = period.size();
        let half = Interval { low: -0.5 * size - rounding(size), high: 0.5 * size + rounding(size) };
        let is_few = ways.hull().is_some_and(|hull| -1.4 * size < hull.low && hull.high < 1.4 * size);
        if !is_few {
            return Values::any(ways.hull().map(|_| half));
        }
        let turned = [-size, 0.0, size].into_iter().flat_map(|way| {
            ways.intervals().iter().filter_map(move |i| {
                let slack = if way == 0.0 { 0.0 } else { rounding(size) };
                Interval { low: i.low + way - slack, high: i.high + way + slack }.and(half)
            })
        });
        Values::any(turned.collect::<Vec<_>>())
    });
    each.reduce(|a, b| a.or(&b)).unwrap_or(*ways)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const PERIOD: Period = Period { low: -16.0, high: 240.0 };

    proptest! {
        #[test]
        fn all_that_is_brought_in_is_covered(low in -2000.0..2000.0, long in 0.0..400.0, part in 0.0..=1.0) {
            let interval = Interval { low, high: low + long };
            let values = inside(PERIOD, &interval.into());
            for x in [low, low + long * part, low + long] {
                prop_assert!(values.contains(PERIOD.wrapped(x)), "{} of {}: {}", x, interval, values);
            }
            prop_assert!(values.hull().unwrap().low >= PERIOD.low && values.hull().unwrap().high <= PERIOD.high);
        }

        #[test]
        fn seams_are_covered(turns in -9..9i32, to in -9..9i32) {
            let mut x = PERIOD.low + f64::from(turns) * PERIOD.size();
            for _ in 0..to.abs() {
                x = if to < 0 { x.next_down() } else { x.next_up() };
            }
            prop_assert!(inside(PERIOD, &Values::point(x)).contains(PERIOD.wrapped(x)));
        }
    }

    #[test]
    fn what_stays_inside_stays_as_it_is() {
        let values = Values::any([Interval { low: -16.0, high: 0.5 }, Interval { low: 3.0, high: 239.0 }]);
        assert_eq!(inside(PERIOD, &values), values);
        assert_eq!(inside(PERIOD, &Values::all()), Interval { low: -16.0, high: 240.0 }.into());
        let over = inside(PERIOD, &Interval { low: 230.0, high: 250.0 }.into());
        assert!(over.contains(239.9) && over.contains(-6.0) && !over.contains(0.0) && !over.contains(229.0), "{over}");
    }
}

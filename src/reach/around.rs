//! Boxes of positions in spaces that wrap: one that reaches over a border also begins at the other.

use crate::ir::{Period, Space, World};

use super::goal_positions::PositionBox;

/// The parts of a box between the borders of each space that wraps, where they are; elsewhere the box.
pub(super) fn images(world: &World, place: PositionBox) -> Vec<PositionBox> {
    if !world.spaces.iter().any(Space::wraps) {
        return vec![place];
    }
    let spaces = world.spaces.pairs().filter(|(id, _)| place.space.is_none_or(|space| space == *id));
    let all = spaces.flat_map(|(id, space)| {
        let [across, up] = space.periods;
        let rows = along(place.y, up);
        along(place.x, across)
            .into_iter()
            .flat_map(move |x| rows.clone().into_iter().map(move |y| PositionBox { space: Some(id), x, y }))
    });
    all.collect()
}

/// The images of a range that meet the period.
fn along((low, high): (f64, f64), period: Option<Period>) -> Vec<(f64, f64)> {
    let Some(period) = period else { return vec![(low, high)] };
    let size = period.size();
    // Of an infinite range, it is none.
    let is_part = high - low < size;
    if !is_part {
        return vec![(f64::NEG_INFINITY, f64::INFINITY)];
    }
    let first = ((period.low - high) / size).ceil();
    let turned = (0..3).map(|turn| (first + f64::from(turn)) * size).map(|way| (low + way, high + way));
    turned.filter(|(low, high)| *low <= period.high && period.low <= *high).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_reaches_over_a_border_begins_at_the_other() {
        let period = Some(Period { low: 0.0, high: 100.0 });
        assert_eq!(along((10.0, 20.0), period), [(10.0, 20.0)]);
        assert_eq!(along((-5.0, 5.0), period), [(-5.0, 5.0), (95.0, 105.0)]);
        assert_eq!(along((395.0, 405.0), period), [(-5.0, 5.0), (95.0, 105.0)]);
        assert_eq!(along((0.0, 100.0), period), [(f64::NEG_INFINITY, f64::INFINITY)]);
        assert_eq!(along((f64::NEG_INFINITY, 5.0), None), [(f64::NEG_INFINITY, 5.0)]);
    }
}

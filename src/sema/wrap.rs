//! `wrap`: the borders of a space that are one place, and what has to fit between them.

use crate::diagnostic::catalogue::wrap::{BadWrap, WhyNoWrap};
use crate::syntax::ast::Wrap;

use super::Checker;
use super::checked::Space;

/// The names of the axes.
const SIDES: [&str; 2] = ["wide", "high"];

impl Checker<'_> {
    /// Checks the `wrap`s of a space whose contents are known; `has_map` also holds of a map that could not be read.
    pub(super) fn wraps(&mut self, wraps: &[Wrap], space: &mut Space, has_map: bool) {
        let mut first = [None; 2];
        for wrap in wraps {
            let axis = usize::from(wrap.is_vertical);
            let other = first[axis].replace(wrap.span);
            let why = match other {
                Some(other) => Some(WhyNoWrap::Twice(other)),
                None => misfit(space, axis, has_map),
            };
            if let Some(why) = why {
                self.diagnostics.report(BadWrap { at: wrap.span, space: space.name.text.to_string(), why });
                continue;
            }
            space.wraps[axis] = true;
        }
    }
}

/// Why a space cannot wrap along an axis.
fn misfit(space: &Space, axis: usize, has_map: bool) -> Option<WhyNoWrap> {
    let map = space.map.as_ref().map(|map| [map.size().0, map.size().1][axis]);
    let (low, size) = match (space.bounds, map) {
        (Some(bounds), _) => (bounds[axis], bounds[axis + 2]),
        (None, Some(size)) => (0.0, size),
        (None, None) if has_map => return None,
        (None, None) => return Some(WhyNoWrap::NoBorders),
    };
    let size = (low + size) - low;
    if let Some(map) = map.filter(|map| (low, low + size) != (0.0, *map)) {
        return Some(WhyNoWrap::Map { low, size, map, side: SIDES[axis] });
    }
    if size <= 0.0 {
        return Some(WhyNoWrap::NoBorders);
    }
    let long = space.solids.iter().find(|solid| (solid.rect[axis] + solid.rect[axis + 2]) - solid.rect[axis] > size)?;
    Some(WhyNoWrap::Rect { at: long.span, long: long.rect[axis + 2], size, side: SIDES[axis] })
}

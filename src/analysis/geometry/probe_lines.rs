//! The lines at which the answers of probes change: between two of them, the outcome of a probe of tiles and rectangles is
//! the same everywhere. In a grid game, each place that a body can have is alone between its lines.

use crate::ir::{Expr, ExprId, Program, SpaceId, TagSet, World};
use crate::watch::Meter;

use crate::analysis::geometry::body::{Kind, TOLERANCE};
use crate::analysis::geometry::tiles::Tiles;

/// Per axis, the lines of the probes of a kind in a space; incomplete if the meter runs out.
pub(in crate::analysis) fn probe_lines(
    program: &Program,
    world: &World,
    kind: &Kind,
    space: SpaceId,
    meter: &Meter<'_>,
) -> [Vec<f64>; 2] {
    let code = program.entities[kind.entity].code;
    let mut out = [Vec::new(), Vec::new()];
    let Some(params) = kind.slots.first().map(|slot| &world.slots[*slot].params) else { return out };
    for id in (code.from.0..code.to.0).map(ExprId) {
        let Expr::Probe { mine, other, offset, .. } = program.exprs[id] else { continue };
        let (mine, other) = (TagSet::of(mine), TagSet::of(other));
        let tiles = Tiles::new(world, space);
        if meter.spend(1) || !tiles.tags.iter().any(|tags| tags.meets(other)) && world.spaces[space].solids.is_empty() {
            continue;
        }
        let is_asked = |at: usize| tiles.tag(at).meets(other);
        let (columns, rows) = tiles.lines(is_asked, meter);
        let mut sides = [columns, rows];
        for solid in world.spaces[space].solids.iter().filter(|s| s.tags.meets(other)) {
            sides[0].push((solid.bounds.left, solid.bounds.right));
            sides[1].push((solid.bounds.bottom, solid.bounds.top));
        }
        for (axis, offset) in offset.into_iter().enumerate() {
            // Of an offset that changes, the place itself stands for all that lie on the same grid.
            let offset = program.constant(offset, params, world.step).unwrap_or(0.0);
            for extent in kind.bodies.iter().filter(|b| b.tags.meets(mine)).filter_map(|b| b.extent) {
                out[axis].extend(sides[axis].iter().flat_map(|(low, high)| {
                    [low - extent[axis].high + TOLERANCE - offset, high - extent[axis].low - TOLERANCE - offset]
                }));
            }
        }
    }
    out
}

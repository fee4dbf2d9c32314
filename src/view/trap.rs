//! Places where a player is stuck, as cells of the map.

use std::collections::BTreeSet;

use super::frame::{Frame, Rect};
use super::svg::{box_data, put};

/// The style of the cells, for pictures that have some.
pub(super) const STYLE: &str = "\n.trap{fill:#cf222e;fill-opacity:.42;shape-rendering:crispEdges}";

/// Draws the cells that hold some points; `cell` is their width and height, px of the game.
pub(super) fn draw(out: &mut String, frame: &Frame, points: impl Iterator<Item = [f64; 2]>, cell: (f64, f64)) {
    let cells: BTreeSet<(i64, i64)> = points
        .filter(|&point| frame.holds(point))
        .map(|[x, y]| ((x / cell.0).floor() as i64, (y / cell.1).floor() as i64))
        .collect();
    let mut data = String::new();
    for (column, row) in cells {
        let [x, y] = frame.point([column as f64 * cell.0, (row + 1) as f64 * cell.1]);
        box_data(&mut data, Rect { x, y, width: cell.0 * frame.scale, height: cell.1 * frame.scale });
    }
    if !data.is_empty() {
        put!(out, "<path class=\"trap\" d=\"{data}\"/>\n");
    }
}

//! The heat map: a grid of cells whose colour grows with the logarithm of the visits.

use super::frame::{Frame, Rect};
use super::svg::{Number, box_data, put};

/// Number of shades.
pub(super) const LEVELS: usize = 7;
/// Maximum number of cells of a grid.
const MAX_CELLS: f64 = 400_000.0;

/// Draws the visited points; `cell` is the minimum size of a cell, px of the game, `limit` the maximum number of
/// rectangles.
pub(super) fn draw(
    out: &mut String,
    frame: &Frame,
    points: impl Iterator<Item = [f64; 2]> + Clone,
    cell: f64,
    limit: usize,
) {
    let area = (frame.view.right - frame.view.left) * (frame.view.top - frame.view.bottom);
    let mut cell = cell.max(1.5 / frame.scale).max(libm::sqrt(area / MAX_CELLS));
    let mut runs = runs(frame, points.clone(), cell);
    while runs.len() > limit.max(1) {
        cell *= 2.0;
        runs = self::runs(frame, points.clone(), cell);
    }
    let mut data = vec![String::new(); LEVELS];
    for (level, rect) in runs {
        box_data(&mut data[level], rect);
    }
    for (level, data) in data.iter().enumerate().filter(|(_, data)| !data.is_empty()) {
        put!(out, "<path class=\"heat\" fill-opacity=\"{}\" d=\"{data}\"/>\n", Number(opacity(level)));
    }
}

/// The opacity of a shade.
pub(super) fn opacity(level: usize) -> f64 {
    0.16 + 0.46 * level as f64 / (LEVELS - 1) as f64
}

/// Neighbouring cells of a row with the same shade as one rectangle.
fn runs(frame: &Frame, points: impl Iterator<Item = [f64; 2]>, cell: f64) -> Vec<(usize, Rect)> {
    let view = frame.view;
    let columns = ((view.right - view.left) / cell).ceil().max(1.0) as usize;
    let rows = ((view.top - view.bottom) / cell).ceil().max(1.0) as usize;
    let mut visits = vec![0u32; columns * rows];
    for [x, y] in points.filter(|&point| frame.holds(point)) {
        let column = (((x - view.left) / cell) as usize).min(columns - 1);
        let row = (((view.top - y) / cell) as usize).min(rows - 1);
        let visits = &mut visits[row * columns + column];
        *visits = visits.saturating_add(1);
    }
    let most = visits.iter().copied().max().unwrap_or(0);
    let shades = (LEVELS - 1) as f64 / libm::log(f64::from(most.max(2)));
    let shade = |visits: u32| (libm::log(f64::from(visits)) * shades).round() as usize;
    let side = cell * frame.scale;
    let mut runs = Vec::new();
    for (row, visits) in visits.chunks(columns).enumerate() {
        let mut column = 0;
        for run in visits.chunk_by(|&a, &b| (a > 0) == (b > 0) && (a == 0 || shade(a) == shade(b))) {
            if run[0] > 0 {
                let (x, y) = (column as f64 * side, row as f64 * side);
                let width = (run.len() as f64 * side).min(frame.width() - x);
                let rect = Rect { x, y, width, height: side.min(frame.height() - y) };
                runs.push((shade(run[0]).min(LEVELS - 1), rect));
            }
            column += run.len();
        }
    }
    runs
}

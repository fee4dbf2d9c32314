//! The heat map: a grid of cells whose colour grows with the logarithm of the visits, or tells the first layer of a
//! picture that has been there.

use super::frame::{Frame, Rect};
use super::svg::{Number, box_data, put};
use crate::ir::Extremes;

/// Number of shades.
pub(super) const LEVELS: usize = 7;
/// Maximum number of cells of a grid.
const MAX_CELLS: f64 = 400_000.0;

/// Number of colours of layers.
const LAYER_COLORS: usize = 6;

/// The class of one of several layers: the first and the last colour, and those between that are furthest apart.
pub(super) fn layer_class(layer: usize, count: usize) -> String {
    let last = count.saturating_sub(1).max(1);
    format!("layer{}", (layer.min(last) * (LAYER_COLORS - 1) + last / 2) / last)
}

/// Draws the points of each of some layers where no layer before has one; `cell` and `limit` as for [`draw`].
pub(super) fn draw_layers(
    out: &mut String,
    frame: &Frame,
    (points, count): (impl Iterator<Item = (usize, [f64; 2])> + Clone, usize),
    cell: f64,
    limit: usize,
) {
    let found = fitting(frame, cell, limit, |cell| {
        let mut grid = Grid::new(frame, cell, usize::MAX);
        for (layer, point) in points.clone() {
            if let Some(first) = grid.at(frame, point) {
                *first = layer.min(*first);
            }
        }
        grid.runs(frame, |first| (first < usize::MAX).then_some(first))
    });
    let mut data = vec![String::new(); count];
    for (layer, rect) in found {
        if let Some(data) = data.get_mut(layer) {
            box_data(data, rect);
        }
    }
    for (layer, data) in data.iter().enumerate().filter(|(_, data)| !data.is_empty()) {
        put!(out, "<path class=\"layer {}\" d=\"{data}\"/>\n", layer_class(layer, count));
    }
}

/// Draws the visited points; `cell` is the minimum size of a cell, px of the game, `limit` the maximum number of
/// rectangles.
pub(super) fn draw(
    out: &mut String,
    frame: &Frame,
    points: impl Iterator<Item = [f64; 2]> + Clone,
    cell: f64,
    limit: usize,
) {
    let runs = fitting(frame, cell, limit, |cell| runs(frame, points.clone(), cell));
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

/// The runs of cells of the least side, px of the game, with which they are not too many.
fn fitting(frame: &Frame, cell: f64, limit: usize, runs: impl Fn(f64) -> Vec<(usize, Rect)>) -> Vec<(usize, Rect)> {
    let area = (frame.view.right - frame.view.left) * (frame.view.top - frame.view.bottom);
    let mut cell = cell.greatest(1.5 / frame.scale).greatest(libm::sqrt(area / MAX_CELLS));
    let mut found = runs(cell);
    while found.len() > limit.max(1) {
        cell *= 2.0;
        found = runs(cell);
    }
    found
}

/// Neighbouring cells of a row with the same shade as one rectangle.
fn runs(frame: &Frame, points: impl Iterator<Item = [f64; 2]>, cell: f64) -> Vec<(usize, Rect)> {
    let mut grid = Grid::new(frame, cell, 0u32);
    for point in points {
        if let Some(visits) = grid.at(frame, point) {
            *visits = visits.saturating_add(1);
        }
    }
    let most = grid.cells.iter().copied().max().unwrap_or(0);
    let shades = (LEVELS - 1) as f64 / libm::log(f64::from(most.max(2)));
    let shade = |visits: u32| (libm::log(f64::from(visits)) * shades).round() as usize;
    grid.runs(frame, |visits| (visits > 0).then(|| shade(visits).min(LEVELS - 1)))
}

/// A value for each cell of a frame.
struct Grid<T> {
    cell: f64,
    columns: usize,
    rows: usize,
    cells: Vec<T>,
}

impl<T: Copy> Grid<T> {
    fn new(frame: &Frame, cell: f64, value: T) -> Self {
        let view = frame.view;
        let columns = ((view.right - view.left) / cell).ceil().greatest(1.0) as usize;
        let rows = ((view.top - view.bottom) / cell).ceil().greatest(1.0) as usize;
        Grid { cell, columns, rows, cells: vec![value; columns * rows] }
    }

    /// The value of the cell of a point; none if that is outside.
    fn at(&mut self, frame: &Frame, point: [f64; 2]) -> Option<&mut T> {
        if !frame.holds(point) {
            return None;
        }
        let column = (((point[0] - frame.view.left) / self.cell) as usize).min(self.columns - 1);
        let row = (((frame.view.top - point[1]) / self.cell) as usize).min(self.rows - 1);
        self.cells.get_mut(row * self.columns + column)
    }

    /// Neighbouring cells of a row with the same shade as one rectangle; those without one are left out.
    fn runs(&self, frame: &Frame, shade: impl Fn(T) -> Option<usize>) -> Vec<(usize, Rect)> {
        let side = self.cell * frame.scale;
        let mut runs = Vec::new();
        for (row, cells) in self.cells.chunks(self.columns).enumerate() {
            let mut column = 0;
            for run in cells.chunk_by(|&a, &b| shade(a) == shade(b)) {
                if let Some(shade) = shade(run[0]) {
                    let (x, y) = (column as f64 * side, row as f64 * side);
                    let width = (run.len() as f64 * side).least(frame.width() - x);
                    let rect = Rect { x, y, width, height: side.least(frame.height() - y) };
                    runs.push((shade, rect));
                }
                column += run.len();
            }
        }
        runs
    }
}

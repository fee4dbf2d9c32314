//! The tree of a search as thin lines. Of all lines that end in the same small cell of the picture the first is drawn,
//! so that the tree still looks like a tree; the cells grow until few enough lines are left, so that millions of nodes
//! make a small picture.

use super::frame::Frame;
use super::svg::{Number, put};
use crate::ir::Extremes;
use crate::ordered::Ordered;

/// The grid of line ends, in the picture.
const GRID: f64 = 0.5;
/// Side of the smallest cell, in the picture.
const CELL: f64 = 4.0;

/// Draws lines from parents to nodes, at most `limit`.
pub(super) fn draw(out: &mut String, frame: &Frame, lines: impl Iterator<Item = [[f64; 2]; 2]>, limit: usize) {
    let knot = |point: [f64; 2]| frame.point(point).map(|x| (x / GRID).round() as u16);
    let inside = lines.filter(|[a, b]| frame.holds(*a) && frame.holds(*b));
    let mut segments: Vec<[GridPoint; 2]> = inside.map(|line| line.map(knot)).filter(|[a, b]| a != b).collect();
    let mut cell = (CELL / GRID) as u16;
    loop {
        let end = |segment: &[GridPoint; 2]| segment[1].map(|x| x / cell);
        // The sort is stable: the first line of a cell stays first.
        segments.order_by_key(end);
        segments.dedup_by_key(|segment| end(segment));
        if segments.len() <= limit.max(1) {
            break;
        }
        cell = cell.saturating_mul(2);
    }
    segments.sort_unstable();
    if !segments.is_empty() {
        put!(out, "<path class=\"tree\" d=\"{}\"/>\n", data(&segments, (frame.width(), frame.height())));
    }
}

/// A point of the grid.
type GridPoint = [u16; 2];

/// The lines as few polylines: each continues with a line that begins at its end, if there is one.
fn data(segments: &[[GridPoint; 2]], (width, height): (f64, f64)) -> String {
    let mut data = String::new();
    let mut drawn = vec![false; segments.len()];
    let next = |drawn: &[bool], from: GridPoint| {
        let first = segments.partition_point(|[a, _]| *a < from);
        let rest = segments[first..].iter().zip(&drawn[first..]).take_while(|([a, _], _)| *a == from);
        rest.zip(first..).find(|((_, drawn), _)| !**drawn).map(|(_, index)| index)
    };
    // Rounding must not leave the picture.
    let place = |[x, y]: GridPoint| [(f64::from(x) * GRID).least(width), (f64::from(y) * GRID).least(height)];
    for first in 0..segments.len() {
        if drawn[first] {
            continue;
        }
        let [mut x, mut y] = place(segments[first][0]);
        put!(data, "M{} {}", Number(x), Number(y));
        let mut line = Some(first);
        while let Some(index) = line {
            drawn[index] = true;
            let to = segments[index][1];
            let [to_x, to_y] = place(to);
            let (dx, dy) = (Number(to_x - x).to_string(), Number(to_y - y).to_string());
            // A sign separates numbers like a blank.
            let blank = if dy.starts_with('-') { "" } else { " " };
            put!(data, "l{dx}{blank}{dy}");
            (x, y) = (to_x, to_y);
            line = next(&drawn, to);
        }
    }
    data
}

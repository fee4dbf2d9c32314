//! The tiles of a map: equal neighbours are one rectangle, and a map of very many small tiles is drawn coarser.

use crate::ir::{Bounds, TagId, TagSet, TileMap};

use super::frame::Frame;
use super::look::{Looks, Role};
use super::svg::{box_data, path};

/// The most rectangles of a map.
const MAX_RECTANGLES: usize = 15_000;
/// The height of the upper edge of the ground, in the picture.
const LIP: f64 = 3.0;

/// Tiles by the number of their look.
struct Grid {
    columns: usize,
    rows: usize,
    tile: (f64, f64),
    looks: Vec<Option<u16>>,
}

/// Draws a map.
pub(super) fn draw(out: &mut String, frame: &Frame, map: &TileMap<TagId>, looks: &Looks) {
    let kinds = map.kinds.iter().map(|kind| kind.tags.iter().copied().collect::<TagSet>());
    let kinds: Vec<Option<u16>> = kinds.map(|tags| looks.of(tags).map(|look| look as u16)).collect();
    let cells = map.cells.iter().map(|&kind| kinds[usize::from(kind)]).collect();
    let mut grid = Grid { columns: map.columns, rows: map.rows, tile: map.tile, looks: cells };
    let mut rectangles = grid.rectangles();
    while rectangles.len() > MAX_RECTANGLES {
        grid = grid.coarser();
        rectangles = grid.rectangles();
    }
    for (index, look) in looks.list.iter().enumerate() {
        let (mut data, mut lips) = (String::new(), String::new());
        let own = rectangles.iter().filter(|(of, _)| usize::from(*of) == index);
        for rect in own.filter_map(|(_, bounds)| frame.cut(*bounds)) {
            box_data(&mut data, rect);
            if look.role == Role::OneWay {
                let mut lip = rect;
                lip.height = LIP.min(rect.height);
                box_data(&mut lips, lip);
            }
        }
        path(out, &format!("tile {}", look.class), &data);
        path(out, "tile lip", &lips);
    }
}

impl Grid {
    /// Rectangles of tiles of one look: runs of a row, joined with the same runs of the rows above.
    fn rectangles(&self) -> Vec<(u16, Bounds)> {
        let mut rectangles = Vec::new();
        // First column, column after, look, first row.
        let mut open: Vec<(usize, usize, u16, usize)> = Vec::new();
        for row in 0..=self.rows {
            let cells = self.looks.get(row * self.columns..(row + 1) * self.columns).unwrap_or_default();
            let mut runs = Vec::new();
            let mut column = 0;
            for run in cells.chunk_by(PartialEq::eq) {
                if let Some(look) = run[0] {
                    runs.push((column, column + run.len(), look));
                }
                column += run.len();
            }
            let mut next = Vec::with_capacity(runs.len());
            // Both lists are in the order of columns.
            let mut old = open.into_iter().peekable();
            for (first, after, look) in runs {
                let mut from = row;
                while let Some(rectangle) = old.next_if(|o| o.0 <= first) {
                    if (rectangle.0, rectangle.1, rectangle.2) == (first, after, look) {
                        from = rectangle.3;
                    } else {
                        rectangles.push(self.rectangle(rectangle, row));
                    }
                }
                next.push((first, after, look, from));
            }
            rectangles.extend(old.map(|rectangle| self.rectangle(rectangle, row)));
            open = next;
        }
        rectangles
    }

    fn rectangle(&self, (first, after, look, row): (usize, usize, u16, usize), end: usize) -> (u16, Bounds) {
        let ((left, right), (bottom, top)) = ((first as f64, after as f64), (row as f64, end as f64));
        let (width, height) = self.tile;
        (look, Bounds { left: left * width, right: right * width, bottom: bottom * height, top: top * height })
    }

    /// Four tiles as one, which looks as most of them do.
    fn coarser(&self) -> Grid {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let mut looks = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let at = |x: usize, y: usize| {
                    let (x, y) = (2 * column + x, 2 * row + y);
                    (x < self.columns && y < self.rows).then(|| self.looks[y * self.columns + x])
                };
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                let votes = |look: &Option<u16>| four.iter().flatten().filter(|other| *other == look).count();
                let most =
                    four.iter().flatten().reduce(|best, next| if votes(next) > votes(best) { next } else { best });
                looks.push(most.copied().flatten());
            }
        }
        Grid { columns, rows, tile: (2.0 * self.tile.0, 2.0 * self.tile.1), looks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(rows: &[&str]) -> Grid {
        let look = |c: char| c.to_digit(10).map(|d| d as u16);
        let looks = rows.iter().flat_map(|row| row.chars().map(look)).collect();
        Grid { columns: rows[0].len(), rows: rows.len(), tile: (1.0, 1.0), looks }
    }

    #[test]
    fn rectangles_cover_each_tile_once() {
        let grid = grid(&["11.2", "11.2", "1222", "..2."]);
        let rectangles = grid.rectangles();
        assert_eq!(rectangles.len(), 5);
        for (index, look) in grid.looks.iter().enumerate() {
            let (x, y) = ((index % 4) as f64 + 0.5, (index / 4) as f64 + 0.5);
            let over: Vec<u16> = rectangles
                .iter()
                .filter(|(_, b)| (b.left..b.right).contains(&x) && (b.bottom..b.top).contains(&y))
                .map(|(look, _)| *look)
                .collect();
            assert_eq!(over, Vec::from_iter(*look), "({x}, {y})");
        }
    }

    #[test]
    fn coarser_tiles_look_as_most_do() {
        let grid = grid(&["11.2.", "1.22.", "....1"]).coarser();
        assert_eq!((grid.columns, grid.rows), (3, 2));
        assert_eq!(grid.looks, [Some(1), Some(2), None, None, None, Some(1)]);
    }
}

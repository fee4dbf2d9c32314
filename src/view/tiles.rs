//! The tiles of a map: equal neighbours are merged into rectangles, and a map with very many small tiles is drawn
//! coarser. Slopes are drawn as what is below their line. Tiles that can be broken have dashed outlines.

use crate::ir::{Bounds, Extremes, Slope, SpaceId, TagId, TagSet, TileMap};

use super::appearance::{Appearances, Role};
use super::frame::{Frame, shared};
use super::look::{self, Images};
use super::svg::{Number, box_data, line_data, path, put, styled_path};

/// Maximum number of rectangles of a map.
const MAX_RECTANGLES: usize = 15_000;
/// Height of the upper edge of the ground, in the picture.
const LIP: f64 = 3.0;

/// Tiles by the index of their appearance.
struct Grid {
    columns: usize,
    rows: usize,
    tile: (f64, f64),
    appearances: Vec<Option<u16>>,
}

/// Draws a map.
pub(super) fn draw(
    out: &mut String,
    frame: &Frame,
    map: &TileMap<TagId>,
    appearances: &Appearances,
    (images, space): (&Images, SpaceId),
) {
    let kinds = map.kinds.iter().map(|kind| kind.tags.iter().copied().collect::<TagSet>());
    let kinds: Vec<Option<u16>> = kinds.map(|tags| appearances.of(tags).map(|appearance| appearance as u16)).collect();
    let is_slope = |kind: &u16| map.kinds[usize::from(*kind)].slope.is_some();
    // Very many slopes are drawn as whole tiles.
    let has_slopes = map.cells.iter().filter(|kind| is_slope(kind)).nth(MAX_RECTANGLES).is_none();
    let cells = map.cells.iter().map(|kind| kinds[usize::from(*kind)].filter(|_| !(has_slopes && is_slope(kind))));
    let cells = cells.collect();
    let mut grid = Grid { columns: map.columns, rows: map.rows, tile: map.tile, appearances: cells };
    let mut rectangles = grid.rectangles();
    while rectangles.len() > MAX_RECTANGLES {
        grid = grid.coarser();
        rectangles = grid.rectangles();
    }
    for (index, appearance) in appearances.list.iter().enumerate() {
        let (mut data, mut lips) = (String::new(), String::new());
        let own = rectangles.iter().filter(|(of, _)| usize::from(*of) == index);
        for rect in own.filter_map(|(_, bounds)| frame.cut(*bounds)) {
            box_data(&mut data, rect);
            if appearance.role == Role::OneWay {
                let mut lip = rect;
                lip.height = LIP.least(rect.height);
                box_data(&mut lips, lip);
            }
        }
        let slopes = map.cells.iter().enumerate().filter(|(_, kind)| has_slopes && is_slope(kind));
        for (cell, kind) in slopes.filter(|(_, kind)| kinds[usize::from(**kind)] == Some(index as u16)) {
            slope(&mut data, frame, map, cell, usize::from(*kind));
        }
        let symbol = appearance.look.as_ref().and_then(|look| images.symbol(look)).filter(|_| !data.is_empty());
        let style = match symbol {
            Some(symbol) => {
                let name = format!("tiles{}-{index}-{}-{}", space.0, frame.view.left as i64, frame.view.bottom as i64);
                pattern(out, frame, map.tile, (&name, &symbol));
                format!(" style=\"fill:url(#{name});fill-opacity:1\"")
            }
            None => look::fill(appearance.look.as_ref()),
        };
        styled_path(out, &format!("tile {}", appearance.class), &style, &data);
        path(out, "tile lip", &lips);
    }
    breakable(out, frame, map);
}

/// Defines a pattern that repeats a picture tile by tile.
fn pattern(out: &mut String, frame: &Frame, tile: (f64, f64), (name, symbol): (&str, &str)) {
    let [x, y] = frame.point([0.0, 0.0]).map(Number);
    let (width, height) = (Number(tile.0 * frame.scale), Number(tile.1 * frame.scale));
    put!(
        out,
        "<pattern id=\"{name}\" patternUnits=\"userSpaceOnUse\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">\
         <use href=\"#{symbol}\" width=\"{width}\" height=\"{height}\"/></pattern>\n"
    );
}

/// Adds what is below the line of a slope, as far as it is in the picture.
fn slope(data: &mut String, frame: &Frame, map: &TileMap<TagId>, cell: usize, kind: usize) {
    let tile = Bounds::new(map.rectangle(cell));
    let (Some(Slope { left, right }), Some(_)) = (map.kinds[kind].slope, frame.cut(tile)) else { return };
    let seen = shared(tile, frame.view);
    let top = |x: f64| {
        let along = (x - tile.left) / (tile.right - tile.left);
        (tile.bottom + left + (right - left) * along).clamp(seen.bottom, seen.top)
    };
    let corners = [
        [seen.left, seen.bottom],
        [seen.right, seen.bottom],
        [seen.right, top(seen.right)],
        [seen.left, top(seen.left)],
    ];
    line_data(data, &corners.map(|corner| frame.point(corner)));
    data.push('z');
}

/// Draws a dashed line around each tile that can be broken, unless they are too many to be seen.
fn breakable(out: &mut String, frame: &Frame, map: &TileMap<TagId>) {
    let breaks = |kind: &u16| map.kinds[usize::from(*kind)].breakable.is_some();
    let cells = || map.cells.iter().enumerate().filter(|(_, kind)| breaks(kind));
    let mut data = String::new();
    if cells().nth(MAX_RECTANGLES).is_none() {
        let bounds = cells().map(|(cell, _)| Bounds::new(map.rectangle(cell)));
        bounds.filter_map(|bounds| frame.cut(bounds)).for_each(|rect| box_data(&mut data, rect));
    }
    path(out, "bounds", &data);
}

impl Grid {
    /// Rectangles of tiles with one appearance: runs of a row, merged with equal runs of the rows above.
    fn rectangles(&self) -> Vec<(u16, Bounds)> {
        let mut rectangles = Vec::new();
        // First column, end column, appearance, first row.
        let mut open: Vec<(usize, usize, u16, usize)> = Vec::new();
        for row in 0..=self.rows {
            let cells = self.appearances.get(row * self.columns..(row + 1) * self.columns).unwrap_or_default();
            let mut runs = Vec::new();
            let mut column = 0;
            for run in cells.chunk_by(PartialEq::eq) {
                if let Some(appearance) = run[0] {
                    runs.push((column, column + run.len(), appearance));
                }
                column += run.len();
            }
            let mut next = Vec::with_capacity(runs.len());
            // Both lists are ordered by column.
            let mut old = open.into_iter().peekable();
            for (first, after, appearance) in runs {
                let mut from = row;
                while let Some(rectangle) = old.next_if(|o| o.0 <= first) {
                    if (rectangle.0, rectangle.1, rectangle.2) == (first, after, appearance) {
                        from = rectangle.3;
                    } else {
                        rectangles.push(self.rectangle(rectangle, row));
                    }
                }
                next.push((first, after, appearance, from));
            }
            rectangles.extend(old.map(|rectangle| self.rectangle(rectangle, row)));
            open = next;
        }
        rectangles
    }

    fn rectangle(&self, (first, after, appearance, row): (usize, usize, u16, usize), end: usize) -> (u16, Bounds) {
        let ((left, right), (bottom, top)) = ((first as f64, after as f64), (row as f64, end as f64));
        let (width, height) = self.tile;
        (appearance, Bounds { left: left * width, right: right * width, bottom: bottom * height, top: top * height })
    }

    /// Merges four tiles into one with the most frequent appearance.
    fn coarser(&self) -> Grid {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let mut appearances = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let at = |x: usize, y: usize| {
                    let (x, y) = (2 * column + x, 2 * row + y);
                    (x < self.columns && y < self.rows).then(|| self.appearances[y * self.columns + x])
                };
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                let votes =
                    |appearance: &Option<u16>| four.iter().flatten().filter(|other| *other == appearance).count();
                let most =
                    four.iter().flatten().reduce(|best, next| if votes(next) > votes(best) { next } else { best });
                appearances.push(most.copied().flatten());
            }
        }
        Grid { columns, rows, tile: (2.0 * self.tile.0, 2.0 * self.tile.1), appearances }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(rows: &[&str]) -> Grid {
        let appearance = |c: char| c.to_digit(10).map(|d| d as u16);
        let appearances = rows.iter().flat_map(|row| row.chars().map(appearance)).collect();
        Grid { columns: rows[0].len(), rows: rows.len(), tile: (1.0, 1.0), appearances }
    }

    #[test]
    fn rectangles_cover_each_tile_once() {
        let grid = grid(&["11.2", "11.2", "1222", "..2."]);
        let rectangles = grid.rectangles();
        assert_eq!(rectangles.len(), 5);
        for (index, appearance) in grid.appearances.iter().enumerate() {
            let (x, y) = ((index % 4) as f64 + 0.5, (index / 4) as f64 + 0.5);
            let over: Vec<u16> = rectangles
                .iter()
                .filter(|(_, b)| (b.left..b.right).contains(&x) && (b.bottom..b.top).contains(&y))
                .map(|(appearance, _)| *appearance)
                .collect();
            assert_eq!(over, Vec::from_iter(*appearance), "({x}, {y})");
        }
    }

    #[test]
    fn coarser_tiles_look_as_most_do() {
        let grid = grid(&["11.2.", "1.22.", "....1"]).coarser();
        assert_eq!((grid.columns, grid.rows), (3, 2));
        assert_eq!(grid.appearances, [Some(1), Some(2), None, None, None, Some(1)]);
    }
}

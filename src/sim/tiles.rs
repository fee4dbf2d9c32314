//! Contacts between bodies and the tiles of a map.

use std::cell::Cell;
use std::ops::Range;

use crate::ir::{Bounds, Extremes, Id, Push, Side, Slope, SpaceId, TagId, TileMap, World};
use crate::watch::Meter;

use super::breakable::Breakables;
use super::collision::Body;
use super::contact::{Displacement, Overlap, Rect, TOLERANCE, meet};
use super::encounter::Encounter;
use super::seam::Around;
use super::simulator::Simulator;
use super::slope::Line;

/// A map with the contact rules of one kind of body.
#[derive(Clone, Copy)]
pub(super) struct Tiles<'a> {
    pub map: &'a TileMap<TagId>,
    /// For each kind of tile.
    encounters: &'a [Option<Encounter>],
    /// Those that can be broken, if there are any, and the index of the space.
    breakables: Option<(&'a Breakables, usize)>,
    /// As in [`super::collision::Scratch`].
    lengths: &'a [Cell<f64>],
    /// Counts the rectangles that are searched for covered faces.
    pub meter: &'a Meter<'a>,
    /// The cells of a map that is rare: beyond the seams of a space that wraps, or with slopes.
    around: Option<&'a Around>,
    /// For each kind of tile, the line up to which it is solid; empty if the map has no slopes.
    slopes: &'a [Option<Slope>],
}

/// A tile: where it is seen, and the index of its cell.
#[derive(Clone, Copy)]
pub(super) struct Tile {
    pub column: i64,
    pub row: i64,
    pub at: usize,
}

impl<'a> Tiles<'a> {
    /// Whether the tile of a cell, by its index, blocks.
    #[inline]
    pub fn blocks(&self, state: &[u8], at: usize) -> bool {
        let met = self.map.cells.get(at).and_then(|&kind| self.encounters[usize::from(kind)].as_ref());
        met.is_some_and(|w| w.meeting.response.push == Push::Block) && !self.is_gone(state, at)
    }

    /// Whether the tile of a cell is broken.
    #[inline]
    fn is_gone(&self, state: &[u8], at: usize) -> bool {
        self.breakables.is_some_and(|(breakables, space)| breakables.is_gone(state, space, at))
    }

    /// Whether the neighbour blocks that covers the face of a tile which a side of a body touches.
    #[inline(always)]
    fn covers(&self, state: &[u8], tile: Tile, side: Side, rect: &Rect, overlap: &Overlap) -> bool {
        let Tile { column, row, at } = tile;
        if let Some(around) = self.around {
            return self.covers_around(state, around, tile, side, (rect, overlap.x_side));
        }
        // There are no obstacles outside the map.
        match side {
            Side::Right => column > 0 && self.blocks(state, at - 1),
            Side::Left => column + 1 < self.map.columns as i64 && self.blocks(state, at + 1),
            Side::Above => row > 0 && self.blocks(state, at - self.map.columns),
            Side::Below => self.blocks(state, at + self.map.columns),
        }
    }

    /// As [`Tiles::covers`] of a rare map. A slope covers a left or right face that it is as high as; the face below it
    /// only for what does not come from above its line, and only if that cannot be pushed to the side.
    #[cold]
    fn covers_around(
        &self,
        state: &[u8],
        around: &Around,
        tile: Tile,
        side: Side,
        (rect, x_side): (&Rect, Side),
    ) -> bool {
        let (x, y) = match side {
            Side::Right => (-1, 0),
            Side::Left => (1, 0),
            Side::Above => (0, -1),
            Side::Below => (0, 1),
        };
        let (column, row) = (tile.column + x, tile.row + y);
        let Some(at) = around.cell(self.map, column, row).filter(|at| self.blocks(state, *at)) else { return false };
        let beside = Tile { column, row, at };
        let Some(line) = self.line(beside) else { return true };
        let height = self.map.tile.1 - TOLERANCE;
        match side {
            Side::Right => line.slope.right >= height,
            Side::Left => line.slope.left >= height,
            Side::Above => false,
            Side::Below => {
                let joined = |to_left| self.joined(state, around, (beside, line), to_left);
                let is_pushed_aside = !self.covers_around(state, around, tile, x_side, (rect, x_side));
                is_pushed_aside && !line.is_below(&rect.moved(rect.back.into()), joined)
            }
        }
    }

    /// The contact rule with the tile of a cell, unless it is broken.
    pub fn encounter(&self, state: &[u8], at: usize) -> Option<&'a Encounter> {
        let kind = *self.map.cells.get(at)?;
        self.encounters[usize::from(kind)].as_ref().filter(|_| !self.is_gone(state, at))
    }

    /// The box of the tile at a column and a row.
    pub fn bounds(&self, column: i64, row: i64) -> Bounds {
        let (width, height) = self.map.tile;
        let (left, bottom) = (column as f64 * width, row as f64 * height);
        Bounds { left, right: left + width, bottom, top: bottom + height }
    }

    /// The line of a tile, if it is a slope.
    pub fn line(&self, tile: Tile) -> Option<Line> {
        let slope = (*self.slopes.get(usize::from(*self.map.cells.get(tile.at)?))?)?;
        Some(Line { tile: self.bounds(tile.column, tile.row), slope })
    }

    /// The line of a slope that the body meets, with the rule of the contact.
    pub fn slope_at(&self, state: &[u8], tile: Tile) -> Option<(&'a Encounter, Line)> {
        let line = self.line(tile)?;
        Some((self.encounter(state, tile.at)?, line))
    }

    /// Whether a tile blocks that is no slope.
    pub fn is_wall(&self, state: &[u8], around: &Around, (column, row): (i64, i64)) -> bool {
        let at = around.cell(self.map, column, row).filter(|at| self.blocks(state, *at));
        at.is_some_and(|at| self.line(Tile { column, row, at }).is_none())
    }

    /// How high the tile at a column and a row is on its right side, or on its left, if it blocks, px.
    pub fn height_beside(
        &self,
        state: &[u8],
        around: &Around,
        (column, row): (i64, i64),
        on_right: bool,
    ) -> Option<f64> {
        let at = around.cell(self.map, column, row).filter(|at| self.blocks(state, *at))?;
        let slope = self.line(Tile { column, row, at }).map(|line| line.slope);
        Some(slope.map_or(self.map.tile.1, |slope| if on_right { slope.right } else { slope.left }))
    }

    /// How steep the slope rises that joins the left or the right end of another's line, px per px; 0 if none does.
    pub fn joined(&self, state: &[u8], around: &Around, (tile, line): (Tile, Line), to_left: bool) -> f64 {
        let (width, height) = self.map.tile;
        let end = if to_left { line.slope.left } else { line.slope.right };
        let column = if to_left { tile.column - 1 } else { tile.column + 1 };
        let (row, end) = if end == 0.0 { (tile.row - 1, height) } else { (tile.row, end) };
        let at = around.cell(self.map, column, row);
        let found = at.and_then(|at| self.slope_at(state, Tile { column, row, at }));
        found.map_or(0.0, |(_, Line { slope, .. })| match to_left {
            true if slope.right == end => (slope.right - slope.left) / width,
            false if slope.left == end => (slope.left - slope.right) / width,
            _ => 0.0,
        })
    }

    /// The number of tiles near a box.
    pub fn count_near(&self, around: &Around, rect: &Rect) -> u64 {
        let (width, height) = self.map.tile;
        let count = |cells: Range<i64>| (cells.end - cells.start).max(0) as u64;
        let columns = count(cells_between(rect.left, rect.right, width, &around.columns));
        columns.saturating_mul(count(cells_between(rect.bottom, rect.top, height, &around.rows)))
    }

    /// The columns and rows of the tiles near a box; a cell more at both ends makes up for rounding.
    pub fn near(&self, around: &Around, rect: &Rect) -> impl Iterator<Item = (i64, i64)> + use<> {
        let (width, height) = self.map.tile;
        let columns = cells_between(rect.left, rect.right, width, &around.columns);
        let rows = cells_between(rect.bottom, rect.top, height, &around.rows);
        rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }
}

/// The cells along an axis that an interval may touch, and one more at both ends; the cast saturates.
fn cells_between(low: f64, high: f64, size: f64, within: &Range<i64>) -> Range<i64> {
    let first = ((low / size).floor() as i64).saturating_sub(1).max(within.start);
    first..((high / size).floor() as i64).saturating_add(2).min(within.end)
}

/// From this number of tiles on, a body polls the meter in between.
const LARGE: usize = 1 << 14;

impl Simulator {
    /// Handles the tiles near a body; returns the number of examined tiles that the meter has not counted.
    #[inline(always)]
    pub(super) fn collide_tiles(
        &self,
        state: &mut [u8],
        body: &Body,
        rect: &Rect,
        (displacement, lengths): (&mut Displacement, &[Cell<f64>]),
        meter: &Meter<'_>,
    ) -> usize {
        let Some(map) = &self.world().spaces[SpaceId(rect.space)].map else { return 0 };
        let encounters = &*self.collision.kinds[body.kind].tiles[rect.space as usize];
        let breakables = self.breakables.as_deref().map(|breakables| (breakables, rect.space as usize));
        let tiles = Tiles { map, encounters, breakables, lengths, meter, around: None, slopes: &[] };
        if self.collision.rare_maps.as_ref().is_some_and(|rare| rare[rect.space as usize]) {
            return self.collide_tiles_around(state, (body, rect), tiles, displacement);
        }
        let [columns, rows] = &self.collision.grids[rect.space as usize];
        let (first, after) = columns.range(rect.left, rect.right);
        let (low, high) = rows.range(rect.bottom, rect.top);
        let examined = (high - low) * (after - first);
        let is_large = examined > LARGE;
        for row in low..high {
            if is_large && meter.spend((after - first) as u64) {
                break;
            }
            let start = row * map.columns;
            let Some(cells) = map.cells.get(start + first..start + after) else { continue };
            for (index, &kind) in cells.iter().enumerate() {
                if let Some(with) = &encounters[usize::from(kind)] {
                    let cell = Tile { column: (first + index) as i64, row: row as i64, at: start + first + index };
                    self.collide_tile(state, (body, rect), &tiles, cell, with, displacement);
                }
            }
        }
        if is_large { 0 } else { examined }
    }

    /// As [`Simulator::collide_tiles`] of a map in a space that wraps, where its other end lies beside it, or with slopes,
    /// which are looked at later.
    #[cold]
    fn collide_tiles_around(
        &self,
        state: &mut [u8],
        (body, rect): (&Body, &Rect),
        tiles: Tiles<'_>,
        displacement: &mut Displacement,
    ) -> usize {
        let map = tiles.map;
        let around = &Around::new(&self.world().spaces[SpaceId(rect.space)], map);
        let slopes = self.collision.slopes.as_deref().map_or(&[][..], |slopes| slopes.of_space(rect.space as usize));
        let tiles = Tiles { around: Some(around), slopes, ..tiles };
        let columns = cells_between(rect.left, rect.right, map.tile.0, &around.columns);
        let mut examined = 0;
        for row in cells_between(rect.bottom, rect.top, map.tile.1, &around.rows) {
            if tiles.meter.spend(columns.clone().count() as u64) {
                break;
            }
            for column in columns.clone() {
                let Some(at) = around.cell(map, column, row) else { continue };
                let kind = usize::from(map.cells[at]);
                let Some(with) = &tiles.encounters[kind] else { continue };
                if slopes.get(kind).is_some_and(Option::is_some) {
                    continue;
                }
                examined += 1;
                self.collide_tile(state, (body, rect), &tiles, Tile { column, row, at }, with, displacement);
            }
        }
        examined
    }

    /// Handles a body and a tile.
    #[inline(never)]
    fn collide_tile(
        &self,
        state: &mut [u8],
        (body, rect): (&Body, &Rect),
        tiles: &Tiles<'_>,
        cell: Tile,
        with: &Encounter,
        displacement: &mut Displacement,
    ) {
        if tiles.is_gone(state, cell.at) {
            return;
        }
        let (width, height) = tiles.map.tile;
        let (left, bottom) = (cell.column as f64 * width, cell.row as f64 * height);
        let (right, top) = (left + width, bottom + height);
        let tile = Rect { left, right, bottom, top, active: true, ..Rect::default() };
        // The faces turned to the body; a covered one never gives the side.
        let mut corner = None;
        let contact = meet(rect, &tile, rect.back, with.meeting, |overlap| {
            let is_beside_rect = self.is_beside_rect(rect.space as usize, cell.at);
            // The face along the axis of least penetration gives the side if nothing covers it, whatever the other is.
            if !is_beside_rect && !tiles.covers(state, cell, overlap.least().side, rect, overlap) {
                return (false, false);
            }
            let covered = self.covered_tile(state, (body, rect), tiles, (cell, &tile), overlap);
            if covered == (true, true) && overlap.came_diagonally(rect.back) {
                corner = Some([overlap.horizontal(), overlap.vertical()]);
            }
            covered
        });
        let Some(contact) = contact else { return };
        self.static_contact(state, body, with, contact, displacement);
        self.corner_contact(body, with, corner, displacement);
        if with.more {
            self.touch_tile_along(state, body, (with, tiles), (rect, &tile), cell, contact.side);
        }
    }

    /// Keeps a tile that a body touches with a side, if the tile can be broken and a contact query can name it.
    #[inline]
    pub(super) fn touch_tile_along(
        &self,
        state: &mut [u8],
        body: &Body,
        (with, tiles): (&Encounter, &Tiles<'_>),
        (rect, part): (&Rect, &Rect),
        tile: Tile,
        side: Side,
    ) {
        if with.more
            && let Some(broken) = tiles.breakables.and_then(|(breakables, space)| breakables.tile(space, tile.at))
        {
            let length = match side {
                Side::Left | Side::Right => rect.top.least(part.top) - rect.bottom.greatest(part.bottom),
                Side::Above | Side::Below => rect.right.least(part.right) - rect.left.greatest(part.left),
            };
            let actor = &self.actors[body.slot.index()];
            let mine = self.collision.kinds[body.kind].tags;
            self.touch_tile(state, (actor, mine), (broken, with.tags), (side, length), tiles.lengths);
        }
    }

    /// The map of a space with slopes, as a body meets it.
    pub(super) fn tiles<'a>(
        &'a self,
        body: &Body,
        map: &'a TileMap<TagId>,
        space: usize,
        (lengths, meter): (&'a [Cell<f64>], &'a Meter<'a>),
        around: &'a Around,
    ) -> Tiles<'a> {
        let slopes = self.collision.slopes.as_deref().map_or(&[][..], |slopes| slopes.of_space(space));
        let encounters = &*self.collision.kinds[body.kind].tiles[space];
        let breakables = self.breakables.as_deref().map(|breakables| (breakables, space));
        Tiles { map, encounters, breakables, lengths, meter, around: Some(around), slopes }
    }
}

impl Simulator {
    /// Whether neighbours cover the left or right face of a tile that is turned to a body, and its upper or lower face.
    #[inline(never)]
    fn covered_tile(
        &self,
        state: &[u8],
        (body, rect): (&Body, &Rect),
        tiles: &Tiles<'_>,
        (cell, tile): (Tile, &Rect),
        overlap: &Overlap,
    ) -> (bool, bool) {
        let space = rect.space as usize;
        let covers = |side: Side| tiles.covers(state, cell, side, rect, overlap);
        let covered = (covers(overlap.x_side), covers(overlap.y_side));
        if covered == (true, true) || !self.is_beside_rect(space, cell.at) {
            return covered;
        }
        let kind = &self.collision.kinds[body.kind];
        self.covered(state, (kind, space), (rect, tile), overlap, covered, tiles.meter)
    }
}

/// The columns or the rows of a map, for looking up the tiles near a body without a division.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Grid {
    count: usize,
    /// The reciprocal of a tile's size, rounded down and up, 1/px.
    per_px: (f64, f64),
}

impl Grid {
    /// The columns and the rows of each space; none without a map.
    pub fn of(world: &World) -> Vec<[Grid; 2]> {
        let of = |space| {
            let Some(map) = &world.spaces[space].map else { return [Grid::default(); 2] };
            [Grid::new(map.tile.0, map.columns), Grid::new(map.tile.1, map.rows)]
        };
        world.spaces.ids().map(of).collect()
    }

    fn new(size: f64, count: usize) -> Grid {
        // Wider than the rounding errors of a reciprocal and of a product with it.
        const MARGIN: f64 = 4.0 * f64::EPSILON;
        Grid { count, per_px: ((1.0 - MARGIN) / size, (1.0 + MARGIN) / size) }
    }

    /// A half-open range that contains all tiles whose closed extent overlaps `low..=high`. A tile that is only touched
    /// along its edge counts; one that is missed by a rounding error may be among them.
    #[inline]
    pub fn range(&self, low: f64, high: f64) -> (usize, usize) {
        let (low, high) = (low * self.per_px.0, high * self.per_px.1);
        // The cast truncates, which is the floor of a non-negative number, and saturates. That to 32 bits is the cheapest.
        let after = if high < 0.0 { 0 } else { (high as u32 as usize).saturating_add(1).min(self.count) };
        ((low as u32 as usize).min(after), after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_contains_every_tile_that_is_touched() {
        for size in [16.0, 0.1, 1.0 / 3.0, 7.3, 1e-3, 1e6] {
            let grid = Grid::new(size, 5000);
            for tile in (0..5000i32).step_by(7) {
                let (left, right) = (f64::from(tile) * size, f64::from(tile) * size + size);
                let contains = |low, high| {
                    let (first, after) = grid.range(low, high);
                    (first..after).contains(&(tile as usize))
                };
                assert!(contains(right, right + size) && contains(left - size, left), "{size} {tile}: touched");
                assert!(contains(left, right), "{size} {tile}: filled");
                assert!(!contains(right + 0.01 * size, right + size), "{size} {tile}: apart");
                assert!(!contains(left - size, left - 0.01 * size), "{size} {tile}: apart");
            }
        }
        assert_eq!(Grid::new(16.0, 10).range(-40.0, -1.0), (0, 0));
        assert_eq!(Grid::new(16.0, 10).range(150.0, 1e300), (9, 10));
        assert_eq!(Grid::default().range(3.0, 4.0), (0, 0));
    }
}

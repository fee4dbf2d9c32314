//! Contacts between bodies and the tiles of a map.

use std::cell::Cell;
use std::ops::Range;

use crate::ir::{Id, Push, Side, SpaceId, TagId, TileMap, World};
use crate::watch::Meter;

use super::breakable::Breakables;
use super::collision::{Body, Encounter};
use super::contact::{Displacement, Overlap, Rect, meet};
use super::seam::Around;
use super::simulator::Simulator;

/// A map with the contact rules of one kind of body.
struct Tiles<'a> {
    map: &'a TileMap<TagId>,
    /// For each kind of tile.
    encounters: &'a [Option<Encounter>],
    /// Those that can be broken, if there are any, and the index of the space.
    breakables: Option<(&'a Breakables, usize)>,
    /// As in [`super::collision::Scratch`].
    lengths: &'a [Cell<f64>],
    /// Counts the rectangles that are searched for covered faces.
    meter: &'a Meter<'a>,
    /// The cells beyond the seams of a space that wraps.
    around: Option<&'a Around>,
}

/// A tile: where it is seen, and the index of its cell.
#[derive(Clone, Copy)]
struct Tile {
    column: i64,
    row: i64,
    at: usize,
}

impl Tiles<'_> {
    /// Whether the tile of a cell, by its index, blocks.
    #[inline]
    fn blocks(&self, state: &[u8], at: usize) -> bool {
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
    fn covers(&self, state: &[u8], tile: Tile, side: Side) -> bool {
        let Tile { column, row, at } = tile;
        if let Some(around) = self.around {
            return self.covers_around(state, around, tile, side);
        }
        // There are no obstacles outside the map.
        match side {
            Side::Right => column > 0 && self.blocks(state, at - 1),
            Side::Left => column + 1 < self.map.columns as i64 && self.blocks(state, at + 1),
            Side::Above => row > 0 && self.blocks(state, at - self.map.columns),
            Side::Below => self.blocks(state, at + self.map.columns),
        }
    }

    /// As [`Tiles::covers`] in a space that wraps.
    #[cold]
    fn covers_around(&self, state: &[u8], around: &Around, Tile { column, row, .. }: Tile, side: Side) -> bool {
        let (x, y) = match side {
            Side::Right => (-1, 0),
            Side::Left => (1, 0),
            Side::Above => (0, -1),
            Side::Below => (0, 1),
        };
        around.cell(self.map, column + x, row + y).is_some_and(|at| self.blocks(state, at))
    }
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
        let tiles = Tiles { map, encounters, breakables, lengths, meter, around: None };
        if self.collision.seams.is_some() && self.world().spaces[SpaceId(rect.space)].wraps() {
            return self.collide_tiles_around(state, (body, rect), tiles, displacement);
        }
        let [columns, rows] = &self.collision.grids[rect.space as usize];
        let (first, after) = columns.range(rect.left, rect.right);
        let (low, high) = rows.range(rect.bottom, rect.top);
        let examined = (high - low.min(high)) * (after - first.min(after));
        let is_large = examined > LARGE;
        for row in low..high {
            if is_large && meter.spend((after - first.min(after)) as u64) {
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

    /// As [`Simulator::collide_tiles`] in a space that wraps, where the other end of the map lies beside it.
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
        let tiles = Tiles { around: Some(around), ..tiles };
        // A cell more at both ends makes up for rounding; the cast saturates.
        let range = |low: f64, high: f64, size: f64, within: &Range<i64>| {
            let first = ((low / size).floor() as i64).saturating_sub(1).max(within.start);
            first..((high / size).floor() as i64).saturating_add(2).min(within.end)
        };
        let columns = range(rect.left, rect.right, map.tile.0, &around.columns);
        let mut examined = 0;
        for row in range(rect.bottom, rect.top, map.tile.1, &around.rows) {
            if tiles.meter.spend(columns.clone().count() as u64) {
                break;
            }
            for column in columns.clone() {
                let Some(at) = around.cell(map, column, row) else { continue };
                let Some(with) = &tiles.encounters[usize::from(map.cells[at])] else { continue };
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
            if !is_beside_rect && !tiles.covers(state, cell, overlap.least().side) {
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
        if with.more
            && let Some(broken) = tiles.breakables.and_then(|(breakables, space)| breakables.tile(space, cell.at))
        {
            let length = match contact.side {
                Side::Left | Side::Right => rect.top.min(top) - rect.bottom.max(bottom),
                Side::Above | Side::Below => rect.right.min(right) - rect.left.max(left),
            };
            let actor = &self.actors[body.slot.index()];
            let mine = self.collision.kinds[body.kind].tags;
            self.touch_tile(state, (actor, mine), (broken, with.tags), (contact.side, length), tiles.lengths);
        }
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
        let covered = (tiles.covers(state, cell, overlap.x_side), tiles.covers(state, cell, overlap.y_side));
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
        (low as u32 as usize, after)
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

//! Contacts between bodies and the tiles of a map.

use crate::ir::{Push, Side, SpaceId, TagId, TileMap};
use crate::watch::Meter;

use super::collision::{Body, Encounter};
use super::contact::{Displacement, Rect, meet};
use super::simulator::Simulator;

/// A map with the contact rules of one kind of body.
#[derive(Clone, Copy)]
struct Tiles<'a> {
    map: &'a TileMap<TagId>,
    /// For each kind of tile.
    encounters: &'a [Option<Encounter>],
    /// Counts the rectangles that are searched for covered faces.
    meter: &'a Meter<'a>,
}

impl Tiles<'_> {
    /// Whether the tile of a cell, by its index, blocks.
    fn blocks(self, at: usize) -> bool {
        let met = self.map.cells.get(at).and_then(|&kind| self.encounters[usize::from(kind)].as_ref());
        met.is_some_and(|w| w.meeting.response.push == Push::Block)
    }
}

/// From this number of tiles on, a body polls the meter in between.
const LARGE: usize = 1 << 14;

impl Simulator {
    /// Handles the tiles near a body; returns the number of examined tiles that the meter has not counted.
    pub(super) fn collide_tiles(
        &self,
        state: &mut [u8],
        body: &Body,
        rect: &Rect,
        displacement: &mut Displacement,
        meter: &Meter<'_>,
    ) -> usize {
        let Some(map) = &self.world().spaces[SpaceId(rect.space)].map else { return 0 };
        let encounters = &*self.collision.kinds[body.kind].tiles[rect.space as usize];
        let tiles = Tiles { map, encounters, meter };
        let (width, height) = map.tile;
        // A tile that is touched along its edge counts, so the range is closed at both ends.
        let (first, after) = range(rect.left, rect.right, width, map.columns);
        let (low, high) = range(rect.bottom, rect.top, height, map.rows);
        let examined = (high - low.min(high)) * (after - first.min(after));
        let is_large = examined > LARGE;
        for row in low..high {
            if is_large && meter.spend((after - first.min(after)) as u64) {
                break;
            }
            let start = row * map.columns;
            let Some(cells) = map.cells.get(start + first..start + after) else { continue };
            for (column, &kind) in (first..).zip(cells) {
                if let Some(with) = &encounters[usize::from(kind)] {
                    self.collide_tile(state, (body, rect), tiles, (column, row), with, displacement);
                }
            }
        }
        if is_large { 0 } else { examined }
    }

    /// Handles a body and the tile of a cell.
    #[inline(never)]
    fn collide_tile(
        &self,
        state: &mut [u8],
        (body, rect): (&Body, &Rect),
        tiles: Tiles<'_>,
        (column, row): (usize, usize),
        with: &Encounter,
        displacement: &mut Displacement,
    ) {
        let map = tiles.map;
        let at = row * map.columns + column;
        let (width, height) = map.tile;
        // Signed numbers convert in one instruction.
        let (left, bottom) = (column as i64 as f64 * width, row as i64 as f64 * height);
        let (right, top) = (left + width, bottom + height);
        let tile = Rect { left, right, bottom, top, active: true, ..Rect::default() };
        // The faces turned to the body; a covered one never gives the side.
        let mut corner = None;
        let contact = meet(rect, &tile, rect.back, with.meeting, |overlap| {
            // There are no obstacles outside the map.
            let beside = match overlap.x_side {
                Side::Right => column > 0 && tiles.blocks(at - 1),
                _ => column + 1 < map.columns && tiles.blocks(at + 1),
            };
            let over = match overlap.y_side {
                Side::Above => row > 0 && tiles.blocks(at - map.columns),
                _ => tiles.blocks(at + map.columns),
            };
            let mut covered = (beside, over);
            if covered != (true, true) && self.is_beside_rect(rect.space as usize, at) {
                let kind = &self.collision.kinds[body.kind];
                covered = self.covered((kind, rect.space as usize), (rect, &tile), overlap, covered, tiles.meter);
            }
            if covered == (true, true) && overlap.came_diagonally(rect.back) {
                corner = Some([overlap.horizontal(), overlap.vertical()]);
            }
            covered
        });
        let Some(contact) = contact else { return };
        self.static_contact(state, body, with, contact, displacement);
        self.corner_contact(body, with, corner, displacement);
    }
}

/// The half-open range of tiles of the map whose closed extent overlaps `low..=high`.
fn range(low: f64, high: f64, size: f64, count: usize) -> (usize, usize) {
    let (low, high) = (low / size, high / size);
    // The cast truncates, which is the floor of a non-negative number, and saturates.
    let whole = low as i64;
    let first = match low {
        ..=1.0 => 0,
        _ if whole as f64 == low => whole - 1,
        _ => whole,
    };
    let after = if high < 0.0 { 0 } else { (high as i64).min(count as i64 - 1) + 1 };
    (first as usize, after as usize)
}

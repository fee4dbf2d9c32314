//! Contacts between bodies and slopes. They are found after all others, with the body where pushes along x take it: so a
//! body that a wall stops beside a slope rests where the slope is then.

use std::cell::Cell;

use crate::ir::{Bounds, Extremes, Id, Push, Side, SpaceId};
use crate::watch::Meter;

use super::collision::{Body, Kind, Scratch};
use super::contact::{Contact, Displacement, Overlap, Rect, TOLERANCE};
use super::encounter::Encounter;
use super::seam::Around;
use super::simulator::Simulator;
use super::slope::{Line, Slopes};
use super::tiles::{Tile, Tiles};

/// A collider at the end of a step's motion.
#[derive(Clone, Copy)]
pub(super) struct Mover<'a> {
    pub body: &'a Body,
    pub kind: &'a Kind,
    /// Its box, moved by the pushes along x.
    pub rect: Rect,
    /// Those pushes, px.
    pushed: f64,
    /// Its box as the flows began.
    pub start: Rect,
    pub tiles: Tiles<'a>,
    pub around: &'a Around,
}

impl Simulator {
    /// Handles the slopes near all bodies, which everything else has pushed; without `push`, only contacts count.
    #[cold]
    #[inline(never)]
    pub(super) fn collide_slopes(
        &self,
        slopes: &Slopes,
        state: &mut [u8],
        scratch: &mut Scratch,
        push: bool,
        meter: &Meter<'_>,
    ) {
        let Scratch { boxes, displacements, lengths, .. } = scratch;
        let lengths = Cell::from_mut(lengths.as_mut_slice()).as_slice_of_cells();
        // Instances that never move meet no slope.
        let bodies = &self.collision.bodies[..self.collision.moving];
        let mut from = 0;
        while let Some(first) = bodies.get(from) {
            let after = from + bodies[from..].iter().take_while(|body| body.slot == first.slot).count();
            let slot = first.slot.index();
            let pushed = displacements[slot].push[0];
            let space = self.layout(first.slot).space(state).index();
            let table = &self.world().spaces[SpaceId(space as u32)];
            if let Some(map) = table.map.as_ref().filter(|_| !slopes.of_space(space).is_empty()) {
                let around = Around::new(table, map);
                let mover = |at: usize| {
                    let (body, rect) = (&bodies[at], &boxes[at]);
                    let kind = &self.collision.kinds[body.kind];
                    let is_near = rect.active && kind.meets_tiles[space];
                    is_near.then(|| {
                        let start = rect.moved(rect.back.into());
                        let rect = rect.moved([pushed, 0.0]);
                        let rect = Rect { back: (start.left - rect.left, start.bottom - rect.bottom), ..rect };
                        let tiles = self.tiles(body, map, space, (lengths, meter), &around);
                        Mover { body, kind, rect, pushed, start, tiles, around: &around }
                    })
                };
                for mover in (from..after).filter_map(mover) {
                    self.meet_slopes(state, mover, &mut displacements[slot]);
                }
                if push && displacements[slot].push[1] == 0.0 {
                    self.keep(state, || (from..after).filter_map(mover), &mut displacements[slot]);
                }
            }
            from = after;
        }
    }

    /// Handles the slopes near a body.
    fn meet_slopes(&self, state: &mut [u8], mover: Mover<'_>, displacement: &mut Displacement) {
        let Mover { body, tiles, around, rect, .. } = mover;
        if tiles.meter.spend(tiles.count_near(around, &rect)) {
            return;
        }
        for (column, row) in tiles.near(around, &rect) {
            let Some(at) = around.cell(tiles.map, column, row) else { continue };
            let tile = Tile { column, row, at };
            let Some((with, line)) = tiles.slope_at(state, tile) else { continue };
            let Some(contact) = self.slope_contact(state, mover, (tile, line), with) else { continue };
            self.static_contact(state, body, with, contact, displacement);
            self.touch_tile_along(state, body, (with, &tiles), (&rect, &line.part(&rect)), tile, contact.side);
        }
    }

    /// The contact of a body with a slope. Depths along x are those from where nothing has pushed it.
    fn slope_contact(
        &self,
        state: &[u8],
        mover: Mover<'_>,
        (tile, line): (Tile, Line),
        with: &Encounter,
    ) -> Option<Contact> {
        let Mover { rect, start, pushed, tiles, around, .. } = mover;
        let (meeting, bounds) = (with.meeting, line.tile);
        let overlap = Overlap::of(&rect, &line.part(&rect), rect.back)?;
        let lies_beside = rect.right == bounds.left || rect.left == bounds.right;
        let face = if overlap.x_side == Side::Right { line.slope.left } else { line.slope.right };
        if lies_beside && face == 0.0 {
            return None;
        }
        let joined = |to_left| tiles.joined(state, around, (tile, line), to_left);
        let is_above = !lies_beside && line.is_below(&start, joined);
        let on_top = Contact { side: Side::Below, depth: line.top(&rect) - rect.bottom };
        let across = |contact: Contact| match contact.side {
            Side::Right => Contact { depth: contact.depth - pushed, ..contact },
            Side::Left => Contact { depth: contact.depth + pushed, ..contact },
            Side::Above | Side::Below => contact,
        };
        let was_under = start.top <= bounds.bottom + TOLERANCE;
        match meeting.response.push {
            Push::FromAbove if meeting.first_on_second && is_above => return Some(on_top),
            Push::FromAbove => {
                let depth = rect.top - bounds.bottom;
                return (meeting.second_on_first && was_under).then_some(Contact { side: Side::Above, depth });
            }
            Push::Sense if rect.round && !line.meets_disc(&rect) => return None,
            Push::Block if is_above => {
                let is_free = on_top.depth <= 0.0 || !self.is_under_ceiling(state, mover, on_top.depth);
                return Some(if is_free { on_top } else { self.stopped(mover, bounds).unwrap_or(on_top) });
            }
            Push::Sense if is_above => return Some(on_top),
            Push::Block | Push::Sense => {}
        }
        let was_beside = match overlap.x_side {
            Side::Right => start.right <= bounds.left + TOLERANCE,
            _ => start.left >= bounds.right - TOLERANCE,
        };
        let is_side_covered = face > 0.0 && self.is_slope_covered(state, mover, (tile, line), overlap.x_side);
        let comes_from_under = overlap.y_side == Side::Above && was_under;
        if was_beside && !is_side_covered && !comes_from_under {
            return Some(across(overlap.horizontal()));
        }
        let is_bottom_covered =
            overlap.y_side == Side::Above && tiles.is_wall(state, around, (tile.column, tile.row - 1));
        Some(across(match (is_side_covered, is_bottom_covered) {
            (true, false) => overlap.vertical(),
            (false, true) => overlap.horizontal(),
            _ => overlap.least(),
        }))
    }

    /// Whether neighbours cover the left or right face of a slope which a side of a body touches.
    fn is_slope_covered(&self, state: &[u8], mover: Mover<'_>, (tile, line): (Tile, Line), side: Side) -> bool {
        let Mover { kind, rect, tiles, around, .. } = mover;
        let (to_left, height) = match side {
            Side::Right => (true, line.slope.left),
            _ => (false, line.slope.right),
        };
        let beside = (if to_left { tile.column - 1 } else { tile.column + 1 }, tile.row);
        if tiles.height_beside(state, around, beside, to_left).is_some_and(|beside| beside >= height - TOLERANCE) {
            return true;
        }
        let space = rect.space as usize;
        let at = if to_left { line.tile.left } else { line.tile.right };
        let along = (rect.bottom.greatest(line.tile.bottom), rect.top.least(line.tile.bottom + height));
        self.is_beside_rect(space, tile.at)
            && self.is_side_covered(state, (kind, space), (at, !to_left), along, tiles.meter)
    }

    /// Whether a body that a slope lifts by a way would go into what blocks it from above.
    fn is_under_ceiling(
        &self,
        state: &[u8],
        Mover { kind, rect, start, tiles, around, .. }: Mover<'_>,
        way: f64,
    ) -> bool {
        let lifted = rect.moved([0.0, way]);
        let is_hit = |b: Bounds| {
            start.top <= b.bottom + TOLERANCE
                && lifted.top > b.bottom + TOLERANCE
                && lifted.right - b.left > TOLERANCE
                && b.right - lifted.left > TOLERANCE
        };
        let space = rect.space as usize;
        let blocks = |with: &Option<Encounter>| with.is_some_and(|w| w.meeting.response.push == Push::Block);
        let mut rects = self.collision.solids[space].iter().zip(&kind.solids[space]);
        rects.any(|(solid, with)| blocks(with) && is_hit(solid.bounds))
            || tiles.near(around, &lifted).any(|(column, row)| {
                let at = around.cell(tiles.map, column, row);
                at.is_some_and(|at| tiles.blocks(state, at) && is_hit(tiles.bounds(column, row)))
            })
    }

    /// The contact of a body that a slope cannot lift: it goes back along x, at most to beside the tile.
    fn stopped(&self, Mover { rect, start, pushed, .. }: Mover<'_>, bounds: Bounds) -> Option<Contact> {
        let (left, right) = (rect.left - pushed, rect.right - pushed);
        let way = left - start.left;
        match () {
            () if way > 0.0 => Some(Contact { side: Side::Right, depth: way.least(right - bounds.left) }),
            () if way < 0.0 => Some(Contact { side: Side::Left, depth: (-way).least(bounds.right - left) }),
            () => None,
        }
    }
}

//! What walks down a slope is kept on it, and on the ground at its end: else it would fall for a few steps, again and
//! again.

use crate::ir::{Bounds, Extremes, Push, Side};

use super::contact::{Contact, Displacement, Rect, TOLERANCE};
use super::encounter::Encounter;
use super::simulator::Simulator;
use super::slope_contact::Mover;
use super::tiles::Tile;

/// A tile, by its column and row, or a rectangle, by its number.
#[derive(Clone, Copy)]
enum Spot {
    Tile(i64, i64),
    Rect(usize),
}

/// What is below a body.
#[derive(Clone, Copy)]
struct Ground<'a> {
    with: &'a Encounter,
    tile: Option<Tile>,
    /// The part of it that the body meets.
    part: Rect,
    /// How far the body is above it, px.
    gap: f64,
    /// How steep it is, px per px.
    steep: f64,
    is_slope: bool,
}

impl Simulator {
    /// Keeps an instance, given by its colliders, on the ground. It stood there as the flows began, has not risen since,
    /// and nothing pushes it up or down. It is moved down to what is below it, if that is no deeper than the steeper of
    /// the two goes down over its way along x.
    pub(super) fn keep<'m, I: Iterator<Item = Mover<'m>>>(
        &self,
        state: &mut [u8],
        movers: impl Fn() -> I,
        displacement: &mut Displacement,
    ) {
        let falling = || movers().filter(|m| !m.body.kinematic && m.rect.bottom <= m.start.bottom);
        let (mut stood, mut stood_on_slope) = (None, false);
        let mut nearest: Option<(Ground<'_>, f64)> = None;
        for mover in falling() {
            // Its box is looked at three times.
            if mover.tiles.meter.spend(3 * mover.tiles.count_near(mover.around, &mover.rect)) {
                return;
            }
            for spot in self.spots(&mover, &mover.start) {
                let Some(ground) = self.ground(state, &mover, &mover.start, spot) else { continue };
                if ground.gap.abs() <= TOLERANCE {
                    stood = Some(ground.steep.greatest(stood.unwrap_or(0.0)));
                    stood_on_slope |= ground.is_slope;
                }
            }
            for spot in self.spots(&mover, &mover.rect) {
                let Some(ground) = self.ground(state, &mover, &mover.rect, spot) else { continue };
                if ground.gap >= 0.0 && nearest.is_none_or(|(known, _)| ground.gap < known.gap) {
                    nearest = Some((ground, (mover.rect.left - mover.start.left).abs()));
                }
            }
        }
        let Some((stood, (ground, way))) = stood.zip(nearest) else { return };
        let gap = ground.gap;
        if gap == 0.0 || !(stood_on_slope || ground.is_slope) || gap > way * stood.greatest(ground.steep) + TOLERANCE {
            return;
        }
        for mover in falling() {
            for spot in self.spots(&mover, &mover.rect) {
                let Some(ground) = self.ground(state, &mover, &mover.rect, spot) else { continue };
                if ground.gap != gap {
                    continue;
                }
                let contact = Contact { side: Side::Below, depth: 0.0 };
                self.static_contact(state, mover.body, ground.with, contact, displacement);
                if let Some(tile) = ground.tile {
                    let boxes = (&mover.rect, &ground.part);
                    self.touch_tile_along(state, mover.body, (ground.with, &mover.tiles), boxes, tile, contact.side);
                }
            }
        }
        displacement.push[1] = -gap;
        displacement.stops.below = displacement.stops.below.max(ground.with.stop);
    }

    /// The places at which a box of a body can have something below it, by at most the height of a tile.
    fn spots<'a>(&self, mover: &Mover<'a>, rect: &Rect) -> impl Iterator<Item = Spot> + use<'a> {
        let reach = Rect { bottom: rect.bottom - mover.tiles.map.tile.1, ..*rect };
        let rects = mover.kind.solids[rect.space as usize].len();
        let tiles = mover.tiles.near(mover.around, &reach).map(|(column, row)| Spot::Tile(column, row));
        tiles.chain((0..rects).map(Spot::Rect))
    }

    /// What a box of a body can stand on at a place: what blocks it, and neither bounces nor lets it keep its velocity.
    fn ground<'a>(&self, state: &[u8], mover: &Mover<'a>, rect: &Rect, spot: Spot) -> Option<Ground<'a>> {
        let holds = |with: &&Encounter| {
            let can_hold = match with.meeting.response.push {
                Push::Sense => false,
                Push::FromAbove => with.meeting.first_on_second,
                Push::Block => true,
            };
            can_hold && with.stop == 1
        };
        let space = rect.space as usize;
        let mut ground = match spot {
            Spot::Rect(index) => {
                let with = mover.kind.solids[space][index].as_ref().filter(holds)?;
                let Bounds { left, right, bottom, top } = self.collision.solids[space][index].bounds;
                let part = Rect { left, right, bottom, top, ..Rect::default() };
                Ground { with, tile: None, part, gap: 0.0, steep: 0.0, is_slope: false }
            }
            Spot::Tile(column, row) => {
                let tiles = mover.tiles;
                let at = mover.around.cell(tiles.map, column, row)?;
                let with = tiles.encounter(state, at).filter(holds)?;
                let tile = Tile { column, row, at };
                let line = tiles.line(tile);
                let Bounds { left, right, bottom, top } = tiles.bounds(column, row);
                let top = line.map_or(top, |line| line.top(rect));
                let part = Rect { left, right, bottom, top, ..Rect::default() };
                let steep = line.map_or(0.0, |line| line.gradient().abs());
                Ground { with, tile: Some(tile), part, gap: 0.0, steep, is_slope: line.is_some() }
            }
        };
        let is_over = rect.right - ground.part.left > TOLERANCE && ground.part.right - rect.left > TOLERANCE;
        ground.gap = rect.bottom - ground.part.top;
        (is_over && ground.gap <= mover.tiles.map.tile.1).then_some(ground)
    }
}

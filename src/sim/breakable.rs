//! Tiles that can be broken: a bit of the state for each, and for one that comes back the steps until it does. A world
//! without them has no tables.

use std::cell::Cell;
use std::collections::BTreeSet;

use crate::ir::{BreakableTiles, Expr, Id, Side, SpaceId, TagId, TagSet, TileId, TileLayout, TouchId, World};

use super::actor::Actor;
use super::simulator::Simulator;

/// No tile.
const NONE: u32 = u32::MAX;

/// The breakable tiles of a world.
#[derive(Debug)]
pub(super) struct Breakables {
    pub tiles: BreakableTiles,
    layout: TileLayout,
    /// For each space, the tile of each cell; empty if none can be broken there.
    numbers: Vec<Vec<u32>>,
}

impl Breakables {
    /// Those of a world; `None` if there are none.
    pub fn new(world: &World) -> Option<Box<Breakables>> {
        let layout = world.layout.tiles.clone()?;
        let tiles = BreakableTiles::of(&world.spaces);
        let mut numbers: Vec<Vec<u32>> = world.spaces.iter().map(|_| Vec::new()).collect();
        for (tile, (space, cell)) in tiles.places.pairs() {
            let of = &mut numbers[space.index()];
            if of.is_empty() {
                of.resize(world.spaces[*space].map.as_ref().map_or(0, |map| map.cells.len()), NONE);
            }
            of[*cell as usize] = tile.0;
        }
        Some(Box::new(Breakables { tiles, layout, numbers }))
    }

    /// The tile of a cell.
    #[inline]
    pub fn tile(&self, space: usize, cell: usize) -> Option<TileId> {
        self.numbers[space].get(cell).filter(|number| **number != NONE).map(|number| TileId(*number))
    }

    /// Whether there is a breakable tile in a cell that is broken. Not inlined: it would enlarge every contact with a tile.
    #[inline(never)]
    pub fn is_gone(&self, state: &[u8], space: usize, cell: usize) -> bool {
        self.tile(space, cell).is_some_and(|tile| self.is_broken(state, tile))
    }

    /// Whether a tile is broken.
    #[inline]
    pub fn is_broken(&self, state: &[u8], tile: TileId) -> bool {
        state[self.layout.broken + tile.index() / 8] >> (tile.index() % 8) & 1 == 1
    }

    /// Breaks a tile, unless it is broken.
    pub fn break_tile(&self, state: &mut [u8], tile: TileId) {
        if self.is_broken(state, tile) {
            return;
        }
        state[self.layout.broken + tile.index() / 8] |= 1 << (tile.index() % 8);
        if tile.index() < self.layout.restored {
            let after = self.tiles.kinds.partition_point(|kind| kind.tiles.1 <= tile);
            let steps = self.tiles.kinds.get(after).and_then(|kind| kind.restore).unwrap_or(1);
            self.set_steps(state, tile, steps);
        }
    }

    /// The steps until a tile is back, 0 if it is there or never comes back.
    pub fn steps(&self, state: &[u8], tile: TileId) -> u16 {
        if tile.index() >= self.layout.restored {
            return 0;
        }
        let at = self.layout.restoring + 2 * tile.index();
        u16::from_le_bytes([state[at], state[at + 1]])
    }

    fn set_steps(&self, state: &mut [u8], tile: TileId, steps: u16) {
        let at = self.layout.restoring + 2 * tile.index();
        state[at..at + 2].copy_from_slice(&steps.to_le_bytes());
    }

    /// The 64 bits from a tile on.
    #[inline]
    fn word(&self, state: &[u8], index: usize) -> u64 {
        let at = self.layout.broken + 8 * index;
        state[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }

    /// Ends a step: broken tiles that come back are a step closer to it.
    pub fn restore(&self, state: &mut [u8]) {
        for index in 0..self.layout.restored.div_ceil(64) {
            let mut word = self.word(state, index);
            while word != 0 {
                let tile = TileId::from_index(64 * index + word.trailing_zeros() as usize);
                word &= word - 1;
                if tile.index() >= self.layout.restored {
                    return;
                }
                let steps = self.steps(state, tile).saturating_sub(1);
                self.set_steps(state, tile, steps);
                if steps == 0 {
                    state[self.layout.broken + tile.index() / 8] &= !(1 << (tile.index() % 8));
                }
            }
        }
    }

    /// Calls `on_change` for each tile whose bit differs between two states, with whether it is broken in the second.
    pub fn changes(&self, before: &[u8], after: &[u8], on_change: &mut dyn FnMut(TileId, bool)) {
        for index in 0..self.layout.count.div_ceil(64) {
            let now = self.word(after, index);
            let mut changed = self.word(before, index) ^ now;
            while changed != 0 {
                let bit = changed.trailing_zeros();
                changed &= changed - 1;
                on_change(TileId::from_index(64 * index + bit as usize), now >> bit & 1 == 1);
            }
        }
    }

    /// The number of broken tiles from one to before another.
    pub fn count_broken(&self, state: &[u8], (from, to): (TileId, TileId)) -> usize {
        let (from, to) = (from.index(), to.index());
        let mut count = 0;
        for index in from / 64..to.div_ceil(64) {
            let mut word = self.word(state, index);
            if index == from / 64 {
                word &= u64::MAX << (from % 64);
            }
            if to - 64 * index < 64 {
                word &= !(u64::MAX << (to - 64 * index));
            }
            count += word.count_ones() as usize;
        }
        count
    }

    /// Checks the bits and counts of a state from outside.
    pub fn check(&self, state: &[u8]) -> Result<(), &'static str> {
        let TileLayout { count, restoring, restored, .. } = self.layout;
        let is_clear = |bytes: &[u8]| bytes.iter().all(|byte| *byte == 0);
        let last = self.word(state, count / 64);
        if count % 64 != 0 && last >> (count % 64) != 0 {
            return Err("a tile is broken that is none");
        }
        if !is_clear(&state[restoring + 2 * restored..restoring + (2 * restored).next_multiple_of(8)]) {
            return Err("a tile comes back that is none");
        }
        for kind in &self.tiles.kinds {
            let Some(most) = kind.restore else { continue };
            for tile in (kind.tiles.0.index()..kind.tiles.1.index()).map(TileId::from_index) {
                let fits = match self.is_broken(state, tile) {
                    true => (1..=most).contains(&self.steps(state, tile)),
                    false => self.steps(state, tile) == 0,
                };
                if !fits {
                    return Err("a tile comes back at the wrong time");
                }
            }
        }
        Ok(())
    }
}

/// For each tag, the number of tiles of a world that have it; empty if no instance asks.
pub(super) fn tile_counts(world: &World, actors: &[Actor]) -> Box<[u32]> {
    let asked = actors.iter().flat_map(|actor| &actor.code.exprs).filter_map(|expr| match *expr {
        Expr::Tiles(tag) => Some(tag),
        _ => None,
    });
    // Many instances ask for the same tag.
    let asked: BTreeSet<TagId> = asked.collect();
    let mut counts = vec![0; asked.last().map_or(0, |last| last.index() + 1)];
    for tag in asked {
        counts[tag.index()] = world.tiles_with(tag) as u32;
    }
    counts.into()
}

/// The better of two tiles: with the greater measure, of equal ones the lower, of these the left one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Best {
    pub tile: TileId,
    pub cell: usize,
    pub measure: f64,
}

impl Best {
    pub fn is_better_than(&self, other: &Best) -> bool {
        self.measure > other.measure || (self.measure == other.measure && self.cell < other.cell)
    }
}

impl Simulator {
    /// Keeps a tile that a body touches along an edge, for the contact queries that can name it.
    pub(super) fn touch_tile(
        &self,
        state: &mut [u8],
        (actor, mine): (&Actor, TagSet),
        (tile, tags): (TileId, TagSet),
        (side, length): (Side, f64),
        lengths: &[Cell<f64>],
    ) {
        let Some(breakables) = &self.breakables else { return };
        let cell = |tile: TileId| breakables.tiles.places[tile].1 as usize;
        let layout = &actor.layout;
        for (id, touch) in actor.entity.touches.pairs().take(actor.bound) {
            let on_side = touch.side.is_none_or(|wanted| wanted == side);
            let asks = touch.tiles && on_side && touch.mine.meets(mine) && tags.meets(TagSet::of(touch.other));
            let Some(longest) = lengths.get(actor.kept.start + id.index()).filter(|_| asks) else { continue };
            let found = Best { tile, cell: cell(tile), measure: length };
            let known = layout.touched_tile(state, id);
            let known = known.map(|tile| Best { tile, cell: cell(tile), measure: longest.get() });
            if known.is_none_or(|known| found.is_better_than(&known)) {
                layout.set_touched_tile(state, id, Some(tile));
                longest.set(length);
            }
            layout.set_touch(state, id);
        }
    }

    /// The tile that a contact query keeps, if it keeps no instance.
    pub(super) fn tile_touched(&self, state: &[u8], actor: &Actor, id: TouchId) -> Option<TileId> {
        match actor.layout.touched(state, id) {
            Some(_) => None,
            None => actor.layout.touched_tile(state, id),
        }
    }

    /// The number of broken tiles with a tag.
    #[cold]
    pub(super) fn broken_with(&self, state: &[u8], tag: TagId) -> usize {
        let Some(breakables) = &self.breakables else { return 0 };
        let tagged = breakables.tiles.kinds.iter().filter(|kind| kind.tags.meets(TagSet::of(tag)));
        tagged.map(|kind| breakables.count_broken(state, kind.tiles)).sum()
    }

    /// The number of tiles with a tag, broken or not.
    pub(super) fn tiles_with(&self, tag: TagId) -> u32 {
        self.tile_counts.get(tag.index()).copied().unwrap_or(0)
    }

    /// Whether the tile of a cell of the map of a space is broken.
    pub(super) fn is_gone(&self, state: &[u8], space: usize, cell: usize) -> bool {
        self.breakables.as_ref().is_some_and(|breakables| breakables.is_gone(state, space, cell))
    }

    /// Whether a tile is broken in a state.
    pub fn is_broken(&self, state: &[u8], tile: TileId) -> bool {
        self.breakables.as_ref().is_some_and(|breakables| breakables.is_broken(state, tile))
    }

    /// The steps until a tile is back, 0 if it is there or never comes back.
    pub fn steps_until_restored(&self, state: &[u8], tile: TileId) -> u16 {
        self.breakables.as_ref().map_or(0, |breakables| breakables.steps(state, tile))
    }

    /// The tiles that are broken in a state, in order.
    pub fn broken_tiles(&self, state: &[u8]) -> Vec<TileId> {
        let mut out = Vec::new();
        if let Some(breakables) = &self.breakables {
            let whole = vec![0; state.len()];
            breakables.changes(&whole, state, &mut |tile, _| out.push(tile));
        }
        out
    }

    /// The space of a breakable tile, with its column and row.
    pub fn place_of_tile(&self, tile: TileId) -> Option<(SpaceId, usize, usize)> {
        let (space, cell) = *self.breakables.as_ref()?.tiles.places.get(tile)?;
        let columns = self.world().spaces[space].map.as_ref()?.columns.max(1);
        Some((space, cell as usize % columns, cell as usize / columns))
    }
}

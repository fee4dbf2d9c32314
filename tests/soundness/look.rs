//! What is in the place that a probe asks about, by the definition: of the flat program, tile by tile, slot by slot.

use hypedc::ir::{BreakableTiles, ColliderId, ExprId, Id, Shape, SlotId, SpaceId, TagId, TagSet, VarId};

use super::eye::Eye;
use crate::oracle::collide::Area;
use crate::oracle::slope::Ends;

/// How deep an overlap has to be, px.
const DEEP: f64 = 0.001;

/// A shape in a space: a box, and for a disc its centre and radius.
struct There {
    sides: [f64; 4],
    disc: Option<[f64; 3]>,
}

/// What a place holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    Free,
    Static,
    /// A tile that can be broken, where a name can stand for it.
    Tile,
    Instance(SlotId),
}

impl Eye<'_> {
    /// What a probe finds; none if reading it stops the run.
    pub fn look(
        &self,
        (mine, other): (TagId, TagId),
        offset: [ExprId; 2],
        (bound, names_tiles): (bool, bool),
    ) -> Option<Place> {
        let by = [self.number(offset[0])?, self.number(offset[1])?];
        let space = self.world.layout.slots[self.me].space(self.state);
        let mut found = Place::Free;
        let mut has_tile = false;
        let broken = self.broken(space);
        let own = self.entity(self.me).colliders.pairs().filter(|(_, c)| c.tags.meets(TagSet::of(mine)));
        for (id, _) in own {
            let Some(me) = self.there(self.me, id, by)? else { continue };
            let there = &self.world.spaces[space];
            let (broken, me) = (&broken, &me);
            let tiles = there.map.iter().flat_map(|map| {
                map.cells.iter().enumerate().filter(|(at, _)| !broken.contains(at)).filter_map(move |(at, kind)| {
                    let (column, row) = ((at % map.columns) as f64, (at / map.columns) as f64);
                    let (w, h) = map.tile;
                    let has = map.kinds[usize::from(*kind)].tags.contains(&other);
                    let is_breakable = map.kinds[usize::from(*kind)].breakable.is_some();
                    let mut sides = [column * w, column * w + w, row * h, row * h + h];
                    if let Some(slope) = map.kinds[usize::from(*kind)].slope {
                        let ends = Ends { left: slope.left, right: slope.right };
                        let tile = Area { left: sides[0], right: sides[1], bottom: sides[2], top: sides[3] };
                        let sinks = |[x, y, r]: [f64; 3]| r - ends.distance(tile, (x, y)).sqrt() > DEEP;
                        if !me.disc.is_none_or(sinks) {
                            return None;
                        }
                        sides[3] = ends.top(tile, (me.sides[0], me.sides[1]));
                    }
                    has.then_some((sides, is_breakable))
                })
            });
            let rects = there.solids.iter().filter(|s| s.tags.meets(TagSet::of(other)));
            let rects = rects.map(|s| ([s.bounds.left, s.bounds.right, s.bounds.bottom, s.bounds.top], false));
            let mut statics = tiles.chain(rects).filter(|(sides, _)| sinks(me, &There { sides: *sides, disc: None }));
            if !bound && statics.next().is_some() {
                return Some(Place::Static);
            }
            has_tile |= names_tiles && statics.any(|(_, is_breakable)| is_breakable);
            for slot in self.world.slots.ids().filter(|slot| *slot != self.me) {
                let layout = &self.world.layout.slots[slot];
                let is_before = !matches!(found, Place::Instance(first) if first <= slot);
                if !is_before || !layout.alive(self.state) || layout.space(self.state) != space {
                    continue;
                }
                for (id, _) in self.entity(slot).colliders.pairs().filter(|(_, c)| c.tags.meets(TagSet::of(other))) {
                    if self.there(slot, id, [0.0; 2])?.is_some_and(|there| sinks(me, &there)) {
                        found = Place::Instance(slot);
                    }
                }
            }
            if !bound && found != Place::Free {
                return Some(found);
            }
        }
        Some(if found == Place::Free && has_tile { Place::Tile } else { found })
    }

    /// The cells of the broken tiles of a space.
    pub fn broken(&self, space: SpaceId) -> Vec<usize> {
        let Some(layout) = &self.world.layout.tiles else { return Vec::new() };
        let is_broken = |tile: usize| self.state[layout.broken + tile / 8] >> (tile % 8) & 1 == 1;
        let all = BreakableTiles::of(&self.world.spaces).places;
        let broken = all.pairs().filter(|(tile, (of, _))| *of == space && is_broken(tile.index()));
        broken.map(|(_, (_, cell))| *cell as usize).collect()
    }

    /// The shape of a collider, moved; none if it is not there.
    fn there(&self, slot: SlotId, id: ColliderId, by: [f64; 2]) -> Option<Option<There>> {
        let eye = Eye { me: slot, notes: &super::eye::Nobody, ..*self };
        let collider = &eye.entity(slot).colliders[id];
        if let Some(guard) = collider.guard
            && !eye.truth(guard)?
        {
            return Some(None);
        }
        let at = |axis: u32| self.world.layout.slots[slot].var(self.state, VarId(axis), 0) + 0.0;
        let ([left, bottom, width, height], is_disc) = match collider.shape {
            Shape::Rect([x, y, w, h]) => ([eye.number(x)?, eye.number(y)?, eye.number(w)?, eye.number(h)?], false),
            Shape::Circle([x, y, r]) => {
                let (x, y, r) = (eye.number(x)?, eye.number(y)?, eye.number(r)?);
                ([x - r, y - r, 2.0 * r, 2.0 * r], true)
            }
        };
        let (left, bottom) = (at(0) + left, at(1) + bottom);
        let sides = [left + by[0], left + width + by[0], bottom + by[1], bottom + height + by[1]];
        let middle = [(sides[0] + sides[1]) / 2.0, (sides[2] + sides[3]) / 2.0, (sides[1] - sides[0]) / 2.0];
        Some((width > 0.0 && height > 0.0).then(|| There { sides, disc: is_disc.then_some(middle) }))
    }
}

/// Whether two shapes overlap by more than faces that merely touch.
fn sinks(a: &There, b: &There) -> bool {
    let ways = [a.sides[1] - b.sides[0], b.sides[1] - a.sides[0], a.sides[3] - b.sides[2], b.sides[3] - a.sides[2]];
    if ways.iter().any(|way| *way <= DEEP) {
        return false;
    }
    let to_box = |[x, y, r]: [f64; 3], b: &There| {
        let (dx, dy) = (x - x.clamp(b.sides[0], b.sides[1]), y - y.clamp(b.sides[2], b.sides[3]));
        r - (dx * dx + dy * dy).sqrt()
    };
    match (a.disc, b.disc) {
        (None, None) => true,
        (Some(disc), None) => to_box(disc, b) > DEEP,
        (None, Some(disc)) => to_box(disc, a) > DEEP,
        (Some([x, y, r]), Some([ox, oy, or])) => r + or - ((x - ox) * (x - ox) + (y - oy) * (y - oy)).sqrt() > DEEP,
    }
}

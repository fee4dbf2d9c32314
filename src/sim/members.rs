//! Questions to the instances of an entity: of how many something holds, and which of them is nearest. Answered where a
//! guard asks, on the state that it reads; a program without such questions has no tables for them.

use crate::ir::{EntityId, Expr, ExprId, Id, SlotId, World};

use super::actor::Actor;
use super::evaluate::Reader;
use super::simulator::Simulator;

/// For each entity that is asked for, its slots.
#[derive(Debug)]
pub(super) struct Members {
    of: Vec<Box<[SlotId]>>,
}

impl Members {
    /// The tables of a world; `None` if no instance asks.
    pub fn new(world: &World, actors: &[Actor]) -> Option<Box<Members>> {
        let mut of: Vec<Box<[SlotId]>> = Vec::new();
        for expr in actors.iter().flat_map(|actor| &actor.code.exprs) {
            let (Expr::Count { of: entity, .. } | Expr::Nearest { of: entity, .. }) = *expr else { continue };
            if of.len() <= entity.index() {
                of.resize_with(entity.index() + 1, Box::default);
            }
            if of[entity.index()].is_empty() {
                of[entity.index()] =
                    world.slots.pairs().filter(|(_, s)| s.entity == entity).map(|(id, _)| id).collect();
            }
        }
        (!of.is_empty()).then(|| Box::new(Members { of }))
    }

    fn slots(&self, of: EntityId) -> &[SlotId] {
        self.of.get(of.index()).map_or(&[], |slots| slots)
    }

    /// The number of instances that a question asks.
    pub fn cost(&self, expr: &Expr) -> u64 {
        let (Expr::Count { of, .. } | Expr::Nearest { of, .. }) = *expr else { return 0 };
        self.slots(of).len() as u64
    }
}

impl Simulator {
    /// The living instances of an entity for which a condition holds.
    fn members<'a>(&'a self, reader: &'a Reader<'a>, of: EntityId, holds: ExprId) -> impl Iterator<Item = SlotId> + 'a {
        let slots = self.members.as_ref().map_or(&[][..], |members| members.slots(of));
        let living = slots.iter().copied().filter(|slot| self.layout(*slot).acts(reader.state));
        living.filter(move |slot| Reader { member: *slot, ..*reader }.truth(holds))
    }

    /// The number of living instances of an entity for which a condition holds.
    // Not inlined: it is rare, and would enlarge every guard.
    #[inline(never)]
    pub(super) fn count_members(&self, reader: &Reader<'_>, of: EntityId, holds: ExprId) -> f64 {
        self.members(reader, of, holds).count() as f64
    }

    /// The nearest other living instance of an entity, in the same space, for which a condition holds; of several, the
    /// one with the lowest slot.
    #[inline(never)]
    pub(super) fn nearest_member(&self, reader: &Reader<'_>, of: EntityId, holds: ExprId) -> Option<SlotId> {
        let me = self.position(reader.state, reader.me);
        let space = self.space(reader.state, reader.me);
        let others = self.members(reader, of, holds);
        let others = others.filter(|slot| *slot != reader.me && self.space(reader.state, *slot) == space);
        let mut nearest: Option<(f64, SlotId)> = None;
        for slot in others {
            let way = self.distance(reader.state, slot, me);
            if nearest.is_none_or(|(known, _)| way < known) {
                nearest = Some((way, slot));
            }
        }
        nearest.map(|(_, slot)| slot)
    }

    /// The distance of an instance to a point, by the shorter way if its space wraps, px.
    #[inline]
    pub fn distance(&self, state: &[u8], slot: SlotId, (x, y): (f64, f64)) -> f64 {
        let (px, py) = self.position(state, slot);
        let (mut dx, mut dy) = (px - x, py - y);
        if let Some(seams) = &self.collision.seams {
            [dx, dy] = seams.shortest(self.layout(slot).space(state), [dx, dy]);
        }
        (dx * dx + dy * dy).sqrt()
    }
}

//! Questions to the instances of an entity over sets of states, and distances. Each slot is asked by itself: it counts
//! for certain if it cannot be empty and the condition cannot fail.

use crate::ir::{EntityId, ExprId, Extremes, LeafId, ModeId, SlotId, Subject, VarId};

use crate::analysis::domain::truth::Truth;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::seam;

use super::evaluate::Reader;

impl Reader<'_> {
    /// The possible numbers of living instances of an entity for which a condition holds.
    // Not inlined: expressions are read by recursion, and this is rare.
    #[inline(never)]
    pub(super) fn count_members(&self, of: EntityId, holds: ExprId) -> Interval {
        let mut count = Interval::point(0.0);
        for slot in self.members(of) {
            let Truth { can_hold, can_fail } = self.holds_of(slot, holds);
            count.high += f64::from(u8::from(can_hold));
            count.low += f64::from(u8::from(can_hold && !can_fail));
        }
        count
    }

    /// Whether there is another instance of an entity in the same space for which a condition holds.
    #[inline(never)]
    pub(super) fn has_member(&self, of: EntityId, holds: ExprId) -> Truth {
        let me = self.me.map(|(me, _)| me);
        let mut others = self.members(of).filter(|slot| me != Some(*slot));
        Truth {
            can_hold: others.any(|slot| self.can_meet(slot) && self.holds_of(slot, holds).can_hold),
            can_fail: true,
        }
    }

    fn members(&self, of: EntityId) -> impl Iterator<Item = SlotId> + '_ {
        self.world.slots.pairs().filter(move |(_, slot)| slot.entity == of).map(|(id, _)| id)
    }

    /// Whether a slot has an instance for which a condition holds.
    fn holds_of(&self, slot: SlotId, holds: ExprId) -> Truth {
        let is_me = self.me.is_some_and(|(me, _)| me == slot);
        let (can_live, can_be_absent) = match is_me {
            true => (true, false),
            false => (self.slots[slot].can_live, self.slots[slot].can_be_absent),
        };
        if !can_live {
            return Truth::of(false);
        }
        let Truth { can_hold, can_fail } = Reader { member: Some(slot), ..*self }.truth(holds);
        Truth { can_hold, can_fail: can_fail || can_be_absent }
    }

    /// Whether the instance that is asked is in a mode for certain, as long as it lives.
    pub(super) fn is_surely_in(&self, mode: ModeId) -> bool {
        let Some(slot) = self.member.filter(|_| !self.is_within_step()) else { return false };
        let entity = self.entity(slot);
        let Some(mode) = entity.modes.get(mode) else { return false };
        let of_group = |leaf: &&LeafId| entity.modes[entity.leaves[**leaf].mode].group == mode.group;
        self.slots[slot].leaves.iter().filter(of_group).all(|leaf| mode.leaves.contains(*leaf))
    }

    /// Whether a slot can be in a space of the instance itself.
    fn can_meet(&self, slot: SlotId) -> bool {
        self.me.is_none_or(|(_, at)| at.spaces.iter().any(|space| self.slots[slot].spaces.contains(space)))
    }

    /// The possible distances of a subject to a point, px.
    pub(super) fn distance(&self, of: Subject, x: ExprId, y: ExprId) -> Values {
        let (px, py) = match self.configuration_of(of) {
            Some(c) => (c.vars[VarId::X][0], c.vars[VarId::Y][0]),
            None => (self.position(of, 0), self.position(of, 1)),
        };
        let apart = |axis: usize, a: &Values, b: ExprId| {
            let ways = a.pairs(&self.number(b), Interval::minus);
            seam::shortest(self.world, axis, &ways).map(Interval::square)
        };
        let squares = apart(0, &px, x).pairs(&apart(1, &py, y), Interval::plus);
        squares.map(|i| i.map(|s| s.greatest(0.0).sqrt()))
    }
}

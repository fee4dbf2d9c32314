//! The rule of a contact between a body and something else, prepared once for each pair of sets of tags.

use crate::ir::{Bounce, Entity, Id, Meeting, Push, Response, Side, TagSet, World};

/// The contact rule between a body and something else.
#[derive(Debug, Clone, Copy)]
pub(super) struct Encounter {
    pub meeting: Meeting,
    /// The tags of the other.
    pub tags: TagSet,
    /// The contact bits that a contact sets, for each side of the body: those of the first 64 queries that are not
    /// bound.
    pub bits: [u64; 4],
    /// Whether there are further bits to set.
    pub more: bool,
    /// How it stops velocities, as in [`super::contact::Stops`].
    pub stop: u16,
}

impl Encounter {
    pub fn new(world: &World, bounces: &[Bounce], entity: &Entity, mine: TagSet, tags: TagSet) -> Option<Self> {
        let meeting = world.meeting(mine, tags)?;
        let Response { stop, bounce, .. } = meeting.response;
        let stop = if stop { 1 + bounces.partition_point(|weaker| *weaker < bounce) as u16 } else { 0 };
        let mut bits = [0; 4];
        let mut more = false;
        for (id, touch) in entity.touches.pairs() {
            if !touch.mine.meets(mine) || !tags.meets(TagSet::of(touch.other)) {
                continue;
            }
            if touch.bound || id.index() >= 64 {
                more = true;
                continue;
            }
            for side in Side::ALL {
                if touch.side.is_none_or(|wanted| wanted == side) {
                    bits[side as usize] |= 1 << id.index();
                }
            }
        }
        Some(Encounter { meeting, tags, bits, more, stop })
    }

    /// Whether a contact sets no contact bit of the body.
    pub fn is_unread(&self) -> bool {
        !self.more && self.bits == [0; 4]
    }

    /// Whether a contact has no effect on the body.
    pub fn is_idle(&self) -> bool {
        let response = self.meeting.response;
        response.push == Push::Sense && !response.carry && self.is_unread()
    }
}

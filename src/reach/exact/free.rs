//! Contacts with instances that were left out. A contact query that one of them could satisfy may hold whether anything
//! touches it or not, wherever its collider is there and meets a place where they can be. In a state its bit says that
//! it may hold; a step is taken both with it and without it.

use std::sync::Arc;

use crate::ir::{SlotId, TouchId};
use crate::sim::{Placed, Scratch, Simulator};

use super::occupied::Occupied;

/// Maximum number of contact queries that may hold or not.
pub(super) const MAX_FREE: usize = 8;

/// Where something can be that was left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Where {
    /// Anywhere.
    Anywhere,
    /// In some cells: the index of the tag in [`Occupied`].
    In(usize),
}

/// A contact query that may hold or not.
#[derive(Debug, Clone)]
pub(super) struct FreeTouch {
    pub slot: SlotId,
    pub touch: TouchId,
    /// The colliders of the instance by which it may hold; `None` if it may at any time.
    pub by: Option<Vec<Placed>>,
    pub with: Where,
}

/// All of them.
#[derive(Debug, Clone, Default)]
pub(super) struct FreeTouches {
    pub all: Vec<FreeTouch>,
    pub occupied: Option<Arc<Occupied>>,
}

impl FreeTouches {
    /// Which of them may hold in a state, one bit each.
    #[inline]
    pub fn set_in(&self, sim: &Simulator, state: &[u8]) -> u32 {
        let mut set = 0;
        for (at, free) in self.all.iter().enumerate() {
            set |= u32::from(sim.world().layout.slots[free.slot].touch(state, free.touch)) << at;
        }
        set
    }

    /// Clears those that do not hold.
    #[inline]
    pub fn keep_only(&self, sim: &Simulator, state: &mut [u8], kept: u32) {
        for (at, free) in self.all.iter().enumerate() {
            if kept >> at & 1 == 0 {
                sim.world().layout.slots[free.slot].clear_touch(state, free.touch);
            }
        }
    }

    /// Sets those that may hold after a step.
    #[inline]
    pub fn set_possible(&self, sim: &Simulator, state: &mut [u8], scratch: &Scratch) {
        for free in &self.all {
            let layout = &sim.world().layout.slots[free.slot];
            let may = match &free.by {
                None => layout.alive(state),
                Some(by) => by.iter().any(|collider| match (scratch.placed(*collider), free.with) {
                    (None, _) => false,
                    (Some(_), Where::Anywhere) => true,
                    (Some((space, bounds)), Where::In(tag)) => {
                        self.occupied.as_ref().is_none_or(|occupied| occupied.meets(tag, space, &bounds))
                    }
                }),
            };
            if may {
                layout.set_touch(state, free.touch);
            }
        }
    }
}

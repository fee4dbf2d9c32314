//! Where colliders were when the last step looked for contacts: before blocking contacts moved them.

use crate::ir::{Bounds, ColliderId, Id, SlotId, SpaceId};

use super::simulator::{Scratch, Simulator};

/// A collider of an instance that may move, as a step numbers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Placed {
    /// The instance.
    pub slot: SlotId,
    /// The collider.
    pub collider: ColliderId,
    at: usize,
}

impl Simulator {
    /// The colliders of instances that may move.
    pub fn moving_colliders(&self) -> Vec<Placed> {
        let mut placed: Vec<Placed> = Vec::new();
        for (at, body) in self.collision.bodies[..self.collision.moving].iter().enumerate() {
            // Those of an instance follow each other in the order of their ids.
            let before = placed.last().filter(|last| last.slot == body.slot);
            let collider = ColliderId::from_index(before.map_or(0, |last| last.collider.index() + 1));
            placed.push(Placed { slot: body.slot, collider, at });
        }
        placed
    }
}

impl Scratch {
    /// The box of a collider in the last collision phase, and its space; `None` if it was not there.
    #[inline]
    pub fn placed(&self, collider: Placed) -> Option<(SpaceId, Bounds)> {
        let rect = self.collision.boxes.get(collider.at).filter(|rect| rect.active)?;
        let bounds = Bounds { left: rect.left, right: rect.right, bottom: rect.bottom, top: rect.top };
        Some((SpaceId::from_index(rect.space as usize), bounds))
    }
}

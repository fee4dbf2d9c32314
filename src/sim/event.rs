//! What happened in a step, for those who draw and play sounds. It is read off the states before and after and off the
//! working memory of the step; who does not ask pays nothing.

use crate::ir::{EdgeId, GoalId, NeverId, SlotId, SpaceId, TouchId};

use super::fault::Fault;
use super::simulator::{Scratch, Simulator};

/// Something that happened in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// An instance took an edge of its entity, which may stay in its mode.
    Edge(SlotId, EdgeId),
    /// An instance came to be.
    Spawned(SlotId),
    /// An instance ceased to be.
    Destroyed(SlotId),
    /// An instance went into another space.
    Entered(SlotId, SpaceId),
    /// A contact question of an instance's entity holds, and did not before.
    Touched(SlotId, TouchId),
    /// A contact question of an instance's entity no longer holds.
    Parted(SlotId, TouchId),
    /// A goal holds, and did not before.
    Goal(GoalId),
    /// A `never` holds, and did not before.
    Never(NeverId),
}

impl Simulator {
    /// Tells what happened in the last step that was made with `scratch`, which led from one state to another: edges in the
    /// order in which they were taken, then instances, contacts and predicates by their ids.
    ///
    /// # Errors
    /// A [`Fault`] if a goal or a `never` breaks a rule.
    pub fn events(
        &self,
        before: &[u8],
        after: &[u8],
        scratch: &Scratch,
        listen: &mut dyn FnMut(Event),
    ) -> Result<(), Fault> {
        let world = self.world();
        for &(slot, edge) in scratch.changes.edges() {
            listen(Event::Edge(slot, edge));
        }
        for slot in world.slots.ids() {
            let layout = self.layout(slot);
            match (layout.alive(before), layout.alive(after)) {
                (false, true) => listen(Event::Spawned(slot)),
                (true, false) => listen(Event::Destroyed(slot)),
                (true, true) if layout.space(before) != layout.space(after) => {
                    listen(Event::Entered(slot, layout.space(after)));
                }
                _ => {}
            }
        }
        for slot in world.slots.ids().filter(|slot| self.layout(*slot).alive(after)) {
            for touch in self.entity(slot).touches.ids() {
                // Of an instance that came to be, nothing held before.
                let of = |state| self.layout(slot).alive(state) && self.layout(slot).touch(state, touch);
                match (of(before), of(after)) {
                    (false, true) => listen(Event::Touched(slot, touch)),
                    (true, false) => listen(Event::Parted(slot, touch)),
                    _ => {}
                }
            }
        }
        let begins = |predicate| Ok(self.holds(after, predicate)? && !self.holds(before, predicate)?);
        for (id, goal) in world.goals.pairs() {
            if begins(goal.holds)? {
                listen(Event::Goal(id));
            }
        }
        for (id, never) in world.nevers.pairs() {
            if begins(never.holds)? {
                listen(Event::Never(id));
            }
        }
        Ok(())
    }
}

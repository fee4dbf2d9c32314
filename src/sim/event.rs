//! The events of a step, for drawing and sound. They are derived from the states before and after and from the working
//! memory of the step; unused, they cost nothing.

use crate::ir::{EdgeId, GoalId, NeverId, SlotId, SpaceId, TileId, TouchId};

use super::fault::Fault;
use super::simulator::{Scratch, Simulator};

/// An event of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// An instance took an edge of its entity, possibly without leaving its mode.
    Edge(SlotId, EdgeId),
    /// An instance was spawned.
    Spawned(SlotId),
    /// An instance was destroyed.
    Destroyed(SlotId),
    /// An instance entered another space.
    Entered(SlotId, SpaceId),
    /// A contact query of an instance's entity holds, and did not before.
    Touched(SlotId, TouchId),
    /// A contact query of an instance's entity no longer holds.
    Parted(SlotId, TouchId),
    /// A tile was broken.
    Broken(TileId),
    /// A tile is back.
    Restored(TileId),
    /// A goal holds, and did not before.
    Goal(GoalId),
    /// A `never` holds, and did not before.
    Never(NeverId),
}

impl Simulator {
    /// The edges that were taken in the last step made with `scratch`, in order.
    pub fn taken_edges<'s>(&self, scratch: &'s Scratch) -> &'s [(SlotId, EdgeId)] {
        scratch.changes.edges()
    }

    /// Calls `on_event` for each event of the last step made with `scratch`, which led from one state to another: edges
    /// in the order in which they were taken, then instances, contacts, tiles and predicates by id.
    ///
    /// # Errors
    /// A [`Fault`] if a goal or a `never` breaks a rule.
    pub fn events(
        &self,
        before: &[u8],
        after: &[u8],
        scratch: &Scratch,
        on_event: &mut dyn FnMut(Event),
    ) -> Result<(), Fault> {
        let world = self.world();
        for &(slot, edge) in scratch.changes.edges() {
            on_event(Event::Edge(slot, edge));
        }
        for slot in world.slots.ids() {
            let layout = self.layout(slot);
            match (layout.alive(before), layout.alive(after)) {
                (false, true) => on_event(Event::Spawned(slot)),
                (true, false) => on_event(Event::Destroyed(slot)),
                (true, true) if layout.space(before) != layout.space(after) => {
                    on_event(Event::Entered(slot, layout.space(after)));
                }
                _ => {}
            }
        }
        for slot in world.slots.ids().filter(|slot| self.layout(*slot).alive(after)) {
            for touch in self.entity(slot).touches.ids() {
                // A new instance had no contacts before.
                let of = |state| self.layout(slot).alive(state) && self.layout(slot).touch(state, touch);
                match (of(before), of(after)) {
                    (false, true) => on_event(Event::Touched(slot, touch)),
                    (true, false) => on_event(Event::Parted(slot, touch)),
                    _ => {}
                }
            }
        }
        if let Some(breakables) = &self.breakables {
            breakables.changes(before, after, &mut |tile, is_broken| {
                on_event(if is_broken { Event::Broken(tile) } else { Event::Restored(tile) });
            });
        }
        let begins = |predicate| Ok(self.holds(after, predicate)? && !self.holds(before, predicate)?);
        for (id, goal) in world.goals.pairs() {
            if begins(goal.holds)? {
                on_event(Event::Goal(id));
            }
        }
        for (id, never) in world.nevers.pairs() {
            if begins(never.holds)? {
                on_event(Event::Never(id));
            }
        }
        Ok(())
    }
}

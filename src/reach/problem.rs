//! The question: a world, a goal, and where a branch of the search ends.

use crate::ir::{GoalId, SlotId};
use crate::sim::{Fault, Simulator};

/// What the simulator makes of a state on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Go on.
    Open,
    /// The goal holds.
    Goal,
    /// A `never` holds, or a player's position lies below or beside its space's bounds.
    Dead,
}

/// A world and the goal that is asked for.
pub struct Problem<'s> {
    /// The simulator of the world.
    pub sim: &'s Simulator<'s>,
    /// The goal.
    pub goal: GoalId,
    players: Vec<SlotId>,
}

impl<'s> Problem<'s> {
    /// Asks for a goal of the simulator's world.
    pub fn new(sim: &'s Simulator<'s>, goal: GoalId) -> Self {
        let players = sim.world().players.iter().map(|p| p.slot).collect();
        Problem { sim, goal, players }
    }

    /// The slots that players control.
    pub fn players(&self) -> &[SlotId] {
        &self.players
    }

    /// Judges a state: `never` first, then the bounds of the space, then the goal. The order matters: a state out of
    /// bounds is the end of a run, which the analysis does not look at.
    ///
    /// # Errors
    /// A [`Fault`] if a predicate breaks a rule.
    pub fn judge(&self, state: &[u8]) -> Result<Standing, Fault> {
        if self.sim.violated(state)?.is_some() {
            return Ok(Standing::Dead);
        }
        if !self.in_bounds(state) {
            return Ok(Standing::Dead);
        }
        Ok(if self.sim.goal(state, self.goal)? { Standing::Goal } else { Standing::Open })
    }

    /// Whether every player is within its space: at or above the bounds' lower edge, between their sides. Above there is
    /// no bound, and where there is neither a map nor a `bounds` there is none at all.
    fn in_bounds(&self, state: &[u8]) -> bool {
        self.players.iter().all(|&slot| {
            if !self.sim.world().layout.slots[slot].alive(state) {
                return true;
            }
            let Some(bounds) = self.sim.world().spaces[self.sim.space(state, slot)].bounds else { return true };
            let (x, y) = self.sim.position(state, slot);
            (bounds.left..=bounds.right).contains(&x) && y >= bounds.bottom
        })
    }
}

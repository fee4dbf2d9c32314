//! The instance that is in the way of the first player in the nearest state: it blocks the player and is at the side of it
//! on which the goal is. What is below holds the player, and is not in the way.

use crate::ir::{Bounds, Push, Side, SlotId};
use crate::why::is_at;

use super::super::goal_positions::goal_positions;
use super::super::problem::Problem;
use super::record::{Barrier, Point, WayEnd};

/// An instance that is in the way.
pub(super) struct Bar {
    /// The instance.
    pub slot: SlotId,
    /// Where it is, seen from the player.
    side: Side,
    /// Its modes.
    modes: String,
}

/// The instance that is in the way in a state; `None` if there is none, and if the goal is not at a place of the player.
pub(super) fn bar(problem: &Problem<'_>, state: &[u8]) -> Option<Bar> {
    let (player, goals) = goal_positions(problem)?;
    let sim = problem.sim;
    let me = sim.instance(state, player);
    if problem.players().first() != Some(&player) || !me.is_alive() {
        return None;
    }
    let at = me.position();
    let here = || goals.iter().filter(|goal| goal.space.is_none_or(|space| space == me.space()));
    let mut sides = Vec::new();
    sides.extend(here().any(|goal| goal.x.0 > at.0).then_some(Side::Right));
    sides.extend(here().any(|goal| goal.x.1 < at.0).then_some(Side::Left));
    sides.extend(here().any(|goal| goal.y.0 > at.1).then_some(Side::Above));
    for other in sim.instances(state).filter(|other| other.slot() != player && other.space() == me.space()) {
        for (id, there) in other.colliders() {
            let there = there.placed(other.position());
            let tags = other.entity().colliders[id].tags;
            let own = me.colliders().filter(|(id, _)| {
                let meeting = sim.world().meeting(me.entity().colliders[*id].tags, tags);
                meeting.is_some_and(|meeting| meeting.response.push == Push::Block)
            });
            let own: Vec<Bounds> = own.map(|(_, body)| body.placed(at)).collect();
            let side = sides.iter().find(|side| own.iter().any(|own| is_at(own, &there, Some(**side))));
            if let Some(side) = side {
                let modes = other.modes().map(|mode| format!("`{}`", other.entity().modes[mode].path));
                let modes: Vec<String> = modes.collect();
                return Some(Bar { slot: other.slot(), side: *side, modes: modes.join(", ") });
            }
        }
    }
    None
}

impl Bar {
    /// As the end of the way, at the place of the player.
    pub fn way_end(&self, problem: &Problem<'_>, at: &Point) -> WayEnd {
        let name = &problem.sim.world().slots[self.slot].name;
        let side = match self.side {
            Side::Left => "left of",
            Side::Right => "right of",
            Side::Above => "above",
            Side::Below => "below",
        };
        WayEnd {
            space: at.space.clone().unwrap_or_default(),
            x: at.x,
            y: at.y,
            column: at.column,
            barrier: Barrier::Instance,
            size: None,
            tiles: None,
            words: format!("in the nearest state `{name}` is {side} the player and blocks it, in {}", self.modes),
        }
    }
}

//! Gates: instances that stand in the way while a mode is active, such as locked doors. The distance field leads around
//! them, or to what opens those that are on every way (`stages.rs`).

use crate::analysis::ConfigurationSpace;
use crate::ir::{Bounds, Expr, ExprId, ModeId, Origin, SlotId, SpaceId, Subject, TagSet, VarId};

use super::goal_positions::{extent, is_moving};
use super::problem::Problem;
use super::subgoals::Fact;

/// Maximum number of gates.
const MAX_GATES: usize = 32;

/// What stands in the way.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    /// That it is open.
    pub is_open: Fact,
    /// Where it is, and what it counts as.
    pub space: SpaceId,
    pub bounds: Bounds,
    pub tags: TagSet,
}

/// The gates of a world that are closed at first, to a player.
pub(super) fn gates(problem: &Problem<'_>, space: &ConfigurationSpace, player: SlotId) -> Vec<Gate> {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    if !problem.players().contains(&player) {
        return Vec::new();
    }
    let others = world.slots.pairs().filter(|(id, slot)| *id != player && slot.origin != Origin::Free);
    let gates = others.filter(|(id, _)| !problem.players().contains(id)).flat_map(|(id, slot)| {
        let entity = &program.entities[slot.entity];
        let guarded = entity.colliders.iter().filter_map(|collider| Some((collider, collider.guard?)));
        guarded.filter_map(move |(collider, guard)| {
            let (mode, is_active) = mode_of(problem, guard)?;
            let at = (slot.vars[VarId::X][0], slot.vars[VarId::Y][0]);
            let bounds = extent(problem, id, collider)?.placed(at);
            let is_open = Fact::of_mode(id, mode, !is_active);
            let is_closed = !is_open.holds_at_first(problem) && !is_moving(problem, space, id);
            is_closed.then_some(Gate { is_open, space: slot.space, bounds, tags: collider.tags })
        })
    });
    gates.take(MAX_GATES).collect()
}

/// The mode of the instance that a guard asks for, and whether it is to be active.
pub(super) fn mode_of(problem: &Problem<'_>, guard: ExprId) -> Option<(ModeId, bool)> {
    match problem.sim.program().exprs[guard] {
        Expr::InMode(Subject::Me, mode) => Some((mode, true)),
        Expr::Not(a) => mode_of(problem, a).map(|(mode, is_active)| (mode, !is_active)),
        _ => None,
    }
}

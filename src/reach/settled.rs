//! Where an instance stays for good: in a mode that no edge leads out of, such as being dead, in which its flows hold it
//! still and nothing pushes or carries it. What a goal needs of its place then never comes to hold (`lost.rs`).

use crate::analysis::ConfigurationSpace;
use crate::ir::{
    Actions, Drive, EdgeId, Expr, ExprId, GroupId, Id, IdVec, LeafId, Origin, Place, Slot, SlotId, Subject, TagSet,
    VarId,
};
use crate::sim::Simulator;

use super::gates::mode_of;
use super::goal_positions::is_moving;
use super::problem::Problem;

/// The instance whose place a condition is about, and along which axes, if nothing else counts: its position is compared
/// with a number, or it touches what stays where it is.
pub(super) fn asked_place(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    condition: ExprId,
) -> Option<(SlotId, [bool; 2])> {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let (slot, axes) = match program.exprs[condition] {
        Expr::Compare(_, a, b) => {
            let is_known = |id: ExprId| program.constant(id, &IdVec::new(), world.step).is_some();
            let at = [(a, b), (b, a)].into_iter().find(|(_, with)| is_known(*with))?.0;
            let Expr::Var(Subject::Slot(slot), var, 0) = program.exprs[at] else { return None };
            (slot, VarId::XY.map(|axis| axis == var))
        }
        Expr::Touching(Subject::Slot(slot), touch) => {
            let other = TagSet::of(program.entities[world.slots[slot].entity].touches[touch].other);
            let stays = |(id, of): (SlotId, &Slot)| {
                let mut met = program.entities[of.entity].colliders.iter().filter(|c| c.tags.meets(other)).peekable();
                let is_steady = || of.origin != Origin::Free && !is_moving(problem, space, id);
                id == slot || met.peek().is_none() || (met.all(|c| c.guard.is_none()) && is_steady())
            };
            (slot, [world.slots.pairs().all(stays); 2])
        }
        _ => return None,
    };
    (axes != [false; 2] && world.slots[slot].origin == Origin::Named).then_some((slot, axes))
}

/// The leaves in which the position of an instance, along some axes, never changes again.
#[derive(Debug)]
pub(super) struct Settled {
    slot: SlotId,
    group: GroupId,
    /// For each leaf of the entity.
    stays: Vec<bool>,
}

impl Settled {
    /// Whether the instance is in one of them.
    pub fn is_in(&self, sim: &Simulator, state: &[u8]) -> bool {
        let layout = &sim.world().layout.slots[self.slot];
        layout.alive(state) && self.stays[layout.leaf(state, self.group).index()]
    }
}

/// For each group of an instance that has any, the leaves in which its position, along some axes, never changes again.
pub(super) fn settled(problem: &Problem<'_>, slot: SlotId, axes: [bool; 2]) -> Vec<Settled> {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let params = &world.slots[slot].params;
    let entity = &program.entities[world.slots[slot].entity];
    let vars: Vec<VarId> = VarId::XY.into_iter().zip(axes).filter(|(_, counts)| *counts).map(|(var, _)| var).collect();
    let is_set = |actions: &Actions| {
        actions.updates.iter().any(|update| matches!(update.place, Place::Var(var, 0) if vars.contains(&var)))
    };
    let is_moved_by = |leaf: LeafId, edges: &[EdgeId]| {
        !entity.leaves[leaf].follows.is_empty() || edges.iter().any(|edge| is_set(&entity.edges[*edge].actions))
    };
    let is_held = |leaf: LeafId, of: VarId| {
        let mut drives = entity.leaves[leaf].drives.iter();
        drives.any(|drive| match *drive {
            Drive::Flow { var, degree: 1, value } => {
                var == of && program.constant(value, params, world.step) == Some(0.0)
            }
            _ => false,
        })
    };
    let others = world.slots.pairs().filter(|(id, _)| *id != slot).map(|(_, of)| of.entity);
    let mut others: Vec<TagSet> = others.flat_map(|of| program.entities[of].colliders.iter()).map(|c| c.tags).collect();
    others.sort_unstable();
    others.dedup();
    let is_pushed = |leaf: LeafId| {
        entity.colliders.iter().filter(|collider| !collider.kinematic).any(|collider| {
            let asked = collider.guard.and_then(|guard| mode_of(problem, guard));
            let can_be_there = asked.is_none_or(|(mode, is_active)| entity.is_active_in(mode, leaf) == is_active);
            let mut meetings = others.iter().filter_map(|of| world.meeting(collider.tags, *of));
            can_be_there && meetings.any(|meeting| meeting.response.moves())
        })
    };
    if entity.clamps.iter().any(|clamp| clamp.degree == 0 && vars.contains(&clamp.var)) {
        return Vec::new();
    }
    let in_group = |group: GroupId| {
        let own = entity.leaves_of(&entity.groups[group]);
        // Other groups may move it, too; modes are only entered along edges.
        let mut others = entity.leaves.ids().filter(|leaf| !own.contains(*leaf));
        let is_moved = others.any(|leaf| {
            let of = &entity.leaves[leaf];
            is_moved_by(leaf, &of.edges) || is_moved_by(leaf, &of.internal)
        });
        let is_set_on_entry = own.ids().len() < entity.leaves.len() && entity.modes.iter().any(|m| is_set(&m.entry));
        let stays = |leaf: LeafId| {
            let of = &entity.leaves[leaf];
            own.contains(leaf)
                && of.edges.is_empty()
                && !is_moved_by(leaf, &of.internal)
                && vars.iter().all(|var| is_held(leaf, *var))
                && !is_pushed(leaf)
        };
        let stays: Vec<bool> = entity.leaves.ids().map(stays).collect();
        (!is_moved && !is_set_on_entry && stays.contains(&true)).then_some(Settled { slot, group, stays })
    };
    entity.groups.ids().filter_map(in_group).collect()
}
